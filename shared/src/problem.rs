//! What is wrong with bytes, pinned to the bytes.
//!
//! A problem is small, `Copy` and comparable; its sentence is written when somebody reads it.

mod text;

use crate::place::Place;

/// How bad a problem is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing; nothing is wrong.
    Note,
    /// Against a rule, but the bytes can still be understood.
    Warning,
    /// The bytes can't be trusted or understood.
    Error,
}

impl Severity {
    /// `note`, `warning` or `error`.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// What recomputation proved about a wrong check value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cause {
    /// Nothing could be proved.
    Unknown,
    /// The two bytes of the CRC stand in the wrong order.
    Swapped,
    /// One bit changed on the way: byte (from the start of the frame) and bit number.
    OneBit(u16, u8),
    /// The frame is complete but for its check bytes.
    Missing,
}

/// One finding. The numbers are the ones that its sentence needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Finding {
    /// Bytes that belong to no frame.
    Noise {
        /// How many.
        len: u32,
    },
    /// The CRC differs from the one computed.
    Crc {
        /// As received.
        got: u16,
        /// As computed.
        want: u16,
        /// What recomputation proved.
        cause: Cause,
    },
    /// The LRC differs from the one computed.
    Lrc {
        /// As received.
        got: u8,
        /// As computed.
        want: u8,
    },
    /// The frame ends before it is complete.
    Truncated {
        /// Bytes (ASCII: characters) that are missing at least.
        missing: u16,
    },
    /// Bytes after the end of what the function defines.
    Surplus {
        /// How many.
        len: u16,
    },
    /// A length or count field disagrees with the bytes that are there.
    Count {
        /// As transmitted.
        got: u16,
        /// What the other bytes say.
        want: u16,
    },
    /// The quantity is outside the range of the function.
    Quantity {
        /// As transmitted.
        got: u16,
        /// Largest allowed.
        max: u16,
    },
    /// Start address and quantity go beyond the last address.
    PastEnd {
        /// First address.
        start: u16,
        /// Quantity asked for.
        count: u16,
        /// Number of addresses in the table.
        limit: u32,
    },
    /// The function code is not in the standard; its length is a guess held by the check value.
    UnknownFunction {
        /// The code.
        code: u8,
    },
    /// A sub-function or MEI type is not in the standard.
    UnknownSub {
        /// The code.
        code: u16,
    },
    /// The device does not implement this function; it answers exception 01.
    NotImplemented {
        /// The code.
        code: u8,
    },
    /// No request for this response is known, so addresses are not known either.
    NoRequest,
    /// Request and response of this function look alike and nothing tells which it is.
    EitherRole,
    /// Read as a request although it would be a valid response too, or the other way round.
    Ambiguous,
    /// A read was sent to everybody; nobody may answer.
    BroadcastRead,
    /// Unit addresses 248 to 255 are reserved by the standard.
    ReservedUnit {
        /// The address.
        unit: u8,
    },
    /// The response differs in amount from what the request asked for.
    NotAsAsked {
        /// Bytes received.
        got: u16,
        /// Bytes asked for.
        want: u16,
    },
    /// An echoed field differs from the request.
    EchoDiffers {
        /// As received.
        got: u16,
        /// As sent.
        want: u16,
    },
    /// The value of a single coil is neither `FF00` nor `0000`.
    CoilValue {
        /// As transmitted.
        got: u16,
    },
    /// A value that the field can't have.
    FieldValue {
        /// As transmitted.
        got: u32,
        /// What is allowed.
        allowed: &'static str,
    },
    /// Bits beyond the quantity are set.
    PaddingBits,
    /// The protocol identifier of a TCP frame is not 0.
    Protocol {
        /// As transmitted.
        got: u16,
    },
    /// A character that is no hexadecimal digit.
    BadDigit,
    /// A line of Modbus ASCII without CR LF.
    NoLineEnd,
    /// The device answered with an exception.
    Exception {
        /// The exception code.
        code: u8,
    },
    /// The value is outside its range.
    Range {
        /// Raw value.
        got: i64,
        /// Smallest allowed.
        min: i32,
        /// Largest allowed.
        max: i32,
    },
    /// The code has no name.
    NoName {
        /// The code.
        code: u32,
    },
    /// Digits of a date, time or text are not what they can be.
    BadDigits {
        /// What the bytes should have been: `a BCD date`.
        what: &'static str,
    },
    /// The address is not in the device's map.
    NotInMap,
    /// Only some words of a value are in the frame.
    Part {
        /// Words of the whole value.
        words: u16,
    },
    /// Bits are set that the manual calls not used.
    UnusedBits {
        /// Those bits.
        bits: u32,
    },
    /// The byte count of a report is short by two, as the ICON3000 manual prints it.
    ReportCount {
        /// As transmitted.
        got: u16,
        /// Bytes that follow.
        want: u16,
    },
    /// Diagnostic object: the number of registers is not that of the layout.
    Registers {
        /// As received.
        got: u16,
        /// As the layout has.
        want: u16,
    },
    /// Diagnostic object: the number of records of a log is not that of its registers.
    Records {
        /// As transmitted.
        got: u16,
        /// Whole records that there are.
        want: u16,
    },
    /// Diagnostic object: no layout is known for this request.
    NoLayout,
    /// Diagnostic object: the unit answered with an error code.
    DopError {
        /// The code.
        code: u16,
    },
    /// A time before 2000 or after 2099.
    OddTime,
    /// Pasted text: an odd number of hexadecimal digits.
    OddDigits,
    /// Pasted text: a single digit was taken as a byte.
    LoneDigit,
    /// Pasted text: characters that are no bytes.
    NotHex {
        /// How many words.
        words: u32,
    },
    /// Nothing to decode.
    Empty,
    /// A finding about a HART frame.
    #[cfg(feature = "hart")]
    Hart(crate::hart::problem::Hart),
}

