//! Reading under way: how far it is, how long it may take, and what comes next.

use shared::address::{Address, Table};
use shared::encode::Read;
use shared::icon3000::{File, FileRead, Span};
use shared::proto::{IconNews, IconStep, Outcome};

use super::dossier::{CHANGED, Dossier};
use super::wanted::{Wanted, step_of};

/// What is being read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Job {
    /// Number of the message under way.
    pub id: u32,
    /// All that is wanted.
    pub wanted: Wanted,
    /// What counts as read: everything from this time on, in microseconds.
    since: u64,
    /// When it began.
    began: u64,
    /// When something was last heard of it.
    heard: u64,
    /// Steps of the message under way.
    steps: Vec<IconStep>,
    /// Requests that are done, of the messages before included.
    pub done: u32,
    /// Requests in all, as far as known.
    pub total: u32,
    before: u32,
    /// What is read now, in words.
    pub text: String,
    /// True once it was told to end.
    pub cancelled: bool,
    /// True once it only looks whether the logs that it read are still the same.
    again: bool,
}

impl Job {
    /// A job, if something is missing.
    #[must_use]
    pub fn new(id: u32, wanted: Wanted, dossier: &Dossier, since: u64, now: u64) -> Option<Self> {
        let steps = wanted.missing(dossier, since);
        let total = u32::try_from(steps.len()).unwrap_or(u32::MAX);
        let text = wanted.what.clone();
        (!steps.is_empty()).then_some(Self {
            id,
            wanted,
            since,
            began: now,
            heard: now,
            steps,
            done: 0,
            total,
            before: 0,
            text,
            cancelled: false,
            again: false,
        })
    }

    /// What to ask for now.
    #[must_use]
    pub fn steps(&self) -> &[IconStep] {
        &self.steps
    }

    /// Takes news in; true if the message under way is over.
    pub fn hear(&mut self, news: &IconNews, dossier: &mut Dossier) -> bool {
        match news {
            IconNews::Exchange {
                step,
                request,
                response,
                outcome,
                text,
                at_us,
                ..
            } => {
                let step = usize::try_from(*step).ok();
                let Some(step) = step.and_then(|at| self.steps.get(at)).copied() else {
                    return false;
                };
                let (request, response) = (bytes_of(request), bytes_of(response));
                let ok = *outcome == Outcome::Ok;
                let take = if self.again {
                    Dossier::compare
                } else {
                    Dossier::absorb
                };
                if ok && take(dossier, &request, &response, *at_us) {
                    return false;
                }
                let code = match response[..] {
                    [function, code] if function >= 0x80 => code,
                    _ => 0,
                };
                let text = match (ok, code) {
                    (true, _) => "The answer does not fit what was asked.",
                    // The first entry was there before.
                    (_, 2) if self.again => CHANGED,
                    _ => text,
                };
                let mut fail = |step| dossier.fail(step, *outcome, code, text, *at_us);
                match (step, FileRead::of_pdu(&request)) {
                    // A request may hold parts of several files, not only of that of the step.
                    (IconStep::File { .. }, Some(read)) => {
                        read.spans().iter().copied().map(step_of).for_each(fail);
                    }
                    // Of a block that is refused only a part may be.
                    (IconStep::Block(_), _) => fail(block_of(&request).unwrap_or(step)),
                    _ => fail(step),
                }
            }
            IconNews::Progress {
                done, total, text, ..
            } => {
                self.done = self.before.saturating_add(*done);
                self.total = self.before.saturating_add(*total).max(self.done);
                self.text.clone_from(text);
            }
            IconNews::Done { ok, failed, .. } => {
                let sent = ok.saturating_add(*failed);
                self.before = self.before.saturating_add(sent);
                self.done = self.before;
                self.total = self.total.max(self.before);
                return true;
            }
        }
        false
    }

    /// Goes on with what is still missing, under a new number; false if nothing is, or if it was
    /// told to end.
    pub fn next(&mut self, id: u32, dossier: &Dossier) -> bool {
        if self.cancelled || self.again {
            return false;
        }
        let mut steps = self.wanted.missing(dossier, self.since);
        // The same again would come to nothing again.
        if steps.is_empty() || steps == self.steps {
            self.again = true;
            steps = self.heads(dossier);
        }
        if steps.is_empty() {
            return false;
        }
        self.id = id;
        self.steps = steps;
        let more = u32::try_from(self.steps.len()).unwrap_or(u32::MAX);
        self.total = self.before.saturating_add(more);
        true
    }

