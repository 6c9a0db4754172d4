//! Calendar and BCD.

/// Seconds from 1970 to 2000, where the logs of the actuator begin to count.
const Y2K: u64 = 946_684_800;

/// A date and time of day.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Stamp {
    pub year: u16,
    pub month: u8,
    pub day: u8,
    pub hour: u8,
    pub minute: u8,
    pub second: u8,
}

impl Stamp {
    /// The date of so many seconds since 1970.
    ///
    /// Counts days from the first of March, so that the day of the leap year is the last one of its
    /// year; four hundred years have 146097 days.
    pub(super) fn at(seconds: u64) -> Self {
        let part = |value: u64, by: u64| {
            (
                value.checked_div(by).unwrap_or(0),
                value.checked_rem(by).unwrap_or(0),
            )
        };
        let small = |value: u64| u8::try_from(value).unwrap_or(0);
        let (days, second) = part(seconds, 86_400);
        // From 1 March of the year 0.
        let (era, day) = part(days.saturating_add(719_468), 146_097);
        let leap = part(day, 1460)
            .0
            .saturating_add(part(day, 146_096).0)
            .saturating_sub(part(day, 36_524).0);
        let year = part(day.saturating_sub(leap), 365).0;
        let before = year
            .saturating_mul(365)
            .saturating_add(part(year, 4).0)
            .saturating_sub(part(year, 100).0);
        let day = day.saturating_sub(before);
        let month = part(day.saturating_mul(5).saturating_add(2), 153).0;
        let first = part(month.saturating_mul(153).saturating_add(2), 5).0;
        let is_next_year = month >= 10;
        let month = if is_next_year {
            month.saturating_sub(9)
        } else {
            month.saturating_add(3)
        };
        let year = era
            .saturating_mul(400)
            .saturating_add(year)
            .saturating_add(u64::from(is_next_year));
        Self {
            year: u16::try_from(year).unwrap_or(u16::MAX),
            month: small(month),
            day: small(day.saturating_sub(first).saturating_add(1)),
            hour: small(part(second, 3600).0),
            minute: small(part(part(second, 3600).1, 60).0),
            second: small(part(second, 60).1),
        }
    }

    /// Seconds since 1970; `None` if this is no date.
    pub(super) fn seconds(self) -> Option<u64> {
        let in_range = (1..=12).contains(&self.month)
            && (1..=31).contains(&self.day)
            && self.hour < 24
            && self.minute < 60
            && self.second < 60;
        let (year, month) = (u64::from(self.year), u64::from(self.month));
        let (year, month) = if month <= 2 {
            (year.checked_sub(1)?, month.saturating_add(9))
        } else {
            (year, month.saturating_sub(3))
        };
        let of_month = month.saturating_mul(153).saturating_add(2).checked_div(5)?;
        let days = year
            .saturating_mul(365)
            .saturating_add(year.checked_div(4)?)
            .saturating_sub(year.checked_div(100)?)
            .saturating_add(year.checked_div(400)?)
            .saturating_add(of_month)
            .saturating_add(u64::from(self.day))
            .checked_sub(719_469)?;
        let time = u64::from(self.hour)
            .saturating_mul(3600)
            .saturating_add(u64::from(self.minute).saturating_mul(60))
            .saturating_add(u64::from(self.second));
        let seconds = days.saturating_mul(86_400).saturating_add(time);
        // The thirtieth of February is no day.
        (in_range && Self::at(seconds) == self).then_some(seconds)
    }

    /// Two words: `0xDDMM`, `0xYYYY` (VCIOM-16345-EN, table 5, note 2).
    pub(super) fn date(self) -> [u16; 2] {
        let [high, low] = split(self.year);
        [
            u16::from_be_bytes([bcd(self.day), bcd(self.month)]),
            u16::from_be_bytes([bcd(high), bcd(low)]),
        ]
    }

    /// Two words: `0x00HH`, `0xMMSS` (note 3).
    pub(super) fn time(self) -> [u16; 2] {
        [
            u16::from(bcd(self.hour)),
            u16::from_be_bytes([bcd(self.minute), bcd(self.second)]),
        ]
    }

    /// Six bytes: day, month, year, seconds, minutes, hours (note 12).
    pub(super) fn curve(self) -> [u8; 6] {
        let [_, year] = split(self.year);
        [
            self.day,
            self.month,
            year,
            self.second,
            self.minute,
            self.hour,
        ]
        .map(bcd)
    }

    /// Reads the four words of date and time; `None` if they hold none.
    pub(super) fn read(words: [u16; 4]) -> Option<Self> {
        let [d, y, h, m] = words.map(u16::to_be_bytes);
        let [day, month] = [from_bcd(d[0])?, from_bcd(d[1])?];
        let century = u16::from(from_bcd(y[0])?);
        Some(Self {
            year: century
                .saturating_mul(100)
                .saturating_add(from_bcd(y[1])?.into()),
            month,
            day,
            hour: from_bcd(h[1])?,
            minute: from_bcd(m[0])?,
            second: from_bcd(m[1])?,
        })
    }
}

/// Seconds since 2000, as the log files count (section 8.11.1).
pub(super) fn since_2000(seconds: u64) -> u32 {
    u32::try_from(seconds.saturating_sub(Y2K)).unwrap_or(u32::MAX)
}

/// The two upper and the two lower digits of a year.
fn split(year: u16) -> [u8; 2] {
    let digits = |v: Option<u16>| v.and_then(|v| u8::try_from(v).ok()).unwrap_or(0);
    [digits(year.checked_div(100)), digits(year.checked_rem(100))]
}

/// Two decimal digits.
fn bcd(value: u8) -> u8 {
    let tens = value.checked_div(10).unwrap_or(0);
    let ones = value.checked_rem(10).unwrap_or(0);
    (tens << 4) | ones
}

fn from_bcd(byte: u8) -> Option<u8> {
    let (tens, ones) = (byte >> 4, byte & 0x0F);
    (tens < 10 && ones < 10).then(|| tens.saturating_mul(10).saturating_add(ones))
}
