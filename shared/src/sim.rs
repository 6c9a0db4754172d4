//! Simulated actuators: pure state machines that answer Modbus PDUs. [`Dop`] is a Limitorque with
//! diagnostic objects; the rest of this module is the ICON3000 and ICON3000v2.
//!
//! A simulated actuator has no clock. Time comes in with [`Icon3000::advance`], and the same times
//! give the same answers. It knows the facts of the map (ranges, levels, access), but shares no code
//! with the decoder: the one does not prove the other.
//!
//! Without commands from the bus, a [`Programme`] keeps the valve alive: strokes, a seat that is
//! tight now and then, a dip of the mains. A command from the bus ends the programme until a minute
//! after the last command is over.
//!
//! # Passwords
//!
//! The real ones are not published. Here they are eight characters: `OBSERVER`, `USER0000`,
//! `SERVICE0` and `MAKER000`; for the observer any will do (VCIOM-16345-EN, section 11).

mod answer;
mod clock;
pub mod ddc100;
mod demand;
mod dop;
mod drive;
mod emergency;
mod fault;
mod files;
#[cfg(feature = "hart")]
pub mod hart;
mod history;
mod log;
mod publish;
mod setup;
mod store;
mod stroke;
#[cfg(test)]
mod tests;
mod write;

use crate::capture::Micros;
use crate::map::row::{Level, Model};
use clock::Stamp;
use drive::{Demand, Drive, Motion};
use emergency::Emergency;
use history::{History, Partial, source};
use log::Log;
use store::{Store, at};

pub use dop::{Dop, DopSetup};
pub use fault::Fault;

/// What an actuator does while nobody commands it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Programme {
    /// Nothing.
    Idle,
    /// Opens and closes, with pauses.
    Strokes,
    /// Follows a signal of 4 to 20 mA that never stays long.
    Modulating,
}

/// Time is simulated in steps of this length.
const STEP_MS: u32 = 100;
/// If nobody asked for longer than this, what happened before is left out.
const LONGEST_MS: u64 = 3_600_000;
/// The programme goes on so long after the last command from the bus.
const RESUME_MS: u32 = 60_000;

/// Numbers that the diagnostics return (VCIOM-16345-EN, section 8.7).
#[derive(Clone, Copy, Debug, Default)]
struct Counters {
    bus_messages: u16,
    messages: u16,
    bus_errors: u16,
    exceptions: u16,
    busy: u16,
    overruns: u16,
}

/// A simulated actuator.
#[derive(Clone, Debug)]
pub struct Icon3000 {
    model: Model,
    programme: Programme,
    store: Store,
    drive: Drive,
    alarms: Log,
    warnings: Log,
    counters: Counters,
    /// Level that is logged in; meant for ICON3000v2 only.
    level: Level,
    busy: bool,
    /// Every request fails with "server device failure".
    failing: bool,
    faults: Vec<Fault>,
    /// Files of an ICON3000v2.
    history: History,
    /// The emergency stroke that is going on.
    efs: Emergency,
    /// Bits of HR 3009 that the last stroke test left.
    test_warnings: u16,
    /// The test that is going on, and the tenths of a second since its command or its turn.
    test: Partial,
    test_tenths: u16,
    /// True: FC 17 counts 84 bytes, as the standard wants; false: 82, as the manual prints.
    full_report: bool,
    /// Time of the first and the last `advance`.
    first: Option<Micros>,
    now: Micros,
    /// Part of a step that is left over, in microseconds.
    rest: u64,
    /// Milliseconds simulated since power-up.
    age_ms: u64,
    /// The wall clock outside, in seconds since 1970.
    wall: u64,
    /// What the clock of the actuator was set to, against the one outside.
    clock_offset: i64,
    /// Milliseconds since the last command from the bus.
    since_command_ms: u32,
    /// Milliseconds since a message came, for the fail-safe function.
    since_message_ms: u32,
    /// Commands as the bits of HR 3006.
    bits: u16,
    /// The enumerated command of HR 3008.
    command: u16,
    pst: Pst,
}

/// A partial stroke test.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Pst {
    #[default]
    Off,
    /// Moves to this position, in thousandths of a percent.
    Away(u32),
    /// Waits there for so many milliseconds.
    Pause(u32),
    /// Moves back to where it came from.
    Back,
}

/// Bits of HR 3006 (VCIOM-16345-EN, table 5 and note 4).
mod bit {
    pub(super) const CLOSE: u16 = 1;
    pub(super) const OPEN: u16 = 1 << 1;
    pub(super) const STOP: u16 = 1 << 2;
    pub(super) const ESD: u16 = 1 << 3;
    pub(super) const POSITIONER: u16 = 1 << 4;
    pub(super) const PST: u16 = 1 << 5;
    pub(super) const ALL: u16 = 0x3F;
}

