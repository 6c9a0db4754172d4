//! Buttons, lists of choices and boxes to tick; what they do is told by their `data-act`.

use super::Markup;
use crate::components::icon::Glyph;

/// A button.
#[derive(Clone, Copy, Debug, Default)]
pub struct Button<'a> {
    /// Name of what it does.
    pub act: &'a str,
    /// Its `data-testid`.
    pub testid: &'a str,
    /// Its words.
    pub words: &'a str,
    /// Its icon.
    pub glyph: Option<Glyph>,
    /// For a button that stays pressed.
    pub pressed: Option<bool>,
    /// True if it can't be used now.
    pub disabled: bool,
    /// True if it is not shown now.
    pub hidden: bool,
}

impl Button<'_> {
    /// Draws it.
    pub fn draw(&self, html: &mut Markup) {
        let mut attributes = vec![
            ("class", "button"),
            ("data-act", self.act),
            ("data-testid", self.testid),
        ];
        if let Some(pressed) = self.pressed {
            attributes.push(("aria-pressed", if pressed { "true" } else { "false" }));
        }
        if self.disabled {
            attributes.push(("disabled", ""));
        }
        if self.hidden {
            attributes.push(("hidden", ""));
        }
        html.open("button", &attributes);
        if let Some(glyph) = self.glyph {
            html.icon(glyph);
        }
        html.text(self.words).close("button");
    }
}

/// A list of choices.
#[derive(Clone, Copy, Debug, Default)]
pub struct Choice<'a> {
    /// Name of what it sets.
    pub act: &'a str,
    /// Its `data-testid`.
    pub testid: &'a str,
    /// Its name, also the words of the empty choice unless [`none`](Self::none) has others.
    pub label: &'a str,
    /// Words of the empty choice; empty to use the label.
    pub none: &'a str,
    /// The present choice.
    pub value: &'a str,
    /// True for a visible label before the list.
    pub labelled: bool,
    /// More about it.
    pub title: &'a str,
}

impl Choice<'_> {
    /// Draws it with its choices: value and words.
    pub fn draw<'c>(&self, html: &mut Markup, choices: impl Iterator<Item = (&'c str, &'c str)>) {
        if self.labelled {
            html.open("label", &[("class", "choice"), ("title", self.title)]);
            html.node("span", "", self.label);
        }
        html.open(
            "select",
            &[
                ("data-act", self.act),
                ("data-testid", self.testid),
                ("data-value", self.value),
                ("aria-label", self.label),
            ],
        );
        let none = if self.none.is_empty() {
            self.label
        } else {
            self.none
        };
        html.open("option", &[("value", "")])
            .text(none)
            .close("option");
        for (value, words) in choices {
            let mut attributes = vec![("value", value)];
            if value == self.value {
                attributes.push(("selected", ""));
            }
            html.open("option", &attributes).text(words).close("option");
        }
        html.close("select");
        if self.labelled {
            html.close("label");
        }
    }
}

/// A box to tick.
pub fn tick(html: &mut Markup, act: &str, testid: &str, words: &str, on: bool) {
    html.open("label", &[("class", "check")]);
    let mut attributes = vec![
        ("type", "checkbox"),
        ("data-act", act),
        ("data-testid", testid),
        ("data-value", if on { "on" } else { "" }),
    ];
    if on {
        attributes.push(("checked", ""));
    }
    html.open("input", &attributes).text(words).close("label");
}

/// A field to search with.
pub fn search(html: &mut Markup, act: &str, testid: &str, words: &str, value: &str) {
    html.open(
        "input",
        &[
            ("type", "search"),
            ("class", testid),
            ("data-act", act),
            ("data-testid", testid),
            ("data-find", ""),
            ("data-value", value),
            ("value", value),
            ("placeholder", words),
            ("aria-label", words),
        ],
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn controls_say_what_they_do() {
        let mut html = Markup::new();
        let button = Button {
            act: "pause",
            words: "Pause",
            pressed: Some(true),
            ..Button::default()
        };
        button.draw(&mut html);
        let choice = Choice {
            act: "table",
            label: "Table",
            value: "coil",
            ..Choice::default()
        };
        choice.draw(
            &mut html,
            [("coil", "Coil"), ("input", "Input")].into_iter(),
        );
        tick(&mut html, "reserved", "show-reserved", "Reserved", false);
        let html = html.finish();
        assert!(html.contains("aria-pressed=\"true\">Pause"));
        assert!(html.contains("<option value=\"coil\" selected=\"\">Coil"));
        assert!(!html.contains("checked"));
    }
}
