//! Could a command be given now? The checklist of section 6.2, from what was read of a unit.
//!
//! Nothing here gives a command. An item whose registers were not read, or too long ago, is unknown,
//! never passed.

mod items;
mod notes;
mod relays;

use super::scaling::Scaling;
use super::{Pair, command, tables};
use crate::capture::Micros;
use crate::device::Device;
use crate::image::Image;
use items::{Look, communication, range};
use notes::notes;

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
    /// Start the emergency shutdown of the network.
    StartEsd,
    /// End it.
    StopEsd,
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
            Self::StartEsd => Some(1280),
            Self::StopEsd => Some(1536),
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
        let name = command::meaning(kind, self.command()?)?;
        (!name.ends_with("(do not use)")).then_some(name)
    }

    const fn moves(self) -> bool {
        matches!(self, Self::Open | Self::Close | Self::MoveTo(_))
    }
}

/// When the list is gone through. What was read before `now` less `most` is too old to rely on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moment {
    /// Now, by the clock of what was read.
    pub now: Micros,
    /// How old a value may be, in microseconds.
    pub most: u64,
    /// False while nothing new can come: without a connection everything is old.
    pub online: bool,
}

impl Moment {
    /// How long ago something was, if that is too long.
    const fn too_old(self, at: Micros) -> Option<u64> {
        let age = self.now.get().saturating_sub(at.get());
        if age > self.most { Some(age) } else { None }
    }
}

/// How an item stands, the worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Verdict {
    /// Nothing speaks against the command.
    Pass,
    /// It can be given, but another one fits better.
    Warn,
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
            Self::Warn => "warn",
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
        let all = self.items.iter().map(|i| i.verdict);
        all.max().unwrap_or(Verdict::Unknown)
    }
}

/// Goes through the list for a unit.
///
/// `faults` are the host's, by port; `scaling` is how register 8 is set, `None` if nobody said it.
#[must_use]
pub fn checklist(
    kind: Device,
    image: &Image,
    faults: Pair<Option<bool>>,
    scaling: Option<Scaling>,
    moment: Moment,
    wish: Wish,
) -> Checklist {
    let look = Look {
        kind,
        image,
        scaling: scaling.unwrap_or_default(),
        is_said: scaling.is_some(),
        wish,
        moment,
    };
    let newest = image.iter().map(|(_, _, cell)| cell.at).max();
    let mut items = vec![communication(faults, newest, moment)];
    items.extend(look.known());
    let relay = matches!(wish, Wish::Engage(_) | Wish::Disengage(_));
    let esd = matches!(wish, Wish::StartEsd | Wish::StopEsd);
    let valve = kind != Device::Ddc100Io;
    // A network stop works in REMOTE and in LOCAL, whatever else is wrong (item 10).
    if valve && wish != Wish::Stop {
        items.push(look.remote());
    }
    if valve && (wish.moves() || wish == Wish::StartEsd) {
        items.push(look.combined());
        if wish.moves() {
            items.push(look.position());
        }
        items.push(look.torque());
    }
    if valve && wish.moves() {
        items.push(look.shutdown());
    }
    if valve && esd {
        items.push(look.esd());
    }
    if valve && (wish.moves() || wish == Wish::StartEsd) && tables::is_fast(kind) {
        items.push(look.local_stop());
    }
    if let Wish::MoveTo(percent) = wish {
        items.push(range(percent));
        if valve {
            items.push(look.scale());
        }
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
        notes: notes(kind, wish),
    }
}

#[cfg(test)]
pub(super) mod tests;
