//! One line that several parties share, character by character.

use super::characters;
use crate::capture::Micros;
use std::collections::VecDeque;

/// A character as a receiver gets it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Character {
    /// Its eight bits.
    pub byte: u8,
    /// False if its parity or framing was wrong, as after a collision.
    pub sound: bool,
}

impl Character {
    /// A character without fault.
    #[must_use]
    pub const fn of(byte: u8) -> Self {
        Self { byte, sound: true }
    }
}

/// Whoever is on a line: a device, a master, an end of a cable.
///
/// A party that sends hears nothing meanwhile: the line is half duplex.
pub trait Party {
    /// A character of somebody else ended at this time.
    fn hear(&mut self, character: Character, at: Micros);

    /// Somebody else's carrier came up (`true`), or went away.
    fn carrier(&mut self, on: bool, at: Micros) {
        let _ = (on, at);
    }

    /// When it wants to be asked to [`act`](Self::act), if nothing comes before.
    fn due(&self) -> Option<Micros>;

    /// Its time has come. What it begins to send now, if anything; empty is nothing.
    fn act(&mut self, now: Micros) -> Option<Vec<u8>>;

    /// The last character that it had has ended: what it goes on with, without a gap.
    fn more(&mut self, now: Micros) -> Option<Vec<u8>> {
        let _ = now;
        None
    }

    /// The last character that it sent has ended.
    fn sent(&mut self, at: Micros) {
        let _ = at;
    }
}

/// Two parties that sent at the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Collision {
    /// When the second began.
    pub at: Micros,
    /// Who sent already.
    pub first: usize,
    /// Who began although the line was busy.
    pub second: usize,
}

/// A transmission that is over.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sent {
    /// Who sent.
    pub party: usize,
    /// When the first character began.
    pub begin: Micros,
    /// When the last one ended.
    pub end: Micros,
    /// The characters.
    pub bytes: Vec<u8>,
    /// True if it collided with another.
    pub collided: bool,
}

#[derive(Clone, Debug)]
struct Flight {
    party: usize,
    begin: Micros,
    /// When the character that is on the line began.
    character: Micros,
    left: VecDeque<u8>,
    bytes: Vec<u8>,
    /// The character on the line overlaps another.
    spoilt: bool,
    collided: bool,
}

/// The line.
#[derive(Clone, Debug)]
pub struct Medium {
    baud: u32,
    now: Micros,
    flights: Vec<Flight>,
    collisions: Vec<Collision>,
    history: VecDeque<Sent>,
    kept: usize,
    /// Parties whose time had come without anything to send, and when.
    idle: Vec<Option<Micros>>,
}

impl Medium {
    /// A quiet line. The last `kept` transmissions can be looked at.
    #[must_use]
    pub const fn new(baud: u32, kept: usize) -> Self {
        Self {
            baud,
            now: Micros::new(0),
            flights: Vec::new(),
            collisions: Vec::new(),
            history: VecDeque::new(),
            kept,
            idle: Vec::new(),
        }
    }

    /// All collisions so far.
    #[must_use]
    pub fn collisions(&self) -> &[Collision] {
        &self.collisions
    }

    /// The last transmissions, oldest first.
    pub fn history(&self) -> impl Iterator<Item = &Sent> {
        self.history.iter()
    }

    /// True if nobody sends.
    #[must_use]
    pub fn is_quiet(&self) -> bool {
        self.flights.is_empty()
    }

    /// Until when time went on.
    #[must_use]
    pub const fn now(&self) -> Micros {
        self.now
    }

    /// When something happens next, if nothing comes from outside.
    #[must_use]
    pub fn next(&self, parties: &[&mut dyn Party]) -> Option<Micros> {
        let ends = self.flights.iter().map(|f| self.end(f));
        let dues = parties.iter().enumerate().filter_map(|(at, party)| {
            let sends = self.flights.iter().any(|f| f.party == at);
            let due = party.due().filter(|_| !sends)?;
            // A party that had nothing to send is not asked again at the same time.
            let asked = self.idle.get(at).copied().flatten();
            let after = asked.map_or(due, |asked| due.max(later(asked, 1)));
            Some(after.max(self.now))
        });
        ends.chain(dues).min()
    }

