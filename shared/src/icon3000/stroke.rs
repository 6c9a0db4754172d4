//! Partial and emergency strokes: time over position, limits, and the result in words.
//!
//! Source: VCIOM-16345-EN, tables 39 and 40 with their notes; readings E12, E13, E78, E79, E89.

use super::curve::{Direction, Which};
use super::model::{File, Kind};
use super::read::{Item, Log};
use super::records::Records;
use crate::address::{Address, Table};
use crate::image::Image;
use crate::map::row::Source;
use crate::value::Value;

/// Which stroke it was.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Test {
    /// A partial stroke test.
    Partial,
    /// An emergency stroke.
    Emergency,
}

/// A point: percent of position, and tenths of a second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Point {
    /// Percent of position.
    pub position: u16,
    /// Time since the command, or since the turn; tenths of a second.
    pub tenths: u16,
}

/// A stroke as its file tells it.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Partial or emergency.
    pub test: Test,
    /// Number of the file.
    pub number: u16,
    /// Reference, latest, or an older one.
    pub which: Which,
    /// Which way it went; `None` if not read or of no known code.
    pub direction: Option<Direction>,
    /// The way out. Positions that were not reached are left out (reading E78).
    pub out: Vec<Point>,
    /// The way back, of a partial stroke, from the far end.
    pub back: Vec<Point>,
    /// When, by the clock of the device.
    pub when: Option<String>,
    /// Code of the result: 1 passed, 2 failed, 3 reset, 4 to 6 the limit that failed.
    pub result: Option<u16>,
    /// T-PST and T-RET in tenths of a second.
    pub t_pst: Option<u16>,
    /// Time back.
    pub t_ret: Option<u16>,
    /// OV-TR in tenths of a percent (reading E79).
    pub ov_tr: Option<u16>,
    /// PST travel limit in percent.
    pub travel_limit: Option<u16>,
    /// Bits of the status, 16 of them (reading E13).
    pub status: Option<u16>,
    /// Names of the conditions that reset it (reading E12).
    pub reset: Vec<&'static str>,
    /// Where the file is described.
    pub source: Source,
}

impl Stroke {
    /// A stroke from its file (3000 to 3016, 3500 to 3516); `None` if it is no such file.
    #[must_use]
    pub fn of_file(number: u16, records: &Records) -> Option<Self> {
        let file = File::of(number)?;
        let test = match file.key {
            "pst_curves" => Test::Partial,
            "efs_curves" => Test::Emergency,
            _ => return None,
        };
        let log = Log::read(number, records)?;
        let raw = |key: &str| log.get(key).and_then(|i| i.words.first().copied());
        let direction = match raw("direction") {
            Some(0) => Some(Direction::Close),
            Some(1) => Some(Direction::Open),
            _ => None,
        };
        let (ov_tr, travel_limit) = (raw("ov_tr"), raw("travel_limit"));
        // As far as the travel went: its limit and what it overshot, rounded up.
        let last = match test {
            Test::Emergency => 100,
            Test::Partial => travel_limit.map_or(50, |limit| {
                limit
                    .saturating_add(ov_tr.unwrap_or(0).div_ceil(10))
                    .min(50)
            }),
        };
        let key = if test == Test::Partial {
            "t_pst_at"
        } else {
            "t_efs_at"
        };
        let reset = log.get("reset_conditions");
        let reset = reset.map_or_else(Vec::new, |item| match (item.field.kind, item.value) {
            (Kind::Bits, Value::Flags { raw, set }) => set
                .members
                .iter()
                .filter(|m| raw.wrapping_shr(m.value.into()) & 1 != 0)
                .map(|m| m.label)
                .collect(),
            _ => Vec::new(),
        });
        let mut back = points(&log, "t_ret_at", direction, last);
        back.reverse();
        Some(Self {
            test,
            number,
            which: match number.saturating_sub(file.first) {
                0 => Which::Reference,
                n => Which::Stored(n),
            },
            direction,
            out: points(&log, key, direction, last),
            back,
            when: log.get("time").map(Item::text),
            result: raw("result"),
            t_pst: raw("t_pst"),
            t_ret: raw("t_ret"),
            ov_tr,
            travel_limit,
            status: raw("status"),
            reset,
            source: file.source,
        })
    }

