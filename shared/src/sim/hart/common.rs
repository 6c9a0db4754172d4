//! Common-practice commands (table 13).

use super::device::{Answer, Control, HartDevice};
use super::state::ENTRIES;
use super::text::float;
use super::universal::PERCENT;
use crate::device::Family;

/// Indexes of the condensed status map that can be written and simulated (section 8.1).
const WRITABLE: core::ops::Range<usize> = 8..40;
/// Longest damping in seconds (section 8.1).
const DAMPING: f32 = 250.0;

impl HartDevice {
    /// `None` for a command that this family does not have.
    pub(super) fn common(&mut self, command: u16, data: &[u8]) -> Option<Answer> {
        let cma = self.setup.family == Family::Cma;
        Some(match command {
            34 if !cma => self.write_damping(data),
            35 => self.write_range(data),
            40 if !cma => self.fix_current(data),
            42 => {
                self.resets = true;
                Answer::of([])
            }
            45 => self.trim(data, 3.0..=5.0, Self::trim_zero),
            46 => self.trim(data, 19.0..=21.0, Self::trim_gain),
            49 => match data.first_chunk::<3>() {
                Some([a, b, c]) => {
                    self.notes.serial = u32::from_be_bytes([0, *a, *b, *c]);
                    self.note_change();
                    Answer::of([*a, *b, *c])
                }
                None => Answer::error(5),
            },
            79 => self.force(data),
            523 => self.read_map(data),
            524 => self.write_map(data),
            525 => {
                self.state.map = [0; ENTRIES];
                self.note_change();
                Answer::of([])
            }
            526 => self.simulate_status(data),
            527 => self.simulate_bit(data),
            _ => return None,
        })
    }

    fn write_damping(&mut self, data: &[u8]) -> Answer {
        let Some(seconds) = float(data, 0) else {
            return Answer::error(5);
        };
        if seconds > DAMPING {
            return Answer::error(3);
        }
        if seconds < 0.0 || seconds.is_nan() {
            return Answer::error(4);
        }
        self.signal.damping = seconds;
        self.note_change();
        Answer::of(seconds.to_be_bytes())
    }

    /// Command 35: units, upper, lower.
    fn write_range(&mut self, data: &[u8]) -> Answer {
        let (Some(units), Some(upper), Some(lower)) =
            (data.first(), float(data, 1), float(data, 5))
        else {
            return Answer::error(5);
        };
        if *units != PERCENT {
            return Answer::error(18);
        }
        let fits = |value: f32| (0.0..=100.0).contains(&value);
        match (fits(lower), fits(upper)) {
            (false, false) => return Answer::error(13),
            (false, true) => return Answer::error(if lower > 100.0 { 9 } else { 10 }),
            (true, false) => return Answer::error(if upper > 100.0 { 11 } else { 12 }),
            (true, true) => {}
        }
        let span = (upper - lower).abs();
        if span == 0.0 {
            return Answer::error(29);
        }
        self.signal.upper = upper;
        self.signal.lower = lower;
        self.note_change();
        Answer {
            // The smallest span that command 14 names is 1 %; a smaller one is taken with a warning.
            code: if span < 1.0 { 14 } else { 0 },
            data: data.get(..9).unwrap_or(data).to_vec(),
        }
    }

    /// Command 40: simulates an input current; 0 mA ends it.
    fn fix_current(&mut self, data: &[u8]) -> Answer {
        let Some(current) = float(data, 0) else {
            return Answer::error(5);
        };
        if !self.loop_mode {
            return Answer::error(11);
        }
        if current == 0.0 {
            self.signal.fixed = None;
        } else if current > *super::signal::LINEAR.end() {
            return Answer::error(3);
        } else if super::signal::LINEAR.contains(&current) {
            self.signal.fixed = Some(current);
        } else {
            return Answer::error(4);
        }
        Answer::of(current.to_be_bytes())
    }

    fn trim_zero(&mut self, current: f32) {
        self.signal.trim_zero(current);
    }

    fn trim_gain(&mut self, current: f32) {
        self.signal.trim_gain(current);
    }

    /// Commands 45 and 46: what was measured outside is what flows.
    fn trim(
        &mut self,
        data: &[u8],
        near: core::ops::RangeInclusive<f32>,
        apply: fn(&mut Self, f32),
    ) -> Answer {
        let Some(current) = float(data, 0) else {
            return Answer::error(5);
        };
        if !self.loop_mode {
            return Answer::error(11);
        }
        if current > *near.end() {
            return Answer::error(3);
        }
        if !near.contains(&current) {
            return Answer::error(4);
        }
        if !near.contains(&self.signal.current) {
            return Answer::error(9);
        }
        apply(self, current);
        self.note_change();
        Answer::of(current.to_be_bytes())
    }

