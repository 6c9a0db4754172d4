//! Data files → records. A cell that cannot be read is a problem of rule R00, never a panic.

use std::fs;
use std::io;
use std::path::Path;
use std::str::FromStr;

use crate::types::{
    ACCESS, At, Data, Device, Doc, EXTENTS, File, Function, KINDS, LEVELS, Member, Model, Problem,
    Reading, Row, SETTLED, Scale, TABLES, TRUST, Word,
};

/// Reads `SOURCES.md` and every folder that has a `models.csv`.
pub fn all(root: &Path) -> io::Result<(Data, Vec<Problem>)> {
    let mut data = Data {
        docs: docs(&fs::read_to_string(root.join("SOURCES.md"))?),
        devices: vec![],
    };
    let mut problems = Vec::new();
    let mut folders = fs::read_dir(root)?
        .map(|entry| entry.map(|e| e.path()))
        .collect::<io::Result<Vec<_>>>()?;
    folders.sort();
    for folder in folders.iter().filter(|f| f.join("models.csv").is_file()) {
        data.devices.push(device(folder, &mut problems)?);
    }
    Ok((data, problems))
}

/// The table lines whose first cell is a key in backticks.
fn docs(text: &str) -> Vec<Doc> {
    text.lines()
        .filter_map(|line| {
            let mut cells = line.trim_matches('|').split('|').map(str::trim);
            let key = cells
                .next()?
                .strip_prefix('`')?
                .strip_suffix('`')?
                .to_owned();
            Some(Doc {
                key,
                name: cells.next()?.to_owned(),
            })
        })
        .collect()
}

fn device(folder: &Path, problems: &mut Vec<Problem>) -> io::Result<Device> {
    let key = folder
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    let mut d = Device {
        key,
        ..Device::default()
    };
    for line in Line::all(&folder.join("models.csv"), problems)? {
        d.models.push(Model {
            key: line.text("key", problems),
            name: line.text("name", problems),
            absent: line.text("absent", problems),
            part: line.text("part", problems),
            reading: line.text("reading", problems),
            extent: line.word("extent", EXTENTS, problems),
            units: line.number("units", problems),
            at: line.at,
        });
    }
    for line in Line::all(&folder.join("functions.csv"), problems)? {
        d.functions.push(function(line, &d.models, problems));
    }
    for line in Line::all(&folder.join("files.csv"), problems)? {
        d.files.push(File {
            file: line.text("file", problems),
            table: line.word("table", TABLES, problems),
            first: line.model("first", &d.models, problems),
            last: line.model("last", &d.models, problems),
            doc: line.text("doc", problems),
            part: line.text("part", problems),
            at: line.at,
        });
    }
    for (file, name) in d.files.iter().map(|f| &f.file).enumerate() {
        for line in Line::all(&folder.join(name), problems)? {
            d.rows.push(row(line, file, &d.models, problems));
        }
    }
    for (name, bits) in [("enums.csv", false), ("bits.csv", true)] {
        for line in Line::all(&folder.join(name), problems)? {
            let column = if bits { "bit" } else { "value" };
            let (value, last) = line.parsed(column, codes, problems);
            d.members.push(Member {
                set: line.text("set", problems),
                bits,
                value,
                last,
                key: line.text("key", problems),
                label: line.text("label", problems),
                zero: if bits {
                    line.text("zero", problems)
                } else {
                    String::new()
                },
                one: if bits {
                    line.text("one", problems)
                } else {
                    String::new()
                },
                at: line.at,
            });
        }
    }
    for line in Line::all(&folder.join("readings.csv"), problems)? {
        d.readings.push(Reading {
            id: line.text("id", problems),
            settled: line.word("settled", SETTLED, problems),
            text: line.text("text", problems),
            at: line.at,
        });
    }
    Ok(d)
}

fn function(line: Line, models: &[Model], problems: &mut Vec<Problem>) -> Function {
    Function {
        code: line.number("function", problems),
        sub: line.optional("sub", |cell| cell.parse().ok(), problems),
        label: line.text("label", problems),
        first: line.model("first", models, problems),
        last: line.model("last", models, problems),
        doc: line.text("doc", problems),
        part: line.text("part", problems),
        page: line.optional("page", |cell| cell.parse().ok(), problems),
        note: line.text("note", problems),
        reading: line.text("reading", problems),
        at: line.at,
    }
}

/// `5`, or `19200-19300` for a run of codes.
fn codes(cell: &str) -> Option<(u16, u16)> {
    let (first, last) = cell.split_once('-').unwrap_or((cell, cell));
    Some((first.parse().ok()?, last.parse().ok()?))
}

fn row(line: Line, file: usize, models: &[Model], problems: &mut Vec<Problem>) -> Row {
    let kind = line.text("type", problems);
    let kind = KINDS.iter().find(|k| k.key == kind).unwrap_or_else(|| {
        problems.push(line.unreadable("type", &kind));
        &KINDS[0]
    });
    // Models are a line of descent, or each row says which it belongs to.
    let listed = line.has("models");
    Row {
        file,
        address: line.number("address", problems),
        words: line.number("words", problems),
        key: line.text("key", problems),
        label: line.text("label", problems),
        kind,
        scale: line.optional("scale", scale, problems),
        unit: line.text("unit", problems),
        set: line.text("set", problems),
        access: line.word("access", ACCESS, problems),
        level: line.optional(
            "level",
            |cell| LEVELS.iter().position(|l| l.0 == cell),
            problems,
        ),
        min: line.optional("min", |cell| cell.parse().ok(), problems),
        max: line.optional("max", |cell| cell.parse().ok(), problems),
        group: line.text("group", problems),
        since: (!listed).then(|| line.model("since", models, problems)),
        models: if listed {
            line.models("models", models, problems)
        } else {
            Vec::new()
        },
        page: line.optional("page", |cell| cell.parse().ok(), problems),
        note: line.text("note", problems),
        reading: line.text("reading", problems),
        trust: line.word("trust", TRUST, problems),
        at: line.at,
    }
}

