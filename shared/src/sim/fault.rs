//! Faults that a test or a person puts into a simulated actuator, and the alarms that follow.

use super::{Icon3000, command};

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
    /// The motor turns without a sign from its speed sensor.
    SpeedSensor,
    /// The mains voltage is too low to run.
    MainVoltage,
    /// Contactor K1 does not act.
    K1Contactor,
    /// Contactor K2 does not act.
    K2Contactor,
    /// The configuration is not sound.
    ConfigurationError,
    /// The position request is no signal of 4 to 20 mA: the positioner stands still.
    RequestSignal,
    /// The torque limit was reached in opening direction.
    HiHiTorqueOpen,
    /// The torque limit was reached in closing direction.
    HiHiTorqueClose,
    /// An opening stroke stopped between the ends.
    MidTravelOpen,
    /// A closing stroke stopped between the ends.
    MidTravelClose,
    /// An emergency stroke stopped between the ends.
    EfsMidTravel,
    /// The valve is slow on the way out of a stroke test.
    PstTravel,
    /// The valve is slow on the way back of a stroke test. The last test has failed for it.
    PstReturn,
    /// The valve goes too far in a stroke test.
    PstOverTravel,
}

/// What a fault shows: bits of warnings, Alarms 1, 2 and 3, and the code of the log of alarms
/// (VCIOM-16345-EN, tables 5 and 32); which bit of table 39, note 5, it sets when it ends a test.
struct Signs {
    bits: [u16; 4],
    code: u16,
    reset: Option<u8>,
}

impl Fault {
    /// All of them.
    pub const ALL: [Self; 22] = [
        Self::Thermostat,
        Self::JammedOpen,
        Self::JammedClose,
        Self::HiHiTemperature,
        Self::PositionSensor,
        Self::LostPhase,
        Self::LowBattery,
        Self::Hardware1,
        Self::SpeedSensor,
        Self::MainVoltage,
        Self::K1Contactor,
        Self::K2Contactor,
        Self::ConfigurationError,
        Self::RequestSignal,
        Self::HiHiTorqueOpen,
        Self::HiHiTorqueClose,
        Self::MidTravelOpen,
        Self::MidTravelClose,
        Self::EfsMidTravel,
        Self::PstTravel,
        Self::PstReturn,
        Self::PstOverTravel,
    ];

    /// True if it shows in stroke tests only, so that an ICON2000v4 can't have it.
    #[must_use]
    pub const fn is_of_tests(self) -> bool {
        matches!(
            self,
            Self::PstTravel | Self::PstReturn | Self::PstOverTravel
        )
    }

