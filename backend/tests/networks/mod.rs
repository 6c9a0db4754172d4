//! Simulated networks behind pseudo terminals or in memory, and what the backend says of them.
#![allow(dead_code, reason = "each test file uses a part of it")]

use backend::bus::board::Board;
use backend::bus::ddc::{Common, Network as Running, start};
use backend::bus::master::Stream;
use backend::bus::{Handle, Plug, Report};
use backend::clock::Clock;
use backend::config::{BusConfig, DdcConfig, DdcPorts, DeviceConfig, LineConfig, Mode};
use backend::sim::ddc::{Network as Simulated, Pace, serve};
use shared::address::{Address, Table};
use shared::ddc100::HostPort;
use shared::device::Device;
use shared::encode::Read;
use shared::frame::Framing;
use shared::proto::{DdcNews, DdcShape, LineState};
use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::pin::Pin;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::task::{Context, Poll};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::sync::watch;
use tokio::task::JoinHandle;
use tokio::time::{Instant, timeout};
use tokio_serial::{SerialPort, SerialStream};

/// How long a test waits for anything; in simulated time that is nothing.
const WAIT: Duration = Duration::from_secs(600);

/// Units 1, 2, … of these types.
pub fn units(kinds: &[Device]) -> Vec<DeviceConfig> {
    let unit = |(at, device): (usize, &Device)| DeviceConfig {
        tag: format!("MOV-{}", at + 1),
        device: *device,
        bus: 0,
        unit: u8::try_from(at + 1).unwrap(),
        description: String::new(),
        faults: Vec::new(),
        profile: None,
        target: None,
    };
    kinds.iter().enumerate().map(unit).collect()
}

/// A network to be started.
pub struct Setting {
    pub framing: Framing,
    pub baud: u32,
    pub shape: DdcShape,
    pub retries: u8,
    pub turn_ms: u64,
    pub timeout_ms: u64,
    /// First register of a poll, as printed, and how many.
    pub registers: (u16, u16),
    /// Units and line take their time.
    pub thinks: bool,
    pub troubles: &'static [&'static str],
}

impl Default for Setting {
    fn default() -> Self {
        Self {
            framing: Framing::Rtu,
            baud: 9600,
            shape: DdcShape::Loop,
            retries: 1,
            turn_ms: 21,
            timeout_ms: 201,
            registers: (8, 6),
            thinks: false,
            troubles: &[],
        }
    }
}

/// What is at the host ports.
#[derive(Clone, Debug)]
pub enum Ends {
    /// Pseudo terminals.
    Ptys,
    /// Streams in memory.
    Duplex,
    /// These, whatever there is.
    Configured(DdcPorts),
}

/// A request as it came out of a host port.
#[derive(Clone, Debug)]
pub struct Request {
    pub port: u8,
    pub unit: u8,
    pub pdu: Vec<u8>,
    pub at: Instant,
    /// When its answer had left.
    pub answered: Option<Instant>,
}

type Log = Arc<Mutex<Vec<Request>>>;

/// A network that runs.
pub struct Network {
    running: Running,
    pub simulated: Simulated,
    log: Log,
    pace: Pace,
    directory: PathBuf,
    /// For each port the task that serves it and the other end of its pty.
    served: BTreeMap<u8, (JoinHandle<()>, Option<SerialStream>)>,
    changes: watch::Receiver<u64>,
}

static NUMBER: AtomicUsize = AtomicUsize::new(0);

