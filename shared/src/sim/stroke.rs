//! Partial stroke tests: how they run, and what may end them (section 12, table 39).
//!
//! Reading E89: the limits are percent of something that is not stated. Here the times are percent of
//! those of the reference, by travel; the over-travel is percent of the whole stroke.
//!
//! An ICON3000 tests as well (tables 2 and 5), by the modes in HR 3027 and 3028. It has registers
//! neither for the settings of a test nor for what came of it but HR 3003 and 3009, and no files: its
//! settings here are those that an ICON3000v2 starts with.

use super::drive;
use super::history::Partial;
use super::store::at;
use super::{Fault, Icon3000, Pst, STEP_MS, bit, command};
use crate::map::row::Model;

/// How far the valve coasts beyond its target, in thousandths of a percent: usually, and when it
/// goes too far.
const COAST: u32 = 400;
const TOO_FAR: u32 = 6_000;
/// How many times slower a valve is that is slow.
const SLOW: u32 = 4;
/// T-PST and T-RET of the reference of an ICON3000 in tenths of a second, and its travel in percent.
const REFERENCE: ([u16; 2], u16) = ([49, 47], 15);

/// What may come of a test: code of table 39, note 1, and bit of note 4.
#[derive(Clone, Copy)]
enum End {
    Passed,
    Reset,
    TooSlowAway,
    TooSlowBack,
    TooFar,
}

impl End {
    const fn result(self) -> u16 {
        match self {
            Self::Passed => 1,
            Self::Reset => 3,
            Self::TooSlowAway => 4,
            Self::TooSlowBack => 5,
            Self::TooFar => 6,
        }
    }

    const fn status(self) -> u16 {
        match self {
            Self::Passed => 1,
            Self::TooSlowAway => 1 << 1,
            Self::TooSlowBack => 1 << 2,
            Self::TooFar => 1 << 3,
            Self::Reset => 1 << 4,
        }
    }
}

impl Icon3000 {
    /// How far it coasts in a test.
    pub(super) fn coast(&self) -> u32 {
        if self.has_fault(Fault::PstOverTravel) {
            TOO_FAR
        } else {
            COAST
        }
    }

    /// How many times slower than usual the valve is now.
    pub(super) fn slowness(&self) -> u32 {
        let slow = match self.pst {
            Pst::Away(_) => self.has_fault(Fault::PstTravel),
            Pst::Back => self.has_fault(Fault::PstReturn),
            _ => false,
        };
        if slow { SLOW } else { 1 }
    }

    /// Goes on with a partial stroke test.
    pub(super) fn test(&mut self) {
        if self.pst == Pst::Off {
            return;
        }
        // Table 39, note 5.
        let reset = self.fault_resets()
            | u32::from(self.drive.no_mains) << 8
            | u32::from(self.is_fail_safe()) << 4
            | u32::from(self.is_esd()) << 3
            | u32::from(self.has(bit::STOP)) << 2;
        if reset != 0 {
            self.test.reset = reset;
            self.fails(End::Reset);
            return self.end_test();
        }
        self.test_tenths = self.test_tenths.saturating_add(1);
        let gone = drive::OPEN.saturating_sub(self.drive.position());
        let percent = usize::try_from(gone.checked_div(1000).unwrap_or(0)).unwrap_or(0);
        match self.pst {
            Pst::Off => {}
            Pst::Away(target) => self.away(target, percent),
            Pst::Pause(0) => self.turn_back(),
            Pst::Pause(left) => self.pst = Pst::Pause(left.saturating_sub(STEP_MS)),
            Pst::Back => self.back(percent),
        }
    }

    fn away(&mut self, target: u32, percent: usize) {
        self.reached(percent);
        let position = self.drive.position();
        if position > target && self.is_too_long(0, at::MAX_T_PST) {
            self.fails(End::TooSlowAway);
            return self.turn_back();
        }
        if position > target.saturating_sub(self.coast()) {
            return;
        }
        let over = target
            .saturating_sub(position)
            .checked_div(100)
            .unwrap_or(0);
        self.test.over = u16::try_from(over).unwrap_or(u16::MAX);
        if self.test.over > self.store.get(at::MAX_OV_TR).saturating_mul(10) {
            self.fails(End::TooFar);
        }
        let pause = u32::from(self.store.get(at::PST_PAUSE));
        self.pst = Pst::Pause(pause.saturating_mul(1000));
    }

