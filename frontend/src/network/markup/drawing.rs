//! The network as a picture: host, ports, cable and units, breaks where they are.

use shared::proto::{DdcShape, LineState};

use super::{label, sign_at};
use crate::components::ne107::Sign;
use crate::markup::Markup;
use crate::network::state::cable::Stretch;
use crate::network::state::geometry::{DROP, Layout, WIDTH, layout};
use crate::network::state::net::Reach;
use crate::network::state::picture::{Node, Picture};

/// Draws a network. `chosen` is the place of the unit under the cursor.
pub fn drawing(html: &mut Markup, picture: &Picture, chosen: Option<usize>) {
    let lay = layout(picture.nodes.len(), picture.shape);
    let active = chosen.map(|at| format!("node-{at}"));
    let view = format!("0 0 {WIDTH} {}", lay.height);
    let mut attributes = vec![
        ("class", "ring"),
        ("viewBox", view.as_str()),
        ("role", "listbox"),
        ("tabindex", "0"),
        ("aria-label", "Units in the order of the cable"),
        ("data-testid", "ring"),
    ];
    if let Some(active) = &active {
        attributes.push(("aria-activedescendant", active));
    }
    html.open("svg", &attributes);
    cables(html, picture, &lay);
    host(html, picture, &lay);
    ends(html, picture, &lay);
    for (at, (node, place)) in picture.nodes.iter().zip(&lay.units).enumerate() {
        unit(html, picture, (at, node), *place, chosen == Some(at));
    }
    for mark in &picture.marks {
        let Some(place) = lay.middles.get(mark.at()) else {
            continue;
        };
        let (kind, sign, word) = if mark.certain {
            ("certain", Sign::Failure, "break")
        } else {
            ("possible", Sign::OutOfSpecification, "break?")
        };
        let (from, to) = (mark.from.to_string(), mark.to.to_string());
        html.open(
            "g",
            &[
                ("class", "break"),
                ("data-testid", "break"),
                ("data-kind", kind),
                ("data-from", &from),
                ("data-to", &to),
            ],
        );
        sign_at(html, sign, *place);
        // Inside a turn of the cable, above a straight stretch; without room the letter alone.
        let [from_end, to_end] = ends_of(mark.at(), &lay);
        let words = format!("{word} {}", sign.letter());
        if from_end.1 != to_end.1 {
            let (class, x) = if place.0 < WIDTH / 2 {
                ("break-text start", place.0 + 14)
            } else {
                ("break-text end", place.0 - 14)
            };
            label(html, class, (x, place.1 + 4), &words);
        } else if (from_end.0 - to_end.0).abs() < 72 {
            label(html, "break-text", (place.0, place.1 - 13), sign.letter());
        } else {
            label(html, "break-text", (place.0, place.1 - 15), &words);
        }
        html.close("g");
    }
    html.close("svg");
}

/// The ends of a stretch of the cable.
fn ends_of(stretch: usize, lay: &Layout) -> [(i32, i32); 2] {
    let from = stretch.checked_sub(1).and_then(|at| lay.units.get(at));
    [
        from.copied().unwrap_or(lay.ports[0]),
        lay.units.get(stretch).copied().unwrap_or(lay.ports[1]),
    ]
}

/// What the lines of the cable mean, where there are two kinds.
pub fn legend(html: &mut Markup, picture: &Picture) {
    if picture.ports.len() < 2 || picture.stretches.iter().all(|s| *s == Stretch::Good) {
        return;
    }
    for (class, words) in [
        ("good", "the signal of both ports passes"),
        ("one", "of one port only"),
        ("dead", "of none"),
    ] {
        html.open("span", &[("class", "legend")]);
        html.open(
            "svg",
            &[
                ("class", "ring legend-line"),
                ("viewBox", "0 0 30 8"),
                ("aria-hidden", "true"),
            ],
        );
        let kind = format!("cable {class}");
        let mut paths = vec![kind.as_str()];
        if class == "good" {
            paths.push("cable core");
        }
        for class in paths {
            html.open("path", &[("class", class), ("d", "M0 4H30")])
                .close("path");
        }
        html.close("svg").text(words).close("span");
    }
}

/// The cable, stretches of one kind in one path.
fn cables(html: &mut Markup, picture: &Picture, lay: &Layout) {
    let twin = picture.ports.len() > 1 && picture.shape == DdcShape::Loop;
    let kinds = [
        Stretch::Unknown,
        Stretch::Dead,
        Stretch::One(1),
        Stretch::One(2),
        Stretch::Good,
    ];
    for kind in kinds {
        let path: String = lay
            .stretches
            .iter()
            .zip(&picture.stretches)
            .filter(|(_, stretch)| **stretch == kind)
            .map(|(path, _)| path.as_str())
            .collect();
        if path.is_empty() {
            continue;
        }
        let class = match kind {
            Stretch::Good if !twin => "cable one",
            kind => kind.class(),
        };
        html.open("path", &[("class", class), ("d", &path)])
            .close("path");
        // Two lines where the signal of both ports passes.
        if kind == Stretch::Good && twin {
            html.open("path", &[("class", "cable core"), ("d", &path)])
                .close("path");
        }
    }
    for (at, path) in lay.stretches.iter().enumerate() {
        if picture.marks.iter().any(|m| m.covers(at)) {
            html.open("path", &[("class", "cable broken"), ("d", path)])
                .close("path");
        }
    }
}

