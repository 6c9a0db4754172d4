//! Reads values for sentences, wherever they stand.

use super::{Statement, Truth};
use crate::address::{Address, Table};
use crate::icon3000::model::{MIRRORS, Mirror};
use crate::icon3000::say;
use crate::image::Image;
use crate::map::row::{Access, Model, Row, Source};

/// What was read of a device of some model.
pub(super) struct Look<'a> {
    pub model: Model,
    pub image: &'a Image,
}

/// A holding register, or a bit of it.
#[derive(Clone, Copy)]
pub(super) enum On {
    Word(u16),
    Bit(u16, u8),
}

/// What two registers that show one value say.
pub(super) enum Agreed {
    /// This one was read, and the other says the same or was not read; none was read, if it was not.
    Says(u16),
    Differ,
}

impl Look<'_> {
    /// Whether two registers that show one value say the same (reading E44).
    pub fn agreed(&self, two: [u16; 2]) -> Agreed {
        let [first, second] = two;
        match two.map(|register| self.word(register)) {
            [Some(a), Some(b)] if a != b => Agreed::Differ,
            [None, Some(_)] => Agreed::Says(second),
            _ => Agreed::Says(first),
        }
    }

    /// What they say when they differ.
    pub fn differ(&self, what: &str, [first, second]: [u16; 2]) -> String {
        format!(
            "{what} is disputed: HR {first} says {}, HR {second} says {}; the two should agree.",
            self.text(first),
            self.text(second)
        )
    }

    /// Those of two registers that the model has.
    pub fn both(&self, two: [u16; 2]) -> Vec<On> {
        let has = |register: &u16| {
            let row = self
                .model
                .map()
                .row_at(Table::Holding, Address::new(*register));
            row.is_some_and(|row| row.access != Access::Absent)
        };
        two.into_iter().filter(has).map(On::Word).collect()
    }

    /// All places where a value stands that the model has: the holding register, then its copies.
    fn places(&self, on: On) -> impl Iterator<Item = (Table, Address)> {
        let (address, bit) = match on {
            On::Word(address) => (address, None),
            On::Bit(address, bit) => (address, Some(bit)),
        };
        let home = Address::new(address);
        // A copy of the whole word has all its bits.
        let words = copies(home, None);
        let bits = copies(home, bit).filter(move |_| bit.is_some());
        core::iter::once((Table::Holding, home))
            .chain(words.chain(bits).map(|m| (m.table, m.address)))
            .filter(|(table, address)| {
                let row = self.model.map().row_at(*table, *address);
                row.is_some_and(|row| row.access != Access::Absent)
            })
    }

    /// Where a value was read, else where it would have to be read.
    fn place(&self, on: On) -> (Table, Address) {
        let (On::Word(home) | On::Bit(home, _)) = on;
        self.places(on)
            .find(|(table, address)| self.image.cell(*table, *address).is_some())
            .or_else(|| self.places(on).next())
            .unwrap_or((Table::Holding, Address::new(home)))
    }

    /// The same in words: `HR 3019`.
    pub fn place_name(&self, on: On) -> String {
        let (table, address) = self.place(on);
        format!("{} {address}", table.short())
    }

    pub fn word(&self, address: u16) -> Option<u16> {
        let (table, address) = self.place(On::Word(address));
        self.image.cell(table, address).map(|c| c.word)
    }

    pub fn bit(&self, address: u16, bit: u8) -> Option<bool> {
        let (table, address) = self.place(On::Bit(address, bit));
        let word = self.image.cell(table, address)?.word;
        let bit = if table.is_bits() { 0 } else { bit };
        Some(word.wrapping_shr(bit.into()) & 1 != 0)
    }

    /// The value in words, or that it was not read.
    pub fn text(&self, address: u16) -> String {
        let (table, at) = self.place(On::Word(address));
        let row: Option<&'static Row> = self.model.map().row_at(table, at);
        row.and_then(|row| say::row(self.image, row))
            .unwrap_or_else(|| format!("unknown ({} {at} was not read)", table.short()))
    }

    /// A statement that rests on these registers.
    pub fn say(&self, key: &'static str, text: String, on: &[On], source: Source) -> Statement {
        let mut said = Statement {
            key,
            text,
            holds: None,
            registers: Vec::new(),
            from: Vec::new(),
            source,
            inferred: false,
        };
        for on in on {
            let (On::Word(register) | On::Bit(register, _)) = *on;
            if !said.registers.contains(&register) {
                said.registers.push(register);
            }
            let place = self.place_name(*on);
            if !said.from.contains(&place) {
                said.from.push(place);
            }
        }
        said
    }

    pub fn truth(holds: Option<bool>) -> Truth {
        match holds {
            Some(true) => Truth::Yes,
            Some(false) => Truth::No,
            None => Truth::Unknown,
        }
    }
}

/// The copies of a register, or of a bit of it.
fn copies(home: Address, bit: Option<u8>) -> impl Iterator<Item = &'static Mirror> {
    MIRRORS
        .iter()
        .filter(move |m| m.home == home && m.bit == bit)
}
