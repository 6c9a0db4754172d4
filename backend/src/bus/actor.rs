//! The actor of a line: keeps it open, decides what is asked next, and asks.

use super::board::Board;
use super::dop::DopUnit;
use super::gate::Gate;
use super::icon::IconUnit;
use super::open::{Line, Plug};
use super::query::Query;
use super::recorder::Recorder;
use super::timing::Timing;
use super::unit::{Ask, Job, Origin, Unit};
use super::{Command, Fault, Handle, INBOX, Report, words};
use crate::clock::Clock;
use crate::config::{BusConfig, DeviceConfig};
use shared::proto::{LineState, Outcome, ToPage};
use std::io;
use std::time::Duration;
use tokio::sync::mpsc;
use tokio::time::{Instant, sleep_until};

/// A line that can't be opened is tried again after this time, then twice that, and so on.
const FIRST_RETRY: Duration = Duration::from_millis(200);
/// But at least this often.
const LAST_RETRY: Duration = Duration::from_secs(5);
/// The state of a device that is read is posted at least this often.
const STALE: Duration = Duration::from_secs(1);
/// Commands that are taken between two requests, so that none of both waits for ever.
const AT_ONCE: usize = 64;

/// Starts the actor of a bus. `devices` are those of this bus, in the order of their indices.
#[must_use]
pub fn start(
    bus: BusConfig,
    devices: &[DeviceConfig],
    plug: Plug,
    clock: Clock,
    board: Board,
    recorder: Recorder,
) -> Handle {
    let (commands, inbox) = mpsc::channel(INBOX);
    let gate = Gate::of(devices);
    let unit = |d: &DeviceConfig| {
        let dop = DopUnit::of(d, &gate);
        let icon = IconUnit::of(d);
        Unit::new(d.tag.clone(), d.unit, board.slot(), dop, icon)
    };
    let units = devices.iter().map(unit).collect();
    let actor = Actor {
        gate,
        timing: Timing::of(&bus),
        slot: board.slot(),
        bus,
        units,
        plug,
        clock,
        board,
        recorder: recorder.clone(),
        inbox,
        turn: 0,
        nonce: 0,
    };
    tokio::spawn(actor.run());
    Handle { commands, recorder }
}

struct Actor {
    bus: BusConfig,
    /// What may be written on this line.
    gate: Gate,
    timing: Timing,
    units: Vec<Unit>,
    plug: Plug,
    clock: Clock,
    board: Board,
    slot: usize,
    recorder: Recorder,
    inbox: mpsc::Receiver<Command>,
    /// The device that was asked last.
    turn: usize,
    nonce: u16,
}

/// Why the actor stopped asking.
enum Stop {
    /// Nobody can ask it any more: the program ends.
    Ended,
    /// The line is lost.
    Lost(io::Error),
}

impl Actor {
    async fn run(mut self) {
        self.post(LineState::Starting, "being opened".into());
        let mut wait = FIRST_RETRY;
        let mut said = String::new();
        loop {
            let (gate, recorder) = (self.gate.clone(), self.recorder.clone());
            let opened = Line::open(&self.bus, gate, recorder, &mut self.plug).await;
            let error = match opened {
                Ok(mut line) => {
                    wait = FIRST_RETRY;
                    said.clear();
                    self.up();
                    match self.work(&mut line).await {
                        Stop::Ended => return,
                        Stop::Lost(error) => error,
                    }
                }
                Err(error) => error,
            };
            let text = words::down(&self.bus.line, &error);
            if said != text {
                tracing::warn!("{}: {text}", self.bus.name);
                self.down(&text);
                said = text;
            }
            if !self.idle(wait, &said).await {
                return;
            }
            wait = (wait * 2).min(LAST_RETRY);
        }
    }

    fn up(&mut self) {
        tracing::info!("{}: {} is open", self.bus.name, self.bus.line);
        self.units.iter_mut().for_each(Unit::reset);
        self.post(LineState::Up, "open".into());
    }

