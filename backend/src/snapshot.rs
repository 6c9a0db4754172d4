//! Reading a whole device over its bus.

use crate::bus::query::Query;
use crate::bus::{Handle, Report};
use shared::address::{Address, Table};
use shared::capture::Micros;
use shared::encode::Read;
use shared::icon3000::collect::{Answer, BUSY_TRIES, BUSY_WAIT_MS, Collector, Wire};
use shared::icon3000::identity::{self, Guess, PROBES, detect};
use shared::icon3000::snapshot::Snapshot;
use shared::image::Image;
use shared::proto::Outcome;
use std::time::Duration;
use tokio::time::sleep;

/// A device that gives no answer to so many requests in a row is not there.
const SILENT: u32 = 3;

/// Exceptions (VCIOM-16345-EN, table 50).
const ILLEGAL_ADDRESS: u8 = 2;
const BUSY: u8 = 6;

/// What was read, and what the wire carried for it.
#[derive(Debug)]
pub struct Taken {
    /// The snapshot; what could not be read is in it too, with the reason.
    pub snapshot: Snapshot,
    /// For the theoretical time.
    pub wire: Wire,
}

/// The software of the interface (reading E84), for a device that function 17 tells nothing of.
const SOFTWARE: (u16, u16) = (3072, 2);

/// Asks a device which model it is, by registers that only some have and by function 17; where that
/// gives no report, by the register that has the software too.
///
/// # Errors
/// If the device does not answer, or the line is not there: why, and what to do.
pub async fn which(bus: &Handle, device: usize) -> Result<Guess, String> {
    let mut refused = [None; 2];
    for (refused, at) in refused.iter_mut().zip(PROBES) {
        let Some(read) = Read::new(Table::Holding, Address::new(at), 1) else {
            continue;
        };
        let report = patiently(bus, device, &Query::Read(read)).await?;
        *refused = match report.code {
            None => Some(false),
            Some(code) => (code == ILLEGAL_ADDRESS).then_some(true),
        };
    }
    let report = patiently(bus, device, &Query::Identity).await?;
    let report = report.pdu.as_deref().and_then(identity::Report::of_pdu);
    let mut image = Image::new();
    let (at, count) = SOFTWARE;
    let software = Read::new(Table::Holding, Address::new(at), count);
    if let (None, Some(read)) = (&report, software) {
        let answer = patiently(bus, device, &Query::Read(read)).await?;
        if let Some(pdu) = answer.pdu {
            image.absorb(&read.pdu(), &pdu, Micros::default());
        }
    }
    let [beyond_3473, beyond_21] = refused;
    Ok(detect(&image, report.as_ref(), beyond_3473, beyond_21))
}

/// Asks once more where the device is busy. Its answer may be an exception; none is an error.
async fn patiently(bus: &Handle, device: usize, query: &Query) -> Result<Report, String> {
    let mut tries = 0;
    loop {
        let report = bus.read(device, query.clone()).await;
        match (&report.pdu, report.code) {
            (None, None) => return Err(report.text),
            (None, Some(BUSY)) if tries < BUSY_TRIES => tries += 1,
            _ => return Ok(report),
        }
        sleep(Duration::from_millis(BUSY_WAIT_MS.into())).await;
    }
}

/// Reads everything that the model of `empty` has. `tell` hears, before each request, how many are
/// done, how many there are as far as known, and what comes next.
///
/// # Errors
/// If the device does not answer at all, or the line is not there: why, and what to do.
pub async fn take(
    bus: &Handle,
    device: usize,
    empty: Snapshot,
    mut tell: impl FnMut(u32, u32, &str),
) -> Result<Taken, String> {
    let mut collector = Collector::new(empty);
    let mut silent = 0;
    while let Some(step) = collector.step() {
        let (pdu, text) = (step.pdu.clone(), step.text());
        let wait = Duration::from_millis(step.wait_ms.into());
        let (done, total) = collector.progress();
        tell(done, total, &text);
        let Some(query) = Query::of_pdu(&pdu) else {
            collector.answer(Answer::Failed("not a request that reads"));
            continue;
        };
        if !wait.is_zero() {
            sleep(wait).await;
        }
        let report = bus.read(device, query).await;
        match (report.pdu, report.code) {
            (Some(response), _) => {
                silent = 0;
                collector.answer(Answer::Response(&response));
            }
            (None, Some(code)) => {
                silent = 0;
                let function = pdu.first().copied().unwrap_or(0) | 0x80;
                collector.answer(Answer::Response(&[function, code]));
            }
            (None, None) => {
                silent += 1;
                let lost = report.outcome == Outcome::Down;
                if lost || silent >= SILENT {
                    return Err(report.text);
                }
                collector.answer(Answer::Failed(&report.text));
            }
        }
    }
    let wire = collector.wire();
    Ok(Taken {
        snapshot: collector.finish(),
        wire,
    })
}
