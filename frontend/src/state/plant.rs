//! What the backend has sent, decoded: buses with their frames, devices with their values.

use shared::capture::{Capture, Direction, Micros};
use shared::device::Device;
use shared::frame::Framing;
use shared::image::Image;
use shared::proto::{Block, Bus, DeviceInfo, LineState, Outcome, ToBackend, ToPage, VERSION, Way};
use shared::session::Session;

use super::absorb::{absorb, bytes_of};
use super::job::Job;

/// Frames kept for each bus.
pub const KEPT: u32 = 5000;

/// Frames forgotten at once.
const BATCH: u32 = 500;

/// A bus as the page knows it.
#[derive(Clone, Debug)]
pub struct BusState {
    /// Its configuration.
    pub info: Bus,
    /// State of its line.
    pub line: LineState,
    /// What happened to the line, in words.
    pub line_text: String,
    /// Its frames.
    pub session: Session,
    /// Sequence number of the last capture.
    pub last_seq: Option<u64>,
    /// Captures that were lost on the way to the page.
    pub missed: u64,
}

impl BusState {
    fn new(info: Bus) -> Self {
        let framing = Framing::from_key(&info.framing).unwrap_or_default();
        Self {
            info,
            line: LineState::Starting,
            line_text: String::new(),
            session: Session::new(framing),
            last_seq: None,
            missed: 0,
        }
    }
}