    /// Command 79: variables 1 and 4, one at a time, in percent.
    fn force(&mut self, data: &[u8]) -> Answer {
        let [code, mode, units, a, b, c, d, _status, ..] = *data else {
            return Answer::error(5);
        };
        let value = f32::from_be_bytes([a, b, c, d]);
        let forced = match self.control {
            Control::Digital(_) => Some(1),
            Control::Factory(_) => Some(4),
            Control::Analog | Control::Discrete(_) => None,
        };
        match code {
            1 | 4 => {}
            0 | 2 | 3 => return Answer::error(19),
            _ => return Answer::error(17),
        }
        match mode {
            0 if forced == Some(code) => self.control = Control::Analog,
            0 => {}
            1 if units != PERCENT => return Answer::error(18),
            1 if forced.is_some_and(|f| f != code) => return Answer::error(6),
            1 if !(0.0..=100.0).contains(&value) => return Answer::error(6),
            1 if !self.state.board => return Answer::error(6),
            1 if code == 1 => self.control = Control::Digital(value),
            1 => self.control = Control::Factory(value),
            _ => return Answer::error(10),
        }
        Answer::of(data.get(..8).unwrap_or(data))
    }

    /// Command 523: an even number of entries from an even index on, as far as there are any.
    fn read_map(&self, data: &[u8]) -> Answer {
        let [start, count, ..] = *data else {
            return Answer::error(5);
        };
        let first = usize::from(start & 0xFE);
        let room = ENTRIES.saturating_sub(first);
        let count = usize::from(count & 0xFE).min(room);
        if count == 0 {
            return Answer::error(2);
        }
        let entries = self.state.map.get(first..first.saturating_add(count));
        let packed = entries.unwrap_or(&[]).chunks(2).map(|pair| match *pair {
            [low, high] => high << 4 | low & 0x0F,
            _ => 0,
        });
        let byte = |n: usize| u8::try_from(n).unwrap_or(0);
        Answer::of(
            [byte(first), byte(count)]
                .into_iter()
                .chain(packed)
                .collect::<Vec<_>>(),
        )
    }

    fn write_map(&mut self, data: &[u8]) -> Answer {
        let [start, count, ref packed @ ..] = *data else {
            return Answer::error(5);
        };
        let first = usize::from(start);
        let end = first.saturating_add(usize::from(count));
        let even = start & 1 == 0 && count & 1 == 0 && count > 0;
        if !even || first < WRITABLE.start || end > WRITABLE.end {
            return Answer::error(2);
        }
        let Some(packed) = packed.get(..usize::from(count / 2)) else {
            return Answer::error(5);
        };
        let entries: Vec<u8> = packed.iter().flat_map(|b| [b & 0x0F, b >> 4]).collect();
        // 2 and 7 to 15 are reserved (common table 70).
        if entries.iter().any(|code| !matches!(code, 0 | 1 | 3..=6)) {
            return Answer::error(2);
        }
        if let Some(slots) = self.state.map.get_mut(first..end) {
            slots.copy_from_slice(&entries);
        }
        self.note_change();
        Answer::of([&[start, count], packed].concat())
    }

    fn simulate_status(&mut self, data: &[u8]) -> Answer {
        match *data {
            [] => return Answer::error(5),
            [0, ..] => self.state.frozen = None,
            [1, ..] if self.state.frozen.is_none() => {
                self.state.frozen = Some((self.own_status(), self.base_status()));
            }
            [1, ..] => {}
            _ => return Answer::error(2),
        }
        Answer::of(data.get(..1).unwrap_or(data))
    }

    fn simulate_bit(&mut self, data: &[u8]) -> Answer {
        let [index, value, ..] = *data else {
            return Answer::error(5);
        };
        let at = usize::from(index);
        if !WRITABLE.contains(&at) || value > 1 {
            return Answer::error(2);
        }
        let Some((bytes, _)) = &mut self.state.frozen else {
            return Answer::error(16);
        };
        let mask = 1_u8.wrapping_shl(u32::from(index & 7));
        if let Some(byte) = bytes.get_mut(at.saturating_sub(8) / 8) {
            *byte = if value == 1 {
                *byte | mask
            } else {
                *byte & !mask
            };
        }
        Answer::of([index, value])
    }
}
