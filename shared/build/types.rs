//! What the data files say, before it is checked: plain records that remember their line.

use std::fmt;

/// A place in a data file.
#[derive(Clone, Debug, Default)]
pub struct At {
    /// Path below `shared/`.
    pub file: String,
    /// One-based line.
    pub line: u64,
}

/// One violated rule, printed as `data/icon3000/input.csv:7: R08: …`.
#[derive(Debug)]
pub struct Problem {
    pub at: At,
    pub rule: &'static str,
    pub text: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {}: {}",
            self.at.file, self.at.line, self.rule, self.text
        )
    }
}

/// Everything below `data/`.
#[derive(Debug, Default)]
pub struct Data {
    pub docs: Vec<Doc>,
    pub devices: Vec<Device>,
}

/// A line of the table in `SOURCES.md`.
#[derive(Debug)]
pub struct Doc {
    pub key: String,
    pub name: String,
}

/// A folder with maps of related models.
#[derive(Debug, Default)]
pub struct Device {
    /// Name of the folder.
    pub key: String,
    /// Oldest first where a model has what the ones before it have.
    pub models: Vec<Model>,
    pub functions: Vec<Function>,
    pub files: Vec<File>,
    pub rows: Vec<Row>,
    pub members: Vec<Member>,
    pub readings: Vec<Reading>,
    /// Readings that other data of the folder name.
    pub cited: Vec<(At, String)>,
}

impl Device {
    /// The rows of a table for a model with their positions, those that it lacks included.
    pub fn rows_of(&self, model: usize, table: usize) -> Vec<(usize, &Row)> {
        let in_map = |row: &Row| {
            self.files.get(row.file).is_some_and(|file| {
                file.table == table && (file.first..=file.last).contains(&model)
            }) && (row.models.is_empty() || row.models.contains(&model))
        };
        self.rows
            .iter()
            .enumerate()
            .filter(|(_, row)| in_map(row))
            .collect()
    }

    /// The word for the table of a row.
    pub fn table_of(&self, row: &Row) -> &'static str {
        let table = self
            .files
            .get(row.file)
            .and_then(|file| TABLES.get(file.table));
        table.map_or("", |t| t.0)
    }
}

/// A line of `models.csv`.
#[derive(Debug)]
pub struct Model {
    pub at: At,
    pub key: String,
    pub name: String,
    /// Label, source part and reading of the addresses that older models lack.
    pub absent: String,
    pub part: String,
    pub reading: String,
    /// Whether the device has more than its map.
    pub extent: usize,
    /// Highest unit address.
    pub units: u8,
}

/// A line of `functions.csv`. Models are positions in [`Device::models`].
#[derive(Debug)]
pub struct Function {
    pub at: At,
    pub code: u8,
    pub sub: Option<u16>,
    pub label: String,
    pub first: usize,
    pub last: usize,
    pub doc: String,
    pub part: String,
    pub page: Option<u16>,
    pub note: String,
    pub reading: String,
}

/// A line of `files.csv`. Models are positions in [`Device::models`].
#[derive(Debug)]
pub struct File {
    pub at: At,
    pub file: String,
    pub table: usize,
    pub first: usize,
    pub last: usize,
    pub doc: String,
    pub part: String,
}

/// A line of a file of rows. Codes are positions in the lists of this module.
#[derive(Debug)]
pub struct Row {
    pub at: At,
    /// Position in [`Device::files`].
    pub file: usize,
    pub address: u16,
    pub words: u16,
    pub key: String,
    pub label: String,
    pub kind: &'static Kind,
    pub scale: Option<Scale>,
    pub unit: String,
    pub set: String,
    pub access: usize,
    pub level: Option<usize>,
    pub min: Option<i32>,
    pub max: Option<i32>,
    pub group: String,
    /// `None` where the models are no line of descent.
    pub since: Option<usize>,
    /// Models that have it, empty for all of the file.
    pub models: Vec<usize>,
    pub page: Option<u16>,
    pub note: String,
    pub reading: String,
    pub trust: usize,
}

impl Row {
    /// The first address after the row.
    pub fn end(&self) -> u32 {
        u32::from(self.address) + u32::from(self.words)
    }

