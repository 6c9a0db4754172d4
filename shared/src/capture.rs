//! What came off a wire or out of a file: bytes, and what is known about when and whence.

use core::fmt;

/// Microseconds on the clock of whoever recorded the capture. `shared` reads no clock itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Micros(u64);

impl Micros {
    /// Wraps a count of microseconds.
    #[must_use]
    pub const fn new(micros: u64) -> Self {
        Self(micros)
    }

    /// The count of microseconds.
    #[must_use]
    pub const fn get(self) -> u64 {
        self.0
    }

    /// So many microseconds later.
    #[must_use]
    pub const fn plus(self, micros: u64) -> Self {
        Self(self.0.saturating_add(micros))
    }

    /// Microseconds from `earlier` to here, 0 if the clock went back.
    #[must_use]
    pub const fn since(self, earlier: Self) -> u64 {
        self.0.saturating_sub(earlier.0)
    }
}

impl fmt::Display for Micros {
    /// Seconds with three decimals.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let millis = self.0.checked_div(1000).unwrap_or(0);
        let (whole, part) = (
            millis.checked_div(1000).unwrap_or(0),
            millis.checked_rem(1000).unwrap_or(0),
        );
        write!(f, "{whole}.{part:03}")
    }
}

/// Which way bytes went, where that is known. A sniffer on a two-wire line does not know.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Not known.
    #[default]
    Unknown,
    /// From the master to a device: requests.
    ToDevice,
    /// From a device to the master: responses.
    FromDevice,
}

/// A run of bytes as received.
#[derive(Clone, Copy, Debug)]
pub struct Capture<'a> {
    /// The bytes, unaltered.
    pub bytes: &'a [u8],
    /// When the last of them arrived.
    pub at: Option<Micros>,
    /// Which way they went.
    pub direction: Direction,
    /// True if the line was silent afterwards, so that a frame can't go on in the next capture.
    pub ends: bool,
}

impl<'a> Capture<'a> {
    /// Bytes about which nothing else is known, as pasted or read from a file.
    #[must_use]
    pub const fn of(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            at: None,
            direction: Direction::Unknown,
            ends: false,
        }
    }
}
