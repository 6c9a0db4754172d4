//! Where a field or problem stands, counted in bytes as received from the start of its frame.

/// A run of bytes within one frame. Frames are short, so 16 bits do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Place {
    /// First byte, counted from the start of the frame.
    pub start: u16,
    /// Number of bytes; 0 for something that is missing at `start`.
    pub len: u16,
}

impl Place {
    /// A place of `len` bytes from `start`, cut to what 16 bits can say.
    #[must_use]
    pub fn new(start: usize, len: usize) -> Self {
        Self {
            start: u16::try_from(start).unwrap_or(u16::MAX),
            len: u16::try_from(len).unwrap_or(u16::MAX),
        }
    }

    /// One past the last byte.
    #[must_use]
    pub const fn end(self) -> u16 {
        self.start.saturating_add(self.len)
    }

    /// True if the byte at `offset` belongs to this place.
    #[must_use]
    pub const fn contains(self, offset: u16) -> bool {
        self.start <= offset && offset < self.end()
    }

    /// The same run as a range of indices.
    #[must_use]
    pub fn range(self) -> core::ops::Range<usize> {
        usize::from(self.start)..usize::from(self.end())
    }
}
