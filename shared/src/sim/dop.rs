//! A simulated Limitorque MX or QX of series B, as far as its diagnostic objects go.
//!
//! A pure state machine like the other simulated actuators: time comes in with [`Dop::advance`]. It
//! encodes its objects from the printed tables by itself and shares no code with the decoder.
//!
//! # What is the simulator's own
//!
//! The manual gives no register addresses (reading M7), no position of the status bits (M2), no
//! numbers of the log commands (M5) and no names of the indicator, alarm and warning bits (M3, M4).
//! Those used here are inventions: [`DopSetup`] has them, and the built-in profile names them.

mod identity;
mod logs;
mod noise;
mod objects;
mod position;
mod put;
mod stroke;
#[cfg(test)]
mod tests;
mod torque;
mod trends;
mod unit;
mod vibration;

use crate::capture::Micros;
use logs::Mark;
use unit::{STEP_MS, Unit};

/// Registers of the response area.
const RESPONSE: u16 = 512;
/// If nobody asked for longer than this, what happened before is left out.
const LONGEST_MS: u64 = 3_600_000;
/// The object that the other master asks for.
const FOREIGN_REQUEST: u16 = 1003;
/// The "fault register" 10 of the legacy map, and its bit for any user indicator (reading C22).
const LEGACY_FAULT: u16 = 9;
const ANY_INDICATOR: u16 = 1 << 7;
/// Registers of the legacy map that can be read.
const LEGACY: u16 = 16;

/// Where the registers are and how the unit behaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DopSetup {
    /// Address of the request register.
    pub request: u16,
    /// First of the four registers with the user indicators.
    pub indicators: u16,
    /// Address of the status register.
    pub status: u16,
    /// Address of the count register.
    pub count: u16,
    /// First of the 512 response registers.
    pub response: u16,
    /// Lowest of the three status bits: 11, 12 or 13.
    pub shift: u8,
    /// How long it is busy with a request, in milliseconds.
    pub busy_ms: u32,
    /// Another master asks for an object so often, in milliseconds; 0 for never.
    pub foreign_ms: u32,
    /// Records in the event log at the start.
    pub events: usize,
    /// It strokes by itself once a minute.
    pub moves: bool,
}

impl Default for DopSetup {
    fn default() -> Self {
        Self {
            request: 4000,
            indicators: 4010,
            status: 4014,
            count: 4015,
            response: 4100,
            shift: 12,
            busy_ms: 120,
            foreign_ms: 0,
            events: 420,
            moves: true,
        }
    }
}

/// What the unit does with a request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Work {
    #[default]
    None,
    Busy,
    Ready,
    Error,
}

/// A simulated series B unit.
#[derive(Clone, Debug)]
pub struct Dop {
    setup: DopSetup,
    unit: Unit,
    marks: [Mark; 2],
    request: u16,
    work: Work,
    /// When the work is done.
    done_at: Micros,
    count: u16,
    response: Vec<u16>,
    first: Option<Micros>,
    now: Micros,
    /// Milliseconds that were simulated.
    lived: u64,
    /// When the other master asks next.
    foreign_at: Micros,
    /// Requests that were written.
    writes: u32,
}

impl Dop {
    /// A unit that was just switched on.
    #[must_use]
    pub fn new(tag: &str, setup: DopSetup) -> Self {
        Self {
            unit: Unit::new(tag, setup.events, setup.moves),
            setup,
            marks: [Mark::default(); 2],
            request: 0,
            work: Work::None,
            done_at: Micros::default(),
            count: 0,
            response: vec![0; usize::from(RESPONSE)],
            first: None,
            now: Micros::default(),
            lived: 0,
            foreign_at: Micros::default(),
            writes: 0,
        }
    }

    /// Requests that were written to it, those of the other master left out.
    #[must_use]
    pub const fn writes(&self) -> u32 {
        self.writes
    }

    /// Position in tenths of a percent, 1000 is open.
    #[must_use]
    pub fn position(&self) -> u16 {
        u16::try_from(self.unit.position).unwrap_or(0)
    }

    /// Lets time go on until `now`; `wall` is the wall clock in seconds since 1970 (UTC). The
    /// first call switches the unit on.
    pub fn advance(&mut self, now: Micros, wall: u64) {
        let first = match self.first {
            Some(first) => first,
            None => {
                self.first = Some(now);
                self.unit
                    .begin(i64::try_from(wall).unwrap_or(0), self.setup.events);
                self.foreign_at = self.later(now, self.setup.foreign_ms);
                now
            }
        };
        self.now = self.now.max(now);
        let age = self.now.since(first).checked_div(1000).unwrap_or(0);
        let step = u64::try_from(STEP_MS).unwrap_or(100);
        let behind = age.saturating_sub(self.lived);
        if behind > LONGEST_MS {
            self.lived = age.saturating_sub(LONGEST_MS);
        }
        while self.lived.saturating_add(step) <= age {
            self.lived = self.lived.saturating_add(step);
            self.unit.step();
        }
        if self.setup.foreign_ms > 0 && self.now >= self.foreign_at {
            self.foreign_at = self.later(self.now, self.setup.foreign_ms);
            self.take(FOREIGN_REQUEST);
        }
        if self.work == Work::Busy && self.now >= self.done_at {
            self.work();
        }
    }

