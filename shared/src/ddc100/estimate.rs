//! How long a scan takes: by table 4.1 and the turn time of the host, and what the wire alone needs.

use super::setup::Setup;
use super::tables::{self, Printed, RESPONSE_TIMES, SCAN_TIMES};
use super::timing::{Line, items, thinks};
use crate::address::{Address, Table};
use crate::device::Device;
use crate::encode::Read;

/// On what an estimate rests, from firm to bold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Basis {
    /// A line of table 4.1.
    Printed,
    /// Between or beyond the lines of table 4.1, along a straight line.
    Interpolated,
    /// Another line than that of the table: characters by the line, the unit's own part by the table.
    OtherLine,
    /// A type that the table does not name, taken for a UEC-3-DDC or MX/DDC.
    OtherType,
}

impl Basis {
    /// In words.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Printed => "table 4.1",
            Self::Interpolated => "table 4.1, between or beyond its lines",
            Self::OtherLine => "table 4.1 for the unit, characters by this line",
            Self::OtherType => "table 4.1 of the nearest type; the guide has none for this one",
        }
    }
}

/// The estimate for units of one type. All times in microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Estimate {
    /// Type of the units.
    pub kind: Device,
    /// How many.
    pub units: u16,
    /// Registers that are read of each.
    pub registers: u16,
    /// Query and answer of one unit, without turn time.
    pub exchange_us: u64,
    /// On what that rests.
    pub basis: Basis,
    /// The whole scan: units times exchange and turn time.
    pub scan_us: u64,
    /// The same without turn time, to compare with table 4.2.
    pub bare_us: u64,
    /// The least that one exchange can take: its characters and two silences.
    pub least_us: u64,
    /// The same for the whole scan.
    pub least_scan_us: u64,
    /// What table 4.2 prints, if it has a line for it.
    pub printed: Option<Printed>,
}

/// Estimates the scan of a network of one type.
///
/// `turn_us` is the turn time of the host. `None` if so many registers can't be read at once.
#[must_use]
pub fn estimate(
    kind: Device,
    units: u16,
    registers: u16,
    line: Line,
    turn_us: u64,
) -> Option<Estimate> {
    let read = Read::new(Table::Holding, Address::new(0), registers)?;
    let wire = line.exchange(&read);
    let exchange_us = wire.saturating_add(thinks(kind, registers));
    let least_us = wire.saturating_add(line.gap().saturating_mul(2));
    let in_table = RESPONSE_TIMES.iter().any(|r| r.registers == registers);
    let basis = if !tables::is_printed(kind) {
        Basis::OtherType
    } else if line != Line::GUIDE {
        Basis::OtherLine
    } else if in_table {
        Basis::Printed
    } else {
        Basis::Interpolated
    };
    let all = |us: u64| us.saturating_mul(units.into());
    Some(Estimate {
        kind,
        units,
        registers,
        exchange_us,
        basis,
        scan_us: all(exchange_us.saturating_add(turn_us)),
        bare_us: all(exchange_us),
        least_us,
        least_scan_us: all(least_us),
        printed: tables::printed(kind, units, registers)
            .filter(|_| line == Line::GUIDE && tables::is_printed(kind)),
    })
}

/// Estimates a pass over a network as it is set up, in microseconds.
#[must_use]
pub fn pass(setup: &Setup) -> u64 {
    let wire = setup.line.exchange(&setup.read);
    let registers = items(&setup.read);
    let each = setup.units.iter().map(|member| {
        wire.saturating_add(thinks(member.kind, registers))
            .saturating_add(setup.turn_us)
    });
    // After the last one nothing is waited for.
    each.sum::<u64>().saturating_sub(setup.turn_us)
}

/// The least that a pass over a network can take, in microseconds: characters and silences only.
#[must_use]
pub fn least(setup: &Setup) -> u64 {
    let gaps = setup.line.gap().saturating_mul(2);
    let each = setup.line.exchange(&setup.read).saturating_add(gaps);
    let units = u64::try_from(setup.units.len()).unwrap_or(u64::MAX);
    each.saturating_mul(units)
}

/// A cell of table 4.2 beside what table 4.1 makes of it (reading D23).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Compared {
    /// Type of the units.
    pub kind: Device,
    /// How many.
    pub units: u16,
    /// Registers of each.
    pub registers: u16,
    /// What is printed.
    pub printed: Printed,
    /// That by the unit, in microseconds.
    pub each_us: u64,
    /// Table 4.1, in microseconds.
    pub response_us: u64,
}

impl Compared {
    /// Printed scan time in percent of the units times table 4.1, rounded down.
    #[must_use]
    pub fn percent(&self) -> u64 {
        self.each_us
            .saturating_mul(100)
            .checked_div(self.response_us)
            .unwrap_or(0)
    }

    /// True if the print is less than the units times table 4.1, by more than its rounding.
    #[must_use]
    pub fn is_too_short(&self) -> bool {
        let bare = self.response_us.saturating_mul(self.units.into());
        self.printed.us.saturating_add(self.printed.rounding_us) < bare
    }
}

