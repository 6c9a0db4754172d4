//! Saved devices: which are open, and what changed between two.

use shared::icon3000::snapshot::{Change, Diff, Sort};

use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::saved::{gaps, oldest};
use crate::chart::time::stamp;
use crate::components::icon::Glyph;
use crate::dop::when::ago;
use crate::format::count;
use crate::markup::Markup;
use crate::markup::control::{Button, Choice, tick};

/// How keys of devices on the line begin.
pub const LIVE: &str = "live:";

fn is_live(key: &str) -> bool {
    key.starts_with(LIVE)
}

/// One device that can be looked at or compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Its key in the address: the place of a saved one, or `live:` and the tag.
    pub key: String,
    /// Tag and origin.
    pub label: String,
    /// Where it is looked at.
    pub href: String,
    /// Seconds since 1970 of the oldest of what it says.
    pub taken: i64,
    /// What is missing of it, empty if nothing is.
    pub gaps: String,
    /// What is wrong with its file.
    pub problems: Vec<String>,
    /// Kind and unit address.
    pub model: String,
}

/// An entry of a device.
#[must_use]
pub fn entry(dossier: &Dossier, key: &str, href: String, problems: &[String]) -> Entry {
    let label = if dossier.origin.is_empty() {
        format!("{} · on the line", dossier.tag)
    } else {
        format!("{} · {}", dossier.tag, dossier.origin)
    };
    let live = dossier.origin.is_empty();
    Entry {
        key: key.to_owned(),
        label,
        href,
        taken: oldest(dossier).unwrap_or_else(|| dossier.wall(0)),
        gaps: if live { gaps(dossier) } else { String::new() },
        problems: problems.to_vec(),
        model: format!("{} · unit {}", dossier.device.label(), dossier.unit),
    }
}

/// What this screen is for.
pub fn welcome(html: &mut Markup) {
    html.open("p", &[("class", "icon-lead")]);
    html.text("A snapshot is everything that an ICON3000 tells, as one file: registers, identity, counters, logs, curves. It is opened and compared here without a bridge and without the actuator.");
    html.close("p");
    html.open("p", &[("class", "quiet")]);
    html.text("To make one, open a device, read all of it and save it; or run ")
        .node("code", "", "valvescope snapshot")
        .text(" beside the line.")
        .close("p");
}

/// The devices that are open.
pub fn list(html: &mut Markup, entries: &[Entry], now: i64) {
    if entries.is_empty() {
        html.open("p", &[("class", "empty"), ("data-testid", "icon-nothing")]);
        html.text("No snapshot is open. Open a file, or drop one here.")
            .close("p");
        return;
    }
    html.open("ul", &[("class", "icon-snapshots")]);
    for entry in entries {
        let live = is_live(&entry.key);
        html.open(
            "li",
            &[("data-testid", "snapshot"), ("data-key", &entry.key)],
        );
        html.open("a", &[("href", &entry.href)]);
        html.icon(if live { Glyph::Devices } else { Glyph::File });
        html.text(" ").node("b", "", &entry.label).close("a");
        html.open("span", &[("class", "quiet")]);
        html.text(&format!(
            "{} · {}{} UTC, {}",
            entry.model,
            if live { "a copy, read from " } else { "" },
            stamp(entry.taken),
            ago(entry.taken, now)
        ));
        if live && entry.gaps.is_empty() {
            html.text(" on, whole");
        } else if live {
            html.text(" on; ").node("em", "quality", &entry.gaps);
        }
        html.close("span");
        if !live {
            html.open(
                "button",
                &[
                    ("class", "button"),
                    ("data-act", "close"),
                    ("data-key", &entry.key),
                    ("data-testid", "snapshot-close"),
                ],
            );
            html.text("Close").close("button");
        }
        for problem in &entry.problems {
            html.open(
                "p",
                &[
                    ("class", "snapshot-problem"),
                    ("data-testid", "snapshot-problem"),
                ],
            );
            html.severity(shared::problem::Severity::Warning);
            html.text(" ").text(problem).close("p");
        }
        html.close("li");
    }
    html.close("ul");
}

