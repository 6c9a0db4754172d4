//! Faults that a test or a person puts into a simulated actuator, and the alarms that follow.

use super::Icon3000;

/// A fault of an ICON3000.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Fault {
    /// The motor is too hot: the thermostat has opened.
    Thermostat,
    /// The valve does not move in opening direction.
    JammedOpen,
    /// The valve does not move in closing direction.
    JammedClose,
    /// The electronics are too hot.
    HiHiTemperature,
    /// The encoder does not answer.
    PositionSensor,
    /// A phase of the supply is missing.
    LostPhase,
    /// The battery is low; everything works.
    LowBattery,
    /// A card reports fault 1.
    Hardware1,
    /// The stroke test took too long on the way back: a warning.
    PstReturn,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 9] = [
        Self::Thermostat,
        Self::JammedOpen,
        Self::JammedClose,
        Self::HiHiTemperature,
        Self::PositionSensor,
        Self::LostPhase,
        Self::LowBattery,
        Self::Hardware1,
        Self::PstReturn,
    ];

    /// Bits of warnings, Alarms 1 and Alarms 2, and the code of the log with true for an alarm
    /// (VCIOM-16345-EN, table 5 and its notes).
    const fn signs(self) -> ([u16; 3], u16, bool) {
        match self {
            Self::Thermostat => ([0, 1, 0], 2, true),
            Self::JammedOpen => ([0, 1 << 3, 1 << 2], 8, true),
            Self::JammedClose => ([0, 1 << 4, 1 << 1], 7, true),
            Self::HiHiTemperature => ([0, 1 << 5, 0], 3, true),
            Self::PositionSensor => ([0, 1 << 6, 0], 9, true),
            Self::LostPhase => ([0, 1 << 14, 0], 12, true),
            Self::LowBattery => ([0, 1 << 13, 0], 4, true),
            Self::Hardware1 => ([0, 1 << 12, 1 << 6], 17, true),
            Self::PstReturn => ([1 << 9 | 1 << 11, 0, 0], 12, false),
        }
    }

    /// True if the motor does not run in this direction.
    pub(super) const fn stops(self, opening: bool) -> bool {
        match self {
            Self::JammedOpen => opening,
            Self::JammedClose => !opening,
            Self::LowBattery | Self::PstReturn => false,
            _ => true,
        }
    }
}

impl Icon3000 {
    /// Puts a fault in, or takes it away. A new one is noted in the log.
    pub fn set_fault(&mut self, fault: Fault, on: bool) {
        let there = self.faults.contains(&fault);
        if on && !there {
            self.faults.push(fault);
            let (_, code, alarm) = fault.signs();
            let stamp = self.stamp();
            let log = if alarm {
                &mut self.alarms
            } else {
                &mut self.warnings
            };
            log.add(self.wall, stamp, code);
        } else if !on {
            self.faults.retain(|f| *f != fault);
        }
        self.publish();
    }

    /// The bits of warnings, Alarms 1 and Alarms 2 that the faults set.
    pub(super) fn fault_bits(&self) -> [u16; 3] {
        let mut bits = [0; 3];
        for fault in &self.faults {
            let (signs, ..) = fault.signs();
            for (word, sign) in bits.iter_mut().zip(signs) {
                *word |= sign;
            }
        }
        bits
    }
}
