//! One HART frame to its decode tree.

use super::cause::{Verdict, judge};
use super::content::{answered, content};
use super::frame::{Address, Delimiter, Head, PREAMBLE, ROTORK, Type, extended, preamble};
use super::model::{Bits, Names};
use super::payload::{Data, Way};
use super::problem::Hart;
use super::{DEVICE_STATUS, command};
use crate::device::Device;
use crate::frame::Marks;
use crate::map::row::Source;
use crate::place::Place;
use crate::problem::{Finding, Problem};
use crate::reader::{Layout, Reader};
use crate::scale::Scale;
use crate::tree::{Decoded, FieldDef, FieldId, Name};
use crate::value::Value;

/// Declares the fields around the data: name, key, label, part of the data link layer.
macro_rules! defs {
    ($($name:ident = $key:literal, $label:literal, $part:literal;)*) => {
        $(static $name: FieldDef = FieldDef {
            key: $key,
            label: $label,
            unit: "",
            source: Source { doc: super::LINK, part: $part },
        };)*
    };
}

defs! {
    FILL = "preamble", "Preamble", "preamble";
    DELIMITER = "delimiter", "Delimiter", "delimiter";
    ADDRESS = "address", "Address", "address";
    EXPANSION = "expansion", "Expansion bytes", "expansion bytes";
    COMMAND = "command", "Command", "command";
    COUNT = "byte_count", "Byte count", "byte count";
    CODE = "response_code", "Response code", "response codes";
    STATUS = "device_status", "Device status", "status bytes";
    CHECK = "check", "Check byte", "check byte";
    UNKNOWN = "unknown", "Unknown bytes", "data";
}

/// Decodes a frame into `out`, which holds its bytes. `request` is the one that it answers.
pub(crate) fn frame(
    marks: Marks,
    bytes: &[u8],
    request: Option<&[u8]>,
    device: Device,
    out: &mut Decoded,
) {
    let fill = preamble(bytes);
    let body = bytes.get(fill..).unwrap_or(&[]);
    let place = Place::new(0, fill);
    if fill > 0 {
        out.push(None, Name::Def(&FILL), Value::Raw, place);
    }
    let eaten = matches!(judge(body), Verdict::Start { .. });
    if fill < *PREAMBLE.start() && !eaten {
        let got = u16::try_from(fill).unwrap_or(0);
        note(out, Hart::Preamble { got }, place);
    }
    let reader = Reader::new(body, fill, Layout::Plain);
    inner(reader, fill, request, device, out);
    if marks.has(Marks::AGAIN) {
        note(out, Hart::Again, Place::new(0, bytes.len()));
    }
}

/// A frame without its preamble, which begins at byte `base`.
pub(super) fn inner(
    mut reader: Reader<'_>,
    base: usize,
    request: Option<&[u8]>,
    device: Device,
    out: &mut Decoded,
) {
    let body = reader.rest();
    let (verdict, begun) = begin(body);
    if let Some(head) = begun {
        whole(&head, verdict, &mut reader, request, device, out);
    } else if let Some(delimiter) = body.first().and_then(|d| Delimiter::new(*d)) {
        start(delimiter, &mut reader, out);
    }
    unknown(&mut reader, out);
    damage(verdict, base, body.len(), out);
}

/// What is wrong with a frame without its preamble, and its head.
pub(super) fn begin(body: &[u8]) -> (Verdict, Option<Head>) {
    let verdict = judge(body);
    let head = match verdict {
        Verdict::Start { delimiter } => {
            Delimiter::new(delimiter).and_then(|d| Head::after(d, body, 0))
        }
        _ => Head::of(body),
    };
    (verdict, head)
}

/// The head, and what it announces.
fn whole(
    head: &Head,
    verdict: Verdict,
    reader: &mut Reader<'_>,
    request: Option<&[u8]>,
    device: Device,
    out: &mut Decoded,
) -> Option<()> {
    let delimiter = head.delimiter;
    if !matches!(verdict, Verdict::Start { .. }) {
        start(delimiter, reader, out);
    }
    let len = if delimiter.is_long() { 5 } else { 1 };
    let (bytes, place) = reader.take(len)?;
    let value = match *bytes {
        [short] => Value::Hex(u32::from(short)),
        _ => Value::Raw,
    };
    let id = out.push(None, Name::Def(&ADDRESS), value, place);
    out.say(id, address_words(head));
    if delimiter.expansion() > 0 {
        let (_, place) = reader.take(usize::from(delimiter.expansion()))?;
        out.push(None, Name::Def(&EXPANSION), Value::Raw, place);
    }
    let (number, place) = reader.u8()?;
    let own = command(u16::from(number));
    let named = Value::Named(u32::from(number), own.map(|c| c.label));
    out.push(None, Name::Def(&COMMAND), named, place);
    let (count, place) = reader.u8()?;
    let value = Value::Number {
        raw: i64::from(count),
        scale: Scale::ONE,
    };
    out.push(None, Name::Def(&COUNT), value, place);
    // Where the check byte stands: at the end, unless the end is missing.
    let sealed = !matches!(
        verdict,
        Verdict::CheckMissing { .. } | Verdict::Cut { .. } | Verdict::None
    );
    let room = match verdict {
        Verdict::None => usize::from(head.count).min(reader.left()),
        _ => reader.left().saturating_sub(usize::from(sealed)),
    };
    let mut inner = reader.sub(room)?;
    let way = match delimiter.kind() {
        Type::Stx => Way::Request,
        Type::Ack | Type::Back => Way::Response,
    };
    data(way, head, &mut inner, request, device, out);
    unknown(&mut inner, out);
    if sealed && let Some((check, place)) = reader.u8() {
        out.push(None, Name::Def(&CHECK), Value::Hex(u32::from(check)), place);
    }
    Some(())
}

