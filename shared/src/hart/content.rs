//! What a command says, in a frame or in a direct PDU of HART-IP: its response code, its data, and
//! what is to be said of both.

use super::decode::{flags, note};
use super::model::{Class, Command, Effect};
use super::payload::{Data, Way};
use super::problem::Hart;
use super::{COMMUNICATION_ERROR, class, code_words, command};
use crate::map::row::Source;
use crate::place::Place;
use crate::reader::Reader;
use crate::tree::{Decoded, FieldDef, Name};
use crate::value::Value;

static ERROR: FieldDef = FieldDef {
    key: "communication_error",
    label: "Communication error",
    unit: "",
    source: Source {
        doc: super::LINK,
        part: "status bytes",
    },
};

/// The first status byte: a communication error, or a response code as this field. False if no data
/// follow.
pub(super) fn answered(
    command: Option<&'static Command>,
    first: u8,
    def: &'static FieldDef,
    place: Place,
    out: &mut Decoded,
) -> bool {
    if first & 0x80 != 0 {
        let name = Name::Def(&ERROR);
        flags(
            out,
            None,
            name,
            u32::from(first),
            &COMMUNICATION_ERROR,
            place,
        );
        note(out, Hart::Line, place);
        return false;
    }
    let words = code_words(command, first);
    let named = Some(words).filter(|w| !w.is_empty());
    let value = Value::Named(u32::from(first), named);
    out.push(None, Name::Def(def), value, place);
    let (class, _) = class(first);
    let error = class == Class::Error;
    if class != Class::Success {
        let finding = Hart::Code {
            code: first,
            words,
            error,
        };
        note(out, finding, place);
    }
    !error
}

/// The data of a command, and what is to be said of it. Unless `open`, its response code lets none
/// follow.
pub(super) fn content(
    mut number: u16,
    open: bool,
    reader: &mut Reader<'_>,
    data: &mut Data<'_>,
) -> Option<()> {
    let len = reader.left();
    // A refusal may still carry the number of an extended command.
    let numbered = number == 31 && len == 2;
    if !(open || numbered) {
        if len > 0 {
            let len = u16::try_from(len).unwrap_or(u16::MAX);
            note(data.out, Hart::Unasked { len }, reader.here());
        }
        return None;
    }
    if number == 31 {
        number = data.carrier(command(31)?, reader)?;
    }
    let whole = reader.here();
    let Some(command) = command(number) else {
        note(data.out, Hart::Unknown { number }, whole);
        return None;
    };
    if !open {
        return None;
    }
    data.command(command, reader);
    if data.way == Way::Request {
        let effects = command.effects_of(usize::from(whole.len));
        for effect in effects.iter().copied() {
            if !matches!(effect, Effect::Reads | Effect::Carries) {
                note(data.out, Hart::Does { effect }, whole);
            }
        }
    }
    if let Some(family) = data.family
        && !command.families.contains(&family)
    {
        note(data.out, Hart::NotListed { number }, whole);
    }
    Some(())
}
