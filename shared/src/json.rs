//! The JSON lines of the command line: a documented contract, written field by field.
//!
//! One object a line. See the README for every key.

pub mod value;

use core::fmt::{self, Write};

use crate::frame::{Frame, Framing};
use crate::map::row::Trust;
use crate::problem::Problem;
use crate::text::TextProblem;
use crate::tree::{Decoded, Field, FieldId};
use crate::value::{Quality, Rfc3339, Value};

/// Text as a JSON string.
pub(crate) struct Quoted<'a>(pub(crate) &'a str);

impl fmt::Display for Quoted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_char('"')?;
        // Nearly all text has nothing to escape and goes out in one piece.
        let escaped = |b: &u8| matches!(b, b'"' | b'\\' | 0..=0x1F | 0x7F);
        let mut rest = self.0;
        while let Some(at) = rest.bytes().position(|b| escaped(&b)) {
            let (clean, from) = rest.split_at_checked(at).unwrap_or((rest, ""));
            f.write_str(clean)?;
            let mut chars = from.chars();
            match chars.next() {
                Some('"') => f.write_str("\\\"")?,
                Some('\\') => f.write_str("\\\\")?,
                Some(c) => write!(f, "\\u{:04x}", u32::from(c))?,
                None => {}
            }
            rest = chars.as_str();
        }
        f.write_str(rest)?;
        f.write_char('"')
    }
}

/// One frame, or a run of noise, as a JSON object without line end.
///
/// # Errors
/// Only if writing fails.
pub fn write_frame(
    out: &mut impl Write,
    index: u32,
    frame: &Frame,
    framing: Framing,
    decoded: &Decoded,
) -> fmt::Result {
    write_head(out, index, frame, framing, decoded)?;
    write_tail(out, frame, decoded)
}

