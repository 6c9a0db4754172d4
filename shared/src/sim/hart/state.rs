//! Status as the device forms it: its own bytes (tables 6 to 11), the condensed status map, the
//! extended status, and which bits of the device status follow.

use super::setup::{HartSelector, HartSetup};
use super::signal::Signal;
use super::valve::{Valve, Way};
use crate::device::Family;
use crate::hart::additional;

/// Bytes of its own status.
pub(super) const OWN: usize = 6;
/// Of these, the first four hold what counts for More Status Available (sections 6.3 to 6.7).
const ALARMS: usize = 4;
/// Entries of the condensed status map that can be read (section 8.1).
pub(super) const ENTRIES: usize = 64;

/// Bits of the device status (table 4).
pub(super) mod bit {
    pub(in super::super) const MALFUNCTION: u8 = 0x80;
    pub(in super::super) const CHANGED: u8 = 0x40;
    pub(in super::super) const COLD: u8 = 0x20;
    pub(in super::super) const MORE: u8 = 0x10;
    pub(in super::super) const FIXED: u8 = 0x08;
    pub(in super::super) const SATURATED: u8 = 0x04;
    pub(in super::super) const PV_LIMITS: u8 = 0x01;
}

/// What the device remembers about its status.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// Bits that were injected.
    pub injected: [u8; OWN],
    /// Injected bits of the device status.
    pub device: u8,
    /// Where the selector stands.
    pub selector: HartSelector,
    /// False: the field unit does not reach the main board.
    pub board: bool,
    /// A partial stroke is going on.
    pub stroke: bool,
    /// An emergency shut-down was commanded.
    pub esd: bool,
    /// Relays that are energised; bit 0 is relay 1.
    pub relays: u16,
    /// Category of each entry of the condensed status map.
    pub map: [u8; ENTRIES],
    /// With status simulation on: the own bytes and the device status that stand still.
    pub frozen: Option<([u8; OWN], u8)>,
    /// Alarm bits whose report was written back (command 48).
    known: [u8; ALARMS],
}

impl State {
    pub const fn new() -> Self {
        Self {
            injected: [0; OWN],
            device: 0,
            selector: HartSelector::Remote,
            board: true,
            stroke: false,
            esd: false,
            relays: 0,
            map: [0; ENTRIES],
            frozen: None,
            known: [0; ALARMS],
        }
    }

    /// The own bytes.
    pub fn own(&self, setup: &HartSetup, valve: &Valve, signal: &Signal) -> [u8; OWN] {
        if let Some((bytes, _)) = self.frozen {
            return bytes;
        }
        let mut bytes = self.live(setup.family, valve, signal);
        for (byte, injected) in bytes.iter_mut().zip(self.injected) {
            *byte |= injected;
        }
        bytes
    }

    fn live(&self, family: Family, valve: &Valve, signal: &Signal) -> [u8; OWN] {
        let on = |condition: bool, mask: u8| if condition { mask } else { 0 };
        let stalled = valve.stalled.is_some();
        let opening = valve.stalled == Some(Way::Open);
        let closing = valve.stalled == Some(Way::Close);
        let moves = valve.moving.is_some();
        let (remote, stop, local) = match self.selector {
            HartSelector::Remote => (true, false, false),
            HartSelector::Stop => (false, true, false),
            HartSelector::Local => (false, false, true),
        };
        let running =
            on(valve.moving == Some(Way::Close), 0x08) | on(valve.moving == Some(Way::Open), 0x10);
        let limits = on(valve.is_closed(), 0x02) | on(valve.is_open(), 0x04);
        // Byte 4 of all but the CVA (tables 8 to 11).
        let four = on(moves, 0x01)
            | limits
            | running
            | on(remote, 0x20)
            | on(stop, 0x40)
            | on(local, 0x80);
        let five = on(self.stroke, 0x02) | on(!self.board, 0x04);
        match family {
            // Tables 6 and 7.
            Family::Cva => [
                0,
                0,
                0,
                on(opening, 0x08)
                    | on(closing, 0x10)
                    | on(stalled, 0x20)
                    | on(stop, 0x40)
                    | on(local, 0x80),
                on(!self.board, 0x01) | limits | running | on(remote, 0x20) | on(stop, 0x40),
                on(moves, 0x01),
            ],
            // Tables 8 and 10.
            Family::Iq | Family::Ck => [0, on(stalled, 0x01), on(stalled, 0x02), 0, four, five],
            // Table 9; its byte 5 is reserved (reading R9).
            Family::Cma => {
                let lost = signal.is_lost();
                let relay = |number: u8, mask: u8| on(self.has_relay(number), mask);
                [
                    on(stalled || lost, 0x01)
                        | on(lost, 0x02)
                        | on(opening, 0x08)
                        | on(closing, 0x10),
                    on(lost, 0x02) | on(local, 0x40) | on(valve.is_closed(), 0x80),
                    on(valve.is_open(), 0x01)
                        | on(stop, 0x02)
                        | on(remote, 0x04)
                        | on(local, 0x08)
                        | on(self.esd, 0x10)
                        | relay(1, 0x20)
                        | relay(2, 0x40)
                        | relay(5, 0x80),
                    relay(6, 0x01) | relay(7, 0x02) | relay(8, 0x04),
                    four,
                    0,
                ]
            }
            // Table 11: no alarms.
            Family::Si => [0, 0, 0, 0, four, five],
        }
    }

