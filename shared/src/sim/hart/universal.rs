//! Universal commands (table 12).

use super::device::{Answer, Control, HartDevice, of_master, set_master};
use super::text::{number, three};
use crate::device::Family;

/// Units (table 2 of the common tables) and classifications (table 21).
pub(super) const PERCENT: u8 = 57;
const MILLIAMPERE: u8 = 39;
const NOT_USED: u8 = 250;
const ANALYTICAL: u8 = 81;
const CURRENT: u8 = 84;
/// Device variable status: good, manual or fixed, bad and constant; and limits.
const GOOD: u8 = 0xC0;
const FIXED: u8 = 0x80;
const BAD: u8 = 0x30;
const LOW: u8 = 0x10;
const HIGH: u8 = 0x20;

/// A device variable as it stands.
struct Variable {
    class: u8,
    units: u8,
    value: Option<f32>,
    status: u8,
}

impl HartDevice {
    pub(super) fn universal(&mut self, command: u8, data: &[u8], primary: bool) -> Answer {
        match command {
            0 | 11 | 21 => Answer::of(self.identity()),
            1 => {
                let pv = self.variable(1);
                Answer::of([&[PERCENT][..], &number(pv.value)].concat())
            }
            2 => {
                let percent = self.variable(244);
                let current = number(Some(self.signal.measured()));
                Answer::of([current, number(percent.value)].concat())
            }
            3 => {
                let mut answer = number(Some(self.signal.measured())).to_vec();
                for code in 1..=4 {
                    let variable = self.variable(code);
                    answer.push(variable.units);
                    answer.extend(number(variable.value));
                }
                Answer::of(answer)
            }
            6 => self.write_polling(data),
            7 => Answer::of([self.polling, u8::from(self.loop_mode)]),
            8 => Answer::of([ANALYTICAL; 4]),
            9 => self.variables(data),
            12 => Answer::of(self.notes.message),
            13 => Answer::of(self.tag()),
            14 => {
                let limits = [100.0_f32, 0.0, 1.0].map(f32::to_be_bytes).concat();
                Answer::of([&three(self.notes.serial)[..], &[PERCENT], &limits].concat())
            }
            15 => {
                let range = [self.signal.upper, self.signal.lower, self.signal.damping];
                let range = range.map(f32::to_be_bytes).concat();
                // No alarm selection, linear; no write protection; the channel is an input.
                let head = [251, 0, PERCENT];
                Answer::of([&head[..], &range, &[251, NOT_USED, 1]].concat())
            }
            16 => Answer::of(three(self.notes.assembly)),
            17 => self.write(data, |device, bytes: [u8; 24]| {
                device.notes.message = bytes;
                true
            }),
            18 => self.write_tag(data),
            19 => self.write(data, |device, [a, b, c]: [u8; 3]| {
                device.notes.assembly = u32::from_be_bytes([0, a, b, c]);
                true
            }),
            20 => Answer::of(self.notes.long_tag),
            22 => self.write(data, |device, bytes: [u8; 32]| {
                device.notes.long_tag = bytes;
                true
            }),
            38 => self.reset_changed(data, primary),
            48 => self.additional(data),
            _ => Answer::error(64),
        }
    }

    fn identity(&self) -> Vec<u8> {
        let [_, a, b, c] = self.setup.device_id.to_be_bytes();
        let [high, low] = self.counter.to_be_bytes();
        let own = self.own_status();
        let extended = self.state.extended(self.setup.family, own);
        let (wanted, preambles) = (self.setup.wanted, self.setup.preambles);
        // HART 7, device revision 2 (note 1), software 1, hardware 1 on FSK, no flags.
        let mut identity = vec![254, 0x6E, 0xDD, wanted, 7, 2, 1, 0x08, 0, a, b, c];
        // Last variable 4, maker and label 110, process automation device.
        identity.extend([preambles, 4, high, low, extended, 0, 0x6E, 0, 0x6E, 1]);
        identity
    }

    /// Takes over bytes that are stored as they come, and repeats them.
    fn write<const N: usize>(
        &mut self,
        data: &[u8],
        take: impl Fn(&mut Self, [u8; N]) -> bool,
    ) -> Answer {
        let Some(bytes) = data.first_chunk::<N>() else {
            return Answer::error(5);
        };
        if take(self, *bytes) {
            self.note_change();
        }
        Answer::of(*bytes)
    }

    fn tag(&self) -> Vec<u8> {
        let notes = &self.notes;
        [&notes.tag[..], &notes.descriptor, &notes.date].concat()
    }

    fn write_tag(&mut self, data: &[u8]) -> Answer {
        let Some((tag, rest)) = data.split_first_chunk::<6>() else {
            return Answer::error(5);
        };
        let Some((descriptor, rest)) = rest.split_first_chunk::<12>() else {
            return Answer::error(5);
        };
        let Some(date) = rest.first_chunk::<3>() else {
            return Answer::error(5);
        };
        if !exists(*date) {
            return Answer::error(9);
        }
        self.notes.tag = *tag;
        self.notes.descriptor = *descriptor;
        self.notes.date = *date;
        self.note_change();
        Answer::of(self.tag())
    }

