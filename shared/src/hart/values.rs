//! Values as HART writes them: packed ASCII, floats, times.

use crate::scale::Scale;

/// Characters of packed ASCII: six bits each, four in three bytes; what is left over is dropped.
#[must_use]
pub fn unpack(bytes: &[u8]) -> String {
    let mut text = String::new();
    for &[a, b, c] in bytes.as_chunks::<3>().0 {
        let word = u32::from_be_bytes([0, a, b, c]);
        for shift in [18, 12, 6, 0] {
            let code = u8::try_from(word.wrapping_shr(shift) & 0x3F).unwrap_or(0);
            let character = if code < 0x20 { code | 0x40 } else { code };
            text.push(char::from(character));
        }
    }
    text
}

/// Text as packed ASCII, padded with blanks to a multiple of four characters; what it can't say
/// becomes a question mark.
#[must_use]
pub fn pack(text: &str) -> Vec<u8> {
    let mut codes: Vec<u8> = text
        .chars()
        .map(|c| c.to_ascii_uppercase())
        .map(|c| u8::try_from(c).unwrap_or(b'?'))
        .map(|c| {
            if (0x20..0x60).contains(&c) {
                c & 0x3F
            } else {
                b'?'
            }
        })
        .collect();
    codes.resize(codes.len().next_multiple_of(4), 0x20);
    let mut bytes = Vec::new();
    for &[a, b, c, d] in codes.as_chunks::<4>().0 {
        let word = [a, b, c, d]
            .iter()
            .fold(0_u32, |word, code| word << 6 | u32::from(*code));
        let [_, x, y, z] = word.to_be_bytes();
        bytes.extend([x, y, z]);
    }
    bytes
}

/// What four bytes of a float say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Real {
    /// Exactly this decimal number.
    Number(i64, Scale),
    /// No value.
    Missing,
    /// A number that is too large or too small to be written out, or infinite.
    Far,
}

/// Reads a float without losing anything: the shortest decimal number that means these bits.
#[must_use]
pub fn real(bits: u32) -> Real {
    let value = f32::from_bits(bits);
    if value.is_nan() {
        return Real::Missing;
    }
    let text = value.to_string();
    let (whole, part) = text.split_once('.').unwrap_or((&text, ""));
    // A factor of 10^-9 is the smallest that a scale can say.
    let digits = format!("{whole}{part}");
    match (digits.parse(), u8::try_from(part.len())) {
        (Ok(raw), Ok(decimals)) if decimals <= 9 => {
            let den = 10_u32.saturating_pow(u32::from(decimals));
            Real::Number(raw, Scale::new(1, den, decimals))
        }
        _ => Real::Far,
    }
}

/// True for a day that exists; the year counts from 1900.
#[must_use]
pub const fn is_date(day: u8, month: u8, year: u8) -> bool {
    let last = match month {
        // 1900 had no 29 February, 2000 had one, and 2100 has none.
        2 if year.is_multiple_of(4) && year != 0 && year != 200 => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => 0,
    };
    day >= 1 && day <= last
}

/// A time of 1/32 ms in words: `15:17:29.482`, with days in front where it has any.
#[must_use]
pub fn clock(ticks: u32) -> String {
    let millis = ticks / 32;
    let seconds = millis / 1000;
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    let text = format!(
        "{:02}:{minutes:02}:{:02}.{:03}",
        hours % 24,
        seconds % 60,
        millis % 1000
    );
    match hours / 24 {
        0 => text,
        1 => format!("1 day {text}"),
        days => format!("{days} days {text}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_ascii_has_six_bits() {
        // VALVE-01, worked out bit by bit.
        let packed = [0x58, 0x13, 0x16, 0x16, 0xDC, 0x31];
        assert_eq!(unpack(&packed), "VALVE-01");
        assert_eq!(pack("valve-01"), packed);
        assert_eq!(unpack(&[0; 3]), "@@@@");
        assert!(pack("").is_empty());
        assert_eq!(pack("A"), [0x06, 0x08, 0x20], "000001 100000 100000 100000");
        assert_eq!(
            pack(&" ".repeat(8)),
            [0x82, 0x08, 0x20, 0x82, 0x08, 0x20],
            "eight blanks"
        );
    }

    #[test]
    fn floats_are_exact_or_said_to_be_none() {
        let number = |bits| match real(bits) {
            Real::Number(raw, scale) => scale.apply(raw).to_string(),
            other => format!("{other:?}"),
        };
        assert_eq!(number(0x41C8_0000), "25");
        assert_eq!(number(0x4246_0000), "49.5");
        assert_eq!(number(0xC060_0000), "-3.5");
        assert_eq!(number(0xBF00_0000), "-0.5");
        assert_eq!(number(0), "0");
        assert_eq!(number(0x3DCC_CCCD), "0.1");
        assert_eq!(real(0x7FA0_0000), Real::Missing);
        assert_eq!(real(0xFFC0_0000), Real::Missing);
        assert_eq!(real(0x7F80_0000), Real::Far, "infinite");
        assert_eq!(real(0x0000_0001), Real::Far, "1e-45");
    }

    #[test]
    fn dates_follow_the_calendar() {
        for (day, month, year) in [
            (31, 1, 0),
            (28, 2, 0),
            (29, 2, 100),
            (29, 2, 124),
            (30, 4, 124),
            (31, 12, 255),
        ] {
            assert!(is_date(day, month, year), "{day}.{month}.{year}");
        }
        // 1900 and 2100 are no leap years.
        for (day, month, year) in [
            (0, 1, 124),
            (32, 1, 124),
            (29, 2, 0),
            (29, 2, 200),
            (29, 2, 123),
            (30, 2, 124),
            (31, 2, 124),
            (31, 4, 124),
            (31, 6, 124),
            (31, 9, 124),
            (31, 11, 124),
            (1, 0, 124),
            (1, 13, 124),
        ] {
            assert!(!is_date(day, month, year), "{day}.{month}.{year}");
        }
    }

    #[test]
    fn times_roll_over_after_a_day() {
        // 68FF6500h counts of 1/32 ms are 55049 s.
        assert_eq!(clock(0x68FF_6500), "15:17:29.000");
        assert_eq!(clock(0), "00:00:00.000");
        assert_eq!(clock(0xA4CB_8000), "1 day 00:00:00.000");
    }
}
