//! A device on the line: its profile, what was read of it, and what is being read.

use std::collections::BTreeMap;
use std::sync::Arc;

use shared::dop::profile::LogCommand;
use shared::dop::{OBJECTS, Profile, Request};
use shared::proto::{DopNews, Outcome};

use super::kept::{Course, Kept, words_of};
use super::logs::{EVENTS, Log, MOVEMENTS};

/// A read that did not succeed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// How it ended.
    pub outcome: Outcome,
    /// The error code of the device, if it gave one.
    pub code: Option<u16>,
    /// In words.
    pub text: String,
}

/// What is being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// Its number.
    pub id: u32,
    /// The log, if it is one.
    pub log: Option<u16>,
    /// Objects or records that are done.
    pub done: u32,
    /// Objects that were asked for; 0 for a log.
    pub total: u32,
    /// The request under way.
    pub request: Option<Request>,
    /// What is happening, in words.
    pub text: String,
    /// True once it was asked to end.
    pub cancelled: bool,
}

/// A device.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Site {
    /// Its settings.
    pub profile: Arc<Profile>,
    /// True once the backend told them.
    pub known: bool,
    /// Position of the status bits that was learned.
    pub shift: Option<u8>,
    /// Objects that were read, by request.
    pub kept: BTreeMap<u16, Kept>,
    /// Objects that could not be read.
    pub failed: BTreeMap<u16, Failure>,
    /// What is being read, one after the other.
    pub jobs: Vec<Job>,
    /// What the last job came to.
    pub last: String,
    /// The user indicators and when they were read, in microseconds of the backend.
    pub indicators: Option<(u64, u64)>,
    /// The event log.
    pub events: Log,
    /// The movement log.
    pub movements: Log,
}

impl Site {
    /// The log of this number.
    #[must_use]
    pub const fn log(&self, object: u16) -> &Log {
        if object == MOVEMENTS {
            &self.movements
        } else {
            &self.events
        }
    }

    fn log_mut(&mut self, object: u16) -> &mut Log {
        if object == MOVEMENTS {
            &mut self.movements
        } else {
            &mut self.events
        }
    }

    /// The job that reads a request or a log.
    #[must_use]
    pub fn job_of_log(&self, object: u16) -> Option<&Job> {
        self.jobs.iter().find(|job| job.log == Some(object))
    }

    /// A job that is not a log.
    #[must_use]
    pub fn reading(&self) -> Option<&Job> {
        self.jobs.iter().find(|job| job.log.is_none())
    }

    /// Notes that objects were asked for.
    pub fn asked(&mut self, id: u32, requests: &[Request]) {
        for request in requests {
            self.failed.remove(&request.word());
        }
        self.jobs.push(Job {
            id,
            log: None,
            done: 0,
            total: u32::try_from(requests.len()).unwrap_or(u32::MAX),
            request: None,
            text: "waiting".to_owned(),
            cancelled: false,
        });
    }

    /// Notes that a log was asked for; a fresh one forgets what was read before.
    pub fn asked_log(&mut self, id: u32, object: u16, from_oldest: bool, resume: bool) {
        let log = self.log_mut(object);
        if resume {
            log.end = None;
        } else {
            *log = Log::begin(from_oldest);
        }
        self.jobs.push(Job {
            id,
            log: Some(object),
            done: 0,
            total: 0,
            request: None,
            text: "waiting".to_owned(),
            cancelled: false,
        });
    }

    /// Notes that a job was asked to end.
    pub fn cancelled(&mut self, id: u32) {
        if let Some(job) = self.jobs.iter_mut().find(|job| job.id == id) {
            job.cancelled = true;
        }
    }

    /// The connection is gone, and with it all jobs.
    pub fn lost(&mut self) {
        if !self.jobs.is_empty() {
            self.jobs.clear();
            "The connection was lost while reading.".clone_into(&mut self.last);
        }
    }

