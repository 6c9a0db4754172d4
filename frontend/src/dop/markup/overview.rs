//! The state of a unit at a glance: what is active, who it is, its clock, supply, work and tests.

use shared::dop::object::Object;
use shared::dop::profile::{BitLabel, BitWord};
use shared::dop::{LogRecord, Profile, Request, Stamp};
use shared::problem::Severity;

use super::list::link;
use super::object::values;
use super::sign_of;
use crate::dop::state::explain::{explained, since};
use crate::dop::state::kept::Decoded;
use crate::dop::state::logs::EVENTS;
use crate::dop::state::site::{Site, newest};
use crate::dop::when::{ago, exact, span};
use crate::markup::Markup;
use crate::markup::device::sign;

/// Alarms and warnings.
pub const ALARMS: u16 = 1005;
/// The clock.
pub const CLOCK: u16 = 1007;

/// The objects that the overview shows besides the indicators.
pub const SHOWN: [u16; 6] = [ALARMS, 1006, CLOCK, 1003, 1004, 209];

/// User indicators, alarms and warnings that are active.
pub fn active(html: &mut Markup, site: &Site, tag: &str, now_us: u64, now: i64) {
    let events = events(site);
    html.open(
        "section",
        &[("class", "active-bits"), ("data-testid", "indicators")],
    );
    html.node("h3", "", "User indicators");
    match site.indicators {
        None => {
            let words = if site.profile.registers.indicators.is_none() && site.known {
                "The profile has no address for the indicators."
            } else {
                "Not read yet."
            };
            html.node("p", "quiet", words);
        }
        Some((raw, at)) => {
            bits(
                html,
                &events,
                tag,
                &site.profile.active(BitWord::Indicators, raw),
                now,
            );
            let seconds = now_us.saturating_sub(at) / 1_000_000;
            let when = match seconds {
                0..10 => "just now".to_owned(),
                _ => format!("{} ago", span(seconds)),
            };
            let words = format!("read {when}; they stay until they are acknowledged at the unit");
            html.node("p", "quiet", &words);
        }
    }
    html.close("section");
    let alarms = site.kept.get(&ALARMS).map(|kept| kept.read(&site.profile));
    for (key, title) in [("alarms", "Alarms"), ("warnings", "Warnings")] {
        html.open("section", &[("class", "active-bits"), ("data-testid", key)]);
        html.node("h3", "", title);
        match &alarms {
            None => {
                state_of(html, site, ALARMS);
            }
            Some(read) => bits(html, &events, tag, &read.active(key), now),
        }
        html.close("section");
    }
}

/// The events that are known: the log as far as it was read, and the newest page of it.
fn events(site: &Site) -> Vec<LogRecord> {
    let newest = newest(EVENTS, &site.profile).and_then(|r| site.kept.get(&r.word()));
    let page = newest.map_or_else(Vec::new, |kept| kept.read(&site.profile).records());
    site.events.records.iter().cloned().chain(page).collect()
}

/// Bits that are set: their sign and name, since when, and which object says more.
fn bits(html: &mut Markup, events: &[LogRecord], tag: &str, bits: &[BitLabel], now: i64) {
    if bits.is_empty() {
        html.node("p", "quiet", "none active");
        return;
    }
    html.open("ul", &[("class", "conditions")]);
    for bit in bits {
        html.open(
            "li",
            &[
                ("data-testid", "active-bit"),
                ("data-bit", &bit.bit.to_string()),
            ],
        );
        if let Some(category) = bit.ne107 {
            sign(html, sign_of(category), "18");
        } else {
            html.severity(Severity::Note);
        }
        html.open("span", &[("class", "active-name")]);
        html.node("b", "", &bit.name);
        if bit.assumed {
            html.node("span", "quiet", "not named in the profile");
        } else if let Some(event) = since(&bit.name, events) {
            let when = event
                .time
                .seconds()
                .map_or_else(String::new, |s| ago(s, now));
            html.node("span", "quiet", &format!("{when}, {}", exact(event.time)));
        } else if events.is_empty() {
            html.node("span", "quiet", "since when: read the event log");
        } else {
            html.node(
                "span",
                "quiet",
                "not in the event log as far as it was read",
            );
        }
        html.close("span");
        if let Some(more) = explained(&bit.name) {
            let query = format!("object={}&option={}", more.object, more.option);
            let label = shared::dop::object(more.object).map_or("", |o| o.label);
            html.open(
                "a",
                &[
                    ("class", "option"),
                    ("href", &link(tag, "objects", &query)),
                    ("data-testid", "explained"),
                ],
            );
            html.node("code", "quiet", &more.object.to_string())
                .text(" ")
                .text(label)
                .close("a");
        }
        html.close("li");
    }
    html.close("ul");
}

/// Why an object has no values.
fn state_of(html: &mut Markup, site: &Site, object: u16) {
    if let Some(failure) = site.failed.get(&object) {
        html.open("p", &[]);
        html.severity(Severity::Error);
        html.text(" ").text(&failure.text).close("p");
    } else {
        html.node("p", "quiet", "Not read yet.");
    }
}

