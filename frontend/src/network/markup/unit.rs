//! A unit: what it does, what is wrong, whether it could be commanded, all that it says.

use shared::address::{Address, Table};
use shared::ddc100::checklist::{Checklist, Verdict};
use shared::ddc100::scaling::{Scaled, Scaling};
use shared::ddc100::view::{Bit, View};
use shared::device::Device;
use shared::map::row::{Kind, Row};
use shared::proto::Outcome;

use super::head::address;
use super::table::{bar, bit, own, since};
use crate::components::icon::Glyph;
use crate::components::ne107::Sign;
use crate::format::{age, millis};
use crate::markup::Markup;
use crate::markup::control::{Button, Choice};
use crate::markup::device::sign;
use crate::network::state::net::{Asked, Net, Unit};
use crate::network::state::tags::Tags;
use crate::network::state::unit::{Judged, kind, place};
use crate::state::health::outcome;

/// Registers that a unit has, as printed.
pub const REGISTERS: u16 = 56;

/// Where the unit is, what its valve does, and when that was so.
pub fn head(
    html: &mut Markup,
    bus: &str,
    net: &Net,
    (unit, judged): (&Unit, &Judged),
    tags: &Tags,
    now_us: u64,
) {
    html.open("p", &[("class", "big"), ("data-testid", "unit-position")]);
    match &judged.view.position {
        Some(position) => {
            html.text(&position.to_string());
        }
        None => {
            html.text("\u{2013}");
        }
    }
    html.close("p");
    html.open("div", &[("class", "unit-now")]);
    html.open(
        "p",
        &[("class", "big-state"), ("data-testid", "unit-state")],
    );
    if let Some(mark) = judged.health.sign() {
        sign(html, mark, "20");
        html.text(" ");
    }
    html.text(&judged.view.state);
    // An I/O module has no selector; its register 12 holds inputs of the user.
    if unit.device != Device::Ddc100Io {
        html.text(" · ").text(judged.view.mode.label());
    }
    html.close("p");
    let reach = unit.reach(net.ports.len());
    html.open("p", &[("data-testid", "unit-reach")]);
    html.text(reach.words(net.ports.len()));
    html.text(&format!(
        ", last good answer {}",
        match unit.at {
            Some(_) => format!("{} ago", since(unit, now_us)),
            None => "never".to_owned(),
        }
    ));
    if let Some(took) = unit.took {
        html.text(&format!(", after {}", millis(took)));
    }
    html.close("p");
    if !unit.text.is_empty() {
        html.node("p", "net-small", &unit.text);
    }
    html.open("p", &[("class", "quiet net-small")]);
    let tag = tags.tag(unit);
    if tag != unit.info.tag {
        html.text(&format!("{tag} in the tag list · "));
    }
    let description = tags.description(unit);
    if !description.is_empty() && description != unit.info.description {
        html.text(&format!("{description} · "));
    }
    let at = net.place(unit.info.unit).map_or(0, |at| at + 1);
    html.text(&format!(
        "{} · place {at} of {} on ",
        kind(unit.device),
        net.units.len()
    ));
    html.open(
        "a",
        &[("href", &address(bus, "")), ("data-testid", "to-network")],
    );
    html.text(bus).close("a").close("p");
    html.close("div");
}