/// Which two are compared, and whether counters are shown.
/// `idle` is true if the device on the line could be read now.
pub fn choices(
    html: &mut Markup,
    entries: &[Entry],
    (first, second): (&str, &str),
    passing: bool,
    idle: bool,
) {
    if entries.len() < 2 {
        html.node(
            "p",
            "quiet",
            "Two are needed to compare: open another file, or read a device.",
        );
        return;
    }
    for (act, label, value) in [("first", "From", first), ("second", "To", second)] {
        Choice {
            act,
            testid: if act == "first" {
                "compare-first"
            } else {
                "compare-second"
            },
            label,
            none: "Choose one",
            value,
            labelled: true,
            ..Choice::default()
        }
        .draw(
            html,
            entries.iter().map(|e| (e.key.as_str(), e.label.as_str())),
        );
    }
    Button {
        act: "swap",
        testid: "compare-swap",
        words: "Swap",
        glyph: Some(Glyph::Traffic),
        disabled: first.is_empty() || second.is_empty(),
        ..Button::default()
    }
    .draw(html);
    if let Some(live) = [second, first].into_iter().find(|key| is_live(key)) {
        html.open("span", &[("data-key", live)]);
        Button {
            act: "fresh",
            testid: "compare-fresh",
            words: "Read it now and compare",
            glyph: Some(Glyph::Poll),
            disabled: !idle,
            ..Button::default()
        }
        .draw(html);
        html.close("span");
    }
    let words = "Counters, clock and measurements too";
    tick(html, "passing", "compare-passing", words, passing);
}

/// What changed.
pub fn changes(html: &mut Markup, diff: &Diff, passing: bool) {
    let shown: Vec<&Change> = diff
        .changes
        .iter()
        .filter(|c| passing || !c.sort.is_passing())
        .collect();
    let hidden = diff.changes.len().saturating_sub(shown.len());
    for remark in &diff.remarks {
        html.open(
            "p",
            &[("class", "notice"), ("data-testid", "compare-remark")],
        );
        html.text(remark).close("p");
    }
    html.open(
        "p",
        &[("class", "compare-sum"), ("data-testid", "compare-sum")],
    );
    let n = u64::try_from(shown.len()).unwrap_or(0);
    html.node(
        "b",
        "",
        &if n == 0 {
            "No change".to_owned()
        } else {
            count(n, "change")
        },
    );
    if hidden > 0 {
        html.text(&format!(
            ", and {} of counters, clock and measurements",
            count(u64::try_from(hidden).unwrap_or(0), "change")
        ));
    }
    if !diff.only_one.is_empty() {
        html.text(&format!(
            ". {} could not be compared, because only one of the two has them",
            count(u64::try_from(diff.only_one.len()).unwrap_or(0), "value")
        ));
    }
    html.text(".").close("p");
    let mut sort: Option<Sort> = None;
    for change in shown {
        if sort != Some(change.sort) {
            if sort.is_some() {
                html.close("tbody").close("table").close("div");
            }
            sort = Some(change.sort);
            super::heading(html, change.sort.label(), "");
            begin(html);
        }
        row(html, change);
    }
    if sort.is_some() {
        html.close("tbody").close("table").close("div");
    }
    only_one(html, diff);
}

