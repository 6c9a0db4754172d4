//! Finds the answer to a request among the bytes that came.
//!
//! Answers of Modbus RTU and ASCII carry no number of their request. What can be checked is
//! checked: unit, function, the amount of data asked for, the check value, and that there are no
//! two different answers.

use shared::decode::pdu_of;
use shared::frame::Framing;
use shared::frame::check::{crc_holds, lrc};
use shared::pdu::length::{self, Length};

use super::query::is_answer;

/// What was asked.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// How frames are marked off.
    pub framing: Framing,
    /// Unit address.
    pub unit: u8,
    /// The request as sent.
    pub request: &'a [u8],
    /// Its PDU.
    pub pdu: &'a [u8],
    /// Length of a good response PDU.
    pub response_len: usize,
}

/// What the bytes so far hold.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Found {
    /// The PDU of the answer.
    pub answer: Option<Vec<u8>>,
    /// There are two answers that differ; which one is ours nobody can tell.
    pub two: bool,
    /// The line repeats what we send.
    pub echo: bool,
    /// Sound frames that are no answer to this request.
    pub strays: u32,
    /// What is behind the last sound frame looks like the beginning of our answer.
    pub begun: bool,
    /// That beginning is as long as the answer should be, and yet it is none.
    pub complete: bool,
}

/// Looks through all bytes that came since the request was sent.
///
/// `echoes` says that this line is known to repeat what is sent.
#[must_use]
pub fn find(asked: &Asked<'_>, bytes: &[u8], echoes: bool) -> Found {
    let mut found = Found::default();
    // A write of one register is answered by itself as well.
    let is_echo_request = matches!(asked.pdu.first(), Some(6 | 8));
    let mut bytes = bytes;
    // The answer to an echo request looks like the request; only a line known to repeat sends two.
    if (echoes || !is_echo_request)
        && let Some(rest) = bytes.strip_prefix(asked.request)
    {
        found.echo = true;
        bytes = rest;
    }
    let mut rest = bytes;
    let mut at = 0;
    while let Some(tail) = bytes.get(at..).filter(|t| !t.is_empty()) {
        let Some((len, unit, pdu)) = sound(asked.framing, tail) else {
            at += 1;
            continue;
        };
        at += len;
        rest = bytes.get(at..).unwrap_or(&[]);
        if unit != asked.unit || !answers(asked, &pdu) {
            found.strays += 1;
            continue;
        }
        match &found.answer {
            Some(first) if *first != pdu => found.two = true,
            _ => found.answer = Some(pdu),
        }
    }
    (found.begun, found.complete) = beginning(asked, rest);
    found
}

/// A sound frame at the start of the bytes: its length, unit and PDU.
fn sound(framing: Framing, bytes: &[u8]) -> Option<(usize, u8, Vec<u8>)> {
    match framing {
        Framing::Ascii => {
            if bytes.first() != Some(&b':') {
                return None;
            }
            let end = bytes.iter().position(|b| *b == b'\n')? + 1;
            let line = bytes.get(..end)?;
            // Only a line that is exactly what the standard says: two digits a byte, CR LF.
            let digits = line.strip_prefix(b":")?.strip_suffix(b"\r\n")?;
            if digits.len() % 2 != 0 || !digits.iter().all(u8::is_ascii_hexdigit) {
                return None;
            }
            let payload: Vec<u8> = digits
                .chunks_exact(2)
                .filter_map(shared::frame::ascii::hex_pair)
                .collect();
            let (sent, body) = payload.split_last()?;
            let unit = *body.first()?;
            (lrc(body) == *sent && body.len() >= 2).then_some(())?;
            Some((end, unit, pdu_of(line, framing)?))
        }
        Framing::Rtu => {
            let pdu = bytes.get(1..)?;
            let Length::Exact(len) = length::response(pdu) else {
                return None;
            };
            // The report of an ICON3000 is longer than it says.
            let lengths = [Some(len), length::report(pdu)];
            let mut frames = lengths
                .into_iter()
                .flatten()
                .map(|len| bytes.get(..len + 3));
            let frame = frames.find_map(|f| f.filter(|f| crc_holds(f)))?;
            Some((frame.len(), *frame.first()?, pdu_of(frame, framing)?))
        }
        Framing::Tcp | Framing::Hart | Framing::HartIp => None,
    }
}

/// True if a response PDU has the shape of an answer to this request.
fn answers(asked: &Asked<'_>, pdu: &[u8]) -> bool {
    let (Some(function), Some(got)) = (asked.pdu.first(), pdu.first()) else {
        return false;
    };
    if *got == function | 0x80 {
        return pdu.len() == 2;
    }
    got == function && is_answer(asked.pdu, asked.response_len, pdu)
}

