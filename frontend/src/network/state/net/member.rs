//! A unit of a network: its registers, its counters, which ports reach it.

use std::collections::BTreeMap;

use shared::ddc100::counters;
use shared::ddc100::scaling::Scaling;
use shared::ddc100::words::register;
use shared::device::Device;
use shared::image::Image;
use shared::proto::{DdcUnit, Outcome};

/// Which host ports reach a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reach {
    /// Every port that there is.
    Full,
    /// Only this one of two.
    Only(u8),
    /// None: the unit is off-line.
    Lost,
    /// This port reaches it or not; the other one was not tried yet.
    Half(u8, bool),
    /// Not tried yet.
    Unknown,
}

impl Reach {
    /// In words, as the state of a unit.
    #[must_use]
    pub const fn words(self, ports: usize) -> &'static str {
        match (self, ports) {
            (Self::Full, 2..) => "answers on both ports",
            (Self::Full, _) => "answers",
            (Self::Only(1), _) => "answers on port 1 only",
            (Self::Only(_), _) => "answers on port 2 only",
            (Self::Lost, 2..) => "no answer on either port",
            (Self::Lost, _) => "no answer",
            (Self::Half(1, true), _) => "answers on port 1, port 2 not tried yet",
            (Self::Half(_, true), _) => "answers on port 2, port 1 not tried yet",
            (Self::Half(1, false), _) => "no answer on port 1, port 2 not tried yet",
            (Self::Half(_, false), _) => "no answer on port 2, port 1 not tried yet",
            (Self::Unknown, _) => "not tried yet",
        }
    }
}

/// Which ports reach a unit whose faults on port 1 and 2 are these.
#[must_use]
pub const fn reach(fault: [Option<bool>; 2], ports: usize) -> Reach {
    if ports < 2 {
        return match fault[0] {
            None => Reach::Unknown,
            Some(false) => Reach::Full,
            Some(true) => Reach::Lost,
        };
    }
    match fault {
        [None, None] => Reach::Unknown,
        [Some(false), Some(false)] => Reach::Full,
        [Some(false), Some(true)] => Reach::Only(1),
        [Some(true), Some(false)] => Reach::Only(2),
        [Some(true), Some(true)] => Reach::Lost,
        [Some(fault), None] => Reach::Half(1, !fault),
        [None, Some(fault)] => Reach::Half(2, !fault),
    }
}

/// A unit.
#[derive(Clone, Debug)]
pub struct Unit {
    /// Address, kind, tag and description, as configured.
    pub info: DdcUnit,
    /// Its kind.
    pub device: Device,
    /// Its registers as last read.
    pub image: Image,
    /// How the last poll ended; `None` before the first.
    pub outcome: Option<Outcome>,
    /// The same in words; empty if it was good.
    pub text: String,
    /// Host port of the last poll.
    pub port: u8,
    /// Fault on host port 1 and 2, as the host found it; `None` where it was not tried.
    pub fault: [Option<bool>; 2],
    /// When the last good answer came, in microseconds of the backend.
    pub at: Option<u64>,
    /// How long it took, in microseconds.
    pub took: Option<u64>,
    /// Counters of function 08 that were asked for, by their sub-function.
    pub counters: BTreeMap<u16, Counted>,
}

/// A counter that was asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Counted {
    /// No answer yet.
    Asked,
    /// Its value, and when it came, in microseconds of the backend.
    Value(u16, u64),
    /// Why it could not be read.
    Failed(String),
}

impl Unit {
    pub(super) fn new(info: DdcUnit) -> Self {
        Self {
            device: Device::from_key(&info.kind).unwrap_or_default(),
            info,
            image: Image::new(),
            outcome: None,
            text: String::new(),
            port: 0,
            fault: [None; 2],
            at: None,
            took: None,
            counters: BTreeMap::new(),
        }
    }

    /// Takes the answer to a counter in, or why there is none.
    pub(super) fn counted(&mut self, request: &[u8], response: &[u8], text: &str, at_us: u64) {
        let &[8, high, low, ..] = request else {
            return;
        };
        let sub = u16::from_be_bytes([high, low]);
        let counted = match counters::answer(request, response) {
            Some(counter) => Counted::Value(counter.value, at_us),
            None => Counted::Failed(text.to_owned()),
        };
        self.counters.insert(sub, counted);
    }

    /// Which of so many ports reach it.
    #[must_use]
    pub const fn reach(&self, ports: usize) -> Reach {
        reach(self.fault, ports)
    }

    /// When the newest of its registers was read, in microseconds of the backend.
    #[must_use]
    pub fn newest(&self) -> Option<u64> {
        self.image.iter().map(|(_, _, cell)| cell.at.get()).max()
    }

    /// When a register was read last, by its number.
    #[must_use]
    pub fn read_at(&self, number: u16) -> Option<u64> {
        register(&self.image, number).map(|cell| cell.at.get())
    }

    /// How its analog values are scaled, if somebody said it: as chosen here, else as the tag list of
    /// the bridge says.
    #[must_use]
    pub fn said_scaling(&self, chosen: Option<Scaling>) -> Option<Scaling> {
        let listed = || Scaling::from_key(self.info.scaling.as_deref()?);
        chosen.or_else(listed)
    }

    /// How its analog values are scaled: as somebody said, else in percent.
    #[must_use]
    pub fn scaling(&self, chosen: Option<Scaling>) -> Scaling {
        self.said_scaling(chosen).unwrap_or_default()
    }

    /// Its tag, or its address if it has none.
    #[must_use]
    pub fn name(&self) -> String {
        if self.info.tag.is_empty() {
            format!("unit {}", self.info.unit)
        } else {
            self.info.tag.clone()
        }
    }
}
