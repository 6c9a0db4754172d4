//! The actor of a HART line: keeps it open, decides what is asked next, and asks.

mod pages;

use super::super::board::Board;
use super::super::open::Plug;
use super::super::recorder::Recorder;
use super::super::{Command, Handle, INBOX, words as lines};
use super::job::{Ask, Job, Kind};
use super::open::Line;
use super::unit::Unit;
use super::{Exchange, words};
use crate::bus::{ClientId, Outlet};
use crate::clock::Clock;
use crate::config::{BusConfig, DeviceConfig};
use shared::hart::link::{Device, Step, Target};
use shared::proto::{HartAsk, HartNews, LineState, Outcome, ToPage};
use shared::render::hex;
use std::collections::VecDeque;
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
/// Jobs that may wait for one line.
const MAX_JOBS: usize = 64;
/// How long a page that takes nothing is waited for before it is looked at again.
const PAUSE: Duration = Duration::from_millis(20);
/// The state of a line is told at most this often.
const TELL: Duration = Duration::from_millis(500);

/// Starts the actor of a HART bus. `devices` are those of this bus, in the order of their indices.
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
    let unit = |d: &DeviceConfig| {
        let target = d.target.clone().unwrap_or(Target::Polling(d.unit));
        Unit::new(d.tag.clone(), board.slot(), Device::new(target))
    };
    let actor = Actor {
        units: devices.iter().map(unit).collect(),
        slot: board.slot(),
        bus,
        plug,
        clock,
        board,
        recorder: recorder.clone(),
        inbox,
        jobs: VecDeque::new(),
        job_was_last: false,
        turn: 0,
        listeners: Vec::new(),
        told: Instant::now(),
    };
    tokio::spawn(actor.run());
    Handle { commands, recorder }
}

struct Actor {
    bus: BusConfig,
    units: Vec<Unit>,
    plug: Plug,
    clock: Clock,
    board: Board,
    slot: usize,
    recorder: Recorder,
    inbox: mpsc::Receiver<Command>,
    jobs: VecDeque<Job>,
    /// The last thing done was for a job: a watch goes first now.
    job_was_last: bool,
    /// The device that was asked last for a watch.
    turn: usize,
    /// Pages that want the state of the line, and what they know of it.
    listeners: Vec<(ClientId, Outlet, Option<HartNews>)>,
    told: Instant,
}

/// Why the actor stopped asking.
enum Stop {
    /// Nobody can ask it any more: the program ends.
    Ended,
    /// The line is lost.
    Lost(io::Error),
}

/// What to do next.
enum Turn {
    /// The first of the jobs.
    Job,
    /// A watch of this device.
    Watch(usize),
}

