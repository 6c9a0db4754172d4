//! The numbered rules that the files of function 20 and the health list must keep.
//!
//! | Rule | Demands |
//! |---|---|
//! | I01 | files do not overlap, are in order, and have unique keys |
//! | I02 | a layout exists, and every layout is used |
//! | I03 | the bytes that the manual prints are those of the fields |
//! | I04 | type, words, count, scale and unit of a field fit together; keys are unique in a part |
//! | I05 | a named set exists and suits the type; codes of a set are unique and all used |
//! | I06 | trust is `reading` exactly where a reading is named; readings exist, once; those mentioned in a note exist |
//! | I07 | a log begins with its number of entries |
//! | I08 | every alarm and warning, as bit and as code, has one line in the health list, and lines name what exists |
//! | I09 | no blanks around texts; reasons and checks are not empty |
//! | I10 | a mirror and its home are values of the map, of one type and length, or a bit of bits |

use std::collections::BTreeSet;

use super::data::{Data, Field};
use crate::rules::Findings;
use crate::types::{At, Device, Problem, Row, UNITS};

/// Types and the words of one value; `None` for any number.
pub const KINDS: [(&str, Option<u16>); 7] = [
    ("u16", Some(1)),
    ("i16", Some(1)),
    ("enum", Some(1)),
    ("bits", None),
    ("stamp", Some(2)),
    ("ascii", None),
    ("unused", None),
];
/// Letters of NE 107, the worst first.
pub const STATUS: [(&str, &str); 4] = [
    ("F", "Failure"),
    ("C", "CheckFunction"),
    ("S", "OutOfSpecification"),
    ("M", "Maintenance"),
];
/// Sets whose every bit or code needs a line.
const COMPLETE: [&str; 6] = [
    "alarms_1",
    "alarms_2",
    "alarms_3",
    "warnings",
    "alarm_code",
    "warning_code",
];

/// All violations.
pub fn check(data: &Data, device: &Device) -> Vec<Problem> {
    let mut found = Findings::default();
    files(data, &mut found);
    for (at, field) in &data.fields {
        shape(data, device, at, field, &mut found);
    }
    readings(data, device, &mut found);
    health(data, device, &mut found);
    mirrors(data, device, &mut found);
    found.into()
}

