//! Simulated actuators on lines: behind the built-in plant, a TCP port or a serial port.
//!
//! What the actuators do is in `shared::sim`; here are only their lines and their time.

pub mod ddc;
pub mod hart;

use crate::bus::timing::gap;
use crate::clock::Clock;
use crate::config::DeviceConfig;
use shared::capture::Micros;
use shared::device::Device;
use shared::dop::Profile;
use shared::encode::frame;
use shared::frame::Framing;
use shared::frame::check::crc_holds;
use shared::map::row::Model;
use shared::pdu::length::{self, Length};
use shared::sim::{Dop, DopSetup, Icon3000, Programme};
use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::Semaphore;
use tokio::time::{Instant, sleep_until, timeout};

/// TCP connections that may be open at once.
const MAX_CONNECTIONS: usize = 32;
/// A TCP client that is silent for so long is let go.
const IDLE: Duration = Duration::from_secs(300);
/// Unit address by which a device on Modbus TCP is meant whatever its own address is.
/// Source: Modbus Messaging on TCP/IP V1.0b, section 4.4.1.2.
const DIRECT: u8 = 255;
/// Longest frame of Modbus RTU (Modbus over Serial Line V1.02, section 2.5.1).
const LONGEST: usize = 256;
/// What is heard without a silence is kept up to here.
const KEPT: usize = 4096;
/// Exception "gateway target device failed to respond".
const NO_TARGET: u8 = 0x0B;

/// The actuators of one line. Clones are the same actuators.
#[derive(Clone, Debug)]
pub struct Actuators {
    units: Arc<Mutex<Vec<(u8, Actuator)>>>,
    clock: Clock,
}

/// One actuator.
#[derive(Clone, Debug)]
enum Actuator {
    Icon(Box<Icon3000>),
    Dop(Box<Dop>),
}

impl Actuator {
    fn advance(&mut self, now: Micros, wall: u64) {
        match self {
            Self::Icon(icon) => icon.advance(now, wall),
            Self::Dop(dop) => dop.advance(now, wall),
        }
    }

    fn overheard(&mut self, sound: bool) {
        match self {
            Self::Icon(icon) => icon.overheard(sound),
            Self::Dop(_) => {}
        }
    }

    fn overrun(&mut self) {
        match self {
            Self::Icon(icon) => icon.overrun(),
            Self::Dop(_) => {}
        }
    }

    fn broadcast(&mut self, pdu: &[u8]) {
        match self {
            Self::Icon(icon) => icon.broadcast(pdu),
            // It has nothing that would make sense to set in all units at once.
            Self::Dop(_) => {}
        }
    }

    fn answer(&mut self, pdu: &[u8]) -> Option<Vec<u8>> {
        match self {
            Self::Icon(icon) => icon.answer(pdu),
            Self::Dop(dop) => dop.answer(pdu),
        }
    }
}

/// The profile of the simulated DOP device. Its addresses and names are the simulator's own.
#[must_use]
pub fn dop_profile() -> Arc<Profile> {
    // A test holds that it is valid; if it were not, it would say nothing.
    let profile = Profile::from_json(include_str!("sim/dop-profile.json"));
    Arc::new(profile.unwrap_or_default())
}

/// How fast a simulated line is.
#[derive(Clone, Copy, Debug)]
pub struct Pace {
    /// Time of one character that is waited for; zero if the line itself takes its time.
    character: Duration,
    /// How long the device thinks.
    turn: Duration,
    /// Silence that ends a frame.
    gap: Duration,
}

impl Pace {
    /// A line that is only pretended, with the speed of a real one.
    #[must_use]
    pub fn of(baud: u32) -> Self {
        Self {
            character: Duration::from_nanos(11_000_000_000 / u64::from(baud.max(1))),
            turn: Duration::from_millis(6),
            gap: gap(baud),
        }
    }

    /// A real line, or one where time does not matter.
    #[must_use]
    pub const fn real(gap: Duration) -> Self {
        Self {
            character: Duration::ZERO,
            turn: Duration::ZERO,
            gap,
        }
    }
}

