//! Read planning: the fewest legal requests for the values that are wanted.

use super::row::{Access, Kind, Row};
use crate::address::{Address, Table};
use crate::encode::Read;

/// Values up to this many words must come from one answer: the halves of a counter or date that
/// were read one after the other may not belong together. Longer ones (texts, curves) may be cut.
const WHOLE: u16 = 4;

/// Plans reads for these rows of one table, which must be in order of address.
///
/// Each read has at most 125 registers (2000 bits). Gaps between wanted rows are read along where
/// that saves a request; reserved ranges are never asked for on their own and never cut into.
#[must_use]
pub fn plan<'r>(table: Table, rows: impl IntoIterator<Item = &'r Row>) -> Vec<Read> {
    let max = u32::from(table.max_read());
    let mut reads = Vec::new();
    // The block being built: first address, and one past its last.
    let mut block: Option<(u32, u32)> = None;
    let wanted = rows
        .into_iter()
        .filter(|r| r.table == table && r.kind != Kind::Reserved && r.access != Access::Absent);
    for row in wanted {
        let start = u32::from(row.address.get());
        let end = start.saturating_add(u32::from(row.words));
        let (first, last) = block.unwrap_or((start, start));
        let limit = first.saturating_add(max);
        if end <= limit {
            block = Some((first, end.max(last)));
        } else if row.words <= WHOLE || start >= limit {
            push(&mut reads, table, first, last);
            block = Some((start, end));
        } else {
            // A long value goes on in the next block.
            push(&mut reads, table, first, limit);
            let mut from = limit;
            while end.saturating_sub(from) > max {
                let to = from.saturating_add(max);
                push(&mut reads, table, from, to);
                from = to;
            }
            block = Some((from, end));
        }
    }
    if let Some((first, last)) = block {
        push(&mut reads, table, first, last);
    }
    reads
}

fn push(reads: &mut Vec<Read>, table: Table, first: u32, last: u32) {
    let count = u16::try_from(last.saturating_sub(first)).unwrap_or(0);
    let start = u16::try_from(first).map(Address::new);
    reads.extend(start.ok().and_then(|start| Read::new(table, start, count)));
}
