//! A network as the backend tells of it: how it is made up, what the last poll of each unit brought,
//! how the passes go.

#[cfg(test)]
pub(crate) mod tests;

use std::collections::BTreeMap;

use shared::capture::Micros;
use shared::ddc100::diagnosis::Diagnosis;
use shared::ddc100::scaling::Scaling;
use shared::ddc100::{counters, follow::Follower};
use shared::device::Device;
use shared::image::Image;
use shared::proto::{DdcNews, DdcShape, DdcUnit, LineState, Outcome};

use super::findings::findings;
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

/// Which host ports reach a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Every port that there is.
    Full,
    /// Only this one of two.
    Only(u8),
    /// None: the unit is off-line.
    Lost,
    /// This port reaches it or not; the other one was not tried yet.
    Half(u8, bool),
    /// Not tried yet.
    Unknown,
}

impl Reach {
    /// In words, as the state of a unit.
    #[must_use]
    pub const fn words(self, ports: usize) -> &'static str {
        match (self, ports) {
            (Self::Full, 2..) => "answers on both ports",
            (Self::Full, _) => "answers",
            (Self::Only(1), _) => "answers on port 1 only",
            (Self::Only(_), _) => "answers on port 2 only",
            (Self::Lost, 2..) => "no answer on either port",
            (Self::Lost, _) => "no answer",
            (Self::Half(1, true), _) => "answers on port 1, port 2 not tried yet",
            (Self::Half(_, true), _) => "answers on port 2, port 1 not tried yet",
            (Self::Half(1, false), _) => "no answer on port 1, port 2 not tried yet",
            (Self::Half(_, false), _) => "no answer on port 2, port 1 not tried yet",
            (Self::Unknown, _) => "not tried yet",
        }
    }
}

/// Which ports reach a unit whose faults on port 1 and 2 are these.
#[must_use]
pub const fn reach(fault: [Option<bool>; 2], ports: usize) -> Reach {
    if ports < 2 {
        return match fault[0] {
            None => Reach::Unknown,
            Some(false) => Reach::Full,
            Some(true) => Reach::Lost,
        };
    }
    match fault {
        [None, None] => Reach::Unknown,
        [Some(false), Some(false)] => Reach::Full,
        [Some(false), Some(true)] => Reach::Only(1),
        [Some(true), Some(false)] => Reach::Only(2),
        [Some(true), Some(true)] => Reach::Lost,
        [Some(fault), None] => Reach::Half(1, !fault),
        [None, Some(fault)] => Reach::Half(2, !fault),
    }
}

/// A unit.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Address, kind, tag and description, as configured.
    pub info: DdcUnit,
    /// Its kind.
    pub device: Device,
    /// Its registers as last read.
    pub image: Image,
    /// How the last poll ended; `None` before the first.
    pub outcome: Option<Outcome>,
    /// The same in words; empty if it was good.
    pub text: String,
    /// Host port of the last poll.
    pub port: u8,
    /// Fault on host port 1 and 2, as the host found it; `None` where it was not tried.
    pub fault: [Option<bool>; 2],
    /// When the last good answer came, in microseconds of the backend.
    pub at: Option<u64>,
    /// How long it took, in microseconds.
    pub took: Option<u64>,
    /// Counters of function 08 that were asked for, by their sub-function.
    pub counters: BTreeMap<u16, Counted>,
}

/// A counter that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Counted {
    /// No answer yet.
    Asked,
    /// Its value, and when it came, in microseconds of the backend.
    Value(u16, u64),
    /// Why it could not be read.
    Failed(String),
}

impl Unit {
    fn new(info: DdcUnit) -> Self {
        Self {
            device: Device::from_key(&info.kind).unwrap_or_default(),
            info,
            image: Image::new(),
            outcome: None,
            text: String::new(),
            port: 0,
            fault: [None; 2],
            at: None,
            took: None,
            counters: BTreeMap::new(),
        }
    }

    /// Takes the answer to a counter in, or why there is none.
    fn counted(&mut self, request: &[u8], response: &[u8], text: &str, at_us: u64) {
        let &[8, high, low, ..] = request else {
            return;
        };
        let sub = u16::from_be_bytes([high, low]);
        let counted = match counters::answer(request, response) {
            Some(counter) => Counted::Value(counter.value, at_us),
            None => Counted::Failed(text.to_owned()),
        };
        self.counters.insert(sub, counted);
    }

    /// Which of so many ports reach it.
    #[must_use]
    pub const fn reach(&self, ports: usize) -> Reach {
        reach(self.fault, ports)
    }

    /// How its analog values are scaled: as chosen here, else as the tag list of the bridge says,
    /// else in percent.
    #[must_use]
    pub fn scaling(&self, chosen: Option<Scaling>) -> Scaling {
        let listed = || Scaling::from_key(self.info.scaling.as_deref()?);
        chosen.or_else(listed).unwrap_or_default()
    }

    /// Its tag, or its address if it has none.
    #[must_use]
    pub fn name(&self) -> String {
        if self.info.tag.is_empty() {
            format!("unit {}", self.info.unit)
        } else {
            self.info.tag.clone()
        }
    }
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
    /// What to look at although the network is polled.
    pub hint: Option<String>,
    /// The faults, as they came in, which tells whether they belong together.
    faults: Option<Follower>,
    /// Number of the last whole pass; 0 before the first.
    pub passes: u64,
    /// The read that was asked for last.
    pub asked: Option<Asked>,
}

impl Net {
    /// Takes news in. Those about a unit or a port that is not of this network are left out.
    pub fn hear(&mut self, news: DdcNews) {
        if let Some(faults) = &mut self.faults {
            faults.hear(&news);
        }
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
                hint,
                bus: _,
            } => {
                let port = |line| Port {
                    line,
                    state: LineState::Starting,
                    text: String::new(),
                    pass: None,
                };
                let faults = Follower::new(units.iter().map(|u| u.unit), ports.len() > 1);
                *self = Self {
                    hint,
                    faults: Some(faults),
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
                    passes: 0,
                    asked: self.asked.take(),
                };
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
                if let Some(port) = self.port_mut(port) {
                    port.pass = Some((took_us, expected_us));
                }
            }
            DdcNews::Port {
                port, state, text, ..
            } => {
                if let Some(port) = self.port_mut(port) {
                    port.state = state;
                    port.text = text;
                }
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
                    unit.image.absorb(&request, &response, Micros::new(at_us));
                    unit.counted(&request, &response, &text, at_us);
                }
                if let Some(asked) = self.asked.as_mut().filter(|a| a.id == id) {
                    asked.end = Some((outcome, text));
                }
            }
            DdcNews::Poll { .. } => {}
        }
    }

    /// What the pattern of faults means; `None` before the backend told of the network.
    #[must_use]
    pub fn diagnosis(&self) -> Option<Diagnosis> {
        findings(self.shape?, self.faults.as_ref()?.table())
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
