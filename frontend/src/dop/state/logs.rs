//! A log as it grows page by page: records once each, in the order in which they came.

use std::collections::BTreeSet;

use shared::dop::profile::Ne107;
use shared::dop::{LogRecord, ObjectRead, Stamp};

use crate::chart::table::quote;
use crate::chart::time::stamp;
use crate::state::json::quoted;

/// The event log.
pub const EVENTS: u16 = 1202;
/// The movement log.
pub const MOVEMENTS: u16 = 1203;

/// A log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// The records, as they came.
    pub records: Vec<LogRecord>,
    /// Records that came again and were left out.
    pub repeated: usize,
    /// Pages that came.
    pub pages: u32,
    /// True if the oldest were asked for first.
    pub from_oldest: bool,
    /// Why it ended, once it did.
    pub end: Option<String>,
    seen: BTreeSet<(u32, i64)>,
}

impl Log {
    /// A log that begins at one end.
    #[must_use]
    pub fn begin(from_oldest: bool) -> Self {
        Self {
            from_oldest,
            ..Self::default()
        }
    }

    /// Adds the records of a page. One is the same as another if number and time are.
    pub fn add(&mut self, page: &ObjectRead) {
        self.pages += 1;
        for record in page.records() {
            // Numbers of the movement log come round again, so the time belongs to the identity.
            if self.seen.insert((record.id, seconds(record.time))) {
                self.records.push(record);
            } else {
                self.repeated += 1;
            }
        }
    }

    /// The number of the last record, from which reading can go on.
    #[must_use]
    pub fn last_id(&self) -> Option<u64> {
        self.records.last().map(|r| u64::from(r.id))
    }

    /// The records that match, newest or oldest first as they came.
    #[must_use]
    pub fn matching(&self, filter: &Filter) -> Vec<usize> {
        let records = self.records.iter().enumerate();
        records
            .filter(|(_, record)| filter.keeps(record))
            .map(|(at, _)| at)
            .collect()
    }
}

fn seconds(time: Stamp) -> i64 {
    match time {
        Stamp::Never => 0,
        Stamp::At(seconds) | Stamp::Odd(seconds) => seconds,
    }
}

/// Which records are wanted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Filter {
    /// Part of the text, or the number of the record.
    pub text: String,
    /// A category, `None` for all.
    pub category: Option<u16>,
}

impl Filter {
    fn keeps(&self, record: &LogRecord) -> bool {
        if self.category.is_some() && self.category != record.category {
            return false;
        }
        let wanted = self.text.trim().to_ascii_lowercase();
        wanted.is_empty()
            || record.text.to_ascii_lowercase().contains(&wanted)
            || record.id.to_string() == wanted
    }
}

/// The words of a category.
#[must_use]
pub fn category(code: u16) -> String {
    match (Ne107::from_log(code), code) {
        (Some(category), _) => category.label().to_owned(),
        (None, 4) => "Engineering info".to_owned(),
        (None, 5) => "Engineering warning".to_owned(),
        (None, 6) => "Engineering alarm".to_owned(),
        (None, 7) => "Engineering test".to_owned(),
        (None, code) => format!("category {code}"),
    }
}

/// The time of a record as a program reads it; empty if there is none.
fn iso(time: Stamp) -> String {
    time.seconds()
        .map_or_else(String::new, |s| format!("{}Z", stamp(s).replace(' ', "T")))
}

/// Records as comma-separated values with a head line.
#[must_use]
pub fn csv(records: &[&LogRecord]) -> String {
    let mut out = String::from("record,time_utc,category,text");
    let numbers = records.first().map_or(&[][..], |r| &r.numbers);
    for (field, number) in numbers {
        out.push(',');
        let name = if number.unit.is_empty() {
            field.label.to_owned()
        } else {
            format!("{} ({})", field.label, number.unit)
        };
        quote(&mut out, &name);
    }
    out.push('\n');
    for record in records {
        out.push_str(&format!("{},{},", record.id, iso(record.time)));
        quote(
            &mut out,
            &record.category.map_or_else(String::new, category),
        );
        out.push(',');
        quote(&mut out, &record.text);
        for (_, number) in &record.numbers {
            out.push(',');
            quote(&mut out, &number.scale.apply(number.raw).to_string());
        }
        out.push('\n');
    }
    out
}

