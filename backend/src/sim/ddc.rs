//! A simulated DDC-100 network on one or two lines.
//!
//! What cable and units do is in `shared::sim`; here are their lines, their time, and when troubles
//! come and go.

mod fault;

pub use fault::{Fault, Span};

use crate::bus::Plug;
use crate::bus::master::Stream;
use crate::bus::timing::gap;
use crate::clock::Clock;
use crate::config::{DdcConfig, DdcPorts, DeviceConfig};
use shared::capture::Micros;
use shared::ddc100::HostPort;
use shared::ddc100::setup::Member;
use shared::decode::pdu_of;
use shared::device::Device;
use shared::encode::frame;
use shared::frame::Framing;
use shared::frame::ascii::hex_pair;
use shared::frame::check::crc_holds;
use shared::pdu::length::{self, Length};
use shared::proto::DdcShape;
use shared::sim::ddc100::{Answer, Loop, Trouble};
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::time::{Instant, sleep_until, timeout};

/// Bytes of the shortest frame of RTU: address, function and check.
const SHORTEST: usize = 4;
/// More bytes than any request has.
const MAX_HEARD: usize = 4096;

/// A simulated network. Clones are the same network.
#[derive(Clone, Debug)]
pub struct Network {
    state: Arc<Mutex<State>>,
    clock: Clock,
}

#[derive(Debug)]
struct State {
    cable: Loop,
    faults: Vec<(Fault, bool)>,
    strokes: Vec<Stroke>,
}

/// A valve that somebody in the control room opens and closes.
#[derive(Debug)]
struct Stroke {
    unit: u8,
    next: Micros,
    opens: bool,
}

/// From one stroke of a valve to the next, in microseconds.
const STROKE_US: u64 = 150_000_000;
/// Between the strokes of two valves.
const APART_US: u64 = 23_000_000;
/// Values of register 1 (LMAIM4019-00, table 3.7).
const OPEN: u16 = 256;
const CLOSE: u16 = 768;

impl State {
    /// Brings about what is to be by now.
    fn go_on(&mut self, now: Micros) {
        for (fault, on) in &mut self.faults {
            let holds = fault.span.is_none_or(|span| span.holds(now));
            if holds != *on {
                *on = holds;
                match holds {
                    true => self.cable.inject(fault.trouble),
                    false => self.cable.heal(fault.trouble),
                };
            }
        }
        for stroke in self.strokes.iter_mut().filter(|s| s.next <= now) {
            let value = if stroke.opens { OPEN } else { CLOSE };
            let [high, low] = value.to_be_bytes();
            let command = [6, 0, 0, high, low];
            // Through whichever port reaches it.
            let _done = HostPort::BOTH
                .into_iter()
                .find_map(|port| self.cable.request(port, stroke.unit, &command, now));
            stroke.opens = !stroke.opens;
            stroke.next = now.plus(STROKE_US);
        }
    }
}

impl Network {
    /// A network of these units in the order of the cable.
    ///
    /// # Errors
    /// If there is no place or unit that a fault names; gives that fault.
    pub fn new(
        shape: DdcShape,
        devices: &[DeviceConfig],
        faults: &[Fault],
        clock: Clock,
    ) -> Result<Self, Fault> {
        let members: Vec<Member> = devices
            .iter()
            .map(|d| Member {
                unit: d.unit,
                kind: d.device,
            })
            .collect();
        let mut cable = Loop::new(shape, &members);
        for fault in faults {
            if !cable.inject(fault.trouble) {
                return Err(*fault);
            }
            cable.heal(fault.trouble);
        }
        let faults = faults.iter().map(|f| (*f, false)).collect();
        Ok(Self {
            state: Arc::new(Mutex::new(State {
                cable,
                faults,
                strokes: Vec::new(),
            })),
            clock,
        })
    }

