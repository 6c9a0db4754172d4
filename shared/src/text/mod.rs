//! Pasted text and files to bytes: hexadecimal in any usual writing, Modbus ASCII lines, or bytes
//! as they are.
//!
//! Nothing is dropped silently: what is no byte becomes a [`TextProblem`] with line and column.

mod line;
mod stamp;
#[cfg(test)]
mod tests;

use crate::capture::Micros;
use crate::frame::ascii::hex_digit;
use crate::frame::{Framing, detect};
use crate::problem::Finding;

/// What an input is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Form {
    /// Bytes as they are: a binary capture.
    Binary,
    /// Modbus ASCII lines; the characters themselves are the stream.
    AsciiLines,
    /// Text that writes bytes in hexadecimal.
    Hex,
}

/// How many bytes are looked at to tell the form.
const SAMPLE: usize = 64 * 1024;

/// Tells the form of an input from its beginning.
///
/// Control characters make it binary. A line that begins with a colon and six hexadecimal digits
/// makes it Modbus ASCII. Anything else is taken as text with hexadecimal bytes.
#[must_use]
pub fn form(start: &[u8]) -> Form {
    let sample = start.get(..SAMPLE).unwrap_or(start);
    let is_text = |b: &u8| matches!(b, b'\t' | b'\n' | b'\r' | 0x20..=0x7E | 0x80..);
    let cut = sample.len() == SAMPLE;
    let valid = match core::str::from_utf8(sample) {
        Ok(_) => true,
        // A character cut in two by the end of the sample.
        Err(e) => e.error_len().is_none() && cut,
    };
    if !valid || !sample.iter().all(is_text) {
        return Form::Binary;
    }
    let is_frame = |line: &[u8]| {
        line.trim_ascii_start()
            .strip_prefix(b":")
            .and_then(|l| l.get(..6))
            .is_some_and(|l| l.iter().all(u8::is_ascii_hexdigit))
    };
    if sample.split(|b| *b == b'\n').any(is_frame) {
        Form::AsciiLines
    } else {
        Form::Hex
    }
}

/// Something in a text that is no byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextProblem {
    /// What it is.
    pub finding: Finding,
    /// Line, counted from 1.
    pub line: u32,
    /// Column in bytes, counted from 1.
    pub column: u32,
    /// How many bytes had been read when it was met.
    pub offset: u64,
}

/// Lines longer than this are read in pieces, so that memory stays bounded.
const LONGEST: usize = 64 * 1024;

/// Reads hexadecimal text piece by piece.
#[derive(Clone, Debug, Default)]
pub struct HexReader {
    pending: Vec<u8>,
    line: u32,
    column: u32,
    offset: u64,
    state: line::State,
    skipped: u32,
    first_skipped: Option<TextProblem>,
    /// Offsets of bytes before which a line had a time, if that is wanted.
    stamps: Option<Vec<(u64, Micros)>>,
}

impl HexReader {
    /// A reader at the start of a text.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// A reader that keeps the times with which lines begin; they take memory.
    #[must_use]
    pub fn with_stamps() -> Self {
        Self {
            stamps: Some(Vec::new()),
            ..Self::default()
        }
    }

    /// Offset of the first byte of each line that began with a time, and that time: microseconds
    /// since midnight, or since 1970 where the line has a date.
    #[must_use]
    pub fn stamps(&self) -> &[(u64, Micros)] {
        self.stamps.as_deref().unwrap_or_default()
    }

    /// Takes a piece of text in; appends the bytes that it writes to `out`.
    pub fn push(&mut self, text: &[u8], out: &mut Vec<u8>, problems: &mut Vec<TextProblem>) {
        for piece in text.split_inclusive(|b| *b == b'\n') {
            self.pending.extend_from_slice(piece);
            if piece.ends_with(b"\n") {
                let line = core::mem::take(&mut self.pending);
                self.read(&line, out, problems);
                self.pending = line;
                self.pending.clear();
                self.line = self.line.saturating_add(1);
                self.column = 0;
            } else {
                while self.pending.len() > LONGEST {
                    self.read_part(out, problems);
                }
            }
        }
    }

    /// The text is at its end.
    pub fn finish(&mut self, out: &mut Vec<u8>, problems: &mut Vec<TextProblem>) {
        let line = core::mem::take(&mut self.pending);
        self.read(&line, out, problems);
        if let Some(mut problem) = self.first_skipped.take() {
            problem.finding = Finding::NotHex {
                words: self.skipped,
            };
            problems.push(problem);
        }
    }

