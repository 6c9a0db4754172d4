//! The device: it listens, answers below the slave time-out, and follows its signal.

use super::characters;
use super::medium::{Character, Party, later};
use super::respond::{Delayed, Faults};
use super::setup::{HartLoss, HartSelector, HartSetup};
use super::signal::Signal;
use super::state::{State, bit};
use super::text::{latin, packed};
use super::valve::{Goal, Valve};
use super::wire::Receiver;
use crate::capture::Micros;
use crate::device::Family;

/// Time is simulated in steps of this length.
const STEP_MS: u16 = 100;
/// If nobody looked for longer than this, what happened before is left out.
const LONGEST_MS: u64 = 3_600_000;
/// How far a partial stroke goes, in percent.
const PARTIAL: f32 = 10.0;

/// What controls the valve (table 17).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Control {
    /// The analogue input.
    Analog,
    /// Command 79, variable 1: this demand in percent.
    Digital(f32),
    /// Command 79, variable 4: this percentage of the factory stroke.
    Factory(f32),
    /// Command 132: this ACTCON register.
    Discrete(u8),
}

/// An answer in the making: a response code, and data unless the code is an error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Answer {
    pub code: u8,
    pub data: Vec<u8>,
}

impl Answer {
    pub fn of(data: impl Into<Vec<u8>>) -> Self {
        Self {
            code: 0,
            data: data.into(),
        }
    }

    pub const fn error(code: u8) -> Self {
        Self {
            code,
            data: Vec::new(),
        }
    }
}

/// What the device stores for the people who set it up.
#[derive(Clone, Debug)]
pub(super) struct Notes {
    pub message: [u8; 24],
    pub tag: [u8; 6],
    pub descriptor: [u8; 12],
    pub date: [u8; 3],
    pub assembly: u32,
    pub long_tag: [u8; 32],
    pub serial: u32,
}

/// A simulated Rotork actuator with a HART field unit.
#[derive(Clone, Debug)]
pub struct HartDevice {
    pub(super) setup: HartSetup,
    pub(super) notes: Notes,
    pub(super) polling: u8,
    /// Loop current mode (command 6).
    pub(super) loop_mode: bool,
    pub(super) signal: Signal,
    pub(super) valve: Valve,
    pub(super) state: State,
    pub(super) control: Control,
    /// Configuration changed and cold start, of secondary and primary master.
    pub(super) changed: [bool; 2],
    pub(super) cold: [bool; 2],
    pub(super) counter: u16,
    pub(super) faults: Faults,
    pub(super) delayed: Option<Delayed>,
    receiver: Receiver,
    pub(super) pending: Option<(Micros, Vec<u8>)>,
    /// After its answer it resets.
    pub(super) resets: bool,
    away_until: Option<Micros>,
    first: Option<Micros>,
    /// When the field unit was switched on or reset.
    born: Micros,
    pub(super) now: Micros,
    lived_ms: u64,
    /// Where a partial stroke began and whether it is on the way back.
    partial: Option<(f32, bool)>,
    /// Characters of this transmission that the modem still misses.
    missing: u8,
    pub(super) heard: u32,
    pub(super) answered: u32,
}

impl HartDevice {
    /// A device that was just switched on.
    #[must_use]
    pub fn new(tag: &str, setup: HartSetup) -> Self {
        Self {
            notes: Notes {
                message: packed("", 32),
                tag: packed(tag, 8),
                descriptor: packed("", 16),
                date: [1, 7, 124],
                assembly: 0,
                long_tag: latin(tag, 0),
                serial: 0,
            },
            polling: setup.polling & 0x3F,
            loop_mode: true,
            signal: Signal::new(&setup),
            valve: Valve::new(&setup),
            state: State::new(),
            control: Control::Analog,
            changed: [false; 2],
            cold: [true; 2],
            counter: 0,
            faults: Faults::default(),
            delayed: None,
            receiver: Receiver::default(),
            pending: None,
            resets: false,
            away_until: None,
            first: None,
            born: Micros::default(),
            now: Micros::default(),
            lived_ms: 0,
            partial: None,
            missing: 0,
            heard: 0,
            answered: 0,
            setup,
        }
    }

    // Time.

    /// Lets time go on until `now`. The first call switches the device on.
    pub fn advance(&mut self, now: Micros) {
        let first = match self.first {
            Some(first) => first,
            None => {
                self.first = Some(now);
                self.born = now;
                now
            }
        };
        self.now = self.now.max(now);
        let age = self.now.since(first).checked_div(1000).unwrap_or(0);
        if age.saturating_sub(self.lived_ms) > LONGEST_MS {
            self.lived_ms = age.saturating_sub(LONGEST_MS);
        }
        let step = u64::from(STEP_MS);
        while self.lived_ms.saturating_add(step) <= age {
            self.lived_ms = self.lived_ms.saturating_add(step);
            self.step();
        }
        let own = self.own_status();
        self.state.settle(self.setup.family, own);
    }

    fn step(&mut self) {
        self.signal.step(STEP_MS);
        self.valve.goal = self.goal();
        self.valve.step(STEP_MS);
    }

