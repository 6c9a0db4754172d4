//! The time of this program: microseconds since it started, and the wall clock for people.

use shared::capture::Micros;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use tokio::time::Instant;

/// Counts from the start of the program. Cheap to copy; all copies agree.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    start: Instant,
    /// Wall clock at `start`. Later jumps of the wall clock change nothing.
    wall: Duration,
}

impl Clock {
    /// A clock that starts now.
    #[must_use]
    pub fn start() -> Self {
        Self {
            start: Instant::now(),
            wall: SystemTime::now()
                .duration_since(UNIX_EPOCH)
                .unwrap_or_default(),
        }
    }

    /// Microseconds since the start.
    #[must_use]
    pub fn now(&self) -> Micros {
        self.at(Instant::now())
    }

    /// A moment as microseconds since the start.
    #[must_use]
    pub fn at(&self, moment: Instant) -> Micros {
        let passed = moment.saturating_duration_since(self.start).as_micros();
        Micros::new(u64::try_from(passed).unwrap_or(u64::MAX))
    }

    /// The moment of a time of this clock.
    #[must_use]
    pub fn moment(&self, at: Micros) -> Instant {
        self.start + Duration::from_micros(at.get())
    }

    /// Milliseconds since 1970, running on from what the wall clock said at the start.
    #[must_use]
    pub fn wall_ms(&self) -> u64 {
        let wall = self.wall + self.start.elapsed();
        u64::try_from(wall.as_millis()).unwrap_or(u64::MAX)
    }

    /// A number that differs from run to run.
    #[must_use]
    pub fn run(&self) -> u64 {
        // Pages read it as a double, which holds 53 bits.
        u64::try_from(self.wall.as_micros()).unwrap_or(1) & ((1 << 53) - 1)
    }
}
