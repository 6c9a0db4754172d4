//! A bursting neighbour of another make.

use super::characters;
use super::medium::{Character, Party, later};
use super::wire::{Message, Receiver, message};
use crate::capture::Micros;

/// It sends so soon after an answer: a BACK follows every ACK (FieldComm Group, support article on
/// the BACK message).
const AT_ONCE: u64 = 1;
/// If the master that may send does not (HOLD) and the other one neither (RT2), it goes on.
const UNUSED: u64 = 10;
/// A request whose answer does not begin in this time (a little over STO) gets none.
const NO_ANSWER: u64 = 30;

/// A temperature transmitter in burst mode: after every answer on the line, and while nobody asks,
/// it sends its command 3 and hands the token to the primary and the secondary master in turn.
#[derive(Clone, Debug)]
pub struct HartBurst {
    baud: u32,
    /// Expanded device type and device id, without master and burst bit.
    address: [u8; 5],
    polling: u8,
    period_us: u64,
    receiver: Receiver,
    due: Option<Micros>,
    /// When it burst last.
    last: Option<Micros>,
    /// For which master the next burst is.
    primary: bool,
    /// An answer to a request for itself.
    answer: Option<Vec<u8>>,
    carrier: bool,
    sent: u32,
}

impl HartBurst {
    /// A device that begins to burst at once, as often as it may, or not more often than so many
    /// milliseconds.
    #[must_use]
    pub fn new(baud: u32, polling: u8, period_ms: u32) -> Self {
        Self {
            baud,
            // A type of another maker (264Eh is one of the sources' captures).
            address: [0x26, 0x4E, 0x0B, 0x00, polling],
            polling,
            period_us: u64::from(period_ms).saturating_mul(1000),
            receiver: Receiver::default(),
            due: Some(Micros::default()),
            last: None,
            primary: true,
            answer: None,
            carrier: false,
            sent: 0,
        }
    }

    /// Bursts that it sent.
    #[must_use]
    pub const fn sent_bursts(&self) -> u32 {
        self.sent
    }

    /// Plans the next burst, so many characters from here but not before its period is over.
    fn plan(&mut self, at: Micros, count: u64) {
        let soon = later(at, characters(count, self.baud));
        let period = self.last.map_or(soon, |last| later(last, self.period_us));
        self.due = Some(soon.max(period));
    }

    fn address_for(&self, primary: bool) -> [u8; 5] {
        let [first, rest @ ..] = self.address;
        let master = if primary { 0x80 } else { 0 };
        let [a, b, c, d] = rest;
        [first | master | 0x40, a, b, c, d]
    }

    /// Status, 11.2 mA, 23.5 °C, and three variables that it does not have.
    fn values() -> Vec<u8> {
        let mut data = vec![0, 0];
        data.extend(11.2_f32.to_be_bytes());
        data.push(32);
        data.extend(23.5_f32.to_be_bytes());
        data
    }

    fn understand(&mut self, message: &Message, at: Micros) {
        if !message.is_request() {
            if message.damage == 0 && message.is_answer() {
                // As the answer did, so that the other master is next.
                self.primary = message.is_primary();
                self.plan(at, AT_ONCE);
            }
            return;
        }
        self.plan(at, NO_ANSWER);
        let plain = message.plain_address();
        let polls = plain == [self.polling] && message.command == 0;
        if message.damage != 0 || !(polls || plain == self.address) {
            return;
        }
        let primary = message.is_primary();
        let mut address = self.address_for(primary).to_vec();
        if polls {
            address = vec![self.polling | 0x40 | if primary { 0x80 } else { 0 }];
        }
        let [kind, low, id @ ..] = self.address;
        let body = match message.command {
            0 => {
                let mut body = vec![0, 0, 254, kind, low, 5, 7, 1, 1, 0x08, 0];
                body.extend(id);
                body.extend([5, 0, 0, 0, 0, 0, 0x26, 0, 0x26, 1]);
                body
            }
            3 => Self::values(),
            _ => vec![64, 0],
        };
        let delimiter = if polls { 0x06 } else { 0x86 };
        self.answer = Some(message_of(delimiter, &address, message.command, &body));
        self.due = Some(later(at, characters(4, self.baud)));
    }
}

fn message_of(delimiter: u8, address: &[u8], command: u8, body: &[u8]) -> Vec<u8> {
    message(5, delimiter, address, command, body)
}

impl Party for HartBurst {
    fn hear(&mut self, character: Character, at: Micros) {
        let gap = characters(2, self.baud).max(20_000);
        if let Some(message) = self.receiver.take(character, at, gap) {
            self.understand(&message, at);
        }
    }

    fn carrier(&mut self, on: bool, at: Micros) {
        self.carrier = on;
        self.receiver.reset();
        // Noise, or the end of something that it did not understand.
        let planned = self.due.is_some_and(|due| due >= at);
        if !on && !planned && self.answer.is_none() {
            self.plan(at, NO_ANSWER);
        }
    }

    fn due(&self) -> Option<Micros> {
        self.due.filter(|_| !self.carrier)
    }

    fn act(&mut self, now: Micros) -> Option<Vec<u8>> {
        self.due = None;
        if let Some(answer) = self.answer.take() {
            return Some(answer);
        }
        let address = self.address_for(self.primary);
        self.primary = !self.primary;
        self.sent = self.sent.saturating_add(1);
        self.last = Some(now);
        Some(message_of(0x81, &address, 3, &Self::values()))
    }

    fn sent(&mut self, at: Micros) {
        self.plan(at, UNUSED);
    }
}