    /// The heads of the logs that are whole, each with its first entry: the latest, so that a log
    /// that is full shows too whether it went on meanwhile.
    fn heads(&self, dossier: &Dossier) -> Vec<IconStep> {
        let head = |file: &u16| {
            let layout = File::of(*file)?.layout?;
            let whole = dossier.records(*file, self.since).is_complete(*file);
            let count = layout.head_records + layout.entry_records;
            let entries = dossier.records(*file, 0).get(0) != Some(0);
            let unchecked = dossier.unchecked.contains(file);
            (whole && entries && unchecked).then(|| step_of(Span::new(*file, 0, count)))
        };
        self.wanted.files.iter().filter_map(head).collect()
    }

    /// What is left of it, to go on with later.
    #[must_use]
    pub fn is_whole(&self, dossier: &Dossier) -> bool {
        self.wanted.missing(dossier, self.since).is_empty()
    }

    /// Something was heard of it at this time.
    pub const fn touch(&mut self, now: u64) {
        self.heard = now;
    }

    /// True if nothing was heard of it for so long that nothing will come any more: the bridge
    /// refused it, or does not know it.
    #[must_use]
    pub const fn is_stuck(&self, now: u64) -> bool {
        now.saturating_sub(self.heard) > 60_000_000
    }

    /// From when on what was read counts.
    #[must_use]
    pub const fn since(&self) -> u64 {
        self.since
    }

    /// `12 of 32 requests, 3 s left`.
    #[must_use]
    pub fn progress(&self, now: u64) -> String {
        let mut text = format!("{} of {} requests", self.done, self.total);
        if self.cancelled {
            text.push_str(", ending");
            return text;
        }
        let left = u64::from(self.total.saturating_sub(self.done));
        let passed = now.saturating_sub(self.began);
        // Two requests say enough about the third.
        if self.done >= 2 && left > 0 {
            let micros = passed / u64::from(self.done) * left;
            text.push_str(&match micros.div_ceil(1_000_000) {
                seconds @ 0..120 => format!(", {seconds} s left"),
                seconds => format!(", {} min left", seconds.div_ceil(60)),
            });
        }
        text
    }
}

/// The block that a request reads.
fn block_of(request: &[u8]) -> Option<IconStep> {
    let &[function, s0, s1, c0, c1] = request else {
        return None;
    };
    let mut tables = Table::ALL.into_iter();
    let table = tables.find(|t| t.read_function() == function)?;
    let start = Address::new(u16::from_be_bytes([s0, s1]));
    let read = Read::new(table, start, u16::from_be_bytes([c0, c1]))?;
    Some(IconStep::Block(read.into()))
}