    /// Where the valve is to go now.
    fn goal(&mut self) -> Goal {
        self.state.esd =
            matches!(self.control, Control::Discrete(register) if register & 0x28 == 0x28);
        if self.state.selector != HartSelector::Remote || !self.state.board {
            return Goal::Hold;
        }
        if let Some(goal) = self.partial_stroke() {
            return goal;
        }
        match self.control {
            Control::Digital(percent) => Goal::User(percent),
            Control::Factory(percent) => Goal::Factory(percent),
            Control::Discrete(register) => match register & 0x0F {
                actcon if actcon & 0x01 != 0 => Goal::Hold,
                // Emergency shut-down closes; which way it goes is set in the actuator.
                actcon if actcon & 0x08 != 0 => Goal::User(0.0),
                0x02 => Goal::User(0.0),
                0x04 => Goal::User(100.0),
                _ => Goal::Hold,
            },
            // In multidrop the signal does not position (section 10.1).
            Control::Analog if !self.loop_mode => Goal::Hold,
            Control::Analog if self.signal.is_lost() => match self.setup.loss {
                (_, after) if self.signal.lost_ms() < after => Goal::Hold,
                (HartLoss::Stay, _) => Goal::Hold,
                (HartLoss::Close, _) => Goal::User(0.0),
                (HartLoss::Open, _) => Goal::User(100.0),
            },
            Control::Analog if self.signal.is_below() => Goal::Hold,
            Control::Analog => Goal::User(self.signal.demand()),
        }
    }

    /// A partial stroke goes a little way and comes back.
    fn partial_stroke(&mut self) -> Option<Goal> {
        let asked = matches!(self.control, Control::Discrete(register) if register & 0x3F == 0x30);
        let (from, back) = match (self.partial, asked, self.state.stroke) {
            (_, false, _) => {
                self.partial = None;
                self.state.stroke = false;
                return None;
            }
            (None, true, false) => {
                self.state.stroke = true;
                (self.valve.user(), false)
            }
            (Some(partial), true, true) => partial,
            // It is over; the bit has to go before it begins again.
            (_, true, _) => return Some(Goal::Hold),
        };
        let far = if from > 50.0 {
            from - PARTIAL
        } else {
            from + PARTIAL
        };
        let near = |to: f32| (self.valve.user() - to).abs() < 0.6;
        let back = back || near(far);
        self.partial = Some((from, back));
        if back && near(from) {
            self.state.stroke = false;
        }
        Some(Goal::User(if back { from } else { far }))
    }

    /// The card starts anew (command 42, or power): what is not stored is gone.
    pub(super) fn reset(&mut self) {
        self.cold = [true; 2];
        self.signal.fixed = None;
        self.control = Control::Analog;
        self.state.frozen = None;
        self.delayed = None;
        self.pending = None;
        self.resets = false;
        self.receiver.reset();
        self.born = self.now;
        let away = u64::from(self.setup.reset_ms).saturating_mul(1000);
        self.away_until = Some(later(self.now, away));
    }

    /// Counts of 1/32 ms since the card began, over again after a day (section 10.2).
    pub(super) fn ticks(&self) -> u32 {
        let ms = self.now.since(self.born).checked_div(1000).unwrap_or(0);
        let ticks = ms.saturating_mul(32).checked_rem(2_764_800_000);
        u32::try_from(ticks.unwrap_or(0)).unwrap_or(0)
    }

    /// The device status that a master gets.
    pub(super) fn device_status(&self, primary: bool) -> u8 {
        let own = self.own_status();
        let on = |condition: bool, mask: u8| if condition { mask } else { 0 };
        let live = on(self.signal.fixed.is_some(), bit::FIXED)
            | on(self.signal.is_outside(), bit::SATURATED | bit::PV_LIMITS)
            | self.state.device;
        let family = self.setup.family;
        self.state.frozen.map_or(live, |(_, status)| status)
            | on(self.state.malfunctions(family, own), bit::MALFUNCTION)
            | on(self.state.has_more(family, own), bit::MORE)
            | on(of_master(self.changed, primary), bit::CHANGED)
            | on(of_master(self.cold, primary), bit::COLD)
    }

    /// What of the device status stands still while status simulation is on.
    pub(super) fn base_status(&self) -> u8 {
        self.device_status(true)
            & (bit::FIXED | bit::SATURATED | bit::PV_LIMITS | self.state.device)
    }

    /// The configuration was changed.
    pub(super) const fn note_change(&mut self) {
        self.changed = [true; 2];
        self.counter = self.counter.wrapping_add(1);
    }
}

/// The flag of a master.
pub(super) const fn of_master(flags: [bool; 2], primary: bool) -> bool {
    let [secondary, first] = flags;
    if primary { first } else { secondary }
}

/// Changes the flag of a master.
pub(super) const fn set_master(flags: &mut [bool; 2], primary: bool, on: bool) {
    let [secondary, first] = flags;
    *if primary { first } else { secondary } = on;
}

impl Party for HartDevice {
    fn hear(&mut self, character: Character, at: Micros) {
        if self.away_until.is_some_and(|until| at < until) {
            return;
        }
        self.away_until = None;
        if self.missing > 0 {
            self.missing = self.missing.saturating_sub(1);
            return;
        }
        let gap = u64::from(self.setup.gap_us).max(characters(2, self.setup.baud));
        if let Some(message) = self.receiver.take(character, at, gap) {
            self.understand(&message, at);
        }
    }

    fn carrier(&mut self, on: bool, _: Micros) {
        self.receiver.reset();
        self.missing = if on { self.setup.missed } else { 0 };
    }

    fn due(&self) -> Option<Micros> {
        self.pending.as_ref().map(|(at, _)| *at)
    }

    fn act(&mut self, now: Micros) -> Option<Vec<u8>> {
        self.advance(now);
        let (_, bytes) = self.pending.take_if(|(at, _)| *at <= now)?;
        Some(bytes)
    }

    fn sent(&mut self, at: Micros) {
        self.advance(at);
        if self.resets {
            self.reset();
        }
    }
}

/// True for the families whose card has relays (section 9.6; reading R31).
pub(super) const fn has_relays(family: Family) -> bool {
    matches!(family, Family::Iq | Family::Cma)
}
