//! Finding rows of a map: by words, by address, by register number.
//!
//! The query is parsed once and then asked about every row, so that a browser can filter a map
//! while somebody types.

use super::row::{Access, DeviceMap, Kind, Level, Row};
use crate::address::{Address, RegisterNumber, Table};

/// What a user typed, taken apart. All words must match.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Query {
    words: Vec<Word>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
struct Word {
    text: String,
    place: Option<Place>,
}

/// Where a word that is a number may point to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// An address in any table: `3004`, `0x0BBC`.
    Address(Address),
    /// A register number: `403005`, `43005`.
    Number(Table, Address),
}

impl Query {
    /// Takes a query apart at blanks.
    ///
    /// Up to four digits and hexadecimal with `0x` are an address, five or six digits a register
    /// number. Everything else, numbers included, is looked for in the texts.
    #[must_use]
    pub fn parse(query: &str) -> Self {
        let words = query.split_whitespace();
        let words = words.map(|word| Word {
            text: word.to_owned(),
            place: place(word),
        });
        Self {
            words: words.collect(),
        }
    }

    /// True if there is nothing to look for.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.is_empty()
    }

    /// True if every word is found in the row. An empty query matches all rows.
    #[must_use]
    pub fn matches(&self, row: &Row) -> bool {
        self.words.iter().all(|word| word.matches(row))
    }
}

fn place(word: &str) -> Option<Place> {
    if let Some(hex) = word.strip_prefix("0x").or(word.strip_prefix("0X")) {
        let address = u16::from_str_radix(hex, 16).ok()?;
        return Some(Place::Address(Address::new(address)));
    }
    if !word.bytes().all(|b| b.is_ascii_digit()) {
        return None;
    }
    if word.len() > 4 {
        let (table, address) = RegisterNumber::new(word.parse().ok()?).resolve()?;
        return Some(Place::Number(table, address));
    }
    Some(Place::Address(Address::new(word.parse().ok()?)))
}

impl Word {
    fn matches(&self, row: &Row) -> bool {
        match self.place {
            Some(Place::Address(address)) if row.contains(address) => true,
            Some(Place::Number(table, address)) if row.table == table && row.contains(address) => {
                true
            }
            // A number inside a longer one says nothing: "4" is no hit for "4095".
            Some(_) => texts(row).any(|text| has_word(text, &self.text)),
            None => texts(row).any(|text| contains(text, &self.text)),
        }
    }
}

/// The texts in which words are looked for.
fn texts(row: &Row) -> impl Iterator<Item = &'static str> {
    let members = row.set.map_or(&[][..], |set| set.members);
    [row.label, row.key, row.group, row.unit]
        .into_iter()
        .chain(members.iter().map(|member| member.label))
}

/// True if `text` contains `part`, whatever the case of ASCII letters. Allocates nothing.
fn contains(text: &str, part: &str) -> bool {
    let (text, part) = (text.as_bytes(), part.as_bytes());
    // `windows` must not be asked for empty ones.
    !part.is_empty()
        && text
            .windows(part.len())
            .any(|window| window.eq_ignore_ascii_case(part))
}

/// True if `word` stands in `text` between other characters than letters and digits.
fn has_word(text: &str, word: &str) -> bool {
    text.split(|c: char| !c.is_ascii_alphanumeric())
        .any(|part| part.eq_ignore_ascii_case(word))
}

/// Which rows by who may write them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Writes {
    /// Read-only rows.
    No,
    /// All that can be written.
    Any,
    /// Those whose write moves or reconfigures equipment.
    Guarded,
}

impl Writes {
    fn matches(self, access: Access) -> bool {
        match self {
            Self::No => access == Access::Read,
            Self::Any => access == Access::Write || access.is_guarded(),
            Self::Guarded => access.is_guarded(),
        }
    }
}

/// What a list of rows is narrowed to. The default lets every row pass.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// Words and numbers.
    pub query: Query,
    /// Only this table.
    pub table: Option<Table>,
    /// Only this group, by its exact name.
    pub group: Option<String>,
    /// Only rows that can or cannot be written.
    pub access: Option<Writes>,
    /// Only rows with this user level.
    pub level: Option<Level>,
    /// Leave out reserved, spare and absent rows.
    pub hide_reserved: bool,
}

