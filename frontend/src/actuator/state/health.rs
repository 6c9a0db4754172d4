//! What is wrong with the device, by NAMUR NE 107, the worst first.

use shared::address::Table;
use shared::icon3000::model::{HEALTH, Meaning, Ne107};
use shared::map::row::{Access, Kind, Row};
use shared::value::Value;

use super::dossier::Dossier;
use super::logs::Y2K;

/// Something that a status or alarm word says.
#[derive(Clone, Debug)]
pub struct Condition {
    /// What it means, and why.
    pub meaning: &'static Meaning,
    /// The word that says it.
    pub row: &'static Row,
    /// The word as read.
    pub word: u32,
    /// When it was read, in microseconds.
    pub at: u64,
}

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

/// Every condition that is active, the worst first; within a category in the order of the map.
#[must_use]
pub fn conditions(dossier: &Dossier) -> Vec<Condition> {
    let mut found = Vec::new();
    for row in rows(dossier) {
        let Some(seen) = dossier.image.row(row) else {
            continue;
        };
        let Value::Flags { raw, set } = seen.judged.value else {
            continue;
        };
        for meaning in HEALTH.iter().filter(|m| m.set == set.name) {
            if raw.wrapping_shr(meaning.value.into()) & 1 == 1 {
                found.push(Condition {
                    meaning,
                    row,
                    word: raw,
                    at: seen.at.get(),
                });
            }
        }
    }
    found.sort_by_key(|c| rank(c.meaning.status));
    found
}

/// The words that were not read, so that nobody knows what they would say.
#[must_use]
pub fn unread(dossier: &Dossier) -> Vec<&'static Row> {
    let rows = rows(dossier).into_iter();
    rows.filter(|row| dossier.image.row(row).is_none())
        .collect()
}

/// The worst of all conditions.
#[must_use]
pub fn worst(conditions: &[Condition]) -> Option<Ne107> {
    conditions.first().map(|c| c.meaning.status)
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
    found.sort_by_key(|p| core::cmp::Reverse(p.time));
    found.truncate(most);
    found
}

/// The worst first.
const fn rank(status: Ne107) -> u8 {
    match status {
        Ne107::Failure => 0,
        Ne107::CheckFunction => 1,
        Ne107::OutOfSpecification => 2,
        Ne107::Maintenance => 3,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;
    use crate::actuator::state::logs::tests::put;
    use shared::device::Device;

    /// HR 3010 bit 13 low battery and bit 14 lost phase, HR 3009 bit 6... as the map names them.
    #[test]
    fn the_worst_comes_first() {
        let set = |name: &str, key: &str| {
            let found = HEALTH.iter().find(|m| m.set == name && m.key == key);
            1_u16 << found.unwrap().value
        };
        let alarms = set("alarms_1", "low_battery") | set("alarms_1", "lost_phase");
        let warnings = set("warnings", "maintenance_request");
        let dossier = device(&[(3009, &[warnings, alarms, 0]), (3016, &[0])]);
        let found = conditions(&dossier);
        let keys: Vec<_> = found.iter().map(|c| c.meaning.key).collect();
        assert_eq!(keys[0], "lost_phase");
        assert!(keys.contains(&"low_battery") && keys.contains(&"maintenance_request"));
        assert_eq!(worst(&found), Some(Ne107::Failure));
        assert!(
            found
                .iter()
                .all(|c| !c.meaning.reason.is_empty() && !c.meaning.check.is_empty())
        );
        let open: Vec<_> = unread(&dossier).iter().map(|r| r.address.get()).collect();
        assert_eq!(open, [3001, 3002, 3003, 3030]);
    }

    /// What was not read is not good.
    #[test]
    fn nothing_read_is_no_health() {
        let dossier = device(&[]);
        assert!(conditions(&dossier).is_empty());
        assert_eq!(unread(&dossier).len(), rows(&dossier).len());
        let unknown = Dossier::new("x", Device::None);
        assert!(rows(&unknown).is_empty());
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