/// The faults: of the host, of the unit's own channels, and its fault bits.
pub fn faults(html: &mut Markup, unit: &Unit, judged: &Judged) {
    html.node("h3", "", "Faults");
    html.open("table", &[("class", "plain unit-channels")]);
    html.open("thead", &[]).open("tr", &[]);
    for words in ["1 is a fault", "Channel A", "Channel B"] {
        html.open("th", &[("scope", "col")]).text(words).close("th");
    }
    html.close("tr")
        .close("thead")
        .open("tbody", &[])
        .open("tr", &[]);
    html.open("th", &[("scope", "row")])
        .text("as the host polls")
        .close("th");
    for (at, testid) in ["host-a", "host-b"].into_iter().enumerate() {
        html.open("td", &[("class", "mono")]);
        bit(html, unit.fault.get(at).copied().flatten(), testid);
        html.close("td");
    }
    html.close("tr").open("tr", &[]);
    html.open("th", &[("scope", "row")])
        .text("as the unit reports, 9.10 and 9.11")
        .close("th");
    for (is, testid) in [
        (judged.view.own.one, "own-a"),
        (judged.view.own.two, "own-b"),
    ] {
        html.open("td", &[]);
        html.open("code", &[]);
        own(html, is, testid);
        html.close("code");
        html.text(" ").node("span", "quiet", is.label());
        html.close("td");
    }
    html.close("tr").close("tbody").close("table");
    if judged.view.faults.is_empty() {
        let words = if judged.known {
            "No fault bit is set."
        } else {
            "The status was not read yet."
        };
        html.node("p", "quiet", words);
    } else {
        html.open("ul", &[("class", "conditions")]);
        for fault in &judged.view.faults {
            html.open(
                "li",
                &[
                    ("data-testid", "unit-fault"),
                    ("data-key", fault.member.key),
                ],
            );
            let mark = if fault.member.key == "combined_fault" {
                Sign::Failure
            } else {
                Sign::Warning
            };
            sign(html, mark, "16");
            html.node("span", "", fault.member.label);
            html.node("code", "quiet", &place(fault)).close("li");
        }
        html.close("ul");
    }
    if judged.view.combined_disputed {
        html.node(
            "p",
            "net-small",
            "The combined fault is not what the other bits make of it (note 3 of table 3.5, reading D8).",
        );
    }
}

/// What somebody might want, and where to.
pub fn wishes(html: &mut Markup, choices: &[(String, String)], wish: &str, percent: u8) {
    html.node("h3", "", "Could a command be given now?");
    html.open("div", &[("class", "toolbar wishes")]);
    Choice {
        act: "wish",
        testid: "wish",
        label: "Command",
        none: "Choose a command",
        value: wish,
        ..Choice::default()
    }
    .draw(
        html,
        choices
            .iter()
            .map(|(key, name)| (key.as_str(), name.as_str())),
    );
    if wish == "move" {
        let value = percent.to_string();
        html.open("label", &[("class", "choice")]).text("to");
        html.open(
            "input",
            &[
                ("type", "number"),
                ("min", "0"),
                ("max", "100"),
                ("data-act", "percent"),
                ("data-testid", "wish-percent"),
                ("data-value", &value),
                ("value", &value),
                ("aria-label", "Position in percent"),
            ],
        );
        html.text("%").close("label");
    }
    html.close("div");
}

/// The checklist of section 6.2.
pub fn checklist(html: &mut Markup, list: &Checklist, now_us: u64) {
    let (mark, words) = match list.verdict() {
        Verdict::Pass => (None, "Nothing speaks against it now."),
        Verdict::Unknown => (
            Some(Sign::OutOfSpecification),
            "Not known: something was not read.",
        ),
        Verdict::Fail => (Some(Sign::Failure), "It should not be given now."),
    };
    html.open(
        "p",
        &[
            ("class", "verdict"),
            ("data-testid", "verdict"),
            ("data-verdict", list.verdict().key()),
        ],
    );
    if let Some(mark) = mark {
        sign(html, mark, "18");
        html.text(" ");
    }
    html.node("b", "", words).close("p");
    html.open("ul", &[("class", "checklist")]);
    for item in &list.items {
        html.open(
            "li",
            &[
                ("data-testid", "check-item"),
                ("data-key", item.key),
                ("data-verdict", item.verdict.key()),
            ],
        );
        let (class, letter) = match item.verdict {
            Verdict::Pass => ("check-mark", "\u{2713}"),
            Verdict::Unknown => ("check-mark", "?"),
            Verdict::Fail => ("check-mark fail", "\u{2717}"),
        };
        html.node("b", class, letter);
        html.open("span", &[]).text(&item.text).text(" ");
        html.node("span", "quiet net-small", item.source);
        if let Some(at) = item.at {
            let old = format!(", read {} ago", age(now_us.saturating_sub(at.get())));
            html.node("span", "quiet net-small", &old);
        }
        html.close("span").close("li");
    }
    html.close("ul");
    html.open("ul", &[("class", "check-notes quiet net-small")]);
    for (text, source) in &list.notes {
        html.node("li", "", &format!("{text} ({source})"));
    }
    html.node("li", "", "Nothing is sent from here: this page only reads.");
    html.close("ul");
}

