//! The condensed status map: where it comes from, and as a file.

use shared::device::Family;
use shared::hart::model::{Bit, Preset};
use shared::hart::ne107::{ALARM_BYTES, ENTRIES, Map};
use shared::hart::{CONDENSED_STATUS, DEVICE_STATUS, PRESETS, additional};

use super::plan;
use super::unit::{Unit, find};

/// The first line of a file.
const HEAD: &str = "index,status,bit,name,category";

/// The map that a device sent, if it was read.
#[must_use]
pub fn of_device(unit: &Unit) -> Option<Map> {
    let good = unit.reading(&plan::map())?.good.as_ref()?;
    let (_, field) = find(&good.shown, "entry")?;
    let start = super::unit::raw_of(&good.shown, "start")?;
    let mut map = Map::default();
    let bytes = good.shown.decoded.payload(field);
    map.take(u8::try_from(start).ok()?, &bytes);
    Some(map)
}

/// The example with this key.
#[must_use]
pub fn preset(key: &str) -> Option<&'static Preset> {
    PRESETS.iter().find(|p| p.key == key)
}

/// Table of the manual that an example is from: `table 20`.
#[must_use]
pub fn table(preset: &Preset) -> String {
    let part = preset.bits.first().map_or("", |b| b.source.part);
    part.split(',').next().unwrap_or(part).to_owned()
}

/// Where an index stands: `device status` or the byte of command 48, and the bit.
#[must_use]
pub fn place(index: usize) -> (String, u8) {
    match Map::bit(index) {
        Some((byte, bit)) => (format!("byte {byte}"), bit),
        None => (
            "device status".to_owned(),
            u8::try_from(index % 8).unwrap_or(0),
        ),
    }
}

/// What is known of the bit of an index.
#[must_use]
pub fn bit(family: Option<Family>, index: usize) -> Option<&'static Bit> {
    let (bits, bit) = match Map::bit(index) {
        Some((byte, bit)) => (additional(family?, byte)?, bit),
        None => (&DEVICE_STATUS, place(index).1),
    };
    bits.bits.iter().find(|b| b.bit == bit)
}

/// The indexes that a map of this family is about: those of the alarm bytes, with the bits that have
/// a name; without a family, or with no such bit, all of them. An entry that has a category is
/// always among them.
#[must_use]
pub fn rows(family: Option<Family>, map: &Map) -> Vec<usize> {
    let alarms = Map::index(0, 0)..Map::index(ALARM_BYTES, 0);
    let named = |index: &usize| family.is_none() || bit(family, *index).is_some();
    (0..ENTRIES)
        .filter(|i| map.get(*i) != 0 || (alarms.contains(i) && named(i)))
        .collect()
}

/// The name of a category.
#[must_use]
pub fn category(code: u8) -> &'static str {
    CONDENSED_STATUS.name(u32::from(code)).unwrap_or("Reserved")
}

/// The map as a file: one line an entry.
#[must_use]
pub fn to_csv(family: Option<Family>, map: &Map) -> String {
    let mut text = format!("{HEAD}\n");
    for index in 0..ENTRIES {
        let (status, number) = place(index);
        let name = bit(family, index).map_or("", |b| b.label);
        let name = name.replace('"', "\"\"");
        let code = map.get(index);
        text.push_str(&format!("{index},{status},{number},\"{name}\",{code}\n"));
    }
    text
}

/// Reads a file that [`to_csv`] wrote.
///
/// # Errors
///
/// What is wrong in which line, and what is expected.
pub fn from_csv(text: &str) -> Result<Map, String> {
    let mut map = Map::default();
    let mut lines = (1..).zip(text.lines());
    if lines.next().map(|(_, line)| line.trim()) != Some(HEAD) {
        return Err(format!(
            "This is no map: the first line of a saved one is `{HEAD}`."
        ));
    }
    for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
        let index = line.split(',').next().and_then(|i| i.trim().parse().ok());
        let code = line.rsplit(',').next().and_then(|c| c.trim().parse().ok());
        match (index, code) {
            (Some(index @ 0..ENTRIES), Some(code @ 0..=15)) => map.set(index, code),
            _ => {
                return Err(format!(
                    "Line {number}: an entry has an index of 0 to 63 first and a category of 0 to \
                     15 last; it is `{line}`."
                ));
            }
        }
    }
    Ok(map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::unit;

    /// The worked exchange R22, R23: the example of table 20.
    const MAP: (&str, &str) = (
        "82AEDD0123451F04020B0040C4",
        "86AEDD0123451F260000020B0040 00000000304000510405000005030000000000000000000000000000000000 00C4",
    );

    #[test]
    fn the_map_of_a_device_is_that_of_table_20() {
        let unit = unit(&[(523, MAP.0, MAP.1)]);
        let map = of_device(&unit).unwrap();
        assert_eq!(Some(&map), Map::example(Family::Iq).as_ref());
        // Local control fault is a failure, reading it by hand from the table.
        assert_eq!(map.get(Map::index(0, 1)), 3);
        assert_eq!(bit(Some(Family::Iq), 9).unwrap().key, "local_control_fault");
        assert_eq!(of_device(&super::super::unit::tests::unit(&[])), None);
    }

    #[test]
    fn files_come_back_and_say_what_is_wrong() {
        for preset in &PRESETS {
            let map = Map::of(preset);
            let text = to_csv(Some(preset.family), &map);
            assert_eq!(text.lines().count(), 65);
            assert_eq!(from_csv(&text), Ok(map));
        }
        assert!(from_csv("").unwrap_err().contains("no map"));
        let bad = format!("{HEAD}\n64,x,0,\"\",3\n");
        assert!(from_csv(&bad).unwrap_err().starts_with("Line 2:"));
        let bad = format!("{HEAD}\n8,x,0,\"\",16\n");
        assert!(from_csv(&bad).is_err());
    }

    #[test]
    fn examples_name_their_table() {
        let tables: Vec<_> = PRESETS.iter().map(table).collect();
        assert_eq!(tables, ["table 20", "table 23", "table 25"]);
        assert_eq!(category(3), "Failure");
        assert_eq!(category(9), "Reserved");
        assert!(rows(Some(Family::Iq), &Map::default()).len() > 20);
        // SI has no alarms.
        assert_eq!(rows(Some(Family::Si), &Map::default()), Vec::<usize>::new());
    }
}
