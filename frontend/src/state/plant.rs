//! What the backend has sent, decoded: buses with their frames, devices with their values.

mod parts;
#[cfg(test)]
mod tests;

use shared::capture::{Capture, Direction, Micros};
use shared::proto::{Block, Bus, DeviceInfo, Outcome, ToBackend, ToPage, VERSION, Way};

pub use parts::{BusState, DeviceState};

use super::absorb::{absorb, bytes_of};
use super::job::Job;
use super::overview::Figure;
use super::wire;
use crate::format::encode;

/// Frames kept for each bus.
pub const KEPT: u32 = 5000;

/// Frames forgotten at once.
const BATCH: u32 = 500;

/// Everything that the backend has told.
#[derive(Clone, Debug, Default)]
pub struct Plant {
    run: Option<u64>,
    /// Name and version of the backend.
    pub app: String,
    /// True: no write leaves the backend.
    pub read_only: bool,
    /// Why this page and the backend do not understand each other.
    pub mismatch: Option<String>,
    /// What the backend refused last.
    pub refused: Option<String>,
    /// All buses.
    pub buses: Vec<BusState>,
    /// All devices.
    pub devices: Vec<DeviceState>,
    /// Milliseconds since 1970 when the backend started.
    pub start_wall_ms: u64,
    /// Microseconds of the backend and the page's milliseconds at the same moment.
    clock: Option<(u64, f64)>,
    next_id: u32,
    watching: Vec<(String, Vec<Block>, u32)>,
}

impl Plant {
    /// The address of the first DDC-100 network, as the route has it; `None` without one.
    #[must_use]
    pub fn network(&self) -> Option<String> {
        let device = self.devices.iter().find(|d| d.is_ddc())?;
        Some(encode(&device.info.bus))
    }

    /// The page's first message.
    #[must_use]
    pub const fn hello() -> ToBackend {
        ToBackend::Hello { version: VERSION }
    }

    /// Takes a message in at the page's time `local_ms`; returns what to answer.
    pub fn take(&mut self, message: ToPage, local_ms: f64) -> Vec<ToBackend> {
        match message {
            ToPage::Hello {
                version,
                app,
                run,
                now_us,
                wall_ms,
                read_only,
                buses,
                devices,
            } => {
                self.app = app;
                self.read_only = read_only;
                self.clock = Some((now_us, local_ms));
                self.start_wall_ms = wall_ms.saturating_sub(now_us / 1000);
                self.watching.clear();
                if version != VERSION {
                    self.mismatch = Some(format!(
                        "The backend speaks version {version} of the protocol, this page version {VERSION}. Reload the page; if that does not help, use the page that came with the backend."
                    ));
                    return Vec::new();
                }
                self.mismatch = None;
                if self.run.replace(run) != Some(run) {
                    self.buses.clear();
                    self.devices.clear();
                }
                self.configure(buses, devices);
                return self.subscriptions();
            }
            ToPage::Capture {
                bus,
                seq,
                at_us,
                way,
                ends,
                hex,
            } => self.capture(&bus, seq, at_us, way, ends, &hex),
            ToPage::Lagged { bus, missed } => {
                if let Some(bus) = self.bus_mut(&bus) {
                    bus.missed = bus.missed.saturating_add(missed);
                    bus.session.silence();
                    // The next capture follows the hole, however wide it is.
                    bus.last_seq = None;
                }
            }
            ToPage::Line {
                bus, state, text, ..
            } => {
                if let Some(bus) = self.bus_mut(&bus) {
                    bus.line = state;
                    bus.line_text = text;
                }
            }
            ToPage::Device {
                tag,
                outcome,
                text,
                last_ok_us,
                latency_us,
            } => {
                if let Some(device) = self.device_mut(&tag) {
                    device.outcome = Some(outcome);
                    device.text = text;
                    device.last_ok = last_ok_us;
                    device.latency = latency_us;
                }
            }
            ToPage::Done { id, outcome, text } => return self.settle(id, outcome, &text),
            ToPage::Refused { text } => self.refused = Some(text),
            ToPage::Tick { now_us } => self.clock = Some((now_us, local_ms)),
        }
        Vec::new()
    }

    fn configure(&mut self, buses: Vec<Bus>, devices: Vec<DeviceInfo>) {
        let mut old = core::mem::take(&mut self.buses);
        for info in buses {
            let kept = old.iter().position(|b| b.info == info);
            self.buses.push(match kept {
                Some(at) => old.swap_remove(at),
                None => BusState::new(info),
            });
        }
        let mut old = core::mem::take(&mut self.devices);
        for info in devices {
            let kept = old.iter().position(|d| d.info == info);
            self.devices.push(match kept {
                Some(at) => old.swap_remove(at),
                None => DeviceState::new(info),
            });
        }
    }

    fn subscriptions(&self) -> Vec<ToBackend> {
        let known = self.buses.iter().filter(|bus| bus.is_known());
        known
            .map(|bus| ToBackend::Subscribe {
                bus: bus.info.name.clone(),
                after: bus.last_seq,
            })
            .collect()
    }

