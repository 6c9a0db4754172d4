//! Puts a read together from the exchanges that follow its request.

use super::exchange::registers;
use super::{Areas, Exchange, FoundRead};
use crate::capture::Micros;
use crate::dop::handshake::status::{self, Meaning, Position, Status};
use crate::dop::{Profile, Request};

/// Registers of the response area.
const RESPONSE: usize = 512;

/// Whether the status was seen to be ready, or in error.
#[derive(Clone, Copy, PartialEq, Eq)]
enum State {
    No,
    /// The word could be "busy" as well.
    Perhaps,
    Yes,
}

/// A read whose end was not seen yet.
pub(super) struct Building {
    pub read: FoundRead,
    status: status::Reader,
    /// The last status word.
    last: Option<u16>,
    /// Whether the status was ready; a pasted capture has no times that would tell.
    state: State,
    /// All registers of the count were read: what is read now belongs to somebody else, but for
    /// one more look at the status.
    full: bool,
    looked: bool,
    words: Vec<Option<u16>>,
}

impl Building {
    pub fn new(exchange: &Exchange, word: u16, position: Position, profile: &Profile) -> Self {
        let request = Request::from_word(word);
        let mut building = Self {
            read: FoundRead {
                unit: exchange.unit,
                request,
                words: Vec::new(),
                count: None,
                complete: false,
                error: None,
                position,
                started: exchange.at,
                ready: None,
                ended: None,
                polls: 0,
                problems: Vec::new(),
                frames: vec![exchange.frame],
            },
            status: status::Reader::new(position),
            last: None,
            state: State::No,
            full: false,
            looked: false,
            words: vec![None; RESPONSE],
        };
        building.read.frames.extend(exchange.answer);
        if exchange.response.is_none() {
            building.say("The write of the request was not answered.".to_owned());
        }
        if !request.is_known(profile) {
            building.say(format!(
                "The request {request} names no object and option that are known."
            ));
        }
        building
    }

    pub fn say(&mut self, problem: String) {
        if !self.read.problems.contains(&problem) {
            self.read.problems.push(problem);
        }
    }

    /// Takes a read of registers: one may cover more than one area.
    pub fn absorb(&mut self, exchange: &Exchange, areas: &Areas, start: u16, data: &[u8]) {
        if self.full && (start != areas.status || core::mem::replace(&mut self.looked, true)) {
            return;
        }
        let mut used = false;
        for (address, word) in registers(start, data) {
            let offset = usize::from(address.wrapping_sub(areas.response));
            if address == areas.status {
                self.polled(word, exchange.answered);
            } else if address == areas.count {
                self.read.count = Some(word);
            } else if let Some(slot) = self.words.get_mut(offset) {
                *slot = Some(word);
                self.read.ended = exchange.answered;
                self.settle();
            } else {
                continue;
            }
            used = true;
        }
        let wanted = self.read.count.map(usize::from);
        let read = wanted.and_then(|count| self.words.get(..count));
        self.full = self.state == State::Yes && read.is_some_and(|w| w.iter().all(Option::is_some));
        if used {
            self.read.frames.push(exchange.frame);
            self.read.frames.extend(exchange.answer);
        }
    }

    fn polled(&mut self, word: u16, at: Option<Micros>) {
        self.read.polls = self.read.polls.saturating_add(1);
        let object = status::object_of(word);
        if object != self.read.request.object() {
            self.say(format!(
                "The status 0x{word:04X} is about object {object}: another master asks in \
                 between, or the device has not taken up the request."
            ));
            return;
        }
        self.last = Some(word);
        if self.state == State::Perhaps {
            self.state = State::No;
            self.read.ready = None;
        }
        match self.status.read(word) {
            Meaning::Is(status @ (Status::Ready | Status::Error)) => {
                self.state = State::Yes;
                self.read.ready = self.read.ready.or(at);
                if status == Status::Error {
                    self.read.error = Some(None);
                }
            }
            Meaning::Is(Status::Busy) if self.state == State::Yes => {
                self.say("The status went back to busy.".to_owned());
            }
            Meaning::Is(Status::Busy) => {}
            Meaning::Is(Status::Undefined) => {
                self.say(format!("The status 0x{word:04X} is not defined."));
            }
            // Told by what the master does next.
            Meaning::ReadyOrBusy(_) => {
                self.state = State::Perhaps;
                self.read.ready = at;
            }
        }
    }

    /// Whoever reads the data takes the status for ready.
    fn settle(&mut self) {
        if self.status.position() == Position::Unknown
            && let Some(word) = self.last
            && let Meaning::ReadyOrBusy(shift) = self.status.read(word)
        {
            self.status.settle(shift);
            self.state = State::Yes;
        }
    }

    pub fn finish(mut self) -> FoundRead {
        self.read.position = self.status.position();
        let words: Vec<u16> = self.words.iter().map_while(|w| *w).collect();
        let have = words.len();
        let ready = self.state == State::Yes;
        if self.read.error.is_some() {
            self.read.error = Some(words.first().copied());
            self.read.words = words.into_iter().take(1).collect();
            let text = match self.read.words.first() {
                Some(code) => match status::error_text(*code) {
                    Some(text) => format!("The device answered with error {code}: {text}."),
                    None => format!("The device answered with error {code}, which is not defined."),
                },
                None => "The device answered with an error whose code was not read.".to_owned(),
            };
            self.say(text);
            return self.read;
        }
        match self.read.count {
            None if have > 0 => {
                self.say(
                    "The count was not read; all registers that follow each other are shown."
                        .to_owned(),
                );
                self.read.words = words;
            }
            None => self.say("Nothing but the request was seen.".to_owned()),
            Some(count) if usize::from(count) > RESPONSE => {
                self.say(format!(
                    "The device counts {count} registers, and there are 512 at most."
                ));
                self.read.words = words;
            }
            Some(count) => {
                let count = usize::from(count);
                self.read.words = words.into_iter().take(count).collect();
                if have < count {
                    self.say(format!("{have} of {count} registers were read."));
                }
                if !ready && self.status.position() == Position::Unknown {
                    self.say("The status was not seen to be ready.".to_owned());
                }
                self.read.complete = have >= count && ready;
            }
        }
        self.read
    }
}
