//! Everything that runs: the buses, their devices, and what is known of both.

use crate::bus::board::Board;
use crate::bus::recorder::Recorder;
use crate::bus::{self, ClientId, Handle, Plug, ddc};
use crate::clock::Clock;
use crate::config::{Config, DeviceConfig, LineConfig};
use crate::sim::{self, Actuators};
use shared::device::Device as Kind;
use shared::frame::Framing;
use shared::hart::link::Target;
use shared::proto::{self, NO_POLLING, ToPage, VERSION};
use std::sync::atomic::{AtomicU64, Ordering};
use tokio::sync::watch;

/// A running plant.
#[derive(Debug)]
pub struct Plant {
    clock: Clock,
    buses: Vec<(proto::Bus, Handle)>,
    devices: Vec<Device>,
    /// DDC-100 networks by the name of their bus: the newest of each unit.
    networks: Vec<(String, Board)>,
    board: Board,
    activity: watch::Sender<u64>,
    clients: AtomicU64,
}

/// A device and the way to it.
#[derive(Debug)]
struct Device {
    info: proto::DeviceInfo,
    bus: usize,
    /// Its index on its bus.
    at: usize,
}

impl Plant {
    /// Starts an actor for each bus.
    #[must_use]
    pub fn start(config: &Config) -> Self {
        let clock = Clock::start();
        let activity = watch::Sender::new(0);
        let board = Board::new(activity.clone());
        let mut devices = Vec::new();
        let mut buses: Vec<(proto::Bus, Handle)> = Vec::new();
        let mut networks = Vec::new();
        for (index, bus) in config.buses.iter().enumerate() {
            let own: Vec<DeviceConfig> = config
                .devices
                .iter()
                .filter(|d| d.bus == index)
                .cloned()
                .collect();
            let simulated = bus.line == LineConfig::Simulator;
            // A network with two ports is more than one line.
            let first = buses.len();
            devices.extend(own.iter().enumerate().map(|(at, device)| Device {
                info: proto::DeviceInfo {
                    tag: device.tag.clone(),
                    kind: device.device.key().into(),
                    bus: bus.name.clone(),
                    unit: match &device.target {
                        None | Some(Target::Polling(_)) => device.unit,
                        Some(_) => NO_POLLING,
                    },
                    description: device.description.clone(),
                },
                bus: first,
                at,
            }));
            if let LineConfig::Ddc(ddc) = &bus.line {
                let common = ddc::Common {
                    clock,
                    board: board.clone(),
                    activity: activity.clone(),
                };
                let plugs = sim::ddc::plugs(ddc, &own, clock);
                if let Some(network) = ddc::start(bus, ddc, &own, plugs, common) {
                    buses.extend(network.lines);
                    networks.push((bus.name.clone(), network.news));
                }
                continue;
            }
            let info = proto::Bus {
                name: bus.name.clone(),
                line: bus.line.to_string(),
                framing: bus.line.framing().key().into(),
                simulated,
            };
            if let Some(hart) = bus.line.hart() {
                let plug = if bus.line.is_simulated() {
                    let made = sim::hart::Loop::of(&own, clock);
                    if hart.faulty {
                        made.spoil();
                    }
                    Plug::Loop(made)
                } else {
                    Plug::Configured
                };
                let info = proto::Bus {
                    simulated: bus.line.is_simulated(),
                    ..info
                };
                let recorder = Recorder::new(&bus.name, clock, activity.clone());
                let handle =
                    bus::hart::start(bus.clone(), &own, plug, clock, board.clone(), recorder);
                buses.push((info, handle));
                continue;
            }
            let plug = if simulated {
                Plug::Simulated(Actuators::new(&own, clock))
            } else {
                Plug::Configured
            };
            let recorder = Recorder::new(&bus.name, clock, activity.clone());
            let handle = bus::start(bus.clone(), &own, plug, clock, board.clone(), recorder);
            buses.push((info, handle));
        }
        Self {
            clock,
            buses,
            devices,
            networks,
            board,
            activity,
            clients: AtomicU64::new(0),
        }
    }

    /// The first message to a page.
    #[must_use]
    pub fn hello(&self) -> ToPage {
        ToPage::Hello {
            version: VERSION,
            app: concat!("Valvescope ", env!("CARGO_PKG_VERSION")).into(),
            run: self.clock.run(),
            now_us: self.clock.now().get(),
            wall_ms: self.clock.wall_ms(),
            read_only: true,
            buses: self.buses.iter().map(|(info, _)| info.clone()).collect(),
            devices: self.devices.iter().map(|d| d.info.clone()).collect(),
        }
    }

