//! Files of a device: what comes in, and what is known of them.

use shared::icon3000::plan::Probe;
use shared::icon3000::records::groups;
use shared::icon3000::{File, FileRead, Files, Log, Records, Span};
use shared::proto::Outcome;

use super::{CHANGED, Dossier, Record, Subject};
use crate::actuator::state::wanted::{LIMITS, step_of};

impl Dossier {
    pub(super) fn file_answer(
        &mut self,
        request: &[u8],
        response: &[u8],
        at: u64,
    ) -> Option<Subject> {
        let pairs = pairs(request, response)?;
        let subject = pairs.first().map(|(span, _)| Subject::File(span.file));
        for (span, words) in pairs {
            let kept = self.files.entry(span.file).or_default();
            let first = usize::from(span.start);
            if File::of(span.file).is_some_and(File::is_log) {
                let head = kept.first().copied().flatten().map(|r| r.word);
                if first > 0 {
                    self.unchecked.push(span.file);
                } else if head.is_some() && head != words.first().copied() {
                    // With another number of entries those of before have other places.
                    kept.clear();
                }
            }
            if kept.len() < first + words.len() {
                kept.resize(first + words.len(), None);
            }
            for (record, word) in kept.iter_mut().skip(first).zip(words) {
                *record = Some(Record { word, at });
            }
            self.failed.remove(&Subject::File(span.file));
            self.probed(span, true, at);
        }
        subject
    }

    /// Compares a good answer with what is known of its logs; one that is not the same any more
    /// changed while it was read. False if it is none to what was asked.
    pub fn compare(&mut self, request: &[u8], response: &[u8], at: u64) -> bool {
        let Some(pairs) = pairs(request, response) else {
            return false;
        };
        for (span, words) in pairs {
            self.unchecked.retain(|file| *file != span.file);
            if self.records(span.file, 0).run(span.start, span.count) != Some(words) {
                self.fail(step_of(span), Outcome::Ok, 0, CHANGED, at);
            }
        }
        true
    }

    /// True if a log changed while it was read.
    #[must_use]
    pub fn changed(&self, file: u16) -> bool {
        let failure = self.failed.get(&Subject::File(file));
        failure.is_some_and(|f| f.text == CHANGED)
    }

    /// Goes on in the file whose length nothing tells, if that is what was asked for.
    pub(super) fn probed(&mut self, span: Span, answered: bool, at: u64) {
        let anew = Probe::new(LIMITS, 0);
        let known = self.probe.filter(|_| anew.next() != Some(span));
        let mut probe = known.map_or(anew, |(probe, _)| probe);
        if probe.next() == Some(span) {
            if answered {
                probe.answered();
            } else {
                probe.refused();
            }
            self.probe = Some((probe, at));
            let kept = self.files.get_mut(&LIMITS);
            if let Some(kept) = kept.filter(|_| probe.next().is_none()) {
                kept.truncate(probe.found().into());
            }
        }
    }

    /// The records of a file that were read at a time or later.
    #[must_use]
    pub fn records(&self, file: u16, since: u64) -> Records {
        let kept = self.files.get(&file).map_or(&[][..], Vec::as_slice);
        let mut records = Records::default();
        for (at, record) in (0..).zip(kept) {
            if let Some(record) = record.filter(|r| r.at >= since) {
                records.put(at, [record.word]);
            }
        }
        records
    }

    /// The records of all files.
    #[must_use]
    pub fn all_files(&self) -> Files {
        let mut files = Files::default();
        for &file in self.files.keys() {
            for (record, word) in self.records(file, 0).iter() {
                files.entry(file).put(record, [word]);
            }
        }
        files
    }

    /// A file as values; `None` if nothing of it was read, or if the manual does not describe it.
    #[must_use]
    pub fn log(&self, file: u16) -> Option<Log> {
        let records = self.records(file, 0);
        (!records.is_empty()).then(|| Log::read(file, &records))?
    }

    /// When the oldest of the records of a file was read.
    #[must_use]
    pub fn read_at(&self, file: u16) -> Option<u64> {
        let records = self.files.get(&file)?;
        records.iter().flatten().map(|r| r.at).min()
    }
}

/// Stretches of files with their records. The response repeats neither file nor record; both are in
/// the request. All groups fit what was asked for, or there are none.
fn pairs(request: &[u8], response: &[u8]) -> Option<Vec<(Span, Vec<u16>)>> {
    let asked = FileRead::of_pdu(request)?;
    let groups = groups(response)?;
    let as_many = groups.len() == asked.spans().len();
    let pairs: Vec<_> = asked.spans().iter().copied().zip(groups).collect();
    let fits = |(span, words): &(Span, Vec<u16>)| words.len() == usize::from(span.count);
    (as_many && pairs.iter().all(fits)).then_some(pairs)
}
