//! Everything that was read of a device: registers, files, identity, counters, and what failed.

mod files;

use std::collections::BTreeMap;

use shared::address::{Address, Table};
use shared::capture::Micros;
use shared::device::Device;
use shared::icon3000::Span;
use shared::icon3000::identity::Guess;
use shared::icon3000::plan::Probe;
use shared::image::Image;
use shared::map::row::{Access, DeviceMap, Kind, Row};
use shared::proto::{IconStep, Outcome, TableName};

use super::logs::moment;
use super::wanted::{LIMITS, RUNS, stored};

/// A record of a file, and when it was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// The word.
    pub word: u16,
    /// When it was read, in microseconds.
    pub at: u64,
}

/// Why something could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failure {
    /// What was asked for.
    pub step: IconStep,
    /// How it ended.
    pub outcome: Outcome,
    /// The code of an exception; 0 for none.
    pub code: u8,
    /// In words.
    pub text: String,
    /// When.
    pub at: u64,
    /// True once it is to be tried again.
    pub again: bool,
}

impl Failure {
    /// True if it is not asked for again in a read that began at a time.
    #[must_use]
    pub const fn is_final(&self, since: u64) -> bool {
        self.at >= since && !self.again
    }
}

/// An answer as it came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Answer {
    /// The response PDU.
    pub pdu: Vec<u8>,
    /// When it came, in microseconds.
    pub at: u64,
}

/// A counter as it was read at a time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reading {
    /// What it said.
    pub count: u16,
    /// When, in microseconds.
    pub at: u64,
}

/// What a log is said to have failed with whose head was another one in the end.
pub const CHANGED: &str = "the log changed while it was read; read it again";

/// Readings of a counter that are kept.
const READINGS: usize = 720;

/// What was asked for, so that a failure finds its place again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Subject {
    /// A block of registers, by table and first address.
    Block(u8, u16),
    /// A file.
    File(u16),
    /// FC 17.
    Identity,
    /// A sub-function of FC 08.
    Diagnostic(u16),
}

impl Subject {
    /// What a step asks for.
    #[must_use]
    pub const fn of(step: IconStep) -> Self {
        match step {
            IconStep::Block(block) => Self::Block(
                match block.table {
                    TableName::Coil => 1,
                    TableName::Discrete => 2,
                    TableName::Holding => 3,
                    TableName::Input => 4,
                },
                block.start,
            ),
            IconStep::File { file, .. } => Self::File(file),
            IconStep::Identity => Self::Identity,
            IconStep::Diagnostic { sub_function } => Self::Diagnostic(sub_function),
        }
    }
}

/// One device.
#[derive(Clone, Debug, Default)]
pub struct Dossier {
    /// Its tag.
    pub tag: String,
    /// Its kind.
    pub device: Device,
    /// Its unit address.
    pub unit: u8,
    /// Where it is from: empty for the device on the line, else the name of a file.
    pub origin: String,
    /// Milliseconds since 1970 at the moment 0 of all times in here.
    pub start_wall_ms: u64,
    /// Its registers and bits.
    pub image: Image,
    /// Records of its files; what was not read is `None`.
    pub files: BTreeMap<u16, Vec<Option<Record>>>,
    /// Its answer to FC 17.
    pub identity: Option<Answer>,
    /// Its counters of FC 08, by sub-function, the latest last.
    pub counters: BTreeMap<u16, Vec<Reading>>,
    /// What could not be read.
    pub failed: BTreeMap<Subject, Failure>,
    /// How far the file is known whose length nothing tells, and since when.
    pub probe: Option<(Probe, u64)>,
    /// Logs of which more than the head was read, but the head not once more after that.
    pub unchecked: Vec<u16>,
    /// Which model a file says it is, and why.
    pub guess: Option<Guess>,
}

impl Dossier {
    /// A device of which nothing is known yet.
    #[must_use]
    pub fn new(tag: &str, device: Device) -> Self {
        Self {
            tag: tag.to_owned(),
            device,
            ..Self::default()
        }
    }

