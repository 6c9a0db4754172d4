//! Values with unit, quality and age; raw bytes, source and reading on demand.

use shared::device::Family;
use shared::value::Quality;

use crate::format::{age, millis};
use crate::hart::state::unit::{Key, Reading, Unit, find, plain};
use crate::markup::{Markup, facts};
use crate::state::tree::Facts;

/// Values that belong together.
#[derive(Clone, Copy, Debug)]
pub struct Group {
    /// Its title.
    pub title: &'static str,
    /// Command, key of the field, and a label where the field's own does not do.
    pub values: &'static [(u16, &'static str, &'static str)],
}

/// Everything of the set-up, in the order of the handheld's menus.
pub const SETUP: [Group; 6] = [
    Group {
        title: "HART set-up",
        values: &[
            (13, "tag", ""),
            (20, "long_tag", ""),
            (13, "descriptor", ""),
            (12, "message", ""),
            (13, "date", ""),
            (16, "final_assembly", ""),
            (14, "serial", ""),
        ],
    },
    Group {
        title: "Loop configuration",
        values: &[
            (7, "polling_address", ""),
            (7, "loop_current_mode", ""),
            (131, "zero", ""),
            (131, "span", ""),
            (133, "mode", ""),
        ],
    },
    Group {
        title: "Range",
        values: &[
            (15, "upper_range", ""),
            (15, "lower_range", ""),
            (15, "damping", ""),
            (15, "transfer_function", ""),
            (15, "alarm_selection", ""),
            (15, "write_protect", ""),
            (15, "channel_flags", ""),
            (14, "upper_limit", ""),
            (14, "lower_limit", ""),
            (14, "minimum_span", ""),
        ],
    },
    Group {
        title: "HART review",
        values: &[
            (0, "manufacturer", ""),
            (0, "expanded_type", ""),
            (0, "device_id", ""),
            (0, "universal_revision", ""),
            (0, "device_revision", ""),
            (0, "hardware", ""),
            (0, "flags", ""),
            (0, "request_preambles", ""),
            (0, "response_preambles", ""),
            (0, "last_variable", ""),
            (0, "change_counter", ""),
            (0, "distributor", ""),
            (0, "profile", ""),
        ],
    },
    Group {
        title: "Versions",
        values: &[
            (128, "version", "Actuator software (command 128)"),
            (0, "software_revision", "HART card software revision"),
            (0, "device_revision", ""),
        ],
    },
    Group {
        title: "Classification of the variables",
        values: &[
            (8, "pv_class", ""),
            (8, "sv_class", ""),
            (8, "tv_class", ""),
            (8, "qv_class", ""),
        ],
    },
];

/// Something that the menus of a handheld show and no documented command reads.
#[derive(Clone, Copy, Debug)]
pub struct Unavailable {
    /// What it is.
    pub what: &'static str,
    /// The families whose menus have it.
    pub families: &'static [Family],
    /// True if it is in the diagnostics menu, else in the set-up.
    pub diagnostics: bool,
}

impl Unavailable {
    /// The section of the manual that shows it for a family.
    #[must_use]
    pub const fn section(&self, family: Family) -> &'static str {
        match (family, self.diagnostics) {
            (Family::Cva, false) => "11.3",
            (Family::Cva, true) => "11.4",
            (Family::Iq, false) => "12.2",
            (Family::Iq, true) => "12.3",
            (Family::Cma, false) => "13.2",
            (Family::Cma, true) => "13.3",
            (Family::Ck, false) => "14.2",
            (Family::Ck, true) => "14.3",
            (Family::Si, false) => "15.2",
            (Family::Si, true) => "15.3",
        }
    }
}

/// All of them.
pub const UNAVAILABLE: [Unavailable; 10] = {
    use Family::{Ck, Cma, Cva, Iq, Si};
    const fn setup(what: &'static str, families: &'static [Family]) -> Unavailable {
        Unavailable {
            what,
            families,
            diagnostics: false,
        }
    }
    const fn diagnostics(what: &'static str, families: &'static [Family]) -> Unavailable {
        Unavailable {
            diagnostics: true,
            ..setup(what, families)
        }
    }
    [
        setup(
            "Valve actions: torque or thrust limits, closing direction, seating at limit or torque",
            &[Cva, Iq, Ck],
        ),
        setup("Deadband", &[Cva, Iq, Cma, Ck, Si]),
        setup("Hysteresis", &[Iq, Ck, Si]),
        setup("Feedback current, its end points and its source", &[Cva]),
        setup(
            "Action, position and time-out on loss of signal or communication",
            &[Cva, Iq, Cma, Ck, Si],
        ),
        setup("Motion inhibit time, function of the ESD input", &[Iq, Ck]),
        setup("Partial stroke: travel, limit, time-outs", &[Iq, Ck, Si]),
        setup("Auxiliary inputs: function and contact type", &[Iq, Ck, Si]),
        diagnostics("Number of operations towards open and close", &[Iq, Si]),
        diagnostics("Historic torque over position", &[Iq]),
    ]
};

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

/// The value itself, or why there is none.
fn said(html: &mut Markup, reading: Option<&Reading>, facts: Option<&Facts>) {
    html.open("span", &[("class", "value-said")]);
    match facts {
        Some(facts) => {
            let blank = facts.value.trim().is_empty();
            let text = if blank { "empty" } else { &facts.value };
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
            html.text(" ")
                .open(
                    "em",
                    &[("class", "quality stale-mark"), ("title", &bad.text)],
                )
                .text(if facts.is_some() { "stale" } else { &bad.text })
                .close("em");
        }
        Some(_) => {}
    }
    html.close("span");
}

/// Everything about a field of the last good answer.
fn facts_of(reading: Option<&Reading>, field: &str) -> Option<Facts> {
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

/// The groups of the set-up, and what can't be read.
pub fn setup(html: &mut Markup, unit: &Unit, open: &[String], now_us: u64) {
    for group in &SETUP {
        html.open("section", &[("class", "hart-group")]);
        html.node("h2", "", group.title);
        for (command, field, label) in group.values {
            value(html, unit, &plain(*command), field, label, (open, now_us));
        }
        html.close("section");
    }
    html.open(
        "section",
        &[("class", "hart-group"), ("data-testid", "hart-unavailable")],
    );
    html.node("h2", "", "Not available over documented commands");
    html.node(
        "p",
        "quiet",
        "The menus of a handheld show these too. PUB092-003 documents no command that reads them, so \
         they are not shown here, and their absence says nothing about their value.",
    );
    html.open("ul", &[("class", "plain-list")]);
    for item in &UNAVAILABLE {
        let own = unit.family.filter(|f| item.families.contains(f));
        if unit.family.is_some() && own.is_none() {
            continue;
        }
        html.open("li", &[]).text(item.what);
        if let Some(family) = own {
            let source = format!(" PUB092-003-00, section {}", item.section(family));
            html.node("span", "quiet", &source);
        }
        html.close("li");
    }
    html.close("ul").close("section");
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
    let key = crate::hart::state::plan::variables();
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
    use crate::hart::state::unit::tests::{POLL, unit};

    #[test]
    fn not_read_is_not_zero() {
        let mut html = Markup::new();
        setup(&mut html, &unit(&[]), &[], 0);
        let html = html.finish();
        let values = html.matches("data-testid=\"hart-value\"").count();
        assert_eq!(html.matches("not read<").count(), values);
        assert!(values > 40, "{values}");
        // Every value has a label of the tables.
        assert!(html.contains("Loop current mode") && html.contains("Final assembly number"));
        assert!(html.contains("Deadband"), "what can't be read is listed");
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
    }
}
