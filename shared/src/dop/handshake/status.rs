//! The status register: which object the device works on, and how far it is.
//!
//! The manual gives it eleven bits of object and three of status, and its figure, which would say
//! where these three stand, is lost (reading M2). One word can't tell: `0x1000` with the object is
//! "busy" if the status begins at bit 12 and "ready" if it begins at bit 11. A complete exchange
//! can: from busy to ready is a step of one at the right position.

use super::super::Request;

/// Where the three bits of the status begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shift {
    /// Bits 11 to 13.
    Eleven,
    /// Bits 12 to 14.
    Twelve,
    /// Bits 13 to 15.
    Thirteen,
}

impl Shift {
    /// All positions.
    pub const ALL: [Self; 3] = [Self::Eleven, Self::Twelve, Self::Thirteen];

    /// The position with this lowest bit.
    #[must_use]
    pub const fn new(bit: u8) -> Option<Self> {
        match bit {
            11 => Some(Self::Eleven),
            12 => Some(Self::Twelve),
            13 => Some(Self::Thirteen),
            _ => None,
        }
    }

    /// The lowest bit.
    #[must_use]
    pub const fn bit(self) -> u8 {
        match self {
            Self::Eleven => 11,
            Self::Twelve => 12,
            Self::Thirteen => 13,
        }
    }

    /// What a status word says if its status begins here.
    #[must_use]
    pub const fn read(self, word: u16) -> Status {
        // The five bits above the object; those that belong to no field must be zero.
        let (value, spare) = match self {
            Self::Eleven => ((word >> 11) & 7, word >> 14),
            Self::Twelve => ((word >> 12) & 7, (word >> 11) & 0b1_0001),
            Self::Thirteen => (word >> 13, (word >> 11) & 3),
        };
        match (value, spare) {
            (1, 0) => Status::Busy,
            (2, 0) => Status::Ready,
            (3, 0) => Status::Error,
            _ => Status::Undefined,
        }
    }

    /// The word of a status, for simulators and tests.
    #[must_use]
    pub const fn word(self, object: u16, value: u16) -> u16 {
        (object & 0x07FF) | ((value & 7) << self.bit())
    }
}

/// What the device says about a request.
/// Source: AIIOM000698-01, section 2.1.3; the values 0 and 4 to 7 are not defined (reading B20).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// 1: it works on it.
    Busy,
    /// 2: the data are there.
    Ready,
    /// 3: it can't; an error code is there.
    Error,
    /// Anything else.
    Undefined,
}

/// What is known about the place of the status bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Position {
    /// The profile says it.
    Configured(Shift),
    /// An exchange proved it.
    Learned(Shift),
    /// A status that did not change and data that were there speak for it.
    Likely(Shift),
    /// Nothing is known yet.
    #[default]
    Unknown,
}

impl Position {
    /// The position, as far as it is known.
    #[must_use]
    pub const fn shift(self) -> Option<Shift> {
        match self {
            Self::Configured(shift) | Self::Learned(shift) | Self::Likely(shift) => Some(shift),
            Self::Unknown => None,
        }
    }
}

/// A status word as far as it can be understood.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Meaning {
    /// The status is certain.
    Is(Status),
    /// "Ready" at this position, and "busy" at the next one.
    ReadyOrBusy(Shift),
}

/// Follows the status words of one request and learns where the status stands.
#[derive(Clone, Copy, Debug)]
pub struct Reader {
    position: Position,
    /// The five upper bits of the word before, since the last write.
    before: Option<u16>,
}

impl Reader {
    /// A reader that knows this much.
    #[must_use]
    pub const fn new(position: Position) -> Self {
        Self {
            position,
            before: None,
        }
    }

    /// What is known by now.
    #[must_use]
    pub const fn position(&self) -> Position {
        self.position
    }

    /// A request was written: what the register said before no longer counts.
    pub const fn restart(&mut self) {
        self.before = None;
    }

    /// Takes what speaks for a position for granted.
    pub const fn settle(&mut self, shift: Shift) {
        self.position = Position::Likely(shift);
    }

    /// Understands a status word that names our object.
    pub fn read(&mut self, word: u16) -> Meaning {
        let top = word >> 11;
        let before = self.before.replace(top);
        if let Some(shift) = self.position.shift() {
            let status = shift.read(word);
            let fixed = matches!(self.position, Position::Configured(_));
            let elsewhere = |s: &Shift| s.read(word) != Status::Undefined;
            if fixed || status != Status::Undefined || !Shift::ALL.iter().any(elsewhere) {
                return Meaning::Is(status);
            }
            // The word makes sense at another position only: learning begins anew.
            self.position = Position::Unknown;
        }
        let (shift, status) = match (before, top) {
            (_, 1) => (Shift::Eleven, Status::Busy),
            (_, 3) => (Shift::Eleven, Status::Error),
            (_, 6) => (Shift::Twelve, Status::Error),
            (_, 8) => (Shift::Thirteen, Status::Ready),
            (_, 12) => (Shift::Thirteen, Status::Error),
            // One step from busy to ready.
            (Some(2), 4) => (Shift::Twelve, Status::Ready),
            (_, 2) => return Meaning::ReadyOrBusy(Shift::Eleven),
            (_, 4) => return Meaning::ReadyOrBusy(Shift::Twelve),
            _ => return Meaning::Is(Status::Undefined),
        };
        self.position = Position::Learned(shift);
        Meaning::Is(status)
    }
}

/// The object that a status word is about.
#[must_use]
pub fn object_of(word: u16) -> u16 {
    Request::from_word(word).object()
}

/// What an error code of the device means; `None` for those that are not defined.
/// Source: AIIOM000698-01, section 2.1.3, in the order of reading B19.
#[must_use]
pub const fn error_text(code: u16) -> Option<&'static str> {
    Some(match code {
        0 => "no error",
        1 => "it does not handle this command",
        2 => "the object is too large",
        3 => "it does not have this option of the object",
        4 => "it could not queue the command",
        5 => "it could not be unlocked for writing",
        6 => "a parameter is out of range",
        7 => "it could not save",
        8 => "it could not execute the command",
        9 => "writing is not allowed now",
        10 => "the link to its DOP board is busy",
        11 => "its DOP board did not answer in time",
        12 => "the request to its DOP board failed",
        13 => "its DOP board answered something invalid",
        14 => "the number of parameters is wrong",
        _ => return None,
    })
}
