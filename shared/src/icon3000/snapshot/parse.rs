//! Any bytes to a snapshot and what is wrong with them, by line.

use serde_json::{Map, Value};

use super::file::{FORMAT, VERSION};
use super::{Failure, Part, Snapshot};
use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::icon3000::plan::Span;
use crate::icon3000::records::RECORDS;
use crate::map::row::Model;

/// A file is not read beyond this: the largest snapshot is far below a megabyte.
pub const LONGEST: usize = 16 << 20;
/// More problems than these are only counted.
const MOST_PROBLEMS: usize = 100;

/// What is wrong with a file, and where.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileProblem {
    /// Line from 1; 0 for the file as a whole.
    pub line: usize,
    /// What happened and what was done about it.
    pub text: String,
}

impl core::fmt::Display for FileProblem {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        f.write_str(&self.text)
    }
}

/// Reads the bytes of a file. `None` if they hold no snapshot at all; the problems say why, or what
/// could not be read of one.
///
/// What can be read of a damaged file is read, line by line.
#[must_use]
pub fn parse(bytes: &[u8]) -> (Option<Snapshot>, Vec<FileProblem>) {
    let mut problems = Problems::default();
    if bytes.len() > LONGEST {
        let len = bytes.len();
        problems.say(
            0,
            format!("{len} bytes are too many for a snapshot; nothing was read"),
        );
        return (None, problems.list);
    }
    let text = String::from_utf8_lossy(bytes);
    if matches!(text, std::borrow::Cow::Owned(_)) {
        problems.say(0, "some bytes are no UTF-8; they were replaced".to_owned());
    }
    let text = text.trim_start_matches('\u{feff}');
    let mut head = Map::new();
    let mut parts: Vec<(usize, Map<String, Value>)> = Vec::new();
    let mut odd: Vec<usize> = Vec::new();
    for (line, text) in (1_usize..).zip(text.lines()) {
        split(line, text, &mut head, &mut parts, &mut odd);
    }
    let ends = head.contains_key("format") && head.contains_key("hash");
    if !odd.is_empty() || !ends {
        // Other white space than ours, or damaged.
        match serde_json::from_str::<Value>(text) {
            Ok(Value::Object(whole)) => {
                let list = whole.get("parts").and_then(Value::as_array);
                parts = list
                    .into_iter()
                    .flatten()
                    .map(|part| (0, part.as_object().cloned().unwrap_or_default()))
                    .collect();
                head = whole;
            }
            Ok(_) => problems.say(1, "this is JSON, but not a snapshot".to_owned()),
            Err(error) if head.contains_key("format") => {
                problems.say(error.line(), format!("the JSON is damaged: {error}"));
                for line in odd {
                    problems.say(line, "this line was left out: it is no part".to_owned());
                }
            }
            Err(error) => problems.say(error.line(), format!("this is no JSON: {error}")),
        }
    }
    let snapshot = build(&head, &parts, &mut problems);
    (snapshot, problems.finish())
}

#[derive(Default)]
struct Problems {
    list: Vec<FileProblem>,
    more: usize,
}

impl Problems {
    fn say(&mut self, line: usize, text: String) {
        if self.list.len() < MOST_PROBLEMS {
            self.list.push(FileProblem { line, text });
        } else {
            self.more = self.more.saturating_add(1);
        }
    }

    fn finish(mut self) -> Vec<FileProblem> {
        if self.more > 0 {
            let text = format!("{} more problems", self.more);
            self.list.push(FileProblem { line: 0, text });
        }
        self.list
    }
}

/// One line as we write it: `"key":value,` or a part.
fn split(
    line: usize,
    text: &str,
    head: &mut Map<String, Value>,
    parts: &mut Vec<(usize, Map<String, Value>)>,
    odd: &mut Vec<usize>,
) {
    let text = text.trim();
    let text = text.strip_suffix(',').unwrap_or(text);
    if matches!(text, "" | "{" | "}" | "]") || text == "\"parts\":[" {
        return;
    }
    if text.starts_with('{') {
        match serde_json::from_str::<Value>(text) {
            Ok(Value::Object(part)) => parts.push((line, part)),
            _ => odd.push(line),
        }
        return;
    }
    match serde_json::from_str::<Value>(&format!("{{{text}}}")) {
        Ok(Value::Object(pair)) if pair.len() == 1 => head.extend(pair),
        _ => odd.push(line),
    }
}

