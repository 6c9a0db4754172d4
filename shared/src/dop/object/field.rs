//! One value of an object, and what it stands for.

use crate::dop::profile::Setting;
use crate::map::row::{Reading, Set, Source, Trust};
use crate::scale::Scale;

/// How the registers of a field make up its value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FieldKind {
    /// One register, unsigned.
    U16,
    /// One register, two's complement.
    S16,
    /// Two registers, unsigned.
    U32,
    /// Two registers, two's complement.
    S32,
    /// Four registers, two's complement: seconds since 1970-01-01 UTC (reading C16).
    Time,
    /// Characters, two a register; the number of registers.
    Text(u16),
}

impl FieldKind {
    /// The word used in JSON; that of the manual.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::U16 => "U16",
            Self::S16 => "S16",
            Self::U32 => "U32",
            Self::S32 => "S32",
            Self::Time => "S64",
            Self::Text(_) => "ASCII",
        }
    }

    /// Registers of one value.
    #[must_use]
    pub const fn words(self) -> u16 {
        match self {
            Self::U16 | Self::S16 => 1,
            Self::U32 | Self::S32 => 2,
            Self::Time => 4,
            Self::Text(words) => words,
        }
    }
}

/// The part that a field plays in a picture of its object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Part {
    /// How many points or bins are valid.
    Points,
    /// How many records follow.
    Records,
    /// Largest values.
    Max,
    /// Smallest values.
    Min,
    /// Averages.
    Avg,
    /// Long-term averages.
    Lta,
    /// Values of an open stroke or of the open side.
    Open,
    /// Values of a close stroke or of the close side.
    Close,
    /// Amounts of bins that are neither.
    Bins,
    /// Times that belong to the bins or values of another field.
    When,
    /// When the data begin.
    Start,
    /// When the data end.
    End,
    /// Identity of a record.
    Id,
    /// Category of a record.
    Category,
    /// None of these.
    Other,
}

/// What the elements of an array stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// The field is no array.
    One,
    /// Steps back in time from the newest: `hour`, `day`, `month`, `year`.
    Ago(&'static str),
    /// Bins of `step` from `from`, in tenths of the unit.
    Bins {
        /// Where the first bin begins.
        from: u16,
        /// How wide a bin is.
        step: u16,
        /// Unit of both.
        unit: &'static str,
    },
    /// The axes X, Y and Z.
    Xyz,
}

impl Axis {
    /// What the element `index` stands for: `0 to 10 %`, `X`, `day 1`. Empty for no array.
    #[must_use]
    pub fn label(self, index: u16) -> String {
        match self {
            Self::One => String::new(),
            Self::Ago(unit) => format!("{unit} {}", index.saturating_add(1)),
            Self::Bins { unit, .. } => {
                let (from, to) = self.bounds(index).unwrap_or_default();
                let text = |tenths: u16| {
                    let text = Scale::TENTH.apply(i64::from(tenths)).to_string();
                    text.strip_suffix(".0").map(str::to_owned).unwrap_or(text)
                };
                format!("{} to {} {unit}", text(from), text(to))
            }
            Self::Xyz => ["X", "Y", "Z"]
                .get(usize::from(index))
                .map_or_else(|| index.to_string(), |name| (*name).to_owned()),
        }
    }

    /// Where a bin begins and ends, in tenths of its unit.
    #[must_use]
    pub fn bounds(self, index: u16) -> Option<(u16, u16)> {
        let Self::Bins { from, step, .. } = self else {
            return None;
        };
        let start = from.saturating_add(step.saturating_mul(index));
        Some((start, start.saturating_add(step)))
    }
}

/// One value of an object, or an array of equal ones.
#[derive(Debug, PartialEq)]
pub struct Field {
    /// The object it belongs to.
    pub object: u16,
    /// First register, counted from the start of the response (of the record in a log).
    pub at: u16,
    /// How many values follow each other.
    pub count: u16,
    /// How registers make up a value.
    pub kind: FieldKind,
    /// Frozen identifier, unique within its layout.
    pub key: &'static str,
    /// What people read, spelling corrected.
    pub label: &'static str,
    /// Engineering unit, empty if it has none.
    pub unit: &'static str,
    /// Factor from raw counts to the unit.
    pub scale: Scale,
    /// Names of codes or bits.
    pub set: Option<&'static Set>,
    /// Its part in a picture.
    pub part: Part,
    /// What the elements of an array stand for.
    pub axis: Axis,
    /// For an array of which only the first points are valid: the point that its first element is
    /// (reading C19).
    pub limit: Option<u16>,
    /// True if every record of a log has one.
    pub record: bool,
    /// The setting of the profile that decides about unit or scale.
    pub setting: Option<Setting>,
    /// The same field in degrees Fahrenheit, for a temperature (reading C4).
    pub fahrenheit: Option<&'static Self>,
    /// Where the manual says so.
    pub source: Source,
    /// How far it can be trusted.
    pub trust: Trust,
    /// Why it differs from the print, or what the print leaves open.
    pub reading: Option<&'static Reading>,
    /// Further readings that concern it.
    pub also: &'static [&'static Reading],
    /// A remark in our words, empty if there is none.
    pub note: &'static str,
}

impl Field {
    /// Registers of the whole field.
    #[must_use]
    pub const fn words(&self) -> u16 {
        self.kind.words().saturating_mul(self.count)
    }

    /// The register after its last one.
    #[must_use]
    pub const fn end(&self) -> u16 {
        self.at.saturating_add(self.words())
    }

    /// True if it is followed by an index in a path.
    #[must_use]
    pub const fn is_indexed(&self) -> bool {
        self.count > 1 || self.record
    }

    /// What people read of one of its values: `Maximum vibration, day 3`.
    #[must_use]
    pub fn item_label(&self, index: u16) -> String {
        match self.axis {
            Axis::One => self.label.to_owned(),
            axis => format!("{}, {}", self.label, axis.label(index)),
        }
    }

    /// True if its elements are points, newest first.
    #[must_use]
    pub const fn is_trend(&self) -> bool {
        matches!(self.axis, Axis::Ago(_))
    }

    /// All readings that concern it, the one that decides first.
    pub fn readings(&self) -> impl Iterator<Item = &'static Reading> {
        self.reading.into_iter().chain(self.also.iter().copied())
    }
}
