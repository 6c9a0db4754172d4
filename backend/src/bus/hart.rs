//! HART lines: one actor for each, on a serial modem, with a HART-IP gateway, or simulated.

mod actor;
pub mod gate;
mod ip;
mod job;
mod line;
mod open;
mod unit;
pub(crate) mod words;

pub use actor::start;
pub use ip::{Gateway, IpLine};
pub use line::{Port, SerialLine};
pub use open::{Line, MODE};

use super::{ClientId, Outlet};
use shared::capture::Micros;
use shared::hart::link::{Answer, Done, Failure};
use shared::proto::HartAsk;

/// What a page asks the actor of a HART line.
pub struct Wish {
    /// Who wants it.
    pub client: ClientId,
    /// Index of the device on this bus, where one is meant.
    pub device: Option<usize>,
    /// What is wanted.
    pub ask: HartAsk,
    /// Gets what comes of it.
    pub out: Outlet,
}

/// A request that was sent, and what came of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// From the delimiter to the check byte.
    pub request: Vec<u8>,
    /// The answer, whatever its response code.
    pub outcome: Result<Answer, Fault>,
    /// How often it was sent.
    pub tries: u8,
    /// When its first byte went out.
    pub began: Micros,
    /// When the last byte of the answer came, or when it was given up.
    pub ended: Micros,
}

impl From<Done> for Exchange {
    fn from(done: Done) -> Self {
        Self {
            request: done.request,
            outcome: done.outcome.map_err(Fault::Link),
            tries: done.tries,
            began: done.began,
            ended: done.ended,
        }
    }
}

/// Why there is no answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// The line did not bring it.
    Link(Failure),
    /// The gateway did not do it.
    Gateway(String),
}
