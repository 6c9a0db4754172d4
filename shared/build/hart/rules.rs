//! The numbered rules that the HART data must keep.
//!
//! | Rule | Demands |
//! |---|---|
//! | R00 | the files can be read (checked while reading) |
//! | R40 | keys are lower snake case and unique among their neighbours; numbers are unique |
//! | R41 | a form's lengths are distinct and end where a field ends; the longest holds all fields |
//! | R42 | a type is known, its set exists and is of the right sort; every set is used |
//! | R43 | a value's unit stands directly before it, or is fixed |
//! | R44 | codes and bits of a set are unique |
//! | R45 | status bytes are covered bit by bit, once; a family has as many named bits as counted |
//! | R46 | an example of the condensed status map names bits and categories that exist |
//! | R47 | response codes 0 to 127 have one class each; one with several meanings has words |
//! | R48 | a unit's code and classification are unique |
//! | R49 | a document is known, and every command has a place in one |
//! | R50 | readings exist, and those that concern data are used; trust agrees with them |
//! | R51 | group, effect, family, address and class are known words |
//! | R52 | data have at most 253 bytes; expected values and ranges fit their type |

use std::collections::BTreeSet;

use toml::Spanned;

use super::data::{Command, Data, Field, Form, Forms, Kind, Sourced};
use crate::rules::Findings;
use crate::types::{At, Doc, Problem, SETTLED};

/// Sets that only the code uses, and those that are printed for whoever needs them.
pub const BY_CODE: [&str; 12] = [
    "communication_error",
    "device_status",
    "device_variable",
    "rotork_variable",
    "dv_process_data",
    "dv_limit",
    "hart_ip_message_type",
    "hart_ip_message_id",
    "hart_ip_status",
    "hart_ip_master",
    "lock_device",
    "lock_status",
];
/// The set that the manufacturers make up.
pub const MAKERS: &str = "manufacturer";
const EFFECTS: [&str; 6] = ["reads", "config", "moves", "ends", "carries", "unknown"];
const GROUPS: [&str; 3] = ["universal", "common", "device"];
const REACH: [&str; 3] = ["long", "any", "broadcast"];
const PLACES: [&str; 4] = ["data", "code", "page", "none"];
/// Two of 255 bytes are the status.
const MOST: u16 = 253;

/// All violations.
pub fn check(data: &Data, docs: &[Doc]) -> Vec<Problem> {
    let mut rules = Rules {
        data,
        docs,
        found: Findings::default(),
        used: BTreeSet::new(),
        sets: BTreeSet::new(),
    };
    rules.commands();
    rules.status();
    rules.tables();
    rules.unused();
    rules.found.into()
}

pub(super) struct Rules<'a> {
    pub data: &'a Data,
    pub docs: &'a [Doc],
    pub found: Findings,
    /// Readings and sets that something names.
    pub used: BTreeSet<&'a str>,
    pub sets: BTreeSet<&'a str>,
}

pub(super) fn is_key(key: &str) -> bool {
    let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    key.starts_with(|c: char| c.is_ascii_lowercase()) && key.chars().all(good)
}

impl<'a> Rules<'a> {
    /// R40 for one key among those seen.
    pub fn key(&mut self, key: &'a str, seen: &mut BTreeSet<&'a str>, at: &At) {
        let fine = is_key(key) && seen.insert(key);
        self.found.unless(
            fine,
            "R40",
            at,
            format!("key {key:?} is odd or there twice"),
        );
    }

    /// R50 for the readings of something.
    pub fn readings(&mut self, ids: impl IntoIterator<Item = &'a str>, at: &At) {
        for id in ids.into_iter().filter(|id| !id.is_empty()) {
            let known = self.data.readings.iter().any(|(_, r)| r.id == id);
            self.found
                .unless(known, "R50", at, format!("no reading {id}"));
            self.used.insert(id);
        }
    }

    /// R50 for trust: a reading is needed where the print is not followed.
    pub fn trust(&mut self, trust: &str, reading: &str, at: &At) {
        let known = ["manual", "reading", "inferred"].contains(&trust);
        let fine = known && (trust == "manual" || !reading.is_empty());
        self.found
            .unless(fine, "R50", at, format!("trust {trust:?} needs a reading"));
    }

