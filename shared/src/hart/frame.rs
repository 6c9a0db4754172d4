//! The parts of a HART frame, from the delimiter on.

use core::fmt;

/// Bytes of a preamble that a sender must send, and may send.
pub const PREAMBLE: core::ops::RangeInclusive<usize> = 5..=20;
/// Expanded device type of Rotork actuators: manufacturer 6Eh, device type DDh.
pub const ROTORK: u16 = 0x6EDD;
/// Bytes of a preamble that a receiver needs.
pub const SYNC: usize = 2;
/// The byte of a preamble.
pub const FILL: u8 = 0xFF;
/// Preamble bytes that are counted to a frame; what stands before them is noise.
pub(crate) const MOST_FILL: usize = 64;
/// Longest frame without preamble: delimiter, address, expansion, command, count, data, check.
pub(crate) const LONGEST: usize = 1 + 5 + 3 + 1 + 1 + 255 + 1;
/// Delimiters that are met on a line: reply, request and burst with long and short address.
pub(crate) const DELIMITERS: [u8; 6] = [0x86, 0x82, 0x81, 0x06, 0x02, 0x01];

/// Who sends a frame of this type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Type {
    /// A device, unasked (burst).
    Back,
    /// A master.
    Stx,
    /// A device that was asked.
    Ack,
}

/// The first byte after the preamble.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Delimiter(u8);

impl Delimiter {
    /// A delimiter; `None` if the standard defines no such frame type or physical layer.
    #[must_use]
    pub const fn new(byte: u8) -> Option<Self> {
        match (byte & 0x07, byte & 0x18) {
            (1 | 2 | 6, 0x00 | 0x08) => Some(Self(byte)),
            _ => None,
        }
    }

    /// The byte itself.
    #[must_use]
    pub const fn get(self) -> u8 {
        self.0
    }

    /// Who sends it.
    #[must_use]
    pub const fn kind(self) -> Type {
        match self.0 & 0x07 {
            1 => Type::Back,
            2 => Type::Stx,
            _ => Type::Ack,
        }
    }

    /// True for a unique address of five bytes.
    #[must_use]
    pub const fn is_long(self) -> bool {
        self.0 & 0x80 != 0
    }

    /// Number of expansion bytes.
    #[must_use]
    pub const fn expansion(self) -> u8 {
        self.0 >> 5 & 0x03
    }

    /// True for the synchronous physical layer (C8PSK).
    #[must_use]
    pub const fn is_synchronous(self) -> bool {
        self.0 & 0x08 != 0
    }

    fn address_len(self) -> usize {
        if self.is_long() { 5 } else { 1 }
    }
}

impl fmt::Display for Delimiter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self.kind() {
            Type::Back => "BACK, burst of a device",
            Type::Stx => "STX, request of a master",
            Type::Ack => "ACK, reply of a device",
        })?;
        f.write_str(if self.is_long() {
            ", long address"
        } else {
            ", short address"
        })?;
        if self.is_synchronous() {
            f.write_str(", synchronous")?;
        }
        match self.expansion() {
            0 => Ok(()),
            1 => f.write_str(", 1 expansion byte"),
            n => write!(f, ", {n} expansion bytes"),
        }
    }
}

/// Who is meant or speaks, without master and burst bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Address {
    /// Polling address, 0 to 63.
    Short(u8),
    /// Low 14 bits of the device type, and device id.
    Long(u16, u32),
}

impl Address {
    /// Whom everybody hears: all bits 0.
    pub const BROADCAST: Self = Self::Long(0, 0);
}

impl fmt::Display for Address {
    /// Hexadecimal digits: two, or ten.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short(polling) => write!(f, "{polling:02X}"),
            Self::Long(kind, id) => write!(f, "{kind:04X}{id:06X}"),
        }
    }
}

/// A frame from delimiter to check byte, as far as it is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head {
    /// The first byte.
    pub delimiter: Delimiter,
    /// Who is meant or speaks.
    pub address: Address,
    /// True if the primary master is the one that asks or is answered.
    pub primary: bool,
    /// True if the device is in burst mode.
    pub burst: bool,
    /// The command byte.
    pub command: u8,
    /// Bytes of status and data, as the frame says.
    pub count: u8,
    /// Where status and data begin.
    pub data: usize,
}

