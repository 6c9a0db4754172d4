//! Opening a line.

use super::alarm::Alarm;
use super::gate::{DopPermit, Gate};
use super::master::{Master, Request, Stream};
use super::query::Query;
use super::recorder::Recorder;
use super::tap::Tap;
use super::tcp::{self, Remote};
use super::timing::{SIMULATED_BAUD, Timing};
use super::{Answer, Fault};
use crate::config::{BusConfig, LineConfig};
use crate::serial;
use crate::sim::{self, Actuators};
use std::io;
use tokio::time::Instant;

/// What is at the other end of a line where the configuration does not say it.
pub enum Plug {
    /// The configuration says it all.
    Configured,
    /// The simulated plant.
    Simulated(Actuators),
    /// The simulated HART loop.
    Loop(sim::hart::Loop),
    /// A stream that is made anew each time the line is opened; for tests.
    Stream(Box<dyn FnMut() -> io::Result<Box<dyn Stream>> + Send>),
}

/// An open line.
#[derive(Debug)]
pub enum Line {
    /// RTU or ASCII over any stream; boxed because it is much larger than the other.
    Serial(Box<Master>),
    /// Modbus TCP.
    Tcp(Remote),
}

impl Line {
    /// Opens the line of a bus.
    pub async fn open(
        bus: &BusConfig,
        gate: Gate,
        recorder: Recorder,
        plug: &mut Plug,
    ) -> io::Result<Self> {
        let framing = bus.line.framing();
        let timing = Timing::of(bus);
        let mut alarm = Alarm::default();
        let stream: Box<dyn Stream> = match (&bus.line, plug) {
            (_, Plug::Stream(make)) => make()?,
            (LineConfig::Tcp { host }, _) => {
                let remote = Remote::connect(host, bus.timeout, gate, recorder).await?;
                return Ok(Self::Tcp(remote));
            }
            (
                LineConfig::Serial {
                    port, baud, mode, ..
                },
                _,
            ) => {
                alarm = Alarm::exact();
                Box::new(serial::open(port, *baud, *mode)?)
            }
            (LineConfig::RtuOverTcp { host }, _) => Box::new(tcp::connect(host).await?),
            (LineConfig::Simulator, Plug::Simulated(actuators)) => {
                let (near, far) = tokio::io::duplex(4096);
                let actuators = actuators.clone();
                tokio::spawn(async move {
                    sim::serve_rtu(far, &actuators, sim::Pace::of(SIMULATED_BAUD)).await
                });
                Box::new(near)
            }
            (LineConfig::Simulator, _) | (LineConfig::Ddc(_) | LineConfig::Hart(_), _) => {
                return Err(io::Error::other("nothing is simulated here"));
            }
        };
        let tap = Tap::new(stream, framing, gate, recorder);
        let master = Master::new(tap, framing, timing, alarm);
        Ok(Self::Serial(Box::new(master)))
    }

    /// Reads once.
    pub async fn read(&mut self, unit: u8, query: &Query) -> Result<Answer, Fault> {
        match self {
            Self::Serial(master) => {
                let request = Request {
                    unit,
                    pdu: &query.pdu(),
                    response_len: query.response_len(),
                };
                master.exchange(request).await
            }
            Self::Tcp(remote) => remote.read(unit, query).await,
        }
    }

    /// Writes the request for a diagnostic object.
    pub async fn write(&mut self, permit: &DopPermit) -> Result<Answer, Fault> {
        match self {
            Self::Serial(master) => {
                let request = Request {
                    unit: permit.unit(),
                    pdu: permit.pdu(),
                    response_len: permit.response_len(),
                };
                master.exchange(request).await
            }
            Self::Tcp(remote) => remote.write(permit).await,
        }
    }

    /// Asks a device to repeat a number (FC 08, sub-function 0): whatever it said before is over.
    pub async fn echo(&mut self, unit: u8, nonce: u16) -> Result<Answer, Fault> {
        let Self::Serial(master) = self else {
            // On TCP an answer names its request, and a connection in doubt was closed.
            return Ok(Answer {
                pdu: Vec::new(),
                latency: std::time::Duration::ZERO,
            });
        };
        let [high, low] = nonce.to_be_bytes();
        let pdu = [8, 0, 0, high, low];
        let request = Request {
            unit,
            pdu: &pdu,
            response_len: pdu.len(),
        };
        master.exchange(request).await
    }

    /// Listens while there is nothing to ask. Ends only if the line is lost. Safe to cancel.
    pub async fn listen(&mut self) -> io::Error {
        match self {
            Self::Serial(master) => master.listen().await,
            Self::Tcp(_) => std::future::pending().await,
        }
    }

    /// When the last byte passed, in either direction.
    pub fn last(&self) -> Option<Instant> {
        match self {
            Self::Serial(master) => Some(master.last()),
            Self::Tcp(_) => None,
        }
    }

    /// From now on devices may take so long to begin their answers.
    pub fn set_timeout(&mut self, timeout: std::time::Duration) {
        if let Self::Serial(master) = self {
            master.set_timeout(timeout);
        }
    }

    /// Another port of the same cable was busy until then: this one keeps the same silence.
    pub fn busy_until(&mut self, moment: Instant) {
        if let Self::Serial(master) = self {
            master.busy_until(moment);
        }
    }

    /// When bytes last came that nobody waited for.
    pub fn stray(&self) -> Option<Instant> {
        match self {
            Self::Serial(master) => master.stray(),
            Self::Tcp(_) => None,
        }
    }
}
