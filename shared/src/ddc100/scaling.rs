//! Analog values: what a raw word means depends on how the unit is set, which no register tells.
//!
//! Source: table 3.5, register 8, by reading D7: 0 to 100 (the default), 0 to 255 or 0 to 4095.

use core::fmt;

use crate::address::Table;
use crate::map::row::Row;

/// How a unit is set to report an analog value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Scaling {
    /// 0 to 100, the default: percent.
    #[default]
    Percent,
    /// 0 to 255.
    Byte,
    /// 0 to 4095.
    TwelveBits,
    /// Not known: shown as the counts that they are.
    Raw,
}

impl Scaling {
    /// All choices, the default first.
    pub const ALL: [Self; 4] = [Self::Percent, Self::Byte, Self::TwelveBits, Self::Raw];

    /// The word in tag lists and addresses of the page.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Percent => "0-100",
            Self::Byte => "0-255",
            Self::TwelveBits => "0-4095",
            Self::Raw => "raw",
        }
    }

    /// The choice with this [`key`](Self::key).
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|s| s.key() == key)
    }

    /// The counts that stand for 100 %; `None` if that is not known.
    #[must_use]
    pub const fn full(self) -> Option<u16> {
        match self {
            Self::Percent => Some(100),
            Self::Byte => Some(255),
            Self::TwelveBits => Some(4095),
            Self::Raw => None,
        }
    }

    /// What a raw word means.
    #[must_use]
    pub fn read(self, raw: u16) -> Scaled {
        match self.full() {
            None => Scaled::Counts(raw),
            Some(full) if raw > full => Scaled::Beyond { raw, full },
            Some(full) => {
                // Rounded half up; at most 1000.
                let half = u32::from(full) / 2;
                let tenths = u32::from(raw)
                    .saturating_mul(1000)
                    .saturating_add(half)
                    .checked_div(u32::from(full));
                Scaled::Tenths {
                    tenths: tenths.and_then(|t| u16::try_from(t).ok()).unwrap_or(0),
                    fine: full > 100,
                }
            }
        }
    }

    /// True for a row whose counts depend on the setting: those in percent. Note 2 of table 3.5 lists
    /// registers 3, 4, 6, 7 and 8; register 5 of the types that have an analog input there is
    /// inferred, and its row says so.
    #[must_use]
    pub fn applies_to(row: &Row) -> bool {
        row.unit == "%" && matches!(row.table, Table::Holding | Table::Input)
    }
}

/// An analog value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scaled {
    /// Tenths of a percent.
    Tenths {
        /// 0 to 1000.
        tenths: u16,
        /// True if the scale is finer than a percent, so that the decimal says something.
        fine: bool,
    },
    /// Counts of an unknown scale.
    Counts(u16),
    /// More than the scale has: no signal (many units report 65535), or another scale.
    Beyond {
        /// As transmitted.
        raw: u16,
        /// The most that the scale has.
        full: u16,
    },
}

impl Scaled {
    /// Tenths of a percent, if that is known.
    #[must_use]
    pub const fn tenths(self) -> Option<u16> {
        match self {
            Self::Tenths { tenths, .. } => Some(tenths),
            Self::Counts(_) | Self::Beyond { .. } => None,
        }
    }
}

impl fmt::Display for Scaled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tenths {
                tenths,
                fine: false,
            } => write!(f, "{} %", tenths / 10),
            Self::Tenths { tenths, fine: true } => {
                write!(f, "{}.{} %", tenths / 10, tenths % 10)
            }
            Self::Counts(raw) => write!(f, "{raw} counts"),
            Self::Beyond { raw: 0xFFFF, .. } => f.write_str("no value (65535)"),
            Self::Beyond { raw, full } => write!(f, "{raw}, beyond 0 to {full}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 61 of 100, of 255 (23.92 %), of 4095 (1.49 %).
    #[test]
    fn d7_the_same_word_on_each_scale() {
        let texts = Scaling::ALL.map(|s| s.read(61).to_string());
        assert_eq!(texts, ["61 %", "23.9 %", "1.5 %", "61 counts"]);
        for scaling in Scaling::ALL {
            assert_eq!(Scaling::from_key(scaling.key()), Some(scaling));
            if let Some(full) = scaling.full() {
                assert_eq!(scaling.read(full).tenths(), Some(1000));
                assert_eq!(scaling.read(0).tenths(), Some(0));
                assert_eq!(scaling.read(full + 1).tenths(), None);
            }
        }
        assert_eq!(
            Scaling::Percent.read(0xFFFF).to_string(),
            "no value (65535)"
        );
        assert_eq!(Scaling::Byte.read(300).to_string(), "300, beyond 0 to 255");
        assert_eq!(Scaling::from_key("2-255"), None, "the misprint is no scale");
    }
}
