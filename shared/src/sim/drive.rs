//! Motor, gear and valve: position, speed and torque.

/// Fully open, in thousandths of a percent.
pub(super) const OPEN: u32 = 100_000;
/// Time of a full stroke.
const OPENING_MS: u32 = 24_000;
const CLOSING_MS: u32 = 26_000;
/// Every so many strokes the seat is tight.
const TIGHT: u32 = 4;
/// Above this torque the warning comes, in percent.
const HI_TORQUE: u8 = 80;

/// Torque by position in percent of travel and of nominal torque: break-out of the seat, running,
/// and the end.
const OPENING: [(u32, u32); 7] = [
    (0, 62),
    (4, 48),
    (10, 27),
    (45, 23),
    (60, 26),
    (90, 22),
    (100, 36),
];
const CLOSING: [(u32, u32); 7] = [
    (0, 71),
    (3, 55),
    (9, 31),
    (40, 25),
    (60, 24),
    (92, 22),
    (100, 39),
];

/// What the motor is to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Demand {
    Stop,
    Open,
    Close,
    /// Go to a position and stay there.
    Reach(u32),
    /// Follow a position with dead band and motion inhibit time (section 9.2).
    Follow(u32),
}

/// Which way the motor runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    Still,
    Opening,
    Closing,
}

/// A full stroke that was recorded.
#[derive(Clone, Debug)]
pub(super) struct Stroke {
    pub opening: bool,
    /// Torque at 0 % to 100 %.
    pub samples: [u8; 101],
    pub millis: u32,
}

/// What a step brought about.
#[derive(Clone, Debug, Default)]
pub(super) struct Done {
    pub stroke: Option<Stroke>,
    pub hi_torque: bool,
}

/// The drive.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    position: u32,
    pub motion: Motion,
    /// Torque in percent, without direction.
    pub load: u8,
    /// The mains voltage is low, or too low to run.
    pub low_mains: bool,
    pub no_mains: bool,
    /// How many times slower than usual it runs.
    pub slow: u32,
    /// Warning of torque in closing direction, until the next start.
    pub hi_torque: bool,
    pub cycles: u32,
    pub run_ms: u64,
    still_ms: u32,
    /// The stroke that is being recorded, if it began at an end.
    recording: Option<Stroke>,
    closings: u32,
}

impl Drive {
    pub(super) fn new() -> Self {
        Self {
            position: 0,
            motion: Motion::Still,
            load: 0,
            low_mains: false,
            no_mains: false,
            slow: 1,
            hi_torque: false,
            cycles: 0,
            run_ms: 0,
            still_ms: 3_600_000,
            recording: None,
            closings: 0,
        }
    }

    /// Position in thousandths of a percent.
    pub(super) const fn position(&self) -> u32 {
        self.position
    }

    /// Position in tenths of a percent, rounded down, so that only an end is shown as one.
    pub(super) fn tenths(&self) -> u16 {
        u16::try_from(self.position.checked_div(100).unwrap_or(0)).unwrap_or(1000)
    }

    pub(super) const fn is_open(&self) -> bool {
        self.position >= OPEN
    }

    pub(super) const fn is_closed(&self) -> bool {
        self.position == 0
    }

    /// Torque as shown: negative in opening direction.
    pub(super) fn torque(&self) -> i16 {
        match self.motion {
            Motion::Still => 0,
            Motion::Opening => i16::from(self.load).saturating_neg(),
            Motion::Closing => i16::from(self.load),
        }
    }

    /// One step of time.
    pub(super) fn step(&mut self, ms: u32, demand: Demand, band: u32, inhibit: u32) -> Done {
        let wanted = self.wanted(demand, band, inhibit);
        if wanted != self.motion {
            self.turn(wanted);
        }
        if self.motion == Motion::Still {
            self.still_ms = self.still_ms.saturating_add(ms);
            self.load = 0;
            return Done::default();
        }
        self.run_ms = self.run_ms.saturating_add(ms.into());
        let slow = self.slow;
        let travel = |full: u32| {
            let full = full.saturating_mul(slow);
            OPEN.saturating_mul(ms).checked_div(full).unwrap_or(0)
        };
        let target = match demand {
            Demand::Reach(to) | Demand::Follow(to) => Some(to.min(OPEN)),
            _ => None,
        };
        self.position = match self.motion {
            Motion::Opening => self
                .position
                .saturating_add(travel(OPENING_MS))
                .min(target.unwrap_or(OPEN)),
            _ => self
                .position
                .saturating_sub(travel(CLOSING_MS))
                .max(target.unwrap_or(0)),
        };
        let mut done = Done::default();
        self.load = self.torque_here();
        self.record(ms);
        if self.load > HI_TORQUE && !self.hi_torque && self.motion == Motion::Closing {
            self.hi_torque = true;
            done.hi_torque = true;
        }
        let arrived = match self.motion {
            Motion::Opening => self.is_open(),
            _ => self.is_closed(),
        };
        if arrived {
            done.stroke = self.recording.take();
            self.turn(Motion::Still);
        } else if target == Some(self.position) {
            self.turn(Motion::Still);
        }
        done
    }

