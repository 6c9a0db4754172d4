//! A device as a file, and back.

use shared::address::{Address, Table};
use shared::capture::Micros;
use shared::device::Device;
use shared::icon3000::identity::{Guess, PROBES, Report, detect};
use shared::icon3000::snapshot::{Failure as Had, FileProblem, Part, parse};
use shared::icon3000::{Snapshot, Span};
use shared::map::row::Model;
use shared::proto::{Block, IconStep, Outcome};
use shared::value::Rfc3339;

use super::dossier::{Answer, Dossier, Reading, Record, Subject};
use super::wanted::Wanted;
use crate::chart::time::Civil;
use crate::format::count;

/// What a file says beside the device itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Opened {
    /// What is wrong with it.
    pub problems: Vec<String>,
}

/// The model of a device.
#[must_use]
pub fn model(device: Device) -> Option<Model> {
    device.map().map(|map| map.model)
}

/// Which model a device is by what it answers, or by what its file says of that.
#[must_use]
pub fn guess(dossier: &Dossier) -> Guess {
    if let Some(guess) = &dossier.guess {
        return guess.clone();
    }
    // A register that answers is known; one that is not there, asked for alone, is refused with
    // exception 02.
    let refused = |start: u16| {
        let known = dossier.image.cell(Table::Holding, Address::new(start));
        let failure = dossier.failed.get(&Subject::Block(3, start));
        match (known, failure) {
            (Some(_), _) => Some(false),
            (_, Some(failure)) if failure.code == 2 && is_alone(failure.step) => Some(true),
            _ => None,
        }
    };
    let [beyond_3473, beyond_21] = PROBES.map(refused);
    let pdu = dossier.identity.as_ref().map(|a| a.pdu.as_slice());
    let report = pdu.and_then(Report::of_pdu);
    detect(&dossier.image, report.as_ref(), beyond_3473, beyond_21)
}

const fn is_alone(step: IconStep) -> bool {
    matches!(step, IconStep::Block(Block { count: 1, .. }))
}

/// The device of a model.
fn device(model: Model) -> Device {
    let of = |device: &Device| device.map().is_some_and(|map| map.model == model);
    Device::ALL.into_iter().find(of).unwrap_or_default()
}

/// A device as it is saved at a time, in seconds since 1970. `None` without a known kind.
#[must_use]
pub fn snapshot(dossier: &Dossier, now: i64) -> Option<Snapshot> {
    let mut snapshot = Snapshot::new(model(dossier.device)?, dossier.unit, &dossier.tag);
    snapshot.tool = concat!("valvescope ", env!("CARGO_PKG_VERSION"), ", page").to_owned();
    snapshot.taken = Rfc3339(oldest(dossier).unwrap_or(now)).to_string();
    // What is read on the page may be hours apart, and the time of the clock counts.
    let clock = clock(dossier).and_then(|at| dossier.image.cell(Table::Holding, at));
    if let Some(cell) = clock {
        snapshot.clock_read = Rfc3339(dossier.wall(cell.at.get())).to_string();
    }
    for (table, address, cell) in dossier.image.iter() {
        snapshot
            .image
            .set(table, address, cell.word, Micros::default());
    }
    // A file from before it was kept stays as it is.
    let told = |g: &Guess| g.model.is_some() || dossier.identity.is_some();
    let live = || Some(guess(dossier)).filter(|g| dossier.origin.is_empty() && told(g));
    snapshot.guess = dossier.guess.clone().or_else(live);
    snapshot.identity = dossier.identity.as_ref().map(|a| a.pdu.clone());
    let counters = dossier.counters.keys();
    snapshot.counters = counters
        .filter_map(|sub| Some((*sub, dossier.count(*sub)?.count)))
        .collect();
    snapshot.files = dossier.all_files();
    for failure in dossier.failed.values().filter(|f| dossier.has(f.step)) {
        let part = match failure.step {
            IconStep::Block(block) => Part::Block(
                Table::from(block.table),
                Address::new(block.start),
                block.count,
            ),
            IconStep::File { file, start, count } => Part::File(Span::new(file, start, count)),
            IconStep::Identity => Part::Identity,
            IconStep::Diagnostic { sub_function } => Part::Counter(sub_function),
        };
        let why = failure.text.clone();
        snapshot.failures.push(Had { part, why });
    }
    Some(snapshot)
}

/// The register that holds the minutes and seconds of a device's clock.
fn clock(dossier: &Dossier) -> Option<Address> {
    let (start, count) = dossier.clock();
    Address::new(start).checked_add(count - 1)
}

