//! The actuator behind the field unit: it moves, strains, gets stuck.

use super::setup::{CkSwitch, HartSetup};
use crate::device::Family;

/// A difference below this does not start the motor, in percent.
const DEADBAND: f32 = 0.5;
/// Table 15: stalled if it moved less than 1 % in 10 s.
const STALL_MS: u32 = 10_000;

/// Which way the motor runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Way {
    Open,
    Close,
}

/// Where the valve is to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    /// Stay.
    Hold,
    /// Percent between the user's limits.
    User(f32),
    /// Percent of the factory stroke.
    Factory(f32),
}

/// The valve and its drive.
#[derive(Clone, Debug)]
pub(super) struct Valve {
    family: Family,
    switch: CkSwitch,
    low: f32,
    high: f32,
    /// Percent of the factory stroke in a millisecond.
    rate: f32,
    /// Percent of the factory stroke.
    at: f32,
    pub(super) goal: Goal,
    pub(super) moving: Option<Way>,
    /// The valve does not follow the motor.
    pub(super) stuck: bool,
    /// Which way it got nowhere.
    pub(super) stalled: Option<Way>,
    still_ms: u32,
    /// Pressure of a fluid-power actuator, in percent.
    pressure: f32,
}

impl Valve {
    pub fn new(setup: &HartSetup) -> Self {
        let (low, high) = setup.limits;
        let ms = u16::try_from(setup.stroke_ms.clamp(100, 60_000)).unwrap_or(u16::MAX);
        Self {
            family: setup.family,
            switch: setup.switch,
            low,
            high,
            rate: (high - low) / f32::from(ms),
            at: low,
            goal: Goal::Hold,
            moving: None,
            stuck: false,
            stalled: None,
            still_ms: 0,
            pressure: 92.0,
        }
    }

    /// Percent between the user's limits.
    pub fn user(&self) -> f32 {
        (self.at - self.low) / (self.high - self.low) * 100.0
    }

    /// Percent of the factory stroke.
    pub fn factory(&self) -> f32 {
        self.at
    }

    pub fn is_closed(&self) -> bool {
        self.user() <= 0.1
    }

    pub fn is_open(&self) -> bool {
        self.user() >= 99.9
    }

    /// Lets time go on.
    pub fn step(&mut self, ms: u16) {
        let wanted = match self.goal {
            Goal::Hold => None,
            Goal::User(percent) => {
                Some(self.low + percent.clamp(0.0, 100.0) / 100.0 * (self.high - self.low))
            }
            Goal::Factory(percent) => Some(percent.clamp(0.0, 100.0)),
        };
        let need = wanted.map_or(0.0, |w| w - self.at);
        let limit = if self.moving.is_some() { 0.0 } else { DEADBAND };
        let way = if need > limit {
            Some(Way::Open)
        } else if need < -limit {
            Some(Way::Close)
        } else {
            None
        };
        if self.stalled.is_some() && (!self.stuck || way != self.stalled) {
            self.stalled = None;
            self.still_ms = 0;
        }
        self.moving = way.filter(|w| self.stalled != Some(*w));
        let by = self.rate * f32::from(ms);
        match self.moving {
            Some(way) if self.stuck => {
                self.still_ms = self.still_ms.saturating_add(u32::from(ms));
                if self.still_ms >= STALL_MS {
                    self.stalled = Some(way);
                    self.moving = None;
                }
            }
            Some(Way::Open) => self.at += by.min(need),
            Some(Way::Close) => self.at -= by.min(-need),
            None => {}
        }
        if !self.stuck {
            self.still_ms = 0;
        }
        self.pressure = match self.moving {
            Some(_) => (self.pressure - 0.004 * f32::from(ms)).max(70.0),
            None => (self.pressure + 0.001 * f32::from(ms)).min(92.0),
        };
    }

    /// Thrust or torque in percent of the rating, pressure on SI3 and SI4.
    pub fn effort(&self) -> f32 {
        if self.family == Family::Si {
            return self.pressure;
        }
        let seat = (10.0 - self.user().clamp(0.0, 10.0)) * 2.5;
        let torque = match self.moving {
            Some(_) if self.stuck => 100.0,
            Some(Way::Open) => 24.0 + seat,
            Some(Way::Close) => 20.0 + seat,
            None => 0.0,
        };
        match (self.family, self.switch) {
            (Family::Ck, CkSwitch::Mechanical | CkSwitch::Potentiometer) if torque < 100.0 => 0.0,
            _ => torque,
        }
    }

    /// The position as the actuator reports it, in percent.
    pub fn reported(&self) -> f32 {
        if (self.family, self.switch) == (Family::Ck, CkSwitch::Mechanical) {
            return match (self.is_closed(), self.is_open()) {
                (true, _) => 0.0,
                (_, true) => 100.0,
                _ => 50.0,
            };
        }
        self.user()
    }
}
