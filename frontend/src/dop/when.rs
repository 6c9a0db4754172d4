//! Times in words: how long ago, and exactly.

use shared::dop::Stamp;

use crate::chart::time::stamp;

/// How long ago a moment was, in words: `3 days ago`. A clock ahead of ours gives `in 5 minutes`.
#[must_use]
pub fn ago(then: i64, now: i64) -> String {
    let seconds = now.saturating_sub(then);
    let words = span(seconds.unsigned_abs());
    match seconds {
        -59..=59 => "just now".to_owned(),
        60.. => format!("{words} ago"),
        _ => format!("in {words}"),
    }
}

/// A length of time in its largest unit that says enough: `90 seconds`, `3 hours`, `2 years`.
#[must_use]
pub fn span(seconds: u64) -> String {
    const UNITS: [(u64, u64, &str); 6] = [
        (120, 1, "second"),
        (2 * 3600, 60, "minute"),
        (2 * 86_400, 3600, "hour"),
        (60 * 86_400, 86_400, "day"),
        (730 * 86_400, 30 * 86_400 + 37_800, "month"),
        (u64::MAX, 31_556_952, "year"),
    ];
    let (_, unit, name) = UNITS
        .into_iter()
        .find(|(below, _, _)| seconds < *below)
        .unwrap_or((0, 31_556_952, "year"));
    let count = seconds / unit;
    format!("{count} {name}{}", if count == 1 { "" } else { "s" })
}

/// The exact time: `2026-11-23 14:05:09 UTC`, `never`, or the odd number of seconds.
#[must_use]
pub fn exact(stamp_of: Stamp) -> String {
    match stamp_of {
        Stamp::Never => "never".to_owned(),
        Stamp::At(seconds) => format!("{} UTC", stamp(seconds)),
        Stamp::Odd(seconds) => format!("{seconds} s, which is no date"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spans_are_told_in_their_unit() {
        for (seconds, words) in [
            (0, "0 seconds"),
            (119, "119 seconds"),
            (120, "2 minutes"),
            (7_199, "119 minutes"),
            (7_200, "2 hours"),
            (172_800, "2 days"),
            (5_184_000, "1 month"),
            (63_072_000, "1 year"),
            (95_000_000, "3 years"),
        ] {
            assert_eq!(span(seconds), words);
        }
    }

    #[test]
    fn past_and_future() {
        assert_eq!(ago(1000, 1030), "just now");
        assert_eq!(ago(1000, 1000 + 3 * 86_400), "3 days ago");
        assert_eq!(ago(1000 + 600, 1000), "in 10 minutes");
        assert_eq!(ago(i64::MIN, i64::MAX), ago(i64::MIN, i64::MAX));
    }

    #[test]
    fn exact_times_say_never() {
        assert_eq!(exact(Stamp::Never), "never");
        assert_eq!(exact(Stamp::At(0x6026_9ECB)), "2021-02-12 15:29:15 UTC");
        assert_eq!(exact(Stamp::Odd(-5)), "-5 s, which is no date");
    }
}
