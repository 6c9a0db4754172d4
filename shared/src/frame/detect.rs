//! Which framing a stream has, judged by how much of it decodes.

use super::{Frame, Framing, Role, scan};
use crate::pdu::length::{self, Length};

/// How many bytes are tried.
pub(super) const SAMPLE: usize = 16 * 1024;

/// The framing under which most bytes belong to good frames.
///
/// Looks at the first 16 KiB. A CRC is a stronger proof than a header, so RTU wins a draw; with no
/// good frame at all, a header with protocol 0 and a fitting length speaks for TCP, a colon for
/// ASCII, and RTU is the rest.
#[must_use]
pub fn detect(bytes: &[u8]) -> Framing {
    let sample = bytes.get(..SAMPLE).unwrap_or(bytes);
    let mut best = (0_u64, None);
    for framing in Framing::ALL {
        let good = good(&scan(sample, framing));
        if good > best.0 {
            best = (good, Some(framing));
        }
    }
    best.1.unwrap_or_else(|| by_look(sample))
}

/// How many bytes belong to sound frames.
pub(super) fn good(frames: &[Frame]) -> u64 {
    frames
        .iter()
        .filter(|f| f.role != Role::Noise && !f.marks.is_damaged())
        .map(|f| u64::from(f.len))
        .fold(0_u64, u64::saturating_add)
}

/// What the first bytes look like if nothing in them is sound.
fn by_look(bytes: &[u8]) -> Framing {
    if bytes.trim_ascii_start().first() == Some(&b':') {
        return Framing::Ascii;
    }
    let known = |at: usize| bytes.get(at).is_some_and(|f| length::is_known(f & 0x7F));
    let pdu = bytes.get(1..).unwrap_or(&[]);
    let rtu = Length::Exact(bytes.len().saturating_sub(3));
    if known(1) && (length::request(pdu) == rtu || length::response(pdu) == rtu) {
        return Framing::Rtu;
    }
    match bytes.first_chunk::<6>() {
        Some(&[_, _, 0, 0, 0, stated]) if stated >= 2 && known(7) => Framing::Tcp,
        _ => Framing::Rtu,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sound_frames_decide() {
        assert_eq!(detect(&[0x02, 0x07, 0x41, 0x12]), Framing::Rtu);
        assert_eq!(detect(&[0, 1, 0, 0, 0, 6, 1, 3, 0, 0, 0, 2]), Framing::Tcp);
        assert_eq!(detect(b":0207F7\r\n"), Framing::Ascii);
    }

    #[test]
    fn damaged_frames_go_by_their_look() {
        assert_eq!(
            detect(&[1, 3, 0, 0, 0, 2, 0xDE, 0xAD]),
            Framing::Rtu,
            "a wrong CRC"
        );
        assert_eq!(
            detect(&[0, 1, 0, 0, 0, 6, 1, 3, 0, 0]),
            Framing::Tcp,
            "cut short"
        );
        assert_eq!(detect(b" :0207FF\r\n"), Framing::Ascii, "a wrong LRC");
        assert_eq!(detect(&[]), Framing::Rtu);
    }
}