    fn turn_back(&mut self) {
        self.test_tenths = 0;
        self.pst = Pst::Back;
    }

    fn back(&mut self, percent: usize) {
        self.returned(percent);
        if self.is_too_long(1, at::MAX_T_RET) {
            self.fails(End::TooSlowBack);
        }
        if self.drive.is_open() {
            self.returned(0);
            self.fails(End::Passed);
            self.end_test();
        }
    }

    /// True if the way takes longer than the limit in this register allows: percent of the time of
    /// the reference.
    fn is_too_long(&self, way: usize, limit: u16) -> bool {
        let (times, travel) = if self.is_v2() {
            self.history.reference_times()
        } else {
            REFERENCE
        };
        let time = u64::from(times.get(way).copied().unwrap_or(0));
        let percent = u64::from(self.store.get(limit));
        let allowed = time
            .saturating_mul(percent)
            .saturating_mul(self.test.travel.into())
            .checked_div(u64::from(travel).saturating_mul(100));
        allowed.is_some_and(|allowed| u64::from(self.test_tenths) > allowed)
    }

    /// Notes what came of the test, unless something did before.
    fn fails(&mut self, end: End) {
        if self.test.result == 0 {
            self.test.result = end.result();
            self.test.status = end.status();
        }
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

    fn end_test(&mut self) {
        let test = core::mem::take(&mut self.test);
        let baseline = self.command == command::BASELINE_PST;
        self.keep_test(&test, baseline);
        if matches!(self.command, command::PST | command::BASELINE_PST) {
            self.command = command::NONE;
        }
        self.pst = Pst::Off;
    }

    /// Registers, file and warnings of a test that is over (table 34 for the codes of the log).
    fn keep_test(&mut self, test: &Partial, baseline: bool) {
        self.store.set(at::PST_STATUS, test.status);
        let conditions = at::PST_STATUS.saturating_add(1);
        self.store.long(conditions, test.reset);
        if self.is_v2() {
            self.history.test(test, self.wall, baseline);
        }
        let (bits, code) = match test.result {
            4 => (1 << 8 | 1 << 11, 11),
            5 => (1 << 9 | 1 << 11, 12),
            6 => (1 << 10 | 1 << 11, 13),
            _ => (0, 0),
        };
        self.test_warnings = bits;
        if code != 0 {
            let stamp = self.stamp();
            self.warnings.add(self.wall, stamp, code);
        }
    }

    /// True if it has partial stroke tests; of an ICON2000v4 nothing is stated (reading E37).
    pub(super) fn has_tests(&self) -> bool {
        self.model >= Model::Icon3000
    }

    /// A test that has just failed because the valve came back too slowly.
    pub(super) fn failed_return(&mut self) {
        let travel = self.store.get(at::PST_TRAVEL);
        let run = |from: u16, each: u16| {
            let times = from..=travel;
            times
                .map(|percent| percent.saturating_mul(each).saturating_add(2))
                .collect()
        };
        let mut back: Vec<u16> = run(1, 11);
        // The way back begins at the far end.
        back.reverse();
        let test = Partial {
            away: run(0, 3),
            back,
            result: End::TooSlowBack.result(),
            status: End::TooSlowBack.status(),
            reset: 0,
            travel,
            over: 4,
        };
        self.keep_test(&test, false);
    }

    /// Begins a partial stroke test, if the set-up allows it and the valve is open.
    pub(super) fn begin_test(&mut self) {
        let allowed = self.has_tests()
            && self.store.get(at::EFS_INPUT_MODE) == 0
            && self.store.get(at::INTERLOCK_MODE) == 1;
        if allowed && self.pst == Pst::Off && self.drive.is_open() {
            let percent = self.store.get(at::PST_TRAVEL);
            let travel = u32::from(percent).saturating_mul(1000);
            self.pst = Pst::Away(drive::OPEN.saturating_sub(travel));
            self.test = Partial {
                back: vec![0; usize::from(percent.min(50))],
                travel: percent,
                ..Partial::default()
            };
            self.test_tenths = 0;
        } else if matches!(self.command, command::PST | command::BASELINE_PST) {
            self.command = command::NONE;
        }
    }
}
