//! What a page asked for on one device: objects, or a log.

use super::super::{ClientId, Outlet};
use shared::dop::handshake::{Handshake, Why};
use shared::dop::log::{LogRun, Stop};
use shared::dop::{ObjectRead, Profile, Request};
use shared::proto::{DopNews, LogFrom, Outcome};
use shared::render::hex;
use std::collections::VecDeque;

/// After so many objects in a row without any answer the others are given up.
const SILENT: u8 = 2;

/// What is to be read.
enum Kind {
    Objects(VecDeque<u16>),
    // Boxed because it is much larger than the other.
    Log(Box<LogRun>, u16),
}

/// One message of a page.
pub(super) struct Job {
    pub client: ClientId,
    pub id: u32,
    pub out: Outlet,
    kind: Kind,
    total: u32,
    ok: u32,
    failed: u32,
    /// Objects in a row for which the device did not answer at all.
    silent: u8,
}

impl Job {
    pub fn read(client: ClientId, id: u32, requests: Vec<u16>, out: Outlet) -> Self {
        Self {
            client,
            id,
            out,
            total: u32::try_from(requests.len()).unwrap_or(u32::MAX),
            kind: Kind::Objects(requests.into()),
            ok: 0,
            failed: 0,
            silent: 0,
        }
    }

    /// A log; gives the outlet back if the object is none.
    #[expect(clippy::too_many_arguments, reason = "they are those of the message")]
    pub fn log(
        client: ClientId,
        id: u32,
        object: u16,
        from: LogFrom,
        after: Option<u64>,
        limit: u32,
        profile: &Profile,
        out: Outlet,
    ) -> Result<Self, Outlet> {
        let Some(run) = LogRun::new(object, from, after, limit, profile) else {
            return Err(out);
        };
        Ok(Self {
            client,
            id,
            out,
            kind: Kind::Log(Box::new(run), object),
            total: 0,
            ok: 0,
            failed: 0,
            silent: 0,
        })
    }

    pub fn is(&self, client: ClientId, id: u32) -> bool {
        self.client == client && self.id == id
    }

    /// Nothing more is begun for it.
    pub fn cancel(&mut self) {
        match &mut self.kind {
            Kind::Objects(requests) => requests.clear(),
            Kind::Log(run, _) => run.cancel(),
        }
    }

    /// The next object to read.
    pub fn next_request(&mut self) -> Option<Request> {
        match &mut self.kind {
            Kind::Objects(requests) => requests.front().map(|word| Request::from_word(*word)),
            Kind::Log(run, _) => run.next(),
        }
    }

    /// False for a page of a log that would be another one if it were asked for again.
    pub fn may_repeat(&self) -> bool {
        match &self.kind {
            Kind::Objects(_) => true,
            Kind::Log(run, _) => run.is_at_start(),
        }
    }

    /// True if the device is not there: the rest is not asked for.
    pub const fn is_hopeless(&self) -> bool {
        self.silent >= SILENT
    }

    pub fn progress(&mut self, device: &str, handshake: &Handshake) {
        let done = match &self.kind {
            Kind::Objects(_) => self.ok.saturating_add(self.failed),
            Kind::Log(run, _) => run.records(),
        };
        self.out.say(DopNews::Progress {
            id: self.id,
            device: device.to_owned(),
            request: handshake.request().word(),
            step: handshake.step(),
            done,
            total: self.total,
            text: handshake.text(),
        });
    }

    /// An object was read.
    pub fn read_done(
        &mut self,
        device: &str,
        handshake: &Handshake,
        words: &[u16],
        profile: &Profile,
    ) {
        let request = handshake.request();
        let mut text = handshake.text();
        let wanted = match &mut self.kind {
            Kind::Objects(requests) => {
                requests.pop_front();
                true
            }
            Kind::Log(run, _) => {
                let page = run.page(&ObjectRead::read(request, words, profile));
                if page.repeated > 0 {
                    text.push_str(&format!("; {} records were known", page.repeated));
                }
                if page.skipped > 0 {
                    text.push_str(&format!("; {} records passed over", page.skipped));
                }
                !page.new.is_empty()
            }
        };
        self.ok = self.ok.saturating_add(1);
        self.silent = 0;
        if !wanted {
            return;
        }
        let course = handshake.course();
        let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_be_bytes()).collect();
        self.out.send(DopNews::Object {
            id: self.id,
            device: device.to_owned(),
            request: request.word(),
            hex: hex(&bytes),
            at_us: course.ended.map_or(0, shared::capture::Micros::get),
            took_us: course.took(),
            busy_us: course.busy(),
            polls: course.polls,
            retries: course.retries,
            foreign: course.foreign,
            text,
        });
    }

    /// An object could not be read.
    pub fn failed(
        &mut self,
        device: &str,
        request: Request,
        outcome: Outcome,
        why: Option<&Why>,
        text: String,
    ) {
        let code = why.and_then(Why::code);
        match why {
            Some(Why::Lost {
                outcome: Outcome::Silence,
                ..
            }) => self.silent = self.silent.saturating_add(1),
            Some(_) => self.silent = 0,
            None => {}
        }
        match &mut self.kind {
            Kind::Objects(requests) => {
                requests.pop_front();
            }
            Kind::Log(run, _) => {
                if why.is_some_and(is_passing) && !run.is_at_start() && run.disturbed() {
                    return;
                }
                run.failed(code, &text);
                // An unknown command behind the first page is an end like another.
                if matches!(run.stop(), Some(Stop::Option)) {
                    return;
                }
            }
        }
        self.failed = self.failed.saturating_add(1);
        self.out.send(DopNews::Failed {
            id: self.id,
            device: device.to_owned(),
            request: request.word(),
            code,
            outcome,
            text,
        });
    }

    /// Says that it is over.
    pub fn finish(&mut self, device: &str) {
        if let Kind::Log(run, object) = &self.kind {
            let mut text = run.stop().map_or_else(String::new, ToString::to_string);
            if run.rewinds() > 0 {
                text.push_str(&format!("; begun anew {} times", run.rewinds()));
            }
            self.out.send(DopNews::LogEnd {
                id: self.id,
                device: device.to_owned(),
                object: *object,
                pages: run.pages(),
                text,
            });
        }
        self.out.send(DopNews::Done {
            id: self.id,
            device: device.to_owned(),
            ok: self.ok,
            failed: self.failed,
        });
    }

    /// The line is down: what was not read will not be.
    pub fn down(&mut self, device: &str, text: &str) {
        let rest = match &mut self.kind {
            Kind::Objects(requests) => requests.len(),
            Kind::Log(..) => 1,
        };
        if let (Some(request), Kind::Objects(_)) = (self.next_request(), &self.kind) {
            // One message says it for all.
            self.out.send(DopNews::Failed {
                id: self.id,
                device: device.to_owned(),
                request: request.word(),
                code: None,
                outcome: Outcome::Down,
                text: text.to_owned(),
            });
        }
        if let Kind::Log(run, _) = &mut self.kind {
            run.failed(None, text);
        }
        let rest = u32::try_from(rest).unwrap_or(u32::MAX);
        self.failed = self.failed.saturating_add(rest);
        self.cancel();
        self.finish(device);
    }
}

/// True if it may be gone the next time.
const fn is_passing(why: &Why) -> bool {
    matches!(
        why,
        Why::Foreign(_)
            | Why::Changed(_)
            | Why::NotTaken(_)
            | Why::Code(4 | 10 | 11)
            | Why::Lost {
                outcome: Outcome::Silence | Outcome::Damaged,
                ..
            }
    )
}
