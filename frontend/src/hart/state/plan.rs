//! What is asked of a device: only what a screen shows, slow things slowly, the rest once.

use shared::device::Family;

use super::unit::{Key, Unit, plain};

/// Seconds after which a value that seldom changes is read again while it is shown.
const SLOW: u64 = 30;
/// Seconds between two reads of command 48 while the device says that there is more to read.
const MORE: u64 = 5;

/// Seconds between two reads at least, whatever the device gives reason for: a bit may flutter.
const HASTE: u64 = 2;

/// Tabs of a device: word in the address, and what people read.
pub const TABS: [(&str, &str); 6] = [
    ("overview", "Overview"),
    ("setup", "Set-up"),
    ("variables", "Variables"),
    ("status", "Status"),
    ("map", "Status map"),
    ("traffic", "Traffic"),
];

/// The tab with this word, or the first.
#[must_use]
pub fn tab(word: &str) -> &'static str {
    let found = TABS.iter().find(|(key, _)| *key == word);
    found.map_or("overview", |(key, _)| key)
}

/// Device variables 0 to 4 with status.
#[must_use]
pub fn variables() -> Key {
    (9, "0001020304".to_owned())
}

/// All 64 entries of the condensed status map.
#[must_use]
pub fn map() -> Key {
    entries(0, 64)
}

/// So many entries of the condensed status map from an index on.
#[must_use]
pub fn entries(start: u8, count: u8) -> Key {
    (523, format!("{start:02X}{count:02X}"))
}

/// What tells of forced and simulated modes, on every tab.
fn modes() -> [Key; 4] {
    [plain(133), plain(48), plain(7), variables()]
}

/// The status word of the CVA.
#[must_use]
pub fn status_word() -> Key {
    (129, "020000".to_owned())
}

/// What is polled while a tab is shown, with the time from one round to the next in milliseconds.
#[must_use]
pub fn watched(tab: &str, family: Option<Family>) -> (Vec<Key>, u32) {
    match tab {
        // Travel and limits are in command 48, everything else that moves in command 3.
        "overview" => (vec![plain(3), plain(3), plain(3), plain(48)], 1500),
        "traffic" => (vec![plain(3)], 500),
        "variables" => (vec![plain(3), variables()], 1000),
        "status" => {
            let mut keys = vec![plain(48), plain(3)];
            if family == Some(Family::Cva) {
                keys.push(status_word());
            }
            (keys, 2000)
        }
        "map" => (vec![plain(48), plain(3)], 2000),
        // A demand that goes away must be seen here, too.
        _ => (vec![plain(3)], 2000),
    }
}

/// True for a tab that shows what the status map makes of the status.
fn has_map(tab: &str) -> bool {
    tab == "map" || tab == "status"
}

/// What a tab needs to know once.
#[must_use]
pub fn once(tab: &str) -> Vec<Key> {
    let numbers: &[u16] = match tab {
        "overview" => &[0, 20],
        "setup" => &[0, 13, 20, 12, 15, 131, 14, 16, 8, 128],
        "variables" => &[8],
        // Answers are told from those of others by the device id.
        "status" | "traffic" => &[0],
        _ => &[],
    };
    let mut keys = Vec::from(modes());
    keys.extend(numbers.iter().copied().map(plain));
    if has_map(tab) {
        keys.push(map());
    }
    keys
}

/// What is to be read once more now: what a tab needs and nobody asked for yet, what grows old, and
/// what a device gives reason to read again.
#[must_use]
pub fn due(tab: &str, unit: &Unit, now_us: u64) -> Vec<Key> {
    let more = unit.status.is_some_and(|(status, _)| status & 0x10 != 0);
    let mut keys = once(tab);
    if has_map(tab) {
        keys.extend(super::map::rest(unit));
    }
    keys.retain(|key| {
        let Some(last) = last(unit, key) else {
            return unit.reading(key).is_none();
        };
        let slow = match key.0 {
            48 if more && tab == "overview" => MORE,
            7 | 9 | 48 | 133 => SLOW,
            // The counter of changes.
            0 if tab == "setup" => SLOW,
            _ => u64::MAX,
        };
        let changed = match key.0 {
            48 | 133 => unit.moded_us.max(unit.configured_us),
            _ => unit.configured_us,
        };
        let age = now_us.saturating_sub(last) / 1_000_000;
        (last < changed && age >= HASTE) || age >= slow
    });
    keys
}