    fn later(&self, from: Micros, ms: u32) -> Micros {
        Micros::new(
            from.get()
                .saturating_add(u64::from(ms).saturating_mul(1000)),
        )
    }

    /// A request was written.
    fn take(&mut self, request: u16) {
        self.request = request;
        self.work = Work::Busy;
        self.count = 0;
        self.done_at = self.later(self.now, self.setup.busy_ms);
        if self.setup.busy_ms == 0 {
            self.work();
        }
    }

    /// Does the work: fills the response. What lies behind it stays as it was.
    fn work(&mut self) {
        let object = self.request & 0x07FF;
        let option = u8::try_from(self.request >> 12).unwrap_or(0);
        let [events, moves] = &mut self.marks;
        let done = match object {
            1202 => logs::page(&self.unit, object, option, events),
            1203 => logs::page(&self.unit, object, option, moves),
            _ => objects::respond(&self.unit, object, option),
        };
        let (work, words) = match done {
            Ok(words) => (Work::Ready, words),
            Err(code) => (Work::Error, vec![code]),
        };
        self.count = match work {
            Work::Ready => u16::try_from(words.len()).unwrap_or(0),
            _ => 0,
        };
        self.work = work;
        for (slot, word) in self.response.iter_mut().zip(words) {
            *slot = word;
        }
    }

    fn status(&self) -> u16 {
        let value: u16 = match self.work {
            Work::None => return 0,
            Work::Busy => 1,
            Work::Ready => 2,
            Work::Error => 3,
        };
        let shift = u32::from(self.setup.shift);
        self.request & 0x07FF | value.checked_shl(shift).unwrap_or(0)
    }

    /// The user indicators that are active: the bits 1, 13 and 40, and while a phase is lost 63.
    fn active(&self) -> u64 {
        let lost = u64::from(self.unit.phase_lost());
        1 << 1 | 1 << 13 | 1 << 40 | lost << 63
    }

    fn register(&self, address: u16) -> Option<u16> {
        let within = |start: u16, len: u16| {
            let offset = address.checked_sub(start)?;
            (offset < len).then_some(offset)
        };
        if address == self.setup.request {
            return Some(self.request);
        }
        if address == self.setup.status {
            return Some(self.status());
        }
        if address == self.setup.count {
            return Some(self.count);
        }
        if let Some(offset) = within(self.setup.indicators, 4) {
            // Lowest word first.
            let shift = u32::from(offset).saturating_mul(16);
            let word = self.active().checked_shr(shift).unwrap_or(0) & 0xFFFF;
            return u16::try_from(word).ok();
        }
        if let Some(offset) = within(self.setup.response, RESPONSE) {
            return self.response.get(usize::from(offset)).copied();
        }
        within(0, LEGACY)?;
        let any = address == LEGACY_FAULT && self.active() != 0;
        Some(if any { ANY_INDICATOR } else { 0 })
    }

    /// The answer to a PDU that is addressed to this unit.
    #[must_use]
    pub fn answer(&mut self, pdu: &[u8]) -> Option<Vec<u8>> {
        let word = |high: &u8, low: &u8| u16::from_be_bytes([*high, *low]);
        let function = *pdu.first()?;
        let refuse = |code: u8| Some(vec![function | 0x80, code]);
        match pdu {
            [3 | 4, a, b, c, d] => {
                let (start, count) = (word(a, b), word(c, d));
                if !(1..=125).contains(&count) {
                    return refuse(3);
                }
                let bytes = u8::try_from(count.saturating_mul(2)).unwrap_or(0);
                let mut response = vec![function, bytes];
                for offset in 0..count {
                    match start.checked_add(offset).and_then(|at| self.register(at)) {
                        Some(word) => response.extend(word.to_be_bytes()),
                        None => return refuse(2),
                    }
                }
                Some(response)
            }
            [6, a, b, c, d] => {
                if word(a, b) != self.setup.request {
                    return refuse(2);
                }
                self.writes = self.writes.saturating_add(1);
                self.take(word(c, d));
                Some(pdu.to_vec())
            }
            [16, a, b, 0, 1, 2, c, d] => {
                if word(a, b) != self.setup.request {
                    return refuse(2);
                }
                self.writes = self.writes.saturating_add(1);
                self.take(word(c, d));
                Some(vec![16, *a, *b, 0, 1])
            }
            [8, 0, 0, ..] => Some(pdu.to_vec()),
            [3 | 4 | 6 | 16, ..] => refuse(3),
            _ => refuse(1),
        }
    }
}
