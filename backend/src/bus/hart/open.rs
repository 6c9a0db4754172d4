//! Opening a HART line, and what both kinds of it have in common.

use super::super::alarm::Alarm;
use super::super::gate::Gate;
use super::super::open::Plug;
use super::super::recorder::Recorder;
use super::super::tap::Tap;
use super::line::{Port, SerialLine};
use super::{Exchange, Gateway, IpLine, words};
use crate::clock::Clock;
use crate::config::hart::{HartWay, Keying};
use crate::config::{BusConfig, Mode, Parity};
use crate::serial;
use crate::sim::hart as sim;
use shared::capture::Micros;
use shared::frame::Framing;
use shared::hart::link::Request;
use shared::proto::HartNews;
use std::io;
use std::sync::Arc;
use std::time::Duration;
use tokio::time::Instant;

/// Eight data bits, odd parity, one stop bit.
pub const MODE: Mode = Mode {
    data: 8,
    parity: Parity::Odd,
    stop: 1,
};

/// An open HART line. Boxed because they differ much in size.
#[derive(Debug)]
pub enum Line {
    /// A modem, or what stands in its place.
    Serial(Box<SerialLine>, Option<u8>),
    /// A gateway.
    Ip(Box<IpLine>),
}

impl Line {
    /// Opens the line of a bus.
    ///
    /// # Errors
    /// If it is no HART bus, or if the port or gateway can't be had.
    pub async fn open(
        bus: &BusConfig,
        recorder: Recorder,
        plug: &mut Plug,
        clock: Clock,
    ) -> io::Result<Self> {
        let Some(hart) = bus.line.hart() else {
            return Err(io::Error::other("this is no HART line"));
        };
        let hart = Arc::clone(hart);
        let gate = Gate::hart();
        let (port, keying, alarm) = match (&hart.way, plug) {
            (_, Plug::Stream(make)) => (Port::Other(make()?), nothing(), Alarm::default()),
            (HartWay::Serial { port, baud, keying }, _) => {
                let port = serial::open(port, *baud, MODE)?;
                (Port::Serial(port), *keying, Alarm::exact())
            }
            (HartWay::Simulated, Plug::Loop(simulated)) => {
                let (near, far) = tokio::io::duplex(4096);
                let simulated = simulated.clone();
                tokio::spawn(async move { sim::serve(far, &simulated).await });
                (Port::Other(Box::new(near)), nothing(), Alarm::default())
            }
            (HartWay::Simulated, _) => {
                return Err(io::Error::other("nothing is simulated here"));
            }
            (HartWay::Ip { host, udp }, _) => {
                let gateway = Gateway {
                    host,
                    udp: *udp,
                    primary: hart.primary,
                    timeout: bus.timeout,
                    retries: bus.retries,
                };
                let line = IpLine::open(gateway, gate, recorder, clock).await?;
                return Ok(Self::Ip(Box::new(line)));
            }
        };
        let tap = Tap::new(port, Framing::Hart, gate, recorder);
        let setup = hart.setup(bus.retries);
        let line = SerialLine::new(tap, setup, keying, clock, alarm);
        Ok(Self::Serial(Box::new(line), hart.preambles))
    }

    /// Sends a request and waits for its outcome.
    ///
    /// # Errors
    /// If the line is lost, or if the request may not be sent.
    pub async fn exchange(&mut self, request: Request) -> io::Result<Exchange> {
        match self {
            Self::Serial(line, least) => {
                let preambles = least.unwrap_or(0).max(request.preambles);
                let request = request.with_preambles(preambles);
                Ok(line.exchange(request).await?.into())
            }
            Self::Ip(line) => line.exchange(&request).await,
        }
    }

    /// Listens while there is nothing to ask, until something was heard. Safe to cancel.
    ///
    /// # Errors
    /// If the line is lost.
    pub async fn listen(&mut self) -> io::Result<()> {
        match self {
            Self::Serial(line, _) => line.listen().await,
            Self::Ip(line) => line.listen().await,
        }
    }

    /// When it has something to say by itself.
    #[must_use]
    pub fn due(&self) -> Option<Instant> {
        match self {
            Self::Serial(..) => None,
            Self::Ip(line) => Some(line.due()),
        }
    }

    /// Says it.
    ///
    /// # Errors
    /// If the line is lost.
    pub async fn tend(&mut self) -> io::Result<()> {
        match self {
            Self::Serial(..) => Ok(()),
            Self::Ip(line) => line.tend().await,
        }
    }

    /// Leaves the line.
    pub async fn close(&mut self) {
        if let Self::Ip(line) = self {
            line.close().await;
        }
    }

    /// Who else is on the line, and how its traffic goes.
    #[must_use]
    pub fn news(&self, bus: &str, now: Micros) -> HartNews {
        let (primary, other, burst, stats) = match self {
            Self::Serial(line, _) => {
                let link = line.link();
                let (other, burst) = (link.hears_other_master(now), link.hears_bursts(now));
                (Some(link.setup().primary), other, burst, link.stats())
            }
            Self::Ip(line) => (None, false, line.stats().bursts > 0, line.stats()),
        };
        HartNews::Link {
            bus: bus.to_owned(),
            primary,
            other_master: other,
            burst,
            sent: stats.sent,
            answered: stats.answered,
            retried: stats.retried,
            damaged: stats.damaged,
            text: words::link(other, burst, stats),
        }
    }
}

/// A carrier that nobody has to switch.
const fn nothing() -> Keying {
    Keying {
        lead: Duration::ZERO,
        tail: Duration::ZERO,
    }
}