    fn end(&self, flight: &Flight) -> Micros {
        later(flight.character, characters(1, self.baud))
    }

    /// Lets time go on until `until`. The parties are the same and in the same order each time.
    pub fn run(&mut self, parties: &mut [&mut dyn Party], until: Micros) {
        self.idle.resize(parties.len(), None);
        while let Some(at) = self.next(parties).filter(|at| *at <= until) {
            self.now = self.now.max(at);
            self.deliver(parties);
            self.ask(parties);
        }
        self.now = self.now.max(until);
    }

    /// Characters that end now reach all who listen.
    fn deliver(&mut self, parties: &mut [&mut dyn Party]) {
        let char_us = characters(1, self.baud);
        let now = self.now;
        let shared = self.flights.len() > 1;
        let senders: Vec<usize> = self.flights.iter().map(|f| f.party).collect();
        let mut over = Vec::new();
        for flight in &mut self.flights {
            if later(flight.character, char_us) > now {
                continue;
            }
            let Some(byte) = flight.left.pop_front() else {
                continue;
            };
            flight.bytes.push(byte);
            let character = Character {
                byte,
                sound: !flight.spoilt,
            };
            for (at, party) in parties.iter_mut().enumerate() {
                if !senders.contains(&at) {
                    party.hear(character, now);
                }
            }
            flight.character = now;
            flight.spoilt = shared;
            if flight.left.is_empty()
                && let Some(more) = parties.get_mut(flight.party).and_then(|p| p.more(now))
            {
                flight.left.extend(more);
            }
            if flight.left.is_empty() {
                over.push(flight.party);
            }
        }
        for party in over {
            self.finish(party, parties);
        }
    }

    fn finish(&mut self, party: usize, parties: &mut [&mut dyn Party]) {
        let Some(at) = self.flights.iter().position(|f| f.party == party) else {
            return;
        };
        let flight = self.flights.swap_remove(at);
        let now = self.now;
        if self.kept > 0 {
            if self.history.len() >= self.kept {
                self.history.pop_front();
            }
            self.history.push_back(Sent {
                party,
                begin: flight.begin,
                end: now,
                bytes: flight.bytes,
                collided: flight.collided,
            });
        }
        // Who sent alone: the carrier is gone for all others.
        let quiet = self.flights.is_empty();
        for (at, other) in parties.iter_mut().enumerate() {
            if at == party {
                other.sent(now);
            } else if quiet {
                other.carrier(false, now);
            }
        }
    }

    /// Parties whose time has come may begin.
    fn ask(&mut self, parties: &mut [&mut dyn Party]) {
        let now = self.now;
        let mut begun = Vec::new();
        for (at, party) in parties.iter_mut().enumerate() {
            let sends = self.flights.iter().any(|f| f.party == at);
            if sends || party.due().is_none_or(|due| due > now) {
                continue;
            }
            match party.act(now).filter(|bytes| !bytes.is_empty()) {
                Some(bytes) => begun.push((at, bytes)),
                None => {
                    if let Some(idle) = self.idle.get_mut(at) {
                        *idle = Some(now);
                    }
                }
            }
        }
        for (at, bytes) in begun {
            for other in &mut self.flights {
                self.collisions.push(Collision {
                    at: now,
                    first: other.party,
                    second: at,
                });
                other.spoilt = true;
                other.collided = true;
            }
            let collided = !self.flights.is_empty();
            self.flights.push(Flight {
                party: at,
                begin: now,
                character: now,
                left: bytes.into(),
                bytes: Vec::new(),
                spoilt: collided,
                collided,
            });
            for (other, party) in parties.iter_mut().enumerate() {
                if other != at && !collided {
                    party.carrier(true, now);
                }
            }
        }
    }
}

/// A time so many microseconds later.
pub(super) fn later(at: Micros, us: u64) -> Micros {
    Micros::new(at.get().saturating_add(us))
}