    fn capture(&mut self, name: &str, seq: u64, at_us: u64, way: Way, ends: bool, hex: &str) {
        let Some(at) = self.buses.iter().position(|b| b.info.name == name) else {
            return;
        };
        let Some(bus) = self.buses.get_mut(at) else {
            return;
        };
        if let Some(last) = bus.last_seq {
            if seq <= last {
                return;
            }
            if seq > last.saturating_add(1) {
                bus.missed = bus.missed.saturating_add(seq - last - 1);
                bus.session.silence();
            }
        }
        bus.last_seq = Some(seq);
        let before = bus.session.len();
        bus.session.push(&Capture {
            bytes: &bytes_of(hex),
            at: Some(Micros::new(at_us)),
            direction: match way {
                Way::Tx => Direction::ToDevice,
                Way::Rx => Direction::FromDevice,
            },
            ends,
        });
        for index in before..bus.session.len() {
            absorb(bus, index, &mut self.devices);
        }
        // In batches, so that places in a list of frames stay what they are for a while.
        let kept = bus.session.len().saturating_sub(bus.session.first());
        if kept > KEPT.saturating_add(BATCH) {
            bus.session
                .forget_before(bus.session.len().saturating_sub(KEPT));
        }
    }

    /// Takes news about a HART device in, as far as the list of all devices shows it; true if that
    /// changed something.
    pub fn hart(&mut self, text: &str) -> bool {
        let polled = wire::hart::polled(text);
        let Some((tag, answer, at)) = polled.filter(|(_, answer, _)| !answer.is_empty()) else {
            return false;
        };
        let device = self.device_mut(&tag);
        device.is_some_and(|device| {
            device.position = Figure::of_hart(&answer, at);
            true
        })
    }

    fn settle(&mut self, id: u32, outcome: Outcome, text: &str) -> Vec<ToBackend> {
        let mut next = self.next_id;
        let mut sent = Vec::new();
        for device in &mut self.devices {
            let Some(job) = &mut device.job else { continue };
            if job.settle(id, outcome, text) {
                sent = reads(&device.info.tag, job, &mut next);
                break;
            }
        }
        self.next_id = next;
        sent
    }

    /// Reads blocks of a device once; returns what to send.
    pub fn read(&mut self, tag: &str, blocks: Vec<Block>) -> Vec<ToBackend> {
        let mut next = self.next_id;
        let mut sent = Vec::new();
        if let Some(device) = self.device_mut(tag) {
            let mut job = Job::new(blocks);
            sent = reads(tag, &mut job, &mut next);
            device.job = Some(job);
        }
        self.next_id = next;
        sent
    }

    /// What must be sent so that exactly these blocks are watched.
    pub fn watch(&mut self, wanted: Vec<(String, Vec<Block>, u32)>) -> Vec<ToBackend> {
        let mut sent = Vec::new();
        let mut say = |device: &str, blocks: &[Block], period_ms: u32| {
            sent.push(ToBackend::Watch {
                device: device.to_owned(),
                blocks: blocks.to_vec(),
                period_ms,
            });
        };
        for (tag, ..) in &self.watching {
            if wanted.iter().all(|(t, ..)| t != tag) {
                say(tag, &[], 1000);
            }
        }
        for new in &wanted {
            if !self.watching.contains(new) {
                say(&new.0, &new.1, new.2);
            }
        }
        self.watching = wanted;
        sent
    }

    /// The connection is gone: reads under way do not come back.
    pub fn lost(&mut self) {
        self.watching.clear();
        for device in &mut self.devices {
            if let Some(job) = &mut device.job {
                job.lose();
            }
        }
    }

    /// Microseconds since the start of the backend at the page's time `local_ms`.
    #[must_use]
    pub fn now(&self, local_ms: f64) -> u64 {
        let Some((us, at)) = self.clock else { return 0 };
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a positive number of microseconds, far below 2^52"
        )]
        let passed = ((local_ms - at).max(0.0) * 1000.0) as u64;
        us.saturating_add(passed)
    }

    /// Milliseconds since 1970 at a time of the backend.
    #[must_use]
    pub const fn wall_ms(&self, us: u64) -> u64 {
        self.start_wall_ms.saturating_add(us / 1000)
    }

    /// A device by its tag.
    #[must_use]
    pub fn device(&self, tag: &str) -> Option<&DeviceState> {
        self.devices.iter().find(|d| d.info.tag == tag)
    }

    /// A device by its tag, to change.
    pub fn device_mut(&mut self, tag: &str) -> Option<&mut DeviceState> {
        self.devices.iter_mut().find(|d| d.info.tag == tag)
    }

    /// A bus by its name.
    #[must_use]
    pub fn bus(&self, name: &str) -> Option<&BusState> {
        self.buses.iter().find(|b| b.info.name == name)
    }

    fn bus_mut(&mut self, name: &str) -> Option<&mut BusState> {
        self.buses.iter_mut().find(|b| b.info.name == name)
    }

    /// The device at a unit address of a bus.
    #[must_use]
    pub fn at(&self, bus: &str, unit: u8) -> Option<&DeviceState> {
        self.devices
            .iter()
            .find(|d| d.info.bus == bus && d.info.unit == unit)
    }
}

fn reads(tag: &str, job: &mut Job, next_id: &mut u32) -> Vec<ToBackend> {
    job.send(next_id)
        .into_iter()
        .map(|(id, block)| ToBackend::Read {
            id,
            device: tag.to_owned(),
            block,
        })
        .collect()
}
