//! One question and its answer.

use super::Actor;
use super::port::Port;
use crate::bus::query::Query;
use crate::bus::timing::Timing;
use crate::bus::{Answer, Fault};
use shared::address::{Address, Table};
use shared::ddc100::{HostPort, timing};
use shared::encode::Read;
use std::io;
use std::pin::pin;
use std::time::Duration;
use tokio::time::{Instant, sleep_until};

impl Actor {
    /// The read to poll a unit with: one whose answer can't be mistaken for a late one.
    pub(super) async fn shape(&mut self, at: usize) -> Read {
        loop {
            let usual = self.usual;
            let Some(unit) = self.units.get_mut(at) else {
                return usual;
            };
            match unit.doubts.poll(usual, Instant::now()) {
                Ok(read) => return read,
                Err(until) => sleep_until(until).await,
            }
        }
    }

    /// Asks a unit through a port, after the turn time, and listens to the other port meanwhile.
    pub(super) async fn exchange(
        &mut self,
        number: HostPort,
        at: usize,
        query: &Query,
    ) -> Result<Answer, Fault> {
        for port in &self.ports {
            port.drive(port.number == number);
        }
        let quiet = self.quiet_from;
        let Some(unit) = self.units.get(at) else {
            return Err(io::Error::from(io::ErrorKind::NotFound).into());
        };
        let (address, setup) = (unit.address, self.poller.setup());
        // A long answer takes longer, and so does the unit (reading D24).
        let timeout = timing::timeout(
            setup.line,
            unit.kind,
            &like(query, self.usual),
            setup.timeout_us,
        );
        let timeout = Duration::from_micros(timeout);
        let mut active = None;
        let mut other = None;
        for port in &mut self.ports {
            if port.number == number {
                // What is said of a silent unit names it.
                port.bus.timeout = timeout;
                active = port.line.as_mut();
            } else {
                other = Some(port);
            }
        }
        let Some(line) = active else {
            return Err(io::Error::from(io::ErrorKind::NotConnected).into());
        };
        line.set_timeout(timeout);
        line.busy_until(quiet);
        let stray = line.stray();
        let (result, lost) = {
            let work = pin!(line.read(address, query));
            beside(work, other).await
        };
        let now = Instant::now();
        self.quiet_from = match &result {
            Ok(_) => line.last().unwrap_or(now),
            Err(_) => now,
        };
        if let Some(at) = line.stray().filter(|at| Some(*at) != stray) {
            self.units.iter_mut().for_each(|u| u.doubts.stray(at));
        }
        if let Some(error) = lost {
            self.lost(number.other(), &error);
        }
        match &result {
            Err(Fault::Line(error)) if error.kind() != io::ErrorKind::PermissionDenied => {
                self.lost(number, error);
            }
            Err(fault) if fault.is_open() => {
                let timing = Timing {
                    timeout,
                    ..self.timing
                };
                let quarantine = timing.quarantine(query.response_len(), false);
                if let Some(unit) = self.units.get_mut(at) {
                    unit.doubts.add(query, now, quarantine);
                }
            }
            _ => {}
        }
        result
    }
}

/// A read that takes a unit and the wire as long, or a little longer.
fn like(query: &Query, usual: Read) -> Read {
    match query {
        Query::Read(read) => *read,
        _ => Read::new(Table::Holding, Address::new(0), 2).unwrap_or(usual),
    }
}

/// Does the work while a port is listened to, and says if that was lost meanwhile.
async fn beside<T>(
    mut work: impl Future<Output = T> + Unpin,
    port: Option<&mut Port>,
) -> (T, Option<io::Error>) {
    let Some(port) = port else {
        return (work.await, None);
    };
    let mut lost = None;
    loop {
        tokio::select! {
            biased;
            result = &mut work => return (result, lost),
            error = port.listen(), if lost.is_none() => lost = Some(error),
        }
    }
}
