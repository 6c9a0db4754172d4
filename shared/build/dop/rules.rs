//! The numbered rules that the objects must keep.
//!
//! | Rule | Demands |
//! |---|---|
//! | R00 | the file can be read (checked while reading) |
//! | R20 | a computed offset is the printed one, unless a reading says why not |
//! | R21 | the fields of a layout add up to its registers, a record to its stride; at most 512 |
//! | R22 | keys are lower snake case and unique among their neighbours |
//! | R23 | type, part, axis, setting, group, shape and command are known words |
//! | R24 | the unit is a known one; unit and scale stand only on numbers |
//! | R25 | a named set exists and suits; its values are unique; every set is used |
//! | R26 | readings exist; each is used, or says what it concerns |
//! | R27 | options are unique and have four bits; a request is the printed one, unless a reading says why not |
//! | R28 | layouts and their variants exist and are used |
//! | R29 | the objects are those of the manual, in order |
//! | R30 | no blanks around labels and notes; labels are not empty |
//! | R31 | every object and layout has a section, and the document is known |
//! | R32 | arrays have an axis and single values none; counted arrays fit the counter of their layout |
//! | R33 | trust is only written where no reading decides |
//! | R34 | the codes that the manual lists all have a name |

use std::collections::BTreeSet;

use toml::Spanned;

use super::Objects;
use super::data::{Choice, Data, Layout, Object, OneOrMany};
use super::place::{self, Placed};
use crate::rules::Findings;
use crate::types::{At, Doc, Problem};

/// The objects of the manual.
const IDS: [u16; 32] = [
    1, 2, 3, 4, 5, 6, 7, 201, 202, 203, 204, 205, 206, 207, 208, 209, 401, 402, 403, 404, 405, 601,
    602, 604, 605, 1003, 1004, 1005, 1006, 1007, 1202, 1203,
];
/// Units as they are printed beside a value.
pub const UNITS: [&str; 11] = [
    "", "%", "s", "min", "°C", "V", "Hz", "mG", "rpm", "turns", "starts/h",
];
const GROUPS: [&str; 6] = [
    "vibration",
    "position",
    "torque",
    "environment",
    "operation",
    "log",
];
const SHAPES: [&str; 9] = [
    "trend",
    "histogram",
    "profile",
    "cards",
    "axes",
    "log",
    "alarms",
    "identity",
    "clock",
];
pub const PARTS: [&str; 15] = [
    "points", "records", "max", "min", "avg", "lta", "open", "close", "bins", "when", "start",
    "end", "id", "category", "other",
];
pub const SETTINGS: [&str; 5] = [
    "dst_trend",
    "dst_statistics",
    "movement_position",
    "movement_speed",
    "movement_torque",
];
const COMMANDS: [&str; 5] = ["newest", "oldest", "older", "newer", "present"];
/// Readings that say why an offset is not the printed one, or why none is printed.
const MOVED: [&str; 3] = ["B2", "B4", "M6"];
/// Registers of a response.
const MOST: u16 = 512;

/// All violations.
pub fn check(objects: &Objects, docs: &[Doc]) -> Vec<Problem> {
    let mut rules = Rules {
        objects,
        data: &objects.data,
        found: Findings::default(),
    };
    let known = docs.iter().any(|d| d.key == "dop");
    rules.unless(known, "R31", 0, "no document `dop` in SOURCES.md");
    rules.objects();
    rules.layouts();
    rules.sets();
    rules.readings();
    rules.found.into()
}

/// `0+0.4 G`: from, step and unit, both numbers in tenths.
pub fn bins(text: &str) -> Option<(u16, u16, String)> {
    let (range, unit) = text.split_once(' ')?;
    let (from, step) = range.split_once('+')?;
    let tenths = |number: &str| {
        let (whole, tenth) = number.split_once('.').unwrap_or((number, "0"));
        let (whole, tenth): (u16, u16) = (whole.parse().ok()?, tenth.parse().ok()?);
        (tenth < 10).then_some(whole * 10 + tenth)
    };
    Some((tenths(from)?, tenths(step)?, unit.to_owned()))
}

