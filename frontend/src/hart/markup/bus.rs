//! A HART line: who else is on it, how its traffic goes, and who is found on it.

use crate::format::thousands;
use crate::hart::state::site::{Found, Job, Link, Plant};
use crate::hart::state::unit::raw_of;
use crate::markup::Markup;
use crate::markup::control::Button;

/// The state of the line.
pub fn link(html: &mut Markup, link: Option<&Link>) {
    let Some(link) = link else {
        html.node(
            "p",
            "quiet",
            "The bridge has not told the state of the line yet.",
        );
        return;
    };
    html.open("p", &[("class", "hart-link"), ("data-testid", "hart-link")]);
    html.node(
        "b",
        "",
        match link.primary {
            Some(true) => "We are the primary master",
            Some(false) => "We are the secondary master",
            None => "A gateway is the master",
        },
    );
    html.text(if link.other_master {
        ", another master is on the line"
    } else if link.primary.is_some() {
        ", no other master is heard"
    } else {
        ""
    });
    html.text(if link.burst {
        ", a device sends bursts."
    } else {
        "."
    });
    let [sent, answered, retried, damaged] = link.counts;
    html.node(
        "span",
        "quiet",
        &format!(
            " {} sent, {} answered, {} sent again, {} damaged heard. {}",
            thousands(sent),
            thousands(answered),
            thousands(retried),
            thousands(damaged),
            link.text
        ),
    );
    html.close("p");
}

/// Tools to look for devices.
pub fn search(html: &mut Markup, job: &Job, online: bool, tag: &str) {
    let busy = job.is_running() || !online;
    Button {
        act: "scan",
        testid: "hart-scan",
        words: "Scan 0 to 63",
        disabled: busy,
        ..Button::default()
    }
    .draw(html);
    html.open(
        "input",
        &[
            ("type", "text"),
            ("data-act", "tag"),
            ("data-testid", "hart-tag"),
            ("data-value", tag),
            ("value", tag),
            ("maxlength", "32"),
            ("placeholder", "Tag or long tag"),
            ("aria-label", "Tag or long tag"),
        ],
    );
    let short = !tag.is_empty() && tag.chars().count() <= 8;
    Button {
        act: "find",
        testid: "hart-find",
        words: "Find by tag",
        disabled: busy || !short,
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "find-long",
        testid: "hart-find-long",
        words: "Find by long tag",
        disabled: busy || tag.is_empty(),
        ..Button::default()
    }
    .draw(html);
    html.open(
        "span",
        &[
            ("class", "quiet"),
            ("role", "status"),
            ("data-testid", "hart-search"),
        ],
    );
    if job.is_running() {
        html.text(&format!("{} of {} {}", job.done, job.total, job.text));
    } else {
        html.text(&job.text);
    }
    html.close("span");
    Button {
        act: "cancel",
        testid: "hart-cancel",
        words: "Cancel",
        hidden: !job.is_running(),
        ..Button::default()
    }
    .draw(html);
}

/// What was found, with the configured devices for comparison.
pub fn found(html: &mut Markup, all: &[Found], plant: &Plant, bus: &str) {
    let configured = plant.devices.iter().filter(|d| d.bus == bus);
    html.open("table", &[("class", "hart-found-list")]);
    html.open("thead", &[]).open("tr", &[]);
    for head in ["Poll", "Address", "Device", "Revision"] {
        html.open("th", &[("scope", "col")]).text(head).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for one in all {
        html.open("tr", &[("data-testid", "hart-found")]);
        let poll = one.polling.map_or("–".to_owned(), |p| p.to_string());
        html.node("td", "num", &poll);
        html.node("td", "mono", &one.address().unwrap_or_default());
        let decoded = &one.shown.decoded;
        let maker = super::super::state::unit::find(&one.shown, "manufacturer")
            .map_or_else(String::new, |(_, f)| decoded.bare_text(f));
        html.node("td", "", &maker);
        let revision = raw_of(&one.shown, "universal_revision");
        html.node(
            "td",
            "num",
            &revision.map_or_else(String::new, |r| format!("HART {r}")),
        );
        html.close("tr");
    }
    for device in configured {
        html.open("tr", &[("class", "quiet")]);
        html.node("td", "num", &device.polling.to_string());
        html.node("td", "", "configured");
        html.open("td", &[]).open(
            "a",
            &[(
                "href",
                &format!("#/device/{}", crate::format::encode(&device.tag)),
            )],
        );
        html.text(&device.tag).close("a").close("td");
        html.node("td", "", "").close("tr");
    }
    html.close("tbody").close("table");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_says_who_is_on_it() {
        let mut html = Markup::new();
        let state = Link {
            primary: Some(false),
            other_master: true,
            burst: true,
            counts: [1, 2, 3, 4],
            text: String::new(),
        };
        link(&mut html, Some(&state));
        search(&mut html, &Job::default(), true, "FV-401");
        let html = html.finish();
        assert!(html.contains("secondary master") && html.contains("another master"));
        assert!(html.contains("sends bursts"));
        assert!(!html.contains("disabled"), "{html}");
    }
}
