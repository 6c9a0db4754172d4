//! Who a device is: function 17, registers and card reports, each statement with its source.

use super::model::File;
use super::read::Log;
use super::records::Files;
use super::say;
use crate::address::{Address, Table};
use crate::image::Image;
use crate::map::row::{Model, Source};
use crate::render::text_of;

/// The report of server ID as an ICON3000 gives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// The byte count as transmitted: 0x52 as the manual prints it, or 0x54 as the standard counts
    /// (reading E63).
    pub count: u8,
    /// Server ID; the manual prints 0.
    pub server_id: u8,
    /// Run indicator; the manual prints 0.
    pub run: u8,
    /// 14 characters in a field of 16.
    pub actuator_type: String,
    /// Up to 28 characters.
    pub serial_number: String,
    /// Up to 28 characters.
    pub valve_tag: String,
    /// `9.00`.
    pub base_card: String,
    /// `4.01`; reading E84: 4.00 or later is an ICON3000v2.
    pub interface: String,
}

/// Where the report is described.
pub const REPORT: Source = Source {
    doc: "VCIOM-16345-EN",
    part: "section 8.10, p. 60",
};

impl Report {
    /// Reads a response PDU of function 17. The data are taken from its length, since the byte
    /// count is either of two (reading E63); `None` unless 84 bytes follow it.
    #[must_use]
    pub fn of_pdu(pdu: &[u8]) -> Option<Self> {
        let [17, count, server_id, run, data @ ..] = pdu else {
            return None;
        };
        if data.len() != 82 || !matches!(count, 82 | 84) {
            return None;
        }
        let text = |from: usize, to: usize| text_of(data.get(from..to).unwrap_or(&[]));
        Some(Self {
            count: *count,
            server_id: *server_id,
            run: *run,
            actuator_type: text(0, 16),
            serial_number: text(16, 44),
            valve_tag: text(44, 72),
            base_card: text(72, 76),
            interface: text(78, 82),
        })
    }
}

/// One statement about a device.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fact {
    /// Frozen identifier.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// What it says.
    pub value: String,
    /// Where it came from, in words: `FC 17`, `HR 3042`, `file 5300`.
    pub from: String,
    /// Where that is described.
    pub source: Source,
    /// True if another place says something else of the same.
    pub disputed: bool,
}

/// Keys and labels of facts that several places tell: the registers of each (inferred mirrors,
/// reading E44), and what function 17 calls it.
const TOLD: [(&str, &str, &[u16]); 12] = [
    ("actuator_type", "Actuator type", &[3034]),
    ("serial_number", "Actuator serial number", &[3042, 3742]),
    ("valve_tag", "Valve tag", &[3056]),
    ("base_card", "Base card software", &[3070]),
    ("interface", "Modbus interface software", &[3072]),
    ("order_type", "Actuator type (order)", &[3460, 3756]),
    ("nominal_torque", "Nominal torque or thrust", &[3074]),
    ("test_date", "Test date", &[3078, 3770]),
    ("start_up_date", "Start-up date", &[3082]),
    ("interface_firmware", "Interface firmware revision", &[3654]),
    ("interface_hardware", "Interface hardware revision", &[3655]),
    ("identifier", "Identifier", &[3000, 44]),
];

/// All that is known of who a device is, by key; of one key, function 17 first, then registers.
///
/// Statements of one key that differ are all marked as disputed.
#[must_use]
pub fn facts(model: Model, image: &Image, report: Option<&Report>, files: &Files) -> Vec<Fact> {
    let mut facts = Vec::new();
    for (key, label, registers) in TOLD {
        let first = facts.len();
        if let Some(value) = report.and_then(|r| of_report(r, key)) {
            facts.push(Fact {
                key,
                label,
                value: value.to_owned(),
                from: "FC 17".to_owned(),
                source: REPORT,
                disputed: false,
            });
        }
        for register in registers {
            let row = model
                .map()
                .row_at(Table::Holding, Address::new(*register))
                .filter(|row| row.address.get() == *register);
            let Some((row, text)) = row.and_then(|row| Some((row, say::row(image, row)?))) else {
                continue;
            };
            facts.push(Fact {
                key,
                label,
                value: text,
                from: format!("HR {register}"),
                source: row.source,
                disputed: false,
            });
        }
        let told = facts.get_mut(first..).unwrap_or_default();
        let said: Vec<_> = told.iter().map(|f| f.value.clone()).collect();
        let differ = said.windows(2).any(|w| w.first() != w.last());
        told.iter_mut().for_each(|f| f.disputed = differ);
    }
    facts.extend(cards(files));
    facts
}

