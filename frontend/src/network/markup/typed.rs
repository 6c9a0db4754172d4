//! The fault table that is filled in by hand.

use crate::markup::Markup;
use crate::markup::control::{Button, Choice};
use crate::network::state::typed::{EXAMPLES, SHAPES, Typed};

/// Shape, number of units, examples.
pub fn controls(html: &mut Markup, typed: &Typed, live: bool) {
    html.open("label", &[("class", "choice")]).text("Cable");
    html.open(
        "select",
        &[
            ("data-act", "shape"),
            ("data-testid", "typed-shape"),
            ("data-value", typed.shape_key()),
            ("aria-label", "How the cable runs"),
        ],
    );
    for (key, words, shape) in SHAPES {
        let mut attributes = vec![("value", key)];
        if shape == typed.shape {
            attributes.push(("selected", ""));
        }
        html.open("option", &attributes).text(words).close("option");
    }
    html.close("select").close("label");
    let units = typed.units.len().to_string();
    html.open("label", &[("class", "choice")]).text("Units");
    html.open(
        "input",
        &[
            ("type", "number"),
            ("min", "1"),
            ("max", "250"),
            ("data-act", "units"),
            ("data-testid", "typed-units"),
            ("data-value", &units),
            ("value", &units),
        ],
    );
    html.close("label");
    Choice {
        act: "example",
        testid: "typed-example",
        label: "Example of the guide",
        ..Choice::default()
    }
    .draw(html, EXAMPLES.iter().map(|(key, ..)| (*key, *key)));
    if live {
        Button {
            act: "take",
            testid: "typed-take",
            words: "Take from the network",
            ..Button::default()
        }
        .draw(html);
    }
    Button {
        act: "clear",
        testid: "typed-clear",
        words: "No faults",
        ..Button::default()
    }
    .draw(html);
}

/// The bits, to be turned by clicking.
pub fn grid(html: &mut Markup, typed: &Typed) {
    html.open(
        "ol",
        &[
            ("class", "typed-grid"),
            ("data-testid", "typed-grid"),
            (
                "aria-label",
                "Faults of the units in the order of the cable; pressed is a fault",
            ),
        ],
    );
    let ports = ["A", "B"];
    for (at, (unit, faults)) in typed.units.iter().enumerate() {
        let place = at.to_string();
        html.open("li", &[]);
        html.node("span", "typed-unit", &unit.to_string());
        for (port, (name, fault)) in ports.iter().zip(faults).take(typed.ports).enumerate() {
            let pressed = match fault {
                Some(true) => "true",
                Some(false) => "false",
                None => "mixed",
            };
            let (label, number) = (format!("Unit {unit}, fault on {name}"), port.to_string());
            html.open(
                "button",
                &[
                    ("class", "typed-bit"),
                    ("data-act", "bit"),
                    ("data-testid", "typed-bit"),
                    ("data-at", &place),
                    ("data-port", &number),
                    ("aria-pressed", pressed),
                    ("aria-label", &label),
                ],
            );
            html.text(name).text(" ").text(match fault {
                Some(true) => "1",
                Some(false) => "0",
                None => "\u{2013}",
            });
            html.close("button");
        }
        html.close("li");
    }
    html.close("ol");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_say_what_they_are() {
        let typed = Typed::example("3").unwrap();
        let mut html = Markup::new();
        grid(&mut html, &typed);
        controls(&mut html, &typed, false);
        let html = html.finish();
        assert_eq!(html.matches("typed-bit\" data-at").count(), 10);
        assert_eq!(html.matches("aria-pressed=\"true\"").count(), 5);
        assert!(html.contains("aria-label=\"Unit 4, fault on A\">A 1<"));
        assert!(html.contains("value=\"loop\" selected") && !html.contains("typed-take"));
        let line = Typed::example("7").unwrap();
        let mut html = Markup::new();
        grid(&mut html, &line);
        assert_eq!(html.finish().matches("typed-bit\" data-at").count(), 5);
    }
}
