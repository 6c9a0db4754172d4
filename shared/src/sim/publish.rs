//! From the state of the actuator to its registers and inputs.

use super::drive::Motion;
use super::store::{Store, at};
use super::{Icon3000, Programme, Pst, bit};
use crate::map::row::Level;

/// Nominal voltage of the mains.
const VOLTS: u16 = 400;
/// Cycles and hours before the actuator was switched on.
const OLD_CYCLES: u32 = 18_344;
const OLD_HOURS: u32 = 167;
const RECENT_CYCLES: u32 = 1_906;
const RECENT_HOURS: u32 = 19;

/// Bits, from bit 0.
fn bits<const N: usize>(flags: [bool; N]) -> u16 {
    flags
        .iter()
        .rev()
        .fold(0, |word, on| word << 1 | u16::from(*on))
}

/// A part of a range by position: `low` at 0 %, `high` at 100 %.
fn between(low: u32, high: u32, position: u32) -> u32 {
    let span = high.saturating_sub(low);
    // Positions are below 2^17 and ranges below 2^15 but for the encoder, which is divided first.
    let part = if span > 0x7FFF {
        span.checked_div(1000)
            .unwrap_or(0)
            .saturating_mul(position.checked_div(100).unwrap_or(0))
    } else {
        span.saturating_mul(position)
            .checked_div(100_000)
            .unwrap_or(0)
    };
    low.saturating_add(part)
}

fn word(value: u32) -> u16 {
    u16::try_from(value).unwrap_or(u16::MAX)
}

impl Icon3000 {
    /// Brings all registers up to date.
    pub(super) fn publish(&mut self) {
        let stamp = self.stamp();
        let position = self.drive.position();
        let torque = self.drive.torque();
        let store = &mut self.store;
        store.set(at::POSITION, self.drive.tenths());
        store.signed(at::TORQUE, torque);
        store.date(at::DATE, stamp);
        store.fill(at::TIME, stamp.time());
        self.alarms.publish(store, at::ALARM_LOG);
        self.warnings.publish(store, at::WARNING_LOG);
        store.set(at::COMMAND_BITS, self.bits);
        store.set(at::COMMAND, self.command);
        let [of_faults, alarms_1, alarms_2, alarms_3] = self.fault_bits();
        let store = &mut self.store;
        let warnings = u16::from(self.drive.hi_torque) << 1
            | u16::from(self.drive.low_mains) << 3
            | of_faults
            | self.test_warnings;
        // Bit 15 is the general warning.
        let any = u16::from(warnings != 0) << 15;
        store.set(at::WARNINGS, warnings | any);
        store.set(at::ALARMS_1, u16::from(self.drive.no_mains) << 8 | alarms_1);
        store.set(at::ALARMS_1.saturating_add(1), alarms_2);
        store.set(at::ALARMS_3, alarms_3);
        store.set(at::MOTOR_ALARMS, self.alarms.count(&[2, 3]));
        store.set(
            at::MOTOR_ALARMS.saturating_add(1),
            self.alarms.count(&[5, 6, 7, 8]),
        );
        let hours = u32::try_from(self.drive.run_ms.checked_div(3_600_000).unwrap_or(0));
        let hours = hours.unwrap_or(u32::MAX);
        store.long(at::CYCLES, self.drive.cycles.saturating_add(OLD_CYCLES));
        store.long(
            at::RECENT_CYCLES,
            self.drive.cycles.saturating_add(RECENT_CYCLES),
        );
        store.long(at::RUN_TIME, hours.saturating_add(OLD_HOURS));
        store.long(at::RECENT_RUN_TIME, hours.saturating_add(RECENT_HOURS));
        let request = if self.is_positioner() {
            u32::from(self.store.get(at::POSITION_REQUEST)).saturating_mul(100)
        } else if self.programme == Programme::Modulating {
            self.signal()
        } else {
            position
        };
        let store = &mut self.store;
        // 4 to 20 mA in hundredths, and the same as a number of twelve bits (note 5).
        let signal = if self.programme == Programme::Modulating {
            request
        } else {
            0
        };
        store.set(at::AUX_MA, word(between(400, 2000, signal)));
        store.set(at::AUX_BITS, word(between(0, 4095, signal)));
        self.status(position);
        if self.is_v2() {
            self.version_2(position, request);
        }
    }

