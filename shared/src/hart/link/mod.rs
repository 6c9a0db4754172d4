//! The link layer of a HART master as a pure state machine: who may send when, and what answers
//! what. On top of it, [`Device`] and [`Scan`] turn devices into requests.
//!
//! # How to drive it
//!
//! ```text
//!            ask(request)                       done() ──► outcome
//!  owner ──────────────────►  Link  ◄── heard(bytes, now) ── line
//!            next(now) ──► Transmit(bytes) ────────────────► line ── sent(now) ──► Link
//!                          Wait(until) | Idle
//! ```
//!
//! - [`Link::ask`] hands over one request; while [`Link::is_busy`] no other is taken.
//! - [`Link::next`] says what to do now. `Transmit`: switch the carrier on, send these bytes, switch
//!   it off behind the last bit, and call [`Link::sent`] then. `Wait`: nothing until that moment,
//!   or until bytes come. `Idle`: nothing until something is asked or heard.
//! - [`Link::heard`] takes what comes from the line, also while we send, with the time at which it
//!   was delivered; [`Link::carrier`] what a modem says of its carrier, if it says anything.
//! - [`Link::done`] gives how the request ended, once. [`Link::event`] tells of the others.
//!
//! Look at `done` and `event` behind every other call; calling `next` more often than needed changes
//! nothing. All times are those of one clock.
//!
//! # Who may send when
//!
//! | heard last | we may begin |
//! |---|---|
//! | nothing for RT1, or a request, or something damaged | after RT1 of silence |
//! | a request, while a device bursts | after twice RT1: the burst device is first |
//! | an answer to the other master | at once, within HOLD |
//! | an answer to us | RT2 behind it, so that the other master may go first |
//! | a burst to the other master | at once, within HOLD |
//! | a burst to us, or any answer while a device bursts | after RT1: the burst device is next |
//!
//! After RT1 the turns of the two masters alternate, RT2 apart, so that two masters that waited do
//! not begin at the same moment. A master never begins while bytes or a carrier are heard. After a
//! request that failed for good it leaves the line for the RT1 of a secondary master.
//!
//! Source: the timers are those of the table of timers; which of them follows what is reading G19,
//! and agrees with the state machine (watching, enabled, using) that open implementations follow.
//!
//! # What answers
//!
//! A reply answers a request if its check byte holds, if it names the same device, master and
//! command, and if its first byte came after our first byte went out. Behind a try that was not
//! answered, the same command of the same device is not asked again before [`Link`] is certain that
//! no answer to the old one can come.

mod device;
mod ear;
mod event;
mod hear;
mod request;
#[cfg(test)]
mod tests;
mod timing;

use super::frame::Address;
use crate::capture::Micros;
pub use device::{
    Device, Identity, LAST_OF_HART_5, LAST_POLLING, LONG_TAG, Scan, Sighting, Step, TAG, Target,
    overview, reads, usual_data,
};
use ear::Ear;
pub use event::{Event, Stats};
pub use request::{Answer, Done, Failure, Request};
use std::collections::VecDeque;
pub use timing::{BATCHED_GAP, BAUD, PATIENT_GAP, Timing};

/// Tries beyond the first, as most masters have it (readings: FieldComm's server, EL6184).
pub const RETRIES: u8 = 3;
/// Characters after which a master or burst device that is not heard any more counts as gone.
const FORGET: usize = 1200;
/// Characters for which a line that is never free is waited for.
const PATIENCE: usize = 1200;
/// Events that are kept.
const EVENTS: usize = 64;

/// What a master is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Primary or secondary master.
    pub primary: bool,
    /// Tries beyond the first.
    pub retries: u8,
    /// Times of the line.
    pub timing: Timing,
}

impl Setup {
    /// A primary master of a line at 1200 bit/s that is heard character by character.
    #[must_use]
    pub fn primary() -> Self {
        Self {
            primary: true,
            retries: RETRIES,
            timing: Timing::new(BAUD, None),
        }
    }

    /// The same as a secondary master.
    #[must_use]
    pub fn secondary() -> Self {
        Self {
            primary: false,
            ..Self::primary()
        }
    }
}

/// What to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Next {
    /// Send these bytes, and say when the last bit is out.
    Transmit(Vec<u8>),
    /// Nothing until this moment.
    Wait(Micros),
    /// Nothing until something is asked or heard.
    Idle,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    Watching,
    Sending { until: Micros },
    Waiting { until: Micros },
}

/// What the last frame says about whose turn it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// Nothing.
    Unknown,
    /// Ours, from this moment on.
    Ours(Micros),
    /// The other master's first.
    Yield,
    /// Nothing, behind a request: a burst device may go on once it is not answered.
    Request,
}