    /// Tells everybody that the line is down.
    fn down(&mut self, text: &str) {
        self.recorder.silence();
        self.post(LineState::Down, text.to_owned());
        for at in 0..self.units.len() {
            let Some(unit) = self.units.get_mut(at) else {
                continue;
            };
            let waiting: Vec<_> = unit.once.drain(..).map(|(_, reply)| reply).collect();
            let again = unit.again.take();
            let watched = !unit.plan.is_empty();
            let replies = waiting
                .into_iter()
                .chain(again.and_then(|job| match job.origin {
                    Origin::Once(reply) => Some(reply),
                    Origin::Watch | Origin::Dop | Origin::Indicators | Origin::Icon => None,
                }));
            unit.programs_down(text, self.clock.now());
            replies.for_each(|reply| reply(Report::down(text)));
            if watched {
                self.state(at, Outcome::Down, text.to_owned());
            }
        }
    }

    /// Waits before the line is tried again; answers commands meanwhile. False at the end.
    async fn idle(&mut self, wait: Duration, text: &str) -> bool {
        let until = Instant::now() + wait;
        loop {
            tokio::select! {
                () = sleep_until(until) => return true,
                command = self.inbox.recv() => match command {
                    None => return false,
                    Some(Command::Read { reply, .. }) => reply(Report::down(text)),
                    Some(command) => {
                        let watched = match &command {
                            Command::Watch { device, reads, .. } if !reads.is_empty() => Some(*device),
                            _ => None,
                        };
                        self.obey(command);
                        let now = self.clock.now();
                        self.units.iter_mut().for_each(|u| u.programs_down(text, now));
                        if let Some(device) = watched {
                            self.state(device, Outcome::Down, text.to_owned());
                        }
                    }
                },
            }
        }
    }

    /// Asks until the line is lost or the program ends.
    async fn work(&mut self, line: &mut Line) -> Stop {
        loop {
            for _ in 0..AT_ONCE {
                match self.inbox.try_recv() {
                    Ok(command) => self.obey(command),
                    Err(mpsc::error::TryRecvError::Empty) => break,
                    Err(mpsc::error::TryRecvError::Disconnected) => return Stop::Ended,
                }
            }
            let now = Instant::now();
            match self.choose(line.stray(), now) {
                Ok(at) => {
                    let job = self.units.get_mut(at).and_then(|u| {
                        u.open = None;
                        u.take(self.bus.retries, now, self.clock)
                    });
                    if let Some(job) = job
                        && let Err(error) = self.attempt(line, at, job).await
                    {
                        return Stop::Lost(error);
                    }
                }
                Err(wake) => {
                    // Without anything to do, a day is as good as for ever.
                    let wake = wake.unwrap_or(now + Duration::from_secs(86_400));
                    tokio::select! {
                        biased;
                        command = self.inbox.recv() => match command {
                            Some(command) => self.obey(command),
                            None => return Stop::Ended,
                        },
                        error = line.listen() => return Stop::Lost(error),
                        () = sleep_until(wake) => {}
                    }
                }
            }
        }
    }

    fn obey(&mut self, command: Command) {
        match command {
            Command::Read {
                device,
                query,
                reply,
            } => match self.units.get_mut(device) {
                Some(unit) => unit.once.push_back((query, reply)),
                None => {
                    let text = "there is no such device".to_owned();
                    reply(Report::failed(Outcome::Refused, text));
                }
            },
            Command::Watch {
                client,
                device,
                reads,
                period,
            } => {
                if let Some(unit) = self.units.get_mut(device) {
                    unit.plan.set(client, &reads, period, Instant::now());
                }
            }
            Command::Dop {
                client,
                device,
                ask,
                out,
            } => {
                if let Some(dop) = self.units.get_mut(device).and_then(|u| u.dop.as_mut()) {
                    dop.ask(client, ask, out);
                }
            }
            // No device of this line speaks HART.
            Command::Hart(_) => {}
            Command::Icon {
                client,
                device,
                ask,
                out,
            } => {
                if let Some(icon) = self.units.get_mut(device).and_then(|u| u.icon.as_mut()) {
                    icon.ask(client, ask, out);
                }
            }
            Command::Leave { client } => self.units.iter_mut().for_each(|u| u.leave(client)),
        }
    }

    /// The device whose turn it is, else when there will be something to do.
    fn choose(&mut self, stray: Option<Instant>, now: Instant) -> Result<usize, Option<Instant>> {
        let (count, turn, clock) = (self.units.len(), self.turn, self.clock);
        let mut wake = None;
        for only_once in [true, false] {
            for at in (1..=count).map(|step| (turn + step) % count) {
                let unit = self.units.get_mut(at);
                let Some(due) = unit.and_then(|u| u.next(stray, only_once, now, clock)) else {
                    continue;
                };
                if due <= now {
                    return Ok(at);
                }
                wake = Some(wake.map_or(due, |earlier: Instant| earlier.min(due)));
            }
        }
        Err(wake)
    }

