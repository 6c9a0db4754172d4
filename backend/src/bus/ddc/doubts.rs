//! Answers of a unit that may still come.
//!
//! An answer carries no number of its request. When a read was given up, its answer may come while
//! the next one is waited for, and if both have the same shape nobody can tell them apart. So for a
//! while after a read was given up, the unit is asked for another number of registers: a late answer
//! then has the wrong length and is thrown away. This costs nothing, needs no function of the unit,
//! and leaves the order and the pace of the polls as the guide wants them.

use crate::bus::query::Query;
use shared::address::Address;
use shared::encode::Read;
use std::time::Duration;
use tokio::time::Instant;

/// Registers that a unit has (LMAIM4019-00, table 3.5).
const REGISTERS: u16 = 56;

/// Reads of one unit that were given up and may be answered yet.
#[derive(Debug, Default)]
pub(super) struct Doubts {
    given_up: Vec<(Query, Instant, Duration)>,
}

impl Doubts {
    /// A read was given up; its answer may come for so long.
    pub fn add(&mut self, query: &Query, now: Instant, quarantine: Duration) {
        self.given_up.retain(|(other, ..)| !alike(other, query));
        self.given_up.push((query.clone(), now, quarantine));
    }

    /// Bytes came that nobody waited for: what was late may be later still.
    pub fn stray(&mut self, at: Instant) {
        for (_, since, _) in &mut self.given_up {
            *since = at.max(*since);
        }
    }

    /// Nothing from before can come.
    pub fn clear(&mut self) {
        self.given_up.clear();
    }

    /// When this read can be trusted; `None` at once.
    pub fn until(&mut self, query: &Query, now: Instant) -> Option<Instant> {
        self.given_up
            .retain(|(_, since, wait)| *since + *wait > now);
        let same = self.given_up.iter().find(|(other, ..)| alike(other, query));
        same.map(|(_, since, wait)| *since + *wait)
    }

    /// The read to poll with: `usual`, or one that contains it and can't be mistaken. If there is
    /// none, the moment from which there is.
    pub fn poll(&mut self, usual: Read, now: Instant) -> Result<Read, Instant> {
        let mut soonest: Option<Instant> = None;
        for read in shapes(usual) {
            match self.until(&read.into(), now) {
                None => return Ok(read),
                Some(at) => soonest = Some(soonest.map_or(at, |s| s.min(at))),
            }
        }
        Err(soonest.unwrap_or(now))
    }
}

/// True if the answer to one could be taken for that to the other.
fn alike(one: &Query, other: &Query) -> bool {
    match (one, other) {
        (Query::Read(one), Query::Read(other)) => {
            one.table == other.table && one.response_len() == other.response_len()
        }
        // An answer names its counter; an older value of the same one is what is feared.
        _ => one == other,
    }
}

/// The usual read, and longer ones that contain it.
fn shapes(usual: Read) -> impl Iterator<Item = Read> {
    let (start, count) = (usual.start.get(), usual.count());
    let behind = REGISTERS.saturating_sub(start + count);
    (0..REGISTERS).filter_map(move |more| {
        // First registers behind it, then before it.
        let before = more.saturating_sub(behind);
        let start = start.checked_sub(before)?;
        Read::new(usual.table, Address::new(start), count + more)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::address::Table;

    const WAIT: Duration = Duration::from_secs(1);

    fn read(start: u16, count: u16) -> Read {
        Read::new(Table::Holding, Address::new(start), count).unwrap()
    }

    #[tokio::test]
    async fn another_number_of_registers_is_read_for_a_while() {
        let mut doubts = Doubts::default();
        let (now, usual) = (Instant::now(), read(7, 6));
        assert_eq!(doubts.poll(usual, now), Ok(usual));
        for more in 0..5 {
            let next = doubts.poll(usual, now).unwrap();
            assert_eq!(next, read(7, 6 + more));
            doubts.add(&next.into(), now + WAIT * u32::from(more), WAIT);
        }
        assert_eq!(doubts.poll(usual, now + WAIT - WAIT / 100), Ok(read(7, 11)));
        assert_eq!(doubts.poll(usual, now + WAIT), Ok(usual));
        assert_eq!(doubts.poll(usual, now + WAIT * 6), Ok(usual));
    }

    /// Whatever the block is, it stays contained, within the registers that there are.
    #[tokio::test]
    async fn every_shape_contains_the_usual_registers() {
        let now = Instant::now();
        for (start, count) in [(0, 56), (8, 2), (7, 49), (0, 10), (3, 50)] {
            let (mut doubts, usual) = (Doubts::default(), read(start, count));
            let mut seen = 0;
            while let Ok(next) = doubts.poll(usual, now) {
                let (from, to) = (next.start.get(), next.start.get() + next.count());
                assert!(from <= start && to >= start + count && to <= REGISTERS);
                doubts.add(&next.into(), now, WAIT);
                seen += 1;
            }
            assert_eq!(seen, 57 - count, "{start}+{count}");
            assert_eq!(doubts.poll(usual, now), Err(now + WAIT));
        }
    }

    #[tokio::test]
    async fn what_is_late_keeps_being_doubted() {
        let mut doubts = Doubts::default();
        let now = Instant::now();
        doubts.add(&read(7, 6).into(), now, WAIT);
        doubts.stray(now + WAIT / 2);
        assert!(doubts.until(&read(40, 6).into(), now + WAIT).is_some());
        assert_eq!(
            doubts.until(&read(40, 6).into(), now + WAIT + WAIT / 2),
            None
        );
        // Coils are told apart by their function.
        doubts.add(&read(7, 6).into(), now, WAIT);
        let coils = Read::new(Table::Coil, Address::new(0), 9).unwrap();
        assert_eq!(doubts.until(&coils.into(), now), None);
        // Counters are told apart by their sub-function.
        doubts.add(&Query::Diagnostic(11), now, WAIT);
        assert!(doubts.until(&Query::Diagnostic(11), now).is_some());
        assert_eq!(doubts.until(&Query::Diagnostic(12), now), None);
        doubts.clear();
        assert_eq!(doubts.until(&read(7, 6).into(), now), None);
    }
}
