//! Communication: the counters of function 08 and those in the registers of both channels.
//!
//! Source: VCIOM-16345-EN, table 19 and section 8.7; registers 3531 to 3542 of table 5.

use crate::address::{Address, Table};
use crate::image::Image;
use crate::map::row::Source;

/// A counter of the diagnostics.
#[derive(Debug, PartialEq, Eq)]
pub struct Counter {
    /// Sub-function of function 08.
    pub sub: u16,
    /// What people read.
    pub label: &'static str,
    /// What it counts, in our words.
    pub meaning: &'static str,
    /// Registers of channel 1 and 2 that hold the same (reading E60: inferred from their names).
    pub registers: [u16; 2],
    /// True if a healthy line leaves it at 0.
    pub is_error: bool,
    /// The reading that it rests on, empty if none.
    pub reading: &'static str,
}

/// Where the counters are described.
pub const SOURCE: Source = Source {
    doc: "VCIOM-16345-EN",
    part: "section 8.7, table 19",
};

/// All counters, by sub-function.
pub static NAMES: [Counter; 6] = [
    Counter {
        sub: 11,
        label: "Bus messages",
        meaning: "messages seen on the line, whoever they were for",
        registers: [3531, 3537],
        is_error: false,
        reading: "E60",
    },
    Counter {
        sub: 12,
        label: "Communication errors",
        meaning: "messages with a wrong CRC",
        registers: [3533, 3539],
        is_error: true,
        reading: "E59",
    },
    Counter {
        sub: 13,
        label: "Exception responses",
        meaning: "requests that this device refused with an exception",
        registers: [3534, 3540],
        is_error: true,
        reading: "E60",
    },
    Counter {
        sub: 14,
        label: "Messages for this device",
        meaning: "messages that were for this device or for all, and carried out",
        registers: [3532, 3538],
        is_error: false,
        reading: "E60",
    },
    Counter {
        sub: 17,
        label: "Busy responses",
        meaning: "requests that were answered with server device busy",
        registers: [3535, 3541],
        is_error: true,
        reading: "E60",
    },
    Counter {
        sub: 18,
        label: "Character overruns",
        meaning: "messages lost because characters came faster than they were taken",
        registers: [3536, 3542],
        is_error: true,
        reading: "E60",
    },
];

/// The request for a counter; only sub-functions that read have one.
#[must_use]
pub fn request(sub: u16) -> Option<[u8; 5]> {
    let known = NAMES.iter().any(|c| c.sub == sub);
    let [high, low] = sub.to_be_bytes();
    known.then_some([8, high, low, 0, 0])
}

/// A counter as the registers of one channel hold it.
#[must_use]
pub fn of_channel(image: &Image, counter: &Counter, channel: usize) -> Option<u16> {
    let address = *counter.registers.get(channel)?;
    let cell = image.cell(Table::Holding, Address::new(address))?;
    Some(cell.word)
}

/// How far a counter went between two reads; counters go round at 65536.
#[must_use]
pub const fn since(before: u16, now: u16) -> u16 {
    now.wrapping_sub(before)
}

/// Errors in thousandths of a percent of the messages between two reads; `None` without messages.
#[must_use]
pub fn rate(errors: u16, messages: u16) -> Option<u32> {
    u32::from(errors)
        .saturating_mul(100_000)
        .checked_div(messages.into())
}
