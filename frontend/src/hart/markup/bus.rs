//! A HART line: who else is on it, how its traffic goes, and who is found on it.

use crate::format::thousands;
use crate::hart::state::site::{Found, Job, Link, Plant};
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

/// What was found, then the configured devices that were not.
pub fn found(html: &mut Markup, all: &[Found], plant: &Plant, bus: &str) {
    html.open("table", &[("class", "hart-found-list")]);
    html.open("thead", &[]).open("tr", &[]);
    for head in ["Poll", "Address", "Device", "Revision", "Configured as"] {
        html.open("th", &[("scope", "col")]).text(head).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    let mut seen = Vec::new();
    for one in all {
        let known = one.known(all, plant, bus);
        seen.extend(known.map(|known| &known.tag));
        html.open("tr", &[("data-testid", "hart-found")]);
        poll(html, one.polling);
        html.node("td", "mono", &one.address().unwrap_or_default());
        let (name, digits) = one.kind().unwrap_or_default();
        html.open("td", &[]).text(&name).text(" ");
        html.node("span", "quiet", &digits).close("td");
        let revision = one
            .identity
            .as_ref()
            .map(|i| format!("HART {}", i.revision));
        html.node("td", "num", &revision.unwrap_or_default());
        configured(html, known.map(|known| known.tag.as_str()));
        html.close("tr");
    }
    let rest = plant.devices.iter().filter(|d| d.bus == bus);
    for device in rest.filter(|d| !seen.contains(&&d.tag)) {
        html.open("tr", &[("class", "quiet")]);
        poll(html, device.polling);
        let words = match device.polling {
            Some(_) => "not found yet",
            None => "found by its tag or address",
        };
        html.open("td", &[("colspan", "3")]).text(words).close("td");
        configured(html, Some(&device.tag));
        html.close("tr");
    }
    html.close("tbody").close("table");
}

fn poll(html: &mut Markup, polling: Option<u8>) {
    let poll = polling.map_or("–".to_owned(), |p| p.to_string());
    html.node("td", "num", &poll);
}

/// The way to a device of the configuration.
fn configured(html: &mut Markup, tag: Option<&str>) {
    html.open("td", &[]);
    match tag {
        Some(tag) => {
            let href = format!("#/device/{}", crate::format::encode(tag));
            html.open("a", &[("href", &href)]).text(tag).close("a");
        }
        None => {
            html.node("span", "quiet", "not configured");
        }
    }
    html.close("td");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::site::Known;

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

    /// The worked answer R2 to command 0, of a device at address 0.
    #[test]
    fn what_is_found_says_what_it_is() {
        let response = "068000180020FE6EDD0507020108000123450505000700006E006E019B";
        let known = |tag: &str, polling| Known {
            tag: tag.into(),
            family: None,
            bus: "loop".into(),
            polling,
        };
        let plant = Plant {
            buses: Vec::new(),
            devices: vec![known("FV-1", Some(0)), known("FV-2", None)],
        };
        let all = [Found::new(Some(0), response, 1).unwrap()];
        let mut html = Markup::new();
        found(&mut html, &all, &plant, "loop");
        let html = html.finish();
        assert!(html.contains("2EDD012345") && html.contains("HART 7"));
        assert!(html.contains("Rotork actuator"));
        assert_eq!(
            html.matches("#/device/FV-1").count(),
            1,
            "once, where it was found"
        );
        assert!(
            html.contains("<td class=\"num\">–</td>"),
            "no address 0 for FV-2"
        );
    }
}
