//! Everything that is known about a field or a row of a map.

use shared::map::row::{Reading, Settled, Trust};
use shared::value::Quality;

use super::Markup;
use crate::state::tree::{Facts, binary};

/// Opens a list of facts.
pub fn fact(html: &mut Markup, name: &str, text: &str) {
    html.node("dt", "", name).node("dd", "", text);
}

/// The facts of a field of a frame, or what to do to see them.
pub fn field(html: &mut Markup, facts: Option<&Facts>) {
    let Some(facts) = facts else {
        html.node(
            "p",
            "quiet",
            "Select a field or a byte to see where it is described.",
        );
        return;
    };
    let (first, last) = facts.bytes;
    let bytes = if first >= last {
        format!("byte {first}")
    } else {
        format!("bytes {first} to {last}")
    };
    html.open("p", &[("class", "facts-title")]);
    html.node("b", "", &facts.label)
        .text(" ")
        .node("code", "", &facts.path)
        .text(" ")
        .node("span", "quiet", &bytes);
    html.close("p").open("dl", &[]);
    html.node("dt", "", "Raw");
    match facts.number {
        Some((value, len)) => {
            let width = len * 2;
            let text = format!("0x{value:0width$X} · {value} · {}", binary(value, len));
            html.node("dd", "mono", &text);
        }
        None => {
            html.node("dd", "mono wrap", &facts.raw);
        }
    }
    if facts.quality != Quality::Good {
        fact(html, "Quality", facts.quality.label());
    }
    let source = facts
        .source
        .map_or_else(|| "no map describes it".to_owned(), |s| s.to_string());
    let text = match facts.source {
        Some(_) => format!("{source}, {}", trust(facts.trust)),
        None => source,
    };
    fact(html, "Source", &text);
    if let Some(read) = facts.reading {
        reading(html, read);
    }
    html.close("dl");
}

/// Why a description differs from the print.
pub fn reading(html: &mut Markup, reading: &Reading) {
    let settled = match reading.settled {
        Settled::Yes => "settled by the text",
        Settled::Likely => "likely",
        Settled::No => "open, the raw value decides",
    };
    html.node("dt", "", "Reading").open("dd", &[]);
    html.node("code", "", reading.id)
        .text(" ")
        .text(reading.text)
        .node("span", "quiet", &format!(" ({settled})"))
        .close("dd");
}

/// The words for a trust.
#[must_use]
pub const fn trust(trust: Trust) -> &'static str {
    match trust {
        Trust::Manual => "as printed",
        Trust::Reading => "read differently from the print",
        Trust::Inferred => "concluded, not printed",
    }
}
