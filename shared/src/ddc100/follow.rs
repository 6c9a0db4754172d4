//! The table of faults of somebody who follows a host by its news.
//!
//! News are of the newest kind: who is slow gets the last state of each unit, and may miss what was
//! in between. So the table here is that of the host at the time of the last news, and what is said
//! of its certainty is never more than the host could say:
//!
//! - A fault that is news makes all the rest to be looked at anew, however long ago it came about.
//! - A poll bears out the fault on the port that it went through.
//! - A pass is as many polls as there are units, however few of them were told of.
//! - A whole pass bears out all faults on its port if nothing changed since the pass before it.
//! - What the host does not know any more, because a port came back, is not known here either.

use super::HostPort;
use super::faults::FaultTable;
use crate::proto::{DdcNews, LineState};

/// A table of faults, filled from news.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Follower {
    table: FaultTable,
    /// True if no fault changed since the last pass that was told of.
    quiet: bool,
    /// Number of that pass.
    passes: u64,
    /// Polls that were told of since.
    polls: u64,
}

impl Follower {
    /// Of a network with these units in the order of the cable, of which nothing was told yet.
    #[must_use]
    pub fn new(units: impl IntoIterator<Item = u8>, second: bool) -> Self {
        Self {
            table: FaultTable::new(units, second),
            quiet: false,
            passes: 0,
            polls: 0,
        }
    }

    /// The faults.
    #[must_use]
    pub const fn table(&self) -> &FaultTable {
        &self.table
    }

    /// Takes news in. Those about a unit or a port that is not of this network are left out.
    pub fn hear(&mut self, news: &DdcNews) {
        match news {
            DdcNews::Unit {
                unit,
                port,
                fault_a,
                fault_b,
                ..
            } => self.note(*unit, *port, [*fault_a, *fault_b]),
            DdcNews::Pass { port, number, .. } => self.bear_out(*port, *number),
            DdcNews::Port { port, state, .. } => {
                if let Some(of) = HostPort::from_number(*port) {
                    self.table.set_port(of, *state != LineState::Down);
                }
            }
            DdcNews::Network { .. } | DdcNews::Poll { .. } | DdcNews::Read { .. } => {}
        }
    }

    fn note(&mut self, unit: u8, port: u8, faults: [Option<bool>; 2]) {
        for (of, fault) in HostPort::BOTH.into_iter().zip(faults) {
            let before = self.table.fault(unit, of);
            let news = before != fault;
            match fault {
                // A lost port says the same of all units; the news of the port tell it.
                Some(_) if !self.table.is_up(of) => continue,
                Some(failed) if news || of.number() == port => {
                    self.table.note(unit, of, failed);
                    self.polls = self.polls.saturating_add(1);
                }
                None if news => self.table.forget(unit, of),
                _ => {}
            }
            self.quiet &= !news;
        }
    }

