//! The actor of a DDC-100 network: it owns the host ports, polls all units again and again, and
//! between two polls reads what pages ask for.
//!
//! Who is asked next through which port is decided by [`Poller`]; here are only the ports and the
//! time. One port is driven at a time; the other one is listened to, since what is sent at one end
//! of a loop comes out at the other.

mod desk;
mod doubts;
mod exchange;
mod pages;
mod port;
mod tell;
mod unit;

use super::board::Board;
use super::gate::Gate;
use super::open::Plug;
use super::recorder::Recorder;
use super::timing::Timing;
use super::{Command, Handle, INBOX, words};
use crate::clock::Clock;
use crate::config::{BusConfig, DdcConfig, DeviceConfig};
use desk::Desk;
use pages::Job;
use port::Port;
use shared::address::{Address, Table};
use shared::ddc100::poller::{Next, Poll};
use shared::ddc100::setup::{Member, Setup};
use shared::ddc100::timing::Line;
use shared::ddc100::{HostPort, Poller};
use shared::encode::Read;
use shared::proto::{self, DdcNews, Outcome};
use std::collections::VecDeque;
use std::io;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use tokio::sync::{mpsc, watch};
use tokio::time::{Instant, sleep_until};
use unit::{Last, Unit};

/// The state of a unit is posted at least this often.
const STALE: Duration = Duration::from_secs(1);
/// Commands that are taken between two requests, so that none of both waits for ever.
const AT_ONCE: usize = 64;

/// A network that runs.
#[derive(Debug)]
pub struct Network {
    /// What was on it: first the network, then its ports if it has two.
    pub lines: Vec<(proto::Bus, Handle)>,
    /// The newest of each unit, for pages that follow it.
    pub news: Board,
}

/// What is shared by everything that runs.
#[derive(Clone, Debug)]
pub struct Common {
    /// The clock.
    pub clock: Clock,
    /// States of lines and devices.
    pub board: Board,
    /// Told of everything new.
    pub activity: watch::Sender<u64>,
}

/// How the network of a bus is polled.
#[must_use]
pub fn setup(bus: &BusConfig, ddc: &DdcConfig, devices: &[DeviceConfig]) -> Option<Setup> {
    let units = devices.iter().map(|d| Member {
        unit: d.unit,
        kind: d.device,
    });
    let micros = |time: Duration| u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
    let read = Read::new(Table::Holding, Address::new(ddc.start), ddc.count)?;
    Some(Setup {
        line: Line {
            framing: ddc.framing,
            baud: ddc.baud,
            bits: u8::try_from(ddc.mode.bits()).unwrap_or(10),
        },
        retries: bus.retries,
        retry_faulty: ddc.retry_faulty,
        turn_us: micros(bus.turnaround),
        timeout_us: micros(bus.timeout),
        ..Setup::new(ddc.shape, ddc.paths().len() > 1, units.collect(), read)
    })
}