/// One object of the overview with its values.
pub fn panel(html: &mut Markup, site: &Site, tag: &str, object: &Object, now: i64) {
    let id = object.id.to_string();
    html.open(
        "section",
        &[
            ("class", "panel"),
            ("data-testid", "panel"),
            ("data-object", &id),
        ],
    );
    html.open("h3", &[]);
    html.open(
        "a",
        &[(
            "href",
            &link(tag, "objects", &format!("object={id}&option=0")),
        )],
    );
    html.text(object.label).close("a");
    html.close("h3");
    match site.kept.get(&object.id) {
        None => state_of(html, site, object.id),
        Some(kept) => {
            let decoded = Decoded::new(kept.clone(), &site.profile);
            if object.id == CLOCK {
                deviation(html, &decoded);
            }
            values(html, &decoded, now);
        }
    }
    html.close("section");
}

/// How far the unit's clock was off when it was read.
fn deviation(html: &mut Markup, decoded: &Decoded) {
    let unit = decoded.read.layout.and_then(|layout| {
        let field = layout.fields.first()?;
        decoded.read.time(field.key)
    });
    let (Some(Stamp::At(unit)), Some(wall)) = (unit, decoded.kept.wall_ms) else {
        return;
    };
    let off = unit.saturating_sub(i64::try_from(wall / 1000).unwrap_or(0));
    let words = match off {
        -5..=5 => "The unit's clock agrees with that of the bridge.".to_owned(),
        6.. => format!(
            "The unit's clock is {} ahead of that of the bridge.",
            span(off.unsigned_abs())
        ),
        _ => format!(
            "The unit's clock is {} behind that of the bridge.",
            span(off.unsigned_abs())
        ),
    };
    html.open(
        "p",
        &[("class", "quiet"), ("data-testid", "clock-deviation")],
    );
    html.text(&words).close("p");
}

/// The requests that the overview needs: its objects, and the newest events, which tell since when
/// something is active.
#[must_use]
pub fn requests(profile: &Profile) -> Vec<Request> {
    let objects = SHOWN.into_iter().map(Request::from_word);
    objects.chain(newest(EVENTS, profile)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dop::registers::Registers;
    use crate::dop::state::kept::Kept;
    use crate::dop::state::site::Failure;
    use shared::proto::Outcome;
    use std::sync::Arc;

    const THEN: i64 = 0x6026_9ECB;

    fn site() -> Site {
        let profile = r#"{"indicators":[{"bit":3,"name":"Vibration HI","ne107":"S"}],
            "warnings":[{"bit":0,"name":"Battery low","ne107":"M"}]}"#;
        let mut site = Site {
            profile: Arc::new(Profile::from_json(profile).unwrap()),
            known: true,
            indicators: Some((0b1001_1000, 1_000_000)),
            ..Site::default()
        };
        // No alarm, warning 0.
        site.kept.insert(
            ALARMS,
            Kept::new(Request::from_word(ALARMS), vec![0, 0, 1, 0], ""),
        );
        site.events.records.push(LogRecord {
            index: 0,
            id: 4,
            time: Stamp::At(THEN),
            category: Some(1),
            text: "Vibration HI".into(),
            numbers: Vec::new(),
        });
        site
    }

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn what_is_active_says_since_when_and_where_to_look() {
        let html = drawn(|html| active(html, &site(), "MX-301", 31_000_000, THEN + 7200));
        assert_eq!(
            html.matches("data-testid=\"active-bit\"").count(),
            4,
            "{html}"
        );
        assert!(html.contains("2 hours ago, 2021-02-12 15:29:15 UTC"));
        assert!(
            html.contains("object=7&amp;option=1"),
            "explained by object 7: {html}"
        );
        assert!(html.contains("User indicator bit 4") && html.contains("not named in the profile"));
        assert!(html.contains("sign-s") && html.contains("sign-m"));
        assert!(html.contains("none active") && html.contains("read 30 seconds ago"));
    }

    #[test]
    fn what_was_not_read_is_not_none() {
        let mut site = Site::default();
        let html = drawn(|html| active(html, &site, "MX-301", 0, 0));
        assert_eq!(html.matches("Not read yet").count(), 3, "{html}");
        let failure = Failure {
            outcome: Outcome::Silence,
            code: None,
            text: "The unit stayed busy.".into(),
        };
        site.failed.insert(ALARMS, failure);
        let html = drawn(|html| active(html, &site, "MX-301", 0, 0));
        assert_eq!(html.matches("stayed busy").count(), 2);
    }

    #[test]
    fn the_clock_is_compared() {
        let mut site = Site::default();
        let registers = Registers::default().i64([THEN]).u16([3100, 2]);
        let mut kept = Kept::new(Request::from_word(CLOCK), registers.0, "");
        kept.wall_ms = Some((THEN.cast_unsigned() + 600) * 1000);
        site.kept.insert(CLOCK, kept);
        let object = shared::dop::object(CLOCK).unwrap();
        let html = drawn(|html| panel(html, &site, "MX-301", object, THEN + 660));
        assert!(html.contains("10 minutes behind"), "{html}");
        assert!(html.contains("3.100"), "battery in volts: {html}");
    }
}
