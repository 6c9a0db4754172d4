//! Tables 4.1 and 4.2 of the guide, as printed: RTU, 9600 baud, 8N1, function 03, without the turn
//! time of the host.

use crate::device::Device;

/// A line of table 4.1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ResponseTime {
    /// Registers that were read.
    pub registers: u16,
    /// Query and answer of an MX/DDC, in microseconds.
    pub mx_us: u64,
    /// Query and answer of a UEC-3-DDC, in microseconds.
    pub uec_us: u64,
    /// Page of the guide.
    pub page: u16,
}

/// A time as printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Printed {
    /// In seconds, with its digits: `.40`.
    pub text: &'static str,
    /// In microseconds.
    pub us: u64,
    /// Half a unit of its last digit, in microseconds.
    pub rounding_us: u64,
}

/// Two cells of table 4.2.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanTime {
    /// Units of the network.
    pub units: u16,
    /// Registers that were read of each.
    pub registers: u16,
    /// With MX/DDC.
    pub mx: Printed,
    /// With UEC-3-DDC.
    pub uec: Printed,
    /// Page of the guide.
    pub page: u16,
}

include!(concat!(env!("OUT_DIR"), "/ddc100.rs"));

/// True for the types that answer as fast as an MX/DDC. Those that the tables do not name count as
/// the slower UEC-3-DDC, whose electronics they share.
#[must_use]
pub const fn is_fast(kind: Device) -> bool {
    matches!(kind, Device::Ddc100Mx | Device::Ddc100MxB)
}

/// True for the types that the tables name.
#[must_use]
pub const fn is_printed(kind: Device) -> bool {
    matches!(kind, Device::Ddc100Mx | Device::Ddc100Uec)
}

impl ResponseTime {
    /// That of a type.
    #[must_use]
    pub const fn of(&self, kind: Device) -> u64 {
        if is_fast(kind) {
            self.mx_us
        } else {
            self.uec_us
        }
    }
}

impl ScanTime {
    /// That of a type.
    #[must_use]
    pub const fn of(&self, kind: Device) -> Printed {
        if is_fast(kind) { self.mx } else { self.uec }
    }
}

/// What table 4.2 prints for so many units and registers.
#[must_use]
pub fn printed(kind: Device, units: u16, registers: u16) -> Option<Printed> {
    let cell = |s: &&ScanTime| s.units == units && s.registers == registers;
    SCAN_TIMES.iter().find(cell).map(|s| s.of(kind))
}

/// The cell of table 4.2 that is nearest to so many units and registers without being below either;
/// `None` beyond the table.
#[must_use]
pub fn nearest(units: u16, registers: u16) -> Option<&'static ScanTime> {
    let above = |s: &&ScanTime| s.units >= units && s.registers >= registers;
    let all = SCAN_TIMES.iter().filter(above);
    all.min_by_key(|s| (s.units, s.registers))
}
