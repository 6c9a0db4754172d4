//! A network as the backend tells of it: how it is made up, what the last poll of each unit brought,
//! how the passes go.

mod member;
#[cfg(test)]
pub(crate) mod tests;

pub use member::{Counted, Reach, Unit, reach};

use shared::capture::Micros;
use shared::ddc100::diagnosis::Diagnosis;
use shared::ddc100::{FaultTable, HostPort, counters};
use shared::proto::{DdcNews, DdcShape, LineState, Outcome};

use super::findings::findings;
use super::log::Log;
use crate::state::absorb::bytes_of;

/// A host port.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Port {
    /// Where it goes.
    pub line: String,
    /// Its state.
    pub state: LineState,
    /// What happened to it, and what to do.
    pub text: String,
    /// How long its last whole pass took and should have taken, in microseconds.
    pub pass: Option<(u64, u64)>,
}

/// A read that was asked for here.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Asked {
    /// Its number.
    pub id: u32,
    /// The unit.
    pub unit: u8,
    /// How it ended and the words; `None` while it is under way.
    pub end: Option<(Outcome, String)>,
}

/// A network.
#[derive(Clone, Debug, Default)]
pub struct Net {
    /// How the cable runs; `None` before the backend told.
    pub shape: Option<DdcShape>,
    /// Key of the framing.
    pub framing: String,
    /// Bits a second.
    pub baud: u32,
    /// Host ports 1 and, if there is one, 2.
    pub ports: Vec<Port>,
    /// First register of each poll, zero-based.
    pub start: u16,
    /// Registers of each poll.
    pub count: u16,
    /// From an answer to the next request, in milliseconds.
    pub turn_ms: u32,
    /// How long an answer is waited for, in milliseconds.
    pub timeout_ms: u32,
    /// How often a poll is repeated on the same port.
    pub retries: u8,
    /// The units in the order of the cable, from host port 1.
    pub units: Vec<Unit>,
    /// The faults, as they came in, which tells whether they belong together.
    pub table: Option<FaultTable>,
    /// True if no fault changed since the last pass was over.
    quiet: bool,
    /// Number of the last whole pass; 0 before the first.
    pub passes: u64,
    /// The read that was asked for last.
    pub asked: Option<Asked>,
    /// The last of those that the page of a unit makes by itself.
    pub watched: Option<Asked>,
    /// What was found, and when.
    pub log: Log,
}

impl Net {
    /// Takes news in. Those about a unit or a port that is not of this network are left out.
    pub fn hear(&mut self, news: DdcNews) {
        match news {
            DdcNews::Network {
                shape,
                framing,
                baud,
                ports,
                start,
                count,
                turn_ms,
                timeout_ms,
                retries,
                units,
                bus: _,
            } => {
                let port = |line| Port {
                    line,
                    state: LineState::Starting,
                    text: String::new(),
                    pass: None,
                };
                let table = FaultTable::new(units.iter().map(|u| u.unit), ports.len() > 1);
                *self = Self {
                    table: Some(table),
                    shape: Some(shape),
                    framing,
                    baud,
                    ports: ports.into_iter().map(port).collect(),
                    start,
                    count,
                    turn_ms,
                    timeout_ms,
                    retries,
                    units: units.into_iter().map(Unit::new).collect(),
                    quiet: false,
                    passes: 0,
                    asked: self.asked.take(),
                    watched: None,
                    log: core::mem::take(&mut self.log),
                };
                self.log.connected();
            }
            DdcNews::Unit {
                unit,
                port,
                outcome,
                text,
                fault_a,
                fault_b,
                request,
                response,
                at_us,
                took_us,
                bus: _,
            } => {
                self.note(unit, port, [fault_a, fault_b]);
                self.log.reach(unit, [fault_a, fault_b]);
                let Some(unit) = self.unit_mut(unit) else {
                    return;
                };
                unit.outcome = Some(outcome);
                unit.text = text;
                unit.port = port;
                unit.fault = [fault_a, fault_b];
                unit.at = at_us;
                unit.took = took_us;
                if let Some(at) = at_us {
                    unit.image
                        .absorb(&bytes_of(&request), &bytes_of(&response), Micros::new(at));
                    let number = unit.info.unit;
                    self.log_bits(number);
                }
            }
            DdcNews::Pass {
                port,
                number,
                took_us,
                expected_us,
                ..
            } => {
                self.passes = number;
                self.bear_out(port);
                if let Some(port) = self.port_mut(port) {
                    port.pass = Some((took_us, expected_us));
                }
                self.log_findings();
            }
            DdcNews::Port {
                port, state, text, ..
            } => {
                self.log.port(port, state, &text);
                if let (Some(table), Some(of)) = (self.table.as_mut(), HostPort::from_number(port))
                {
                    table.set_port(of, state != LineState::Down);
                }
                if let Some(port) = self.port_mut(port) {
                    port.state = state;
                    port.text = text;
                }
                self.log_findings();
            }
            DdcNews::Read {
                id,
                unit,
                outcome,
                text,
                request,
                response,
                at_us,
                bus: _,
            } => {
                let (request, response) = (bytes_of(&request), bytes_of(&response));
                if let Some(unit) = self.unit_mut(unit) {
                    let number = unit.info.unit;
                    unit.image.absorb(&request, &response, Micros::new(at_us));
                    unit.counted(&request, &response, &text, at_us);
                    self.log_bits(number);
                }
                let both = self.asked.iter_mut().chain(self.watched.as_mut());
                for asked in both.filter(|a| a.id == id) {
                    asked.end = Some((outcome, text.clone()));
                }
            }
            DdcNews::Poll { .. } => {}
        }
    }