/// Whether bytes that are no sound frame look like the beginning of our answer, and whether all of
/// it should be there.
fn beginning(asked: &Asked<'_>, bytes: &[u8]) -> (bool, bool) {
    let function = asked.pdu.first().copied().unwrap_or(0);
    match asked.framing {
        Framing::Ascii => {
            let begun = bytes.first() == Some(&b':');
            (begun, begun && bytes.ends_with(b"\n"))
        }
        _ => match bytes {
            [unit, got, ..] => {
                let begun = *unit == asked.unit && got & 0x7F == function;
                (begun, begun && bytes.len() >= asked.response_len + 3)
            }
            _ => (false, false),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::encode::frame;

    const PDU: [u8; 5] = [3, 0, 0, 0, 2];
    const GOOD: [u8; 6] = [3, 4, 1, 2, 3, 4];

    fn check(framing: Framing, bytes: &[u8], test: impl Fn(Found)) {
        let request = frame(framing, 0, 9, &PDU);
        let asked = Asked {
            framing,
            unit: 9,
            request: &request,
            pdu: &PDU,
            response_len: 6,
        };
        test(find(&asked, bytes, false));
    }

    const SERIAL: [Framing; 2] = [Framing::Rtu, Framing::Ascii];

    #[test]
    fn the_answer_is_found_behind_noise_echo_and_strays() {
        for framing in SERIAL {
            let good = frame(framing, 0, 9, &GOOD);
            let other_unit = frame(framing, 0, 8, &GOOD);
            let shorter = frame(framing, 0, 9, &[3, 2, 1, 2]);
            let echo = frame(framing, 0, 9, &PDU);
            for before in [&[][..], &[0, 0xFF, 9, 3], &other_unit, &shorter, &echo] {
                check(framing, &[before, &good].concat(), |found| {
                    assert_eq!(found.answer.as_deref(), Some(&GOOD[..]));
                    assert!(!found.two);
                });
            }
        }
    }

    #[test]
    fn exceptions_answer() {
        check(
            Framing::Rtu,
            &frame(Framing::Rtu, 0, 9, &[0x83, 2]),
            |found| {
                assert_eq!(found.answer, Some(vec![0x83, 2]));
            },
        );
        check(
            Framing::Rtu,
            &frame(Framing::Rtu, 0, 9, &[0x84, 2]),
            |found| {
                assert_eq!((found.answer, found.strays), (None, 1));
            },
        );
    }

    #[test]
    fn two_answers_that_differ_are_none() {
        for framing in SERIAL {
            let one = frame(framing, 0, 9, &GOOD);
            let two = frame(framing, 0, 9, &[3, 4, 1, 2, 3, 5]);
            check(framing, &[one.as_slice(), &one].concat(), |f| {
                assert!(!f.two);
            });
            check(framing, &[one.as_slice(), &two].concat(), |f| {
                assert!(f.two);
            });
        }
    }

    #[test]
    fn damaged_answers_are_none_and_are_seen_to_be_ours() {
        for framing in SERIAL {
            let good = frame(framing, 0, 9, &GOOD);
            for at in 0..good.len() {
                for bit in 0..8 {
                    let mut bad = good.clone();
                    bad[at] ^= 1 << bit;
                    // A bit of an ASCII digit may only change its case.
                    let same = bad.eq_ignore_ascii_case(&good) && framing == Framing::Ascii;
                    check(framing, &bad, |f| assert_eq!(f.answer.is_some(), same));
                }
            }
            for len in 2..good.len() {
                check(framing, &good[..len], |found| {
                    assert_eq!(found.answer, None);
                    assert!(found.begun && !found.complete, "{framing:?} {len}");
                });
            }
        }
    }

    #[test]
    fn an_echo_request_is_answered_by_its_nonce_only() {
        let pdu = [8, 0, 0, 0x12, 0x34];
        let request = frame(Framing::Rtu, 0, 9, &pdu);
        let asked = Asked {
            framing: Framing::Rtu,
            unit: 9,
            request: &request,
            pdu: &pdu,
            response_len: 5,
        };
        let late = frame(Framing::Rtu, 0, 9, &[8, 0, 0, 0x12, 0x33]);
        assert_eq!(find(&asked, &late, false).answer, None);
        assert!(find(&asked, &request, false).answer.is_some());
        // On a line that repeats, the first copy is our own.
        assert_eq!(find(&asked, &request, true).answer, None);
        let twice = [request.as_slice(), &request].concat();
        assert!(find(&asked, &twice, true).answer.is_some());
    }
}
