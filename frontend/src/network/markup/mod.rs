//! The program's screens as HTML text. Pure, tested natively.

pub mod cards;
pub mod check;
pub mod counters;
pub mod drawing;
pub mod findings;
pub mod head;
pub mod line;
pub mod log;
pub mod scan;
pub mod table;
pub mod tags;
pub mod typed;
pub mod unit;

use crate::components::ne107::Sign;
use crate::markup::Markup;

/// A sign within a drawing: outline, inner mark and letter, its middle at a place.
fn sign_at(html: &mut Markup, sign: Sign, (x, y): (i32, i32)) {
    let (outline, inner) = sign.paths();
    let place = format!("translate({} {}) scale(.9)", x - 9, y - 9);
    html.open("g", &[("class", sign.class()), ("transform", &place)]);
    html.open("path", &[("class", "sign-shape"), ("d", outline)])
        .close("path");
    html.open("path", &[("class", "sign-inner"), ("d", inner)])
        .close("path")
        .close("g");
}

/// A short text within a drawing.
fn label(html: &mut Markup, class: &str, (x, y): (i32, i32), text: &str) {
    html.open(
        "text",
        &[
            ("class", class),
            ("x", &x.to_string()),
            ("y", &y.to_string()),
        ],
    );
    html.text(text).close("text");
}
