//! What a look at the status means for the read.

use super::status::{self, Meaning, Status};
use super::{FIRST_PAUSE, Handshake, LATER, LOOKS, State, Why, later};
use crate::capture::Micros;

impl Handshake {
    pub(super) fn polled(&mut self, word: u16, now: Micros) {
        self.course.polls = self.course.polls.saturating_add(1);
        let moved = self.last.replace(word).is_some_and(|last| last != word);
        if status::object_of(word) != self.request.object() {
            self.other(word, moved, now);
            return;
        }
        self.seen = true;
        match self.status.read(word) {
            Meaning::Is(Status::Ready) if self.is_doubtful() => {
                self.doubted = true;
                self.state = State::Poll(now);
            }
            Meaning::Is(Status::Ready) => self.ready(now),
            Meaning::Is(Status::Error) => {
                self.error = true;
                self.ready(now);
                self.words.clear();
                self.state = State::Data(1);
            }
            Meaning::Is(Status::Busy) => {
                self.worked = true;
                self.again(Why::Busy(self.setup.timeout), now);
            }
            Meaning::Is(Status::Undefined) => self.again(Why::Undefined(word), now),
            Meaning::ReadyOrBusy(shift) => {
                // A device that were busy would be done by now.
                if now.since(self.written) >= self.setup.timeout >> 1 {
                    self.status.settle(shift);
                    self.ready(now);
                } else {
                    self.pause(now);
                }
            }
        }
    }

    /// "Ready" at once, for the object that was read before: it might be the answer to that.
    fn is_doubtful(&self) -> bool {
        !self.worked && !self.doubted && self.setup.previous == Some(self.request.object())
    }

    const fn ready(&mut self, now: Micros) {
        self.course.ready = Some(now);
        self.state = State::Count;
    }

    /// Looks again later, or gives up.
    fn again(&mut self, why: Why, now: Micros) {
        if now.since(self.written) >= self.setup.timeout {
            self.fail(why, now);
        } else {
            self.pause(now);
        }
    }

    /// Waits before the next look. The first pauses are an eighth, a quarter and a half of the
    /// poll period: most objects are ready long before it is over.
    pub(super) fn pause(&mut self, now: Micros) {
        let shorter = FIRST_PAUSE.saturating_sub(self.pauses);
        self.pauses = self.pauses.saturating_add(1);
        let pause = self.setup.poll.checked_shr(shorter).unwrap_or(0);
        self.state = State::Poll(later(now, pause));
    }

    /// The status names another object.
    fn other(&mut self, word: u16, moved: bool, now: Micros) {
        let object = status::object_of(word);
        let patience = self.setup.poll.saturating_mul(LOOKS);
        let waited = now.since(self.written);
        if !self.seen && waited < patience.min(self.setup.timeout) {
            // The device may not have looked at our request yet.
            self.pause(now);
            return;
        }
        // An object that is neither ours nor the one that stood there before is somebody else's.
        let new = moved || self.setup.previous.is_some_and(|p| p != object);
        if object != 0 && (self.seen || new) {
            self.foreign(object, now);
        } else {
            self.retry(Why::NotTaken(word), now);
        }
    }

    fn foreign(&mut self, object: u16, now: Micros) {
        self.course.foreign = self.course.foreign.saturating_add(1);
        self.course.foreign_object = Some(object);
        self.retry(Why::Foreign(object), now);
    }

    /// The status after the data: only if it still says the same, the data are of one piece.
    pub(super) fn checked(&mut self, word: u16, total: u16, now: Micros) {
        self.course.polls = self.course.polls.saturating_add(1);
        let object = status::object_of(word);
        if object != self.request.object() {
            self.foreign(object, now);
            return;
        }
        let wanted = if self.error {
            Status::Error
        } else {
            Status::Ready
        };
        let meaning = self.status.read(word);
        if meaning == Meaning::Is(Status::Busy) && !self.worked {
            // It begins only now: what was read is the answer to a request before ours.
            self.worked = true;
            self.error = false;
            self.words.clear();
            self.course.ready = None;
            self.again(Why::Busy(self.setup.timeout), now);
            return;
        }
        if meaning != Meaning::Is(wanted) {
            self.retry(Why::Changed(word), now);
            return;
        }
        if !self.error {
            self.end(now);
            return;
        }
        let code = self.words.first().copied().unwrap_or(0);
        self.words.truncate(usize::from(total));
        let why = Why::Code(code);
        if LATER.contains(&code) {
            self.retry(why, now);
        } else {
            self.fail(why, now);
        }
    }
}
