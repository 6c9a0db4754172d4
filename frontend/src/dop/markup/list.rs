//! All objects with their options: what was read, what failed, what is being read.

use shared::dop::object::Group;
use shared::dop::{OBJECTS, Request};
use shared::problem::Severity;

use crate::components::icon::Glyph;
use crate::dop::state::logs::{EVENTS, MOVEMENTS};
use crate::dop::state::site::{Site, all_requests};
use crate::dop::when::ago;
use crate::markup::Markup;
use crate::markup::control::Button;

/// The buttons above the list and how far a read is.
pub fn tools(html: &mut Markup, site: &Site, online: bool, kept: bool) {
    let job = site.reading();
    Button {
        act: "read-all",
        testid: "read-all-objects",
        words: "Read all",
        glyph: Some(Glyph::Poll),
        disabled: job.is_some() || !online,
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "save-all",
        testid: "save-objects",
        words: "Save reads",
        glyph: Some(Glyph::Save),
        disabled: site.kept.is_empty(),
        ..Button::default()
    }
    .draw(html);
    html.open(
        "label",
        &[("class", "button"), ("data-testid", "open-earlier")],
    );
    html.icon(Glyph::File).text("Compare with file");
    html.open(
        "input",
        &[
            ("type", "file"),
            ("class", "hidden-input"),
            ("accept", ".json,application/json"),
            ("data-testid", "earlier-file"),
            ("data-file", "earlier"),
        ],
    )
    .close("label");
    Button {
        act: "keep",
        testid: "keep-objects",
        words: if kept {
            "Keep anew"
        } else {
            "Keep for comparison"
        },
        disabled: site.kept.is_empty(),
        ..Button::default()
    }
    .draw(html);
    html.open(
        "div",
        &[
            ("class", "dop-job"),
            ("data-testid", "dop-job"),
            ("role", "status"),
        ],
    );
    match job {
        Some(job) => {
            let (done, total) = (job.done.to_string(), job.total.to_string());
            html.open("progress", &[("max", &total), ("value", &done)])
                .close("progress");
            html.text(&format!(" {done} of {total}, "));
            html.text(if job.cancelled { "ending" } else { &job.text });
            html.text(" ");
            Button {
                act: "cancel",
                testid: "cancel-objects",
                words: "Cancel",
                glyph: Some(Glyph::Close),
                disabled: job.cancelled,
                ..Button::default()
            }
            .draw(html);
        }
        None if !site.last.is_empty() => {
            html.text(&site.last);
        }
        None => {
            let total = all_requests(&site.profile).len();
            html.node(
                "span",
                "quiet",
                &format!("{} of {total} read", site.kept.len()),
            );
        }
    }
    html.close("div");
}

/// The objects by group; each option is a link to its page.
pub fn objects(html: &mut Markup, site: &Site, tag: &str, chosen: Request, now: i64) {
    for group in Group::ALL {
        html.node("h3", "", group.label());
        html.open("ul", &[("class", "object-list")]);
        for object in OBJECTS.iter().filter(|o| o.group == group) {
            let is_log = matches!(object.id, EVENTS | MOVEMENTS);
            let id = object.id.to_string();
            html.open("li", &[("data-testid", "object-row"), ("data-object", &id)]);
            html.open("span", &[("class", "object-name")]);
            html.node("code", "quiet", &id)
                .text(" ")
                .text(object.label)
                .close("span");
            html.open("span", &[("class", "object-options")]);
            if is_log {
                let href = link(tag, "logs", &format!("log={id}"));
                html.open("a", &[("class", "option"), ("href", &href)]);
                html.text("Open the log").close("a");
            } else {
                for choice in object.options {
                    let request = object.request(choice, &site.profile);
                    option(
                        html,
                        site,
                        tag,
                        request,
                        choice.label,
                        (request == chosen, now),
                    );
                }
            }
            html.close("span").close("li");
        }
        html.close("ul");
    }
}

fn option(
    html: &mut Markup,
    site: &Site,
    tag: &str,
    request: Request,
    label: &str,
    (is_chosen, now): (bool, i64),
) {
    let kept = site.kept.get(&request.word());
    let failed = site.failed.get(&request.word());
    let reading = site
        .jobs
        .iter()
        .any(|j| j.log.is_none() && j.request == Some(request));
    let query = format!("object={}&option={}", request.object(), request.option());
    let href = link(tag, "objects", &query);
    let word = request.to_string();
    let mut attributes = vec![
        (
            "class",
            if kept.is_some() {
                "option read"
            } else {
                "option"
            },
        ),
        ("href", href.as_str()),
        ("data-testid", "object-option"),
        ("data-request", &word),
    ];
    if is_chosen {
        attributes.push(("aria-current", "page"));
    }
    html.open("a", &attributes);
    html.text(if label.is_empty() { "Data" } else { label });
    html.text(" ");
    if reading {
        html.node("small", "quiet", "reading");
    } else if failed.is_some() {
        html.severity(Severity::Error);
    } else if let Some(wall) = kept.and_then(|k| k.wall_ms) {
        let then = i64::try_from(wall / 1000).unwrap_or(0);
        html.node("small", "quiet", &ago(then, now));
    }
    html.close("a");
}

/// An address within a device.
#[must_use]
pub fn link(tag: &str, tab: &str, query: &str) -> String {
    let mark = if query.is_empty() { "" } else { "?" };
    format!("#/device/{}/{tab}{mark}{query}", crate::format::encode(tag))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dop::state::kept::Kept;
    use crate::dop::state::site::Failure;
    use shared::proto::Outcome;

    #[test]
    fn every_option_has_its_link_and_state() {
        let mut site = Site::default();
        let mut kept = Kept::new(Request::from_word(0x1001), vec![0], "read from the device");
        kept.wall_ms = Some(60_000);
        site.kept.insert(0x1001, kept);
        let failure = Failure {
            outcome: Outcome::Ok,
            code: Some(3),
            text: "option".into(),
        };
        site.failed.insert(0x2001, failure);
        let mut html = Markup::new();
        objects(&mut html, &site, "MX 301", Request::from_word(0x1001), 240);
        let html = html.finish();
        assert_eq!(html.matches("data-testid=\"object-row\"").count(), 32);
        let options = html.matches("data-testid=\"object-option\"").count();
        assert_eq!(options, all_requests(&site.profile).len());
        assert!(
            html.contains("#/device/MX%20301/objects?object=1&amp;option=1"),
            "{html}"
        );
        assert!(html.contains("3 minutes ago"));
        assert_eq!(html.matches("aria-current=\"page\"").count(), 1);
        assert_eq!(html.matches("severity error").count(), 1);
    }

    #[test]
    fn progress_is_told() {
        let mut site = Site::default();
        let drawn = |site: &Site| {
            let mut html = Markup::new();
            tools(&mut html, site, true, false);
            html.finish()
        };
        assert!(drawn(&site).contains("0 of 55 read"));
        site.asked(1, &[Request::from_word(1), Request::from_word(2)]);
        let html = drawn(&site);
        assert!(
            html.contains("0 of 2, waiting") && html.contains("cancel-objects"),
            "{html}"
        );
    }
}
