//! Registers to numbers, characters and times, in the orders that the profile sets.

use core::fmt;

use super::profile::Profile;

/// A register with its bytes the right way round.
pub(super) fn straight(word: u16, profile: &Profile) -> u16 {
    if profile.byte_swap() {
        word.swap_bytes()
    } else {
        word
    }
}

/// One to four registers as an unsigned number.
pub(super) fn unsigned(words: &[u16], profile: &Profile) -> u64 {
    let join = |high: u64, word: &u16| high.wrapping_shl(16) | u64::from(straight(*word, profile));
    if profile.low_word_first() {
        words.iter().rev().fold(0, join)
    } else {
        words.iter().fold(0, join)
    }
}

/// One to four registers in two's complement.
pub(super) fn signed(words: &[u16], profile: &Profile) -> i64 {
    let bits = u32::try_from(words.len().saturating_mul(16)).unwrap_or(64);
    let unused = 64_u32.saturating_sub(bits);
    let high = unsigned(words, profile).wrapping_shl(unused);
    high.cast_signed().wrapping_shr(unused)
}

/// The characters up to the first NUL or the end (reading C24).
pub(super) fn characters(words: &[u16], profile: &Profile) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(words.len().saturating_mul(2));
    for word in words {
        let word = straight(*word, profile);
        bytes.extend(if profile.text_low_byte_first() {
            word.to_le_bytes()
        } else {
            word.to_be_bytes()
        });
    }
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    bytes.truncate(end);
    bytes
}

/// A time of the unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Stamp {
    /// It never happened: the unit sends 0 or a negative time (reading C16).
    Never,
    /// Seconds since 1970-01-01 UTC.
    At(i64),
    /// Seconds that are no date with a year of four digits.
    Odd(i64),
}

impl Stamp {
    /// The last second of the year 9999.
    const LAST: i64 = 253_402_300_799;

    /// A time as transmitted.
    #[must_use]
    pub fn from_raw(raw: i64, profile: &Profile) -> Self {
        if raw <= 0 {
            return Self::Never;
        }
        Self::of(profile.seconds(raw))
    }

    /// A time that happened.
    pub(super) fn of(seconds: i64) -> Self {
        if (0..=Self::LAST).contains(&seconds) {
            Self::At(seconds)
        } else {
            Self::Odd(seconds)
        }
    }

    /// Seconds since 1970-01-01 UTC, if it is a date.
    #[must_use]
    pub const fn seconds(self) -> Option<i64> {
        match self {
            Self::At(seconds) => Some(seconds),
            Self::Never | Self::Odd(_) => None,
        }
    }

    /// True for a time within 2000 to 2099; others are possible but no time of such a unit.
    #[must_use]
    pub const fn is_plausible(self) -> bool {
        match self {
            Self::Never => true,
            Self::At(seconds) => seconds >= 946_684_800 && seconds < 4_102_444_800,
            Self::Odd(_) => false,
        }
    }
}

impl fmt::Display for Stamp {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Never => f.write_str("never"),
            Self::At(seconds) | Self::Odd(seconds) => crate::value::Value::Stamp(seconds).fmt(f),
        }
    }
}
