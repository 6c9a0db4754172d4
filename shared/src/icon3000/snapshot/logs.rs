//! What changed in the files: entries and curves move when a new one comes, so they are told by
//! what they hold and not by where they stand. Only where both sides were read as a whole is what the
//! one has and the other has not new or gone; else it is something that only one of them has.

use super::diff::{Change, Diff, OnlyOne};
use super::{Snapshot, Sort};
use crate::address::Table;
use crate::icon3000::model::{FILES, File, Kind, Numbering};
use crate::icon3000::read::{Entry, Item, Log};
use crate::icon3000::say;
use crate::map::row::Model;

/// Compares the files of two snapshots, and the logs in the registers.
pub(super) fn compare(first: &Snapshot, second: &Snapshot, out: &mut Diff) {
    for (log, number) in [("alarm", 2), ("warning", 3)] {
        // The file has what the registers have, and more.
        let both = |s: &Snapshot| s.files.get(number).is_some();
        if !(both(first) && both(second)) {
            registers(first, second, log, out);
        }
    }
    for file in &FILES {
        match file.numbering {
            Numbering::Curves => curves(first, second, file, out),
            Numbering::Single | Numbering::Named(_) => {
                for number in file.first..=file.last {
                    one(first, second, file, number, out);
                }
            }
        }
    }
}

/// The five latest entries of a log in the registers: code, date and time of each. An ICON2000v4 has
/// them in input registers only, which the others have too.
fn registers(first: &Snapshot, second: &Snapshot, log: &str, out: &mut Diff) {
    const PARTS: [&str; 3] = ["date", "time", "code"];
    let table = match first.model.min(second.model) {
        Model::Icon3000 | Model::Icon3000v2 => Table::Holding,
        _ => Table::Input,
    };
    let row = |at: u16, part: &str| {
        let key = format!("{log}_log_{at}_{part}");
        let map = Model::Icon3000v2.map();
        map.by_key(table, &key)
    };
    let list = |snapshot: &Snapshot| -> Vec<(u16, String)> {
        (1..=5)
            .filter_map(|at| {
                let texts: Option<Vec<_>> = PARTS
                    .into_iter()
                    .map(|part| say::row(&snapshot.image, row(at, part)?))
                    .collect();
                // Code 0 is no entry.
                let code = row(at, "code").and_then(|r| snapshot.image.bytes(r))?;
                (code != [0, 0]).then_some((at, texts?.join(", ")))
            })
            .collect()
    };
    let is_read = |snapshot: &Snapshot| {
        (1..=5).all(|at| {
            let bytes = |part| row(at, part).and_then(|r| snapshot.image.bytes(r));
            PARTS.into_iter().all(|part| bytes(part).is_some())
        })
    };
    let whole = is_read(first) && is_read(second);
    let mut old = list(first);
    let full = old.len() == 5;
    let mut added = 0_usize;
    let mut push = |at: u16, text: String, in_second: bool| {
        let Some(row) = row(at, "code") else { return };
        let path = format!("{}.{}", table.key(), row.address);
        let label = row.label.split(" - ").next().unwrap_or(row.label);
        if !whole {
            out.only_one.push(OnlyOne {
                path,
                label: format!("{label}: {text}"),
                in_second,
            });
            return;
        }
        let what = if in_second { "new" } else { "gone" };
        let (was, now) = sides(text, in_second);
        out.changes.push(Change {
            sort: Sort::Log,
            path,
            label: format!("{label} ({what})"),
            was,
            now,
            also: Vec::new(),
            source: Some(row.source),
        });
    };
    for (at, text) in list(second) {
        if let Some(found) = old.iter().position(|(_, t)| *t == text) {
            old.remove(found);
            continue;
        }
        added = added.saturating_add(1);
        push(at, text, true);
    }
    if whole && full && old.len() <= added {
        old.clear();
    }
    for (at, text) in old {
        push(at, text, false);
    }
}

/// What it was and what it is: a text that only one of them has.
fn sides(text: String, in_second: bool) -> (String, String) {
    if in_second {
        (String::new(), text)
    } else {
        (text, String::new())
    }
}

fn only_one(file: &File, number: u16, in_second: bool) -> OnlyOne {
    OnlyOne {
        path: format!("file.{number}"),
        label: file.name(number).into_owned(),
        in_second,
    }
}