impl Actuators {
    /// The actuators that a configuration names.
    #[must_use]
    pub fn new<'a>(devices: impl IntoIterator<Item = &'a DeviceConfig>, clock: Clock) -> Self {
        Self::with(devices, clock, DopSetup::default())
    }

    /// The same with DOP devices that behave like this.
    #[must_use]
    pub fn with<'a>(
        devices: impl IntoIterator<Item = &'a DeviceConfig>,
        clock: Clock,
        setup: DopSetup,
    ) -> Self {
        let units = devices
            .into_iter()
            .filter_map(|d| {
                let model = match d.device {
                    Device::Icon3000v2 => Model::Icon3000v2,
                    Device::Icon3000 => Model::Icon3000,
                    Device::Icon2000v4 => Model::Icon2000v4,
                    Device::Dop => {
                        let dop = Box::new(Dop::new(&d.tag, setup));
                        return Some((d.unit, Actuator::Dop(dop)));
                    }
                    _ => return None,
                };
                // Control valves modulate, the others go from end to end.
                let programme = if d.tag.starts_with("FV") || d.tag.starts_with("PV") {
                    Programme::Modulating
                } else {
                    Programme::Strokes
                };
                let mut icon = Box::new(Icon3000::new(model, &d.tag, programme));
                // Faults have their time in the logs, so it must be switched on.
                if !d.faults.is_empty() {
                    icon.advance(clock.now(), clock.wall_ms() / 1000);
                }
                d.faults
                    .iter()
                    .for_each(|fault| icon.set_fault(*fault, true));
                Some((d.unit, Actuator::Icon(icon)))
            })
            .collect();
        Self {
            units: Arc::new(Mutex::new(units)),
            clock,
        }
    }

    /// The response PDU of a unit; `None` if nobody answers.
    #[must_use]
    pub fn answer(&self, unit: u8, pdu: &[u8]) -> Option<Vec<u8>> {
        let (now, wall) = (self.clock.now(), self.clock.wall_ms() / 1000);
        let mut units = self.units.lock().unwrap_or_else(PoisonError::into_inner);
        let mut answer = None;
        for (address, device) in units.iter_mut() {
            device.advance(now, wall);
            if unit == 0 {
                device.broadcast(pdu);
            } else if *address == unit {
                answer = device.answer(pdu);
            } else {
                device.overheard(true);
            }
        }
        answer
    }

    /// A frame that no unit could read.
    fn damaged(&self) {
        let mut units = self.units.lock().unwrap_or_else(PoisonError::into_inner);
        units.iter_mut().for_each(|(_, d)| d.overheard(false));
    }

    /// A frame that is longer than any can be.
    fn overrun(&self) {
        let mut units = self.units.lock().unwrap_or_else(PoisonError::into_inner);
        units.iter_mut().for_each(|(_, d)| d.overrun());
    }

    /// The unit that a TCP client means.
    fn addressed(&self, unit: u8) -> Option<u8> {
        let units = self.units.lock().unwrap_or_else(PoisonError::into_inner);
        match unit {
            0 => Some(0),
            DIRECT => units.first().map(|(u, _)| *u),
            _ => units.iter().map(|(u, _)| *u).find(|u| *u == unit),
        }
    }
}

/// Answers Modbus RTU until the line is closed.
///
/// # Errors
/// If the line fails.
pub async fn serve_rtu<S>(mut line: S, actuators: &Actuators, pace: Pace) -> io::Result<()>
where
    S: AsyncRead + AsyncWrite + Unpin,
{
    let mut heard: Vec<u8> = Vec::with_capacity(512);
    loop {
        let mut bytes = [0; 512];
        let count = if heard.is_empty() {
            line.read(&mut bytes).await?
        } else {
            match timeout(pace.gap, line.read(&mut bytes)).await {
                Ok(read) => read?,
                Err(_) => {
                    // The frame is over, whatever it was.
                    if crc_holds(&heard) {
                        answer(&mut line, actuators, pace, &heard, Instant::now()).await?;
                    } else if heard.len() > LONGEST {
                        actuators.overrun();
                    } else {
                        actuators.damaged();
                    }
                    heard.clear();
                    continue;
                }
            }
        };
        if count == 0 {
            return Ok(());
        }
        heard.extend_from_slice(bytes.get(..count).unwrap_or(&[]));
        // Too long already: what comes until the line is silent belongs to it.
        heard.truncate(KEPT);
        let complete = length::request(heard.get(1..).unwrap_or(&[]));
        if complete == Length::Exact(heard.len().saturating_sub(3)) && crc_holds(&heard) {
            answer(&mut line, actuators, pace, &heard, Instant::now()).await?;
            heard.clear();
        }
    }
}

async fn answer<S>(
    line: &mut S,
    actuators: &Actuators,
    pace: Pace,
    request: &[u8],
    since: Instant,
) -> io::Result<()>
where
    S: AsyncWrite + Unpin,
{
    let (Some(unit), Some(pdu)) = (request.first(), request.get(1..request.len() - 2)) else {
        return Ok(());
    };
    let Some(response) = actuators.answer(*unit, pdu) else {
        return Ok(());
    };
    let response = frame(Framing::Rtu, 0, *unit, &response);
    let characters = u32::try_from(request.len() + response.len()).unwrap_or(u32::MAX);
    if !pace.character.is_zero() {
        sleep_until(since + pace.character * characters + pace.turn).await;
    }
    line.write_all(&response).await?;
    Ok(())
}