/// The host and its ports.
fn host(html: &mut Markup, picture: &Picture, lay: &Layout) {
    let last = lay.ports[1].1;
    let (x, width, y, height) = ("8", "96", "10", (last + 14).to_string());
    html.open(
        "rect",
        &[
            ("class", "host"),
            ("x", x),
            ("y", y),
            ("width", width),
            ("height", &height),
            ("rx", "4"),
        ],
    )
    .close("rect");
    if last > lay.ports[0].1 {
        let middle = i32::midpoint(lay.ports[0].1, last);
        label(html, "host-text", (56, middle + 4), "Host");
    }
    for (at, port) in picture.ports.iter().enumerate() {
        let Some((px, py)) = lay.ports.get(at) else {
            continue;
        };
        let class = if *port == Some(LineState::Down) {
            "port down"
        } else {
            "port"
        };
        let (left, top) = ((px - 9).to_string(), (py - 8).to_string());
        html.open(
            "rect",
            &[
                ("class", class),
                ("x", &left),
                ("y", &top),
                ("width", "18"),
                ("height", "16"),
                ("rx", "3"),
            ],
        )
        .close("rect");
        let number = (at + 1).to_string();
        label(html, "port-number", (*px, py + 4), &number);
        if *port == Some(LineState::Down) {
            sign_at(html, Sign::Failure, (78, *py));
            label(html, "port-text", (38, py + 4), "down F");
        } else {
            let channel = if at == 0 { "Port A" } else { "Port B" };
            label(html, "port-text", (52, py + 4), channel);
        }
    }
}

/// How an open cable ends, and the other end of a loop that only one port drives.
fn ends(html: &mut Markup, picture: &Picture, lay: &Layout) {
    let Some((x, y)) = lay.units.last().copied() else {
        return;
    };
    if picture.shape != DdcShape::Loop {
        let outwards = lay
            .units
            .len()
            .checked_sub(2)
            .and_then(|at| lay.units.get(at))
            .is_none_or(|before| before.0 < x || before.1 != y);
        let (end, text) = if outwards {
            (x + 26, x + 30)
        } else {
            (x - 26, x - 30)
        };
        let path = format!("M{x} {y}H{end}M{end} {}V{}", y - 7, y + 7);
        html.open("path", &[("class", "cable-end"), ("d", &path)])
            .close("path");
        let class = if outwards {
            "end-text"
        } else {
            "end-text left"
        };
        label(html, class, (text, y + 4), "end");
    }
}

/// A unit. Grey is normal; what is not has a sign and its letter.
fn unit(
    html: &mut Markup,
    picture: &Picture,
    (at, node): (usize, &Node),
    (x, y): (i32, i32),
    chosen: bool,
) {
    let hangs = picture.shape == DdcShape::MultiDrop;
    let middle = if hangs { y + DROP } else { y };
    let class = match (node.reach, chosen) {
        (Reach::Lost, false) => "node lost",
        (Reach::Lost, true) => "node lost chosen",
        (Reach::Unknown, false) => "node unknown",
        (Reach::Unknown, true) => "node unknown chosen",
        (_, false) => "node",
        (_, true) => "node chosen",
    };
    let (id, place, number) = (format!("node-{at}"), at.to_string(), node.unit.to_string());
    html.open(
        "g",
        &[
            ("class", class),
            ("id", &id),
            ("role", "option"),
            ("aria-selected", if chosen { "true" } else { "false" }),
            ("aria-label", &picture.name(at)),
            ("data-act", "unit"),
            ("data-testid", "node"),
            ("data-at", &place),
            ("data-unit", &number),
        ],
    );
    html.open("title", &[])
        .text(&picture.name(at))
        .close("title");
    let rect = |html: &mut Markup, class: &str, half: i32, (up, high): (i32, i32)| {
        html.open(
            "rect",
            &[
                ("class", class),
                ("x", &(x - half).to_string()),
                ("y", &(middle - up).to_string()),
                ("width", &(2 * half).to_string()),
                ("height", &high.to_string()),
                ("rx", "3"),
            ],
        )
        .close("rect");
    };
    rect(html, "hit", 17, (17, 46));
    if hangs {
        let stub = format!("M{x} {y}V{middle}");
        html.open("path", &[("class", "stub"), ("d", &stub)])
            .close("path");
    }
    rect(html, "box", 7, (7, 14));
    if let Some(sign) = node.health.sign() {
        sign_at(html, sign, (x, middle));
        if !sign.letter().is_empty() {
            // On a multi-drop line the trunk runs above.
            let beside = if hangs {
                (x + 15, middle + 4)
            } else {
                (x, middle - 13)
            };
            label(html, "letter", beside, sign.letter());
        }
    }
    label(html, "number", (x, middle + 23), &number);
    html.close("g");
}