/// A finding with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Problem {
    /// What it is.
    pub finding: Finding,
    /// The bytes it is about, counted from the start of the frame (or noise).
    pub place: Place,
}

impl Problem {
    /// Pins a finding to bytes.
    #[must_use]
    pub const fn new(finding: Finding, place: Place) -> Self {
        Self { finding, place }
    }

    /// How bad it is.
    #[must_use]
    pub const fn severity(&self) -> Severity {
        use Finding as F;
        match self.finding {
            #[cfg(feature = "hart")]
            F::Hart(finding) => finding.severity(),
            F::Noise { .. }
            | F::Crc { .. }
            | F::Lrc { .. }
            | F::Truncated { .. }
            | F::Surplus { .. }
            | F::Count { .. }
            | F::Protocol { .. }
            | F::BadDigit
            | F::NotAsAsked { .. }
            | F::CoilValue { .. }
            | F::Registers { .. }
            | F::Records { .. }
            | F::NoLayout
            | F::OddDigits
            | F::NotHex { .. }
            | F::Empty => Severity::Error,
            F::Quantity { .. }
            | F::PastEnd { .. }
            | F::UnknownSub { .. }
            | F::UnknownFunction { .. }
            | F::Ambiguous
            | F::BroadcastRead
            | F::ReservedUnit { .. }
            | F::EchoDiffers { .. }
            | F::FieldValue { .. }
            | F::PaddingBits
            | F::Range { .. }
            | F::NoName { .. }
            | F::BadDigits { .. }
            | F::OddTime
            | F::LoneDigit => Severity::Warning,
            F::NotImplemented { .. }
            | F::NoLineEnd
            | F::NoRequest
            | F::EitherRole
            | F::Exception { .. }
            | F::NotInMap
            | F::Part { .. }
            | F::UnusedBits { .. }
            | F::ReportCount { .. }
            | F::DopError { .. } => Severity::Note,
        }
    }

    /// The frozen identifier used in JSON: `crc-mismatch`.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        use Finding as F;
        match self.finding {
            #[cfg(feature = "hart")]
            F::Hart(finding) => finding.code(),
            F::Noise { .. } => "noise",
            F::Crc {
                cause: Cause::Missing,
                ..
            } => "crc-missing",
            F::Crc { .. } => "crc-mismatch",
            F::Lrc { .. } => "lrc-mismatch",
            F::Truncated { .. } => "truncated",
            F::Surplus { .. } => "surplus-bytes",
            F::Count { .. } => "count-mismatch",
            F::Quantity { .. } => "quantity-out-of-range",
            F::PastEnd { .. } => "past-end",
            F::UnknownFunction { .. } => "unknown-function",
            F::UnknownSub { .. } => "unknown-sub-function",
            F::NotImplemented { .. } => "not-implemented",
            F::NoRequest => "request-unknown",
            F::EitherRole => "role-unknown",
            F::Ambiguous => "ambiguous",
            F::BroadcastRead => "broadcast-read",
            F::ReservedUnit { .. } => "reserved-unit",
            F::NotAsAsked { .. } => "not-as-asked",
            F::EchoDiffers { .. } => "echo-differs",
            F::CoilValue { .. } => "coil-value",
            F::FieldValue { .. } => "field-value",
            F::PaddingBits => "padding-bits",
            F::Protocol { .. } => "protocol-id",
            F::BadDigit => "bad-digit",
            F::NoLineEnd => "no-line-end",
            F::Exception { .. } => "exception",
            F::Range { .. } => "out-of-range",
            F::NoName { .. } => "unknown-code",
            F::BadDigits { .. } => "bad-digits",
            F::NotInMap => "not-in-map",
            F::Part { .. } => "part-of-value",
            F::UnusedBits { .. } => "unused-bits",
            F::ReportCount { .. } => "report-count",
            F::Registers { .. } => "register-count",
            F::Records { .. } => "record-count",
            F::NoLayout => "no-layout",
            F::DopError { .. } => "dop-error",
            F::OddTime => "odd-time",
            F::OddDigits => "odd-hex-digits",
            F::LoneDigit => "lone-hex-digit",
            F::NotHex { .. } => "not-hex",
            F::Empty => "empty",
        }
    }
}
