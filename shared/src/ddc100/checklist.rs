//! Could a command be given now? The checklist of section 6.2, from what was read of a unit.
//!
//! Nothing here gives a command. An item whose registers were not read is unknown, never passed.

mod items;

use super::scaling::Scaling;
use super::{Pair, tables};
use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::device::Device;
use crate::image::Image;
use items::{Look, communication, range};

/// What somebody wants the unit to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Wish {
    /// Open the valve.
    Open,
    /// Close it.
    Close,
    /// Stop it.
    Stop,
    /// Move it to a position in percent of open.
    MoveTo(u8),
    /// Engage a relay, by the number of table 3.7.
    Engage(u8),
    /// Disengage a relay.
    Disengage(u8),
}

impl Wish {
    /// Its value in register 1 (table 3.7; the move-to in one step is of section 3.2.6). `None` if
    /// there is none.
    #[must_use]
    pub fn command(self) -> Option<u16> {
        let relay = |from: u16, number: u8| {
            let past = u16::from(number.checked_sub(1)?).checked_mul(256)?;
            (number <= 7).then(|| from.saturating_add(past))
        };
        match self {
            Self::Open => Some(256),
            Self::Stop => Some(512),
            Self::Close => Some(768),
            Self::MoveTo(percent) if percent <= 100 => {
                Some(19_200_u16.saturating_add(percent.into()))
            }
            Self::MoveTo(_) => None,
            Self::Engage(number) => relay(2304, number),
            Self::Disengage(number) => relay(4352, number),
        }
    }

    /// What the type calls it: `Open`, `Engage AS-3`; `None` if the type must not be sent it.
    #[must_use]
    pub fn name(self, kind: Device) -> Option<String> {
        let value = self.command()?;
        let row = kind.map()?.row_at(Table::Holding, Address::new(0))?;
        let member = row.set?.get(value.into())?;
        let name = member.name(value.into());
        (!name.ends_with("(do not use)")).then(|| name.into_owned())
    }

    const fn moves(self) -> bool {
        matches!(self, Self::Open | Self::Close | Self::MoveTo(_))
    }
}

/// How an item stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Verdict {
    /// Nothing speaks against the command.
    Pass,
    /// Something was not read, or can't be read.
    Unknown,
    /// The command should not be given.
    Fail,
}

impl Verdict {
    /// A word for programs and people.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Unknown => "unknown",
            Self::Fail => "fail",
        }
    }
}

/// One item.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Item {
    /// A word for programs.
    pub key: &'static str,
    /// How it stands.
    pub verdict: Verdict,
    /// What was found, and what to do.
    pub text: String,
    /// Where the guide asks for it.
    pub source: &'static str,
    /// When the oldest register that it rests on was read.
    pub at: Option<Micros>,
}

/// The whole list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Checklist {
    /// What is wanted.
    pub wish: Wish,
    /// Its items, in the order of the guide.
    pub items: Vec<Item>,
    /// What to know when it is sent, with the place in the guide.
    pub notes: Vec<(&'static str, &'static str)>,
}

impl Checklist {
    /// The worst of all items.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        let has = |verdict| self.items.iter().any(|i| i.verdict == verdict);
        match (has(Verdict::Fail), has(Verdict::Unknown)) {
            (true, _) => Verdict::Fail,
            (false, true) => Verdict::Unknown,
            (false, false) => Verdict::Pass,
        }
    }
}

/// Goes through the list for a unit.
///
/// `faults` are the host's, by port; `scaling` is how register 8 is set.
#[must_use]
pub fn checklist(
    kind: Device,
    image: &Image,
    faults: Pair<Option<bool>>,
    scaling: Scaling,
    wish: Wish,
) -> Checklist {
    let look = Look {
        kind,
        image,
        scaling,
        wish,
    };
    let mut items = vec![communication(faults)];
    items.extend(look.known());
    let relay = matches!(wish, Wish::Engage(_) | Wish::Disengage(_));
    let valve = kind != Device::Ddc100Io;
    // A network stop works in REMOTE and in LOCAL, whatever else is wrong (item 10).
    if valve && (wish.moves() || relay) {
        items.push(look.remote());
    }
    if valve && wish.moves() {
        items.push(look.combined());
        items.push(look.position());
        items.push(look.torque());
        items.push(look.shutdown());
        if tables::is_fast(kind) {
            items.push(look.local_stop());
        }
    }
    if let Wish::MoveTo(percent) = wish {
        items.push(range(percent));
    }
    if relay && wish.name(kind).is_some() {
        items.push(look.relay());
        if !valve && matches!(wish, Wish::Engage(_)) {
            items.push(look.interlock());
        }
    }
    Checklist {
        wish,
        items,
        notes: notes(wish),
    }
}

/// What the guide says beside the list.
fn notes(wish: Wish) -> Vec<(&'static str, &'static str)> {
    let mut notes = vec![
        (
            "It goes between two polls, through the port of the pass; through the other one if the unit has a fault there.",
            "sections 4.3.1 and 6.2, item 1",
        ),
        (
            "It is sent once, and again only if no acknowledge came: repeating it can stop the valve.",
            "section 6.2, item 6",
        ),
    ];
    match wish {
        Wish::Open | Wish::Close => notes.push((
            "The unit stops by itself at the end, and turns round without a stop in between.",
            "section 6.2, items 7 and 9",
        )),
        Wish::MoveTo(_) => notes.push((
            "Only for actuators that are set up for position control, which no register tells; by function 06 or 16 (reading D22).",
            "section 6.2, items 4 and 5",
        )),
        Wish::Stop => notes.push((
            "A stop works in REMOTE and in LOCAL.",
            "section 6.2, item 10",
        )),
        Wish::Engage(_) | Wish::Disengage(_) => notes.push((
            "Where two relays work one device, the first is disengaged before the second is engaged.",
            "section 6.2, item 3",
        )),
    }
    notes
}

#[cfg(test)]
pub(super) mod tests;
