//! Dates and times on an axis, in UTC: the clock of the device knows no other.

use super::ticks::Tick;

const MONTHS: [&str; 12] = [
    "Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec",
];

const DAY: i64 = 86_400;

/// A moment by the calendar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Civil {
    /// Year; 0 and negative years are before our era.
    pub year: i64,
    /// 1 to 12.
    pub month: i64,
    /// 1 to 31.
    pub day: i64,
    /// Seconds since midnight.
    pub second: i64,
}

impl Civil {
    /// The calendar's name of a moment in seconds since 1970-01-01 UTC.
    #[must_use]
    pub fn of(seconds: i64) -> Self {
        // Years that begin in March have their leap day at the end; 400 of them are 146 097 days.
        let days = seconds.div_euclid(DAY).saturating_add(719_468);
        let (era, of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
        let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
        let of_year = of_era - (365 * year + year / 4 - year / 100);
        let shifted = (5 * of_year + 2) / 153;
        let month = if shifted < 10 {
            shifted + 3
        } else {
            shifted - 9
        };
        Self {
            year: era * 400 + year + i64::from(month <= 2),
            month,
            day: of_year - (153 * shifted + 2) / 5 + 1,
            second: seconds.rem_euclid(DAY),
        }
    }

    /// Seconds since 1970-01-01 UTC.
    #[must_use]
    pub fn seconds(self) -> i64 {
        let year = if self.month <= 2 {
            self.year - 1
        } else {
            self.year
        };
        let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
        let shifted = if self.month > 2 {
            self.month - 3
        } else {
            self.month + 9
        };
        let of_year = (153 * shifted + 2) / 5 + self.day - 1;
        let days = era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468;
        days.saturating_mul(DAY).saturating_add(self.second)
    }

    fn month_name(self) -> &'static str {
        let at = usize::try_from(self.month - 1).unwrap_or(0);
        MONTHS.get(at).copied().unwrap_or("")
    }
}

/// Date and time to the second: `2026-11-23 14:05:09`.
#[must_use]
pub fn stamp(seconds: i64) -> String {
    let c = Civil::of(seconds);
    format!("{}:{:02}", minute(seconds), c.second % 60)
}

/// Date and time to the minute: `2026-11-23 14:05`.
#[must_use]
pub fn minute(seconds: i64) -> String {
    let c = Civil::of(seconds);
    format!(
        "{} {:02}:{:02}",
        date(seconds),
        c.second / 3600,
        c.second / 60 % 60
    )
}

/// The date: `2026-11-23`.
#[must_use]
pub fn date(seconds: i64) -> String {
    let c = Civil::of(seconds);
    format!("{:04}-{:02}-{:02}", c.year, c.month, c.day)
}

/// A stretch of time, as exact as its length asks for.
#[must_use]
pub fn stretch(from: i64, to: i64) -> String {
    let long = to.saturating_sub(from) >= 2 * DAY;
    match (long, from == to) {
        (_, true) => minute(from),
        (true, _) => format!("{} to {}", date(from), date(to)),
        _ if date(from) == date(to) => {
            let end = minute(to);
            format!("{} to {}", minute(from), end.get(11..).unwrap_or(&end))
        }
        _ => format!("{} to {}", minute(from), minute(to)),
    }
}

/// The step from one tick to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    Seconds(i64),
    Months(i64),
}

/// Steps that fall on round times.
const STEPS: [Step; 21] = [
    Step::Seconds(1),
    Step::Seconds(5),
    Step::Seconds(15),
    Step::Seconds(60),
    Step::Seconds(300),
    Step::Seconds(900),
    Step::Seconds(1800),
    Step::Seconds(3600),
    Step::Seconds(3 * 3600),
    Step::Seconds(6 * 3600),
    Step::Seconds(12 * 3600),
    Step::Seconds(DAY),
    Step::Seconds(2 * DAY),
    Step::Seconds(7 * DAY),
    Step::Months(1),
    Step::Months(3),
    Step::Months(6),
    Step::Months(12),
    Step::Months(24),
    Step::Months(60),
    Step::Months(120),
];

/// Ticks at round dates and times, at most `most` of them.
#[must_use]
pub fn ticks(low: i64, high: i64, most: usize) -> Vec<Tick> {
    let most = i64::try_from(most.max(1)).unwrap_or(1);
    let span = high.saturating_sub(low).max(1);
    let fits = |step: &Step| match step {
        Step::Seconds(s) => span / s <= most,
        // The shortest months decide.
        Step::Months(m) => span / (m * 28 * DAY) <= most,
    };
    match STEPS.iter().copied().find(fits) {
        Some(Step::Seconds(step)) => by_seconds(low, high, step),
        Some(Step::Months(step)) => by_months(low, high, step),
        None => by_months(low, high, 12 * (span / (most * 365 * DAY)).max(1)),
    }
}

