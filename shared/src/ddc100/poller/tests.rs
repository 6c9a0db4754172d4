//! The rules without a network: outcomes by hand, and any outcomes in any order.

use super::*;
use crate::address::{Address, Table};
use crate::device::Device;
use crate::encode::Read;
use crate::proto::DdcShape;
use proptest::prelude::*;

fn setup(units: u8, second: bool, retries: u8) -> Setup {
    let members = (1..=units).map(|unit| Member {
        unit,
        kind: Device::Ddc100Uec,
    });
    let read = Read::new(Table::Holding, Address::new(7), 3).unwrap();
    let shape = if second {
        DdcShape::Loop
    } else {
        DdcShape::SingleEnded
    };
    Setup {
        retries,
        ..Setup::new(shape, second, members.collect(), read)
    }
}

/// Asks until something is to be sent.
fn sent(poller: &mut Poller, now: &mut Micros) -> Option<Sent> {
    loop {
        match poller.next(*now) {
            Next::Wait(until) => {
                assert!(until > *now, "no waiting for the past");
                *now = until;
            }
            Next::Poll(poll) => return Some(Sent::Poll(poll)),
            Next::Other(other, port) => return Some(Sent::Other(other, port)),
            Next::Idle => return None,
            Next::Busy => panic!("nothing is under way"),
        }
    }
}

/// Gives each exchange its outcome; returns unit, port and repeat of each.
fn run(poller: &mut Poller, outcomes: &[Outcome]) -> Vec<(u8, u8, u8)> {
    let mut now = Micros::new(0);
    let mut log = Vec::new();
    for outcome in outcomes {
        let Some(Sent::Poll(poll)) = sent(poller, &mut now) else {
            panic!("a poll");
        };
        log.push((poll.member.unit, poll.port.number(), poll.repeat));
        now = now.plus(100_000);
        poller.done(*outcome, now);
    }
    log
}

use Outcome::{Damaged, Down, Exception, Ok as Good, Refused, Silence};

/// P7: repeats on the same port before the other one is tried; P5 and P6 after that.
#[test]
fn p7_retries_stay_on_the_port() {
    let mut poller = Poller::new(setup(2, true, 3));
    let log = run(
        &mut poller,
        &[Silence, Damaged, Silence, Silence, Good, Good, Good],
    );
    let expected = [
        (1, 1, 0),
        (1, 1, 1),
        (1, 1, 2),
        (1, 1, 3),
        (1, 2, 0),
        (2, 1, 0),
        (1, 2, 0),
    ];
    assert_eq!(log, expected);
    assert_eq!(poller.faults().fault(1, HostPort::One), Some(true));
    assert_eq!(poller.faults().fault(1, HostPort::Two), Some(false), "P5");
    // A repeat that succeeds is a success.
    let mut poller = Poller::new(setup(2, true, 1));
    let log = run(&mut poller, &[Silence, Good, Good]);
    assert_eq!(log, [(1, 1, 0), (1, 1, 1), (2, 1, 0)]);
    assert_eq!(poller.faults().fault(1, HostPort::One), Some(false));
    // Repeats on the other port count anew.
    let mut poller = Poller::new(setup(1, true, 1));
    let log = run(&mut poller, &[Silence; 6]);
    assert_eq!(log[..4], [(1, 1, 0), (1, 1, 1), (1, 2, 0), (1, 2, 1)]);
    assert_eq!(
        log[4..],
        [(1, 2, 0), (1, 1, 0)],
        "the second pass begins at port 2, and knows of both faults"
    );
}

/// P1, P2: with one port only that one is used; a success clears the fault.
#[test]
fn p1_p2_passes() {
    let mut poller = Poller::new(setup(2, false, 0));
    let log = run(&mut poller, &[Silence, Good, Good, Good]);
    assert_eq!(log, [(1, 1, 0), (2, 1, 0), (1, 1, 0), (2, 1, 0)]);
    assert_eq!(poller.faults().fault(1, HostPort::One), Some(false));
    assert_eq!(
        poller.faults().fault(1, HostPort::Two),
        None,
        "no such port"
    );
    assert_eq!(poller.last_pass().map(|p| p.number), Some(2));
}

