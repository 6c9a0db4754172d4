//! Around the input of the decode page: choices, what was found, samples, the head of the problems.

use shared::device::{Device, Family};
use shared::frame::Framing;

use super::Markup;
use super::control::{Button, Choice, tick};
use crate::decode_store::{FOREIGN, Progress};
use crate::format::{count, size, thousands};
use crate::state::samples::{SAMPLES, Sample};
use crate::state::work::{Work, form_label};

/// What the choices show.
#[derive(Clone, Debug)]
pub struct Choices<'a> {
    /// The framing that the user chose.
    pub framing: Option<Framing>,
    /// The device that the user chose.
    pub device: Option<Device>,
    /// Key of the open sample.
    pub sample: Option<&'static str>,
    /// Set while a program of its own decodes: the framing that the user chose, empty for automatic.
    pub hosted: Option<&'static str>,
    /// The input and its frames.
    pub work: Option<&'a Work>,
    /// Work under way.
    pub progress: Option<Progress>,
}

/// Framing, device, what was found and how far it is, samples.
pub fn choices(html: &mut Markup, now: &Choices<'_>) {
    let hart = now.hosted.is_some();
    let framing = now.work.map(|w| w.session.framing().label());
    let framing = framing.or(hart.then_some("HART"));
    // What is on a HART line is no choice for a Modbus line.
    let rotork = Family::ALL.into_iter().filter(|_| hart);
    let modbus = Device::ALL.into_iter().filter(|_| !hart);
    let devices = rotork.map(Device::Rotork).chain(modbus);
    Choice {
        act: "framing",
        testid: "decode-framing",
        label: "Framing",
        none: &automatic(
            now.framing.is_none() && now.hosted.is_none_or(str::is_empty),
            framing,
        ),
        value: now.hosted.unwrap_or(now.framing.map_or("", Framing::key)),
        labelled: true,
        title: "",
    }
    .draw(
        html,
        Framing::ALL
            .iter()
            .map(|f| (f.key(), f.label()))
            .chain(FOREIGN.iter().copied()),
    );
    let guess = now.work.map(|w| &w.guess).filter(|_| now.device.is_none());
    Choice {
        act: "device",
        testid: "decode-device",
        label: "Device",
        none: &automatic(now.device.is_none(), guess.map(|g| g.device.label())),
        value: now.device.map_or("", Device::key),
        labelled: true,
        title: guess.map_or("", |g| &g.reason),
    }
    .draw(html, devices.map(|d| (d.key(), d.label())));
    if let Some(work) = now.work {
        found(html, work);
    }
    if let Some(progress) = &now.progress {
        progress_bar(html, progress);
    }
    Choice {
        act: "sample",
        testid: "sample",
        label: "Sample",
        none: "Choose",
        value: now.sample.unwrap_or_default(),
        labelled: true,
        title: "",
    }
    .draw(html, SAMPLES.iter().map(|s| (s.key, s.title)));
    Button {
        act: "clear",
        testid: "clear",
        words: "Clear",
        hidden: now.work.is_none() && !hart,
        ..Button::default()
    }
    .draw(html);
}

/// What was opened, and what was found in it.
pub fn found(html: &mut Markup, work: &Work) {
    html.open(
        "span",
        &[
            ("class", "found"),
            ("data-testid", "found"),
            ("role", "status"),
        ],
    );
    let stopped = if work.partial {
        ", reading was stopped"
    } else {
        ""
    };
    html.text(&format!(
        "{}: {}, {}, {}{stopped}",
        work.name,
        form_label(work.form),
        size(work.session.end()),
        count(u64::from(work.session.len()), "frame")
    ))
    .close("span");
}

fn automatic(is: bool, found: Option<&str>) -> String {
    match found.filter(|_| is) {
        Some(found) => format!("Automatic: {found}"),
        None => "Automatic".to_owned(),
    }
}

/// How far long work is, and a way to stop it.
pub fn progress_bar(html: &mut Markup, progress: &Progress) {
    let percent = progress.percent().to_string();
    html.open("span", &[("class", "progress")]);
    html.open("progress", &[("max", "100"), ("value", &percent)])
        .close("progress");
    html.text(progress.what).text(" ").text(&percent).text(" %");
    if progress.frames > 0 {
        html.text(", ")
            .text(&thousands(u64::from(progress.frames)))
            .text(" frames");
    }
    Button {
        act: "cancel",
        testid: "cancel",
        words: "Cancel",
        ..Button::default()
    }
    .draw(html);
    html.close("span");
}

/// What to do first: samples to try.
pub fn welcome(html: &mut Markup) {
    html.node(
        "p",
        "",
        "Paste the bytes of a bus above, or drop a capture anywhere. Everything is decoded here; nothing leaves this page.",
    );
    html.open("p", &[])
        .text("Registers of a Limitorque MX or QX diagnostic object instead of frames? ");
    let link = [("href", "#/dop"), ("data-testid", "dop-link")];
    html.open("a", &link)
        .text("DOP objects: paste registers")
        .close("a");
    html.text(" Faults of a DDC-100 network? ");
    let link = [("href", "#/network"), ("data-testid", "network-link")];
    html.open("a", &link)
        .text("Fault table and scan time")
        .close("a");
    html.close("p");
    html.node("h2", "", "Or try one");
    html.open("ul", &[("class", "sample-list")]);
    // A program decodes what it was made for.
    let own =
        |s: &&Sample| cfg!(feature = "maps") || s.device.is_some_and(|d| d.family().is_some());
    for sample in SAMPLES.iter().filter(own) {
        html.open("li", &[]).open(
            "button",
            &[
                ("class", "sample"),
                ("data-act", sample.key),
                ("data-testid", "sample-button"),
                ("data-sample", sample.key),
            ],
        );
        html.node("b", "", sample.title)
            .node("span", "quiet", sample.about);
        html.close("button").close("li");
    }
    html.close("ul");
}

/// Number of problems, and whether notes are listed.
pub fn problem_head(
    html: &mut Markup,
    (errors, warnings, notes): (u64, u64, u64),
    listed: u64,
    with_notes: bool,
) {
    html.open(
        "span",
        &[("role", "status"), ("data-testid", "problem-count")],
    );
    html.text(&count(errors, "error"))
        .text(", ")
        .text(&count(warnings, "warning"));
    if errors + warnings > listed {
        html.text(&format!(", the first {} are listed", thousands(listed)));
    }
    html.close("span");
    if notes > 0 {
        let words = count(notes, "note");
        tick(html, "notes", "with-notes", &words, with_notes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;

    #[test]
    fn what_was_found_is_said() {
        let work = Work::new("a.hex".into(), load(b"7D0300070003BFF6", None), true);
        let mut html = Markup::new();
        let now = Choices {
            framing: None,
            device: None,
            hosted: None,
            sample: None,
            work: Some(&work),
            progress: None,
        };
        choices(&mut html, &now);
        let html = html.finish();
        for part in [
            "Automatic: Modbus RTU",
            "a.hex: hex text, 8 bytes, 1 frame, reading was stopped",
            "Automatic: No device map",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }

    #[test]
    fn samples_and_problems() {
        let mut html = Markup::new();
        welcome(&mut html);
        problem_head(&mut html, (2000, 1000, 3), 2000, true);
        let html = html.finish();
        assert!(html.contains("href=\"#/dop\""));
        assert!(html.contains("data-sample=\"damaged\""));
        assert!(html.contains("the first 2\u{2009}000 are listed"));
        assert!(html.contains("3 notes"));
    }
}
