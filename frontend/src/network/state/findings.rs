//! What the pattern of faults means, and where it is drawn.

use shared::ddc100::diagnosis::{Diagnosis, End, Finding, diagnose};
use shared::ddc100::{FaultTable, HostPort};
use shared::proto::DdcShape;

use super::picture::Mark;
use crate::components::ne107::Sign;

/// What a table of faults means; `None` without units.
#[must_use]
pub fn findings(shape: DdcShape, table: &FaultTable) -> Option<Diagnosis> {
    (!table.is_empty()).then(|| diagnose(shape, table))
}

/// Where breaks are drawn, of so many units.
#[must_use]
pub fn marks(diagnosis: &Diagnosis, units: usize) -> Vec<Mark> {
    let all = diagnosis.findings.iter();
    all.filter_map(|finding| {
        let (from, to) = finding.stretch()?;
        let from = match from {
            End::Port(_) => 0,
            End::Unit { place, .. } => place + 1,
        };
        let to = match to {
            End::Port(HostPort::One) => 0,
            End::Port(HostPort::Two) => units,
            End::Unit { place, .. } => place,
        };
        // Seen from port 2 the ends stand the other way round.
        Some(Mark {
            from: from.min(to),
            to: to.max(from.min(to)),
            certain: diagnosis.is_certain(finding),
        })
    })
    .collect()
}

/// The sign of a finding, if it has one: a fault that is certain is a failure, one that may be
/// something else is out of what can be told.
#[must_use]
pub fn sign(diagnosis: &Diagnosis, finding: &Finding) -> Option<Sign> {
    match finding {
        Finding::NoFault | Finding::Untried(_) => None,
        finding if diagnosis.is_certain(finding) => Some(Sign::Failure),
        _ => Some(Sign::OutOfSpecification),
    }
}

/// A fault table from faults in the order of the cable, which all hold at the same time: nothing in
/// it is preliminary.
#[must_use]
pub fn table(units: &[(u8, [Option<bool>; 2])], ports: usize) -> FaultTable {
    let mut table = FaultTable::new(units.iter().map(|(unit, _)| *unit), ports > 1);
    // Said twice, so that each bears out the others.
    for (unit, fault) in units.iter().chain(units) {
        for (port, fault) in HostPort::BOTH.into_iter().zip(fault) {
            if let Some(failed) = fault {
                table.note(*unit, port, *failed);
            }
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    fn say(shape: DdcShape, ports: usize, faults: &[[u8; 2]]) -> (Vec<&'static str>, Vec<Mark>) {
        let units: Vec<_> = (1..)
            .zip(faults)
            .map(|(unit, f)| (unit, [Some(f[0] == 1), (ports > 1).then_some(f[1] == 1)]))
            .collect();
        let diagnosis = findings(shape, &table(&units, ports)).unwrap();
        let keys = diagnosis.findings.iter().map(Finding::key).collect();
        (keys, marks(&diagnosis, units.len()))
    }

    /// The examples of section 4.3.2: where the drawing has its break.
    #[test]
    fn breaks_are_where_the_guide_says() {
        let mark = |from, to, certain| vec![Mark { from, to, certain }];
        let ring = |faults: &[[u8; 2]]| say(DdcShape::Loop, 2, faults).1;
        assert_eq!(ring(&[[0, 0]; 5]), []);
        assert_eq!(ring(&[[0, 0], [0, 0], [1, 1], [0, 0], [0, 0]]), []);
        let three = [[0, 1], [0, 1], [0, 1], [1, 0], [1, 0]];
        assert_eq!(ring(&three), mark(3, 3, true));
        assert_eq!(ring(&[[0, 1]; 5]), mark(5, 5, true));
        assert_eq!(ring(&[[1, 0]; 5]), mark(0, 0, true));
        let line = |faults: &[[u8; 2]]| say(DdcShape::SingleEnded, 1, faults);
        let seven = [[0, 0], [0, 0], [1, 0], [1, 0], [1, 0]];
        assert_eq!(line(&seven).1, mark(2, 2, false));
        let last = [[0, 0], [0, 0], [1, 0]];
        assert_eq!(line(&last), (vec!["last_unit"], mark(2, 2, false)));
        // Two breaks, or a break and a unit without power.
        let among = [[0, 1], [1, 1], [1, 0]];
        assert_eq!(ring(&among), mark(1, 2, false));
    }
}
