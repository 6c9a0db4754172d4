//! A line with an end outside, such as a serial port: bytes go in and come out at the pace of the
//! line.

use super::burst::HartBurst;
use super::device::HartDevice;
use super::master::HartMaster;
use super::medium::{Character, Collision, Medium, Party};
use crate::capture::Micros;
use std::collections::VecDeque;

/// The end outside: it sends what it gets and keeps what it hears.
#[derive(Clone, Debug, Default)]
struct Port {
    queue: VecDeque<u8>,
    due: Option<Micros>,
    heard: Vec<u8>,
    echo: bool,
}

impl Port {
    fn take(&mut self) -> Vec<u8> {
        self.due = None;
        let bytes: Vec<u8> = self.queue.drain(..).collect();
        if self.echo {
            self.heard.extend_from_slice(&bytes);
        }
        bytes
    }
}

impl Party for Port {
    fn hear(&mut self, character: Character, _: Micros) {
        // A damaged character comes out of a modem as some other one.
        let damage = if character.sound { 0 } else { 0x5A };
        self.heard.push(character.byte ^ damage);
    }

    fn due(&self) -> Option<Micros> {
        self.due
    }

    fn act(&mut self, _: Micros) -> Option<Vec<u8>> {
        Some(self.take())
    }

    fn more(&mut self, _: Micros) -> Option<Vec<u8>> {
        Some(self.take())
    }
}

/// Devices, neighbours and perhaps a second master on one line, with an end for us.
///
/// Whoever serves it keeps to this: [`push`](Self::push) what was written to the port,
/// [`advance`](Self::advance) and pass on what comes out, and come again at
/// [`next_event`](Self::next_event) at the latest.
#[derive(Clone, Debug)]
pub struct HartLine {
    medium: Medium,
    port: Port,
    devices: Vec<HartDevice>,
    bursts: Vec<HartBurst>,
    master: Option<HartMaster>,
}

impl HartLine {
    /// A line with these devices; `baud` is 1200, or more for fast motion.
    #[must_use]
    pub fn new(baud: u32, devices: Vec<HartDevice>) -> Self {
        Self {
            medium: Medium::new(baud, 0),
            port: Port::default(),
            devices,
            bursts: Vec::new(),
            master: None,
        }
    }

    /// Adds a bursting neighbour.
    pub fn add_burst(&mut self, burst: HartBurst) {
        self.bursts.push(burst);
    }

    /// Adds a second master.
    pub fn set_master(&mut self, master: Option<HartMaster>) {
        self.master = master;
    }

    /// Lets what we send come back, as a half-duplex modem may do.
    pub const fn set_echo(&mut self, echo: bool) {
        self.port.echo = echo;
    }

    /// The devices.
    #[must_use]
    pub fn devices(&self) -> &[HartDevice] {
        &self.devices
    }

    /// The devices, to change what stands around them.
    pub fn devices_mut(&mut self) -> &mut [HartDevice] {
        &mut self.devices
    }

    /// Whoever sent at the same time. Party 0 is the end outside, then come the devices, the
    /// neighbours and the second master.
    #[must_use]
    pub fn collisions(&self) -> &[Collision] {
        self.medium.collisions()
    }

    /// Bytes were written to our end. They go out one after the other at the pace of the line.
    pub fn push(&mut self, bytes: &[u8], at: Micros) {
        self.run(at);
        if bytes.is_empty() {
            return;
        }
        self.port.queue.extend(bytes);
        self.port.due.get_or_insert(at);
    }

    /// Lets time go on; what came out at our end meanwhile.
    #[must_use]
    pub fn advance(&mut self, now: Micros) -> Vec<u8> {
        self.run(now);
        for device in &mut self.devices {
            device.advance(now);
        }
        core::mem::take(&mut self.port.heard)
    }

    /// When something happens by itself.
    #[must_use]
    pub fn next_event(&mut self) -> Option<Micros> {
        let (medium, parties) = self.parts();
        medium.next(&parties)
    }

    fn run(&mut self, until: Micros) {
        let (medium, mut parties) = self.parts();
        medium.run(&mut parties, until);
    }

    fn parts(&mut self) -> (&mut Medium, Vec<&mut dyn Party>) {
        let mut parties: Vec<&mut dyn Party> = vec![&mut self.port];
        for party in &mut self.devices {
            parties.push(party);
        }
        for party in &mut self.bursts {
            parties.push(party);
        }
        if let Some(party) = &mut self.master {
            parties.push(party);
        }
        (&mut self.medium, parties)
    }
}
