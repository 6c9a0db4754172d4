//! A block of registers that a device refuses: one register that its firmware does not have loses
//! the whole block (reading E84), so its rows are asked for in ever smaller parts.

use std::collections::VecDeque;

use crate::address::{Address, Table};
use crate::encode::Read;
use crate::icon3000::snapshot::{Failure, Part};
use crate::map::row::{Access, DeviceMap, Kind, Row};

/// After so many refusals in a row what is left is not asked for: the device has none of it.
const ENOUGH: u8 = 8;

/// A block that is read in parts. The larger parts come first, so that what the device has is found
/// early, and a block of which it has nothing costs few requests.
#[derive(Clone, Debug)]
pub(super) struct Split {
    whole: Read,
    why: String,
    open: VecDeque<Read>,
    lost: Vec<Read>,
    refusals: u8,
    answered: bool,
}

impl Split {
    /// The parts of a block that was refused; `None` if it is one row only.
    pub(super) fn new(map: &DeviceMap, whole: Read, why: String) -> Option<Self> {
        let halves = halves(map, whole)?;
        Some(Self {
            whole,
            why,
            open: halves.into(),
            lost: Vec::new(),
            refusals: 0,
            answered: false,
        })
    }

    /// The next part to ask for; `None` after the last.
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

    pub(super) fn refused(&mut self, map: &DeviceMap, part: Read) {
        self.refusals = self.refusals.saturating_add(1);
        match halves(map, part) {
            Some(halves) => self.open.extend(halves),
            None => self.lost.push(part),
        }
    }

    /// What the device did not give: the block, or the rows of it that were refused, those next to
    /// each other together.
    pub(super) fn failures(self) -> Vec<Failure> {
        let mut runs: Vec<(Table, u16, u16)> = Vec::new();
        let mut lost = if self.answered {
            self.lost
        } else {
            vec![self.whole]
        };
        lost.sort_by_key(|r| r.start);
        for read in lost {
            let start = read.start.get();
            match runs.last_mut() {
                Some((_, first, count)) if first.saturating_add(*count) == start => {
                    *count = count.saturating_add(read.count());
                }
                _ => runs.push((read.table, start, read.count())),
            }
        }
        let failure = |(table, start, count)| Failure {
            part: Part::Block(table, Address::new(start), count),
            why: self.why.clone(),
        };
        runs.into_iter().map(failure).collect()
    }
}

/// The rows of a block in two parts; `None` if there is but one.
fn halves(map: &DeviceMap, read: Read) -> Option<[Read; 2]> {
    let (first, end) = (
        read.start.get(),
        u32::from(read.start.get()).saturating_add(read.count().into()),
    );
    let reaches = |row: &&&Row| {
        let start = u32::from(row.address.get());
        let past = start.saturating_add(row.words.into());
        let readable = !matches!(row.access, Access::Absent | Access::WriteOnly);
        past > first.into() && start < end && readable && row.kind != Kind::Reserved
    };
    let rows: Vec<&Row> = map
        .rows_of(read.table)
        .iter()
        .filter(reaches)
        .copied()
        .collect();
    let (low, high) = rows.split_at(rows.len() / 2);
    let part = |rows: &[&Row]| {
        let start = rows.first()?.address.get().max(first);
        let last = rows.last()?;
        let past = u32::from(last.address.get())
            .saturating_add(last.words.into())
            .min(end);
        let count = u16::try_from(past.saturating_sub(start.into())).ok()?;
        Read::new(read.table, Address::new(start), count)
    };
    Some([part(low)?, part(high)?])
}