/// Bytes from hexadecimal; empty if that is not what it is.
fn bytes_of(hex: &str) -> Vec<u8> {
    let pairs = hex.as_bytes().chunks(2);
    let bytes = pairs.map(|pair| {
        let text = core::str::from_utf8(pair).ok()?;
        (pair.len() == 2).then(|| u8::from_str_radix(text, 16).ok())?
    });
    bytes.collect::<Option<Vec<u8>>>().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::device::Device;

    fn exchange(step: u32, request: &str, response: &str, outcome: Outcome) -> IconNews {
        IconNews::Exchange {
            id: 1,
            device: "XV".into(),
            step,
            request: request.into(),
            response: response.into(),
            outcome,
            text: "illegal data address".into(),
            at_us: 100,
        }
    }

    fn done(ok: u32, failed: u32) -> IconNews {
        IconNews::Done {
            id: 1,
            device: "XV".into(),
            ok,
            failed,
        }
    }

    fn wanted() -> Wanted {
        Wanted {
            what: "logs".into(),
            files: vec![2, 3],
            ..Wanted::default()
        }
    }

    #[test]
    fn a_log_takes_two_messages() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let mut job = Job::new(1, wanted(), &dossier, 50, 0).unwrap();
        assert_eq!(job.steps().len(), 2);
        let head = exchange(
            0,
            "14070600020000 0001".replace(' ', "").as_str(),
            "14040306 0002".replace(' ', "").as_str(),
            Outcome::Ok,
        );
        assert!(!job.hear(&head, &mut dossier));
        let refused = exchange(1, "140706000300000001", "9402", Outcome::Exception);
        assert!(!job.hear(&refused, &mut dossier));
        assert!(job.hear(&done(1, 1), &mut dossier));
        assert!(!job.is_whole(&dossier));
        assert!(job.next(2, &dossier));
        let rest = IconStep::File {
            file: 2,
            start: 1,
            count: 6,
        };
        assert_eq!((job.id, job.steps()), (2, &[rest][..]));
        let words = "14".to_owned() + "0E0D06" + &"0001".repeat(6);
        job.hear(
            &exchange(0, "140706000200010006", &words, Outcome::Ok),
            &mut dossier,
        );
        assert!(job.hear(&done(1, 0), &mut dossier));
        assert!(job.is_whole(&dossier));
        assert_eq!(dossier.records(2, 0).len(), 7);
        assert_eq!((job.done, job.total), (3, 3));
    }

    /// A log with one entry of three records, read whole; then its head and first entry once more,
    /// answered with these words; without words it is refused.
    fn looked_at_again(words: &[&str]) -> Dossier {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let only_alarms = Wanted {
            files: vec![2],
            ..wanted()
        };
        let mut job = Job::new(1, only_alarms, &dossier, 50, 0).unwrap();
        for (count, request, words) in [
            (3, "140706000200000001", "0001".to_owned()),
            (4, "140706000200010003", "00070000000C".to_owned()),
            (0, "140706000200000004", words.concat()),
        ] {
            let bytes = words.len() / 2;
            let good = format!("14{:02X}{:02X}06{words}", bytes + 2, bytes + 1);
            let (response, outcome) = match bytes {
                0 => ("9402", Outcome::Exception),
                _ => (good.as_str(), Outcome::Ok),
            };
            job.hear(&exchange(0, request, response, outcome), &mut dossier);
            assert!(job.hear(&done(1, 0), &mut dossier));
            assert_eq!(job.next(2, &dossier), count > 0);
            if count > 0 {
                // One record of head: the entry is 1 to 3, both together are 0 to 3.
                let (file, start) = (2, 4 - count);
                assert_eq!(job.steps(), [IconStep::File { file, start, count }]);
            }
        }
        assert!(job.is_whole(&dossier));
        assert_eq!(dossier.records(2, 0).get(1), Some(7), "it is only compared");
        dossier
    }

    /// A new alarm is one more, or in a log that is full the first of as many.
    #[test]
    fn a_log_that_changed_while_it_was_read_is_said() {
        use crate::actuator::state::logs::Table;
        use crate::actuator::state::saved::{open, snapshot};
        let same = ["0001", "0007", "0000", "000C"];
        let dossier = looked_at_again(&same);
        assert!(dossier.failed.is_empty() && dossier.unchecked.is_empty());
        assert!(Table::of(&dossier, 2).problems.is_empty());
        for (at, word) in [(0, "0002"), (1, "0008"), (3, "000D")] {
            let mut other = same;
            other[at] = word;
            let dossier = looked_at_again(&other);
            assert_eq!(Table::of(&dossier, 2).problems, [CHANGED]);
            let saved = snapshot(&dossier, 0).unwrap();
            assert_eq!(saved.failures.len(), 1);
            assert_eq!(saved.failures[0].why, CHANGED);
            let (opened, _) = open("x.json", &saved.to_text()).unwrap();
            assert_eq!(Table::of(&opened, 2).problems, [CHANGED]);
        }
        // Cleared meanwhile, it has no first entry; and then there is nothing to look at again.
        let mut dossier = looked_at_again(&[]);
        assert_eq!(Table::of(&dossier, 2).problems, [CHANGED]);
        let mut job = Job::new(1, wanted(), &dossier, 200, 0).unwrap();
        for (step, file) in [(0, 2), (1, 3)] {
            let request = format!("140706000{file}00000001");
            let mut head = exchange(step, &request, "140403060000", Outcome::Ok);
            if let IconNews::Exchange { at_us, .. } = &mut head {
                *at_us = 300;
            }
            job.hear(&head, &mut dossier);
        }
        assert!(job.hear(&done(2, 0), &mut dossier) && !job.next(2, &dossier));
        assert!(Table::of(&dossier, 2).problems.is_empty());
    }

    /// The part of a block that the device has not is told by its own request.
    #[test]
    fn a_refused_part_of_a_block_is_the_failure() {
        use crate::actuator::state::dossier::Subject;
        use shared::proto::{Block, TableName};
        let mut dossier = Dossier::new("XV", Device::Icon3000);
        let block = |start, count| Block {
            table: TableName::Holding,
            start,
            count,
        };
        let blocks = Wanted {
            blocks: vec![block(3459, 15)],
            ..Wanted::default()
        };
        let mut job = Job::new(1, blocks, &dossier, 0, 0).unwrap();
        let good = exchange(0, "030D830001", "03020007", Outcome::Ok);
        job.hear(&good, &mut dossier);
        let refused = exchange(0, "030D84000E", "8302", Outcome::Exception);
        job.hear(&refused, &mut dossier);
        let failure = dossier.failed.get(&Subject::Block(3, 3460));
        assert_eq!(
            failure.map(|f| f.step),
            Some(IconStep::Block(block(3460, 14)))
        );
        assert!(job.hear(&done(1, 1), &mut dossier));
        assert!(job.is_whole(&dossier) && !job.next(2, &dossier));
    }

    /// One request may hold parts of several files: all of them failed, whichever step it was for;
    /// asked for one by one, each tells of itself.
    #[test]
    fn a_failure_names_every_file_of_its_request() {
        use crate::actuator::state::dossier::Subject;
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let mut job = Job::new(1, wanted(), &dossier, 0, 0).unwrap();
        let both = "140E06000200000001".to_owned() + "06000300000001";
        job.hear(&exchange(0, &both, "", Outcome::Silence), &mut dossier);
        let codes = |dossier: &Dossier| -> Vec<_> {
            let failed = dossier.failed.iter();
            failed.map(|(subject, f)| (*subject, f.code)).collect()
        };
        let (two, three) = (Subject::File(2), Subject::File(3));
        assert_eq!(codes(&dossier), [(two, 0), (three, 0)]);
        let refused = exchange(0, "140706000300000001", "9402", Outcome::Exception);
        job.hear(&refused, &mut dossier);
        assert_eq!(codes(&dossier), [(two, 0), (three, 2)]);
    }

    #[test]
    fn an_answer_that_does_not_fit_is_a_failure() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let mut job = Job::new(1, wanted(), &dossier, 0, 0).unwrap();
        for response in ["1404030600", "zz", ""] {
            job.hear(
                &exchange(0, "140706000200000001", response, Outcome::Ok),
                &mut dossier,
            );
        }
        assert_eq!(dossier.failed.len(), 1);
        job.hear(&exchange(9, "", "", Outcome::Ok), &mut dossier);
        job.hear(&done(0, 2), &mut dossier);
        let again = job.next(2, &dossier);
        assert!(again, "file 3 was not answered at all");
        job.hear(&done(0, 1), &mut dossier);
        assert!(!job.next(3, &dossier), "the same again is not asked");
    }

    #[test]
    fn progress_is_told_in_words() {
        let dossier = Dossier::new("XV", Device::Icon3000v2);
        let mut job = Job::new(1, wanted(), &dossier, 0, 1_000_000).unwrap();
        assert_eq!(job.progress(1_000_000), "0 of 2 requests");
        (job.done, job.total) = (12, 32);
        // Twelve took 1.8 s, so twenty take 3 s.
        assert_eq!(job.progress(2_800_000), "12 of 32 requests, 3 s left");
        assert_eq!(job.progress(121_000_000), "12 of 32 requests, 4 min left");
        assert!(!job.is_stuck(60_000_000) && job.is_stuck(62_000_000));
        job.touch(61_000_000);
        assert!(!job.is_stuck(62_000_000));
        job.cancelled = true;
        assert_eq!(job.progress(2_800_000), "12 of 32 requests, ending");
        let nothing = Wanted::default();
        assert_eq!(Job::new(1, nothing, &dossier, 0, 0), None);
    }
}
