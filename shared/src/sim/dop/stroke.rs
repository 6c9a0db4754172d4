//! What was recorded of a stroke: its torque and vibration follow from its number.

use super::unit::{BIN_MS, Way, noise};

/// What was recorded of a stroke.
#[derive(Clone, Debug)]
pub(super) struct Stroke {
    pub start: i64,
    pub end: i64,
    /// Number of the stroke; its noise comes from it.
    pub number: i64,
    /// True for the saved reference: a little easier, without the wear at 60 %.
    pub reference: bool,
    pub way: Way,
}

impl Stroke {
    /// Torque at a percent of the travel, in tenths of a percent of the rating.
    pub fn torque(&self, seed: i64, percent: i64) -> i64 {
        let from_start = match self.way {
            Way::Open => percent,
            Way::Close => 99_i64.saturating_sub(percent),
        };
        let base = match from_start {
            // Breakout, then running, then the end of travel.
            0..=4 => 410_i64.saturating_sub(from_start.saturating_mul(40)),
            95..=99 if self.way == Way::Close => from_start
                .saturating_sub(94)
                .saturating_mul(70)
                .saturating_add(225),
            95..=99 => from_start
                .saturating_sub(94)
                .saturating_mul(14)
                .saturating_add(225),
            _ => 225,
        };
        let wear = match percent {
            58..=66 if !self.reference => 46,
            _ => 0,
        };
        let number = self.number.saturating_mul(100).saturating_add(percent);
        let rough = if self.reference { 4 } else { 12 };
        base.saturating_add(wear)
            .saturating_add(noise(seed, number, rough))
    }

    /// Vibration in a tenth of the travel in mG: most, least, average.
    pub fn vibration(&self, seed: i64, bin: i64) -> [i64; 3] {
        let number = self.number.saturating_mul(10).saturating_add(bin);
        let least = noise(seed, number, 30).saturating_add(90);
        let wear = if bin == 6 && !self.reference { 240 } else { 0 };
        let most = noise(seed, number.saturating_add(5), 90)
            .saturating_add(310)
            .saturating_add(wear);
        let average = least.saturating_add(most).checked_div(2).unwrap_or(0);
        [most, least, average]
    }

    /// When the valve was in a tenth of the travel.
    pub fn time_in(&self, bin: i64) -> i64 {
        let tenths = match self.way {
            Way::Open => bin,
            Way::Close => 9_i64.saturating_sub(bin),
        };
        let passed = tenths.saturating_mul(BIN_MS).checked_div(1000).unwrap_or(0);
        self.start.saturating_add(passed)
    }
}
