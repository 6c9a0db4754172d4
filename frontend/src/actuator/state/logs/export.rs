//! A log as a file for other programs.

use super::{Row, Table};
use crate::chart::table::quote;
use crate::chart::time::stamp;
use crate::state::json::quoted;

/// A time of the device for programs: `2024-02-29T00:00:00`, without a zone, because none is told.
fn iso(seconds: i64) -> String {
    stamp(seconds).replace(' ', "T")
}

/// Rows as comma-separated values with a head line. `offset` is what the clock of the device is
/// ahead of UTC.
#[must_use]
pub fn csv(table: &Table, rows: &[usize], offset: Option<i64>) -> String {
    let mut out = String::from(if table.has_times() {
        "number,device_time,utc"
    } else {
        "record"
    });
    for name in table.names() {
        out.push(',');
        quote(&mut out, &name);
    }
    out.push_str(",raw\n");
    for row in rows.iter().filter_map(|at| table.rows.get(*at)) {
        out.push_str(&row.number.to_string());
        if table.has_times() {
            out.push(',');
            out.push_str(&row.time.map(iso).unwrap_or_default());
            out.push(',');
            if let (Some(time), Some(offset)) = (row.time, offset) {
                out.push_str(&format!("{}Z", iso(time - offset)));
            }
        }
        for cell in &row.cells {
            out.push(',');
            quote(&mut out, cell.as_ref().map_or("", |c| &c.text));
        }
        out.push(',');
        quote(&mut out, &raw(table, row));
        out.push('\n');
    }
    out
}

/// The words of the cells of a row; those of a file that is not described are the same in each.
fn raw(table: &Table, row: &Row) -> String {
    let cells = row.cells.iter().flatten().map(|c| c.raw.as_str());
    if table.columns.is_empty() {
        return cells.take(1).collect();
    }
    cells.collect::<Vec<_>>().join(" ")
}

/// Rows as a JSON list, one object a line.
#[must_use]
pub fn json(table: &Table, rows: &[usize], offset: Option<i64>) -> String {
    let mut out = String::from("[");
    let rows = rows.iter().filter_map(|at| table.rows.get(*at));
    for (n, row) in rows.enumerate() {
        out.push_str(if n == 0 { "\n" } else { ",\n" });
        out.push_str(&format!(" {{\"number\":{}", row.number));
        let time = |out: &mut String, name: &str, time: Option<String>| {
            out.push_str(&format!(",\"{name}\":"));
            match time {
                Some(time) => quoted(out, &time),
                None => out.push_str("null"),
            }
        };
        if table.has_times() {
            time(&mut out, "device_time", row.time.map(iso));
            let utc = row
                .time
                .zip(offset)
                .map(|(t, o)| format!("{}Z", iso(t - o)));
            time(&mut out, "utc", utc);
        }
        let keys = ["hex", "unsigned", "signed", "characters"];
        for (at, cell) in row.cells.iter().enumerate() {
            let key = table.columns.get(at).map_or(keys[at.min(3)], |f| f.key);
            time(&mut out, key, cell.as_ref().map(|c| c.text.clone()));
            if let Some(number) = cell.as_ref().and_then(|c| c.number) {
                out.push_str(&format!(",\"{key}_raw\":{number}"));
            }
        }
        time(&mut out, "raw", Some(raw(table, row)));
        out.push('}');
    }
    out.push_str("\n]\n");
    out
}