/// Values of HR 0 and 3008 (VCIOM-16345-EN, table 5, note 1).
mod command {
    pub(super) const NONE: u16 = 0;
    pub(super) const CLOSE: u16 = 1;
    pub(super) const OPEN: u16 = 2;
    pub(super) const ESD: u16 = 3;
    pub(super) const POSITIONER: u16 = 4;
    pub(super) const PST: u16 = 5;
    pub(super) const BASELINE_PST: u16 = 6;
}

impl Icon3000 {
    /// An actuator that was just switched on: closed, in remote, with a plausible set-up.
    #[must_use]
    pub fn new(model: Model, tag: &str, programme: Programme) -> Self {
        // Actuators of a plant do not all do the same at the same time.
        let phase = tag
            .bytes()
            .fold(0_u64, |sum, b| sum.wrapping_mul(31).wrapping_add(b.into()));
        let mut actuator = Self {
            model,
            programme,
            store: setup::store(model, tag),
            drive: Drive::new(),
            alarms: Log::default(),
            warnings: Log::default(),
            counters: Counters::default(),
            level: Level::User,
            busy: false,
            failing: false,
            faults: Vec::new(),
            history: History::default(),
            efs: Emergency::Off,
            test_warnings: 0,
            test: Partial::default(),
            test_tenths: 0,
            full_report: false,
            first: None,
            now: Micros::default(),
            rest: 0,
            age_ms: match programme {
                Programme::Idle => 0,
                _ => phase.checked_rem(97).unwrap_or(0).saturating_mul(1000),
            },
            wall: 0,
            clock_offset: 0,
            since_command_ms: RESUME_MS,
            since_message_ms: 0,
            bits: 0,
            command: command::NONE,
            pst: Pst::Off,
        };
        actuator.publish();
        actuator
    }

    /// Which model it is.
    #[must_use]
    pub const fn model(&self) -> Model {
        self.model
    }

    /// Position in tenths of a percent, 1000 is open.
    #[must_use]
    pub fn position(&self) -> u16 {
        self.drive.tenths()
    }

    /// Makes it answer everything with "server device busy", or not.
    pub const fn set_busy(&mut self, busy: bool) {
        self.busy = busy;
    }

    /// Makes it answer everything with "server device failure", or not.
    pub const fn set_failing(&mut self, failing: bool) {
        self.failing = failing;
    }

    /// Makes the byte count of FC 17 the one of the standard (84), or the printed one (82).
    pub const fn set_full_report(&mut self, full: bool) {
        self.full_report = full;
    }

    /// Lets time go on until `now`; `wall` is the wall clock in seconds since 1970 (UTC). The first
    /// call switches the actuator on.
    pub fn advance(&mut self, now: Micros, wall: u64) {
        self.wall = wall;
        if self.first.is_none() {
            self.first = Some(now);
            self.now = now;
            self.power_up();
        }
        let passed = now.since(self.now).saturating_add(self.rest);
        self.now = self.now.max(now);
        let step = u64::from(STEP_MS).saturating_mul(1000);
        let longest = LONGEST_MS.saturating_mul(1000);
        let (steps, rest) = (
            passed.min(longest).checked_div(step).unwrap_or(0),
            passed.checked_rem(step).unwrap_or(0),
        );
        self.rest = rest;
        for _ in 0..steps {
            self.step();
        }
        self.publish();
    }

    /// The answer to a PDU that is addressed to this actuator; `None` if it stays silent.
    #[must_use]
    pub fn answer(&mut self, pdu: &[u8]) -> Option<Vec<u8>> {
        self.since_message_ms = 0;
        self.heard();
        self.publish_counters();
        let response = self.respond(pdu)?;
        if response.first().is_some_and(|f| *f >= 0x80) {
            count(&mut self.counters.exceptions);
        }
        self.publish();
        Some(response)
    }

    /// Carries out a PDU that is addressed to everybody. Only writes are allowed, and nobody answers.
    pub fn broadcast(&mut self, pdu: &[u8]) {
        self.since_message_ms = 0;
        self.heard();
        if pdu.first().is_some_and(|f| matches!(f, 5 | 6 | 15 | 16)) {
            let _unsent = self.respond(pdu);
            self.publish();
        }
    }

    /// Counts a frame for this actuator, which is one on the bus too.
    const fn heard(&mut self) {
        count(&mut self.counters.bus_messages);
        count(&mut self.counters.messages);
    }

