//! Does a stream look like HART? Without the tables and the framer of HART, for a program that only
//! hands such a stream on.

use super::detect::{SAMPLE, good};
use super::{Framing, scan};

/// True if more bytes belong to sound frames of HART, or to messages of HART-IP, than to sound
/// frames of Modbus. Looks at the first 16 KiB.
#[must_use]
pub fn is_hart(bytes: &[u8]) -> bool {
    let sample = bytes.get(..SAMPLE).unwrap_or(bytes);
    let modbus = Framing::MODBUS.map(|framing| good(&scan(sample, framing)));
    let hart = sound(sample, frame).max(sound(sample, message));
    modbus.into_iter().all(|good| hart > good)
}

/// How many bytes are in sound frames. `len` tells how long the frame at the start is, if one is
/// there; a frame that follows another directly needs no mark in front of it.
fn sound(mut rest: &[u8], len: fn(&[u8], bool) -> Option<usize>) -> u64 {
    let (mut good, mut aligned) = (0_u64, true);
    while !rest.is_empty() {
        let found = len(rest, aligned);
        aligned = found.is_some();
        good = good.saturating_add(found.and_then(|n| u64::try_from(n).ok()).unwrap_or(0));
        rest = rest.get(found.unwrap_or(1).max(1)..).unwrap_or(&[]);
    }
    good
}

/// Preamble, delimiter, address, command, count, data; the exclusive or of all but the preamble is 0.
fn frame(bytes: &[u8], aligned: bool) -> Option<usize> {
    let fill = bytes.iter().take_while(|b| **b == 0xFF).count();
    let body = bytes.get(fill..)?;
    let first = *body.first()?;
    if !matches!(first & 0x17, 1 | 2 | 6) || !(aligned || fill >= 2) {
        return None;
    }
    let address: usize = if first & 0x80 == 0 { 1 } else { 5 };
    let head = address.saturating_add(usize::from(first >> 5 & 3));
    // The count stands behind delimiter, address, expansion and command.
    let count = *body.get(head.saturating_add(2))?;
    let len = head.saturating_add(4).saturating_add(usize::from(count));
    let sum = body.get(..len)?.iter().fold(0, |sum, byte| sum ^ byte);
    (sum == 0).then(|| fill.saturating_add(len))
}

/// A header of HART-IP with a length that is there.
fn message(bytes: &[u8], _: bool) -> Option<usize> {
    let &[version, kind, id, _, _, _, high, low] = bytes.first_chunk::<8>()?;
    let len = usize::from(u16::from_be_bytes([high, low]));
    let possible = matches!(version, 1 | 2) && matches!(kind & 0x0F, 0..=2 | 15) && id <= 5;
    (possible && (8..=bytes.len()).contains(&len)).then_some(len)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encode::frame as modbus;

    /// The worked frame R5 of command 3 and its answer R28.
    const POLL: [u8; 24] = [
        0xFF, 0xFF, 0x82, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x03, 0x00, 0x95, 0xFF, 0xFF, 0x86, 0xAE,
        0xDD, 0x01, 0x23, 0x45, 0x23, 0x02, 0x40, 0x40, 0xB3,
    ];

    #[test]
    fn hart_is_told_from_modbus() {
        assert!(is_hart(&POLL));
        assert!(is_hart(&POLL[2..11]), "a frame without its preamble");
        let mut damaged = [0x00, 0x12, 0xAE].to_vec();
        damaged.extend(POLL);
        assert!(is_hart(&damaged), "noise in front");
        // A session that opens, and one that carries command 0 (captures of icsnpp-hart-ip).
        let open = [1, 0, 0, 0, 0, 2, 0, 13, 1, 0, 9, 0x27, 0xC0];
        assert!(is_hart(&open));
        for framing in Framing::MODBUS {
            let poll = modbus(framing, 1, 2, &[3, 0, 0, 0, 1]);
            assert!(!is_hart(&poll), "{framing:?}");
            let burst = modbus(framing, 256, 1, &[1, 0, 0, 0, 1]);
            assert!(!is_hart(&burst), "{framing:?}");
        }
        assert!(!is_hart(&[]));
        assert!(!is_hart(&[0xFF; 100]));
        assert!(!is_hart(&[0; 100]));
    }

    /// The framers of HART see the same.
    #[cfg(feature = "hart")]
    #[test]
    fn the_framers_agree() {
        use super::super::detect;
        let hart = |bytes: &[u8]| matches!(detect(bytes), Framing::Hart | Framing::HartIp);
        for cut in 0..POLL.len() {
            let part = &POLL[cut..];
            assert_eq!(is_hart(part), hart(part), "{part:02X?}");
        }
    }
}
