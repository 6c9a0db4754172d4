//! One object: how it was read, what is to be known about it, its values in words.

use shared::dop::profile::Setting;
use shared::dop::{ObjectRead, Profile, Stamp};
use shared::map::row::Trust;
use shared::problem::Severity;
use shared::value::Quality;

use super::{assumed, reading, sign_of};
use crate::chart::time::stamp;
use crate::dop::cards::{Card, Line, cards};
use crate::dop::state::kept::{Decoded, Kept};
use crate::dop::when::{ago, exact, span};
use crate::format::{count, millis, thousands};
use crate::markup::Markup;
use crate::markup::device::sign;

/// Title, request word, and how and when it was read. `now` is in seconds since 1970.
pub fn head(html: &mut Markup, decoded: &Decoded, now: i64) {
    let read = &decoded.read;
    html.open("div", &[("class", "object-title")]);
    let title = read.object.map_or("Unknown object", |o| o.label);
    html.node("h2", "", title);
    html.open("p", &[("class", "quiet")]);
    html.text(&format!("object {}", read.request.object()));
    if let Some(choice) = read.choice.filter(|c| !c.label.is_empty()) {
        html.text(" · ").text(choice.label);
    } else if read.object.is_some_and(|o| o.options.len() > 1) {
        html.text(&format!(" · option {}", read.request.option()));
    }
    html.text(" · ").node("code", "", &read.request.to_string());
    html.close("p").close("div");
    how(html, &decoded.kept, now);
}

/// How, when and from where registers were read.
fn how(html: &mut Markup, kept: &Kept, now: i64) {
    html.open(
        "p",
        &[("class", "object-how quiet"), ("data-testid", "object-how")],
    );
    let registers = count(u64::try_from(kept.words.len()).unwrap_or(0), "register");
    html.text(&format!("{registers}, {}", kept.origin));
    if let Some(wall) = kept.wall_ms {
        let then = i64::try_from(wall / 1000).unwrap_or(0);
        html.text(", ").node("b", "", &ago(then, now));
        html.text(&format!(" ({} UTC)", stamp(then)));
    }
    if let Some(course) = kept.course {
        html.text(&format!(
            ". Took {}, busy {}, status read {}",
            millis(course.took_us),
            millis(course.busy_us),
            times(course.polls)
        ));
        if course.retries > 0 {
            html.text(&format!(", begun anew {}", times(course.retries)));
        }
        if course.foreign > 0 {
            html.text(&format!(
                ", another master asked in between {}",
                times(course.foreign)
            ));
        }
    }
    html.text(".").close("p");
}

fn times(count: u32) -> String {
    match count {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        n => format!("{} times", thousands(u64::from(n))),
    }
}

/// How the layout was chosen, what is wrong, what is assumed, which readings hold.
pub fn remarks(html: &mut Markup, decoded: &Decoded) {
    let read = &decoded.read;
    html.open(
        "p",
        &[("class", "object-why"), ("data-testid", "object-why")],
    );
    html.text(&read.why);
    if let Some(layout_reading) = read.layout.and_then(|l| l.reading) {
        html.text(" ");
        reading(html, layout_reading);
    }
    if let Some(object) = read.object {
        html.text(" ");
        html.node("span", "quiet", &object.section.to_string());
        for read in object
            .reading
            .into_iter()
            .chain(object.also.iter().copied())
        {
            html.text(" ");
            reading(html, read);
        }
        if !object.note.is_empty() {
            html.text(" ").node("span", "quiet", object.note);
        }
    }
    if let Some(read) = read.choice.and_then(|c| c.reading) {
        html.text(" ");
        reading(html, read);
    }
    html.close("p");
    if let Some(code) = read.error {
        html.open(
            "p",
            &[("class", "object-error"), ("data-testid", "object-error")],
        );
        html.severity(Severity::Error);
        let words =
            shared::dop::error_name(code).unwrap_or("a code that the manual leaves undefined");
        html.text(&format!(" The unit answered with error {code}: {words}."))
            .close("p");
    }
    problems(html, read, &decoded.kept.remarks);
    let settings = assumptions(read, &decoded.profile);
    if !settings.is_empty() {
        html.open(
            "p",
            &[("class", "object-assumed"), ("data-testid", "assumptions")],
        );
        assumed(html);
        html.text(" ");
        for (at, words) in settings.iter().enumerate() {
            html.text(if at == 0 { "" } else { "; " }).text(words);
        }
        html.text(". A profile settles it.").close("p");
    }
}

fn problems(html: &mut Markup, read: &ObjectRead, more: &[String]) {
    let problems = read.decoded.problems();
    if problems.is_empty() && more.is_empty() {
        return;
    }
    html.open("ul", &[("class", "object-problems")]);
    for problem in problems {
        html.open(
            "li",
            &[
                ("data-testid", "object-problem"),
                ("data-code", problem.code()),
                ("data-byte", &problem.place.start.to_string()),
            ],
        );
        html.severity(problem.severity());
        html.text(" ").text(&problem.to_string()).close("li");
    }
    for words in more {
        html.open("li", &[("data-testid", "object-remark")]);
        html.severity(Severity::Note);
        html.text(" ").text(words).close("li");
    }
    html.close("ul");
}

