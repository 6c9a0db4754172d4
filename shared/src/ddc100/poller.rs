//! Who is polled next, through which port.
//!
//! The rules, by the guide (section 4.3) where it says them:
//!
//! - **P1** Without a fault all units are polled through port 1, then all through port 2, and so on.
//! - **P2** A good answer clears the fault of that unit on that port.
//! - **P3** A failed poll sets it, and the same unit is tried through the other port.
//! - **P4** If that fails too, the other fault is set, and polling goes on at the original port.
//! - **P5** If it succeeds, the other fault is cleared and the answer is the unit's data.
//! - **P6** Then too the next unit is polled at the original port (not stated; follows from P1).
//! - **P7** Retries are spent on the same port before P3 (not stated), at most three. Where a fault is
//!   known already there are none, unless [`Setup::retry_faulty`] wants them.
//! - **P8** A unit that is off is tried on each pass, on both ports, until it answers.
//!
//! Between two exchanges there is room for something else ([`Poller::ask`]): at most one between
//! two polls, so that nobody starves. A port that the host lost is left out until it is back.

use std::collections::VecDeque;

use super::faults::FaultTable;
use super::setup::{Member, Setup};
use super::{HostPort, Pair, estimate};
use crate::capture::Micros;
use crate::proto::Outcome;

/// Other requests that may wait at once.
pub const MOST_WAITING: usize = 64;

/// A poll to be sent: [`Setup::read`] of a unit through a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Poll {
    /// The unit.
    pub member: Member,
    /// The port.
    pub port: HostPort,
    /// 0 for the first time on this port, then how often it was repeated.
    pub repeat: u8,
    /// How long to wait for the answer, in microseconds from the end of the request to the last
    /// character of the answer.
    pub timeout_us: u64,
}

/// A request beside the polls, for example one more read for a page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Other {
    /// Chosen by the owner, who keeps what is to be sent.
    pub id: u64,
    /// The unit.
    pub unit: u8,
}

/// What the owner is to do now.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Send a poll, then tell [`Poller::done`] how it ended.
    Poll(Poll),
    /// Send another request through this port, then tell [`Poller::done`] how it ended.
    Other(Other, HostPort),
    /// Ask again at this time: the turn time is not over.
    Wait(Micros),
    /// An exchange is under way: tell [`Poller::done`] first.
    Busy,
    /// No port is there: ask again when [`Poller::set_port`] was told of one.
    Idle,
}

/// A whole pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pass {
    /// The port on which it was made; units that failed there were tried on the other one too.
    pub port: HostPort,
    /// Passes since the start, this one counted.
    pub number: u64,
    /// From its first request to the end of its last exchange, in microseconds.
    pub took_us: u64,
    /// What it should take without a fault, in microseconds; see [`Poller::expected_us`].
    pub expected_us: u64,
}

/// How an exchange ended, and what follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Done {
    /// What was sent; `None` if nothing was under way.
    pub sent: Option<Sent>,
    /// How it ended.
    pub outcome: Outcome,
    /// From the call of [`Poller::next`] to the end, in microseconds.
    pub took_us: u64,
    /// False if the same poll is repeated on the same port, so that nothing is decided yet.
    pub decided: bool,
    /// A pass that ended with it.
    pub pass: Option<Pass>,
}

/// What was sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sent {
    /// A poll.
    Poll(Poll),
    /// Another request.
    Other(Other, HostPort),
}

/// Why another request was not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AskRefused {
    /// The network has no such unit.
    NoSuchUnit,
    /// Too many wait already.
    Full,
}

/// Polls a network by the rules P1 to P8.
#[derive(Clone, Debug)]
pub struct Poller {
    setup: Setup,
    faults: FaultTable,
    up: Pair<bool>,
    /// The unit whose turn it is, by its place on the cable.
    place: usize,
    /// Port of this pass.
    port: HostPort,
    /// True while the unit is tried through the other port.
    detour: bool,
    repeat: u8,
    flight: Option<(Sent, Micros)>,
    /// When the turn time is over.
    free: Micros,
    waiting: VecDeque<Other>,
    /// True if the last thing sent was another request.
    others_turn_over: bool,
    passes: u64,
    pass_began: Option<Micros>,
    last: Option<Pass>,
}

impl Poller {
    /// A poller that begins with the first unit on port 1. Look at [`Setup::problems`] before.
    #[must_use]
    pub fn new(setup: Setup) -> Self {
        let faults = FaultTable::new(setup.units.iter().map(|m| m.unit), setup.second);
        Self {
            up: Pair {
                one: true,
                two: setup.second,
            },
            setup,
            faults,
            place: 0,
            port: HostPort::One,
            detour: false,
            repeat: 0,
            flight: None,
            free: Micros::new(0),
            waiting: VecDeque::new(),
            others_turn_over: false,
            passes: 0,
            pass_began: None,
            last: None,
        }
    }

    /// The set-up.
    #[must_use]
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// The faults of all units on both ports.
    #[must_use]
    pub const fn faults(&self) -> &FaultTable {
        &self.faults
    }

    /// The last whole pass.
    #[must_use]
    pub const fn last_pass(&self) -> Option<Pass> {
        self.last
    }

    /// The port of the pass that is under way.
    #[must_use]
    pub const fn port(&self) -> HostPort {
        self.port
    }

    /// What a pass should take without a fault, in microseconds: for each unit the wire, its time
    /// by table 4.1, and the turn time after it, which the last one does not have.
    #[must_use]
    pub fn expected_us(&self) -> u64 {
        estimate::pass(&self.setup)
    }

