//! What whoever drives a handshake does and says, and how it went.

use crate::capture::Micros;
use crate::dop::Request;
use crate::encode::Read;
use crate::proto::Outcome;

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Write the request word.
    Write {
        /// Address of the request register.
        address: u16,
        /// The request.
        request: Request,
        /// 6 or 16.
        function: u8,
    },
    /// Read registers.
    Read(Read),
    /// Nothing before this moment.
    Wait(Micros),
    /// Nothing any more.
    Over,
}

/// What came of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reply<'a> {
    /// The write was acknowledged.
    Written,
    /// The registers that were read.
    Words(&'a [u16]),
    /// The device refused with this exception code.
    Exception(u8),
    /// There is no sound answer.
    Lost(Outcome, &'a str),
}

/// What is known about the course of a read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Course {
    /// When the first request was written.
    pub started: Micros,
    /// When the device was ready, or in error.
    pub ready: Option<Micros>,
    /// When it was over.
    pub ended: Option<Micros>,
    /// How often the status was read.
    pub polls: u32,
    /// How often the request was begun anew.
    pub retries: u32,
    /// How often another master's request was seen.
    pub foreign: u32,
    /// The object of the last of these.
    pub foreign_object: Option<u16>,
    /// Blocks in which the data were read.
    pub blocks: u32,
}

impl Course {
    /// Microseconds from the request to the end.
    #[must_use]
    pub fn took(&self) -> u64 {
        self.ended.map_or(0, |end| end.since(self.started))
    }

    /// Microseconds from the request until the device was ready.
    #[must_use]
    pub fn busy(&self) -> u64 {
        self.ready.map_or(0, |ready| ready.since(self.started))
    }
}