    /// Counts a frame that came in too fast or was too long to be kept.
    pub const fn overrun(&mut self) {
        count(&mut self.counters.overruns);
    }

    /// Counts a frame on the bus that is for somebody else. Damaged ones are counted apart.
    pub const fn overheard(&mut self, sound: bool) {
        if sound {
            count(&mut self.counters.bus_messages);
        } else {
            count(&mut self.counters.bus_errors);
        }
    }

    /// Time by the clock of the actuator.
    fn stamp(&self) -> Stamp {
        Stamp::at(self.wall.saturating_add_signed(self.clock_offset))
    }

    fn is_v2(&self) -> bool {
        self.model >= Model::Icon3000v2
    }

    /// One step of time.
    fn step(&mut self) {
        self.age_ms = self.age_ms.saturating_add(STEP_MS.into());
        self.since_command_ms = self.since_command_ms.saturating_add(STEP_MS);
        self.since_message_ms = self.since_message_ms.saturating_add(STEP_MS);
        if self.is_commanded() {
            self.since_command_ms = 0;
        }
        self.mains();
        self.test();
        let demand = self.demand();
        let is_held = match demand {
            Demand::Stop => false,
            Demand::Open => self.is_held(true),
            Demand::Close => self.is_held(false),
            Demand::Follow(_) if self.has_fault(Fault::RequestSignal) => true,
            Demand::Reach(to) | Demand::Follow(to) => self.is_held(to > self.drive.position()),
        };
        let demand = if is_held { Demand::Stop } else { demand };
        let dead_band = u32::from(self.store.get(at::DEAD_BAND)).saturating_mul(100);
        let inhibit = u32::from(self.store.get(at::MOTION_INHIBIT)).saturating_mul(1000);
        let stamp = self.stamp();
        let before = self.drive.motion;
        self.drive.slow = self.slowness();
        let done = self.drive.step(STEP_MS, demand, dead_band, inhibit);
        self.keep_history(before);
        self.emergency();
        if done.hi_torque {
            self.warnings.add(self.wall, stamp, 2);
        }
        if let Some(stroke) = done.stroke {
            self.history.stroke(&stroke, self.wall);
            setup::curve(&mut self.store, &stroke, stamp, true);
        }
        // The end of travel clears enumerated open and close commands.
        let at_end = match self.command {
            command::OPEN => self.drive.is_open(),
            command::CLOSE => self.drive.is_closed(),
            _ => false,
        };
        if at_end {
            self.command = command::NONE;
        }
    }

    /// True if a fault keeps the motor from running in this direction.
    fn is_held(&self, opening: bool) -> bool {
        self.faults.iter().any(|f| f.stops(opening))
    }

    /// Notes starts of the motor with their cause, and samples of the recorders.
    fn keep_history(&mut self, before: Motion) {
        let now = self.drive.motion;
        if now != before {
            let code = match now {
                Motion::Still => 0,
                Motion::Opening => 1,
                Motion::Closing => 2,
            };
            let cause = if self.is_esd() {
                source::ESD
            } else if self.is_fail_safe() {
                source::FAIL_SAFE
            } else if self.pst != Pst::Off {
                source::PST
            } else if self.is_positioner() {
                source::BUS_REQUEST
            } else if self.is_commanded() {
                source::BUS
            } else if self.programme == Programme::Modulating {
                source::ANALOG_REQUEST
            } else {
                source::LOCAL
            };
            self.history.event(self.wall, code, cause);
        }
        let every = u64::from(history::TORQUE_EVERY).saturating_mul(1000);
        if now != Motion::Still && self.age_ms.is_multiple_of(every) {
            self.history.torque(self.wall, self.drive.load.into());
        }
        self.history.tick(self.wall);
    }

    /// A dip of the mains, once in a quarter of an hour.
    fn mains(&mut self) {
        let quarter = self.age_ms.checked_rem(900_000).unwrap_or(0);
        let (before, alarm_before) = (self.drive.low_mains, self.drive.no_mains);
        let live = self.programme != Programme::Idle;
        self.drive.low_mains = live && (400_000..410_000).contains(&quarter);
        self.drive.no_mains = live && (402_000..409_000).contains(&quarter);
        let stamp = self.stamp();
        if self.drive.low_mains && !before {
            self.warnings.add(self.wall, stamp, 4);
        }
        if self.drive.no_mains && !alarm_before {
            self.alarms.add(self.wall, stamp, 11);
            // An alarm clears enumerated open and close commands.
            if matches!(self.command, command::OPEN | command::CLOSE) {
                self.command = command::NONE;
            }
        }
    }
}

/// Counters go round.
const fn count(counter: &mut u16) {
    *counter = counter.wrapping_add(1);
}
