//! The bytes of a frame.

use shared::problem::{Cause, Finding, Severity};
use shared::tree::Decoded;

use super::Markup;
use crate::format::count;
use crate::state::work::Shown;

/// Bytes in rows with offset and characters. Bytes with problems are marked, missing ones stand
/// as dots at the end.
#[must_use]
pub fn bytes(shown: &Shown, per_row: usize) -> String {
    let decoded = &shown.decoded;
    let bad = worst_by_byte(decoded);
    let missing = missing(decoded).min(8);
    let bytes = decoded.bytes();
    let mut html = Markup::new();
    for (row, run) in bytes.chunks(per_row).enumerate() {
        let from = row * per_row;
        html.open("div", &[("class", "hex-row"), ("role", "row")]);
        html.open("span", &[("class", "hex-offset"), ("role", "rowheader")]);
        html.text(&format!("{from:04X}")).close("span");
        html.open("span", &[("class", "hex-bytes")]);
        for (at, byte) in run.iter().enumerate() {
            let class = match bad.get(from + at) {
                Some(Some(Severity::Error)) => "byte bad-error",
                Some(Some(Severity::Warning)) => "byte bad-warning",
                _ => "byte",
            };
            html.open(
                "span",
                &[
                    ("class", class),
                    ("role", "gridcell"),
                    ("tabindex", "-1"),
                    ("data-testid", "hex-byte"),
                    ("data-offset", &(from + at).to_string()),
                ],
            );
            html.text(&format!("{byte:02X}")).close("span");
        }
        if from + run.len() == bytes.len() {
            for _ in 0..missing {
                html.open("span", &[("class", "byte ghost"), ("title", "missing")]);
                html.text("··").close("span");
            }
        }
        html.close("span");
        html.open("span", &[("class", "hex-text"), ("aria-hidden", "true")]);
        html.text(&characters(run)).close("span").close("div");
    }
    if shown.hidden() > 0 {
        let words = format!("{} not shown", count(shown.hidden(), "more byte"));
        html.node("p", "quiet", &words);
    }
    html.finish()
}

/// The worst error or warning about each byte. Problems of the whole frame mark none: they would
/// mark all.
fn worst_by_byte(decoded: &Decoded) -> Vec<Option<Severity>> {
    let len = decoded.bytes().len();
    let mut worst = vec![None; len];
    for problem in decoded.problems() {
        let range = problem.place.range();
        if range.len() >= len && len > 1 {
            continue;
        }
        for at in range {
            if let Some(slot) = worst.get_mut(at) {
                *slot = (*slot).max(Some(problem.severity()));
            }
        }
    }
    worst
}

/// How many bytes are known to be missing at the end.
fn missing(decoded: &Decoded) -> usize {
    let of = |finding: &Finding| match finding {
        Finding::Truncated { missing } => usize::from(*missing),
        Finding::Crc {
            cause: Cause::Missing,
            ..
        } => 2,
        _ => 0,
    };
    let problems = decoded.problems().iter();
    problems.map(|p| of(&p.finding)).max().unwrap_or(0)
}

fn characters(bytes: &[u8]) -> String {
    let printable = |b: &u8| match b {
        0x20..=0x7E => char::from(*b),
        _ => '·',
    };
    bytes.iter().map(printable).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;
    use shared::device::Device;
    use shared::frame::Framing;

    fn html(text: &str, index: u32) -> String {
        let loaded = load(text.as_bytes(), Some(Framing::Rtu));
        let shown = Shown::of(&loaded.session, index, Device::None).unwrap();
        bytes(&shown, 16)
    }

    #[test]
    fn every_byte_has_its_offset() {
        let html = html("7D0306003D084400003E07", 0);
        assert_eq!(html.matches("data-testid=\"hex-byte\"").count(), 11);
        assert!(html.contains("data-offset=\"10\""));
        assert!(html.contains("}···"), "{html}");
    }

    #[test]
    fn problems_and_missing_bytes_are_marked() {
        let damaged = html("7D0300070003BFF6 7D0306003D084400003E08", 1);
        assert_eq!(damaged.matches("bad-error").count(), 2, "{damaged}");
        let cut = html("7D0300070003BFF6 7D0306003D0844", 1);
        assert!(cut.contains("ghost"), "{cut}");
    }
}
