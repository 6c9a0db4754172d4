//! Lists that are sorted by a column, up or down: the setting in the address bar, and the order of
//! what is known and what is not.

use core::cmp::Ordering;

/// Columns that a list can be sorted by. The default one stands in no address.
pub trait Columns: Copy + Default + PartialEq + 'static {
    /// All columns.
    const ALL: &'static [Self];

    /// The word in the address bar.
    fn key(self) -> &'static str;
}

/// By which column a list is sorted, and which way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Order<C> {
    /// The column.
    pub column: C,
    /// True for the largest first.
    pub down: bool,
}

impl<C: Columns> Order<C> {
    /// Reads the setting of the address bar: `name`, `-name`; anything else is the default.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let key = text.strip_prefix('-');
        let mut all = C::ALL.iter();
        let found = all.find(|c| c.key() == key.unwrap_or(text)).copied();
        Self {
            column: found.unwrap_or_default(),
            down: key.is_some() && found.is_some(),
        }
    }

    /// The setting after a column was chosen: its order, or the other way round if it has it.
    #[must_use]
    pub fn after(self, chosen: &str) -> String {
        Self::setting(chosen, self.column.key() == chosen && !self.down)
    }

    /// The setting for a column and a way.
    #[must_use]
    pub fn setting(chosen: &str, down: bool) -> String {
        match (down, chosen == C::default().key()) {
            (true, _) => format!("-{chosen}"),
            (false, true) => String::new(),
            (false, false) => chosen.to_owned(),
        }
    }

    /// How a column is sorted, as ARIA says it.
    #[must_use]
    pub fn aria(self, column: C) -> &'static str {
        match (self.column == column, self.down) {
            (false, _) => "none",
            (true, false) => "ascending",
            (true, true) => "descending",
        }
    }
}

/// What something is sorted by: numbers before words, and what is not known last, whichever way.
#[derive(Clone, Debug, PartialEq)]
pub enum Key {
    /// A value.
    Number(f64),
    /// A count or a time.
    Count(u64),
    /// Words.
    Text(String),
    /// Not known.
    None,
}

impl Key {
    const fn rank(&self) -> u8 {
        match self {
            Self::Number(_) | Self::Count(_) => 0,
            Self::Text(_) => 1,
            Self::None => 2,
        }
    }

    /// The order of two, `down` for the largest first.
    #[must_use]
    pub fn compare(&self, other: &Self, down: bool) -> Ordering {
        let order = match (self, other) {
            (Self::None, _) | (_, Self::None) => return self.rank().cmp(&other.rank()),
            (Self::Number(a), Self::Number(b)) => a.total_cmp(b),
            (Self::Count(a), Self::Count(b)) => a.cmp(b),
            (Self::Text(a), Self::Text(b)) => a.cmp(b),
            _ => self.rank().cmp(&other.rank()),
        };
        if down { order.reverse() } else { order }
    }
}

/// The places of keys in their order; equal ones stay as they are. Of a few thousand only places
/// move; the sorts of the standard library are several kilobytes for each type.
#[must_use]
pub fn places(keys: &[Key], down: bool) -> Vec<usize> {
    let mut places: Vec<usize> = Vec::with_capacity(keys.len());
    for (at, key) in keys.iter().enumerate() {
        let place = places.partition_point(|other| keys[*other].compare(key, down).is_le());
        places.insert(place, at);
    }
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_last_both_ways() {
        let keys = [
            Key::None,
            Key::Text("b".into()),
            Key::Count(7),
            Key::Text("a".into()),
            Key::None,
        ];
        assert_eq!(places(&keys, false), [2, 3, 1, 0, 4]);
        assert_eq!(places(&keys, true), [1, 3, 2, 0, 4]);
    }
}
