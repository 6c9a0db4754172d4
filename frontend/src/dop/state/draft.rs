//! A profile while it is being edited: the texts of a form, and what is wrong with them.

use serde_json::Value;
use shared::dop::Profile;

use crate::state::json::quoted;

/// What is typed into a field of the form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// Any text.
    Text,
    /// A whole number.
    Number,
    /// One of these values, with the words for it.
    Choice(&'static [(&'static str, &'static str)]),
}

/// A field of the form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Spec {
    /// The key in the file.
    pub key: &'static str,
    /// What people read.
    pub label: &'static str,
    /// What is typed.
    pub entry: Entry,
    /// What holds while it is empty.
    pub default: &'static str,
    /// The reading that says why it is open, empty if none does.
    pub reading: &'static str,
}

const fn spec(
    key: &'static str,
    label: &'static str,
    entry: Entry,
    default: &'static str,
    reading: &'static str,
) -> Spec {
    Spec {
        key,
        label,
        entry,
        default,
        reading,
    }
}

const YES_NO: &[(&str, &str)] = &[("true", "yes"), ("false", "no")];

/// The sections of the form.
pub const SECTIONS: [(&str, &[Spec]); 7] = [
    ("Site", &[spec("name", "Name", Entry::Text, "none", "")]),
    (
        "Registers",
        &[
            spec(
                "registers.request",
                "Request",
                Entry::Number,
                "not configured",
                "M7",
            ),
            spec(
                "registers.indicators",
                "User indicators",
                Entry::Number,
                "not configured",
                "M7",
            ),
            spec(
                "registers.status",
                "Status",
                Entry::Number,
                "not configured",
                "M7",
            ),
            spec(
                "registers.count",
                "Data count",
                Entry::Number,
                "not configured",
                "M7",
            ),
            spec(
                "registers.response",
                "Response",
                Entry::Number,
                "not configured",
                "M7",
            ),
            spec(
                "table",
                "Read from",
                Entry::Choice(&[
                    ("holding", "holding registers"),
                    ("input", "input registers"),
                ]),
                "holding registers",
                "M7",
            ),
            spec(
                "request_function",
                "Function that writes the request",
                Entry::Choice(&[
                    ("6", "6, single register"),
                    ("16", "16, multiple registers"),
                ]),
                "6, single register",
                "",
            ),
            spec(
                "status.shift",
                "Lowest status bit",
                Entry::Choice(&[("11", "11"), ("12", "12"), ("13", "13")]),
                "learned",
                "M2",
            ),
        ],
    ),
    (
        "Words and times",
        &[
            spec(
                "words.low_word_first",
                "Low word first",
                Entry::Choice(YES_NO),
                "yes",
                "C17",
            ),
            spec(
                "words.text_low_byte_first",
                "First character in the low byte",
                Entry::Choice(YES_NO),
                "yes",
                "C17",
            ),
            spec(
                "words.byte_swap",
                "Bytes swapped on the way",
                Entry::Choice(YES_NO),
                "no",
                "C17",
            ),
            spec(
                "time.epoch",
                "Seconds from 1970 to time 0",
                Entry::Number,
                "0",
                "C16",
            ),
            spec(
                "time.unit",
                "One count of time",
                Entry::Choice(&[("s", "a second"), ("ms", "a millisecond")]),
                "a second",
                "C16",
            ),
        ],
    ),
    (
        "Units and scales",
        &[
            spec(
                "temperature",
                "Temperatures",
                Entry::Choice(&[("degC", "°C"), ("degF", "°F")]),
                "°C",
                "C4",
            ),
            spec(
                "scales.dst_trend",
                "Counts per turn, 203 and 204",
                Entry::Number,
                "1000",
                "C8",
            ),
            spec(
                "scales.dst_statistics",
                "Counts per turn, 205 and 206",
                Entry::Number,
                "10000",
                "C8",
            ),
            spec(
                "scales.movement_position",
                "Counts per % of position, 1203",
                Entry::Number,
                "1",
                "C14",
            ),
            spec(
                "scales.movement_speed",
                "Counts per rpm, 1203",
                Entry::Number,
                "1",
                "C14",
            ),
            spec(
                "scales.movement_torque",
                "Counts per % of torque, 1203",
                Entry::Number,
                "1",
                "C14",
            ),
        ],
    ),
    (
        "Options of the logs",
        &[
            spec("log.newest", "Newest records", Entry::Number, "0", "M5"),
            spec("log.oldest", "Oldest records", Entry::Number, "1", "M5"),
            spec("log.older", "Older records", Entry::Number, "2", "M5"),
            spec("log.newer", "Newer records", Entry::Number, "3", "M5"),
            spec("log.present", "Is there a log", Entry::Number, "4", "M5"),
        ],
    ),
    (
        "Reading",
        &[
            spec(
                "reading.max_registers",
                "Registers in one read",
                Entry::Number,
                "125",
                "M8",
            ),
            spec(
                "reading.poll_ms",
                "Pause between two looks, ms",
                Entry::Number,
                "250",
                "M9",
            ),
            spec(
                "reading.timeout_ms",
                "Longest busy time, ms",
                Entry::Number,
                "10000",
                "M9",
            ),
            spec(
                "reading.retries",
                "Tries after a failure",
                Entry::Number,
                "2",
                "M9",
            ),
            spec(
                "reading.log_limit",
                "Requests of one log",
                Entry::Number,
                "10000",
                "M5",
            ),
        ],
    ),
    ("Names of bits", &[]),
];