    /// Takes in that a port was lost or is back. What is under way on a lost port still has to be
    /// told to [`done`](Self::done), as [`Outcome::Down`].
    pub fn set_port(&mut self, port: HostPort, up: bool) {
        if !self.setup.has(port) {
            return;
        }
        self.up.set(port, up);
        self.faults.set_port(port, up);
    }

    /// Puts a request beside the polls in line.
    ///
    /// # Errors
    /// If the unit is none of the network's, or [`MOST_WAITING`] wait already.
    pub fn ask(&mut self, other: Other) -> Result<(), AskRefused> {
        if !self.setup.units.iter().any(|m| m.unit == other.unit) {
            return Err(AskRefused::NoSuchUnit);
        }
        if self.waiting.len() >= MOST_WAITING {
            return Err(AskRefused::Full);
        }
        self.waiting.push_back(other);
        Ok(())
    }

    /// Takes back what was put in line with this id and not sent yet. True if there was any.
    pub fn forget(&mut self, id: u64) -> bool {
        let before = self.waiting.len();
        self.waiting.retain(|other| other.id != id);
        self.waiting.len() != before
    }

    /// The port through which something for a unit goes now: that of the pass, or the other one if
    /// the unit has a fault there (section 4.3.1). `None` without a port.
    #[must_use]
    pub fn port_for(&self, unit: u8) -> Option<HostPort> {
        let good =
            |port: &HostPort| self.is_there(*port) && self.faults.fault(unit, *port) != Some(true);
        let both = [self.port, self.port.other()];
        let any = || both.into_iter().find(|p| self.is_there(*p));
        both.into_iter().find(good).or_else(any)
    }

    const fn is_there(&self, port: HostPort) -> bool {
        self.setup.has(port) && self.up.get(port)
    }

    /// What to do now.
    pub fn next(&mut self, now: Micros) -> Next {
        if self.flight.is_some() {
            return Next::Busy;
        }
        if now < self.free {
            return Next::Wait(self.free);
        }
        if !self.others_turn_over
            && let Some(other) = self.waiting.front().copied()
            && let Some(port) = self.port_for(other.unit)
        {
            self.waiting.pop_front();
            self.others_turn_over = true;
            self.flight = Some((Sent::Other(other, port), now));
            return Next::Other(other, port);
        }
        let Some(poll) = self.poll() else {
            return Next::Idle;
        };
        self.others_turn_over = false;
        self.pass_began.get_or_insert(now);
        self.flight = Some((Sent::Poll(poll), now));
        Next::Poll(poll)
    }

    fn poll(&mut self) -> Option<Poll> {
        let member = *self.setup.units.get(self.place)?;
        let mut port = if self.detour {
            self.port.other()
        } else {
            self.port
        };
        if !self.is_there(port) {
            // The fault of a lost port is known without a try.
            port = port.other();
            if !self.is_there(port) {
                return None;
            }
            self.repeat = 0;
            self.detour = false;
            self.port = port;
        }
        Some(Poll {
            member,
            port,
            repeat: self.repeat,
            timeout_us: self.setup.timeout(member.kind),
        })
    }

    /// Takes in how the exchange that is under way ended. An exception is an answer: the unit was
    /// reached.
    pub fn done(&mut self, outcome: Outcome, now: Micros) -> Done {
        let Some((sent, began)) = self.flight.take() else {
            return Done {
                sent: None,
                outcome,
                took_us: 0,
                decided: false,
                pass: None,
            };
        };
        self.free = now.plus(self.setup.turn_us);
        let mut done = Done {
            sent: Some(sent),
            outcome,
            took_us: now.since(began),
            decided: true,
            pass: None,
        };
        match sent {
            Sent::Other(_, port) if outcome == Outcome::Down => self.set_port(port, false),
            Sent::Other(..) => {}
            Sent::Poll(poll) => {
                done.decided = self.judge(poll, outcome);
                if done.decided {
                    done.pass = self.step(poll, outcome, now);
                }
            }
        }
        done
    }

    /// Sets or clears the fault. False if the poll is to be repeated (P7).
    fn judge(&mut self, poll: Poll, outcome: Outcome) -> bool {
        let unit = poll.member.unit;
        match outcome {
            Outcome::Ok | Outcome::Exception => self.faults.note(unit, poll.port, false),
            Outcome::Down => self.set_port(poll.port, false),
            // Nothing was sent, so nothing is known.
            Outcome::Refused => {}
            Outcome::Silence | Outcome::Damaged => {
                let known = self.faults.fault(unit, poll.port) == Some(true);
                let retries = match known && !self.setup.retry_faulty {
                    true => 0,
                    false => self.setup.retries,
                };
                if self.repeat < retries {
                    self.repeat = self.repeat.saturating_add(1);
                    return false;
                }
                self.faults.note(unit, poll.port, true);
            }
        }
        true
    }

    /// Goes on to the other port (P3) or to the next unit.
    fn step(&mut self, poll: Poll, outcome: Outcome, now: Micros) -> Option<Pass> {
        self.repeat = 0;
        let good = matches!(outcome, Outcome::Ok | Outcome::Exception);
        if !good && !self.detour && poll.port == self.port && self.is_there(poll.port.other()) {
            self.detour = true;
            return None;
        }
        self.detour = false;
        self.place = self.place.saturating_add(1);
        if self.place < self.setup.units.len() {
            return None;
        }
        self.place = 0;
        self.passes = self.passes.saturating_add(1);
        let began = self.pass_began.take().unwrap_or(now);
        let pass = Pass {
            port: self.port,
            number: self.passes,
            took_us: now.since(began),
            expected_us: self.expected_us(),
        };
        self.last = Some(pass);
        if self.is_there(self.port.other()) {
            self.port = self.port.other();
        }
        Some(pass)
    }
}

#[cfg(test)]
mod tests;
