//! One line of text to bytes.

use super::push_pairs;
use super::stamp::Stamp;
use crate::capture::Micros;
use crate::problem::Finding;

/// Words that say which way a frame went or belong to a C array; they are no bytes and no mistake.
const LABELS: [&str; 24] = [
    "tx", "rx", "send", "sent", "recv", "received", "read", "write", "req", "resp", "request",
    "response", "query", "answer", "master", "slave", "client", "server", "unsigned", "const",
    "static", "char", "uint8_t", "byte",
];

/// What one line means for the next.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// Within a C comment.
    comment: bool,
    /// The lines begin with offsets, as dumps print them.
    offsets: bool,
    /// The time at which the line begins, if it begins with one.
    pub(super) stamp: Option<Micros>,
}

/// Reads one line. `report` gets a finding, its column from 0, and the length of `out` then.
pub(super) fn read(
    line: &[u8],
    state: &mut State,
    out: &mut Vec<u8>,
    report: &mut dyn FnMut(Finding, usize, usize),
) {
    let line = without_comments(line, &mut state.comment);
    // `unsigned char frame[] = { 0x01, …`: what names the array is no data.
    let skip = line
        .iter()
        .rposition(|b| *b == b'{')
        .or_else(|| line.iter().rposition(|b| *b == b'='))
        .map_or(0, |at| at.saturating_add(1));
    // `hexdump -C` ends its lines with the text between bars.
    let bar = line
        .iter()
        .position(|b| *b == b'|')
        .filter(|at| *at > 0)
        .unwrap_or(line.len());
    let mut words: Vec<(usize, &[u8])> = Vec::new();
    let mut start = None;
    for (at, byte) in line
        .iter()
        .chain(b" ")
        .enumerate()
        .skip(skip)
        .take_while(|(at, _)| *at <= bar)
    {
        let inside = is_inside(*byte) && at < bar;
        match (inside, start) {
            (true, None) => start = Some(at),
            (false, Some(from)) => {
                words.push((from, line.get(from..at).unwrap_or(&[])));
                start = None;
            }
            _ => {}
        }
    }
    if let (Some(from), true) = (start, bar == line.len()) {
        words.push((from, line.get(from..).unwrap_or(&[])));
    }
    let mut words = words.as_slice();
    let mut dump = bar < line.len();
    let mut stamp = Stamp::default();
    // Offsets of dumps, time stamps and labels stand first.
    while let Some(((_, first), rest)) = words.split_first() {
        // The last line of such a dump is an offset alone.
        let offset = matches!(first.len(), 7 | 8)
            && (!rest.is_empty() || state.offsets)
            && rest.iter().all(|(_, w)| w.len() == 2)
            && first.iter().all(u8::is_ascii_hexdigit);
        let label = first.ends_with(b":") && !rest.is_empty();
        if !(offset || label || stamp.takes(first)) {
            break;
        }
        state.offsets |= offset;
        dump |= offset || (label && is_hex(first.strip_suffix(b":").unwrap_or(first)));
        words = rest;
    }
    state.stamp = stamp.time();
    let lone = words.iter().filter(|(_, w)| w.len() == 1).count();
    // Some tools print bytes without the leading zero.
    let short = lone > 1 && words.iter().all(|(_, w)| w.len() <= 2);
    for (at, word) in words {
        if !bytes(word, short, *at, out, report) {
            if dump {
                // The text column of a dump.
                break;
            }
            if !is_label(word) {
                report(Finding::NotHex { words: 1 }, *at, out.len());
            }
        }
    }
}

/// True for characters that may belong to a word.
const fn is_inside(byte: u8) -> bool {
    matches!(byte, b'0'..=b'9' | b'a'..=b'z' | b'A'..=b'Z' | b'_' | b':' | b'-' | b'.' | b'$' | b'#' | 0x80..)
}

fn is_hex(word: &[u8]) -> bool {
    !word.is_empty() && word.iter().all(u8::is_ascii_hexdigit)
}

fn is_label(word: &[u8]) -> bool {
    let word = word.strip_suffix(b":").unwrap_or(word);
    word.iter().all(|b| matches!(b, b'-' | b'.' | b':'))
        || LABELS
            .iter()
            .any(|l| word.eq_ignore_ascii_case(l.as_bytes()))
}

/// The bytes that a word writes; false if it is no hexadecimal.
fn bytes(
    word: &[u8],
    short: bool,
    at: usize,
    out: &mut Vec<u8>,
    report: &mut dyn FnMut(Finding, usize, usize),
) -> bool {
    let (digits, prefixed) = match word {
        [b'0', b'x' | b'X', rest @ ..] | [b'x' | b'X' | b'$' | b'#', rest @ ..] => (rest, true),
        _ => (word, false),
    };
    let (digits, prefixed) = match digits {
        [rest @ .., b'h' | b'H'] if is_hex(rest) => (rest, true),
        _ => (digits, prefixed),
    };
    let digits = digits.strip_suffix(b":").unwrap_or(digits);
    if is_hex(digits) {
        run(digits, prefixed || short, at, out, report);
        return true;
    }
    // `01-03-00` and `01:03:00:0A`: pairs with marks between.
    let mark = if digits.contains(&b'-') { b'-' } else { b':' };
    let mut parts = digits
        .split(|b| *b == mark)
        .filter(|p| !p.is_empty())
        .peekable();
    let joined = parts.peek().is_some()
        && parts
            .clone()
            .all(|p| is_hex(p) && p.len().is_multiple_of(2));
    if joined {
        parts.for_each(|p| push_pairs(p, out));
    }
    joined
}

/// A run of digits. An odd one has lost a digit, unless it stands for one byte.
fn run(
    digits: &[u8],
    single: bool,
    at: usize,
    out: &mut Vec<u8>,
    report: &mut dyn FnMut(Finding, usize, usize),
) {
    if digits.len().is_multiple_of(2) {
        push_pairs(digits, out);
    } else if let (1, [digit]) = (digits.len(), digits) {
        if !single {
            report(Finding::LoneDigit, at, out.len());
        }
        push_pairs(&[b'0', *digit], out);
    } else {
        let even = digits.len().saturating_sub(1);
        push_pairs(digits.get(..even).unwrap_or(&[]), out);
        report(Finding::OddDigits, at.saturating_add(even), out.len());
    }
}

/// The line with C comments blanked out, so that columns stay what they are.
fn without_comments(line: &[u8], inside: &mut bool) -> Vec<u8> {
    let mut text = line.to_vec();
    let mut at = 0_usize;
    while at < text.len() {
        let two = line.get(at..at.saturating_add(2)).unwrap_or(&[]);
        let step = match (*inside, two) {
            (true, b"*/") => {
                *inside = false;
                2
            }
            (true, _) => 1,
            (false, b"//") => text.len(),
            (false, b"/*") => {
                *inside = true;
                2
            }
            (false, _) => 0,
        };
        let end = at.saturating_add(step).min(text.len());
        if let Some(blank) = text.get_mut(at..end) {
            blank.fill(b' ');
        }
        at = end.max(at.saturating_add(1));
    }
    text
}