    /// From now on its valves are opened and closed, and inputs of I/O modules change, so that there
    /// is something to see.
    #[must_use]
    pub fn lively(self, devices: &[DeviceConfig]) -> Self {
        let valves = devices.iter().filter(|d| d.device != Device::Ddc100Io);
        let now = self.clock.now();
        let mut next = now;
        let strokes = valves.map(|d| {
            next = next.plus(APART_US);
            Stroke {
                unit: d.unit,
                next: now.plus(next.since(now) % STROKE_US),
                opens: true,
            }
        });
        let strokes = strokes.collect();
        let mut state = self.lock();
        state.strokes = strokes;
        state.cable.set_lively();
        drop(state);
        self
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // Nothing panics while it holds the lock.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Brings a trouble about, or ends it. False if it was so already, or if there is nothing that
    /// it could happen to.
    pub fn set(&self, trouble: Trouble, on: bool) -> bool {
        let mut state = self.lock();
        if on {
            state.cable.inject(trouble)
        } else {
            state.cable.heal(trouble)
        }
    }

    /// What the unit says that a request at a port reaches; `None` if nobody answers.
    #[must_use]
    pub fn answer(&self, port: HostPort, unit: u8, pdu: &[u8]) -> Option<Answer> {
        let now = self.clock.now();
        let mut state = self.lock();
        state.go_on(now);
        state.cable.request(port, unit, pdu, now)
    }

    /// A frame came to a port that no unit could make anything of.
    fn damaged(&self, port: HostPort) {
        let now = self.clock.now();
        let mut state = self.lock();
        state.go_on(now);
        state.cable.damaged(port, now);
    }
}

/// What is at the ports of a network: as configured, or the simulated cable.
#[must_use]
pub fn plugs(ddc: &DdcConfig, devices: &[DeviceConfig], clock: Clock) -> Vec<Plug> {
    let DdcPorts::Simulated(faults) = &ddc.ports else {
        return ddc.paths().iter().map(|_| Plug::Configured).collect();
    };
    // The configuration was checked: a fault that can't be is not there any more.
    let network = Network::new(ddc.shape, devices, faults, clock)
        .or_else(|_| Network::new(ddc.shape, devices, &[], clock))
        .map(|network| network.lively(devices));
    let pace = Pace::of(ddc);
    let plug = |port: HostPort| {
        let network = network.clone();
        Plug::Stream(Box::new(move || {
            let Ok(network) = network.clone() else {
                return Err(io::ErrorKind::NotFound.into());
            };
            let (near, far) = tokio::io::duplex(MAX_HEARD);
            tokio::spawn(async move { serve(far, port, &network, pace).await });
            Ok(Box::new(near) as Box<dyn Stream>)
        }))
    };
    HostPort::BOTH
        .into_iter()
        .take(ddc.paths().len())
        .map(plug)
        .collect()
}

/// How a simulated network takes its time.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// RTU or ASCII.
    pub framing: Framing,
    /// Time of one character that is waited for; zero if the line itself takes its time.
    pub character: Duration,
    /// Units take the time of table 4.1; else they answer at once.
    pub thinks: bool,
    /// Silence that ends a frame of RTU.
    pub gap: Duration,
}

impl Pace {
    /// A line that is only pretended, with units and speed of a real one: 8N1.
    #[must_use]
    pub fn new(framing: Framing, baud: u32, shortest_gap: Duration) -> Self {
        Self {
            framing,
            character: Duration::from_nanos(10_000_000_000 / u64::from(baud.max(1))),
            thinks: true,
            gap: gap(baud).max(shortest_gap),
        }
    }

    /// That of a network of the configuration.
    #[must_use]
    pub fn of(ddc: &DdcConfig) -> Self {
        let bits = u64::from(ddc.mode.bits());
        Self {
            character: Duration::from_nanos(bits * 1_000_000_000 / u64::from(ddc.baud.max(1))),
            ..Self::new(ddc.framing, ddc.baud, Duration::ZERO)
        }
    }

    /// The same on a line that takes its time itself.
    #[must_use]
    pub const fn on_the_wire(self) -> Self {
        Self {
            character: Duration::ZERO,
            ..self
        }
    }

    /// The same without any waiting.
    #[must_use]
    pub const fn at_once(self) -> Self {
        Self {
            character: Duration::ZERO,
            thinks: false,
            ..self
        }
    }
}

/// A request that was heard.
struct Heard {
    unit: u8,
    pdu: Vec<u8>,
    /// Characters of its frame.
    characters: usize,
}

/// Answers at one end of the cable until the line is closed.
///
/// # Errors
/// If the line fails.
pub async fn serve<S>(mut line: S, port: HostPort, network: &Network, pace: Pace) -> io::Result<()>
where
    S: AsyncRead + AsyncWrite + Unpin,
{
    let mut heard: Vec<u8> = Vec::with_capacity(512);
    loop {
        let mut bytes = [0; 512];
        let count = if heard.is_empty() || pace.framing == Framing::Ascii {
            line.read(&mut bytes).await?
        } else {
            match timeout(pace.gap, line.read(&mut bytes)).await {
                Ok(read) => read?,
                Err(_) => {
                    // The frame is over, whatever it was.
                    if heard.len() >= SHORTEST && !crc_holds(&heard) {
                        network.damaged(port);
                    }
                    heard.clear();
                    continue;
                }
            }
        };
        let since = Instant::now();
        if count == 0 {
            return Ok(());
        }
        heard.extend_from_slice(bytes.get(..count).unwrap_or(&[]));
        match request(pace.framing, &mut heard) {
            Some(Ok(request)) => answer(&mut line, port, network, pace, &request, since).await?,
            Some(Err(Damaged)) => network.damaged(port),
            None if heard.len() > MAX_HEARD => heard.clear(),
            None => {}
        }
    }
}