/// Records as JSON, one object a line.
#[must_use]
pub fn json(records: &[&LogRecord]) -> String {
    let mut out = String::new();
    for record in records {
        out.push_str(&format!("{{\"record\":{},\"time\":", record.id));
        match record.time.seconds() {
            Some(_) => quoted(&mut out, &iso(record.time)),
            None => out.push_str("null"),
        }
        out.push_str(",\"category\":");
        match record.category {
            Some(code) => {
                out.push_str(&format!("{code},\"category_text\":"));
                quoted(&mut out, &category(code));
            }
            None => out.push_str("null"),
        }
        out.push_str(",\"text\":");
        quoted(&mut out, &record.text);
        for (field, number) in &record.numbers {
            out.push_str(&format!(",\"{}\":", field.key));
            out.push_str(&number.scale.apply(number.raw).to_string());
        }
        out.push_str("}\n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::dop::{Profile, Request};

    /// A page of the event log: number, seconds and category of each record, texts of its number.
    fn page(records: &[(u32, i64, u16)]) -> ObjectRead {
        let mut words = vec![u16::try_from(records.len()).unwrap()];
        for &(id, time, category) in records {
            let time = time.cast_unsigned();
            words.extend([id as u16, (id >> 16) as u16]);
            words.extend([0, 16, 32, 48].map(|shift| (time >> shift) as u16));
            words.push(category);
            // Twenty registers: "=A" with the first character in the low byte, then NULs.
            words.push(0x413D);
            words.extend([0; 19]);
        }
        ObjectRead::read(Request::from_word(0x04B2), &words, &Profile::default())
    }

    /// 2021-02-12 15:29:15 UTC.
    const THEN: i64 = 0x6026_9ECB;

    fn log() -> Log {
        let mut log = Log::begin(false);
        log.add(&page(&[(9, THEN + 60, 3), (8, THEN, 0)]));
        log.add(&page(&[(8, THEN, 0), (7, THEN - 60, 4)]));
        log
    }

    #[test]
    fn records_are_kept_once() {
        let log = log();
        let ids: Vec<_> = log.records.iter().map(|r| r.id).collect();
        assert_eq!(ids, [9, 8, 7]);
        assert_eq!((log.pages, log.repeated, log.last_id()), (2, 1, Some(7)));
        // The same number at another time is another record.
        let mut wrapped = Log::begin(false);
        wrapped.add(&page(&[(1, THEN, 0), (1, THEN - 1, 0)]));
        assert_eq!(wrapped.records.len(), 2);
    }

    #[test]
    fn records_are_found() {
        let log = log();
        let found = |text: &str, category| {
            log.matching(&Filter {
                text: text.into(),
                category,
            })
        };
        assert_eq!(found("", None), [0, 1, 2]);
        assert_eq!(found("=a", Some(3)), [0]);
        assert_eq!(found("7", None), [2]);
        assert!(found("b", None).is_empty());
    }

    #[test]
    fn files_have_exact_times_and_no_formulas() {
        let log = log();
        let all: Vec<_> = log.records.iter().collect();
        let csv = csv(&all);
        assert_eq!(csv.lines().next(), Some("record,time_utc,category,text"));
        assert_eq!(
            csv.lines().nth(2),
            Some("8,2021-02-12T15:29:15Z,Maintenance required,\"'=A\"")
        );
        assert_eq!(
            json(&all).lines().nth(2),
            Some(
                "{\"record\":7,\"time\":\"2021-02-12T15:28:15Z\",\"category\":4,\
                 \"category_text\":\"Engineering info\",\"text\":\"=A\"}"
            )
        );
        assert_eq!(category(9), "category 9");
    }
}
