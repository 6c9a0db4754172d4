//! The logs of alarms and warnings, the latest first.

use super::clock::{Stamp, since_2000};
use super::store::Store;

/// Entries that are kept; the registers show five of them, the file all.
const KEPT: usize = 100;

/// One event.
#[derive(Clone, Copy, Debug)]
struct Event {
    seconds: u32,
    stamp: Stamp,
    code: u16,
}

/// A log.
#[derive(Clone, Debug, Default)]
pub(super) struct Log {
    events: Vec<Event>,
}

impl Log {
    /// Notes an event; `wall` is in seconds since 1970.
    pub(super) fn add(&mut self, wall: u64, stamp: Stamp, code: u16) {
        let seconds = since_2000(wall);
        self.events.insert(
            0,
            Event {
                seconds,
                stamp,
                code,
            },
        );
        self.events.truncate(KEPT);
    }

    pub(super) fn clear(&mut self) {
        self.events.clear();
    }

    /// How many events of these codes there are.
    pub(super) fn count(&self, codes: &[u16]) -> u16 {
        let count = self.events.iter().filter(|e| codes.contains(&e.code));
        u16::try_from(count.count()).unwrap_or(u16::MAX)
    }

    /// Writes the five latest into their registers: code, date, time.
    pub(super) fn publish(&self, store: &mut Store, address: u16) {
        let mut words = Vec::with_capacity(25);
        for event in self.events.iter().take(5) {
            words.push(event.code);
            words.extend(event.stamp.date());
            words.extend(event.stamp.time());
        }
        words.resize(25, 0);
        store.fill(address, words);
    }

    /// The records of the log file: how many, then three words each (sections 8.11.1 and 8.11.2).
    pub(super) fn file(&self) -> Vec<u16> {
        let mut words = vec![u16::try_from(self.events.len()).unwrap_or(u16::MAX)];
        for event in &self.events {
            let [a, b, c, d] = event.seconds.to_be_bytes();
            words.extend([u16::from_be_bytes([a, b]), u16::from_be_bytes([c, d])]);
            words.push(event.code);
        }
        words
    }
}