/// A frame that is whole, but not sound.
struct Damaged;

/// A frame that is complete; what was heard is used up then. In RTU a damaged one has no end of its
/// own: the silence after it is one.
fn request(framing: Framing, heard: &mut Vec<u8>) -> Option<Result<Heard, Damaged>> {
    match framing {
        Framing::Ascii => {
            let end = heard.iter().position(|b| *b == b'\n')? + 1;
            let line: Vec<u8> = heard.drain(..end).collect();
            // A colon begins a frame anew, whatever stood before it.
            let at = line.iter().rposition(|b| *b == b':')?;
            let line = line.get(at..)?;
            let unit = line.get(1..3).and_then(hex_pair);
            let sound = unit.and_then(|unit| {
                // Only what is exactly the frame of this PDU.
                let pdu = pdu_of(line, framing)
                    .filter(|pdu| frame(framing, 0, unit, pdu).eq_ignore_ascii_case(line))?;
                Some(Heard {
                    unit,
                    pdu,
                    characters: line.len(),
                })
            });
            Some(sound.ok_or(Damaged))
        }
        _ => {
            let complete = length::request(heard.get(1..)?);
            let whole = complete == Length::Exact(heard.len().saturating_sub(3));
            if !whole || !crc_holds(heard) {
                return None;
            }
            let frame = std::mem::take(heard);
            Some(Ok(Heard {
                unit: *frame.first()?,
                pdu: pdu_of(&frame, framing)?,
                characters: frame.len(),
            }))
        }
    }
}

async fn answer<S>(
    line: &mut S,
    port: HostPort,
    network: &Network,
    pace: Pace,
    request: &Heard,
    since: Instant,
) -> io::Result<()>
where
    S: AsyncWrite + Unpin,
{
    let Some(said) = network.answer(port, request.unit, &request.pdu) else {
        return Ok(());
    };
    let bytes = frame(pace.framing, 0, request.unit, &said.pdu);
    let characters = u32::try_from(request.characters + bytes.len()).unwrap_or(u32::MAX);
    let mut wait = pace.character.saturating_mul(characters);
    if pace.thinks {
        wait += Duration::from_micros(said.after_us);
    }
    if !wait.is_zero() {
        sleep_until(since + wait).await;
    }
    line.write_all(&bytes).await
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Function 08, sub-function 12: frames whose check does not hold, by RTU and ASCII.
    #[tokio::test(start_paused = true)]
    async fn damaged_frames_are_counted() {
        for framing in [Framing::Rtu, Framing::Ascii] {
            let device = DeviceConfig {
                tag: "MOV-1".into(),
                device: Device::Ddc100Mx,
                bus: 0,
                unit: 1,
                description: String::new(),
                faults: Vec::new(),
                profile: None,
                target: None,
            };
            let shape = DdcShape::SingleEnded;
            let network = Network::new(shape, &[device], &[], Clock::start()).unwrap();
            let pace = Pace::new(framing, 9600, Duration::ZERO).at_once();
            let (mut near, far) = tokio::io::duplex(MAX_HEARD);
            tokio::spawn(async move { serve(far, HostPort::One, &network, pace).await });
            let sound = frame(framing, 0, 1, &[8, 0, 12, 0, 0]);
            let mut bad = sound.clone();
            // A digit of the data of ASCII, or a byte of it in RTU.
            bad[5] ^= 1;
            for _ in 0..3 {
                near.write_all(&bad).await.unwrap();
                tokio::time::sleep(Duration::from_millis(100)).await;
            }
            // A sound frame for somebody else is not damaged.
            near.write_all(&frame(framing, 0, 9, &[3, 0, 8, 0, 1]))
                .await
                .unwrap();
            tokio::time::sleep(Duration::from_millis(100)).await;
            near.write_all(&sound).await.unwrap();
            let answer = frame(framing, 0, 1, &[8, 0, 12, 0, 3]);
            let mut heard = vec![0; answer.len()];
            near.read_exact(&mut heard).await.unwrap();
            assert_eq!(heard, answer, "{framing:?}");
        }
    }
}
