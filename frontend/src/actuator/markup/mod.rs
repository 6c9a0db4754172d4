//! The program's screens as HTML text. Pure, tested natively.

pub mod communication;
pub mod configuration;
pub mod curves;
pub mod health;
pub mod identity;
pub mod logs;
pub mod rows;
pub mod signature;
pub mod snapshots;
pub mod tools;
pub mod words;

use shared::map::row::{Reading, Settled};

use crate::markup::Markup;

/// The number of a reading, with its reason for those who open it.
pub fn reading(html: &mut Markup, reading: &Reading) {
    let settled = match reading.settled {
        Settled::Yes => "settled by the text",
        Settled::Likely => "likely",
        Settled::No => "open, the raw value decides",
    };
    html.open("details", &[("class", "reading")]);
    html.open("summary", &[("class", "trust")])
        .text(reading.id)
        .close("summary");
    html.text(&format!("{} ({settled}) ", reading.text))
        .close("details");
}

/// A heading with a remark beside it.
pub fn heading(html: &mut Markup, title: &str, remark: &str) {
    html.open("h2", &[("class", "icon-heading")]).text(title);
    if !remark.is_empty() {
        html.text(" ").node("small", "quiet", remark);
    }
    html.close("h2");
}
