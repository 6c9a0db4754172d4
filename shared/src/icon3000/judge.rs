//! What is wrong with the records of a file.

use super::model::{Kind, Layout};
use super::read::{Entry, Item, RecordProblem};
use super::records::{RECORDS, Records};
use crate::value::Quality;

/// What is wrong with the records themselves.
pub(super) fn judge(
    layout: &Layout,
    records: &Records,
    head: &[Option<Item>],
    entries: &[Entry],
    stored: Option<u16>,
    problems: &mut Vec<RecordProblem>,
) {
    let mut say = |record, text| problems.push(RecordProblem { record, text });
    if let Some(stored) = stored {
        let needs = layout.records(stored);
        if needs > RECORDS.into() {
            say(
                0,
                format!(
                    "{stored} entries would need {needs} records, but a file has 10000 at most; \
                     the count is not sound"
                ),
            );
        }
        if let Some(beyond) = entries.iter().find(|e| e.number > stored)
            && let Some(item) = beyond.items.iter().flatten().next()
        {
            let number = beyond.number;
            say(
                item.record,
                format!("entry {number} was read, but the file announces {stored} only"),
            );
        }
    }
    if !layout.is_log()
        && let Some((record, _)) = records.iter().find(|(r, _)| *r >= layout.head_records)
    {
        let last = layout.head_records.saturating_sub(1);
        say(
            record,
            format!("the file ends with record {last}; what follows is not described"),
        );
    }
    let all = head
        .iter()
        .chain(entries.iter().flat_map(|e| &e.items))
        .flatten();
    for item in all {
        let what = match (item.quality, item.field.kind) {
            (Quality::OutOfRange, _) => {
                let (min, max) = item.field.range.unwrap_or_default();
                format!("{} is outside {min} to {max}", item.text())
            }
            (Quality::Disputed, _) => {
                "an 8-bit value widened without its sign; read as negative".to_owned()
            }
            (Quality::Invalid, Kind::Enum) => "the code has no name".to_owned(),
            (Quality::Invalid, _) => "not all bytes are characters".to_owned(),
            _ => continue,
        };
        say(item.record, format!("{}: {what}", item.label()));
    }
    // The latest comes first.
    let mut times = entries.iter().filter_map(|e| Some((e.number, e.time()?)));
    if let Some((mut number, mut time)) = times.next() {
        for (next, earlier) in times {
            if earlier > time {
                let record = layout.records(next.saturating_sub(1));
                say(
                    u16::try_from(record).unwrap_or(u16::MAX),
                    format!(
                        "entry {next} is later than entry {number}, though the latest comes first: \
                         the clock was set, or the log changed while it was read"
                    ),
                );
            }
            (number, time) = (next, earlier);
        }
    }
}
