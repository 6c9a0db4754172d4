//! Buses: one actor for each line, which alone opens, writes and reads it.

mod actor;
mod alarm;
mod answer;
pub mod board;
pub mod ddc;
mod dop;
pub mod gate;
pub mod hart;
pub mod icon;
pub mod master;
mod open;
mod outlet;
pub mod query;
pub mod recorder;
mod schedule;
pub mod tap;
mod tcp;
pub mod timing;
mod unit;
pub(crate) mod words;

pub use actor::start;
pub use open::Plug;
pub use outlet::Outlet;

use shared::encode::Read;
use shared::proto::{DopAsk, IconAsk, Outcome};
use std::io;
use std::time::Duration;
use tokio::sync::{mpsc, oneshot};

/// Commands that may wait for an actor.
const INBOX: usize = 256;

/// Which client a watch belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ClientId(pub u64);

/// What an actor is asked to do. There is nothing here that carries a value or an address to write.
pub enum Command {
    /// Read once.
    Read {
        /// Index of the device on this bus.
        device: usize,
        /// What to ask.
        query: query::Query,
        /// Gets the outcome.
        reply: Reply,
    },
    /// Read these again and again; replaces what the client watched on the device before.
    Watch {
        /// Who wants it.
        client: ClientId,
        /// Index of the device on this bus.
        device: usize,
        /// What to read; none ends the watch.
        reads: Vec<Read>,
        /// From one round to the next.
        period: Duration,
    },
    /// About the diagnostic objects of a device.
    Dop {
        /// Who wants it.
        client: ClientId,
        /// Index of the device on this bus.
        device: usize,
        /// What is wanted.
        ask: DopAsk,
        /// Gets what comes of it.
        out: Outlet,
    },
    /// About what an ICON3000 offers beyond its registers.
    Icon {
        /// Who wants it.
        client: ClientId,
        /// Index of the device on this bus.
        device: usize,
        /// What is wanted.
        ask: IconAsk,
        /// Gets what comes of it.
        out: Outlet,
    },
    /// About the devices of a HART line.
    Hart(hart::Wish),
    /// The client is gone, and its watches with it.
    Leave {
        /// Who.
        client: ClientId,
    },
}

/// Takes the outcome of a read.
pub type Reply = Box<dyn FnOnce(Report) + Send>;

/// How a read ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Report {
    /// How.
    pub outcome: Outcome,
    /// In words.
    pub text: String,
    /// The response PDU of a good answer.
    pub pdu: Option<Vec<u8>>,
    /// The code of an exception.
    pub code: Option<u8>,
}

impl Report {
    /// What an answer says.
    fn of(answer: Answer) -> Self {
        match answer.pdu.as_slice() {
            [function, code] if *function >= 0x80 => Self {
                outcome: Outcome::Exception,
                text: words::exception(*code),
                pdu: None,
                code: Some(*code),
            },
            _ => Self {
                outcome: Outcome::Ok,
                text: words::good(answer.latency),
                pdu: Some(answer.pdu),
                code: None,
            },
        }
    }

    /// Nothing was answered.
    fn failed(outcome: Outcome, text: String) -> Self {
        Self {
            outcome,
            text,
            pdu: None,
            code: None,
        }
    }

    /// It is not allowed, or makes no sense.
    #[must_use]
    pub fn refused(text: String) -> Self {
        Self::failed(Outcome::Refused, text)
    }

    /// The line is not there.
    fn down(text: &str) -> Self {
        Self::failed(Outcome::Down, text.to_owned())
    }
}

/// An answer: good, or an exception. Its shape is that of an answer to the request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The response PDU.
    pub pdu: Vec<u8>,
    /// From the end of the request to the end of the answer.
    pub latency: Duration,
}

/// Why there is no answer. "No answer" and "a bad answer" are different things.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The line is lost.
    #[error("{0}")]
    Line(#[from] io::Error),
    /// The other side closed the connection; it can be opened again.
    #[error("the other side closed the connection")]
    Closed,
    /// Nothing came.
    #[error("no answer")]
    Silence,
    /// Bytes came, but not from this device or not to this request.
    #[error("{0}")]
    Noise(String),
    /// The device answered, and the answer is damaged.
    #[error("{0}")]
    Damaged(String),
    /// Two answers came that differ.
    #[error("two answers came that differ; one of them belongs to an earlier request")]
    Two,
}

impl Fault {
    /// True if an answer to this request may still come.
    const fn is_open(&self) -> bool {
        matches!(self, Self::Silence | Self::Noise(_) | Self::Two)
    }
}

/// The way to a bus.
#[derive(Clone, Debug)]
pub struct Handle {
    commands: mpsc::Sender<Command>,
    recorder: recorder::Recorder,
}

impl Handle {
    /// Asks the actor. False if it has ended, which it does only with the program.
    pub async fn ask(&self, command: Command) -> bool {
        self.commands.send(command).await.is_ok()
    }

    /// Reads once and waits for the outcome.
    pub async fn read(&self, device: usize, query: impl Into<query::Query>) -> Report {
        let query = query.into();
        let (sender, receiver) = oneshot::channel();
        let reply: Reply = Box::new(move |report| {
            // Nobody waits any more: then nobody needs it.
            let _unread = sender.send(report);
        });
        let command = Command::Read {
            device,
            query,
            reply,
        };
        self.ask(command).await;
        let ending = |_| Report::down("the program is ending");
        receiver.await.unwrap_or_else(ending)
    }

    /// What was on the line.
    #[must_use]
    pub const fn recorder(&self) -> &recorder::Recorder {
        &self.recorder
    }
}
