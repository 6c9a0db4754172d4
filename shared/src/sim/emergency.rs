//! Emergency strokes: an ESD from one end to the other leaves its times in a file (table 40).

use super::Icon3000;
use super::drive::{self, Demand};

/// An emergency stroke.
#[derive(Clone, Debug, Default)]
pub(super) enum Emergency {
    #[default]
    Off,
    /// From end to end: tenths of a second since the command, at each percent of the way.
    Runs {
        opening: bool,
        tenths: u16,
        times: Vec<u16>,
    },
    /// It is over, or did not begin at an end.
    Over,
}

impl Icon3000 {
    /// Follows an emergency stroke; called after each step of the drive.
    pub(super) fn emergency(&mut self) {
        if !self.is_v2() || !self.is_esd() {
            self.efs = Emergency::Off;
            return;
        }
        if matches!(self.efs, Emergency::Off) {
            // One step was made already; no valve leaves its end in it.
            let gone = self.drive.position();
            let left = drive::OPEN.saturating_sub(gone);
            self.efs = match self.demand() {
                Demand::Close if left < 1000 => begin(false),
                Demand::Open if gone < 1000 => begin(true),
                _ => Emergency::Over,
            };
        }
        let position = self.drive.position();
        let Emergency::Runs {
            opening,
            tenths,
            times,
        } = &mut self.efs
        else {
            return;
        };
        *tenths = tenths.saturating_add(1);
        let gone = if *opening {
            position
        } else {
            drive::OPEN.saturating_sub(position)
        };
        let percent = usize::try_from(gone.checked_div(1000).unwrap_or(0)).unwrap_or(0);
        while times.len() <= percent.min(100) {
            times.push(*tenths);
        }
        if percent >= 100 {
            self.history.emergency(times, *opening, self.wall);
            self.efs = Emergency::Over;
        }
    }
}

fn begin(opening: bool) -> Emergency {
    Emergency::Runs {
        opening,
        tenths: 0,
        times: Vec::new(),
    }
}
