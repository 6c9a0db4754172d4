//! A host port of a network: opened, lost and opened again by itself, whatever the other one does.

use crate::bus::gate::Gate;
use crate::bus::open::{Line, Plug};
use crate::bus::recorder::Recorder;
use crate::bus::words;
use crate::config::BusConfig;
use shared::ddc100::HostPort;
use shared::proto::LineState;
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use tokio::time::Instant;

/// A port that can't be opened is tried again after this time, then twice that, and so on.
const FIRST_RETRY: Duration = Duration::from_millis(200);
/// But at least this often.
const LAST_RETRY: Duration = Duration::from_secs(5);

/// A host port.
pub(super) struct Port {
    pub number: HostPort,
    /// It as a serial line of its own.
    pub bus: BusConfig,
    /// Where its state is posted, if it has a name of its own.
    pub slot: Option<usize>,
    pub state: LineState,
    /// What happened, and what to do.
    pub text: String,
    pub line: Option<Line>,
    plug: Plug,
    gate: Gate,
    recorder: Recorder,
    driven: Arc<AtomicBool>,
    wait: Duration,
    again: Instant,
}

impl Port {
    pub fn new(
        number: HostPort,
        bus: BusConfig,
        plug: Plug,
        gate: Gate,
        recorder: Recorder,
        driven: Arc<AtomicBool>,
    ) -> Self {
        Self {
            number,
            bus,
            slot: None,
            state: LineState::Starting,
            text: "being opened".into(),
            line: None,
            plug,
            gate,
            recorder,
            driven,
            wait: FIRST_RETRY,
            again: Instant::now(),
        }
    }

    /// When it is to be opened; `None` if it is open.
    pub fn due(&self) -> Option<Instant> {
        self.line.is_none().then_some(self.again)
    }

    /// Tries to open it. True if there is something new to say.
    pub async fn open(&mut self) -> bool {
        let (gate, recorder) = (self.gate.clone(), self.recorder.clone());
        match Line::open(&self.bus, gate, recorder, &mut self.plug).await {
            Ok(line) => {
                tracing::info!("{}: {} is open", self.bus.name, self.bus.line);
                self.line = Some(line);
                self.wait = FIRST_RETRY;
                self.state = LineState::Up;
                self.text = "open".into();
                true
            }
            Err(error) => self.lost(&error),
        }
    }

    /// It is lost, or can't be opened. True if there is something new to say.
    pub fn lost(&mut self, error: &io::Error) -> bool {
        self.line = None;
        self.recorder.silence();
        self.again = Instant::now() + self.wait;
        self.wait = (self.wait * 2).min(LAST_RETRY);
        let text = words::down(&self.bus.line, error);
        if self.state == LineState::Down && self.text == text {
            return false;
        }
        tracing::warn!("{}: {text}", self.bus.name);
        self.state = LineState::Down;
        self.text = text;
        true
    }

    /// Says whether this is the port that is used now.
    pub fn drive(&self, driven: bool) {
        self.driven.store(driven, Ordering::Relaxed);
    }

    /// Listens, if it is open, until it is lost. Safe to cancel.
    pub async fn listen(&mut self) -> io::Error {
        match &mut self.line {
            Some(line) => line.listen().await,
            None => std::future::pending().await,
        }
    }
}
