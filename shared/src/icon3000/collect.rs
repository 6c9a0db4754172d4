//! A whole device, request by request: what to ask next, and what to make of the answer.
//!
//! Pure: whoever owns the line asks for the [`Collector::step`] request, sends it, and hands the
//! answer back. First the tables (never a reserved range), identity and counters; then, where the
//! model has files, the heads of the logs, the curves that the registers say are stored, and the
//! card reports; then the entries that the heads announce, and the file of which nobody knows how
//! long it is; at last the heads once more, so that a log that changed while it was read is known.
//!
//! A busy device is asked again ([`Step::wait_ms`]). What it refuses as a whole is asked for in parts.

mod split;
mod wire;

use std::collections::VecDeque;

use super::counters;
use super::model::{FILES, File, Numbering};
use super::plan::{FileRead, Probe, Span, plan};
use super::snapshot::{Failure, Part, Snapshot};
use crate::address::{Address, Table};
use crate::encode::Read;
use crate::map;
use split::Split;

pub use wire::Wire;

/// Function code of file reads.
const READ_FILE: u8 = 20;
/// Exception codes (table 50).
const ILLEGAL_FUNCTION: u8 = 1;
const ILLEGAL_ADDRESS: u8 = 2;
const ILLEGAL_VALUE: u8 = 3;
/// "The master should retransmit the request later."
const BUSY: u8 = 6;
/// How often a busy device is asked again, and how long is waited before each time.
pub const BUSY_TRIES: u8 = 3;
/// See [`BUSY_TRIES`].
pub const BUSY_WAIT_MS: u32 = 200;
/// Registers that tell how many curves of a kind are stored, and whether a reference is set
/// (reading E32), by the first file of the kind.
const STORED: [(u16, u16, u16); 4] = [
    (1000, 3511, 3982),
    (2000, 3512, 3981),
    (3000, 3513, 3983),
    (3500, 3514, 3984),
];

/// One request.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Step {
    /// The request PDU.
    pub pdu: Vec<u8>,
    /// Length of a good response PDU.
    pub response_len: usize,
    /// How long to wait before it is sent: the device was busy.
    pub wait_ms: u32,
    /// How often it was sent already.
    tries: u8,
    /// What it reads; of several stretches of files, all.
    parts: Vec<Part>,
}

impl Step {
    fn new(pdu: Vec<u8>, response_len: usize, parts: Vec<Part>) -> Self {
        Self {
            pdu,
            response_len,
            wait_ms: 0,
            tries: 0,
            parts,
        }
    }

    fn block(read: Read) -> Self {
        let part = Part::Block(read.table, read.start, read.count());
        Self::new(read.pdu().to_vec(), read.response_len(), vec![part])
    }

    fn files(read: &FileRead) -> Self {
        let parts = read.spans().iter().copied().map(Part::File).collect();
        Self::new(read.pdu(), read.response_len(), parts)
    }

    /// What it reads.
    #[must_use]
    pub fn parts(&self) -> &[Part] {
        &self.parts
    }

    /// What it reads, in words: `Holding register 3000 to 3124`.
    #[must_use]
    pub fn text(&self) -> String {
        match self.parts.as_slice() {
            [] => String::new(),
            [one] => one.to_string(),
            [first, ..] => {
                let more = self.parts.len().saturating_sub(1);
                format!("{first} and {more} more")
            }
        }
    }
}

/// How an exchange ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer<'a> {
    /// A response PDU, that of an exception too.
    Response(&'a [u8]),
    /// None, and why: `no answer`.
    Failed(&'a str),
}

/// What is asked next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Tables,
    Heads,
    Entries,
    /// Files of which nothing says how long they are.
    Raw,
    Again,
    Done,
}

/// Reads a whole device.
#[derive(Clone, Debug)]
pub struct Collector {
    snapshot: Snapshot,
    queue: VecDeque<Step>,
    stage: Stage,
    done: u32,
    wire: Wire,
    /// A block that was refused and is read in parts.
    split: Option<Split>,
    /// The file whose length is being found.
    probe: Option<Probe>,
    /// Curves of which it is not known how many there are; told once the device turned out to have
    /// files.
    uncounted: Vec<Failure>,
}

impl Collector {
    /// Reads everything that the model of `snapshot` has; what is in it already is read again.
    #[must_use]
    pub fn new(snapshot: Snapshot) -> Self {
        let map = snapshot.model.map();
        let mut queue = VecDeque::new();
        for table in Table::ALL {
            let rows = map.rows_of(table).iter().copied();
            queue.extend(map::plan::plan(table, rows).into_iter().map(Step::block));
        }
        queue.push_back(Step::new(vec![17], 86, vec![Part::Identity]));
        for counter in &counters::NAMES {
            let [high, low] = counter.sub.to_be_bytes();
            let part = Part::Counter(counter.sub);
            queue.push_back(Step::new(vec![8, high, low, 0, 0], 5, vec![part]));
        }
        Self {
            snapshot,
            queue,
            stage: Stage::Tables,
            done: 0,
            wire: Wire::default(),
            split: None,
            probe: None,
            uncounted: Vec::new(),
        }
    }

