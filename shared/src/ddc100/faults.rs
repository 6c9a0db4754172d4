//! The host's own table of faults: for each unit and host port whether the last poll failed.
//!
//! It stands beside bits 10 and 11 of register 9, which the unit sets by itself, and never
//! overwrites them. The guide leaves the choice to the host (section 4.3.1); its examples overwrite,
//! and [`FaultTable::overwritten`] shows the word as they would have it.

use super::{HostPort, Pair};
use crate::proto::{DdcNews, LineState};

/// Bit 10 of register 9: channel A fault.
pub const CHANNEL_A: u16 = 1 << 10;
/// Bit 11 of register 9: channel B fault.
pub const CHANNEL_B: u16 = 1 << 11;

/// What is known of a unit on a port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Cell {
    /// Whether the last poll failed; `None` before the first.
    fault: Option<bool>,
    /// Number of the observation that said so.
    seen: u64,
}

/// Faults of all units on both ports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultTable {
    second: bool,
    up: Pair<bool>,
    /// In the order of the cable.
    units: Vec<(u8, Pair<Cell>)>,
    /// Observations so far.
    seen: u64,
    /// The last observation that changed something.
    changed: u64,
}

impl FaultTable {
    /// The table of a network of which nothing is known yet: its units in the order of the cable,
    /// and whether the host has a second port.
    #[must_use]
    pub fn new(units: impl IntoIterator<Item = u8>, second: bool) -> Self {
        Self {
            second,
            up: Pair::both(true),
            units: units.into_iter().map(|u| (u, Pair::default())).collect(),
            seen: 0,
            changed: 0,
        }
    }

    /// Takes in how a poll of a unit on a port ended: 1 is a fault, as in the examples of the guide
    /// (rules P2 and P3). A unit or port that the network does not have is left out.
    pub fn note(&mut self, unit: u8, port: HostPort, failed: bool) {
        if port == HostPort::Two && !self.second {
            return;
        }
        self.seen = self.seen.saturating_add(1);
        let Some((_, cells)) = self.units.iter_mut().find(|(u, _)| *u == unit) else {
            return;
        };
        if cells.get(port).fault != Some(failed) {
            self.changed = self.seen;
        }
        let cell = Cell {
            fault: Some(failed),
            seen: self.seen,
        };
        cells.set(port, cell);
    }

    /// Takes in that the host lost one of its ports, or has it back. Without the port no unit can
    /// be reached through it; with the port back nothing is known until each was tried anew.
    pub fn set_port(&mut self, port: HostPort, up: bool) {
        if self.up.get(port) == up || (port == HostPort::Two && !self.second) {
            return;
        }
        self.up.set(port, up);
        self.seen = self.seen.saturating_add(1);
        self.changed = self.seen;
        for (_, cells) in &mut self.units {
            let cell = Cell {
                fault: (!up).then_some(true),
                seen: 0,
            };
            cells.set(port, cell);
        }
    }

    /// Takes in what the backend tells of a network: how a poll ended, and the state of a port. With
    /// the table made of the same units, the page has the same table as the host.
    pub fn apply(&mut self, news: &DdcNews) {
        match news {
            DdcNews::Unit {
                unit,
                port,
                fault_a,
                fault_b,
                ..
            } => {
                for (of, fault) in HostPort::BOTH.into_iter().zip([fault_a, fault_b]) {
                    // The port that was used was looked at; the other one counts if it is news.
                    let looked = of.number() == *port && self.is_up(of);
                    let news = *fault != self.fault(*unit, of) && self.is_up(of);
                    if let Some(failed) = fault
                        && (looked || news)
                    {
                        self.note(*unit, of, *failed);
                    }
                }
            }
            DdcNews::Port { port, state, .. } => {
                if let Some(port) = HostPort::from_number(*port) {
                    self.set_port(port, *state == LineState::Up);
                }
            }
            _ => {}
        }
    }

    /// True unless the host lost the port.
    #[must_use]
    pub const fn is_up(&self, port: HostPort) -> bool {
        self.up.get(port)
    }

    /// True if the host has the port.
    #[must_use]
    pub const fn has(&self, port: HostPort) -> bool {
        self.second || matches!(port, HostPort::One)
    }

    /// Fault of a unit on a port; `None` if it was not tried yet or does not exist.
    #[must_use]
    pub fn fault(&self, unit: u8, port: HostPort) -> Option<bool> {
        let (_, cells) = self.units.iter().find(|(u, _)| *u == unit)?;
        cells.get(port).fault
    }

    /// All units in the order of the cable with their faults.
    pub fn units(&self) -> impl DoubleEndedIterator<Item = (u8, Pair<Option<bool>>)> + '_ {
        self.units.iter().map(|(unit, cells)| {
            let faults = Pair {
                one: cells.one.fault,
                two: cells.two.fault,
            };
            (*unit, faults)
        })
    }

    /// Number of units.
    #[must_use]
    pub const fn len(&self) -> usize {
        self.units.len()
    }

    /// True without units.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.units.is_empty()
    }

    /// How many pairs of unit and port must still be tried before the table can be relied on: those
    /// that were not looked at again since the last change. A pattern seen half before and half
    /// after a change may look like another fault; only 0 rules that out.
    #[must_use]
    pub fn unsettled(&self) -> usize {
        let ports = HostPort::BOTH
            .into_iter()
            .filter(|p| self.has(*p) && self.is_up(*p));
        ports
            .map(|port| {
                let old = |(_, cells): &&(u8, Pair<Cell>)| {
                    let cell = cells.get(port);
                    cell.fault.is_none() || cell.seen < self.changed
                };
                self.units.iter().filter(old).count()
            })
            .sum()
    }

    /// Register 9 with bits 10 and 11 as the guide's examples store it in the host: those of the
    /// unit replaced by those of this table. What was never tried stays as the unit has it; with
    /// one port the second bit is 0.
    #[must_use]
    pub fn overwritten(&self, unit: u8, register_9: u16) -> u16 {
        let put = |word: u16, bit: u16, fault: Option<bool>| match fault {
            Some(true) => word | bit,
            Some(false) => word & !bit,
            None => word,
        };
        let b = if self.second {
            self.fault(unit, HostPort::Two)
        } else {
            Some(false)
        };
        put(
            put(register_9, CHANNEL_A, self.fault(unit, HostPort::One)),
            CHANNEL_B,
            b,
        )
    }
}
