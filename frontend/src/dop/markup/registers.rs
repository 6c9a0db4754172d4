//! The registers of a response, as received.

use shared::problem::Severity;
use shared::tree::Decoded;

use crate::markup::Markup;

/// Registers in rows with the number of the first; those with problems are marked.
pub fn registers(html: &mut Markup, decoded: &Decoded, per_row: usize) {
    let bytes = decoded.bytes();
    for (row, run) in bytes.chunks(per_row * 2).enumerate() {
        html.open("div", &[("class", "hex-row"), ("role", "row")]);
        html.open("span", &[("class", "hex-offset"), ("role", "rowheader")]);
        html.text(&format!("{:>3}", row * per_row)).close("span");
        html.open("span", &[("class", "word-row")]);
        for (at, pair) in run.chunks(2).enumerate() {
            let register = row * per_row + at;
            let class = match worst(decoded, register) {
                Some(Severity::Error) => "word byte bad-error",
                Some(Severity::Warning) => "word byte bad-warning",
                _ => "word byte",
            };
            let offset = (register * 2).to_string();
            html.open(
                "span",
                &[
                    ("class", class),
                    ("role", "gridcell"),
                    ("data-testid", "register"),
                    ("data-offset", &offset),
                ],
            );
            let text: String = pair.iter().map(|byte| format!("{byte:02X}")).collect();
            html.text(&text).close("span");
        }
        html.close("span").close("div");
    }
}

/// The worst that is said about a register; problems of the whole answer mark none.
fn worst(decoded: &Decoded, register: usize) -> Option<Severity> {
    let all = decoded.bytes().len();
    let at = register * 2;
    let problems = decoded.problems().iter();
    problems
        .filter(|p| {
            let range = p.place.range();
            (range.len() < all || all <= 2) && (range.contains(&at) || range.contains(&(at + 1)))
        })
        .map(shared::problem::Problem::severity)
        .max()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::dop::{ObjectRead, Profile, Request};

    #[test]
    fn every_register_has_its_place() {
        let words: Vec<u16> = (0..10).collect();
        let read = ObjectRead::read(Request::from_word(405), &words, &Profile::default());
        let mut html = Markup::new();
        registers(&mut html, &read.decoded, 8);
        let html = html.finish();
        assert_eq!(html.matches("data-testid=\"register\"").count(), 10);
        assert_eq!(html.matches("hex-row").count(), 2);
        assert!(html.contains("data-offset=\"18\">0009<"), "{html}");
        assert!(html.contains(">  8<"), "{html}");
    }
}