    /// The next request; `None` when everything was asked. The same one until it was answered.
    #[must_use]
    pub fn step(&mut self) -> Option<&Step> {
        while self.queue.is_empty() && self.stage != Stage::Done {
            self.go_on();
        }
        self.queue.front()
    }

    /// Takes the answer to the request that [`step`](Self::step) gave. False if it was no good one:
    /// an exception, nothing, or something else than was asked for.
    pub fn answer(&mut self, answer: Answer<'_>) -> bool {
        let Some(step) = self.queue.pop_front() else {
            return false;
        };
        self.done = self.done.saturating_add(1);
        let why = match answer {
            Answer::Failed(why) => why.to_owned(),
            Answer::Response(response) => {
                self.wire.add(step.pdu.len(), response.len());
                if self.take(&step, response) {
                    self.took();
                    return true;
                }
                match response {
                    [function, code, ..] if *function >= 0x80 => {
                        self.refused(step, *code);
                        return false;
                    }
                    _ => "the answer is not what was asked for".to_owned(),
                }
            }
        };
        self.gave_up(&step, &why);
        false
    }

    /// Requests that were answered or failed, and requests in all as far as they are known.
    #[must_use]
    pub fn progress(&self) -> (u32, u32) {
        let left = u32::try_from(self.queue.len()).unwrap_or(u32::MAX);
        (self.done, self.done.saturating_add(left))
    }

    /// What the wire carried so far.
    #[must_use]
    pub const fn wire(&self) -> Wire {
        self.wire
    }

    /// What was read so far.
    #[must_use]
    pub const fn snapshot(&self) -> &Snapshot {
        &self.snapshot
    }

    /// What was read, for the context that the caller knows: tool, time.
    pub const fn snapshot_mut(&mut self) -> &mut Snapshot {
        &mut self.snapshot
    }

    /// What was read.
    #[must_use]
    pub fn finish(self) -> Snapshot {
        self.snapshot
    }

    /// Takes a good answer in. At the second look at the heads of the logs it only compares.
    fn take(&mut self, step: &Step, response: &[u8]) -> bool {
        if self.stage != Stage::Again {
            return self.snapshot.absorb(&step.pdu, response);
        }
        let mut now = super::records::Files::default();
        let Some(spans) = now.absorb(&step.pdu, response) else {
            return false;
        };
        for span in spans {
            let words = |files: &super::records::Files| {
                files
                    .get(span.file)
                    .and_then(|r| r.run(span.start, span.count))
            };
            if words(&now) != words(&self.snapshot.files) {
                self.snapshot.failures.push(Failure {
                    part: Part::File(span),
                    why: "the log changed while it was read; read it again".to_owned(),
                });
            }
        }
        true
    }

    /// A good answer: what is read piece by piece goes on.
    fn took(&mut self) {
        if let Some(probe) = &mut self.probe {
            probe.answered();
        }
        if let Some(split) = &mut self.split {
            split.answered();
            self.go_on_splitting();
        }
    }

    /// An exception. A busy device is asked again a little later. Of several stretches of files one
    /// may be to blame, so each is asked on its own; so are the parts of a block of registers, and a
    /// file of unknown length is asked for less.
    fn refused(&mut self, mut step: Step, code: u8) {
        if code == BUSY && step.tries < BUSY_TRIES {
            step.tries = step.tries.saturating_add(1);
            step.wait_ms = BUSY_WAIT_MS;
            self.queue.push_front(step);
            return;
        }
        let blames_a_part = matches!(code, ILLEGAL_ADDRESS | ILLEGAL_VALUE);
        let read = FileRead::of_pdu(&step.pdu);
        if let Some(read) = read.filter(|r| blames_a_part && r.spans().len() > 1) {
            for part in read.split().iter().rev() {
                self.queue.push_front(Step::files(part));
            }
            return;
        }
        let name = crate::pdu::names::exception(code).map_or("unknown exception", |e| e.0);
        let why = format!("exception {code:02}: {}", name.to_ascii_lowercase());
        match (&mut self.probe, step.parts.first()) {
            (Some(probe), _) if blames_a_part => {
                probe.refused();
                // At the end of the file nothing is missing, unless there is no file at all.
                if probe.next().is_some() || probe.found() > 0 {
                    return;
                }
            }
            (None, Some(Part::Block(table, start, count))) if code == ILLEGAL_ADDRESS => {
                let map = self.snapshot.model.map();
                let read = Read::new(*table, *start, *count);
                match (&mut self.split, read) {
                    (Some(split), Some(read)) => {
                        split.refused(map, read);
                        return self.go_on_splitting();
                    }
                    (None, Some(read)) => self.split = Split::new(map, read, why.clone()),
                    _ => {}
                }
                if self.split.is_some() {
                    return self.go_on_splitting();
                }
            }
            _ => {}
        }
        self.gave_up(&step, &why);
        // Without the function there are no files at all.
        if code == ILLEGAL_FUNCTION && step.pdu.first() == Some(&READ_FILE) {
            self.queue.clear();
            self.stage = Stage::Done;
        }
    }

