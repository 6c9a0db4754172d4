//! A strict little reader of separated values (RFC 4180) that remembers where each cell stands.

use super::TagProblem;

/// A cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    /// Its text, without the quotes around it.
    pub text: String,
    /// Line where it begins, from 1.
    pub line: u32,
    /// Column where it begins, in characters from 1.
    pub column: u32,
}

/// The separator: the one of comma, semicolon and tab that the first line has most of.
fn separator(text: &str) -> char {
    let first = text.lines().next().unwrap_or("");
    let count = |mark: char| first.chars().filter(|c| *c == mark).count();
    // The last of equals wins, so the comma stands last.
    [';', '\t', ',']
        .into_iter()
        .max_by_key(|mark| count(*mark))
        .unwrap_or(',')
}

/// All lines that are not empty, as cells.
pub(super) fn rows(text: &str, problems: &mut Vec<TagProblem>) -> Vec<Vec<Cell>> {
    let mark = separator(text);
    let (mut line, mut column) = (1_u32, 0_u32);
    let mut rows = Vec::new();
    let mut row: Vec<Cell> = Vec::new();
    let mut cell = Cell {
        text: String::new(),
        line: 1,
        column: 1,
    };
    let (mut quoted, mut closed) = (false, false);
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        column = column.saturating_add(1);
        let problem = |text: &str| TagProblem {
            line,
            column,
            text: text.to_owned(),
        };
        if quoted {
            if c == '\n' {
                line = line.saturating_add(1);
                column = 0;
            }
            if c != '"' {
                cell.text.push(c);
            } else if rest.peek() == Some(&'"') {
                rest.next();
                column = column.saturating_add(1);
                cell.text.push('"');
            } else {
                (quoted, closed) = (false, true);
            }
        } else if c == mark || c == '\n' {
            let next = Cell {
                text: String::new(),
                line,
                column: column.saturating_add(1),
            };
            row.push(core::mem::replace(&mut cell, next));
            closed = false;
            if c == '\n' {
                push(&mut rows, core::mem::take(&mut row));
                line = line.saturating_add(1);
                column = 0;
                (cell.line, cell.column) = (line, 1);
            }
        } else if c == '\r' {
            // Part of a line end.
        } else if c == '"' && cell.text.trim().is_empty() && !closed {
            cell.text.clear();
            quoted = true;
        } else if closed && !c.is_whitespace() {
            problems.push(problem(
                "text after the closing quote; a quote within quotes is written twice.",
            ));
            closed = false;
            cell.text.push(c);
        } else if !closed {
            cell.text.push(c);
        }
    }
    if quoted {
        problems.push(TagProblem {
            line: cell.line,
            column: cell.column,
            text: "the quote is never closed.".to_owned(),
        });
    }
    row.push(cell);
    push(&mut rows, row);
    rows
}

/// Leaves out lines of nothing.
fn push(rows: &mut Vec<Vec<Cell>>, row: Vec<Cell>) {
    if row.iter().any(|c| !c.text.trim().is_empty()) {
        rows.push(row);
    }
}
