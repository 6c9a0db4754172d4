//! What is read of one ICON3000 beyond its registers: files, identity, counters.
//!
//! Reads of all pages stand in one queue. Steps that read files and follow each other share
//! requests, as many groups in each as fit; if the device refuses such a request, its groups are
//! asked for one by one, for it may be one of them only. So are the parts of a block of registers
//! that it refuses. A busy device is asked again.

mod parts;
mod pieces;
#[cfg(test)]
mod tests;

use super::query::Query;
use super::{ClientId, Outlet, Report};
use crate::config::DeviceConfig;
use parts::{Part, parts};
use pieces::Pieces;
use shared::capture::Micros;
use shared::icon3000::collect::BUSY_WAIT_MS;
use shared::map::row::DeviceMap;
use shared::proto::{IconAsk, IconNews, Outcome};
use shared::render::hex;
use std::collections::VecDeque;
use std::time::Duration;
use tokio::time::Instant;

/// Exception "illegal data address".
const ILLEGAL_ADDRESS: u8 = 2;
/// Reads that may wait for one device.
const MAX_JOBS: usize = 64;
/// After so many requests in a row without any answer the others are given up.
const SILENT: u8 = 2;
/// How long a page that takes nothing is waited for before it is looked at again.
const PAUSE: Duration = Duration::from_millis(5);

/// One message of a page.
#[derive(Debug)]
struct Job {
    client: ClientId,
    id: u32,
    out: Outlet,
    /// The first is under way if [`IconUnit::under_way`] says so.
    parts: VecDeque<Part>,
    /// The block that was refused and is asked for in pieces; the first part is one of them.
    pieces: Option<Pieces>,
    ok: u32,
    failed: u32,
    /// Requests in a row for which the device did not answer at all.
    silent: u8,
    /// What is under way is not sent again.
    cancelled: bool,
}

/// The reads of one ICON3000.
#[derive(Debug)]
pub struct IconUnit {
    tag: String,
    map: Option<&'static DeviceMap>,
    jobs: VecDeque<Job>,
    /// The first part of the first job was sent and is not answered yet.
    under_way: bool,
}

impl IconUnit {
    /// The unit of a device; `None` if it is no ICON3000.
    #[must_use]
    pub fn of(device: &DeviceConfig) -> Option<Self> {
        device.device.is_icon().then(|| Self {
            tag: device.tag.clone(),
            map: device.device.map(),
            jobs: VecDeque::new(),
            under_way: false,
        })
    }

    /// Does what a page asks.
    pub fn ask(&mut self, client: ClientId, ask: IconAsk, out: Outlet) {
        match ask {
            IconAsk::Cancel { id } => self.cancel(|job| job.client == client && job.id == id),
            IconAsk::Read { id, steps, .. } => {
                let full = self.jobs.len() >= MAX_JOBS;
                let mut job = Job {
                    client,
                    id,
                    out,
                    parts: VecDeque::new(),
                    pieces: None,
                    ok: 0,
                    failed: 0,
                    silent: 0,
                    cancelled: false,
                };
                match parts(&steps) {
                    Ok(parts) if !full => job.parts = parts,
                    Ok(_) => {
                        let text = "too much is waiting for this device; try again later";
                        job.refuse(&self.tag, 0, text);
                    }
                    Err(step) => {
                        let text = "this can't be read: a count is 0 or too large, or the \
                                    function is none that reads";
                        job.refuse(&self.tag, step, text);
                    }
                }
                if full {
                    job.finish(&self.tag);
                } else {
                    self.jobs.push_back(job);
                }
            }
        }
        self.settle();
    }

    /// A page is gone. What is under way on the line comes to its end.
    pub fn leave(&mut self, client: ClientId) {
        self.cancel(|job| job.client == client);
        self.settle();
    }

    fn cancel(&mut self, mut which: impl FnMut(&Job) -> bool) {
        for (at, job) in self.jobs.iter_mut().enumerate() {
            if which(job) {
                let kept = usize::from(self.under_way && at == 0);
                job.parts.truncate(kept);
                job.pieces = None;
                job.cancelled = true;
            }
        }
    }

    /// When there will be something to do; `None` if nothing is asked for.
    #[must_use]
    pub fn due(&self, now: Instant) -> Option<Instant> {
        let job = self.jobs.front()?;
        let ready = job.out.has_room();
        let rest = job.parts.front().and_then(|part| part.not_before);
        let soon = if ready { now } else { now + PAUSE };
        Some(rest.map_or(soon, |rest| rest.max(soon)))
    }

    /// Takes the next thing to send.
    pub fn take(&mut self) -> Option<Query> {
        let job = self.jobs.front().filter(|job| job.out.has_room())?;
        let part = job.parts.front()?;
        if part.not_before.is_some_and(|rest| rest > Instant::now()) {
            return None;
        }
        self.under_way = true;
        Some(part.query.clone())
    }

    /// What came of it.
    pub fn reply(&mut self, query: &Query, report: &Report, at: Micros) {
        self.under_way = false;
        let Some(job) = self.jobs.front_mut() else {
            return;
        };
        match job.parts.pop_front() {
            // "The master should retransmit the request later" (VCIOM-16345-EN, table 50).
            Some(mut part) if part.is_again(report) && !job.cancelled => {
                part.busy += 1;
                let wait = Duration::from_millis(BUSY_WAIT_MS.into());
                part.not_before = Some(Instant::now() + wait);
                job.silent = 0;
                job.parts.push_front(part);
            }
            Some(part) => job.answered(&self.tag, self.map, &part, query, report, at),
            None => {}
        }
        self.settle();
    }

