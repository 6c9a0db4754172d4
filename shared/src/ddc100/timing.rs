//! How long exchanges take: on the wire, in the unit, and how long an answer is waited for.

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
        self.characters(self.frame(read.pdu().len()))
            .saturating_add(self.answer(read))
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

/// Points of table 4.1 without the wire: registers, microseconds.
const MX: [(u16, u64); 3] = [(1, 24_375), (5, 26_042), (10, 27_625)];
const UEC: [(u16, u64); 3] = [(1, 55_375), (5, 85_042), (10, 127_625)];

/// How long a unit needs between request and answer, in microseconds: table 4.1 without the time
/// of the characters. Between its points and beyond them along the straight line. Types that the
/// table does not name count as the slower one of the two.
#[must_use]
pub fn thinks(kind: Device, registers: u16) -> u64 {
    let [a, b, c] = match kind {
        Device::Ddc100Mx | Device::Ddc100MxB => MX,
        _ => UEC,
    };
    let (from, to) = if registers <= b.0 { (a, b) } else { (b, c) };
    let along = u64::from(registers.saturating_sub(from.0));
    let slope = to.1.saturating_sub(from.1);
    let width = u64::from(to.0.saturating_sub(from.0));
    from.1
        .saturating_add(slope.saturating_mul(along).checked_div(width).unwrap_or(0))
}
