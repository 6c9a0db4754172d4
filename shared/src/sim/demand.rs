//! What is wanted of the valve: by the bus, by a test, or by its programme.

use super::drive::Demand;
use super::store::at;
use super::{Icon3000, Programme, Pst, RESUME_MS, bit, command};

impl Icon3000 {
    /// True while the bus wants something.
    pub(super) fn is_commanded(&self) -> bool {
        self.bits != 0 || self.command != command::NONE || self.pst != Pst::Off
    }

    pub(super) fn has(&self, bit: u16) -> bool {
        self.bits & bit != 0
    }

    pub(super) fn is_esd(&self) -> bool {
        self.has(bit::ESD) || self.command == command::ESD
    }

    pub(super) fn is_positioner(&self) -> bool {
        self.has(bit::POSITIONER) || self.command == command::POSITIONER
    }

    /// True if the bus was silent for too long and the actuator acts on it (section 9.3).
    pub(super) fn is_fail_safe(&self) -> bool {
        let enabled = !self.is_v2() || self.store.get(at::FAIL_SAFE_ENABLED) == 1;
        let delay = u32::from(self.store.get(at::FAIL_SAFE_DELAY)).saturating_add(10);
        enabled
            && self.store.get(at::FAIL_SAFE_ACTION) != 0
            && self.since_message_ms >= delay.saturating_mul(1000)
    }

    /// What the motor is to do, by priority: ESD, stop, fail-safe, test, positioner, open and close,
    /// and at last the programme.
    pub(super) fn demand(&self) -> Demand {
        if self.drive.no_mains {
            return Demand::Stop;
        }
        if self.is_esd() {
            let (action, position) = if self.is_v2() {
                (
                    self.store.get(at::ESD_ACTION),
                    self.store.get(at::ESD_POSITION),
                )
            } else {
                (1, 0)
            };
            return action_of(action, position);
        }
        if self.has(bit::STOP) {
            return Demand::Stop;
        }
        if self.is_fail_safe() {
            let position = self.store.get(at::FAIL_SAFE_POSITION);
            return action_of(self.store.get(at::FAIL_SAFE_ACTION), position);
        }
        match self.pst {
            Pst::Away(target) => return Demand::Reach(target.saturating_sub(self.coast())),
            Pst::Pause(_) => return Demand::Stop,
            Pst::Back => return Demand::Open,
            Pst::Off => {}
        }
        if self.is_positioner() {
            let wanted = u32::from(self.store.get(at::POSITION_REQUEST));
            return Demand::Follow(wanted.saturating_mul(100));
        }
        match (self.has(bit::OPEN), self.has(bit::CLOSE), self.command) {
            (true, false, _) | (false, false, command::OPEN) => Demand::Open,
            (false, true, _) | (false, false, command::CLOSE) => Demand::Close,
            (true, true, _) => Demand::Stop,
            _ => self.programmed(),
        }
    }

    /// What the programme wants.
    fn programmed(&self) -> Demand {
        if self.since_command_ms < RESUME_MS {
            return Demand::Stop;
        }
        match self.programme {
            Programme::Idle => Demand::Stop,
            Programme::Strokes => match self.age_ms.checked_rem(100_000).unwrap_or(0) {
                10_000..50_000 => Demand::Open,
                60_000.. => Demand::Close,
                _ => Demand::Stop,
            },
            Programme::Modulating => Demand::Follow(self.signal()),
        }
    }

    /// The signal that a modulating actuator follows, in thousandths of a percent.
    pub(super) fn signal(&self) -> u32 {
        const LEVELS: [u32; 12] = [
            42_000, 44_500, 51_000, 63_000, 60_500, 58_000, 71_000, 66_000, 49_000, 37_500, 28_000,
            35_000,
        ];
        let which = self.age_ms.checked_div(15_000).unwrap_or(0);
        let which = which.checked_rem(12).unwrap_or(0);
        let which = usize::try_from(which).unwrap_or(0);
        LEVELS.get(which).copied().unwrap_or(0)
    }
}

/// What ESD and fail-safe actions mean: 0 off, 1 close, 2 open, 3 stay put, 4 go to percent.
fn action_of(action: u16, position: u16) -> Demand {
    match action {
        1 => Demand::Close,
        2 => Demand::Open,
        4 => Demand::Reach(u32::from(position).saturating_mul(1000)),
        _ => Demand::Stop,
    }
}