/// Answers Modbus TCP until the listener fails.
///
/// # Errors
/// If no connection can be taken any more.
pub async fn serve_tcp(listener: TcpListener, actuators: Actuators) -> io::Result<()> {
    let seats = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    loop {
        let Ok(seat) = Arc::clone(&seats).acquire_owned().await else {
            return Ok(());
        };
        let (stream, peer) = match listener.accept().await {
            Ok(accepted) => accepted,
            // A client that is gone again, or too many open files: neither is the end.
            Err(error) => {
                tracing::debug!("no connection: {error}");
                tokio::time::sleep(Duration::from_millis(50)).await;
                continue;
            }
        };
        let actuators = actuators.clone();
        tokio::spawn(async move {
            if let Err(error) = connection(stream, &actuators).await {
                tracing::debug!("{peer}: {error}");
            }
            drop(seat);
        });
    }
}

async fn connection(mut stream: TcpStream, actuators: &Actuators) -> io::Result<()> {
    stream.set_nodelay(true)?;
    loop {
        let mut header = [0; 7];
        match timeout(IDLE, stream.read_exact(&mut header)).await {
            Ok(Ok(_)) => {}
            _ => return Ok(()),
        }
        let [t0, t1, p0, p1, l0, l1, unit] = header;
        let len = usize::from(u16::from_be_bytes([l0, l1]));
        if (p0, p1) != (0, 0) || !(2..=254).contains(&len) {
            return Err(io::Error::new(io::ErrorKind::InvalidData, "not Modbus TCP"));
        }
        let mut pdu = vec![0; len - 1];
        stream.read_exact(&mut pdu).await?;
        let response = match actuators.addressed(unit) {
            Some(target) => actuators.answer(target, &pdu),
            None => {
                let function = pdu.first().copied().unwrap_or(0) | 0x80;
                Some(vec![function, NO_TARGET])
            }
        };
        if let Some(response) = response {
            let transaction = u16::from_be_bytes([t0, t1]);
            let bytes = frame(Framing::Tcp, transaction, unit, &response);
            stream.write_all(&bytes).await?;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The profile names the registers that the simulated device has.
    #[test]
    fn the_profile_is_that_of_the_simulator() {
        let profile = dop_profile();
        let setup = DopSetup::default();
        let registers = &profile.registers;
        assert_eq!(profile.name, "Simulator");
        assert_eq!(registers.request, Some(setup.request));
        assert_eq!(registers.indicators, Some(setup.indicators));
        assert_eq!(registers.status, Some(setup.status));
        assert_eq!(registers.count, Some(setup.count));
        assert_eq!(registers.response, Some(setup.response));
    }

    fn two() -> Actuators {
        let devices = [("XV-1", 1), ("XV-2", 2)]
            .map(|(tag, unit)| DeviceConfig::simple(tag, Device::Icon3000v2, unit));
        Actuators::new(&devices, Clock::start())
    }

    /// A counter of FC 08.
    fn count(actuators: &Actuators, unit: u8, sub: u8) -> u16 {
        let answer = actuators.answer(unit, &[8, 0, sub, 0, 0]).unwrap();
        u16::from_be_bytes([answer[3], answer[4]])
    }

    /// Sections 8.7.2 and 8.7.5: 11 counts every message on the bus, 14 those for the unit and for all.
    #[test]
    fn messages_are_counted_by_whom_they_are_for() {
        let actuators = two();
        let read = [3, 0x0B, 0xBC, 0, 1];
        for unit in [1, 1, 1, 2, 2] {
            assert!(actuators.answer(unit, &read).is_some());
        }
        assert_eq!(actuators.answer(0, &[6, 0x0B, 0xC9, 0, 12]), None);
        // Three and two for them, one for all; each question counts itself.
        assert_eq!(count(&actuators, 1, 11), 7);
        assert_eq!(count(&actuators, 1, 14), 6);
        assert_eq!(count(&actuators, 2, 11), 9);
        assert_eq!(count(&actuators, 2, 14), 5);
        assert_eq!(count(&actuators, 2, 12), 0);
    }

    /// A frame with a wrong CRC counts under 12; one that is longer than any frame (256 bytes) under 18.
    #[tokio::test(start_paused = true)]
    async fn frames_that_nobody_can_read_are_counted() {
        let actuators = two();
        let (mut near, far) = tokio::io::duplex(4096);
        let served = actuators.clone();
        tokio::spawn(async move { serve_rtu(far, &served, Pace::of(9600)).await });
        let silence = Duration::from_millis(100);
        for (bytes, errors, overruns) in [(300, 0, 1), (10, 1, 1), (256, 2, 1), (257, 2, 2)] {
            near.write_all(&vec![0x55; bytes]).await.unwrap();
            tokio::time::sleep(silence).await;
            for unit in [1, 2] {
                let counted = (count(&actuators, unit, 12), count(&actuators, unit, 18));
                assert_eq!(counted, (errors, overruns), "{bytes} bytes, unit {unit}");
            }
        }
        // The line works on.
        near.write_all(&frame(Framing::Rtu, 0, 1, &[3, 0x0B, 0xBC, 0, 1]))
            .await
            .unwrap();
        let mut answer = [0; 7];
        near.read_exact(&mut answer).await.unwrap();
        assert!(crc_holds(&answer));
    }
}