    /// The word used on the command line.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Thermostat => "thermostat",
            Self::JammedOpen => "jammed-open",
            Self::JammedClose => "jammed-close",
            Self::HiHiTemperature => "hi-hi-temperature",
            Self::PositionSensor => "position-sensor",
            Self::LostPhase => "lost-phase",
            Self::LowBattery => "low-battery",
            Self::Hardware1 => "hardware-1",
            Self::SpeedSensor => "speed-sensor",
            Self::MainVoltage => "main-voltage",
            Self::K1Contactor => "k1-contactor",
            Self::K2Contactor => "k2-contactor",
            Self::ConfigurationError => "configuration-error",
            Self::RequestSignal => "request-signal",
            Self::HiHiTorqueOpen => "hi-hi-torque-open",
            Self::HiHiTorqueClose => "hi-hi-torque-close",
            Self::MidTravelOpen => "mid-travel-open",
            Self::MidTravelClose => "mid-travel-close",
            Self::EfsMidTravel => "efs-mid-travel",
            Self::PstTravel => "pst-travel",
            Self::PstReturn => "pst-return",
            Self::PstOverTravel => "pst-over-travel",
        }
    }

    /// The fault with this [`key`](Self::key).
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|f| f.key() == key)
    }

    const fn signs(self) -> Signs {
        let (bits, code, reset) = match self {
            Self::Thermostat => ([0, 1, 0, 0], 2, Some(7)),
            Self::JammedOpen => ([0, 1 << 3, 1 << 2, 0], 8, Some(11)),
            Self::JammedClose => ([0, 1 << 4, 1 << 1, 0], 7, Some(11)),
            Self::HiHiTemperature => ([0, 1 << 5, 0, 0], 3, Some(10)),
            Self::PositionSensor => ([0, 1 << 6, 0, 0], 9, Some(6)),
            Self::SpeedSensor => ([0, 1 << 7, 0, 0], 10, Some(13)),
            Self::MainVoltage => ([0, 1 << 8, 0, 0], 11, Some(8)),
            Self::K1Contactor => ([0, 1 << 9, 0, 0], 13, Some(14)),
            Self::K2Contactor => ([0, 1 << 10, 0, 0], 14, Some(15)),
            Self::ConfigurationError => ([0, 1 << 11, 0, 0], 1, Some(5)),
            Self::Hardware1 => ([0, 1 << 12, 1 << 6, 0], 17, Some(16)),
            Self::LowBattery => ([0, 1 << 13, 0, 0], 4, None),
            Self::LostPhase => ([0, 1 << 14, 0, 0], 12, Some(9)),
            Self::RequestSignal => ([0, 1 << 15, 0, 0], 18, None),
            Self::HiHiTorqueOpen => ([0, 1 << 1, 0, 0], 6, Some(12)),
            Self::HiHiTorqueClose => ([0, 1 << 2, 0, 0], 5, Some(12)),
            Self::MidTravelOpen => ([0, 0, 1 << 4, 0], 16, None),
            Self::MidTravelClose => ([0, 0, 1 << 5, 0], 15, None),
            // Reading E12: bit 17, of actuators with EFS only.
            Self::EfsMidTravel => ([0, 0, 0, 1], 29, Some(17)),
            // These show in the tests that they spoil.
            Self::PstTravel | Self::PstReturn | Self::PstOverTravel => ([0; 4], 0, None),
        };
        Signs { bits, code, reset }
    }

    /// True if the motor does not run in this direction.
    pub(super) const fn stops(self, opening: bool) -> bool {
        match self {
            Self::JammedOpen | Self::HiHiTorqueOpen => opening,
            Self::JammedClose | Self::HiHiTorqueClose => !opening,
            Self::LowBattery
            | Self::RequestSignal
            | Self::MidTravelOpen
            | Self::MidTravelClose
            | Self::EfsMidTravel
            | Self::PstTravel
            | Self::PstReturn
            | Self::PstOverTravel => false,
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
            // Every alarm but that of the battery clears enumerated open and close commands (table 5,
            // note 1); reading E39: the bits stay, and the valve goes on when it is over.
            let clears = fault.signs().code != 0 && fault != Fault::LowBattery;
            if clears && matches!(self.command, command::OPEN | command::CLOSE) {
                self.command = command::NONE;
            }
            let stamp = self.stamp();
            match fault.signs().code {
                0 if fault == Fault::PstReturn && self.has_tests() => self.failed_return(),
                0 => {}
                code => self.alarms.add(self.wall, stamp, code),
            }
        } else if !on {
            self.faults.retain(|f| *f != fault);
        }
        self.publish();
    }

    pub(super) fn has_fault(&self, fault: Fault) -> bool {
        self.faults.contains(&fault)
    }

    /// The bits of warnings, Alarms 1, Alarms 2 and Alarms 3 that the faults set.
    pub(super) fn fault_bits(&self) -> [u16; 4] {
        let mut bits = [0; 4];
        for fault in &self.faults {
            for (word, sign) in bits.iter_mut().zip(fault.signs().bits) {
                *word |= sign;
            }
        }
        bits
    }

    /// The conditions of table 39, note 5, that the faults meet.
    pub(super) fn fault_resets(&self) -> u32 {
        let bits = self.faults.iter().filter_map(|f| f.signs().reset);
        bits.fold(0, |all, bit| all | 1_u32.wrapping_shl(bit.into()))
    }
}
