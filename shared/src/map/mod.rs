//! Register maps: what each address of a device means.
//!
//! The facts are data (`shared/data`); the build turns them into the static tables of this
//! module and stops at the first map that breaks a rule. Nothing is parsed at run time.
//!
//! **Invariant:** the rows of a map cover each of its tables from address 0 without holes or
//! overlaps, so a lookup below the end of a table always finds a row.

pub mod decode;
pub mod export;
mod fields;
pub mod plan;
pub mod row;
pub mod search;
#[cfg(test)]
mod tests;

use crate::address::{Address, Table};
use crate::scale::Scale;
use row::{
    Access, DeviceMap, Function, Kind, Level, Member, Reading, Row, Set, Settled, Source, Trust,
};

pub(crate) use fields::words;

include!(concat!(env!("OUT_DIR"), "/maps.rs"));

impl Model {
    /// The model with this [`key`](Self::key).
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|model| model.key() == key)
    }
}

impl Row {
    /// The address after its last word.
    ///
    /// A `u32`, because a row may end with address 65535.
    #[must_use]
    pub fn end(&self) -> u32 {
        u32::from(self.address.get()).saturating_add(u32::from(self.words))
    }

    /// True if one of its words has this address.
    #[must_use]
    pub fn contains(&self, address: Address) -> bool {
        self.address <= address && u32::from(address.get()) < self.end()
    }
}

impl DeviceMap {
    /// True if the device knows this function code.
    #[must_use]
    pub fn implements(&self, function: u8) -> bool {
        let codes = self.codes.checked_shr(u32::from(function));
        codes.is_some_and(|codes| codes & 1 != 0)
    }

    /// The row that holds an address, `None` beyond the end of the table.
    ///
    /// One binary search over all rows: this runs for every transaction of a capture.
    #[must_use]
    pub fn row_at(&self, table: Table, address: Address) -> Option<&'static Row> {
        let row = *self.rows.get(self.position(table, address)?)?;
        (row.table == table && row.contains(address)).then_some(row)
    }

    /// Position of the last row that begins at or before an address.
    fn position(&self, table: Table, address: Address) -> Option<usize> {
        let wanted = table.index() << 16 | u32::from(address.get());
        self.keys
            .partition_point(|key| *key <= wanted)
            .checked_sub(1)
    }

    /// All rows of a table, by address.
    #[must_use]
    pub fn rows_of(&self, table: Table) -> &'static [&'static Row] {
        let start = self.rows.partition_point(|row| row.table < table);
        let rows = self.rows.get(start..).unwrap_or_default();
        let end = rows.partition_point(|row| row.table == table);
        rows.get(..end).unwrap_or_default()
    }

    /// The rows that have a word in `start .. start + count`, by address.
    ///
    /// The first and the last may reach beyond the range: a request can begin or end in the
    /// middle of a value.
    pub fn rows_in(
        &self,
        table: Table,
        start: Address,
        count: u16,
    ) -> impl Iterator<Item = &'static Row> + use<> {
        self.slice_in(table, start, count).iter().copied()
    }

    /// Like [`rows_in`](Self::rows_in), as a slice.
    fn slice_in(&self, table: Table, start: Address, count: u16) -> &'static [&'static Row] {
        let first = table.index() << 16 | u32::from(start.get());
        let end = first.saturating_add(u32::from(count));
        // The row before may reach into the range, or end before it, or be of another table.
        let before = self
            .keys
            .partition_point(|key| *key <= first)
            .saturating_sub(1);
        let rows = self.rows.get(before..).unwrap_or_default();
        let beyond = self
            .keys
            .get(before..)
            .unwrap_or_default()
            .iter()
            .position(|key| *key >= end)
            .unwrap_or(rows.len());
        let rows = rows.get(..beyond).unwrap_or_default();
        match rows.split_first() {
            Some((row, rest)) if row.table != table || row.end() <= u32::from(start.get()) => rest,
            _ => rows,
        }
    }

    /// The row of a table with this key.
    #[must_use]
    pub fn by_key(&self, table: Table, key: &str) -> Option<&'static Row> {
        self.rows_of(table)
            .iter()
            .copied()
            .find(|row| row.key == key)
    }

    /// The readings that a note mentions.
    pub fn mentioned<'a>(&self, note: &'a str) -> impl Iterator<Item = &'static Reading> + use<'a> {
        let readings = self.readings;
        note.split(|c: char| !c.is_ascii_alphanumeric())
            .filter_map(move |word| readings.iter().find(|reading| reading.id == word))
    }

    /// The reading with this id.
    #[must_use]
    pub fn reading(&self, id: &str) -> Option<&'static Reading> {
        self.readings.iter().find(|reading| reading.id == id)
    }
}
