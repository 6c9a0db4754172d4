//! A simulated line: one byte at a time, with masters, devices that answer and devices that burst.

use super::super::*;
use crate::hart::frame::{FILL, Head, check, preamble, seal};

/// Who sends a run of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    Master(usize),
    Device(usize),
}

/// A run of bytes on the line.
#[derive(Clone, Debug)]
pub struct Run {
    pub by: By,
    pub start: u64,
    pub bytes: Vec<u8>,
    /// Somebody else sent at the same time.
    pub hit: bool,
}

impl Run {
    pub fn end(&self, character: u64) -> u64 {
        self.start + character * self.bytes.len() as u64
    }
}

/// What a device does with a request: after which time it answers what.
pub type Behave = Box<dyn FnMut(&[u8]) -> Option<(u64, Vec<u8>)>>;

/// A device on the line.
pub struct Device {
    pub behave: Behave,
    heard: Vec<u8>,
    last: u64,
    /// What it will send, and when.
    pub due: Option<(u64, Vec<u8>)>,
    /// It sends this whenever the line was quiet for so long, in characters; the master bit
    /// alternates.
    pub burst: Option<(u64, Vec<u8>)>,
    primary: bool,
}

impl Device {
    pub fn new(behave: Behave) -> Self {
        Self {
            behave,
            heard: Vec::new(),
            last: 0,
            due: None,
            burst: None,
            primary: true,
        }
    }

    fn hear(&mut self, byte: u8, now: u64, character: u64) {
        if now - self.last > character * 2 {
            self.heard.clear();
        }
        self.last = now;
        self.heard.push(byte);
        let fill = preamble(&self.heard);
        if fill < 2 && self.heard.len() > fill {
            self.heard.clear();
            return;
        }
        let frame = &self.heard[fill..];
        if let Some(head) = Head::of(frame)
            && frame.len() == head.total()
        {
            let frame = frame.to_vec();
            self.heard.clear();
            if frame[0] & 7 == 2
                && check(&frame) == 0
                && let Some((delay, reply)) = (self.behave)(&frame)
            {
                self.due = Some((now + delay, reply));
            }
        }
    }

    fn wants(&self, quiet: u64, character: u64) -> Option<u64> {
        let burst = self
            .burst
            .as_ref()
            .map(|(after, _)| quiet + after * character);
        match (&self.due, burst) {
            (Some((at, _)), _) => Some(*at),
            (None, burst) => burst,
        }
    }

    fn take(&mut self) -> Vec<u8> {
        if let Some((_, bytes)) = self.due.take() {
            return bytes;
        }
        let mut frame = self.burst.as_ref().map(|b| b.1.clone()).unwrap_or_default();
        // The master bit of the address, and with it the check byte.
        self.primary = !self.primary;
        if self.primary {
            frame[1] ^= 0x80;
            *frame.last_mut().unwrap() ^= 0x80;
        }
        [vec![FILL; 5], frame].concat()
    }
}

/// The line.
pub struct World {
    pub now: u64,
    pub character: u64,
    pub links: Vec<Link>,
    pub devices: Vec<Device>,
    /// Masters hear themselves.
    pub echo: bool,
    /// Everything that was sent.
    pub runs: Vec<Run>,
    /// Index into `runs`, and how many bytes of it are out.
    active: Vec<(usize, usize)>,
    quiet: u64,
}

impl World {
    pub fn new(setups: &[Setup]) -> Self {
        Self {
            now: 0,
            character: setups[0].timing.character,
            links: setups
                .iter()
                .map(|s| Link::new(*s, Micros::new(0)))
                .collect(),
            devices: Vec::new(),
            echo: false,
            runs: Vec::new(),
            active: Vec::new(),
            quiet: 0,
        }
    }

    pub fn at(&self) -> Micros {
        Micros::new(self.now)
    }

    fn start(&mut self, by: By, bytes: Vec<u8>) {
        let hit = !self.active.is_empty();
        for (run, _) in &self.active {
            self.runs[*run].hit = true;
        }
        self.active.push((self.runs.len(), 0));
        self.runs.push(Run {
            by,
            start: self.now,
            bytes,
            hit,
        });
    }

    fn is_sending(&self, who: By) -> bool {
        self.active.iter().any(|(run, _)| self.runs[*run].by == who)
    }

