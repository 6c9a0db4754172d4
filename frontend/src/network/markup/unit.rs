//! A unit: what it does, what is wrong, all of its registers.

use shared::address::{Address, Table};
use shared::ddc100::scaling::Scaling;
use shared::ddc100::view::has_bits;
use shared::ddc100::words::{STATUS, register};
use shared::device::Device;
use shared::map::row::{Kind, Row};
use shared::proto::Outcome;

use super::cards::Cards;
use super::head::address;
use super::table::{bit, own, since};
use crate::components::icon::Glyph;
use crate::components::ne107::Sign;
use crate::format::{age, encode, millis};
use crate::markup::Markup;
use crate::markup::control::Button;
use crate::markup::device::sign;
use crate::network::state::net::{Net, Reach, Unit};
use crate::network::state::tags::Tags;
use crate::network::state::unit::{Judged, kind, place};
use crate::state::health::outcome;

/// Registers that a unit has, as printed.
pub const REGISTERS: u16 = 56;
/// Registers that the page of a unit reads by itself, as printed.
pub const WATCHED: (u16, u16) = (3, 16);

/// Where the unit is, what its valve does, and when that was so.
pub fn head(
    html: &mut Markup,
    bus: &str,
    net: &Net,
    (unit, judged): (&Unit, &Judged),
    tags: &Tags,
    (now_us, online): (u64, bool),
) {
    let stale = is_stale(net, unit, online);
    let class = if stale { "big stale" } else { "big" };
    html.open("p", &[("class", class), ("data-testid", "unit-position")]);
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
        &[
            (
                "class",
                if stale {
                    "big-state stale"
                } else {
                    "big-state"
                },
            ),
            ("data-testid", "unit-state"),
        ],
    );
    if let Some(mark) = judged.health.sign() {
        sign(html, mark, "20");
        html.text(" ");
    }
    let mut state = judged.view.state.clone();
    // An I/O module has no selector; its register 12 holds inputs of the user.
    if unit.device != Device::Ddc100Io {
        state.push_str(" · ");
        state.push_str(judged.view.mode.label());
    }
    html.text(&match (stale, unit.newest().filter(|_| judged.known)) {
        (false, _) => state,
        (true, read) => {
            let why = if online { "off-line" } else { "no connection" };
            match read {
                Some(at) => {
                    let old = age(now_us.saturating_sub(at));
                    format!("{why}; was: {state}, {old} ago")
                }
                None => why.to_owned(),
            }
        }
    });
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
    if let Some(at) = judged.view.at {
        let old = age(now_us.saturating_sub(at.get()));
        html.text(&format!("; oldest of registers 3 to 16: {old}"));
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
    neighbours(html, net, at, tags);
    html.close("div");
}

/// True if what is known of a unit is not what it says now.
#[must_use]
pub fn is_stale(net: &Net, unit: &Unit, online: bool) -> bool {
    !online || unit.reach(net.ports.len()) == Reach::Lost
}

/// The units before and after place `at`, from 1, along the cable.
fn neighbours(html: &mut Markup, net: &Net, at: usize, tags: &Tags) {
    html.open(
        "nav",
        &[
            ("class", "unit-neighbours net-small"),
            ("aria-label", "Along the cable"),
        ],
    );
    let last = if net.ports.len() > 1 {
        "host port 2"
    } else {
        "end of the cable"
    };
    for (testid, next, end, arrow) in [
        ("unit-before", at.checked_sub(2), "host port 1", "\u{2190} "),
        ("unit-after", Some(at), last, "\u{2192} "),
    ] {
        let Some(unit) = next.and_then(|at| net.units.get(at)) else {
            html.node("span", "quiet", &format!("{arrow}{end}"));
            continue;
        };
        html.open(
            "a",
            &[
                ("href", &format!("#/device/{}", encode(&unit.info.tag))),
                ("data-testid", testid),
            ],
        );
        html.text(&format!("{arrow}{} {}", unit.info.unit, tags.tag(unit)))
            .close("a");
    }
    html.close("nav");
}

