//! `data/hart` → records → rules → `hart.rs`.

mod data;
mod emit;
mod rules;
mod sets;
mod status;

pub use data::Data;
pub use emit::emit;
pub use rules::check;

use std::path::Path;
use std::{fs, io};

use serde::de::DeserializeOwned;

use crate::types::{At, Problem};

/// Reads all files. What cannot be read is a problem of rule R00.
pub fn read(root: &Path, problems: &mut Vec<Problem>) -> io::Result<Data> {
    let folder = root.join("hart");
    let path = folder.join("commands.toml");
    let mut data = Data {
        text: fs::read_to_string(&path)?,
        files: table(&folder.join("files.csv"), problems)?,
        sets: table(&folder.join("sets.csv"), problems)?,
        codes: table(&folder.join("enums.csv"), problems)?,
        bits: table(&folder.join("bits.csv"), problems)?,
        status: table(&folder.join("status.csv"), problems)?,
        families: table(&folder.join("families.csv"), problems)?,
        units: table(&folder.join("units.csv"), problems)?,
        makers: table(&folder.join("manufacturers.csv"), problems)?,
        responses: table(&folder.join("response_codes.csv"), problems)?,
        timers: table(&folder.join("timers.csv"), problems)?,
        presets: table(&folder.join("presets.csv"), problems)?,
        readings: table(&folder.join("readings.csv"), problems)?,
        ..Data::default()
    };
    match toml::from_str(&data.text) {
        Ok(commands) => data.commands = commands,
        Err(error) => problems.push(Problem {
            at: data.at(error.span().map_or(0, |span| span.start)),
            rule: "R00",
            text: error.message().to_owned(),
        }),
    }
    Ok(data)
}

impl Data {
    /// The line of the file of commands in which a byte stands.
    pub fn at(&self, offset: usize) -> At {
        let before = self.text.get(..offset).unwrap_or(&self.text);
        At {
            file: "data/hart/commands.toml".to_owned(),
            line: before.bytes().filter(|b| *b == b'\n').count() as u64 + 1,
        }
    }
}

/// The lines of a file with their places.
pub fn table<T: DeserializeOwned>(
    path: &Path,
    problems: &mut Vec<Problem>,
) -> io::Result<Vec<(At, T)>> {
    let file = path.to_string_lossy().into_owned();
    let mut reader = csv::Reader::from_path(path).map_err(io::Error::other)?;
    let header = reader.headers().map_err(io::Error::other)?.clone();
    let mut rows = Vec::new();
    for line in reader.records() {
        let position = match &line {
            Ok(cells) => cells.position(),
            Err(error) => error.position(),
        };
        let at = At {
            file: file.clone(),
            line: position.map_or(0, csv::Position::line),
        };
        match line.and_then(|cells| cells.deserialize(Some(&header))) {
            Ok(row) => rows.push((at, row)),
            Err(error) => problems.push(Problem {
                at,
                rule: "R00",
                text: error.to_string(),
            }),
        }
    }
    Ok(rows)
}
