//! Waiting until a moment, exactly.
//!
//! Timers of the runtime are up to two milliseconds late. That is as long as the silence before a
//! request: on a fast line it would cost a tenth of its capacity. A timer of the system that is
//! waited for like a socket is late by less than a tenth of a millisecond.

use tokio::time::{Instant, sleep_until};

/// Wakes a line.
#[derive(Debug, Default)]
pub struct Alarm {
    #[cfg(target_os = "linux")]
    timer: Option<linux::Timer>,
}

impl Alarm {
    /// An alarm that is as exact as the system can make it.
    #[must_use]
    pub fn exact() -> Self {
        Self {
            #[cfg(target_os = "linux")]
            timer: linux::Timer::new().ok(),
        }
    }

    /// Waits until a moment. Never ends before it. Safe to cancel.
    pub async fn until(&self, at: Instant) {
        #[cfg(target_os = "linux")]
        if let Some(timer) = &self.timer
            && timer.until(at).await.is_ok()
        {
            return;
        }
        sleep_until(at).await;
    }
}

#[cfg(target_os = "linux")]
mod linux {
    use rustix::fd::OwnedFd;
    use rustix::io::read;
    use rustix::time::{
        Itimerspec, TimerfdClockId, TimerfdFlags, TimerfdTimerFlags, Timespec, timerfd_create,
        timerfd_settime,
    };
    use std::io;
    use std::time::Duration;
    use tokio::io::unix::AsyncFd;
    use tokio::time::{Instant, sleep_until};

    /// Longer waits are left to the runtime, but for their end.
    const FINE: Duration = Duration::from_millis(20);

    #[derive(Debug)]
    pub(super) struct Timer(AsyncFd<OwnedFd>);

    impl Timer {
        pub(super) fn new() -> io::Result<Self> {
            let flags = TimerfdFlags::NONBLOCK | TimerfdFlags::CLOEXEC;
            let fd = timerfd_create(TimerfdClockId::Monotonic, flags)?;
            // The other constructor is `unsafe`, which this program does without.
            #[expect(
                deprecated,
                reason = "unsound only for types that lie about their descriptor; `OwnedFd` does not"
            )]
            AsyncFd::new(fd).map(Self)
        }

        pub(super) async fn until(&self, at: Instant) -> io::Result<()> {
            loop {
                let left = at.saturating_duration_since(Instant::now());
                if left.is_zero() {
                    return Ok(());
                }
                if left > FINE * 2 {
                    sleep_until(at - FINE).await;
                    continue;
                }
                let zero = Timespec::default();
                let spec = Itimerspec {
                    it_interval: zero,
                    it_value: Timespec::try_from(left).unwrap_or(zero),
                };
                timerfd_settime(&self.0, TimerfdTimerFlags::empty(), &spec)?;
                let mut ready = self.0.readable().await?;
                let mut count = [0; 8];
                // An alarm that was set before and not waited for says nothing; then again.
                let _rung = ready.try_io(|fd| Ok(read(fd, &mut count)?));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[tokio::test]
    async fn it_is_never_early() {
        for alarm in [Alarm::exact(), Alarm::default()] {
            for micros in [0, 100, 1750, 4010, 45_000] {
                let at = Instant::now() + Duration::from_micros(micros);
                alarm.until(at).await;
                assert!(Instant::now() >= at, "{micros}");
            }
        }
    }
}