/// One HART frame with the step that it is in a procedure, if it is in any.
///
/// # Errors
/// Only if writing fails.
#[cfg(feature = "hart")]
pub fn write_hart_frame(
    out: &mut impl Write,
    index: u32,
    frame: &Frame,
    framing: Framing,
    decoded: &Decoded,
    step: Option<&crate::hart::procedure::Step>,
) -> fmt::Result {
    write_head(out, index, frame, framing, decoded)?;
    if let Some(step) = step {
        out.write_str(r#","procedure":"#)?;
        step.write_json(out)?;
    }
    write_tail(out, frame, decoded)
}

fn write_head(
    out: &mut impl Write,
    index: u32,
    frame: &Frame,
    framing: Framing,
    decoded: &Decoded,
) -> fmt::Result {
    let kind = if frame.is_noise() { "noise" } else { "frame" };
    write!(
        out,
        r#"{{"kind":"{kind}","index":{index},"offset":{},"length":{}"#,
        frame.offset, frame.len
    )?;
    if frame.is_noise() {
        write!(out, r#","raw":"{}""#, crate::render::hex(decoded.bytes()))?;
    } else {
        write!(
            out,
            r#","framing":"{}","role":"{}""#,
            framing.key(),
            frame.role.key()
        )?;
        write_who(out, frame, framing, decoded)?;
        write!(out, r#","ok":{},"pairs_with":"#, decoded.is_ok())?;
        match frame.pair() {
            Some(pair) => write!(out, "{pair}")?,
            None => out.write_str("null")?,
        }
    }
    Ok(())
}

fn write_tail(out: &mut impl Write, frame: &Frame, decoded: &Decoded) -> fmt::Result {
    if !frame.is_noise() {
        out.write_str(r#","fields":["#)?;
        for (id, field) in decoded.iter() {
            if id.get() > 0 {
                out.write_char(',')?;
            }
            write_field(out, frame.offset, decoded, id, field)?;
        }
        out.write_char(']')?;
    }
    out.write_str(r#","problems":["#)?;
    for (at, problem) in decoded.problems().iter().enumerate() {
        if at > 0 {
            out.write_char(',')?;
        }
        let offset = frame.offset.saturating_add(u64::from(problem.place.start));
        write_problem(out, problem, offset)?;
    }
    out.write_str("]}")
}

/// What stands between the bytes of a pasted text, as a run of noise of no bytes.
///
/// # Errors
/// Only if writing fails.
pub fn write_text_problem(out: &mut impl Write, index: u32, problem: &TextProblem) -> fmt::Result {
    let offset = problem.offset;
    write!(
        out,
        r#"{{"kind":"noise","index":{index},"offset":{offset},"length":0,"raw":"","line":{},"column":{},"problems":["#,
        problem.line, problem.column
    )?;
    let place = crate::place::Place::default();
    write_problem(out, &Problem::new(problem.finding, place), offset)?;
    out.write_str("]}")
}

/// One problem as a JSON object; `offset` is that of its first byte.
///
/// # Errors
/// Only if writing fails.
pub fn write_problem(out: &mut impl Write, problem: &Problem, offset: u64) -> fmt::Result {
    write!(
        out,
        r#"{{"severity":"{}","code":"{}","offset":{offset},"length":{},"text":{}}}"#,
        problem.severity().key(),
        problem.code(),
        problem.place.len,
        Quoted(&problem.to_string())
    )
}

/// One field as a JSON object; `base` is the offset of the first byte of the tree.
///
/// # Errors
/// Only if writing fails.
pub fn write_field(
    out: &mut impl Write,
    base: u64,
    decoded: &Decoded,
    id: FieldId,
    field: &Field,
) -> fmt::Result {
    write!(
        out,
        r#"{{"path":{},"label":{},"value":"#,
        Quoted(&decoded.path(id)),
        Quoted(&field.name.label())
    )?;
    write_value(out, decoded, field)?;
    let offset = base.saturating_add(u64::from(field.place.start));
    write!(
        out,
        r#","text":{},"unit":{},"raw":"{}","offset":{offset},"length":{},"source":"#,
        Quoted(&decoded.text(field)),
        Quoted(field.name.unit()),
        decoded.raw(field),
        field.place.len
    )?;
    match field.name.source() {
        Some(source) => write!(out, "{}", Quoted(&source.to_string()))?,
        None => out.write_str("null")?,
    }
    // What goes beyond the usual is only there where it says something.
    if field.quality != Quality::Good {
        write!(out, r#","quality":"{}""#, field.quality.label())?;
    }
    if field.name.trust() != Trust::Manual {
        write!(out, r#","trust":"{}""#, field.name.trust().key())?;
    }
    if let Some(reading) = field.name.reading() {
        write!(
            out,
            r#","reading":{{"id":"{}","settled":"{}","text":{}}}"#,
            reading.id,
            reading.settled.key(),
            Quoted(reading.text)
        )?;
    }
    let also = field.name.also();
    for (at, reading) in also.iter().enumerate() {
        let before = if at == 0 { r#","also":["# } else { "," };
        write!(out, r#"{before}"{}""#, reading.id)?;
    }
    out.write_str(if also.is_empty() { "}" } else { "]}" })
}

/// Who was asked or answers, and what for.
#[cfg_attr(
    not(feature = "hart"),
    expect(unused_variables, reason = "HART has addresses and commands instead")
)]
fn write_who(
    out: &mut impl Write,
    frame: &Frame,
    framing: Framing,
    decoded: &Decoded,
) -> fmt::Result {
    #[cfg(feature = "hart")]
    match framing {
        Framing::Hart => return crate::hart::who::write_who(out, decoded.bytes()),
        Framing::HartIp => return crate::hart::ip::write_who(out, decoded.bytes()),
        _ => {}
    }
    write!(
        out,
        r#","unit":{},"function":{}"#,
        frame.unit, frame.function
    )
}

fn write_value(out: &mut impl Write, decoded: &Decoded, field: &Field) -> fmt::Result {
    match field.value {
        Value::Group | Value::Unavailable(_) => out.write_str("null"),
        Value::Number { raw, scale } => write!(out, "{}", scale.apply(raw)),
        Value::Hex(raw)
        | Value::Code { raw, .. }
        | Value::Named(raw, _)
        | Value::Flags { raw, .. } => {
            write!(out, "{raw}")
        }
        Value::Address(_, address) => write!(out, "{address}"),
        Value::Bit { on, .. } => write!(out, "{on}"),
        Value::Samples => {
            out.write_char('[')?;
            for (at, sample) in decoded.payload(field).iter().enumerate() {
                if at > 0 {
                    out.write_char(',')?;
                }
                write!(out, "{sample}")?;
            }
            out.write_char(']')
        }
        Value::Stamp(seconds) => write!(out, "\"{}\"", Rfc3339(seconds)),
        #[cfg(feature = "icon")]
        Value::DeviceTime(_) => {
            // A time without a zone: `2021-02-12T15:29:15`.
            let text = field.value.to_string().replace(' ', "T");
            write!(out, "\"{text}\"")
        }
        Value::Raw => write!(out, r#""{}""#, decoded.raw(field)),
        Value::Text | Value::Amount { .. } | Value::Date { .. } | Value::Time { .. } => {
            write!(out, "{}", Quoted(&decoded.bare_text(field)))
        }
    }
}
