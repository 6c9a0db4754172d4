//! What takes several frames: identifying a device, trimming its loop current, its condensed status
//! map, simulated status, forced values, delayed answers.
//!
//! [`Procedures`] goes over the frames of a line once, in order, and says of each to which
//! procedure it belongs and what it does there:
//!
//! ```
//! use shared::frame::Framing;
//! use shared::hart::procedure::{Procedure, Procedures};
//!
//! let mut procedures = Procedures::new();
//! // Command 40 fixes 4 mA, and the device agrees.
//! let asks = [0x82, 0xAE, 0xDD, 1, 0x23, 0x45, 40, 4, 0x40, 0x80, 0, 0, 0x7A];
//! let step = procedures.frame(Framing::Hart, &asks, 0).unwrap();
//! assert_eq!((step.procedure, step.run, step.key), (Procedure::Trim, 1, "fix-current"));
//! assert_eq!(step.text, "Asks to fix the loop current at 4 mA.");
//! let agrees = [0x86, 0xAE, 0xDD, 1, 0x23, 0x45, 40, 6, 0, 8, 0x40, 0x80, 0, 0, 0x74];
//! let step = procedures.frame(Framing::Hart, &agrees, 1).unwrap();
//! assert_eq!(step.text, "The loop current is fixed at 4 mA; the valve follows it.");
//! // The list ends here, and the mode still stands.
//! let open = procedures.open();
//! assert_eq!((open[0].procedure, open[0].since), (Procedure::Trim, 1));
//! ```
//!
//! Only sound frames are to be passed in. A mode counts from the answer of the device on, not from
//! the request. What went on before the list began is not known, and said so where it matters.

mod follow;
mod words;

use core::fmt::{self, Write};

use super::frame::Address;
use crate::json::Quoted;
use crate::problem::Severity;

pub use follow::Procedures;

/// A procedure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Procedure {
    /// Commands 0, 11 or 21, then what the device says about itself.
    Identify,
    /// Command 40 with a current, 45 and 46, command 40 with 0.
    Trim,
    /// Commands 523 to 525: the condensed status map.
    StatusMap,
    /// Commands 526 and 527: simulated status bits.
    StatusSimulation,
    /// Command 79: a forced device variable.
    ForcedVariable,
    /// Command 132 with bit 5, until it is sent without.
    DigitalControl,
    /// Command 48 with the bytes last read.
    Acknowledge,
    /// Response codes 33 and 34: the device needs longer.
    Delayed,
}

impl Procedure {
    /// The word used in JSON.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Identify => "identify",
            Self::Trim => "trim",
            Self::StatusMap => "status-map",
            Self::StatusSimulation => "status-simulation",
            Self::ForcedVariable => "forced-variable",
            Self::DigitalControl => "digital-control",
            Self::Acknowledge => "acknowledge",
            Self::Delayed => "delayed-response",
        }
    }

    /// True if it leaves something standing in the device until it is ended.
    #[must_use]
    pub const fn lasts(self) -> bool {
        match self {
            Self::Identify | Self::StatusMap | Self::Acknowledge => false,
            Self::Trim
            | Self::StatusSimulation
            | Self::ForcedVariable
            | Self::DigitalControl
            | Self::Delayed => true,
        }
    }

    /// What people read.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Identify => "Identification",
            Self::Trim => "Fixed current and trim",
            Self::StatusMap => "Condensed status map",
            Self::StatusSimulation => "Status simulation",
            Self::ForcedVariable => "Forced variable",
            Self::DigitalControl => "Digital control",
            Self::Acknowledge => "Acknowledgement of status",
            Self::Delayed => "Delayed response",
        }
    }
}

/// Something about a step that one should know.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// The device refused with this response code.
    Refused(u8),
    /// The device reports that the request came in damaged.
    Damaged,
    /// The request before it changes something and got no answer: whether it was done is not known.
    Unanswered(u16),
    /// The loop current was not fixed in this list.
    NotFixed,
    /// The current that is fixed is not near the end point that is trimmed: fixed, wanted, in mA.
    OtherEnd(f32, f32),
    /// Status simulation was not switched on in this list.
    NotSimulated,
    /// Entries of the map from this to that index were left out between two pages.
    Skipped(u8, u8),
    /// The other master began the procedure.
    OtherMaster,
    /// The device forgot it by a reset.
    Reset,
}

