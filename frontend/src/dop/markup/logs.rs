//! The event log and the movement log.

use shared::dop::LogRecord;
use shared::dop::profile::Ne107;

use super::list::link;
use super::sign_of;
use crate::components::icon::Glyph;
use crate::dop::state::logs::{EVENTS, Filter, Log, MOVEMENTS, category};
use crate::dop::state::site::Job;
use crate::dop::when::{ago, exact};
use crate::format::count;
use crate::markup::Markup;
use crate::markup::control::{Button, Choice};
use crate::markup::device::sign;

/// Which log is open.
pub fn choose(html: &mut Markup, tag: &str, open: u16) {
    for (object, name) in [(EVENTS, "Events"), (MOVEMENTS, "Movements")] {
        let id = object.to_string();
        html.open(
            "a",
            &[
                ("class", "option"),
                ("href", &link(tag, "logs", &format!("log={id}"))),
                ("data-testid", &format!("log-{id}")),
                (
                    "aria-current",
                    if object == open { "page" } else { "false" },
                ),
            ],
        );
        html.text(name)
            .text(" ")
            .node("code", "quiet", &id)
            .close("a");
    }
}

/// The buttons of a log, and how far it is.
pub fn tools(html: &mut Markup, log: &Log, job: Option<&Job>, online: bool) {
    let idle = online && job.is_none();
    for (act, words) in [("newest", "From the newest"), ("oldest", "From the oldest")] {
        Button {
            act,
            testid: &format!("log-{act}"),
            words,
            glyph: Some(if act == "newest" {
                Glyph::Down
            } else {
                Glyph::Up
            }),
            disabled: !idle,
            ..Button::default()
        }
        .draw(html);
    }
    Button {
        act: "resume",
        testid: "log-resume",
        words: "Go on",
        glyph: Some(Glyph::Play),
        disabled: !idle || log.records.is_empty(),
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "cancel",
        testid: "log-cancel",
        words: "Cancel",
        glyph: Some(Glyph::Close),
        hidden: job.is_none(),
        disabled: job.is_some_and(|j| j.cancelled),
        ..Button::default()
    }
    .draw(html);
    for (act, words) in [("csv", "CSV"), ("json", "JSON")] {
        Button {
            act,
            testid: &format!("log-{act}"),
            words,
            glyph: Some(Glyph::Save),
            disabled: log.records.is_empty(),
            ..Button::default()
        }
        .draw(html);
    }
}

/// What is looked for.
pub fn filter(html: &mut Markup, log: u16, filter: &Filter) {
    html.open(
        "input",
        &[
            ("type", "search"),
            ("data-act", "text"),
            ("data-testid", "log-filter"),
            ("data-value", &filter.text),
            ("value", &filter.text),
            ("placeholder", "Text or number"),
            ("aria-label", "Text or number of a record"),
            ("data-find", ""),
        ],
    );
    if log == EVENTS {
        let codes: Vec<(String, String)> = (0..8).map(|c| (c.to_string(), category(c))).collect();
        let value = filter.category.map_or_else(String::new, |c| c.to_string());
        Choice {
            act: "category",
            testid: "log-category",
            label: "All categories",
            value: &value,
            ..Choice::default()
        }
        .draw(html, codes.iter().map(|(c, w)| (c.as_str(), w.as_str())));
    }
}

/// How many records there are and why the log ended.
pub fn status(html: &mut Markup, log: &Log, job: Option<&Job>, shown: usize) {
    let records = count(u64::try_from(log.records.len()).unwrap_or(0), "record");
    html.node("b", "", &records);
    if shown != log.records.len() {
        html.text(&format!(", {shown} shown"));
    }
    if log.pages > 0 {
        html.text(&format!(" of {}", count(u64::from(log.pages), "page")));
    }
    if log.repeated > 0 {
        html.text(&format!(", {} came again and left out", log.repeated));
    }
    html.text(match (log.pages, log.from_oldest) {
        (0, _) => "",
        (_, true) => ", the oldest first",
        (_, false) => ", the newest first",
    });
    if let Some(job) = job {
        html.text(" · ").node(
            "span",
            "quiet",
            if job.cancelled { "Ending" } else { &job.text },
        );
    } else if let Some(end) = &log.end {
        html.text(" · ").node("span", "quiet", end);
    }
}

