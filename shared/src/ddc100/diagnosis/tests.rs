//! Each row of the patterns, printed and not, and every pattern of a short network.

use super::*;
use crate::ddc100::{FaultTable, Pair};
use crate::proto::DdcShape;
use DdcShape::{Loop, MultiDrop, SingleEnded};

/// A table from `AB` for each unit: 0 good, 1 fault, `-` not tried; seen often enough to hold.
fn table(shape: DdcShape, pattern: &str) -> FaultTable {
    let cells: Vec<&str> = pattern.split(' ').collect();
    let units = 1..=u8::try_from(cells.len()).unwrap();
    let mut table = FaultTable::new(units.clone(), shape == Loop);
    for _ in 0..2 {
        for (unit, cell) in units.clone().zip(&cells) {
            for (port, mark) in HostPort::BOTH.into_iter().zip(cell.chars()) {
                if mark != '-' {
                    table.note(unit, port, mark == '1');
                }
            }
        }
    }
    table
}

fn check(shape: DdcShape, pattern: &str, expected: &[&str]) {
    let table = table(shape, pattern);
    let found = diagnose(shape, &table);
    let texts: Vec<String> = found.findings.iter().map(Finding::to_string).collect();
    assert_eq!(texts.len(), expected.len(), "{pattern}: {texts:?}");
    for (text, part) in texts.iter().zip(expected) {
        assert!(text.contains(part), "{pattern}: {text:?} lacks {part:?}");
    }
    for finding in &found.findings {
        assert_eq!(
            finding.is_ambiguous(),
            !finding.why().is_empty(),
            "{finding:?}"
        );
    }
}

/// The rows of the guide, and the mirror of example 4.
#[test]
fn a_loop() {
    check(Loop, "00 00 00 00 00", &["No fault"]);
    check(Loop, "00 00 11 00 00", &["Unit 3 is off-line"]);
    check(Loop, "01 01 01 10 10", &["between unit 3 and unit 4"]);
    check(Loop, "01 10 10 10 10", &["between unit 1 and unit 2"]);
    check(Loop, "01 01 01 01 10", &["between unit 4 and unit 5"]);
    check(
        Loop,
        "01 01 01 01 01",
        &[
            "Loss of host port 2: no unit answers through it. Look at the cable between it and unit 5",
        ],
    );
    check(
        Loop,
        "10 10 10 10 10",
        &[
            "Loss of host port 1: no unit answers through it. Look at the cable between it and unit 1",
        ],
    );
}

/// Patterns that the guide does not print.
#[test]
fn a_loop_with_several_faults() {
    check(
        Loop,
        "11 00 11 00 11",
        &["Unit 1 is off", "Unit 3 is off", "Unit 5 is off"],
    );
    // The signal passes units 2 and 3 both ways.
    check(Loop, "00 11 11 00", &["Unit 2 is off", "Unit 3 is off"]);
    check(
        Loop,
        "01 11 01 10 11 10",
        &[
            "Unit 2 is off",
            "between unit 3 and unit 4",
            "Unit 5 is off",
        ],
    );
    // At a break, silent units may be cut off by a second one.
    check(
        Loop,
        "01 11 11 10",
        &["somewhere between unit 1 and unit 4; units 2 and 3 do not answer"],
    );
    check(
        Loop,
        "01 11 10",
        &["somewhere between unit 1 and unit 3; unit 2 does not answer"],
    );
    check(
        Loop,
        "11 10 10",
        &["somewhere between host port 1 and unit 2; unit 1 does not"],
    );
    check(
        Loop,
        "01 11 11",
        &["somewhere between unit 1 and host port 2; units 2 and 3 do not"],
    );
    check(Loop, "11 11 11", &["No unit answers through either port"]);
    check(
        Loop,
        "01 11 01",
        &["Unit 2 is off-line", "Loss of host port 2"],
    );
    check(
        Loop,
        "10 11 10",
        &["Loss of host port 1", "Unit 2 is off-line"],
    );
}

#[test]
fn a_loop_that_no_cable_explains() {
    check(
        Loop,
        "00 10 00",
        &["Unit 2 does not answer through host port 1, but units beyond it do"],
    );
    check(
        Loop,
        "00 01 00",
        &["Unit 2 does not answer through host port 2"],
    );
    let found = diagnose(Loop, &table(Loop, "00 10 11 00"));
    assert_eq!(found.findings.len(), 2);
    assert!(
        !found.findings.iter().any(|f| found.is_certain(f)),
        "nothing is certain then"
    );
}

