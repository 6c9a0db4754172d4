//! A DDC-100 host and its network in simulated time: the poller of `shared` asks the simulated loop,
//! with the characters on the wire in between.

use shared::address::{Address, Table};
use shared::capture::Micros;
use shared::ddc100::poller::{Next, Pass};
use shared::ddc100::setup::{Member, Setup};
use shared::ddc100::{FaultTable, HostPort, Poller};
use shared::device::Device;
use shared::encode::Read;
use shared::proto::{DdcNews, Outcome};
use shared::sim::ddc100::Loop;

/// Host and network, in simulated time.
#[derive(Debug)]
pub struct Bench {
    /// The host.
    pub poller: Poller,
    /// The cable with its units.
    pub network: Loop,
    /// The clock of both.
    pub now: Micros,
    /// Unit, port and success of each poll that was decided.
    pub log: Vec<(u8, u8, bool)>,
}

impl Bench {
    /// A network that was just switched on.
    ///
    /// # Panics
    ///
    /// If the set-up has problems.
    #[must_use]
    pub fn new(setup: Setup) -> Self {
        assert_eq!(setup.problems(), []);
        Self {
            network: Loop::new(setup.shape, &setup.units),
            poller: Poller::new(setup),
            now: Micros::new(0),
            log: Vec::new(),
        }
    }

    /// One thing after the other until a pass is over.
    pub fn pass(&mut self) -> Pass {
        loop {
            if let Some(pass) = self.step() {
                return pass;
            }
        }
    }

    /// One thing: a wait, or an exchange. Returns the pass that ended with it.
    ///
    /// # Panics
    ///
    /// If the poller has nothing to do.
    pub fn step(&mut self) -> Option<Pass> {
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
    #[must_use]
    pub fn table(&self) -> Vec<(u8, u8)> {
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

/// What a host tells of a unit after a poll through a port.
#[must_use]
pub fn unit_news(faults: &FaultTable, unit: u8, port: u8) -> DdcNews {
    DdcNews::Unit {
        bus: String::new(),
        unit,
        port,
        outcome: Outcome::Ok,
        text: String::new(),
        fault_a: faults.fault(unit, HostPort::One),
        fault_b: faults.fault(unit, HostPort::Two),
        request: String::new(),
        response: String::new(),
        at_us: None,
        took_us: None,
    }
}

/// What it tells of a pass.
#[must_use]
pub fn pass_news(pass: Pass) -> DdcNews {
    DdcNews::Pass {
        bus: String::new(),
        port: pass.port.number(),
        number: pass.number,
        took_us: pass.took_us,
        expected_us: pass.expected_us,
    }
}

/// Units 1 and on, all of one type.
#[must_use]
pub fn units(count: u8, kind: Device) -> Vec<Member> {
    (1..=count).map(|unit| Member { unit, kind }).collect()
}

/// A read of so many holding registers.
///
/// # Panics
///
/// If that is more than one read can have.
#[must_use]
pub fn registers(first: u16, count: u16) -> Read {
    Read::new(Table::Holding, Address::new(first - 1), count).expect("a legal read")
}
