//! When to try again.

use crate::format::within;

/// Longest wait, in milliseconds: a backend that is back is found within five seconds.
const LONGEST: u32 = 4500;

/// Milliseconds to wait before attempt number `attempt`, counted from 0. `random` is 0 to 1 and
/// keeps many pages from coming back at the same moment.
#[must_use]
pub fn wait_ms(attempt: u32, random: f64) -> u32 {
    let base = 300_u32.saturating_mul(1 << attempt.min(6)).min(LONGEST);
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a random part of a positive number below 2^32"
    )]
    let jitter = (f64::from(base / 2) * within(random, 0.0, 1.0)) as u32;
    base / 2 + jitter
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waits_grow_and_stay_below_five_seconds() {
        assert!(wait_ms(0, 1.0) <= 300);
        for attempt in 0..100 {
            for random in [0.0, 0.5, 1.0, 7.0] {
                let wait = wait_ms(attempt, random);
                assert!((150..=4500).contains(&wait), "{attempt} {random} {wait}");
            }
        }
        assert!(wait_ms(9, 0.0) > wait_ms(0, 1.0));
    }
}
