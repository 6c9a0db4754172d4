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
        .filter(|r| r.table == table && r.kind != Kind::Reserved)
        .filter(|r| !matches!(r.access, Access::Absent | Access::WriteOnly));
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::row::Model;

    fn whole(table: Table) -> Vec<(u16, u16)> {
        let map = Model::Icon3000v2.map();
        let reads = plan(table, map.rows_of(table).iter().copied());
        reads.iter().map(|r| (r.start.get(), r.count())).collect()
    }

    /// Nine reads for the whole holding map, and none of them touches the reserved 46 to 2999.
    #[test]
    fn the_whole_holding_map_takes_nine_reads() {
        let reads = whole(Table::Holding);
        assert_eq!(reads.len(), 9, "{reads:?}");
        assert_eq!(reads[0], (0, 46));
        assert_eq!(reads[1].0, 3000);
        for (start, count) in &reads {
            let end = start + count;
            assert!((1..=125).contains(count), "{reads:?}");
            assert!(end <= 46 || *start >= 3000, "{reads:?}");
        }
        assert_eq!(reads.last().map(|(start, count)| start + count), Some(3989));
        for pair in reads.windows(2) {
            assert!(
                pair[0].0 + pair[0].1 <= pair[1].0,
                "no address is read twice: {reads:?}"
            );
        }
    }

    #[test]
    fn the_other_tables() {
        assert_eq!(whole(Table::Input), [(0, 125), (125, 125), (250, 119)]);
        assert_eq!(
            whole(Table::Discrete),
            [(0, 30)],
            "the last two are reserved"
        );
        assert_eq!(whole(Table::Coil), [(0, 6)], "the rest is reserved");
    }

    /// A pair of words is never cut: both halves must come from one answer.
    #[test]
    fn pairs_stay_together() {
        let map = Model::Icon3000v2.map();
        for first in 3000..3300 {
            let rows = map
                .rows_of(Table::Holding)
                .iter()
                .copied()
                .filter(|r| r.address.get() >= first);
            for read in plan(Table::Holding, rows) {
                let (from, to) = (read.start.get(), read.start.get() + read.count());
                for cut in [from, to] {
                    let row = map.row_at(Table::Holding, Address::new(cut));
                    let Some(row) = row.filter(|r| r.address.get() < cut) else {
                        continue;
                    };
                    assert!(
                        row.words > WHOLE || row.kind == Kind::Reserved,
                        "{cut} cuts {}",
                        row.key
                    );
                }
            }
        }
    }

    #[test]
    fn few_rows_take_one_read_where_it_saves_a_request() {
        let map = Model::Icon3000v2.map();
        let rows = [3004, 3023, 3100].map(|a| map.row_at(Table::Holding, Address::new(a)));
        let reads = plan(Table::Holding, rows.into_iter().flatten());
        assert_eq!(
            reads,
            [Read::new(Table::Holding, Address::new(3004), 97).unwrap()]
        );
        assert_eq!(
            plan(
                Table::Holding,
                map.row_at(Table::Holding, Address::new(1000))
            ),
            []
        );
        assert_eq!(plan(Table::Holding, []), []);
    }
}
