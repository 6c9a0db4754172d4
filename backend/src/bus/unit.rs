//! One device on a line, as its actor knows it: what is to be read, and whether its next answer
//! could be that of an earlier request.

use super::schedule::Plan;
use super::{Fault, Reply};
use shared::capture::Micros;
use shared::encode::Read;
use shared::proto::Outcome;
use std::collections::VecDeque;
use std::time::Duration;
use tokio::time::Instant;

/// A device that does not answer is tried again after this time, then twice that, and so on.
const HOLD: Duration = Duration::from_secs(1);
/// But at least this often.
const LONGEST_HOLD: Duration = Duration::from_secs(10);

/// Who asked for a read.
pub enum Origin {
    /// A watch.
    Watch,
    /// Somebody who waits.
    Once(Reply),
}

/// A read that is under way or to be repeated.
pub struct Job {
    /// What to read.
    pub read: Read,
    /// Repetitions left.
    pub left: u8,
    /// Repetitions done.
    pub tried: u8,
    /// Who asked.
    pub origin: Origin,
}

/// One device.
pub struct Unit {
    /// Its tag.
    pub tag: String,
    /// Its address.
    pub address: u8,
    /// Where its state is posted.
    pub slot: usize,
    /// It answers the echo of FC 08, as far as is known.
    pub echo: bool,
    /// What is read again and again.
    pub plan: Plan,
    /// What is read once.
    pub once: VecDeque<(Read, Reply)>,
    /// What is to be repeated.
    pub again: Option<Job>,
    /// When a request was given up whose answer may still come, and how long that may take.
    pub open: Option<(Instant, Duration)>,
    /// The next answer is to be trusted only after an echo.
    pub resync: bool,
    /// Not asked for watches before this moment, because it does not answer.
    hold: Option<Instant>,
    silences: u32,
    /// How the last read ended.
    pub outcome: Option<Outcome>,
    /// When its state was posted last.
    pub posted: Option<Instant>,
    /// When it last answered well.
    pub last_ok: Option<Micros>,
    /// How long that took.
    pub latency: Option<Duration>,
}

impl Unit {
    /// A device of which nothing is known.
    #[must_use]
    pub fn new(tag: String, address: u8, slot: usize, echo: bool) -> Self {
        Self {
            tag,
            address,
            slot,
            echo,
            plan: Plan::default(),
            once: VecDeque::new(),
            again: None,
            open: None,
            resync: false,
            hold: None,
            silences: 0,
            outcome: None,
            posted: None,
            last_ok: None,
            latency: None,
        }
    }

    /// Before this moment the device is left alone, so that a late answer is not taken for another.
    /// `stray` is when bytes last came that nobody waited for.
    fn released(&self, stray: Option<Instant>) -> Option<Instant> {
        let (since, wait) = self.open?;
        Some(stray.map_or(since, |s| s.max(since)) + wait)
    }

    /// When there will be something to do: for somebody who waits, or at all.
    #[must_use]
    pub fn next(&self, stray: Option<Instant>, only_once: bool, now: Instant) -> Option<Instant> {
        let waits = !self.once.is_empty()
            || matches!(&self.again, Some(job) if matches!(job.origin, Origin::Once(_)));
        let due = if waits {
            // Long past: at once.
            Some(None)
        } else if only_once {
            None
        } else {
            let due = if self.again.is_some() {
                Some(None)
            } else {
                self.plan.next_due().map(Some)
            };
            due.map(|due| due.max(self.hold))
        };
        let due = due?;
        Some(due.max(self.released(stray)).unwrap_or(now))
    }

    /// Takes the next thing to do.
    #[must_use]
    pub fn take(&mut self, retries: u8, now: Instant) -> Option<Job> {
        let again = self.again.take();
        if let Some(job) = again {
            // Somebody waits: the watch will come up again by itself.
            if matches!(job.origin, Origin::Once(_)) || self.once.is_empty() {
                return Some(job);
            }
        }
        let (read, origin) = match self.once.pop_front() {
            Some((read, reply)) => (read, Origin::Once(reply)),
            None => (self.plan.due(now)?, Origin::Watch),
        };
        // A device known to be silent is tried, not pressed.
        let dead = self.silences > 0 && matches!(origin, Origin::Watch);
        Some(Job {
            read,
            left: if dead { 0 } else { retries },
            tried: 0,
            origin,
        })
    }

    /// Notes a fault; an answer that may still come makes the device wait for `quarantine`.
    pub fn failed(&mut self, fault: &Fault, quarantine: Duration, now: Instant) {
        if fault.is_open() {
            self.open = Some((now, quarantine));
            self.resync = self.echo;
        }
    }

    /// Notes how a read ended.
    pub fn ended(&mut self, outcome: Outcome, now: Instant) {
        if outcome == Outcome::Silence {
            let wait = HOLD.saturating_mul(1 << self.silences.min(8));
            self.hold = Some(now + wait.min(LONGEST_HOLD));
            self.silences = self.silences.saturating_add(1);
        } else {
            self.hold = None;
            self.silences = 0;
        }
    }

    /// The line was opened anew: nothing from before can come.
    pub fn reset(&mut self) {
        self.open = None;
        self.resync = false;
        self.hold = None;
        self.silences = 0;
    }
}