    /// Which way to run.
    fn wanted(&self, demand: Demand, band: u32, inhibit: u32) -> Motion {
        let towards = |to: u32| match to.min(OPEN) {
            to if to > self.position => Motion::Opening,
            to if to < self.position => Motion::Closing,
            _ => Motion::Still,
        };
        match demand {
            Demand::Stop => Motion::Still,
            Demand::Open if self.is_open() => Motion::Still,
            Demand::Open => Motion::Opening,
            Demand::Close if self.is_closed() => Motion::Still,
            Demand::Close => Motion::Closing,
            Demand::Reach(to) => towards(to),
            Demand::Follow(to) => {
                let off = to.abs_diff(self.position);
                let may_start = off > band && self.still_ms >= inhibit;
                if self.motion != Motion::Still || may_start {
                    towards(to)
                } else {
                    Motion::Still
                }
            }
        }
    }

    fn turn(&mut self, to: Motion) {
        self.motion = to;
        self.still_ms = 0;
        self.recording = None;
        if to == Motion::Still {
            self.load = 0;
            return;
        }
        self.cycles = self.cycles.saturating_add(1);
        self.hi_torque = false;
        let opening = to == Motion::Opening;
        if !opening {
            self.closings = self.closings.saturating_add(1);
        }
        // Only a stroke from end to end gives a curve.
        if (opening && self.is_closed()) || (!opening && self.is_open()) {
            self.recording = Some(Stroke {
                opening,
                samples: [0; 101],
                millis: 0,
            });
        }
    }

    fn torque_here(&self) -> u8 {
        let tight = self.closings.checked_rem(TIGHT) == Some(TIGHT.saturating_sub(1));
        torque(self.motion == Motion::Opening, self.position, tight)
    }

    fn record(&mut self, ms: u32) {
        let (load, position) = (self.load, self.position);
        let Some(stroke) = &mut self.recording else {
            return;
        };
        stroke.millis = stroke.millis.saturating_add(ms);
        let here = position.checked_div(1000).unwrap_or(0);
        let here = usize::try_from(here).unwrap_or(0);
        // A step may pass over a sample: all that were not taken yet get the same.
        let untaken = |s: &&mut u8| **s == 0;
        if stroke.opening {
            let passed = stroke.samples.iter_mut().take(here.saturating_add(1));
            passed.rev().take_while(untaken).for_each(|s| *s = load);
        } else {
            let passed = stroke.samples.iter_mut().skip(here);
            passed.take_while(untaken).for_each(|s| *s = load);
        }
    }
}

/// Torque in percent at a position. It never is 0: a motor that runs turns something.
pub(super) fn torque(opening: bool, position: u32, tight: bool) -> u8 {
    let points = if opening { &OPENING } else { &CLOSING };
    let percent = position.checked_div(1000).unwrap_or(0);
    let mut load = 25;
    for pair in points.windows(2) {
        if let [(from, low), (to, high)] = pair
            && (from..=to).contains(&&percent)
        {
            let along = |by: u32| {
                by.saturating_mul(percent.saturating_sub(*from))
                    .checked_div(to.saturating_sub(*from))
                    .unwrap_or(0)
            };
            load = if high >= low {
                low.saturating_add(along(high.saturating_sub(*low)))
            } else {
                low.saturating_sub(along(low.saturating_sub(*high)))
            };
            break;
        }
    }
    // A little unevenness of the gear, the same at the same position.
    let ripple = percent.saturating_mul(37).checked_rem(5).unwrap_or(0);
    load = load.saturating_add(ripple).saturating_sub(2);
    if tight && !opening && percent < 6 {
        load = load.saturating_add(20);
    }
    u8::try_from(load.clamp(1, 100)).unwrap_or(100)
}
