//! The status of a device by bit.

use shared::hart::model::Bit;
use shared::tree::{FieldId, Name};
use shared::value::Value;

use crate::components::ne107::Sign;
use crate::format::age;
use crate::hart::state::unit::{Good, Key, Unit, find, plain};
use crate::hart::state::{condition, plan};
use crate::markup::Markup;
use crate::markup::device::sign;

/// The bits of a field of flags, with whether they are set.
fn bits(good: &Good, id: FieldId) -> impl Iterator<Item = (&'static Bit, bool)> {
    let fields = good.shown.decoded.fields().iter();
    fields.filter_map(move |field| match (field.name, field.value) {
        (Name::HartBit(bit), Value::Bit { on, .. }) if field.parent == Some(id) => Some((bit, on)),
        _ => None,
    })
}

/// The bits that are set in device status and command 48: alarms first.
pub fn set_bits(html: &mut Markup, unit: &Unit, all: &[&Bit]) {
    if unit.good(48).is_none() {
        html.node("p", "quiet", "Command 48 was not read yet.");
    }
    for (title, alarm) in [("Alarms", true), ("States", false)] {
        html.node("h3", "", title);
        let mut some = false;
        html.open("ul", &[("class", "conditions")]);
        for bit in all.iter().filter(|b| b.alarm == alarm) {
            some = true;
            html.open("li", &[("data-testid", "hart-set"), ("data-key", bit.key)]);
            if alarm {
                sign(html, Sign::Warning, "18");
            }
            html.node("span", "", bit.label);
            if !bit.alias.is_empty() {
                html.text(" ")
                    .node("span", "quiet", &format!("also: {}", bit.alias));
            }
            html.close("li");
        }
        html.close("ul");
        if !some {
            html.node("p", "quiet", "none");
        }
    }
}

/// All bits of the answers that carry status, in their order.
pub fn status(html: &mut Markup, unit: &Unit, now_us: u64) {
    html.open("section", &[("class", "hart-status")]);
    super::overview::ne107(html, unit, &condition::set_bits(unit));
    let map = super::super::state::map::of_device(unit);
    if let (Some(family), Some(map), Some(status)) =
        (unit.family, map, condition::alarm_bytes(unit))
    {
        super::map::result(html, "the status as read", map.report(family, &status));
    }
    html.close("section");
    section(
        html,
        unit,
        &plain(48),
        "Additional device status, command 48",
        now_us,
    );
    if unit.has(129) {
        section(
            html,
            unit,
            &plan::status_word(),
            "Actuator status register, command 129",
            now_us,
        );
    }
}

fn section(html: &mut Markup, unit: &Unit, key: &Key, title: &str, now_us: u64) {
    html.open("section", &[("class", "hart-status")]);
    html.open("h2", &[]).text(title);
    let reading = unit.reading(key);
    let good = reading.and_then(|r| r.good.as_ref());
    if let Some(good) = good {
        let words = format!(" {} ago", age(now_us.saturating_sub(good.at_us)));
        html.node("span", "quiet", &words);
    }
    html.close("h2");
    if let Some(bad) = reading.and_then(|r| r.bad.as_ref()) {
        html.node("p", "notice", &bad.text);
    }
    match good {
        Some(good) => fields(html, good),
        None if reading.is_none() => {
            html.node("p", "quiet", "not read");
        }
        None => {}
    }
    html.close("section");
}

fn fields(html: &mut Markup, good: &Good) {
    let decoded = &good.shown.decoded;
    html.open("div", &[("class", "hart-bytes")]);
    for (id, field) in decoded.iter() {
        let Value::Flags { .. } = field.value else {
            continue;
        };
        html.open(
            "section",
            &[("class", "hart-byte"), ("data-testid", "hart-byte")],
        );
        html.open("h3", &[]).text(&field.name.label()).text(" ");
        html.node("code", "quiet", &decoded.raw(field));
        let mut source = "";
        if let Some((bit, _)) = bits(good, id).next() {
            source = bit.source.part;
            html.text(" ").node("span", "quiet", source);
        }
        html.close("h3");
        html.open("ul", &[("class", "hart-bits")]);
        for (bit, on) in bits(good, id) {
            one(html, bit, on, source);
        }
        html.close("ul").close("section");
    }
    let rest: Vec<String> = decoded
        .fields()
        .iter()
        .filter(|f| {
            matches!(
                (f.name, f.value),
                (Name::Hart(..), Value::Hex(_) | Value::Raw)
            )
        })
        .map(|f| format!("{} {}", f.name.label(), decoded.raw(f)))
        .collect();
    html.close("div");
    if let Some((_, mode)) = find(&good.shown, "operating_mode") {
        let words = format!("Operating mode: {}.", decoded.bare_text(mode));
        html.node("p", "quiet", &words);
    }
    if !rest.is_empty() {
        let words = format!("Without named bits for this family: {}.", rest.join(", "));
        html.node("p", "quiet", &words);
    }
}

