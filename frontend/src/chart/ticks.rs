//! Ranges and ticks at round numbers. Ticks are counted in whole steps, so their texts are exact.

/// A mark on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Where it stands.
    pub at: f64,
    /// What is written beside it.
    pub text: String,
}

impl Tick {
    /// A tick at a whole number.
    #[must_use]
    #[expect(
        clippy::cast_precision_loss,
        reason = "ticks of a screen, not of a ledger"
    )]
    pub fn new(at: i64, text: String) -> Self {
        Self {
            at: at as f64,
            text,
        }
    }
}

/// The numbers from 0 in the order that `before` says; equal ones stay as they were. One small sort
/// for all: the general ones would be compiled anew for each list.
#[must_use]
pub fn ordered(count: usize, before: &dyn Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut order: Vec<usize> = Vec::with_capacity(count);
    for at in 0..count {
        let place = order.partition_point(|&other| !before(at, other));
        order.insert(place, at);
    }
    order
}

/// A step of 1, 2 or 5 times a power of ten.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    mantissa: i64,
    exponent: i32,
}

/// Exponents beyond which no axis goes.
const EXPONENTS: core::ops::RangeInclusive<i32> = -9..=18;

impl Step {
    /// The smallest step that divides `span` into at most `most` parts.
    #[must_use]
    pub fn of(span: f64, most: usize) -> Self {
        let parts = u32::try_from(most.max(1)).map_or(1.0, f64::from);
        for exponent in EXPONENTS {
            for mantissa in [1, 2, 5] {
                let step = Self { mantissa, exponent };
                // A hair of tolerance: 0.3 in parts of 0.1 are three.
                if span / step.size() <= parts + 1e-9 {
                    return step;
                }
            }
        }
        Self {
            mantissa: 5,
            exponent: *EXPONENTS.end(),
        }
    }

    /// Its size.
    #[must_use]
    pub fn size(self) -> f64 {
        self.place(1)
    }

    /// Where its multiple stands.
    #[must_use]
    #[expect(
        clippy::cast_precision_loss,
        reason = "ticks of a screen, not of a ledger"
    )]
    fn place(self, multiple: i64) -> f64 {
        let counts = multiple.saturating_mul(self.mantissa) as f64;
        if self.exponent < 0 {
            // Division rounds once; a factor of 0.1 would round twice.
            counts / 10_f64.powi(-self.exponent)
        } else {
            counts * 10_f64.powi(self.exponent)
        }
    }

    /// Its multiple as decimal text with blanks between thousands.
    #[must_use]
    fn text(self, multiple: i64) -> String {
        let counts = multiple.saturating_mul(self.mantissa);
        let sign = if counts < 0 { "\u{2212}" } else { "" };
        let counts = counts.unsigned_abs();
        match u32::try_from(-self.exponent) {
            Ok(0) => format!("{sign}{}", crate::format::thousands(counts)),
            Ok(decimals) => {
                let ten = 10_u64.pow(decimals);
                let width = usize::try_from(decimals).unwrap_or(1);
                let whole = crate::format::thousands(counts / ten);
                format!("{sign}{whole}.{:0width$}", counts % ten)
            }
            Err(_) => {
                let ten = 10_u64.saturating_pow(self.exponent.unsigned_abs());
                format!(
                    "{sign}{}",
                    crate::format::thousands(counts.saturating_mul(ten))
                )
            }
        }
    }

    #[expect(
        clippy::cast_possible_truncation,
        reason = "multiples of a step on a screen"
    )]
    fn floor(self, value: f64) -> i64 {
        let parts = value / self.size();
        (parts + 1e-9).floor() as i64
    }

    fn ceil(self, value: f64) -> i64 {
        -self.floor(-value)
    }
}

