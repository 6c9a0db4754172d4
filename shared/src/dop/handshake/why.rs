//! Why an object could not be read, in words.

use super::Handshake;
use super::status::{Shift, Status, error_text, object_of};
use crate::pdu::names;
use crate::proto::Outcome;
use core::fmt;

/// One of the areas of registers that serve the diagnostic objects, with its address.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Area {
    /// Where the request is written.
    Request(u16),
    /// Where the device says how far it is.
    Status(u16),
    /// How many registers the response has.
    Count(u16),
    /// The response.
    Response(u16),
}

impl fmt::Display for Area {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Request(at) => write!(f, "the request register (address {at})"),
            Self::Status(at) => write!(f, "the status register (address {at})"),
            Self::Count(at) => write!(f, "the count register (address {at})"),
            Self::Response(at) => write!(f, "the response registers (from address {at})"),
        }
    }
}

/// Why an object could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Why {
    /// The device gave this error code.
    Code(u16),
    /// The device refused a Modbus request.
    Exception {
        /// What was written or read.
        area: Area,
        /// The exception.
        code: u8,
    },
    /// A Modbus request got no sound answer.
    Lost {
        /// What was written or read.
        area: Area,
        /// How it ended.
        outcome: Outcome,
        /// What the line says about it.
        text: String,
    },
    /// It was busy for so many microseconds.
    Busy(u64),
    /// The status never showed our object; the last word.
    NotTaken(u16),
    /// Another master asked for this object meanwhile.
    Foreign(u16),
    /// The status changed while the data were read; the last word.
    Changed(u16),
    /// The status has no meaning; the last word.
    Undefined(u16),
    /// So many registers there can't be.
    Count(u16),
    /// The response would go beyond address 65535.
    Address,
}

impl Why {
    /// The error code of the device.
    #[must_use]
    pub const fn code(&self) -> Option<u16> {
        match self {
            Self::Code(code) => Some(*code),
            _ => None,
        }
    }

    /// The kind of failure; `Ok` where the device answered with an error of its own.
    #[must_use]
    pub const fn outcome(&self) -> Outcome {
        match self {
            Self::Code(_) => Outcome::Ok,
            Self::Exception { .. } => Outcome::Exception,
            Self::Lost { outcome, .. } => *outcome,
            Self::Busy(_) | Self::NotTaken(_) => Outcome::Silence,
            Self::Address => Outcome::Refused,
            Self::Foreign(_) | Self::Changed(_) | Self::Undefined(_) | Self::Count(_) => {
                Outcome::Damaged
            }
        }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Code(code) => match error_text(*code) {
                Some(text) => write!(f, "the device answered with error {code}: {text}"),
                None => write!(
                    f,
                    "the device answered with error {code}, which is not defined"
                ),
            },
            Self::Exception { area, code } => {
                write!(f, "the device refused {area} with exception {code:02}")?;
                match names::exception(*code) {
                    Some((name, _)) => write!(f, ", {}", name.to_ascii_lowercase())?,
                    None => f.write_str(", which the standard does not know")?,
                }
                if *code == 2 {
                    f.write_str("; check the addresses in the profile")?;
                }
                Ok(())
            }
            Self::Lost { area, text, .. } => write!(f, "{area}: {text}"),
            Self::Busy(micros) => {
                let ms = micros.checked_div(1000).unwrap_or(0);
                write!(
                    f,
                    "the device was still busy after {ms} ms; give it more time with \
                     reading.timeout_ms, or check status.shift"
                )
            }
            Self::NotTaken(word) => write!(
                f,
                "the device did not take up the request; its status stayed at 0x{word:04X}"
            ),
            Self::Foreign(object) => write!(
                f,
                "another master asked for object {object} in between, again and again"
            ),
            Self::Changed(word) => write!(
                f,
                "the status changed to 0x{word:04X} while the data were read, again and again"
            ),
            Self::Undefined(word) => {
                write!(f, "the status 0x{word:04X} has no meaning")?;
                let other = Shift::ALL
                    .into_iter()
                    .find(|s| s.read(*word) != Status::Undefined);
                match other {
                    Some(shift) => write!(
                        f,
                        " where the profile has it; it would have one with status.shift {}",
                        shift.bit()
                    ),
                    None => write!(f, " for object {}", object_of(*word)),
                }
            }
            Self::Count(count) => write!(
                f,
                "the device counts {count} response registers, and there are 512 at most; check \
                 the address of the count register"
            ),
            Self::Address => f.write_str("the response registers go beyond address 65535"),
        }
    }
}

impl Handshake {
    /// How it went or goes, in words.
    #[must_use]
    pub fn text(&self) -> String {
        let course = self.course();
        let mut text = match self.outcome() {
            None => match self.step() {
                crate::proto::DopStep::Requesting if course.retries > 0 => {
                    "asking again".to_owned()
                }
                crate::proto::DopStep::Requesting => "asking".to_owned(),
                crate::proto::DopStep::Busy => "the device works on it".to_owned(),
                crate::proto::DopStep::Counting => "ready".to_owned(),
                crate::proto::DopStep::Reading => "reading".to_owned(),
            },
            Some(Ok(words)) => format!(
                "{} registers in {} block{}, {} ms",
                words.len(),
                course.blocks,
                if course.blocks == 1 { "" } else { "s" },
                course.took().checked_div(1000).unwrap_or(0)
            ),
            Some(Err(why)) => why.to_string(),
        };
        if let (Some(object), 1..) = (course.foreign_object, course.foreign) {
            text.push_str(&format!(
                "; another master asked for object {object} in between"
            ));
        }
        if course.retries > 0 {
            text.push_str(&match course.retries {
                1 => "; asked again once".to_owned(),
                n => format!("; asked again {n} times"),
            });
        }
        if let super::Position::Likely(shift) = self.position() {
            text.push_str(&format!(
                "; the status seems to begin at bit {}, which no exchange has proved yet",
                shift.bit()
            ));
        }
        text
    }
}