/// All cells of table 4.2 for a type beside table 4.1.
#[must_use]
pub fn compared(kind: Device) -> Vec<Compared> {
    let cells = SCAN_TIMES.iter().filter_map(|cell| {
        let response = RESPONSE_TIMES
            .iter()
            .find(|r| r.registers == cell.registers)?;
        let printed = cell.of(kind);
        Some(Compared {
            kind,
            units: cell.units,
            registers: cell.registers,
            printed,
            each_us: printed.us.checked_div(cell.units.into())?,
            response_us: response.of(kind),
        })
    });
    cells.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Framing;

    fn of(kind: Device, units: u16, registers: u16) -> Estimate {
        estimate(kind, units, registers, Line::GUIDE, 30_000).unwrap()
    }

    /// Section 4.3: 20 MX/DDC with 5 registers, and the turn time comes on top.
    #[test]
    fn the_example_of_the_guide() {
        let e = of(Device::Ddc100Mx, 20, 5);
        assert_eq!((e.exchange_us, e.basis), (50_000, Basis::Printed));
        assert_eq!((e.bare_us, e.scan_us), (1_000_000, 1_600_000));
        assert_eq!(e.printed.unwrap().text, ".98");
    }

    /// Wire times by hand: 8 and 5 + 2n characters of 10 bits at 9600 baud, and 3.5 characters.
    #[test]
    fn the_wire() {
        for (registers, wire, least) in [
            (1, 15_625, 22_917),
            (5, 23_958, 31_250),
            (10, 34_375, 41_667),
        ] {
            let read = Read::new(Table::Holding, Address::new(0), registers).unwrap();
            assert!(Line::GUIDE.exchange(&read).abs_diff(wire) <= 2);
            let e = of(Device::Ddc100Uec, 1, registers);
            assert!(e.least_us.abs_diff(least) <= 3, "{}", e.least_us);
            // ASCII: 17 and 11 + 4n.
            let ascii = Line {
                framing: Framing::Ascii,
                ..Line::GUIDE
            };
            assert_eq!(ascii.frame(5), 17);
            assert_eq!(
                ascii.frame(read.response_len()),
                11 + 4 * u64::from(registers)
            );
        }
    }

    /// Table 4.1 comes out as printed, to the microsecond, and grows in between.
    #[test]
    fn table_4_1() {
        for (registers, mx, uec) in [(1, 40, 71), (5, 50, 109), (10, 62, 162)] {
            assert_eq!(of(Device::Ddc100Mx, 1, registers).exchange_us, mx * 1000);
            assert_eq!(of(Device::Ddc100Uec, 1, registers).exchange_us, uec * 1000);
        }
        for kind in [Device::Ddc100Mx, Device::Ddc100Uec, Device::Ddc100Io] {
            for registers in 1..125 {
                let (a, b) = (of(kind, 1, registers), of(kind, 1, registers + 1));
                assert!(a.exchange_us < b.exchange_us);
            }
        }
        assert_eq!(of(Device::Ddc100Io, 1, 5).basis, Basis::OtherType);
        assert_eq!(of(Device::Ddc100Mx, 1, 9).basis, Basis::Interpolated);
        assert_eq!(estimate(Device::Ddc100Mx, 1, 126, Line::GUIDE, 0), None);
    }

    /// Reading D23: what does not fit within table 4.2, and between it and table 4.1.
    #[test]
    fn d23_table_4_2_contradicts() {
        let cell = |kind, units, registers| {
            let all = compared(kind);
            let found = all
                .into_iter()
                .find(|c| c.units == units && c.registers == registers);
            found.unwrap()
        };
        let mx = |units, registers| cell(Device::Ddc100Mx, units, registers).each_us;
        assert_eq!((mx(50, 10), mx(100, 10)), (76_000, 65_000));
        assert_eq!((mx(100, 5), mx(200, 5)), (60_000, 50_000));
        let uec = |units| cell(Device::Ddc100Uec, units, 1).each_us;
        assert_eq!((uec(10), uec(250)), (94_000, 128_000));
        let percents: Vec<u64> = compared(Device::Ddc100Uec)
            .iter()
            .map(Compared::percent)
            .collect();
        assert_eq!(
            (percents.iter().min(), percents.iter().max()),
            (Some(&117), Some(&180))
        );
        // Shorter than table 4.1 allows, as printed, and beyond its rounding.
        let short = |c: &Compared| c.each_us < c.response_us;
        let short: Vec<_> = compared(Device::Ddc100Mx)
            .into_iter()
            .filter(short)
            .collect();
        let which: Vec<_> = short
            .iter()
            .map(|c| (c.units, c.registers, c.printed.text))
            .collect();
        assert_eq!(which, [(10, 10, ".61"), (20, 5, ".98"), (250, 5, "12")]);
        let beyond: Vec<_> = short
            .iter()
            .filter(|c| c.is_too_short())
            .map(|c| c.units)
            .collect();
        assert_eq!(beyond, [10, 20]);
    }

    /// Reading D24: the time-outs that the guide's 200 ms would miss.
    #[test]
    fn d24_time_outs_grow() {
        use crate::ddc100::timing::timeout;
        let read = |n| Read::new(Table::Holding, Address::new(0), n).unwrap();
        let slow = Line {
            baud: 1200,
            ..Line::GUIDE
        };
        assert_eq!(slow.answer(&read(10)), 208_334, "25 characters");
        assert!(timeout(slow, Device::Ddc100Mx, &read(10), 0) >= 408_000);
        let long = timeout(Line::GUIDE, Device::Ddc100Uec, &read(56), 0);
        assert!(long >= 2 * thinks(Device::Ddc100Uec, 56) + 121_000);
        assert_eq!(
            timeout(Line::GUIDE, Device::Ddc100Mx, &read(1), 250_000),
            257_292
        );
    }

    /// Table 4.2 by hand: 24 units with 6 registers lie below 40 units with 10 registers.
    #[test]
    fn the_nearest_cell_is_not_below() {
        let of = |units, registers| {
            let cell = tables::nearest(units, registers)?;
            Some((cell.units, cell.registers, cell.mx.text, cell.uec.text))
        };
        assert_eq!(of(24, 6), Some((40, 10, "2.5", "7.6")));
        assert_eq!(of(10, 10), Some((10, 10, ".61", "1.9")));
        assert_eq!(of(250, 56), None);
    }
}
