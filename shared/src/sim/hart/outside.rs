//! What stands around the device and can be changed, and what can be looked at.

use super::device::{Control, HartDevice};
use super::setup::{HartSelector, HartSetup};
use super::state::{OWN, State};

impl HartDevice {
    /// The current on its loop, in mA, unless a programme drives it.
    pub const fn set_signal(&mut self, current: f32) {
        self.signal.current = current;
    }

    /// Turns the selector of the actuator.
    pub const fn set_selector(&mut self, selector: HartSelector) {
        self.state.selector = selector;
    }

    /// Blocks the valve, or frees it: after 10 s the actuator is stalled.
    pub const fn set_stuck(&mut self, stuck: bool) {
        self.valve.stuck = stuck;
    }

    /// Cuts the field unit off from the main board, or connects it again.
    pub const fn set_main_board(&mut self, reached: bool) {
        self.state.board = reached;
    }

    /// Sets or clears a status bit of command 48 by its key in the map of the family, or as
    /// `byte.bit`; false if there is no such bit.
    pub fn inject(&mut self, bit: &str, on: bool) -> bool {
        let found = State::find(self.setup.family, bit);
        if let Some((byte, mask)) = found
            && let Some(slot) = self.state.injected.get_mut(byte)
        {
            *slot = if on { *slot | mask } else { *slot & !mask };
        }
        found.is_some()
    }

    /// Bits of the device status that stand in any case.
    pub const fn inject_device_status(&mut self, bits: u8) {
        self.state.device = bits;
    }

    /// Puts it under digital control (command 79, variable 1) with this demand in percent, as a master
    /// may have left it; the valve does not follow the loop current then (table 17).
    pub const fn set_digital(&mut self, percent: f32) {
        self.control = Control::Digital(percent);
    }

    /// Puts it under factory control (command 79, variable 4) with this percentage of the factory
    /// stroke (table 17).
    pub const fn set_factory(&mut self, percent: f32) {
        self.control = Control::Factory(percent);
    }

    /// Makes it busy (code 32) for so many requests.
    pub const fn set_busy(&mut self, requests: u32) {
        self.faults.busy = requests;
    }

    /// Lets it miss so many requests.
    pub const fn set_silent(&mut self, requests: u32) {
        self.faults.silent = requests;
    }

    /// Damages its next answers, so many.
    pub const fn set_damaged(&mut self, answers: u32) {
        self.faults.damaged = answers;
    }

    /// Delays its next answers beyond the slave time-out, so many.
    pub const fn set_late(&mut self, answers: u32) {
        self.faults.late = answers;
    }

    /// Switches it off and on again.
    pub fn power_cycle(&mut self) {
        self.reset();
    }

    /// What it is.
    #[must_use]
    pub const fn setup(&self) -> &HartSetup {
        &self.setup
    }

    /// Position in percent between the user's limits.
    #[must_use]
    pub fn position(&self) -> f32 {
        self.valve.user()
    }

    /// Its status bytes as command 48 would answer them.
    #[must_use]
    pub fn own_status(&self) -> [u8; OWN] {
        self.state.own(&self.setup, &self.valve, &self.signal)
    }

    /// Energised relays; bit 0 is relay 1.
    #[must_use]
    pub const fn relays(&self) -> u16 {
        self.state.relays
    }

    /// Requests for it that it understood, and answers that it sent.
    #[must_use]
    pub const fn exchanges(&self) -> (u32, u32) {
        (self.heard, self.answered)
    }

    /// Its long address without master bit.
    #[must_use]
    pub fn long_address(&self) -> [u8; 5] {
        let [_, a, b, c] = self.setup.device_id.to_be_bytes();
        // 6EDDh, of which 14 bits travel.
        [0x2E, 0xDD, a, b, c]
    }
}
