//! The network as a list, for narrow windows: the order of the cable from top to bottom.

use shared::proto::{DdcShape, LineState};

use crate::components::ne107::Sign;
use crate::format::count;
use crate::markup::Markup;
use crate::markup::device::sign;
use crate::network::state::cable::Stretch;
use crate::network::state::picture::{Mark, Picture};

/// Units that stand together from this number on.
const RUN: usize = 6;

/// Draws the list. `chosen` is the place of the unit under the cursor.
pub fn line(html: &mut Markup, picture: &Picture, chosen: Option<usize>) {
    html.open(
        "ol",
        &[("class", "cable-list"), ("data-testid", "cable-list")],
    );
    port(html, picture, 0);
    for (from, to) in picture.runs(RUN) {
        for mark in picture.marks.iter().filter(|m| m.from == from) {
            broken(html, *mark);
        }
        units(html, picture, (from, to), chosen);
    }
    let n = picture.nodes.len();
    for mark in picture.marks.iter().filter(|m| m.from == n) {
        broken(html, *mark);
    }
    if picture.shape == DdcShape::Loop {
        port(html, picture, 1);
    } else {
        html.node("li", "cable-host quiet", "End of the cable");
    }
    html.close("ol");
}

fn port(html: &mut Markup, picture: &Picture, at: usize) {
    html.open("li", &[("class", "cable-host")]);
    match picture.ports.get(at) {
        Some(state) => {
            html.text(&format!("Host port {}", at + 1));
            if *state == Some(LineState::Down) {
                html.text(" ");
                sign(html, Sign::Failure, "16");
                html.text(" down");
            }
        }
        None => {
            html.text("Back at the host, no second port");
        }
    }
    html.close("li");
}

fn broken(html: &mut Markup, mark: Mark) {
    let kind = if mark.certain { "certain" } else { "possible" };
    html.open(
        "li",
        &[
            ("class", "cable-break"),
            ("data-testid", "break"),
            ("data-kind", kind),
            ("data-from", &mark.from.to_string()),
            ("data-to", &mark.to.to_string()),
        ],
    );
    if mark.certain {
        sign(html, Sign::Failure, "18");
        html.text(" Break or short here");
    } else {
        sign(html, Sign::OutOfSpecification, "18");
        html.text(" Break or short possible here");
    }
    html.close("li");
}

/// One unit, or a run of units that are alike.
fn units(html: &mut Markup, picture: &Picture, (from, to): (usize, usize), chosen: Option<usize>) {
    let (Some(first), Some(last)) = (picture.nodes.get(from), picture.nodes.get(to)) else {
        return;
    };
    let cable = picture
        .stretches
        .get(from + 1)
        .or_else(|| picture.stretches.get(from))
        .copied()
        .unwrap_or(Stretch::Unknown);
    let class = format!("cable-units {}", cable.class());
    html.open("li", &[("class", &class)]);
    let single = from == to;
    let place = from.to_string();
    let mut attributes = vec![
        ("class", "cable-unit"),
        ("data-act", "unit"),
        ("data-testid", "line-unit"),
        ("data-at", &place),
    ];
    if single && chosen == Some(from) {
        attributes.push(("aria-current", "true"));
    }
    html.open(if single { "button" } else { "span" }, &attributes);
    if single {
        html.node("b", "", &first.unit.to_string());
        html.text(" ").text(&first.tag);
    } else {
        html.node("b", "", &format!("{} \u{2026} {}", first.unit, last.unit));
        let many = u64::try_from(to - from + 1).unwrap_or(0);
        html.text(" ").node("span", "quiet", &count(many, "unit"));
    }
    html.open("span", &[("class", "cable-words")]);
    if let Some(mark) = first.health.sign() {
        sign(html, mark, "16");
        html.text(" ");
    }
    html.text(first.reach.words(picture.ports.len()));
    if single && !first.words.is_empty() {
        html.text(", ").text(&first.words);
    }
    html.close("span");
    html.close(if single { "button" } else { "span" })
        .close("li");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::picture::tests::broken;

    #[test]
    fn the_break_stands_between_its_units() {
        let mut html = Markup::new();
        line(&mut html, &broken(), Some(0));
        let html = html.finish();
        let at = |text: &str| html.find(text).unwrap_or_else(|| panic!("{text}: {html}"));
        assert!(at("<b class=\"\">3</b>") < at("data-testid=\"break\""));
        assert!(at("data-testid=\"break\"") < at("<b class=\"\">4</b>"));
        assert!(at("Host port 1") < at("Host port 2"));
        assert!(html.contains("answers on port 2 only, Open"));
        assert!(html.contains("Combined fault"));
    }

    #[test]
    fn many_units_are_few_lines() {
        let faults: Vec<_> = (1..=250)
            .map(|u| (u, [Some(u > 99), Some(u < 100)]))
            .collect();
        let mark = Mark {
            from: 99,
            to: 99,
            certain: true,
        };
        let picture = Picture::of_faults(&faults, DdcShape::Loop, 2, vec![mark]);
        let mut html = Markup::new();
        line(&mut html, &picture, None);
        let html = html.finish();
        assert_eq!(html.matches("<li").count(), 5);
        assert!(html.contains("1 \u{2026} 99") && html.contains("151 units"));
    }
}
