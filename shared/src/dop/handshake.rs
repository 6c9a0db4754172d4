//! One object read as a state machine: at the first time look at the status, write the request, poll the status until it is ready or in
//! error for *this* object, read the count, read the data in blocks, look at the status once more.
//!
//! The machine does no I/O and reads no clock. Whoever drives it asks [`Handshake::next`] what to
//! do, does it, and says what came of it with [`Handshake::reply`].
//!
//! # What can go wrong, and what is done
//!
//! | seen | done |
//! |---|---|
//! | the status names another object | it is another master's, or ours was not taken up: wait, ask again |
//! | the status changed while the data were read | the data may be mixed: ask again |
//! | it was ready at once, and is busy behind the data | the answer was an old one: go on waiting |
//! | the status stays busy, or undefined | give up after the time-out and say so |
//! | the write was not answered | look at the status: it may have arrived all the same |
//! | error 4, 10 or 11: the device is busy inside | ask again |
//! | any other error, exception or silence | the read has failed, with the reason in words |
//!
//! The object is the only mark that the status carries. Another master's request for another
//! option of the *same* object, begun and finished between two looks, can't be told from ours.

mod course;
mod look;
mod setup;
pub mod status;
#[cfg(test)]
mod tests;
mod why;

use super::Request;
use crate::address::Address;
use crate::capture::Micros;
use crate::encode::Read;
use crate::proto::{DopStep, Outcome};
pub use course::{Course, Next, Reply};
pub use setup::{Missing, Setup};
pub use status::{Meaning, Position, Shift, Status, error_text};
pub use why::{Area, Why};

/// Registers of the response area (AIIOM000698-01, section 2.1.5).
pub const MAX_COUNT: u16 = 512;
/// Error codes that mean "later": could not queue, link busy, board did not answer.
const LATER: [u16; 3] = [4, 10, 11];
/// Modbus exceptions that mean "later": acknowledge, server device busy.
const BUSY_EXCEPTIONS: [u8; 2] = [5, 6];
/// The first pause is the poll period, halved so often.
const FIRST_PAUSE: u32 = 3;
/// Poll periods after which a foreign or missing object id counts.
const LOOKS: u64 = 4;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    /// Nothing is known of the device: the status is looked at before anything is written. If
    /// that fails, the addresses are wrong, and nothing is written at all.
    Before,
    Write,
    Poll(Micros),
    Count,
    Data(u16),
    Check(u16),
    Pause(Micros),
    Over,
}

/// The read of one object.
#[derive(Clone, Debug)]
pub struct Handshake {
    request: Request,
    setup: Setup,
    state: State,
    status: status::Reader,
    words: Vec<u16>,
    failed: Option<Why>,
    /// The device said "error": one register holds its code.
    error: bool,
    /// The request was written at least once.
    wrote: bool,
    /// When the request was written this time.
    written: Micros,
    /// Our object was seen in the status since then.
    seen: bool,
    /// The device was seen at work on it since then.
    worked: bool,
    /// A "ready" that might be the one before was looked at twice.
    doubted: bool,
    /// Pauses between looks at the status since then.
    pauses: u32,
    /// The last status word since then.
    last: Option<u16>,
    course: Course,
}

impl Handshake {
    /// A handshake that begins now.
    #[must_use]
    pub const fn new(request: Request, setup: Setup, now: Micros) -> Self {
        let status = status::Reader::new(setup.position);
        let state = match setup.previous {
            Some(_) => State::Write,
            None => State::Before,
        };
        Self {
            request,
            setup,
            state,
            status,
            words: Vec::new(),
            failed: None,
            error: false,
            wrote: false,
            written: now,
            seen: false,
            worked: false,
            doubted: false,
            pauses: 0,
            last: None,
            course: Course {
                started: now,
                ready: None,
                ended: None,
                polls: 0,
                retries: 0,
                foreign: 0,
                foreign_object: None,
                blocks: 0,
            },
        }
    }

    /// What is read.
    #[must_use]
    pub const fn request(&self) -> Request {
        self.request
    }

    /// How it went so far.
    #[must_use]
    pub const fn course(&self) -> &Course {
        &self.course
    }

