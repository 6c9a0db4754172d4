//! What can be wrong with a HART frame, or worth knowing about it.

use core::fmt;

use super::model::Effect;
use crate::problem::Severity;

/// One finding. The numbers are the ones that its sentence needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Hart {
    /// The check byte differs from the one computed.
    Check {
        /// As received.
        got: u8,
        /// As computed.
        want: u8,
    },
    /// All but the check byte is there.
    CheckMissing {
        /// What it would be.
        want: u8,
    },
    /// The byte count is wrong, and the check byte proves it.
    Count {
        /// As received.
        got: u8,
        /// What the bytes say.
        want: u8,
        /// True if the sender counted wrong.
        sent: bool,
    },
    /// The delimiter is gone with the preamble.
    Start {
        /// The delimiter with which the check byte holds.
        delimiter: u8,
    },
    /// Fewer preamble bytes than a sender must send.
    Preamble {
        /// How many there are.
        got: u16,
    },
    /// The same request again.
    Again,
    /// The device reports an error of the line in the request.
    Line,
    /// The device answered with a code other than success.
    Code {
        /// The code.
        code: u8,
        /// What it means, empty if nobody knows.
        words: &'static str,
        /// True if no data follow.
        error: bool,
    },
    /// Data behind a code that lets none follow.
    Unasked {
        /// How many bytes.
        len: u16,
    },
    /// The data are not as long as any form of the command.
    Length {
        /// How many bytes there are.
        got: u16,
        /// The nearest length.
        want: u16,
    },
    /// The command is not in the tables.
    Unknown {
        /// Its number.
        number: u16,
    },
    /// The manual does not list the command for this family.
    NotListed {
        /// Its number.
        number: u16,
    },
    /// What a request may do.
    Does {
        /// The worst of it.
        effect: Effect,
    },
    /// A field that has one value only has another.
    Expected {
        /// As received.
        got: u32,
        /// What is expected.
        want: u32,
    },
}

impl Hart {
    /// How bad it is.
    #[must_use]
    pub const fn severity(self) -> Severity {
        match self {
            Self::Check { .. }
            | Self::CheckMissing { .. }
            | Self::Count { .. }
            | Self::Start { .. } => Severity::Error,
            Self::Unasked { .. } | Self::Length { .. } | Self::Expected { .. } => Severity::Warning,
            Self::Preamble { .. }
            | Self::Again
            | Self::Line
            | Self::Code { .. }
            | Self::Unknown { .. }
            | Self::NotListed { .. }
            | Self::Does { .. } => Severity::Note,
        }
    }

    /// The frozen identifier used in JSON.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Check { .. } => "check-mismatch",
            Self::CheckMissing { .. } => "check-missing",
            Self::Count { .. } => "count-mismatch",
            Self::Start { .. } => "start-missing",
            Self::Preamble { .. } => "short-preamble",
            Self::Again => "same-request-again",
            Self::Line => "communication-error",
            Self::Code { error: true, .. } => "response-error",
            Self::Code { error: false, .. } => "response-warning",
            Self::Unasked { .. } => "data-after-error",
            Self::Length { .. } => "data-length",
            Self::Unknown { .. } => "unknown-command",
            Self::NotListed { .. } => "not-listed",
            Self::Does { .. } => "effect",
            Self::Expected { .. } => "unexpected-value",
        }
    }
}

impl fmt::Display for Hart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Check { got, want } => write!(
                f,
                "The check byte is {got:02X}, computed from the delimiter on it is {want:02X}. The frame was damaged on the way; don't trust its values."
            ),
            Self::CheckMissing { want } => write!(
                f,
                "The frame ends one byte early. If only the check byte is missing, it would be {want:02X}."
            ),
            Self::Count {
                got,
                want,
                sent: true,
            } => write!(
                f,
                "The byte count says {got}, but {want} bytes follow and the check byte holds with the wrong count: whoever sent the frame counted wrong."
            ),
            Self::Count { got, want, .. } => write!(
                f,
                "The byte count says {got}, but {want} bytes follow; with {want} in its place the check byte holds. The count changed on the way."
            ),
            Self::Start { delimiter } => write!(
                f,
                "The frame begins with its address: preamble and delimiter were lost. With the delimiter {delimiter:02X} in front the check byte holds. A modem that is slow to notice the carrier does this."
            ),
            Self::Preamble { got: 0 } => write!(f, "No preamble: it was lost or not recorded."),
            Self::Preamble { got } => write!(
                f,
                "Only {got} of at least 5 preamble bytes are there: the others were lost while the modem found the carrier."
            ),
            Self::Again => write!(
                f,
                "The same request directly before: the echo of a half-duplex modem, or a repetition because no answer came."
            ),
            Self::Line => write!(
                f,
                "The device did not understand the request; the bits say what it noticed on the line. A master repeats the request."
            ),
            Self::Code { code, words, error } => {
                write!(
                    f,
                    "The device answers with {} {code}",
                    if error { "error" } else { "warning" }
                )?;
                if words.is_empty() {
                    write!(f, ", of which no meaning is known for this command.")
                } else {
                    write!(f, ": {words}.")
                }
            }
            Self::Unasked { len } => write!(
                f,
                "{len} byte(s) of data follow a response code that lets none follow."
            ),
            Self::Length { got, want } => write!(
                f,
                "{got} byte(s) of data are not a length that this command has; {want} would be the nearest."
            ),
            Self::Unknown { number } => write!(
                f,
                "Command {number} is not in the tables; its data are shown raw."
            ),
            Self::NotListed { number } => write!(
                f,
                "The manual does not list command {number} for this actuator; expect response code 64."
            ),
            Self::Does { effect } => write!(f, "This command {}.", effect.label()),
            Self::Expected { got, want } => write!(f, "The value is {got}, expected is {want}."),
        }
    }
}
