//! What the valve does, and whether it is healthy.

use super::values::{short, value};
use crate::components::ne107::Sign;
use crate::format::age;
use crate::hart::state::condition::{self, Ne107};
use crate::hart::state::unit::{Unit, find, plain};
use crate::markup::Markup;
use crate::markup::device::sign;
use crate::state::overview::{Figure, Overview, Travel};

use shared::hart::model::Bit;
use shared::value::Value;

/// Modes in which the valve does not follow its loop: unmistakable, above everything else.
pub fn forced(html: &mut Markup, unit: &Unit) {
    for words in condition::forced(unit) {
        html.open(
            "p",
            &[("class", "hart-forced"), ("data-testid", "hart-forced")],
        );
        sign(html, Sign::FunctionCheck, "20");
        html.node("b", "", &words).close("p");
    }
}

/// The valve as its picture needs it. Travel and limits that are old are words only.
#[must_use]
pub fn picture(unit: &Unit, now_us: u64) -> Overview {
    let fresh = unit.is_fresh(48, now_us);
    let (travel, close_limit, open_limit) = condition::travel(unit);
    let state = match travel {
        _ if unit.good(48).is_none() => "",
        Travel::Opening => "opening",
        Travel::Closing => "closing",
        Travel::Stopped if close_limit => "closed",
        Travel::Stopped if open_limit => "open",
        Travel::Stopped => "stopped",
    };
    let old = unit.good(48).filter(|_| !fresh);
    Overview {
        known: true,
        position: position(unit),
        travel: if fresh { travel } else { Travel::Stopped },
        close_limit: close_limit && fresh,
        open_limit: open_limit && fresh,
        state: old.map_or_else(
            || state.to_owned(),
            |good| format!("{state} {} ago", age(now_us.saturating_sub(good.at_us))),
        ),
        ..Overview::default()
    }
}

fn position(unit: &Unit) -> Option<Figure> {
    let good = unit.good(3)?;
    let (_, field) = find(&good.shown, "sv")?;
    let Value::Number { raw, scale } = field.value else {
        return None;
    };
    let text = good.shown.decoded.bare_text(field);
    Some(Figure {
        value: scale.to_f64(raw),
        text: short(&text).unwrap_or(text),
        unit: field.name.unit(),
        at: good.at_us,
        quality: None,
    })
}

/// Position and state, large; then demand, torque, current and mode.
pub fn figures(html: &mut Markup, unit: &Unit, open: &[String], now_us: u64) {
    let picture = picture(unit, now_us);
    let stale = !unit.is_fresh(3, now_us);
    let class = if stale { "big stale" } else { "big" };
    html.open("p", &[("class", class), ("data-testid", "hart-position")]);
    match &picture.position {
        Some(position) => {
            html.text(&position.text)
                .text(" ")
                .node("i", "unit", position.unit);
        }
        None => {
            html.text("–");
        }
    }
    if stale && picture.position.is_some() {
        html.text(" ").node("em", "quality stale-mark", "stale");
    }
    html.close("p");
    html.open(
        "p",
        &[("class", "big-state"), ("data-testid", "hart-state")],
    );
    html.text(&picture.state);
    if !picture.state.is_empty() && !unit.is_fresh(48, now_us) {
        html.text(" ").node("em", "quality stale-mark", "stale");
    }
    html.close("p");
    answered(html, unit, now_us);
    let third = condition::third(unit.family);
    // HART 5 and 6 have a type of one byte.
    let kind = match unit.raw(0, "device_type") {
        Some(_) => "device_type",
        None => "expanded_type",
    };
    html.open("div", &[("class", "hart-group")]);
    for (command, field, label) in [
        (3, "pv", "Demand"),
        (3, "sv", "Position"),
        (3, "tv", third),
        (3, "loop_current", "Loop current"),
        (133, "mode", "Control mode"),
        (20, "long_tag", "Long tag"),
        (0, kind, "Device type"),
        (0, "device_id", "Device id"),
    ] {
        value(html, unit, &plain(command), field, label, (open, now_us));
    }
    html.close("div");
}

/// When the device last answered, and what became of the last request.
fn answered(html: &mut Markup, unit: &Unit, now_us: u64) {
    html.open("p", &[("class", "quiet"), ("data-testid", "hart-answered")]);
    match unit.answered_us {
        Some(at) => {
            let words = format!("last answer {} ago", age(now_us.saturating_sub(at)));
            html.text(&words);
        }
        None => {
            html.text("not answered yet");
        }
    }
    if let Some((outcome, text)) = &unit.last
        && *outcome != shared::proto::Outcome::Ok
    {
        html.text(": ").text(text);
    }
    html.close("p");
}

/// NE 107 as the device reports it, its device status in words, and the bits that are set.
pub fn health(html: &mut Markup, unit: &Unit) {
    let set = condition::set_bits(unit);
    ne107(html, unit, &set);
    super::status::set_bits(html, unit, &set);
}

