//! Values with unit, quality and age; raw bytes, source and reading on demand.

use shared::value::Quality;

use crate::format::{age, millis};
use crate::hart::state::plan;
use crate::hart::state::unit::{Key, Reading, Unit, find, plain};
use crate::markup::{Markup, facts};
use crate::state::tree::Facts;

/// A value of a command, addressed by the key of its field or the end of its path.
pub fn value(
    html: &mut Markup,
    unit: &Unit,
    key: &Key,
    field: &str,
    label: &str,
    (open, now_us): (&[String], u64),
) {
    let reading = unit.reading(key);
    let facts = facts_of(reading, field);
    let own = format!("{}.{}.{field}", key.0, key.1);
    let is_open = facts.is_some() && open.contains(&own);
    html.open(
        "div",
        &[
            (
                "class",
                if is_open {
                    "hart-value open"
                } else {
                    "hart-value"
                },
            ),
            ("data-testid", "hart-value"),
            ("data-key", &format!("{}.{field}", key.0)),
        ],
    );
    let name = match &facts {
        _ if !label.is_empty() => label.to_owned(),
        Some(facts) => facts.label.clone(),
        None => described(key.0, field),
    };
    let expanded = if is_open { "true" } else { "false" };
    let mut attributes = vec![
        ("class", "value-name"),
        ("data-act", "open"),
        ("data-key", &own),
    ];
    if facts.is_none() {
        attributes.push(("disabled", ""));
    } else {
        attributes.push(("aria-expanded", expanded));
    }
    html.open("button", &attributes).text(&name).close("button");
    said(html, reading, facts.as_ref());
    html.open("span", &[("class", "num quiet value-age")]);
    if let Some(good) = reading.and_then(|r| r.good.as_ref()) {
        html.text(&age(now_us.saturating_sub(good.at_us)));
    }
    html.close("span");
    if is_open {
        html.open(
            "div",
            &[
                ("class", "facts value-facts"),
                ("data-testid", "value-facts"),
            ],
        );
        facts::field(html, facts.as_ref());
        if let Some(facts) = facts.as_ref().filter(|f| short(&f.value).is_some()) {
            html.node(
                "p",
                "quiet",
                &format!("Unrounded: {} {}", facts.value, facts.unit),
            );
        }
        if let Some(good) = reading.and_then(|r| r.good.as_ref()) {
            let tries = match good.tries {
                0 | 1 => String::new(),
                n => format!(", sent {n} times"),
            };
            let words = format!(
                "Command {}, answered in {}{tries}. The frame: {}",
                key.0,
                millis(good.took_us),
                shared::render::Spaced(good.shown.decoded.bytes())
            );
            html.node("p", "quiet mono wrap", &words);
        }
        html.close("div");
    }
    html.close("div");
}

/// A decimal number with no more than three decimals, rounded; `None` if it has no more, or is none.
///
/// A float of 32 bits has about seven digits that mean something, a valve no more than three.
#[must_use]
pub fn short(text: &str) -> Option<String> {
    let (whole, decimals) = text.split_once('.')?;
    let digits = |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
    let (sign, whole) = match whole.strip_prefix('-') {
        Some(rest) => ("-", rest),
        None => ("", whole),
    };
    if decimals.len() <= 3 || !digits(whole) || !digits(decimals) {
        return None;
    }
    let (kept, rest) = decimals.split_at(3);
    let thousandths = format!("{whole}{kept}").parse::<u64>().ok()? + u64::from(rest >= "5");
    let (whole, part) = (thousandths / 1000, thousandths % 1000);
    let all = format!("{sign}{whole}.{part:03}");
    Some(all.trim_end_matches('0').trim_end_matches('.').to_owned())
}

/// The value itself, or why there is none.
fn said(html: &mut Markup, reading: Option<&Reading>, facts: Option<&Facts>) {
    html.open("span", &[("class", "value-said")]);
    match facts {
        Some(facts) => {
            let blank = facts.value.trim().is_empty();
            let rounded = short(&facts.value);
            let text = if blank {
                "empty"
            } else {
                rounded.as_deref().unwrap_or(&facts.value)
            };
            html.node(
                if blank { "span" } else { "b" },
                if blank { "quiet" } else { "" },
                text,
            )
            .text(" ")
            .node("i", "unit", facts.unit);
            if facts.quality != Quality::Good {
                html.text(" ").node("em", "quality", facts.quality.label());
            }
            if let Some(read) = facts.reading {
                html.text(" ");
                super::reading(html, read);
            }
        }
        None if reading.is_some_and(|r| r.good.is_some()) => {
            html.node("span", "quiet", "not in the answer of this device");
        }
        None => {}
    }
    match reading {
        None => {
            html.node("span", "quiet", "not read");
        }
        Some(Reading { bad: Some(bad), .. }) => {
            if facts.is_some() {
                html.text(" ").node("em", "quality stale-mark", "stale");
            }
            html.text(" ").node("span", "quiet", &bad.text);
        }
        Some(_) => {}
    }
    html.close("span");
}

