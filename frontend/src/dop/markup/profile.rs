//! The settings of a site: as a form, and what of them is assumed.

use shared::dop::profile::{BitWord, Ne107, ProfileProblem, Setting};
use shared::dop::{Profile, reading as reading_of};

use super::{assumed, reading};
use crate::components::icon::Glyph;
use crate::dop::state::draft::{BitRow, Draft, Entry, LISTS, SECTIONS, Spec};
use crate::markup::Markup;
use crate::markup::control::Button;

/// The form. Fields are named by their key in `data-act`.
pub fn form(html: &mut Markup, draft: &Draft, problems: &[ProfileProblem]) {
    for (title, specs) in SECTIONS.iter().filter(|s| !s.1.is_empty()) {
        html.open("fieldset", &[("class", "profile-section")]);
        html.node("legend", "", title);
        for spec in *specs {
            field(html, spec, draft.get(spec.key), problems);
        }
        html.close("fieldset");
    }
    for (list, ((key, title, bits, reason), rows)) in LISTS.iter().zip(&draft.bits).enumerate() {
        html.open("fieldset", &[("class", "profile-section bit-names")]);
        html.open("legend", &[]);
        html.text(title).text(" ");
        why(html, reason);
        html.close("legend");
        html.node(
            "p",
            "quiet",
            &format!("Names of the {bits} bits. One without a name is shown by its number."),
        );
        for (at, row) in rows.iter().enumerate() {
            bit_row(html, list, at, row);
        }
        told(html, problems.iter().filter(|p| p.key.starts_with(key)));
        Button {
            act: &format!("add.{list}"),
            testid: &format!("add-{key}"),
            words: "Add a name",
            ..Button::default()
        }
        .draw(html);
        html.close("fieldset");
    }
}

fn field(html: &mut Markup, spec: &Spec, text: &str, problems: &[ProfileProblem]) {
    html.open(
        "label",
        &[("class", "profile-field"), ("data-key", spec.key)],
    );
    html.open("span", &[]);
    html.text(spec.label).text(" ");
    why(html, spec.reading);
    html.close("span");
    let act = format!("set.{}", spec.key);
    let testid = format!("profile-{}", spec.key);
    match spec.entry {
        Entry::Choice(choices) => {
            let none = format!("{} (assumed)", spec.default);
            let attributes = [
                ("data-act", act.as_str()),
                ("data-testid", &testid),
                ("data-value", text),
            ];
            html.open("select", &attributes);
            option(html, "", &none, text);
            for (value, words) in choices {
                option(html, value, words, text);
            }
            html.close("select");
        }
        Entry::Text | Entry::Number => {
            let mode = if spec.entry == Entry::Number {
                "numeric"
            } else {
                "text"
            };
            html.open(
                "input",
                &[
                    ("type", "text"),
                    ("inputmode", mode),
                    (
                        "class",
                        if spec.entry == Entry::Number {
                            "num"
                        } else {
                            ""
                        },
                    ),
                    ("data-act", &act),
                    ("data-testid", &testid),
                    ("data-value", text),
                    ("value", text),
                    ("placeholder", spec.default),
                    ("autocomplete", "off"),
                ],
            );
        }
    }
    html.close("label");
    told(html, problems.iter().filter(|p| p.key == spec.key));
}

fn option(html: &mut Markup, value: &str, words: &str, now: &str) {
    let mut attributes = vec![("value", value)];
    if value == now {
        attributes.push(("selected", ""));
    }
    html.open("option", &attributes).text(words).close("option");
}

fn why(html: &mut Markup, id: &str) {
    if let Some(found) = reading_of(id) {
        reading(html, found);
    }
}

fn told<'a>(html: &mut Markup, problems: impl Iterator<Item = &'a ProfileProblem>) {
    for problem in problems {
        html.open(
            "p",
            &[
                ("class", "profile-problem"),
                ("data-testid", "profile-problem"),
            ],
        );
        html.severity(shared::problem::Severity::Error);
        html.text(" ").text(&problem.text).close("p");
    }
}

fn bit_row(html: &mut Markup, list: usize, at: usize, row: &BitRow) {
    html.open("div", &[("class", "bit-row"), ("data-testid", "bit-row")]);
    for (what, label, text, class) in [
        ("bit", "Bit", &row.bit, "num bit-number"),
        ("name", "Name", &row.name, "bit-name"),
    ] {
        html.open(
            "input",
            &[
                ("type", "text"),
                ("class", class),
                ("data-act", &format!("bits.{list}.{at}.{what}")),
                ("data-value", text),
                ("value", text),
                ("placeholder", label),
                ("aria-label", label),
                ("autocomplete", "off"),
            ],
        );
    }
    html.open(
        "select",
        &[
            ("data-act", &format!("bits.{list}.{at}.ne107")),
            ("data-value", &row.ne107),
            ("aria-label", "NE 107 category"),
        ],
    );
    option(html, "", "no category", &row.ne107);
    for category in [
        Ne107::Failure,
        Ne107::CheckFunction,
        Ne107::OutOfSpecification,
        Ne107::Maintenance,
    ] {
        let words = format!("{} {}", category.letter(), category.label());
        option(html, category.letter(), &words, &row.ne107);
    }
    html.close("select");
    html.open(
        "button",
        &[
            ("class", "icon-button"),
            ("data-act", &format!("drop.{list}.{at}")),
            ("aria-label", "Remove this name"),
        ],
    );
    html.icon(Glyph::Clear).close("button").close("div");
}