/// True for a frozen identifier.
pub fn is_key(key: &str) -> bool {
    let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    key.starts_with(|c: char| c.is_ascii_lowercase()) && key.chars().all(good)
}

/// What is checked, and what was found.
pub struct Rules<'a> {
    objects: &'a Objects,
    pub data: &'a Data,
    found: Findings,
}

impl<'a> Rules<'a> {
    /// A rule is broken at this byte of the file, unless it is kept.
    pub fn unless(
        &mut self,
        kept: bool,
        rule: &'static str,
        offset: usize,
        text: impl Into<String>,
    ) {
        if !kept {
            let at: At = self.objects.at(offset);
            self.found.add(rule, &at, text);
        }
    }

    /// R22 for a list of keys.
    fn keys(&mut self, keys: impl Iterator<Item = (usize, &'a str)>) {
        let mut seen = BTreeSet::new();
        for (offset, key) in keys {
            self.unless(is_key(key), "R22", offset, format!("{key:?} is no key"));
            self.unless(
                seen.insert(key),
                "R22",
                offset,
                format!("{key} is there twice"),
            );
        }
    }

    /// R30.
    pub fn text(&mut self, offset: usize, text: &str, needed: bool) {
        let good = text.trim() == text && (!needed || !text.is_empty());
        self.unless(good, "R30", offset, format!("text {text:?}"));
    }

    /// R23.
    pub fn word(&mut self, offset: usize, words: &[&str], word: &str) {
        self.unless(
            words.contains(&word),
            "R23",
            offset,
            format!("unknown word {word:?}"),
        );
    }

    fn objects(&mut self) {
        let data = self.data;
        let ids: Vec<u16> = data.objects.iter().map(|o| o.get_ref().id).collect();
        self.unless(ids == IDS, "R29", 0, format!("objects {ids:?}"));
        self.keys(spans(&data.objects).map(|(at, o)| (at, o.key.as_str())));
        for (offset, object) in spans(&data.objects) {
            self.text(offset, &object.label, true);
            self.text(offset, &object.note, false);
            self.word(offset, &GROUPS, &object.group);
            self.word(offset, &SHAPES, &object.shape);
            self.unless(!object.section.is_empty(), "R31", offset, "no section");
            self.keys(spans(&object.options).map(|(at, c)| (at, c.key.as_str())));
            let mut options = BTreeSet::new();
            for (offset, choice) in spans(&object.options) {
                let fits = choice.option < 16 && options.insert(choice.option);
                self.unless(fits, "R27", offset, format!("option {}", choice.option));
                self.choice(offset, object, choice);
            }
            let any = !object.options.is_empty();
            self.unless(any, "R27", offset, "an object has an option");
        }
    }

    fn choice(&mut self, offset: usize, object: &Object, choice: &Choice) {
        let one = object.options.len() == 1;
        self.text(offset, &choice.label, !one);
        if let Some(command) = &choice.command {
            self.word(offset, &COMMANDS, command);
        }
        let mut ids = object.readings.iter().chain(&choice.readings);
        // Readings A are those of command words; M5 and M6 are about the commands of the logs.
        let explained = ids.any(|id| id.starts_with('A') || id == "M5" || id == "M6");
        let word = format!("0x{:04X}", choice.option << 12 | object.id);
        let kept = match &choice.printed {
            Some(printed) => *printed == word || explained,
            None => explained,
        };
        self.unless(
            kept,
            "R27",
            offset,
            format!("printed {:?}, computed {word}", choice.printed),
        );
        let layout = place::layout(self.data, &choice.layout);
        let variant = layout.and_then(|layout| place::variant(layout, choice.points));
        self.unless(
            variant.is_some(),
            "R28",
            offset,
            format!("no layout {} {:?}", choice.layout, choice.points),
        );
        for other in &choice.others {
            let layout = place::layout(self.data, other);
            self.unless(
                layout.is_some(),
                "R28",
                offset,
                format!("no layout {other}"),
            );
        }
    }

    fn layouts(&mut self) {
        let data = self.data;
        self.keys(spans(&data.layouts).map(|(at, l)| (at, l.key.as_str())));
        for (offset, layout) in spans(&data.layouts) {
            let used = data
                .objects
                .iter()
                .flat_map(|o| place::used(data, o.get_ref()))
                .any(|(l, _)| l.key == layout.key);
            self.unless(used, "R28", offset, format!("{} is not used", layout.key));
            self.unless(!layout.section.is_empty(), "R31", offset, "no section");
            let variants = place::variants(layout);
            let same = match &layout.words {
                OneOrMany::One(_) => layout.points.is_empty(),
                OneOrMany::Many(words) => words.len() == variants,
            };
            let steps = layout.steps.len() == layout.points.len();
            self.unless(
                same && steps,
                "R28",
                offset,
                "points, steps and words differ",
            );
            self.keys(spans(&layout.fields).map(|(at, f)| (at, f.key.as_str())));
            for (offset, field) in spans(&layout.fields) {
                self.field(offset, &layout.points, field);
            }
            for variant in 0..variants {
                let placed = place::place(layout, variant);
                self.size(offset, layout, variant, &placed);
                self.counted(layout, &placed);
                for placed in &placed {
                    self.offset(variant, placed);
                }
            }
        }
    }

    /// R21.
    fn size(&mut self, offset: usize, layout: &Layout, variant: usize, placed: &[Placed<'_>]) {
        let words = layout.words.get(variant).copied().unwrap_or_default();
        let end = placed.last().map_or(0, Placed::end);
        let first = placed.iter().find(|p| p.field.record);
        let sum = match (layout.record, first) {
            (Some(record), Some(first)) => {
                let stride = end - first.at;
                self.unless(
                    stride == record.stride,
                    "R21",
                    offset,
                    format!("a record has {stride} registers, not {}", record.stride),
                );
                let together = placed
                    .iter()
                    .skip_while(|p| !p.field.record)
                    .all(|p| p.field.record);
                self.unless(together, "R21", offset, "a record has a hole");
                first.at + record.stride * record.max
            }
            (None, None) => end,
            _ => {
                self.unless(false, "R21", offset, "records without fields of records");
                end
            }
        };
        self.unless(
            sum == words && words <= MOST,
            "R21",
            offset,
            format!(
                "{}: {sum} registers, declared are {words}",
                place::key(layout, variant)
            ),
        );
    }

    /// R20.
    fn offset(&mut self, variant: usize, placed: &Placed<'_>) {
        let printed = placed.field.printed.get(variant);
        let Some(printed) = printed else {
            return self.unless(false, "R20", placed.offset, "too few printed offsets");
        };
        let computed = placed.printed();
        let explained = placed
            .field
            .readings
            .iter()
            .any(|id| MOVED.contains(&id.as_str()));
        self.unless(
            *printed == computed || explained,
            "R20",
            placed.offset,
            format!(
                "{}: printed {printed:?}, computed {computed:?}",
                placed.field.key
            ),
        );
    }

    /// R32 for arrays of which only some points are valid.
    fn counted(&mut self, layout: &Layout, placed: &[Placed<'_>]) {
        let has = |part: &str| {
            layout
                .fields
                .iter()
                .any(|f| f.get_ref().part.as_deref() == Some(part))
        };
        let mut next = 0;
        for placed in placed {
            if let Some(first) = placed.field.first {
                // An array goes on where the one before ended, or begins anew.
                let fits = has("points") && (first == 0 || first == next);
                self.unless(fits, "R32", placed.offset, format!("first {first}"));
                next = first + placed.count;
            }
        }
    }
}

/// Records with the byte at which each is written.
pub fn spans<T>(items: &[Spanned<T>]) -> impl Iterator<Item = (usize, &T)> {
    items.iter().map(|item| (item.span().start, item.get_ref()))
}
