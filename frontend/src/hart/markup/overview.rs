//! What the valve does, and whether it is healthy.

use super::values::value;
use crate::components::ne107::Sign;
use crate::format::age;
use crate::hart::state::condition::{self, Ne107};
use crate::hart::state::unit::{Unit, find, plain};
use crate::markup::Markup;
use crate::markup::device::sign;
use crate::state::overview::{Figure, Overview, Travel};

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

/// The valve as its picture needs it.
#[must_use]
pub fn picture(unit: &Unit) -> Overview {
    let (travel, close_limit, open_limit) = condition::travel(unit);
    let state = match travel {
        _ if unit.good(48).is_none() => "",
        Travel::Opening => "opening",
        Travel::Closing => "closing",
        Travel::Stopped if close_limit => "closed",
        Travel::Stopped if open_limit => "open",
        Travel::Stopped => "stopped",
    };
    Overview {
        known: true,
        position: position(unit),
        travel,
        close_limit,
        open_limit,
        state: state.to_owned(),
        ..Overview::default()
    }
}

fn position(unit: &Unit) -> Option<Figure> {
    let good = unit.good(3)?;
    let (_, field) = find(&good.shown, "sv")?;
    let Value::Number { raw, scale } = field.value else {
        return None;
    };
    Some(Figure {
        value: scale.to_f64(raw),
        text: good.shown.decoded.bare_text(field),
        unit: field.name.unit(),
        at: good.at_us,
        quality: None,
    })
}

/// Position and state, large; then demand, torque, current and mode.
pub fn figures(html: &mut Markup, unit: &Unit, open: &[String], now_us: u64, online: bool) {
    let picture = picture(unit);
    let stale = !online
        || unit
            .reading(&plain(3))
            .is_none_or(|r| r.bad.is_some() || r.good.is_none());
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
    html.close("p").open("p", &[("class", "big-state")]);
    html.text(&picture.state);
    if stale && picture.position.is_some() {
        html.text(" ").node("em", "quality stale-mark", "stale");
    }
    html.close("p");
    answered(html, unit, now_us);
    let third = condition::third(unit.family);
    html.open("div", &[("class", "hart-group")]);
    for (command, field, label) in [
        (3, "pv", "Demand"),
        (3, "sv", "Position"),
        (3, "tv", third),
        (3, "loop_current", "Loop current"),
        (133, "mode", "Control mode"),
        (20, "long_tag", "Long tag"),
        (0, "expanded_type", "Device type"),
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
            html.text("Good: no category is reported.");
        }
        Ne107::Signs(signs) => {
            for one in signs {
                sign(html, one, "20");
                html.node("b", "", one.label()).text(" ");
            }
        }
    }
    html.close("p");
    super::status::set_bits(html, unit);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{POLL, STATUS, unit};
    use crate::markup::valve;

    #[test]
    fn the_overview_tells_position_and_health() {
        let unit = unit(&[(3, POLL.0, POLL.1), (48, STATUS.0, STATUS.1)]);
        let mut html = Markup::new();
        forced(&mut html, &unit);
        assert_eq!(html.clone().finish(), "", "nothing is forced");
        figures(&mut html, &unit, &[], 7, true);
        health(&mut html, &unit);
        valve::valve(&mut html, &picture(&unit));
        let html = html.finish();
        assert!(html.contains("49.5 <i class=\"unit\">%</i>"), "{html}");
        assert!(html.contains(">open<"), "the open limit is reached");
        assert!(html.contains("Failure"));
        assert!(html.contains("Local control fault"), "{html}");
        assert!(!html.contains("stale-mark"));
    }

    #[test]
    fn nothing_read_is_said() {
        let mut html = Markup::new();
        figures(&mut html, &unit(&[]), &[], 7, true);
        health(&mut html, &unit(&[]));
        let html = html.finish();
        assert!(html.contains("not answered yet") && html.contains("–"));
        assert!(!html.contains(">0<"));
    }
}
