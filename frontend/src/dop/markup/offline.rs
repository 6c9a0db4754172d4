//! Offline: what was pasted, which requests fit, which reads are in it, samples.

use shared::dop::{OBJECTS, Profile, Request};
use shared::problem::Severity;

use crate::dop::state::offline::{Item, Offline};
use crate::format::{millis, size};
use crate::markup::Markup;
use crate::markup::control::{Button, Choice};

/// Registers to try.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Identifier.
    pub key: &'static str,
    /// What people read.
    pub title: &'static str,
    /// What is to be seen in it.
    pub about: &'static str,
    /// The request word, 0 to detect.
    pub request: u16,
    /// The file.
    pub content: &'static str,
}

macro_rules! sample {
    ($key:literal, $request:literal, $title:literal, $about:literal) => {
        Sample {
            key: $key,
            title: $title,
            about: $about,
            request: $request,
            content: include_str!(concat!("../../../../static/samples/dop-", $key, ".txt")),
        }
    };
}

/// All samples, made by hand.
pub const SAMPLES: [Sample; 7] = [
    sample!(
        "torque",
        0x0191,
        "Torque of an open stroke",
        "Object 401: 100 points of largest, smallest, average and long-term torque"
    ),
    sample!(
        "temperature",
        0x225C,
        "Internal temperature, 12 months",
        "Object 604: nine of twelve points are valid, some below zero"
    ),
    sample!(
        "vibration",
        0x0002,
        "Time by vibration",
        "Object 2: two widths of bins, each with the time it last grew"
    ),
    sample!(
        "axes",
        0x0005,
        "Present vibration",
        "Object 5: three axes and the peak of their spectrum"
    ),
    sample!(
        "pst",
        0x00D1,
        "Partial stroke tests",
        "Object 209: counts, times and the reason of the last failure; found by its number of registers"
    ),
    sample!(
        "events",
        0x04B2,
        "Event log",
        "Object 1202: six events of four categories"
    ),
    sample!(
        "session",
        0x0000,
        "A session on the bus",
        "Modbus RTU: the request is written, the status polled, the data read in blocks"
    ),
];

/// The sample with this key.
#[must_use]
pub fn sample(key: &str) -> Option<&'static Sample> {
    SAMPLES.iter().find(|s| s.key == key)
}

/// The request that the user names, and samples.
pub fn choices(html: &mut Markup, request: Option<Request>, profile: &Profile, offline: &Offline) {
    let words: Vec<(String, String)> = OBJECTS
        .iter()
        .flat_map(|object| object.options.iter().map(move |choice| (object, choice)))
        .map(|(object, choice)| {
            let request = object.request(choice, profile);
            let option = if choice.label.is_empty() {
                String::new()
            } else {
                format!(", {}", choice.label)
            };
            (
                request.to_string(),
                format!("{} {}{option}", object.id, object.label),
            )
        })
        .collect();
    let value = request.map_or_else(String::new, |r| r.to_string());
    Choice {
        act: "request",
        testid: "dop-request",
        label: "Object",
        none: "Find out",
        value: &value,
        labelled: true,
        title: "Which object and option the registers are the answer to",
    }
    .draw(html, words.iter().map(|(w, l)| (w.as_str(), l.as_str())));
    html.open("label", &[("class", "choice")]);
    html.node("span", "", "Request word");
    html.open(
        "input",
        &[
            ("type", "search"),
            ("class", "mono request-word"),
            ("data-act", "word"),
            ("data-testid", "dop-word"),
            ("data-value", &value),
            ("value", &value),
            ("placeholder", "0x1001"),
            ("aria-label", "Request word in hexadecimal"),
            ("autocomplete", "off"),
        ],
    )
    .close("label");
    let samples = SAMPLES.iter().map(|s| (s.key, s.title));
    Choice {
        act: "sample",
        testid: "dop-sample",
        label: "Try a sample",
        ..Choice::default()
    }
    .draw(html, samples);
    html.open(
        "p",
        &[
            ("class", "found"),
            ("data-testid", "dop-found"),
            ("role", "status"),
        ],
    );
    html.text(&offline.said).close("p");
    Button {
        act: "clear",
        testid: "dop-clear",
        words: "Clear",
        hidden: offline.items.is_empty() && offline.problems.is_empty(),
        ..Button::default()
    }
    .draw(html);
}

/// What could not be used, and which requests fit if nobody said which.
pub fn doubts(html: &mut Markup, offline: &Offline, chosen: Option<Request>) {
    if !offline.problems.is_empty() {
        html.open("ul", &[("class", "object-problems")]);
        for problem in &offline.problems {
            html.open("li", &[("data-testid", "dop-problem")]);
            html.severity(Severity::Warning);
            html.text(" ").text(problem).close("li");
        }
        html.close("ul");
    }
    let Some(item) = offline.items.first().filter(|_| offline.registers) else {
        return;
    };
    let registers = item.decoded.kept.words.len();
    if offline.fits.is_empty() {
        if item.decoded.read.object.is_none() {
            html.open("p", &[("data-testid", "no-fit")]);
            html.text(&format!(
                "No object has an answer of {registers} registers. Choose the object above to see \
                 what of it fits."
            ))
            .close("p");
        }
        return;
    }
    html.open("p", &[("class", "fits"), ("data-testid", "dop-fits")]);
    html.text(&format!("Answers of {registers} registers: "));
    for fit in &offline.fits {
        let word = fit.request.to_string();
        let pressed = chosen == Some(fit.request);
        html.open(
            "button",
            &[
                ("class", "option"),
                ("data-act", "fit"),
                ("data-word", &word),
                ("data-testid", "dop-fit"),
                ("aria-pressed", if pressed { "true" } else { "false" }),
            ],
        );
        html.node("code", "quiet", &fit.object.id.to_string());
        html.text(" ").text(fit.object.label);
        if !fit.choice.label.is_empty() {
            html.text(", ").text(fit.choice.label);
        }
        if fit.times.1 > 0 {
            let words = format!(" {} of {} times possible", fit.times.0, fit.times.1);
            html.node("small", "quiet", &words);
        }
        html.close("button");
    }
    html.close("p");
}

