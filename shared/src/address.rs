//! Where a value lives in a Modbus device: table and zero-based address.
//!
//! The wire carries **addresses** (zero-based); manuals print **numbers** (one-based, with a
//! leading digit for the table). Mixing the two shifts every value by one, so they are two types
//! with one conversion.

use core::fmt;

/// One of the four data areas of a Modbus device.
///
/// Source: Modbus Application Protocol V1.1b3, section 4.3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Table {
    /// Single bits, readable and writable (FC 01, 05, 15). Numbers begin with 0.
    Coil,
    /// Single bits, read-only (FC 02). Numbers begin with 1.
    Discrete,
    /// 16-bit words, read-only (FC 04). Numbers begin with 3.
    Input,
    /// 16-bit words, readable and writable (FC 03, 06, 16, 22, 23). Numbers begin with 4.
    Holding,
}

impl Table {
    /// All four, in the order in which maps are listed.
    pub const ALL: [Self; 4] = [Self::Coil, Self::Discrete, Self::Input, Self::Holding];

    /// The lower-case name used in paths, JSON and the map files: `holding`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Coil => "coil",
            Self::Discrete => "discrete",
            Self::Input => "input",
            Self::Holding => "holding",
        }
    }

    /// The name shown to people: `Holding register`.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Coil => "Coil",
            Self::Discrete => "Discrete input",
            Self::Input => "Input register",
            Self::Holding => "Holding register",
        }
    }

    /// The short name in sentences: `HR` of `HR 3010`.
    #[must_use]
    pub const fn short(self) -> &'static str {
        match self {
            Self::Coil => "coil",
            Self::Discrete => "DI",
            Self::Input => "IR",
            Self::Holding => "HR",
        }
    }

    /// 0 to 3, in the order in which maps are listed.
    pub(crate) const fn index(self) -> u32 {
        match self {
            Self::Coil => 0,
            Self::Discrete => 1,
            Self::Input => 2,
            Self::Holding => 3,
        }
    }

    /// The table with this [`key`](Self::key).
    #[must_use]
    pub fn from_key(key: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.key() == key)
    }

    /// True for coils and discrete inputs, whose items are single bits.
    #[must_use]
    pub const fn is_bits(self) -> bool {
        matches!(self, Self::Coil | Self::Discrete)
    }

    /// The leading digit of a register number: 0, 1, 3 or 4.
    const fn digit(self) -> u32 {
        match self {
            Self::Coil => 0,
            Self::Discrete => 1,
            Self::Input => 3,
            Self::Holding => 4,
        }
    }

    /// The function code that reads this table.
    #[must_use]
    pub const fn read_function(self) -> u8 {
        match self {
            Self::Coil => 1,
            Self::Discrete => 2,
            Self::Holding => 3,
            Self::Input => 4,
        }
    }

    /// The table that a read function code (01 to 04) reads.
    #[must_use]
    pub const fn of_read_function(function: u8) -> Option<Self> {
        match function {
            1 => Some(Self::Coil),
            2 => Some(Self::Discrete),
            3 => Some(Self::Holding),
            4 => Some(Self::Input),
            _ => None,
        }
    }

    /// The largest quantity that one read request may ask for.
    ///
    /// Source: Modbus Application Protocol V1.1b3, sections 6.1 to 6.4.
    #[must_use]
    pub const fn max_read(self) -> u16 {
        if self.is_bits() { 2000 } else { 125 }
    }
}

/// A zero-based address as it travels on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Address(u16);

impl Address {
    /// Wraps an address as it stands in a PDU.
    #[must_use]
    pub const fn new(wire: u16) -> Self {
        Self(wire)
    }

    /// The value that goes into a PDU.
    #[must_use]
    pub const fn get(self) -> u16 {
        self.0
    }

    /// The address `by` further on, or `None` beyond 65535.
    #[must_use]
    pub fn checked_add(self, by: u16) -> Option<Self> {
        self.0.checked_add(by).map(Self)
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// A one-based register number with its table digit, as manuals and engineering tools print it.
///
/// The six-digit form is canonical (`403005` is holding register address 3004); the older
/// five-digit form (`43005`) is understood too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RegisterNumber(u32);

impl RegisterNumber {
    /// Wraps a printed number. Use [`resolve`](Self::resolve) to learn whether it means anything.
    #[must_use]
    pub const fn new(printed: u32) -> Self {
        Self(printed)
    }

    /// The canonical six-digit number of an address.
    #[must_use]
    pub fn of(table: Table, address: Address) -> Self {
        let base = table.digit().saturating_mul(100_000);
        Self(
            base.saturating_add(u32::from(address.get()))
                .saturating_add(1),
        )
    }

    /// The printed number.
    #[must_use]
    pub const fn get(self) -> u32 {
        self.0
    }

    /// Table and address behind a number, `None` where no table has it.
    ///
    /// `403005` and `43005` are both holding register address 3004. Coils have no leading digit,
    /// so `1` is coil address 0; coils above 9999 can't be told from five-digit numbers of other
    /// tables and are not resolved. `40000` is nothing: numbers begin with 1.
    #[must_use]
    pub fn resolve(self) -> Option<(Table, Address)> {
        for (unit, last) in [(10_000, 9_999), (100_000, 65_536)] {
            for table in Table::ALL {
                if table == Table::Coil && last > 9_999 {
                    continue;
                }
                let base = table.digit().saturating_mul(unit);
                let Some(one_based) = self.0.checked_sub(base) else {
                    continue;
                };
                if (1..=last).contains(&one_based) {
                    return Some((
                        table,
                        Address(u16::try_from(one_based.checked_sub(1)?).ok()?),
                    ));
                }
            }
        }
        None
    }
}

impl fmt::Display for RegisterNumber {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:06}", self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_resolve_in_both_lengths() {
        let at = |n| RegisterNumber::new(n).resolve();
        assert_eq!(at(403_005), Some((Table::Holding, Address(3004))));
        assert_eq!(at(43_005), Some((Table::Holding, Address(3004))));
        assert_eq!(at(30_001), Some((Table::Input, Address(0))));
        assert_eq!(at(10_129), Some((Table::Discrete, Address(128))));
        assert_eq!(at(1), Some((Table::Coil, Address(0))));
        assert_eq!(at(465_536), Some((Table::Holding, Address(65_535))));
        assert_eq!(at(465_537), None);
        assert_eq!(at(0), None);
    }

    #[test]
    fn the_canonical_number_comes_back() {
        for table in Table::ALL {
            for wire in [0, 1, 3004, 9998, 9999, 65_535] {
                if table == Table::Coil && wire > 9998 {
                    continue;
                }
                let number = RegisterNumber::of(table, Address(wire));
                assert_eq!(number.resolve(), Some((table, Address(wire))), "{number}");
            }
        }
        assert_eq!(
            RegisterNumber::of(Table::Holding, Address(3004)).to_string(),
            "403005"
        );
    }
}
