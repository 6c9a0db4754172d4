//! What is read, how far it is, what failed.

use shared::map::row::Row;

use crate::actuator::state::dossier::{CHANGED, Dossier, Failure, Subject};
use crate::actuator::state::saved::gaps;
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
    let idle = online && site.shown_job().is_none();
    for (act, words) in what {
        let testid = if *act == "read" { "icon-read" } else { act };
        button(html, (act, testid, words), Glyph::Poll, false, !idle);
    }
    progress(html, site, online, now_us);
    html.node("span", "toolbar-gap", "");
    let whole = ("whole", "icon-whole", "Read whole device");
    let save = ("save", "icon-save", "Save snapshot");
    let nothing = site.dossier.is_empty() || site.shown_job().is_some();
    if site.saving && !nothing {
        html.open("span", &[("class", "notice"), ("data-testid", "icon-gaps")]);
        html.text(&format!("Not whole: {}.", gaps(&site.dossier)));
        html.close("span");
        button(html, whole, Glyph::Poll, false, !idle);
        let as_it_is = ("save", "icon-save-gaps", "Save with gaps");
        button(html, as_it_is, Glyph::Save, false, false);
    } else {
        button(html, whole, Glyph::Poll, false, !idle);
        button(html, save, Glyph::Save, false, nothing);
    }
}

/// A button: what it does, its `data-testid` and its words.
fn button(
    html: &mut Markup,
    (act, testid, words): (&str, &str, &str),
    glyph: Glyph,
    hidden: bool,
    disabled: bool,
) {
    Button {
        act,
        testid,
        words,
        glyph: Some(glyph),
        hidden,
        disabled,
        ..Button::default()
    }
    .draw(html);
}

/// How far a read is, a button to end it and one to go on with it.
pub fn progress(html: &mut Markup, site: &Site, online: bool, now_us: u64) {
    let job = site.shown_job();
    let cancelled = job.is_some_and(|j| j.cancelled);
    let cancel = ("cancel", "icon-cancel", "Cancel");
    button(html, cancel, Glyph::Close, job.is_none(), cancelled);
    let on = ("resume", "icon-resume", "Go on");
    let hidden = site.broken.is_none() || job.is_some();
    button(html, on, Glyph::Play, hidden, !online || job.is_some());
    html.open(
        "span",
        &[
            ("class", "quiet icon-job"),
            ("role", "status"),
            ("data-testid", "icon-job"),
        ],
    );
    match job {
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
    let failed = dossier.failed.iter();
    let failed: Vec<_> = failed
        .filter(|(s, f)| shows(**s) && dossier.has(f.step))
        .collect();
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
    html.text(": ");
    if failure.text == CHANGED {
        html.text(CHANGED);
    } else {
        html.text("the device ").text(outcome(failure.outcome));
        if !failure.text.is_empty() {
            html.text(&format!(" ({})", failure.text));
        }
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

/// When these rows were read, the oldest first to be told.
pub fn read_at(html: &mut Markup, dossier: &Dossier, rows: &[&'static Row], now: i64) {
    let seen = rows.iter().filter_map(|row| dossier.image.row(row));
    when(html, dossier, seen.map(|seen| seen.at.get()).min(), now);
}

/// When something was read: `Read 2 minutes ago, 2026-11-27 02:03:04 UTC.`, by its microseconds.
pub fn when(html: &mut Markup, dossier: &Dossier, at: Option<u64>, now: i64) {
    if let Some(at) = at {
        let then = dossier.wall(at);
        let words = format!("Read {}, {} UTC.", ago(then, now), stamp(then));
        html.open("p", &[("class", "quiet"), ("data-testid", "read-at")]);
        html.text(&words).close("p");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;
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

    /// What is read again and again by itself disturbs nobody.
    #[test]
    fn a_quiet_job_is_not_shown() {
        let mut site = Site {
            dossier: Dossier::new("XV", Device::Icon3000v2),
            last: "12 requests done.".into(),
            ..Site::default()
        };
        let wanted = Wanted {
            files: vec![2],
            quiet: true,
            ..Wanted::default()
        };
        site.job = Job::new(1, wanted.clone(), &site.dossier, 0, 0);
        site.broken = Some((wanted, 0));
        let html = drawn(|html| reads(html, &site, true, 0, &[("read", "Read")]));
        assert!(html.contains("12 requests done.") && !html.contains("<progress"));
        assert!(
            !html.contains("data-testid=\"icon-read\" disabled"),
            "{html}"
        );
        assert!(html.contains("data-testid=\"icon-resume\">"), "{html}");
        site.lost();
        assert_eq!(site.last, "12 requests done.");
    }

    #[test]
    fn a_snapshot_with_gaps_is_asked_about() {
        let mut site = Site {
            dossier: device(&[(3004, &[1])]),
            ..Site::default()
        };
        let draw = |site: &Site| drawn(|html| reads(html, site, true, 0, &[]));
        assert!(!draw(&site).contains("icon-gaps"));
        site.saving = true;
        let html = draw(&site);
        for part in [
            "Not whole: ",
            "parts not read.",
            "icon-save-gaps",
            "icon-whole",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }

    #[test]
    fn the_time_of_a_read_is_told() {
        let mut dossier = device(&[(3004, &[1]), (3005, &[1])]);
        dossier.start_wall_ms = 1_765_000_000_000;
        let rows = dossier.rows(&|row| (3004..=3005).contains(&row.address.get()));
        let html = drawn(|html| read_at(html, &dossier, &rows, 1_765_000_181));
        assert!(
            html.contains("Read 3 minutes ago, 2025-12-06 05:46:41 UTC."),
            "{html}"
        );
        assert_eq!(drawn(|html| read_at(html, &dossier, &[], 0)), "");
    }

    /// What was asked for to find out the model is no failure of a model that has not got it.
    #[test]
    fn a_probe_of_the_model_is_no_failure() {
        let block = |start| {
            IconStep::Block(shared::proto::Block {
                table: shared::proto::TableName::Holding,
                start,
                count: 1,
            })
        };
        let mut dossier = Dossier::new("XV", Device::Icon3000);
        for start in [22, 44, 3480] {
            dossier.fail(
                block(start),
                Outcome::Exception,
                2,
                "illegal data address",
                1,
            );
        }
        let html = drawn(|html| failures(html, &dossier, |_| true));
        assert_eq!(html.matches("icon-failed").count(), 1, "{html}");
        assert!(html.contains("holding registers from 44"));
    }

    #[test]
    fn failures_say_what_and_why() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let file = IconStep::File {
            file: 3500,
            start: 0,
            count: 110,
        };
        dossier.fail(file, Outcome::Exception, 2, "illegal data address", 1);
        dossier.fail(IconStep::Identity, Outcome::Silence, 0, "", 1);
        let html = drawn(|html| failures(html, &dossier, |s| s == Subject::File(3500)));
        assert!(
            html.contains("file 3500") && html.contains("illegal data address"),
            "{html}"
        );
        assert!(!html.contains("identity"));
        assert_eq!(drawn(|html| failures(html, &dossier, |_| false)), "");
    }
}