/// Ticks between two numbers, at most `most + 1` of them.
#[must_use]
pub fn ticks(low: f64, high: f64, most: usize) -> Vec<Tick> {
    let step = Step::of((high - low).max(0.0), most);
    (step.ceil(low)..=step.floor(high))
        .map(|multiple| Tick {
            at: step.place(multiple),
            text: step.text(multiple),
        })
        .collect()
}

/// A range that begins and ends at a tick and holds all values; bars stand on zero.
#[must_use]
pub fn range(values: impl Iterator<Item = f64>, from_zero: bool, most: usize) -> (f64, f64) {
    let start = from_zero.then_some((0.0, 0.0));
    let found = values.fold(start, |range, v| {
        let (low, high) = range.unwrap_or((v, v));
        Some((low.min(v), high.max(v)))
    });
    let Some((mut low, mut high)) = found else {
        return (0.0, 1.0);
    };
    // Little that is far from zero gets an axis of its own; what is near it stands on it.
    if low > 0.0 && low < high / 2.0 {
        low = 0.0;
    }
    if high < 0.0 && high > low / 2.0 {
        high = 0.0;
    }
    if high - low < 1e-9 {
        let half = if low == 0.0 { 1.0 } else { low.abs() / 10.0 };
        low -= if from_zero { 0.0 } else { half };
        high += half;
    }
    let step = Step::of(high - low, most);
    (step.place(step.floor(low)), step.place(step.ceil(high)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(low: f64, high: f64, most: usize) -> Vec<String> {
        ticks(low, high, most).into_iter().map(|t| t.text).collect()
    }

    #[test]
    fn ticks_are_round_and_exact() {
        assert_eq!(texts(0.0, 100.0, 5), ["0", "20", "40", "60", "80", "100"]);
        assert_eq!(texts(-3.2, 3.2, 4), ["\u{2212}2", "0", "2"]);
        assert_eq!(texts(0.0, 0.3, 3), ["0.0", "0.1", "0.2", "0.3"]);
        assert_eq!(
            texts(0.0005, 0.0012, 4),
            ["0.0006", "0.0008", "0.0010", "0.0012"]
        );
        assert_eq!(
            texts(0.0, 40_000.0, 2),
            ["0", "20\u{2009}000", "40\u{2009}000"]
        );
        let at: Vec<_> = ticks(0.0, 0.3, 3).iter().map(|t| t.at).collect();
        assert_eq!(at, [0.0, 0.1, 0.2, 0.3]);
    }

    #[test]
    fn ranges_begin_and_end_at_a_tick() {
        let range = |values: &[f64], zero| range(values.iter().copied(), zero, 5);
        // Parts of 10: 37 to 81 is within 30 and 90; it is nearer to zero than half of 81.
        assert_eq!(range(&[37.0, 81.0], false), (0.0, 100.0));
        assert_eq!(range(&[61.0, 81.0], false), (60.0, 85.0));
        assert_eq!(range(&[-12.0, 7.0], false), (-15.0, 10.0));
        assert_eq!(range(&[950.0], true), (0.0, 1000.0));
        assert_eq!(range(&[-61.0, -81.0], false), (-85.0, -60.0));
        assert_eq!(range(&[], false), (0.0, 1.0));
        assert_eq!(range(&[0.0, 0.0], true), (0.0, 1.0));
        // All the same: a tenth to each side.
        assert_eq!(range(&[50.0, 50.0], false), (44.0, 56.0));
    }

    #[test]
    fn numbers_are_ordered() {
        let values = [3, 1, 2, 1];
        let order = ordered(4, &|a, b| values[a] < values[b]);
        assert_eq!(order, [1, 3, 2, 0]);
        assert!(ordered(0, &|_, _| true).is_empty());
    }

    #[test]
    fn extremes_do_not_overflow() {
        for (low, high) in [(0.0, 9e18), (-9e18, 9e18), (0.0, 1e-12), (5.0, 5.0)] {
            assert!(ticks(low, high, 6).len() < 12, "{low} {high}");
        }
    }
}
