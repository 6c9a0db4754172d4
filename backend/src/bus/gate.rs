//! The last thing that stands before a line: only reads pass.
//!
//! Above this there is no type that could say anything but a read; this holds even if somebody
//! adds one. It looks at the bytes themselves.

use shared::decode::pdu_of;
use shared::encode;
use shared::frame::Framing;
use shared::frame::ascii::hex_pair;
use shared::pdu::length::{Length, request};

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
    matches!(
        pdu,
        [1..=4 | 7 | 11 | 12 | 17 | 20 | 24, ..] | [8, 0, 0, ..] | [43, 0x0E, ..]
    )
}

/// Checks a whole frame before its first byte is sent: it must be one read request, complete, and
/// nothing else.
///
/// # Errors
/// If the bytes are anything else.
pub fn admit(framing: Framing, frame: &[u8]) -> Result<(), NotARead> {
    let pdu = pdu_of(frame, framing).unwrap_or_default();
    // Nothing may hide behind a read: the frame made from this PDU has to be this frame.
    let unit = match framing {
        Framing::Rtu => frame.first().copied(),
        Framing::Ascii => frame.get(1..3).and_then(hex_pair),
        Framing::Tcp => frame.get(6).copied(),
    };
    let transaction = match (framing, frame) {
        (Framing::Tcp, [high, low, ..]) => u16::from_be_bytes([*high, *low]),
        _ => 0,
    };
    let complete = request(&pdu) == Length::Exact(pdu.len());
    let whole = unit.is_some_and(|u| encode::frame(framing, transaction, u, &pdu) == frame);
    if is_read(&pdu) && complete && whole {
        return Ok(());
    }
    Err(NotARead {
        function: pdu.first().copied().unwrap_or(0),
    })
}

/// A complete request of every function code: with the length that the standard gives it, and
/// where it gives none, with four bytes of data.
#[cfg(test)]
pub(super) fn every_function() -> impl Iterator<Item = Vec<u8>> {
    (0..=255_u8).map(|function| {
        let mut pdu = match function {
            15 | 16 => vec![function, 0, 0, 0, 1, 2, 0, 1],
            20 | 21 => vec![function, 9, 6, 0, 2, 0, 0, 0, 1, 0, 1],
            23 => vec![function, 0, 0, 0, 1, 0, 0, 0, 1, 2, 0, 1],
            43 => vec![function, 14, 1, 0],
            _ => vec![function, 0, 0, 0, 1, 0, 0, 0, 0],
        };
        match function {
            20 => pdu = vec![20, 7, 6, 0, 2, 0, 0, 0, 1],
            _ => {
                if let Length::Exact(len) = request(&pdu) {
                    pdu.truncate(len);
                }
            }
        }
        pdu
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::encode::frame;

    /// Every function code in every framing, each as a complete request.
    #[test]
    fn only_reads_pass() {
        let allowed = [1, 2, 3, 4, 7, 8, 11, 12, 17, 20, 24, 43];
        for framing in Framing::ALL {
            for pdu in every_function() {
                let passed = admit(framing, &frame(framing, 1, 1, &pdu)).is_ok();
                assert_eq!(passed, allowed.contains(&pdu[0]), "{framing:?} {pdu:?}");
            }
        }
    }

    #[test]
    fn nothing_hides_behind_a_read() {
        for framing in Framing::ALL {
            let read = frame(framing, 1, 1, &[3, 0, 0, 0, 1]);
            let write = frame(framing, 1, 1, &[6, 0, 0, 0, 1]);
            assert!(admit(framing, &read).is_ok());
            assert!(admit(framing, &[read, write].concat()).is_err());
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
            for bytes in [
                &b""[..],
                &[1],
                &[1, 3],
                b":",
                b":01",
                &[0, 1, 0, 0, 0, 6, 1],
            ] {
                assert!(admit(framing, bytes).is_err(), "{framing:?} {bytes:?}");
            }
        }
    }
}