fn by_seconds(low: i64, high: i64, step: i64) -> Vec<Tick> {
    // Weeks begin on Monday; 1970-01-01 was a Thursday.
    let shift = if step == 7 * DAY { 4 * DAY } else { 0 };
    let first = (low - shift).div_euclid(step) + i64::from((low - shift).rem_euclid(step) != 0);
    let mut ticks = Vec::new();
    let mut at = first * step + shift;
    while at <= high {
        let c = Civil::of(at);
        let text = if c.second == 0 {
            format!("{} {}", c.day, c.month_name())
        } else if step < 60 {
            format!(
                "{:02}:{:02}:{:02}",
                c.second / 3600,
                c.second / 60 % 60,
                c.second % 60
            )
        } else {
            format!("{:02}:{:02}", c.second / 3600, c.second / 60 % 60)
        };
        ticks.push(Tick::new(at, text));
        at += step;
    }
    ticks
}

fn by_months(low: i64, high: i64, step: i64) -> Vec<Tick> {
    let c = Civil::of(low);
    let first = c.year * 12 + c.month - 1;
    let mut month = first.div_euclid(step) * step;
    let mut ticks = Vec::new();
    loop {
        let c = Civil {
            year: month.div_euclid(12),
            month: month.rem_euclid(12) + 1,
            day: 1,
            second: 0,
        };
        let at = c.seconds();
        if at > high {
            return ticks;
        }
        if at >= low {
            let text = match (step >= 12, c.month) {
                (true, _) => c.year.to_string(),
                (false, 1) => format!("{} {}", c.month_name(), c.year),
                _ => c.month_name().to_owned(),
            };
            ticks.push(Tick::new(at, text));
        }
        month += step;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0x60269ECB, the low word of the example in section 2.1.6 of AIIOM000698-01.
    const EXAMPLE: i64 = 0x6026_9ECB;

    fn texts(ticks: &[Tick]) -> Vec<&str> {
        ticks.iter().map(|t| t.text.as_str()).collect()
    }

    #[test]
    fn the_calendar_is_right() {
        assert_eq!(stamp(EXAMPLE), "2021-02-12 15:29:15");
        assert_eq!(stamp(0), "1970-01-01 00:00:00");
        assert_eq!(stamp(-1), "1969-12-31 23:59:59");
        // 2000 was a leap year, 1900 was none.
        assert_eq!(date(951_782_400), "2000-02-29");
        assert_eq!(date(-2_203_891_200), "1900-03-01");
        for at in [0, EXAMPLE, -1, 951_782_400, -2_203_891_200, 4_102_444_800] {
            assert_eq!(Civil::of(at).seconds(), at);
        }
    }

    #[test]
    fn stretches_are_as_exact_as_they_are_long() {
        let noon = 1_600_000_000 - 1_600_000_000 % DAY + DAY / 2;
        assert_eq!(stretch(noon, noon + 3600), "2020-09-13 12:00 to 13:00");
        assert_eq!(stretch(noon, noon + 60 * DAY), "2020-09-13 to 2020-11-12");
        assert_eq!(stretch(noon, noon), "2020-09-13 12:00");
    }

    #[test]
    fn ticks_stand_at_round_times() {
        // 2021-02-12 15:29:15 and a day later: every six hours.
        let day = ticks(EXAMPLE, EXAMPLE + DAY, 6);
        assert_eq!(texts(&day), ["18:00", "13 Feb", "06:00", "12:00"]);
        // Thirty days: weeks, on Mondays. 2021-02-15 was one.
        let month = ticks(EXAMPLE, EXAMPLE + 30 * DAY, 6);
        assert_eq!(texts(&month), ["15 Feb", "22 Feb", "1 Mar", "8 Mar"]);
        let year = ticks(EXAMPLE, EXAMPLE + 365 * DAY, 6);
        assert_eq!(texts(&year), ["Apr", "Jul", "Oct", "Jan 2022"]);
        let decade = ticks(EXAMPLE, EXAMPLE + 3650 * DAY, 6);
        assert_eq!(texts(&decade), ["2022", "2024", "2026", "2028", "2030"]);
        assert!(ticks(EXAMPLE, EXAMPLE + 30, 40).len() <= 31);
    }
}