/// Mistakes in the text, each with its line.
pub fn problems(html: &mut Markup, problems: &[ProfileProblem]) {
    if problems.is_empty() {
        html.node("p", "quiet", "The profile is valid.");
        return;
    }
    html.open("ul", &[("class", "object-problems")]);
    for problem in problems {
        html.open("li", &[("data-testid", "text-problem")]);
        html.severity(shared::problem::Severity::Error);
        html.text(" ").text(&problem.to_string()).close("li");
    }
    html.close("ul");
}

/// The settings that hold for a device, and which of them nobody made.
pub fn settings(html: &mut Markup, profile: &Profile, shift: Option<u8>) {
    let draft = Draft::of(profile);
    for (title, specs) in SECTIONS.iter().filter(|s| !s.1.is_empty()) {
        html.node("h3", "", title);
        html.open("dl", &[("class", "fact-list")]);
        for spec in *specs {
            let text = draft.get(spec.key);
            html.node("dt", "", spec.label);
            html.open("dd", &[("data-testid", "setting"), ("data-key", spec.key)]);
            if text.is_empty() {
                html.text(spec.default).text(" ");
                let learned = shift.filter(|_| spec.key == Setting::StatusShift.key());
                match learned {
                    Some(shift) => {
                        html.node("b", "", &format!("bit {shift}"));
                    }
                    None if spec.default != "not configured" && spec.key != "name" => assumed(html),
                    None => {}
                }
            } else {
                html.node("b", "", words_of(spec, text));
            }
            html.text(" ");
            why(html, spec.reading);
            html.close("dd");
        }
        html.close("dl");
    }
    for (word, (_, title, bits, _)) in [BitWord::Indicators, BitWord::Alarms, BitWord::Warnings]
        .into_iter()
        .zip(LISTS)
    {
        let named = (0..bits)
            .filter(|bit| !profile.bit(word, *bit).assumed)
            .count();
        html.node("h3", "", title);
        html.node("p", "quiet", &format!("{named} of {bits} bits are named."));
    }
}

fn words_of<'a>(spec: &Spec, text: &'a str) -> &'a str
where
    'static: 'a,
{
    match spec.entry {
        Entry::Choice(choices) => choices.iter().find(|c| c.0 == text).map_or(text, |c| c.1),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn mistakes_stand_beside_their_field() {
        let mut draft = Draft::default();
        draft.set("registers.request", "x".into());
        let problems = Profile::from_json(&draft.to_json()).unwrap_err();
        let html = drawn(|html| form(html, &draft, &problems));
        assert_eq!(
            html.matches("data-testid=\"profile-problem\"").count(),
            1,
            "{html}"
        );
        let after = html.split("data-key=\"registers.request\"").nth(1).unwrap();
        assert!(after.find("profile-problem").unwrap() < after.find("profile-field").unwrap());
        assert!(html.contains("title=\"Reading M7"));
        let list = drawn(|html| super::problems(html, &problems));
        assert!(
            list.contains("registers.request") && list.contains("line "),
            "{list}"
        );
    }

    #[test]
    fn what_nobody_set_is_assumed() {
        let profile =
            Profile::from_json(r#"{"temperature":"degF","registers":{"status":7}}"#).unwrap();
        let html = drawn(|html| settings(html, &profile, Some(12)));
        let of = |key: &str| {
            let start = format!("data-key=\"{key}\"");
            html.split(&start)
                .nth(1)
                .unwrap()
                .split("</dd>")
                .next()
                .unwrap()
                .to_owned()
        };
        assert!(of("temperature").contains("°F") && !of("temperature").contains("assumed"));
        assert!(of("time.unit").contains("assumed"));
        assert!(of("registers.status").contains(">7<"));
        assert!(of("registers.count").contains("not configured"));
        assert!(
            of("status.shift").contains("bit 12"),
            "{}",
            of("status.shift")
        );
    }

    #[test]
    fn names_of_bits_have_their_row() {
        let profile =
            Profile::from_json(r#"{"indicators":[{"bit":3,"name":"Vibration HI","ne107":"S"}]}"#);
        let draft = Draft::of(&profile.unwrap());
        let html = drawn(|html| form(html, &draft, &[]));
        assert_eq!(html.matches("data-testid=\"bit-row\"").count(), 1);
        assert!(html.contains("value=\"Vibration HI\"") && html.contains("value=\"S\" selected"));
    }
}