/// The reads of a capture or a file, to choose from.
pub fn items(html: &mut Markup, offline: &Offline, chosen: usize) {
    html.open("ol", &[("class", "found-reads")]);
    for (at, item) in offline.items.iter().enumerate() {
        html.open("li", &[]);
        let here = at == chosen;
        html.open(
            "button",
            &[
                ("class", "found-read"),
                ("data-act", "item"),
                ("data-index", &at.to_string()),
                ("data-testid", "found-read"),
                ("aria-pressed", if here { "true" } else { "false" }),
            ],
        );
        found(html, item);
        html.close("button").close("li");
    }
    html.close("ol");
}

fn found(html: &mut Markup, item: &Item) {
    let read = &item.decoded.read;
    html.node("code", "quiet", &read.request.to_string());
    html.node("b", "", read.object.map_or("Unknown object", |o| o.label));
    html.open("span", &[("class", "quiet")]);
    if let Some(choice) = read.choice.filter(|c| !c.label.is_empty()) {
        html.text(choice.label).text(" · ");
    }
    if let Some(unit) = item.unit {
        html.text(&format!("unit {unit} · "));
    }
    html.text(&size(
        u64::try_from(item.decoded.kept.words.len() * 2).unwrap_or(0),
    ));
    if let Some(course) = item.decoded.kept.course {
        html.text(&format!(
            " · {}, busy {}",
            millis(course.took_us),
            millis(course.busy_us)
        ));
    }
    html.close("span");
    if read.error.is_some() {
        html.severity(Severity::Error);
    } else if item.incomplete {
        html.severity(Severity::Warning);
        html.node("span", "quiet", "incomplete");
    }
}

/// What to do, and samples.
pub fn welcome(html: &mut Markup) {
    html.open(
        "div",
        &[("class", "welcome"), ("data-testid", "dop-welcome")],
    );
    html.node(
        "p",
        "quiet",
        "Paste the response registers of a Limitorque MX or QX series B actuator: hexadecimal, \
         decimal or a table. Or a Modbus capture of the whole exchange, or a file of saved reads. \
         Nothing leaves this computer.",
    );
    html.node("h2", "", "Samples");
    html.open("div", &[("class", "sample-list")]);
    for sample in SAMPLES {
        html.open(
            "button",
            &[
                ("class", "sample"),
                ("data-act", "sample"),
                ("data-sample", sample.key),
                ("data-testid", "dop-sample-button"),
            ],
        );
        html.node("b", "", sample.title)
            .node("span", "quiet", sample.about)
            .close("button");
    }
    html.close("div").close("div");
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn open(key: &str) -> Offline {
        let sample = sample(key).unwrap();
        let request = (sample.request != 0).then(|| Request::from_word(sample.request));
        Offline::open(sample.content, request, &Arc::new(Profile::default()))
    }

    #[test]
    fn every_sample_shows_what_it_promises() {
        for (key, registers) in [
            ("torque", 410),
            ("temperature", 81),
            ("vibration", 91),
            ("axes", 14),
            ("pst", 26),
            ("events", 1 + 6 * 27),
        ] {
            let offline = open(key);
            assert!(offline.problems.is_empty(), "{key}: {:?}", offline.problems);
            assert_eq!(offline.items.len(), 1, "{key}");
            let read = &offline.items[0].decoded.read;
            assert_eq!(read.words.len(), registers, "{key}");
            assert!(read.decoded.is_ok(), "{key}: {:?}", read.decoded.problems());
        }
        let session = open("session");
        assert!(session.said.contains("inferred"), "{}", session.said);
        let requests: Vec<_> = session
            .items
            .iter()
            .map(|i| i.decoded.read.request.word())
            .collect();
        assert_eq!(requests, [0x03EF, 0x025C]);
        let doubts: Vec<_> = session
            .items
            .iter()
            .filter(|i| i.incomplete)
            .map(|i| (i.decoded.read.words.len(), &i.decoded.kept.remarks))
            .collect();
        assert!(doubts.is_empty(), "{doubts:?} {}", session.said);
    }

    #[test]
    fn candidates_are_offered() {
        let sample = sample("pst").unwrap();
        let offline = Offline::open(sample.content, None, &Arc::new(Profile::default()));
        let chosen = offline.items[0].decoded.read.request;
        let mut html = Markup::new();
        doubts(&mut html, &offline, Some(chosen));
        let html = html.finish();
        // 26 registers: 207 and 209.
        assert_eq!(html.matches("data-testid=\"dop-fit\"").count(), 2, "{html}");
        assert_eq!(html.matches("aria-pressed=\"true\"").count(), 1);
        assert_eq!(chosen.object(), 209);
    }

    #[test]
    fn what_fits_nothing_says_what_to_do() {
        let offline = Offline::open("0001 0002 0003", None, &Arc::new(Profile::default()));
        let mut html = Markup::new();
        doubts(&mut html, &offline, None);
        assert!(
            html.finish()
                .contains("No object has an answer of 3 registers")
        );
    }
}
