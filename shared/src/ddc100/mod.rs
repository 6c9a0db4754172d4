//! A DDC-100 network: who is asked when, what the pattern of faults means, how long a scan takes,
//! and what the registers of a unit say together.
//!
//! ```text
//!             setup ──► poller ──► Poll, Other, Wait ──► the owner's line
//!  the owner's clock ──►   │   ◄── Outcome of an exchange
//!                          ▼
//!                       faults ──► diagnosis in words
//! ```
//!
//! Everything here is pure: the [`poller::Poller`] sends nothing and reads no clock, it says what is
//! to be sent next and is told how it went. What single registers mean is in the maps of the unit
//! types (`shared/data/ddc100`).
//!
//! Source: FCD LMAIM4019-00 (9/04), sections 4.3 and 6. Where the guide is silent, the rules P1 to
//! P8 of [`poller`] say what is done.

pub mod checklist;
pub mod command;
pub mod counters;
pub mod diagnosis;
pub mod estimate;
pub mod faults;
pub mod follow;
pub mod poller;
pub mod scaling;
pub mod setup;
pub mod tables;
pub mod tags;
pub mod timing;
pub mod view;
pub mod words;

use core::fmt;

pub use diagnosis::{Diagnosis, End, Finding, diagnose};
pub use faults::FaultTable;
pub use poller::Poller;
pub use setup::Setup;

/// One of the two ports of the host.
///
/// Port 1 is channel A and reaches the first unit of the cable first; port 2 is channel B and comes
/// from the other end of the loop (section 4.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum HostPort {
    /// Host port 1, channel A.
    One,
    /// Host port 2, channel B.
    Two,
}

impl HostPort {
    /// Both, in order.
    pub const BOTH: [Self; 2] = [Self::One, Self::Two];

    /// 1 or 2, as in messages and on the page.
    #[must_use]
    pub const fn number(self) -> u8 {
        match self {
            Self::One => 1,
            Self::Two => 2,
        }
    }

    /// The port with this number.
    #[must_use]
    pub const fn from_number(number: u8) -> Option<Self> {
        match number {
            1 => Some(Self::One),
            2 => Some(Self::Two),
            _ => None,
        }
    }

    /// The other one.
    #[must_use]
    pub const fn other(self) -> Self {
        match self {
            Self::One => Self::Two,
            Self::Two => Self::One,
        }
    }

    /// `A` or `B`, as the channel is called in register 9.
    #[must_use]
    pub const fn channel(self) -> char {
        match self {
            Self::One => 'A',
            Self::Two => 'B',
        }
    }
}

impl fmt::Display for HostPort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "host port {}", self.number())
    }
}

/// Something that there is once for each host port.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Pair<T> {
    /// Of host port 1.
    pub one: T,
    /// Of host port 2.
    pub two: T,
}

impl<T: Copy> Pair<T> {
    /// The same for both.
    #[must_use]
    pub const fn both(value: T) -> Self {
        Self {
            one: value,
            two: value,
        }
    }

    /// That of a port.
    #[must_use]
    pub const fn get(&self, port: HostPort) -> T {
        match port {
            HostPort::One => self.one,
            HostPort::Two => self.two,
        }
    }

    /// Sets that of a port.
    pub const fn set(&mut self, port: HostPort, value: T) {
        match port {
            HostPort::One => self.one = value,
            HostPort::Two => self.two = value,
        }
    }
}
