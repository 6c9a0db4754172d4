//! From a table of faults to findings.

use super::{Diagnosis, End, Finding};
use crate::ddc100::HostPort;
use crate::ddc100::faults::FaultTable;
use crate::proto::DdcShape;

/// What is known of a unit: the end, and whether it answers through port 1 and 2.
#[derive(Clone, Copy)]
struct Heard {
    end: End,
    one: bool,
    two: bool,
}

impl Heard {
    /// True if no unit stands behind it, seen from a port.
    const fn is_last(&self, port: HostPort, all: usize) -> bool {
        match port {
            HostPort::One => self.place().saturating_add(1) == all,
            HostPort::Two => self.place() == 0,
        }
    }

    const fn place(&self) -> usize {
        match self.end {
            End::Unit { place, .. } => place,
            End::Port(_) => 0,
        }
    }

    fn unit(&self) -> u8 {
        match self.end {
            End::Unit { unit, .. } => unit,
            End::Port(_) => 0,
        }
    }
}

/// Says what a table of faults means.
#[must_use]
pub fn diagnose(shape: DdcShape, faults: &FaultTable) -> Diagnosis {
    let mut findings = Vec::new();
    let used = |port| faults.has(port) && faults.is_up(port);
    let mut untried = 0_usize;
    let mut heard = Vec::with_capacity(faults.len());
    let mut unsteady = Vec::new();
    for (place, (unit, pair)) in faults.units().enumerate() {
        let end = End::Unit { place, unit };
        if faults.is_unsteady(unit) {
            unsteady.push(unit);
            continue;
        }
        let state = |port| {
            if used(port) {
                pair.get(port)
            } else {
                Some(true)
            }
        };
        let (one, two) = (state(HostPort::One), state(HostPort::Two));
        untried = untried
            .saturating_add(usize::from(one.is_none()))
            .saturating_add(usize::from(two.is_none()));
        // A unit that was not tried on both ports says nothing yet.
        if let (Some(one), Some(two)) = (one, two) {
            heard.push(Heard {
                end,
                one: !one,
                two: !two,
            });
        }
    }
    if !unsteady.is_empty() {
        findings.push(Finding::Unsteady(unsteady));
    }
    for port in HostPort::BOTH {
        if faults.has(port) && !faults.is_up(port) {
            findings.push(Finding::PortDown(port));
        }
    }
    match (used(HostPort::One), used(HostPort::Two)) {
        (true, true) => both(&heard, faults.len(), &mut findings),
        (true, false) => single(
            heard.iter(),
            HostPort::One,
            shape,
            faults.len(),
            &mut findings,
        ),
        (false, true) => single(
            heard.iter().rev(),
            HostPort::Two,
            shape,
            faults.len(),
            &mut findings,
        ),
        (false, false) => {}
    }
    if untried > 0 {
        findings.push(Finding::Untried(untried));
    } else if findings.is_empty() {
        findings.push(Finding::NoFault);
    }
    Diagnosis {
        findings,
        unsettled: faults.unsettled(),
    }
}

/// A loop with two ports.
fn both(heard: &[Heard], all: usize, findings: &mut Vec<Finding>) {
    if heard.is_empty() {
        return;
    }
    // The last that answers through port 1, the first that answers through port 2.
    let last = heard.iter().rposition(|h| h.one);
    let first = heard.iter().position(|h| h.two);
    if last.is_none() && first.is_none() {
        findings.push(Finding::Nothing {
            units: all,
            multi_drop: false,
            port: None,
        });
        return;
    }
    let whole = last.zip(first).is_some_and(|(last, first)| first <= last);
    // If there is a break, it lies before the first unit that port 2 reaches.
    let gap = first.unwrap_or(heard.len());
    let mut silent: Vec<u8> = Vec::new();
    let cut = |silent| {
        let from = last.and_then(|l| heard.get(l));
        broken(from, heard.get(gap), all, silent)
    };
    for (at, unit) in heard.iter().enumerate() {
        if !whole && at == gap {
            findings.push(cut(core::mem::take(&mut silent)));
        }
        let passed = whole || last.is_some_and(|last| at < last) || at > gap;
        let one_sided = |port| Finding::OneSided {
            unit: unit.end,
            port,
        };
        match (unit.one, unit.two) {
            (false, true) if whole => findings.push(one_sided(HostPort::One)),
            (true, false) if whole => findings.push(one_sided(HostPort::Two)),
            (false, false) if passed => findings.push(Finding::OffLine(unit.end)),
            (false, false) => silent.push(unit.unit()),
            _ => {}
        }
    }
    if !whole && gap == heard.len() {
        findings.push(cut(silent));
    }
}

/// A break between what port 1 reaches last and what port 2 reaches first.
fn broken(from: Option<&Heard>, to: Option<&Heard>, all: usize, silent: Vec<u8>) -> Finding {
    let from_end = from.map_or(End::Port(HostPort::One), |h| h.end);
    let to_end = to.map_or(End::Port(HostPort::Two), |h| h.end);
    if !silent.is_empty() {
        return Finding::BreakAmong {
            from: from_end,
            to: to_end,
            silent,
        };
    }
    // With an unsteady unit in between, it may as well be the cable at that one.
    match (from, to) {
        (None, Some(next)) if next.place() == 0 => Finding::PortLost {
            port: HostPort::One,
            next: next.end,
        },
        (Some(next), None) if next.place().saturating_add(1) == all => Finding::PortLost {
            port: HostPort::Two,
            next: next.end,
        },
        _ => Finding::Break {
            from: from_end,
            to: to_end,
        },
    }
}

/// One port, with the units in the order in which its signal gets to them.
fn single<'a>(
    heard: impl ExactSizeIterator<Item = &'a Heard> + DoubleEndedIterator,
    port: HostPort,
    shape: DdcShape,
    all: usize,
    findings: &mut Vec<Finding>,
) {
    let heard: Vec<&Heard> = heard.collect();
    if heard.is_empty() {
        return;
    }
    let answers = |h: &Heard| h.one || h.two;
    let Some(last) = heard.iter().rposition(|h| answers(h)) else {
        findings.push(Finding::Nothing {
            units: all,
            multi_drop: shape == DdcShape::MultiDrop,
            port: Some(port),
        });
        return;
    };
    let (near, far) = heard.split_at(last.saturating_add(1));
    let off = near.iter().filter(|h| !answers(h));
    findings.extend(off.map(|h| Finding::OffLine(h.end)));
    let from = near.last().map_or(End::Port(port), |h| h.end);
    match far {
        [] => {}
        [unit] if unit.is_last(port, all) => findings.push(Finding::LastUnit {
            from,
            unit: unit.end,
        }),
        [to, ..] => findings.push(Finding::Beyond {
            from,
            to: to.end,
            silent: far.iter().map(|h| h.unit()).collect(),
        }),
    }
}