impl Setting {
    /// Starts simulated units and a backend that polls them.
    pub async fn start(&self, devices: &[DeviceConfig], ends: Ends) -> Network {
        let clock = Clock::start();
        let simulated = Simulated::new(self.shape, devices, &[], clock).unwrap();
        for trouble in self.troubles {
            assert!(simulated.set(trouble.parse().unwrap(), true), "{trouble}");
        }
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let directory =
            std::env::temp_dir().join(format!("valvescope-ddc-{}-{number}", std::process::id()));
        let path = |port: u8| {
            let path = directory.join(format!("port-{port}"));
            path.to_str().unwrap().to_owned()
        };
        let count = if self.shape == DdcShape::Loop { 2 } else { 1 };
        let ports = match &ends {
            Ends::Configured(ports) => ports.clone(),
            _ => DdcPorts::Serial(path(1), (count == 2).then(|| path(2))),
        };
        let ddc = DdcConfig {
            ports,
            framing: self.framing,
            baud: self.baud,
            mode: Mode::parse("8N1").unwrap(),
            shape: self.shape,
            start: self.registers.0 - 1,
            count: self.registers.1,
            retry_faulty: false,
            scalings: BTreeMap::new(),
        };
        let pace = Pace::of(&ddc);
        let pace = if self.thinks { pace } else { pace.at_once() };
        let activity = watch::Sender::new(0);
        let changes = activity.subscribe();
        let mut network = Network {
            running: Running {
                lines: Vec::new(),
                news: Board::new(activity.clone()),
            },
            simulated,
            log: Log::default(),
            pace,
            directory,
            served: BTreeMap::new(),
            changes,
        };
        let mut plugs = Vec::new();
        for port in 1..=count {
            plugs.push(match ends {
                Ends::Ptys => {
                    network.plug(port).await;
                    Plug::Configured
                }
                Ends::Duplex => network.duplex(port),
                Ends::Configured(_) => Plug::Configured,
            });
        }
        let bus = BusConfig {
            name: "Loop".into(),
            line: LineConfig::Ddc(Arc::new(ddc.clone())),
            timeout: Duration::from_millis(self.timeout_ms),
            retries: self.retries,
            turnaround: Duration::from_millis(self.turn_ms),
        };
        let common = Common {
            clock,
            board: Board::new(activity.clone()),
            activity,
        };
        network.running = start(&bus, &ddc, devices, plugs, common).unwrap();
        network
    }
}

impl Network {
    fn duplex(&mut self, port: u8) -> Plug {
        let (near, far) = tokio::io::duplex(4096);
        self.serve(port, far, None);
        let mut near = Some(near);
        Plug::Stream(Box::new(move || {
            let stream = near.take().ok_or(io::ErrorKind::NotFound)?;
            Ok(Box::new(stream) as Box<dyn Stream>)
        }))
    }

    /// Connects simulated units to a port by a pseudo terminal.
    pub async fn plug(&mut self, port: u8) {
        let (ours, theirs) = SerialStream::pair().unwrap();
        let path = theirs.name().unwrap();
        std::fs::create_dir_all(&self.directory).unwrap();
        let link = self.directory.join(format!("port-{port}"));
        let _old = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(path, link).unwrap();
        self.serve(port, ours, Some(theirs));
    }

    /// Pulls a port out.
    pub fn unplug(&mut self, port: u8) {
        let (task, theirs) = self.served.remove(&port).unwrap();
        task.abort();
        drop(theirs);
        std::fs::remove_file(self.directory.join(format!("port-{port}"))).unwrap();
    }

    fn serve<S>(&mut self, port: u8, line: S, theirs: Option<SerialStream>)
    where
        S: AsyncRead + AsyncWrite + Send + Unpin + 'static,
    {
        let (simulated, pace) = (self.simulated.clone(), self.pace);
        let line = Watched {
            line,
            port,
            framing: pace.framing,
            log: Arc::clone(&self.log),
        };
        let number = HostPort::from_number(port).unwrap();
        let task = tokio::spawn(async move {
            let _ended = serve(line, number, &simulated, pace).await;
        });
        self.served.insert(port, (task, theirs));
    }

    /// The news that are there.
    fn news(&self) -> Vec<DdcNews> {
        let (texts, _) = self.running.news.news(0);
        let parse = |text: &axum::extract::ws::Utf8Bytes| DdcNews::from_text(text).unwrap();
        texts.iter().map(parse).collect()
    }

    /// How many messages wait for a page that took none so far.
    pub fn waiting(&self) -> usize {
        self.news().len()
    }

    /// The news about units in the order of their addresses.
    pub fn units(&self) -> Vec<DdcNews> {
        let mut units: Vec<_> = self
            .news()
            .into_iter()
            .filter_map(|n| match &n {
                DdcNews::Unit { unit, .. } => Some((*unit, n)),
                _ => None,
            })
            .collect();
        units.sort_by_key(|(unit, _)| *unit);
        units.into_iter().map(|(_, news)| news).collect()
    }