/// A card of bits: those that are active stand out, the rest is quiet.
pub fn bits(html: &mut Markup, title: &str, testid: &str, bits: &[Bit]) {
    html.open(
        "section",
        &[("class", "unit-card"), ("data-testid", testid)],
    );
    html.node("h3", "", title);
    if bits.is_empty() {
        html.node("p", "quiet", "This type has none, or they were not read.");
    }
    html.open("ul", &[("class", "unit-bit-list")]);
    for bit in bits {
        let on = bit.is_active();
        html.open(
            "li",
            &[
                ("class", if on { "on" } else { "quiet" }),
                ("data-key", bit.member.key),
                ("data-on", if on { "1" } else { "0" }),
            ],
        );
        html.node("code", "", &place(bit));
        html.node("span", "", bit.member.label);
        html.node("span", "bit-words", bit.text()).close("li");
    }
    html.close("ul").close("section");
}

/// The analog values, with how they count.
pub fn analog(html: &mut Markup, view: &View, scaling: Scaling) {
    html.open(
        "section",
        &[("class", "unit-card"), ("data-testid", "analog")],
    );
    html.node("h3", "", "Analog values");
    html.open("label", &[("class", "choice")]).text("Scale ");
    html.open(
        "select",
        &[
            ("data-act", "scaling"),
            ("data-testid", "scaling"),
            ("data-value", scaling.key()),
            ("aria-label", "How the analog values of this unit count"),
        ],
    );
    for choice in Scaling::ALL {
        let mut attributes = vec![("value", choice.key())];
        if choice == scaling {
            attributes.push(("selected", ""));
        }
        html.open("option", &attributes)
            .text(choice.key())
            .close("option");
    }
    html.close("select").close("label");
    html.node(
        "p",
        "quiet net-small",
        "A setting of the unit that no register tells (reading D7); remembered here for this unit.",
    );
    html.open("table", &[("class", "plain unit-analog")])
        .open("tbody", &[]);
    for value in &view.analog {
        let register = (u32::from(value.row.address.get()) + 1).to_string();
        html.open(
            "tr",
            &[("data-testid", "analog-row"), ("data-register", &register)],
        );
        html.open("td", &[("class", "num quiet")]);
        html.node("code", "", &register).close("td");
        html.open("th", &[("scope", "row"), ("title", value.row.note)]);
        html.text(value.row.label).close("th");
        html.node("td", "num quiet mono", &value.raw.to_string());
        html.open("td", &[("class", "num analog-value")]);
        html.text(&value.to_string());
        if let Some(tenths) = value.scaled.and_then(Scaled::tenths) {
            bar(html, u32::from(tenths));
        }
        html.close("td").close("tr");
    }
    html.close("tbody").close("table");
    if view.analog.is_empty() {
        html.node("p", "quiet", "None was read yet.");
    }
    html.close("section");
}

