//! How long things take on a line.

use crate::config::{BusConfig, LineConfig};
use std::time::Duration;

/// Above 19200 baud the silences have fixed lengths.
/// Source: Modbus over Serial Line V1.02, section 2.5.1.1.
const FIXED_ABOVE: u32 = 19_200;
const FIXED_GAP: Duration = Duration::from_micros(1750);

/// A pause within a frame that is still taken for a pause. USB adapters hold bytes back for up to
/// 16 ms, so the 1.5 characters of the standard would cut good frames.
const STALL: Duration = Duration::from_millis(20);
/// The same over a network, where segments come late.
const NETWORK_STALL: Duration = Duration::from_millis(200);
/// Source: Modbus over Serial Line V1.02, section 2.5.2.1: up to one second between characters.
const ASCII_STALL: Duration = Duration::from_secs(1);

/// The simulated line behaves like one of this speed.
pub const SIMULATED_BAUD: u32 = 38_400;

/// The times of one line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Timing {
    /// Time of one character on the wire; zero where nobody knows.
    pub character: Duration,
    /// Silence that ends a frame, and that must stand before each request: 3.5 characters.
    pub gap: Duration,
    /// Silence before a request that the devices ask for; at least [`gap`](Self::gap).
    pub turnaround: Duration,
    /// Silence after which the rest of a frame no longer comes.
    pub stall: Duration,
    /// How long a device may take to begin its answer.
    pub timeout: Duration,
}

impl Timing {
    /// The times of a bus.
    #[must_use]
    pub fn of(bus: &BusConfig) -> Self {
        let (baud, bits, stall) = match &bus.line {
            LineConfig::Serial {
                baud,
                mode,
                framing,
                ..
            } => match framing {
                shared::frame::Framing::Ascii => (*baud, mode.bits(), ASCII_STALL),
                _ => (*baud, mode.bits(), STALL),
            },
            LineConfig::Simulator => (SIMULATED_BAUD, 11, STALL),
            LineConfig::Ddc(ddc) => {
                let stall = match ddc.framing {
                    shared::frame::Framing::Ascii => ASCII_STALL,
                    _ => STALL,
                };
                (ddc.baud, ddc.mode.bits(), stall)
            }
            // A HART line has times of its own.
            LineConfig::Tcp { .. } | LineConfig::RtuOverTcp { .. } | LineConfig::Hart(_) => {
                (0, 0, NETWORK_STALL)
            }
        };
        let gap = gap(baud);
        Self {
            character: character(baud, bits),
            gap,
            turnaround: bus.turnaround.max(gap),
            stall: stall.min(bus.timeout).max(gap),
            timeout: bus.timeout,
        }
    }

    /// Time that so many characters need on the wire.
    #[must_use]
    pub fn characters(&self, count: usize) -> Duration {
        self.character
            .saturating_mul(u32::try_from(count).unwrap_or(u32::MAX))
    }

    /// How long a unit is left alone after a time-out: twice the time that it has to answer, and
    /// twice that if it can't be asked for an echo before it is trusted again.
    #[must_use]
    pub fn quarantine(&self, answer: usize, echo: bool) -> Duration {
        let times = if echo { 2 } else { 4 };
        (self.timeout + self.characters(answer)).saturating_mul(times)
    }
}

/// Time of one character.
fn character(baud: u32, bits: u32) -> Duration {
    match baud {
        0 => Duration::ZERO,
        baud => Duration::from_nanos(u64::from(bits) * 1_000_000_000 / u64::from(baud)),
    }
}

/// The silence of 3.5 characters of eleven bits.
#[must_use]
pub fn gap(baud: u32) -> Duration {
    match baud {
        1..=FIXED_ABOVE => character(baud, 11).saturating_mul(7) / 2,
        _ => FIXED_GAP,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Modbus over Serial Line V1.02, section 2.5.1.1: 3.5 characters of 11 bits; 1.75 ms above
    /// 19200 baud.
    #[test]
    fn gaps_by_hand() {
        assert_eq!(gap(9600).as_micros(), 4010);
        assert_eq!(gap(19_200).as_micros(), 2005);
        assert_eq!(gap(38_400).as_micros(), 1750);
        assert_eq!(gap(600).as_micros(), 64_166);
        assert_eq!(gap(0).as_micros(), 1750);
    }
}