/// What is assumed about a read, in words: only settings that this object depends on.
#[must_use]
pub fn assumptions(read: &ObjectRead, profile: &Profile) -> Vec<String> {
    let fields = read.layout.map_or(&[][..], |l| l.fields);
    let mut settings: Vec<Setting> = Vec::new();
    let mut want = |setting| {
        if profile.is_assumed(setting) && !settings.contains(&setting) {
            settings.push(setting);
        }
    };
    for field in fields {
        if let Some(setting) = field.setting {
            want(setting);
        }
    }
    use shared::dop::object::FieldKind as Kind;
    let has = |wanted: fn(Kind) -> bool| fields.iter().any(|f| wanted(f.kind));
    if has(|k| matches!(k, Kind::Time)) {
        want(Setting::TimeEpoch);
    }
    if has(|k| matches!(k, Kind::Text(_))) {
        want(Setting::TextLowByteFirst);
    }
    if has(|k| matches!(k, Kind::U32 | Kind::S32 | Kind::Time)) {
        want(Setting::LowWordFirst);
    }
    settings.into_iter().map(words).map(str::to_owned).collect()
}

/// A setting that nobody made, in words.
const fn words(setting: Setting) -> &'static str {
    match setting {
        Setting::Table => "areas in holding registers",
        Setting::RequestFunction => "request written with function 6",
        Setting::StatusShift => "status bits where they were learned",
        Setting::LowWordFirst => "low word first",
        Setting::TextLowByteFirst => "first character in the low byte",
        Setting::ByteSwap => "bytes as they came",
        Setting::TimeEpoch => "times count seconds since 1970 UTC",
        Setting::TimeUnit => "times in seconds",
        Setting::Temperature => "temperatures in °C",
        Setting::DstTrend => "1000 counts a turn",
        Setting::DstStatistics => "10 000 counts a turn",
        Setting::MovementPosition => "positions in whole percent",
        Setting::MovementSpeed => "speeds in whole rpm",
        Setting::MovementTorque => "torques in whole percent",
        Setting::LogCommands => "options of the log",
    }
}

/// The single values in groups. A time is told in words and exactly.
pub fn values(html: &mut Markup, decoded: &Decoded, now: i64) {
    let read = &decoded.read;
    if read.error.is_some() {
        return;
    }
    let cards = cards(read, &decoded.profile);
    html.open("div", &[("class", "cards")]);
    for card in &cards {
        draw_card(html, read, card, now);
    }
    html.close("div");
    let records = read.records();
    if !records.is_empty() {
        html.open("div", &[("class", "log-rows")]);
        for record in &records {
            super::logs::row(html, record, now);
        }
        html.close("div");
    }
}

fn draw_card(html: &mut Markup, read: &ObjectRead, card: &Card, now: i64) {
    html.open("section", &[("class", "card"), ("data-testid", "card")]);
    if !card.title.is_empty() {
        html.node("h3", "", card.title);
    }
    html.open("dl", &[]);
    for line in &card.lines {
        draw_line(html, read, line, now);
    }
    html.close("dl").close("section");
}

fn draw_line(html: &mut Markup, read: &ObjectRead, line: &Line, now: i64) {
    html.open(
        "div",
        &[
            ("class", "card-line"),
            ("data-testid", "card-line"),
            ("data-path", &line.path),
            ("data-field", &line.id.get().to_string()),
        ],
    );
    html.node("dt", "", &line.label);
    html.open("dd", &[("class", if line.numeric { "num" } else { "" })]);
    let key = line.path.rsplit('.').next().unwrap_or("");
    let bits = read.active(key);
    match line.stamp {
        Some(stamp) => draw_time(html, stamp, now),
        None if matches!(key, "alarms" | "warnings") => draw_bits(html, &bits),
        None => {
            let text = if line.text.is_empty() {
                "–"
            } else {
                &line.text
            };
            html.node("b", "", text)
                .text(" ")
                .node("i", "unit", line.unit);
            if line.unit == "s" {
                html.text(" ");
                longer(html, &line.text);
            }
        }
    }
    if line.quality != Quality::Good {
        html.text(" ").node("em", "quality", line.quality.label());
    }
    if line.assumed {
        html.text(" ");
        assumed(html);
    }
    if let Some(read) = line.reading.filter(|_| line.trust != Trust::Manual) {
        html.text(" ");
        reading(html, read);
    }
    html.close("dd").close("div");
}

/// Seconds beyond a minute or two in a larger unit as well.
fn longer(html: &mut Markup, text: &str) {
    let whole = text.split('.').next().and_then(|t| t.parse::<u64>().ok());
    if let Some(seconds) = whole.filter(|s| *s >= 120) {
        html.node("span", "quiet", &span(seconds));
    }
}

fn draw_time(html: &mut Markup, stamp: Stamp, now: i64) {
    match stamp {
        Stamp::At(seconds) => {
            html.node("b", "", &ago(seconds, now)).text(" ");
            html.node("span", "quiet exact", &exact(stamp));
        }
        _ => {
            html.node("span", "quiet", &exact(stamp));
        }
    }
}