fn one(first: &Snapshot, second: &Snapshot, file: &'static File, number: u16, out: &mut Diff) {
    let (was, now) = match (first.files.get(number), second.files.get(number)) {
        (Some(was), Some(now)) => (was, now),
        (None, None) => return,
        (_, now) => return out.only_one.push(only_one(file, number, now.is_some())),
    };
    let (Some(was), Some(now)) = (Log::read(number, was), Log::read(number, now)) else {
        // No layout: record by record.
        for record in 0..super::super::records::RECORDS {
            if let (Some(was), Some(now)) = (was.get(record), now.get(record))
                && was != now
            {
                out.changes.push(change(
                    file,
                    format!("file.{number}.record[{record}]"),
                    format!("{}, record {record}", file.label),
                    format!("0x{was:04X}"),
                    format!("0x{now:04X}"),
                ));
            }
        }
        return;
    };
    head(file, number, &was, &now, out);
    if file.is_log() {
        entries(file, number, &was, &now, out);
    }
}

/// What sort a file is of.
fn sort(file: &File) -> Sort {
    match file.key {
        "card_reports" => Sort::Identity,
        "recorders_log" | "t_recorders_log" => Sort::Curve,
        "limits" => Sort::Configuration,
        _ if file.numbering == Numbering::Curves => Sort::Curve,
        _ => Sort::Log,
    }
}

fn change(file: &File, path: String, label: String, was: String, now: String) -> Change {
    Change {
        sort: sort(file),
        path,
        label,
        was,
        now,
        also: Vec::new(),
        source: Some(file.source),
    }
}

/// The values before the entries. The number of entries follows from the entries.
fn head(file: &'static File, number: u16, was: &Log, now: &Log, out: &mut Diff) {
    for pair in was.head.iter().zip(&now.head) {
        let (Some(was), Some(now)) = pair else {
            continue;
        };
        let counted = file.is_log() && was.field.key == "count";
        if was.words == now.words || counted || was.field.kind == Kind::Unused {
            continue;
        }
        out.changes.push(change(
            file,
            format!("file.{number}.{}", was.field.key),
            format!("{}: {}", file.name(number), was.label()),
            was.text_with_unit(),
            now.text_with_unit(),
        ));
    }
}

/// All words of an entry; `None` unless all were read.
fn words(entry: &Entry) -> Option<Vec<u16>> {
    entry
        .items
        .iter()
        .map(|item| item.as_ref().map(|i| i.words.clone()))
        .collect::<Option<Vec<_>>>()
        .map(|words| words.concat())
}

/// An entry in a few words: its values without the unused ones.
fn said(entry: &Entry) -> String {
    let used = |i: &&Item| i.field.kind != Kind::Unused;
    let texts: Vec<_> = entry
        .items
        .iter()
        .flatten()
        .filter(used)
        .map(Item::text_with_unit)
        .collect();
    texts.join(", ")
}

fn entries(file: &'static File, number: u16, was: &Log, now: &Log, out: &mut Diff) {
    let whole = was.complete && now.complete;
    let mut old: Vec<(Vec<u16>, &Entry)> = Vec::new();
    let counts = |entry: &&Entry, stored: Option<u16>| stored.is_none_or(|n| entry.number <= n);
    for entry in was.entries.iter().filter(|e| counts(e, was.stored)) {
        old.extend(words(entry).map(|w| (w, entry)));
    }
    let mut push = |entry: &Entry, in_second: bool| {
        let path = format!("file.{number}.entry[{}]", entry.number);
        let (name, item, text) = (file.label, lower(file.item), said(entry));
        if !whole {
            out.only_one.push(OnlyOne {
                path,
                label: format!("{name}: {item}, {text}"),
                in_second,
            });
            return;
        }
        let label = if in_second {
            format!("{name}: new {item}")
        } else {
            format!("{name}: {item} gone")
        };
        let (was, now) = sides(text, in_second);
        out.changes.push(change(file, path, label, was, now));
    };
    let mut added = 0_usize;
    for entry in now.entries.iter().filter(|e| counts(e, now.stored)) {
        let Some(words) = words(entry) else { continue };
        if let Some(at) = old.iter().position(|(w, _)| *w == words) {
            old.remove(at);
            continue;
        }
        added = added.saturating_add(1);
        push(entry, true);
    }
    // What a full log lost at its end made room for what came.
    let rolled = |last: u16| was.stored.is_none_or(|n| n == last);
    if whole && old.len() <= added && old.last().is_some_and(|(_, e)| rolled(e.number)) {
        old.clear();
    }
    for (_, entry) in old {
        push(entry, false);
    }
    // Of whole logs the entries tell it.
    let told = whole && was.entries != now.entries;
    if let (Some(a), Some(b)) = (was.stored, now.stored)
        && a != b
        && !told
    {
        out.changes.push(change(
            file,
            format!("file.{number}.count"),
            format!("{}: number of entries", file.label),
            a.to_string(),
            b.to_string(),
        ));
    }
}