/// Starts the actor of a network. `devices` are its units in the order of the cable; `plugs` say
/// what is at its ports.
#[must_use]
pub fn start(
    bus: &BusConfig,
    ddc: &DdcConfig,
    devices: &[DeviceConfig],
    plugs: Vec<Plug>,
    common: Common,
) -> Option<Network> {
    let setup = setup(bus, ddc, devices)?;
    let Common {
        clock,
        board,
        activity,
    } = common;
    let (commands, inbox) = mpsc::channel(INBOX);
    let whole = Recorder::new(&bus.name, clock, activity.clone());
    let info = |name: &str, line: String| proto::Bus {
        name: name.to_owned(),
        line,
        framing: ddc.framing.key().into(),
        simulated: bus.line.is_simulated(),
    };
    let handle = |recorder: &Recorder| Handle {
        commands: commands.clone(),
        recorder: recorder.clone(),
    };
    let mut lines = vec![(info(&bus.name, bus.line.to_string()), handle(&whole))];
    let longest = devices.iter().map(|d| setup.timeout(d.device)).max();
    let timeout = longest.map_or(bus.timeout, Duration::from_micros);
    let paths = ddc.paths();
    let gate = Gate::of(devices);
    let slot = board.slot();
    let mut ports = Vec::new();
    for ((number, path), plug) in HostPort::BOTH.into_iter().zip(&paths).zip(plugs) {
        let line = ddc.serial(path);
        let driven = Arc::new(AtomicBool::new(false));
        let single = paths.len() == 1;
        let name = match single {
            true => bus.name.clone(),
            false => format!("{}, port {}", bus.name, number.number()),
        };
        let recorder = match single {
            true => whole.clone(),
            false => whole.of_port(&name, Arc::clone(&driven)),
        };
        if !single {
            lines.push((info(&name, line.to_string()), handle(&recorder)));
        }
        let own = BusConfig {
            name,
            line,
            timeout,
            ..bus.clone()
        };
        let mut port = Port::new(number, own, plug, gate.clone(), recorder, driven);
        port.slot = (!single).then(|| board.slot());
        ports.push(port);
    }
    let units: Vec<Unit> = devices
        .iter()
        .map(|d| Unit::new(d.tag.clone(), d.unit, d.device, board.slot()))
        .collect();
    let desk = Desk::new(units.len(), activity);
    let timeout_ms = u32::try_from(timeout.as_millis()).unwrap_or(u32::MAX);
    desk.say(desk::network(bus, ddc, devices, &setup, timeout_ms), 0);
    let news = desk.board();
    let actor = Actor {
        name: bus.name.clone(),
        timing: Timing::of(bus),
        retries: bus.retries,
        usual: setup.read,
        poller: Poller::new(setup),
        ports,
        units,
        jobs: VecDeque::new(),
        fed: None,
        turn: 0,
        quiet_from: Instant::now(),
        clock,
        board,
        slot,
        desk,
        inbox,
    };
    tokio::spawn(actor.run());
    Some(Network { lines, news })
}

/// What ends an idle time.
enum Event {
    Asked(Option<Command>),
    Lost(HostPort, io::Error),
    Due,
}

/// Listens to a port until it is lost.
async fn listen(port: Option<&mut Port>) -> Event {
    match port {
        Some(port) => Event::Lost(port.number, port.listen().await),
        None => std::future::pending().await,
    }
}

struct Actor {
    name: String,
    timing: Timing,
    retries: u8,
    /// What a poll reads.
    usual: Read,
    poller: Poller,
    ports: Vec<Port>,
    units: Vec<Unit>,
    /// What pages wait for.
    jobs: VecDeque<Job>,
    /// The one of it that the poller knows of.
    fed: Option<Job>,
    /// The unit whose watch was served last.
    turn: usize,
    /// From then on the turn time counts.
    quiet_from: Instant,
    clock: Clock,
    board: Board,
    /// Where the state of the whole is posted.
    slot: usize,
    desk: Desk,
    inbox: mpsc::Receiver<Command>,
}

impl Actor {
    async fn run(mut self) {
        for at in 0..self.ports.len() {
            self.tell_port(at);
        }
        loop {
            for _ in 0..AT_ONCE {
                match self.inbox.try_recv() {
                    Ok(command) => self.obey(command),
                    Err(mpsc::error::TryRecvError::Empty) => break,
                    // Nobody can ask it any more: the program ends.
                    Err(mpsc::error::TryRecvError::Disconnected) => return,
                }
            }
            self.open().await;
            self.feed(Instant::now());
            // The rest of the turn time is waited for on the line itself, which is exact.
            let next = match self.poller.next(self.clock.now()) {
                Next::Wait(free) => self.poller.next(free),
                next => next,
            };
            match next {
                Next::Poll(poll) => self.poll(poll).await,
                Next::Other(other, port) => self.serve(other.unit, port).await,
                Next::Wait(_) | Next::Busy | Next::Idle => {
                    if !self.idle().await {
                        return;
                    }
                }
            }
        }
    }

