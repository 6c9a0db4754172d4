//! The writable map as a view: what is set, what may be set, and who may set it.

use super::model::Mirror;
use super::say;
use crate::address::{Address, Table};
use crate::image::Image;
use crate::map::decode::value;
use crate::map::row::{Access, Level, Model, Reading, Row};
use crate::value::Quality;

/// One register that can be written.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// The row of the map.
    pub row: &'static Row,
    /// What it says, with unit; `None` if it was not read.
    pub value: Option<String>,
    /// Its words as read.
    pub raw: Option<Vec<u8>>,
    /// True if what was read is outside what the manual allows, or no valid value.
    pub outside: bool,
    /// True if the manual leaves open how to read it.
    pub disputed: bool,
    /// What may be set, with unit: `0.1 to 25.5 %`; empty if the manual gives no range.
    pub range: String,
    /// Level that a write needs, where the model has levels.
    pub level: Option<Level>,
    /// The register whose value this one shows once more (reading E44).
    pub mirror_of: Option<Address>,
    /// True if the mirror was read and says something else.
    pub differs: bool,
}

impl Setting {
    /// Why the row differs from the print.
    #[must_use]
    pub const fn reading(&self) -> Option<&'static Reading> {
        self.row.reading
    }
}

/// Settings that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// The manual's group.
    pub name: &'static str,
    /// Its settings in the order of their addresses.
    pub settings: Vec<Setting>,
}

/// Every holding register that can be written, in groups, in the order of their first address.
///
/// Commands and the login are among them; their values are what was written last, or 0.
#[must_use]
pub fn configuration(model: Model, image: &Image) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for row in model.map().rows_of(Table::Holding) {
        if !matches!(
            row.access,
            Access::Write | Access::WriteGuarded | Access::WriteOnly
        ) {
            continue;
        }
        let setting = setting(model, image, row);
        match groups.iter_mut().find(|g| g.name == row.group) {
            Some(group) => group.settings.push(setting),
            None => groups.push(Group {
                name: row.group,
                settings: vec![setting],
            }),
        }
    }
    groups
}

fn setting(model: Model, image: &Image, row: &'static Row) -> Setting {
    let raw = image.bytes(row);
    let quality = raw.as_deref().map(|bytes| value(row, bytes).quality);
    let (_, home, _) = Mirror::home(row.table, row.address);
    let mirror_of = (home != row.address).then_some(home);
    let home = mirror_of.and_then(|a| model.map().row_at(Table::Holding, a));
    let of_home = home.and_then(|row| image.bytes(row));
    Setting {
        row,
        value: raw.as_deref().map(|bytes| say::bytes_of(row, bytes)),
        outside: matches!(quality, Some(Quality::OutOfRange | Quality::Invalid)),
        disputed: quality == Some(Quality::Disputed),
        range: range(row),
        level: row.level.filter(|_| model >= Model::Icon3000v2),
        mirror_of,
        differs: raw.is_some() && of_home.is_some() && raw != of_home,
        raw,
    }
}

/// What may be set, with unit. Reading E87: ranges are raw counts, so they are scaled here.
#[must_use]
pub fn range(row: &Row) -> String {
    let Some((min, max)) = row.range else {
        return String::new();
    };
    let (min, max) = (row.scale.apply(min.into()), row.scale.apply(max.into()));
    let unit = if row.unit.is_empty() { "" } else { " " };
    if min == max {
        format!("{min}{unit}{}", row.unit)
    } else {
        format!("{min} to {max}{unit}{}", row.unit)
    }
}

/// Who is logged in, as HR 3480 says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoggedIn {
    /// This level.
    Level(Level),
    /// A code that no level has.
    Unknown(u16),
    /// The register was not read.
    Unread,
    /// The model has no levels (section 11: ICON3000v2 only).
    NoLevels,
}

/// Who is logged in. After power-up it is the user (section 11).
#[must_use]
pub fn logged_in(model: Model, image: &Image) -> LoggedIn {
    if model < Model::Icon3000v2 {
        return LoggedIn::NoLevels;
    }
    match image.cell(Table::Holding, Address::new(3480)) {
        None => LoggedIn::Unread,
        Some(cell) => match cell.word {
            0 => LoggedIn::Level(Level::Observer),
            1 => LoggedIn::Level(Level::User),
            2 => LoggedIn::Level(Level::Service),
            3 => LoggedIn::Level(Level::Manufacturer),
            other => LoggedIn::Unknown(other),
        },
    }
}
