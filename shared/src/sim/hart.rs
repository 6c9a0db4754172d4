//! A simulated Rotork actuator with a HART field unit, and the line that it shares with others.
//!
//! [`HartDevice`] is a device of one family, [`HartMaster`] a plain master that obeys the token
//! rules, [`HartBurst`] a bursting neighbour of another make; each is a [`Party`] of a [`Medium`],
//! which carries characters between them at the pace of the line and garbles what collides.
//! [`HartLine`] is a medium with an end outside: what is behind a serial port.
//!
//! All of it is pure: time comes in, and the same times give the same characters. The device
//! encodes its answers from the printed tables by itself and shares no code with the decoder; only
//! the names of status bits, by which faults are injected, come from the tables of the map.
//!
//! # What is the simulator's own
//!
//! The manual (PUB092-003-00) lists commands and status and leaves much open. Choices made here:
//! how fast valve and answers are, that command 48 has 9 bytes and one more while status simulation
//! is on, that a forced mode ends with a reset of the card, which of several response codes a wrong
//! parameter gets, that one More Status Available serves both masters, and that the CK fills no
//! extended device status (readings R11, R13) but can make a partial stroke (R30). Delayed answers
//! (codes 33 to 36) and the relays fitted are chosen in the [`HartSetup`].

mod burst;
mod common;
mod device;
mod line;
mod master;
mod medium;
mod outside;
mod own;
mod prepared;
mod respond;
mod setup;
mod signal;
mod state;
#[cfg(test)]
mod tests;
mod text;
mod universal;
mod valve;
mod wire;

pub use burst::HartBurst;
pub use device::HartDevice;
pub use line::HartLine;
pub use master::{HartMaster, Seen};
pub use medium::{Character, Collision, Medium, Party, Sent};
pub use setup::{CkSwitch, HartLoss, HartSelector, HartSetup};

/// Bits of a character on the line: start, eight of data, odd parity, stop.
const CHARACTER_BITS: u64 = 11;

/// How long so many characters take, in microseconds.
#[must_use]
pub fn characters(count: u64, baud: u32) -> u64 {
    count
        .saturating_mul(CHARACTER_BITS)
        .saturating_mul(1_000_000)
        .checked_div(u64::from(baud.max(1)))
        .unwrap_or(0)
}