/// One record.
pub fn row(html: &mut Markup, record: &LogRecord, now: i64) {
    let class = if record.category.is_some() {
        "log-row event"
    } else {
        "log-row movement"
    };
    html.open(
        "div",
        &[
            ("class", class),
            ("data-testid", "log-row"),
            ("data-id", &record.id.to_string()),
        ],
    );
    html.open("span", &[("class", "log-sign")]);
    if let Some(category) = record.category.and_then(Ne107::from_log) {
        sign(html, sign_of(category), "18");
    }
    html.close("span");
    html.node("code", "log-id quiet num", &record.id.to_string());
    html.open("span", &[("class", "log-time")]);
    html.node("span", "exact", &exact(record.time));
    if let Some(seconds) = record.time.seconds() {
        html.text(" ")
            .node("span", "quiet log-ago", &ago(seconds, now));
    }
    html.close("span");
    html.open("span", &[("class", "log-text")]);
    html.node(
        "b",
        "",
        if record.text.is_empty() {
            "–"
        } else {
            &record.text
        },
    );
    if let Some(code) = record.category {
        html.text(" ").node("span", "quiet", &category(code));
    }
    html.close("span");
    html.open("span", &[("class", "log-numbers")]);
    for (field, number) in &record.numbers {
        html.open("span", &[("class", "log-number"), ("data-key", field.key)]);
        html.node("span", "quiet", short(field.key)).text(" ");
        html.node("b", "", &number.scale.apply(number.raw).to_string());
        html.text(" ").node("i", "unit", number.unit).close("span");
    }
    html.close("span").close("div");
}

/// A short name for a column of the movement log.
fn short(key: &str) -> &str {
    match key {
        "position" => "pos",
        "speed" => "speed",
        "torque" => "torque",
        "motor_temperature" | "temperature" => "motor",
        "demand" => "demand",
        "deadband" => "deadband",
        "proportional_band" | "band" => "band",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dop::registers::Registers;
    use shared::dop::{ObjectRead, Profile, Request};

    const THEN: i64 = 0x6026_9ECB;

    fn event() -> ObjectRead {
        let registers = Registers::default()
            .u16([1])
            .i32([70_000])
            .i64([THEN])
            .u16([3])
            .text("Open overtorque", 20);
        ObjectRead::read(
            Request::from_word(0x04B2),
            &registers.0,
            &Profile::default(),
        )
    }

    fn movement() -> ObjectRead {
        let registers = Registers::default()
            .u16([1, 7])
            .i64([THEN])
            .u16([45, 0xFFF4, 30, 215, 500, 10, 55])
            .text("Remote open", 16);
        ObjectRead::read(
            Request::from_word(0x04B3),
            &registers.0,
            &Profile::default(),
        )
    }

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn events_carry_sign_words_and_time() {
        let record = &event().records()[0];
        let html = drawn(|html| row(html, record, THEN + 3600));
        for words in [
            "70000",
            "Open overtorque",
            "Failure",
            "sign-f",
            "60 minutes ago",
            "15:29:15 UTC",
        ] {
            assert!(html.contains(words), "{words}: {html}");
        }
    }

    #[test]
    fn movements_carry_their_numbers() {
        let record = &movement().records()[0];
        let html = drawn(|html| row(html, record, THEN));
        // Speed -12 rpm; demand 50.0 %, deadband 1.0 %, band 5.5 %, motor 21.5 °C.
        for words in [
            "Remote open",
            ">45<",
            ">-12<",
            ">50.0<",
            ">1.0<",
            ">5.5<",
            ">21.5<",
        ] {
            assert!(html.contains(words), "{words}: {html}");
        }
        assert!(!html.contains("class=\"sign"));
    }

    #[test]
    fn a_log_says_where_it_stands() {
        let mut log = Log::begin(false);
        log.add(&event());
        log.add(&event());
        log.end = Some("The device has no older records.".into());
        let html = drawn(|html| status(html, &log, None, 1));
        assert!(
            html.contains("1 record") && html.contains("of 2 pages"),
            "{html}"
        );
        assert!(html.contains("1 came again") && html.contains("no older records"));
        let tools = drawn(|html| tools(html, &log, None, true));
        assert!(tools.contains("data-testid=\"log-resume\">") && tools.contains("hidden"));
    }
}
