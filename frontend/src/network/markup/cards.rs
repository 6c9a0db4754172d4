//! The cards of a unit: bits, analog values, what its type is about. Each says how old it is.

use shared::address::{Address, Table};
use shared::ddc100::scaling::{Scaled, Scaling};
use shared::ddc100::view::{Bit, View, has_bits, has_software};
use shared::device::Device;
use shared::map::row::Kind;

use super::table::bar;
use crate::format::age;
use crate::markup::Markup;
use crate::network::state::net::{Net, Unit};
use crate::network::state::tags::Tags;
use crate::network::state::unit::{kind, place};

/// What is common to all cards of a unit.
#[derive(Clone, Copy, Debug)]
pub struct Cards<'a> {
    /// The unit.
    pub unit: &'a Unit,
    /// Now, in microseconds of the backend.
    pub now_us: u64,
    /// True if nothing new comes: the unit is off-line, or there is no connection.
    pub stale: bool,
    /// What was read before is old.
    pub before_us: u64,
}

impl<'a> Cards<'a> {
    /// For a unit of a network.
    #[must_use]
    pub fn of(net: &Net, unit: &'a Unit, now_us: u64, stale: bool) -> Self {
        let newest = unit.newest().unwrap_or(0);
        Self {
            unit,
            now_us,
            stale,
            before_us: newest.saturating_sub(net.bits_last_us()),
        }
    }

    const fn class(&self) -> &'static str {
        if self.stale {
            "unit-card stale"
        } else {
            "unit-card"
        }
    }

    /// How old registers are, in words: `register 14: 3.0 s ago; register 15: not read yet`.
    #[must_use]
    pub fn ages(&self, numbers: &[u16]) -> String {
        let mut groups: Vec<(String, String)> = Vec::new();
        for number in numbers {
            let read = self.unit.read_at(*number);
            let text = read.map_or_else(
                || "not read yet".to_owned(),
                |at| format!("{} ago", age(self.now_us.saturating_sub(at))),
            );
            match groups.last_mut().filter(|(_, t)| *t == text) {
                Some((names, _)) => {
                    if !names.contains(',') {
                        *names = names.replace("register", "registers");
                    }
                    names.push_str(&format!(", {number}"));
                }
                None => groups.push((format!("register {number}"), text)),
            }
        }
        let words: Vec<String> = groups
            .into_iter()
            .map(|(names, text)| format!("{names}: {text}"))
            .collect();
        words.join("; ")
    }

    fn open(&self, html: &mut Markup, testid: &str, title: &str, numbers: &[u16]) {
        html.open(
            "section",
            &[("class", self.class()), ("data-testid", testid)],
        );
        html.node("h3", "", title);
        if !numbers.is_empty() {
            html.open(
                "p",
                &[("class", "quiet net-small"), ("data-testid", "card-age")],
            );
            html.text(&self.ages(numbers)).close("p");
        }
    }

    /// A card of bits: those that are active stand out, the rest is quiet, and so is what is old.
    pub fn bits(
        &self,
        html: &mut Markup,
        (title, testid): (&str, &str),
        numbers: &[u16],
        bits: &[Bit],
    ) {
        let device = self.unit.device;
        let has: Vec<u16> = numbers
            .iter()
            .copied()
            .filter(|number| has_bits(device, *number))
            .collect();
        self.open(html, testid, title, &has);
        if has.is_empty() {
            html.node("p", "quiet", "This type has none.");
        }
        html.open("ul", &[("class", "unit-bit-list")]);
        for bit in bits {
            let on = bit.is_active();
            let old = bit.at.get() < self.before_us;
            html.open(
                "li",
                &[
                    ("class", if on && !old { "on" } else { "quiet" }),
                    ("data-key", bit.member.key),
                    ("data-on", if on { "1" } else { "0" }),
                ],
            );
            html.node("code", "", &place(bit));
            html.node("span", "", bit.member.label);
            html.open("span", &[("class", "bit-words")]);
            html.text(bit.text());
            if old {
                html.text(", old");
            }
            html.close("span").close("li");
        }
        html.close("ul").close("section");
    }

    /// The analog values, with how they count.
    pub fn analog(&self, html: &mut Markup, view: &View, tags: &Tags) {
        let (unit, device) = (self.unit, self.unit.device);
        let has = |number: &u16| {
            let address = Address::new(number.saturating_sub(1));
            let row = device.map().and_then(|m| m.row_at(Table::Holding, address));
            row.is_some_and(|row| row.kind != Kind::Reserved)
        };
        // Register 2 is for commands; it is shown once it was read with all others.
        let argument = (2..3).filter(|n| self.unit.read_at(*n).is_some());
        let numbers: Vec<u16> = argument.chain((3..=8).filter(has)).collect();
        self.open(html, "analog", "Analog values", &numbers);
        let scaling = tags.scaling(unit, 8);
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
            let number = value.row.address.get().saturating_add(1);
            let register = number.to_string();
            html.open(
                "tr",
                &[("data-testid", "analog-row"), ("data-register", &register)],
            );
            html.open("td", &[("class", "num quiet")]);
            html.node("code", "", &register).close("td");
            html.open("th", &[("scope", "row")]).text(value.row.label);
            html.close("th");
            html.node("td", "num quiet mono", &value.raw.to_string());
            html.open("td", &[("class", "num analog-value")]);
            html.text(&value.to_string());
            if let Some(tenths) = value
                .scaled
                .and_then(Scaled::tenths)
                .filter(|_| !self.stale)
            {
                bar(html, u32::from(tenths));
            }
            html.close("td").close("tr");
            let mut notes: Vec<String> = Vec::new();
            let own = tags.scaling(unit, number);
            if value.scaled.is_some() && own != scaling {
                notes.push(format!("Scaled {} by the tag list.", own.key()));
            }
            if !value.row.note.is_empty() {
                notes.push(value.row.note.to_owned());
            }
            if !notes.is_empty() {
                html.open("tr", &[("class", "analog-note")]);
                html.node("td", "", "")
                    .open("td", &[("colspan", "3")])
                    .node("p", "quiet net-small", &notes.join(" "))
                    .close("td")
                    .close("tr");
            }
        }
        html.close("tbody").close("table");
        html.close("section");
    }
}