    /// Opens the ports that are due.
    async fn open(&mut self) {
        for at in 0..self.ports.len() {
            let now = Instant::now();
            let Some(port) = self.ports.get_mut(at) else {
                continue;
            };
            if port.due().is_none_or(|due| due > now) || !port.open().await {
                continue;
            }
            let (number, up) = (port.number, port.line.is_some());
            self.poller.set_port(number, up);
            if up {
                // Nothing from before can come.
                self.units.iter_mut().for_each(|u| u.doubts.clear());
            }
            self.tell_port(at);
            self.tell_all();
        }
        // A port that could not be opened at first has told nobody yet.
        for port in &self.ports {
            self.poller.set_port(port.number, port.line.is_some());
        }
    }

    /// A port is lost.
    fn lost(&mut self, number: HostPort, error: &io::Error) {
        self.poller.set_port(number, false);
        let Some(at) = self.ports.iter().position(|p| p.number == number) else {
            return;
        };
        if self.ports.get_mut(at).is_some_and(|port| port.lost(error)) {
            self.tell_port(at);
            self.tell_all();
        }
    }

    /// Waits until there is something to do; false at the end of the program.
    async fn idle(&mut self) -> bool {
        let due = self.ports.iter().filter_map(Port::due).min();
        // Without anything to do, a day is as good as for ever.
        let wake = due.unwrap_or(Instant::now() + Duration::from_secs(86_400));
        let (one, two) = match self.ports.as_mut_slice() {
            [one, two, ..] => (Some(one), Some(two)),
            [one] => (Some(one), None),
            [] => (None, None),
        };
        let event = tokio::select! {
            biased;
            command = self.inbox.recv() => Event::Asked(command),
            lost = listen(one) => lost,
            lost = listen(two) => lost,
            () = sleep_until(wake) => Event::Due,
        };
        match event {
            Event::Asked(Some(command)) => self.obey(command),
            Event::Asked(None) => return false,
            Event::Lost(number, error) => self.lost(number, &error),
            Event::Due => {}
        }
        true
    }

    /// Polls a unit once.
    async fn poll(&mut self, poll: Poll) {
        let address = poll.member.unit;
        let Some(at) = self.units.iter().position(|u| u.address == address) else {
            return;
        };
        self.desk.say(
            DdcNews::Poll {
                bus: self.name.clone(),
                unit: address,
                port: poll.port.number(),
            },
            at,
        );
        let read = self.shape(at).await;
        let result = self.exchange(poll.port, at, &read.into()).await;
        let (outcome, text) = match &result {
            Ok(answer) => match answer.pdu.as_slice() {
                [function, code] if *function >= 0x80 => {
                    (Outcome::Exception, words::exception(*code))
                }
                _ => (Outcome::Ok, String::new()),
            },
            Err(fault) => {
                let bus = self.ports.iter().find(|p| p.number == poll.port);
                let tries = poll.repeat.saturating_add(1);
                let text = bus.map(|port| words::fault(fault, &port.bus, address, tries));
                (words::outcome(fault), text.unwrap_or_default())
            }
        };
        let ended = self.clock.at(self.quiet_from);
        if let (Ok(answer), Some(unit)) = (&result, self.units.get_mut(at)) {
            let took = u64::try_from(answer.latency.as_micros()).unwrap_or(u64::MAX);
            unit.answered(ended, took);
            if outcome == Outcome::Ok {
                unit.polled(read, &answer.pdu, ended, took);
            }
        }
        let done = self.poller.done(outcome, ended);
        if done.decided {
            if let Some(unit) = self.units.get_mut(at) {
                unit.last = Some(Last {
                    port: poll.port,
                    outcome,
                    text: text.clone(),
                    read,
                });
            }
            self.tell_unit(at);
            self.judge(at, outcome, text);
        }
        if let Some(pass) = done.pass {
            self.tell_pass(pass);
        }
    }
}