fn of_report<'a>(report: &'a Report, key: &str) -> Option<&'a str> {
    let text = match key {
        "actuator_type" => &report.actuator_type,
        "serial_number" => &report.serial_number,
        "valve_tag" => &report.valve_tag,
        "base_card" => &report.base_card,
        "interface" => &report.interface,
        _ => return None,
    };
    Some(text)
}

/// What the card reports say (files 5300 to 5304).
fn cards(files: &Files) -> Vec<Fact> {
    let mut facts = Vec::new();
    let Some(file) = File::by_key("card_reports") else {
        return facts;
    };
    for number in file.first..=file.last {
        let log = files.get(number).and_then(|r| Log::read(number, r));
        let Some(log) = log else { continue };
        for item in log.head.iter().flatten() {
            if matches!(item.field.kind, super::model::Kind::Unused) {
                continue;
            }
            facts.push(Fact {
                key: item.field.key,
                label: item.field.label,
                value: item.text(),
                from: format!("file {number} ({})", log.name()),
                source: item.field.source,
                disputed: false,
            });
        }
    }
    facts
}

/// Which model a device is, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Guess {
    /// The model; `None` if what was read does not tell.
    pub model: Option<Model>,
    /// Why, in words.
    pub why: String,
}

/// Holding registers that tell the models apart when each is asked for alone: the level logged in,
/// which only an ICON3000v2 has, and the first one that an ICON2000v4 does not have (reading E35).
pub const PROBES: [u16; 2] = [3480, 22];

/// Which model a device is, from what was read of it (reading E84).
///
/// `beyond_3473` and `beyond_21` tell whether a read of one holding register beyond 3473, and of one
/// beyond 21 ([`PROBES`]), was refused with exception 02 (`Some(true)`), answered (`Some(false)`), or
/// not tried. A block says less: it is refused for any register of it.
///
/// Software before 4.00 alone says no more than that it is no ICON3000v2: function 17 is one of an
/// ICON2000v4 too (table 6).
#[must_use]
pub fn detect(
    image: &Image,
    report: Option<&Report>,
    beyond_3473: Option<bool>,
    beyond_21: Option<bool>,
) -> Guess {
    let guess = |model, why: &str| Guess {
        model,
        why: why.to_owned(),
    };
    let answers = |from: u16, to: u16| {
        image
            .iter()
            .any(|(table, at, _)| table == Table::Holding && (from..=to).contains(&at.get()))
    };
    if answers(3474, u16::MAX) || beyond_3473 == Some(false) {
        return guess(
            Some(Model::Icon3000v2),
            "A register beyond 3473 answers; only an ICON3000v2 has them.",
        );
    }
    let beyond_21_answers = answers(22, 3473) || beyond_21 == Some(false);
    if beyond_21 == Some(true) && !beyond_21_answers {
        return guess(
            Some(Model::Icon2000v4),
            "Registers beyond 21 are refused; the ICON2000v4 has 0 to 21 only.",
        );
    }
    let of_registers = {
        let row = Model::Icon3000v2
            .map()
            .row_at(Table::Holding, Address::new(3072));
        row.and_then(|row| image.bytes(row)).map(|b| text_of(&b))
    };
    let software = report.map(|r| r.interface.clone()).or(of_registers);
    let said = software.as_deref().and_then(major).zip(software.as_deref());
    let is_new = said.map(|(major, _)| major >= 4);
    let software = said.map_or("", |(_, text)| text);
    match (is_new, beyond_3473, beyond_21_answers) {
        (Some(true), Some(true), _) => Guess {
            model: None,
            why: format!(
                "The interface has software {software}, which is that of an ICON3000v2, but HR 3480 \
                 is refused."
            ),
        },
        (Some(true), ..) => Guess {
            model: Some(Model::Icon3000v2),
            why: format!("The interface has software {software}; 4.00 or later is an ICON3000v2."),
        },
        (Some(false), _, true) => Guess {
            model: Some(Model::Icon3000),
            why: format!(
                "Registers beyond 21 answer, and the interface has software {software}, before the \
                 4.00 of the ICON3000v2."
            ),
        },
        (None, Some(true), true) => guess(
            Some(Model::Icon3000),
            "Registers beyond 3473 are refused, those before answer.",
        ),
        (Some(false), ..) => Guess {
            model: None,
            why: format!(
                "The interface has software {software}: no ICON3000v2. Whether it is an ICON3000 or \
                 an ICON2000v4, HR 22 would tell."
            ),
        },
        (None, ..) => guess(
            None,
            "What was read does not tell: neither the software of the interface (FC 17 or HR 3072) \
             nor a register beyond 3473 or 21 is known.",
        ),
    }
}

/// The number before the point.
fn major(version: &str) -> Option<u32> {
    version.split_once('.')?.0.trim().parse().ok()
}