/// A refusal of the unit is an answer; what was not sent says nothing.
#[test]
fn answers_and_what_is_none() {
    let mut poller = Poller::new(setup(2, true, 3));
    run(&mut poller, &[Exception, Refused]);
    assert_eq!(poller.faults().fault(1, HostPort::One), Some(false));
    assert_eq!(poller.faults().fault(2, HostPort::One), None);
    let done = poller.done(Good, Micros::new(0));
    assert!(
        done.sent.is_none() || !done.decided,
        "nothing was under way"
    );
}

/// The pause after an answer, and no second exchange at once.
#[test]
fn the_turn_time_is_kept() {
    let mut poller = Poller::new(setup(2, true, 0));
    let start = Micros::new(1000);
    assert!(matches!(poller.next(start), Next::Poll(_)));
    assert_eq!(poller.next(start), Next::Busy);
    let end = start.plus(70_000);
    let done = poller.done(Good, end);
    assert_eq!((done.took_us, done.decided), (70_000, true));
    let free = end.plus(21_000);
    assert_eq!(poller.next(end), Next::Wait(free));
    assert_eq!(
        poller.next(free.plus(0)),
        Next::Poll(Poll {
            member: poller.setup().units[1],
            port: HostPort::One,
            repeat: 0,
            timeout_us: poller.setup().timeout(Device::Ddc100Uec),
        })
    );
}

/// A lost port: known for all units at once, left out until it is back.
#[test]
fn a_lost_port_is_left_out() {
    let mut poller = Poller::new(setup(3, true, 3));
    run(&mut poller, &[Good; 6]);
    poller.set_port(HostPort::Two, false);
    for unit in 1..=3 {
        assert_eq!(poller.faults().fault(unit, HostPort::Two), Some(true));
    }
    let log = run(&mut poller, &[Good; 6]);
    assert!(log.iter().all(|(_, port, _)| *port == 1), "{log:?}");
    poller.set_port(HostPort::Two, true);
    assert_eq!(
        poller.faults().fault(1, HostPort::Two),
        None,
        "not tried since"
    );
    let log = run(&mut poller, &[Good; 6]);
    assert_eq!(log.iter().filter(|(_, port, _)| *port == 2).count(), 3);
    assert_eq!(poller.faults().fault(1, HostPort::Two), Some(false));
}

/// A port that is lost during an exchange: the unit is tried through the other one.
#[test]
fn a_port_is_lost_under_way() {
    let mut poller = Poller::new(setup(2, true, 3));
    let log = run(&mut poller, &[Good, Down, Good, Good, Good]);
    assert_eq!(log, [(1, 1, 0), (2, 1, 0), (2, 2, 0), (1, 2, 0), (2, 2, 0)]);
    assert!(!poller.faults().is_up(HostPort::One));
    // The other one as well: nothing is left to do.
    run(&mut poller, &[Down]);
    assert_eq!(poller.next(Micros::new(u64::MAX)), Next::Idle);
    assert_eq!(poller.port_for(1), None);
    poller.set_port(HostPort::One, true);
    assert!(matches!(poller.next(Micros::new(u64::MAX)), Next::Poll(p) if p.port == HostPort::One));
}

