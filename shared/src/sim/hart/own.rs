//! Device-specific commands (table 14).

use super::device::{Answer, Control, HartDevice, has_relays};
use super::setup::HartSelector;
use super::text::latin;
use super::valve::Way;
use crate::device::Family;

/// The command could not be carried out by the main board.
const INCORRECT: u8 = 73;

impl HartDevice {
    /// `None` for a command that this family does not have.
    pub(super) fn own(&mut self, command: u8, data: &[u8]) -> Option<Answer> {
        Some(match command {
            // Firmware V105 (note 1), in the forms of section 9.1.
            128 if self.setup.family == Family::Cva => Answer::of(latin::<12>("1.05 (0312)", 0)),
            128 => Answer::of(latin::<12>("v105+( 0312)", 0)),
            129 if self.setup.family == Family::Cva => self.status_data(data),
            131 => {
                let (zero, span) = self.signal.ends();
                Answer::of([zero, span].map(f32::to_be_bytes).concat())
            }
            132 => self.control_digitally(data),
            133 if !self.state.board => Answer::error(INCORRECT),
            133 => Answer::of([match self.control {
                Control::Analog => 0,
                Control::Digital(_) => 1,
                Control::Factory(_) => 2,
                Control::Discrete(_) => 3,
            }]),
            134 if has_relays(self.setup.family) => self.control_relays(data),
            _ => return None,
        })
    }

    /// Command 129: functional block 0200h, index 0 (reading R26).
    fn status_data(&self, data: &[u8]) -> Answer {
        match *data {
            [0x02, 0x00, 0x00, ..] if !self.state.board => Answer::error(INCORRECT),
            [0x02, 0x00, 0x00, ..] => {
                let [high, low] = self.actuator_status().to_be_bytes();
                Answer::of([0x02, 0x01, 0x00, high, low])
            }
            _ => Answer::error(2),
        }
    }

    /// The register of table 15. Injected bits of command 48 that mean the same stand here too.
    fn actuator_status(&self) -> u16 {
        let [own_0, _, _, own_3, ..] = self.own_status();
        let on = |condition: bool, bit: u16| if condition { bit } else { 0 };
        let stalled = self.valve.stalled;
        // Alarms of tables 6 that are no position of the knob.
        let fault = self.own_status().iter().take(3).any(|b| *b != 0) || own_3 & 0x3F != 0;
        on(fault, 1 << 4)
            | on(own_3 & 0x10 != 0 || stalled == Some(Way::Close), 1 << 1)
            | on(own_3 & 0x08 != 0 || stalled == Some(Way::Open), 1 << 2)
            | on(own_0 & 0x80 != 0, 1 << 5)
            | on(own_0 & 0x40 != 0, 1 << 6)
            | on(self.valve.is_open(), 1 << 9)
            | on(self.valve.is_closed(), 1 << 10)
            | on(self.state.selector == HartSelector::Stop, 1 << 11)
            | on(self.state.selector == HartSelector::Remote, 1 << 12)
            | on(self.state.selector == HartSelector::Local, 1 << 13)
            | on(self.signal.is_dead(), 1 << 14)
            | on(own_3 & 0x20 != 0, 1 << 15)
    }

    /// Command 132. Without bit 5 nothing else counts, and the analogue input is back.
    fn control_digitally(&mut self, data: &[u8]) -> Answer {
        let Some(register) = data.first().copied() else {
            return Answer::error(5);
        };
        let partial = matches!(self.setup.family, Family::Iq | Family::Si | Family::Ck);
        if register & 0xC0 != 0 || register & 0x10 != 0 && !partial {
            return Answer::error(2);
        }
        if !self.state.board {
            return Answer::error(INCORRECT);
        }
        self.control = if register & 0x20 != 0 {
            Control::Discrete(register)
        } else {
            Control::Analog
        };
        Answer::of([register])
    }

    /// Command 134: a relay whose set and reset bits are both 1 stays as it is (reading R34).
    fn control_relays(&mut self, data: &[u8]) -> Answer {
        let [set_low, set_high, reset_low, reset_high] = *data else {
            return Answer::error(if data.len() < 4 { 5 } else { 75 });
        };
        let set = u16::from_be_bytes([set_high, set_low]);
        let reset = u16::from_be_bytes([reset_high, reset_low]);
        if (set | reset) & !self.setup.relays != 0 {
            return Answer::error(74);
        }
        if !self.state.board {
            return Answer::error(INCORRECT);
        }
        self.state.relays |= set & !reset;
        self.state.relays &= !(reset & !set);
        Answer::of(data)
    }
}
