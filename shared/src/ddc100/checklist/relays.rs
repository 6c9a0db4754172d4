//! The items about relays.

use super::items::{Look, unread};
use super::{Item, Verdict, Wish};
use crate::ddc100::tables;
use crate::ddc100::words::{OUTPUTS, bit, register};
use crate::device::Device;

impl Look<'_> {
    /// The bit of register 11 of the relay that is meant (readings D2 and D3).
    fn relay_bit(&self, relay: u8) -> Option<u32> {
        let relay = u32::from(relay);
        if tables::is_fast(self.kind) {
            Some(relay.saturating_add(1))
        } else if self.kind == Device::Ddc100Io && relay <= 2 {
            Some(relay.saturating_add(5))
        } else {
            relay.checked_sub(1)
        }
    }

    /// Repeating what was done already is no good (item 6).
    pub(super) fn relay(&self) -> Item {
        let (relay, on) = match self.wish {
            Wish::Engage(n) => (n, true),
            Wish::Disengage(n) => (n, false),
            _ => (0, false),
        };
        let now = self
            .relay_bit(relay)
            .and_then(|at| bit(self.image, OUTPUTS, at));
        let found = match (now, on) {
            (None, _) => unread(OUTPUTS),
            (Some(true), true) => (Verdict::Fail, "The relay is engaged already.".to_owned()),
            (Some(false), false) => (Verdict::Fail, "The relay is disengaged already.".to_owned()),
            (Some(true), false) => (Verdict::Pass, "The relay is engaged.".to_owned()),
            (Some(false), true) => (Verdict::Pass, "The relay is disengaged.".to_owned()),
        };
        self.item("relay", &[OUTPUTS], "section 6.2, item 6", found)
    }

    /// Item 3: of two relays that work one device, the first is disengaged first.
    pub(super) fn interlock(&self) -> Item {
        const RELAYS: u16 = 0b1111_1100;
        let own = match self.wish {
            Wish::Engage(n) => self.relay_bit(n).map_or(0, |at| 1_u16.wrapping_shl(at)),
            _ => 0,
        };
        let found = match register(self.image, OUTPUTS) {
            None => unread(OUTPUTS),
            Some(cell) if cell.word & RELAYS & !own == 0 => {
                (Verdict::Pass, "No other relay is engaged.".to_owned())
            }
            Some(_) => (
                Verdict::Unknown,
                "Another relay is engaged: if both work one device, disengage that one first. Which belong together, no register tells.".to_owned(),
            ),
        };
        self.item("interlock", &[OUTPUTS], "section 6.2, item 3", found)
    }
}