    /// Goes on to the next moment at which something happens, `until` at the latest.
    pub fn step(&mut self, until: u64) {
        let mut wake = until;
        for at in 0..self.links.len() {
            if self.is_sending(By::Master(at)) {
                continue;
            }
            loop {
                let now = self.at();
                match self.links[at].next(now) {
                    Next::Transmit(bytes) => {
                        self.start(By::Master(at), bytes);
                        break;
                    }
                    Next::Wait(when) if when <= now => {}
                    Next::Wait(when) => {
                        wake = wake.min(when.get());
                        break;
                    }
                    Next::Idle => {
                        // An outcome waits to be taken.
                        if self.links[at].is_busy() {
                            wake = self.now;
                        }
                        break;
                    }
                }
            }
        }
        for at in 0..self.devices.len() {
            if self.is_sending(By::Device(at)) {
                continue;
            }
            let silent = self.active.is_empty();
            let device = &mut self.devices[at];
            // Answers come when they come; bursts only into a silence.
            let ready = device.due.is_some() || silent;
            match device.wants(self.quiet, self.character) {
                Some(when) if when <= self.now && ready => {
                    let bytes = device.take();
                    self.start(By::Device(at), bytes);
                }
                Some(when) if when > self.now => wake = wake.min(when),
                _ => {}
            }
        }
        let byte_end = |(run, out): &(usize, usize)| {
            self.runs[*run].start + self.character * (*out as u64 + 1)
        };
        wake = self.active.iter().map(byte_end).fold(wake, u64::min);
        self.now = wake.max(self.now);
        self.deliver();
    }

    fn deliver(&mut self) {
        let two = self.active.len() > 1;
        let mut out = Vec::new();
        for at in 0..self.active.len() {
            let (run, sent) = self.active[at];
            let end = self.runs[run].start + self.character * (sent as u64 + 1);
            if end != self.now {
                continue;
            }
            let byte = self.runs[run].bytes[sent] ^ if two { 0x5A } else { 0 };
            out.push((self.runs[run].by, byte));
            self.active[at].1 += 1;
            self.quiet = self.now;
        }
        let (now, character) = (self.at(), self.character);
        for (by, byte) in out {
            for at in 0..self.links.len() {
                let own = by == By::Master(at);
                if (own && self.echo) || (!own && !self.is_sending(By::Master(at))) {
                    self.links[at].heard(&[byte], now);
                }
            }
            // Half duplex: whoever sends hears nothing.
            let sends: Vec<bool> = (0..self.devices.len())
                .map(|at| self.is_sending(By::Device(at)))
                .collect();
            for (device, sends) in self.devices.iter_mut().zip(sends) {
                if !sends {
                    device.hear(byte, now.get(), character);
                }
            }
        }
        let runs = &self.runs;
        let over: Vec<By> = self
            .active
            .iter()
            .filter(|(run, sent)| *sent == runs[*run].bytes.len())
            .map(|(run, _)| runs[*run].by)
            .collect();
        self.active
            .retain(|(run, sent)| *sent < runs[*run].bytes.len());
        for by in over {
            if let By::Master(at) = by {
                self.links[at].sent(now);
            }
        }
    }

    /// Runs until a master has an outcome, or until a moment.
    pub fn outcome(&mut self, master: usize, until: u64) -> Option<Done> {
        while self.now < until {
            if let Some(done) = self.links[master].done() {
                return Some(done);
            }
            self.step(until);
        }
        self.links[master].done()
    }

    /// Forgets what was sent, unless something is being sent.
    pub fn forget(&mut self) {
        if self.active.is_empty() {
            self.runs.clear();
        }
    }

    /// Runs until a moment; outcomes are dropped.
    pub fn run(&mut self, until: u64) {
        while self.now < until {
            self.links.iter_mut().for_each(|l| drop(l.done()));
            self.step(until);
        }
    }

    /// The runs of one sender.
    pub fn of(&self, by: By) -> Vec<&Run> {
        self.runs.iter().filter(|r| r.by == by).collect()
    }
}

/// The reply to a request: same address, these two status bytes and data.
pub fn reply(request: &[u8], status: [u8; 2], data: &[u8]) -> Vec<u8> {
    let long = request[0] & 0x80 != 0;
    let address = &request[1..if long { 6 } else { 2 }];
    let command = request[1 + address.len()];
    let data = [&status[..], data].concat();
    let delimiter = if long { 0x86 } else { 0x06 };
    [vec![FILL; 5], seal(delimiter, address, command, &data)].concat()
}