    /// Reads the first part of a line that is too long: up to a blank or comma, else up to an even
    /// number of digits.
    fn read_part(&mut self, out: &mut Vec<u8>, problems: &mut Vec<TextProblem>) {
        let window = self.pending.get(..LONGEST).unwrap_or(&self.pending);
        let cut = window
            .iter()
            .rposition(|b| matches!(b, b' ' | b',' | b'\t' | b';'))
            .map_or(LONGEST & !1, |at| at.saturating_add(1));
        let rest = self.pending.split_off(cut.min(self.pending.len()));
        let part = core::mem::replace(&mut self.pending, rest);
        self.read(&part, out, problems);
        let read = u32::try_from(part.len()).unwrap_or(u32::MAX);
        self.column = self.column.saturating_add(read);
    }

    fn read(&mut self, line: &[u8], out: &mut Vec<u8>, problems: &mut Vec<TextProblem>) {
        let before = out.len();
        let mut report =
            |finding, at: usize, bytes: usize, skipped: &mut (u32, Option<TextProblem>)| {
                let ahead = u64::try_from(bytes.saturating_sub(before)).unwrap_or(0);
                let column = u32::try_from(at).unwrap_or(u32::MAX).saturating_add(1);
                let problem = TextProblem {
                    finding,
                    line: self.line.saturating_add(1),
                    column: self.column.saturating_add(column),
                    offset: self.offset.saturating_add(ahead),
                };
                if matches!(finding, Finding::NotHex { .. }) {
                    skipped.0 = skipped.0.saturating_add(1);
                    skipped.1 = skipped.1.or(Some(problem));
                } else {
                    problems.push(problem);
                }
            };
        let mut skipped = (self.skipped, self.first_skipped);
        line::read(line, &mut self.state, out, &mut |finding, at, bytes| {
            report(finding, at, bytes, &mut skipped);
        });
        (self.skipped, self.first_skipped) = skipped;
        let read = u64::try_from(out.len().saturating_sub(before)).unwrap_or(0);
        if let (Some(stamps), Some(stamp)) = (&mut self.stamps, self.state.stamp)
            && read > 0
        {
            stamps.push((self.offset, stamp));
        }
        self.offset = self.offset.saturating_add(read);
    }
}

/// Reads a whole hexadecimal text.
#[must_use]
pub fn read_hex(text: &[u8]) -> (Vec<u8>, Vec<TextProblem>) {
    let (mut out, mut problems) = (Vec::with_capacity(text.len() / 3), Vec::new());
    let mut reader = HexReader::new();
    reader.push(text, &mut out, &mut problems);
    reader.finish(&mut out, &mut problems);
    (out, problems)
}

/// An input as a stream of bytes, ready to be scanned.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    /// What the input was.
    pub form: Form,
    /// How its frames are marked off: as chosen, else as detected.
    pub framing: Framing,
    /// The stream.
    pub bytes: Vec<u8>,
    /// What in the text is no byte.
    pub problems: Vec<TextProblem>,
}

/// Reads a whole input that is in memory. `framing` is the choice of the user, `None` to detect.
#[must_use]
pub fn import(input: &[u8], framing: Option<Framing>) -> Import {
    let form = form_for(input, framing);
    let (bytes, problems) = match form {
        Form::Hex => read_hex(input),
        Form::Binary | Form::AsciiLines => (input.to_vec(), Vec::new()),
    };
    let framing = framing.unwrap_or_else(|| match form {
        Form::AsciiLines => Framing::Ascii,
        Form::Hex | Form::Binary => detect(&bytes),
    });
    Import {
        form,
        framing,
        bytes,
        problems,
    }
}

/// The form of an input for a chosen framing: lines with a colon are characters of the stream only
/// if Modbus ASCII is looked for.
#[must_use]
pub fn form_for(start: &[u8], framing: Option<Framing>) -> Form {
    match form(start) {
        Form::AsciiLines if !matches!(framing, None | Some(Framing::Ascii)) => Form::Hex,
        form => form,
    }
}

/// Appends the bytes of an even number of digits.
fn push_pairs(digits: &[u8], out: &mut Vec<u8>) {
    for pair in digits.chunks_exact(2) {
        if let [high, low] = pair
            && let (Some(high), Some(low)) = (hex_digit(*high), hex_digit(*low))
        {
            out.push((high << 4) | low);
        }
    }
}
