//! The condensed status map (commands 523 to 527) and what a device makes of it: the NE 107
//! categories of the extended device status, and when it sets "more status available".

use super::PRESETS;
use super::model::Preset;
use crate::device::Family;

/// Entries that a Rotork actuator has: its device status, and seven bytes of command 48.
pub const ENTRIES: usize = 64;
/// Bytes of command 48 that hold alarms.
pub const ALARM_BYTES: u8 = 4;

/// Category of each status bit, by index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Map([u8; ENTRIES]);

impl Default for Map {
    /// No bit has an effect, as a Rotork actuator leaves the factory.
    fn default() -> Self {
        Self([0; ENTRIES])
    }
}

impl Map {
    /// Index of a bit of command 48, by byte and bit.
    ///
    /// Reading R21: 0 to 7 are the device status, then 8 + 8 × byte + bit.
    #[must_use]
    pub fn index(byte: u8, bit: u8) -> usize {
        let byte = usize::from(byte).saturating_add(1);
        byte.saturating_mul(8).saturating_add(usize::from(bit & 7))
    }

    /// Byte and bit of command 48 of an index; `None` for the device status.
    #[must_use]
    pub fn bit(index: usize) -> Option<(u8, u8)> {
        let byte = u8::try_from(index / 8).ok()?.checked_sub(1)?;
        Some((byte, u8::try_from(index % 8).ok()?))
    }

    /// An example of the manual.
    #[must_use]
    pub fn of(preset: &Preset) -> Self {
        let mut map = Self::default();
        for mapped in preset.bits {
            map.set(Self::index(mapped.byte, mapped.bit), mapped.category);
        }
        map
    }

    /// The example for this family, if the manual has one.
    #[must_use]
    pub fn example(family: Family) -> Option<Self> {
        PRESETS.iter().find(|p| p.family == family).map(Self::of)
    }

    /// The category of an index; 0 beyond the last.
    #[must_use]
    pub fn get(&self, index: usize) -> u8 {
        self.0.get(index).copied().unwrap_or(0)
    }

    /// Changes a category; an index beyond the last changes nothing.
    pub fn set(&mut self, index: usize, category: u8) {
        if let Some(entry) = self.0.get_mut(index) {
            *entry = category & 0x0F;
        }
    }

    /// Takes over the entries of an answer to command 523, from index `start` on.
    pub fn take(&mut self, start: u8, entries: &[u8]) {
        let codes = entries.iter().flat_map(|b| [b & 0x0F, b >> 4]);
        for (index, code) in (usize::from(start)..).zip(codes) {
            self.set(index, code);
        }
    }

    /// All entries as an answer to command 523 carries them, the smaller index in the low half.
    #[must_use]
    pub fn entries(&self) -> Vec<u8> {
        self.0
            .as_chunks::<2>()
            .0
            .iter()
            .map(|[low, high]| high << 4 | low)
            .collect()
    }
}

/// What a device reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Report {
    /// Bit 4 of the device status.
    pub more_status: bool,
    /// Bit 7 of the device status, as far as the map decides it.
    pub malfunction: bool,
    /// Extended device status.
    pub extended: u8,
}

/// What a device of this family makes of its own status bytes and the map.
///
/// Reading R12: the CVA looks at any alarm, the others at those with a category. Reading R11: IQ and
/// CMA fill the extended device status, the others send 0. Reading R13: a failure is a malfunction
/// on IQ and CMA, and taken for one on CK, which stays open; SI has no alarms (R10), so whatever
/// stands in its bytes 0 to 3 makes neither.
#[must_use]
pub fn report(family: Family, status: &[u8], map: &Map) -> Report {
    let mut report = Report::default();
    for (byte, raw) in (0..ALARM_BYTES).zip(status) {
        for bit in (0..8_u8).filter(|bit| raw.wrapping_shr(u32::from(*bit)) & 1 != 0) {
            if family == Family::Cva {
                report.more_status = true;
                continue;
            }
            let category = map.get(Map::index(byte, bit));
            report.more_status |= category != 0;
            let by_map = matches!(family, Family::Iq | Family::Cma | Family::Ck);
            report.malfunction |= by_map && category == 3;
            report.extended |= match category {
                _ if !matches!(family, Family::Iq | Family::Cma) => 0,
                1 => 0x01,
                3 => 0x08,
                4 => 0x10,
                5 => 0x20,
                _ => 0,
            };
        }
    }
    report
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indexes_count_from_the_device_status() {
        assert_eq!(Map::index(0, 0), 8, "the first that may be written");
        assert_eq!(Map::index(3, 7), 39, "the last");
        assert_eq!(Map::bit(39), Some((3, 7)));
        assert_eq!(Map::bit(7), None);
    }

    /// The entries of the worked frame R23: table 20 of the manual.
    #[test]
    fn the_example_packs_as_worked_out() {
        let mut frame = vec![0; 4];
        frame.extend([0x30, 0x40, 0x00, 0x51, 0x04, 0x05, 0, 0, 0x05, 0x03]);
        frame.resize(32, 0);
        let map = Map::example(Family::Iq).unwrap();
        assert_eq!(map.entries(), frame);
        let mut taken = Map::default();
        taken.take(0, &frame);
        assert_eq!(taken, map);
    }

    #[test]
    fn reports_follow_the_map() {
        let map = Map::example(Family::Iq).unwrap();
        // Local control fault is a failure.
        let failure = report(Family::Iq, &[0x02, 0, 0, 0, 0, 0], &map);
        assert_eq!((failure.extended, failure.malfunction), (0x08, true));
        // Thermostat out of specification, high high torque maintenance, high torque check.
        let three = report(Family::Iq, &[0xC8, 0, 0, 0, 0, 0], &map);
        assert_eq!((three.extended, three.malfunction), (0x31, false));
        assert!(three.more_status);
        // Battery low has no effect, and states never have.
        let none = report(Family::Iq, &[0x01, 0, 0, 0, 0xFF, 0xFF], &map);
        assert_eq!(none, Report::default());
        // The CVA has no map: any alarm is more status, and nothing else.
        let cva = report(Family::Cva, &[0, 0, 0, 0x02, 0, 0], &Map::default());
        assert_eq!((cva.more_status, cva.extended), (true, 0));
        let moving = report(Family::Cva, &[0, 0, 0, 0, 0x09, 0x01], &Map::default());
        assert!(!moving.more_status);
    }
}