/// Everything about a field of the last good answer.
pub(super) fn facts_of(reading: Option<&Reading>, field: &str) -> Option<Facts> {
    let good = reading?.good.as_ref()?;
    let decoded = &good.shown.decoded;
    if !field.contains('.') {
        let (id, _) = find(&good.shown, field)?;
        return Facts::of(decoded, id);
    }
    let (id, _) = decoded
        .iter()
        .find(|(id, _)| decoded.path(*id).ends_with(field))?;
    Facts::of(decoded, id)
}

/// The label of a field that was not read, from the tables.
#[must_use]
pub fn described(command: u16, field: &str) -> String {
    let forms = shared::hart::command(command).map_or(&[][..], |c| c.response);
    let mut items = forms.iter().flat_map(|f| f.items);
    items
        .find(|i| i.key == field)
        .map_or_else(|| field.to_owned(), |i| i.label.to_owned())
}

/// Dynamic variables with their classes, then device variables with their status.
pub fn variables(html: &mut Markup, unit: &Unit, open: &[String], now_us: u64) {
    let third = crate::hart::state::condition::third(unit.family);
    html.open("section", &[("class", "hart-group")]);
    html.node("h2", "", "Dynamic variables");
    for (field, label) in [
        ("loop_current", "Loop current".to_owned()),
        ("pv", "PV · Demand".to_owned()),
        ("sv", "SV · Position".to_owned()),
        ("tv", format!("TV · {third}")),
        ("qv", "QV · Position within factory limits".to_owned()),
    ] {
        value(html, unit, &plain(3), field, &label, (open, now_us));
    }
    html.close("section");
    html.open("section", &[("class", "hart-group")]);
    html.node("h2", "", "Device variables");
    let key = plan::variables();
    for slot in 0..5 {
        let name = facts_of(unit.reading(&key), &format!("slot[{slot}].code"));
        let name = name.map_or_else(|| format!("Device variable {slot}"), |f| f.value);
        for (field, label) in [
            ("value", name.clone()),
            ("status", format!("{name}, status")),
            ("class", format!("{name}, class")),
        ] {
            let field = format!("slot[{slot}].{field}");
            value(html, unit, &key, &field, &label, (open, now_us));
        }
    }
    for field in ["time", "extended_status"] {
        value(html, unit, &key, field, "", (open, now_us));
    }
    html.close("section");
    html.open("section", &[("class", "hart-group")]);
    html.node("h2", "", "Classification");
    for (field, label) in [
        ("pv_class", "PV"),
        ("sv_class", "SV"),
        ("tv_class", "TV"),
        ("qv_class", "QV"),
    ] {
        value(html, unit, &plain(8), field, label, (open, now_us));
    }
    html.close("section");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{POLL, answer, hear, poll, request, unit};
    use shared::proto::Outcome;

    #[test]
    fn floats_are_short_and_rounded() {
        for (text, wanted) in [
            ("12.916666", Some("12.917")),
            ("30.000002", Some("30")),
            ("-0.99996", Some("-1")),
            ("0.0625", Some("0.063")),
            ("99.9994", Some("99.999")),
            ("12.5", None),
            ("12.917", None),
            ("7", None),
            ("2024.01.0111", None),
            ("v1.0000", None),
            ("not a number", None),
        ] {
            assert_eq!(short(text).as_deref(), wanted, "{text}");
        }
    }

    #[test]
    fn reasons_are_text() {
        let mut unit = unit(&[]);
        hear(&mut unit, 3, 0, &poll(50.0), 1);
        let silence = (Outcome::Silence, "no answer");
        unit.take(&request(3, &[]), &[], 3, silence, (2_000_000, 1, 4));
        let ok = (Outcome::Ok, "");
        let mut refusal = answer(131, 0, &[]);
        // Response code 64, command not implemented; the check byte follows.
        refusal[8] = 64;
        let last = refusal.len() - 1;
        refusal[last] ^= 64;
        unit.take(&request(131, &[]), &refusal, 131, ok, (3, 1, 1));
        let mut html = Markup::new();
        variables(&mut html, &unit, &[], 3);
        super::super::setup::setup(&mut html, &unit, &[], 3);
        let html = html.finish();
        assert!(html.contains(">stale</em> <span class=\"quiet\">no answer<"));
        assert!(html.contains(">Refused: Command not implemented"), "{html}");
        assert!(
            !html.contains("title="),
            "nothing is told to the mouse only"
        );
    }

    #[test]
    fn a_value_has_unit_age_raw_and_source() {
        let unit = unit(&[(3, POLL.0, POLL.1)]);
        let mut html = Markup::new();
        let open = ["3..sv".to_owned()];
        variables(&mut html, &unit, &open, 1_500_007);
        let html = html.finish();
        assert!(
            html.contains("<b class=\"\">49.5</b> <i class=\"unit\">%</i>"),
            "{html}"
        );
        assert!(html.contains("1.5 s"));
        assert!(html.contains("0x42460000"), "raw");
        assert!(html.contains("HART universal commands"), "source");
        assert!(html.contains("not a number"), "the fourth has no value");
        assert!(html.contains(">R35<"), "a reading is named");
        assert!(html.contains("never derived"), "in words");
    }
}
