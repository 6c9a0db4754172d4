//! Streams to measure with: made here by arithmetic, the same on every machine.

use shared::address::{Address, Table};
use shared::encode::{Read, frame};
use shared::frame::Framing;

/// A stream with its number of messages.
#[derive(Clone, Debug)]
pub struct Load {
    /// The bytes.
    pub bytes: Vec<u8>,
    /// How many frames are in them.
    pub messages: u64,
}

/// Requests only, 36 bytes on average: reads of 8 bytes and writes of 63. Every peer reads these.
#[must_use]
pub fn requests(messages: u64) -> Load {
    let mut bytes = Vec::new();
    for index in 0..messages {
        let unit = 1 + (index % 31) as u8;
        let pdu = if index % 2 == 0 {
            vec![3, 0x0B, 0xB8 + (index % 64) as u8, 0, 10]
        } else {
            let words = (0..27_u16).flat_map(|w| (w.wrapping_mul(977)).to_be_bytes());
            [16, 0, (index % 64) as u8, 0, 27, 54]
                .into_iter()
                .chain(words)
                .collect()
        };
        bytes.extend(frame(Framing::Rtu, 0, unit, &pdu));
    }
    Load { bytes, messages }
}

/// Polls of ICON3000 units as they are on a line, 37 bytes a message on average: requests for the
/// status block, the clock, alarms and texts, and their responses.
#[must_use]
pub fn polls(messages: u64) -> Load {
    const BLOCKS: [(u16, u16); 4] = [(3000, 31), (3023, 4), (3090, 50), (3500, 40)];
    let mut bytes = Vec::new();
    for index in 0..messages / 2 {
        let unit = 1 + (index % 31) as u8;
        let (start, count) = BLOCKS[(index % 4) as usize];
        let read = Read::new(Table::Holding, Address::new(start), count).expect("a legal block");
        bytes.extend(frame(Framing::Rtu, 0, unit, &read.pdu()));
        bytes.extend(frame(Framing::Rtu, 0, unit, &response(start, count, index)));
    }
    Load { bytes, messages }
}

/// A response PDU to a read of holding registers; positions move, digits are BCD.
#[must_use]
pub fn response(start: u16, count: u16, index: u64) -> Vec<u8> {
    let words = (start..start + count).map(|address| match address {
        3004 => (index * 7 % 1001) as u16,
        3023 | 3091.. if address % 5 != 0 && address < 3140 => 0x1110,
        3024 => 0x2026,
        3025 => 0x0017,
        3026 => 0x4239,
        _ => 1,
    });
    let mut pdu = vec![3, (count * 2) as u8];
    pdu.extend(words.flat_map(u16::to_be_bytes));
    pdu
}