/// Section 4.3.1: other requests go between two polls, through the port of the pass, or the other
/// one if the unit has a fault there; at most one after the other.
#[test]
fn other_requests_go_between() {
    let mut poller = Poller::new(setup(2, true, 0));
    assert_eq!(
        poller.ask(Other { id: 1, unit: 9 }),
        Err(AskRefused::NoSuchUnit)
    );
    // Unit 1 answers through port 2 only.
    run(&mut poller, &[Silence, Good]);
    for (id, unit) in [(1, 1), (2, 2), (3, 1)] {
        poller.ask(Other { id, unit }).unwrap();
    }
    assert!(poller.forget(2) && !poller.forget(2));
    let mut now = Micros::new(10_000_000);
    let mut log = Vec::new();
    for _ in 0..4 {
        let it = sent(&mut poller, &mut now).unwrap();
        log.push(match it {
            Sent::Poll(poll) => format!("poll {} by {}", poll.member.unit, poll.port.number()),
            Sent::Other(other, port) => format!("other {} by {}", other.id, port.number()),
        });
        let done = poller.done(Good, now.plus(1));
        assert_eq!(done.sent, Some(it));
    }
    assert_eq!(
        log,
        ["other 1 by 2", "poll 2 by 1", "other 3 by 2", "poll 1 by 2"]
    );
    for id in 0..MOST_WAITING {
        poller
            .ask(Other {
                id: id as u64,
                unit: 1,
            })
            .unwrap();
    }
    assert_eq!(poller.ask(Other { id: 99, unit: 1 }), Err(AskRefused::Full));
}

#[test]
fn set_ups_with_problems() {
    use super::super::setup::SetupProblem as P;
    let good = || setup(3, true, 3);
    assert_eq!(good().problems(), []);
    let check = |change: fn(&mut Setup), expected: &[P]| {
        let mut setup = good();
        change(&mut setup);
        assert_eq!(setup.problems(), expected);
        assert!(expected.iter().all(|p| p.to_string().ends_with('.')));
    };
    check(|s| s.units.clear(), &[P::Empty]);
    check(|s| s.units[0].unit = 0, &[P::Address(0)]);
    check(|s| s.units[0].unit = 251, &[P::Address(251)]);
    check(|s| s.units[0].unit = 2, &[P::Twice(2)]);
    check(|s| s.shape = DdcShape::SingleEnded, &[P::SecondPort]);
    check(|s| s.retries = 4, &[P::Retries(4)]);
    check(|s| s.turn_us = 20_000, &[P::Turn(20_000)]);
    check(|s| s.turn_us = 50_000, &[P::Turn(50_000)]);
    check(|s| s.timeout_us = 200_000, &[P::Timeout(200_000)]);
    check(|s| s.line.baud = 0, &[P::Baud]);
    let many = setup(251, false, 0);
    assert_eq!(many.problems(), [P::TooMany(251), P::Address(251)]);
    let mut drop = setup(29, false, 0);
    drop.shape = DdcShape::MultiDrop;
    assert_eq!(
        (drop.problems(), drop.hint()),
        (vec![], Some(P::MultiDrop(29)))
    );
    assert_eq!(setup(28, false, 0).hint(), None);
}

/// Anything that can happen.
#[derive(Clone, Debug)]
enum Event {
    Ends(Outcome, u32),
    Port(bool, bool),
    Ask(u8),
    Time(u32),
}

fn event() -> impl Strategy<Value = Event> {
    let outcome = prop_oneof![
        Just(Good),
        Just(Exception),
        Just(Silence),
        Just(Damaged),
        Just(Refused),
        Just(Down)
    ];
    prop_oneof![
        8 => (outcome, 0..2_000_000_u32).prop_map(|(o, t)| Event::Ends(o, t)),
        1 => any::<(bool, bool)>().prop_map(|(a, b)| Event::Port(a, b)),
        2 => (0..9_u8).prop_map(Event::Ask),
        1 => any::<u32>().prop_map(Event::Time),
    ]
}

