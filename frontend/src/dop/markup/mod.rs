//! The program's screens as HTML text. Pure, tested natively.

pub mod compare;
pub mod list;
pub mod logs;
pub mod object;
pub mod offline;
pub mod overview;
pub mod profile;
pub mod registers;

use shared::dop::profile::Ne107;
use shared::map::row::{Reading, Settled};

use crate::components::ne107::Sign;
use crate::markup::Markup;

/// The sign of a category.
#[must_use]
pub const fn sign_of(category: Ne107) -> Sign {
    match category {
        Ne107::Failure => Sign::Failure,
        Ne107::CheckFunction => Sign::FunctionCheck,
        Ne107::OutOfSpecification => Sign::OutOfSpecification,
        Ne107::Maintenance => Sign::Maintenance,
    }
}

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

/// Marks what no setting confirms.
pub fn assumed(html: &mut Markup) {
    html.open(
        "em",
        &[
            ("class", "quality assumed"),
            (
                "title",
                "The profile does not say it, so the default is assumed.",
            ),
        ],
    )
    .text("assumed")
    .close("em");
}
