//! The host's own table of faults: for each unit and host port whether the last poll failed.
//!
//! It stands beside bits 10 and 11 of register 9, which the unit sets by itself, and never
//! overwrites them. The guide leaves the choice to the host (section 4.3.1); its examples overwrite,
//! and [`FaultTable::overwritten`] shows the word as they would have it.

use super::{HostPort, Pair};

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

/// Changes of a unit that make it an unsteady one, within [`UNSTEADY_PASSES`]: a unit that goes off
/// and comes back makes four on two ports.
const UNSTEADY_CHANGES: usize = 6;
/// How far back changes count, in passes over all units on all ports.
const UNSTEADY_PASSES: u64 = 16;

/// A unit.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Line {
    unit: u8,
    cells: Pair<Cell>,
    /// The observation that changed it last.
    changed: u64,
    /// Those that turned good to bad or back, the last ones only.
    turns: [u64; UNSTEADY_CHANGES],
}

/// Faults of all units on both ports.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FaultTable {
    second: bool,
    up: Pair<bool>,
    /// In the order of the cable.
    units: Vec<Line>,
    /// Observations so far.
    seen: u64,
    /// When a port was lost or came back last.
    ports_changed: u64,
}

impl FaultTable {
    /// The table of a network of which nothing is known yet: its units in the order of the cable,
    /// and whether the host has a second port.
    #[must_use]
    pub fn new(units: impl IntoIterator<Item = u8>, second: bool) -> Self {
        Self {
            second,
            up: Pair::both(true),
            units: units
                .into_iter()
                .map(|unit| Line {
                    unit,
                    cells: Pair::default(),
                    changed: 0,
                    turns: [0; UNSTEADY_CHANGES],
                })
                .collect(),
            seen: 0,
            ports_changed: 0,
        }
    }

    /// Takes in how a poll of a unit on a port ended: 1 is a fault, as in the examples of the guide
    /// (rules P2 and P3). A unit or port that the network does not have is left out.
    pub fn note(&mut self, unit: u8, port: HostPort, failed: bool) {
        if port == HostPort::Two && !self.second {
            return;
        }
        self.seen = self.seen.saturating_add(1);
        let Some(line) = self.units.iter_mut().find(|l| l.unit == unit) else {
            return;
        };
        let before = line.cells.get(port).fault;
        if before != Some(failed) {
            line.changed = self.seen;
        }
        if before == Some(!failed) {
            line.turns.rotate_left(1);
            if let Some(last) = line.turns.last_mut() {
                *last = self.seen;
            }
        }
        let cell = Cell {
            fault: Some(failed),
            seen: self.seen,
        };
        line.cells.set(port, cell);
    }

    /// Takes in that so many polls were made of which no more is known: the window of
    /// [`FaultTable::is_unsteady`] is one of polls.
    pub const fn elapse(&mut self, polls: u64) {
        self.seen = self.seen.saturating_add(polls);
    }

    /// Takes in that a whole pass on a port found every fault there as it is known.
    pub fn confirm(&mut self, port: HostPort) {
        self.seen = self.seen.saturating_add(1);
        for line in &mut self.units {
            let fault = line.cells.get(port).fault;
            if fault.is_some() {
                let seen = self.seen;
                line.cells.set(port, Cell { fault, seen });
            }
        }
    }

    /// Takes in that the host lost one of its ports, or has it back. Without the port no unit can
    /// be reached through it; with the port back nothing is known until each was tried anew.
    pub fn set_port(&mut self, port: HostPort, up: bool) {
        if self.up.get(port) == up || (port == HostPort::Two && !self.second) {
            return;
        }
        self.up.set(port, up);
        self.seen = self.seen.saturating_add(1);
        self.ports_changed = self.seen;
        for line in &mut self.units {
            let cell = Cell {
                fault: (!up).then_some(true),
                seen: 0,
            };
            line.cells.set(port, cell);
        }
    }

    /// Takes in that nothing is known of a unit on a port any more.
    pub fn forget(&mut self, unit: u8, port: HostPort) {
        self.seen = self.seen.saturating_add(1);
        if let Some(line) = self.units.iter_mut().find(|l| l.unit == unit) {
            line.cells.set(port, Cell::default());
            line.changed = self.seen;
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
        let line = self.units.iter().find(|l| l.unit == unit)?;
        line.cells.get(port).fault
    }

    /// All units in the order of the cable with their faults.
    pub fn units(&self) -> impl DoubleEndedIterator<Item = (u8, Pair<Option<bool>>)> + '_ {
        self.units.iter().map(|line| {
            let faults = Pair {
                one: line.cells.one.fault,
                two: line.cells.two.fault,
            };
            (line.unit, faults)
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

    /// True for a unit that comes and goes: its faults turned six times and more within sixteen
    /// passes on all ports. The diagnosis leaves it out, so that it does not keep the rest in doubt.
    #[must_use]
    pub fn is_unsteady(&self, unit: u8) -> bool {
        let mut all = self.units.iter();
        all.find(|l| l.unit == unit)
            .is_some_and(|l| self.turns_often(l))
    }

    fn turns_often(&self, line: &Line) -> bool {
        let ports = if self.second { 2 } else { 1 };
        let units = u64::try_from(self.units.len()).unwrap_or(u64::MAX);
        let window = units.saturating_mul(ports).saturating_mul(UNSTEADY_PASSES);
        let first = line.turns.first().copied().unwrap_or(0);
        first > 0 && self.seen.saturating_sub(first) <= window
    }

    /// How many pairs of unit and port must still be tried before the table can be relied on: those
    /// that were not looked at again since the last change. A pattern seen half before and half
    /// after a change may look like another fault; only 0 rules that out. Unsteady units don't
    /// count.
    #[must_use]
    pub fn unsettled(&self) -> usize {
        let steady = || self.units.iter().filter(|l| !self.turns_often(l));
        let changed = steady().map(|l| l.changed).max().unwrap_or(0);
        let changed = changed.max(self.ports_changed);
        let ports = HostPort::BOTH
            .into_iter()
            .filter(|p| self.has(*p) && self.is_up(*p));
        ports
            .map(|port| {
                let old = |line: &&Line| {
                    let cell = line.cells.get(port);
                    cell.fault.is_none() || cell.seen < changed
                };
                steady().filter(old).count()
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