/// A bit; its source where it is another than that of its byte.
fn one(html: &mut Markup, bit: &Bit, on: bool, source: &str) {
    let class = match (on, bit.alarm) {
        (false, _) => "bit-off",
        (true, true) => "bit-on alarm",
        (true, false) => "bit-on",
    };
    html.open(
        "li",
        &[
            ("class", class),
            ("data-testid", "hart-bit"),
            ("data-key", bit.key),
            ("data-on", if on { "1" } else { "0" }),
        ],
    );
    html.node("code", "", &bit.bit.to_string());
    html.open("span", &[("class", "bit-mark")]);
    if on && bit.alarm {
        sign(html, Sign::Warning, "16");
    } else if on {
        html.text("●");
    } else {
        html.text("○");
    }
    html.close("span").open("span", &[("class", "bit-name")]);
    html.text(bit.label);
    if !bit.alias.is_empty() {
        html.text(" ")
            .node("span", "quiet", &format!("also: {}", bit.alias));
    }
    if bit.source.part != source {
        html.text(" ").node("span", "quiet", bit.source.part);
    }
    if let Some(reading) = bit.reading {
        html.text(" ");
        super::reading(html, reading);
    }
    html.close("span");
    let state = if on { bit.states.1 } else { bit.states.0 };
    html.node("span", "quiet bit-state", state);
    html.node(
        "span",
        "quiet bit-kind",
        if bit.alarm { "alarm" } else { "state" },
    );
    html.close("li");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{STATUS, answer, request, unit};

    /// The worked answer R10: byte 0 local control fault, byte 2 bit 1, byte 4 A4, byte 5 40.
    #[test]
    fn every_bit_has_its_name_and_what_it_is() {
        let unit = unit(&[(48, STATUS.0, STATUS.1)]);
        let mut html = Markup::new();
        status(&mut html, &unit, 7);
        let html = html.finish();
        let set = html.matches("data-on=\"1\"").count();
        // 02, 02, A4, 40, extended 08 and device status 90: 1 + 1 + 3 + 1 + 1 + 2.
        assert_eq!(set, 9, "{html}");
        // 39 bits of the IQ, 8 of the device status, 6 extended, 8 and 4 standardized.
        assert!(html.matches("data-testid=\"hart-bit\"").count() >= 39 + 8 + 6 + 8);
        assert!(html.contains("data-key=\"local_control_fault\" data-on=\"1\""));
        assert!(html.contains("also: "), "both names");
        assert!(html.contains("table 8"), "source");
        assert!(html.contains("data-testid=\"hart-ne107\""), "the result");
        assert!(
            html.contains("table 8 stops at bit 6"),
            "reading R4 in words"
        );
        assert!(
            !html.contains("title="),
            "nothing is told to the mouse only"
        );
    }

    /// Local control fault alone: a failure by table 20, as the device's map has it.
    #[test]
    fn the_result_of_the_map_is_told_where_it_was_read() {
        let mut known = unit(&[(48, STATUS.0, STATUS.1)]);
        let draw = |unit: &Unit| {
            let mut html = Markup::new();
            status(&mut html, unit, 7);
            html.finish()
        };
        assert!(!draw(&known).contains("hart-result"));
        let data = [&[2, 11, 0, 64, 0, 0, 0, 0, 0x30][..], &[0; 27]].concat();
        let (asked, answer) = (request(31, &[2, 11, 0, 64]), answer(31, 0x90, &data));
        let ok = (shared::proto::Outcome::Ok, "");
        known.take(&asked, &answer, 523, ok, (8, 2, 1));
        let html = draw(&known);
        let result = html.split("hart-result").nth(1).unwrap();
        assert!(
            result.split("</p>").next().unwrap().contains("Failure"),
            "{result}"
        );
    }
}