/// What a read of the whole device would still ask for, in words; empty if nothing.
#[must_use]
pub fn gaps(dossier: &Dossier) -> String {
    let mut words = Vec::new();
    let missing = Wanted::everything(dossier).missing(dossier, 0).len();
    if missing > 0 {
        let missing = count(u64::try_from(missing).unwrap_or(0), "part");
        words.push(format!("{missing} not read"));
    }
    let failed = dossier.failed.values().filter(|f| dossier.has(f.step));
    let failed = u64::try_from(failed.count()).unwrap_or(0);
    if failed > 0 {
        words.push(format!(
            "{} refused, changed or not answered",
            count(failed, "part")
        ));
    }
    words.join(", ")
}

/// When the oldest of what a device says was read, in seconds since 1970.
#[must_use]
pub fn oldest(dossier: &Dossier) -> Option<i64> {
    let registers = dossier.image.iter().map(|(_, _, cell)| cell.at.get());
    let records = dossier.files.values().flatten().flatten().map(|r| r.at);
    let oldest = registers.chain(records).min()?;
    Some(dossier.wall(oldest))
}

/// A saved device, under the name of its file.
#[must_use]
pub fn dossier(snapshot: &Snapshot, name: &str) -> Dossier {
    let mut dossier = Dossier::new(&snapshot.tag, device(snapshot.model));
    name.clone_into(&mut dossier.origin);
    dossier.unit = snapshot.unit;
    let taken = seconds(&snapshot.taken).and_then(|s| u64::try_from(s).ok());
    dossier.start_wall_ms = taken.unwrap_or(0).saturating_mul(1000);
    dossier.guess = snapshot.guess.clone();
    dossier.image = snapshot.image.clone();
    let later = seconds(&snapshot.clock_read).zip(seconds(&snapshot.taken));
    let later = later.and_then(|(clock, taken)| u64::try_from(clock - taken).ok());
    if let (Some(later), Some(last)) = (later, clock(&dossier)) {
        for at in (0..4).filter_map(|n| last.get().checked_sub(n)) {
            let at = Address::new(at);
            if let Some(cell) = dossier.image.cell(Table::Holding, at).copied() {
                let then = Micros::new(later.saturating_mul(1_000_000));
                dossier.image.set(Table::Holding, at, cell.word, then);
            }
        }
    }
    dossier.identity = snapshot.identity.clone().map(|pdu| Answer { pdu, at: 0 });
    for (&sub, &count) in &snapshot.counters {
        dossier.counters.insert(sub, vec![Reading { count, at: 0 }]);
    }
    for (file, records) in snapshot.files.iter() {
        let kept = dossier.files.entry(file).or_default();
        for (record, word) in records.iter() {
            let at = usize::from(record);
            if kept.len() <= at {
                kept.resize(at + 1, None);
            }
            if let Some(slot) = kept.get_mut(at) {
                *slot = Some(Record { word, at: 0 });
            }
        }
    }
    for failure in &snapshot.failures {
        let step = match failure.part {
            Part::Block(table, start, count) => IconStep::Block(Block {
                table: table.into(),
                start: start.get(),
                count,
            }),
            Part::File(span) => IconStep::File {
                file: span.file,
                start: span.start,
                count: span.count,
            },
            Part::Identity => IconStep::Identity,
            Part::Counter(sub_function) => IconStep::Diagnostic { sub_function },
        };
        // Files do not tell which of the ways it failed; the words do.
        dossier.fail(step, Outcome::Exception, 0, &failure.why, 0);
    }
    dossier
}

/// Opens a file: the device, and what is wrong with the file.
///
/// # Errors
///
/// Why it holds no device, in words.
pub fn open(name: &str, text: &str) -> Result<(Dossier, Opened), String> {
    let (snapshot, problems) = parse(text.as_bytes());
    let words = |problems: &[FileProblem]| -> Vec<String> {
        problems.iter().map(ToString::to_string).collect()
    };
    match snapshot {
        Some(snapshot) => Ok((
            dossier(&snapshot, name),
            Opened {
                problems: words(&problems),
            },
        )),
        None => Err(format!(
            "{name} is no snapshot: {}.",
            words(&problems).join("; ")
        )),
    }
}

