//! The program's screens as HTML text. Pure, tested natively.

pub mod bus;
pub mod map;
pub mod overview;
pub mod setup;
pub mod status;
pub mod steps;
pub mod values;

use shared::map::row::{Reading, Settled};

use crate::markup::Markup;

/// The number of a reading; pressed, it tells the rest.
pub fn reading(html: &mut Markup, reading: &Reading) {
    let settled = match reading.settled {
        Settled::Yes => "settled by the text",
        Settled::Likely => "likely",
        Settled::No => "open, the raw value decides",
    };
    let words = format!("Reading {}: {} ({settled})", reading.id, reading.text);
    // The same reading stands in several places, with the same words.
    let id = format!("reading-{}", reading.id);
    html.open("button", &[("class", "trust"), ("popovertarget", &id)])
        .text(reading.id)
        .close("button");
    html.open("span", &[("class", "note"), ("id", &id), ("popover", "")])
        .text(&words)
        .close("span");
}