/// What is different about this type, as far as it matters for what is shown.
pub fn differences(html: &mut Markup, device: Device) {
    let Some(map) = device.map() else { return };
    html.open(
        "section",
        &[("class", "unit-card"), ("data-testid", "differences")],
    );
    html.node("h3", "", &format!("About this type: {}", kind(device)));
    let ids: &[&str] = match device {
        Device::Ddc100Mx | Device::Ddc100MxB => &["D9", "D18", "D31", "D2"],
        Device::Ddc100Io => &["D31", "D33", "D3", "D17"],
        _ => &["D31", "D8", "D16", "D15"],
    };
    html.open("ul", &[("class", "differences")]);
    for reading in map.readings.iter().filter(|r| ids.contains(&r.id)) {
        html.open("li", &[]);
        html.node("code", "quiet", reading.id)
            .text(" ")
            .text(reading.text);
        html.close("li");
    }
    let watchdog = match device {
        Device::Ddc100Mx | Device::Ddc100MxB => {
            "60 s without a poll set its own fault bits; it does not reset (section 4.3)."
        }
        _ => {
            "Each of three times 60 s without a poll resets its UART, then once its processor; a reset takes 10 to 15 s (section 4.3)."
        }
    };
    html.open("li", &[])
        .node("code", "quiet", "Watchdog")
        .text(" ")
        .text(watchdog)
        .close("li");
    html.close("ul");
    html.close("section");
}

/// Reading all registers, and how that went.
pub fn reading(html: &mut Markup, unit: u8, asked: Option<&Asked>, online: bool) {
    html.node("h3", "", "Registers");
    let asked = asked.filter(|a| a.unit == unit);
    let running = asked.is_some_and(|a| a.end.is_none());
    Button {
        act: "read",
        testid: "read-registers",
        words: "Read all registers",
        glyph: Some(Glyph::Poll),
        disabled: running || !online,
        ..Button::default()
    }
    .draw(html);
    html.open(
        "span",
        &[
            ("class", "quiet"),
            ("role", "status"),
            ("data-testid", "read-state"),
        ],
    );
    html.text(&match asked.map(|a| &a.end) {
        None => String::new(),
        Some(None) => "reading between two polls".to_owned(),
        Some(Some((Outcome::Ok, _))) => format!("read: 1 to {REGISTERS}"),
        Some(Some((how, text))) if text.is_empty() => outcome(*how).to_owned(),
        Some(Some((_, text))) => text.clone(),
    });
    html.close("span");
}

