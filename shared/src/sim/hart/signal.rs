//! The loop current and what becomes of it: calibration, range, damping.

use super::setup::HartSetup;
use crate::sim::Programme;

/// The input is a little off before calibration: what its converter makes of 0 and of 1 mA more.
const OFFSET: f32 = 0.012;
const SLOPE: f32 = 1.0035;
/// From 3.5 to 20.5 mA the input is linear (table 1).
pub(super) const LINEAR: core::ops::RangeInclusive<f32> = 3.5..=20.5;
/// Below this the signal counts as lost after a second (section 4.1).
const LOST: f32 = 2.0;
const LOST_MS: u32 = 1_000;

/// The analogue input.
#[derive(Clone, Debug)]
pub(super) struct Signal {
    programme: Programme,
    /// What flows, in mA.
    pub(super) current: f32,
    /// What command 40 puts in its place.
    pub(super) fixed: Option<f32>,
    /// Calibration: reading of the converter and what it means in mA.
    low: (f32, f32),
    high: (f32, f32),
    pub(super) lower: f32,
    pub(super) upper: f32,
    /// Seconds.
    pub(super) damping: f32,
    /// Damped percent of range.
    percent: f32,
    below_ms: u32,
    age_ms: u64,
}

fn converted(current: f32) -> f32 {
    current * SLOPE + OFFSET
}

impl Signal {
    pub fn new(setup: &HartSetup) -> Self {
        let mut signal = Self {
            programme: setup.programme,
            current: setup.signal,
            fixed: None,
            low: (converted(4.0), 4.0),
            high: (converted(20.0), 20.0),
            lower: 0.0,
            upper: 100.0,
            damping: 0.0,
            percent: 0.0,
            below_ms: 0,
            age_ms: 0,
        };
        signal.percent = signal.undamped();
        signal
    }

    /// The current as the field unit measures or simulates it, in mA.
    pub fn measured(&self) -> f32 {
        if let Some(fixed) = self.fixed {
            return fixed;
        }
        let (raw, zero) = self.low;
        let (top, span) = self.high;
        zero + (converted(self.current) - raw) * (span - zero) / (top - raw)
    }

    fn undamped(&self) -> f32 {
        let linear = self.measured().clamp(*LINEAR.start(), *LINEAR.end());
        (linear - 4.0) / 16.0 * 100.0
    }

    /// Percent of range, damped.
    pub fn percent(&self) -> f32 {
        self.percent
    }

    /// The primary variable: the demand in percent.
    pub fn demand(&self) -> f32 {
        self.lower + self.percent / 100.0 * (self.upper - self.lower)
    }

    /// Half a milliampere outside 4 to 20 mA, which is 3.125 % outside (readings H19, H20).
    pub fn is_outside(&self) -> bool {
        !LINEAR.contains(&self.measured())
    }

    /// True a second after the signal fell below 2 mA.
    pub fn is_lost(&self) -> bool {
        self.below_ms >= LOST_MS
    }

    /// True below 2 mA, lost or not yet.
    pub fn is_below(&self) -> bool {
        self.below_ms > 0
    }

    /// How long it has been lost, in milliseconds.
    pub fn lost_ms(&self) -> u32 {
        self.below_ms.saturating_sub(LOST_MS)
    }

    /// True below 1 mA (table 15, bit 14; reading R37).
    pub fn is_dead(&self) -> bool {
        self.measured() < 1.0
    }

    /// The end points of command 131, in mA.
    pub fn ends(&self) -> (f32, f32) {
        (self.low.1, self.high.1)
    }

    /// Command 45: what flows now is this current.
    pub fn trim_zero(&mut self, current: f32) {
        self.low = (converted(self.current), current);
    }

    /// Command 46: what flows now is this current.
    pub fn trim_gain(&mut self, current: f32) {
        self.high = (converted(self.current), current);
    }

    pub fn step(&mut self, ms: u16) {
        self.age_ms = self.age_ms.saturating_add(u64::from(ms));
        self.drive();
        if self.fixed.is_none() && self.current < LOST {
            self.below_ms = self.below_ms.saturating_add(u32::from(ms));
        } else {
            self.below_ms = 0;
        }
        let target = self.undamped();
        let part = f32::from(ms) / 1000.0;
        self.percent = if self.damping > 0.0 {
            self.percent + (target - self.percent) * (part / (self.damping + part))
        } else {
            target
        };
    }

    /// What the control system would send.
    fn drive(&mut self) {
        let second = self.age_ms.checked_div(1000).unwrap_or(0);
        let within = |period: u64| u16::try_from(second.checked_rem(period).unwrap_or(0));
        match self.programme {
            Programme::Idle => {}
            Programme::Strokes => {
                let opens = (10..70).contains(&within(120).unwrap_or(0));
                self.current = if opens { 20.0 } else { 4.0 };
            }
            Programme::Modulating => {
                // Up and down between 8 and 16 mA in steps, two minutes a round.
                let step = within(120).unwrap_or(0) / 10;
                let up = if step < 6 {
                    step
                } else {
                    12_u16.saturating_sub(step)
                };
                self.current = 8.0 + f32::from(up) * 8.0 / 6.0;
            }
        }
    }
}