    /// Command 6. With one byte, as HART 5 sends it, an address other than 0 means multidrop.
    fn write_polling(&mut self, data: &[u8]) -> Answer {
        let (polling, mode) = match *data {
            [] => return Answer::error(5),
            [polling] => (polling, u8::from(polling == 0)),
            [polling, mode, ..] => (polling, mode),
        };
        if polling > 63 {
            return Answer::error(2);
        }
        if mode > 1 {
            return Answer::error(12);
        }
        self.polling = polling;
        self.loop_mode = mode == 1;
        if !self.loop_mode {
            self.signal.fixed = None;
        }
        self.note_change();
        Answer::of(data.get(..2).unwrap_or(data))
    }

    fn variable(&self, code: u8) -> Variable {
        let percent = |value: Option<f32>, status: u8| Variable {
            class: ANALYTICAL,
            units: PERCENT,
            value: value.filter(|_| status != BAD),
            status,
        };
        let board = if self.state.board { GOOD } else { BAD };
        let outside = self.signal.is_outside();
        let limit = match (outside, self.signal.measured() < 12.0) {
            (false, _) => GOOD,
            (true, true) => GOOD | LOW,
            (true, false) => GOOD | HIGH,
        };
        let analog = self.control == Control::Analog;
        match code {
            0 | 245 => Variable {
                class: CURRENT,
                units: MILLIAMPERE,
                value: Some(self.signal.measured()),
                status: if self.signal.fixed.is_some() {
                    FIXED
                } else {
                    limit
                },
            },
            // In modes 1, 2 and 3 the primary variable has no value (table 17).
            1 | 246 => match self.control {
                Control::Analog => percent(Some(self.signal.demand()), limit),
                Control::Digital(_) => percent(None, FIXED),
                Control::Factory(_) | Control::Discrete(_) => percent(None, BAD),
            },
            244 if analog => percent(Some(self.signal.percent()), limit),
            244 => percent(None, BAD),
            2 | 247 => percent(Some(self.valve.reported()), board),
            3 | 248 => percent(Some(self.valve.effort()), board),
            4 | 249 => match self.control {
                Control::Factory(_) => percent(Some(self.valve.factory()), FIXED),
                // Table 3: on the IQ the same as the primary variable (reading R35).
                Control::Analog if self.setup.family == Family::Iq => {
                    percent(Some(self.signal.demand()), limit)
                }
                _ => percent(None, BAD),
            },
            _ => Variable {
                class: 0,
                units: NOT_USED,
                value: None,
                status: BAD,
            },
        }
    }

    fn variables(&self, data: &[u8]) -> Answer {
        if data.is_empty() {
            return Answer::error(5);
        }
        let own = self.own_status();
        let mut answer = vec![self.state.extended(self.setup.family, own)];
        for code in data.iter().take(8).copied() {
            let variable = self.variable(code);
            answer.extend([code, variable.class, variable.units]);
            answer.extend(number(variable.value));
            answer.push(variable.status);
        }
        answer.extend(self.ticks().to_be_bytes());
        Answer::of(answer)
    }

    /// Command 38: the flag of the master that asks; without a counter, of both.
    fn reset_changed(&mut self, data: &[u8], primary: bool) -> Answer {
        match *data {
            [] => {
                self.changed = [false; 2];
                Answer::of([])
            }
            [_] => Answer::error(5),
            [high, low, ..] if u16::from_be_bytes([high, low]) != self.counter => Answer::error(9),
            [high, low, ..] => {
                if of_master(self.changed, primary) {
                    set_master(&mut self.changed, primary, false);
                }
                Answer::of([high, low])
            }
        }
    }

    /// Command 48, and with the bytes last read: More Status Available goes away.
    fn additional(&mut self, data: &[u8]) -> Answer {
        let bytes = self.status_bytes();
        if data.is_empty() {
            return Answer::of(bytes);
        }
        if data.len() < 9 {
            return Answer::error(5);
        }
        if data != bytes {
            return Answer {
                code: 14,
                data: bytes,
            };
        }
        let own = self.own_status();
        self.state.acknowledge(self.setup.family, own);
        Answer::of(bytes)
    }

    /// What command 48 answers.
    fn status_bytes(&self) -> Vec<u8> {
        let own = self.own_status();
        let extended = self.state.extended(self.setup.family, own);
        let forced = matches!(self.control, Control::Digital(_) | Control::Factory(_));
        let simulates = self.state.frozen.is_some();
        let mut bytes = own.to_vec();
        bytes.extend([extended, 0, u8::from(forced), u8::from(simulates)]);
        bytes.resize(25, 0);
        // Standardized status 1 is the tenth byte; it is there when it says something.
        let len = usize::from(self.setup.status_len.clamp(9, 25)).max(9);
        let len = if simulates { len.max(10) } else { len };
        bytes.truncate(len);
        bytes
    }
}

/// True for a day that exists, worked out apart from the decoder: day, month, year since 1900.
fn exists([day, month, year]: [u8; 3]) -> bool {
    let year = u16::from(year).saturating_add(1900);
    let leap = year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let february = if leap { 29 } else { 28 };
    let lengths = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let length = lengths.get(usize::from(month.wrapping_sub(1)));
    length.is_some_and(|length| (1..=*length).contains(&day))
}
