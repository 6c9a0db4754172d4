//! Requests and frames as bytes: for the master, the simulator and the tests.

use crate::address::{Address, Table};
use crate::frame::Framing;
use crate::frame::check::{crc, lrc};
use crate::render::hex;

/// A read that a master may send. There is no way to write one that changes a device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Read {
    /// What to read.
    pub table: Table,
    /// First address.
    pub start: Address,
    /// Quantity, within what the function allows.
    count: u16,
}

impl Read {
    /// A read of `count` items from `start`; `None` if the standard does not allow that many, or
    /// if they go beyond address 65535.
    #[must_use]
    pub fn new(table: Table, start: Address, count: u16) -> Option<Self> {
        let end = u32::from(start.get()).saturating_add(u32::from(count));
        let legal = (1..=table.max_read()).contains(&count) && end <= 65_536;
        legal.then_some(Self {
            table,
            start,
            count,
        })
    }

    /// Number of bits or registers.
    #[must_use]
    pub const fn count(&self) -> u16 {
        self.count
    }

    /// The request PDU.
    #[must_use]
    pub fn pdu(&self) -> [u8; 5] {
        let [s0, s1] = self.start.get().to_be_bytes();
        let [c0, c1] = self.count.to_be_bytes();
        [self.table.read_function(), s0, s1, c0, c1]
    }

    /// Length of a good response PDU.
    #[must_use]
    pub fn response_len(&self) -> usize {
        let data = if self.table.is_bits() {
            usize::from(self.count.div_ceil(8))
        } else {
            usize::from(self.count).saturating_mul(2)
        };
        data.saturating_add(2)
    }
}

/// Wraps a PDU into a frame. `transaction` is used by Modbus TCP only. A HART frame is a request of
/// the primary master to a polling address: the first byte is the command, the rest its data.
#[must_use]
pub fn frame(framing: Framing, transaction: u16, unit: u8, pdu: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(pdu.len().saturating_mul(2).saturating_add(8));
    match framing {
        Framing::Rtu => {
            bytes.push(unit);
            bytes.extend_from_slice(pdu);
            let check = crc(&bytes);
            bytes.extend_from_slice(&check.to_le_bytes());
        }
        Framing::Tcp => {
            let length = u16::try_from(pdu.len().saturating_add(1)).unwrap_or(u16::MAX);
            bytes.extend_from_slice(&transaction.to_be_bytes());
            bytes.extend_from_slice(&[0, 0]);
            bytes.extend_from_slice(&length.to_be_bytes());
            bytes.push(unit);
            bytes.extend_from_slice(pdu);
        }
        Framing::Ascii => {
            let mut payload = vec![unit];
            payload.extend_from_slice(pdu);
            payload.push(lrc(&payload));
            bytes.push(b':');
            bytes.extend_from_slice(hex(&payload).as_bytes());
            bytes.extend_from_slice(b"\r\n");
        }
        #[cfg(feature = "hart")]
        Framing::Hart => {
            use crate::hart::frame::{FILL, PREAMBLE, seal};
            let (command, data) = pdu.split_first().unwrap_or((&0, &[]));
            bytes.resize(*PREAMBLE.start(), FILL);
            bytes.extend(seal(0x02, &[0x80 | unit & 0x3F], *command, data));
        }
        #[cfg(feature = "hart")]
        Framing::HartIp => {
            let (command, data) = pdu.split_first().unwrap_or((&0, &[]));
            let inner = crate::hart::frame::seal(0x02, &[0x80 | unit & 0x3F], *command, data);
            let len = u16::try_from(inner.len().saturating_add(8)).unwrap_or(u16::MAX);
            bytes.extend([1, 0, 3, 0]);
            bytes.extend_from_slice(&transaction.to_be_bytes());
            bytes.extend_from_slice(&len.to_be_bytes());
            bytes.extend(inner);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// DDC-100 Direct-to-Host Programming Guide, section 3.2.3: poll of unit 125.
    #[test]
    fn printed_request() {
        let read = Read::new(Table::Holding, Address::new(7), 3).unwrap();
        let bytes = frame(Framing::Rtu, 0, 0x7D, &read.pdu());
        assert_eq!(hex(&bytes), "7D0300070003BFF6");
        assert_eq!(read.response_len(), 8);
    }

    /// Modbus Messaging on TCP/IP V1.0b, section 4.2: header layout; and the LRC by hand.
    #[test]
    fn other_framings() {
        let pdu = [3, 0, 0, 0, 10];
        assert_eq!(
            hex(&frame(Framing::Tcp, 0x1501, 0xFF, &pdu)),
            "150100000006FF030000000A"
        );
        assert_eq!(frame(Framing::Ascii, 0, 1, &pdu), b":01030000000AF2\r\n");
    }

    #[test]
    fn illegal_reads_do_not_exist() {
        let read = |table, start, count| Read::new(table, Address::new(start), count);
        assert_eq!(read(Table::Holding, 0, 0), None);
        assert_eq!(read(Table::Holding, 0, 126), None);
        assert_eq!(read(Table::Coil, 0, 2001), None);
        assert_eq!(read(Table::Input, 65_535, 2), None);
        assert!(read(Table::Input, 65_535, 1).is_some());
    }
}
