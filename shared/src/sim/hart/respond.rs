//! Requests to answers: whether it is meant, and whether it can.

use super::characters;
use super::device::{Answer, HartDevice, set_master};
use super::medium::later;
use super::wire::{Message, message};
use crate::capture::Micros;

/// A late answer begins after so many characters; the slave time-out is 28.
const LATE: u64 = 60;

/// A command that takes longer than an answer may.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Delayed {
    primary: bool,
    command: u8,
    data: Vec<u8>,
    done: Micros,
}

/// Faults of the line that the device has on demand: how many answers they spoil.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Faults {
    pub busy: u32,
    pub silent: u32,
    pub damaged: u32,
    pub late: u32,
}

impl HartDevice {
    /// A message came in; what it answers, and when it may begin.
    pub(super) fn understand(&mut self, message: &Message, at: Micros) {
        self.advance(at);
        let Some(answer) = self.respond(message) else {
            return;
        };
        let mut turn = u64::from(self.setup.turn);
        if self.faults.late > 0 {
            self.faults.late = self.faults.late.saturating_sub(1);
            turn = LATE;
        }
        let begin = later(at, characters(turn, self.setup.baud));
        self.pending = Some((begin, answer));
    }

    fn respond(&mut self, request: &Message) -> Option<Vec<u8>> {
        if !request.is_request() || request.delimiter & 0x60 != 0 {
            // Whoever does not know expansion bytes must not answer (reading G10).
            return None;
        }
        let plain = request.plain_address();
        let long = self.long_address();
        let broadcast = plain == [0; 5];
        let searches = broadcast && matches!(request.command, 11 | 21) && request.damage == 0;
        let polls = plain == [self.polling] && request.command == 0;
        if !(searches || polls || plain == long) {
            return None;
        }
        if searches && !self.has_tag(request) {
            return None;
        }
        self.heard = self.heard.saturating_add(1);
        if self.faults.silent > 0 {
            self.faults.silent = self.faults.silent.saturating_sub(1);
            return None;
        }
        let primary = request.is_primary();
        let mut body;
        if request.damage == 0 {
            let answer = self.execute(request, primary);
            body = vec![answer.code, self.device_status(primary)];
            body.extend(answer.data);
            set_master(&mut self.cold, primary, false);
        } else {
            body = vec![request.damage, self.device_status(primary)];
        }
        let mut address = if broadcast { long.to_vec() } else { plain };
        if let (Some(first), true) = (address.first_mut(), primary) {
            *first |= 0x80;
        }
        let delimiter = if address.len() == 5 { 0x86 } else { 0x06 };
        let preambles = self.setup.preambles;
        let mut bytes = message(preambles, delimiter, &address, request.command, &body);
        if self.faults.damaged > 0 {
            self.faults.damaged = self.faults.damaged.saturating_sub(1);
            if let Some(last) = bytes.last_mut() {
                *last ^= 0x55;
            }
        }
        self.answered = self.answered.saturating_add(1);
        Some(bytes)
    }

    fn has_tag(&self, request: &Message) -> bool {
        match request.command {
            11 => request.data.get(..6) == Some(&self.notes.tag),
            _ => request.data.get(..32) == Some(&self.notes.long_tag),
        }
    }

    fn execute(&mut self, request: &Message, primary: bool) -> Answer {
        let finds = matches!(request.command, 0 | 11 | 21);
        if self.faults.busy > 0 && !finds {
            self.faults.busy = self.faults.busy.saturating_sub(1);
            return Answer::error(32);
        }
        if self.setup.delayed_ms > 0
            && matches!(request.command, 22 | 42)
            && let Some(code) = self.delay(request, primary)
        {
            return Answer::error(code);
        }
        let data = &request.data[..];
        match request.command {
            0..=30 | 38 | 48 => self.universal(request.command, data, primary),
            31 => self.extended(data),
            command => self
                .common(u16::from(command), data)
                .or_else(|| self.own(command, data))
                .unwrap_or(Answer::error(64)),
        }
    }

    /// Code 33 at first, 34 while it runs, 36 for another; none once it is done.
    fn delay(&mut self, request: &Message, primary: bool) -> Option<u8> {
        let Some(delayed) = &self.delayed else {
            let wait = u64::from(self.setup.delayed_ms).saturating_mul(1000);
            self.delayed = Some(Delayed {
                primary,
                command: request.command,
                data: request.data.clone(),
                done: later(self.now, wait),
            });
            return Some(33);
        };
        let same = delayed.primary == primary
            && delayed.command == request.command
            && delayed.data == request.data;
        if !same {
            return Some(36);
        }
        if self.now < delayed.done {
            return Some(34);
        }
        self.delayed = None;
        None
    }

    /// A command above 255 inside command 31.
    fn extended(&mut self, data: &[u8]) -> Answer {
        let Some((number, rest)) = data.split_first_chunk::<2>() else {
            return Answer::error(5);
        };
        let command = u16::from_be_bytes(*number);
        let inner = if command < 256 {
            Answer::error(20)
        } else {
            self.common(command, rest).unwrap_or(Answer::error(64))
        };
        // The number stands in front of the data, of an error too (reading G9).
        Answer {
            code: inner.code,
            data: [&number[..], &inner.data].concat(),
        }
    }
}