    /// Takes a message that is about this device. `start_ms` is the moment 0 of the backend's clock
    /// in milliseconds since 1970.
    pub fn hear(&mut self, news: &DopNews, start_ms: u64) {
        match news {
            DopNews::Profile { profile, shift, .. } => {
                // The backend has checked it.
                self.profile = Arc::new(Profile::from_value(profile));
                self.known = true;
                self.shift = *shift;
            }
            DopNews::Progress {
                id,
                request,
                done,
                total,
                text,
                ..
            } => {
                if let Some(job) = self.jobs.iter_mut().find(|job| job.id == *id) {
                    job.done = *done;
                    job.total = job.total.max(*total);
                    job.request = Some(Request::from_word(*request));
                    job.text.clone_from(text);
                }
            }
            DopNews::Object { id, .. } => self.object(*id, news, start_ms),
            DopNews::Failed {
                request,
                code,
                outcome,
                text,
                ..
            } => {
                let failure = Failure {
                    outcome: *outcome,
                    code: *code,
                    text: text.clone(),
                };
                self.last.clone_from(text);
                self.failed.insert(*request, failure);
            }
            DopNews::LogEnd { object, text, .. } => {
                self.log_mut(*object).end = Some(text.clone());
            }
            DopNews::Done { id, ok, failed, .. } => self.done(*id, *ok, *failed),
            DopNews::Indicators { hex, at_us, .. } => {
                let words = words_of(hex).and_then(|words| <[u16; 4]>::try_from(words).ok());
                if let Some(words) = words {
                    self.indicators = Some((self.profile.indicators(words), *at_us));
                }
            }
        }
    }

    fn object(&mut self, id: u32, news: &DopNews, start_ms: u64) {
        let DopNews::Object {
            request,
            hex,
            at_us,
            took_us,
            busy_us,
            polls,
            retries,
            foreign,
            ..
        } = news
        else {
            return;
        };
        let Some(words) = words_of(hex) else { return };
        let request = Request::from_word(*request);
        let mut kept = Kept::new(request, words, "read from the device");
        kept.wall_ms = Some(start_ms.saturating_add(at_us / 1000));
        kept.course = Some(Course {
            took_us: *took_us,
            busy_us: *busy_us,
            polls: *polls,
            retries: *retries,
            foreign: *foreign,
        });
        let job = self.jobs.iter_mut().find(|job| job.id == id);
        if let Some(log) = job.as_ref().and_then(|job| job.log) {
            let page = kept.read(&self.profile);
            self.log_mut(log).add(&page);
        } else if let Some(job) = job {
            job.done = job.done.saturating_add(1).min(job.total);
        }
        self.failed.remove(&request.word());
        self.kept.insert(request.word(), kept);
    }

    fn done(&mut self, id: u32, ok: u32, failed: u32) {
        let Some(at) = self.jobs.iter().position(|job| job.id == id) else {
            return;
        };
        let job = self.jobs.remove(at);
        if job.log.is_some() {
            return;
        }
        self.last = match (job.cancelled, ok, failed) {
            (true, ..) => format!("Cancelled after {}.", objects(ok)),
            (false, _, 0) => format!("{} read.", objects(ok)),
            (false, 0, 1) => self.last.clone(),
            (false, ok, failed) => format!("{} read, {failed} could not be.", objects(ok)),
        };
    }
}

fn objects(count: u32) -> String {
    crate::format::count(u64::from(count), "object")
}

/// Every request that reads data: all objects with all options, the logs not among them.
#[must_use]
pub fn all_requests(profile: &Profile) -> Vec<Request> {
    let plain = OBJECTS
        .iter()
        .filter(|o| o.id != EVENTS && o.id != MOVEMENTS);
    plain
        .flat_map(|object| object.options.iter().map(|c| object.request(c, profile)))
        .collect()
}

/// The request for the newest records of a log.
#[must_use]
pub fn newest(object: u16, profile: &Profile) -> Option<Request> {
    Request::new(object, profile.log_option(LogCommand::Newest))
}

#[cfg(test)]
mod tests;