/// I01, I02, I03, I07.
fn files(data: &Data, found: &mut Findings) {
    let mut before = 0;
    let mut keys = BTreeSet::new();
    for (at, file) in &data.files {
        found.unless(
            before < file.first && file.first <= file.last,
            "I01",
            at,
            "overlaps the file before, or is out of order",
        );
        before = file.last;
        found.unless(keys.insert(&file.key), "I01", at, "key is there twice");
        let head = data.words(&file.layout, "head");
        let entry = data.words(&file.layout, "entry");
        found.unless(
            file.layout.is_empty() || head > 0,
            "I02",
            at,
            format!("no layout {:?}", file.layout),
        );
        for (printed, words, part) in [(file.head, head, "head"), (file.entry, entry, "entry")] {
            found.unless(
                printed.unwrap_or(0) == words * 2,
                "I03",
                at,
                format!("{part}: {printed:?} bytes printed, {} of fields", words * 2),
            );
        }
        let first = data.part(&file.layout, "head").next();
        found.unless(
            entry == 0 || first.is_some_and(|f| f.key == "count" && f.r#type == "u16"),
            "I07",
            at,
            "a log begins with its number of entries",
        );
        let known = ["single", "curves", "card"].contains(&file.numbering.as_str());
        found.unless(known, "I01", at, "numbering is single, curves or card");
    }
    for (at, field) in &data.fields {
        let used = data.files.iter().any(|(_, f)| f.layout == field.layout);
        found.unless(used, "I02", at, "no file has this layout");
    }
}

/// I04, I05.
fn shape(data: &Data, device: &Device, at: &At, field: &Field, found: &mut Findings) {
    let kind = KINDS.iter().find(|k| k.0 == field.r#type);
    found.unless(
        kind.is_some_and(|k| k.1.is_none_or(|words| words == field.words))
            && field.words > 0
            && field.count > 0,
        "I04",
        at,
        "words do not fit the type",
    );
    found.unless(
        (field.count > 1) == field.from.is_some()
            && field.from.is_some() == field.label.contains("{}"),
        "I04",
        at,
        "a run of values, and nothing else, has `from` and {} in its label",
    );
    let number = matches!(field.r#type.as_str(), "u16" | "i16");
    let scaled = field.scale.is_empty() || crate::read::scale(&field.scale).is_some();
    found.unless(
        scaled && (number || (field.unit.is_empty() && field.scale.is_empty())),
        "I04",
        at,
        "only numbers have a scale and a unit",
    );
    found.unless(
        UNITS.contains(&field.unit.as_str()),
        "I04",
        at,
        "unknown unit",
    );
    found.unless(
        field.min.is_some() == field.max.is_some() && field.min <= field.max,
        "I04",
        at,
        "min and max come together, in order",
    );
    let same = data
        .part(&field.layout, &field.part)
        .filter(|f| f.key == field.key);
    found.unless(same.count() == 1, "I04", at, "key is there twice");
    found.unless(
        ["head", "entry"].contains(&field.part.as_str()),
        "I04",
        at,
        "part is head or entry",
    );
    let (coded, bits) = (field.r#type == "enum", field.r#type == "bits");
    let own = data.codes.iter().any(|(_, c)| c.set == field.set);
    let of_map = device.members.iter().find(|m| m.set == field.set);
    let suits = match (own, of_map) {
        (true, None) => coded,
        (false, Some(member)) => (coded || bits) && member.bits == bits,
        (false, None) => field.set.is_empty() && !coded && !bits,
        (true, Some(_)) => false,
    };
    found.unless(suits, "I05", at, format!("set {:?}", field.set));
}

/// I05, I06.
fn readings(data: &Data, device: &Device, found: &mut Findings) {
    for (at, code) in &data.codes {
        let same = data
            .codes
            .iter()
            .filter(|(_, c)| c.set == code.set && (c.value == code.value || c.key == code.key));
        found.unless(same.count() == 1, "I05", at, "code is there twice");
        let used = data.fields.iter().any(|(_, f)| f.set == code.set) || code.set == "card";
        found.unless(used, "I05", at, "no field has this set");
    }
    let known = |id: &str| {
        data.readings.iter().any(|(_, r)| r.id == id) || device.readings.iter().any(|r| r.id == id)
    };
    for (at, reading) in &data.readings {
        let same = data.readings.iter().filter(|(_, r)| r.id == reading.id);
        let twice = same.count() > 1 || device.readings.iter().any(|r| r.id == reading.id);
        found.unless(!twice, "I06", at, "reading is there twice");
        let settled = ["yes", "likely", "no"].contains(&reading.settled.as_str());
        found.unless(settled, "I06", at, "settled is yes, likely or no");
    }
    for (at, field) in &data.fields {
        let named = !field.reading.is_empty();
        found.unless(
            (field.trust == "reading") == named && ["reading", "manual"].contains(&&*field.trust),
            "I06",
            at,
            "trust is reading exactly where one is named",
        );
        found.unless(
            !named || known(&field.reading),
            "I06",
            at,
            "no such reading",
        );
        mentioned(&field.note, at, known, found);
    }
    for (at, file) in &data.files {
        let named = !file.reading.is_empty();
        found.unless(!named || known(&file.reading), "I06", at, "no such reading");
        mentioned(&file.note, at, known, found);
    }
}

/// I06: `E42` in a note is a reading.
fn mentioned(note: &str, at: &At, known: impl Fn(&str) -> bool, found: &mut Findings) {
    let words = note.split(|c: char| !c.is_ascii_alphanumeric());
    for word in words.filter(|w| w.len() == 3 && w.starts_with('E')) {
        let digits = word.bytes().skip(1).all(|b| b.is_ascii_digit());
        found.unless(
            !digits || known(word),
            "I06",
            at,
            format!("no reading {word}"),
        );
    }
}

/// I08, I09.
fn health(data: &Data, device: &Device, found: &mut Findings) {
    let mut seen = BTreeSet::new();
    for (at, line) in &data.health {
        let exists = device
            .members
            .iter()
            .any(|m| m.set == line.set && m.key == line.key);
        found.unless(
            exists,
            "I08",
            at,
            format!("no {} in {}", line.key, line.set),
        );
        let once = seen.insert((&line.set, &line.key));
        found.unless(once, "I08", at, "is there twice");
        let known = STATUS.iter().any(|s| s.0 == line.status);
        found.unless(known, "I08", at, "status is F, C, S or M");
        for text in [&line.reason, &line.check] {
            let clean = !text.is_empty() && text.trim() == text;
            found.unless(clean, "I09", at, "a text is empty or has blanks around it");
        }
    }
    for member in &device.members {
        let none = !member.bits && member.value == 0;
        if COMPLETE.contains(&member.set.as_str()) && !none {
            let there = seen.contains(&(&member.set, &member.key));
            found.unless(there, "I08", &member.at, "has no line in health.csv");
        }
    }
}

/// I10.
fn mirrors(data: &Data, device: &Device, found: &mut Findings) {
    // A model may have something else at the address of another.
    let rows = |table: &str, address: u16| -> Vec<&Row> {
        device
            .rows
            .iter()
            .filter(|r| device.table_of(r) == table && r.address == address)
            .collect()
    };
    for (at, mirror) in &data.mirrors {
        let home = rows("holding", mirror.home);
        let fits = rows(&mirror.table, mirror.address).iter().any(|copy| {
            home.iter().any(|home| match mirror.bit {
                Some(_) => home.kind.key == "bits" && copy.kind.key == "bool",
                None => copy.kind.key == home.kind.key && copy.words == home.words,
            })
        });
        let text = "mirror and home are not of one type and length";
        found.unless(fits, "I10", at, text);
    }
}
