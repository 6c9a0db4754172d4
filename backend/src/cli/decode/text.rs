//! Frames as people read them: what is wrong first, then byte by byte what it means.

use super::Tally;
use shared::frame::{Frame, Framing, Role};
use shared::hart::procedure::{Open, Step};
use shared::place::Place;
use shared::problem::{Problem, Severity};
use shared::render::Spaced;
use shared::text::TextProblem;
use shared::tree::{Decoded, Field};
use std::fmt::{self, Write};

/// Bytes of a field that are shown; longer ones are cut.
const SHOWN: usize = 8;
/// Bytes of noise that are shown.
const SHOWN_NOISE: usize = 24;

/// Colours of a terminal.
struct Paint(bool);

impl Paint {
    fn severity(&self, severity: Severity) -> (&'static str, &'static str) {
        match (self.0, severity) {
            (false, _) => ("", ""),
            (true, Severity::Error) => ("\x1b[31m", "\x1b[0m"),
            (true, Severity::Warning) => ("\x1b[33m", "\x1b[0m"),
            (true, Severity::Note) => ("\x1b[2m", "\x1b[0m"),
        }
    }

    fn head(&self) -> (&'static str, &'static str) {
        if self.0 {
            ("\x1b[1m", "\x1b[0m")
        } else {
            ("", "")
        }
    }

    fn faint(&self) -> (&'static str, &'static str) {
        if self.0 {
            ("\x1b[2m", "\x1b[0m")
        } else {
            ("", "")
        }
    }
}

/// One frame or run of noise with its fields, without the last line end.
pub(in crate::cli) fn write_frame(
    out: &mut impl Write,
    colour: bool,
    index: u32,
    frame: &Frame,
    framing: Framing,
    decoded: &Decoded,
    step: Option<&Step>,
) -> fmt::Result {
    let paint = Paint(colour);
    let (on, off) = paint.head();
    let offset = frame.offset;
    let len = match frame.len {
        1 => "1 byte".to_owned(),
        n => format!("{n} bytes"),
    };
    if frame.is_noise() {
        write!(out, "{on}#{index}  noise{off}  offset {offset}, {len}")?;
    } else {
        let role = match frame.role {
            Role::Request => "request",
            Role::Response => "response",
            Role::Exception => "exception",
            Role::Burst => "burst",
            Role::Unknown | Role::Noise => "frame",
        };
        write!(out, "{on}#{index}  {role}  ")?;
        if matches!(framing, Framing::Hart | Framing::HartIp) {
            out.write_str(&shared::hart::who(framing, decoded.bytes()))?;
        } else {
            let function = frame.function & 0x7F;
            let name = shared::pdu::names::function(function).unwrap_or("unknown function");
            write!(out, "unit {}  FC {function:02} {name}", frame.unit)?;
        }
        write!(out, "{off}  offset {offset}, {len}")?;
        match (frame.pair(), frame.role) {
            (Some(pair), Role::Request) => write!(out, ", answered by #{pair}")?,
            (Some(pair), _) => write!(out, ", answers #{pair}")?,
            (None, _) => {}
        }
    }
    out.write_char('\n')?;
    if let Some(step) = step {
        write_step(out, &paint, step)?;
    }
    for problem in decoded.problems() {
        write_problem(out, &paint, problem, frame.offset)?;
    }
    if frame.is_noise() {
        write_bytes(out, decoded.bytes(), SHOWN_NOISE)?;
        return out.write_char('\n');
    }
    for (id, field) in decoded.iter() {
        write_field(out, &paint, frame, decoded, field, decoded.depth(id))?;
    }
    Ok(())
}

/// What the frame does in a procedure.
fn write_step(out: &mut impl Write, paint: &Paint, step: &Step) -> fmt::Result {
    writeln!(
        out,
        "  {} (run {}): {}",
        step.procedure.label(),
        step.run,
        step.text
    )?;
    for doubt in &step.doubts {
        let (on, off) = paint.severity(doubt.severity());
        writeln!(out, "  {on}{}{off}: {doubt}", doubt.severity().key())?;
    }
    Ok(())
}

/// A procedure that was not ended, without the line end.
pub(super) fn write_open(out: &mut impl Write, colour: bool, open: &Open) -> fmt::Result {
    let (on, off) = Paint(colour).severity(Severity::Warning);
    write!(out, "{on}{}{off}: {open}", Severity::Warning.key())
}

fn write_field(
    out: &mut impl Write,
    paint: &Paint,
    frame: &Frame,
    decoded: &Decoded,
    field: &Field,
    depth: usize,
) -> fmt::Result {
    let (on, off) = paint.faint();
    let offset = frame.offset + u64::from(field.place.start);
    let bytes = decoded.bytes().get(field.place.range()).unwrap_or(&[]);
    let mut raw = String::new();
    write_bytes(&mut raw, bytes, SHOWN)?;
    let label = field.name.label();
    let indent = depth * 2;
    let width = 34_usize.saturating_sub(indent);
    let text = decoded.text(field);
    let line = format!(
        "{on}{offset:>8}  {raw:<27}{off}  {:indent$}{label:<width$}  {text}",
        ""
    );
    writeln!(out, "{}", line.trim_end())
}

/// The first bytes of a run.
fn write_bytes(out: &mut impl Write, bytes: &[u8], shown: usize) -> fmt::Result {
    match bytes.get(..shown) {
        Some(first) if bytes.len() > shown => write!(out, "{} …", Spaced(first)),
        _ => write!(out, "{}", Spaced(bytes)),
    }
}

fn write_problem(out: &mut impl Write, paint: &Paint, problem: &Problem, base: u64) -> fmt::Result {
    let severity = problem.severity();
    let (on, off) = paint.severity(severity);
    let at = base + u64::from(problem.place.start);
    writeln!(out, "  {on}{}{off} at {at}: {problem}", severity.key())
}

/// What in a text is no byte, without the line end.
pub(super) fn write_text_problem(
    out: &mut impl Write,
    colour: bool,
    problem: &TextProblem,
) -> fmt::Result {
    let found = Problem::new(problem.finding, Place::default());
    let severity = found.severity();
    let (on, off) = Paint(colour).severity(severity);
    writeln!(
        out,
        "{on}{}{off} in line {}, column {}: {found}",
        severity.key(),
        problem.line,
        problem.column
    )
}

/// The last line.
pub(super) fn write_tally(out: &mut impl Write, tally: &Tally) -> fmt::Result {
    let plural = |n: u64, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
    write!(out, "{}", plural(tally.frames, "frame", "frames"))?;
    if tally.noise > 0 {
        let bytes = plural(tally.noise, "byte", "bytes");
        write!(out, ", {bytes} of noise")?;
    }
    match tally.errors {
        0 => writeln!(out, ", no errors"),
        n => writeln!(out, ", errors in {}", plural(n, "entry", "entries")),
    }
}
