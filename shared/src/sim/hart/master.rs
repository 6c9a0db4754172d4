//! A plain master that obeys the token rules, written apart from the link layer of the product.

use super::characters;
use super::medium::{Character, Party, later};
use super::wire::{Message, Receiver, message};
use crate::capture::Micros;
use std::collections::VecDeque;

/// Times of the data link in characters.
const HOLD: u64 = 2;
const RT2: u64 = 8;
const RT1_PRIMARY: u64 = 33;
const RT1_SECONDARY: u64 = 41;
/// Bursts that were not seen for so long are over.
const BURSTS_US: u64 = 5_000_000;
/// It asks so often until it gives up.
const TRIES: u8 = 4;
/// Answers that are kept.
const KEPT: usize = 64;

/// An answer that the master got.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Seen {
    /// When it ended.
    pub at: Micros,
    /// The command.
    pub command: u8,
    /// The two status bytes and the data.
    pub body: Vec<u8>,
}

/// A second master: it asks the same things over and over, one at a time.
#[derive(Clone, Debug)]
pub struct HartMaster {
    baud: u32,
    primary: bool,
    /// Long or short address without master bit, command, data.
    requests: Vec<(Vec<u8>, u8, Vec<u8>)>,
    next: usize,
    period_us: u64,
    /// When the next request may begin by its own plan.
    wanted: Micros,
    receiver: Receiver,
    carrier: bool,
    /// From when to when it may begin; after the window it waits for RT1 of silence.
    window: (Micros, Option<Micros>),
    bursts: Option<Micros>,
    /// It waits for an answer since then.
    asked: Option<Micros>,
    tries: u8,
    seen: VecDeque<Seen>,
    sent: u32,
    answered: u32,
    given_up: u32,
}

impl HartMaster {
    /// A master that just came to the line. It asks at most once in `period_ms`.
    #[must_use]
    pub fn new(baud: u32, primary: bool, period_ms: u32) -> Self {
        let mut master = Self {
            baud,
            primary,
            requests: Vec::new(),
            next: 0,
            period_us: u64::from(period_ms).saturating_mul(1000),
            wanted: Micros::default(),
            receiver: Receiver::default(),
            carrier: false,
            window: (Micros::default(), None),
            bursts: None,
            asked: None,
            tries: 0,
            seen: VecDeque::new(),
            sent: 0,
            answered: 0,
            given_up: 0,
        };
        master.wait_quiet(Micros::default());
        master
    }

    /// Adds a request to its round: an address of one or five bytes without master bit.
    pub fn ask(&mut self, address: &[u8], command: u8, data: &[u8]) {
        self.requests
            .push((address.to_vec(), command, data.to_vec()));
    }

    /// Requests sent, answers got, requests given up.
    #[must_use]
    pub const fn counts(&self) -> (u32, u32, u32) {
        (self.sent, self.answered, self.given_up)
    }

    /// The last answers, oldest first.
    pub fn answers(&self) -> impl Iterator<Item = &Seen> {
        self.seen.iter()
    }

    fn after(&self, at: Micros, count: u64) -> Micros {
        later(at, characters(count, self.baud))
    }

    /// RT1 of silence from here on.
    fn wait_quiet(&mut self, at: Micros) {
        let rt1 = if self.primary {
            RT1_PRIMARY
        } else {
            RT1_SECONDARY
        };
        self.window = (self.after(at, rt1), None);
    }

    /// The token is here: begin within HOLD, or leave it.
    fn take_token(&mut self, at: Micros) {
        self.window = (self.after(at, 1), Some(self.after(at, HOLD)));
    }

    fn understand(&mut self, message: &Message, at: Micros) {
        if message.damage != 0 {
            return self.wait_quiet(at);
        }
        let mine = message.is_primary() == self.primary;
        match message.delimiter & 0x07 {
            6 if mine && self.asked.is_some() => {
                self.asked = None;
                self.tries = 0;
                self.answered = self.answered.saturating_add(1);
                self.next = self.next.saturating_add(1);
                if self.seen.len() >= KEPT {
                    self.seen.pop_front();
                }
                self.seen.push_back(Seen {
                    at,
                    command: message.command,
                    body: message.data.clone(),
                });
                self.window = (self.after(at, RT2), None);
            }
            // With a burst device on the line its message follows every answer and hands the token.
            6 if self.bursts.is_some_and(|seen| at.since(seen) < BURSTS_US) => self.wait_quiet(at),
            6 if !mine => self.take_token(at),
            1 => {
                // Like an answer: a burst for one master lets the other one begin.
                self.bursts = Some(at);
                if mine {
                    self.wait_quiet(at);
                } else {
                    self.take_token(at);
                }
            }
            // A request of the other: its answer begins within STO.
            _ => self.wait_quiet(at),
        }
    }
}

impl Party for HartMaster {
    fn hear(&mut self, character: Character, at: Micros) {
        let gap = characters(2, self.baud).max(20_000);
        if let Some(message) = self.receiver.take(character, at, gap) {
            self.understand(&message, at);
        }
    }

    fn carrier(&mut self, on: bool, at: Micros) {
        self.carrier = on;
        self.receiver.reset();
        if !on && self.window.0 <= at {
            self.wait_quiet(at);
        }
    }

    fn due(&self) -> Option<Micros> {
        if self.carrier || self.requests.is_empty() {
            return None;
        }
        let (from, _) = self.window;
        // A repetition does not wait for the plan.
        let wanted = if self.tries > 0 { from } else { self.wanted };
        Some(from.max(wanted))
    }

    fn act(&mut self, now: Micros) -> Option<Vec<u8>> {
        let (_, until) = self.window;
        if until.is_some_and(|until| now > until) {
            // The time to hold the token is over.
            self.wait_quiet(now);
            return None;
        }
        if self.asked.take().is_some() && self.tries >= TRIES {
            self.given_up = self.given_up.saturating_add(1);
            self.next = self.next.saturating_add(1);
            self.tries = 0;
            self.wanted = later(now, self.period_us);
            self.window = (self.after(now, 1), None);
            return None;
        }
        let at = self.next.checked_rem(self.requests.len())?;
        let (address, command, data) = self.requests.get(at)?;
        let mut address = address.clone();
        if let (Some(first), true) = (address.first_mut(), self.primary) {
            *first |= 0x80;
        }
        let delimiter = if address.len() == 5 { 0x82 } else { 0x02 };
        if self.tries == 0 {
            self.wanted = later(now, self.period_us);
        }
        self.tries = self.tries.saturating_add(1);
        self.sent = self.sent.saturating_add(1);
        self.asked = Some(now);
        Some(message(5, delimiter, &address, *command, data))
    }

    fn sent(&mut self, at: Micros) {
        // No answer within STO: either may begin after RT1.
        self.wait_quiet(at);
    }
}