    /// True if this relay, counted from 1, is energised.
    pub fn has_relay(&self, number: u8) -> bool {
        let bit = u32::from(number.saturating_sub(1));
        self.relays.checked_shr(bit).unwrap_or(0) & 1 != 0
    }

    /// The alarm bits that count: all of them on the CVA, elsewhere those with a category.
    fn counting(&self, family: Family, own: [u8; OWN]) -> [u8; ALARMS] {
        let mut counting = [0; ALARMS];
        let entries = self.map.get(8..).unwrap_or(&[]);
        let (categories, _) = entries.as_chunks::<8>();
        for ((slot, byte), categories) in counting.iter_mut().zip(own).zip(categories) {
            let mut mask = 0;
            for (bit, category) in categories.iter().enumerate() {
                if *category != 0 {
                    mask |= 1_u8 << (bit & 7);
                }
            }
            *slot = if family == Family::Cva {
                byte
            } else {
                byte & mask
            };
        }
        counting
    }

    /// Forgets bits that went away, so that they count as new when they come back.
    pub fn settle(&mut self, family: Family, own: [u8; OWN]) {
        let counting = self.counting(family, own);
        for (known, now) in self.known.iter_mut().zip(counting) {
            *known &= now;
        }
    }

    /// The host wrote back what it had read.
    pub fn acknowledge(&mut self, family: Family, own: [u8; OWN]) {
        self.known = self.counting(family, own);
    }

    /// More Status Available: a bit that counts and was not written back.
    pub fn has_more(&self, family: Family, own: [u8; OWN]) -> bool {
        let counting = self.counting(family, own);
        counting
            .iter()
            .zip(self.known)
            .any(|(now, known)| now & !known != 0)
    }

    /// True if a bit of this NE 107 category stands.
    fn has(&self, category: u8, own: [u8; OWN]) -> bool {
        let entries = self.map.get(8..).unwrap_or(&[]);
        let (categories, _) = entries.as_chunks::<8>();
        own.iter()
            .take(ALARMS)
            .zip(categories)
            .any(|(byte, categories)| {
                let mut bits = categories.iter().enumerate();
                bits.any(|(bit, own)| *own == category && byte & 1_u8 << (bit & 7) != 0)
            })
    }

    /// Extended device status (table 5): IQ and CMA only (reading R11).
    pub fn extended(&self, family: Family, own: [u8; OWN]) -> u8 {
        if !matches!(family, Family::Iq | Family::Cma) {
            return 0;
        }
        [(1, 0x01), (3, 0x08), (4, 0x10), (5, 0x20)]
            .into_iter()
            .filter(|(category, _)| self.has(*category, own))
            .fold(0, |sum, (_, mask)| sum | mask)
    }

    /// Malfunction: no main board, or an NE 107 failure on IQ and CMA, and on CK by reading R13.
    pub fn malfunctions(&self, family: Family, own: [u8; OWN]) -> bool {
        let by_map = matches!(family, Family::Iq | Family::Cma | Family::Ck);
        !self.board || by_map && self.has(3, own)
    }

    /// Byte and mask of a status bit with this key, or `byte.bit` in digits.
    pub fn find(family: Family, key: &str) -> Option<(usize, u8)> {
        if let Some((byte, bit)) = key.split_once('.') {
            let (byte, bit) = (byte.parse::<usize>().ok()?, bit.parse::<u32>().ok()?);
            let known = byte < OWN && bit < 8;
            return known.then(|| (byte, 1_u8.wrapping_shl(bit)));
        }
        (0..OWN).find_map(|byte| {
            let bits = additional(family, u8::try_from(byte).ok()?)?;
            let found = bits.bits.iter().find(|b| b.key == key)?;
            Some((byte, 1_u8.wrapping_shl(u32::from(found.bit))))
        })
    }
}
