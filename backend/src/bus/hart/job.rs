//! What pages asked for on a HART line: commands of a device, a scan, a search.

use super::super::{ClientId, Outlet};
use super::Exchange;
use shared::hart::link::{Identity, Scan, Sighting, Target};
use shared::proto::{HartNews, Outcome};
use shared::render::hex;
use std::collections::VecDeque;

/// A command with its data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ask {
    /// Its number.
    pub number: u16,
    /// Its data.
    pub data: Vec<u8>,
}

/// What is to be done.
#[derive(Debug)]
pub enum Kind {
    /// Commands of the device with this index.
    Read(usize, VecDeque<Ask>),
    /// Polling addresses.
    Scan(Box<Scan>),
    /// A search by tag; `None` once it was made.
    Find(Option<Target>),
}

/// One message of a page.
#[derive(Debug)]
pub struct Job {
    pub client: ClientId,
    pub id: u32,
    pub out: Outlet,
    pub kind: Kind,
    total: u32,
    ok: u32,
    failed: u32,
    cancelled: bool,
    given_up: bool,
}

impl Job {
    pub fn new(client: ClientId, id: u32, out: Outlet, kind: Kind) -> Self {
        let total = match &kind {
            Kind::Read(_, asks) => asks.len().try_into().unwrap_or(u32::MAX),
            Kind::Scan(scan) => scan.progress().1,
            Kind::Find(_) => 1,
        };
        Self {
            client,
            id,
            out,
            kind,
            total,
            ok: 0,
            failed: 0,
            cancelled: false,
            given_up: false,
        }
    }

    pub fn is(&self, client: ClientId, id: u32) -> bool {
        self.client == client && self.id == id
    }

    /// Nothing more is begun for it.
    pub fn cancel(&mut self) {
        self.cancelled = true;
        match &mut self.kind {
            Kind::Read(_, asks) => asks.clear(),
            Kind::Scan(scan) => scan.stop(),
            Kind::Find(target) => *target = None,
        }
    }

    /// True if nothing is left to do.
    pub fn is_over(&self) -> bool {
        match &self.kind {
            Kind::Read(_, asks) => asks.is_empty(),
            Kind::Scan(scan) => scan.next().is_none(),
            Kind::Find(target) => target.is_none(),
        }
    }

    fn progress(&self, text: String) {
        self.out.say(HartNews::Progress {
            id: self.id,
            done: self.ok.saturating_add(self.failed),
            total: self.total,
            text,
        });
    }

    /// A command of a read was done, or can't be.
    pub fn done(&mut self, news: HartNews) {
        if let Kind::Read(_, asks) = &mut self.kind {
            asks.pop_front();
        }
        if let HartNews::Exchange { outcome, .. } = &news {
            self.count(*outcome == Outcome::Ok);
        }
        self.out.send(news);
        if let Kind::Read(_, asks) = &self.kind
            && !asks.is_empty()
        {
            self.progress(String::new());
        }
    }

    fn count(&mut self, ok: bool) {
        let counter = if ok { &mut self.ok } else { &mut self.failed };
        *counter = counter.saturating_add(1);
    }

    /// What a polling address of a scan brought.
    pub fn scanned(&mut self, exchange: &Exchange, bus: &str) {
        let Kind::Scan(scan) = &mut self.kind else {
            return;
        };
        let Some((polling, _)) = scan.next() else {
            return;
        };
        let sighting = scan.take(exchange.outcome.as_ref().ok());
        let text = match &sighting {
            Sighting::Nobody => format!("nobody at {polling}"),
            Sighting::Device(identity) => format!("a device at {polling}: {}", identity.address),
            Sighting::Again(before) => {
                format!("at {polling} the device of {before} again; it looks at four bits only")
            }
            Sighting::Unknown => format!("something at {polling} does not say who it is"),
        };
        let found = matches!(sighting, Sighting::Device(_) | Sighting::Unknown);
        self.count(found);
        if found && let Ok(answer) = &exchange.outcome {
            self.found(Some(polling), &answer.frame, exchange, bus);
        }
        self.progress(text);
    }

    /// What a search brought.
    pub fn searched(&mut self, exchange: &Exchange, bus: &str) {
        self.kind = Kind::Find(None);
        let answer = exchange.outcome.as_ref().ok();
        let known = answer.filter(|a| Identity::of(a).is_some());
        self.count(known.is_some());
        if let Some(answer) = known {
            self.found(None, &answer.frame, exchange, bus);
        }
    }

    fn found(&self, polling: Option<u8>, frame: &[u8], exchange: &Exchange, bus: &str) {
        self.out.send(HartNews::Found {
            id: self.id,
            bus: bus.to_owned(),
            polling,
            response: hex(frame),
            at_us: exchange.ended.get(),
        });
    }

    /// The device does not answer: the rest is not asked for.
    pub fn give_up(&mut self) {
        if let Kind::Read(_, asks) = &mut self.kind
            && !asks.is_empty()
        {
            let rest = u32::try_from(asks.len()).unwrap_or(u32::MAX);
            self.failed = self.failed.saturating_add(rest);
            asks.clear();
            self.given_up = true;
        }
    }

    /// Says that it is over.
    pub fn finish(&self, why: &str) {
        let (ok, failed) = (self.ok, self.failed);
        let mut text = match &self.kind {
            Kind::Read(..) => format!("{ok} of {} commands answered", self.total),
            Kind::Scan(_) if ok == 1 => "1 device found".to_owned(),
            Kind::Scan(_) => format!("{ok} devices found"),
            Kind::Find(_) if ok == 0 => "no device has this tag".to_owned(),
            Kind::Find(_) => "found".to_owned(),
        };
        if self.given_up {
            text.push_str("; the rest was not asked for, since the device does not answer");
        }
        if self.cancelled && why.is_empty() {
            text.push_str("; ended before all was done");
        }
        if !why.is_empty() {
            text.push_str("; ");
            text.push_str(why);
        }
        self.out.send(HartNews::Done {
            id: self.id,
            ok,
            failed,
            text,
        });
    }

    /// The line is down: what was not done will not be.
    pub fn down(&mut self, text: &str) {
        let done = self.ok.saturating_add(self.failed);
        self.failed = self.failed.saturating_add(self.total.saturating_sub(done));
        self.cancel();
        self.finish(text);
    }
}