/// NE 107 as the device reports it; the bits are those that are set.
pub fn ne107(html: &mut Markup, unit: &Unit, set: &[&'static Bit]) {
    html.node("h2", "", "NE 107");
    html.open(
        "p",
        &[("class", "hart-ne107"), ("data-testid", "hart-ne107")],
    );
    match condition::ne107(unit) {
        Ne107::Unread => {
            html.node("span", "quiet", "not read");
        }
        Ne107::None(None) => {
            html.node(
                "span",
                "quiet",
                "This family reports no category; its device status shows no malfunction.",
            );
        }
        Ne107::None(Some(one)) => {
            sign(html, one, "20");
            html.text("Device malfunction; this family reports no category.");
        }
        Ne107::Signs(signs) if signs.is_empty() => {
            if condition::can_have_category(unit.family, set) {
                let map = format!("#/device/{}/map", crate::format::encode(&unit.tag));
                html.text("Alarm bits stand, but the device's map gives them no category. ");
                html.open("a", &[("href", &map)])
                    .text("Status map")
                    .close("a");
            } else if set.iter().any(|bit| bit.alarm) {
                html.text("No category is reported; no map gives one to the alarms that stand.");
            } else {
                html.text("Good: no category is reported.");
            }
        }
        Ne107::Signs(signs) => {
            for one in signs {
                sign(html, one, "20");
                html.node("b", "", one.label()).text(" ");
            }
        }
    }
    html.close("p");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{POLL, STATUS, hear, identity_of, poll, unit};
    use crate::markup::valve;

    #[test]
    fn the_overview_tells_position_and_health() {
        let unit = unit(&[(3, POLL.0, POLL.1), (48, STATUS.0, STATUS.1)]);
        let mut html = Markup::new();
        forced(&mut html, &unit);
        assert_eq!(html.clone().finish(), "", "nothing is forced");
        figures(&mut html, &unit, &[], 7);
        health(&mut html, &unit);
        valve::valve(&mut html, &picture(&unit, 7));
        let html = html.finish();
        assert!(html.contains("49.5 <i class=\"unit\">%</i>"), "{html}");
        assert!(html.contains(">open<"), "the open limit is reached");
        assert!(html.contains("Failure"));
        assert!(html.contains("Local control fault"), "{html}");
        assert!(!html.contains("stale-mark"));
    }

    /// Command 48 came at 7 µs with the open limit; command 3 went on.
    #[test]
    fn an_old_picture_does_not_look_live() {
        let mut unit = unit(&[(48, STATUS.0, STATUS.1)]);
        hear(&mut unit, 3, 0, &poll(50.0), 34);
        let now = 34_000_007;
        let seen = picture(&unit, now);
        assert!(!seen.open_limit);
        assert_eq!(seen.state, "open 34 s ago");
        let mut html = Markup::new();
        figures(&mut html, &unit, &[], now);
        let text = html.finish();
        assert!(text.contains("open 34 s ago <em class=\"quality stale-mark\">stale"));
        assert_eq!(text.matches("stale-mark").count(), 1, "the position is not");
    }

    /// An IQ with local control fault and an extended status of 0: its map is that of the factory.
    #[test]
    fn alarms_without_a_category_are_not_good() {
        let said = |status: &[u8], device: u8| {
            let mut unit = unit(&[]);
            hear(&mut unit, 48, device, status, 1);
            let mut html = Markup::new();
            health(&mut html, &unit);
            html.finish()
        };
        let html = said(&[2, 0, 0, 0, 0, 0, 0, 0, 0], 0);
        assert!(html.contains("gives them no category") && html.contains("#/device/FV-1/map"));
        assert!(!html.contains("Good:"), "{html}");
        // PV out of limits is no bit of a map; a moving valve is no alarm.
        assert!(said(&[0; 9], 1).contains("no map gives one"));
        assert!(said(&[0, 0, 0, 0, 1, 0, 0, 0, 0], 0).contains("Good:"));
    }

    #[test]
    fn older_revisions_have_a_type() {
        for (revision, key) in [
            (5, "0.device_type"),
            (6, "0.device_type"),
            (7, "0.expanded_type"),
        ] {
            let mut unit = unit(&[]);
            hear(&mut unit, 0, 0, &identity_of(revision, 1), 1);
            let mut html = Markup::new();
            figures(&mut html, &unit, &[], 1);
            assert!(html.finish().contains(key), "{revision}");
        }
    }

    #[test]
    fn nothing_read_is_said() {
        let mut html = Markup::new();
        figures(&mut html, &unit(&[]), &[], 7);
        health(&mut html, &unit(&[]));
        let html = html.finish();
        assert!(html.contains("not answered yet") && html.contains("–"));
        assert!(!html.contains(">0<"));
    }
}