/// When a command was asked last, however it ended.
fn last(unit: &Unit, key: &Key) -> Option<u64> {
    let reading = unit.reading(key)?;
    let good = reading.good.as_ref().map(|g| g.at_us);
    good.max(reading.bad.as_ref().map(|b| b.at_us))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{POLL, STATUS, hear, identity_of, poll, unit};

    /// Nothing here may be refused by the gate: all that is asked reads.
    #[test]
    fn all_that_is_asked_reads() {
        let mut keys = Vec::new();
        for (word, _) in TABS {
            keys.extend(once(word));
            for family in Family::ALL {
                keys.extend(watched(word, Some(family)).0);
            }
        }
        assert!(keys.len() > 30);
        for (number, data) in keys {
            let command = shared::hart::command(number).unwrap();
            let effects = command.effects_of(data.len() / 2);
            assert_eq!(effects, [shared::hart::model::Effect::Reads], "{number}");
        }
    }

    #[test]
    fn what_is_shown_is_read_and_what_grows_old_is_read_again() {
        let fresh = unit(&[]);
        let first = due("overview", &fresh, 0);
        assert_eq!(first.len(), 6);
        for (word, _) in TABS {
            for key in [plain(133), plain(48), plain(7), variables()] {
                assert!(due(word, &fresh, 0).contains(&key), "{word}");
            }
        }
        let known = unit(&[(3, POLL.0, POLL.1), (48, STATUS.0, STATUS.1)]);
        let due_at = |seconds: u64| due("overview", &known, seconds * 1_000_000);
        assert!(!due_at(3).contains(&plain(48)));
        // The device says that there is more to read.
        assert!(due_at(6).contains(&plain(48)));
        assert_eq!(tab("nonsense"), "overview");
    }

    /// A device whose modes were read at second 10, and polled since.
    fn polled() -> Unit {
        let mut unit = unit(&[]);
        hear(&mut unit, 133, 0, &[0], 10);
        hear(&mut unit, 48, 0, &[0; 9], 10);
        hear(&mut unit, 0, 0, &identity_of(7, 1), 10);
        hear(&mut unit, 3, 0, &poll(50.0), 10);
        unit
    }

    fn has(unit: &Unit, tab: &str, number: u16, second: u64) -> bool {
        due(tab, unit, second * 1_000_000).contains(&plain(number))
    }

    #[test]
    fn a_demand_that_goes_away_is_looked_into_at_once() {
        let mut unit = polled();
        hear(&mut unit, 3, 0, &poll(51.0), 11);
        assert!(!has(&unit, "overview", 133, 11) && !has(&unit, "overview", 48, 11));
        hear(&mut unit, 3, 0, &poll(f32::NAN), 12);
        for (tab, _) in TABS {
            let (polled, _) = watched(tab, None);
            assert!(polled.contains(&plain(3)), "{tab}: its demand is looked at");
            assert!(has(&unit, tab, 133, 12) && has(&unit, tab, 48, 12), "{tab}");
        }
        hear(&mut unit, 133, 0, &[1], 13);
        hear(&mut unit, 48, 0, &[0; 9], 13);
        hear(&mut unit, 3, 0, &poll(f32::NAN), 14);
        assert!(!has(&unit, "overview", 133, 14) && !has(&unit, "overview", 48, 14));
        assert!(has(&unit, "overview", 133, 43), "slowly in any case");
    }

    #[test]
    fn a_bit_of_the_device_status_is_looked_into_at_once() {
        let mut unit = polled();
        // Loop current fixed.
        hear(&mut unit, 3, 0x08, &poll(50.0), 12);
        assert!(has(&unit, "overview", 133, 12) && has(&unit, "overview", 48, 12));
        assert!(!has(&unit, "overview", 0, 12), "the identity stays");
        // A bit that flutters does not take the line.
        hear(&mut unit, 133, 0, &[0], 12);
        hear(&mut unit, 3, 0x08, &poll(50.0), 13);
        assert!(!has(&unit, "overview", 133, 13) && has(&unit, "overview", 133, 14));
    }

    #[test]
    fn a_changed_configuration_is_read_again() {
        let mut unit = polled();
        hear(&mut unit, 131, 0, &[0x40, 0x80, 0, 0, 0x41, 0xA0, 0, 0], 11);
        assert!(!has(&unit, "setup", 131, 12));
        hear(&mut unit, 3, 0x40, &poll(50.0), 12);
        assert!(has(&unit, "setup", 131, 13), "configuration changed");
        hear(
            &mut unit,
            131,
            0x40,
            &[0x40, 0x80, 0, 0, 0x41, 0xA0, 0, 0],
            13,
        );
        assert!(!has(&unit, "setup", 131, 13));
        // The bit stands; what goes on is the counter, which is looked at again.
        hear(&mut unit, 0, 0x40, &identity_of(7, 1), 13);
        assert!(has(&unit, "setup", 0, 43) && !has(&unit, "overview", 0, 43));
        hear(&mut unit, 0, 0x40, &identity_of(7, 2), 44);
        assert!(has(&unit, "setup", 131, 44));
    }

    /// The line is for command 3 first; command 48 tells travel and limits every few answers.
    #[test]
    fn the_overview_watches_travel() {
        let (keys, _) = watched("overview", Some(Family::Iq));
        let of = |number| keys.iter().filter(|k| **k == plain(number)).count();
        assert_eq!((of(3), of(48)), (3, 1));
    }
}
