//! One device on a line, as its actor knows it: what is to be read, and whether its next answer
//! could be that of an earlier request.

use super::dop::{DopUnit, Step, until};
use super::gate::DopPermit;
use super::icon::IconUnit;
use super::query::Query;
use super::schedule::Plan;
use super::{ClientId, Fault, Reply};
use crate::clock::Clock;
use shared::capture::Micros;
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
    /// The handshake of a diagnostic object.
    Dop,
    /// A watch of the user indicators.
    Indicators,
    /// Files, identity or counters of an ICON3000.
    Icon,
}

/// What is asked of a device.
#[derive(Debug)]
pub enum Ask {
    /// A read.
    Query(Query),
    /// The request for a diagnostic object.
    Dop(DopPermit),
}

impl Ask {
    /// Length of a good response PDU.
    #[must_use]
    pub fn response_len(&self) -> usize {
        match self {
            Self::Query(query) => query.response_len(),
            Self::Dop(permit) => permit.response_len(),
        }
    }
}

/// Something that is under way or to be repeated.
pub struct Job {
    /// What to ask.
    pub ask: Ask,
    /// Repetitions left.
    pub left: u8,
    /// Repetitions done.
    pub tried: u8,
    /// Who asked.
    pub origin: Origin,
}

impl Job {
    const fn new(ask: Ask, left: u8, origin: Origin) -> Self {
        Self {
            ask,
            left,
            tried: 0,
            origin,
        }
    }
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
    pub once: VecDeque<(Query, Reply)>,
    /// What is to be repeated.
    pub again: Option<Job>,
    /// Its diagnostic objects, if it has any.
    pub dop: Option<DopUnit>,
    /// What is read of it beyond its registers, if it is an ICON3000.
    pub icon: Option<IconUnit>,
    /// The last thing done was for a program of a page: a watch goes first now.
    program_was_last: bool,
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
    pub fn new(
        tag: String,
        address: u8,
        slot: usize,
        dop: Option<DopUnit>,
        icon: Option<IconUnit>,
    ) -> Self {
        Self {
            tag,
            address,
            slot,
            // Of the devices here, the ICON3000 has the function.
            echo: icon.is_some(),
            plan: Plan::default(),
            once: VecDeque::new(),
            again: None,
            dop,
            icon,
            program_was_last: false,
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
    pub fn next(
        &mut self,
        stray: Option<Instant>,
        only_once: bool,
        now: Instant,
        clock: Clock,
    ) -> Option<Instant> {
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
            let watched = due.map(|due| due.max(self.hold));
            let objects = self.dop_due(now, clock).map(Some);
            let files = self.icon.as_ref().and_then(|i| i.due(now)).map(Some);
            [watched, objects, files].into_iter().flatten().min()
        };
        let due = due?;
        Some(due.max(self.released(stray)).unwrap_or(now))
    }

    /// When the diagnostic objects go on.
    fn dop_due(&mut self, now: Instant, clock: Clock) -> Option<Instant> {
        let at = clock.at(now);
        let due = self.dop.as_mut()?.due(at)?;
        Some(now + until(due, at))
    }

    /// Takes the next thing to do.
    #[must_use]
    pub fn take(&mut self, retries: u8, now: Instant, clock: Clock) -> Option<Job> {
        let again = self.again.take();
        if let Some(job) = again {
            // Somebody waits: the watch will come up again by itself.
            if !matches!(job.origin, Origin::Watch) || self.once.is_empty() {
                return Some(job);
            }
        }
        if let Some((query, reply)) = self.once.pop_front() {
            return Some(Job::new(Ask::Query(query), retries, Origin::Once(reply)));
        }
        // Watches and what programs of a page ask for take turns.
        let watch = self
            .plan
            .due(now)
            .filter(|_| self.hold.is_none_or(|hold| hold <= now));
        if watch.is_none() || !self.program_was_last {
            let job = self.program(retries, now, clock);
            self.program_was_last = job.is_some();
            if job.is_some() {
                return job;
            }
        }
        self.program_was_last = false;
        // A device known to be silent is tried, not pressed.
        let retries = if self.silences > 0 { 0 } else { retries };
        let ask = Ask::Query(watch?.into());
        Some(Job::new(ask, retries, Origin::Watch))
    }

    /// Takes the next thing that a program of a page asked for.
    fn program(&mut self, retries: u8, now: Instant, clock: Clock) -> Option<Job> {
        if let Some(query) = self.icon.as_mut().and_then(IconUnit::take) {
            return Some(Job::new(Ask::Query(query), retries, Origin::Icon));
        }
        let job = match self.dop.as_mut()?.take(clock.at(now))? {
            // The handshake itself knows whether a write may be repeated.
            Step::Write(permit) => Job::new(Ask::Dop(permit), 0, Origin::Dop),
            Step::Read(read) => Job::new(Ask::Query(read.into()), retries, Origin::Dop),
            Step::Indicators(read) => Job::new(Ask::Query(read.into()), 0, Origin::Indicators),
        };
        Some(job)
    }

    /// A page is gone.
    pub fn leave(&mut self, client: ClientId) {
        self.plan.leave(client);
        if let Some(dop) = &mut self.dop {
            dop.leave(client);
        }
        if let Some(icon) = &mut self.icon {
            icon.leave(client);
        }
    }

    /// The line is down: what programs of a page wait for will not come.
    pub fn programs_down(&mut self, text: &str, at: Micros) {
        if let Some(dop) = &mut self.dop {
            dop.down(text);
        }
        if let Some(icon) = &mut self.icon {
            icon.down(text, at);
        }
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
