//! What is wrong with the device, by NAMUR NE 107, the worst first.

use shared::address::Table;
use shared::few;
use shared::icon3000::model::{HEALTH, Meaning};
use shared::map::row::{Access, Kind, Row};
use shared::value::Value;

use super::dossier::Dossier;
use super::logs::Y2K;

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
/// have them all; older masters read the copies in the input registers.
#[must_use]
pub fn rows(dossier: &Dossier) -> Vec<&'static Row> {
    let Some(map) = dossier.device.map() else {
        return Vec::new();
    };
    let told = |row: &&Row| {
        row.kind == Kind::Bits
            && row.access != Access::Absent
            && row
                .set
                .is_some_and(|set| HEALTH.iter().any(|m| m.set == set.name))
    };
    let rows = |table| {
        let rows = map.rows_of(table).iter().copied();
        rows.filter(told).collect::<Vec<_>>()
    };
    let mut found = rows(Table::Holding);
    for copy in rows(Table::Input) {
        let set = |row: &Row| row.set.map(|s| s.name);
        if found.iter().all(|row| set(row) != set(copy)) {
            found.push(copy);
        }
    }
    found
}

/// What the logs of alarms and warnings tell, the latest first, at most so many.
#[must_use]
pub fn past(dossier: &Dossier, most: usize) -> Vec<Past> {
    let mut found: Vec<Past> = Vec::new();
    for (file, set) in [(2, "alarm_code"), (3, "warning_code")] {
        let Some(log) = dossier.log(file) else {
            continue;
        };
        let valid = |number: u16| log.stored.is_none_or(|stored| number <= stored);
        for entry in log.entries.iter().filter(|e| valid(e.number)) {
            let Some(Value::Code { raw, .. }) = entry.get("code").map(|i| i.value) else {
                continue;
            };
            let mut meanings = HEALTH.iter();
            let meaning = meanings.find(|m| m.set == set && u32::from(m.value) == raw);
            if let Some(meaning) = meaning {
                found.push(Past {
                    meaning,
                    time: entry.time().map(|t| Y2K + i64::from(t)),
                    number: entry.number,
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
        let dossier = device(&[]);
        let wanted: Vec<_> = rows(&dossier).iter().map(|r| r.address.get()).collect();
        let health =
            shared::icon3000::health::health(model(dossier.device).unwrap(), &dossier.image);
        assert!(
            health
                .unread
                .iter()
                .all(|r| wanted.contains(&r.address.get()))
        );
        assert!(rows(&Dossier::new("x", Device::None)).is_empty());
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
