//! A simulated DDC-100 network: a cable with up to 250 field units of mixed types between two
//! ports of a host.
//!
//! A request goes in at a port with the time; what comes out is the answer of the unit that it
//! reached, and how long that unit took by table 4.1 of the guide, without the characters on the
//! wire, which the line of the host adds. Which units a request reaches depends on the cable: a
//! break or a short cuts it, a unit without power passes it on through its bypass relays.
//!
//! It shares the facts of the maps with the decoder, but no code with it or with the poller.
//!
//! Source: FCD LMAIM4019-00 (9/04), sections 3 and 4.

mod answer;
mod cable;
mod drive;
mod senses;
#[cfg(test)]
mod tests;
mod trouble;
mod unit;

use crate::capture::Micros;
use crate::ddc100::HostPort;
use crate::ddc100::setup::Member;
use crate::proto::DdcShape;
use cable::Cable;
use unit::Unit;

pub use trouble::{Trouble, UnitTrouble};

/// A simulated network.
#[derive(Clone, Debug)]
pub struct Loop {
    cable: Cable,
    units: Vec<Unit>,
    troubles: Vec<Trouble>,
    now: Micros,
}

/// The answer of a unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// From the end of the request to the first character of the answer, in microseconds.
    pub after_us: u64,
    /// The answer.
    pub pdu: Vec<u8>,
}

impl Loop {
    /// A network that was just switched on: valves closed, all in REMOTE, no fault. Units are in
    /// the order of the cable, from host port 1.
    #[must_use]
    pub fn new(shape: DdcShape, members: &[Member]) -> Self {
        Self {
            cable: Cable::new(shape, members.len()),
            units: members.iter().map(|m| Unit::new(*m)).collect(),
            troubles: Vec::new(),
            now: Micros::new(0),
        }
    }

    /// Lets time go on. A time before the last one changes nothing.
    pub fn advance(&mut self, now: Micros) {
        self.now = self.now.max(now);
        for unit in &mut self.units {
            unit.advance(self.now);
        }
    }

    /// True if a unit takes in what reaches it: it has power and its own address, and is in no
    /// reset.
    #[must_use]
    pub fn listens(&self, unit: u8) -> bool {
        let mut all = self.units.iter();
        all.any(|it| it.address() == unit && it.hears())
    }

    /// A request at a host port; `now` is the end of its last character. `None` if nobody answers:
    /// the unit is not there, not reached, without power or resetting, or the request was for all
    /// (unit 0), which every unit that it reaches carries out.
    pub fn request(&mut self, port: HostPort, unit: u8, pdu: &[u8], now: Micros) -> Option<Answer> {
        self.now = self.now.max(now);
        let mut answer = None;
        for it in self.hearing(port) {
            it.noticed();
            let meant = unit == 0 || unit == it.address();
            if !meant {
                continue;
            }
            let said = it.request(port, pdu, now);
            if unit != 0 {
                answer = said;
            }
        }
        answer
    }

    /// A frame at a host port whose check does not hold; every unit that it reaches counts it, and
    /// none answers.
    pub fn damaged(&mut self, port: HostPort, now: Micros) {
        self.now = self.now.max(now);
        self.hearing(port).for_each(Unit::damaged);
    }

    /// Those that take in what comes from a port now.
    fn hearing(&mut self, port: HostPort) -> impl Iterator<Item = &mut Unit> {
        let reached = self.units.get_mut(self.cable.reached(port));
        let now = self.now;
        reached.into_iter().flatten().filter_map(move |it| {
            it.advance(now);
            it.hears().then_some(it)
        })
    }

    /// From now on the inputs of I/O modules change with time, so that there is something to see.
    pub fn set_lively(&mut self) {
        self.units.iter_mut().for_each(Unit::set_lively);
    }

    /// Brings a trouble about. False if it is there already or the network has no such unit or
    /// place, or the unit is of a type that knows no such trouble.
    pub fn inject(&mut self, trouble: Trouble) -> bool {
        if self.troubles.contains(&trouble) || !self.set(trouble, true) {
            return false;
        }
        self.troubles.push(trouble);
        true
    }

    /// Ends a trouble. False if it was not there.
    pub fn heal(&mut self, trouble: Trouble) -> bool {
        let before = self.troubles.len();
        self.troubles.retain(|t| *t != trouble);
        self.troubles.len() != before && self.set(trouble, false)
    }

    /// All troubles that are there now.
    #[must_use]
    pub fn troubles(&self) -> &[Trouble] {
        &self.troubles
    }

    fn set(&mut self, trouble: Trouble, on: bool) -> bool {
        match trouble {
            Trouble::Break(place) => self.cable.set_break(place, on),
            Trouble::Short(place) => self.cable.set_short(place, on),
            Trouble::Port(port) => {
                self.cable.set_dead(port, on);
                true
            }
            Trouble::Unit(unit, what) => {
                let now = self.now;
                let it = self.units.iter_mut().find(|u| u.address() == unit);
                it.is_some_and(|it| {
                    it.advance(now);
                    it.knows(what) && {
                        it.set(what, on);
                        true
                    }
                })
            }
        }
    }
}
