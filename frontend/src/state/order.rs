//! The order of the register browser: by a column, up or down.

use shared::image::Image;
use shared::map::row::Row;
use shared::scale::Scale;
use shared::value::Value;

use super::sorted::{Columns, Key, places};
use super::values::{Item, cell};

/// A column that the list can be sorted by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Column {
    /// Table and address, the order of the map.
    #[default]
    Address,
    /// The name.
    Name,
    /// The value: numbers by their size, then words, then what was not read.
    Value,
    /// The age of the value, the youngest first; then what was not read.
    Age,
}

impl Columns for Column {
    const ALL: &'static [Self] = &[Self::Address, Self::Name, Self::Value, Self::Age];

    fn key(self) -> &'static str {
        match self {
            Self::Address => "address",
            Self::Name => "name",
            Self::Value => "value",
            Self::Age => "age",
        }
    }
}

impl Column {
    /// The word over the column.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Address => "Address",
            Self::Name => "Name",
            Self::Value => "Value",
            Self::Age => "Age",
        }
    }
}

/// By which column the list is sorted, and which way.
pub type Order = super::sorted::Order<Column>;

impl Order {
    /// True if the order depends on what was read.
    #[must_use]
    pub const fn is_live(self) -> bool {
        matches!(self.column, Column::Value | Column::Age)
    }

    /// Sorts rows that are in the order of the map. Equal ones stay in it, and what was not read
    /// comes last, whichever way.
    pub fn sort(self, rows: &mut Vec<&'static Row>, image: &Image) {
        if self.column == Column::Address {
            if self.down {
                rows.reverse();
            }
            return;
        }
        let keys: Vec<Key> = rows.iter().map(|row| self.key(row, image)).collect();
        let places = places(&keys, self.down);
        *rows = places.into_iter().map(|at| rows[at]).collect();
    }

    fn key(self, row: &'static Row, image: &Image) -> Key {
        match self.column {
            Column::Address => Key::None,
            Column::Name => Key::Text(row.label.to_ascii_lowercase()),
            Column::Value => value(row, image),
            // The youngest has the latest time.
            Column::Age => image
                .row(row)
                .map_or(Key::None, |seen| Key::Count(u64::MAX - seen.at.get())),
        }
    }
}

fn value(row: &'static Row, image: &Image) -> Key {
    let Some(seen) = image.row(row) else {
        return Key::None;
    };
    match seen.judged.value {
        Value::Number { raw, scale } => Key::Number(Scale::to_f64(scale, raw)),
        _ => cell(Item::Row(row), image)
            .map_or(Key::None, |c| Key::Text(c.text.to_ascii_lowercase())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::address::Table;
    use shared::capture::Micros;
    use shared::map::row::Model;

    fn rows() -> Vec<&'static Row> {
        let map = Model::Icon3000v2.map();
        [
            "actuator_status_1",
            "actuator_position",
            "output_torque",
            "cpu_firmware_version",
        ]
        .into_iter()
        .filter_map(|key| map.by_key(Table::Holding, key))
        .collect()
    }

    fn image() -> Image {
        let mut image = Image::new();
        let mut read = |address: u16, word: u16, at: u64| {
            let [a, b] = address.to_be_bytes();
            let [c, d] = word.to_be_bytes();
            image
                .absorb(&[3, a, b, 0, 1], &[3, 2, c, d], Micros::new(at))
                .unwrap();
        };
        read(3001, 0x0001, 30);
        // 45.2 % and -12 %: by size of the value, not of the word.
        read(3004, 452, 20);
        read(3005, 0xFFF4, 10);
        image
    }

    fn sorted(text: &str) -> Vec<u16> {
        let mut all: Vec<&'static Row> = rows();
        Order::parse(text).sort(&mut all, &image());
        all.iter()
            .map(|r| r.address.get())
            .filter(|a| *a < 3006)
            .collect()
    }

    #[test]
    fn rows_are_sorted_by_what_a_column_means() {
        assert_eq!(sorted(""), [3001, 3004, 3005]);
        assert_eq!(sorted("-address"), [3005, 3004, 3001]);
        // Actuator Position, Actuator Status 1, Output Torque.
        assert_eq!(sorted("name"), [3004, 3001, 3005]);
        assert_eq!(sorted("-name"), [3005, 3001, 3004]);
        assert_eq!(sorted("value"), [3005, 3004, 3001], "numbers before words");
        assert_eq!(sorted("-value"), [3001, 3004, 3005]);
        assert_eq!(sorted("age"), [3001, 3004, 3005], "the youngest first");
        assert_eq!(sorted("-age"), [3005, 3004, 3001]);
    }

    #[test]
    fn what_was_not_read_is_last_both_ways() {
        let unread = Model::Icon3000v2
            .map()
            .rows
            .iter()
            .copied()
            .find(|r| r.table == Table::Holding && r.address.get() == 3006);
        for text in ["value", "-value", "age", "-age"] {
            let mut all: Vec<_> = unread.into_iter().chain(rows()).collect();
            Order::parse(text).sort(&mut all, &image());
            assert!(all.last().unwrap().address.get() > 3005, "{text}");
            assert!(all[2].address.get() < 3006, "{text}");
        }
    }

    #[test]
    fn a_column_chosen_twice_turns_round() {
        let order = Order::parse("");
        assert_eq!(order.after("address"), "-address");
        assert_eq!(order.after("name"), "name");
        assert_eq!(Order::parse("name").after("name"), "-name");
        assert_eq!(Order::parse("-name").after("name"), "name");
        assert_eq!(Order::parse("-address").after("address"), "");
        assert_eq!(Order::parse("-name").aria(Column::Name), "descending");
        assert_eq!(Order::parse("-name").aria(Column::Age), "none");
        assert_eq!(Order::parse("-nonsense"), Order::default());
    }
}
