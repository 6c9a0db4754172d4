//! What an actuator holds when it is switched on: identity, set-up, history.

use super::clock::Stamp;
use super::drive::{self, Stroke};
use super::history::{History, source};
use super::store::{Store, at};
use super::{Icon3000, command};
use crate::address::Table;
use crate::map::row::{Access, Kind, Model};

/// One day in seconds.
const DAY: u64 = 86_400;

/// The registers of a new actuator.
pub(super) fn store(model: Model, tag: &str) -> Store {
    let mut store = Store::new();
    defaults(&mut store, model);
    store.set(at::ACTUATOR_ID, 0x9000);
    store.set(at::COMPATIBILITY, 1);
    store.set(at::IDENTIFIER, 0x9000);
    store.set(at::COMMAND, command::NONE);
    identity(&mut store, model, tag);
    store.set(at::DEAD_BAND, 10);
    store.set(at::MOTION_INHIBIT, 2);
    store.set(at::FAIL_SAFE_POSITION, 50);
    store.set(at::CHANNEL_MODE, 0);
    // What stroke tests need; an ICON3000 shows the mode only.
    for (address, word) in [
        (at::INTERLOCK_MODE, 1),
        (at::PST_TRAVEL, 15),
        (at::PST_PAUSE, 2),
        (at::MAX_T_PST, 150),
        (at::MAX_T_RET, 150),
        (at::MAX_OV_TR, 5),
    ] {
        store.set(address, word);
    }
    let stamp = |year, month, day| Stamp {
        year,
        month,
        day,
        hour: 9,
        minute: 41,
        second: 7,
    };
    store.date(at::TEST_DATE, stamp(2023, 11, 8));
    store.date(at::START_UP, stamp(2024, 2, 19));
    store.date(at::LAST_MAINTENANCE, stamp(2025, 3, 4));
    store.date(at::NEXT_MAINTENANCE, stamp(2027, 3, 4));
    store.date(at::RECENT_LOG, stamp(2025, 3, 4));
    store.set(at::OPENING_TIME, 24);
    store.set(at::CLOSING_TIME, 26);
    store.long(at::UNPOWERED, 131);
    store.long(at::RECENT_UNPOWERED, 12);
    store.set(at::UTILIZATION, 6);
    store.set(at::RECENT_UTILIZATION, 11);
    for (address, values) in [
        (at::TEMPERATURES, [-9_i16, 58, -12, 49, 74]),
        (at::RECENT_TEMPERATURES, [3, 52, 1, 45, 71]),
    ] {
        for (address, value) in (address..).zip(values) {
            store.signed(address, value);
        }
    }
    for opening in [true, false] {
        let samples = core::array::from_fn(|percent| {
            let position = u32::try_from(percent).unwrap_or(0).saturating_mul(1000);
            // When it was new, it ran a little easier.
            drive::torque(opening, position, false)
                .saturating_sub(4)
                .max(1)
        });
        let stroke = Stroke {
            opening,
            samples,
            millis: if opening { 24_000 } else { 26_000 },
        };
        curve(&mut store, &stroke, stamp(2024, 2, 19), false);
        curve(&mut store, &stroke, stamp(2026, 1, 15), true);
    }
    if model >= Model::Icon3000v2 {
        version_2(&mut store);
    }
    store
}

/// Every writable register starts within its range.
fn defaults(store: &mut Store, model: Model) {
    for row in model.map().rows_of(Table::Holding) {
        let (Some((min, max)), Access::Write | Access::WriteGuarded) = (row.range, row.access)
        else {
            continue;
        };
        let start = if (min..=max).contains(&0) { 0 } else { min };
        match row.kind {
            Kind::I16 => store.signed(row.address.get(), i16::try_from(start).unwrap_or(0)),
            _ => store.set(row.address.get(), u16::try_from(start).unwrap_or(0)),
        }
    }
}

fn identity(store: &mut Store, model: Model, tag: &str) {
    let number = tag.bytes().fold(4711_u32, |sum, b| {
        sum.wrapping_mul(33).wrapping_add(b.into())
    });
    let serial = format!("SIM{:06}", number.checked_rem(1_000_000).unwrap_or(0));
    store.text(at::NAME, 8, "Biffi ICON3000");
    store.text(at::SERIAL, 14, &serial);
    store.text(at::TAG, 14, tag);
    let v2 = model >= Model::Icon3000v2;
    store.text(at::BASE_VERSION, 2, if v2 { "9.02" } else { "6.05" });
    store.text(at::MODBUS_VERSION, 2, if v2 { "4.01" } else { "2.03" });
    store.text(at::TYPE, 14, "ICON-060/480-36");
    // Newton metres, then the amount in seven characters (note 8).
    store.bytes(at::NOMINAL_TORQUE, b"\x01480    ");
}

