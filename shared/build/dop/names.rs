//! The rules about sets of names and about readings. See `rules.rs` for the list.

use std::collections::BTreeSet;

use super::rules::{Rules, is_key, spans};
use crate::types::SETTLED;

/// Sets that the manual lists without a hole, with their last code.
const LISTED: [(&str, u16); 3] = [("error_codes", 14), ("pst_reasons", 38), ("ne107", 7)];
impl<'a> Rules<'a> {
    /// R25, R34.
    pub fn sets(&mut self) {
        let data = self.data;
        for (offset, set) in spans(&data.sets) {
            self.unless(
                is_key(&set.name),
                "R22",
                offset,
                format!("{:?} is no key", set.name),
            );
            let mut seen = BTreeSet::new();
            for member in set.all() {
                let fits = !set.bits || member.value() < 32;
                let unique = seen.insert(member.value()) && is_key(member.key());
                self.unless(
                    fits && unique,
                    "R25",
                    offset,
                    format!("{}: {}", set.name, member.value()),
                );
                self.text(offset, member.label(), true);
            }
            // Error codes and status do not stand in a layout.
            let protocol = matches!(set.name.as_str(), "error_codes" | "statuses");
            let used = data
                .layouts
                .iter()
                .flat_map(|l| &l.get_ref().fields)
                .any(|f| f.get_ref().set == set.name);
            self.unless(
                used || protocol,
                "R25",
                offset,
                format!("{} is not used", set.name),
            );
        }
        for (name, last) in LISTED {
            let set = data.sets.iter().find(|s| s.get_ref().name == name);
            let codes: BTreeSet<u16> = set
                .iter()
                .flat_map(|s| s.get_ref().all())
                .map(|m| m.value())
                .collect();
            let all = codes == (0..=last).collect();
            self.unless(all, "R34", 0, format!("{name} has {codes:?}"));
        }
    }

    /// R26.
    pub fn readings(&mut self) {
        let data = self.data;
        let mut used: BTreeSet<&str> = BTreeSet::new();
        let mut ids: Vec<(usize, &str)> = Vec::new();
        let mut all = |offset: usize, names: &'a [String]| {
            ids.extend(names.iter().map(|id| (offset, id.as_str())));
        };
        for (offset, object) in spans(&data.objects) {
            all(offset, &object.readings);
            for (offset, choice) in spans(&object.options) {
                all(offset, &choice.readings);
            }
        }
        for (_, layout) in spans(&data.layouts) {
            for (offset, field) in spans(&layout.fields) {
                all(offset, &field.readings);
            }
        }
        let defaults = &data.defaults;
        for names in [
            &defaults.time,
            &defaults.text,
            &defaults.points,
            &defaults.temperature,
        ] {
            all(0, names);
        }
        for (offset, layout) in spans(&data.layouts) {
            ids.extend(layout.reading.iter().map(|id| (offset, id.as_str())));
        }
        for (offset, id) in ids {
            let known = data.readings.iter().any(|r| r.get_ref().id == id);
            self.unless(known, "R26", offset, format!("no reading {id}"));
            used.insert(id);
        }
        let mut seen = BTreeSet::new();
        for (offset, reading) in spans(&data.readings) {
            let id = reading.id.as_str();
            let settled = SETTLED.iter().any(|s| s.0 == reading.settled);
            self.unless(
                settled && seen.insert(id),
                "R26",
                offset,
                format!("reading {id}"),
            );
            self.text(offset, &reading.text, true);
            self.unless(
                used.contains(id) != reading.concerns.is_some(),
                "R26",
                offset,
                format!("{id} is used, or says what it concerns"),
            );
        }
    }
}
