//! `data/dop/objects.toml` → records → rules → `dop.rs`.

mod data;
mod emit;
mod fields;
mod names;
mod place;
mod rules;

pub use emit::emit;
pub use rules::check;

use std::path::Path;
use std::{fs, io};

use crate::types::{At, Problem};

/// A file of objects with the places of its lines.
#[derive(Debug, Default)]
pub struct Objects {
    pub file: String,
    pub text: String,
    pub data: data::Data,
}

impl Objects {
    /// The line in which a byte stands.
    pub fn at(&self, offset: usize) -> At {
        let before = self.text.get(..offset).unwrap_or(&self.text);
        At {
            file: self.file.clone(),
            line: before.bytes().filter(|b| *b == b'\n').count() as u64 + 1,
        }
    }
}

/// Reads the file. What cannot be read is a problem of rule R00.
pub fn read(root: &Path, problems: &mut Vec<Problem>) -> io::Result<Objects> {
    let path = root.join("dop").join("objects.toml");
    let mut objects = Objects {
        file: path.to_string_lossy().into_owned(),
        text: fs::read_to_string(&path)?,
        data: data::Data::default(),
    };
    match toml::from_str(&objects.text) {
        Ok(data) => objects.data = data,
        Err(error) => problems.push(Problem {
            at: objects.at(error.span().map_or(0, |span| span.start)),
            rule: "R00",
            text: error.message().to_owned(),
        }),
    }
    Ok(objects)
}
