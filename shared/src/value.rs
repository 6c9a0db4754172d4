//! What a field says. Unknown, unavailable and raw are values of their own, never 0 or blank.

use crate::address::{Address, Table};
use crate::map::row::Set;
use crate::scale::Scale;

/// The meaning of a field. Small and `Copy`: text, series and raw bytes stay in the frame and are
/// read from the field's place when they are shown.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(u32)]
pub enum Value {
    /// The field only groups the fields below it.
    Group,
    /// An exact number: `raw` counts of `scale`.
    Number {
        /// Counts as transmitted.
        raw: i64,
        /// Factor to the unit of the field.
        scale: Scale,
    },
    /// A number that is written in hexadecimal: addresses of memory, check values, patterns.
    Hex(u32),
    /// An address in a table, shown with its register number.
    Address(Table, Address),
    /// A code with names; a code without a name stays what it is.
    Code {
        /// The code as transmitted.
        raw: u32,
        /// Its names.
        set: &'static Set,
    },
    /// A code of the protocol with its name, `None` if the protocol knows none.
    Named(u32, Option<&'static str>),
    /// A word of named bits.
    Flags {
        /// The word as transmitted.
        raw: u32,
        /// Names of its bits.
        set: &'static Set,
    },
    /// One bit, with the words for 0 and 1.
    Bit {
        /// Its state.
        on: bool,
        /// What 0 and 1 mean.
        words: &'static Words,
    },
    /// Characters, at the field's place; blanks and NULs at the end are padding.
    Text,
    /// A calendar date.
    Date {
        /// Year with century.
        year: u16,
        /// 1 to 12.
        month: u8,
        /// 1 to 31.
        day: u8,
    },
    /// A time of day.
    Time {
        /// 0 to 23.
        hour: u8,
        /// 0 to 59.
        minute: u8,
        /// 0 to 59.
        second: u8,
    },
    /// Nominal torque or thrust: a unit, and its amount as characters at the field's place.
    Amount {
        /// Name of the unit as the manual prints it, `None` for an unknown code.
        unit: Option<&'static str>,
    },
    /// A series of samples, one byte each, at the field's place.
    Samples,
    /// The device has no value here, and why.
    Unavailable(&'static str),
    /// Bytes whose meaning is not known.
    Raw,
}

/// What 0 and 1 mean.
pub type Words = (&'static str, &'static str);

/// The words for a bit that has no others.
pub static ACTIVE: Words = ("not active", "active");
/// The words for a coil or discrete input.
pub static ON_OFF: Words = ("off", "on");

/// How much a value can be relied on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Quality {
    /// Nothing speaks against it.
    #[default]
    Good,
    /// Outside the range of the manual.
    OutOfRange,
    /// Not a valid value of its type: a code without a name, a digit that is no BCD digit.
    Invalid,
    /// The manual leaves open how to read it; the raw value decides.
    Disputed,
    /// The frame around it is damaged.
    Damaged,
}

impl Quality {
    /// A word for people.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::OutOfRange => "out of range",
            Self::Invalid => "invalid",
            Self::Disputed => "disputed reading",
            Self::Damaged => "damaged frame",
        }
    }
}
