//! A whole device, request by request: what to ask next, and what to make of the answer.
//!
//! Pure: whoever owns the line asks for the [`Collector::step`] request, sends it, and hands the
//! answer back. First the tables (never a reserved range), identity and counters; then, where the
//! model has files, the heads of the logs, the curves that the registers say are stored, and the
//! card reports; then the entries that the heads announce; at last the heads once more, so that a
//! log that changed while it was read is known.

use std::collections::VecDeque;

use super::counters;
use super::model::{FILES, File, Numbering};
use super::plan::{FileRead, Span, plan};
use super::snapshot::{Failure, Part, Snapshot};
use crate::address::{Address, Table};
use crate::encode::Read;
use crate::map;

/// Function code of file reads.
const READ_FILE: u8 = 20;
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
    /// What it reads; of several stretches of files, all.
    parts: Vec<Part>,
}

impl Step {
    fn block(read: Read) -> Self {
        Self {
            pdu: read.pdu().to_vec(),
            response_len: read.response_len(),
            parts: vec![Part::Block(read.table, read.start, read.count())],
        }
    }

    fn files(read: &FileRead) -> Self {
        Self {
            pdu: read.pdu(),
            response_len: read.response_len(),
            parts: read.spans().iter().copied().map(Part::File).collect(),
        }
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

/// What the wire carried, for the theoretical time of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wire {
    /// Exchanges.
    pub exchanges: u32,
    /// Bytes of all request frames, address and CRC included.
    pub request_bytes: u32,
    /// Bytes of all response frames, address and CRC included.
    pub response_bytes: u32,
}

impl Wire {
    fn add(&mut self, request: usize, response: usize) {
        // Address and CRC.
        let frame = |pdu: usize| u32::try_from(pdu.saturating_add(3)).unwrap_or(u32::MAX);
        self.exchanges = self.exchanges.saturating_add(1);
        self.request_bytes = self.request_bytes.saturating_add(frame(request));
        self.response_bytes = self.response_bytes.saturating_add(frame(response));
    }

    /// Theoretical time on a Modbus RTU line, in microseconds: all characters, and a silence of 3.5
    /// characters (1.75 ms above 19200 baud) after each frame. `bits` of a character are 11 with
    /// parity or two stop bits, else 10.
    ///
    /// Source: Modbus over Serial Line V1.02, section 2.5.1.1.
    #[must_use]
    pub fn micros(&self, baud: u32, bits: u32) -> u64 {
        let bytes = u64::from(self.request_bytes).saturating_add(self.response_bytes.into());
        // In bits, so that nothing is rounded before the end; the silence counts in half characters.
        let time = |bits: u64| bits.saturating_mul(1_000_000).checked_div(baud.into());
        let characters = time(bytes.saturating_mul(bits.into())).unwrap_or(0);
        let frames = u64::from(self.exchanges).saturating_mul(2);
        let silence = if baud > 19_200 {
            frames.saturating_mul(1750)
        } else {
            let halves = frames.saturating_mul(7).saturating_mul(bits.into());
            time(halves).unwrap_or(0) / 2
        };
        characters.saturating_add(silence)
    }
}

/// What is asked next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Tables,
    Heads,
    Entries,
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
        queue.push_back(Step {
            pdu: vec![17],
            response_len: 86,
            parts: vec![Part::Identity],
        });
        for counter in &counters::NAMES {
            let [high, low] = counter.sub.to_be_bytes();
            queue.push_back(Step {
                pdu: vec![8, high, low, 0, 0],
                response_len: 5,
                parts: vec![Part::Counter(counter.sub)],
            });
        }
        Self {
            snapshot,
            queue,
            stage: Stage::Tables,
            done: 0,
            wire: Wire::default(),
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
                    return true;
                }
                match response {
                    [function, code, ..] if *function >= 0x80 => {
                        return self.refused(step, *code);
                    }
                    _ => "the answer is not what was asked for".to_owned(),
                }
            }
        };
        self.failed(&step, &why);
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

    /// An exception: of several stretches one may be to blame, so each is asked on its own.
    fn refused(&mut self, step: Step, code: u8) -> bool {
        let read = FileRead::of_pdu(&step.pdu);
        if let Some(read) = read.filter(|r| code != 1 && r.spans().len() > 1) {
            for part in read.split().iter().rev() {
                self.queue.push_front(Step::files(part));
            }
            return false;
        }
        let name = crate::pdu::names::exception(code).map_or("unknown exception", |e| e.0);
        let why = format!("exception {code:02}: {}", name.to_ascii_lowercase());
        self.failed(&step, &why);
        // Without the function there are no files at all.
        if code == 1 && step.pdu.first() == Some(&READ_FILE) {
            self.queue.clear();
            self.stage = Stage::Done;
        }
        false
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
        let (stage, spans) = match self.stage {
            Stage::Tables if self.snapshot.model.map().implements(READ_FILE) => {
                (Stage::Heads, self.heads())
            }
            Stage::Heads => (Stage::Entries, self.entries()),
            // Only a log that took more than its head can have changed on the way.
            Stage::Entries => (Stage::Again, self.again()),
            _ => (Stage::Done, Vec::new()),
        };
        self.stage = stage;
        self.queue.extend(plan(spans).iter().map(Step::files));
    }

    /// The heads of all logs, the curves that are stored, the reports of the cards.
    fn heads(&self) -> Vec<Span> {
        let register = |address: u16| {
            let cell = self
                .snapshot
                .image
                .cell(Table::Holding, Address::new(address));
            cell.map_or(0, |c| c.word)
        };
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
                let latest = register(*stored).min(most);
                let from = if register(*set) == 0 { 1 } else { 0 };
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
