//! One field unit, as the actor of its network knows it.

use super::doubts::Doubts;
use crate::bus::schedule::Plan;
use shared::capture::Micros;
use shared::ddc100::{FaultTable, HostPort};
use shared::device::Device;
use shared::encode::Read;
use shared::proto::{DdcNews, Outcome};
use shared::render::hex;
use tokio::time::Instant;

/// How the last poll ended.
#[derive(Clone, Debug)]
pub(super) struct Last {
    pub port: HostPort,
    pub outcome: Outcome,
    pub text: String,
    pub read: Read,
}

/// The last good answer to a poll.
#[derive(Clone, Debug)]
struct Good {
    request: String,
    response: String,
    at: Micros,
    took_us: u64,
}

/// One field unit.
pub(super) struct Unit {
    pub tag: String,
    pub address: u8,
    pub kind: Device,
    /// Where its state is posted.
    pub slot: usize,
    /// What pages watch on it.
    pub plan: Plan,
    pub doubts: Doubts,
    pub last: Option<Last>,
    good: Option<Good>,
    /// What goes wrong with what a page watches, while polls go well.
    pub trouble: Option<(Outcome, String)>,
    /// What was posted last, and when.
    pub posted: Option<(Outcome, Instant)>,
    pub last_ok: Option<Micros>,
    pub latency_us: Option<u64>,
}

impl Unit {
    /// A unit of which nothing is known.
    pub fn new(tag: String, address: u8, kind: Device, slot: usize) -> Self {
        Self {
            tag,
            address,
            kind,
            slot,
            plan: Plan::default(),
            doubts: Doubts::default(),
            last: None,
            good: None,
            trouble: None,
            posted: None,
            last_ok: None,
            latency_us: None,
        }
    }

    /// It answered.
    pub fn answered(&mut self, at: Micros, took_us: u64) {
        self.last_ok = Some(at);
        self.latency_us = Some(took_us);
    }

    /// It answered a poll well.
    pub fn polled(&mut self, read: Read, response: &[u8], at: Micros, took_us: u64) {
        self.good = Some(Good {
            request: hex(&read.pdu()),
            response: hex(response),
            at,
            took_us,
        });
    }

    /// What pages are told; `None` before the first poll.
    pub fn news(&self, bus: &str, faults: &FaultTable) -> Option<DdcNews> {
        let last = self.last.as_ref()?;
        let good = self.good.as_ref();
        Some(DdcNews::Unit {
            bus: bus.to_owned(),
            unit: self.address,
            port: last.port.number(),
            outcome: last.outcome,
            text: last.text.clone(),
            fault_a: faults.fault(self.address, HostPort::One),
            fault_b: faults.fault(self.address, HostPort::Two),
            request: good.map_or_else(|| hex(&last.read.pdu()), |g| g.request.clone()),
            response: good.map(|g| g.response.clone()).unwrap_or_default(),
            at_us: good.map(|g| g.at.get()),
            took_us: good.map(|g| g.took_us),
        })
    }

    /// True if no port that the network has reaches it.
    pub fn is_off(&self, faults: &FaultTable) -> bool {
        HostPort::BOTH
            .into_iter()
            .filter(|port| faults.has(*port))
            .all(|port| faults.fault(self.address, port) == Some(true))
    }
}
