//! `data/icon3000/record_*.csv`, `mirrors.csv` and `health.csv` → records → rules → `icon3000.rs`.

mod data;
mod emit;
mod rules;

pub use data::Data;
pub use emit::emit;
pub use rules::check;

use std::io;
use std::path::Path;

use crate::hart::table;
use crate::types::Problem;

/// Reads all files. What cannot be read is a problem of rule R00.
pub fn read(root: &Path, problems: &mut Vec<Problem>) -> io::Result<Data> {
    let folder = root.join("icon3000");
    Ok(Data {
        files: table(&folder.join("record_files.csv"), problems)?,
        fields: table(&folder.join("record_fields.csv"), problems)?,
        codes: table(&folder.join("record_enums.csv"), problems)?,
        readings: table(&folder.join("record_readings.csv"), problems)?,
        mirrors: table(&folder.join("mirrors.csv"), problems)?,
        health: table(&folder.join("health.csv"), problems)?,
    })
}
