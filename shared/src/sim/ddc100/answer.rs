//! What a unit answers to each function (tables 3.2 to 3.8).

use super::Answer;
use super::drive::{Motion, OPEN};
use super::unit::Unit;
use crate::capture::Micros;
use crate::ddc100::{HostPort, timing};
use crate::device::Device;

/// Exception codes.
const ILLEGAL_FUNCTION: u8 = 1;
const ILLEGAL_ADDRESS: u8 = 2;
const ILLEGAL_VALUE: u8 = 3;

/// An answer without its function code, or an exception code.
type Outcome = Result<Vec<u8>, u8>;

/// Last register of table 3.5 and that of the watchdog (section 4.3).
const LAST_REGISTER: u16 = 56;
const WATCHDOG: u16 = 112;
/// Coils of table 3.3.
const COILS: u16 = 9;
/// Status inputs of table 3.4: numbers 129 to 208 are the bits of registers 9 to 13.
const FIRST_INPUT: u16 = 129;
const LAST_INPUT: u16 = 208;

/// Address and quantity or value, and what follows.
fn two_words(data: &[u8]) -> Option<(u16, u16, &[u8])> {
    match data {
        [a, b, c, d, rest @ ..] => Some((
            u16::from_be_bytes([*a, *b]),
            u16::from_be_bytes([*c, *d]),
            rest,
        )),
        _ => None,
    }
}

impl Unit {
    /// A request for it, or for all, that came in through a host port.
    pub(super) fn request(&mut self, port: HostPort, pdu: &[u8], now: Micros) -> Option<Answer> {
        let (function, data) = pdu.split_first()?;
        self.polled(port, now);
        let listened_only = self.listens_only;
        // It takes in what comes then, but does nothing of it, except to restart.
        if listened_only && !matches!(pdu, [8, 0, 1, ..]) {
            return None;
        }
        self.counters.own = self.counters.own.wrapping_add(1);
        let outcome = self.function(*function, data);
        // Neither what begins nor what ends that is answered.
        if listened_only || self.listens_only {
            return None;
        }
        let pdu = match outcome {
            Ok(data) => {
                let mut pdu = vec![*function];
                pdu.extend(data);
                pdu
            }
            Err(code) => {
                self.counters.exceptions = self.counters.exceptions.wrapping_add(1);
                vec![function | 0x80, code]
            }
        };
        // Two bytes of an answer are a register; what is no read counts as one.
        let registers = match function {
            1..=4 => u16::try_from(pdu.len().saturating_sub(2).div_ceil(2)).unwrap_or(1),
            _ => 1,
        };
        Some(Answer {
            after_us: timing::thinks(self.member.kind, registers.max(1)),
            pdu,
        })
    }

    fn function(&mut self, function: u8, data: &[u8]) -> Outcome {
        match function {
            1 => self.coils(data),
            2 if !self.is_mx() => self.inputs(data),
            3 | 4 => self.registers(function, data),
            5 => self.write_coil(data),
            6 => self.write_register(data),
            8 => self.diagnostics(data),
            15 => self.write_coils(data),
            16 => self.write_registers(data),
            _ => Err(ILLEGAL_FUNCTION),
        }
    }