/// The faults: of the host, of the unit's own channels, and its fault bits.
pub fn faults(html: &mut Markup, net: &Net, judged: &Judged, cards: &Cards<'_>) {
    let unit = cards.unit;
    html.node("h3", "", "Faults");
    html.open(
        "p",
        &[("class", "quiet net-small"), ("data-testid", "card-age")],
    );
    html.text(&cards.ages(&[9, 10, 14, 15])).close("p");
    if cards.stale {
        html.open("div", &[("class", "stale")]);
    } else {
        html.open("div", &[]);
    }
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
    let word = register(&unit.image, STATUS).map(|cell| cell.word);
    if let (Some(word), Some(table)) = (word, net.table()) {
        let stored = table.overwritten(unit.info.unit, word);
        html.open(
            "p",
            &[("class", "quiet net-small"), ("data-testid", "overwritten")],
        );
        html.text(&format!(
            "Register 9 is {word:04X} as received, {stored:04X} as a host stores it that overwrites bits 10 and 11 with its own (section 4.3.1)."
        ));
        html.close("p");
    }
    if judged.view.faults.is_empty() {
        html.node("p", "quiet", &none_set(unit, net));
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
    if !judged.view.old_faults.is_empty() {
        html.node(
            "p",
            "net-small",
            "Set when they were read, but not read again since; the unit may have cleared them, so they do not count:",
        );
        html.open("ul", &[("class", "conditions quiet")]);
        for fault in &judged.view.old_faults {
            html.open(
                "li",
                &[("data-testid", "old-fault"), ("data-key", fault.member.key)],
            );
            html.node("span", "", fault.member.label);
            html.node("code", "", &place(fault));
            let old = age(cards.now_us.saturating_sub(fault.at.get()));
            html.node("span", "net-small", &format!("{old} ago"))
                .close("li");
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
    html.close("div");
}

/// What is said if no fault bit counts: of which registers that holds, and of which it is not known.
fn none_set(unit: &Unit, net: &Net) -> String {
    let newest = unit.newest().unwrap_or(0);
    let fresh = |number: &u16| {
        let at = unit.read_at(*number);
        at.is_some_and(|at| newest.saturating_sub(at) <= net.bits_last_us())
    };
    let all = [9, 10, 14, 15].into_iter();
    let all = all.filter(|number| has_bits(unit.device, *number));
    let (read, unknown): (Vec<u16>, Vec<u16>) = all.partition(fresh);
    let list = |numbers: &[u16]| {
        let texts: Vec<String> = numbers.iter().map(u16::to_string).collect();
        texts.join(", ")
    };
    match (read.is_empty(), unknown.is_empty()) {
        (true, _) => "The status was not read yet.".to_owned(),
        (_, true) => "No fault bit is set.".to_owned(),
        _ => format!(
            "No fault bit is set in register {}; of {} it is not known.",
            list(&read),
            list(&unknown)
        ),
    }
}

/// Reading all registers, and how that went.
pub fn reading(html: &mut Markup, unit: u8, net: &Net, online: bool) {
    html.node("h3", "", "Registers");
    let asked = net.asked.as_ref().filter(|a| a.unit == unit);
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
    html.open(
        "p",
        &[("class", "quiet net-small"), ("data-testid", "watched")],
    );
    html.text(&format!(
        "Registers {} to {} are read every few seconds while this page is shown, between two polls.",
        WATCHED.0, WATCHED.1
    ));
    let watched = net.watched.as_ref().filter(|a| a.unit == unit);
    if let Some((how, text)) = watched.and_then(|a| a.end.as_ref())
        && *how != Outcome::Ok
    {
        let words = if text.is_empty() { outcome(*how) } else { text };
        html.text(&format!(" The last time it failed: {words}"));
    }
    html.close("p");
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
    use shared::capture::Micros;
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
        let judged = Judged::of(unit, &net, &tags);
        let now = (8_000_000, true);
        let html = drawn(|html| head(html, "Loop", &net, (unit, &judged), &tags, now));
        assert!(html.contains("61 %") && html.contains("Stopped between the ends · Remote"));
        assert!(html.contains("answers on port 1 only, last good answer 3.0 s ago, after 71.0 ms"));
        assert!(html.contains("place 2 of 3 on <a href=\"#/network/Loop\""));
        assert!(html.contains("oldest of registers 3 to 16: 3.0 s"));
        let cards = Cards::of(&net, unit, 8_000_000, false);
        let html = drawn(|html| faults(html, &net, &judged, &cards));
        // Section 4.3.1: unit 2 answers on port 1, not on port 2; bit 11 stays set.
        assert!(html.contains("Register 9 is 1884 as received, 1884 as a host stores it"));
        assert!(html.contains("data-bit=\"host-b\">1<"));
        assert!(html.contains("not fitted"));
        assert!(html.contains("data-key=\"open_torque_switch_fault\""));
        assert!(html.contains("data-key=\"user_fault_2\""));
    }

    #[test]
    fn registers_are_listed() {
        let net = net();
        let html = drawn(|html| registers(html, &net.units[1], 8_000_000));
        assert!(html.contains("40009") && html.contains("1884"));
        assert_eq!(html.matches("<tr data-register").count(), 9);
    }

    /// A unit that is lost is not drawn as if it still said so.
    #[test]
    fn a_lost_unit_says_what_it_was() {
        let mut net = net();
        let tags = Tags::default();
        let head_of = |net: &Net, online| {
            let judged = Judged::of(&net.units[1], net, &tags);
            let of = (&net.units[1], &judged);
            drawn(|html| head(html, "Loop", net, of, &tags, (17_000_000, online)))
        };
        let was = "; was: Stopped between the ends · Remote, 12 s ago";
        let html = head_of(&net, true);
        assert!(!html.contains("stale") && !html.contains("was:"), "{html}");
        let html = head_of(&net, false);
        assert!(html.contains(&format!("no connection{was}")), "{html}");
        net.units[1].fault = [Some(true), Some(true)];
        let html = head_of(&net, true);
        assert!(html.contains(&format!("off-line{was}")), "{html}");
        assert!(html.contains("class=\"big stale\"") && html.contains("big-state stale"));
        net.units[1].image = shared::image::Image::new();
        assert!(
            head_of(&net, true).contains(">off-line</p>")
                || head_of(&net, true).contains(" off-line</p>")
        );
        let unit = &net.units[1];
        let judged = Judged::of(unit, &net, &tags);
        let cards = Cards::of(&net, unit, 17_000_000, is_stale(&net, unit, true));
        let html = drawn(|html| faults(html, &net, &judged, &cards));
        assert!(html.contains("<div class=\"stale\">"));
    }

    #[test]
    fn neighbours_along_the_cable() {
        let net = net();
        let tags = Tags::default();
        let html = drawn(|html| neighbours(html, &net, 2, &tags));
        assert!(
            html.contains(
                "href=\"#/device/MOV-001\" data-testid=\"unit-before\">\u{2190} 1 MOV-001<"
            )
        );
        assert!(
            html.contains(
                "href=\"#/device/MOV-003\" data-testid=\"unit-after\">\u{2192} 3 MOV-003<"
            )
        );
        let html = drawn(|html| neighbours(html, &net, 1, &tags));
        assert!(html.contains("host port 1") && html.contains("MOV-002"));
        let html = drawn(|html| neighbours(html, &net, 3, &tags));
        assert!(html.contains("host port 2") && html.contains("MOV-002"));
    }

    /// Registers 14 and 15 were read once; since then polls bring register 9 only.
    #[test]
    fn old_faults_are_told_apart() {
        let mut net = net();
        let at = Micros::new(40_000_000);
        net.units[1]
            .image
            .absorb(&[3, 0, 8, 0, 1], &[3, 2, 0x08, 0x04], at);
        let judged = Judged::of(&net.units[1], &net, &Tags::default());
        let cards = Cards::of(&net, &net.units[1], 41_000_000, false);
        let html = drawn(|html| faults(html, &net, &judged, &cards));
        assert!(
            html.contains("No fault bit is set in register 9; of 10, 14, 15 it is not known."),
            "{html}"
        );
        assert!(html.contains("data-testid=\"old-fault\" data-key=\"user_fault_2\""));
        assert!(html.contains("36 s ago") && html.contains("they do not count"));
        assert!(html.contains("register 9: 1.0 s ago; registers 10, 14, 15: 36 s ago"));
    }

    #[test]
    fn a_read_tells_how_it_went() {
        let mut net = net();
        net.ask(5, 2);
        let html = drawn(|html| reading(html, 2, &net, true));
        assert!(html.contains("disabled") && html.contains("between two polls"));
        let html = drawn(|html| reading(html, 3, &net, true));
        assert!(!html.contains("disabled") && !html.contains("reading between"));
        net.lost();
        let html = drawn(|html| reading(html, 2, &net, true));
        assert!(html.contains("connection to the bridge was lost"));
    }

    #[test]
    fn a_watch_that_fails_says_so() {
        let mut net = net();
        assert!(net.watch(9, 2));
        assert!(!net.watch(10, 2), "one at a time");
        assert!(net.watch(11, 3), "another unit");
        let read = |html: &mut Markup, net: &Net| reading(html, 3, net, true);
        let html = drawn(|html| read(html, &net));
        assert!(html.contains("Registers 3 to 16 are read every few seconds"));
        assert!(!html.contains("failed"));
        net.hear(shared::proto::DdcNews::Read {
            id: 11,
            bus: "Loop".into(),
            unit: 3,
            outcome: Outcome::Silence,
            text: "no answer within 250 ms".into(),
            request: "030002000e".into(),
            response: String::new(),
            at_us: 9,
        });
        let html = drawn(|html| read(html, &net));
        assert!(html.contains("failed: no answer within 250 ms"), "{html}");
        assert!(net.watch(12, 3));
    }
}