    /// R49.
    pub fn document(&mut self, doc: &str, at: &At) {
        let known = self.docs.iter().any(|d| d.key == doc);
        self.found
            .unless(known, "R49", at, format!("no document {doc:?}"));
    }

    /// R42.
    pub fn set(&mut self, set: &'a str, sort: &str, at: &At) {
        self.sets.insert(set);
        let known = self.data.sets.iter().find(|(_, s)| s.set == set);
        let fine = known.map_or(set == MAKERS && sort == "enum", |(_, s)| s.kind == sort);
        self.found
            .unless(fine, "R42", at, format!("no set {set:?} of {sort}"));
    }

    fn words(&mut self, words: &[String], known: &[&str], at: &At) {
        for word in words {
            let fine = known.contains(&word.as_str());
            self.found
                .unless(fine, "R51", at, format!("unknown word {word:?}"));
        }
    }

    fn commands(&mut self) {
        let data = self.data;
        let (mut numbers, mut keys) = (BTreeSet::new(), BTreeSet::new());
        for command in &data.commands.list {
            let at = data.at(command.span().start);
            let command = command.get_ref();
            let unique = numbers.insert(command.number);
            let text = format!("command {} is there twice", command.number);
            self.found.unless(unique, "R40", &at, text);
            self.key(&command.key, &mut keys, &at);
            self.command(command, &at);
        }
    }

    fn command(&mut self, command: &'a Command, at: &At) {
        self.readings(command.readings.iter().map(String::as_str), at);
        self.document(&command.layout, at);
        let placed = command.table.is_some() == command.page.is_some()
            && (command.table.is_some() || command.part.is_some());
        self.found.unless(
            placed,
            "R49",
            at,
            "a command needs table and page, or a part",
        );
        self.words(&command.effect, &EFFECTS, at);
        let families: Vec<&str> = self
            .data
            .families
            .iter()
            .map(|f| f.1.key.as_str())
            .collect();
        self.words(&command.families, &families, at);
        self.words(std::slice::from_ref(&command.group), &GROUPS, at);
        self.words(command.address.as_slice(), &REACH, at);
        self.codes(command, at);
        for forms in [&command.request, &command.response] {
            match forms {
                Forms::Same(of) => {
                    let known = of == "request" || self.data.command(of).is_some();
                    self.found
                        .unless(known, "R41", at, format!("no forms {of:?}"));
                }
                Forms::Own(forms) => {
                    let mut lengths = BTreeSet::new();
                    for form in forms {
                        self.form(form, &mut lengths, at);
                    }
                }
            }
        }
    }

    fn codes(&mut self, command: &Command, at: &At) {
        for (code, words) in &command.codes {
            let known = code
                .parse()
                .ok()
                .and_then(|code: u8| self.data.response(code));
            let fine = known.is_some_and(|k| !words.is_empty() || !k.label.is_empty());
            self.found
                .unless(fine, "R47", at, format!("code {code} needs words"));
        }
        let sourced = match &command.sourced {
            Sourced::Word(word) => word == "all",
            Sourced::Codes(codes) => {
                let listed = codes
                    .iter()
                    .all(|c| command.codes.contains_key(&c.to_string()));
                let why = command.readings.iter().any(|r| r == "G5" || r == "R28");
                listed && (why || codes.len() == command.codes.len())
            }
        };
        self.found.unless(
            sourced,
            "R47",
            at,
            "codes without a source need a reading, sourced ones must be listed",
        );
    }

    fn form(&mut self, form: &'a Form, lengths: &mut BTreeSet<u16>, at: &At) {
        self.readings(form.readings.iter().map(String::as_str), at);
        if let Some(effect) = &form.effect {
            self.words(effect, &EFFECTS, at);
        }
        self.fields(&form.fields, at);
        let (mut end, mut ends, mut open, mut repeat) = (0, vec![0], false, None);
        for field in &form.fields {
            match Kind::of(&field.kind, field.max) {
                Some(Kind::Repeat(most)) => {
                    let size: u16 = field.fields.iter().map(width).sum();
                    repeat = Some((size.max(1), u16::from(most)));
                }
                Some(Kind::Nibbles(_)) => open = true,
                _ => {}
            }
            end += width(field);
            ends.push(end);
        }
        for length in &form.lengths {
            let ends_well = match repeat {
                Some((size, most)) => {
                    let room = length.saturating_sub(end);
                    room.is_multiple_of(size) && (1..=most).contains(&(room / size))
                }
                None => open || ends.contains(length),
            };
            let fine = ends_well && lengths.insert(*length);
            self.found
                .unless(fine, "R41", at, format!("length {length} does not fit"));
            self.found
                .unless(*length <= MOST, "R52", at, format!("{length} bytes"));
        }
        let longest = form.lengths.iter().max();
        let whole = repeat.is_some() || open || longest == Some(&end);
        let text = format!("the fields have {end} bytes");
        self.found.unless(whole, "R41", at, text);
    }

