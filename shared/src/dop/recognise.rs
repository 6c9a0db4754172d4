//! Finds reads of diagnostic objects in what was recorded on a bus.
//!
//! A read is a write of a request word, looks at a status register until it is ready, a read of
//! the count and reads of the response. With the addresses of the profile these are known; without
//! them they are inferred from the pattern, and [`Found::inferred`] says so.

mod building;
mod exchange;
mod infer;
#[cfg(test)]
mod tests;

use super::handshake::{Position, Shift};
use super::{Profile, Request};
use crate::address::Table;
use crate::capture::Micros;
use crate::pdu::Asked;
use building::Building;
use exchange::Act;
pub use exchange::Exchange;

/// Where the areas are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Areas {
    /// Table that is read.
    pub table: Table,
    /// The request register.
    pub request: u16,
    /// The status register.
    pub status: u16,
    /// The count register.
    pub count: u16,
    /// The first response register.
    pub response: u16,
}

impl Areas {
    /// Those of a profile, if it has them all.
    #[must_use]
    pub fn of(profile: &Profile) -> Option<Self> {
        let registers = &profile.registers;
        Some(Self {
            table: profile.table(),
            request: registers.request?,
            status: registers.status?,
            count: registers.count?,
            response: registers.response?,
        })
    }
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// The areas that were used; `None` if nothing looks like a read of an object.
    pub areas: Option<Areas>,
    /// True if the areas were inferred from the pattern.
    pub inferred: bool,
    /// The reads, in the order of their requests.
    pub reads: Vec<FoundRead>,
}

/// A read of one object.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundRead {
    /// Unit address.
    pub unit: u8,
    /// What was asked for.
    pub request: Request,
    /// The response registers, as far as they were read without a gap.
    pub words: Vec<u16>,
    /// What the count register said.
    pub count: Option<u16>,
    /// All registers of the count were read, and the status was ready.
    pub complete: bool,
    /// The device answered with an error; its code, if that was read.
    pub error: Option<Option<u16>>,
    /// Where the status bits stand, as this exchange shows.
    pub position: Position,
    /// When the request went out.
    pub started: Option<Micros>,
    /// When the status was seen to be ready.
    pub ready: Option<Micros>,
    /// When the last register came.
    pub ended: Option<Micros>,
    /// How often the status was read.
    pub polls: u32,
    /// What is remarkable, in words.
    pub problems: Vec<String>,
    /// Indices of all frames that belong to it.
    pub frames: Vec<u32>,
}

impl FoundRead {
    /// Microseconds from the request to the last register.
    #[must_use]
    pub fn took(&self) -> Option<u64> {
        Some(self.ended?.since(self.started?))
    }

    /// Microseconds from the request until it was ready.
    #[must_use]
    pub fn busy(&self) -> Option<u64> {
        Some(self.ready?.since(self.started?))
    }
}

/// Finds the reads of objects. Addresses that the profile lacks are inferred.
#[must_use]
pub fn recognise(exchanges: &[Exchange], profile: &Profile) -> Found {
    let configured = Areas::of(profile);
    let areas = configured.or_else(|| infer::areas(exchanges, profile));
    let Some(areas) = areas else {
        return Found::default();
    };
    let configured_shift = profile.status.shift.and_then(Shift::new);
    let mut reads = Vec::new();
    let mut open: Vec<Building> = Vec::new();
    for exchange in exchanges {
        let act = exchange.act();
        if let Act::Write(address, _) | Act::Refused(address, _) = act
            && address == areas.request
            && let Some(at) = open.iter().position(|b| b.read.unit == exchange.unit)
        {
            reads.push(open.swap_remove(at).finish());
        }
        match act {
            Act::Write(address, word) if address == areas.request => {
                let position = configured_shift.map_or(Position::Unknown, Position::Configured);
                open.push(Building::new(exchange, word, position, profile));
            }
            Act::Refused(address, code) if address == areas.request => {
                let word = Asked::new(&exchange.request).word(3).unwrap_or(0);
                let mut refused = Building::new(exchange, word, Position::Unknown, profile);
                refused.say(format!(
                    "The device refused the request with exception {code:02}."
                ));
                reads.push(refused.finish());
            }
            Act::Read(table, start, data) if table == areas.table => {
                if let Some(building) = open.iter_mut().find(|b| b.read.unit == exchange.unit) {
                    building.absorb(exchange, &areas, start, data);
                }
            }
            _ => {}
        }
    }
    reads.extend(open.into_iter().map(Building::finish));
    // Nearly in order: they were found one after the other.
    crate::few::sort_by_key(&mut reads, |r| r.frames.first().copied());
    Found {
        areas: Some(areas),
        inferred: configured.is_none(),
        reads,
    }
}