    /// The line is down: nothing that was asked for can be had.
    pub fn down(&mut self, text: &str, at: Micros) {
        self.under_way = false;
        for mut job in self.jobs.drain(..) {
            job.give_up(&self.tag, Outcome::Down, text, at);
            job.finish(&self.tag);
        }
    }

    /// Ends the jobs that have nothing left to do.
    fn settle(&mut self) {
        let tag = &self.tag;
        self.jobs.retain(|job| {
            if job.parts.is_empty() {
                job.finish(tag);
            }
            !job.parts.is_empty()
        });
    }
}

impl Job {
    fn answered(
        &mut self,
        tag: &str,
        map: Option<&DeviceMap>,
        part: &Part,
        query: &Query,
        report: &Report,
        at: Micros,
    ) {
        self.silent = match report.outcome {
            Outcome::Silence => self.silent.saturating_add(1),
            _ => 0,
        };
        if !self.is_taken_apart(map, part, query, report) {
            self.tell(tag, part.step, query, report, at);
        }
        self.next_piece(tag, at);
        if self.silent >= SILENT && !self.parts.is_empty() {
            let text = "not asked for, since the device does not answer";
            self.give_up(tag, Outcome::Silence, text, at);
        }
        let done = self.ok.saturating_add(self.failed);
        let left = u32::try_from(self.parts.len()).unwrap_or(u32::MAX);
        self.out.say(IconNews::Progress {
            id: self.id,
            device: tag.to_owned(),
            done,
            total: done.saturating_add(left),
            text: self.parts.front().map_or_else(String::new, Part::words),
        });
    }

    /// True if what was refused is asked for in parts, or was such a part of a block.
    fn is_taken_apart(
        &mut self,
        map: Option<&DeviceMap>,
        part: &Part,
        query: &Query,
        report: &Report,
    ) -> bool {
        match (query, report.code, &mut self.pieces) {
            // Illegal address or value.
            (Query::File(file), Some(ILLEGAL_ADDRESS | 3), _) if file.spans().len() > 1 => {
                for file in file.split().into_iter().rev() {
                    let part = Part::new(part.step, Query::File(file));
                    self.parts.push_front(part);
                }
                true
            }
            (Query::Read(read), Some(ILLEGAL_ADDRESS), Some(pieces)) => {
                pieces.refused(map, *read, &report.text);
                true
            }
            (Query::Read(read), Some(ILLEGAL_ADDRESS), None) if !self.cancelled => {
                self.pieces = Pieces::new(map, part.step, *read, &report.text);
                self.pieces.is_some()
            }
            (_, None, Some(pieces)) if report.outcome == Outcome::Ok => {
                pieces.answered();
                false
            }
            _ => false,
        }
    }

    /// Goes on with the block that is asked for in pieces; after the last of them it tells what the
    /// device has not.
    fn next_piece(&mut self, tag: &str, at: Micros) {
        let Some(pieces) = &mut self.pieces else {
            return;
        };
        let step = pieces.step;
        if let Some(read) = pieces.next() {
            self.parts.push_front(Part::new(step, Query::Read(read)));
        } else if let Some(pieces) = self.pieces.take() {
            let (lost, text) = pieces.lost();
            let refusal = Report {
                outcome: Outcome::Exception,
                text,
                pdu: None,
                code: Some(ILLEGAL_ADDRESS),
            };
            for read in lost {
                self.tell(tag, step, &Query::Read(read), &refusal, at);
            }
        }
    }

    /// Tells what came of a request.
    fn tell(&mut self, tag: &str, step: u32, query: &Query, report: &Report, at: Micros) {
        let request = query.pdu();
        let response = match (&report.pdu, report.code) {
            (Some(pdu), _) => hex(pdu),
            (None, Some(code)) => hex(&[request.first().copied().unwrap_or(0) | 0x80, code]),
            (None, None) => String::new(),
        };
        match report.outcome {
            Outcome::Ok => self.ok = self.ok.saturating_add(1),
            _ => self.failed = self.failed.saturating_add(1),
        }
        self.out.send(IconNews::Exchange {
            id: self.id,
            device: tag.to_owned(),
            step,
            request: hex(&request),
            response,
            outcome: report.outcome,
            text: report.text.clone(),
            at_us: at.get(),
        });
    }

    /// What is left will not be asked for; one message says it for all.
    fn give_up(&mut self, tag: &str, outcome: Outcome, text: &str, at: Micros) {
        let left = u32::try_from(self.parts.len()).unwrap_or(u32::MAX);
        self.failed = self.failed.saturating_add(left);
        if let Some(part) = self.parts.front() {
            self.out.send(IconNews::Exchange {
                id: self.id,
                device: tag.to_owned(),
                step: part.step,
                request: hex(&part.query.pdu()),
                response: String::new(),
                outcome,
                text: text.to_owned(),
                at_us: at.get(),
            });
        }
        self.parts.clear();
        self.pieces = None;
    }

    fn refuse(&mut self, tag: &str, step: u32, text: &str) {
        self.failed = 1;
        self.out.send(IconNews::Exchange {
            id: self.id,
            device: tag.to_owned(),
            step,
            request: String::new(),
            response: String::new(),
            outcome: Outcome::Refused,
            text: text.to_owned(),
            at_us: 0,
        });
    }

    fn finish(&self, tag: &str) {
        self.out.send(IconNews::Done {
            id: self.id,
            device: tag.to_owned(),
            ok: self.ok,
            failed: self.failed,
        });
    }
}
