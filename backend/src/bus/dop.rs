//! The diagnostic objects of one device: what was asked for, and the handshake that is under way.
//!
//! Requests of all pages stand in one queue; a handshake is not begun before the one before is over,
//! for there is one request register only. Between two steps the line is free for other devices.

mod job;
#[cfg(test)]
mod tests;

use super::gate::{DopPermit, Gate};
use super::{ClientId, Outlet, Report};
use crate::config::DeviceConfig;
use job::Job;
use shared::address::Address;
use shared::capture::Micros;
use shared::dop::handshake::{Handshake, Next, Position, Reply, Setup, Why};
use shared::dop::{Profile, Request};
use shared::encode::Read;
use shared::proto::{DopAsk, DopNews, MIN_PERIOD_MS, Outcome};
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

/// Jobs that may wait for one device.
const MAX_JOBS: usize = 64;
/// How long a page that takes nothing is waited for before it is looked at again.
const PAUSE_US: u64 = 5_000;
/// Registers of the user indicators.
const INDICATORS: u16 = 4;

/// Something to send.
#[derive(Debug)]
pub enum Step {
    /// The request for an object.
    Write(DopPermit),
    /// A read that belongs to the handshake.
    Read(Read),
    /// The user indicators.
    Indicators(Read),
}

/// Who watches the user indicators.
struct Watch {
    client: ClientId,
    period_us: u64,
    out: Outlet,
}

/// The diagnostic objects of one device.
pub struct DopUnit {
    tag: String,
    address: u8,
    gate: Gate,
    profile: Arc<Profile>,
    position: Position,
    /// The object that was read before.
    previous: Option<u16>,
    jobs: VecDeque<Job>,
    running: Option<Handshake>,
    watches: Vec<Watch>,
    watch_due: Micros,
}

impl DopUnit {
    /// The unit of a device; `None` if it is not declared as DOP.
    #[must_use]
    pub fn of(device: &DeviceConfig, gate: &Gate) -> Option<Self> {
        if !device.device.is_dop() {
            return None;
        }
        Some(Self {
            tag: device.tag.clone(),
            address: device.unit,
            gate: gate.clone(),
            profile: device.profile.clone().unwrap_or_default(),
            position: Position::Unknown,
            previous: None,
            jobs: VecDeque::new(),
            running: None,
            watches: Vec::new(),
            watch_due: Micros::default(),
        })
    }

    /// Does what a page asks.
    pub fn ask(&mut self, client: ClientId, ask: DopAsk, out: Outlet) {
        let job = match ask {
            DopAsk::Cancel { id } => {
                let mine = |j: &&mut Job| j.is(client, id);
                self.jobs.iter_mut().filter(mine).for_each(Job::cancel);
                return;
            }
            DopAsk::Watch { period_ms, .. } => return self.watch(client, period_ms, out),
            DopAsk::Profile { .. } => return self.tell_profile(&out),
            DopAsk::Read { id, requests, .. } => Job::read(client, id, requests, out),
            DopAsk::Log {
                id,
                object,
                from,
                after,
                limit,
                ..
            } => match Job::log(client, id, object, from, after, limit, &self.profile, out) {
                Ok(job) => job,
                Err(out) => {
                    let text = format!("Object {object} is no log; the logs are 1202 and 1203.");
                    self.refuse(&out, id, object, text);
                    return;
                }
            },
        };
        if self.jobs.len() >= MAX_JOBS {
            let text = "Too much is waiting for this device; try again later.".to_owned();
            self.refuse(&job.out, job.id, 0, text);
            return;
        }
        self.jobs.push_back(job);
    }

    fn refuse(&self, out: &Outlet, id: u32, request: u16, text: String) {
        out.send(DopNews::Failed {
            id,
            device: self.tag.clone(),
            request,
            code: None,
            outcome: Outcome::Refused,
            text,
        });
        out.send(DopNews::Done {
            id,
            device: self.tag.clone(),
            ok: 0,
            failed: 1,
        });
    }

    fn watch(&mut self, client: ClientId, period_ms: u32, out: Outlet) {
        self.watches.retain(|w| w.client != client);
        if period_ms == 0 {
            return;
        }
        if self.profile.registers.indicators.is_none() {
            // It has no id that could fail; the profile says the same.
            self.tell_profile(&out);
            return;
        }
        self.watches.push(Watch {
            client,
            period_us: u64::from(period_ms.max(MIN_PERIOD_MS)) * 1000,
            out,
        });
        self.watch_due = Micros::default();
    }

    fn tell_profile(&self, out: &Outlet) {
        let shift = match self.position {
            Position::Learned(shift) | Position::Likely(shift) => Some(shift.bit()),
            Position::Configured(_) | Position::Unknown => None,
        };
        let profile = serde_json::from_str(&self.profile.to_json());
        out.send(DopNews::Profile {
            device: self.tag.clone(),
            profile: profile.unwrap_or_default(),
            shift,
        });
    }

    /// A page is gone. What is under way on the line comes to its end.
    pub fn leave(&mut self, client: ClientId) {
        self.watches.retain(|w| w.client != client);
        self.jobs
            .iter_mut()
            .filter(|j| j.client == client)
            .for_each(Job::cancel);
    }

    /// When there will be something to do; `None` if nothing is asked for.
    pub fn due(&mut self, now: Micros) -> Option<Micros> {
        let watch = (!self.watches.is_empty()).then_some(self.watch_due);
        let work = self.settle(now);
        [watch, work].into_iter().flatten().min()
    }