/// With one unit nothing can be told apart.
#[test]
fn one_unit() {
    check(Loop, "00", &["No fault"]);
    check(Loop, "11", &["The only unit does not answer"]);
    check(Loop, "01", &["Loss of host port 2"]);
    check(Loop, "10", &["Loss of host port 1"]);
    check(SingleEnded, "1-", &["The only unit does not answer"]);
    check(MultiDrop, "1-", &["The only unit does not answer"]);
    let nothing = &diagnose(SingleEnded, &table(SingleEnded, "1-")).findings[0];
    assert!(nothing.is_ambiguous() && nothing.why().contains("With one unit"));
}

#[test]
fn one_port() {
    check(SingleEnded, "0- 0- 0- 0- 0-", &["No fault"]);
    check(SingleEnded, "0- 1- 0- 0- 0-", &["Unit 2 is off-line"]);
    check(
        SingleEnded,
        "0- 0- 1- 1- 1-",
        &["between unit 2 and unit 3, or bad terminals at either, or no power from unit 3 on"],
    );
    check(
        SingleEnded,
        "0- 1- 0- 0- 1-",
        &["Unit 2 is off-line", "Unit 5, the last one"],
    );
    check(
        SingleEnded,
        "0- 0- 0- 0- 1-",
        &["it is off-line, or the cable between unit 4 and unit 5"],
    );
    check(
        SingleEnded,
        "1- 1- 1-",
        &["No unit answers: look at host port 1, its converter and its cable first."],
    );
    check(
        MultiDrop,
        "1- 1- 1-",
        &["a short anywhere on the line silences all"],
    );
    check(MultiDrop, "0- 1- 1-", &["No unit answers from unit 2 on"]);
}

#[test]
fn not_tried_yet() {
    check(Loop, "-- -- --", &["6 polls are still to be made"]);
    check(Loop, "0- 0- 1-", &["3 polls"]);
    check(SingleEnded, "0- -- 0-", &["one poll is still"]);
    let found = diagnose(Loop, &table(Loop, "00 11 0-"));
    assert!(found.unsettled > 0 && !found.findings.iter().any(|f| found.is_certain(f)));
}

/// A port that the host lost: nothing is said of the cable there, and the rest is judged through
/// the other one.
#[test]
fn a_lost_port() {
    let lost = |pattern, port: &[HostPort]| {
        let mut table = table(Loop, pattern);
        for port in port {
            table.set_port(*port, false);
        }
        let found = diagnose(Loop, &table);
        found
            .findings
            .iter()
            .map(Finding::to_string)
            .collect::<Vec<_>>()
    };
    let two = lost("00 00 00", &[HostPort::Two]);
    assert_eq!(two.len(), 1);
    assert!(two[0].contains("The host lost host port 2"), "{two:?}");
    let two = lost("00 00 11 00", &[HostPort::Two]);
    assert!(two[1].contains("Unit 3 is off-line"), "{two:?}");
    let one = lost("10 10 00 00", &[HostPort::One]);
    assert_eq!(one.len(), 1, "port 2 reaches all");
    let one = lost("01 01 00 00", &[HostPort::One]);
    assert!(
        one[1].contains("from unit 2 on: break or short between unit 3 and unit 2"),
        "{one:?}"
    );
    let both = lost("00 00", &HostPort::BOTH);
    assert_eq!(both.len(), 2);
    // A port that is back has to be tried anew.
    let mut table = table(Loop, "00 00");
    table.set_port(HostPort::Two, false);
    assert_eq!(table.fault(1, HostPort::Two), Some(true));
    table.set_port(HostPort::Two, true);
    assert_eq!(table.fault(1, HostPort::Two), None);
    assert_eq!(diagnose(Loop, &table).findings, [Finding::Untried(2)]);
}