    /// The next part of a block that was refused; after the last one, what none of them gave.
    fn go_on_splitting(&mut self) {
        let Some(split) = &mut self.split else {
            return;
        };
        if let Some(read) = split.next() {
            self.queue.push_front(Step::block(read));
        } else if let Some(split) = self.split.take() {
            self.snapshot.failures.extend(split.failures());
        }
    }

    /// Nothing came of a request, and it is not sent again.
    fn gave_up(&mut self, step: &Step, why: &str) {
        self.failed(step, why);
        self.probe = None;
        self.go_on_splitting();
    }

    fn failed(&mut self, step: &Step, why: &str) {
        for part in &step.parts {
            self.snapshot.failures.push(Failure {
                part: *part,
                why: why.to_owned(),
            });
        }
    }

    fn go_on(&mut self) {
        if let Some(span) = self.probe.and_then(Probe::next) {
            self.queue.extend(plan([span]).iter().map(Step::files));
            return;
        }
        let (stage, spans) = match self.stage {
            Stage::Tables if self.snapshot.model.map().implements(READ_FILE) => {
                (Stage::Heads, self.heads())
            }
            Stage::Heads => {
                self.snapshot.failures.append(&mut self.uncounted);
                (Stage::Entries, self.entries())
            }
            Stage::Entries => {
                let unknown = FILES.iter().find(|f| f.layout.is_none());
                self.probe = unknown.map(|f| Probe::new(f.first, 0));
                (Stage::Raw, Vec::new())
            }
            // Only a log that took more than its head can have changed on the way.
            Stage::Raw => (Stage::Again, self.again()),
            _ => (Stage::Done, Vec::new()),
        };
        if stage == Stage::Again {
            self.probe = None;
        }
        self.stage = stage;
        self.queue.extend(plan(spans).iter().map(Step::files));
    }

    /// The heads of all logs, the curves that are stored, the reports of the cards.
    ///
    /// Where the register that counts the curves was not read, the latest is tried, and the snapshot
    /// says that there may be more; so is a reference of which it is not known whether there is one.
    fn heads(&mut self) -> Vec<Span> {
        let image = &self.snapshot.image;
        let register = |address: u16| {
            let cell = image.cell(Table::Holding, Address::new(address));
            cell.map(|c| c.word)
        };
        let mut failures = Vec::new();
        let mut spans = Vec::new();
        for file in FILES.iter().filter(|f| f.is_log()) {
            let head = file.layout.map_or(0, |l| l.head_records);
            spans.push(Span::new(file.first, 0, head));
        }
        for file in &FILES {
            let Some(layout) = file.layout.filter(|l| !l.is_log()) else {
                continue;
            };
            let numbers: Vec<u16> = if file.numbering == Numbering::Curves {
                let of = STORED.iter().find(|(first, ..)| *first == file.first);
                let Some((first, stored, set)) = of else {
                    continue;
                };
                let most = file.last.saturating_sub(file.first);
                let latest = register(*stored).map_or(1, |n| n.min(most));
                if register(*stored).is_none() {
                    failures.push(Failure {
                        part: Part::Block(Table::Holding, Address::new(*stored), 1),
                        why: format!(
                            "not read, so how many of the files {} to {} there are is not known; \
                             of these only the first was tried",
                            first.saturating_add(1),
                            file.last
                        ),
                    });
                }
                let from = if register(*set) == Some(0) { 1 } else { 0 };
                (from..=latest).map(|n| first.saturating_add(n)).collect()
            } else {
                (file.first..=file.last).collect()
            };
            spans.extend(
                numbers
                    .into_iter()
                    .map(|n| Span::new(n, 0, layout.head_records)),
            );
        }
        self.uncounted = failures;
        spans
    }

    /// What the heads announce.
    fn entries(&self) -> Vec<Span> {
        self.logs()
            .flat_map(|(number, records)| records.missing(number))
            .collect()
    }

    fn again(&self) -> Vec<Span> {
        self.logs()
            .filter(|(_, records)| records.get(0).is_some_and(|n| n > 0))
            .filter_map(|(number, _)| {
                let layout = File::of(number)?.layout?;
                Some(Span::new(number, 0, layout.head_records))
            })
            .collect()
    }

    /// The logs whose heads were read.
    fn logs(&self) -> impl Iterator<Item = (u16, &super::records::Records)> {
        self.snapshot
            .files
            .iter()
            .filter(|(number, _)| File::of(*number).is_some_and(File::is_log))
    }
}
