//! What a screen needs, and what of it is still to be read.

use shared::address::{Address, Table};
use shared::icon3000::Span;
use shared::icon3000::plan::Probe;
use shared::map::plan::plan;
use shared::map::row::{Access, Kind, Row};
use shared::proto::{Block, IconStep, MAX_ICON_STEPS};

use super::dossier::{Dossier, Subject};

/// Sub-functions of FC 08 that read a counter, in the order of the manual's table 19.
pub const COUNTERS: [u16; 6] = [11, 12, 13, 14, 17, 18];

/// The file whose records the manual does not describe, nor how many there are (reading E69).
pub const LIMITS: u16 = 5;

/// Things to be read, all of them or only those that are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// What it is, for people.
    pub what: String,
    /// Blocks of registers and bits.
    pub blocks: Vec<Block>,
    /// Files, by number; none of them on a model that has no files.
    pub files: Vec<u16>,
    /// Runs of files by their first, each with its reference and as many as the device says it has
    /// stored.
    pub runs: Vec<u16>,
    /// The answer to FC 17.
    pub identity: bool,
    /// Counters of FC 08.
    pub counters: Vec<u16>,
    /// True for what is read again and again without being asked for: it gives way to all else.
    pub quiet: bool,
}

/// Files that every device has: logs, recorders, cards.
const ALWAYS: [u16; 12] = [
    2, 3, 4, LIMITS, 5000, 5100, 5200, 5300, 5301, 5302, 5303, 5304,
];

/// Where curves begin, and how many there can be. HR 3511 to 3514 count them in this order.
pub const RUNS: [(u16, u16); 4] = [(1000, 100), (2000, 100), (3000, 16), (3500, 16)];

/// How many curves the device has stored, by HR 3511 to 3514: opening, closing, PST, EFS.
#[must_use]
pub fn stored(dossier: &Dossier) -> [Option<u16>; 4] {
    let mut at = 3511..;
    RUNS.map(|(_, most)| {
        let address = Address::new(at.next().unwrap_or(3511));
        let cell = dossier.image.cell(Table::Holding, address)?;
        Some(cell.word.min(most))
    })
}

