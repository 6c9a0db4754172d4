//! A simulated HART loop behind a stream: the bytes come and go at the pace of the line.

use crate::clock::Clock;
use crate::config::DeviceConfig;
use shared::capture::Micros;
use shared::device::Family;
use shared::hart::link::BAUD;
use shared::hart::ne107::Map;
use shared::sim::Programme;
use shared::sim::hart::{Collision, HartDevice, HartLine, HartSetup};
use std::io;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::time::sleep_until;

/// A loop without anything to do is looked at so often, so that its valves move.
const IDLE: Duration = Duration::from_millis(200);

/// A condensed status map for a CMA, of which the manual has no example: byte, bit and category.
const CMA_MAP: [(u8, u8, u8); 5] = [
    // General fault and critical fault: failure.
    (0, 0, 3),
    (1, 1, 3),
    // Over-temperature: out of specification.
    (0, 7, 4),
    // Monitor relay: function check.
    (1, 2, 5),
    // Non-critical fault: maintenance required.
    (3, 7, 1),
];

/// The devices of one loop. Clones are the same loop.
#[derive(Clone, Debug)]
pub struct Loop {
    line: Arc<Mutex<HartLine>>,
    clock: Clock,
}

impl Loop {
    /// A loop with this line.
    #[must_use]
    pub fn new(line: HartLine, clock: Clock) -> Self {
        Self {
            line: Arc::new(Mutex::new(line)),
            clock,
        }
    }

    /// The loop that a configuration names.
    #[must_use]
    pub fn of<'a>(devices: impl IntoIterator<Item = &'a DeviceConfig>, clock: Clock) -> Self {
        let devices = devices.into_iter().zip(0_u32..).filter_map(|(d, count)| {
            let family = d.device.family()?;
            let setup = HartSetup {
                polling: d.unit,
                // Two devices of one kind differ by their id.
                device_id: 0x01_2345 + count,
                programme: Programme::Modulating,
                ..HartSetup::of(family)
            };
            Some(HartDevice::new(&d.tag, setup))
        });
        Self::new(HartLine::new(BAUD, devices.collect()), clock)
    }

    /// Gives some of its devices something to report: a CMA an alarm and a condensed status map that
    /// makes it out of specification, an SI a digital input.
    pub fn spoil(&self) {
        let mut line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        for device in line.devices_mut() {
            match device.setup().family {
                Family::Cma => {
                    for (byte, bit, category) in CMA_MAP {
                        device.set_category(Map::index(byte, bit), category);
                    }
                    device.inject("over_temperature", true);
                }
                Family::Si => {
                    device.inject("digital_input_1", true);
                }
                Family::Cva | Family::Iq | Family::Ck => {}
            }
        }
    }

    /// Whoever sent at the same time as another; party 0 is our end.
    #[must_use]
    pub fn collisions(&self) -> Vec<Collision> {
        let line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        line.collisions().to_vec()
    }

    /// Bytes go in; what came out, and when something happens by itself.
    fn turn(&self, bytes: &[u8]) -> (Vec<u8>, Option<Micros>) {
        let mut line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        let now = self.clock.now();
        line.push(bytes, now);
        let out = line.advance(now);
        (out, line.next_event())
    }
}

/// Answers on a stream until it is closed.
///
/// # Errors
/// If the stream fails.
pub async fn serve<S>(mut stream: S, simulated: &Loop) -> io::Result<()>
where
    S: AsyncRead + AsyncWrite + Unpin,
{
    let mut heard = 0;
    let mut bytes = [0; 512];
    loop {
        let (out, next) = simulated.turn(bytes.get(..heard).unwrap_or(&[]));
        heard = 0;
        if !out.is_empty() {
            stream.write_all(&out).await?;
        }
        let idle = simulated
            .clock
            .now()
            .plus(u64::try_from(IDLE.as_micros()).unwrap_or(0));
        let wake = next.map_or(idle, |next| next.min(idle));
        tokio::select! {
            biased;
            read = stream.read(&mut bytes) => {
                heard = read?;
                if heard == 0 {
                    return Ok(());
                }
            }
            () = sleep_until(simulated.clock.moment(wake)) => {}
        }
    }
}