proptest! {
    /// P8 and more: whatever happens, units take turns in order, nobody starves, a failed unit is
    /// tried on both ports, and two other requests never go in a row.
    #[test]
    fn nobody_starves(
        events in proptest::collection::vec(event(), 1..400),
        units in 1..7_u8,
        second in any::<bool>(),
        retries in 0..4_u8,
    ) {
        let mut poller = Poller::new(setup(units, second, retries));
        let mut now = Micros::new(0);
        let mut last: Option<Poll> = None;
        let mut in_a_row = 0;
        for event in events {
            match event {
                Event::Port(one, up) => {
                    let port = if one { HostPort::One } else { HostPort::Two };
                    poller.set_port(port, up);
                }
                Event::Ask(unit) => {
                    let known = (1..=units).contains(&unit);
                    let asked = poller.ask(Other { id: 0, unit });
                    prop_assert_eq!(asked == Err(AskRefused::NoSuchUnit), !known);
                }
                Event::Time(us) => now = now.plus(us.into()),
                Event::Ends(outcome, us) => {
                    let Some(it) = sent(&mut poller, &mut now) else {
                        // Only without any port.
                        prop_assert!(poller.port_for(1).is_none());
                        continue;
                    };
                    now = now.plus(us.into());
                    let done = poller.done(outcome, now);
                    prop_assert_eq!(done.sent, Some(it));
                    let Sent::Poll(poll) = it else {
                        in_a_row += 1;
                        prop_assert!(in_a_row == 1, "two others in a row");
                        continue;
                    };
                    in_a_row = 0;
                    prop_assert!(poll.repeat <= retries);
                    // The same unit again, or the next one along the cable.
                    let unit = poll.member.unit;
                    if let Some(last) = last {
                        let next = last.member.unit % units + 1;
                        prop_assert!(unit == last.member.unit || unit == next);
                    }
                    last = Some(poll);
                    if done.decided {
                        let fault = poller.faults().fault(unit, poll.port);
                        match outcome {
                            Good | Exception => prop_assert_eq!(fault, Some(false)),
                            Silence | Damaged | Down => prop_assert_eq!(fault, Some(true)),
                            Refused => {}
                        }
                    }
                }
            }
        }
        // However it stands: with the ports there, a whole round of failures tries each unit on
        // each port, and ends within so many exchanges.
        for port in HostPort::BOTH {
            poller.set_port(port, true);
        }
        let ports = if second { 2 } else { 1 };
        let most = usize::from(units) * ports * usize::from(retries + 1) * 3 + 2 * MOST_WAITING;
        let mut tried = std::collections::BTreeSet::new();
        for _ in 0..most {
            if let Some(Sent::Poll(poll)) = sent(&mut poller, &mut now) {
                tried.insert((poll.member.unit, poll.port));
            }
            now = now.plus(1000);
            poller.done(Silence, now);
        }
        prop_assert_eq!(tried.len(), usize::from(units) * ports);
        for unit in 1..=units {
            prop_assert_eq!(poller.faults().fault(unit, HostPort::One), Some(true));
        }
    }
}

/// A unit that is known to be off is tried once on each port of each pass, and as often as a new fault
/// only if that is wanted; what answers is repeated as before.
#[test]
fn known_faults_are_tried_once() {
    for (retry_faulty, expected) in [(false, 2), (true, 6)] {
        let mut made = setup(2, true, 2);
        made.retry_faulty = retry_faulty;
        let mut poller = Poller::new(made);
        let mut now = Micros::new(0);
        let mut pass = || {
            let mut polls = 0;
            loop {
                match poller.next(now) {
                    Next::Wait(until) => now = until,
                    Next::Poll(poll) => {
                        let off = poll.member.unit == 2;
                        polls += u32::from(off);
                        now = now.plus(50_000);
                        if poller
                            .done(if off { Silence } else { Good }, now)
                            .pass
                            .is_some()
                        {
                            return polls;
                        }
                    }
                    other => panic!("{other:?}"),
                }
            }
        };
        assert_eq!(pass(), 6, "three times on each port");
        assert_eq!(pass(), expected);
        assert_eq!(pass(), expected);
    }
}
