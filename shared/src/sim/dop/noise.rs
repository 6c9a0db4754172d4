//! Numbers that look like measurements and are the same each time.

/// A number that looks random and is always the same, from 0 to `below` - 1.
pub(super) fn noise(seed: i64, number: i64, below: i64) -> i64 {
    let mut x = seed.wrapping_mul(0x9E37_79B9).wrapping_add(number);
    x = (x ^ (x >> 29)).wrapping_mul(0x3F4B_62A5_9C1D_8E71);
    x = (x ^ (x >> 31)).wrapping_mul(0x0519_2E6B_77D3_4A95);
    (x ^ (x >> 30)).checked_rem_euclid(below).unwrap_or(0)
}

/// A triangle from 0 to `height` and back.
pub(super) fn wave(at: i64, period: i64, height: i64) -> i64 {
    let phase = at.checked_rem_euclid(period).unwrap_or(0);
    let half = period >> 1;
    let up = if phase < half {
        phase
    } else {
        period.saturating_sub(phase)
    };
    up.saturating_mul(height).checked_div(half).unwrap_or(0)
}
