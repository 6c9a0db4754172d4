//! Modbus ASCII in a stream: from colon to CR LF, the LRC as proof.

use super::check::lrc;
use super::{Found, Marks, Role, View};
use crate::capture::Direction;
use crate::pdu::length::{self, Length};
use crate::transaction::Pairing;

/// Longest frame in characters. Source: Modbus over Serial Line V1.02, section 2.5.2.1.
const MAX: usize = 513;
/// Longest payload: unit, PDU, LRC.
pub(crate) const MAX_PAYLOAD: usize = 255;

/// The payload of a line, decoded from its hexadecimal characters.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Payload {
    bytes: [u8; MAX_PAYLOAD],
    len: usize,
    /// Characters of the line that are payload, digits or not.
    pub digits: usize,
    /// False if a character is no digit, or their number is odd.
    pub sound: bool,
}

impl Payload {
    /// Decodes the characters between the colon and the line end. A pair that is no byte ends it.
    pub(crate) fn of(line: &[u8]) -> Self {
        let body = line.strip_prefix(b":").unwrap_or(line);
        let body = body.strip_suffix(b"\n").unwrap_or(body);
        let body = body.strip_suffix(b"\r").unwrap_or(body);
        let mut bytes = [0; MAX_PAYLOAD];
        let mut len = 0_usize;
        let mut sound = body.len().is_multiple_of(2);
        for pair in body.chunks_exact(2) {
            let (Some(byte), Some(slot)) = (hex_pair(pair), bytes.get_mut(len)) else {
                sound = false;
                break;
            };
            *slot = byte;
            len = len.saturating_add(1);
        }
        Self {
            bytes,
            len,
            digits: body.len(),
            sound,
        }
    }

    /// Unit, PDU and LRC.
    pub(crate) fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.len).unwrap_or(&[])
    }
}

/// The byte that two hexadecimal characters write.
#[must_use]
pub fn hex_pair(pair: &[u8]) -> Option<u8> {
    match pair {
        [high, low] => Some((hex_digit(*high)? << 4) | hex_digit(*low)?),
        _ => None,
    }
}

/// The value of a hexadecimal character of either case.
#[must_use]
pub fn hex_digit(character: u8) -> Option<u8> {
    match character {
        b'0'..=b'9' => Some(character.wrapping_sub(b'0')),
        b'A'..=b'F' => Some(character.wrapping_sub(b'A').wrapping_add(10)),
        b'a'..=b'f' => Some(character.wrapping_sub(b'a').wrapping_add(10)),
        _ => None,
    }
}

/// The frame or noise at the start of the view.
pub(super) fn next(view: &View<'_>, pairing: &Pairing) -> Found {
    if view.bytes.first() != Some(&b':') {
        let colon = view.bytes.iter().position(|b| *b == b':');
        return Found::noise(colon.unwrap_or(view.bytes.len()));
    }
    // The line goes to its line feed, to the next colon, or to the end.
    let rest = view.bytes.get(1..).unwrap_or(&[]);
    let stop = rest
        .iter()
        .take(MAX.saturating_add(8))
        .position(|b| matches!(b, b'\n' | b':'));
    let (len, complete) = match stop {
        Some(at) if rest.get(at) == Some(&b'\n') => (at.saturating_add(2), true),
        Some(at) => (at.saturating_add(1), false),
        None => (view.bytes.len().min(MAX), false),
    };
    let line = view.bytes.get(..len).unwrap_or(&[]);
    let payload = Payload::of(line);
    let bytes = payload.bytes();
    let (Some(unit), Some(function)) = (bytes.first().copied(), bytes.get(1).copied()) else {
        return Found::noise(len);
    };
    let proper = line.ends_with(b"\r\n") || (complete && line.ends_with(b"\n"));
    let (pdu, holds) = match bytes.split_last() {
        Some((sent, body)) => (
            body.get(1..).unwrap_or(&[]),
            payload.sound && lrc(body) == *sent,
        ),
        None => (bytes, false),
    };
    let mut marks = Marks::default();
    let request = length::request(pdu);
    let response = length::response(pdu);
    let exact = Length::Exact(pdu.len());
    if !holds {
        marks = marks.with(Marks::BAD_CHECK);
        // Without its line end, a line that fails its check was cut.
        let short = matches!(request, Length::Exact(n) if n > pdu.len());
        if payload.sound && (!proper || short) {
            marks = marks.with(Marks::TRUNCATED);
        }
    } else if request != exact && response != exact {
        match (request, response) {
            (Length::Open { .. }, _) | (_, Length::Open { .. }) => marks = Marks::GUESS,
            _ if pdu.get(..3) == Some(&[8, 0, 0]) || is_report(pdu) => {}
            _ => marks = Marks::MALFORMED,
        }
    }
    if !payload.sound {
        marks = marks.with(Marks::MALFORMED);
    }
    let answer = if function >= 0x80 {
        Role::Exception
    } else {
        Role::Response
    };
    let due = pairing.expects_serial(unit, function);
    let role = match view.direction {
        Direction::ToDevice => Role::Request,
        Direction::FromDevice => answer,
        Direction::Unknown => match (request == exact, response == exact || is_report(pdu)) {
            (true, true) if due => answer,
            (true, _) => Role::Request,
            (false, true) => answer,
            _ if function >= 0x80 => Role::Exception,
            _ if due => answer,
            // A damaged line: fields of requests stand at fixed places.
            _ if marks.is_damaged() && length::is_known(function) => Role::Request,
            _ => Role::Unknown,
        },
    };
    Found {
        len,
        unit,
        function,
        role,
        marks,
        transaction: 0,
    }
}

/// Reading E63: a report that counts 82 bytes where 84 follow.
fn is_report(pdu: &[u8]) -> bool {
    pdu.get(..2) == Some(&[17, 0x52]) && pdu.len() == 86
}
