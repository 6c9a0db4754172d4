//! Where the areas might be, from the pattern alone: a word is written that is a known request;
//! a register is read that then holds its object with something above it; another holds a number;
//! and so many registers are read in a row.

use super::exchange::{Act, registers};
use super::{Areas, Exchange};
use crate::address::Table;
use crate::dop::{Profile, Request};
use std::collections::BTreeMap;

/// What followed one write.
struct Segment {
    request: u16,
    object: u16,
    /// Table, address and word of short reads, where status and count are.
    words: Vec<(Table, u16, u16)>,
    /// Runs of registers that were read one behind the other: table, first address, length.
    runs: Vec<(Table, u16, u16)>,
}

/// Longest read in which a status or count is looked for; longer ones are data.
const SHORT: usize = 4;

/// The areas that explain most of the requests; `None` if none explains any.
pub(super) fn areas(exchanges: &[Exchange], profile: &Profile) -> Option<Areas> {
    let mut votes: BTreeMap<(u16, u16, u16, u16, Table), u32> = BTreeMap::new();
    for segment in segments(exchanges, profile) {
        let mut proposed = Vec::new();
        for (table, status, word) in &segment.words {
            let about = Request::from_word(*word).object() == segment.object && word >> 11 != 0;
            if !about || *status == segment.request {
                continue;
            }
            for (table_2, count, number) in &segment.words {
                if table_2 != table || count == status || *count == segment.request {
                    continue;
                }
                for (table_3, response, len) in &segment.runs {
                    let apart = response != status && response != count;
                    if table_3 == table && apart && len == number && *number > 0 {
                        proposed.push((segment.request, *status, *count, *response, *table));
                    }
                }
            }
        }
        proposed.sort_unstable();
        proposed.dedup();
        for areas in proposed {
            let votes = votes.entry(areas).or_default();
            *votes = votes.saturating_add(1);
        }
    }
    // The first of those with most votes.
    let best = votes.values().copied().max()?;
    let ((request, status, count, response, table), _) =
        votes.into_iter().find(|(_, votes)| *votes == best)?;
    Some(Areas {
        table,
        request,
        status,
        count,
        response,
    })
}

/// Reads behind one request that are looked at.
const MOST: usize = 64;

/// Cuts the exchanges at the writes of known requests, unit by unit.
fn segments(exchanges: &[Exchange], profile: &Profile) -> Vec<Segment> {
    let mut done = Vec::new();
    let mut open: Vec<(u8, Segment)> = Vec::new();
    for exchange in exchanges {
        match exchange.act() {
            Act::Write(address, word) => {
                if let Some(at) = open.iter().position(|(unit, _)| *unit == exchange.unit) {
                    done.push(open.swap_remove(at).1);
                }
                let request = Request::from_word(word);
                if request.is_known(profile) {
                    let segment = Segment {
                        request: address,
                        object: request.object(),
                        words: Vec::new(),
                        runs: Vec::new(),
                    };
                    open.push((exchange.unit, segment));
                }
            }
            Act::Read(table, start, data) => {
                if let Some((_, segment)) = open.iter_mut().find(|(u, _)| *u == exchange.unit) {
                    segment.add(table, start, data);
                }
            }
            Act::Refused(..) | Act::Other => {}
        }
    }
    done.extend(open.into_iter().map(|(_, segment)| segment));
    done
}

impl Segment {
    fn add(&mut self, table: Table, start: u16, data: &[u8]) {
        let len = data.len() >> 1;
        if len <= SHORT {
            let room = MOST.saturating_sub(self.words.len());
            let words = registers(start, data).map(|(at, word)| (table, at, word));
            self.words.extend(words.take(room));
        }
        let len = u16::try_from(len).unwrap_or(u16::MAX);
        // Blocks follow each other, and each may begin something of its own.
        for (_, from, have) in self.runs.iter_mut().filter(|run| run.0 == table) {
            if from.checked_add(*have) == Some(start) {
                *have = have.saturating_add(len);
            }
        }
        if self.runs.len() < MOST {
            self.runs.push((table, start, len));
        }
    }
}