/// Bits that are set, with the sign of their category and whether the profile names them.
pub fn draw_bits(html: &mut Markup, bits: &[shared::dop::profile::BitLabel]) {
    if bits.is_empty() {
        html.node("span", "quiet", "none");
        return;
    }
    html.open("ul", &[("class", "bits")]);
    for bit in bits {
        html.open(
            "li",
            &[("data-testid", "bit"), ("data-bit", &bit.bit.to_string())],
        );
        if let Some(category) = bit.ne107 {
            sign(html, sign_of(category), "18");
            html.text(" ");
        }
        html.text(&bit.name);
        if bit.assumed {
            html.text(" ")
                .node("span", "quiet", "(not named in the profile)");
        }
        html.close("li");
    }
    html.close("ul");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dop::registers::Registers;
    use shared::dop::Request;
    use std::sync::Arc;

    const THEN: i64 = 0x6026_9ECB;

    fn decoded(request: u16, registers: Registers, profile: &str) -> Decoded {
        let profile = Profile::from_json(profile).unwrap();
        let kept = Kept::new(Request::from_word(request), registers.0, "pasted");
        Decoded::new(kept, &Arc::new(profile))
    }

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    /// Object 209: open 12 passed, 3 failed for reason 13; close never.
    fn strokes() -> Decoded {
        let registers = Registers::default()
            .i32([12])
            .i64([THEN])
            .i32([3])
            .i64([THEN - 86_400 * 3])
            .u16([13])
            .i32([0])
            .i64([0])
            .i32([0])
            .i64([0])
            .u16([0]);
        decoded(209, registers, "{}")
    }

    #[test]
    fn times_are_told_in_words_and_exactly() {
        let html = drawn(|html| values(html, &strokes(), THEN + 120));
        assert!(
            html.contains("2 minutes ago") && html.contains("2021-02-12 15:29:15 UTC"),
            "{html}"
        );
        assert!(html.contains("3 days ago") && html.contains("never"));
        assert!(
            html.contains("Valve Jam") || html.contains("Valve jam"),
            "{html}"
        );
        assert_eq!(html.matches("data-testid=\"card\"").count(), 4);
        assert!(html.contains(">Open, failed<"));
    }

    #[test]
    fn how_it_was_read_is_told() {
        let mut decoded = strokes();
        decoded.kept.wall_ms = Some(1_613_143_755_000);
        decoded.kept.course = Some(crate::dop::state::kept::Course {
            took_us: 812_000,
            busy_us: 250_000,
            polls: 2,
            retries: 1,
            foreign: 3,
        });
        let html = drawn(|html| head(html, &decoded, THEN + 7200));
        for words in [
            "26 registers",
            "2 hours ago",
            "812.0 ms",
            "status read twice",
            "begun anew once",
            "in between 3 times",
            "0x00D1",
        ] {
            assert!(html.contains(words), "{words}: {html}");
        }
    }

    #[test]
    fn bits_carry_names_and_signs_of_the_profile() {
        let profile = r#"{"alarms":[{"bit":2,"name":"Motor hot","ne107":"F"}]}"#;
        // Alarms 2 and 31, no warning.
        let alarms = decoded(1005, Registers::default().u16([4, 0x8000, 0, 0]), profile);
        let html = drawn(|html| values(html, &alarms, 0));
        assert!(
            html.contains("Motor hot") && html.contains("sign-f"),
            "{html}"
        );
        assert!(html.contains("Alarm bit 31") && html.contains("not named in the profile"));
        assert!(html.contains(">none<"));
    }

    #[test]
    fn assumptions_are_only_those_that_matter() {
        let registers = || {
            Registers::default()
                .u16([215])
                .i64([THEN])
                .u16([300])
                .i64([0])
                .u16([0])
        };
        let temperatures = |profile| {
            let registers = registers().i64([0]).i32([0]).i64([0]).i32([0]);
            decoded(602, registers, profile)
        };
        let words = |d: &Decoded| assumptions(&d.read, &d.profile).join("; ");
        let all = words(&temperatures("{}"));
        assert!(
            all.contains("°C") && all.contains("1970") && all.contains("low word"),
            "{all}"
        );
        let set = r#"{"temperature":"degF","time":{"epoch":0},"words":{"low_word_first":true}}"#;
        assert_eq!(words(&temperatures(set)), "");
        let mut told = temperatures("{}");
        told.kept.remarks.push("by hand".into());
        let html = drawn(|html| remarks(html, &told));
        assert!(html.contains("assumptions") && html.contains("by hand"));
    }

    #[test]
    fn an_error_is_told_in_words() {
        let mut kept = Kept::new(Request::from_word(0x10CD), vec![3], "pasted");
        kept.error = true;
        let decoded = Decoded::new(kept, &Arc::new(Profile::default()));
        let html = drawn(|html| remarks(html, &decoded));
        assert!(
            html.contains("error 3") && html.to_lowercase().contains("option invalid"),
            "{html}"
        );
        assert_eq!(drawn(|html| values(html, &decoded, 0)), "");
    }
}
