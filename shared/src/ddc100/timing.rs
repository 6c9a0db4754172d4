//! How long exchanges take: on the wire, in the unit, and how long an answer is waited for.

use super::tables::{RESPONSE_TIMES, ResponseTime};
use crate::device::Device;
use crate::encode::Read;
use crate::frame::Framing;

/// What decides how long characters take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Line {
    /// RTU or ASCII.
    pub framing: Framing,
    /// Bits a second; 1200 to 19200 on these networks (table 3.1).
    pub baud: u32,
    /// Bits of a character with start, parity and stop: 10 for 8N1 and 7E1.
    pub bits: u8,
}

impl Line {
    /// That of tables 4.1 and 4.2: RTU, 9600 baud, 8N1.
    pub const GUIDE: Self = Self {
        framing: Framing::Rtu,
        baud: 9600,
        bits: 10,
    };

    /// How long so many characters take, in microseconds; rounded up. A baud rate of 0 counts as 1.
    #[must_use]
    pub fn characters(self, count: u64) -> u64 {
        count
            .saturating_mul(u64::from(self.bits))
            .saturating_mul(1_000_000)
            .div_ceil(u64::from(self.baud.max(1)))
    }

    /// Characters of a frame with a PDU of so many bytes.
    ///
    /// RTU adds address and CRC; ASCII doubles everything and adds colon, LRC and line end.
    #[must_use]
    pub fn frame(self, pdu: usize) -> u64 {
        let pdu = u64::try_from(pdu).unwrap_or(u64::MAX);
        match self.framing {
            Framing::Ascii => pdu.saturating_mul(2).saturating_add(7),
            _ => pdu.saturating_add(3),
        }
    }

    /// The silence that ends a frame: three and a half characters, 1.75 ms above 19,200 baud; none
    /// in ASCII, where the line end does.
    #[must_use]
    pub fn gap(self) -> u64 {
        match self.framing {
            Framing::Ascii => 0,
            _ if self.baud > 19_200 => 1750,
            _ => self.characters(7).div_ceil(2),
        }
    }

    /// Both frames of a read, in microseconds, without any pause.
    #[must_use]
    pub fn exchange(self, read: &Read) -> u64 {
        let query = self.frame(read.pdu().len());
        self.characters(query.saturating_add(self.frame(read.response_len())))
    }

    /// The frame of a good answer, in microseconds.
    #[must_use]
    pub fn answer(self, read: &Read) -> u64 {
        self.characters(self.frame(read.response_len()))
    }
}

/// Least time that an answer is waited for, as the guide wants it (section 4.3, point 4).
pub const LEAST_TIMEOUT_US: u64 = 200_000;

/// How long an answer is waited for, from the end of the request to its last character.
///
/// The guide wants more than 200 ms of every line and every length. That is too short for long
/// answers and slow lines (reading D24): so the answer's own time on the wire is added, and a unit
/// may take twice its average time of table 4.1.
///
/// `base` is what the user set, in microseconds; less than 200 ms counts as 200 ms.
#[must_use]
pub fn timeout(line: Line, kind: Device, read: &Read, base: u64) -> u64 {
    let unit = thinks(kind, items(read)).saturating_mul(2);
    line.answer(read)
        .saturating_add(unit.max(base).max(LEAST_TIMEOUT_US))
}

/// Registers of a read; sixteen bits count as one.
pub(super) fn items(read: &Read) -> u16 {
    if read.table.is_bits() {
        read.count().div_ceil(16)
    } else {
        read.count()
    }
}

/// How long a unit needs between request and answer, in microseconds: table 4.1 without the time
/// of the characters. Between its lines and beyond them along the straight line.
#[must_use]
pub fn thinks(kind: Device, registers: u16) -> u64 {
    let [a, b, c] = &RESPONSE_TIMES;
    let (from, to) = if registers <= b.registers {
        (a, b)
    } else {
        (b, c)
    };
    let alone = |r: &ResponseTime| {
        // A query has 8 characters, an answer 5 and two for each register.
        let wire = u64::from(r.registers).saturating_mul(2).saturating_add(13);
        r.of(kind).saturating_sub(Line::GUIDE.characters(wire))
    };
    let along = u64::from(registers.saturating_sub(from.registers));
    let slope = alone(to).saturating_sub(alone(from));
    let width = u64::from(to.registers.saturating_sub(from.registers));
    let more = slope.saturating_mul(along).checked_div(width).unwrap_or(0);
    alone(from).saturating_add(more)
}