/// `0.1` is 1/10, `100/4095` is shown with two decimals.
pub fn scale(cell: &str) -> Option<Scale> {
    if let Some((num, den)) = cell.split_once('/') {
        return Some(Scale {
            num: num.parse().ok()?,
            den: den.parse().ok()?,
            decimals: 2,
        });
    }
    let (whole, fraction) = cell.split_once('.').unwrap_or((cell, ""));
    let num = format!("{whole}{fraction}").parse().ok()?;
    let den = 10_u32.checked_pow(u32::try_from(fraction.len()).ok()?)?;
    Some(Scale {
        num,
        den,
        decimals: fraction.len(),
    })
}

/// One line of a CSV file with the names of its columns.
struct Line {
    at: At,
    header: csv::StringRecord,
    cells: csv::StringRecord,
}

impl Line {
    /// The lines of a file. One with too few or too many cells is a problem and left out.
    fn all(path: &Path, problems: &mut Vec<Problem>) -> io::Result<Vec<Self>> {
        let file = path.to_string_lossy().into_owned();
        let named = |e: csv::Error| io::Error::other(format!("{file}: {e}"));
        let mut reader = csv::Reader::from_path(path).map_err(named)?;
        let header = reader.headers().map_err(named)?.clone();
        let mut lines = Vec::new();
        for cells in reader.records() {
            let position = match &cells {
                Ok(cells) => cells.position(),
                Err(error) => error.position(),
            };
            let at = At {
                file: file.clone(),
                line: position.map_or(0, csv::Position::line),
            };
            match cells {
                Ok(cells) => lines.push(Self {
                    at,
                    header: header.clone(),
                    cells,
                }),
                Err(error) => problems.push(Problem {
                    at,
                    rule: "R00",
                    text: error.to_string(),
                }),
            }
        }
        Ok(lines)
    }

    fn unreadable(&self, column: &str, cell: &str) -> Problem {
        let text = format!("column {column}: cannot read {cell:?}");
        Problem {
            at: self.at.clone(),
            rule: "R00",
            text,
        }
    }

    fn text(&self, column: &str, problems: &mut Vec<Problem>) -> String {
        let position = self.header.iter().position(|name| name == column);
        position.and_then(|i| self.cells.get(i)).map_or_else(
            || {
                let text = format!("no column {column}");
                problems.push(Problem {
                    at: self.at.clone(),
                    rule: "R00",
                    text,
                });
                String::new()
            },
            str::to_owned,
        )
    }

    fn optional<T>(
        &self,
        column: &str,
        parse: impl Fn(&str) -> Option<T>,
        problems: &mut Vec<Problem>,
    ) -> Option<T> {
        let cell = self.text(column, problems);
        if cell.is_empty() {
            return None;
        }
        let value = parse(&cell);
        if value.is_none() {
            problems.push(self.unreadable(column, &cell));
        }
        value
    }

    fn number<T: FromStr + Default>(&self, column: &str, problems: &mut Vec<Problem>) -> T {
        self.parsed(column, |cell| cell.parse().ok(), problems)
    }

    fn parsed<T: Default>(
        &self,
        column: &str,
        parse: impl Fn(&str) -> Option<T>,
        problems: &mut Vec<Problem>,
    ) -> T {
        let cell = self.text(column, problems);
        parse(&cell).unwrap_or_else(|| {
            problems.push(self.unreadable(column, &cell));
            T::default()
        })
    }

    fn has(&self, column: &str) -> bool {
        self.header.iter().any(|name| name == column)
    }

    /// Positions of the models that a cell lists.
    fn models(&self, column: &str, models: &[Model], problems: &mut Vec<Problem>) -> Vec<usize> {
        let cell = self.text(column, problems);
        let known = |key: &str| models.iter().position(|m| m.key == key);
        let found: Vec<_> = cell.split_whitespace().filter_map(known).collect();
        if found.len() != cell.split_whitespace().count() {
            problems.push(self.unreadable(column, &cell));
        }
        found
    }

    /// Position of the cell in a list of words.
    fn word(&self, column: &str, words: &[Word], problems: &mut Vec<Problem>) -> usize {
        self.position(column, words.iter().map(|w| w.0), problems)
    }

    /// Position of the cell among the models.
    fn model(&self, column: &str, models: &[Model], problems: &mut Vec<Problem>) -> usize {
        self.position(column, models.iter().map(|m| m.key.as_str()), problems)
    }

    fn position<'a>(
        &self,
        column: &str,
        mut words: impl Iterator<Item = &'a str>,
        problems: &mut Vec<Problem>,
    ) -> usize {
        let cell = self.text(column, problems);
        words.position(|w| w == cell).unwrap_or_else(|| {
            problems.push(self.unreadable(column, &cell));
            0
        })
    }
}
