//! What is read again and again on one device: the union of what its clients want.

use super::ClientId;
use shared::encode::Read;
use std::time::Duration;
use tokio::time::Instant;

/// The reads that are watched on a device.
#[derive(Debug, Default)]
pub struct Plan {
    entries: Vec<Entry>,
}

#[derive(Debug)]
struct Entry {
    read: Read,
    /// Who wants it how often.
    wants: Vec<(ClientId, Duration)>,
    due: Instant,
}

impl Entry {
    /// The shortest period that anybody wants.
    fn period(&self) -> Duration {
        let periods = self.wants.iter().map(|(_, period)| *period);
        periods.min().unwrap_or(Duration::MAX)
    }
}

impl Plan {
    /// Replaces what a client watches.
    pub fn set(&mut self, client: ClientId, reads: &[Read], period: Duration, now: Instant) {
        for entry in &mut self.entries {
            entry.wants.retain(|(who, _)| *who != client);
        }
        for read in reads {
            match self.entries.iter_mut().find(|e| e.read == *read) {
                Some(entry) if entry.wants.iter().any(|(who, _)| *who == client) => {}
                Some(entry) => {
                    entry.wants.push((client, period));
                    entry.due = entry.due.min(now + entry.period());
                }
                None => self.entries.push(Entry {
                    read: *read,
                    wants: vec![(client, period)],
                    due: now,
                }),
            }
        }
        self.entries.retain(|e| !e.wants.is_empty());
    }

    /// Forgets a client.
    pub fn leave(&mut self, client: ClientId) {
        for entry in &mut self.entries {
            entry.wants.retain(|(who, _)| *who != client);
        }
        self.entries.retain(|e| !e.wants.is_empty());
    }

    /// True if nobody watches anything.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// When the next read is due.
    #[must_use]
    pub fn next_due(&self) -> Option<Instant> {
        self.entries.iter().map(|e| e.due).min()
    }

    /// The read that has been due for longest.
    #[must_use]
    pub fn due(&self, now: Instant) -> Option<Read> {
        let due = self.entries.iter().filter(|e| e.due <= now);
        due.min_by_key(|e| e.due).map(|e| e.read)
    }

    /// A read is over. What could not be done in time is left out, not made up for.
    pub fn done(&mut self, read: Read, now: Instant) {
        if let Some(entry) = self.entries.iter_mut().find(|e| e.read == read) {
            let period = entry.period();
            // The grid is kept as long as it can be.
            entry.due = match entry.due.checked_add(period) {
                Some(next) if next > now => next,
                _ => now,
            };
            if entry.due == now {
                // Late by a whole period: whoever waits behind goes first.
                entry.due = now + Duration::from_micros(1);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::address::{Address, Table};

    const A: ClientId = ClientId(1);
    const B: ClientId = ClientId(2);
    const SECOND: Duration = Duration::from_secs(1);

    fn read(start: u16) -> Read {
        Read::new(Table::Holding, Address::new(start), 1).unwrap()
    }

    /// Runs the plan for a time in which every read takes `each`; counts the reads.
    fn run(plan: &mut Plan, mut now: Instant, time: Duration, each: Duration) -> Vec<(u16, usize)> {
        let end = now + time;
        let mut counts: Vec<(u16, usize)> = Vec::new();
        while now < end {
            let Some(read) = plan.due(now) else {
                now = plan.next_due().unwrap_or(end);
                continue;
            };
            let start = read.start.get();
            match counts.iter_mut().find(|(s, _)| *s == start) {
                Some((_, count)) => *count += 1,
                None => counts.push((start, 1)),
            }
            now += each;
            plan.done(read, now);
        }
        counts.sort_unstable();
        counts
    }

    #[tokio::test]
    async fn the_same_read_is_done_once_for_all() {
        let now = Instant::now();
        let mut plan = Plan::default();
        plan.set(A, &[read(1), read(2), read(1)], SECOND, now);
        plan.set(B, &[read(2)], SECOND / 4, now);
        let counts = run(&mut plan, now, SECOND * 10, SECOND / 1000);
        assert_eq!(counts, [(1, 10), (2, 40)]);
        plan.leave(B);
        assert_eq!(plan.next_due().map(|_| ()), Some(()));
        plan.set(A, &[], SECOND, now);
        assert!(plan.is_empty());
    }

    #[tokio::test]
    async fn a_plan_that_is_too_much_is_fair_and_does_not_burst() {
        let now = Instant::now();
        let mut plan = Plan::default();
        plan.set(A, &[read(1), read(2), read(3)], SECOND / 10, now);
        let counts = run(&mut plan, now, SECOND * 9, SECOND / 10);
        assert_eq!(counts, [(1, 30), (2, 30), (3, 30)]);
        // After a long pause there is one round, not all that were missed.
        let later = now + SECOND * 1000;
        for _ in 0..3 {
            let due = plan.due(later).unwrap();
            plan.done(due, later);
        }
        assert_eq!(plan.due(later), None);
    }
}
