//! Any bytes to a snapshot and what is wrong with them, by line.

use std::borrow::Cow;

use super::file::{FORMAT, VERSION};
use super::{Failure, Part, Snapshot};
use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::icon3000::identity::Guess;
use crate::icon3000::plan::Span;
use crate::icon3000::records::RECORDS;
use crate::json::value::Json;
use crate::map::row::Model;

/// A file is not read beyond this: the largest snapshot is far below a megabyte.
pub const LONGEST: usize = 16 << 20;
/// More problems than these are only counted.
const MOST_PROBLEMS: usize = 100;

/// A value of the file; it has no others.
#[derive(Clone, Debug)]
enum Scalar {
    Text(String),
    Number(u64),
    Other,
}

impl Scalar {
    fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    const fn number(&self) -> Option<u64> {
        match self {
            Self::Number(number) => Some(*number),
            _ => None,
        }
    }
}

/// Members of an object, in the order in which they came.
type Members = Vec<(String, Scalar)>;

/// A member; where a name comes twice, the last one counts.
fn get<'a>(members: &'a Members, key: &str) -> Option<&'a Scalar> {
    let (_, value) = members.iter().rev().find(|(name, _)| name == key)?;
    Some(value)
}

fn owned(members: &[(Cow<'_, str>, Json<'_>)]) -> Members {
    let scalar = |json: &Json<'_>| match json {
        Json::Text(text) => Scalar::Text(text.clone().into_owned()),
        Json::Number(number) => Scalar::Number(*number),
        _ => Scalar::Other,
    };
    let members = members.iter();
    members
        .map(|(key, value)| (key.clone().into_owned(), scalar(value)))
        .collect()
}

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
    if matches!(text, Cow::Owned(_)) {
        problems.say(0, "some bytes are no UTF-8; they were replaced".to_owned());
    }
    let text = text.trim_start_matches('\u{feff}');
    let mut head = Members::new();
    let mut parts: Vec<(usize, Members)> = Vec::new();
    let mut odd: Vec<usize> = Vec::new();
    for (line, text) in (1_usize..).zip(text.lines()) {
        split(line, text, &mut head, &mut parts, &mut odd);
    }
    let ends = get(&head, "format").is_some() && get(&head, "hash").is_some();
    if !odd.is_empty() || !ends {
        // Other white space than ours, or damaged.
        match Json::read(text) {
            Ok(Json::Object(whole)) => {
                let list = whole.iter().rev().find(|(key, _)| key == "parts");
                let list = list.and_then(|(_, list)| list.list()).unwrap_or(&[]);
                let members = |part: &Json<'_>| part.members().map(owned).unwrap_or_default();
                parts = list.iter().map(|part| (0, members(part))).collect();
                head = owned(&whole);
            }
            Ok(_) => problems.say(1, "this is JSON, but not a snapshot".to_owned()),
            Err(at) => {
                let before = text.get(..at).unwrap_or_default();
                let line = before.matches('\n').count().saturating_add(1);
                if get(&head, "format").is_some() {
                    problems.say(line, "the JSON is damaged from here on".to_owned());
                    for line in odd {
                        problems.say(line, "this line was left out: it is no part".to_owned());
                    }
                } else {
                    problems.say(line, "this is no JSON".to_owned());
                }
            }
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
    head: &mut Members,
    parts: &mut Vec<(usize, Members)>,
    odd: &mut Vec<usize>,
) {
    let text = text.trim();
    let text = text.strip_suffix(',').unwrap_or(text);
    if matches!(text, "" | "{" | "}" | "]") || text == "\"parts\":[" {
        return;
    }
    if text.starts_with('{') {
        match Json::parse(text) {
            Some(Json::Object(part)) => parts.push((line, owned(&part))),
            _ => odd.push(line),
        }
        return;
    }
    match Json::parse(&format!("{{{text}}}")) {
        Some(Json::Object(pair)) if pair.len() == 1 => head.extend(owned(&pair)),
        _ => odd.push(line),
    }
}

fn build(head: &Members, parts: &[(usize, Members)], problems: &mut Problems) -> Option<Snapshot> {
    let text = |key: &str| get(head, key).and_then(Scalar::text).unwrap_or_default();
    if text("format") != FORMAT {
        let say = format!("this is no snapshot: \"format\" is not \"{FORMAT}\"");
        problems.say(0, say);
        return None;
    }
    match get(head, "version").and_then(Scalar::number) {
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
    let of_key = |key: &str| {
        let icon = [Model::Icon2000v4, Model::Icon3000, Model::Icon3000v2];
        Model::from_key(key).filter(|m| icon.contains(m))
    };
    let Some(model) = of_key(device) else {
        let say =
            format!("\"device\" is {device:?}; icon2000v4, icon3000 or icon3000v2 was expected");
        problems.say(0, say);
        return None;
    };
    let unit = get(head, "unit").and_then(Scalar::number);
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
    snapshot.took_ms = get(head, "took_ms").and_then(Scalar::number);
    snapshot.clock_read = text("clock_read").to_owned();
    snapshot.guess = get(head, "guess_why")
        .and_then(Scalar::text)
        .map(|why| Guess {
            model: of_key(text("guess")),
            why: why.to_owned(),
        });
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
fn take(snapshot: &mut Snapshot, part: &Members) -> Result<(), String> {
    let text = |key: &str| get(part, key).and_then(Scalar::text);
    let number = |key: &str| {
        get(part, key)
            .and_then(Scalar::number)
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
    if get(part, "table").is_some() {
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
    if get(part, "counter").is_some() {
        snapshot
            .counters
            .insert(number("counter")?, number("value")?);
        return Ok(());
    }
    if get(part, "file").is_some() {
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
