//! The numbered rules that a map must keep.
//!
//! | Rule | Demands |
//! |---|---|
//! | R00 | every cell can be read (checked while reading) |
//! | R01 | the rows of a table cover it from address 0 without hole or overlap, for each model |
//! | R02 | keys are lower snake case and unique within the table of a model |
//! | R03 | every row has a page, every file a known document |
//! | R04 | a named set exists and suits the type; every set is used |
//! | R05 | codes of a set are unique; each lies in the range of some row, and each code of a range has a name; codes with gaps need no range; a run of codes has `{}` in its label |
//! | R06 | a scale stands only on numbers and is not zero |
//! | R07 | the unit is a known one and stands only on numbers |
//! | R08 | the number of words fits the type, and the address space |
//! | R09 | `min` and `max` come together, in order, and fit the type |
//! | R10 | trust is `reading` exactly where a reading is named; readings exist and are used |
//! | R11 | a writable holding register has a user level, if the device has levels |
//! | R12 | bits of a set are unique and fit the words of the rows that use it |
//! | R13 | reserved rows are read-only, bits and registers of read-only tables too |
//! | R14 | no blanks around labels, notes and groups; labels and groups are not empty |
//! | R15 | a reading mentioned in a note exists |
//! | R16 | a bit names both of its states or none |
//! | R17 | a group has at least two rows (a single one is a misspelt group) |
//! | R18 | the models of a row are among those of its file |
//! | R19 | functions are unique for each model; only FC 08 has sub-functions; each has a page and a known document |

use std::collections::BTreeSet;

use crate::sets;
use crate::types::{At, Data, Device, Doc, Problem, Row, TABLES, TRUST, UNITS};

/// The problems found so far.
#[derive(Default)]
pub struct Findings(Vec<Problem>);

impl Findings {
    /// A rule is broken here.
    pub fn add(&mut self, rule: &'static str, at: &At, text: impl Into<String>) {
        self.0.push(Problem {
            at: at.clone(),
            rule,
            text: text.into(),
        });
    }

    /// A rule is broken here, unless it is kept.
    pub fn unless(&mut self, kept: bool, rule: &'static str, at: &At, text: impl Into<String>) {
        if !kept {
            self.add(rule, at, text);
        }
    }
}

impl From<Findings> for Vec<Problem> {
    fn from(found: Findings) -> Self {
        found.0
    }
}

/// All violations, in no particular order of importance.
pub fn check(data: &Data) -> Vec<Problem> {
    let mut found = Findings::default();
    for device in &data.devices {
        coverage(device, &mut found);
        sources(device, &data.docs, &mut found);
        for row in &device.rows {
            shape(row, &mut found);
            access(device, row, &mut found);
            texts(row, &mut found);
        }
        sets::check(device, &mut found);
        readings(device, &mut found);
        groups(device, &mut found);
        models(device, &mut found);
        functions(device, &data.docs, &mut found);
    }
    found.0
}

/// R01, R02.
fn coverage(device: &Device, found: &mut Findings) {
    for (position, model) in device.models.iter().enumerate() {
        for (table, (name, _)) in TABLES.iter().enumerate() {
            let mut rows = device.rows_of(position, table);
            rows.sort_by_key(|(_, row)| row.address);
            let (mut next, mut keys) = (0, BTreeSet::new());
            for (_, row) in rows {
                let starts = u32::from(row.address);
                let text = format!("{} {name}: starts at {starts}, expected {next}", model.key);
                found.unless(starts == next, "R01", &row.at, text);
                next = row.end();
                let text = format!("{} {name}: key {} is taken", model.key, row.key);
                found.unless(keys.insert(&row.key), "R02", &row.at, text);
            }
        }
    }
    let members = device
        .members
        .iter()
        .flat_map(|m| [(&m.at, &m.set), (&m.at, &m.key)]);
    for (at, key) in device.rows.iter().map(|r| (&r.at, &r.key)).chain(members) {
        found.unless(
            is_snake_case(key),
            "R02",
            at,
            format!("key {key:?} is no snake case"),
        );
    }
}

fn is_snake_case(key: &str) -> bool {
    key.starts_with(|c: char| c.is_ascii_lowercase())
        && key.split('_').all(|part| {
            !part.is_empty()
                && part
                    .chars()
                    .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit())
        })
}

/// R03.
fn sources(device: &Device, docs: &[Doc], found: &mut Findings) {
    for file in &device.files {
        let known = docs.iter().any(|d| d.key == file.doc);
        found.unless(
            known,
            "R03",
            &file.at,
            format!("unknown document {:?}", file.doc),
        );
        found.unless(
            !file.part.is_empty(),
            "R03",
            &file.at,
            "the table is not named",
        );
    }
    for row in &device.rows {
        found.unless(row.page.is_some(), "R03", &row.at, "no page");
    }
}