/// Where the poll is: a ring around the unit, drawn over the picture so that the picture stays.
pub fn poll(html: &mut Markup, units: usize, shape: DdcShape, at: Option<(usize, u8)>) {
    let lay = layout(units, shape);
    let view = format!("0 0 {WIDTH} {}", lay.height);
    html.open(
        "svg",
        &[
            ("class", "ring poll"),
            ("viewBox", &view),
            ("aria-hidden", "true"),
        ],
    );
    if let Some(((x, y), port)) = at.and_then(|(at, port)| Some((*lay.units.get(at)?, port))) {
        let y = if shape == DdcShape::MultiDrop {
            y + DROP
        } else {
            y
        };
        html.open(
            "circle",
            &[
                ("class", "now"),
                ("data-testid", "poll"),
                ("data-port", &port.to_string()),
                ("cx", &x.to_string()),
                ("cy", &y.to_string()),
                ("r", "13"),
            ],
        )
        .close("circle");
        // The port that is used.
        if let Some((px, py)) = lay.ports.get(usize::from(port).saturating_sub(1)) {
            html.open(
                "rect",
                &[
                    ("class", "now"),
                    ("x", &(px - 12).to_string()),
                    ("y", &(py - 11).to_string()),
                    ("width", "24"),
                    ("height", "22"),
                    ("rx", "5"),
                ],
            )
            .close("rect");
        }
    }
    html.close("svg");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::picture::tests::broken;

    fn drawn(picture: &Picture) -> String {
        let mut html = Markup::new();
        drawing(&mut html, picture, Some(3));
        html.finish()
    }

    #[test]
    fn a_break_is_marked_between_its_units() {
        let html = drawn(&broken());
        assert_eq!(html.matches("data-testid=\"node\"").count(), 5);
        assert!(html.contains("data-kind=\"certain\" data-from=\"3\" data-to=\"3\""));
        assert_eq!(html.matches("cable broken").count(), 1);
        assert!(html.contains("break F"), "colour, shape and letter");
        let mut lines = Markup::new();
        legend(&mut lines, &broken());
        assert_eq!(lines.finish().matches("legend-line").count(), 3);
        assert!(html.contains("aria-activedescendant=\"node-3\""));
        assert_eq!(html.matches("aria-selected=\"true\"").count(), 1);
        assert!(!html.contains("style="));
    }

    #[test]
    fn normal_is_quiet() {
        let faults: Vec<_> = (1..=250).map(|u| (u, [Some(false), Some(false)])).collect();
        let good = Picture::of_faults(&faults, DdcShape::Loop, 2, Vec::new());
        let html = drawn(&good);
        assert_eq!(html.matches("data-testid=\"node\"").count(), 250);
        assert_eq!(html.matches("class=\"cable").count(), 2, "one path, twice");
        let mut none = Markup::new();
        legend(&mut none, &good);
        assert_eq!(none.finish(), "");
        assert!(!html.contains("sign-"));
        assert!(html.len() < 250 * 1000, "{}", html.len());
    }

    #[test]
    fn an_open_cable_has_an_end_and_drops_hang() {
        let faults: Vec<_> = (1..=5).map(|u| (u, [Some(false), None])).collect();
        let line = Picture::of_faults(&faults, DdcShape::SingleEnded, 1, Vec::new());
        let html = drawn(&line);
        assert!(html.contains("cable-end") && !html.contains("stub"));
        let drop = Picture::of_faults(&faults, DdcShape::MultiDrop, 1, Vec::new());
        assert_eq!(drawn(&drop).matches("class=\"stub\"").count(), 5);
        let faults = [(1, [Some(true), Some(true)])];
        let lost = drawn(&Picture::of_faults(&faults, DdcShape::Loop, 2, Vec::new()));
        assert!(lost.contains("node lost") && lost.contains(">F</text>"));
    }

    #[test]
    fn the_poll_is_drawn_by_itself() {
        let mut html = Markup::new();
        poll(&mut html, 5, DdcShape::Loop, Some((4, 2)));
        assert!(html.finish().contains("data-port=\"2\""));
        let mut html = Markup::new();
        poll(&mut html, 5, DdcShape::Loop, Some((9, 1)));
        assert!(!html.finish().contains("circle"));
    }
}
