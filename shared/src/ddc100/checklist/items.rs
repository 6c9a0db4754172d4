//! The items of the checklist.

use super::{Item, Verdict, Wish};
use crate::capture::Micros;
use crate::ddc100::scaling::Scaling;
use crate::ddc100::view::Mode;
use crate::ddc100::words::{FAULTS, INPUTS_1, OUTPUTS, POSITION, STATUS, bit, register};
use crate::ddc100::{Pair, tables};
use crate::device::Device;
use crate::image::Image;

/// What the items look at.
pub(super) struct Look<'a> {
    pub(super) kind: Device,
    pub(super) image: &'a Image,
    pub(super) scaling: Scaling,
    pub(super) wish: Wish,
}

pub(super) fn item(
    key: &'static str,
    verdict: Verdict,
    source: &'static str,
    text: impl Into<String>,
) -> Item {
    Item {
        key,
        verdict,
        text: text.into(),
        source,
        at: None,
    }
}

/// Item 2, first point, and item 3: the unit answers the polls.
pub(super) fn communication(faults: Pair<Option<bool>>) -> Item {
    let (verdict, text) = match (faults.one, faults.two) {
        (Some(false), Some(false)) => (Verdict::Pass, "The unit answers through both host ports."),
        (Some(false), _) => (Verdict::Pass, "The unit answers through host port 1."),
        (_, Some(false)) => (Verdict::Pass, "The unit answers through host port 2."),
        (None, None) => (Verdict::Unknown, "The unit was not polled yet."),
        _ => (
            Verdict::Fail,
            "The unit does not answer the polls: a command would not reach it.",
        ),
    };
    item("communication", verdict, "section 6.2, items 2 and 3", text)
}

/// Item 5 and reading D21.
pub(super) fn range(percent: u8) -> Item {
    let (verdict, text) = match percent {
        2..=98 => (Verdict::Pass, format!("{percent} % is within 2 to 98 %.")),
        0 => (Verdict::Fail, "For 0 % give Close instead.".to_owned()),
        100 => (Verdict::Fail, "For 100 % give Open instead.".to_owned()),
        1 | 99 => (
            Verdict::Fail,
            format!(
                "{percent} % is outside 2 to 98 %: go to the end with Open or Close, or stay within."
            ),
        ),
        _ => (
            Verdict::Fail,
            format!("{percent} % does not exist: a position is 0 to 100 %."),
        ),
    };
    item("range", verdict, "section 6.2, item 5", text)
}

