//! A block of registers that a device refuses: one register that its firmware does not have loses
//! the whole block (reading E84), so its rows are asked for in ever smaller parts.

use std::collections::VecDeque;

use crate::address::{Address, Table};
use crate::encode::Read;
use crate::icon3000::snapshot::{Failure, Part};
use crate::map::row::{Access, DeviceMap, Kind, Row};

/// After so many refusals in a row what is left is not asked for: most likely the device has none of
/// it.
const ENOUGH: u8 = 8;
/// Why it was not, where the device has other parts of the block.
const UNASKED: &str = "not asked for: eight parts of this block were refused in a row";
/// The same, where it has none that was asked for.
const REST: &str = "so were eight parts of it in a row, and the rest was not asked for by itself";

/// A block that is read in parts. The larger parts come first, so that what the device has is found
/// early, and a block of which it has nothing costs few requests.
#[derive(Clone, Debug)]
pub(super) struct Split {
    whole: Read,
    why: String,
    open: VecDeque<Read>,
    lost: Vec<Read>,
    unasked: Vec<Read>,
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
            unasked: Vec::new(),
            refusals: 0,
            answered: false,
        })
    }

    /// The next part to ask for; `None` after the last.
    pub(super) fn next(&mut self) -> Option<Read> {
        if self.refusals >= ENOUGH {
            self.unasked.extend(self.open.drain(..));
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

    /// What the device did not give: the block, or the rows of it that were refused and those that
    /// were not asked for, by address, those next to each other together.
    pub(super) fn failures(self) -> Vec<Failure> {
        if !self.answered {
            let why = if self.unasked.is_empty() {
                self.why
            } else {
                format!("{}; {REST}", self.why)
            };
            return vec![failure(
                self.whole.table,
                self.whole.start.get(),
                self.whole.count(),
                why,
            )];
        }
        let lost = self.lost.into_iter().map(|read| (read, self.why.as_str()));
        let unasked = self.unasked.into_iter().map(|read| (read, UNASKED));
        let mut parts: Vec<(Read, &str)> = lost.chain(unasked).collect();
        parts.sort_by_key(|(read, _)| read.start);
        let mut runs: Vec<(Table, u16, u16, &str)> = Vec::new();
        for (read, why) in parts {
            let start = read.start.get();
            match runs.last_mut() {
                Some((_, first, count, of))
                    if *of == why && first.saturating_add(*count) == start =>
                {
                    *count = count.saturating_add(read.count());
                }
                _ => runs.push((read.table, start, read.count(), why)),
            }
        }
        let runs = runs.into_iter();
        runs.map(|(table, start, count, why)| failure(table, start, count, why.to_owned()))
            .collect()
    }
}

fn failure(table: Table, start: u16, count: u16, why: String) -> Failure {
    Failure {
        part: Part::Block(table, Address::new(start), count),
        why,
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::row::Model;

    const WHY: &str = "exception 02: illegal data address";

    /// First register, how many, and why.
    type Lost = (u16, u16, String);

    /// Splits a block of a device that has nothing from `missing` on: what was asked for, and what
    /// comes of it.
    fn split(start: u16, count: u16, missing: u16) -> (Vec<(u16, u16)>, Vec<Lost>) {
        let map = Model::Icon3000v2.map();
        let whole = Read::new(Table::Holding, Address::new(start), count).unwrap();
        let mut split = Split::new(map, whole, WHY.to_owned()).unwrap();
        let mut asked = Vec::new();
        while let Some(read) = split.next() {
            let first = read.start.get();
            asked.push((first, read.count()));
            if first + read.count() > missing {
                split.refused(map, read);
            } else {
                split.answered();
            }
        }
        let failures = split.failures().into_iter().map(|f| match f.part {
            Part::Block(Table::Holding, start, count) => (start.get(), count, f.why),
            other => panic!("{other:?}"),
        });
        (asked, failures.collect())
    }

    /// HR 3580 to 3595 are 16 rows of one word (functions and contacts of eight relays). The second
    /// half is missing: the half, its quarters, its eighths and one row make eight refusals.
    #[test]
    fn rows_that_were_not_asked_for_are_not_said_to_be_refused() {
        let (asked, failures) = split(3580, 16, 3588);
        let by_hand = [
            (3580, 8),
            (3588, 8),
            (3588, 4),
            (3592, 4),
            (3588, 2),
            (3590, 2),
            (3592, 2),
            (3594, 2),
            (3588, 1),
        ];
        assert_eq!(asked, by_hand);
        let unasked = "not asked for: eight parts of this block were refused in a row";
        assert_eq!(
            failures,
            [(3588, 1, WHY.to_owned()), (3589, 7, unasked.to_owned())]
        );
        // Of six rows, three are missing: two halves, the parts of the second, and two rows of those.
        let (asked, failures) = split(3580, 6, 3583);
        assert_eq!(asked.len(), 6, "{asked:?}");
        assert_eq!(failures, [(3583, 3, WHY.to_owned())]);
    }

    /// Nothing of it is there: halves, quarters and two eighths; that the rest was left out is said.
    #[test]
    fn a_block_of_nothing_is_said_once() {
        let (asked, failures) = split(3580, 16, 3580);
        assert_eq!(asked.len(), 8);
        let why = format!(
            "{WHY}; so were eight parts of it in a row, and the rest was not asked for by itself"
        );
        assert_eq!(failures, [(3580, 16, why)]);
        let (_, failures) = split(3580, 2, 3580);
        assert_eq!(failures, [(3580, 2, WHY.to_owned())]);
    }
}
