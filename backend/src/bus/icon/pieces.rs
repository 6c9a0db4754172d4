//! A block of registers that a device refuses: one register that its firmware does not have loses
//! the whole block (reading E84), so its rows are asked for in ever smaller pieces.

use shared::address::Address;
use shared::encode::Read;
use shared::map::plan::plan;
use shared::map::row::{Access, DeviceMap, Kind, Row};
use std::collections::VecDeque;

/// After so many refusals in a row what is left is not asked for: the device has none of it.
const ENOUGH: u8 = 8;

/// A block that is read in pieces. The larger ones come first, so that what the device has is found
/// early, and a block of which it has nothing costs few requests.
#[derive(Debug)]
pub(super) struct Pieces {
    /// The step that asked for it.
    pub(super) step: u32,
    whole: Read,
    open: VecDeque<Read>,
    lost: Vec<Read>,
    text: String,
    refusals: u8,
    answered: bool,
}

impl Pieces {
    /// The pieces of a block that was refused; `None` if it is one row only.
    pub(super) fn new(map: Option<&DeviceMap>, step: u32, whole: Read, text: &str) -> Option<Self> {
        let open: VecDeque<Read> = halves(map, whole).into();
        (!open.is_empty()).then(|| Self {
            step,
            whole,
            open,
            lost: Vec::new(),
            text: text.to_owned(),
            refusals: 0,
            answered: false,
        })
    }

    /// The next one to ask for; `None` after the last.
    pub(super) fn next(&mut self) -> Option<Read> {
        if self.refusals >= ENOUGH {
            self.lost.extend(self.open.drain(..));
        }
        self.open.pop_front()
    }

    pub(super) const fn answered(&mut self) {
        self.refusals = 0;
        self.answered = true;
    }

    /// Exception 02, in these words.
    pub(super) fn refused(&mut self, map: Option<&DeviceMap>, piece: Read, text: &str) {
        self.refusals = self.refusals.saturating_add(1);
        text.clone_into(&mut self.text);
        let halves = halves(map, piece);
        if halves.is_empty() {
            self.lost.push(piece);
        }
        self.open.extend(halves);
    }

    /// What the device has not: the block, or rows of it, those next to each other together; and
    /// its words for that.
    pub(super) fn lost(mut self) -> (Vec<Read>, String) {
        if !self.answered {
            return (vec![self.whole], self.text);
        }
        self.lost.sort_by_key(|read| read.start);
        let mut runs: Vec<Read> = Vec::new();
        for read in self.lost {
            let joined = runs.last().and_then(|last| {
                let touch = end(*last) == u32::from(read.start.get());
                let count = last.count().saturating_add(read.count());
                Read::new(last.table, last.start, count).filter(|_| touch)
            });
            if joined.is_some() {
                runs.pop();
            }
            runs.push(joined.unwrap_or(read));
        }
        (runs, self.text)
    }
}

/// One past the last address.
fn end(read: Read) -> u32 {
    u32::from(read.start.get()) + u32::from(read.count())
}

/// The rows of a block in two reads; none if there is but one row.
fn halves(map: Option<&DeviceMap>, read: Read) -> Vec<Read> {
    let inside = |row: &&&Row| {
        let place = Address::new(row.address.get());
        let readable = !matches!(row.access, Access::Absent | Access::WriteOnly);
        let at = u32::from(place.get());
        let first = u32::from(read.start.get());
        readable
            && row.kind != Kind::Reserved
            && at < end(read)
            && at + u32::from(row.words) > first
    };
    let rows = map.map_or(&[][..], |map| map.rows_of(read.table));
    let rows: Vec<&Row> = rows.iter().filter(inside).copied().collect();
    if rows.len() < 2 {
        return Vec::new();
    }
    let (low, high) = rows.split_at(rows.len() / 2);
    [low, high]
        .iter()
        .flat_map(|rows| plan(read.table, rows.iter().copied()))
        .collect()
}
