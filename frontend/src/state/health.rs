//! Which devices need a look first.

use shared::proto::Outcome;

use super::overview::{Overview, watched};
use super::plant::DeviceState;

/// How a device is, the worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Health {
    /// Nothing is wrong.
    Good,
    /// Nothing was read yet.
    Unread,
    /// Warning bits are set.
    Warning,
    /// It does not answer, or not soundly: what it is doing is not known.
    Silent,
    /// Alarm bits are set.
    Alarm,
}

impl Health {
    /// How a device is, from its last answers.
    #[must_use]
    pub fn of(outcome: Option<Outcome>, overview: &Overview) -> Self {
        if !overview.alarms.is_empty() {
            Self::Alarm
        } else if outcome.is_some_and(|o| !matches!(o, Outcome::Ok | Outcome::Exception)) {
            Self::Silent
        } else if !overview.warnings.is_empty() {
            Self::Warning
        } else if overview.known {
            Self::Good
        } else {
            Self::Unread
        }
    }
}

/// How a device is. One of which nothing is read again and again is not worse for that.
#[must_use]
pub fn health(device: &DeviceState, overview: &Overview) -> Health {
    match Health::of(device.outcome, overview) {
        Health::Unread if watched(device.device).is_empty() => Health::Good,
        other => other,
    }
}

/// The words for an outcome.
#[must_use]
pub const fn outcome(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Ok => "answers",
        Outcome::Exception => "refuses the read",
        Outcome::Silence => "does not answer",
        Outcome::Damaged => "answers are damaged",
        Outcome::Down => "line down",
        Outcome::Refused => "read was not sent",
    }
}

/// How fresh a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freshness {
    /// As fresh as it should be.
    Fresh,
    /// Older than it should be, or nobody can bring a newer one.
    Stale,
}

/// Judges a value of `age` microseconds. `period` is how often it is read again, `None` if it was
/// read once; `reachable` is false while the connection or the device is away.
#[must_use]
pub fn freshness(age: u64, period: Option<u64>, reachable: bool) -> Freshness {
    let late = period.is_some_and(|period| age > period.saturating_mul(3).max(3_000_000));
    if late || !reachable {
        Freshness::Stale
    } else {
        Freshness::Fresh
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_comes_last() {
        let known = Overview {
            known: true,
            ..Overview::default()
        };
        let good = Health::of(Some(Outcome::Ok), &known);
        let silent = Health::of(Some(Outcome::Silence), &known);
        let unread = Health::of(None, &Overview::default());
        assert!(good < unread && unread < silent && silent < Health::Alarm);
    }

    #[test]
    fn old_and_unreachable_values_are_stale() {
        assert_eq!(
            freshness(1_500_000, Some(1_000_000), true),
            Freshness::Fresh
        );
        assert_eq!(
            freshness(3_500_000, Some(1_000_000), true),
            Freshness::Stale
        );
        assert_eq!(freshness(900_000_000, None, true), Freshness::Fresh);
        assert_eq!(freshness(0, None, false), Freshness::Stale);
    }
}
