//! The device on the line, and what is being read of it.

use leptos::prelude::*;
use shared::device::Device;
use shared::proto::{IconAsk, IconNews};

use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::job::Job;
use crate::actuator::state::wanted::Wanted;

/// The device on the line.
#[derive(Clone, Debug, Default)]
pub struct Site {
    /// What was read of it.
    pub dossier: Dossier,
    /// What is being read.
    pub job: Option<Job>,
    /// A read that was ended before it was whole, and from when on its answers count.
    pub broken: Option<(Wanted, u64)>,
    /// How the last read ended, in words.
    pub last: String,
    /// True while it is asked whether to save what is not whole.
    pub saving: bool,
}

impl Site {
    /// What is being read because somebody asked for it.
    #[must_use]
    pub fn shown_job(&self) -> Option<&Job> {
        self.job.as_ref().filter(|job| !job.wanted.quiet)
    }

    /// The connection is gone: nothing of what was asked comes back.
    pub fn lost(&mut self) {
        self.stop("The connection was lost.");
    }

    /// Ends the read under way, and says why; it can be gone on with.
    pub(super) fn stop(&mut self, why: &str) {
        if let Some(job) = self.job.take().filter(|job| !job.wanted.quiet) {
            self.broken = Some((job.wanted.clone(), job.since()));
            why.clone_into(&mut self.last);
        }
    }

    /// A backend said hello. Its clock may be another one than before: then no time in here counts.
    pub(super) fn greeted(&mut self, device: Option<(Device, u8)>, start_wall_ms: u64) {
        let before = self.dossier.start_wall_ms;
        if before != 0 && before.abs_diff(start_wall_ms) > 5000 {
            self.dossier = Dossier::new(&self.dossier.tag, Device::None);
            self.job = None;
            self.broken = None;
        }
        self.dossier.start_wall_ms = start_wall_ms;
        let (device, unit) = device.unwrap_or_default();
        self.dossier.device = device;
        self.dossier.unit = unit;
    }

    /// Takes news in; what to ask for next, if something is still missing.
    pub(super) fn hear(
        &mut self,
        news: &IconNews,
        next: StoredValue<u32>,
        now: u64,
    ) -> Option<IconAsk> {
        let job = self.job.as_mut().filter(|job| job.id == id_of(news))?;
        job.touch(now);
        if !job.hear(news, &mut self.dossier) {
            return None;
        }
        let id = next.get_value();
        if job.next(id, &self.dossier) {
            next.set_value(id.wrapping_add(1));
            return Some(IconAsk::Read {
                id,
                device: self.dossier.tag.clone(),
                steps: job.steps().to_vec(),
            });
        }
        let job = self.job.take().filter(|job| !job.wanted.quiet)?;
        let requests = crate::format::count(u64::from(job.done), "request");
        let whole = job.is_whole(&self.dossier);
        self.last = if job.cancelled {
            format!("Cancelled after {requests}.")
        } else {
            format!("{requests} done.")
        };
        if !whole {
            self.broken = Some((job.wanted.clone(), job.since()));
        }
        None
    }
}

const fn id_of(news: &IconNews) -> u32 {
    match news {
        IconNews::Exchange { id, .. }
        | IconNews::Progress { id, .. }
        | IconNews::Done { id, .. } => *id,
    }
}

/// The tag of the device that news are about.
pub(super) const fn device_of(news: &IconNews) -> &String {
    match news {
        IconNews::Exchange { device, .. }
        | IconNews::Progress { device, .. }
        | IconNews::Done { device, .. } => device,
    }
}