    /// The status words.
    fn status(&mut self, position: u32) {
        let drive = &self.drive;
        let moving = drive.motion != Motion::Still;
        let (opening, closing) = (
            drive.motion == Motion::Opening,
            drive.motion == Motion::Closing,
        );
        let din = self.conditions(at::DIN_FUNCTION, at::DIN_POSITION, 6);
        let interlock = self.store.get(at::INTERLOCK_COMMANDS);
        let [warnings, alarms_1, alarms_2, alarms_3] = self.fault_bits();
        let has_alarm = drive.no_mains || (alarms_1 | alarms_2 | alarms_3) != 0;
        let has_warning =
            drive.hi_torque || drive.low_mains || (warnings | self.test_warnings) != 0;
        let status_1 = bits([
            drive.is_closed(),
            drive.is_open(),
            moving,
            !has_alarm,
            false,
            true,
            has_alarm,
            has_warning,
        ]) | din << 8
            | (interlock & 1) << 14
            | (interlock & 2) << 14;
        let programmed = !self.is_commanded() && self.programme == Programme::Strokes;
        let esd = self.is_esd();
        let status_2 = bits([
            self.is_fail_safe(),
            opening,
            closing,
            false,
            esd || self.pst != Pst::Off,
            programmed,
            self.is_positioner(),
            drive.no_mains,
            true,
            programmed && opening,
            programmed && closing,
            false,
            !programmed,
            false,
            esd,
            self.pst != Pst::Off,
        ]);
        let percent = position.checked_div(1000).unwrap_or(0);
        let limit = |store: &Store, at: u16| u32::from(store.get(at));
        let status_3 = bits([
            self.store.get(at::PST_STATUS) & 1 << 4 != 0,
            self.store.get(at::PST_STATUS) & 1 != 0,
            false,
            true,
            false,
            opening,
            closing,
            true,
            false,
            true,
            self.is_v2() && percent >= limit(&self.store, at::DIN_POSITION.saturating_add(1)),
            self.is_v2() && percent <= limit(&self.store, at::DIN_POSITION),
            true,
            true,
            false,
            false,
        ]);
        self.store.set(at::STATUS_1, status_1);
        self.store.set(at::STATUS_2, status_2);
        self.store.set(at::STATUS_3, status_3);
    }

    /// Which of some configured conditions hold (HR 3580 names them).
    fn conditions(&self, functions: u16, positions: u16, count: u16) -> u16 {
        if !self.is_v2() {
            return 0;
        }
        (0..count)
            .map(|n| {
                let limit = self.store.get(positions.saturating_add(n));
                self.holds(self.store.get(functions.saturating_add(n)), limit)
            })
            .rev()
            .fold(0, |word, on| word << 1 | u16::from(on))
    }

    fn holds(&self, function: u16, percent: u16) -> bool {
        let drive = &self.drive;
        let at = u32::from(percent).saturating_mul(1000);
        let moving = drive.motion != Motion::Still;
        match function {
            0 => drive.is_open(),
            1 => drive.is_closed(),
            2 => drive.position() >= at,
            3 => drive.position() <= at,
            4 => drive.motion == Motion::Closing,
            5 => drive.motion == Motion::Opening,
            6 => moving,
            // Half a second on, half a second off.
            7 => moving && self.age_ms.checked_rem(1000).is_some_and(|ms| ms < 500),
            8 => !drive.is_open() && !drive.is_closed(),
            10 => true,
            12 => self.is_esd() || self.pst != Pst::Off,
            22 => drive.hi_torque || drive.low_mains,
            26 => !drive.no_mains,
            28 => self.pst != Pst::Off,
            _ => false,
        }
    }