    /// A whole pass on a port is over. If nothing changed in it, it bears out every fault there.
    /// News of single units do not: of several polls only the newest may have come here.
    fn bear_out(&mut self, port: u8) {
        let quiet = core::mem::replace(&mut self.quiet, true);
        let (Some(table), Some(of)) = (&mut self.table, HostPort::from_number(port)) else {
            return;
        };
        for unit in self.units.iter().filter(|_| quiet) {
            let at = usize::from(port).saturating_sub(1);
            if let Some(Some(failed)) = unit.fault.get(at) {
                table.note(unit.info.unit, of, *failed);
            }
        }
    }

    /// Takes faults into the table: that of the port that was polled, and the other one if it is
    /// news.
    fn note(&mut self, unit: u8, port: u8, faults: [Option<bool>; 2]) {
        let Some(table) = &mut self.table else {
            return;
        };
        for (of, fault) in HostPort::BOTH.into_iter().zip(faults) {
            let Some(failed) = fault else { continue };
            let news = table.fault(unit, of) != Some(failed);
            if of.number() == port || news {
                table.note(unit, of, failed);
            }
            self.quiet &= !news;
        }
    }

    /// Takes the fault bits of a unit into the log.
    fn log_bits(&mut self, unit: u8) {
        if let Some(unit) = self.units.iter().find(|u| u.info.unit == unit) {
            self.log.bits(unit.info.unit, unit.device, &unit.image);
        }
    }

    /// Takes what the pattern of faults means into the log, if every poll bears it out.
    fn log_findings(&mut self) {
        if let Some(diagnosis) = self.diagnosis().filter(|d| d.unsettled == 0) {
            self.log.findings(&diagnosis);
        }
    }

    /// How long the longest pass takes, as measured or as expected, in microseconds; 0 if that is
    /// not known.
    #[must_use]
    pub fn pass_us(&self) -> u64 {
        let each = self.ports.iter().filter_map(|port| port.pass);
        each.map(|(took, expected)| took.max(expected))
            .max()
            .unwrap_or(0)
    }

    /// How old a value may be to rely on, in microseconds: two passes, and at least ten seconds.
    #[must_use]
    pub fn values_last_us(&self) -> u64 {
        self.pass_us().saturating_mul(2).max(10_000_000)
    }

    /// How much older than the newest answer of a unit a fault bit may be to count, in
    /// microseconds: three passes, and at least fifteen seconds.
    #[must_use]
    pub fn bits_last_us(&self) -> u64 {
        self.pass_us().saturating_mul(3).max(15_000_000)
    }

    /// The page of a unit reads what the polls leave out; `false` if such a read is under way.
    pub fn watch(&mut self, id: u32, unit: u8) -> bool {
        let waits = |a: &Asked| a.unit == unit && a.end.is_none();
        if self.watched.as_ref().is_some_and(waits) {
            return false;
        }
        self.watched = Some(Asked {
            id,
            unit,
            end: None,
        });
        true
    }

    /// What the pattern of faults means; `None` before the backend told of the network.
    #[must_use]
    pub fn diagnosis(&self) -> Option<Diagnosis> {
        findings(self.shape?, self.table.as_ref()?)
    }

    /// A read of a unit was asked for.
    pub fn ask(&mut self, id: u32, unit: u8) {
        self.asked = Some(Asked {
            id,
            unit,
            end: None,
        });
    }

    /// Counters of a unit were asked for.
    pub fn ask_counters(&mut self, unit: u8) {
        if let Some(unit) = self.unit_mut(unit) {
            let asked = counters::READS.map(|sub| (sub, Counted::Asked));
            unit.counters.extend(asked);
        }
    }

    /// The connection is lost: what was asked will not be answered.
    pub fn lost(&mut self) {
        for counted in self.units.iter_mut().flat_map(|u| u.counters.values_mut()) {
            if *counted == Counted::Asked {
                *counted = Counted::Failed("the connection to the bridge was lost".to_owned());
            }
        }
        if self.shape.is_some() {
            self.log.lost();
        }
        self.watched = None;
        if let Some(asked) = self.asked.as_mut().filter(|a| a.end.is_none()) {
            let words = "The connection to the bridge was lost.";
            asked.end = Some((Outcome::Down, words.to_owned()));
        }
    }

    /// Where a unit is along the cable, from 0.
    #[must_use]
    pub fn place(&self, unit: u8) -> Option<usize> {
        self.units.iter().position(|u| u.info.unit == unit)
    }

    fn unit_mut(&mut self, unit: u8) -> Option<&mut Unit> {
        self.units.iter_mut().find(|u| u.info.unit == unit)
    }

    fn port_mut(&mut self, port: u8) -> Option<&mut Port> {
        let at = usize::from(port).checked_sub(1)?;
        self.ports.get_mut(at)
    }
}
