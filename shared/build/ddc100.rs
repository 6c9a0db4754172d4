//! `data/ddc100/*_times.csv` → records → rules → `ddc100.rs`.
//!
//! | Rule | Demands |
//! |---|---|
//! | R00 | the files can be read |
//! | R60 | table 4.1 grows from line to line, in registers and in both times, and has three lines |
//! | R61 | table 4.2 has each number of units with the registers of table 4.1, in order, once |
//! | R62 | a printed time is a decimal number of seconds above 0 |

use std::fmt::Write;
use std::io;
use std::path::Path;

use serde::Deserialize;
use serde::de::DeserializeOwned;

use crate::rules::Findings;
use crate::types::{At, Problem};

/// A line of table 4.1; times in milliseconds.
#[derive(Debug, Deserialize)]
struct Response {
    registers: u16,
    mx: u32,
    uec: u32,
    page: u16,
    reading: String,
}

/// A cell pair of table 4.2; times in seconds as printed.
#[derive(Debug, Deserialize)]
struct Scan {
    units: u16,
    registers: u16,
    mx: String,
    uec: String,
    page: u16,
    reading: String,
}

/// Both tables.
#[derive(Debug)]
pub struct Times {
    responses: Vec<(At, Response)>,
    scans: Vec<(At, Scan)>,
}

impl Times {
    /// The readings that lines rest on.
    pub fn cited(&self) -> Vec<(At, String)> {
        let responses = self.responses.iter().map(|(at, r)| (at, &r.reading));
        let scans = self.scans.iter().map(|(at, s)| (at, &s.reading));
        responses
            .chain(scans)
            .map(|(at, id)| (at.clone(), id.clone()))
            .collect()
    }
}

/// Reads both files.
pub fn read(root: &Path, problems: &mut Vec<Problem>) -> io::Result<Times> {
    let folder = root.join("ddc100");
    Ok(Times {
        responses: table(&folder.join("response_times.csv"), problems)?,
        scans: table(&folder.join("scan_times.csv"), problems)?,
    })
}

/// The lines of a file with their places.
fn table<T: DeserializeOwned>(
    path: &Path,
    problems: &mut Vec<Problem>,
) -> io::Result<Vec<(At, T)>> {
    let mut reader = csv::Reader::from_path(path).map_err(io::Error::other)?;
    let mut rows = Vec::new();
    for (line, row) in (2..).zip(reader.deserialize()) {
        let at = At {
            file: path.to_string_lossy().into_owned(),
            line,
        };
        match row {
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

/// Milliseconds of a printed number of seconds.
fn millis(printed: &str) -> Option<u32> {
    let (whole, part) = printed.split_once('.').unwrap_or((printed, "0"));
    let whole: u32 = if whole.is_empty() {
        0
    } else {
        whole.parse().ok()?
    };
    if part.len() > 3 || !part.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    let part: u32 = format!("{part:0<3}").parse().ok()?;
    Some(whole * 1000 + part).filter(|ms| *ms > 0)
}

/// Half a unit of the last printed digit, in milliseconds.
fn rounding(printed: &str) -> u32 {
    let digits = printed.split_once('.').map_or(0, |(_, part)| part.len());
    [500, 50, 5].get(digits).copied().unwrap_or(0)
}

/// Checks all rules.
pub fn check(times: &Times) -> Vec<Problem> {
    let mut found = Findings::default();
    for pair in times.responses.windows(2) {
        if let [(_, a), (at, b)] = pair {
            let grows = a.registers < b.registers && a.mx < b.mx && a.uec < b.uec;
            found.unless(grows, "R60", at, "does not grow");
        }
    }
    let first = times.responses.first().map(|(at, _)| at.clone());
    let at = first.unwrap_or_default();
    let three = times.responses.len() == 3;
    found.unless(three, "R60", &at, "the table has three lines");
    let mut before = 0;
    for lines in times.scans.chunks(times.responses.len().max(1)) {
        for ((at, scan), (_, response)) in lines.iter().zip(&times.responses) {
            let same = lines.iter().all(|(_, s)| s.units == scan.units);
            found.unless(same && scan.units > before, "R61", at, "units out of order");
            let text = "registers are not those of table 4.1";
            found.unless(scan.registers == response.registers, "R61", at, text);
            for printed in [&scan.mx, &scan.uec] {
                let text = format!("{printed:?} is no time");
                found.unless(millis(printed).is_some(), "R62", at, text);
            }
        }
        before = lines.first().map_or(before, |(_, s)| s.units);
    }
    found.into()
}

/// The text of `ddc100.rs`.
pub fn emit(times: &Times) -> String {
    let mut out = String::from("// Written by shared/build.rs from shared/data/ddc100.\n\n");
    let count = times.responses.len();
    // Writing to a String cannot fail.
    let _ = writeln!(
        out,
        "/// Table 4.1: average time of query and answer.\npub static RESPONSE_TIMES: [ResponseTime; {count}] = ["
    );
    for (_, r) in &times.responses {
        let _ = writeln!(
            out,
            "    ResponseTime {{ registers: {}, mx_us: {}, uec_us: {}, page: {} }},",
            r.registers,
            r.mx * 1000,
            r.uec * 1000,
            r.page
        );
    }
    let count = times.scans.len();
    let _ = writeln!(
        out,
        "];\n\n/// Table 4.2: average scan time of a network.\npub static SCAN_TIMES: [ScanTime; {count}] = ["
    );
    let printed = |text: &str| {
        format!(
            "Printed {{ text: {text:?}, us: {}, rounding_us: {} }}",
            millis(text).unwrap_or(0) * 1000,
            rounding(text) * 1000
        )
    };
    for (_, s) in &times.scans {
        let _ = writeln!(
            out,
            "    ScanTime {{ units: {}, registers: {}, mx: {}, uec: {}, page: {} }},",
            s.units,
            s.registers,
            printed(&s.mx),
            printed(&s.uec),
            s.page
        );
    }
    out.push_str("];\n");
    out
}