impl Wanted {
    /// Rows of the map in the fewest requests.
    #[must_use]
    pub fn rows(mut self, rows: &[&'static Row]) -> Self {
        for table in Table::ALL {
            let reads = plan(table, rows.iter().copied());
            self.blocks.extend(reads.into_iter().map(Block::from));
        }
        self
    }

    /// Holding registers by address, with their number.
    #[must_use]
    pub fn registers(self, dossier: &Dossier, ranges: &[(u16, u16)]) -> Self {
        let maps = dossier.device.map().into_iter();
        let rows = maps.flat_map(|map| map.rows_of(Table::Holding)).copied();
        let rows: Vec<_> = rows.filter(|row| within(row, ranges)).collect();
        self.rows(&rows)
    }

    /// The whole device.
    #[must_use]
    pub fn everything(dossier: &Dossier) -> Self {
        let rows = dossier.device.map().map_or(&[][..], |map| map.rows);
        Self {
            what: "the whole device".to_owned(),
            identity: true,
            counters: COUNTERS.to_vec(),
            files: ALWAYS.to_vec(),
            runs: RUNS.map(|r| r.0).to_vec(),
            ..Self::default()
        }
        .rows(rows)
    }

    /// What is missing, or older than `since` (microseconds), in the order in which it is read. A
    /// log whose head is missing asks for the head first. At most as many steps as one message may
    /// have; what failed since then is not asked for again.
    #[must_use]
    pub fn missing(&self, dossier: &Dossier, since: u64) -> Vec<IconStep> {
        let mut steps: Vec<IconStep> = Vec::new();
        let old_blocks = self.blocks.iter().filter(|b| is_old(dossier, **b, since));
        steps.extend(old_blocks.map(|b| IconStep::Block(*b)));
        let identity = dossier.identity.as_ref().is_none_or(|a| a.at < since);
        if self.identity && identity && !gave_up(dossier, Subject::Identity, since) {
            steps.push(IconStep::Identity);
        }
        for &sub_function in &self.counters {
            let old = dossier.count(sub_function).is_none_or(|r| r.at < since);
            if old && !gave_up(dossier, Subject::Diagnostic(sub_function), since) {
                steps.push(IconStep::Diagnostic { sub_function });
            }
        }
        for file in self.every_file(dossier) {
            if !gave_up(dossier, Subject::File(file), since) {
                steps.extend(rest(dossier, file, since));
            }
        }
        steps.truncate(MAX_ICON_STEPS);
        steps
    }

    /// Every file that is wanted, as far as the device has told how many there are.
    fn every_file(&self, dossier: &Dossier) -> Vec<u16> {
        if !dossier.device.implements(20) || dossier.device.map().is_none() {
            return Vec::new();
        }
        let mut files = self.files.clone();
        for ((first, _), stored) in RUNS.into_iter().zip(stored(dossier)) {
            if self.runs.contains(&first) {
                // The latest is there as a rule, even before its number is known.
                files.extend(first..=first.saturating_add(stored.unwrap_or(1)));
            }
        }
        files
    }
}

/// True if a row begins in one of these ranges: first address and number.
#[must_use]
pub fn within(row: &Row, ranges: &[(u16, u16)]) -> bool {
    let at = row.address.get();
    let inside = |(start, count): &(u16, u16)| at >= *start && at < start.saturating_add(*count);
    ranges.iter().any(inside)
}

fn gave_up(dossier: &Dossier, subject: Subject, since: u64) -> bool {
    let failure = dossier.failed.get(&subject);
    failure.is_some_and(|f| f.is_final(since))
}

/// True if something of a block is to be read. Parts of it may have been refused by themselves.
fn is_old(dossier: &Dossier, block: Block, since: u64) -> bool {
    let Some(read) = block.read() else {
        return false;
    };
    (0..block.count).any(|at| {
        let address = read.start.checked_add(at);
        let cell = address.and_then(|a| dossier.image.cell(read.table, a));
        cell.is_none_or(|c| c.at.get() < since)
            && address.is_some_and(|a| is_awaited(dossier, block, a, since))
    })
}

/// False for a place that failed, or that is not read by itself: between parts of a block.
fn is_awaited(dossier: &Dossier, block: Block, address: Address, since: u64) -> bool {
    let at = address.get();
    let failed = |step: IconStep| match step {
        IconStep::Block(b) => b.table == block.table && at >= b.start && at - b.start < b.count,
        _ => false,
    };
    let mut failures = dossier.failed.values();
    if failures.any(|f| f.is_final(since) && failed(f.step)) {
        return false;
    }
    let maps = dossier.device.map().into_iter();
    let mut row = maps.filter_map(|map| map.row_at(block.table.into(), address));
    let unread = |row: &Row| {
        row.kind == Kind::Reserved || matches!(row.access, Access::Absent | Access::WriteOnly)
    };
    // What is asked for by itself may be beyond the map.
    block.count == 1 || !row.any(unread)
}

/// The parts of a file that are to be read: first its head, then what the head announces.
fn rest(dossier: &Dossier, file: u16, since: u64) -> Vec<IconStep> {
    let spans = if file == LIMITS {
        let known = dossier.probe.filter(|(_, at)| *at >= since);
        let probe = known.map_or_else(|| Probe::new(file, 0), |(probe, _)| probe);
        probe.next().into_iter().collect()
    } else {
        dossier.records(file, since).missing(file)
    };
    spans.into_iter().map(step_of).collect()
}

/// The step that reads a stretch of a file.
#[must_use]
pub const fn step_of(span: Span) -> IconStep {
    IconStep::File {
        file: span.file,
        start: span.start,
        count: span.count,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::device::Device;
    use shared::proto::{Outcome, TableName};

    fn dossier() -> Dossier {
        Dossier::new("XV-101", Device::Icon3000v2)
    }

    fn file(file: u16, start: u16, count: u16) -> IconStep {
        IconStep::File { file, start, count }
    }

    /// Puts records into a file as if they had been read.
    fn put(dossier: &mut Dossier, file: u16, start: u16, words: &[u16], at: u64) {
        let count = u16::try_from(words.len()).unwrap();
        let mut request = vec![0x14, 7, 6];
        for word in [file, start, count] {
            request.extend(word.to_be_bytes());
        }
        let bytes = u8::try_from(words.len() * 2).unwrap();
        let mut response = vec![0x14, bytes + 2, bytes + 1, 6];
        response.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        assert!(dossier.absorb(&request, &response, at));
    }

    /// 64 N + 2 bytes for N connections are 1 + 32 N records (section 8.11.3).
    #[test]
    fn a_log_is_read_by_what_its_head_says() {
        let wanted = Wanted {
            files: vec![4],
            ..Wanted::default()
        };
        let mut dossier = dossier();
        assert_eq!(wanted.missing(&dossier, 0), [file(4, 0, 1)]);
        put(&mut dossier, 4, 0, &[3], 10);
        assert_eq!(wanted.missing(&dossier, 0), [file(4, 1, 96)]);
        put(&mut dossier, 4, 1, &[7; 50], 11);
        assert_eq!(wanted.missing(&dossier, 0), [file(4, 51, 46)], "it goes on");
        put(&mut dossier, 4, 51, &[7; 46], 12);
        assert_eq!(wanted.missing(&dossier, 0), []);
        assert_eq!(wanted.missing(&dossier, 20), [file(4, 0, 1)], "all anew");
        // An empty log has nothing but its head: four records of events.
        put(&mut dossier, 5000, 0, &[0; 4], 10);
        let events = Wanted {
            files: vec![5000],
            ..Wanted::default()
        };
        assert_eq!(events.missing(&dossier, 0), []);
    }

    #[test]
    fn what_failed_is_not_asked_again() {
        let wanted = Wanted {
            files: vec![3500, 1000],
            identity: true,
            counters: vec![11],
            ..Wanted::default()
        };
        let mut dossier = dossier();
        let all = wanted.missing(&dossier, 5);
        assert_eq!(all.len(), 4);
        assert_eq!(all.last(), Some(&file(1000, 0, 108)));
        let refused = |dossier: &mut Dossier, at| {
            let step = file(3500, 0, 110);
            dossier.fail(step, Outcome::Exception, 2, "illegal address", at);
        };
        refused(&mut dossier, 6);
        dossier.fail(IconStep::Identity, Outcome::Silence, 0, "no answer", 4);
        let left = wanted.missing(&dossier, 5);
        assert_eq!(left.len(), 3, "an older failure counts no more: {left:?}");
        assert!(!left.contains(&file(3500, 0, 110)));
        // Going on tries it once more; until that is answered it stays on the list.
        for failure in dossier.failed.values_mut() {
            failure.again = true;
        }
        assert!(wanted.missing(&dossier, 5).contains(&file(3500, 0, 110)));
        assert_eq!(dossier.failed.len(), 2);
        refused(&mut dossier, 9);
        assert!(!wanted.missing(&dossier, 5).contains(&file(3500, 0, 110)));
    }

    /// Reading E69: nothing tells the length of file 5. Of 64 records, 121 are refused, then 60
    /// answered, and of the four that are left 3 and 1; a further one is refused.
    #[test]
    fn file_5_is_found_by_halves() {
        let wanted = Wanted {
            files: vec![5],
            ..Wanted::default()
        };
        let mut dossier = dossier();
        let mut asked = Vec::new();
        while let [IconStep::File { start, count, .. }] = wanted.missing(&dossier, 3)[..] {
            asked.push((start, count));
            assert!(asked.len() < 40, "{asked:?}");
            if start + count <= 64 {
                put(&mut dossier, 5, start, &vec![7; count.into()], 9);
            } else {
                let step = file(5, start, count);
                dossier.fail(step, Outcome::Exception, 2, "illegal data address", 9);
            }
        }
        assert_eq!(asked[..3], [(0, 121), (0, 60), (60, 60)]);
        assert_eq!(asked.last(), Some(&(64, 1)));
        assert_eq!(dossier.records(5, 0).len(), 64);
        assert!(dossier.failed.is_empty(), "its end is no failure");
        assert_eq!(wanted.missing(&dossier, 10), [file(5, 0, 121)], "all anew");
    }

    /// A device without the file refuses even its first record, and that is said.
    #[test]
    fn no_file_5_is_a_failure() {
        let wanted = Wanted {
            files: vec![5],
            ..Wanted::default()
        };
        let mut dossier = dossier();
        for count in [121, 60, 30, 15, 7, 3, 1] {
            assert_eq!(wanted.missing(&dossier, 0), [file(5, 0, count)]);
            let step = file(5, 0, count);
            dossier.fail(step, Outcome::Exception, 2, "illegal data address", 9);
        }
        assert_eq!(dossier.failed.len(), 1);
        assert_eq!(wanted.missing(&dossier, 0), []);
    }

    /// HR 3513 says that two partial strokes are stored: the reference and those two are read.
    #[test]
    fn curves_are_read_as_many_as_are_stored() {
        let mut dossier = dossier();
        let wanted = Wanted {
            runs: vec![3000],
            ..Wanted::default()
        };
        let files = |dossier: &Dossier| -> Vec<u16> {
            let steps = wanted.missing(dossier, 0).into_iter();
            steps
                .filter_map(|s| match s {
                    IconStep::File { file, .. } => Some(file),
                    _ => None,
                })
                .collect()
        };
        assert_eq!(files(&dossier), [3000, 3001]);
        assert!(dossier.absorb(&[3, 0x0D, 0xB9, 0, 1], &[3, 2, 0, 2], 1));
        assert_eq!(files(&dossier), [3000, 3001, 3002]);
        dossier.device = Device::Icon3000;
        assert_eq!(files(&dossier), [0; 0], "there are no files before the v2");
    }

    /// HR 3460 to 3473 came with firmware 2.03 (reading E84). Before, the block around them is
    /// refused, and the parts of it are read one by one.
    #[test]
    fn a_block_is_read_once_its_parts_are() {
        let mut dossier = dossier();
        let wanted = Wanted::default().registers(&dossier, &[(3392, 82)]);
        let all = wanted.missing(&dossier, 1);
        assert_eq!(all.len(), 1);
        let mut response = vec![3, 128];
        response.extend([0; 128]);
        assert!(dossier.absorb(&[3, 0x0D, 0x40, 0, 64], &response, 9));
        assert_eq!(wanted.missing(&dossier, 1), all, "3460 is not known");
        let step = IconStep::Block(Block {
            table: TableName::Holding,
            start: 3460,
            count: 14,
        });
        dossier.fail(step, Outcome::Exception, 2, "illegal data address", 9);
        let left = wanted.missing(&dossier, 1);
        assert_eq!(left, [], "3456 to 3459 are reserved");
        assert_eq!(wanted.missing(&dossier, 10), all, "all anew");
    }

    #[test]
    fn registers_are_asked_in_blocks() {
        let mut dossier = dossier();
        let wanted = Wanted::default().registers(&dossier, &[(3200, 256)]);
        let counts: Vec<_> = wanted.blocks.iter().map(|b| (b.start, b.count)).collect();
        assert_eq!(counts, [(3200, 125), (3325, 125), (3450, 6)]);
        assert_eq!(wanted.missing(&dossier, 0).len(), 3);
        let mut response = vec![3, 250];
        response.extend([0; 250]);
        dossier.absorb(&[3, 0x0C, 0x80, 0, 125], &response, 9);
        assert_eq!(wanted.missing(&dossier, 0).len(), 2);
        assert!(wanted.blocks.iter().all(|b| b.table == TableName::Holding));
    }
}
