//! An object as people read it: what was taken for what, what is wrong, then register by register.

use serde_json::json;
use shared::dop::input::{Input, InputProblem};
use shared::dop::profile::Profile;
use shared::dop::{Candidate, ObjectRead, Request};
use shared::problem::Severity;
use shared::tree::{Decoded, Field, Name};
use shared::value::{Quality, Value};
use std::fmt::{self, Write};

/// Registers of a field that are shown; longer ones are cut.
const SHOWN: usize = 4;

/// Escape sequences around text of a kind, empty without colour.
fn paint(colour: bool, code: &'static str) -> (&'static str, &'static str) {
    if colour { (code, "\x1b[0m") } else { ("", "") }
}

/// What the text was taken for, and what in it is no register.
pub(super) fn write_input(out: &mut String, colour: bool, input: &Input) -> fmt::Result {
    let (on, off) = paint(colour, "\x1b[31m");
    let registers = match input.words.len() {
        1 => "1 register".to_owned(),
        n => format!("{n} registers"),
    };
    writeln!(out, "{} {registers}.", input.said)?;
    for problem in &input.problems {
        writeln!(
            out,
            "{on}error{off} in line {}, column {}: {}",
            problem.line, problem.column, problem.text
        )?;
    }
    Ok(())
}

/// A problem of the text as a line of JSON.
pub(super) fn write_input_json(out: &mut String, problem: &InputProblem) -> fmt::Result {
    let line = json!({
        "kind": "input",
        "line": problem.line,
        "column": problem.column,
        "register": problem.at,
        "severity": "error",
        "text": problem.text,
    });
    writeln!(out, "{line}")
}

/// The request, if all candidates read the same object in the same layout.
pub(super) fn only(found: &[Candidate]) -> Option<Request> {
    let first = found.first()?;
    let same = |c: &Candidate| std::ptr::eq(c.layout, first.layout);
    found.iter().all(same).then_some(first.request)
}

/// The requests that so many registers can answer.
pub(super) fn write_candidates(
    out: &mut String,
    found: &[Candidate],
    words: &[u16],
    profile: &Profile,
) -> fmt::Result {
    if found.is_empty() {
        return writeln!(
            out,
            "No object has {} registers. Give the request word with --request.",
            words.len()
        );
    }
    writeln!(out, "So many registers can be the answer to:")?;
    for candidate in found {
        let read = ObjectRead::read(candidate.request, words, profile);
        write!(
            out,
            "  {}  {}",
            candidate.request,
            title(Some(candidate.object.label), Some(candidate.choice.label))
        )?;
        if !std::ptr::eq(candidate.layout, candidate.choice.layout) {
            write!(out, " (as {})", candidate.layout.key)?;
        }
        let (good, all) = read.plausible_times();
        if good < all {
            write!(
                out,
                " ({} of {all} times would be impossible)",
                all.saturating_sub(good)
            )?;
        }
        out.push('\n');
    }
    if only(found).is_none() {
        writeln!(out, "Choose one with --request.")?;
    } else if found.len() > 1 {
        writeln!(out, "All have the same layout; the first is shown.")?;
    }
    Ok(())
}

fn title(object: Option<&str>, choice: Option<&str>) -> String {
    match (object, choice) {
        (Some(object), Some("") | None) => object.to_owned(),
        (Some(object), Some(choice)) => format!("{object}: {}", choice.to_lowercase()),
        (None, _) => "unknown object".to_owned(),
    }
}

/// The whole object.
pub(super) fn write_object(out: &mut String, colour: bool, read: &ObjectRead) -> fmt::Result {
    let (on, off) = paint(colour, "\x1b[1m");
    let request = read.request;
    writeln!(
        out,
        "{on}{request}  object {}, option {}  {}{off}",
        request.object(),
        request.option(),
        title(read.object.map(|o| o.label), read.choice.map(|c| c.label))
    )?;
    writeln!(out, "  {}", read.why)?;
    for reading in read.readings() {
        writeln!(out, "  reading {}: {}", reading.id, reading.text)?;
    }
    let assumed: Vec<&str> = read.assumed.iter().map(|setting| setting.key()).collect();
    if !assumed.is_empty() {
        writeln!(out, "  assumed, not in a profile: {}", assumed.join(", "))?;
    }
    for problem in read.decoded.problems() {
        let severity = problem.severity();
        let (on, off) = match severity {
            Severity::Error => paint(colour, "\x1b[31m"),
            Severity::Warning => paint(colour, "\x1b[33m"),
            Severity::Note => paint(colour, "\x1b[2m"),
        };
        let at = problem.place.start / 2;
        writeln!(out, "  {on}{}{off} at {at}: {problem}", severity.key())?;
    }
    for (id, field) in read.decoded.iter() {
        write_field(out, colour, &read.decoded, field, read.decoded.depth(id))?;
    }
    Ok(())
}

fn write_field(
    out: &mut String,
    colour: bool,
    decoded: &Decoded,
    field: &Field,
    depth: usize,
) -> fmt::Result {
    let (on, off) = paint(colour, "\x1b[2m");
    let register = field.place.start / 2;
    let bytes = decoded.bytes().get(field.place.range()).unwrap_or(&[]);
    // A group shows no registers: those of its parts follow.
    let group = field.value == Value::Group;
    let mut raw = String::new();
    if !group {
        for pair in bytes.chunks(2).take(SHOWN) {
            for byte in pair {
                write!(raw, "{byte:02X}")?;
            }
            raw.push(' ');
        }
        if bytes.len() > SHOWN * 2 {
            raw.push('…');
        }
    }
    let label = field.name.label();
    let indent = depth * 2;
    let width = 46_usize.saturating_sub(indent);
    let text = decoded.text(field);
    let mark = if group { String::new() } else { mark(field) };
    let line = format!(
        "{on}{register:>5}  {raw:<21}{off}  {:indent$}{label:<width$}  {text}{mark}",
        ""
    );
    writeln!(out, "{}", line.trim_end())
}

/// Which readings the value rests on, and why it may not be right.
fn mark(field: &Field) -> String {
    let mut parts: Vec<&str> = match field.name {
        Name::Dop(def, _) => def.readings().map(|reading| reading.id).collect(),
        _ => Vec::new(),
    };
    if field.quality != Quality::Good {
        parts.push(field.quality.label());
    }
    if parts.is_empty() {
        String::new()
    } else {
        format!("  [{}]", parts.join(" "))
    }
}
