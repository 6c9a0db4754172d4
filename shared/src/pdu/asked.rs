//! What a request asked for, so that its response can be understood.

use crate::address::{Address, Table};

/// A request PDU, read just far enough.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Asked<'a> {
    /// The request PDU, function code first.
    pub pdu: &'a [u8],
}

impl<'a> Asked<'a> {
    /// Wraps a request PDU.
    #[must_use]
    pub const fn new(pdu: &'a [u8]) -> Self {
        Self { pdu }
    }

    /// Function code.
    #[must_use]
    pub fn function(&self) -> u8 {
        self.pdu.first().copied().unwrap_or(0)
    }

    /// The word at `at` bytes from the function code.
    #[must_use]
    pub fn word(&self, at: usize) -> Option<u16> {
        let pair = self.pdu.get(at..)?.first_chunk::<2>()?;
        Some(u16::from_be_bytes(*pair))
    }

    /// For a read (FC 01 to 04, 23): table, first address and quantity.
    #[must_use]
    pub fn read(&self) -> Option<(Table, Address, u16)> {
        let table = match self.function() {
            23 => Table::Holding,
            function => Table::of_read_function(function)?,
        };
        Some((table, Address::new(self.word(1)?), self.word(3)?))
    }
}