/// A pattern half from before a change and half from after it is not certain.
#[test]
fn a_mixture_is_preliminary() {
    let mut table = table(Loop, "01 01 01 01");
    assert_eq!(table.unsettled(), 0);
    // Port 2 comes back as port 1 goes; the pass on port 1 has got as far as unit 2.
    for (unit, one) in [(3, true), (4, true)] {
        table.note(unit, HostPort::One, one);
        table.note(unit, HostPort::Two, false);
    }
    let found = diagnose(Loop, &table);
    assert!(
        matches!(found.findings[..], [Finding::Break { .. }]),
        "{found:?}"
    );
    assert!(!found.is_certain(&found.findings[0]));
    assert!(found.caution().starts_with("Preliminary"));
    let texts: Vec<_> = [0, 1, 2]
        .map(|unsettled| {
            Diagnosis {
                findings: vec![],
                unsettled,
            }
            .caution()
        })
        .into();
    assert_eq!(texts[0], "");
    assert!(texts[1].contains("one poll") && texts[2].contains("2 polls"));
}

/// Every state of a loop of four units whose pattern can come about: what is certain is so.
#[test]
fn all_states_of_a_short_loop() {
    const UNITS: usize = 4;
    for cuts in 0..1_u32 << (UNITS + 1) {
        for off in 0..1_u32 << UNITS {
            let cut = |from: usize, to: usize| (from..to).any(|p| cuts >> p & 1 == 1);
            let is_off = |unit: usize| off >> unit & 1 == 1;
            let cell = |unit: usize| {
                let one = is_off(unit) || cut(0, unit + 1);
                let two = is_off(unit) || cut(unit + 1, UNITS + 1);
                format!("{}{}", u8::from(one), u8::from(two))
            };
            let pattern = (0..UNITS).map(cell).collect::<Vec<_>>().join(" ");
            let table = table(Loop, &pattern);
            let found = diagnose(Loop, &table);
            let place = |end| match end {
                End::Port(HostPort::One) => 0,
                End::Port(HostPort::Two) => UNITS + 1,
                End::Unit { place, .. } => place + 1,
            };
            let mut explained = off == 0 && cuts == 0;
            for finding in &found.findings {
                let right = match finding {
                    Finding::NoFault => off == 0 && cuts == 0,
                    Finding::OffLine(End::Unit { place, .. }) => is_off(*place),
                    Finding::Nothing { .. } => {
                        (0..UNITS).all(|u| is_off(u) || (cut(0, u + 1) && cut(u + 1, UNITS + 1)))
                    }
                    other => {
                        let (from, to) = other.stretch().unwrap();
                        cut(place(from), place(to))
                    }
                };
                assert!(right, "{cuts:b} {off:b} {pattern}: {finding:?}");
                explained |= !matches!(finding, Finding::NoFault);
            }
            assert!(explained, "{cuts:b} {off:b} {pattern}: {found:?}");
        }
    }
}

/// Any pattern gives words, in any shape, and the ends are in order.
#[test]
fn any_pattern() {
    for shape in [Loop, SingleEnded, MultiDrop] {
        for number in 0..9_u32.pow(4) {
            let marks = ['0', '1', '-'];
            let cell = |unit: u32| {
                let digit = number / 9_u32.pow(unit) % 9;
                [marks[(digit / 3) as usize], marks[(digit % 3) as usize]]
                    .iter()
                    .collect::<String>()
            };
            let pattern = (0..4).map(cell).collect::<Vec<_>>().join(" ");
            let found = diagnose(shape, &table(shape, &pattern));
            assert!(!found.findings.is_empty(), "{pattern}");
            for finding in &found.findings {
                assert!(!finding.to_string().is_empty() && !finding.key().is_empty());
                if let Some((from, to)) = finding.stretch() {
                    let at = |end| match end {
                        End::Port(HostPort::One) => -1,
                        End::Port(HostPort::Two) => 4,
                        End::Unit { place, .. } => i32::try_from(place).unwrap(),
                    };
                    assert!(at(from) < at(to), "{pattern}: {finding:?}");
                }
            }
        }
    }
}

#[test]
fn long_lists_stay_short() {
    let pattern = format!("01 {}10", "11 ".repeat(30));
    let found = diagnose(Loop, &table(Loop, &pattern));
    let text = found.findings[0].to_string();
    assert!(
        text.contains("units 2, 3, 4, 5, 6, 7, 8, 9, 21 more and 31 do not answer"),
        "{text}"
    );
}