/// What is different about this type, as far as it matters for what is shown.
pub fn differences(html: &mut Markup, device: Device, view: &View) {
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
    if has_software(device) {
        let text = view.software.map_or_else(
            || "not read yet".to_owned(),
            |byte| format!("{byte:02X} hex, {byte} decimal"),
        );
        html.open("li", &[("data-testid", "software")])
            .node("code", "quiet", "D14")
            .text(" Field unit software vs. ID, bits 8 to 15 of register 11: ")
            .node("b", "", &text)
            .close("li");
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::net::tests::{network, poll};
    use crate::network::state::unit::Judged;
    use shared::capture::Micros;
    use shared::proto::DdcShape;

    fn net() -> Net {
        let mut net = network(3, DdcShape::Loop, 2);
        // Register 8 to 16: combined fault and open torque switch, at REMOTE, analog 1 low.
        poll(
            &mut net,
            2,
            [Some(false), Some(true)],
            &[61, 0x1884, 0, 0x2A04, 0x0801, 0, 0x0001, 0x0004, 0],
        );
        net
    }

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn cards_say_how_old_they_are() {
        let mut net = net();
        let image = &mut net.units[1].image;
        image.absorb(
            &[3, 0, 8, 0, 1],
            &[3, 2, 0x18, 0x84],
            Micros::new(40_000_000),
        );
        let unit = &net.units[1];
        let view = Judged::of(unit, &net, &Tags::default()).view;
        let cards = Cards::of(&net, unit, 42_000_000, false);
        let bits = |title, testid, numbers: &[u16], bits: &[Bit]| {
            drawn(|html| cards.bits(html, (title, testid), numbers, bits))
        };
        let html = bits("Timers", "timers", &[14], &view.timers);
        assert!(html.contains("register 14: 37 s ago"), "{html}");
        assert!(html.contains("class=\"quiet\" data-key=\"analog_channel_1_low\" data-on=\"1\""));
        assert!(html.contains(">active, old<"));
        let html = bits("Status", "status", &[9, 16], &view.status);
        assert!(html.contains("register 9: 2.0 s ago; register 16: 37 s ago"));
        assert!(html.contains("class=\"on\" data-key=\"combined_fault\""));
        assert_eq!(
            cards.ages(&[7, 8]),
            "register 7: not read yet; register 8: 37 s ago"
        );
    }

    #[test]
    fn none_and_not_read_are_told_apart() {
        let mut net = network(2, DdcShape::Loop, 2);
        net.units[1].device = Device::Ddc100Mx;
        let user_faults = |at: usize| {
            let cards = Cards::of(&net, &net.units[at], 0, false);
            drawn(|html| cards.bits(html, ("User faults", "user-faults"), &[15], &[]))
        };
        assert!(user_faults(0).contains("register 15: not read yet"));
        assert!(!user_faults(0).contains("has none"));
        // Reading D10: bits 0 to 15 are not used on an MX/DDC.
        assert!(user_faults(1).contains("This type has none."));
        assert!(!user_faults(1).contains("not read"));
    }

    #[test]
    fn analog_values_have_their_notes_and_scales() {
        let mut net = net();
        net.units[1].device = Device::Ddc100Mx;
        let image = &mut net.units[1].image;
        let four = [3, 8, 0, 10, 0, 20, 1, 0xE0, 0, 30];
        image.absorb(&[3, 0, 2, 0, 4], &four, Micros::new(5_000_000));
        let mut tags = Tags::default();
        let mut entry = tags.get(2).cloned().unwrap_or_default();
        entry.registers.insert(6, Scaling::Byte);
        tags.set(2, entry);
        let unit = &net.units[1];
        let view = Judged::of(unit, &net, &tags).view;
        let html = drawn(|html| Cards::of(&net, unit, 8_000_000, false).analog(html, &view, &tags));
        assert!(
            html.contains("data-register=\"8\"") && html.contains("61 %"),
            "{html}"
        );
        let note = view
            .analog
            .iter()
            .find(|a| a.row.key.starts_with("att"))
            .unwrap();
        assert!(
            note.row.note.contains("40"),
            "note 1 of table 3.5 on torque: {}",
            note.row.note
        );
        assert!(html.contains("40") && !html.contains("title="));
        // 30 of 255 is 11.8 %.
        assert!(html.contains("11.8 %") && html.contains("Scaled 0-255 by the tag list"));
        assert!(html.contains("register 7: not read yet"));
        let html = drawn(|html| Cards::of(&net, unit, 8_000_000, true).analog(html, &view, &tags));
        assert!(html.contains("unit-card stale") && !html.contains("bar-fill"));
    }

    #[test]
    fn a_type_tells_its_software() {
        let net = net();
        let unit = &net.units[1];
        let view = Judged::of(unit, &net, &Tags::default()).view;
        let html = drawn(|html| differences(html, unit.device, &view));
        assert!(
            html.contains("D31") && html.contains("2A hex, 42 decimal"),
            "{html}"
        );
        let none = Judged::of(&net.units[0], &net, &Tags::default()).view;
        let html = drawn(|html| differences(html, Device::Ddc100Uec, &none));
        assert!(
            html.contains("register 11: <b class=\"\">not read yet"),
            "{html}"
        );
        let html = drawn(|html| differences(html, Device::Ddc100Mx, &none));
        assert!(!html.contains("software"));
    }
}