/// The registers that were read: raw and meaning.
pub fn registers(html: &mut Markup, unit: &Unit, now_us: u64) {
    html.open(
        "table",
        &[
            ("class", "plain unit-registers"),
            ("data-testid", "registers"),
        ],
    );
    html.open("thead", &[]).open("tr", &[]);
    for (class, words) in [
        ("num", "Register"),
        ("", "Name"),
        ("num", "Raw"),
        ("", "Meaning"),
        ("num", "Age"),
    ] {
        html.open("th", &[("scope", "col"), ("class", class)])
            .text(words)
            .close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    let map = unit.device.map();
    for address in 0..REGISTERS {
        let address = Address::new(address);
        let Some(cell) = unit.image.cell(Table::Holding, address) else {
            continue;
        };
        let number = u32::from(address.get()) + 1;
        let row = map.and_then(|map| map.row_at(Table::Holding, address));
        html.open("tr", &[("data-register", &number.to_string())]);
        html.node("td", "num quiet mono", &(40_000 + number).to_string());
        html.open("th", &[("scope", "row")]);
        html.text(row.map_or("not described", |r| r.label))
            .close("th");
        html.open("td", &[("class", "num mono")]);
        html.text(&format!("{:04X}", cell.word));
        html.text(" ")
            .node("span", "quiet", &cell.word.to_string())
            .close("td");
        html.node(
            "td",
            "",
            &row.map_or_else(String::new, |row| meaning(row, unit)),
        );
        html.node(
            "td",
            "num quiet",
            &age(now_us.saturating_sub(cell.at.get())),
        );
        html.close("tr");
    }
    html.close("tbody").close("table");
}

/// The meaning of a register by the map; the scale of analog values is told apart.
fn meaning(row: &'static Row, unit: &Unit) -> String {
    let Some(seen) = unit.image.row(row).filter(|_| row.kind != Kind::Reserved) else {
        return String::new();
    };
    if Scaling::applies_to(row) {
        return "analog, see above".to_owned();
    }
    let text = seen.judged.value.to_string();
    if row.unit.is_empty() {
        text
    } else {
        format!("{text} {}", row.unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::net::tests::{network, poll};
    use crate::network::state::wish::{choices, from_key};
    use shared::ddc100::Pair;
    use shared::ddc100::checklist::checklist as check;
    use shared::proto::DdcShape;

    fn net() -> Net {
        let mut net = network(3, DdcShape::Loop, 2);
        // Register 8 to 16: combined fault and open torque switch, at REMOTE, analog 1 low.
        poll(
            &mut net,
            2,
            [Some(false), Some(true)],
            &[61, 0x1884, 0, 0x0004, 0x0801, 0, 0x0001, 0x0004, 0],
        );
        net
    }

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn a_unit_says_what_it_does() {
        let (net, tags) = (net(), Tags::default());
        let unit = &net.units[1];
        let judged = Judged::of(unit, 2, &tags);
        let html = drawn(|html| head(html, "Loop", &net, (unit, &judged), &tags, 8_000_000));
        assert!(html.contains("61 %") && html.contains("Stopped between the ends · Remote"));
        assert!(html.contains("answers on port 1 only, last good answer 3.0 s ago, after 71.0 ms"));
        assert!(html.contains("place 2 of 3 on <a href=\"#/network/Loop\""));
        let html = drawn(|html| faults(html, unit, &judged));
        assert!(html.contains("data-bit=\"host-b\">1<"));
        assert!(html.contains("not fitted"));
        assert!(html.contains("data-key=\"open_torque_switch_fault\""));
        assert!(html.contains("data-key=\"user_fault_2\""));
    }

    #[test]
    fn the_checklist_has_words_and_sources() {
        let net = net();
        let unit = &net.units[1];
        let faults = Pair {
            one: unit.fault[0],
            two: unit.fault[1],
        };
        let wish = from_key("open", 0).unwrap();
        let list = check(unit.device, &unit.image, faults, Scaling::Percent, wish);
        let html = drawn(|html| checklist(html, &list, 8_000_000));
        assert!(html.contains("data-verdict=\"fail\""));
        assert!(html.contains("data-key=\"torque\" data-verdict=\"fail\""));
        assert!(html.contains("data-key=\"communication\" data-verdict=\"pass\""));
        assert!(html.contains("section 6.2, item 2c") && html.contains("read 3.0 s ago"));
        assert!(html.contains("Nothing is sent from here"));
        let all = choices(unit.device);
        let html = drawn(|html| wishes(html, &all, "move", 50));
        assert!(html.contains("wish-percent") && html.contains("value=\"50\""));
    }

    #[test]
    fn bits_analog_values_and_registers() {
        let net = net();
        let unit = &net.units[1];
        let view = Judged::of(unit, 2, &Tags::default()).view;
        let html = drawn(|html| bits(html, "Timers", "timers", &view.timers));
        assert!(html.contains("data-key=\"analog_channel_1_low\" data-on=\"1\""));
        let html = drawn(|html| analog(html, &view, Scaling::Percent));
        assert!(html.contains("data-register=\"8\"") && html.contains("61 %"));
        let html = drawn(|html| registers(html, unit, 8_000_000));
        assert!(html.contains("40009") && html.contains("1884"));
        assert_eq!(html.matches("<tr data-register").count(), 9);
        let html = drawn(|html| differences(html, unit.device));
        assert!(html.contains("D31"));
    }

    #[test]
    fn a_read_tells_how_it_went() {
        let mut net = net();
        net.ask(5, 2);
        let html = drawn(|html| reading(html, 2, net.asked.as_ref(), true));
        assert!(html.contains("disabled") && html.contains("between two polls"));
        let html = drawn(|html| reading(html, 3, net.asked.as_ref(), true));
        assert!(!html.contains("disabled") && !html.contains("polls"));
        net.lost();
        let html = drawn(|html| reading(html, 2, net.asked.as_ref(), true));
        assert!(html.contains("connection to the bridge was lost"));
    }
}
