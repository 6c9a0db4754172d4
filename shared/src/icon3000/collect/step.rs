//! One request of a whole read, and what it is about.

use crate::encode::Read;
use crate::icon3000::plan::FileRead;
use crate::icon3000::snapshot::Part;

/// One request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The request PDU.
    pub pdu: Vec<u8>,
    /// Length of a good response PDU.
    pub response_len: usize,
    /// How long to wait before it is sent: the device was busy.
    pub wait_ms: u32,
    /// How often it was sent already.
    pub(super) tries: u8,
    /// What it reads; of several stretches of files, all.
    pub(super) parts: Vec<Part>,
}

impl Step {
    pub(super) fn new(pdu: Vec<u8>, response_len: usize, parts: Vec<Part>) -> Self {
        Self {
            pdu,
            response_len,
            wait_ms: 0,
            tries: 0,
            parts,
        }
    }

    pub(super) fn block(read: Read) -> Self {
        let part = Part::Block(read.table, read.start, read.count());
        Self::new(read.pdu().to_vec(), read.response_len(), vec![part])
    }

    pub(super) fn files(read: &FileRead) -> Self {
        let parts = read.spans().iter().copied().map(Part::File).collect();
        Self::new(read.pdu(), read.response_len(), parts)
    }

    /// What it reads.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What it reads, in words: `Holding register 3000 to 3124`.
    #[must_use]
    pub fn text(&self) -> String {
        match self.parts.as_slice() {
            [] => String::new(),
            [one] => one.to_string(),
            [first, ..] => {
                let more = self.parts.len().saturating_sub(1);
                format!("{first} and {more} more")
            }
        }
    }
}
