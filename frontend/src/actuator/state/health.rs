//! What is wrong with the device, by NAMUR NE 107, the worst first.

use shared::address::Table;
use shared::few;
use shared::icon3000::model::{HEALTH, Meaning};
use shared::map::row::{DeviceMap, Kind, Model, Row, Set};

use super::dossier::Dossier;
use super::logs::Table as Log;

/// A code of a log.
#[derive(Clone, Debug)]
pub struct Past {
    /// What it means, and why.
    pub meaning: &'static Meaning,
    /// When, in seconds since 1970 by the clock of the device.
    pub time: Option<i64>,
    /// Its entry in the log, 1 is the latest.
    pub number: u16,
    /// The file of the log.
    pub file: u16,
}

/// The words of a device that say what is wrong, in the order of the map. The holding registers
/// have them all but on an ICON2000v4.
#[must_use]
pub fn rows(dossier: &Dossier) -> Vec<&'static Row> {
    let mut rows = inputs(dossier);
    if rows.is_empty() {
        rows = dossier.rows(&|row| {
            let told = |set: &Set| HEALTH.iter().any(|m| m.set == set.name);
            row.kind == Kind::Bits && row.set.is_some_and(told)
        });
    }
    rows
}

/// The inputs of an ICON2000v4 that tell what later models have in holding registers: its state,
/// alarms, warnings and measurements. No others have any.
#[must_use]
pub fn inputs(dossier: &Dossier) -> Vec<&'static Row> {
    let old = |map: &&DeviceMap| map.model == Model::Icon2000v4;
    let Some(map) = dossier.device.map().filter(old) else {
        return Vec::new();
    };
    let told = |row: &&Row| match row.table {
        Table::Discrete => row.kind != Kind::Reserved,
        Table::Input => row.address.get() < 5,
        _ => false,
    };
    map.rows.iter().copied().filter(told).collect()
}

/// What the logs of alarms and warnings tell, the latest first, at most so many.
#[must_use]
pub fn past(dossier: &Dossier, most: usize) -> Vec<Past> {
    let mut found: Vec<Past> = Vec::new();
    for (file, set) in [(2, "alarm_code"), (3, "warning_code")] {
        for row in Log::of(dossier, file).rows {
            let code = row.cells.first().cloned().flatten().and_then(|c| c.number);
            let mut meanings = HEALTH.iter();
            let meaning = meanings.find(|m| m.set == set && Some(i64::from(m.value)) == code);
            if let Some(meaning) = meaning {
                found.push(Past {
                    meaning,
                    time: row.time,
                    number: row.number,
                    file,
                });
            }
        }
    }
    few::sort_by_key(&mut found, |p| core::cmp::Reverse(p.time));
    found.truncate(most);
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;
    use crate::actuator::state::logs::tests::put;
    use crate::actuator::state::saved::model;
    use shared::device::Device;

    /// Everything that the list of conditions needs is read.
    #[test]
    fn every_word_of_the_list_is_read() {
        for device in [Device::Icon2000v4, Device::Icon3000, Device::Icon3000v2] {
            let dossier = Dossier::new("x", device);
            let wanted = rows(&dossier);
            let model = model(device).unwrap();
            let health = shared::icon3000::health::health(model, &dossier.image);
            assert!(!health.unread.is_empty());
            let read = |row: &&&Row| wanted.iter().any(|w| core::ptr::eq(*w, **row));
            assert_eq!(health.unread.iter().find(|r| !read(r)), None, "{device:?}");
        }
        assert!(rows(&Dossier::new("x", Device::None)).is_empty());
    }

    /// The ICON2000v4 tells its latest alarm in IR 45 to 49: code 12, 2024-02-29 12:34:56.
    #[test]
    fn registers_tell_the_past_of_an_older_model() {
        let mut dossier = Dossier::new("x", Device::Icon2000v4);
        let words = [0, 12, 0x29, 0x02, 0x20, 0x24, 0, 0x12, 0x34, 0x56];
        let mut response = vec![4, 10];
        response.extend(words);
        assert!(dossier.absorb(&[4, 0, 45, 0, 5], &response, 1));
        let past = past(&dossier, 9);
        assert_eq!((past.len(), past[0].meaning.value), (1, 12));
        let time = past[0].time.map(crate::chart::time::stamp);
        assert_eq!(time.as_deref(), Some("2024-02-29 12:34:56"));
        let wanted = rows(&dossier);
        assert!(wanted.iter().any(|r| r.key == "alarms_1"));
    }

    #[test]
    fn logs_tell_the_past() {
        let mut dossier = device(&[]);
        put(&mut dossier, 2, &[2, 0, 90, 12, 0, 10, 6]);
        put(&mut dossier, 3, &[1, 0, 50, 6]);
        let past = past(&dossier, 2);
        let told: Vec<_> = past.iter().map(|p| (p.file, p.number)).collect();
        assert_eq!(told, [(2, 1), (3, 1)]);
    }
}
