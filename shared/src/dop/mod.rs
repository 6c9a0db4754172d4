//! Diagnostic objects of Limitorque MX and QX series B actuators (Diagnostics Object Protocol).
//!
//! A master writes a [`Request`] to a register, waits until the status says that this object is
//! ready, and reads so many registers as the count says. [`ObjectRead`] says what they mean; the
//! [`Profile`] of the site says what the manual leaves open; [`input`] reads pasted registers.
//!
//! The facts are data (`shared/data/dop`); the build turns them into the static tables of this
//! module and stops at the first that breaks a rule.
//!
//! **Invariant:** the fields of a layout follow each other from register 0 without hole or
//! overlap, so the leaves of a decoded object tile its registers.

mod choose;
pub mod export;
mod fields;
pub mod handshake;
pub mod input;
pub mod log;
pub mod object;
pub mod profile;
mod read;
pub mod recognise;
mod values;
mod words;

use crate::map::row::{Member, Reading, Set, Settled, Source, Trust};
use crate::scale::Scale;
use object::{Axis, Choice, Field, FieldKind, Group, Layout, Object, Part, Record, Shape};
use profile::{LogCommand, Setting};

pub use choose::Candidate;
pub use object::Request;
pub use profile::Profile;
pub use read::{LogRecord, Number, ObjectRead};
pub use words::Stamp;

include!(concat!(env!("OUT_DIR"), "/dop.rs"));

/// Registers that a response has room for.
pub const RESPONSE_WORDS: u16 = 512;

/// The object with this number.
#[must_use]
pub fn object(id: u16) -> Option<&'static Object> {
    OBJECTS.iter().find(|object| object.id == id)
}

/// The reading with this id.
#[must_use]
pub fn reading(id: &str) -> Option<&'static Reading> {
    READINGS.iter().find(|reading| reading.id == id)
}

/// The name of an error code.
#[must_use]
pub fn error_name(code: u16) -> Option<&'static str> {
    ERROR_CODES.get(u32::from(code)).map(|member| member.label)
}