fn begin(html: &mut Markup) {
    html.open("div", &[("class", "icon-table")]);
    html.open("table", &[("class", "plain compare")])
        .open("thead", &[])
        .open("tr", &[]);
    for name in ["What", "From", "To", "Where"] {
        html.open("th", &[("scope", "col")]).text(name).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
}

fn row(html: &mut Markup, change: &Change) {
    html.open(
        "tr",
        &[("data-testid", "change"), ("data-path", &change.path)],
    );
    html.open("th", &[("scope", "row")])
        .text(&change.label)
        .close("th");
    for (class, text) in [("was", &change.was), ("now", &change.now)] {
        html.open("td", &[("class", class)]);
        if text.is_empty() {
            html.node("span", "quiet", "not there");
        } else {
            html.text(text);
        }
        html.close("td");
    }
    html.open("td", &[("class", "quiet")]);
    html.node("code", "", &change.path);
    if !change.also.is_empty() {
        html.text(&format!(" and {}", change.also.join(", ")));
    }
    if let Some(source) = &change.source {
        html.text(&format!(" · {source}"));
    }
    html.close("td").close("tr");
}

/// What only one of the two has.
fn only_one(html: &mut Markup, diff: &Diff) {
    if diff.only_one.is_empty() {
        return;
    }
    html.open("details", &[("class", "only-one")]);
    html.open("summary", &[])
        .text("What only one of them has")
        .close("summary");
    html.open("ul", &[]);
    for one in diff.only_one.iter().take(200) {
        let which = if one.in_second { "to" } else { "from" };
        html.open("li", &[("data-testid", "only-one")]);
        html.text(&one.label)
            .text(" ")
            .node("code", "quiet", &one.path);
        html.text(&format!(": only in \u{201c}{which}\u{201d}"))
            .close("li");
    }
    if let Some(more) = diff.only_one.len().checked_sub(200).filter(|n| *n > 0) {
        html.node("li", "quiet", &format!("and {more} more"));
    }
    html.close("ul").close("details");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::put;
    use crate::actuator::state::saved::{snapshot, tests::device};
    use shared::icon3000::snapshot::diff;

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    /// PST travel from 20 to 25 %, and a counter that went on.
    #[test]
    fn changes_are_told_and_counters_apart() {
        let before = device();
        let mut after = device();
        put(&mut after, 3615, &[25], 9);
        assert!(after.absorb(&[8, 0, 11, 0, 0], &[8, 0, 11, 0, 12], 9));
        let diff = diff(
            &snapshot(&before, 0).unwrap(),
            &snapshot(&after, 0).unwrap(),
        );
        let html = drawn(|html| changes(html, &diff, false));
        assert_eq!(html.matches("data-testid=\"change\"").count(), 1, "{html}");
        for part in [
            "1 change",
            "holding.3615",
            ">20 %<",
            ">25 %<",
            "1 change of counters",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        let html = drawn(|html| changes(html, &diff, true));
        assert_eq!(html.matches("data-testid=\"change\"").count(), 2);
        assert!(html.contains("counter.11"));
    }

    #[test]
    fn a_device_with_itself_has_no_change() {
        let one = snapshot(&device(), 0).unwrap();
        let diff = diff(&one, &one);
        let html = drawn(|html| changes(html, &diff, true));
        assert!(
            html.contains("No change") && !html.contains("<table"),
            "{html}"
        );
    }

    #[test]
    fn entries_lead_to_their_device() {
        let mut dossier = device();
        let live = entry(
            &dossier,
            "live:XV-101",
            "#/device/XV-101/health".into(),
            &[],
        );
        dossier.origin = "a.json".into();
        let saved = entry(
            &dossier,
            "0",
            "#/snapshots/health?of=0".into(),
            &["hash".into()],
        );
        let both = [live, saved];
        let html = drawn(|html| list(html, &both, 1_765_003_600));
        for part in [
            "on the line",
            "a.json",
            "60 minutes ago",
            "unit 7",
            "snapshot-problem",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
        assert_eq!(html.matches("snapshot-close").count(), 1);
        assert!(
            html.contains("a copy, read from 2025-12-06 05:46:40 UTC"),
            "{html}"
        );
        assert!(html.contains("parts not read, 1 part refused"), "{html}");
        let choose =
            |entries: &[Entry], pair| drawn(|html| choices(html, entries, pair, false, true));
        assert!(choose(&both[..1], ("", "")).contains("Two are needed"));
        assert!(!choose(&both, ("0", "")).contains("compare-fresh"));
        let html = choose(&both, ("0", "live:XV-101"));
        assert!(html.contains("data-key=\"live:XV-101\"><button"), "{html}");
    }
}