    /// A number for a new client.
    pub fn client(&self) -> ClientId {
        ClientId(self.clients.fetch_add(1, Ordering::Relaxed))
    }

    /// The clock of this run.
    #[must_use]
    pub const fn clock(&self) -> Clock {
        self.clock
    }

    /// States of lines and devices.
    #[must_use]
    pub const fn board(&self) -> &Board {
        &self.board
    }

    /// Told whenever there is a new capture or state.
    #[must_use]
    pub fn activity(&self) -> watch::Receiver<u64> {
        self.activity.subscribe()
    }

    /// All buses.
    pub fn buses(&self) -> impl Iterator<Item = &Handle> {
        self.buses.iter().map(|(_, handle)| handle)
    }

    /// The bus with this name.
    #[must_use]
    pub fn bus(&self, name: &str) -> Option<&Handle> {
        let found = self.buses.iter().find(|(info, _)| info.name == name);
        found.map(|(_, handle)| handle)
    }

    /// The bus of a device, and the index of the device on it.
    #[must_use]
    pub fn device(&self, tag: &str) -> Option<(&Handle, usize)> {
        let device = self.devices.iter().find(|d| d.info.tag == tag)?;
        let (_, handle) = self.buses.get(device.bus)?;
        Some((handle, device.at))
    }

    /// The newest of each unit of the DDC-100 network with this name.
    #[must_use]
    pub fn network(&self, name: &str) -> Option<&Board> {
        let found = self.networks.iter().find(|(bus, _)| bus == name);
        found.map(|(_, news)| news)
    }

    /// The tag of the device with this address on a bus.
    #[must_use]
    pub fn tag(&self, bus: &str, unit: u8) -> Option<&str> {
        let found = self
            .devices
            .iter()
            .find(|d| d.info.bus == bus && d.info.unit == unit);
        found.map(|d| d.info.tag.as_str())
    }

    /// The HART bus with this name.
    #[must_use]
    pub fn hart_bus(&self, name: &str) -> Option<&Handle> {
        let found = self.buses.iter().find(|(info, _)| info.name == name);
        found.filter(|(info, _)| is_hart(info)).map(|(_, h)| h)
    }

    /// All HART buses.
    pub fn hart_buses(&self) -> impl Iterator<Item = &Handle> {
        let hart = self.buses.iter().filter(|(info, _)| is_hart(info));
        hart.map(|(_, handle)| handle)
    }

    /// The line of the HART device with this tag, and its index on it.
    ///
    /// # Errors
    /// If there is no such device, or if it is no HART device; in words.
    pub fn hart_device(&self, tag: &str) -> Result<(&Handle, usize), String> {
        let Some(device) = self.devices.iter().find(|d| d.info.tag == tag) else {
            return Err(format!("There is no device \"{tag}\"; reload the page."));
        };
        match self.buses.get(device.bus) {
            Some((info, handle)) if is_hart(info) => Ok((handle, device.at)),
            _ => Err(format!("{tag} is no HART device.")),
        }
    }

    /// True if the device with this tag is declared as DOP.
    #[must_use]
    pub fn has_objects(&self, tag: &str) -> bool {
        let found = self.devices.iter().find(|d| d.info.tag == tag);
        found.is_some_and(|d| d.info.kind == Kind::Dop.key())
    }

    /// The devices with diagnostic objects: bus, and index on it.
    pub fn dop_devices(&self) -> impl Iterator<Item = (&Handle, usize)> {
        let found = self
            .devices
            .iter()
            .filter(|d| d.info.kind == Kind::Dop.key());
        found.filter_map(|d| Some((&self.buses.get(d.bus)?.1, d.at)))
    }

    /// True if the device with this tag is an ICON3000.
    #[must_use]
    pub fn is_icon(&self, tag: &str) -> bool {
        let found = self.devices.iter().find(|d| d.info.tag == tag);
        found.is_some_and(Device::is_icon)
    }

    /// The ICON3000 devices: bus, and index on it.
    pub fn icon_devices(&self) -> impl Iterator<Item = (&Handle, usize)> {
        let found = self.devices.iter().filter(|d| d.is_icon());
        found.filter_map(|d| Some((&self.buses.get(d.bus)?.1, d.at)))
    }
}

impl Device {
    fn is_icon(&self) -> bool {
        Kind::from_key(&self.info.kind).is_some_and(Kind::is_icon)
    }
}

fn is_hart(bus: &proto::Bus) -> bool {
    [Framing::Hart.key(), Framing::HartIp.key()].contains(&bus.framing.as_str())
}