    /// What is known about the place of the status bits by now.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.status.position()
    }

    /// The object that the status names by now, as far as is known; for the next handshake.
    #[must_use]
    pub const fn stands(&self) -> Option<u16> {
        if self.wrote {
            Some(self.request.object())
        } else {
            self.setup.previous
        }
    }

    /// The registers, or why there are none; `None` as long as it goes on.
    #[must_use]
    pub fn outcome(&self) -> Option<Result<&[u16], &Why>> {
        match (&self.failed, self.state) {
            (Some(why), _) => Some(Err(why)),
            (None, State::Over) => Some(Ok(&self.words)),
            (None, _) => None,
        }
    }

    /// Where it is, for those who watch.
    #[must_use]
    pub const fn step(&self) -> DopStep {
        match self.state {
            State::Before | State::Write | State::Pause(_) => DopStep::Requesting,
            State::Poll(_) => DopStep::Busy,
            State::Count => DopStep::Counting,
            State::Data(_) | State::Check(_) | State::Over => DopStep::Reading,
        }
    }

    /// What to do next.
    pub fn next(&mut self, now: Micros) -> Next {
        let (start, count) = match self.state {
            State::Over => return Next::Over,
            State::Pause(until) if now < until => return Next::Wait(until),
            State::Write | State::Pause(_) => {
                self.state = State::Write;
                return Next::Write {
                    address: self.setup.request,
                    request: self.request,
                    function: self.setup.function,
                };
            }
            State::Poll(at) if now < at => return Next::Wait(at),
            State::Before | State::Poll(_) | State::Check(_) => (self.setup.status, 1),
            State::Count => (self.setup.count, 1),
            State::Data(total) => {
                let have = u16::try_from(self.words.len()).unwrap_or(u16::MAX);
                let left = total.saturating_sub(have);
                let start = self.setup.response.checked_add(have);
                let most = self.setup.max_registers.max(1);
                match start {
                    Some(start) => (start, left.min(most)),
                    None => return self.fail(Why::Address, now),
                }
            }
        };
        match Read::new(self.setup.table, Address::new(start), count) {
            Some(read) => Next::Read(read),
            None => self.fail(Why::Address, now),
        }
    }

    /// Says what came of what [`next`](Self::next) asked for.
    pub fn reply(&mut self, reply: Reply<'_>, now: Micros) {
        match (self.state, reply) {
            (State::Over | State::Pause(_), _) => {}
            (State::Before, Reply::Words([word, ..])) => {
                self.setup.previous = Some(status::object_of(*word));
                self.state = State::Write;
            }
            (State::Write, Reply::Written) => self.begin(now),
            // It may have arrived all the same; nothing is written twice before that is known.
            (State::Write, Reply::Lost(Outcome::Silence | Outcome::Damaged, _)) => self.begin(now),
            (_, Reply::Exception(code)) => self.exception(code, now),
            (_, Reply::Lost(outcome, text)) => {
                let why = Why::Lost {
                    area: self.area(),
                    outcome,
                    text: text.to_owned(),
                };
                self.fail(why, now);
            }
            (State::Poll(_), Reply::Words([word, ..])) => self.polled(*word, now),
            (State::Count, Reply::Words([count, ..])) => self.counted(*count, now),
            (State::Data(total), Reply::Words(words)) if !words.is_empty() => {
                let left = usize::from(total).saturating_sub(self.words.len());
                self.words.extend(words.iter().take(left));
                self.course.blocks = self.course.blocks.saturating_add(1);
                if self.words.len() >= usize::from(total) {
                    self.state = State::Check(total);
                }
            }
            (State::Check(total), Reply::Words([word, ..])) => self.checked(*word, total, now),
            (_, Reply::Written | Reply::Words(_)) => {
                let why = Why::Lost {
                    area: self.area(),
                    outcome: Outcome::Damaged,
                    text: "the answer has no registers".to_owned(),
                };
                self.fail(why, now);
            }
        }
    }

    /// The request is on its way; the status is looked at from now on.
    const fn begin(&mut self, now: Micros) {
        self.wrote = true;
        self.written = now;
        self.seen = false;
        self.worked = false;
        self.doubted = false;
        self.error = false;
        self.pauses = 0;
        self.last = None;
        self.course.ready = None;
        self.status.restart();
        self.state = State::Poll(now);
    }

    const fn area(&self) -> Area {
        match self.state {
            State::Write | State::Pause(_) => Area::Request(self.setup.request),
            State::Before | State::Poll(_) | State::Check(_) => Area::Status(self.setup.status),
            State::Count => Area::Count(self.setup.count),
            State::Data(_) | State::Over => Area::Response(self.setup.response),
        }
    }

    fn counted(&mut self, count: u16, now: Micros) {
        self.words.clear();
        match count {
            1..=MAX_COUNT => self.state = State::Data(count),
            0 => self.state = State::Check(0),
            _ => {
                self.fail(Why::Count(count), now);
            }
        }
    }

    fn exception(&mut self, code: u8, now: Micros) {
        let why = Why::Exception {
            area: self.area(),
            code,
        };
        if !BUSY_EXCEPTIONS.contains(&code) {
            self.fail(why, now);
        } else if matches!(self.state, State::Before | State::Write) {
            self.retry(why, now);
        } else if now.since(self.written) >= self.setup.timeout {
            self.fail(why, now);
        } else {
            // The status is looked at again, and all that follows is done again.
            self.words.clear();
            self.pause(now);
        }
    }

    /// Begins anew after a pause that gives another master time to fetch its data.
    fn retry(&mut self, why: Why, now: Micros) {
        self.words.clear();
        if self.course.retries >= u32::from(self.setup.retries) {
            self.fail(why, now);
            return;
        }
        self.course.retries = self.course.retries.saturating_add(1);
        let pause = self.setup.poll.saturating_mul(LOOKS);
        self.state = State::Pause(later(now, pause));
    }

    fn fail(&mut self, why: Why, now: Micros) -> Next {
        self.failed = Some(why);
        self.end(now);
        Next::Over
    }

    const fn end(&mut self, now: Micros) {
        self.course.ended = Some(now);
        self.state = State::Over;
    }
}

const fn later(now: Micros, by: u64) -> Micros {
    Micros::new(now.get().saturating_add(by))
}