/// Seconds since 1970 of a time such as `2026-11-26T23:50:00Z`.
fn seconds(text: &str) -> Option<i64> {
    let number = |from: usize, to: usize| text.get(from..to)?.parse::<i64>().ok();
    let civil = Civil {
        year: number(0, 4)?,
        month: number(5, 7)?,
        day: number(8, 10)?,
        second: number(11, 13)? * 3600 + number(14, 16)? * 60 + number(17, 19)?,
    };
    Some(civil.seconds())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::put as put_registers;
    use crate::actuator::state::logs::tests::put;
    use shared::icon3000::snapshot::diff;
    use shared::proto::TableName;

    /// A device with something of everything.
    pub(crate) fn device() -> Dossier {
        let mut dossier = Dossier::new("XV-101", Device::Icon3000v2);
        dossier.unit = 7;
        dossier.start_wall_ms = 1_765_000_000_000;
        put_registers(&mut dossier, 3615, &[20, 150], 2_000_000);
        put(&mut dossier, 2, &[1, 0x3000, 0, 12]);
        let mut pdu = vec![0x11, 0x52, 0, 0];
        pdu.extend([b' '; 82]);
        assert!(dossier.absorb(&[0x11], &pdu, 3_000_000));
        assert!(dossier.absorb(&[8, 0, 11, 0, 0], &[8, 0, 11, 0, 9], 3_000_000));
        let file = IconStep::File {
            file: 3500,
            start: 0,
            count: 110,
        };
        dossier.fail(file, Outcome::Exception, 2, "illegal data address", 4);
        dossier
    }

    #[test]
    fn a_file_brings_everything_back() {
        let before = device();
        let saved = snapshot(&before, 0).unwrap();
        let (after, opened) = open("xv.json", &saved.to_text()).unwrap();
        assert_eq!(opened.problems, [""; 0]);
        assert_eq!(
            (after.tag.as_str(), after.device, after.unit),
            ("XV-101", Device::Icon3000v2, 7)
        );
        assert_eq!(after.origin, "xv.json");
        assert_eq!(after.count(11).map(|r| r.count), Some(9));
        assert_eq!(after.records(2, 0), before.records(2, 0));
        assert_eq!(after.failed.len(), 1);
        assert_eq!(after.wall(0), 1_765_000_000, "as old as its oldest record");
        let again = snapshot(&after, 0).unwrap();
        assert!(diff(&saved, &again).is_empty());
        assert_eq!(again.to_text(), saved.to_text());
    }

    /// Reading E84: HR 22 came with the ICON3000, HR 3480 with the v2; that it is refused is not
    /// among the words of a file.
    #[test]
    fn a_file_tells_which_model_it_was_found_to_be() {
        let mut before = Dossier::new("XV-101", Device::Icon3000);
        put_registers(&mut before, 22, &[0], 1);
        let step = IconStep::Block(Block {
            table: TableName::Holding,
            start: 3480,
            count: 1,
        });
        before.fail(step, Outcome::Exception, 2, "illegal data address", 1);
        let found = guess(&before);
        assert_eq!(found.model, Some(Model::Icon3000));
        let saved = snapshot(&before, 0).unwrap();
        let (after, _) = open("xv.json", &saved.to_text()).unwrap();
        assert_eq!(guess(&after), found);
        assert_eq!(snapshot(&after, 0).unwrap().to_text(), saved.to_text());
        // Without it, as in files from before.
        let mut old = saved;
        old.guess = None;
        let after = dossier(&old, "old.json");
        assert_eq!(guess(&after).model, None);
        assert_eq!(snapshot(&after, 0).unwrap().guess, None);
    }

    /// HR 3023 to 3026 say 2025-12-06 05:46:52, read 12 s after the oldest part, when it was
    /// 05:46:50 UTC: 2 s ahead, in the file too.
    #[test]
    fn the_clock_keeps_its_own_time() {
        let mut before = device();
        put_registers(
            &mut before,
            3023,
            &[0x0612, 0x2025, 0x0005, 0x4652],
            12_000_000,
        );
        before.start_wall_ms = 1_764_999_998_000;
        assert_eq!(before.clock_offset(), Some(2));
        let saved = snapshot(&before, 0).unwrap();
        assert_eq!(saved.taken, "2025-12-06T05:46:38Z");
        assert_eq!(saved.clock_read, "2025-12-06T05:46:50Z");
        let (after, _) = open("xv.json", &saved.to_text()).unwrap();
        assert_eq!(after.clock_offset(), Some(2));
        assert_eq!(snapshot(&after, 0).unwrap().to_text(), saved.to_text());
    }

    #[test]
    fn gaps_are_told_before_it_is_saved() {
        let said = gaps(&device());
        assert!(said.contains("parts not read, 1 part refused"), "{said}");
        assert_eq!(gaps(&Dossier::new("x", Device::None)), "7 parts not read");
    }

    #[test]
    fn other_files_are_refused_in_words() {
        for text in ["", "{}", "[1]", "{\"format\":\"other\"}"] {
            let error = open("x.json", text).unwrap_err();
            assert!(error.starts_with("x.json is no snapshot: "), "{error}");
        }
    }

    #[test]
    fn times_are_read() {
        assert_eq!(seconds("2025-12-06T05:46:40Z"), Some(1_765_000_000));
        assert_eq!(seconds("yesterday"), None);
    }
}
