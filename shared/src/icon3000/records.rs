//! Words of files as they came: sparse, because a file may be read in parts.

use std::collections::BTreeMap;

use super::model::{File, Layout};
use super::plan::{FileRead, Span};

/// Reference type of every group of function 20.
pub(crate) const REFERENCE: u8 = 6;

/// Records that a file can have: 0 to 9999.
pub const RECORDS: u16 = 10_000;

/// The words of one file that were read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Records {
    words: BTreeMap<u16, u16>,
}

impl Records {
    /// A file of which these words are known, from record `start` on.
    #[must_use]
    pub fn of(start: u16, words: impl IntoIterator<Item = u16>) -> Self {
        let mut records = Self::default();
        records.put(start, words);
        records
    }

    /// A file from its bytes, two a record; a last odd byte is left out.
    #[must_use]
    pub fn of_bytes(start: u16, bytes: &[u8]) -> Self {
        let pairs = bytes.chunks_exact(2).filter_map(|p| p.first_chunk::<2>());
        Self::of(start, pairs.map(|p| u16::from_be_bytes(*p)))
    }

    /// Notes words from record `start` on; what would lie beyond the last record is left out.
    pub fn put(&mut self, start: u16, words: impl IntoIterator<Item = u16>) {
        for (record, word) in (start..RECORDS).zip(words) {
            self.words.insert(record, word);
        }
    }

    /// The word of a record, if it was read.
    #[must_use]
    pub fn get(&self, record: u16) -> Option<u16> {
        self.words.get(&record).copied()
    }

    /// `count` words from `start`, if all of them were read.
    #[must_use]
    pub fn run(&self, start: u16, count: u16) -> Option<Vec<u16>> {
        (0..count)
            .map(|at| self.get(start.checked_add(at)?))
            .collect()
    }

    /// Every word with its record, in order.
    pub fn iter(&self) -> impl Iterator<Item = (u16, u16)> {
        self.words.iter().map(|(record, word)| (*record, *word))
    }

    /// The stretches that were read: first record and words.
    #[must_use]
    pub fn stretches(&self) -> Vec<(u16, Vec<u16>)> {
        let mut found: Vec<(u16, Vec<u16>)> = Vec::new();
        for (record, word) in self.iter() {
            match found.last_mut() {
                Some((start, words))
                    if usize::from(record.saturating_sub(*start)) == words.len() =>
                {
                    words.push(word);
                }
                _ => found.push((record, vec![word])),
            }
        }
        found
    }

    /// How many words were read.
    #[must_use]
    pub fn len(&self) -> usize {
        self.words.len()
    }

    /// True if nothing was read.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.words.clear();
    }

    /// Number of entries that record 0 of a log announces; `None` if it is not known or the file is
    /// no log.
    #[must_use]
    pub fn announced(&self, layout: &Layout) -> Option<u16> {
        layout.is_log().then(|| self.get(0)).flatten()
    }

    /// Records that a file should have: those of its layout, for a log as many as record 0
    /// announces, but never more than 10000. `None` if that is not known yet.
    ///
    /// Reading E76: lengths are in bytes, two a record.
    #[must_use]
    pub fn expected(&self, layout: &Layout) -> Option<u16> {
        let entries = if layout.is_log() {
            self.announced(layout)?
        } else {
            0
        };
        let whole = layout.records(entries).min(RECORDS.into());
        u16::try_from(whole).ok()
    }

    /// What is still to be read of this file: first the head, then what the head announces.
    ///
    /// Empty when the file is complete, or if nothing is known about its records.
    #[must_use]
    pub fn missing(&self, number: u16) -> Vec<Span> {
        let Some(layout) = File::of(number).and_then(|f| f.layout) else {
            return Vec::new();
        };
        let end = self.expected(layout).unwrap_or(layout.head_records);
        let mut spans: Vec<Span> = Vec::new();
        for record in (0..end).filter(|r| self.get(*r).is_none()) {
            match spans.last_mut() {
                Some(span) if span.end() == u32::from(record) => {
                    span.count = span.count.saturating_add(1);
                }
                _ => spans.push(Span::new(number, record, 1)),
            }
        }
        spans
    }

    /// True if everything was read that the file should have.
    #[must_use]
    pub fn is_complete(&self, number: u16) -> bool {
        File::of(number)
            .and_then(|f| f.layout)
            .and_then(|layout| self.expected(layout))
            .is_some_and(|end| (0..end).all(|r| self.get(r).is_some()))
    }
}

/// All files of a device that were read, by number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files {
    files: BTreeMap<u16, Records>,
}

impl Files {
    /// The words of a file, if any were read.
    #[must_use]
    pub fn get(&self, number: u16) -> Option<&Records> {
        self.files.get(&number)
    }

    /// The words of a file, to add to.
    pub fn entry(&mut self, number: u16) -> &mut Records {
        self.files.entry(number).or_default()
    }

    /// All files with their numbers, in order.
    pub fn iter(&self) -> impl Iterator<Item = (u16, &Records)> {
        self.files
            .iter()
            .map(|(number, records)| (*number, records))
    }

    /// How many files there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// True if there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    /// Takes in a good answer to function 20. Returns the stretches that it filled; `None`, and
    /// nothing changes, if it is no answer to this request.
    pub fn absorb(&mut self, request: &[u8], response: &[u8]) -> Option<Vec<Span>> {
        let asked = FileRead::of_pdu(request)?;
        let groups = groups(response)?;
        if groups.len() != asked.spans().len() {
            return None;
        }
        let fits = |(span, words): (&Span, &Vec<u16>)| words.len() == usize::from(span.count);
        if !asked.spans().iter().zip(&groups).all(fits) {
            return None;
        }
        for (span, words) in asked.spans().iter().zip(groups) {
            self.entry(span.file).put(span.start, words);
        }
        Some(asked.spans().to_vec())
    }
}

/// The groups of a response PDU of function 20; `None` unless the whole PDU is sound.
///
/// Source: Modbus Application Protocol V1.1b3, section 6.14 (reading E66).
#[must_use]
pub fn groups(response: &[u8]) -> Option<Vec<Vec<u16>>> {
    let (20, [count, data @ ..]) = response.split_first()? else {
        return None;
    };
    if usize::from(*count) != data.len() {
        return None;
    }
    let mut found = Vec::new();
    let mut rest = data;
    while let Some((length, after)) = rest.split_first() {
        let (group, after) = after.split_at_checked(usize::from(*length))?;
        let (reference, words) = group.split_first()?;
        if *reference != REFERENCE || !words.len().is_multiple_of(2) {
            return None;
        }
        let words = words.chunks_exact(2).filter_map(|p| p.first_chunk::<2>());
        found.push(words.map(|p| u16::from_be_bytes(*p)).collect());
        rest = after;
    }
    Some(found)
}
