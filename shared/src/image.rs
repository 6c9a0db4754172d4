//! What is known of a device: the last word (or bit) seen at each address, and when.

use std::collections::BTreeMap;

use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::map::decode::{Judged, value};
use crate::map::row::Row;
use crate::pdu::Asked;
use crate::value::{ON_OFF, Quality, Value};

/// One word or bit as last seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The word; 0 or 1 for a bit.
    pub word: u16,
    /// When it was read.
    pub at: Micros,
    /// When it last became another value; `None` if it never did since it was first seen.
    pub changed: Option<Micros>,
    /// Bits that were 0 at some time.
    pub cleared: u16,
}

/// The last words of a device, filled from its answers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    cells: BTreeMap<(Table, u16), Cell>,
}

/// The value of a row with the age of its words.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The value.
    pub judged: Judged,
    /// When its oldest word was read.
    pub at: Micros,
    /// When one of its words last changed, if one ever did.
    pub changed: Option<Micros>,
}

impl Image {
    /// An image of a device of which nothing is known.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in a good answer to a read (FC 01 to 04). Returns the table and range that it filled;
    /// `None` if it is no such answer or not as long as was asked.
    pub fn absorb(
        &mut self,
        request: &[u8],
        response: &[u8],
        at: Micros,
    ) -> Option<(Table, Address, u16)> {
        let asked = Asked::new(request);
        let (table, start, count) = asked.read()?;
        let (function, count_byte, data) = match response {
            [function, count, data @ ..] => (*function, usize::from(*count), data),
            _ => return None,
        };
        let want = if table.is_bits() {
            usize::from(count.div_ceil(8))
        } else {
            usize::from(count).checked_mul(2)?
        };
        if function != asked.function() || count_byte != want || data.len() != want {
            return None;
        }
        for index in 0..count {
            let word = if table.is_bits() {
                let byte = data.get(usize::from(index >> 3))?;
                u16::from(byte.wrapping_shr(u32::from(index & 7)) & 1)
            } else {
                let from = usize::from(index).checked_mul(2)?;
                u16::from_be_bytes(*data.get(from..)?.first_chunk::<2>()?)
            };
            self.set(table, start.checked_add(index)?, word, at);
        }
        Some((table, start, count))
    }

    /// Every word and bit with its place, by table and address.
    pub fn iter(&self) -> impl Iterator<Item = (Table, Address, &Cell)> {
        self.cells
            .iter()
            .map(|((table, address), cell)| (*table, Address::new(*address), cell))
    }

    /// Notes a word or bit.
    pub fn set(&mut self, table: Table, address: Address, word: u16, at: Micros) {
        let cell = self.cells.entry((table, address.get())).or_insert(Cell {
            word,
            at,
            changed: None,
            cleared: 0,
        });
        if cell.word != word {
            cell.changed = Some(at);
        }
        cell.word = word;
        cell.cleared |= !word;
        cell.at = at;
    }

    /// The word or bit at an address, if it was ever read.
    #[must_use]
    pub fn cell(&self, table: Table, address: Address) -> Option<&Cell> {
        self.cells.get(&(table, address.get()))
    }

    /// The bytes of a row, if all its words were read. At most 128, for a torque curve.
    #[must_use]
    pub fn bytes(&self, row: &Row) -> Option<Vec<u8>> {
        let mut bytes = Vec::with_capacity(usize::from(row.words).saturating_mul(2));
        for index in 0..row.words {
            let cell = self.cell(row.table, row.address.checked_add(index)?)?;
            bytes.extend_from_slice(&cell.word.to_be_bytes());
        }
        Some(bytes)
    }

    /// The value of a row, if all its words were read.
    #[must_use]
    pub fn row(&self, row: &'static Row) -> Option<Seen> {
        let mut at = Micros::new(u64::MAX);
        let mut changed = None;
        for index in 0..row.words {
            let cell = self.cell(row.table, row.address.checked_add(index)?)?;
            at = at.min(cell.at);
            changed = changed.max(cell.changed);
        }
        let bytes = self.bytes(row)?;
        let judged = if row.table.is_bits() {
            let value = Value::Bit {
                on: bytes != [0, 0],
                words: &ON_OFF,
            };
            Judged {
                value,
                quality: Quality::Good,
            }
        } else {
            value(row, &bytes)
        };
        Some(Seen {
            judged,
            at,
            changed,
        })
    }

    /// Number of words and bits known.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    /// True if nothing is known.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::row::Model;

    fn row(address: u16) -> &'static Row {
        let map = Model::Icon3000v2.map();
        map.row_at(Table::Holding, Address::new(address)).unwrap()
    }

    #[test]
    fn answers_fill_the_image() {
        let mut image = Image::new();
        let request = [3, 0x0B, 0xBC, 0, 2];
        let filled = image.absorb(&request, &[3, 4, 0, 0xF0, 0xFF, 0xF4], Micros::new(5));
        assert_eq!(filled, Some((Table::Holding, Address::new(3004), 2)));
        let seen = image.row(row(3004)).unwrap();
        assert_eq!(seen.judged.value.to_string(), "24.0");
        assert_eq!(
            (seen.at, seen.changed),
            (Micros::new(5), None),
            "a first sight is no change"
        );

        image.absorb(&request, &[3, 4, 0, 0xF1, 0xFF, 0xF4], Micros::new(9));
        assert_eq!(image.row(row(3004)).unwrap().changed, Some(Micros::new(9)));
        assert_eq!(image.row(row(3005)).unwrap().changed, None);
        // 0x00F0 and 0x00F1: bit 0 was 0 once, bits 4 to 7 never were.
        let cell = image.cell(Table::Holding, Address::new(3004)).unwrap();
        assert_eq!(cell.cleared & 0x00FF, 0x000F);
    }

    #[test]
    fn what_is_no_answer_changes_nothing() {
        let mut image = Image::new();
        let request = [3, 0x0B, 0xBC, 0, 2];
        for response in [
            &[0x83, 2][..],
            &[3, 2, 0, 1],
            &[4, 4, 0, 1, 0, 2],
            &[3, 4, 0, 1],
            &[],
        ] {
            assert_eq!(image.absorb(&request, response, Micros::new(1)), None);
        }
        assert!(image.is_empty());
    }

    /// A value is there when all its words are, and as old as the oldest of them.
    #[test]
    fn values_join_from_several_answers() {
        let mut image = Image::new();
        image.absorb(&[3, 0x0C, 0x4B, 0, 1], &[3, 2, 0, 1], Micros::new(3));
        assert_eq!(image.row(row(3147)), None);
        image.absorb(&[3, 0x0C, 0x4C, 0, 1], &[3, 2, 0, 2], Micros::new(8));
        let seen = image.row(row(3147)).unwrap();
        assert_eq!(seen.judged.value.to_string(), "65538");
        assert_eq!(seen.at, Micros::new(3));
    }

    #[test]
    fn bits_are_unpacked() {
        let mut image = Image::new();
        image.absorb(
            &[2, 0, 8, 0, 10],
            &[2, 2, 0b0000_0101, 0b10],
            Micros::new(1),
        );
        let on = |a| image.cell(Table::Discrete, Address::new(a)).map(|c| c.word);
        assert_eq!(
            [8, 9, 10, 17, 18].map(on),
            [Some(1), Some(0), Some(1), Some(1), None]
        );
    }
}
