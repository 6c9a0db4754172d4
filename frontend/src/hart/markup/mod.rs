//! The program's screens as HTML text. Pure, tested natively.

pub mod bus;
pub mod map;
pub mod overview;
pub mod status;
pub mod steps;
pub mod values;

use shared::map::row::{Reading, Settled};

use crate::markup::Markup;

/// The number of a reading, with its reason for those who ask.
pub fn reading(html: &mut Markup, reading: &Reading) {
    let settled = match reading.settled {
        Settled::Yes => "settled by the text",
        Settled::Likely => "likely",
        Settled::No => "open, the raw value decides",
    };
    let title = format!("Reading {}: {} ({settled})", reading.id, reading.text);
    html.open("em", &[("class", "trust"), ("title", &title)])
        .text(reading.id)
        .close("em");
}
