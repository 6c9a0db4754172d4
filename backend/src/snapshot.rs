//! Reading a whole device over its bus.

use crate::bus::Handle;
use crate::bus::query::Query;
use shared::icon3000::collect::{Answer, Collector, Wire};
use shared::icon3000::snapshot::Snapshot;
use shared::proto::Outcome;
use std::time::Duration;
use tokio::time::sleep;

/// A device that gives no answer to so many requests in a row is not there.
const SILENT: u32 = 3;

/// What was read, and what the wire carried for it.
#[derive(Debug)]
pub struct Taken {
    /// The snapshot; what could not be read is in it too, with the reason.
    pub snapshot: Snapshot,
    /// For the theoretical time.
    pub wire: Wire,
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
