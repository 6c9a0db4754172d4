//! Times at the beginning of the lines of a log.

use crate::capture::Micros;

/// The date and the time of day with which a line begins.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stamp {
    /// Days since 1970-01-01.
    days: Option<u64>,
    /// Microseconds since midnight.
    clock: Option<u64>,
}

impl Stamp {
    /// Takes a word in; false if it is neither a date nor a time.
    ///
    /// `12:00:01`, `12:00:01.250`, `2026-11-22`, `2026-11-22T12:00:01Z`. A word of this shape that
    /// is no time, such as `99:99:99`, still is no byte.
    pub(super) fn takes(&mut self, word: &[u8]) -> bool {
        let shape = |pattern: &[u8]| {
            word.len() >= pattern.len()
                && word.iter().zip(pattern).all(|(b, p)| match p {
                    b'9' => b.is_ascii_digit(),
                    _ => b == p,
                })
        };
        if shape(b"9999-99-99") {
            self.days = date(word);
            self.clock = word
                .get(10..)
                .and_then(|rest| rest.strip_prefix(b"T"))
                .and_then(clock);
            return true;
        }
        if shape(b"99:99:99") && word.get(8) != Some(&b':') {
            self.clock = clock(word);
            return true;
        }
        false
    }

    /// The moment, counted from the date if there is one, else from midnight.
    pub(super) fn time(self) -> Option<Micros> {
        let day = self.days.unwrap_or(0).checked_mul(86_400_000_000)?;
        Some(Micros::new(day.checked_add(self.clock?)?))
    }
}

/// The number that some digits write.
fn number(digits: Option<&[u8]>) -> Option<u64> {
    core::str::from_utf8(digits?).ok()?.parse().ok()
}

/// Microseconds since midnight of `HH:MM:SS`, with a fraction or without.
fn clock(word: &[u8]) -> Option<u64> {
    let (hour, minute, second) = (
        number(word.get(..2))?,
        number(word.get(3..5))?,
        number(word.get(6..8))?,
    );
    // 60: a leap second.
    if hour > 23 || minute > 59 || second > 60 {
        return None;
    }
    let mut micros = 0_u64;
    let fraction = word
        .get(8..)
        .and_then(|rest| rest.strip_prefix(b".").or(rest.strip_prefix(b",")))
        .unwrap_or(&[]);
    let digits = fraction.iter().take_while(|b| b.is_ascii_digit());
    for digit in digits.chain(b"000000").take(6) {
        micros = micros
            .saturating_mul(10)
            .saturating_add(u64::from(digit.saturating_sub(b'0')));
    }
    let seconds = hour
        .saturating_mul(3600)
        .saturating_add(minute.saturating_mul(60))
        .saturating_add(second);
    Some(seconds.saturating_mul(1_000_000).saturating_add(micros))
}

/// Days since 1970-01-01 of `YYYY-MM-DD`.
fn date(word: &[u8]) -> Option<u64> {
    const BEFORE: [u64; 12] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334];
    let (year, month, day) = (
        number(word.get(..4))?,
        number(word.get(5..7))?,
        number(word.get(8..10))?,
    );
    let before = BEFORE.get(usize::try_from(month.checked_sub(1)?).ok()?)?;
    if year < 1970 || !(1..=31).contains(&day) {
        return None;
    }
    let leaps = |year: u64| {
        (year / 4)
            .saturating_sub(year / 100)
            .saturating_add(year / 400)
    };
    let is_leap = leaps(year) > leaps(year.saturating_sub(1));
    let years = year
        .saturating_sub(1970)
        .saturating_mul(365)
        .saturating_add(leaps(year.saturating_sub(1)).saturating_sub(leaps(1969)));
    let leap_day = u64::from(is_leap && month > 2);
    Some(
        years
            .saturating_add(*before)
            .saturating_add(leap_day)
            .saturating_add(day.saturating_sub(1)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time(words: &[&str]) -> Option<u64> {
        let mut stamp = Stamp::default();
        words
            .iter()
            .for_each(|w| assert!(stamp.takes(w.as_bytes()), "{w}"));
        stamp.time().map(Micros::get)
    }

    /// By hand: 12 h 0 min 1.25 s are 43,201.25 s; 1,613,143,765 s since 1970 are
    /// 2021-02-12T15:29:25Z (`date -u`).
    #[test]
    fn times_count_microseconds() {
        assert_eq!(time(&["12:00:01.25"]), Some(43_201_250_000));
        assert_eq!(time(&["12:00:01,250"]), Some(43_201_250_000));
        assert_eq!(
            time(&["2021-02-12", "15:29:25"]),
            Some(1_613_143_765_000_000)
        );
        assert_eq!(
            time(&["2021-02-12T15:29:25.5Z"]),
            Some(1_613_143_765_500_000)
        );
        assert_eq!(time(&["2024-02-29T00:00:00"]), Some(1_709_164_800_000_000));
        assert_eq!(time(&["2024-03-01T00:00:00"]), Some(1_709_251_200_000_000));
    }

    #[test]
    fn what_is_no_time_is_none() {
        assert_eq!(time(&["25:00:00"]), None);
        assert_eq!(
            time(&["2026-13-01T00:00:00"]),
            Some(0),
            "only the clock counts"
        );
        let mut stamp = Stamp::default();
        // Bytes with marks between.
        assert!(!stamp.takes(b"01:03:00:0A"));
        assert!(!stamp.takes(b"010300"));
    }
}