/// The lists of names: key, title, number of bits, reading.
pub const LISTS: [(&str, &str, u8, &str); 3] = [
    ("indicators", "User indicators", 64, "M3"),
    ("alarms", "Alarms", 32, "M4"),
    ("warnings", "Warnings", 32, "M4"),
];

/// The name of a bit as it is typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BitRow {
    /// Its number.
    pub bit: String,
    /// Its name.
    pub name: String,
    /// Letter of its category, empty for none.
    pub ne107: String,
}

/// The form.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Draft {
    /// Keys with what is written beside them, by key.
    texts: Vec<(String, String)>,
    /// Rows of the three lists.
    pub bits: [Vec<BitRow>; 3],
}

impl Draft {
    /// The form of a profile: what it sets; everything else is empty.
    #[must_use]
    pub fn of(profile: &Profile) -> Self {
        let value = serde_json::from_str::<Value>(&profile.to_json()).unwrap_or_default();
        let mut draft = Self::default();
        for spec in specs() {
            let pointer = format!("/{}", spec.key.replace('.', "/"));
            if let Some(text) = value.pointer(&pointer).and_then(text_of) {
                draft.set(spec.key, text);
            }
        }
        for (rows, (key, ..)) in draft.bits.iter_mut().zip(LISTS) {
            let list = value.get(key).and_then(Value::as_array);
            let text =
                |entry: &Value, key: &str| entry.get(key).and_then(text_of).unwrap_or_default();
            *rows = list.map_or_else(Vec::new, |list| {
                list.iter()
                    .map(|entry| BitRow {
                        bit: text(entry, "bit"),
                        name: text(entry, "name"),
                        ne107: text(entry, "ne107"),
                    })
                    .collect()
            });
        }
        draft
    }

    /// The text of a field.
    #[must_use]
    pub fn get(&self, key: &str) -> &str {
        match self.place(key) {
            Ok(at) => &self.texts[at].1,
            Err(_) => "",
        }
    }

    /// Changes the text of a field.
    pub fn set(&mut self, key: &str, text: String) {
        match (self.place(key), text.trim().is_empty()) {
            (Ok(at), true) => drop(self.texts.remove(at)),
            (Ok(at), false) => self.texts[at].1 = text,
            (Err(_), true) => {}
            (Err(at), false) => self.texts.insert(at, (key.to_owned(), text)),
        }
    }

    /// Where a key is, or would be.
    fn place(&self, key: &str) -> Result<usize, usize> {
        self.texts.binary_search_by(|(k, _)| k.as_str().cmp(key))
    }