impl Look<'_> {
    /// When the oldest of some registers was read; `None` unless all were.
    fn at(&self, numbers: &[u16]) -> Option<Micros> {
        let cells: Option<Vec<_>> = numbers.iter().map(|n| register(self.image, *n)).collect();
        cells?.iter().map(|c| c.at).min()
    }

    fn item(
        &self,
        key: &'static str,
        numbers: &[u16],
        source: &'static str,
        (verdict, text): (Verdict, String),
    ) -> Item {
        Item {
            at: self.at(numbers),
            ..item(key, verdict, source, text)
        }
    }

    /// Table 3.7: the type knows the command.
    pub(super) fn known(&self) -> Option<Item> {
        if self.wish.name(self.kind).is_some() {
            return None;
        }
        let text = match (self.wish, self.kind) {
            (Wish::MoveTo(percent), _) if percent > 100 => return None,
            (Wish::Engage(n) | Wish::Disengage(n), kind) => {
                format!("{} has no relay {n} to be worked.", kind.label())
            }
            (_, kind) => format!("{} works no valve: do not send it this.", kind.label()),
        };
        Some(item("command", Verdict::Fail, "table 3.7", text))
    }

    /// Item 2, second point; reading D9 on bit 6 and its change in 1999.
    pub(super) fn remote(&self) -> Item {
        let remote = bit(self.image, INPUTS_1, 0);
        let local = bit(self.image, STATUS, 6);
        let mode = Mode::of(self.kind, local, remote);
        let (verdict, text) = match mode {
            Mode::Remote if local.is_some() => (Verdict::Pass, "The selector stands at REMOTE."),
            Mode::Remote => (
                Verdict::Unknown,
                "Register 12 says REMOTE; register 9 was not read.",
            ),
            Mode::LocalOrStop if local == Some(false) => (
                Verdict::Fail,
                "Register 12 does not say REMOTE, and register 9 not LOCAL; what that means is told for an MX only. Look at the selector.",
            ),
            Mode::LocalOrStop => (
                Verdict::Fail,
                "The selector stands at LOCAL or STOP: set it to REMOTE at the valve.",
            ),
            Mode::Stop => (
                Verdict::Fail,
                "The selector stands neither at REMOTE nor at LOCAL: at STOP, on a unit from before the second quarter of 1999.",
            ),
            Mode::Contradictory => (
                Verdict::Fail,
                "Register 12 says REMOTE and register 9 says LOCAL: look at the valve.",
            ),
            Mode::NotLocal => (
                Verdict::Unknown,
                "Not at LOCAL, but only register 12 tells REMOTE from STOP, and it was not read.",
            ),
            Mode::Unknown => (Verdict::Unknown, "Registers 9 and 12 were not read."),
        };
        let found = (verdict, text.to_owned());
        self.item("remote", &[STATUS, INPUTS_1], "section 6.2, item 2", found)
    }

    /// Item 2, point a.
    pub(super) fn combined(&self) -> Item {
        let found = match bit(self.image, STATUS, 7) {
            None => unread(STATUS),
            Some(false) => (Verdict::Pass, "No combined fault.".to_owned()),
            Some(true) => (
                Verdict::Fail,
                "Combined fault: the actuator may not be able to move. See to its faults first."
                    .to_owned(),
            ),
        };
        self.item("combined_fault", &[STATUS], "section 6.2, item 2a", found)
    }

    /// Item 2, point b.
    pub(super) fn position(&self) -> Item {
        let (numbers, found): (&[u16], _) = match self.wish {
            Wish::Open => (&[STATUS], self.end(0, "open")),
            Wish::Close => (&[STATUS], self.end(1, "closed")),
            _ => (&[POSITION], self.there()),
        };
        self.item("position", numbers, "section 6.2, item 2b", found)
    }

    fn end(&self, at: u32, name: &str) -> (Verdict, String) {
        match bit(self.image, STATUS, at) {
            None => unread(STATUS),
            Some(false) => (Verdict::Pass, format!("The valve is not {name} yet.")),
            Some(true) => (Verdict::Fail, format!("The valve is {name} already.")),
        }
    }

    fn there(&self) -> (Verdict, String) {
        let Wish::MoveTo(percent) = self.wish else {
            return unread(POSITION);
        };
        match self.tenths() {
            None => self.no_position(),
            Some(tenths) if tenths == u16::from(percent).saturating_mul(10) => (
                Verdict::Fail,
                format!("The valve is at {percent} % already."),
            ),
            Some(tenths) => (
                Verdict::Pass,
                format!("The valve is at {}.{} %.", tenths / 10, tenths % 10),
            ),
        }
    }

    /// The position in tenths of a percent, if it was read and has one.
    fn tenths(&self) -> Option<u16> {
        self.scaling
            .read(register(self.image, POSITION)?.word)
            .tenths()
    }

    fn no_position(&self) -> (Verdict, String) {
        match register(self.image, POSITION) {
            None => unread(POSITION),
            Some(cell) => (
                Verdict::Unknown,
                format!(
                    "Register 8 says {}: that is no position.",
                    self.scaling.read(cell.word)
                ),
            ),
        }
    }

    /// Item 2, point c: the combined fault does not include the torque switches (reading D8).
    pub(super) fn torque(&self) -> Item {
        let open = bit(self.image, STATUS, 12);
        let close = bit(self.image, STATUS, 13);
        let opening = match self.wish {
            Wish::Open => Some(true),
            Wish::Close => Some(false),
            Wish::MoveTo(to) => self
                .tenths()
                .map(|from| from < u16::from(to).saturating_mul(10)),
            _ => None,
        };
        let tripped = |way: &str| {
            let text = format!("The {way} torque switch tripped: the valve may be stuck this way.");
            (Verdict::Fail, text)
        };
        let free = |way: &str| {
            (
                Verdict::Pass,
                format!("No torque switch fault in {way} direction."),
            )
        };
        let found = match (open, close, opening) {
            (None, ..) | (_, None, _) => unread(STATUS),
            (Some(true), _, Some(true)) => tripped("open"),
            (_, Some(true), Some(false)) => tripped("close"),
            (_, _, Some(true)) => free("opening"),
            (_, _, Some(false)) => free("closing"),
            (Some(false), Some(false), None) => free("either"),
            _ => (
                Verdict::Unknown,
                "A torque switch tripped, and without the position it is not known whether it is the one of this direction.".to_owned(),
            ),
        };
        self.item("torque", &[STATUS], "section 6.2, item 2c", found)
    }

    /// Implied by the list: an emergency shutdown drives the valve by itself.
    pub(super) fn shutdown(&self) -> Item {
        let network = bit(self.image, FAULTS, 10);
        let local = bit(self.image, FAULTS, 11);
        let found = match (network, local) {
            (Some(true), _) => (
                Verdict::Fail,
                "The emergency shutdown of the network is active.".to_owned(),
            ),
            (_, Some(true)) => (
                Verdict::Fail,
                "The local emergency shutdown is active: user input 0, unless it is set to be ignored."
                    .to_owned(),
            ),
            (Some(false), Some(false)) => (
                Verdict::Pass,
                "No emergency shutdown is reported; one of the network is only if the unit is not set to ignore it.".to_owned(),
            ),
            _ => unread(FAULTS),
        };
        let source = "sections 6.1, items 4 and 5, and 6.2, item 2";
        self.item("emergency_shutdown", &[FAULTS], source, found)
    }

    /// Implied by the list: bit 13 of register 10 on an MX/DDC. On the others it is another fault.
    pub(super) fn local_stop(&self) -> Item {
        let found = match bit(self.image, FAULTS, 13) {
            None => unread(FAULTS),
            Some(false) => (Verdict::Pass, "No local stop.".to_owned()),
            Some(true) => (
                Verdict::Fail,
                "Stopped at the valve: local stop is active.".to_owned(),
            ),
        };
        let source = "table 3.5, register 10, and section 6.2, item 2";
        self.item("local_stop", &[FAULTS], source, found)
    }

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

fn unread(number: u16) -> (Verdict, String) {
    (Verdict::Unknown, format!("Register {number} was not read."))
}
