//! How a network is made up.

use core::fmt;

use super::HostPort;
use super::timing::{LEAST_TIMEOUT_US, Line, timeout};
use crate::device::Device;
use crate::encode::Read;
use crate::proto::DdcShape;

/// Units that a network may have (table 3.1).
pub const MOST_UNITS: usize = 250;
/// Highest address of a unit.
pub const LAST_UNIT: u8 = 250;
/// Repeats that the guide allows (section 6.1, item 2).
pub const MOST_RETRIES: u8 = 3;
/// The host waits longer than this before the next request (section 4.3), in microseconds.
pub const LEAST_TURN_US: u64 = 20_000;
/// And not as long as this.
pub const MOST_TURN_US: u64 = 50_000;
/// Repeats if nothing else is said.
pub const USUAL_RETRIES: u8 = 1;
/// Turn time if nothing else is said, in microseconds: the shortest whole number of milliseconds that
/// the guide allows.
pub const USUAL_TURN_US: u64 = 21_000;
/// How long a unit may take if nothing else is said, in microseconds: more than 200 ms (section 4.3,
/// point 4). The time of its answer on the wire is added (reading D24).
pub const USUAL_TIMEOUT_US: u64 = 250_000;
/// First and last register of a poll if nothing else is said: position, status, faults, outputs,
/// inputs, timers, user faults and current state.
pub const USUAL_REGISTERS: (u16, u16) = (8, 16);
/// Units of a multi-drop line without repeaters (section 4.2.3).
pub const MOST_MULTI_DROP: usize = 28;

/// A unit of a network.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Member {
    /// Its address, 1 to 250.
    pub unit: u8,
    /// Its type.
    pub kind: Device,
}

/// How a network is made up and how it is polled.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setup {
    /// How the cable runs.
    pub shape: DdcShape,
    /// True if the host has a second port, at the far end of a loop.
    pub second: bool,
    /// The units in the order of the cable, from host port 1.
    pub units: Vec<Member>,
    /// What is read of each unit.
    pub read: Read,
    /// Framing and speed.
    pub line: Line,
    /// How often a poll is repeated on the same port before it has failed, 0 to 3.
    pub retries: u8,
    /// True if it is repeated also where a fault is known already; else it is tried once on each pass,
    /// so that units that are off hold up the others less.
    pub retry_faulty: bool,
    /// From an answer to the next request, in microseconds.
    pub turn_us: u64,
    /// How long an answer is waited for at least, in microseconds; see [`timeout`].
    pub timeout_us: u64,
}

/// Why a network can't be polled as it is set up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SetupProblem {
    /// No unit.
    Empty,
    /// More than 250 units.
    TooMany(usize),
    /// An address outside 1 to 250.
    Address(u8),
    /// An address that two units have.
    Twice(u8),
    /// A second port on a network that is no loop.
    SecondPort,
    /// More than three repeats.
    Retries(u8),
    /// A turn time outside 20 to 50 ms.
    Turn(u64),
    /// A time-out of 200 ms or less.
    Timeout(u64),
    /// More units than a multi-drop line carries without repeaters; see [`Setup::hint`].
    MultiDrop(usize),
    /// A speed of 0.
    Baud,
}

impl fmt::Display for SetupProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |us: &u64| us.checked_div(1000).unwrap_or(0);
        match self {
            Self::Empty => f.write_str("A network needs at least one unit."),
            Self::TooMany(n) => write!(
                f,
                "{n} units are too many: a DDC-100 network has room for {MOST_UNITS}."
            ),
            Self::Address(a) => write!(
                f,
                "Unit address {a} does not exist: field units have 1 to {LAST_UNIT}."
            ),
            Self::Twice(a) => write!(
                f,
                "Two units have address {a}; both would answer at once. Give each its own."
            ),
            Self::SecondPort => f.write_str(
                "Only a loop comes back to a second host port. Take the second port out, or make it a loop.",
            ),
            Self::Retries(n) => write!(
                f,
                "{n} retries are too many: the guide allows {MOST_RETRIES}, so that one unit does not hold up the others."
            ),
            Self::Turn(us) => write!(
                f,
                "A turn time of {} ms is outside what the guide wants: more than 20 and less than 50 ms.",
                ms(us)
            ),
            Self::Timeout(us) => write!(
                f,
                "A time-out of {} ms is too short: the guide wants more than 200 ms.",
                ms(us)
            ),
            Self::MultiDrop(n) => write!(
                f,
                "A multi-drop line carries {MOST_MULTI_DROP} units without repeaters, and here are {n}."
            ),
            Self::Baud => f.write_str("The line needs a speed."),
        }
    }
}

impl Setup {
    /// A network that is polled with `read`, usually of [`USUAL_REGISTERS`]; the rest by default: RTU,
    /// 9600 baud, one retry, 21 ms turn time, 250 ms time-out.
    #[must_use]
    pub fn new(shape: DdcShape, second: bool, units: Vec<Member>, read: Read) -> Self {
        Self {
            shape,
            second,
            units,
            read,
            line: Line::GUIDE,
            retries: USUAL_RETRIES,
            retry_faulty: false,
            turn_us: USUAL_TURN_US,
            timeout_us: USUAL_TIMEOUT_US,
        }
    }

    /// Everything that speaks against it.
    #[must_use]
    pub fn problems(&self) -> Vec<SetupProblem> {
        let mut found = Vec::new();
        if self.units.is_empty() {
            found.push(SetupProblem::Empty);
        }
        if self.units.len() > MOST_UNITS {
            found.push(SetupProblem::TooMany(self.units.len()));
        }
        let mut known = [false; 256];
        for member in &self.units {
            if !(1..=LAST_UNIT).contains(&member.unit) {
                found.push(SetupProblem::Address(member.unit));
            }
            if let Some(known) = known.get_mut(usize::from(member.unit)) {
                if *known {
                    found.push(SetupProblem::Twice(member.unit));
                }
                *known = true;
            }
        }
        if self.second && self.shape != DdcShape::Loop {
            found.push(SetupProblem::SecondPort);
        }
        if self.retries > MOST_RETRIES {
            found.push(SetupProblem::Retries(self.retries));
        }
        if self.turn_us <= LEAST_TURN_US || self.turn_us >= MOST_TURN_US {
            found.push(SetupProblem::Turn(self.turn_us));
        }
        if self.timeout_us <= LEAST_TIMEOUT_US {
            found.push(SetupProblem::Timeout(self.timeout_us));
        }
        if self.line.baud == 0 {
            found.push(SetupProblem::Baud);
        }
        found
    }

    /// What may be right all the same: more units on a multi-drop line than it carries without
    /// repeaters.
    #[must_use]
    pub fn hint(&self) -> Option<SetupProblem> {
        let many = self.shape == DdcShape::MultiDrop && self.units.len() > MOST_MULTI_DROP;
        many.then_some(SetupProblem::MultiDrop(self.units.len()))
    }

    /// True if the host has this port.
    #[must_use]
    pub const fn has(&self, port: HostPort) -> bool {
        self.second || matches!(port, HostPort::One)
    }

    /// How long the answer of a unit to a poll is waited for, in microseconds from the end of the
    /// request to the last character.
    #[must_use]
    pub fn timeout(&self, kind: Device) -> u64 {
        timeout(self.line, kind, &self.read, self.timeout_us)
    }
}