/// Status and data.
fn data(
    way: Way,
    head: &Head,
    reader: &mut Reader<'_>,
    request: Option<&[u8]>,
    device: Device,
    out: &mut Decoded,
) -> Option<()> {
    let number = u16::from(head.command);
    let mut open = true;
    if way == Way::Response {
        // A refusal of an extended command may leave its number out; the request has it.
        let inner = reader.rest().get(2..4).and_then(|n| n.try_into().ok());
        let inner = inner
            .map(u16::from_be_bytes)
            .or_else(|| asked_for(request?))
            .filter(|_| number == 31);
        open = status(
            inner.and_then(command).or_else(|| command(number)),
            reader,
            out,
        )?;
    }
    content(
        number,
        open,
        reader,
        &mut Data::new(way, device.family(), out),
    )
}

/// The number that an extended request asks for.
fn asked_for(request: &[u8]) -> Option<u16> {
    let frame = request.get(preamble(request)..)?;
    extended(&Head::of(frame)?, frame)
}

/// The two status bytes. False if no data follow.
fn status(
    command: Option<&'static super::model::Command>,
    reader: &mut Reader<'_>,
    out: &mut Decoded,
) -> Option<bool> {
    let (first, place) = reader.u8()?;
    let open = answered(command, first, &CODE, place, out);
    let (second, place) = reader.u8()?;
    flags(
        out,
        None,
        Name::Def(&STATUS),
        u32::from(second),
        &DEVICE_STATUS,
        place,
    );
    Some(open)
}

/// A field of named bits with one field for each of them.
pub(super) fn flags(
    out: &mut Decoded,
    parent: Option<FieldId>,
    name: Name,
    raw: u32,
    bits: &'static Bits,
    place: Place,
) -> FieldId {
    let set = &bits.set;
    let id = out.push(parent, name, Value::Flags { raw, set }, place);
    for bit in bits.bits {
        let value = Value::Bit {
            on: raw.wrapping_shr(u32::from(bit.bit)) & 1 != 0,
            words: &bit.states,
        };
        out.push(Some(id), Name::HartBit(bit), value, place);
    }
    if raw & !set.mask != 0 {
        let bits = raw & !set.mask;
        out.problem(Problem::new(Finding::UnusedBits { bits }, place));
    }
    id
}

fn start(delimiter: Delimiter, reader: &mut Reader<'_>, out: &mut Decoded) {
    if let Some((byte, place)) = reader.u8() {
        let value = Value::Hex(u32::from(byte));
        let id = out.push(None, Name::Def(&DELIMITER), value, place);
        out.say(id, delimiter.to_string());
    }
}

fn address_words(head: &Head) -> String {
    let mut words = match head.address {
        Address::BROADCAST => "broadcast".to_owned(),
        Address::Short(polling) => format!("polling address {polling}"),
        // Reading G12: the address has the low 14 bits of the type.
        Address::Long(kind, id) if kind == ROTORK & 0x3FFF => {
            format!("type {kind:04X} (Rotork actuator), device {id:06X}")
        }
        Address::Long(kind, id) => format!("type {kind:04X}, device {id:06X}"),
    };
    words.push_str(if head.primary {
        ", primary master"
    } else {
        ", secondary master"
    });
    if head.burst {
        words.push_str(", in burst mode");
    }
    words
}

/// A code with a name.
pub(super) fn named_field(
    def: &'static FieldDef,
    names: &'static Names,
    code: u32,
    place: Place,
    out: &mut Decoded,
) {
    let value = Value::Named(code, names.name(code));
    out.push(None, Name::Def(def), value, place);
}

/// What is left belongs to no field.
pub(super) fn unknown(reader: &mut Reader<'_>, out: &mut Decoded) {
    if !reader.is_empty() {
        let (_, place) = reader.take_rest();
        out.push(None, Name::Def(&UNKNOWN), Value::Raw, place);
    }
}

/// What recomputation proved.
fn damage(verdict: Verdict, base: usize, len: usize, out: &mut Decoded) {
    let end = base.saturating_add(len);
    let last = Place::new(end.saturating_sub(1), 1);
    match verdict {
        Verdict::Sound | Verdict::None => {}
        Verdict::Check { got, want } => note(out, Hart::Check { got, want }, last),
        Verdict::CheckMissing { want } => {
            note(out, Hart::CheckMissing { want }, Place::new(end, 0));
        }
        Verdict::Count { got, want, sent } => {
            let place = out
                .fields()
                .iter()
                .find(|f| f.name == Name::Def(&COUNT))
                .map_or(last, |f| f.place);
            note(out, Hart::Count { got, want, sent }, place);
        }
        Verdict::Start { delimiter } => note(out, Hart::Start { delimiter }, Place::new(base, 0)),
        Verdict::Cut { missing } => out.problem(Problem::new(
            Finding::Truncated { missing },
            Place::new(end, 0),
        )),
    }
}

/// Pins a finding to bytes.
pub(super) fn note(out: &mut Decoded, finding: Hart, place: Place) {
    out.problem(Problem::new(Finding::Hart(finding), place));
}
