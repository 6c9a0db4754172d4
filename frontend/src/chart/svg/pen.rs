//! Writes the shapes of a picture.

use super::Look;
use crate::markup::Markup;

/// Tenths of a pixel are fine enough.
#[expect(clippy::cast_possible_truncation, reason = "pixels of a screen")]
pub(super) fn n(pixels: f64) -> String {
    let tenths = (pixels * 10.0).round() as i64;
    let sign = if tenths < 0 { "-" } else { "" };
    let tenths = tenths.unsigned_abs();
    match tenths % 10 {
        0 => format!("{sign}{}", tenths / 10),
        tenth => format!("{sign}{}.{tenth}", tenths / 10),
    }
}

/// Writes shapes; on paper the style stands in each of them.
pub(super) struct Pen {
    pub html: Markup,
    pub look: Look,
}

impl Pen {
    pub fn shape(&mut self, tag: &str, class: &str, own: &[(&str, &str)], text: &str) {
        let mut attributes: Vec<(&str, &str)> = own.to_vec();
        match self.look {
            Look::Page => attributes.push(("class", class)),
            Look::Paper => {
                for &(name, value) in class.split(' ').flat_map(printed) {
                    attributes.push((name, value));
                }
            }
        }
        self.html.open(tag, &attributes).text(text).close(tag);
    }

    pub fn path(&mut self, class: &str, d: &str, own: &[(&str, &str)]) {
        let mut attributes = own.to_vec();
        attributes.push(("d", d));
        self.shape("path", class, &attributes, "");
    }

    pub fn line(&mut self, class: &str, from: (f64, f64), to: (f64, f64)) {
        let d = format!("M{} {}L{} {}", n(from.0), n(from.1), n(to.0), n(to.1));
        self.path(class, &d, &[]);
    }

    pub fn circle(&mut self, class: &str, at: (f64, f64), radius: f64) {
        let (x, y, r) = (n(at.0), n(at.1), n(radius));
        self.shape("circle", class, &[("cx", &x), ("cy", &y), ("r", &r)], "");
    }

    pub fn text(&mut self, class: &str, at: (f64, f64), text: &str, own: &[(&str, &str)]) {
        let (x, y) = (n(at.0), n(at.1));
        let mut attributes = own.to_vec();
        attributes.extend([("x", x.as_str()), ("y", &y)]);
        self.shape("text", class, &attributes, text);
    }
}

/// What a class of the style sheet is on paper.
fn printed(class: &str) -> &'static [(&'static str, &'static str)] {
    match class {
        "grid" => &[("stroke", "#ccc"), ("fill", "none")],
        "axis-line" => &[("stroke", "#000"), ("fill", "none")],
        "band" => &[("fill", "#ddd")],
        "series" => &[("fill", "none"), ("stroke", "#000")],
        "solid" => &[("stroke-width", "2")],
        "dashed" => &[("stroke-width", "1.5"), ("stroke-dasharray", "6 4")],
        "dotted" => &[("stroke-width", "1.5"), ("stroke-dasharray", "1.5 3")],
        "dashdot" => &[("stroke-width", "1.5"), ("stroke-dasharray", "8 3 1.5 3")],
        "thin" => &[("stroke-width", "0.8")],
        "bar-solid" => &[("fill", "#444"), ("stroke", "#000")],
        "bar-thin" => &[("fill", "#bbb"), ("stroke", "#000")],
        "bar-dotted" => &[("fill", "#fff"), ("stroke", "#000")],
        "bar-dashed" => &[("stroke", "#000")],
        "end" => &[("text-anchor", "end")],
        "middle" => &[("text-anchor", "middle")],
        _ => &[],
    }
}