#[derive(Clone, Debug)]
struct Job {
    request: Request,
    asked: Micros,
    tries: u8,
    began: Micros,
    /// A try was not answered.
    silent: bool,
}

/// A command of a device of which an answer may still come.
#[derive(Clone, Copy, Debug)]
struct Doubt {
    address: Address,
    command: u8,
    until: Micros,
}

/// The link layer of one master on one line.
#[derive(Clone, Debug)]
pub struct Link {
    setup: Setup,
    ear: Ear,
    phase: Phase,
    turn: Turn,
    /// When the line was last active: the end of what was heard or sent.
    active: Micros,
    carrier: bool,
    not_before: Micros,
    job: Option<Job>,
    done: Option<Done>,
    doubt: Option<Doubt>,
    other: Option<Micros>,
    burst: Option<Micros>,
    events: VecDeque<Event>,
    stats: Stats,
}

impl Link {
    /// A master that begins to listen now.
    #[must_use]
    pub fn new(setup: Setup, now: Micros) -> Self {
        Self {
            setup,
            ear: Ear::new(setup.timing),
            phase: Phase::Watching,
            turn: Turn::Unknown,
            active: now,
            carrier: false,
            not_before: now,
            job: None,
            done: None,
            doubt: None,
            other: None,
            burst: None,
            events: VecDeque::new(),
            stats: Stats::default(),
        }
    }

    /// What this master is.
    #[must_use]
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// How the traffic went so far.
    #[must_use]
    pub const fn stats(&self) -> &Stats {
        &self.stats
    }

    /// True if another master was heard lately.
    #[must_use]
    pub fn hears_other_master(&self, now: Micros) -> bool {
        self.lately(self.other, now)
    }

    /// True if a burst was heard lately.
    #[must_use]
    pub fn hears_bursts(&self, now: Micros) -> bool {
        self.lately(self.burst, now)
    }

    fn lately(&self, at: Option<Micros>, now: Micros) -> bool {
        at.is_some_and(|at| now.since(at) < self.setup.timing.characters(FORGET))
    }