    /// Fields by the section of the file that they stand in, in the order of the form.
    fn sections(&self) -> Vec<(&'static str, Vec<(&'static str, &str)>)> {
        let mut all: Vec<(&'static str, Vec<(&'static str, &str)>)> = Vec::new();
        for spec in specs() {
            let text = self.get(spec.key);
            if text.is_empty() {
                continue;
            }
            let (section, key) = spec.key.split_once('.').unwrap_or(("", spec.key));
            let same = all
                .iter_mut()
                .find(|s| !section.is_empty() && s.0 == section);
            match same {
                Some((_, keys)) => keys.push((key, text)),
                None => all.push((section, vec![(key, text)])),
            }
        }
        all
    }

    /// The file that the form stands for, right or wrong: the check tells.
    #[must_use]
    pub fn to_json(&self) -> String {
        let mut out =
            String::from("{\n  \"format\": \"valvescope-dop-profile\",\n  \"version\": 1");
        for (section, keys) in self.sections() {
            out.push_str(",\n  ");
            if section.is_empty() {
                let (key, text) = &keys[0];
                member(&mut out, key, text);
                continue;
            }
            quoted(&mut out, section);
            out.push_str(": {");
            for (at, (key, text)) in keys.iter().enumerate() {
                out.push_str(if at == 0 { "\n    " } else { ",\n    " });
                member(&mut out, key, text);
            }
            out.push_str("\n  }");
        }
        for (rows, (key, ..)) in self.bits.iter().zip(LISTS) {
            if rows.is_empty() {
                continue;
            }
            out.push_str(&format!(",\n  \"{key}\": ["));
            for (at, row) in rows.iter().enumerate() {
                out.push_str(if at == 0 {
                    "\n    {\"bit\": "
                } else {
                    ",\n    {\"bit\": "
                });
                value(&mut out, &row.bit, false);
                out.push_str(", \"name\": ");
                quoted(&mut out, &row.name);
                if !row.ne107.is_empty() {
                    out.push_str(", \"ne107\": ");
                    quoted(&mut out, &row.ne107);
                }
                out.push('}');
            }
            out.push_str("\n  ]");
        }
        out.push_str("\n}\n");
        out
    }
}

/// All fields of the form.
pub fn specs() -> impl Iterator<Item = &'static Spec> {
    SECTIONS.iter().flat_map(|section| section.1)
}

fn member(out: &mut String, key: &str, text: &str) {
    quoted(out, key);
    out.push_str(": ");
    value(
        out,
        text,
        key == "name" || key == "unit" || key == "table" || key == "temperature",
    );
}

/// A number or a truth value as it is; anything else in quotes, so that the check can name it.
fn value(out: &mut String, text: &str, is_text: bool) {
    let text = text.trim();
    let plain = !is_text && (text.parse::<i64>().is_ok() || matches!(text, "true" | "false"));
    if plain {
        // A plus sign and zeros before a number are none of JSON.
        match text.parse::<i64>() {
            Ok(number) => out.push_str(&number.to_string()),
            Err(_) => out.push_str(text),
        }
    } else {
        quoted(out, text);
    }
}

fn text_of(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        Value::Bool(truth) => Some(truth.to_string()),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::dop::profile::{BitWord, Ne107, Setting, Temperature};

    #[test]
    fn a_form_becomes_a_profile_and_back() {
        let mut draft = Draft::default();
        draft.set("name", "12".into());
        draft.set("registers.request", " 500 ".into());
        draft.set("registers.response", "510".into());
        draft.set("temperature", "degF".into());
        draft.set("words.byte_swap", "true".into());
        draft.set("log.older", "5".into());
        draft.bits[0].push(BitRow {
            bit: "3".into(),
            name: "Vibration \"HI\"".into(),
            ne107: "S".into(),
        });
        let profile = Profile::from_json(&draft.to_json()).unwrap();
        assert_eq!(profile.name, "12");
        assert_eq!(profile.registers.request, Some(500));
        assert_eq!(profile.temperature(), Temperature::DegF);
        assert!(profile.byte_swap() && !profile.is_assumed(Setting::ByteSwap));
        assert!(profile.is_assumed(Setting::LowWordFirst));
        let bit = profile.bit(BitWord::Indicators, 3);
        assert_eq!(
            (bit.name.as_str(), bit.ne107),
            ("Vibration \"HI\"", Some(Ne107::OutOfSpecification))
        );
        let mut again = Draft::of(&profile);
        assert_eq!(again.get("registers.request"), "500");
        again.set("registers.request", " 500 ".into());
        assert_eq!(again, draft);
    }

    #[test]
    fn an_empty_form_assumes_everything() {
        let profile = Profile::from_json(&Draft::default().to_json()).unwrap();
        assert!(Setting::ALL.iter().all(|s| profile.is_assumed(*s)));
    }

    #[test]
    fn mistakes_are_named_by_their_key() {
        for (key, text) in [
            ("registers.request", "none"),
            ("status.shift", "14"),
            ("temperature", "K"),
            ("reading.max_registers", "0"),
        ] {
            let mut draft = Draft::default();
            draft.set(key, text.into());
            let problems = Profile::from_json(&draft.to_json()).unwrap_err();
            assert!(problems.iter().any(|p| p.key == key), "{key}: {problems:?}");
        }
        let mut draft = Draft::default();
        draft.bits[1].push(BitRow {
            bit: "32".into(),
            name: "x".into(),
            ne107: String::new(),
        });
        let problems = Profile::from_json(&draft.to_json()).unwrap_err();
        assert!(
            problems.iter().any(|p| p.key.starts_with("alarms")),
            "{problems:?}"
        );
    }
}