fn build(
    head: &Map<String, Value>,
    parts: &[(usize, Map<String, Value>)],
    problems: &mut Problems,
) -> Option<Snapshot> {
    let text = |key: &str| head.get(key).and_then(Value::as_str).unwrap_or_default();
    if text("format") != FORMAT {
        let say = format!("this is no snapshot: \"format\" is not \"{FORMAT}\"");
        problems.say(0, say);
        return None;
    }
    match head.get("version").and_then(Value::as_u64) {
        Some(VERSION) => {}
        Some(other) => problems.say(
            0,
            format!(
                "the format is version {other}, this program knows {VERSION}; some may be missing"
            ),
        ),
        None => problems.say(0, "the version of the format is missing".to_owned()),
    }
    let device = text("device");
    let icon = [Model::Icon2000v4, Model::Icon3000, Model::Icon3000v2];
    let Some(model) = Model::from_key(device).filter(|m| icon.contains(m)) else {
        let say =
            format!("\"device\" is {device:?}; icon2000v4, icon3000 or icon3000v2 was expected");
        problems.say(0, say);
        return None;
    };
    let unit = head.get("unit").and_then(Value::as_u64);
    let unit = unit.and_then(|u| u8::try_from(u).ok());
    if unit.is_none() {
        problems.say(
            0,
            "the unit address is missing or no number up to 255".to_owned(),
        );
    }
    let mut snapshot = Snapshot::new(model, unit.unwrap_or(0), text("tag"));
    snapshot.tool = text("tool").to_owned();
    snapshot.taken = text("taken").to_owned();
    snapshot.took_ms = head.get("took_ms").and_then(Value::as_u64);
    for (at, (line, part)) in (1_usize..).zip(parts) {
        if let Err(why) = take(&mut snapshot, part) {
            let place = if *line > 0 {
                String::new()
            } else {
                format!("part {at}: ")
            };
            problems.say(*line, format!("{place}{why}; it was left out"));
        }
    }
    let is = snapshot.hash();
    match text("hash") {
        "" => problems.say(
            0,
            "the hash is missing; changes would not be seen".to_owned(),
        ),
        hash if hash == is => {}
        _ => problems.say(
            0,
            "the hash does not fit: the file was changed or damaged since it was written"
                .to_owned(),
        ),
    }
    Some(snapshot)
}

/// Takes one part in.
fn take(snapshot: &mut Snapshot, part: &Map<String, Value>) -> Result<(), String> {
    let text = |key: &str| part.get(key).and_then(Value::as_str);
    let number = |key: &str| {
        part.get(key)
            .and_then(Value::as_u64)
            .and_then(|n| u16::try_from(n).ok())
            .ok_or_else(|| format!("{key:?} is missing or no number up to 65535"))
    };
    let table = |key: &str| {
        let name = text(key).unwrap_or_default();
        Table::ALL
            .into_iter()
            .find(|t| t.key() == name)
            .ok_or_else(|| format!("{key:?} names no table"))
    };
    if text("hole").is_some() {
        // Follows from what is there.
        return Ok(());
    }
    if let Some(what) = text("failed") {
        let why = text("why").unwrap_or_default().to_owned();
        let part = match what {
            "block" => Part::Block(
                table("table")?,
                Address::new(number("start")?),
                number("count")?,
            ),
            "identity" => Part::Identity,
            "counter" => Part::Counter(number("sub")?),
            "file" => Part::File(Span::new(
                number("file")?,
                number("start")?,
                number("count")?,
            )),
            other => return Err(format!("\"failed\" is {other:?}")),
        };
        snapshot.failures.push(Failure { part, why });
        return Ok(());
    }
    if part.contains_key("table") {
        let table = table("table")?;
        let start = number("start")?;
        let words = match (table.is_bits(), text("bits"), text("words")) {
            (true, Some(bits), _) => bits
                .chars()
                .map(|c| c.to_digit(2).and_then(|d| u16::try_from(d).ok()))
                .collect::<Option<Vec<_>>>()
                .ok_or("\"bits\" has other characters than 0 and 1")?,
            (false, _, Some(digits)) => words(digits)?,
            _ => return Err("the words or bits are missing".to_owned()),
        };
        let end = usize::from(start).saturating_add(words.len());
        if end > 65_536 {
            return Err("it goes beyond address 65535".to_owned());
        }
        for (address, word) in (start..=u16::MAX).zip(words) {
            let address = Address::new(address);
            snapshot.image.set(table, address, word, Micros::default());
        }
        return Ok(());
    }
    if let Some(digits) = text("identity") {
        let pdu = bytes(digits)?;
        if pdu.first() != Some(&17) {
            return Err("\"identity\" is no response of function 17".to_owned());
        }
        snapshot.identity = Some(pdu);
        return Ok(());
    }
    if part.contains_key("counter") {
        snapshot
            .counters
            .insert(number("counter")?, number("value")?);
        return Ok(());
    }
    if part.contains_key("file") {
        let words = words(text("words").ok_or("the words are missing")?)?;
        let start = number("start")?;
        let end = usize::from(start).saturating_add(words.len());
        if end > usize::from(RECORDS) {
            return Err("it goes beyond record 9999".to_owned());
        }
        snapshot.files.entry(number("file")?).put(start, words);
        return Ok(());
    }
    Err("this part is of no known sort".to_owned())
}

fn words(digits: &str) -> Result<Vec<u16>, String> {
    let bytes = bytes(digits)?;
    if !bytes.len().is_multiple_of(2) {
        return Err("\"words\" has not four digits for each word".to_owned());
    }
    let pairs = bytes.chunks_exact(2).filter_map(|p| p.first_chunk::<2>());
    Ok(pairs.map(|p| u16::from_be_bytes(*p)).collect())
}

fn bytes(digits: &str) -> Result<Vec<u8>, String> {
    let pairs = digits.as_bytes().chunks(2);
    pairs
        .map(|pair| match pair {
            [_, _] => crate::frame::ascii::hex_pair(pair),
            _ => None,
        })
        .collect::<Option<Vec<_>>>()
        .ok_or_else(|| "there are other characters than pairs of hexadecimal digits".to_owned())
}