/// The set-up of an ICON3000v2.
fn version_2(store: &mut Store) {
    let settings: [(u16, &[u16]); 16] = [
        // Open limit, close limit, position at least and at most, closing, opening, running, alarm.
        (at::RELAY_FUNCTION, &[0, 1, 2, 3, 4, 5, 6, 26]),
        (at::RELAY_CONTACT, &[1; 8]),
        (at::RELAY_POSITION, &[0, 0, 75, 25, 0, 0, 0, 0]),
        (at::DIN_FUNCTION, &[3, 2, 9, 10, 22, 8]),
        (at::DIN_POSITION, &[20, 80, 0, 0, 0, 0]),
        (at::CH1_BAUD, &[9]),
        (at::CH1_PARITY, &[1]),
        (at::CH2_BAUD, &[9]),
        (at::CH2_PARITY, &[1]),
        (at::MODBUS_FIRMWARE, &[401]),
        (at::MODBUS_HARDWARE, &[100]),
        (at::ESD_ACTION, &[1]),
        (at::OPEN_TORQUE, &[85]),
        (at::CLOSE_TORQUE, &[90]),
        // Channel 2 is not connected any more; its counters stand still (order as of channel 1).
        (at::COUNTERS_2, &[4321, 1234, 7, 3, 2, 1]),
        (at::FAIL_SAFE_ENABLED, &[1]),
    ];
    for (address, words) in settings {
        store.fill(address, words.iter().copied());
    }
    store.fill(at::SET_REFERENCES, [1, 1, 1, 1]);
    store.set(at::ENCODER_STATUS, 1 << 7);
    store.long(at::ENCODER_LIMITS, 40_000);
    store.long(at::ENCODER_LIMITS.saturating_add(2), 1_640_000);
    store.set(at::BATTERY, 91);
    store.date(
        at::NEXT_PST,
        Stamp {
            year: 2027,
            month: 1,
            day: 1,
            ..Stamp::default()
        },
    );
}

/// Writes a stroke into its curve and its profile, of the last stroke or of the reference.
pub(super) fn curve(store: &mut Store, stroke: &Stroke, stamp: Stamp, last: bool) {
    let (curve, profile, time) = match (stroke.opening, last) {
        (true, true) => (at::LAST_OPEN_CURVE, at::LAST_OPEN_PROFILE, at::OPENING_TIME),
        (false, true) => (
            at::LAST_CLOSE_CURVE,
            at::LAST_CLOSE_PROFILE,
            at::CLOSING_TIME,
        ),
        (true, false) => (
            at::REFERENCE_OPEN_CURVE,
            at::REFERENCE_OPEN_PROFILE,
            at::OPENING_TIME,
        ),
        (false, false) => (
            at::REFERENCE_CLOSE_CURVE,
            at::REFERENCE_CLOSE_PROFILE,
            at::CLOSING_TIME,
        ),
    };
    let seconds = u16::try_from(stroke.millis.saturating_add(500) / 1000).unwrap_or(u16::MAX);
    if last {
        store.set(time, seconds);
    }
    let mut bytes = stroke.samples.to_vec();
    bytes.extend(stamp.curve());
    // Temperatures of electronics, terminal board and motor; voltage; time of the stroke.
    bytes.extend([31, 28, 46]);
    bytes.extend(400_u16.to_be_bytes());
    bytes.extend(seconds.to_be_bytes());
    bytes.resize(128, 0);
    store.bytes(curve, &bytes);
    let quarter = |from: usize, to: usize| {
        let part = stroke.samples.get(from..to).unwrap_or(&[]);
        u16::from(part.iter().copied().max().unwrap_or(0))
    };
    let (first, last) = (quarter(0, 10), quarter(91, 101));
    let (break_out, ending) = if stroke.opening {
        (first, last)
    } else {
        (last, first)
    };
    store.fill(profile, [break_out, quarter(10, 91), ending]);
    store.date(profile.saturating_add(3), stamp);
}

impl Icon3000 {
    /// What happened before this actuator was switched on, by its own clock.
    pub(super) fn power_up(&mut self) {
        if self.is_v2() {
            self.history = History::new(self.wall);
            self.history.event(self.wall, 0, source::POWER_UP);
        }
        let history = [
            (211, 9_411, 11, true),
            (96, 51_002, 5, true),
            (41, 30_660, 4, false),
            (12, 61_325, 2, false),
        ];
        for (days, second, code, alarm) in history {
            let ago = DAY.saturating_mul(days);
            let midnight = self.wall.saturating_sub(ago);
            let wall = midnight
                .saturating_sub(midnight.checked_rem(DAY).unwrap_or(0))
                .saturating_add(second);
            let log = if alarm {
                &mut self.alarms
            } else {
                &mut self.warnings
            };
            log.add(wall, Stamp::at(wall), code);
        }
    }
}
