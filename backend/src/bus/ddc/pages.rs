//! What pages ask for: read between two polls, so that it holds up nobody.

use super::Actor;
use crate::bus::query::Query;
use crate::bus::{Command, Reply, Report, words};
use shared::ddc100::HostPort;
use shared::ddc100::poller::Other;
use shared::proto::Outcome;
use tokio::time::Instant;

/// Reads that may wait.
const MAX_JOBS: usize = 512;

/// Who asked for a read.
enum Origin {
    /// A watch.
    Watch,
    /// Somebody who waits.
    Once(Reply),
}

/// A read of a unit beside the polls.
pub(super) struct Job {
    /// Which unit.
    at: usize,
    query: Query,
    origin: Origin,
    tried: u8,
}

impl Actor {
    /// Does what it is told, or notes it.
    pub(super) fn obey(&mut self, command: Command) {
        match command {
            Command::Read {
                device,
                query,
                reply,
            } => {
                let why = if !matches!(query, Query::Read(_) | Query::Diagnostic(_)) {
                    "a field unit has no files and no report"
                } else if device >= self.units.len() {
                    "there is no such device"
                } else if self.jobs.len() >= MAX_JOBS {
                    "too much is waiting for this network; try again later"
                } else {
                    return self.jobs.push_back(Job {
                        at: device,
                        query,
                        origin: Origin::Once(reply),
                        tried: 0,
                    });
                };
                reply(Report::failed(Outcome::Refused, why.to_owned()));
            }
            Command::Watch {
                client,
                device,
                reads,
                period,
            } => {
                if let Some(unit) = self.units.get_mut(device) {
                    unit.plan.set(client, &reads, period, Instant::now());
                    if unit.plan.is_empty() {
                        unit.trouble = None;
                    }
                }
            }
            // No unit of a network has diagnostic objects, or the files of an ICON3000, or speaks HART.
            Command::Dop { .. } | Command::Icon { .. } | Command::Hart(_) => {}
            Command::Leave { client } => {
                for unit in &mut self.units {
                    unit.plan.leave(client);
                    if unit.plan.is_empty() {
                        unit.trouble = None;
                    }
                }
            }
        }
    }

    /// Gives the poller the next read to put between two polls.
    pub(super) fn feed(&mut self, now: Instant) {
        if self.ports.iter().all(|p| p.line.is_none()) {
            let text = self.whole().1;
            for job in self.fed.take().into_iter().chain(self.jobs.drain(..)) {
                if let Origin::Once(reply) = job.origin {
                    reply(Report::down(&text));
                }
            }
            self.poller.forget(0);
            return;
        }
        if self.fed.is_some() {
            return;
        }
        let Some(job) = self.next_job(now) else {
            return;
        };
        let Some(unit) = self.units.get(job.at).map(|u| u.address) else {
            return;
        };
        // It knows all units, and nothing else waits there.
        if self.poller.ask(Other { id: 0, unit }).is_ok() {
            self.fed = Some(job);
        }
    }

    /// What somebody waits for goes first; then what is watched, one unit after the other.
    fn next_job(&mut self, now: Instant) -> Option<Job> {
        let units = &mut self.units;
        let mut free = |at: usize, query: &Query| {
            let unit = units.get_mut(at);
            unit.is_some_and(|u| u.doubts.until(query, now).is_none())
        };
        if let Some(job) = (0..self.jobs.len())
            .find(|n| self.jobs.get(*n).is_some_and(|j| free(j.at, &j.query)))
            .and_then(|n| self.jobs.remove(n))
        {
            return Some(job);
        }
        let count = units.len();
        for at in (1..=count).map(|step| (self.turn + step) % count) {
            let Some(unit) = self.units.get_mut(at) else {
                continue;
            };
            // A unit that no poll reaches is not pressed.
            if unit.is_off(self.poller.faults()) {
                continue;
            }
            let Some(read) = unit.plan.due(now) else {
                continue;
            };
            let query = read.into();
            if unit.doubts.until(&query, now).is_none() {
                self.turn = at;
                return Some(Job {
                    at,
                    query,
                    origin: Origin::Watch,
                    tried: 0,
                });
            }
        }
        None
    }

    /// Reads what a page asked for.
    pub(super) async fn serve(&mut self, unit: u8, port: HostPort) {
        let Some(mut job) = self.fed.take() else {
            // Nothing was to be sent after all.
            let now = self.clock.now();
            self.poller.done(Outcome::Refused, now);
            return;
        };
        let result = self.exchange(port, job.at, &job.query).await;
        job.tried = job.tried.saturating_add(1);
        let ended = self.clock.at(self.quiet_from);
        let report = match result {
            Ok(answer) => {
                let took = u64::try_from(answer.latency.as_micros()).unwrap_or(u64::MAX);
                if let Some(unit) = self.units.get_mut(job.at) {
                    unit.answered(ended, took);
                }
                Report::of(answer)
            }
            Err(fault) => {
                let bus = self.ports.iter().find(|p| p.number == port);
                let text = bus.map(|p| words::fault(&fault, &p.bus, unit, job.tried));
                Report::failed(words::outcome(&fault), text.unwrap_or_default())
            }
        };
        self.poller.done(report.outcome, ended);
        let failed = matches!(report.outcome, Outcome::Silence | Outcome::Damaged);
        match job.origin {
            Origin::Once(_) if failed && job.tried <= self.retries => self.jobs.push_front(job),
            Origin::Once(reply) => reply(report),
            Origin::Watch => {
                if let (Some(unit), Query::Read(read)) = (self.units.get_mut(job.at), job.query) {
                    unit.plan.done(read, Instant::now());
                    let good = report.outcome == Outcome::Ok;
                    unit.trouble = (!good).then_some((report.outcome, report.text));
                }
            }
        }
    }
}
