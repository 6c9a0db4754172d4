//! What a screen needs, and what of it is still to be read.

use shared::address::{Address, Table};
use shared::icon3000::Span;
use shared::map::plan::plan;
use shared::map::row::Row;
use shared::proto::{Block, IconStep, MAX_ICON_STEPS};

use super::dossier::{Dossier, Subject};

/// Sub-functions of FC 08 that read a counter, in the order of the manual's table 19.
pub const COUNTERS: [u16; 6] = [11, 12, 13, 14, 17, 18];

/// The file whose records the manual does not describe, and how many of them are asked for: as many
/// as one answer holds (readings E69, E80).
pub const LIMITS: (u16, u16) = (5, 121);

/// Things to be read, all of them or only those that are missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// What it is, for people.
    pub what: String,
    /// Blocks of registers and bits.
    pub blocks: Vec<Block>,
    /// Files, by number.
    pub files: Vec<u16>,
    /// The answer to FC 17.
    pub identity: bool,
    /// Counters of FC 08.
    pub counters: Vec<u16>,
    /// True for every file besides: as many curves as the device says it has stored.
    pub whole: bool,
}

/// Files that every device has: logs, recorders, cards.
const ALWAYS: [u16; 11] = [2, 3, 4, 5000, 5100, 5200, 5300, 5301, 5302, 5303, 5304];

/// Where curves begin, the register that counts them, and how many there can be.
const CURVES: [(u16, u16, u16); 4] = [
    (1000, 3511, 100),
    (2000, 3512, 100),
    (3000, 3513, 16),
    (3500, 3514, 16),
];

/// Every file of a device, as far as it has told how many there are.
fn every_file(dossier: &Dossier) -> Vec<u16> {
    if !dossier.device.implements(20) || dossier.device.map().is_none() {
        return Vec::new();
    }
    let mut files = ALWAYS.to_vec();
    for (first, counter, most) in CURVES {
        let cell = dossier.image.cell(Table::Holding, Address::new(counter));
        let stored = cell.map_or(0, |c| c.word.min(most));
        files.extend(first..=first.saturating_add(stored));
    }
    files
}

impl Wanted {
    /// Rows of the map in the fewest requests.
    #[must_use]
    pub fn rows(mut self, rows: impl Iterator<Item = &'static Row> + Clone) -> Self {
        for table in Table::ALL {
            let reads = plan(table, rows.clone());
            self.blocks.extend(reads.into_iter().map(Block::from));
        }
        self
    }

    /// Holding registers by address, with their number.
    #[must_use]
    pub fn registers(mut self, dossier: &Dossier, ranges: &[(u16, u16)]) -> Self {
        let Some(map) = dossier.device.map() else {
            return self;
        };
        let rows = map.rows_of(Table::Holding).iter().copied();
        let rows = rows.filter(|row| {
            let at = row.address.get();
            ranges
                .iter()
                .any(|(start, count)| at >= *start && at < start.saturating_add(*count))
        });
        let reads = plan(Table::Holding, rows);
        self.blocks.extend(reads.into_iter().map(Block::from));
        self
    }

    /// The whole device.
    #[must_use]
    pub fn everything(dossier: &Dossier) -> Self {
        let rows = dossier.device.map().map_or(&[][..], |map| map.rows);
        Self {
            what: "the whole device".to_owned(),
            identity: true,
            counters: COUNTERS.to_vec(),
            whole: true,
            ..Self::default()
        }
        .rows(rows.iter().copied())
    }

    /// What is missing, or older than `since` (microseconds), in the order in which it is read. A
    /// log whose head is missing asks for the head first. At most as many steps as one message may
    /// have; what failed since then is not asked for again.
    #[must_use]
    pub fn missing(&self, dossier: &Dossier, since: u64) -> Vec<IconStep> {
        let mut steps: Vec<IconStep> = Vec::new();
        let old_block = |block: &&Block| {
            let step = IconStep::Block(**block);
            !gave_up(dossier, Subject::of(step), since) && is_old(dossier, **block, since)
        };
        steps.extend(
            self.blocks
                .iter()
                .filter(old_block)
                .map(|b| IconStep::Block(*b)),
        );
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
        let every = if self.whole {
            every_file(dossier)
        } else {
            Vec::new()
        };
        for &file in self.files.iter().chain(&every) {
            if !gave_up(dossier, Subject::File(file), since) {
                steps.extend(rest(dossier, file, since));
            }
        }
        steps.truncate(MAX_ICON_STEPS);
        steps
    }
}

fn gave_up(dossier: &Dossier, subject: Subject, since: u64) -> bool {
    dossier.failed.get(&subject).is_some_and(|f| f.at >= since)
}

fn is_old(dossier: &Dossier, block: Block, since: u64) -> bool {
    let Some(read) = block.read() else {
        return false;
    };
    (0..block.count).any(|at| {
        let address = read.start.checked_add(at);
        let cell = address.and_then(|a| dossier.image.cell(read.table, a));
        cell.is_none_or(|c| c.at.get() < since)
    })
}

/// The parts of a file that are to be read: first its head, then what the head announces.
fn rest(dossier: &Dossier, file: u16, since: u64) -> Vec<IconStep> {
    let fresh = dossier.records(file, since);
    let spans = if file == LIMITS.0 {
        let missing = (0..LIMITS.1).find(|at| fresh.get(*at).is_none());
        let count = |start| LIMITS.1.saturating_sub(start);
        missing.map_or_else(Vec::new, |start| vec![Span::new(file, start, count(start))])
    } else {
        fresh.missing(file)
    };
    let step = |span: Span| IconStep::File {
        file: span.file,
        start: span.start,
        count: span.count,
    };
    spans.into_iter().map(step).collect()
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
        dossier.fail(file(3500, 0, 110), Outcome::Exception, "illegal address", 6);
        dossier.fail(IconStep::Identity, Outcome::Silence, "no answer", 4);
        let left = wanted.missing(&dossier, 5);
        assert_eq!(left.len(), 3, "an older failure counts no more: {left:?}");
        assert!(!left.contains(&file(3500, 0, 110)));
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