/// `Alarm` within a sentence; `T-Recorder` and `PST Curve` stay as they are.
fn lower(item: &str) -> String {
    let mut chars = item.chars();
    match (chars.next(), chars.next()) {
        (Some(first), Some(second)) if second.is_lowercase() => {
            let rest = item.get(first.len_utf8()..).unwrap_or_default();
            format!("{}{rest}", first.to_ascii_lowercase())
        }
        _ => item.to_owned(),
    }
}

/// Curves move on when a new one is stored; the reference stays where it is.
fn curves(first: &Snapshot, second: &Snapshot, file: &'static File, out: &mut Diff) {
    let reference = file.first;
    match (first.files.get(reference), second.files.get(reference)) {
        (Some(was), Some(now)) if was != now => {
            let logs = (Log::read(reference, was), Log::read(reference, now));
            let said = |log: &Option<Log>| log.as_ref().map_or_else(String::new, brief);
            let (was, mut now) = (said(&logs.0), said(&logs.1));
            if let (Some(was), Some(log)) = &logs
                && let Some(most) = largest(was, log)
            {
                now = format!("{now}; {most}");
            }
            let path = format!("file.{reference}");
            let name = file.name(reference).into_owned();
            out.changes.push(change(file, path, name, was, now));
        }
        (Some(_), None) | (None, Some(_)) => {
            let in_second = second.files.get(reference).is_some();
            out.only_one.push(only_one(file, reference, in_second));
        }
        _ => {}
    }
    let list = |snapshot: &Snapshot| -> Vec<(u16, Vec<u16>, String)> {
        (file.first.saturating_add(1)..=file.last)
            .filter_map(|number| {
                let records = snapshot.files.get(number)?;
                let log = Log::read(number, records).filter(|l| l.complete)?;
                let words = records.iter().map(|(_, w)| w).collect();
                Some((number, words, brief(&log)))
            })
            .collect()
    };
    let whole = first.has_all_curves(file) && second.has_all_curves(file);
    let mut push = |number: u16, text: String, in_second: bool| {
        if !whole {
            out.only_one.push(only_one(file, number, in_second));
            return;
        }
        let what = if in_second { "new curve" } else { "curve gone" };
        let label = format!("{}: {what}", file.label);
        let (was, now) = sides(text, in_second);
        let path = format!("file.{number}");
        out.changes.push(change(file, path, label, was, now));
    };
    let mut old = list(first);
    let oldest = old.last().map(|(number, ..)| *number);
    let mut added = 0_usize;
    for (number, words, text) in list(second) {
        if let Some(at) = old.iter().position(|(_, w, _)| *w == words) {
            old.remove(at);
            continue;
        }
        added = added.saturating_add(1);
        push(number, text, true);
    }
    // As in a full log.
    if whole && old.len() <= added && old.last().map(|(number, ..)| *number) == oldest {
        old.clear();
    }
    for (number, _, text) in old {
        push(number, text, false);
    }
}

/// Where two curves differ most: `most at Torque at 3 %: 48 % → 60 %`; of curves whose samples are
/// the same, the first other value that differs.
fn largest(was: &Log, now: &Log) -> Option<String> {
    let mut most: Option<(u64, &Item, &Item)> = None;
    for pair in was.head.iter().zip(&now.head) {
        let (Some(was), Some(now)) = pair else {
            continue;
        };
        if was.words == now.words {
            continue;
        }
        let by = match (was.number(), now.number()) {
            (Some(a), Some(b)) if was.field.count > 1 => a.abs_diff(b),
            _ => 0,
        };
        if most.is_none_or(|(before, ..)| by > before) {
            most = Some((by, was, now));
        }
    }
    let (by, was, now) = most?;
    let at = if by > 0 { "most at " } else { "" };
    let (label, was, now) = (was.label(), was.text_with_unit(), now.text_with_unit());
    Some(format!("{at}{label}: {was} → {now}"))
}

/// A curve in a few words: when, and its peak or its result.
fn brief(log: &Log) -> String {
    let time = log.get("time").map_or_else(String::new, Item::text);
    let peak = log
        .run("torque")
        .into_iter()
        .flatten()
        .filter_map(|i| i.number().map(|n| (n.unsigned_abs(), i)))
        .max_by_key(|(size, _)| *size);
    match (log.get("result"), peak, log.get("direction")) {
        (Some(result), ..) => format!("{time}, {}", result.text()),
        (_, Some((_, peak)), _) => format!("{time}, peak {}", peak.text_with_unit()),
        (_, _, Some(direction)) => format!("{time}, {}", direction.text()),
        _ => time,
    }
}