    /// A whole pass on a port is over.
    fn bear_out(&mut self, port: u8, number: u64) {
        // One that was missed may have seen a fault that is over again.
        let next = number == self.passes.saturating_add(1);
        let quiet = core::mem::replace(&mut self.quiet, true) && next;
        // Each pass polled each unit, whether it was told of or not.
        let units = u64::try_from(self.table.len()).unwrap_or(u64::MAX);
        let made = number.saturating_sub(self.passes).saturating_mul(units);
        self.table.elapse(made.saturating_sub(self.polls));
        self.polls = 0;
        self.passes = number;
        let of = HostPort::from_number(port).filter(|of| quiet && self.table.is_up(*of));
        if let Some(of) = of {
            self.table.confirm(of);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ddc100::{Finding, diagnose};
    use crate::proto::{DdcShape, Outcome};

    fn unit(unit: u8, port: u8, faults: [Option<bool>; 2]) -> DdcNews {
        DdcNews::Unit {
            bus: String::new(),
            unit,
            port,
            outcome: Outcome::Ok,
            text: String::new(),
            fault_a: faults[0],
            fault_b: faults[1],
            request: String::new(),
            response: String::new(),
            at_us: None,
            took_us: None,
        }
    }

    fn pass(port: u8, number: u64) -> DdcNews {
        DdcNews::Pass {
            bus: String::new(),
            port,
            number,
            took_us: 1,
            expected_us: 1,
        }
    }

    fn port(port: u8, state: LineState) -> DdcNews {
        DdcNews::Port {
            bus: String::new(),
            port,
            state,
            text: String::new(),
        }
    }

    const GOOD: [Option<bool>; 2] = [Some(false); 2];

    /// A loop of two, of which the newest of each unit came once.
    fn two() -> Follower {
        let mut follower = Follower::new(1..=2, true);
        for at in 1..=2 {
            follower.hear(&unit(at, 2, GOOD));
        }
        follower
    }

    #[test]
    fn passes_in_a_row_bear_out() {
        let mut follower = two();
        let mut unsettled = |news| {
            follower.hear(&news);
            follower.table().unsettled()
        };
        assert_eq!(unsettled(unit(1, 2, GOOD)), 2, "port 1");
        assert_eq!(unsettled(pass(1, 7)), 2, "what was before is not known");
        assert_eq!(unsettled(pass(2, 9)), 2, "a pass is missing");
        assert_eq!(unsettled(pass(1, 10)), 0);
        assert_eq!(unsettled(pass(2, 11)), 0);
        let news = unit(1, 2, [Some(true), Some(false)]);
        assert_eq!(
            unsettled(news.clone()),
            2,
            "port 1 of unit 2, port 2 of unit 2"
        );
        assert_eq!(unsettled(pass(1, 12)), 2, "it changed in it");
        assert_eq!(unsettled(pass(2, 13)), 1);
        assert_eq!(unsettled(pass(1, 14)), 0);
    }

    /// A port that was away and is back between two news: nothing is known of it.
    #[test]
    fn a_port_that_was_away_unseen() {
        let mut follower = two();
        for (of, number) in [(1, 1), (2, 2), (1, 3), (2, 4)] {
            follower.hear(&pass(of, number));
        }
        let keys = |f: &Follower| -> Vec<_> {
            let found = diagnose(DdcShape::Loop, f.table());
            found.findings.iter().map(Finding::key).collect()
        };
        assert_eq!(keys(&follower), ["no_fault"]);
        follower.hear(&port(2, LineState::Up));
        for at in 1..=2 {
            follower.hear(&unit(at, 1, [Some(false), None]));
        }
        assert_eq!(follower.table().fault(1, HostPort::Two), None);
        assert_eq!(keys(&follower), ["untried"]);
        follower.hear(&port(2, LineState::Down));
        assert!(keys(&follower).contains(&"port_down"));
        // What a unit says of a lost port is no news.
        follower.hear(&unit(1, 2, [Some(false), Some(true)]));
        assert!(keys(&follower).contains(&"port_down"));
        follower.hear(&port(2, LineState::Up));
        assert_eq!(follower.table().fault(1, HostPort::Two), None);
    }

    /// A unit that came and went is steady again after sixteen passes on both ports, though none of
    /// the polls since were told of.
    #[test]
    fn passes_go_by_without_news_of_units() {
        let mut follower = Follower::new(1..=10, true);
        let mut number = 0;
        let mut failed = false;
        for _ in 0..7 {
            failed = !failed;
            follower.hear(&unit(3, 1, [Some(failed), Some(false)]));
            number += 1;
            follower.hear(&pass(1, number));
        }
        assert!(follower.table().is_unsteady(3));
        for _ in 0..20 {
            number += 1;
            follower.hear(&pass(1, number));
        }
        assert!(follower.table().is_unsteady(3), "as the host would say");
        follower.hear(&pass(1, number + 20));
        assert!(
            !follower.table().is_unsteady(3),
            "passes that were missed count"
        );
    }
}