    /// Faults of all units on both ports.
    pub fn faults(&self) -> Vec<(Option<bool>, Option<bool>)> {
        let units = self.units().into_iter();
        units
            .filter_map(|news| match news {
                DdcNews::Unit {
                    fault_a, fault_b, ..
                } => Some((fault_a, fault_b)),
                _ => None,
            })
            .collect()
    }

    /// The last good answer of a unit.
    pub fn answers_of(&self, address: u8) -> Option<String> {
        self.units().into_iter().find_map(|news| match news {
            DdcNews::Unit { unit, response, .. } if unit == address => Some(response),
            _ => None,
        })
    }

    /// State of a port, and what is said of it.
    pub fn port(&self, number: u8) -> Option<(LineState, String)> {
        self.news().into_iter().find_map(|news| match news {
            DdcNews::Port {
                port, state, text, ..
            } if port == number => Some((state, text)),
            _ => None,
        })
    }

    /// The last pass.
    pub fn pass_news(&self) -> Option<DdcNews> {
        let (texts, _) = self.running.news.news(0);
        let pass = texts.iter().find(|t| t.starts_with("{\"ddc\":{\"pass\""));
        pass.and_then(|text| DdcNews::from_text(text))
    }

    /// What is to be looked at, as pages are told of the network.
    pub fn hint(&self) -> Option<String> {
        self.news().into_iter().find_map(|news| match news {
            DdcNews::Network { hint, .. } => hint,
            _ => None,
        })
    }

    /// Number of the last pass.
    pub fn pass(&self) -> u64 {
        match self.pass_news() {
            Some(DdcNews::Pass { number, .. }) => number,
            _ => 0,
        }
    }

    /// Waits until something holds.
    pub async fn until(&mut self, holds: impl Fn(&Self) -> bool) {
        let wait = async {
            loop {
                self.changes.mark_unchanged();
                if holds(self) {
                    return;
                }
                self.changes.changed().await.unwrap();
            }
        };
        timeout(WAIT, wait).await.expect("what is waited for");
    }

    /// Waits for the end of a pass.
    pub async fn until_pass(&mut self, number: u64) {
        self.until(|n| n.pass() >= number).await;
    }

    /// All requests so far.
    pub fn requests(&self) -> Vec<Request> {
        self.log.lock().unwrap().clone()
    }

    /// The way to the actor.
    pub fn handle(&self) -> &Handle {
        &self.running.lines[0].1
    }

    /// Reads once, as a page does.
    pub async fn read(&self, device: usize, start: u16, count: u16) -> Report {
        let read = Read::new(Table::Holding, Address::new(start), count).unwrap();
        self.handle().read(device, read).await
    }
}

impl Drop for Network {
    fn drop(&mut self) {
        for (task, _) in self.served.values() {
            task.abort();
        }
        let _gone = std::fs::remove_dir_all(&self.directory);
    }
}

/// The end of the units of a line, and when which request came out of it.
struct Watched<S> {
    line: S,
    port: u8,
    framing: Framing,
    log: Log,
}

impl<S: AsyncRead + Unpin> AsyncRead for Watched<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let before = into.filled().len();
        let ready = Pin::new(&mut self.line).poll_read(cx, into);
        let bytes = into.filled()[before..].to_vec();
        if ready.is_ready() && !bytes.is_empty() {
            // Requests are short, and written at once.
            let pdu = shared::decode::pdu_of(&bytes, self.framing).unwrap_or_default();
            let unit = match self.framing {
                Framing::Ascii => shared::frame::ascii::hex_pair(&bytes[1..3]).unwrap(),
                _ => bytes[0],
            };
            self.log.lock().unwrap().push(Request {
                port: self.port,
                unit,
                pdu,
                at: Instant::now(),
                answered: None,
            });
        }
        ready
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Watched<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        cx: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        if let Some(request) = self.log.lock().unwrap().last_mut() {
            request.answered = Some(Instant::now());
        }
        Pin::new(&mut self.line).poll_write(cx, bytes)
    }

    fn poll_flush(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.line).poll_flush(cx)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, cx: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.line).poll_shutdown(cx)
    }
}
