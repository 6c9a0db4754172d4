//! The rules about status bits and the small tables. See `rules.rs` for the list.

use std::collections::{BTreeMap, BTreeSet};

use super::rules::Rules;
use crate::types::At;

/// Bytes of the device's own status that are described.
pub const BYTES: u8 = 6;

impl<'a> Rules<'a> {
    /// R45 and what goes with it.
    pub fn status(&mut self) {
        let data = self.data;
        let mut covered: BTreeMap<(&str, &str, Option<u8>), Vec<u8>> = BTreeMap::new();
        let mut keys: BTreeMap<(&str, &str), BTreeSet<&str>> = BTreeMap::new();
        let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
        for (at, line) in &data.status {
            self.document(&line.doc, at);
            self.readings([line.reading.as_str()], at);
            self.trust(&line.trust, &line.reading, at);
            let kinds = ["alarm", "state", "reserved"].contains(&line.kind.as_str());
            let named = line.is_reserved() == line.key.is_empty();
            self.found.unless(
                kinds && named,
                "R45",
                at,
                "a named bit is an alarm or a state",
            );
            let group = (line.part.as_str(), line.family.as_str(), line.byte);
            match line.bits() {
                Some(bits) => covered.entry(group).or_default().extend(bits),
                None => self.found.add("R45", at, format!("bits {:?}", line.bit)),
            }
            if line.is_reserved() {
                continue;
            }
            let own = (line.part.as_str(), line.family.as_str());
            let mut seen = keys.remove(&own).unwrap_or_default();
            self.key(&line.key, &mut seen, at);
            keys.insert(own, seen);
            if line.part == "additional" {
                *counts.entry(line.family.as_str()).or_default() += 1;
            } else {
                self.set(&line.part, "bits", at);
            }
        }
        let nowhere = At {
            file: "data/hart/status.csv".to_owned(),
            line: 0,
        };
        for ((part, family, byte), mut bits) in covered.clone() {
            bits.sort_unstable();
            let last: u8 = if part == "actuator_status" { 16 } else { 8 };
            let text = format!("{part} {family} {byte:?}: bits {bits:?}");
            self.found
                .unless(bits.into_iter().eq(0..last), "R45", &nowhere, text);
        }
        for (at, family) in &data.families {
            self.readings([family.reading.as_str()], at);
            let count = counts.get(family.key.as_str()).copied();
            let text = format!("{count:?} named bits, {} are counted", family.bits);
            self.found
                .unless(count == Some(family.bits), "R45", at, text);
            for byte in 0..BYTES {
                let there = covered.contains_key(&("additional", family.key.as_str(), Some(byte)));
                self.found
                    .unless(there, "R45", at, format!("no byte {byte}"));
            }
        }
        self.presets();
    }

    /// R46.
    fn presets(&mut self) {
        let data = self.data;
        for (at, preset) in &data.presets {
            self.readings([preset.reading.as_str()], at);
            self.trust(&preset.trust, &preset.reading, at);
            let line = data.status.iter().map(|(_, line)| line).find(|line| {
                line.part == "additional"
                    && line.family == preset.family
                    && line.byte == Some(preset.byte)
                    && line.bits().is_some_and(|b| b.contains(&preset.bit))
            });
            // Reading R16: the example for SI names bits that SI does not have.
            let same = |name: &str| name.eq_ignore_ascii_case(&preset.printed);
            let named = line.is_some_and(|l| {
                same(&l.label) || same(&l.alias) || (l.is_reserved() && preset.family == "si")
            });
            let known = data
                .codes
                .iter()
                .any(|(_, c)| c.set == "condensed_status" && c.value == u16::from(preset.category));
            let text = format!("no bit {:?} or category", preset.printed);
            self.found.unless(named && known, "R46", at, text);
        }
    }

    /// R44, R47, R48 and the documents of the tables.
    pub fn tables(&mut self) {
        let data = self.data;
        for (at, file) in &data.files {
            self.document(&file.doc, at);
        }
        let (mut values, mut keys) = (BTreeSet::new(), BTreeSet::new());
        let codes = data
            .codes
            .iter()
            .map(|(at, c)| (at, &c.set, c.value, &c.key, &c.reading, "enum"));
        let bits = data
            .bits
            .iter()
            .map(|(at, b)| (at, &b.set, u16::from(b.bit), &b.key, &b.reading, "bits"));
        for (at, set, value, key, reading, sort) in codes.chain(bits) {
            self.readings([reading.as_str()], at);
            let unique = values.insert((set, value)) && keys.insert((set, key));
            let text = format!("{value} or {key} of {set} is there twice");
            self.found.unless(unique, "R44", at, text);
            let fine = super::rules::is_key(key);
            self.found.unless(fine, "R40", at, format!("key {key:?}"));
            let known = data
                .sets
                .iter()
                .any(|(_, s)| s.set == *set && s.kind == sort);
            self.found
                .unless(known, "R42", at, format!("no set {set:?} of {sort}"));
        }
        let mut names = BTreeSet::new();
        for (at, set) in &data.sets {
            self.key(&set.set, &mut names, at);
            self.document(&set.doc, at);
            self.readings([set.reading.as_str()], at);
            self.trust(&set.trust, &set.reading, at);
            let words = !set.label.is_empty() && ["yes", "no"].contains(&set.tail.as_str());
            self.found
                .unless(words, "R51", at, "a set has a label, and a tail or none");
        }
        let mut seen = BTreeSet::new();
        for (at, unit) in &data.units {
            self.readings([unit.reading.as_str()], at);
            let unique = seen.insert((unit.code, unit.classification));
            let named = unit.symbol.is_empty() != unit.name.is_empty();
            let text = format!("unit {} is there twice or has no name", unit.code);
            self.found.unless(unique && named, "R48", at, text);
        }
        let mut ids = BTreeSet::new();
        for (at, maker) in &data.makers {
            self.readings([maker.reading.as_str()], at);
            let fine = ids.insert(maker.id) && !maker.name.is_empty();
            self.found
                .unless(fine, "R44", at, format!("manufacturer {}", maker.id));
        }
        let mut keys = BTreeSet::new();
        let mut next = 0;
        for (at, line) in &data.responses {
            self.readings([line.reading.as_str()], at);
            self.trust(&line.trust, &line.reading, at);
            self.key(&line.key, &mut keys, at);
            let follows = line.first == next && line.last >= line.first;
            next = line.last.saturating_add(1);
            self.found
                .unless(follows, "R47", at, "codes follow each other");
            let class = ["success", "warning", "error"].contains(&line.class.as_str());
            self.found.unless(class, "R51", at, "unknown class");
        }
        let nowhere = At {
            file: "data/hart/response_codes.csv".to_owned(),
            line: 0,
        };
        self.found
            .unless(next == 128, "R47", &nowhere, "codes end at 127");
        let mut keys = BTreeSet::new();
        for (at, timer) in &data.timers {
            self.key(&timer.key, &mut keys, at);
            self.readings([timer.reading.as_str()], at);
            self.trust(&timer.trust, &timer.reading, at);
        }
    }
}
