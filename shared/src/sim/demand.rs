//! What is wanted of the valve: by the bus, by a test, or by its programme.

use super::drive::{self, Demand};
use super::history;
use super::store::at;
use super::{Icon3000, Programme, Pst, RESUME_MS, STEP_MS, bit, command};

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
            Pst::Away(target) => return Demand::Reach(target),
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

    /// Goes on with a partial stroke test (section 12).
    pub(super) fn test(&mut self) {
        if self.pst == Pst::Off {
            return;
        }
        // A shutdown or a stop ends the test (table 39, note 5: bits 3 and 2).
        let reset = u32::from(self.is_esd()) << 3 | u32::from(self.has(bit::STOP)) << 2;
        if reset != 0 {
            self.test.reset = reset;
            return self.end_test(3, 1 << 4);
        }
        self.test_tenths = self.test_tenths.saturating_add(1);
        let gone = drive::OPEN.saturating_sub(self.drive.position());
        let percent = usize::try_from(gone.checked_div(1000).unwrap_or(0)).unwrap_or(0);
        self.pst = match self.pst {
            Pst::Off => return,
            Pst::Away(target) if self.drive.position() <= target => {
                self.reached(percent);
                let pause = u32::from(self.store.get(at::PST_PAUSE));
                Pst::Pause(pause.saturating_mul(1000))
            }
            Pst::Away(target) => {
                self.reached(percent);
                Pst::Away(target)
            }
            Pst::Pause(0) => {
                self.test_tenths = 0;
                Pst::Back
            }
            Pst::Pause(left) => Pst::Pause(left.saturating_sub(STEP_MS)),
            Pst::Back if self.drive.is_open() => {
                self.returned(0);
                return self.end_test(1, 1);
            }
            Pst::Back => {
                self.returned(percent);
                Pst::Back
            }
        };
    }

    /// Notes the time of every percent that was passed on the way.
    fn reached(&mut self, percent: usize) {
        while self.test.away.len() <= percent.min(50) {
            self.test.away.push(self.test_tenths);
        }
    }

    /// Notes the time of every percent that was passed on the way back; the way begins at the far
    /// end, and the file at 1 %.
    fn returned(&mut self, percent: usize) {
        for time in self.test.back.iter_mut().skip(percent) {
            if *time == 0 {
                *time = self.test_tenths;
            }
        }
    }

    fn end_test(&mut self, result: u16, status: u16) {
        self.store.set(at::PST_STATUS, status);
        self.store
            .long(at::PST_STATUS.saturating_add(1), self.test.reset);
        self.test.result = result;
        self.test.status = status;
        let baseline = self.command == command::BASELINE_PST;
        let test = core::mem::take(&mut self.test);
        self.history.test(&test, self.wall, baseline);
        if matches!(self.command, command::PST | command::BASELINE_PST) {
            self.command = command::NONE;
        }
        self.pst = Pst::Off;
    }

    /// Begins a partial stroke test, if the set-up allows it and the valve is open.
    pub(super) fn begin_test(&mut self) {
        let allowed = self.is_v2()
            && self.store.get(at::EFS_INPUT_MODE) == 0
            && self.store.get(at::INTERLOCK_MODE) == 1;
        if allowed && self.pst == Pst::Off && self.drive.is_open() {
            let percent = self.store.get(at::PST_TRAVEL);
            let travel = u32::from(percent).saturating_mul(1000);
            self.pst = Pst::Away(drive::OPEN.saturating_sub(travel));
            self.test = history::Partial {
                back: vec![0; usize::from(percent.min(50))],
                travel: percent,
                ..history::Partial::default()
            };
            self.test_tenths = 0;
        } else if matches!(self.command, command::PST | command::BASELINE_PST) {
            self.command = command::NONE;
        }
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
