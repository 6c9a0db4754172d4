//! A frame in a list, the head of a frame, and its problems.

#[cfg(feature = "hart")]
use shared::frame::Framing;
use shared::frame::Role;
use shared::place::Place;
use shared::problem::Problem;

use super::Markup;
use crate::components::icon::Glyph;
use crate::format::{count, thousands};
use crate::state::summary::{Summary, function, role};
use crate::state::work::Shown;

/// True in the program that shows HART frames, and no others.
const HART: bool = cfg!(feature = "hart");

/// What stands beside a frame in its list.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Beside {
    /// Offset or time.
    pub place: String,
    /// Time from the request to this answer; `None` for a list without that column.
    pub latency: Option<String>,
}

/// Names of the columns of a list of frames.
#[must_use]
pub fn head(place: &str, latency: bool) -> String {
    let mut html = Markup::new();
    let latency = latency.then_some("Latency");
    for (class, text) in [
        ("num", "#"),
        ("num", place),
        ("", ""),
        ("num", if HART { "Address" } else { "Unit" }),
        ("", if HART { "Command" } else { "Function" }),
        ("", "About"),
    ] {
        html.node("span", class, text);
    }
    if let Some(latency) = latency {
        html.node("span", "num", latency);
    }
    html.node("span", "num", "Bytes").node("span", "", "");
    html.finish()
}

/// One frame.
pub fn row(html: &mut Markup, index: u32, summary: &Summary, beside: &Beside) {
    let frame = summary.frame;
    let noise = frame.is_noise();
    let mut class = String::from("frame-row");
    for (is, name) in [
        (noise, " noise"),
        (frame.role == Role::Exception, " exception"),
        (beside.latency.is_some(), " with-latency"),
    ] {
        if is {
            class.push_str(name);
        }
    }
    html.open(
        "div",
        &[
            ("class", &class),
            ("data-testid", "frame-row"),
            ("data-index", &index.to_string()),
            ("data-role", frame.role.key()),
        ],
    );
    html.node("span", "num quiet", &thousands(u64::from(index)));
    html.node("span", "num mono", &beside.place);
    pair(html, frame.role, frame.pair());
    html.node("span", "num unit-address", &summary.unit);
    html.open("span", &[("class", "frame-function")]);
    if !summary.code.is_empty() {
        html.node("code", "", &summary.code).text(" ");
    }
    html.text(summary.function).close("span");
    html.node("span", "frame-about", &summary.detail);
    if let Some(latency) = &beside.latency {
        html.node("span", "num", latency);
    }
    html.node("span", "num", &thousands(u64::from(frame.len)));
    html.open("span", &[("class", "frame-mark")]);
    if let Some(severity) = summary.worst {
        html.severity(severity);
    }
    html.close("span").close("div");
}

fn pair(html: &mut Markup, kind: Role, pair: Option<u32>) {
    let glyph = match kind {
        Role::Request => Glyph::Right,
        Role::Response | Role::Exception | Role::Burst => Glyph::Left,
        Role::Unknown | Role::Noise => {
            let mark = if kind == Role::Noise { "" } else { "?" };
            html.open("span", &[("class", "pair alone"), ("title", role(kind))]);
            html.text(mark).close("span");
            return;
        }
    };
    match pair {
        Some(pair) => {
            let words = format!("{}, goes with frame {pair}", role(kind));
            html.open(
                "button",
                &[
                    ("class", "pair"),
                    ("tabindex", "-1"),
                    ("title", &words),
                    ("aria-label", &words),
                    ("data-pair", &pair.to_string()),
                ],
            );
            html.icon(glyph).close("button");
        }
        None => {
            let words = format!("{}, without its other half", role(kind));
            html.open("span", &[("class", "pair alone"), ("title", &words)]);
            html.icon(glyph).close("span");
        }
    }
}

/// Title, place and partner of a frame, ways to copy it, and its problems.
pub fn head_of(html: &mut Markup, shown: &Shown, aside: &str) {
    html.open("header", &[("class", "detail-head")])
        .open("div", &[]);
    title(html, shown, aside);
    html.close("div").open("div", &[("class", "actions")]);
    html.node("span", "quiet", "Copy");
    for form in ["Hex", "Text", "JSON"] {
        html.open(
            "button",
            &[
                ("class", "button"),
                ("data-copy", form),
                (
                    "data-testid",
                    &format!("copy-{}", form.to_ascii_lowercase()),
                ),
                ("aria-label", &format!("Copy as {form}")),
            ],
        );
        html.open("span", &[("aria-live", "polite")])
            .text(form)
            .close("span")
            .close("button");
    }
    html.close("div").close("header");
    html.open("ul", &[("class", "frame-problems")]);
    problems(html, shown);
    html.close("ul");
}

