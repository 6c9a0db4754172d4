//! What is read, how far it is, what failed.

use crate::actuator::state::dossier::{Dossier, Failure, Subject};
use crate::actuator::store::Site;
use crate::chart::time::stamp;
use crate::components::icon::Glyph;
use crate::dop::when::ago;
use crate::markup::Markup;
use crate::markup::control::Button;
use crate::state::health::outcome;

/// The buttons of a screen that reads the device: what it reads, and how far that is. `what` are
/// pairs of an act and its words.
pub fn reads(html: &mut Markup, site: &Site, online: bool, now_us: u64, what: &[(&str, &str)]) {
    let idle = online && site.job.is_none();
    for (act, words) in what {
        Button {
            act,
            testid: if *act == "read" { "icon-read" } else { act },
            words,
            glyph: Some(Glyph::Poll),
            disabled: !idle,
            ..Button::default()
        }
        .draw(html);
    }
    Button {
        act: "cancel",
        testid: "icon-cancel",
        words: "Cancel",
        glyph: Some(Glyph::Close),
        hidden: site.job.is_none(),
        disabled: site.job.as_ref().is_some_and(|j| j.cancelled),
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "resume",
        testid: "icon-resume",
        words: "Go on",
        glyph: Some(Glyph::Play),
        hidden: site.broken.is_none() || site.job.is_some(),
        disabled: !idle,
        ..Button::default()
    }
    .draw(html);
    html.open(
        "span",
        &[
            ("class", "quiet icon-job"),
            ("role", "status"),
            ("data-testid", "icon-job"),
        ],
    );
    match &site.job {
        Some(job) => {
            let done = job.done.to_string();
            let total = job.total.max(1).to_string();
            html.open(
                "progress",
                &[
                    ("value", &done),
                    ("max", &total),
                    ("aria-label", "Requests done"),
                ],
            )
            .close("progress");
            html.text(" ").text(&job.progress(now_us));
            if !job.text.is_empty() {
                html.text(" · ").text(&job.text);
            }
        }
        None if !online => {
            html.text("No connection: what is shown was read before.");
        }
        None => {
            html.text(&site.last);
        }
    }
    html.close("span");
    html.node("span", "toolbar-gap", "");
    Button {
        act: "whole",
        testid: "icon-whole",
        words: "Read whole device",
        glyph: Some(Glyph::Poll),
        disabled: !idle,
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "save",
        testid: "icon-save",
        words: "Save snapshot",
        glyph: Some(Glyph::Save),
        disabled: site.dossier.is_empty() || site.job.is_some(),
        ..Button::default()
    }
    .draw(html);
}

/// In place of the buttons: whose data a saved device are, and when they were read.
pub fn origin(html: &mut Markup, dossier: &Dossier) {
    html.open(
        "span",
        &[("class", "icon-origin"), ("data-testid", "icon-origin")],
    );
    html.node("b", "", &dossier.tag);
    html.text(&format!(" · {} · ", dossier.device.label()));
    let place = format!(
        "saved in {} · {} UTC",
        dossier.origin,
        stamp(dossier.wall(0))
    );
    html.node("span", "quiet", &place).close("span");
}

/// What was asked for and did not come, for subjects that a screen shows.
pub fn failures(html: &mut Markup, dossier: &Dossier, shows: impl Fn(Subject) -> bool) {
    let failed: Vec<_> = dossier.failed.iter().filter(|(s, _)| shows(**s)).collect();
    if failed.is_empty() {
        return;
    }
    html.open("ul", &[("class", "icon-failures")]);
    for (subject, failure) in failed {
        failed_one(html, *subject, failure);
    }
    html.close("ul");
}

fn failed_one(html: &mut Markup, subject: Subject, failure: &Failure) {
    let name = subject_name(subject);
    html.open(
        "li",
        &[("data-testid", "icon-failed"), ("data-subject", &name)],
    );
    html.severity(shared::problem::Severity::Warning);
    html.text(" ").node("b", "", &name);
    html.text(&format!(": the device {}", outcome(failure.outcome)));
    if !failure.text.is_empty() {
        html.text(&format!(" ({})", failure.text));
    }
    html.text(".").close("li");
}

/// What was asked for, in words.
#[must_use]
pub fn subject_name(subject: Subject) -> String {
    match subject {
        Subject::Block(table, start) => {
            let table = match table {
                1 => "coils",
                2 => "discrete inputs",
                3 => "holding registers",
                _ => "input registers",
            };
            format!("{table} from {start}")
        }
        Subject::File(file) => format!("file {file}"),
        Subject::Identity => "identity (FC 17)".to_owned(),
        Subject::Diagnostic(sub) => format!("counter (FC 08, sub-function {sub})"),
    }
}

/// When something was read: `2 minutes ago`, exactly on hover.
pub fn when(html: &mut Markup, then: i64, now: i64) {
    let exact = format!("{} UTC", stamp(then));
    html.open("time", &[("class", "quiet"), ("title", &exact)]);
    html.text(&ago(then, now)).close("time");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::state::job::Job;
    use crate::actuator::state::wanted::Wanted;
    use shared::device::Device;
    use shared::proto::{IconStep, Outcome};

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn a_job_shows_progress_and_cancel() {
        let mut site = Site {
            dossier: Dossier::new("XV", Device::Icon3000v2),
            ..Site::default()
        };
        let idle = drawn(|html| reads(html, &site, true, 0, &[("read", "Read")]));
        assert!(
            idle.contains("data-testid=\"icon-cancel\" hidden"),
            "{idle}"
        );
        assert!(!idle.contains("data-testid=\"icon-read\" disabled"));
        let wanted = Wanted {
            files: vec![2, 3],
            ..Wanted::default()
        };
        site.job = Job::new(1, wanted, &site.dossier, 0, 0);
        let busy = drawn(|html| reads(html, &site, true, 0, &[("read", "Read")]));
        assert!(busy.contains("0 of 2 requests") && busy.contains("<progress"));
        assert!(busy.contains("data-testid=\"icon-read\" disabled"));
        site.job = None;
        let away = drawn(|html| reads(html, &site, false, 0, &[("read", "Read")]));
        assert!(away.contains("No connection"));
    }

    #[test]
    fn failures_say_what_and_why() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let file = IconStep::File {
            file: 3500,
            start: 0,
            count: 110,
        };
        dossier.fail(file, Outcome::Exception, "illegal data address", 1);
        dossier.fail(IconStep::Identity, Outcome::Silence, "", 1);
        let html = drawn(|html| failures(html, &dossier, |s| s == Subject::File(3500)));
        assert!(
            html.contains("file 3500") && html.contains("illegal data address"),
            "{html}"
        );
        assert!(!html.contains("identity"));
        assert_eq!(drawn(|html| failures(html, &dossier, |_| false)), "");
    }
}