/// The host's table beside the unit's own word, as the guide's examples overwrite it.
#[test]
fn the_word_of_the_unit_stays() {
    let table = table(Loop, "01 10 --");
    let own = 0x0844;
    assert_eq!(table.overwritten(1, own), 0x0844);
    assert_eq!(table.overwritten(2, own), 0x0444);
    assert_eq!(table.overwritten(3, own), own, "never tried");
    let single = self::table(SingleEnded, "1-");
    assert_eq!(single.overwritten(1, own), 0x0444, "with one port B is 0");
    let faults: Vec<_> = table.units().map(|(_, f)| f).collect();
    assert_eq!(faults[2], Pair::both(None));
}

/// A unit that comes and goes is named, and does not keep the rest in doubt.
#[test]
fn an_unsteady_unit_is_left_out() {
    let mut table = FaultTable::new(1..=4, true);
    let mut pass = |round: u32, port, off: &[u8]| {
        for unit in 1..=4 {
            let flaps = unit == 2 && round.is_multiple_of(2);
            table.note(unit, port, flaps || off.contains(&unit));
        }
        diagnose(Loop, &table)
    };
    let mut found = None;
    for round in 0..8 {
        for port in HostPort::BOTH {
            found = Some(pass(round, port, &[3]));
        }
    }
    let found = found.unwrap();
    let keys: Vec<_> = found.findings.iter().map(Finding::key).collect();
    assert_eq!(keys, ["unsteady", "off_line"]);
    assert!(
        found.findings[0]
            .to_string()
            .starts_with("Unit 2 comes and goes")
    );
    let two = Finding::Unsteady(vec![2, 4]).to_string();
    assert!(two.starts_with("Units 2 and 4 come and go") && two.contains("They are"));
    assert_eq!(found.unsettled, 0);
    assert!(found.is_certain(&found.findings[1]) && !found.is_certain(&found.findings[0]));
    // Going off once, and coming back, is no such thing.
    let mut table = self::table(Loop, "00 00 00");
    for failed in [true, false] {
        for port in HostPort::BOTH {
            table.note(2, port, failed);
        }
    }
    assert!(!table.is_unsteady(2));
    // And it is forgotten.
    for _ in 0..40 {
        for port in HostPort::BOTH {
            pass(1, port, &[]);
        }
    }
    let calm = pass(1, HostPort::One, &[]);
    assert_eq!(calm.findings, [Finding::NoFault]);
}

/// Next to an unsteady unit the place is told as far as it is known: found by days of polling.
#[test]
fn unsteady_units_widen_the_place() {
    let check = |shape, patterns: [&str; 2], expected: &[&str]| {
        let ports = if shape == Loop { 2 } else { 1 };
        let cells = patterns.map(|p| p.split(' ').collect::<Vec<_>>());
        let units = 1..=u8::try_from(cells[0].len()).unwrap();
        let mut table = FaultTable::new(units.clone(), shape == Loop);
        for round in 0..12 {
            for (at, port) in HostPort::BOTH.into_iter().enumerate().take(ports) {
                for (unit, cell) in units.clone().zip(&cells[round % 2]) {
                    table.note(unit, port, cell.as_bytes()[at] == b'1');
                }
            }
        }
        let found = diagnose(shape, &table);
        let texts: Vec<String> = found.findings.iter().map(Finding::to_string).collect();
        assert_eq!(texts.len(), expected.len(), "{texts:?}");
        for (text, part) in texts.iter().zip(expected) {
            assert!(text.contains(part), "{text:?} lacks {part:?}");
        }
        assert_eq!(found.unsettled, 0);
    };
    let unsteady = "comes and goes";
    check(
        Loop,
        ["01 01 01", "01 01 11"],
        &[
            unsteady,
            "between unit 2 and host port 2, or loss of the port",
        ],
    );
    check(
        Loop,
        ["10 10 10", "11 10 10"],
        &[unsteady, "between host port 1 and unit 2, or loss"],
    );
    check(
        Loop,
        ["01 00 10", "01 11 10"],
        &[unsteady, "between unit 1 and unit 3"],
    );
    check(
        SingleEnded,
        ["0 1 0", "0 1 1"],
        &[unsteady, "No unit answers from unit 2 on"],
    );
    check(
        SingleEnded,
        ["1 0", "1 1"],
        &[unsteady, "No unit answers: look at host port 1"],
    );
}
