//! Tables of a spreadsheet or a log: one register a line, in a column of its own.

use super::{Form, Input, InputProblem, decimal, hex_digits, quoted, word};

/// Names of a column of values, the best first.
const NAMES: [&str; 7] = [
    "value",
    "raw",
    "hex",
    "dec",
    "data",
    "register value",
    "word",
];

/// A cell with the column at which it begins.
type Cell<'a> = (u32, &'a str);

/// Reads a table; `None` if the text is none. With `wanted`, one column is enough.
pub(super) fn read(text: &str, wanted: bool) -> Option<Input> {
    let mark = [';', '\t', ','].into_iter().find(|c| text.contains(*c));
    let lines: Vec<(u32, Vec<Cell<'_>>)> = (1_u32..)
        .zip(text.lines())
        .filter(|(_, line)| !line.trim().is_empty() && !line.trim_start().starts_with('#'))
        .map(|(number, line)| (number, cells(line, mark)))
        .collect();
    let ((_, first), rest) = lines.split_first()?;
    let named = column(first);
    let (column, rows, why) = if let Some(column) = named {
        let (_, name) = first.get(column)?;
        (column, rest, format!("column {}", quoted(name)))
    } else if counts_up(&lines) {
        let why = "the second column; the first counts up".to_owned();
        (1, lines.as_slice(), why)
    } else if wanted {
        let last = first.len().checked_sub(1)?;
        (last, lines.as_slice(), "the last column".to_owned())
    } else {
        return None;
    };
    // A column of hexadecimal numbers shows it by a mark or a letter in any of its cells.
    let values = || {
        rows.iter()
            .filter_map(|(_, cells)| cells.get(column).map(|(_, text)| *text))
    };
    let hex = named
        .and_then(|_| first.get(column))
        .is_some_and(|(_, name)| name.to_ascii_lowercase().contains("hex"))
        || values().any(|text| {
            hex_digits(text).is_some_and(|(digits, marked)| {
                marked || digits.bytes().any(|b| b.is_ascii_alphabetic())
            })
        });
    let mut words = Vec::with_capacity(rows.len());
    let mut problems = Vec::new();
    for (line, cells) in rows {
        let (at, cell) = cells.get(column).copied().unwrap_or((1, ""));
        let value = match hex_digits(cell) {
            Some((digits, _)) if hex && digits.len() <= 4 => Some(word(digits.as_bytes())),
            _ if hex => None,
            _ => decimal(cell),
        };
        match value {
            Some(value) => words.push(value),
            None => problems.push(InputProblem {
                line: *line,
                column: at,
                at: words.len(),
                text: format!("{} is no register; the line is left out.", quoted(cell)),
            }),
        }
    }
    if words.is_empty() && problems.is_empty() {
        problems.push(super::nothing());
    }
    let writing = if hex { "hexadecimal" } else { "decimal" };
    Some(Input {
        words,
        form: Form::Table,
        said: format!("Read as a table ({why}, {writing})."),
        problems,
    })
}

fn cells(line: &str, mark: Option<char>) -> Vec<Cell<'_>> {
    let mut start = 0_usize;
    let mut cells = Vec::new();
    let parts: Vec<&str> = match mark {
        Some(mark) => line.split(mark).collect(),
        None => vec![line],
    };
    for part in parts {
        let column = u32::try_from(start).unwrap_or(u32::MAX).saturating_add(1);
        cells.push((column, part.trim().trim_matches('"').trim()));
        start = start.saturating_add(part.len()).saturating_add(1);
    }
    cells
}

/// The column of values, if the cells are the names of columns.
fn column(cells: &[Cell<'_>]) -> Option<usize> {
    // `dec` alone is a register as well as a name.
    if cells.iter().all(|(_, name)| hex_digits(name).is_some()) {
        return None;
    }
    let names: Vec<String> = cells
        .iter()
        .map(|(_, name)| name.to_ascii_lowercase())
        .collect();
    NAMES.iter().find_map(|wanted| {
        names.iter().position(|name| name == wanted).or_else(|| {
            // `Value (hex)`, `raw_value`.
            let begins = |name: &str| {
                let rest = name.strip_prefix(wanted)?;
                rest.starts_with(|c: char| !c.is_ascii_alphanumeric())
                    .then_some(())
            };
            names.iter().position(|name| begins(name).is_some())
        })
    })
}

/// True if there are two columns and the first counts registers.
fn counts_up(lines: &[(u32, Vec<Cell<'_>>)]) -> bool {
    let addresses: Option<Vec<u32>> = lines
        .iter()
        .map(|(_, cells)| match cells.as_slice() {
            [(_, address), (_, value)] if !value.is_empty() => address.parse().ok(),
            _ => None,
        })
        .collect();
    addresses.is_some_and(|addresses| {
        addresses.len() > 1
            && addresses
                .windows(2)
                .all(|pair| matches!(pair, [a, b] if a.checked_add(1) == Some(*b)))
    })
}
