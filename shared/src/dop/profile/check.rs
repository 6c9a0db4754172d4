//! Reading a profile: every mistake with its line and key, and with what to write there.

use core::fmt;
use std::collections::{BTreeMap, BTreeSet};

use serde_json::{Map, Value};

use super::Profile;
use super::keys::{self, Rule};

/// Something in a profile that can't be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProfileProblem {
    /// Line, counted from 1.
    pub line: u32,
    /// The key with those around it: `registers.request`. Empty if there is none.
    pub key: String,
    /// What is wrong, and what to write.
    pub text: String,
}

impl fmt::Display for ProfileProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.key.is_empty() {
            write!(f, "line {}: {}", self.line, self.text)
        } else {
            write!(f, "line {}: {}: {}", self.line, self.key, self.text)
        }
    }
}

/// Mistakes that are told of one file.
const MOST: usize = 100;

pub(super) fn read(text: &str) -> Result<Profile, Vec<ProfileProblem>> {
    let value: Value = serde_json::from_str(text).map_err(|error| {
        let line = u32::try_from(error.line()).unwrap_or(u32::MAX);
        let sentence = error.to_string();
        let sentence = sentence.split(" at line ").next().unwrap_or_default();
        let column = error.column();
        vec![ProfileProblem {
            line,
            key: String::new(),
            text: format!("no JSON at column {column}: {sentence}"),
        }]
    })?;
    let places = places(text);
    let mut check = Check {
        places: places.iter().cloned().collect(),
        problems: Vec::new(),
    };
    match &value {
        Value::Object(map) => check.section("", "", map),
        _ => check.add("", "write an object in braces"),
    }
    check.twice(&places);
    if !check.problems.is_empty() {
        crate::few::sort_by_key(&mut check.problems, |problem| problem.line);
        return Err(check.problems);
    }
    let profile = super::file::read(&value);
    consistent(&profile, &mut check);
    if check.problems.is_empty() {
        Ok(profile)
    } else {
        Err(check.problems)
    }
}

struct Check {
    /// Every key of the text with its line; of equal keys the last, which is the one that counts.
    places: BTreeMap<String, u32>,
    problems: Vec<ProfileProblem>,
}

impl Check {
    fn add(&mut self, key: &str, text: impl Into<String>) {
        if self.problems.len() >= MOST {
            return;
        }
        self.problems.push(ProfileProblem {
            line: self.places.get(key).copied().unwrap_or(1),
            key: key.to_owned(),
            text: text.into(),
        });
    }

    /// The keys of an object: `path` as it is in the file, `rule` as it is in the table.
    fn section(&mut self, path: &str, rule: &str, map: &Map<String, Value>) {
        for (key, value) in map {
            let join = |before: &str| match before {
                "" => key.clone(),
                _ => format!("{before}.{key}"),
            };
            let (path, name) = (join(path), join(rule));
            match keys::rule(&name) {
                Some(found) => self.value(&path, found, value),
                None => self.add(
                    &path,
                    format!("not a key of a profile; write one of {}", {
                        keys::beside(rule).join(", ")
                    }),
                ),
            }
        }
    }

    fn value(&mut self, path: &str, rule: Rule, value: &Value) {
        let number = value.as_i64();
        let good = match rule {
            Rule::Section => {
                if let Value::Object(map) = value {
                    return self.section(path, path, map);
                }
                false
            }
            Rule::Exactly(text) => value.as_str() == Some(text),
            Rule::Text => value.is_string(),
            Rule::Bool => value.is_boolean(),
            Rule::OneOf(words) => value.as_str().is_some_and(|text| words.contains(&text)),
            Rule::Int(min, max) => number.is_some_and(|n| (min..=max).contains(&n)),
            Rule::IntOrNull(min, max) => {
                value.is_null() || number.is_some_and(|n| (min..=max).contains(&n))
            }
            Rule::OneNumber(numbers) => number.is_some_and(|n| numbers.contains(&n)),
            Rule::Power => {
                number.is_some_and(|n| [1, 10, 100, 1000, 10_000, 100_000, 1_000_000].contains(&n))
            }
            Rule::Bits(count) => {
                if let Value::Array(items) = value {
                    return self.bits(path, count, items);
                }
                false
            }
        };
        if !good {
            self.add(
                path,
                format!("{value} does not fit; write {}", rule.wanted()),
            );
        }
    }