impl Doubt {
    /// The frozen identifier used in JSON.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Refused(_) => "refused",
            Self::Damaged => "damaged",
            Self::Unanswered(_) => "unanswered",
            Self::NotFixed => "not-fixed",
            Self::OtherEnd(..) => "other-end",
            Self::NotSimulated => "not-simulated",
            Self::Skipped(..) => "skipped",
            Self::OtherMaster => "other-master",
            Self::Reset => "reset",
        }
    }

    /// How bad it is.
    #[must_use]
    pub const fn severity(self) -> Severity {
        match self {
            Self::Refused(_) | Self::Damaged | Self::Reset => Severity::Note,
            _ => Severity::Warning,
        }
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Refused(code) => write!(
                f,
                "The device refused with response code {code}: the step was not taken."
            ),
            Self::Damaged => write!(
                f,
                "The request reached the device damaged: the step was not taken; a master repeats it."
            ),
            Self::Unanswered(command) => write!(
                f,
                "Command {command} before it got no answer: whether the device took that step is not known."
            ),
            Self::NotFixed => write!(
                f,
                "No fixed current was seen before: what flows on the loop now counts as the measured current."
            ),
            Self::OtherEnd(fixed, wanted) => write!(
                f,
                "The current is fixed at {fixed} mA, while this trim is for {wanted} mA."
            ),
            Self::NotSimulated => write!(
                f,
                "Status simulation was not seen to be switched on before; without it the device refuses."
            ),
            Self::Skipped(from, to) => {
                write!(f, "Entries {from} to {to} of the map were left out.")
            }
            Self::OtherMaster => write!(f, "The other master began this procedure."),
            Self::Reset => write!(f, "The reset ends every forced mode and simulation."),
        }
    }
}

/// What a frame does in a procedure.
#[derive(Clone, Debug, PartialEq)]
pub struct Step {
    /// Which procedure.
    pub procedure: Procedure,
    /// Number of the run of it, from 1 on; frames of one run have the same.
    pub run: u32,
    /// Frozen identifier of the step.
    pub key: &'static str,
    /// The step in words.
    pub text: String,
    /// What one should know about it.
    pub doubts: Vec<Doubt>,
}

impl Step {
    /// The step as a JSON object.
    ///
    /// # Errors
    /// Only if writing fails.
    pub fn write_json(&self, out: &mut impl Write) -> fmt::Result {
        write!(
            out,
            r#"{{"name":"{}","run":{},"step":"{}","text":{},"warnings":["#,
            self.procedure.key(),
            self.run,
            self.key,
            Quoted(&self.text)
        )?;
        for (at, doubt) in self.doubts.iter().enumerate() {
            let comma = if at > 0 { "," } else { "" };
            write!(
                out,
                r#"{comma}{{"severity":"{}","code":"{}","text":{}}}"#,
                doubt.severity().key(),
                doubt.code(),
                Quoted(&doubt.to_string())
            )?;
        }
        out.write_str("]}")
    }
}

/// A procedure that was begun and not ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Open {
    /// Which procedure.
    pub procedure: Procedure,
    /// Number of the run.
    pub run: u32,
    /// Which device.
    pub address: Address,
    /// Index of the frame that began it.
    pub since: u32,
}

impl fmt::Display for Open {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.procedure {
            Procedure::Trim => {
                "Fixed current mode was not left again: the valve may still follow a simulated signal"
            }
            Procedure::StatusSimulation => {
                "Status simulation was not switched off again: the status may still be simulated"
            }
            Procedure::ForcedVariable => {
                "The forced variable was not given back: the valve may still stand at a forced value"
            }
            Procedure::DigitalControl => {
                "Digital control was not given back: the valve may still ignore its signal"
            }
            Procedure::Delayed => "The device did not finish what it had begun",
            Procedure::Identify | Procedure::StatusMap | Procedure::Acknowledge => {
                "The procedure was not finished"
            }
        };
        write!(
            f,
            "{what} (device {}, since frame {}).",
            self.address, self.since
        )
    }
}

impl Open {
    /// The same as a line of JSON, without line end.
    ///
    /// # Errors
    /// Only if writing fails.
    pub fn write_json(&self, out: &mut impl Write) -> fmt::Result {
        write!(
            out,
            r#"{{"kind":"procedure","name":"{}","run":{},"address":"{}","since":{},"severity":"warning","code":"not-left","text":{}}}"#,
            self.procedure.key(),
            self.run,
            self.address,
            self.since,
            Quoted(&self.to_string())
        )
    }
}
