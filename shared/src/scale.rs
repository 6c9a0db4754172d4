//! Exact scales: engineering value = raw × num / den, written in decimals without binary rounding.

use core::fmt;

/// A positive rational factor with the number of decimals that it needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    num: u32,
    den: u32,
    decimals: u8,
}

impl Scale {
    /// Raw counts are the value.
    pub const ONE: Self = Self {
        num: 1,
        den: 1,
        decimals: 0,
    };
    /// One count is a tenth.
    pub const TENTH: Self = Self {
        num: 1,
        den: 10,
        decimals: 1,
    };
    /// One count is a hundredth.
    pub const HUNDREDTH: Self = Self {
        num: 1,
        den: 100,
        decimals: 2,
    };

    /// `num / den`, shown with `decimals` digits after the point. A zero denominator counts as 1.
    #[must_use]
    pub const fn new(num: u32, den: u32, decimals: u8) -> Self {
        Self {
            num,
            den: if den == 0 { 1 } else { den },
            decimals,
        }
    }

    /// Numerator of the factor.
    #[must_use]
    pub const fn num(self) -> u32 {
        self.num
    }

    /// Denominator of the factor, never 0.
    #[must_use]
    pub const fn den(self) -> u32 {
        self.den
    }

    /// True if raw counts are the value.
    #[must_use]
    pub const fn is_one(self) -> bool {
        self.num == self.den
    }

    /// The scaled value as decimal text, rounded half away from zero where the factor is no
    /// decimal fraction: `240` at a tenth is `24.0`.
    #[must_use]
    pub const fn apply(self, raw: i64) -> Decimal {
        Decimal { raw, scale: self }
    }

    /// The scaled value as a float, for plots.
    #[must_use]
    pub fn to_f64(self, raw: i64) -> f64 {
        // Registers are at most 32 bits wide, so the split is exact.
        let high = i32::try_from(raw >> 31).unwrap_or(0);
        let low = u32::try_from(raw & 0x7FFF_FFFF).unwrap_or(0);
        (f64::from(high) * 2_147_483_648.0 + f64::from(low)) * f64::from(self.num)
            / f64::from(self.den)
    }
}

impl fmt::Display for Scale {
    /// The factor itself: `1`, `0.1`, or as a fraction where it has no short decimal form.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut den = self.den;
        while den.is_multiple_of(10) {
            den = den.checked_div(10).unwrap_or(1);
        }
        if den == 1 {
            let digits = self.den.checked_ilog10().unwrap_or(0);
            let exact = Self {
                decimals: u8::try_from(digits).unwrap_or(0),
                num: 1,
                den: self.den,
            };
            return exact.apply(i64::from(self.num)).fmt(f);
        }
        write!(f, "{}/{}", self.num, self.den)
    }
}

/// A scaled number that prints itself as a decimal. See [`Scale::apply`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Decimal {
    raw: i64,
    scale: Scale,
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let places = u32::from(self.scale.decimals).min(9);
        let ten = 10_u128.pow(places);
        let magnitude = u128::from(self.raw.unsigned_abs())
            .saturating_mul(u128::from(self.scale.num))
            .saturating_mul(ten);
        let den = u128::from(self.scale.den.max(1));
        let half = den / 2;
        let rounded = magnitude.saturating_add(half).checked_div(den).unwrap_or(0);
        if self.raw < 0 && rounded != 0 {
            f.write_str("-")?;
        }
        let whole = rounded.checked_div(ten).unwrap_or(0);
        let fraction = rounded.checked_rem(ten).unwrap_or(0);
        if places == 0 {
            write!(f, "{whole}")
        } else {
            write!(
                f,
                "{whole}.{fraction:0width$}",
                width = usize::from(self.scale.decimals.min(9))
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_exact() {
        let check = |scale: Scale, raw, expected: &str| {
            assert_eq!(scale.apply(raw).to_string(), expected);
        };
        check(Scale::TENTH, 240, "24.0");
        check(Scale::TENTH, -5, "-0.5");
        check(Scale::TENTH, 0, "0.0");
        check(Scale::HUNDREDTH, 65_535, "655.35");
        check(Scale::ONE, -127, "-127");
        check(Scale::new(100, 4095, 2), 4095, "100.00");
        check(Scale::new(100, 4095, 2), 1, "0.02");
        check(Scale::new(100, 4095, 2), -0, "0.00");
        assert!((Scale::TENTH.to_f64(-15) + 1.5).abs() < 1e-12);
    }

    #[test]
    fn the_factor_prints_short() {
        assert_eq!(Scale::ONE.to_string(), "1");
        assert_eq!(Scale::TENTH.to_string(), "0.1");
        assert_eq!(Scale::HUNDREDTH.to_string(), "0.01");
        assert_eq!(Scale::new(5, 1000, 3).to_string(), "0.005");
        assert_eq!(Scale::new(100, 4095, 2).to_string(), "100/4095");
    }
}
