//! The tools above lists: filters, reading, pausing.

use shared::address::Table;
use shared::pdu::names;

use super::Markup;
use super::control::{Button, Choice, search, tick};
use crate::components::icon::Glyph;
use crate::format::count;
use crate::state::health::outcome;
use crate::state::job::Job;
use crate::state::traffic::Filter;
use crate::state::values::LEVELS;

/// What writing a register does, as choices.
const ACCESS: [(&str, &str); 3] = [
    ("r", "Read-only"),
    ("rw", "Writable"),
    ("rw!", "Moves or reconfigures"),
];

/// Functions that a filter offers.
const FUNCTIONS: [u8; 11] = [1, 2, 3, 4, 5, 6, 8, 15, 16, 17, 20];

/// Search and filters of the register browser; `get` tells what is set.
pub fn filters<'a>(html: &mut Markup, groups: &[&str], get: impl Fn(&str) -> &'a str) {
    let words = "Name, address or number";
    search(html, "q", "register-search", words, get("q"));
    let choice = |act: &'static str, testid: &'static str, label: &'static str| Choice {
        act,
        testid,
        label,
        value: get(act),
        ..Choice::default()
    };
    let tables = Table::ALL.iter().map(|t| (t.key(), t.label()));
    choice("table", "filter-table", "Table").draw(html, tables);
    let groups = groups.iter().map(|g| (*g, *g));
    choice("group", "filter-group", "Group").draw(html, groups);
    choice("access", "filter-access", "Access").draw(html, ACCESS.into_iter());
    let levels = LEVELS.iter().map(|l| (l.key(), l.key()));
    choice("level", "filter-level", "Level").draw(html, levels);
    let reserved = !get("reserved").is_empty();
    tick(html, "reserved", "show-reserved", "Reserved", reserved);
}

/// Reading and polling of the register browser.
pub fn reading(html: &mut Markup, found: usize, selected: bool, polling: bool, job: Option<&Job>) {
    let plain = |act: &'static str, words: &'static str| Button {
        act,
        testid: act,
        words,
        ..Button::default()
    };
    plain("read-visible", "Read visible").draw(html);
    Button {
        words: &format!("Read all {found}"),
        ..plain("read-all", "")
    }
    .draw(html);
    Button {
        disabled: !selected,
        ..plain("read-selected", "Read selected")
    }
    .draw(html);
    Button {
        testid: "poll-visible",
        pressed: Some(polling),
        ..plain(
            "poll",
            if polling {
                "Polling visible, 1 s"
            } else {
                "Poll visible"
            },
        )
    }
    .draw(html);
    html.open(
        "span",
        &[
            ("class", "quiet job"),
            ("role", "status"),
            ("data-testid", "job"),
        ],
    );
    html.text(&job.map_or_else(String::new, job_words))
        .close("span");
    Button {
        testid: "cancel-read",
        hidden: job.is_none_or(Job::is_over),
        ..plain("cancel", "Cancel")
    }
    .draw(html);
}

/// How far reading is, and what failed.
fn job_words(job: &Job) -> String {
    let all = |n: usize| count(u64::try_from(n).unwrap_or(0), "block");
    let progress = format!("{} of {}", job.done, all(job.total));
    let failed = job.failed.first().map(|f| {
        let last = f
            .block
            .start
            .saturating_add(f.block.count.saturating_sub(1));
        let why = if f.text.is_empty() {
            outcome(f.outcome)
        } else {
            &f.text
        };
        let many = all(job.failed.len());
        format!("{many} failed; {} to {last}: {why}", f.block.start)
    });
    match (job.is_over(), failed) {
        (false, None) => progress,
        (false, Some(failed)) => format!("{progress}, {failed}"),
        (true, None) => format!("{progress} read"),
        (true, Some(failed)) => failed,
    }
}

/// What the tools of the traffic show.
#[derive(Clone, Debug, Default)]
pub struct Traffic {
    /// True while the list stands still.
    pub paused: bool,
    /// Frames listed.
    pub frames: usize,
    /// Captures that were lost.
    pub missed: u64,
    /// The line in words.
    pub line: String,
    /// True if the unit is fixed.
    pub fixed_unit: bool,
}

/// The tools of the traffic.
pub fn traffic(html: &mut Markup, now: &Traffic, filter: &Filter) {
    Button {
        act: "pause",
        testid: "pause",
        words: if now.paused { "Go on" } else { "Pause" },
        pressed: Some(now.paused),
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "clear",
        testid: "clear-traffic",
        words: "Clear",
        ..Button::default()
    }
    .draw(html);
    if !now.fixed_unit {
        let unit = filter.unit.map_or_else(String::new, |u| u.to_string());
        search(html, "unit", "filter-unit", "Unit", &unit);
    }
    let value = filter.function.map_or_else(String::new, |f| f.to_string());
    let functions = FUNCTIONS.map(|code| {
        let name = names::function(code).unwrap_or_default();
        (code.to_string(), format!("{code:02} {name}"))
    });
    Choice {
        act: "function",
        testid: "filter-function",
        label: "Function",
        value: &value,
        ..Choice::default()
    }
    .draw(
        html,
        functions.iter().map(|(v, w)| (v.as_str(), w.as_str())),
    );
    tick(
        html,
        "problems",
        "filter-problems",
        "Problems only",
        filter.problems,
    );
    Button {
        act: "save",
        testid: "export",
        words: "Save as hex",
        glyph: Some(Glyph::Save),
        ..Button::default()
    }
    .draw(html);
    html.open(
        "span",
        &[("class", "quiet"), ("data-testid", "traffic-count")],
    );
    html.text(&count(u64::try_from(now.frames).unwrap_or(0), "frame"))
        .close("span");
    html.node("span", "quiet line-words", &now.line);
    html.open(
        "span",
        &[
            ("class", "missed"),
            ("role", "status"),
            ("data-testid", "missed"),
        ],
    );
    if now.missed > 0 {
        html.text(&count(now.missed, "capture"))
            .text(" did not reach this page.");
    }
    html.close("span");
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::proto::{Block, Outcome, TableName};

    #[test]
    fn progress_and_failures_are_said() {
        let block = Block {
            table: TableName::Holding,
            start: 3000,
            count: 31,
        };
        let mut job = Job::new(vec![block; 3]);
        job.send(&mut 0);
        assert_eq!(job_words(&job), "0 of 3 blocks");
        job.settle(0, Outcome::Silence, "");
        let words = job_words(&job);
        assert_eq!(
            words,
            "1 of 3 blocks, 1 block failed; 3000 to 3030: does not answer"
        );
    }

    #[test]
    fn tools_are_drawn() {
        let mut html = Markup::new();
        filters(&mut html, &["PST"], |key| if key == "q" { "a" } else { "" });
        reading(&mut html, 7, false, true, None);
        traffic(&mut html, &Traffic::default(), &Filter::default());
        let html = html.finish();
        for part in [
            "register-search",
            "Read all 7",
            "Polling",
            "filter-unit",
            "Pause",
        ] {
            assert!(html.contains(part), "{part}");
        }
    }
}