    /// True if nothing is known of it.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.image.is_empty()
            && self.files.is_empty()
            && self.identity.is_none()
            && self.counters.is_empty()
    }

    /// Seconds since 1970 at a time of this device.
    #[must_use]
    pub fn wall(&self, at: u64) -> i64 {
        let ms = self.start_wall_ms.saturating_add(at / 1000);
        i64::try_from(ms / 1000).unwrap_or(i64::MAX)
    }

    /// Takes a good answer in. False if it is none to what was asked.
    pub fn absorb(&mut self, request: &[u8], response: &[u8], at: u64) -> bool {
        let taken = match request {
            [0x11] if response.first() == Some(&0x11) => {
                self.identity = Some(Answer {
                    pdu: response.to_vec(),
                    at,
                });
                Some(Subject::Identity)
            }
            &[8, high, low, ..] => self.counter(u16::from_be_bytes([high, low]), response, at),
            [0x14, ..] => self.file_answer(request, response, at),
            _ => self.registers(request, response, at),
        };
        if let Some(subject) = taken {
            self.failed.remove(&subject);
        }
        taken.is_some()
    }

    fn registers(&mut self, request: &[u8], response: &[u8], at: u64) -> Option<Subject> {
        let at = Micros::new(at);
        let (table, start, count) = self.image.absorb(request, response, at)?;
        let (function, start) = (table.read_function(), start.get());
        // What was refused as part of it is known now.
        let known = |s: &Subject| match *s {
            Subject::Block(f, at) => f == function && at >= start && at - start < count,
            _ => false,
        };
        self.failed.retain(|subject, _| !known(subject));
        // Curves beyond those that are stored are left from before.
        for ((first, most), stored) in RUNS.into_iter().zip(stored(self)) {
            if let Some(stored) = stored {
                let gone = first + stored + 1..=first + most;
                for file in gone {
                    self.files.remove(&file);
                    self.failed.remove(&Subject::File(file));
                }
            }
        }
        Some(Subject::Block(function, start))
    }

    fn counter(&mut self, sub: u16, response: &[u8], at: u64) -> Option<Subject> {
        let &[8, high, low, a, b] = response else {
            return None;
        };
        if u16::from_be_bytes([high, low]) != sub {
            return None;
        }
        let readings = self.counters.entry(sub).or_default();
        readings.push(Reading {
            count: u16::from_be_bytes([a, b]),
            at,
        });
        if readings.len() > READINGS {
            readings.remove(0);
        }
        Some(Subject::Diagnostic(sub))
    }

    /// Notes that something could not be read; `code` is that of an exception, or 0.
    pub fn fail(&mut self, step: IconStep, outcome: Outcome, code: u8, text: &str, at: u64) {
        if let (IconStep::File { file, start, count }, 2) = (step, code) {
            self.probed(Span::new(file, start, count), false, at);
            // Beyond its end is no failure, unless not even its first record is there.
            let goes_on = |(p, _): (Probe, u64)| p.next().is_some() || p.found() > 0;
            if file == LIMITS && self.probe.is_some_and(goes_on) {
                return;
            }
        }
        let failure = Failure {
            step,
            outcome,
            code,
            text: text.to_owned(),
            at,
            again: false,
        };
        self.failed.insert(Subject::of(step), failure);
    }

    /// Rows that a device has, holding registers first; of what the input registers show once more
    /// (reading E44) the holding registers are taken.
    #[must_use]
    pub fn rows(&self, wanted: &dyn Fn(&Row) -> bool) -> Vec<&'static Row> {
        let mut found: Vec<&'static Row> = Vec::new();
        let maps = self.device.map().into_iter();
        let tables = [Table::Holding, Table::Input];
        let rows = maps.flat_map(|map| tables.into_iter().flat_map(|t| map.rows_of(t)));
        for row in rows {
            let there = row.access != Access::Absent && row.kind != Kind::Reserved;
            if there && wanted(row) && found.iter().all(|r| r.key != row.key) {
                found.push(row);
            }
        }
        found
    }

    /// The row with a key.
    #[must_use]
    pub fn row(&self, key: &str) -> Option<&'static Row> {
        self.rows(&|row| row.key == key).first().copied()
    }

    /// True if the device should have what a step asks for, as far as its map tells; what is asked
    /// for to find out which model it is may be beyond that.
    #[must_use]
    pub fn has(&self, step: IconStep) -> bool {
        let IconStep::Block(block) = step else {
            return true;
        };
        let table = Table::from(block.table);
        let row = |map: &'static DeviceMap| map.row_at(table, Address::new(block.start));
        let row = self.device.map().and_then(row);
        row.is_some_and(|row| row.access != Access::Absent && row.kind != Kind::Reserved)
    }

    /// Date and time of the device: two registers each. The ICON2000v4 has none but the first.
    #[must_use]
    pub const fn clock(&self) -> (u16, u16) {
        match self.device {
            Device::Icon2000v4 => (15, 4),
            _ => (3023, 4),
        }
    }

    /// Seconds that the clock of the device is ahead of ours (UTC), by its registers; its time zone
    /// is not told. `None` if they were not read or hold no time.
    #[must_use]
    pub fn clock_offset(&self) -> Option<i64> {
        let (start, _) = self.clock();
        let map = self.device.map()?;
        let row = |at| map.row_at(Table::Holding, Address::new(at));
        let date = self.image.row(row(start)?)?;
        let time = self.image.row(row(start + 2)?)?;
        let then = moment(Some(date.judged.value), Some(time.judged.value))?;
        Some(then - self.wall(time.at.get()))
    }

    /// The latest reading of a counter.
    #[must_use]
    pub fn count(&self, sub: u16) -> Option<Reading> {
        self.counters.get(&sub)?.last().copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::put as put_registers;
    use crate::actuator::state::logs::tests::put;
    use crate::actuator::state::wanted::step_of;

    fn empty() -> Dossier {
        Dossier::new("XV-101", Device::Icon3000v2)
    }

    /// Records 2 and 3 of file 2, then 0 and 1: the layout of Modbus V1.1b3, section 6.14.
    #[test]
    fn records_fill_a_file_in_any_order() {
        let mut dossier = empty();
        assert!(dossier.absorb(
            &[0x14, 7, 6, 0, 2, 0, 2, 0, 2],
            &[0x14, 6, 5, 6, 0x0D, 0xFE, 0, 0x20],
            9,
        ));
        assert_eq!(dossier.records(2, 0).run(0, 1), None);
        assert!(dossier.absorb(
            &[0x14, 7, 6, 0, 2, 0, 0, 0, 2],
            &[0x14, 6, 5, 6, 0, 1, 0x30, 0],
            5,
        ));
        let words = dossier.records(2, 0).run(0, 4);
        assert_eq!(words, Some(vec![1, 0x3000, 0x0DFE, 0x20]));
        assert_eq!(dossier.records(2, 6).run(2, 2), Some(vec![0x0DFE, 0x20]));
        assert_eq!(dossier.records(2, 6).get(0), None);
        assert_eq!(dossier.read_at(2), Some(5));
        assert_eq!(dossier.read_at(3), None);
    }

    /// Two groups in one answer: record 0 of file 3 and records 1 and 2 of file 4.
    #[test]
    fn one_answer_may_fill_several_files() {
        let mut dossier = empty();
        assert!(dossier.absorb(
            &[0x14, 14, 6, 0, 3, 0, 0, 0, 1, 6, 0, 4, 0, 1, 0, 2],
            &[0x14, 10, 3, 6, 0, 7, 5, 6, 0, 8, 0, 9],
            5,
        ));
        assert_eq!(dossier.records(3, 0).get(0), Some(7));
        assert_eq!(dossier.records(4, 0).run(1, 2), Some(vec![8, 9]));
        assert_eq!(dossier.records(4, 0).get(0), None);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let mut dossier = empty();
        let request = [0x14, 7, 6, 0, 2, 0, 0, 0, 1];
        for response in [
            &[0x94, 2][..],
            &[0x14, 4, 3, 6, 0],
            &[0x14, 4, 3, 5, 0, 1],
            &[0x14, 6, 5, 6, 0, 1, 0, 2],
            &[0x14, 5, 3, 6, 0, 1],
            &[],
        ] {
            assert!(!dossier.absorb(&request, response, 1), "{response:?}");
        }
        assert!(!dossier.absorb(&[8, 0, 11, 0, 0], &[8, 0, 12, 0, 1], 1));
        assert!(!dossier.absorb(&[0x11], &[0x91, 4], 1));
        assert!(dossier.files.is_empty() && dossier.counters.is_empty());
    }

    #[test]
    fn registers_identity_and_counters_are_kept() {
        let mut dossier = empty();
        let step = IconStep::Diagnostic { sub_function: 11 };
        dossier.fail(step, Outcome::Silence, 0, "no answer", 1);
        assert!(dossier.absorb(&[3, 0x0B, 0xBC, 0, 1], &[3, 2, 0, 0xF0], 7));
        let cell = dossier.image.cell(Table::Holding, Address::new(3004));
        assert_eq!(cell.map(|c| c.word), Some(0xF0));
        assert!(dossier.absorb(&[0x11], &[0x11, 2, 0, 0], 8));
        assert_eq!(dossier.identity.as_ref().map(|a| a.at), Some(8));
        for (count, at) in [(5, 10), (9, 20)] {
            assert!(dossier.absorb(&[8, 0, 11, 0, 0], &[8, 0, 11, 0, count], at));
        }
        assert_eq!(dossier.count(11), Some(Reading { count: 9, at: 20 }));
        assert!(dossier.failed.is_empty(), "an answer mends a failure");
    }

    /// HR 3023 to 3026: 0xDDMM, 0xYYYY, 0x00HH, 0xMMSS (notes 2 and 3); 2025-12-06 05:46:40 UTC is
    /// second 1 765 000 000.
    #[test]
    fn the_clock_of_the_device_is_compared_with_ours() {
        let mut dossier = empty();
        assert_eq!(dossier.clock_offset(), None);
        dossier.start_wall_ms = 1_765_000_000_000;
        let response = [3, 8, 0x06, 0x12, 0x20, 0x25, 0x00, 0x06, 0x46, 0x52];
        assert!(dossier.absorb(&[3, 0x0B, 0xCF, 0, 4], &response, 2_000_000));
        assert_eq!(
            dossier.clock_offset(),
            Some(3610),
            "an hour and 12 s less 2 s"
        );
    }

    /// An alarm takes 6 bytes behind a head of 2 (section 8.11.1). Two became one, then none.
    #[test]
    fn a_log_that_is_shorter_now_keeps_nothing_of_before() {
        let mut dossier = empty();
        put(&mut dossier, 2, &[[2].as_slice(), &[7; 6]].concat());
        put(&mut dossier, 2, &[2]);
        assert_eq!(dossier.records(2, 0).len(), 7, "as many as before");
        for head in [1, 0] {
            put(&mut dossier, 2, &[head]);
            assert_eq!(dossier.records(2, 0).stretches(), [(0, vec![head])]);
        }
    }

    /// Nothing tells how long file 5 is but where the device refuses the next record.
    #[test]
    fn file_5_ends_where_it_is_refused() {
        let mut dossier = empty();
        put(&mut dossier, 5, &[7; 121]);
        let refuse = |dossier: &mut Dossier, start, count| {
            let step = step_of(Span::new(LIMITS, start, count));
            dossier.fail(step, Outcome::Exception, 2, "illegal data address", 9);
        };
        for count in [121, 60, 30] {
            refuse(&mut dossier, 0, count);
        }
        put(&mut dossier, 5, &[8; 15]);
        assert_eq!(dossier.records(5, 0).len(), 121, "the end is not found yet");
        for count in [15, 7, 3, 1] {
            refuse(&mut dossier, 15, count);
        }
        assert_eq!(dossier.records(5, 0).stretches(), [(0, vec![8; 15])]);
    }

    /// HR 3513 counts the partial strokes: two, then one. The reference, file 3000, stays.
    #[test]
    fn curves_beyond_those_stored_are_gone() {
        let mut dossier = empty();
        for file in [2016, 3000, 3001, 3002, 3016, 3500] {
            put(&mut dossier, file, &[7]);
        }
        let files = |dossier: &Dossier| dossier.files.keys().copied().collect::<Vec<_>>();
        for file in [3001, 3003] {
            let step = step_of(Span::new(file, 0, 110));
            dossier.fail(step, Outcome::Silence, 0, "no answer", 1);
        }
        put_registers(&mut dossier, 3513, &[2], 1);
        let left: Vec<_> = dossier.failed.keys().copied().collect();
        assert_eq!(left, [Subject::File(3001)]);
        assert_eq!(files(&dossier), [2016, 3000, 3001, 3002, 3500]);
        put_registers(&mut dossier, 3513, &[1], 2);
        assert_eq!(files(&dossier), [2016, 3000, 3001, 3500]);
    }

    /// A block that was refused, and a part of it, are both known once the block answers.
    #[test]
    fn an_answer_mends_what_failed_within_it() {
        let mut dossier = empty();
        for (start, count) in [(3450, 30), (3460, 14), (3480, 1)] {
            let table = TableName::Holding;
            let step = IconStep::Block(shared::proto::Block {
                table,
                start,
                count,
            });
            dossier.fail(step, Outcome::Exception, 2, "illegal data address", 1);
        }
        put_registers(&mut dossier, 3450, &[0; 30], 2);
        let left: Vec<_> = dossier.failed.keys().copied().collect();
        assert_eq!(left, [Subject::Block(3, 3480)]);
    }

    #[test]
    fn times_are_told_on_our_clock() {
        let mut dossier = empty();
        dossier.start_wall_ms = 1_765_000_000_500;
        assert_eq!(dossier.wall(2_600_000), 1_765_000_003);
    }
}