fn title(html: &mut Markup, shown: &Shown, aside: &str) {
    let frame = shown.frame;
    html.open("h2", &[]);
    html.node("span", "quiet", &format!("#{} ", shown.index));
    if frame.is_noise() {
        html.text("Noise")
            .close("h2")
            .open("p", &[("class", "quiet")]);
    } else {
        let (function, who) = about(shown);
        html.text(&format!("{function} · {}", role(frame.role)));
        html.close("h2").open("p", &[("class", "quiet")]);
        html.text(&who).text(" · ");
    }
    html.text(&format!(
        "offset {} · {} ",
        thousands(frame.offset),
        count(u64::from(frame.len), "byte")
    ));
    if let Some(pair) = frame.pair() {
        let words = if pair < shown.index {
            "· answers"
        } else {
            "· answered by"
        };
        html.text(words).text(" ").open(
            "button",
            &[
                ("class", "link"),
                ("data-testid", "frame-pair"),
                ("data-pair", &pair.to_string()),
            ],
        );
        html.text(&format!("frame {pair}")).close("button");
    }
    html.text(aside).close("p");
}

/// Name of the function, and whom a frame is about.
fn about(shown: &Shown) -> (&'static str, String) {
    #[cfg(feature = "hart")]
    if !Framing::MODBUS.contains(&shown.context.framing) {
        use crate::hart::state::summary::{title, who};
        return (title(&shown.decoded), who(&shown.decoded));
    }
    if !cfg!(feature = "maps") {
        return ("Frame", String::new());
    }
    let frame = shown.frame;
    let who = format!("unit {} · function {:02X}", frame.unit, frame.function);
    (function(&frame), who)
}

/// The problems of a frame, each a button that shows the bytes.
fn problems(html: &mut Markup, shown: &Shown) {
    for (at, problem) in shown.decoded.problems().iter().enumerate() {
        html.open("li", &[]).open(
            "button",
            &[
                ("class", "problem"),
                ("data-testid", "frame-problem"),
                ("data-problem", &at.to_string()),
                ("data-code", problem.code()),
            ],
        );
        html.severity(problem.severity());
        html.node("span", "", &problem.to_string());
        html.node("span", "quiet where", &place_words(problem));
        html.close("button").close("li");
    }
}

/// A problem in the list of a whole capture.
pub fn problem_row(html: &mut Markup, problem: &Problem, place: &str) {
    html.open(
        "div",
        &[
            ("class", "problem"),
            ("data-testid", "problem"),
            ("data-code", problem.code()),
        ],
    );
    let words = problem.to_string();
    html.severity(problem.severity());
    html.node("span", "where", place);
    html.open("span", &[("class", "problem-words"), ("title", &words)]);
    html.text(&words).close("span").close("div");
}

/// Where a problem is, within its frame.
#[must_use]
pub fn place_words(problem: &Problem) -> String {
    let Place { start, len } = problem.place;
    match len {
        0 => format!("after byte {}", start.saturating_sub(1)),
        1 => format!("byte {start}"),
        _ => format!("bytes {start} to {}", problem.place.end().saturating_sub(1)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;
    use crate::state::summary::summary;
    use shared::decode::Context;
    use shared::device::Device;
    use shared::tree::Decoded;

    const POLL: &[u8] = b"7D0300070003BFF6 7D0306003D084400003E07 7D0300070003BFF7";

    #[test]
    fn a_row_says_what_the_frame_is() {
        let loaded = load(POLL, None);
        let mut html = Markup::new();
        let mut scratch = Decoded::default();
        let sum = summary(&loaded.session, 1, &Context::default(), &mut scratch).unwrap();
        row(&mut html, 1, &sum, &Beside::default());
        let html = html.finish();
        assert!(html.contains("data-testid=\"frame-row\""));
        assert!(html.contains("data-pair=\"0\""));
        assert!(html.contains("Read holding registers"));
    }

    #[test]
    fn head_and_problems() {
        let loaded = load(POLL, None);
        let shown = Shown::of(&loaded.session, 2, Device::None).unwrap();
        let mut html = Markup::new();
        head_of(&mut html, &shown, "");
        let html = html.finish();
        assert!(html.contains("#2 ") && html.contains("data-problem=\"0\""));
        assert!(html.contains("data-testid=\"copy-json\""));
        assert!(head("Offset", false).contains("Offset"));
    }
}