    /// True for reserved and spare words.
    pub fn is_reserved(&self) -> bool {
        self.kind.variant == "Reserved"
    }

    /// True if the row may be written.
    pub fn is_writable(&self) -> bool {
        ACCESS.get(self.access).is_some_and(|a| a.0 != "r")
    }
}

/// An exact factor: `0.1` is 1/10 with one decimal.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    pub num: u32,
    pub den: u32,
    pub decimals: usize,
}

/// A line of `enums.csv` or `bits.csv`.
#[derive(Debug)]
pub struct Member {
    pub at: At,
    pub set: String,
    pub bits: bool,
    pub value: u16,
    /// Last code of a run, otherwise the same.
    pub last: u16,
    pub key: String,
    pub label: String,
    pub zero: String,
    pub one: String,
}

/// A line of `readings.csv`.
#[derive(Debug)]
pub struct Reading {
    pub at: At,
    pub id: String,
    pub settled: usize,
    pub text: String,
}

/// What a type in a data file stands for.
#[derive(Debug)]
pub struct Kind {
    /// The word in the data file.
    pub key: &'static str,
    /// Name in `map::Kind`.
    pub variant: &'static str,
    /// Fewest and most words.
    pub words: (u16, u16),
    /// Raw values that it can hold, `None` where a range means nothing.
    pub range: Option<(i64, i64)>,
    /// True if scale and unit mean something.
    pub number: bool,
}

const fn kind(
    key: &'static str,
    variant: &'static str,
    words: (u16, u16),
    range: Option<(i64, i64)>,
    number: bool,
) -> Kind {
    Kind {
        key,
        variant,
        words,
        range,
        number,
    }
}

const WORD: Option<(i64, i64)> = Some((0, 0xFFFF));
const ANY: u16 = u16::MAX;

/// All types, in the order of `map::Kind`.
pub static KINDS: [Kind; 14] = [
    kind("bool", "Bool", (1, 1), Some((0, 1)), false),
    kind("u16", "U16", (1, 1), WORD, true),
    kind("i16", "I16", (1, 1), Some((-0x8000, 0x7FFF)), true),
    kind("u32", "U32", (2, 2), Some((0, 0xFFFF_FFFF)), true),
    kind("enum", "Enum", (1, 1), WORD, false),
    kind("bits", "Bits", (1, 2), WORD, false),
    kind("bcd-date", "BcdDate", (2, 2), None, false),
    kind("bcd-time", "BcdTime", (2, 2), None, false),
    kind("ascii", "Ascii", (1, ANY), None, false),
    kind("torque", "Torque", (4, 4), None, false),
    kind("ascii7", "Ascii7", (4, 4), None, false),
    kind("curve", "Curve", (64, 64), None, false),
    kind("hex", "Hex", (1, ANY), WORD, false),
    kind("reserved", "Reserved", (1, ANY), None, false),
];

/// A word of the data files and its name in the crate.
pub type Word = (&'static str, &'static str);

/// The tables, in the order in which maps are listed.
pub const TABLES: &[Word] = &[
    ("coil", "Coil"),
    ("discrete", "Discrete"),
    ("input", "Input"),
    ("holding", "Holding"),
];
/// Who may write.
pub const ACCESS: &[Word] = &[
    ("r", "Read"),
    ("rw", "Write"),
    ("rw!", "WriteGuarded"),
    ("w!", "WriteOnly"),
];
/// Whether a map is all that its device has.
pub const EXTENTS: &[Word] = &[("whole", "true"), ("part", "false")];
/// User levels.
pub const LEVELS: &[Word] = &[
    ("observer", "Observer"),
    ("user", "User"),
    ("service", "Service"),
    ("manufacturer", "Manufacturer"),
];
/// How far a row can be trusted.
pub const TRUST: &[Word] = &[
    ("manual", "Manual"),
    ("reading", "Reading"),
    ("inferred", "Inferred"),
];
/// How certain a reading is.
pub const SETTLED: &[Word] = &[("yes", "Yes"), ("likely", "Likely"), ("no", "No")];
/// Units as they are printed beside a value.
pub const UNITS: &[&str] = &["", "%", "s", "h", "d", "°C", "V", "A", "mA", "kW", "rpm"];