impl Actor {
    async fn run(mut self) {
        self.post(LineState::Starting, "being opened".into());
        let mut wait = FIRST_RETRY;
        let mut said = String::new();
        loop {
            let opened = Line::open(&self.bus, self.recorder.clone(), &mut self.plug, self.clock);
            let error = match opened.await {
                Ok(mut line) => {
                    wait = FIRST_RETRY;
                    said.clear();
                    self.up();
                    let stop = self.work(&mut line).await;
                    line.close().await;
                    match stop {
                        Stop::Ended => return,
                        Stop::Lost(error) => error,
                    }
                }
                Err(error) => error,
            };
            let text = lines::down(&self.bus.line, &error);
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
        self.drop_jobs(text);
        for at in 0..self.units.len() {
            if self.units.get(at).is_some_and(Unit::is_watched) {
                self.state(at, Outcome::Down, text.to_owned());
            }
        }
    }

    fn drop_jobs(&mut self, text: &str) {
        self.jobs.drain(..).for_each(|mut job| job.down(text));
    }

    /// Waits before the line is tried again; answers commands meanwhile. False at the end.
    async fn idle(&mut self, wait: Duration, text: &str) -> bool {
        let until = Instant::now() + wait;
        loop {
            tokio::select! {
                () = sleep_until(until) => return true,
                command = self.inbox.recv() => match command {
                    None => return false,
                    Some(command) => {
                        let watched = match &command {
                            Command::Hart(wish) if matches!(wish.ask, HartAsk::Watch { .. }) => wish.device,
                            _ => None,
                        };
                        self.obey(command);
                        self.drop_jobs(text);
                        if let Some(at) = watched
                            && self.units.get(at).is_some_and(Unit::is_watched)
                        {
                            self.state(at, Outcome::Down, text.to_owned());
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
            let told = self.tell(line);
            let now = Instant::now();
            let waiting = self.units.iter_mut().filter_map(Unit::flush).count() > 0;
            let wake = match self.choose(now) {
                Ok(turn) => {
                    if let Err(error) = self.attempt(line, turn).await {
                        return Stop::Lost(error);
                    }
                    continue;
                }
                Err(wake) => wake,
            };
            // Without anything to do, a day is as good as for ever.
            let pause = waiting.then(|| now + PAUSE);
            let wakes = [wake, told, pause, line.due()];
            let wake = wakes.into_iter().flatten().min();
            let wake = wake.unwrap_or(now + Duration::from_secs(86_400));
            tokio::select! {
                biased;
                command = self.inbox.recv() => match command {
                    Some(command) => self.obey(command),
                    None => return Stop::Ended,
                },
                heard = line.listen() => if let Err(error) = heard {
                    return Stop::Lost(error);
                },
                () = sleep_until(wake) => {}
            }
            if let Err(error) = line.tend().await {
                return Stop::Lost(error);
            }
        }
    }

    /// What is to be done now, else when there will be something to do.
    fn choose(&mut self, now: Instant) -> Result<Turn, Option<Instant>> {
        while let Some(job) = self.jobs.front()
            && job.is_over()
            && job.out.has_room()
        {
            job.finish("");
            self.jobs.pop_front();
        }
        // A page that takes nothing holds up nobody else.
        let ready = |j: &Job| j.out.has_room() && !j.is_over();
        let job = self.jobs.iter().position(ready);
        let count = self.units.len();
        let watch = (1..=count)
            .map(|step| (self.turn + step) % count)
            .find(|at| {
                self.units
                    .get(*at)
                    .and_then(Unit::due)
                    .is_some_and(|d| d <= now)
            });
        match (job, watch) {
            (Some(at), None) => {
                self.jobs.rotate_left(at);
                Ok(Turn::Job)
            }
            (Some(at), Some(_)) if !self.job_was_last => {
                self.jobs.rotate_left(at);
                Ok(Turn::Job)
            }
            (_, Some(at)) => Ok(Turn::Watch(at)),
            (None, None) => {
                let due = self.units.iter().filter_map(Unit::due).min();
                let pause = (!self.jobs.is_empty()).then(|| now + PAUSE);
                Err([due, pause].into_iter().flatten().min())
            }
        }
    }

    /// Asks once and deals with what comes of it. An error means that the line is lost.
    async fn attempt(&mut self, line: &mut Line, turn: Turn) -> io::Result<()> {
        self.job_was_last = matches!(turn, Turn::Job);
        let (at, ask) = match turn {
            Turn::Watch(at) => {
                self.turn = at;
                let ask = self.units.get_mut(at).and_then(|u| u.next(Instant::now()));
                let Some(ask) = ask else { return Ok(()) };
                (at, ask)
            }
            Turn::Job => match self.jobs.front().map(|j| &j.kind) {
                Some(Kind::Read(at, asks)) => {
                    let Some(ask) = asks.front() else {
                        return Ok(());
                    };
                    (*at, ask.clone())
                }
                Some(Kind::Scan(scan)) => {
                    let Some((_, request)) = scan.next() else {
                        return Ok(());
                    };
                    let exchange = line.exchange(request).await?;
                    if let Some(job) = self.jobs.front_mut() {
                        job.scanned(&exchange, &self.bus.name);
                    }
                    return Ok(());
                }
                Some(Kind::Find(Some(target))) => {
                    let exchange = line.exchange(target.identify()).await?;
                    if let Some(job) = self.jobs.front_mut() {
                        job.searched(&exchange, &self.bus.name);
                    }
                    return Ok(());
                }
                Some(Kind::Find(None)) | None => return Ok(()),
            },
        };
        let Some(unit) = self.units.get_mut(at) else {
            return Ok(());
        };
        let exchange = match unit.device.request(ask.number, &ask.data) {
            Step::Ask(request) => line.exchange(request).await?,
            Step::Find(request) => {
                let found = line.exchange(request).await?;
                let known = found.outcome.as_ref().is_ok_and(|a| unit.device.found(a));
                match unit.device.request(ask.number, &ask.data) {
                    Step::Ask(request) if known => {
                        // Between finding it and asking, others may have something to do.
                        line.exchange(request).await?
                    }
                    _ => found,
                }
            }
        };
        self.conclude(at, &ask, &exchange);
        Ok(())
    }

    /// What came of a command of a device.
    fn conclude(&mut self, at: usize, ask: &Ask, exchange: &Exchange) {
        let now = Instant::now();
        let Some(unit) = self.units.get_mut(at) else {
            return;
        };
        // A device that says who it is, and is not the one that was meant.
        let foreign = exchange.outcome.is_ok() && unit.device.identity().is_none();
        let (outcome, text) = if foreign {
            let target = words::target(unit.device.target());
            let text =
                format!("what answers at {target} does not say who it is, or is another device");
            (Outcome::Damaged, text)
        } else {
            let text = words::exchange(exchange, unit.device.target(), &self.bus.line);
            (words::outcome(exchange), text)
        };
        let took_us = exchange.ended.since(exchange.began);
        let response = match &exchange.outcome {
            Ok(answer) => hex(&answer.frame),
            Err(_) => String::new(),
        };
        if outcome == Outcome::Ok {
            unit.last_ok = Some(exchange.ended);
            unit.latency_us = Some(took_us);
        }
        unit.ended(outcome, now);
        let news = |id| HartNews::Exchange {
            id,
            device: unit.tag.clone(),
            command: ask.number,
            request: hex(&exchange.request),
            response: response.clone(),
            outcome,
            text: text.clone(),
            at_us: exchange.ended.get(),
            took_us,
            tries: exchange.tries,
        };
        if self.job_was_last {
            let silent = outcome == Outcome::Silence;
            if let Some(job) = self.jobs.front_mut() {
                job.done(news(Some(job.id)));
                if silent {
                    job.give_up();
                }
            }
        } else {
            let news = news(None);
            unit.done(ask, &news, now);
            if outcome == Outcome::Silence {
                unit.skip(now);
            }
        }
        let old = unit.posted.is_none_or(|at| at + STALE <= now);
        if old || unit.outcome != Some(outcome) {
            self.state(at, outcome, text);
        }
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
            latency_us: unit.latency_us,
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
