//! The items of the checklist.

use super::{Item, Moment, Verdict, Wish};
use crate::capture::Micros;
use crate::ddc100::Pair;
use crate::ddc100::scaling::Scaling;
use crate::ddc100::view::Mode;
use crate::ddc100::words::{FAULTS, INPUTS_1, POSITION, STATUS, bit, register};
use crate::device::Device;
use crate::image::Image;

/// What the items look at.
pub(super) struct Look<'a> {
    pub(super) kind: Device,
    pub(super) image: &'a Image,
    /// How register 8 is set, or the default.
    pub(super) scaling: Scaling,
    /// True if somebody said how.
    pub(super) is_said: bool,
    pub(super) wish: Wish,
    pub(super) moment: Moment,
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
pub(super) fn communication(
    faults: Pair<Option<bool>>,
    newest: Option<Micros>,
    moment: Moment,
) -> Item {
    let late = newest.and_then(|at| moment.too_old(at));
    let found = |verdict, text: &str| (verdict, text.to_owned());
    let (verdict, text) = match (faults.one, faults.two, late) {
        _ if !moment.online => found(
            Verdict::Unknown,
            "No connection: whether the unit answers now is not known.",
        ),
        (None, None, _) => found(Verdict::Unknown, "The unit was not polled yet."),
        (Some(true), Some(true) | None, _) | (None, Some(true), _) => found(
            Verdict::Fail,
            "The unit does not answer the polls: a command would not reach it.",
        ),
        (.., Some(age)) => (
            Verdict::Unknown,
            format!(
                "The last answer came {} ago: too long to rely on.",
                seconds(age)
            ),
        ),
        (Some(false), Some(false), _) => {
            found(Verdict::Pass, "The unit answers through both host ports.")
        }
        (Some(false), ..) => found(Verdict::Pass, "The unit answers through host port 1."),
        (_, Some(false), _) => found(Verdict::Pass, "The unit answers through host port 2."),
    };
    Item {
        at: newest,
        ..item("communication", verdict, "section 6.2, items 2 and 3", text)
    }
}

/// An age in whole seconds.
fn seconds(micros: u64) -> String {
    format!("{} s", micros.checked_div(1_000_000).unwrap_or(0))
}

/// Item 5 and reading D21.
pub(super) fn range(percent: u8) -> Item {
    let (verdict, text) = match percent {
        2..=98 => (Verdict::Pass, format!("{percent} % is within 2 to 98 %.")),
        0..=100 => {
            let end = if percent < 50 { "Close" } else { "Open" };
            let text = format!(
                "{percent} % can be sent, but is outside 2 to 98 %: better give {end} to go to the end (reading D21)."
            );
            (Verdict::Warn, text)
        }
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

    pub(super) fn item(
        &self,
        key: &'static str,
        numbers: &[u16],
        source: &'static str,
        (verdict, text): (Verdict, String),
    ) -> Item {
        let at = self.at(numbers);
        let old = at.and_then(|at| self.moment.too_old(at));
        let (verdict, text) = match old {
            _ if verdict == Verdict::Unknown => (verdict, text),
            _ if !self.moment.online => (
                Verdict::Unknown,
                format!("No connection; when it was read last: {text}"),
            ),
            Some(age) => (
                Verdict::Unknown,
                format!(
                    "Read {} ago, too long to rely on; it was: {text}",
                    seconds(age)
                ),
            ),
            None => (verdict, text),
        };
        Item {
            at,
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
            Some(_) if self.is_there(percent) => (
                Verdict::Fail,
                format!("The valve is at {percent} % already."),
            ),
            Some(tenths) => (
                Verdict::Pass,
                format!("The valve is at {}.{} %.", tenths / 10, tenths % 10),
            ),
        }
    }

    /// True if the position is a count next to so many percent: 50 % of 255 is 127 or 128.
    fn is_there(&self, percent: u8) -> bool {
        let counts = self
            .scaling
            .full()
            .zip(register(self.image, POSITION).map(|cell| cell.word));
        counts.is_some_and(|(full, raw)| {
            let wanted = u32::from(full).saturating_mul(u32::from(percent));
            u32::from(raw).saturating_mul(100).abs_diff(wanted) <= 50
        })
    }

    /// The one-step move-to counts in percent (section 3.2.6, rules).
    pub(super) fn scale(&self) -> Item {
        let (verdict, text) = match self.scaling {
            Scaling::Percent if self.is_said => (
                Verdict::Pass,
                "The unit is scaled 0-100, as it was chosen or as its tag list says; no register tells."
                    .to_owned(),
            ),
            Scaling::Percent => (
                Verdict::Unknown,
                "The move-to in one step wants a unit that is scaled 0-100. That is usual, but nobody said it of this one, and no register tells: choose its scale."
                    .to_owned(),
            ),
            Scaling::Raw => (
                Verdict::Unknown,
                "The move-to in one step wants a unit that is scaled 0-100; its scale is not known."
                    .to_owned(),
            ),
            other => (
                Verdict::Fail,
                format!(
                    "The move-to in one step wants a unit that is scaled 0-100; this one is scaled {}.",
                    other.key()
                ),
            ),
        };
        item("scale", verdict, "section 3.2.6", text)
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
                .filter(|_| !self.is_there(to))
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
                "A torque switch tripped, and it is not known whether it is the one of this direction.".to_owned(),
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

    /// Starting what is started already, or ending what is not (section 6.1, item 5).
    pub(super) fn esd(&self) -> Item {
        let found = match (bit(self.image, FAULTS, 10), self.wish) {
            (None, _) => unread(FAULTS),
            (Some(true), Wish::StartEsd) => (
                Verdict::Fail,
                "The emergency shutdown of the network is active already.".to_owned(),
            ),
            (Some(true), _) => (
                Verdict::Pass,
                "The emergency shutdown of the network is active.".to_owned(),
            ),
            (Some(false), Wish::StartEsd) => (
                Verdict::Pass,
                "No emergency shutdown of the network is reported.".to_owned(),
            ),
            (Some(false), _) => (
                Verdict::Unknown,
                "No emergency shutdown of the network is reported: there is none, or the unit is set to ignore it.".to_owned(),
            ),
        };
        self.item("network_esd", &[FAULTS], "section 6.1, item 5", found)
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
}

pub(super) fn unread(number: u16) -> (Verdict, String) {
    (Verdict::Unknown, format!("Register {number} was not read."))
}
