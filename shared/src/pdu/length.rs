//! The length table: how long a Modbus PDU is, told from its first bytes.
//!
//! Source: Modbus Application Protocol V1.1b3, section 6. Framing tries these lengths first and
//! takes the check value as proof.

/// What the first bytes say about the length of a PDU, function code included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Exactly so many bytes.
    Exact(usize),
    /// So many bytes must be there before the length can be told.
    Needs(usize),
    /// Not fixed by the standard: at least `min` bytes, in steps of `step`.
    Open {
        /// Fewest bytes.
        min: usize,
        /// Distance between possible lengths.
        step: usize,
    },
    /// These bytes can't be such a PDU.
    Never,
}

/// Largest PDU. Source: Modbus Application Protocol V1.1b3, section 4.1.
pub const MAX_PDU: usize = 253;

/// True if the standard describes this function code (without the exception bit).
#[must_use]
pub const fn is_known(function: u8) -> bool {
    matches!(function, 1..=8 | 11 | 12 | 15..=17 | 20..=24 | 43)
}

/// Length of a request.
#[must_use]
pub fn request(pdu: &[u8]) -> Length {
    let Some(function) = pdu.first() else {
        return Length::Needs(1);
    };
    match function {
        1..=6 => Length::Exact(5),
        7 | 11 | 12 | 17 => Length::Exact(1),
        8 => diagnostics(pdu),
        15 | 16 => counted(pdu, 5, 1, 246),
        20 => counted(pdu, 1, 7, 245),
        21 => counted(pdu, 1, 9, 251),
        22 => Length::Exact(7),
        23 => counted(pdu, 9, 2, 242),
        24 => Length::Exact(3),
        43 => match pdu.get(1) {
            Some(0x0E) => Length::Exact(4),
            Some(_) => Length::Open { min: 2, step: 1 },
            None => Length::Needs(2),
        },
        0 | 0x80.. => Length::Never,
        _ => Length::Open { min: 1, step: 1 },
    }
}

/// Length of a response, exceptions included.
#[must_use]
pub fn response(pdu: &[u8]) -> Length {
    let Some(function) = pdu.first() else {
        return Length::Needs(1);
    };
    match function {
        1 | 2 => counted(pdu, 1, 1, 250),
        3 | 4 | 23 => match pdu.get(1) {
            // Registers are words.
            Some(count) if count % 2 != 0 => Length::Never,
            _ => counted(pdu, 1, 2, 250),
        },
        5 | 6 | 11 | 15 | 16 => Length::Exact(5),
        7 => Length::Exact(2),
        8 => diagnostics(pdu),
        12 => counted(pdu, 1, 6, 70),
        17 => counted(pdu, 1, 1, 251),
        20 => counted(pdu, 1, 2, 245),
        21 => counted(pdu, 1, 9, 251),
        22 => Length::Exact(7),
        24 => match pdu.get(1..3) {
            Some(&[high, low]) => match usize::from(u16::from_be_bytes([high, low])) {
                count @ 2..=64 => Length::Exact(count.saturating_add(3)),
                _ => Length::Never,
            },
            _ => Length::Needs(3),
        },
        43 => match pdu.get(1) {
            Some(0x0E) => identification(pdu),
            Some(_) => Length::Open { min: 2, step: 1 },
            None => Length::Needs(2),
        },
        0x81.. => Length::Exact(2),
        0 | 0x80 => Length::Never,
        _ => Length::Open { min: 1, step: 1 },
    }
}

/// The other length of a response: the report (FC 17) of an ICON3000 counts 82 bytes where 84
/// follow (reading E63).
#[must_use]
pub const fn report(pdu: &[u8]) -> Option<usize> {
    match pdu {
        [17, 0x52, ..] => Some(86),
        _ => None,
    }
}

/// Function 08: a sub-function and one word of data; only "return query data" may have more.
fn diagnostics(pdu: &[u8]) -> Length {
    match pdu.get(1..3) {
        Some(_) => Length::Exact(5),
        None => Length::Needs(3),
    }
}

/// A PDU with a byte count at `at`, which may say `min` to `max`.
fn counted(pdu: &[u8], at: usize, min: u8, max: u8) -> Length {
    match pdu.get(at) {
        Some(count) if (min..=max).contains(count) => {
            Length::Exact(at.saturating_add(1).saturating_add(usize::from(*count)))
        }
        Some(_) => Length::Never,
        None => Length::Needs(at.saturating_add(1)),
    }
}

/// A device identification response: six bytes, then objects of id, length and text.
fn identification(pdu: &[u8]) -> Length {
    let Some(objects) = pdu.get(6) else {
        return Length::Needs(7);
    };
    let mut end = 7_usize;
    for _ in 0..*objects {
        let at = end.saturating_add(1);
        let Some(len) = pdu.get(at) else {
            return Length::Needs(at.saturating_add(1));
        };
        end = at.saturating_add(1).saturating_add(usize::from(*len));
        if end > MAX_PDU {
            return Length::Never;
        }
    }
    Length::Exact(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths of the example PDUs of Modbus Application Protocol V1.1b3, section 6.
    #[test]
    fn example_pdus() {
        let check = |request_pdu: &[u8], response_pdu: &[u8]| {
            assert_eq!(request(request_pdu), Length::Exact(request_pdu.len()));
            assert_eq!(response(response_pdu), Length::Exact(response_pdu.len()));
        };
        check(&[1, 0, 0x13, 0, 0x13], &[1, 3, 0xCD, 0x6B, 5]);
        check(&[3, 0, 0x6B, 0, 3], &[3, 6, 2, 0x2B, 0, 0, 0, 0x64]);
        check(&[7], &[7, 0x6D]);
        check(&[8, 0, 0, 0xA5, 0x37], &[8, 0, 0, 0xA5, 0x37]);
        check(&[11], &[11, 0xFF, 0xFF, 1, 8]);
        check(&[12], &[12, 8, 0, 0, 1, 8, 1, 0x21, 0x20, 0]);
        check(&[15, 0, 0x13, 0, 10, 2, 0xCD, 1], &[15, 0, 0x13, 0, 10]);
        check(&[16, 0, 1, 0, 2, 4, 0, 10, 1, 2], &[16, 0, 1, 0, 2]);
        check(&[22, 0, 4, 0, 0xF2, 0, 0x25], &[22, 0, 4, 0, 0xF2, 0, 0x25]);
        check(&[24, 4, 0xDE], &[24, 0, 6, 0, 2, 1, 0xB8, 0x12, 0x84]);
        assert_eq!(response(&[0x81, 2]), Length::Exact(2));
    }

    #[test]
    fn identification_walks_its_objects() {
        let pdu = [0x2B, 0x0E, 1, 1, 0, 0, 2, 0, 2, b'a', b'b', 1, 1, b'c'];
        assert_eq!(response(&pdu), Length::Exact(pdu.len()));
        assert_eq!(response(&pdu[..9]), Length::Needs(13));
    }

    #[test]
    fn what_can_not_be_is_said() {
        assert_eq!(response(&[3, 3]), Length::Never, "half a register");
        assert_eq!(response(&[3, 0]), Length::Never);
        assert_eq!(request(&[0x83]), Length::Never);
        assert_eq!(request(&[]), Length::Needs(1));
        assert_eq!(request(&[16, 0]), Length::Needs(6));
        assert_eq!(request(&[65]), Length::Open { min: 1, step: 1 });
    }
}
