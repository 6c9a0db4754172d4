//! The only way in which decoders touch bytes: every `take` gives the value *and* its place.

use crate::place::Place;

/// How the payload bytes lie in the frame as received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Layout {
    /// Byte for byte.
    #[default]
    Plain,
    /// Two hexadecimal characters a byte behind one start character (Modbus ASCII).
    HexPairs,
}

impl Layout {
    /// The place of `len` payload bytes from `start` in the frame as received.
    #[must_use]
    pub fn place(self, start: usize, len: usize) -> Place {
        match self {
            Self::Plain => Place::new(start, len),
            Self::HexPairs => Place::new(
                start.saturating_mul(2).saturating_add(1),
                len.saturating_mul(2),
            ),
        }
    }
}

/// A cursor over payload bytes that knows where each of them stands in the frame.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a> {
    bytes: &'a [u8],
    base: usize,
    layout: Layout,
}

impl<'a> Reader<'a> {
    /// Reads `bytes`, the first of which is payload byte `base`.
    #[must_use]
    pub const fn new(bytes: &'a [u8], base: usize, layout: Layout) -> Self {
        Self {
            bytes,
            base,
            layout,
        }
    }

    /// What has not been taken yet.
    #[must_use]
    pub const fn rest(&self) -> &'a [u8] {
        self.bytes
    }

    /// True if nothing is left.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }

    /// Number of bytes left.
    #[must_use]
    pub const fn left(&self) -> usize {
        self.bytes.len()
    }

    /// The place of what is left; empty at the end if nothing is.
    #[must_use]
    pub fn here(&self) -> Place {
        self.layout.place(self.base, self.bytes.len())
    }

    /// The next `len` bytes with their place, or `None` (and nothing taken) if there are fewer.
    pub fn take(&mut self, len: usize) -> Option<(&'a [u8], Place)> {
        let (taken, rest) = self.bytes.split_at_checked(len)?;
        let place = self.layout.place(self.base, len);
        self.base = self.base.saturating_add(len);
        self.bytes = rest;
        Some((taken, place))
    }

    /// A reader over the next `len` bytes, which are taken here.
    pub fn sub(&mut self, len: usize) -> Option<Self> {
        let base = self.base;
        let (bytes, _) = self.take(len)?;
        Some(Self {
            bytes,
            base,
            layout: self.layout,
        })
    }

    /// One byte.
    pub fn u8(&mut self) -> Option<(u8, Place)> {
        let (bytes, place) = self.take(1)?;
        Some((*bytes.first()?, place))
    }

    /// Two bytes, high byte first.
    pub fn u16(&mut self) -> Option<(u16, Place)> {
        let (bytes, place) = self.take(2)?;
        Some((u16::from_be_bytes(bytes.try_into().ok()?), place))
    }

    /// Two bytes, low byte first (the CRC of a Modbus RTU frame).
    pub fn u16_le(&mut self) -> Option<(u16, Place)> {
        let (bytes, place) = self.take(2)?;
        Some((u16::from_le_bytes(bytes.try_into().ok()?), place))
    }

    /// All that is left.
    pub fn take_rest(&mut self) -> (&'a [u8], Place) {
        self.take(self.bytes.len())
            .unwrap_or((&[], Place::default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_follow_the_layout() {
        let mut plain = Reader::new(&[1, 2, 3, 4, 5], 10, Layout::Plain);
        assert_eq!(plain.u16(), Some((0x0102, Place { start: 10, len: 2 })));
        let mut sub = plain.sub(2).unwrap();
        assert_eq!(sub.u8(), Some((3, Place { start: 12, len: 1 })));
        assert_eq!(sub.take(2), None);
        assert_eq!(sub.left(), 1);
        assert_eq!(plain.u8(), Some((5, Place { start: 14, len: 1 })));

        let mut pairs = Reader::new(&[1, 2, 3], 0, Layout::HexPairs);
        assert_eq!(pairs.u8(), Some((1, Place { start: 1, len: 2 })));
        assert_eq!(pairs.u16_le(), Some((0x0302, Place { start: 3, len: 4 })));
        assert!(pairs.is_empty());
    }
}
