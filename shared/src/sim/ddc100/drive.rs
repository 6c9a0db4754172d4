//! Motor and valve of a simulated unit.

/// Fully open, in thousandths of a percent.
pub(super) const OPEN: u64 = 100_000;
/// How long the motor pushes against a tripped torque switch before it stops.
const JAM_US: u64 = 1_000_000;
/// Where the torque switch trips, if it is to.
const TRIPS_AT: u64 = 50_000;

/// Which way the motor runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Motion {
    #[default]
    Still,
    Opening,
    Closing,
}

/// Motor and valve.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    /// Time of a full stroke.
    stroke_us: u64,
    position: u64,
    /// What is left of a division, so that many short steps go as far as a long one.
    rest: u64,
    pub(super) motion: Motion,
    target: u64,
    /// How long the torque switch has been tripped while the motor runs.
    jammed_us: Option<u64>,
    /// Torque switch faults until the valve was moved the other way.
    pub(super) open_torque: bool,
    pub(super) close_torque: bool,
    /// The torque switch is to trip on the way.
    pub(super) trips_opening: bool,
    pub(super) trips_closing: bool,
}

impl Drive {
    pub(super) const fn new(stroke_us: u64) -> Self {
        Self {
            stroke_us,
            position: 0,
            rest: 0,
            motion: Motion::Still,
            target: 0,
            jammed_us: None,
            open_torque: false,
            close_torque: false,
            trips_opening: false,
            trips_closing: false,
        }
    }

    /// Position in whole percent, rounded down, so that only an end is shown as 100.
    pub(super) fn percent(&self) -> u16 {
        u16::try_from(self.position.checked_div(1000).unwrap_or(0)).unwrap_or(100)
    }

    pub(super) const fn is_open(&self) -> bool {
        self.position >= OPEN
    }

    pub(super) const fn is_closed(&self) -> bool {
        self.position == 0
    }

    /// True while the motor pushes against a tripped torque switch.
    pub(super) const fn is_jammed(&self) -> bool {
        self.jammed_us.is_some()
    }

    pub(super) const fn stop(&mut self) {
        self.motion = Motion::Still;
        self.jammed_us = None;
    }

    /// Is moved by hand to a position in thousandths of a percent.
    pub(super) const fn put(&mut self, position: u64) {
        self.stop();
        self.position = position;
    }

    /// Goes to a position in thousandths of a percent.
    pub(super) fn go(&mut self, target: u64) {
        self.target = target.min(OPEN);
        self.jammed_us = None;
        self.motion = match self.target.cmp(&self.position) {
            core::cmp::Ordering::Greater if !self.open_torque => Motion::Opening,
            core::cmp::Ordering::Less if !self.close_torque => Motion::Closing,
            _ => Motion::Still,
        };
    }

    /// Lets time go on.
    pub(super) fn advance(&mut self, mut us: u64) {
        if let Some(jammed) = self.jammed_us {
            let jammed = jammed.saturating_add(us);
            self.jammed_us = Some(jammed);
            if jammed >= JAM_US {
                let opening = self.motion == Motion::Opening;
                self.open_torque |= opening;
                self.close_torque |= !opening;
                self.stop();
            }
            return;
        }
        if self.motion == Motion::Still {
            return;
        }
        // Longer than a stroke is as good as a stroke.
        us = us.min(self.stroke_us);
        let product = us.saturating_mul(OPEN).saturating_add(self.rest);
        let way = product.checked_div(self.stroke_us).unwrap_or(OPEN);
        self.rest = product.checked_rem(self.stroke_us).unwrap_or(0);
        let opening = self.motion == Motion::Opening;
        let (from, trips) = (
            self.position,
            if opening {
                self.trips_opening
            } else {
                self.trips_closing
            },
        );
        self.position = if opening {
            from.saturating_add(way).min(self.target)
        } else {
            from.saturating_sub(way).max(self.target)
        };
        let passed = if opening {
            from < TRIPS_AT && self.position >= TRIPS_AT
        } else {
            from > TRIPS_AT && self.position <= TRIPS_AT
        };
        if opening {
            self.close_torque = false;
        } else {
            self.open_torque = false;
        }
        if trips && passed {
            self.position = TRIPS_AT;
            self.jammed_us = Some(0);
        } else if self.position == self.target {
            self.stop();
        }
    }
}