    fn fields(&mut self, fields: &'a [Field], at: &At) {
        let (mut keys, mut unit) = (BTreeSet::new(), None);
        for field in fields {
            self.key(&field.key, &mut keys, at);
            self.readings(field.readings.iter().map(String::as_str), at);
            let text = format!("type {:?} of {}", field.kind, field.key);
            match Kind::of(&field.kind, field.max) {
                None => self.found.add("R42", at, text),
                Some(Kind::Named(_, set) | Kind::Nibbles(set)) => self.set(set, "enum", at),
                Some(Kind::Bits(_, set)) => self.set(set, "bits", at),
                Some(Kind::Unit) => unit = Some(field.key.as_str()),
                Some(Kind::Split) => self.parts(field, at),
                Some(Kind::Repeat(_)) => self.fields(&field.fields, at),
                Some(Kind::Unsigned(_)) => self.fits(field, at),
                Some(_) => {}
            }
            let of = field.of.as_deref();
            let fine = of.is_none_or(|of| unit == Some(of) && field.unit.is_empty());
            let text = format!("the unit of {} is not the last before it", field.key);
            self.found.unless(fine, "R43", at, text);
        }
    }

    fn parts(&mut self, field: &'a Field, at: &At) {
        let mut keys = BTreeSet::new();
        let mut bits: Vec<u8> = Vec::new();
        for part in &field.parts {
            self.key(&part.key, &mut keys, at);
            bits.extend(part.low..=part.high);
            if let Some(set) = part.kind.strip_prefix("enum:") {
                self.set(set, "enum", at);
            }
        }
        bits.sort_unstable();
        let text = format!("the parts of {} do not fill a byte", field.key);
        self.found
            .unless(bits.into_iter().eq(0..8_u8), "R41", at, text);
    }

    fn fits(&mut self, field: &Field, at: &At) {
        let room = 8 * u32::from(width(field));
        let fits = |n: i64| n >= 0 && n.checked_shr(room).unwrap_or(0) == 0;
        let fine = field.expected.is_none_or(|n| fits(i64::from(n)))
            && [field.min, field.max]
                .iter()
                .flatten()
                .all(|n| fits(i64::from(*n)));
        let text = format!("a limit of {} does not fit", field.key);
        self.found.unless(fine, "R52", at, text);
    }

    fn unused(&mut self) {
        let data = self.data;
        for (at, set) in &data.sets {
            let name = set.set.as_str();
            let used = self.sets.contains(name) || BY_CODE.contains(&name);
            self.found
                .unless(used, "R42", at, format!("set {name} is not used"));
        }
        for (at, reading) in &data.readings {
            let known = SETTLED.iter().any(|s| s.0 == reading.settled)
                && PLACES.contains(&reading.place.as_str());
            self.found
                .unless(known, "R50", at, "settled or place is no known word");
            let used = reading.place != "data" || self.used.contains(reading.id.as_str());
            let text = format!("{} is not used", reading.id);
            self.found.unless(used, "R50", at, text);
        }
    }
}

/// Bytes of a field; 0 for those of which there may be many.
pub(super) fn width(field: &Field) -> u16 {
    Kind::of(&field.kind, field.max).map_or(0, |kind| kind.width())
}

impl Data {
    /// The command with this number.
    pub fn command(&self, number: &str) -> Option<&Command> {
        let number: u16 = number.parse().ok()?;
        let mut all = self.commands.list.iter().map(Spanned::get_ref);
        all.find(|c| c.number == number)
    }

    /// What a response code means everywhere.
    pub fn response(&self, code: u8) -> Option<&super::data::Response> {
        let mut all = self.responses.iter().map(|(_, r)| r);
        all.find(|r| (r.first..=r.last).contains(&code))
    }
}