    /// Takes the next thing to send.
    pub fn take(&mut self, now: Micros) -> Option<Step> {
        if !self.watches.is_empty() && self.watch_due <= now {
            let start = Address::new(self.profile.registers.indicators?);
            let read = Read::new(self.profile.table(), start, INDICATORS)?;
            return Some(Step::Indicators(read));
        }
        if self.settle(now)? > now {
            return None;
        }
        match self.running.as_mut()?.next(now) {
            Next::Read(read) => Some(Step::Read(read)),
            Next::Write { request, .. } => match self.gate.permit(self.address, request) {
                Ok(permit) => Some(Step::Write(permit)),
                Err(denied) => {
                    self.running = None;
                    self.fail(request, Outcome::Refused, None, denied.to_string());
                    None
                }
            },
            Next::Wait(_) | Next::Over => None,
        }
    }

    /// Brings the queue to the point where something has to be sent or waited for, and says when.
    fn settle(&mut self, now: Micros) -> Option<Micros> {
        loop {
            if let Some(running) = &mut self.running {
                match running.next(now) {
                    Next::Write { .. } | Next::Read(_) => return Some(now),
                    Next::Wait(until) => return Some(until),
                    Next::Over => self.conclude(),
                }
                continue;
            }
            let job = self.jobs.front_mut()?;
            if !job.out.has_room() {
                return Some(Micros::new(now.get() + PAUSE_US));
            }
            let Some(request) = job.next_request() else {
                job.finish(&self.tag);
                self.jobs.pop_front();
                continue;
            };
            self.begin(request, now);
        }
    }

    /// Begins a handshake, or says why it can't be.
    fn begin(&mut self, request: Request, now: Micros) {
        if self.jobs.front().is_some_and(Job::is_hopeless) {
            let text = "not asked for, since the device does not answer".to_owned();
            self.fail(request, Outcome::Silence, None, text);
            return;
        }
        let mut setup = match Setup::of(&self.profile) {
            Ok(setup) => setup,
            Err(missing) => {
                self.fail(request, Outcome::Refused, None, missing.to_string());
                return;
            }
        };
        if let Err(denied) = self.gate.permit(self.address, request) {
            self.fail(request, Outcome::Refused, None, denied.to_string());
            return;
        }
        if !matches!(setup.position, Position::Configured(_)) {
            setup.position = self.position;
        }
        setup.previous = self.previous;
        if let Some(job) = self.jobs.front() {
            // "Older" asked twice would pass over a page.
            if !job.may_repeat() {
                setup.retries = 0;
            }
        }
        let handshake = Handshake::new(request, setup, now);
        if let Some(job) = self.jobs.front_mut() {
            job.progress(&self.tag, &handshake);
        }
        self.running = Some(handshake);
    }

    /// The object that is being read can't be.
    fn fail(&mut self, request: Request, outcome: Outcome, why: Option<&Why>, text: String) {
        if let Some(job) = self.jobs.front_mut() {
            job.failed(&self.tag, request, outcome, why, text);
        }
    }

    /// A handshake is over.
    fn conclude(&mut self) {
        let Some(handshake) = self.running.take() else {
            return;
        };
        self.previous = handshake.stands();
        let position = handshake.position();
        if !matches!(position, Position::Configured(_)) && position != self.position {
            self.position = position;
            if let Some(job) = self.jobs.front() {
                self.tell_profile(&job.out);
            }
        }
        match handshake.outcome() {
            Some(Ok(words)) => {
                if let Some(job) = self.jobs.front_mut() {
                    job.read_done(&self.tag, &handshake, words, &self.profile);
                }
            }
            Some(Err(why)) => {
                let (outcome, text) = (why.outcome(), handshake.text());
                let why = why.clone();
                self.fail(handshake.request(), outcome, Some(&why), text);
            }
            None => {}
        }
    }

    /// What came of a step of the handshake.
    pub fn reply(&mut self, report: &Report, now: Micros) {
        let Some(running) = &mut self.running else {
            return;
        };
        let step = running.step();
        let words: Vec<u16>;
        let reply = match (report.outcome, report.pdu.as_deref(), report.code) {
            (_, _, Some(code)) => Reply::Exception(code),
            (Outcome::Ok, Some([3 | 4, _, data @ ..]), _) => {
                words = registers(data);
                Reply::Words(&words)
            }
            (Outcome::Ok, ..) => Reply::Written,
            (outcome, ..) => Reply::Lost(outcome, &report.text),
        };
        running.reply(reply, now);
        if running.step() != step
            && let Some(job) = self.jobs.front_mut()
        {
            job.progress(&self.tag, running);
        }
        if running.outcome().is_some() {
            self.conclude();
        }
    }

    /// The user indicators were read, or not.
    pub fn indicators(&mut self, report: &Report, now: Micros) {
        let period = self.watches.iter().map(|w| w.period_us).min();
        self.watch_due = Micros::new(now.get() + period.unwrap_or(0));
        if let (Outcome::Ok, Some([_, _, data @ ..])) = (report.outcome, report.pdu.as_deref()) {
            for watch in &self.watches {
                watch.out.say(DopNews::Indicators {
                    device: self.tag.clone(),
                    hex: shared::render::hex(data),
                    at_us: now.get(),
                });
            }
        }
    }

    /// The line is down: nothing that was asked for can be had.
    pub fn down(&mut self, text: &str) {
        self.running = None;
        for mut job in self.jobs.drain(..) {
            job.down(&self.tag, text);
        }
    }
}

/// The registers of a response.
fn registers(data: &[u8]) -> Vec<u16> {
    let pair = |pair: &[u8]| match pair {
        [high, low] => u16::from_be_bytes([*high, *low]),
        _ => 0,
    };
    data.chunks_exact(2).map(pair).collect()
}

/// How long until a moment, from another.
#[must_use]
pub fn until(due: Micros, now: Micros) -> Duration {
    Duration::from_micros(due.since(now))
}
