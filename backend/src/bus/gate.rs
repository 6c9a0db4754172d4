//! The last thing that stands before a line: only reads pass.
//!
//! Above this there is no type that could say anything but a read; this holds even if somebody
//! adds one. It looks at the bytes themselves.

use shared::decode::pdu_of;
use shared::frame::Framing;

/// A frame that is not a read. It never leaves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("function code {function:02} is not a read and was not sent; this program only reads")]
pub struct NotARead {
    /// What the frame would have asked for.
    pub function: u8,
}

/// True for PDUs that change nothing in a device.
///
/// Source: Modbus Application Protocol V1.1b3, section 6. Of the diagnostics (08) only the echo is
/// let through: others clear counters or silence a device. Of the encapsulated interface (43) only
/// the device identification: what CANopen devices make of the other is their own affair.
#[must_use]
pub fn is_read(pdu: &[u8]) -> bool {
    match pdu {
        [1..=4 | 7 | 11 | 12 | 17 | 20 | 24, ..] => true,
        [8, 0, 0, ..] => true,
        [43, 0x0E, ..] => true,
        _ => false,
    }
}

/// Checks a whole frame before its first byte is sent.
///
/// # Errors
/// If the frame is not a read, or so short that nothing can be said.
pub fn admit(framing: Framing, frame: &[u8]) -> Result<(), NotARead> {
    let pdu = pdu_of(frame, framing).unwrap_or_default();
    if is_read(&pdu) {
        return Ok(());
    }
    Err(NotARead {
        function: pdu.first().copied().unwrap_or(0),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::encode::frame;

    /// Every function code in every framing, with data that would make each a complete request.
    #[test]
    fn only_reads_pass() {
        let allowed = [1, 2, 3, 4, 7, 8, 11, 12, 17, 20, 24];
        for framing in Framing::ALL {
            for function in 0..=255_u8 {
                let pdu = [function, 0, 0, 0, 1];
                let passed = admit(framing, &frame(framing, 1, 1, &pdu)).is_ok();
                assert_eq!(passed, allowed.contains(&function), "{framing:?} {function}");
            }
        }
    }

    #[test]
    fn sub_functions_count() {
        let passes = |pdu: &[u8]| admit(Framing::Rtu, &frame(Framing::Rtu, 0, 1, pdu)).is_ok();
        for sub in 0..=300_u16 {
            let [high, low] = sub.to_be_bytes();
            assert_eq!(passes(&[8, high, low, 0, 0]), sub == 0, "{sub}");
        }
        assert!(passes(&[43, 14, 1, 0]));
        assert!(!passes(&[43, 13, 0, 0]));
        assert!(!passes(&[43]));
    }

    #[test]
    fn fragments_do_not_pass() {
        for framing in Framing::ALL {
            for bytes in [&b""[..], &[1], &[1, 3], b":", b":01", &[0, 1, 0, 0, 0, 6, 1]] {
                assert!(admit(framing, bytes).is_err(), "{framing:?} {bytes:?}");
            }
        }
    }
}