    /// The names of bits.
    fn bits(&mut self, path: &str, count: i64, items: &[Value]) {
        let mut seen = BTreeSet::new();
        for (index, item) in items.iter().enumerate() {
            let path = format!("{path}[{index}]");
            let Value::Object(map) = item else {
                self.add(&path, format!("write {}", Rule::Bits(count).wanted()));
                continue;
            };
            self.section(&path, "[]", map);
            let bit = map.get("bit").and_then(Value::as_i64);
            match bit {
                None if map.contains_key("bit") => {}
                None => self.add(&path, "has no bit; write its number"),
                Some(bit) if bit >= count => self.add(
                    &format!("{path}.bit"),
                    format!("there are {count} bits, 0 to {}", count.saturating_sub(1)),
                ),
                Some(bit) if !seen.insert(bit) => self.add(
                    &format!("{path}.bit"),
                    format!("bit {bit} has a name already"),
                ),
                Some(_) => {}
            }
            if !map.contains_key("name") {
                self.add(&path, "has no name; write one in quotes");
            }
        }
    }

    /// Keys that stand twice in the same object.
    fn twice(&mut self, places: &[(String, u32)]) {
        let mut seen = BTreeSet::new();
        // The place of a list's element has no key.
        for (key, line) in places.iter().filter(|(key, _)| !key.ends_with(']')) {
            if !seen.insert(key) && self.problems.len() < MOST {
                self.problems.push(ProfileProblem {
                    line: *line,
                    key: key.clone(),
                    text: "is there twice; remove one".to_owned(),
                });
            }
        }
    }
}

/// What no single key can tell.
fn consistent(profile: &Profile, check: &mut Check) {
    use super::LogCommand as L;
    let commands = [
        (L::Newest, "log.newest"),
        (L::Oldest, "log.oldest"),
        (L::Older, "log.older"),
        (L::Newer, "log.newer"),
        (L::Present, "log.present"),
    ];
    for (at, (command, key)) in commands.iter().enumerate() {
        let option = profile.log_option(*command);
        for (other, name) in commands.iter().take(at) {
            if profile.log_option(*other) == option {
                check.add(
                    key,
                    format!("option {option} is that of {name}; every command needs its own"),
                );
            }
        }
    }
    let registers = &profile.registers;
    let table = profile.table.unwrap_or_default();
    let mut areas: Vec<(&str, u32, u32)> = Vec::new();
    let mut area = |key, first: Option<u16>, words: u32| {
        if let Some(first) = first {
            let first = u32::from(first);
            areas.push((key, first, first.saturating_add(words)));
        }
    };
    // The request is always a holding register, the others may be input registers.
    if table == super::ReadTable::Holding {
        area("registers.request", registers.request, 1);
    }
    area("registers.indicators", registers.indicators, 4);
    area("registers.status", registers.status, 1);
    area("registers.count", registers.count, 1);
    area("registers.response", registers.response, 512);
    for (at, (key, from, to)) in areas.iter().enumerate() {
        for (other, start, end) in areas.iter().take(at) {
            if from < end && start < to {
                check.add(
                    key,
                    format!("{from} to {} overlap {other}", to.saturating_sub(1)),
                );
            }
        }
    }
}

/// Every key of a JSON text with its line, those of lists as `alarms[0].bit`. The text is valid.
fn places(text: &str) -> Vec<(String, u32)> {
    /// What is open: an object, or a list with the number of its element and whether that began.
    enum Open {
        Object,
        List(usize, bool),
    }
    let mut places = Vec::new();
    let mut open: Vec<(Open, String)> = Vec::new();
    let mut line = 1_u32;
    let mut key = String::new();
    let mut chars = text.chars().peekable();
    let mut word: Option<String> = None;
    while let Some(c) = chars.next() {
        if let Some((Open::List(index, begun), path)) = open.last_mut()
            && !*begun
            && !(c.is_whitespace() || c == ']')
        {
            *begun = true;
            key = format!("{path}[{index}]");
            places.push((key.clone(), line));
        }
        match c {
            '\n' => line = line.saturating_add(1),
            '"' => {
                let mut string = String::new();
                while let Some(c) = chars.next() {
                    match c {
                        '"' => break,
                        '\\' => {
                            string.push(c);
                            string.extend(chars.next());
                        }
                        c => string.push(c),
                    }
                }
                word = Some(string);
            }
            ':' => {
                if let Some(name) = word.take() {
                    let around = open.last().map_or("", |(_, path)| path.as_str());
                    key = if around.is_empty() {
                        name
                    } else {
                        format!("{around}.{name}")
                    };
                    places.push((key.clone(), line));
                }
            }
            '{' | '[' => {
                let kind = if c == '{' {
                    Open::Object
                } else {
                    Open::List(0, false)
                };
                open.push((kind, core::mem::take(&mut key)));
            }
            '}' | ']' => {
                open.pop();
            }
            ',' => {
                if let Some((Open::List(index, begun), _)) = open.last_mut() {
                    *index = index.saturating_add(1);
                    *begun = false;
                }
            }
            _ => {}
        }
    }
    places
}