    fn coils(&self, data: &[u8]) -> Outcome {
        let Some((start, quantity, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        within(start, quantity, 0, COILS)?;
        Ok(packed((0..quantity).map(|at| {
            self.coil(start.saturating_add(at).saturating_add(1))
        })))
    }

    /// State of a coil by its number. Coil n is bit n - 1 of register 11 on every type: relays of
    /// an MX stand from bit 2 and coil 3 on (readings D2, D3, D33).
    fn coil(&self, number: u16) -> bool {
        let bit = u32::from(number.saturating_sub(1));
        self.outputs().wrapping_shr(bit) & 1 == 1 && (1..=COILS).contains(&number)
    }

    fn inputs(&self, data: &[u8]) -> Outcome {
        let Some((start, quantity, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        within(start, quantity, FIRST_INPUT.saturating_sub(1), LAST_INPUT)?;
        let first = start.saturating_sub(FIRST_INPUT.saturating_sub(1));
        Ok(packed((0..quantity).map(|at| {
            let bit = first.saturating_add(at);
            let word = self.register(bit.wrapping_shr(4).saturating_add(9));
            word.wrapping_shr(u32::from(bit & 15)) & 1 == 1
        })))
    }

    fn registers(&mut self, function: u8, data: &[u8]) -> Outcome {
        let Some((start, quantity, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let is_watchdog = function == 3
            && start == WATCHDOG.saturating_sub(1)
            && quantity == 1
            && self.member.kind == Device::Ddc100Uec;
        if is_watchdog {
            let [a, b] = self.watchdog_s.to_be_bytes();
            return Ok(vec![2, a, b]);
        }
        if function == 3 {
            within(start, quantity, 0, LAST_REGISTER)?;
        } else {
            within(start, quantity, 4, 16)?;
        }
        let mut answer = vec![u8::try_from(quantity.saturating_mul(2)).unwrap_or(u8::MAX)];
        let numbers = (0..quantity).map(|at| start.saturating_add(at).saturating_add(1));
        let mut polled_faults = false;
        for number in numbers {
            polled_faults |= number == 10;
            answer.extend(self.register(number).to_be_bytes());
        }
        if polled_faults {
            self.was_reset = false;
        }
        Ok(answer)
    }

    fn write_coil(&mut self, data: &[u8]) -> Outcome {
        let Some((address, value, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let on = match value {
            0xFF00 => true,
            0 => false,
            _ => return Err(ILLEGAL_VALUE),
        };
        let number = address.saturating_add(1);
        if !self.has_coil(number) {
            return Err(ILLEGAL_ADDRESS);
        }
        self.force(number, on);
        Ok(data.to_vec())
    }

    fn write_coils(&mut self, data: &[u8]) -> Outcome {
        let Some((start, quantity, [count, bytes @ ..])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        if bytes.len() != usize::from(*count) || u16::from(*count) != quantity.div_ceil(8) {
            return Err(ILLEGAL_VALUE);
        }
        within(start, quantity, 0, COILS)?;
        let on = |at: u16| {
            let byte = bytes.get(usize::from(at >> 3)).copied().unwrap_or(0);
            byte.wrapping_shr(u32::from(at & 7)) & 1 == 1
        };
        // One after the other: coil 2 off stops what coil 1 on began (reading D28).
        for at in 0..quantity {
            let number = start.saturating_add(at).saturating_add(1);
            if self.has_coil(number) {
                self.force(number, on(at));
            }
        }
        Ok(data.get(..4).unwrap_or_default().to_vec())
    }

    /// Coils that do something (table 3.3).
    const fn has_coil(&self, number: u16) -> bool {
        match self.member.kind {
            Device::Ddc100Mx | Device::Ddc100MxB => matches!(number, 1..=9),
            Device::Ddc100Clamshell => matches!(number, 1..=6),
            Device::Ddc100Io => matches!(number, 3..=8),
            _ => matches!(number, 1..=3 | 6),
        }
    }

    fn force(&mut self, number: u16, on: bool) {
        match (number, on) {
            (1, true) => self.travel(0),
            (2, true) => self.travel(OPEN),
            // Off stops, whatever moves (reading D28).
            (1 | 2, false) => self.halt(),
            _ => {
                let bit = 1_u16.wrapping_shl(u32::from(number.saturating_sub(1)));
                if on {
                    self.relays |= bit;
                } else {
                    self.relays &= !bit;
                }
            }
        }
    }

    /// Goes somewhere, if it may: commands of the network count in REMOTE only, and no emergency
    /// shutdown is active.
    fn travel(&mut self, target: u64) {
        let may = self.is_remote() && !self.is_stuck() && !self.local_esd() && !self.network_esd;
        if may {
            self.drive.go(target);
        }
    }

    /// Stops, in REMOTE and in LOCAL (section 6.2, item 10).
    fn halt(&mut self) {
        if self.drive.motion != Motion::Still {
            self.drive.stop();
        }
    }

    fn write_register(&mut self, data: &[u8]) -> Outcome {
        let Some((address, value, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        match address.saturating_add(1) {
            1 => self.command(value)?,
            2 => self.argument = value,
            WATCHDOG if self.member.kind == Device::Ddc100Uec => self.watchdog_s = value,
            _ => return Err(ILLEGAL_ADDRESS),
        }
        Ok(data.to_vec())
    }

    fn write_registers(&mut self, data: &[u8]) -> Outcome {
        let Some((start, quantity, [count, bytes @ ..])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let words = quantity.checked_mul(2) == Some(u16::from(*count));
        if !words || bytes.len() != usize::from(*count) {
            return Err(ILLEGAL_VALUE);
        }
        within(start, quantity, 0, 2)?;
        let word = |number: u16| {
            let at = usize::from(number.checked_sub(start.saturating_add(1))?);
            let pair = bytes.get(at.saturating_mul(2)..)?.first_chunk::<2>()?;
            Some(u16::from_be_bytes(*pair))
        };
        // The message counts as a whole: the argument is there before the command (reading D20).
        if let Some(argument) = word(2) {
            self.argument = argument;
        }
        if let Some(command) = word(1) {
            self.command(command)?;
        }
        Ok(data.get(..4).unwrap_or_default().to_vec())
    }

    /// Register 1 (table 3.7, and the one-step move-to of section 3.2.6).
    fn command(&mut self, value: u16) -> Result<(), u8> {
        let percent = |p: u16| u64::from(p.min(100)).saturating_mul(1000);
        let valve = !self.is_io();
        match value {
            0 => {}
            256 if valve => self.travel(OPEN),
            512 if valve => self.halt(),
            768 if valve => self.travel(0),
            1280 if valve => {
                self.network_esd = true;
                self.drive.go(0);
            }
            1536 if valve => self.network_esd = false,
            6656 if valve => self.travel(percent(self.argument)),
            19_200..=19_300 if valve => self.travel(percent(value.saturating_sub(19_200))),
            _ => return self.relay(value),
        }
        Ok(())
    }

    /// Engages (2304 and on, in steps of 256) or disengages (4352 and on) a relay.
    fn relay(&mut self, value: u16) -> Result<(), u8> {
        let number = |from: u16| {
            let past = value.checked_sub(from)?;
            let number = past.checked_div(256)?.checked_add(1)?;
            (past & 0xFF == 0 && number <= 7).then_some(number)
        };
        let (relay, on) = match (number(4352), number(2304)) {
            (Some(relay), _) => (relay, false),
            (None, Some(relay)) => (relay, true),
            _ => return Err(ILLEGAL_VALUE),
        };
        let coil = match self.member.kind {
            // Relay n is coil n + 2 (reading D2).
            Device::Ddc100Mx | Device::Ddc100MxB => relay.saturating_add(2),
            // The first works K2, coil 7; the second K1, coil 8 (reading D3).
            Device::Ddc100Io if relay <= 2 => relay.saturating_add(6),
            Device::Ddc100Io if relay > 6 => return Err(ILLEGAL_VALUE),
            _ => relay,
        };
        if coil < 3 || !self.has_coil(coil) {
            return Err(ILLEGAL_VALUE);
        }
        self.force(coil, on);
        Ok(())
    }

    /// Table 3.8 has names only; what they count, and the listen-only mode, is as in the Modbus
    /// application protocol 1.1b3, section 6.8.
    fn diagnostics(&mut self, data: &[u8]) -> Outcome {
        let Some((sub, _, _)) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let counter = match sub {
            0 => return Ok(data.to_vec()),
            1 => {
                self.listens_only = false;
                self.counters = super::unit::Counters::default();
                return Ok(data.to_vec());
            }
            // The diagnostic register is for engineering use only.
            2 => 0,
            3 => return Ok(data.to_vec()),
            4 => {
                self.listens_only = true;
                return Ok(data.to_vec());
            }
            10 => {
                self.counters = super::unit::Counters::default();
                return Ok(data.to_vec());
            }
            11 => self.counters.bus,
            12 => self.counters.damaged,
            13 => self.counters.exceptions,
            14 => self.counters.own,
            _ => return Err(ILLEGAL_FUNCTION),
        };
        let [s0, s1] = sub.to_be_bytes();
        let [c0, c1] = counter.to_be_bytes();
        Ok(vec![s0, s1, c0, c1])
    }
}

/// Checks that a quantity is at least 1 and stays between two addresses.
const fn within(start: u16, quantity: u16, first: u16, end: u16) -> Result<(), u8> {
    if quantity == 0 || quantity > 125 {
        return Err(ILLEGAL_VALUE);
    }
    match start.checked_add(quantity) {
        Some(past) if start >= first && past <= end => Ok(()),
        _ => Err(ILLEGAL_ADDRESS),
    }
}

/// Byte count and bits, the first one lowest.
fn packed(all: impl Iterator<Item = bool>) -> Vec<u8> {
    let all: Vec<bool> = all.collect();
    let bytes = all.chunks(8).map(|eight| {
        eight
            .iter()
            .rev()
            .fold(0_u8, |byte, on| byte << 1 | u8::from(*on))
    });
    let bytes: Vec<u8> = bytes.collect();
    let mut answer = vec![u8::try_from(bytes.len()).unwrap_or(u8::MAX)];
    answer.extend(bytes);
    answer
}