/// R06 to R09.
fn shape(row: &Row, found: &mut Findings) {
    let (kind, at) = (row.kind, &row.at);
    if let Some(scale) = row.scale {
        found.unless(kind.number, "R06", at, format!("{} has no scale", kind.key));
        found.unless(
            scale.num > 0 && scale.den > 0,
            "R06",
            at,
            "the scale is zero",
        );
    }
    let unit = row.unit.as_str();
    found.unless(
        UNITS.contains(&unit),
        "R07",
        at,
        format!("unknown unit {unit:?}"),
    );
    found.unless(
        kind.number || unit.is_empty(),
        "R07",
        at,
        format!("{} has no unit", kind.key),
    );
    let (fewest, most) = kind.words;
    let fits = (fewest..=most).contains(&row.words) && row.end() <= 0x1_0000;
    found.unless(
        fits,
        "R08",
        at,
        format!("{} of {} word(s)", kind.key, row.words),
    );
    match (row.min, row.max) {
        (None, None) => {}
        (Some(min), Some(max)) => {
            let fits = kind
                .range
                .is_some_and(|(low, high)| low <= i64::from(min) && i64::from(max) <= high);
            found.unless(
                min <= max && fits,
                "R09",
                at,
                format!("{min} to {max}: {}", kind.key),
            );
        }
        _ => found.add("R09", at, "min and max come together"),
    }
}

/// R11, R13.
fn access(device: &Device, row: &Row, found: &mut Findings) {
    let table = device.table_of(row);
    let has_levels = device.rows.iter().any(|r| r.level.is_some());
    let needs_level = has_levels && table == "holding" && row.is_writable();
    found.unless(
        !needs_level || row.level.is_some(),
        "R11",
        &row.at,
        "no user level",
    );
    let read_only = row.is_reserved() || matches!(table, "discrete" | "input");
    found.unless(
        !(read_only && row.is_writable()),
        "R13",
        &row.at,
        "must be read-only",
    );
}

/// R14.
fn texts(row: &Row, found: &mut Findings) {
    for text in [&row.label, &row.note, &row.group] {
        found.unless(
            text.trim() == text,
            "R14",
            &row.at,
            format!("blanks around {text:?}"),
        );
    }
    found.unless(!row.label.is_empty(), "R14", &row.at, "no label");
    found.unless(!row.group.is_empty(), "R14", &row.at, "no group");
}

/// R10, R15.
fn readings(device: &Device, found: &mut Findings) {
    let known: BTreeSet<&str> = device.readings.iter().map(|r| r.id.as_str()).collect();
    let mut used = BTreeSet::new();
    let absent = device.models.iter().filter(|m| !m.reading.is_empty());
    let rows = device.rows.iter().map(|r| (&r.at, &r.reading));
    let functions = device.functions.iter().map(|f| (&f.at, &f.reading));
    let others = device.cited.iter().map(|(at, id)| (at, id));
    let cited = rows
        .chain(functions)
        .chain(others)
        .filter(|(_, id)| !id.is_empty());
    for (at, id) in absent.map(|m| (&m.at, &m.reading)).chain(cited) {
        found.unless(
            known.contains(id.as_str()),
            "R10",
            at,
            format!("no reading {id}"),
        );
        used.insert(id.as_str());
    }
    let prefix = device.readings.first().map_or("", |r| letters(&r.id));
    for row in &device.rows {
        let trusted = TRUST.get(row.trust).is_some_and(|t| t.0 == "reading");
        let text = "trust and reading disagree";
        found.unless(trusted != row.reading.is_empty(), "R10", &row.at, text);
        for id in mentioned(&row.note, prefix) {
            found.unless(
                known.contains(id),
                "R15",
                &row.at,
                format!("no reading {id}"),
            );
            used.insert(id);
        }
    }
    for reading in &device.readings {
        let unused = format!("{} is not used", reading.id);
        found.unless(
            used.contains(reading.id.as_str()),
            "R10",
            &reading.at,
            unused,
        );
    }
}

/// The letters that an id begins with.
fn letters(id: &str) -> &str {
    id.trim_end_matches(|c: char| c.is_ascii_digit())
}

/// The reading ids in a note: words of the letters of this device's ids, and digits.
fn mentioned<'a>(note: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    note.split(|c: char| !c.is_ascii_alphanumeric())
        .filter(move |word| !prefix.is_empty() && *word != prefix && letters(word) == prefix)
}

/// R17.
fn groups(device: &Device, found: &mut Findings) {
    for row in &device.rows {
        let alone = device.rows.iter().filter(|r| r.group == row.group).count() == 1;
        found.unless(
            !alone,
            "R17",
            &row.at,
            format!("group {:?} has one row", row.group),
        );
    }
}

/// R18.
fn models(device: &Device, found: &mut Findings) {
    for row in &device.rows {
        let Some(file) = device.files.get(row.file) else {
            continue;
        };
        let inside = row
            .models
            .iter()
            .all(|m| (file.first..=file.last).contains(m));
        let text = format!("a model that {} is not for", file.file);
        found.unless(inside, "R18", &row.at, text);
    }
}

/// R19.
fn functions(device: &Device, docs: &[Doc], found: &mut Findings) {
    let mut seen = BTreeSet::new();
    for f in &device.functions {
        let at = &f.at;
        for model in f.first..=f.last {
            let new = seen.insert((model, f.code, f.sub));
            found.unless(new, "R19", at, format!("{} is there twice", f.code));
        }
        let sub = f.sub.is_none() || f.code == 8;
        found.unless(sub, "R19", at, format!("{} has no sub-functions", f.code));
        let known = docs.iter().any(|d| d.key == f.doc);
        found.unless(known, "R19", at, format!("unknown document {:?}", f.doc));
        let placed = f.page.is_some() && !f.part.is_empty() && f.first <= f.last;
        found.unless(placed, "R19", at, "no page, no part or no model");
        found.unless(f.code < 0x80, "R19", at, "no function code");
        let named = !f.label.is_empty() && f.label.trim() == f.label && f.note.trim() == f.note;
        found.unless(named, "R19", at, "no label, or blanks around it");
    }
}