    /// Asks a device once and deals with what comes of it. An error means that the line is lost.
    async fn attempt(&mut self, line: &mut Line, at: usize, mut job: Job) -> io::Result<()> {
        self.turn = at;
        let Some(unit) = self.units.get_mut(at) else {
            return Ok(());
        };
        let address = unit.address;
        let answer = match resync(line, unit, &mut self.nonce).await {
            Ok(()) => match &job.ask {
                Ask::Query(query) => line.read(address, query).await,
                Ask::Dop(permit) => {
                    tracing::debug!("{}: asks for {}", unit.tag, permit.request());
                    line.write(permit).await
                }
            },
            Err(fault) => Err(fault),
        };
        job.tried = job.tried.saturating_add(1);
        let now = Instant::now();
        let report = match answer {
            Ok(answer) => {
                unit.latency = Some(answer.latency);
                unit.last_ok = Some(self.clock.at(now));
                Report::of(answer)
            }
            Err(Fault::Line(error)) if error.kind() != io::ErrorKind::PermissionDenied => {
                // Those who wait are told with the others.
                unit.again = Some(job);
                return Err(error);
            }
            Err(fault) => {
                let quarantine = self.timing.quarantine(job.ask.response_len(), unit.echo);
                unit.failed(&fault, quarantine, now);
                if job.left > 0 {
                    job.left -= 1;
                    unit.again = Some(job);
                    return Ok(());
                }
                let text = words::fault(&fault, &self.bus, address, job.tried);
                Report::failed(words::outcome(&fault), text)
            }
        };
        unit.ended(report.outcome, now);
        let outcome = report.outcome;
        let text = report.text.clone();
        let round_over = match job.origin {
            Origin::Once(reply) => {
                reply(report);
                false
            }
            Origin::Watch => {
                if let Ask::Query(Query::Read(read)) = job.ask {
                    unit.plan.done(read, now);
                }
                unit.plan.due(now).is_none()
            }
            Origin::Icon => {
                if let (Some(icon), Ask::Query(query)) = (&mut unit.icon, &job.ask) {
                    icon.reply(query, &report, self.clock.at(now));
                }
                false
            }
            Origin::Dop | Origin::Indicators => {
                let at = self.clock.at(now);
                match (&mut unit.dop, job.origin) {
                    (Some(dop), Origin::Dop) => dop.reply(&report, at),
                    (Some(dop), _) => dop.indicators(&report, at),
                    (None, _) => {}
                }
                false
            }
        };
        // A plan that is too much for the line never comes to the end of its round.
        let old = unit.posted.is_none_or(|at| at + STALE <= now);
        if round_over || old || unit.outcome != Some(outcome) {
            self.state(at, outcome, text);
        }
        Ok(())
    }

    /// Posts the state of a device.
    fn state(&mut self, at: usize, outcome: Outcome, text: String) {
        let Some(unit) = self.units.get_mut(at) else {
            return;
        };
        unit.outcome = Some(outcome);
        unit.posted = Some(Instant::now());
        let message = ToPage::Device {
            tag: unit.tag.clone(),
            outcome,
            text,
            last_ok_us: unit.last_ok.map(shared::capture::Micros::get),
            latency_us: unit.latency.and_then(|l| u64::try_from(l.as_micros()).ok()),
        };
        self.board.post(unit.slot, &message);
    }

    /// Posts the state of the line.
    fn post(&self, state: LineState, text: String) {
        let message = ToPage::Line {
            bus: self.bus.name.clone(),
            state,
            text,
            since_us: self.clock.now().get(),
        };
        self.board.post(self.slot, &message);
    }
}

/// Makes sure that the next answer of a device belongs to the next request.
async fn resync(line: &mut Line, unit: &mut Unit, nonce: &mut u16) -> Result<(), Fault> {
    if !unit.resync {
        return Ok(());
    }
    *nonce = nonce.wrapping_add(1);
    let answer = line.echo(unit.address, *nonce).await?;
    // A refusal answers the echo too; but a device that refuses is not asked again.
    if answer.pdu.first() == Some(&0x88) {
        unit.echo = false;
    }
    unit.resync = false;
    Ok(())
}
