//! HART: frames, commands and status of Rotork actuators with a HART field unit.
//!
//! ```text
//!  FF … | delimiter | address | command | byte count | [status] data | check byte
//! ```
//!
//! [`frame`] knows the parts of a frame, `stream` finds frames among other bytes and proves why
//! a damaged one is damaged, `decode` turns one into a tree of fields. The facts are data
//! (`shared/data/hart`); the build turns them into the static tables of this module and stops at
//! the first that breaks a rule.
//!
//! **Invariant:** the fields of a form follow each other without hole or overlap, so the leaves of
//! a decoded frame tile its bytes.

mod cause;
mod content;
pub(crate) mod decode;
mod effect;
pub mod export;
pub mod frame;
pub mod ip;
pub mod link;
pub mod model;
pub mod ne107;
mod payload;
pub mod problem;
pub mod procedure;
mod shape;
pub(crate) mod stream;
pub mod values;
pub(crate) mod who;

use crate::device::Family;
use crate::map::row::{Member, Reading, Set, Settled, Source, Trust};
use model::{
    Bit, Bits, Class, Code, Codes, Command, Effect, Form, Group, Item, Kind, Mapped, Names, Part,
    Preset, Reach, Timer, Unit,
};

pub use who::who;

include!(concat!(env!("OUT_DIR"), "/hart.rs"));

/// The command with this number.
#[must_use]
pub fn command(number: u16) -> Option<&'static Command> {
    let at = COMMANDS.binary_search_by_key(&number, |c| c.number).ok()?;
    COMMANDS.get(at)
}

/// The reading with this id.
#[must_use]
pub fn reading(id: &str) -> Option<&'static Reading> {
    READINGS.iter().find(|reading| reading.id == id)
}

/// The unit with this code; a few codes mean something else under some classifications.
#[must_use]
pub fn unit(code: u8, class: u8) -> Option<&'static Unit> {
    let fits = |u: &&Unit| u.code == code && (u.class == 0 || u.class == class);
    UNITS.iter().find(fits)
}

/// The bits of a byte of the device's own status (command 48), where the family is known.
#[must_use]
pub fn additional(family: Family, byte: u8) -> Option<&'static Bits> {
    let bytes = ADDITIONAL.iter().find(|(f, _)| *f == family)?.1;
    *bytes.get(usize::from(byte))?
}

/// The class of a response code, and what it means for every command.
#[must_use]
pub fn class(code: u8) -> (Class, &'static str) {
    CODES
        .iter()
        .find(|c| (c.first..=c.last).contains(&code))
        .map_or((Class::Error, ""), |c| (c.class, c.label))
}

/// What a response code of a command says, empty if nobody knows.
#[must_use]
pub fn code_words(command: Option<&Command>, code: u8) -> &'static str {
    let own = command
        .and_then(|c| c.codes.iter().find(|k| k.code == code))
        .map_or("", |k| k.words);
    if own.is_empty() { class(code).1 } else { own }
}
