//! The sentences of problems.

use core::fmt;

use super::{Cause, Finding, Problem};

impl fmt::Display for Problem {
    /// What happened, and where it helps, what to do next.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use Finding as F;
        match self.finding {
            #[cfg(feature = "hart")]
            F::Hart(finding) => write!(f, "{finding}"),
            F::Noise { len: 1 } => write!(
                f,
                "1 byte belongs to no frame: no function code, length and check value fit here."
            ),
            F::Noise { len } => write!(
                f,
                "{len} bytes belong to no frame: no function code, length and check value fit here."
            ),
            F::Crc { got, want, cause } => {
                let ([g0, g1], [w0, w1]) = (got.to_le_bytes(), want.to_le_bytes());
                if cause == Cause::Missing {
                    return write!(
                        f,
                        "The two CRC bytes are missing; the frame is complete otherwise. They would be {w0:02X} {w1:02X}."
                    );
                }
                write!(
                    f,
                    "The CRC is {g0:02X} {g1:02X}, computed over the bytes before it is {w0:02X} {w1:02X}."
                )?;
                match cause {
                    Cause::Swapped => write!(
                        f,
                        " The two bytes stand in the wrong order: the low byte goes first."
                    ),
                    Cause::OneBit(byte, bit) => {
                        write!(f, " One flipped bit explains it: byte {byte}, bit {bit}.")
                    }
                    Cause::Unknown | Cause::Missing => write!(
                        f,
                        " The frame was damaged on the way, or is not Modbus RTU; don't trust its values."
                    ),
                }
            }
            F::Lrc { got, want } => write!(
                f,
                "The LRC is {got:02X}, computed over the bytes before it is {want:02X}. The frame was damaged on the way; don't trust its values."
            ),
            F::Truncated { missing: 1 } => {
                write!(f, "The frame ends too early: at least 1 byte is missing.")
            }
            F::Truncated { missing } => write!(
                f,
                "The frame ends too early: at least {missing} bytes are missing."
            ),
            F::Surplus { len } => write!(f, "{len} byte(s) more than this function defines."),
            F::Count { got, want } => write!(
                f,
                "The count says {got}, the bytes that are there say {want}."
            ),
            F::Quantity { got, max } => write!(
                f,
                "A quantity of {got} is outside 1 to {max}; a device answers exception 03."
            ),
            F::PastEnd {
                start,
                count,
                limit,
            } => write!(
                f,
                "{count} from address {start} goes beyond the last address {}; the device answers exception 02.",
                limit.saturating_sub(1)
            ),
            F::UnknownFunction { code } => write!(
                f,
                "Function code {code} (0x{code:02X}) is not in the Modbus standard. Where the frame ends is a guess that its check value supports; the data are shown raw."
            ),
            F::UnknownSub { code } => write!(
                f,
                "Sub-function {code} (0x{code:04X}) is not in the Modbus standard; its data are shown raw."
            ),
            F::NotImplemented { code } => write!(
                f,
                "This device does not implement function code {code}; it answers exception 01."
            ),
            F::NoRequest => write!(
                f,
                "The request is not known, and a response does not carry addresses. Paste the request before it to see what the values mean."
            ),
            F::EitherRole => write!(
                f,
                "Request and response of this function look the same; nothing tells which one this is."
            ),
            F::Ambiguous => write!(
                f,
                "These bytes are valid as a request and as a response; the more likely one is shown."
            ),
            F::BroadcastRead => write!(
                f,
                "A read to unit 0 (broadcast) gets no answer from anybody."
            ),
            F::ReservedUnit { unit } => write!(
                f,
                "Unit address {unit} is outside 1 to 247, the range of the standard."
            ),
            F::NotAsAsked { got, want } => write!(
                f,
                "The request asked for {want} data byte(s), the response carries {got}. It belongs to another request, or the device is at fault."
            ),
            F::EchoDiffers { got, want } => write!(
                f,
                "The response should repeat the request, which had {want} (0x{want:04X}); it has {got} (0x{got:04X})."
            ),
            F::CoilValue { got } => write!(
                f,
                "A coil is written with FF00 (on) or 0000 (off), not with {got:04X}; a device answers exception 03."
            ),
            F::FieldValue { got, allowed } => write!(
                f,
                "{got} (0x{got:X}) is not allowed here; the standard has {allowed}."
            ),
            F::PaddingBits => write!(f, "Bits beyond the quantity are set; they should be 0."),
            F::Protocol { got } => write!(f, "The protocol identifier is {got}, Modbus TCP has 0."),
            F::BadDigit => write!(f, "A character that is no hexadecimal digit."),
            F::NoLineEnd => write!(
                f,
                "The line does not end with CR LF, as it must on the wire; copied text often loses it."
            ),
            F::Exception { code } => write!(
                f,
                "The device refused: exception {code:02X}, {}.",
                crate::pdu::names::exception(code)
                    .map_or("a code that the standard does not know", |e| e.1)
            ),
            F::Range { got, min, max } => {
                write!(f, "The raw value {got} is outside {min} to {max}.")
            }
            F::NoName { code } => write!(f, "The manual has no text for the value {code}."),
            F::BadDigits { what } => write!(f, "The bytes are not {what}."),
            F::NotInMap => write!(f, "The device's map has nothing at this address."),
            F::Part { words } => write!(f, "Only a part of a value of {words} registers was read."),
            F::UnusedBits { bits } => write!(
                f,
                "Bits that the manual calls not used are set: 0x{bits:04X}."
            ),
            F::ReportCount { got, want } => write!(
                f,
                "The byte count says {got}, {want} bytes follow; this device counts without unit id and run indicator (reading E63)."
            ),
            F::Registers { got, want } if got < want => write!(
                f,
                "{got} registers are here, this object has {want}: what is missing has no value."
            ),
            F::Registers { got, want } => write!(
                f,
                "{got} registers are here, this object has {want}: what comes after them is shown raw."
            ),
            F::Records { got, want } => write!(
                f,
                "The response says {got} record(s), its registers hold {want} whole one(s)."
            ),
            F::NoLayout => write!(
                f,
                "No object and option of the manual is asked for, so the registers are shown raw. Check the request word."
            ),
            F::DopError { code } => write!(
                f,
                "The actuator answered with error {code}: {}.",
                crate::dop::error_name(code).unwrap_or("not in the manual")
            ),
            F::OddTime => write!(
                f,
                "A time outside the years 2000 to 2099. The clock was not set, or epoch or unit of time are other ones (reading C16, profile key time)."
            ),
            F::OddDigits => write!(
                f,
                "An odd number of hexadecimal digits: the last one has no partner and is left out. Check whether a digit was lost when copying."
            ),
            F::LoneDigit => write!(
                f,
                "A single hexadecimal digit was taken as a byte with a leading 0."
            ),
            F::NotHex { words: 1 } => write!(f, "1 word is not hexadecimal and was skipped."),
            F::NotHex { words } => write!(f, "{words} words are not hexadecimal and were skipped."),
            F::Empty => write!(
                f,
                "There are no bytes here. Paste hexadecimal bytes such as 01 03 00 00 00 02 C4 0B, Modbus ASCII lines that begin with a colon, or drop a file."
            ),
        }
    }
}
