//! What is wrong with the device, by NAMUR NE 107, the worst first.

use shared::few;
use shared::icon3000::model::{HEALTH, Meaning};
use shared::map::row::{Kind, Row, Set};

use super::dossier::Dossier;
use super::logs::Table;

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
/// have them all; an ICON2000v4 has them in its input registers.
#[must_use]
pub fn rows(dossier: &Dossier) -> Vec<&'static Row> {
    dossier.rows(&|row| {
        let told = |set: &Set| HEALTH.iter().any(|m| m.set == set.name);
        row.kind == Kind::Bits && row.set.is_some_and(told)
    })
}

/// What the logs of alarms and warnings tell, the latest first, at most so many.
#[must_use]
pub fn past(dossier: &Dossier, most: usize) -> Vec<Past> {
    let mut found: Vec<Past> = Vec::new();
    for (file, set) in [(2, "alarm_code"), (3, "warning_code")] {
        for row in Table::of(dossier, file).rows {
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
