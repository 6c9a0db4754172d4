//! The examples of section 4.3.2 by simulator and poller together.

use super::HostPort;
mod soak;

use super::diagnosis::{Finding, diagnose};
use super::poller::{Next, Pass, Poller};
use super::setup::{Member, Setup};
use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::device::Device;
use crate::encode::Read;
use crate::proto::{DdcShape, Outcome};
use crate::sim::ddc100::{Loop, Trouble, UnitTrouble};

/// Host and network, in simulated time.
pub(super) struct Bench {
    pub poller: Poller,
    pub network: Loop,
    pub now: Micros,
    /// Unit, port and success of each poll that was decided.
    pub log: Vec<(u8, u8, bool)>,
}

impl Bench {
    pub(super) fn new(setup: Setup) -> Self {
        assert_eq!(setup.problems(), []);
        Self {
            network: Loop::new(setup.shape, &setup.units),
            poller: Poller::new(setup),
            now: Micros::new(0),
            log: Vec::new(),
        }
    }

    /// One thing after the other until a pass is over.
    pub(super) fn pass(&mut self) -> Pass {
        loop {
            if let Some(pass) = self.step() {
                return pass;
            }
        }
    }

    pub(super) fn step(&mut self) -> Option<Pass> {
        match self.poller.next(self.now) {
            Next::Wait(until) => {
                assert!(until > self.now);
                self.now = until;
                None
            }
            Next::Poll(poll) => {
                let (line, read) = (self.poller.setup().line, self.poller.setup().read);
                self.now = self.now.plus(line.characters(line.frame(5)));
                let answer =
                    self.network
                        .request(poll.port, poll.member.unit, &read.pdu(), self.now);
                let took = answer
                    .as_ref()
                    .map(|a| a.after_us + line.characters(line.frame(a.pdu.len())));
                let outcome = match took {
                    Some(us) if us <= poll.timeout_us => {
                        self.now = self.now.plus(us);
                        Outcome::Ok
                    }
                    _ => {
                        self.now = self.now.plus(poll.timeout_us);
                        Outcome::Silence
                    }
                };
                let done = self.poller.done(outcome, self.now);
                if done.decided {
                    let good = outcome == Outcome::Ok;
                    self.log.push((poll.member.unit, poll.port.number(), good));
                }
                done.pass
            }
            other => panic!("{other:?}"),
        }
    }

    /// Bits 10 and 11 of register 9 as the host keeps them, as `AB` for each unit.
    fn table(&self) -> Vec<(u8, u8)> {
        let faults = self.poller.faults();
        let word = |unit| faults.overwritten(unit, 0);
        faults
            .units()
            .map(|(u, _)| {
                (
                    u8::from(word(u) & 1 << 10 != 0),
                    u8::from(word(u) & 1 << 11 != 0),
                )
            })
            .collect()
    }
}

pub(super) fn units(count: u8, kind: Device) -> Vec<Member> {
    (1..=count).map(|unit| Member { unit, kind }).collect()
}

pub(super) fn status_read() -> Read {
    Read::new(Table::Holding, Address::new(7), 9).unwrap()
}

fn five(shape: DdcShape, trouble: Option<Trouble>) -> Bench {
    let second = shape == DdcShape::Loop;
    let mut bench = Bench::new(Setup::new(
        shape,
        second,
        units(5, Device::Ddc100Mx),
        status_read(),
    ));
    if let Some(trouble) = trouble {
        assert!(bench.network.inject(trouble));
    }
    bench
}

/// Truth tables of examples 1 to 7: A and B of units 1 to 5.
#[test]
fn the_examples_of_the_guide() {
    use DdcShape::{Loop as Ring, SingleEnded};
    let off = |unit| Some(Trouble::Unit(unit, UnitTrouble::Off));
    let clear = [(0, 0); 5];
    let examples = [
        (Ring, None, clear, "no_fault"),
        (
            Ring,
            off(3),
            [(0, 0), (0, 0), (1, 1), (0, 0), (0, 0)],
            "off_line",
        ),
        (
            Ring,
            Some(Trouble::Break(3)),
            [(0, 1), (0, 1), (0, 1), (1, 0), (1, 0)],
            "break",
        ),
        (
            Ring,
            Some(Trouble::Port(HostPort::Two)),
            [(0, 1); 5],
            "port_lost",
        ),
        (SingleEnded, None, clear, "no_fault"),
        (
            SingleEnded,
            off(2),
            [(0, 0), (1, 0), (0, 0), (0, 0), (0, 0)],
            "off_line",
        ),
        (
            SingleEnded,
            Some(Trouble::Short(2)),
            [(0, 0), (0, 0), (1, 0), (1, 0), (1, 0)],
            "beyond",
        ),
    ];
    for (number, (shape, trouble, table, key)) in (1..).zip(examples) {
        let mut bench = five(shape, trouble);
        for _ in 0..4 {
            bench.pass();
        }
        assert_eq!(bench.table(), table, "example {number}");
        let found = diagnose(shape, bench.poller.faults());
        assert_eq!(found.unsettled, 0, "example {number}");
        let keys: Vec<_> = found.findings.iter().map(Finding::key).collect();
        assert_eq!(keys, [key], "example {number}");
    }
}

/// Section 4.3.1: five units, unit 3 off, poll by poll.
#[test]
fn the_worked_sequence() {
    let mut bench = five(DdcShape::Loop, Some(Trouble::Unit(3, UnitTrouble::Off)));
    bench.pass();
    bench.pass();
    bench.pass();
    let (ok, fail) = (true, false);
    let first = [
        (1, 1, ok),
        (2, 1, ok),
        (3, 1, fail),
        (3, 2, fail),
        (4, 1, ok),
        (5, 1, ok),
    ];
    let second = [
        (1, 2, ok),
        (2, 2, ok),
        (3, 2, fail),
        (3, 1, fail),
        (4, 2, ok),
        (5, 2, ok),
    ];
    assert_eq!(bench.log, [first, second, first].concat());
}
