//! Reading many blocks once: what is asked, how far it is, what failed.

use std::collections::VecDeque;

use shared::address::Table;
use shared::map::plan::plan;
use shared::map::row::Row;
use shared::proto::{Block, Outcome};

/// Reads under way at once, so that the backend always has the next one at hand.
const AHEAD: usize = 2;

/// A read that did not bring its values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Failed {
    /// What was asked.
    pub block: Block,
    /// How it ended.
    pub outcome: Outcome,
    /// In words.
    pub text: String,
}

/// Blocks of one device that are read once.
#[derive(Clone, Debug, Default)]
pub struct Job {
    waiting: VecDeque<Block>,
    under_way: Vec<(u32, Block)>,
    /// Number of blocks in all.
    pub total: usize,
    /// Number of blocks that are over.
    pub done: usize,
    /// Those that failed.
    pub failed: Vec<Failed>,
}

impl Job {
    /// A job for these blocks.
    #[must_use]
    pub fn new(blocks: Vec<Block>) -> Self {
        Self {
            total: blocks.len(),
            waiting: blocks.into(),
            ..Self::default()
        }
    }

    /// The reads to send now, with ids from `next_id` on.
    pub fn send(&mut self, next_id: &mut u32) -> Vec<(u32, Block)> {
        let mut sent = Vec::new();
        while self.under_way.len() < AHEAD
            && let Some(block) = self.waiting.pop_front()
        {
            let id = *next_id;
            *next_id = next_id.wrapping_add(1);
            self.under_way.push((id, block));
            sent.push((id, block));
        }
        sent
    }

    /// A read is over. False if it is none of this job.
    pub fn settle(&mut self, id: u32, outcome: Outcome, text: &str) -> bool {
        let Some(at) = self.under_way.iter().position(|(i, _)| *i == id) else {
            return false;
        };
        let (_, block) = self.under_way.remove(at);
        self.done += 1;
        if outcome != Outcome::Ok {
            self.failed.push(Failed {
                block,
                outcome,
                text: text.to_owned(),
            });
        }
        true
    }

    /// Sends nothing more; what is under way still comes in.
    pub fn cancel(&mut self) {
        self.total -= self.waiting.len();
        self.waiting.clear();
    }

    /// The connection is gone: nothing of this comes back.
    pub fn lose(&mut self) {
        self.cancel();
        for (_, block) in self.under_way.drain(..) {
            self.done += 1;
            self.failed.push(Failed {
                block,
                outcome: Outcome::Down,
                text: "The connection was lost.".to_owned(),
            });
        }
    }

    /// True when nothing is left to come.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.waiting.is_empty() && self.under_way.is_empty()
    }
}

/// The fewest blocks that read these rows, table by table. Rows are in the order of the map.
#[must_use]
pub fn blocks(rows: &[&'static Row]) -> Vec<Block> {
    Table::ALL
        .into_iter()
        .flat_map(|table| plan(table, rows.iter().copied()))
        .map(Block::from)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::map::row::Model;
    use shared::proto::TableName;

    #[test]
    fn the_holding_map_takes_nine_reads() {
        let map = Model::Icon3000v2.map();
        let holding = blocks(map.rows_of(Table::Holding));
        assert_eq!(holding.len(), 9);
        assert!(holding.iter().all(|b| b.count <= 125));
        assert!(blocks(map.rows).len() > 9);
    }

    #[test]
    fn a_job_runs_to_its_end() {
        let block = |start| Block {
            table: TableName::Holding,
            start,
            count: 1,
        };
        let mut job = Job::new(vec![block(1), block(2), block(3)]);
        let mut id = 7;
        assert_eq!(job.send(&mut id).len(), AHEAD);
        assert!(!job.settle(99, Outcome::Ok, ""));
        assert!(job.settle(7, Outcome::Ok, ""));
        assert_eq!(job.send(&mut id), [(9, block(3))]);
        assert!(job.settle(8, Outcome::Silence, "no answer"));
        assert!(!job.is_over());
        assert!(job.settle(9, Outcome::Ok, ""));
        assert!(job.is_over());
        assert_eq!((job.done, job.total, job.failed.len()), (3, 3, 1));
    }

    #[test]
    fn cancel_and_loss_end_it() {
        let block = Block {
            table: TableName::Coil,
            start: 0,
            count: 1,
        };
        let mut job = Job::new(vec![block; 5]);
        let mut id = 0;
        job.send(&mut id);
        job.cancel();
        assert_eq!((job.total, job.is_over()), (2, false));
        job.lose();
        assert_eq!((job.done, job.is_over()), (2, true));
    }
}
