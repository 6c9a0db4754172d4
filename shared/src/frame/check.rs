//! Check values: CRC-16/MODBUS and the longitudinal redundancy check.

use crc::{CRC_16_MODBUS, Crc, Table};

use crate::place::Place;
use crate::problem::Cause;

/// Sixteen tables: four times the speed of one on frames of the usual size.
#[cfg(not(target_arch = "wasm32"))]
static CRC: Crc<u16, Table<16>> = Crc::<u16, Table<16>>::new(&CRC_16_MODBUS);

/// In a page the same tables are computed at first use: 8 kB that no compression makes smaller
/// need not travel.
#[cfg(target_arch = "wasm32")]
static CRC: std::sync::LazyLock<Crc<u16, Table<16>>> =
    std::sync::LazyLock::new(|| Crc::<u16, Table<16>>::new(&CRC_16_MODBUS));

/// The CRC of a Modbus RTU frame, computed over unit, function and data.
///
/// It is transmitted low byte first. Source: Modbus over Serial Line V1.02, section 2.5.1.2.
#[must_use]
pub fn crc(bytes: &[u8]) -> u16 {
    CRC.checksum(bytes)
}

/// The LRC of a Modbus ASCII frame, computed over unit, function and data: the two's complement
/// of the sum. Source: Modbus over Serial Line V1.02, section 2.5.2.2.
#[must_use]
pub fn lrc(bytes: &[u8]) -> u8 {
    bytes
        .iter()
        .fold(0_u8, |sum, b| sum.wrapping_add(*b))
        .wrapping_neg()
}

/// True if `frame` is at least four bytes long and ends with its CRC.
#[must_use]
pub fn crc_holds(frame: &[u8]) -> bool {
    frame.len() >= 4
        && frame
            .split_last_chunk::<2>()
            .is_some_and(|(body, sent)| crc(body) == u16::from_le_bytes(*sent))
}

/// What can be proved about a frame whose CRC does not hold.
///
/// A CRC-16 names one flipped bit uniquely in frames of this size, so trying them all is a proof.
#[must_use]
pub fn crc_cause(frame: &[u8]) -> Cause {
    let Some((body, sent)) = frame.split_last_chunk::<2>() else {
        return Cause::Unknown;
    };
    let want = crc(body);
    if want == u16::from_be_bytes(*sent) {
        return Cause::Swapped;
    }
    let mut copy = frame.to_vec();
    for at in 0..copy.len() {
        for bit in 0..8_u8 {
            let mask = 1_u8.wrapping_shl(u32::from(bit));
            if let Some(byte) = copy.get_mut(at) {
                *byte ^= mask;
            }
            let holds = crc_holds(&copy);
            if let Some(byte) = copy.get_mut(at) {
                *byte ^= mask;
            }
            if holds {
                return Cause::OneBit(Place::new(at, 1).start, bit);
            }
        }
    }
    Cause::Unknown
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Modbus over Serial Line V1.02, section 6.2.2: the CRC of `02 07` is 0x1241, sent `41 12`.
    #[test]
    fn crc_of_the_standard() {
        assert_eq!(crc(&[0x02, 0x07]), 0x1241);
        assert!(crc_holds(&[0x02, 0x07, 0x41, 0x12]));
        assert!(!crc_holds(&[0x02, 0x07, 0x12, 0x41]));
        assert!(!crc_holds(&[0xFF, 0xFF]), "the CRC of nothing is no frame");
    }

    /// Hand calculation: 01 + 03 + 00 + 00 + 00 + 0A = 0E, its two's complement is F2.
    #[test]
    fn lrc_by_hand() {
        assert_eq!(lrc(&[0x01, 0x03, 0x00, 0x00, 0x00, 0x0A]), 0xF2);
    }

    #[test]
    fn causes_are_proved() {
        assert_eq!(crc_cause(&[0x02, 0x07, 0x12, 0x41]), Cause::Swapped);
        assert_eq!(crc_cause(&[0x02, 0x17, 0x41, 0x12]), Cause::OneBit(1, 4));
        assert_eq!(crc_cause(&[0x55, 0xAA, 0x55, 0xAA]), Cause::Unknown);
    }
}
