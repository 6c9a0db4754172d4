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
    /// A point in time: seconds since 1970-01-01 UTC.
    Stamp(i64),
    /// A point in time by the clock of the device, whose zone is not known: seconds since
    /// 2000-01-01 00:00:00.
    #[cfg(feature = "icon")]
    DeviceTime(u32),
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

/// A point in time for programs: `2021-02-12T15:29:15Z`.
#[derive(Clone, Copy, Debug)]
pub struct Rfc3339(pub i64);

impl core::fmt::Display for Rfc3339 {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let (year, month, day, second) = civil(self.0);
        let (hour, minute) = (second / 3600, (second % 3600) / 60);
        write!(
            f,
            "{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{:02}Z",
            second % 60
        )
    }
}

/// Seconds from 1970 to 2000.
#[cfg(feature = "icon")]
pub const Y2K: i64 = 946_684_800;

/// Year, month, day and the second of the day of a point in time.
///
/// Counts days from the first of March of the year 0, so that the day of a leap year is the last
/// of its year; four hundred years have 146097 days.
#[must_use]
pub fn civil(seconds: i64) -> (i64, u8, u8, u32) {
    let small = |n: i64| u8::try_from(n).unwrap_or(0);
    let second = u32::try_from(seconds.rem_euclid(86_400)).unwrap_or(0);
    let days = seconds.div_euclid(86_400).saturating_add(719_468);
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    // The last day of four years, of a century and of four centuries is no year of its own.
    let leap = (day / 1460)
        .saturating_sub(day / 36_524)
        .saturating_add(day / 146_096);
    let year = day.saturating_sub(leap) / 365;
    let before = year
        .saturating_mul(365)
        .saturating_add(year / 4)
        .saturating_sub(year / 100);
    let day = day.saturating_sub(before);
    // Five months from March on have 153 days.
    let month = day.saturating_mul(5).saturating_add(2) / 153;
    let first = month.saturating_mul(153).saturating_add(2) / 5;
    let year = era.saturating_mul(400).saturating_add(year);
    let (month, year) = if month < 10 {
        (month.saturating_add(3), year)
    } else {
        (month.saturating_sub(9), year.saturating_add(1))
    };
    (
        year,
        small(month),
        small(day.saturating_sub(first).saturating_add(1)),
        second,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Days around leap years and the ends of the calendar, worked out by hand.
    #[test]
    fn points_in_time_are_dates() {
        let check = |seconds, expected: &str| {
            assert_eq!(Rfc3339(seconds).to_string(), expected);
        };
        check(0, "1970-01-01T00:00:00Z");
        check(-1, "1969-12-31T23:59:59Z");
        // 10957 days later; 2000 is a leap year although a century.
        check(946_684_800, "2000-01-01T00:00:00Z");
        check(951_782_400, "2000-02-29T00:00:00Z");
        check(951_868_800, "2000-03-01T00:00:00Z");
        // 2100 is none.
        check(4_107_542_399, "2100-02-28T23:59:59Z");
        check(4_107_542_400, "2100-03-01T00:00:00Z");
        check(253_402_300_799, "9999-12-31T23:59:59Z");
        check(1_613_143_755, "2021-02-12T15:29:15Z");
        assert_eq!(
            Value::Stamp(1_613_143_755).to_string(),
            "2021-02-12 15:29:15 UTC"
        );
        // No time is too far away to be written.
        assert!(!Rfc3339(i64::MAX).to_string().is_empty());
        assert!(!Rfc3339(i64::MIN).to_string().is_empty());
    }
}
