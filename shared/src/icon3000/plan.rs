//! Which requests a file takes: several groups in one request where they fit.

use super::model::File;
use super::records::{RECORDS, REFERENCE};

/// Most records in one response with a single group.
///
/// Reading E80: the data length is at most 245, of which length and reference type take two.
pub const MOST_RECORDS: u16 = 121;
/// Most data bytes of a request or response (Modbus Application Protocol V1.1b3, section 6.14).
pub const MOST_DATA: usize = 0xF5;
/// Bytes of a group in a request.
const GROUP: usize = 7;

/// A stretch of records of one file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Span {
    /// Number of the file.
    pub file: u16,
    /// First record.
    pub start: u16,
    /// Number of records.
    pub count: u16,
}

impl Span {
    /// `count` records of `file` from `start`.
    #[must_use]
    pub const fn new(file: u16, start: u16, count: u16) -> Self {
        Self { file, start, count }
    }

    /// The record after the last.
    #[must_use]
    pub fn end(self) -> u32 {
        u32::from(self.start).saturating_add(self.count.into())
    }

    /// Cut where the records of a file must end.
    fn fitted(self) -> Self {
        let left = RECORDS.saturating_sub(self.start);
        Self::new(self.file, self.start, self.count.min(left))
    }

    /// Data bytes in a response.
    fn data(self) -> usize {
        usize::from(self.count).saturating_mul(2).saturating_add(2)
    }

    /// In pieces that fit into one response each, cut where an entry of a log ends.
    fn pieces(self) -> Vec<Self> {
        let layout = File::of(self.file).and_then(|f| f.layout);
        let mut pieces = Vec::new();
        let last = self.end().min(RECORDS.into());
        let mut start = self.start;
        while u32::from(start) < last {
            let left = last.saturating_sub(start.into());
            let mut count = u16::try_from(left).unwrap_or(u16::MAX).min(MOST_RECORDS);
            if u32::from(count) < left
                && let Some(layout) = layout.filter(|l| l.is_log())
            {
                // Records of an entry that would be cut stay for the next piece.
                let end = start
                    .saturating_add(count)
                    .saturating_sub(layout.head_records);
                let cut = end.checked_rem(layout.entry_records).unwrap_or(0);
                if cut < count {
                    count = count.saturating_sub(cut);
                }
            }
            pieces.push(Self::new(self.file, start, count));
            start = start.saturating_add(count);
        }
        pieces
    }
}

/// A request of function 20 that a device may be sent.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FileRead(Vec<Span>);

impl FileRead {
    /// A request for these stretches; `None` if it asks for nothing, for a record beyond 9999, or
    /// for more than one request or response can hold.
    #[must_use]
    pub fn new(spans: Vec<Span>) -> Option<Self> {
        let legal = |s: &Span| s.count > 0 && s.end() <= RECORDS.into();
        let data: usize = spans.iter().map(|s| s.data()).sum();
        let fits = spans.len().saturating_mul(GROUP) <= MOST_DATA && data <= MOST_DATA;
        (!spans.is_empty() && fits && spans.iter().all(legal)).then_some(Self(spans))
    }

    /// Reads a request PDU; `None` if it is none of function 20 or not sound.
    #[must_use]
    pub fn of_pdu(pdu: &[u8]) -> Option<Self> {
        let [20, count, groups @ ..] = pdu else {
            return None;
        };
        if usize::from(*count) != groups.len() || !groups.len().is_multiple_of(GROUP) {
            return None;
        }
        let mut spans = Vec::new();
        for group in groups.chunks_exact(GROUP) {
            let &[REFERENCE, f0, f1, s0, s1, c0, c1] = group else {
                return None;
            };
            let word = |a, b| u16::from_be_bytes([a, b]);
            spans.push(Span::new(word(f0, f1), word(s0, s1), word(c0, c1)));
        }
        Self::new(spans)
    }

    /// The stretches, in order.
    #[must_use]
    pub fn spans(&self) -> &[Span] {
        &self.0
    }

    /// The request PDU.
    #[must_use]
    pub fn pdu(&self) -> Vec<u8> {
        let bytes = self.0.len().saturating_mul(GROUP);
        // `new` has seen to it that they fit.
        let mut pdu = vec![20, u8::try_from(bytes).unwrap_or(u8::MAX)];
        for span in &self.0 {
            pdu.push(REFERENCE);
            for word in [span.file, span.start, span.count] {
                pdu.extend(word.to_be_bytes());
            }
        }
        pdu
    }

    /// Length of a good response PDU.
    #[must_use]
    pub fn response_len(&self) -> usize {
        let data: usize = self.0.iter().map(|s| s.data()).sum();
        data.saturating_add(2)
    }

    /// Number of records asked for.
    #[must_use]
    pub fn records(&self) -> u32 {
        self.0.iter().map(|s| u32::from(s.count)).sum()
    }

    /// One request for each stretch: when a device refuses several at once, it may be one of them.
    #[must_use]
    pub fn split(&self) -> Vec<Self> {
        self.0.iter().map(|s| Self(vec![*s])).collect()
    }
}

/// Plans requests for these stretches, in order: each as full as it may be.
///
/// A stretch of up to 121 records comes from one answer, so that a curve is not put together from
/// two; a longer one is cut where an entry of its log ends.
#[must_use]
pub fn plan(spans: impl IntoIterator<Item = Span>) -> Vec<FileRead> {
    let mut reads = Vec::new();
    let mut open: Vec<Span> = Vec::new();
    for piece in spans.into_iter().flat_map(Span::pieces) {
        open.push(piece);
        if FileRead::new(open.clone()).is_some() {
            continue;
        }
        let last = open.pop();
        reads.extend(FileRead::new(core::mem::take(&mut open)));
        open.extend(last);
    }
    reads.extend(FileRead::new(open));
    reads
}

/// Reads a file of which nothing says how many records it has, as file 5 (reading E69).
///
/// It asks for as much as one answer holds. Too long a stretch is refused with exception 02: then
/// half of it is asked for, down to one record. What is answered is gone on behind, until a single
/// record is refused: there the file ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe(Span);

impl Probe {
    /// A file of which the records before `start` are known already; 0 for a new one.
    #[must_use]
    pub fn new(file: u16, start: u16) -> Self {
        Self(Span::new(file, start, MOST_RECORDS).fitted())
    }

    /// What to ask for; `None` if the end was found.
    #[must_use]
    pub fn next(self) -> Option<Span> {
        (self.0.count > 0).then_some(self.0)
    }

    /// What was asked for was answered.
    pub fn answered(&mut self) {
        let Span { file, start, count } = self.0;
        self.0 = Span::new(file, start.saturating_add(count), count).fitted();
    }

    /// What was asked for was refused with exception 02. Any other failure says nothing of the
    /// length: then the probe is over.
    pub const fn refused(&mut self) {
        self.0.count >>= 1;
    }

    /// Records that are known to be there, all from 0.
    #[must_use]
    pub const fn found(self) -> u16 {
        self.0.start
    }
}