    /// True while a request is under way or its outcome was not taken.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        self.job.is_some() || self.done.is_some()
    }

    /// Hands a request over; gives it back if another one is under way.
    ///
    /// # Errors
    /// If the link [is busy](Self::is_busy).
    pub fn ask(&mut self, request: Request, now: Micros) -> Result<(), Request> {
        if self.is_busy() {
            return Err(request);
        }
        if let Some(doubt) = self.doubt
            && (doubt.address, doubt.command) == (request.address, request.command)
        {
            self.not_before = self.not_before.max(doubt.until);
        }
        self.job = Some(Job {
            request,
            asked: now,
            tries: 0,
            began: now,
            silent: false,
        });
        Ok(())
    }

    /// How the request ended, once.
    pub fn done(&mut self) -> Option<Done> {
        self.done.take()
    }

    /// The next event that was not taken yet.
    pub fn event(&mut self) -> Option<Event> {
        self.events.pop_front()
    }

    fn tell(&mut self, event: Event) {
        if self.events.len() >= EVENTS {
            self.events.pop_front();
        }
        self.events.push_back(event);
    }

    /// A modem says whether it hears a carrier; lines without one never call this.
    pub fn carrier(&mut self, on: bool, now: Micros) {
        if !on
            && self.carrier
            && self.active < now
            && matches!(self.turn, Turn::Unknown | Turn::Request)
        {
            self.active = now;
        }
        self.carrier = on;
    }

    /// Bytes were delivered, the last of them now.
    pub fn heard(&mut self, bytes: &[u8], now: Micros) {
        if bytes.is_empty() {
            return;
        }
        let mut heard = Vec::new();
        self.ear.hear(bytes, now, &mut heard);
        if !matches!(self.phase, Phase::Sending { .. }) {
            self.active = self.active.max(now);
        }
        heard.into_iter().for_each(|h| self.consider(h, now));
    }

    /// The last bit of what was to be sent is out.
    pub fn sent(&mut self, now: Micros) {
        self.active = self.active.max(now);
        if let Phase::Sending { .. } = self.phase {
            // Longer than the slave time-out, for both kinds of master.
            let wait = self.setup.timing.quiet_primary;
            self.phase = Phase::Waiting {
                until: now.plus(wait),
            };
        }
    }

    /// What to do now.
    pub fn next(&mut self, now: Micros) -> Next {
        let mut heard = Vec::new();
        self.ear.listen(now, &mut heard);
        heard.into_iter().for_each(|h| self.consider(h, now));
        match self.phase {
            Phase::Sending { until } => {
                if now < until {
                    return Next::Wait(until);
                }
                // Whoever sends forgot to say so.
                self.sent(until);
                self.next(now)
            }
            Phase::Waiting { until } => {
                let patience = self.setup.timing.characters(PATIENCE);
                match self.busy_until(now) {
                    Some(at) if now.since(until) < patience => return Next::Wait(at),
                    _ if now < until => return Next::Wait(until),
                    _ => {}
                }
                self.stats.silent = self.stats.silent.saturating_add(1);
                self.missed(Failure::Silence, now);
                self.next(now)
            }
            Phase::Watching => self.watch(now),
        }
    }

    /// When something that is being heard will be over; `None` if the line is silent.
    fn busy_until(&self, now: Micros) -> Option<Micros> {
        let carrier = self.carrier.then(|| now.plus(self.setup.timing.character));
        self.ear.quiet_at().max(carrier)
    }

    fn watch(&mut self, now: Micros) -> Next {
        let Some(job) = &self.job else {
            return self.ear.quiet_at().map_or(Next::Idle, Next::Wait);
        };
        let patience = self.setup.timing.characters(PATIENCE);
        if now.since(job.asked.max(job.began)) > patience && now.since(self.not_before) > patience {
            self.finish(Err(Failure::Crowded), now);
            return Next::Idle;
        }
        if let Some(at) = self.busy_until(now) {
            return Next::Wait(at);
        }
        let start = self.start(now);
        if now < start {
            return Next::Wait(start);
        }
        self.transmit(now)
    }

    /// When we may begin, at the earliest now.
    fn start(&self, now: Micros) -> Micros {
        let timing = &self.setup.timing;
        let now = now.max(self.not_before);
        let window = |from: Micros, len: u64| {
            let start = now.max(from);
            (start.since(from) <= len).then_some(start)
        };
        let early = match self.turn {
            Turn::Ours(from) => {
                let from = from.max(self.active).plus(timing.turn());
                let left = timing.window().saturating_sub(timing.turn());
                window(from, left)
            }
            Turn::Yield if !self.hears_bursts(now) => {
                window(self.active.plus(timing.link_grant), timing.window())
            }
            Turn::Yield | Turn::Unknown | Turn::Request => None,
        };
        if let Some(start) = early {
            return start;
        }
        // The turns of the two masters alternate.
        let mut quiet = timing.quiet(self.setup.primary);
        if self.turn == Turn::Request && self.hears_bursts(now) {
            quiet = quiet.saturating_mul(2);
        }
        let first = self.active.plus(quiet);
        let round = timing.link_grant.saturating_mul(2).max(1);
        let passed = now.since(first).checked_div(round).unwrap_or(0);
        let turn = first.plus(passed.saturating_mul(round));
        window(turn, timing.window()).unwrap_or_else(|| turn.plus(round))
    }

    fn transmit(&mut self, now: Micros) -> Next {
        let Some(job) = &mut self.job else {
            return Next::Idle;
        };
        let bytes = job.request.bytes(self.setup.primary);
        if job.tries > 0 {
            self.stats.retried = self.stats.retried.saturating_add(1);
        }
        job.tries = job.tries.saturating_add(1);
        job.began = now;
        self.stats.sent = self.stats.sent.saturating_add(1);
        let timing = &self.setup.timing;
        // So long it takes, and an answer would be given up soon after.
        let longest = timing
            .characters(bytes.len())
            .saturating_mul(2)
            .saturating_add(timing.quiet_secondary);
        self.turn = Turn::Request;
        self.phase = Phase::Sending {
            until: now.plus(longest),
        };
        Next::Transmit(bytes)
    }

    /// A try brought no answer.
    fn missed(&mut self, why: Failure, now: Micros) {
        self.phase = Phase::Watching;
        let Some(job) = &mut self.job else {
            return;
        };
        job.silent |= why == Failure::Silence;
        if job.tries > self.setup.retries {
            let timing = &self.setup.timing;
            let free = timing.quiet_secondary.saturating_add(timing.window());
            self.not_before = self.active.plus(free);
            self.finish(Err(why), now);
        }
    }

    fn finish(&mut self, outcome: Result<Answer, Failure>, now: Micros) {
        self.phase = Phase::Watching;
        let Some(job) = self.job.take() else {
            return;
        };
        self.doubt = job.silent.then(|| Doubt {
            address: job.request.address,
            command: job.request.command,
            until: now.plus(self.setup.timing.quiet_secondary.saturating_mul(2)),
        });
        self.done = Some(Done {
            request: job.request.frame(self.setup.primary),
            outcome,
            tries: job.tries,
            began: job.began,
            ended: now,
        });
    }
}