    /// The result in one sentence, with its cause where the file names one.
    #[must_use]
    pub fn in_words(&self) -> String {
        let of = |tenths: Option<u16>, unit: &str| {
            tenths.map_or_else(String::new, |t| format!(" ({}.{} {unit})", t / 10, t % 10))
        };
        if self.test == Test::Emergency {
            return match self.out.last() {
                Some(last) => format!(
                    "Emergency stroke to {} % in {}.{} s.",
                    last.position,
                    last.tenths / 10,
                    last.tenths % 10
                ),
                None => "The times of the emergency stroke were not read.".to_owned(),
            };
        }
        match self.result {
            Some(1) => format!(
                "Passed: went in T-PST{}, came back in T-RET{}.",
                of(self.t_pst, "s"),
                of(self.t_ret, "s")
            ),
            Some(2) => "Failed; the file names no single limit.".to_owned(),
            Some(3) if self.reset.is_empty() => {
                "Reset before its end; no condition is noted.".to_owned()
            }
            Some(3) => format!("Reset before its end by: {}.", self.reset.join(", ")),
            Some(4) => format!(
                "Failed: the way out took longer than T-PST allows{}.",
                of(self.t_pst, "s")
            ),
            Some(5) => format!(
                "Failed: the way back took longer than T-RET allows{}.",
                of(self.t_ret, "s")
            ),
            Some(6) => format!(
                "Failed: the valve went further than OV-TR allows{}.",
                of(self.ov_tr, "%")
            ),
            Some(other) => format!("The result has the unknown code {other}."),
            None => "The result was not read.".to_owned(),
        }
    }

    /// True if result and status bits of a partial stroke contradict each other: the file keeps
    /// both, and neither outranks the other.
    #[must_use]
    pub fn is_contradictory(&self) -> bool {
        let (Some(result), Some(status)) = (self.result, self.status) else {
            return false;
        };
        let passed = status & 1 != 0;
        let failed = status & 0b1110 != 0;
        match result {
            1 => failed,
            2 | 4..=6 => passed && !failed,
            _ => false,
        }
    }
}

/// The points of a run of times. A zero behind the start is a position that was not reached, and
/// what lies beyond the travel has no stated filler (reading E78).
fn points(log: &Log, key: &str, direction: Option<Direction>, last: u16) -> Vec<Point> {
    let direction = direction.unwrap_or(Direction::Close);
    let items = log.run(key).into_iter().flatten();
    items
        .filter_map(|item| {
            let travel = item.field.from.saturating_add(item.index);
            let tenths = item.words.first().copied()?;
            let reached = travel <= last && (tenths > 0 || travel == 0);
            reached.then_some(Point {
                position: direction.position(travel),
                tenths,
            })
        })
        .collect()
}

/// A limit of the stroke test as set, and what it means for one reference.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Limit {
    /// T-PST, T-RET or OV-TR.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// Register that holds it.
    pub register: u16,
    /// As set, in percent; `None` if it was not read.
    pub percent: Option<u16>,
    /// What it comes to: tenths of a second of the reference, or tenths of a percent of the stroke.
    ///
    /// Reading E89: percent of what is not stated; this is a presumption, to be drawn as one.
    pub presumed_tenths: Option<u32>,
}

/// The limits of HR 3616, 3618 and 3619; `reference` is the stroke of file 3000.
#[must_use]
pub fn limits(image: &Image, reference: Option<&Stroke>) -> [Limit; 3] {
    let percent = |register: u16| {
        image
            .cell(Table::Holding, Address::new(register))
            .map(|c| c.word)
    };
    let of_time = |register: u16, time: Option<u16>| {
        let share = u32::from(percent(register)?).saturating_mul(time?.into());
        Some(share / 100)
    };
    [
        Limit {
            key: "t_pst",
            label: "Max T-PST",
            register: 3616,
            percent: percent(3616),
            presumed_tenths: of_time(3616, reference.and_then(|r| r.t_pst)),
        },
        Limit {
            key: "t_ret",
            label: "Max T-RET",
            register: 3618,
            percent: percent(3618),
            presumed_tenths: of_time(3618, reference.and_then(|r| r.t_ret)),
        },
        Limit {
            key: "ov_tr",
            label: "Max OV-TR",
            register: 3619,
            percent: percent(3619),
            presumed_tenths: percent(3619).map(|p| u32::from(p).saturating_mul(10)),
        },
    ]
}
