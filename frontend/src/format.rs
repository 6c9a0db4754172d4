//! Numbers, ages and sizes in words. Pure, so tested natively.

/// A number kept between two bounds. The one of the standard library can fail for bounds in the wrong
/// order, and brings the printing of floating point along to say so: three kilobytes of the page.
#[must_use]
pub fn within(number: f64, low: f64, high: f64) -> f64 {
    number.max(low).min(high)
}

/// A count with thin blanks between thousands: `1 234 567`.
#[must_use]
pub fn thousands(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3 * 3);
    for (at, c) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push('\u{2009}');
        }
        text.push(c);
    }
    text
}

/// A count with its noun: `1 frame`, `2 frames`.
#[must_use]
pub fn count(n: u64, noun: &str) -> String {
    let s = if n == 1 { "" } else { "s" };
    format!("{} {noun}{s}", thousands(n))
}

/// A size: `812 bytes`, `12.3 kB`, `100.0 MB`.
#[must_use]
pub fn size(bytes: u64) -> String {
    let tenths = |unit: u64| format!("{}.{}", bytes / unit, bytes % unit * 10 / unit);
    match bytes {
        0..10_000 => count(bytes, "byte"),
        10_000..1_000_000 => format!("{} kB", tenths(1000)),
        _ => format!("{} MB", tenths(1_000_000)),
    }
}

/// A duration at a glance: `0.4 s`, `12 s`, `3 min`, `2 h`, `5 d`.
#[must_use]
pub fn age(micros: u64) -> String {
    let seconds = micros / 1_000_000;
    match seconds {
        0..10 => format!("{}.{} s", seconds, micros % 1_000_000 / 100_000),
        10..120 => format!("{seconds} s"),
        120..7200 => format!("{} min", seconds / 60),
        7200..172_800 => format!("{} h", seconds / 3600),
        _ => format!("{} d", seconds / 86_400),
    }
}

/// A short duration in milliseconds: `12.4 ms`.
#[must_use]
pub fn millis(micros: u64) -> String {
    format!("{}.{} ms", micros / 1000, micros % 1000 / 100)
}

/// Time of day, `14:03:07.250`, from milliseconds since 1970 and the offset of local time.
#[must_use]
pub fn clock(wall_ms: u64, offset_minutes: i32) -> String {
    let offset = i64::from(offset_minutes) * 60_000;
    let local = wall_ms.saturating_add_signed(offset) % 86_400_000;
    format!(
        "{:02}:{:02}:{:02}.{:03}",
        local / 3_600_000,
        local / 60_000 % 60,
        local / 1000 % 60,
        local % 1000
    )
}

/// The same without milliseconds.
#[must_use]
pub fn clock_seconds(wall_ms: u64, offset_minutes: i32) -> String {
    let mut text = clock(wall_ms, offset_minutes);
    text.truncate(8);
    text
}

/// Text for a query of a link: everything but letters, digits and a few signs as `%XX`.
#[must_use]
pub fn encode(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_' | b'.' | b'~') {
            out.push(char::from(byte));
        } else {
            out.push_str(&format!("%{byte:02X}"));
        }
    }
    out
}

/// The reverse of [`encode`]; a plus is a blank, and broken escapes stay as they are.
#[must_use]
pub fn decode(text: &str) -> String {
    let mut out = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((first, tail)) = rest.split_first() {
        let escaped = (*first == b'%').then_some(tail).and_then(|tail| {
            let digits = std::str::from_utf8(tail.get(..2)?).ok()?;
            u8::from_str_radix(digits, 16).ok()
        });
        match escaped {
            Some(byte) => {
                out.push(byte);
                rest = tail.get(2..).unwrap_or(&[]);
            }
            None => {
                out.push(if *first == b'+' { b' ' } else { *first });
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_grouped() {
        assert_eq!(thousands(7), "7");
        assert_eq!(thousands(1_234_567), "1\u{2009}234\u{2009}567");
        assert_eq!(count(1, "frame"), "1 frame");
        assert_eq!(count(0, "frame"), "0 frames");
    }

    #[test]
    fn sizes_and_times_are_short() {
        assert_eq!(size(812), "812 bytes");
        assert_eq!(size(12_345), "12.3 kB");
        assert_eq!(size(100_000_000), "100.0 MB");
        assert_eq!(age(420_000), "0.4 s");
        assert_eq!(age(61_000_000), "61 s");
        assert_eq!(age(200_000_000), "3 min");
        assert_eq!(age(9_000_000_000), "2 h");
        assert_eq!(millis(12_449), "12.4 ms");
        assert_eq!(clock(3_723_250, 60), "02:02:03.250");
        assert_eq!(clock_seconds(86_400_000, -60), "23:00:00");
    }

    #[test]
    fn links_survive() {
        for text in ["XV 101/ä?&=#", "100%", "a+b"] {
            assert_eq!(decode(&encode(text)), text);
        }
        assert_eq!(decode("a+b%2"), "a b%2");
    }
}