/// A device as the page knows it.
#[derive(Clone, Debug)]
pub struct DeviceState {
    /// Its configuration.
    pub info: DeviceInfo,
    /// Its kind.
    pub device: Device,
    /// Its values.
    pub image: Image,
    /// How its last read ended.
    pub outcome: Option<Outcome>,
    /// The same in words.
    pub text: String,
    /// When it last answered well, in microseconds since the start of the backend.
    pub last_ok: Option<u64>,
    /// How long its last answer took.
    pub latency: Option<u64>,
    /// Reading under way or just over.
    pub job: Option<Job>,
}

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
                None => DeviceState {
                    device: Device::from_key(&info.kind).unwrap_or_default(),
                    info,
                    image: Image::new(),
                    outcome: None,
                    text: String::new(),
                    last_ok: None,
                    latency: None,
                    job: None,
                },
            });
        }
    }

    fn subscriptions(&self) -> Vec<ToBackend> {
        self.buses
            .iter()
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

#[cfg(test)]
mod tests {
    use super::*;
    use shared::address::{Address, Table};
    use shared::encode::frame;
    use shared::proto::TableName;
    use shared::render::hex;

    fn hello(run: u64) -> ToPage {
        ToPage::Hello {
            version: VERSION,
            app: "test".into(),
            run,
            now_us: 5_000_000,
            wall_ms: 1_000_000,
            read_only: true,
            buses: vec![Bus {
                name: "a".into(),
                line: "simulated".into(),
                framing: "modbus-rtu".into(),
                simulated: true,
            }],
            devices: vec![DeviceInfo {
                tag: "XV-1".into(),
                kind: "icon3000v2".into(),
                bus: "a".into(),
                unit: 9,
                description: String::new(),
            }],
        }
    }

    fn capture(seq: u64, way: Way, pdu: &[u8]) -> ToPage {
        ToPage::Capture {
            bus: "a".into(),
            seq,
            at_us: seq * 1000,
            way,
            ends: true,
            hex: hex(&frame(Framing::Rtu, 0, 9, pdu)),
        }
    }

    fn plant() -> Plant {
        let mut plant = Plant::default();
        let sent = plant.take(hello(1), 0.0);
        assert_eq!(
            sent,
            [ToBackend::Subscribe {
                bus: "a".into(),
                after: None
            }]
        );
        plant
    }

    fn position(plant: &Plant) -> Option<u16> {
        let image = &plant.device("XV-1").unwrap().image;
        image
            .cell(Table::Holding, Address::new(3004))
            .map(|c| c.word)
    }

    #[test]
    fn values_come_from_captures() {
        let mut plant = plant();
        plant.take(capture(1, Way::Tx, &[3, 0x0B, 0xBC, 0, 1]), 0.0);
        assert_eq!(position(&plant), None);
        plant.take(capture(2, Way::Rx, &[3, 2, 1, 0xC4]), 0.0);
        assert_eq!(position(&plant), Some(452));
        assert_eq!(plant.buses[0].session.len(), 2);
    }

    #[test]
    fn a_reconnection_goes_on_and_a_restart_begins_anew() {
        let mut plant = plant();
        plant.take(capture(1, Way::Tx, &[3, 0x0B, 0xBC, 0, 1]), 0.0);
        plant.take(capture(2, Way::Rx, &[3, 2, 1, 0xC4]), 0.0);
        plant.lost();
        let again = plant.take(hello(1), 0.0);
        assert_eq!(
            again,
            [ToBackend::Subscribe {
                bus: "a".into(),
                after: Some(2)
            }]
        );
        assert_eq!(position(&plant), Some(452));
        let anew = plant.take(hello(2), 0.0);
        assert_eq!(
            anew,
            [ToBackend::Subscribe {
                bus: "a".into(),
                after: None
            }]
        );
        assert_eq!(position(&plant), None);
    }

    #[test]
    fn holes_are_counted_and_repeats_ignored() {
        let mut plant = plant();
        plant.take(capture(1, Way::Tx, &[17]), 0.0);
        plant.take(capture(1, Way::Tx, &[17]), 0.0);
        assert_eq!(plant.buses[0].session.len(), 1);
        plant.take(capture(5, Way::Tx, &[17]), 0.0);
        assert_eq!(plant.buses[0].missed, 3);
        plant.take(
            ToPage::Lagged {
                bus: "a".into(),
                missed: 10,
            },
            0.0,
        );
        plant.take(capture(16, Way::Tx, &[17]), 0.0);
        assert_eq!(plant.buses[0].missed, 13);
    }

    #[test]
    fn frames_are_bounded() {
        let mut plant = plant();
        for seq in 1..=u64::from(KEPT) + 5000 {
            plant.take(capture(seq, Way::Tx, &[17]), 0.0);
        }
        let session = &plant.buses[0].session;
        let kept = session.len() - session.first();
        assert!((KEPT..=KEPT + BATCH).contains(&kept), "{kept}");
    }

    #[test]
    fn watches_are_sent_when_they_change() {
        let mut plant = plant();
        let block = Block {
            table: TableName::Holding,
            start: 3000,
            count: 31,
        };
        let wanted = || vec![("XV-1".to_owned(), vec![block], 1000)];
        assert_eq!(plant.watch(wanted()).len(), 1);
        assert_eq!(plant.watch(wanted()).len(), 0);
        let end = plant.watch(Vec::new());
        assert!(matches!(&end[..], [ToBackend::Watch { blocks, .. }] if blocks.is_empty()));
    }

    #[test]
    fn a_job_asks_on_until_it_is_done() {
        let mut plant = plant();
        let block = Block {
            table: TableName::Coil,
            start: 0,
            count: 11,
        };
        let sent = plant.read("XV-1", vec![block; 3]);
        assert_eq!(sent.len(), 2);
        let ToBackend::Read { id, .. } = sent[0] else {
            panic!("{sent:?}");
        };
        let done = ToPage::Done {
            id,
            outcome: Outcome::Ok,
            text: String::new(),
        };
        assert_eq!(plant.take(done, 0.0).len(), 1);
        assert_eq!(plant.device("XV-1").unwrap().job.as_ref().unwrap().done, 1);
    }

    #[test]
    fn another_version_is_said() {
        let mut plant = Plant::default();
        let ToPage::Hello {
            app,
            run,
            now_us,
            wall_ms,
            read_only,
            buses,
            devices,
            ..
        } = hello(1)
        else {
            panic!("hello");
        };
        let other = ToPage::Hello {
            version: VERSION + 1,
            app,
            run,
            now_us,
            wall_ms,
            read_only,
            buses,
            devices,
        };
        assert!(plant.take(other, 0.0).is_empty());
        assert!(plant.mismatch.is_some());
    }

    #[test]
    fn the_clock_goes_on_between_ticks() {
        let plant = plant();
        assert_eq!(plant.now(1500.0), 6_500_000);
        assert_eq!(plant.wall_ms(5_000_000), 1_000_000);
    }
}
