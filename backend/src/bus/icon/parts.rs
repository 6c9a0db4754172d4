//! The requests that the steps of a page take.

use super::super::Report;
use super::super::query::{Query, is_counter};
use shared::icon3000::collect::BUSY_TRIES;
use shared::icon3000::{FileRead, Span, plan};
use shared::proto::IconStep;
use std::collections::VecDeque;
use tokio::time::Instant;

/// Exception "server device busy".
const BUSY: u8 = 6;

/// A request and the step that it belongs to; of several, the first.
#[derive(Debug)]
pub(super) struct Part {
    pub(super) step: u32,
    pub(super) query: Query,
    /// How often the device was busy, and when it may be asked again.
    pub(super) busy: u8,
    pub(super) not_before: Option<Instant>,
}

impl Part {
    /// True if the device was busy, and not too often yet.
    pub(super) fn is_again(&self, report: &Report) -> bool {
        report.code == Some(BUSY) && self.busy < BUSY_TRIES
    }

    pub(super) fn new(step: u32, query: Query) -> Self {
        Self {
            step,
            query,
            busy: 0,
            not_before: None,
        }
    }

    /// What is asked, for people.
    pub(super) fn words(&self) -> String {
        match &self.query {
            Query::Read(read) => {
                let (first, count) = (read.start.get(), read.count());
                format!("{count} from address {first}")
            }
            Query::File(file) => file.spans().first().map_or_else(String::new, |span| {
                let more = if file.spans().len() > 1 {
                    " and more"
                } else {
                    ""
                };
                format!("file {}, record {}{more}", span.file, span.start)
            }),
            Query::Identity => "identity".to_owned(),
            Query::Diagnostic(sub) => format!("counter {sub}"),
        }
    }
}

/// The requests that steps take; an error is the index of a step that can't be read.
pub(super) fn parts(steps: &[IconStep]) -> Result<VecDeque<Part>, u32> {
    let mut parts = VecDeque::new();
    let mut files: Vec<(u32, Span)> = Vec::new();
    for (step, what) in (0_u32..).zip(steps) {
        let query = match *what {
            IconStep::File { file, start, count } => {
                let legal = u32::from(start) + u32::from(count) <= 10_000;
                if count == 0 || !legal {
                    return Err(step);
                }
                files.push((step, Span::new(file, start, count)));
                continue;
            }
            IconStep::Block(block) => Query::Read(block.read().ok_or(step)?),
            IconStep::Identity => Query::Identity,
            IconStep::Diagnostic { sub_function } if is_counter(sub_function) => {
                Query::Diagnostic(sub_function)
            }
            IconStep::Diagnostic { .. } => return Err(step),
        };
        parts.extend(file_parts(&files));
        files.clear();
        parts.push_back(Part::new(step, query));
    }
    parts.extend(file_parts(&files));
    Ok(parts)
}

/// Requests for stretches of files, each with the step of its first group.
fn file_parts(files: &[(u32, Span)]) -> Vec<Part> {
    let step_of = |read: &FileRead| {
        let first = read.spans().first()?;
        let holds = |s: &Span| {
            s.file == first.file && s.start <= first.start && u32::from(first.start) < s.end()
        };
        files.iter().find(|(_, s)| holds(s)).map(|(step, _)| *step)
    };
    plan::plan(files.iter().map(|(_, span)| *span))
        .into_iter()
        .map(|read| Part::new(step_of(&read).unwrap_or(0), Query::File(read)))
        .collect()
}