impl Head {
    /// The head of a frame that begins with a delimiter; `None` if it is cut or is none.
    #[must_use]
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let (first, rest) = bytes.split_first()?;
        Self::after(Delimiter::new(*first)?, rest, 1)
    }

    /// The head of a frame whose delimiter is known; `rest` follows it, and it took `skip` bytes.
    pub(crate) fn after(delimiter: Delimiter, rest: &[u8], skip: usize) -> Option<Self> {
        let (address, tail) = rest.split_at_checked(delimiter.address_len())?;
        let first = *address.first()?;
        let found = match *address {
            [_, kind, a, b, c] => Address::Long(
                u16::from_be_bytes([first & 0x3F, kind]),
                u32::from_be_bytes([0, a, b, c]),
            ),
            _ => Address::Short(first & 0x3F),
        };
        let expansion = usize::from(delimiter.expansion());
        let &[command, count] = tail.get(expansion..)?.first_chunk::<2>()?;
        Some(Self {
            delimiter,
            address: found,
            primary: first & 0x80 != 0,
            burst: first & 0x40 != 0,
            command,
            count,
            data: skip
                .saturating_add(delimiter.address_len())
                .saturating_add(expansion)
                .saturating_add(2),
        })
    }

    /// Length of the frame without preamble, check byte included.
    #[must_use]
    pub fn total(&self) -> usize {
        self.data
            .saturating_add(usize::from(self.count))
            .saturating_add(1)
    }

    /// Bytes of status in front of the data: two of a device, none of a master.
    #[must_use]
    pub const fn status_len(&self) -> u8 {
        match self.delimiter.kind() {
            Type::Stx => 0,
            Type::Back | Type::Ack => 2,
        }
    }

    /// False if the count has no room for what every such frame has.
    #[must_use]
    pub const fn is_possible(&self) -> bool {
        self.count >= self.status_len()
    }
}

/// The check byte over these bytes: all of them combined by exclusive or.
#[must_use]
pub fn check(bytes: &[u8]) -> u8 {
    bytes.iter().fold(0, |sum, byte| sum ^ byte)
}

/// Number of preamble bytes at the start.
#[must_use]
pub fn preamble(bytes: &[u8]) -> usize {
    bytes.iter().take_while(|b| **b == FILL).count()
}

/// The command that travels in command 31, if its number is there.
#[must_use]
pub fn extended(head: &Head, frame: &[u8]) -> Option<u16> {
    let from = head.data.saturating_add(usize::from(head.status_len()));
    let end = head.data.saturating_add(usize::from(head.count));
    let number = frame.get(from..end)?.first_chunk::<2>()?;
    (head.command == 31).then(|| u16::from_be_bytes(*number))
}

/// The long address of a device as a master of this kind sends it.
#[must_use]
pub fn long_address(expanded_type: u16, id: u32, primary: bool) -> [u8; 5] {
    let [high, low] = expanded_type.to_be_bytes();
    let [_, a, b, c] = id.to_be_bytes();
    let master = if primary { 0x80 } else { 0 };
    [high & 0x3F | master, low, a, b, c]
}

/// A frame without preamble; data beyond 255 bytes are left out.
#[must_use]
pub fn seal(delimiter: u8, address: &[u8], command: u8, data: &[u8]) -> Vec<u8> {
    let data = data.get(..255).unwrap_or(data);
    let mut frame = vec![delimiter];
    frame.extend_from_slice(address);
    frame.extend([command, u8::try_from(data.len()).unwrap_or(u8::MAX)]);
    frame.extend_from_slice(data);
    frame.push(check(&frame));
    frame
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_delimiter_says_what_follows() {
        let request = Delimiter::new(0x82).unwrap();
        assert_eq!((request.kind(), request.is_long()), (Type::Stx, true));
        let reply = Delimiter::new(0x26).unwrap();
        assert_eq!((reply.kind(), reply.expansion()), (Type::Ack, 1));
        assert!(Delimiter::new(0x0E).unwrap().is_synchronous());
        for none in [0x00, 0x03, 0x04, 0x05, 0x07, 0x12, 0x1A, 0xFF] {
            assert_eq!(Delimiter::new(none), None, "{none:02X}");
        }
    }

    #[test]
    fn six_bits_of_the_type_go_into_the_address() {
        // Reading G12: 6EDDh becomes AE DD and 2E DD, not EE DD.
        assert_eq!(
            long_address(0x6EDD, 0x01_2345, true),
            [0xAE, 0xDD, 0x01, 0x23, 0x45]
        );
        assert_eq!(
            long_address(0x6EDD, 0x01_2345, false),
            [0x2E, 0xDD, 0x01, 0x23, 0x45]
        );
    }

    #[test]
    fn a_head_knows_its_frame() {
        let frame = [0x82, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x03, 0x00, 0x95];
        let head = Head::of(&frame).unwrap();
        assert_eq!(head.address.to_string(), "2EDD012345");
        assert!(head.primary && !head.burst);
        assert_eq!((head.command, head.total()), (3, frame.len()));
        assert_eq!(check(&frame), 0);
        assert_eq!(seal(0x82, &frame[1..6], 3, &[]), frame);
        assert_eq!(Head::of(&frame[..7]), None, "the count is missing");
    }
}