impl Filter {
    /// True if the row passes.
    #[must_use]
    pub fn matches(&self, row: &Row) -> bool {
        self.table.is_none_or(|table| table == row.table)
            && !(self.hide_reserved && row.kind == Kind::Reserved)
            && self.access.is_none_or(|access| access.matches(row.access))
            && self.level.is_none_or(|level| row.level == Some(level))
            && self.group.as_ref().is_none_or(|group| group == row.group)
            && self.query.matches(row)
    }

    /// The rows of a map that pass, in the order of the map.
    pub fn rows<'a>(
        &'a self,
        map: &'static DeviceMap,
    ) -> impl Iterator<Item = &'static Row> + use<'a> {
        map.rows.iter().copied().filter(|row| self.matches(row))
    }
}

/// The groups of a map, by name.
#[must_use]
pub fn groups(map: &DeviceMap) -> Vec<&'static str> {
    let mut groups: Vec<&'static str> = Vec::new();
    for row in map.rows {
        if let Err(place) = groups.binary_search(&row.group) {
            groups.insert(place, row.group);
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::row::Model;

    /// Keys of the rows that a query finds in the map of the ICON3000v2.
    fn found(query: &str) -> Vec<&'static str> {
        let filter = Filter {
            query: Query::parse(query),
            ..Filter::default()
        };
        filter
            .rows(Model::Icon3000v2.map())
            .map(|row| row.key)
            .collect()
    }

    #[test]
    fn a_place_is_found_in_every_notation() {
        for query in ["403005", "43005", "0x0BBC", "0xbbc", "3004"] {
            assert_eq!(found(query), ["actuator_position"], "{query}");
        }
        assert_eq!(found("300001"), ["actuator_position"]);
        assert_eq!(found("000001"), ["open_command"]);
        assert_eq!(found("405000"), [""; 0]);
    }

    #[test]
    fn an_address_is_found_inside_a_longer_value() {
        assert_eq!(found("3050"), ["actuator_serial_number"]);
        assert_eq!(found("413"), ["reserved_46"]);
        assert_eq!(
            found("0"),
            [
                "open_command",
                "close_limit",
                "actuator_position",
                "legacy_actuator_commands",
                "encoder_limit_0_value",
                "torque_sensor_i24_speed_opening_0_plus_5",
                "torque_sensor_i24_speed_closing_0_plus_5",
                "byte_free_0",
                "bit_free_0",
                "word_free_0",
            ]
        );
    }

    #[test]
    fn words_are_looked_for_in_label_group_unit_and_members() {
        assert_eq!(found("motor rating"), ["motor_rating"]);
        assert_eq!(found("MOTOR KW"), ["motor_rating"]);
        assert_eq!(found("romanian"), ["local_display_language"]);
        assert_eq!(found("bluetooth").len(), 2);
        assert!(found("°C").len() > 20);
        assert_eq!(found("").len(), Model::Icon3000v2.map().rows.len());
    }

    #[test]
    fn filters_narrow() {
        let map = Model::Icon3000v2.map();
        let check = |filter: &Filter, wanted: fn(&Row) -> bool| {
            let rows: Vec<_> = filter.rows(map).collect();
            assert!(!rows.is_empty());
            assert!(rows.into_iter().all(wanted), "{filter:?}");
        };
        let all = Filter::default();
        let hide_reserved = true;
        check(
            &Filter {
                hide_reserved,
                ..all.clone()
            },
            |r| r.kind != Kind::Reserved,
        );
        let table = Some(Table::Coil);
        check(
            &Filter {
                table,
                ..all.clone()
            },
            |r| r.table == Table::Coil,
        );
        let group = Some("PST".to_owned());
        check(
            &Filter {
                group,
                ..all.clone()
            },
            |r| r.group == "PST",
        );
        let level = Some(Level::Service);
        check(
            &Filter {
                level,
                ..all.clone()
            },
            |r| r.level == Some(Level::Service),
        );
        let access = Some(Writes::No);
        check(
            &Filter {
                access,
                ..all.clone()
            },
            |r| r.access == Access::Read,
        );
        let access = Some(Writes::Guarded);
        check(
            &Filter {
                access,
                ..all.clone()
            },
            |r| r.access == Access::WriteGuarded,
        );
    }

    #[test]
    fn groups_are_sorted_and_few() {
        let groups = groups(Model::Icon3000v2.map());
        assert!(groups.is_sorted());
        assert!((20..=40).contains(&groups.len()), "{groups:?}");
    }
}