    /// What only the ICON3000v2 has.
    fn version_2(&mut self, position: u32, request: u32) {
        let relays = self.conditions(at::RELAY_FUNCTION, at::RELAY_POSITION, 8);
        // A contact that breaks is closed while its condition does not hold.
        let mut makes = 0;
        for n in 0..8_u16 {
            let contact = self.store.get(at::RELAY_CONTACT.saturating_add(n));
            makes |= (contact & 1).wrapping_shl(n.into());
        }
        let monitor = u16::from(!self.drive.no_mains) << 8;
        let contacts = !(relays ^ makes) & 0xFF | monitor;
        let opening = self.drive.motion == Motion::Opening;
        let closing = self.drive.motion == Motion::Closing;
        let programmed = !self.is_commanded() && self.programme == Programme::Strokes;
        let inputs = bits([programmed && opening, programmed && closing]);
        let moving = opening || closing;
        let load = u16::from(self.drive.load);
        let volts = match (self.drive.no_mains, self.drive.low_mains) {
            (true, _) => 286,
            (false, true) => 338,
            // It is never quite the same.
            _ => {
                let wave = self.age_ms.checked_div(3000).unwrap_or(0);
                let wave = u16::try_from(wave.checked_rem(7).unwrap_or(0)).unwrap_or(0);
                VOLTS.saturating_add(wave).saturating_sub(3)
            }
        };
        let amps = if moving {
            12_u16.saturating_add(load.checked_div(4).unwrap_or(0))
        } else {
            0
        };
        let progress = match self.pst {
            Pst::Off => 0,
            Pst::Away(_) => 30,
            Pst::Pause(_) => 50,
            Pst::Back => 80,
        };
        let level = match self.level {
            Level::Observer => 0,
            Level::User => 1,
            Level::Service => 2,
            Level::Manufacturer => 3,
        };
        let stored = self.history.stored();
        let store = &mut self.store;
        store.set(at::LEVEL_LOGGED, level);
        store.set(at::OUTPUTS, contacts);
        store.set(at::INPUTS, inputs);
        store.set(at::SPEED, if moving { 1395 } else { 0 });
        store.set(at::VOLTAGE, volts);
        store.set(at::CURRENT, amps);
        store.signed(at::TEMPERATURE, 31);
        store.signed(at::MOTOR_TEMPERATURE, if moving { 47 } else { 44 });
        store.signed(at::BOARD_TEMPERATURE, 28);
        store.set(at::OUTPUT_MA, word(between(400, 2000, position)));
        store.set(at::OUTPUT_BITS, word(between(0, 4095, position)));
        store.set(
            at::LOGIC_REQUEST,
            word(request.checked_div(100).unwrap_or(0)),
        );
        store.set(at::PST_PROGRESS, progress);
        store.fill(at::OPEN_CURVES, stored);
        let encoder = between(40_000, 1_640_000, position);
        store.long(at::ENCODER, encoder);
        let wheels = [1_u32, 23, 29].map(|by| {
            let turned = encoder.checked_div(by).unwrap_or(0);
            word(turned.checked_rem(2048).unwrap_or(0))
        });
        store.fill(at::WHEELS, wheels);
        let potentiometer = u32::from(load).saturating_mul(20);
        let potentiometer = if opening {
            2048_u32.saturating_sub(potentiometer)
        } else {
            2048_u32.saturating_add(potentiometer)
        };
        store.set(at::TORQUE_POTENTIOMETER, word(potentiometer.min(4095)));
        store.set(at::MODBUS_STATUS, 1);
        self.publish_counters();
    }

    /// The counters of the bus.
    pub(super) fn publish_counters(&mut self) {
        let c = &self.counters;
        // Their order in the registers differs from that of the sub-functions (reading E60).
        let counters = [
            c.bus_messages,
            c.messages,
            c.bus_errors,
            c.exceptions,
            c.busy,
            c.overruns,
        ];
        self.store.fill(at::COUNTERS, counters);
    }

    /// A discrete input (table 1; reading E41 for the last three).
    pub(super) fn discrete(&self, address: u16) -> bool {
        let (word, at) = match address {
            0..16 => (self.store.get(at::STATUS_1), address),
            16..29 => (self.store.get(at::STATUS_2), address.saturating_sub(16)),
            _ => return false,
        };
        word.wrapping_shr(at.into()) & 1 != 0
    }

    /// A coil (tables 2 and 3). Open and close change places between coils and HR 3006 (E36).
    pub(super) fn coil(&self, address: u16) -> bool {
        self.coil_bit(address).is_some_and(|b| self.bits & b != 0)
    }

    /// The bit of HR 3006 behind a coil; reserved ones have none.
    pub(super) fn coil_bit(&self, address: u16) -> Option<u16> {
        Some(match address {
            0 => bit::OPEN,
            1 => bit::CLOSE,
            2 => bit::STOP,
            3 => bit::ESD,
            4 => bit::POSITIONER,
            5 if self.is_v2() => bit::PST,
            _ => return None,
        })
    }
}
