//! What is asked of a device: only what a screen shows, slow things slowly, the rest once.

use shared::device::Family;

use super::unit::{Key, Unit, plain};

/// Seconds after which a value that seldom changes is read again while it is shown.
const SLOW: u64 = 30;
/// Seconds between two reads of command 48 while the device says that there is more to read.
const MORE: u64 = 5;

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
    (523, "0040".to_owned())
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
        "overview" | "traffic" => (vec![plain(3)], 500),
        "variables" => (vec![plain(3), variables()], 1000),
        "status" => {
            let mut keys = vec![plain(48)];
            if family == Some(Family::Cva) {
                keys.push(status_word());
            }
            (keys, 2000)
        }
        _ => (Vec::new(), 1000),
    }
}

/// What a tab needs to know once.
#[must_use]
pub fn once(tab: &str) -> Vec<Key> {
    let numbers: &[u16] = match tab {
        "overview" => &[0, 133, 48, 20],
        "setup" => &[0, 13, 20, 12, 7, 15, 131, 14, 16, 8, 128, 133],
        "variables" => &[8],
        // Answers are told from those of others by the device id.
        "status" | "traffic" => &[0],
        "map" => return vec![map(), plain(48)],
        _ => &[],
    };
    numbers.iter().copied().map(plain).collect()
}

/// What is to be read once more now: what a tab needs and nobody asked for yet, and on the overview
/// what grows old.
#[must_use]
pub fn due(tab: &str, unit: &Unit, now_us: u64) -> Vec<Key> {
    let asked = |key: &Key| unit.reading(key).is_some();
    let mut keys = once(tab);
    keys.retain(|key| !asked(key));
    if tab == "overview" {
        let more = unit.status.is_some_and(|(status, _)| status & 0x10 != 0);
        for (number, seconds) in [(48, if more { MORE } else { SLOW }), (133, SLOW)] {
            let key = plain(number);
            if old(unit, &key, now_us, seconds) {
                keys.push(key);
            }
        }
    }
    keys
}

/// True for a reading that is older than so many seconds, however it ended.
fn old(unit: &Unit, key: &Key, now_us: u64, seconds: u64) -> bool {
    let Some(reading) = unit.reading(key) else {
        return false;
    };
    let good = reading.good.as_ref().map(|g| g.at_us);
    let last = good.max(reading.bad.as_ref().map(|b| b.at_us));
    last.is_some_and(|at| now_us.saturating_sub(at) > seconds * 1_000_000)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hart::state::unit::tests::{POLL, STATUS, unit};

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
        assert_eq!(due("overview", &fresh, 0).len(), 4);
        assert_eq!(due("traffic", &fresh, 0), [plain(0)]);
        let known = unit(&[(3, POLL.0, POLL.1), (48, STATUS.0, STATUS.1)]);
        let due_at = |seconds: u64| due("overview", &known, seconds * 1_000_000);
        assert!(!due_at(3).contains(&plain(48)));
        // The device says that there is more to read.
        assert!(due_at(6).contains(&plain(48)));
        assert_eq!(tab("nonsense"), "overview");
    }
}
