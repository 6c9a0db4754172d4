//! Modbus RTU in a stream: lengths from the table first, the CRC as proof.

use super::check::crc_holds;
use super::{Found, LOOKAHEAD, Marks, Role, View};
use crate::capture::Direction;
use crate::pdu::length::{self, Length};
use crate::transaction::Pairing;

/// Shortest and longest frame. Source: Modbus over Serial Line V1.02, section 2.5.1.
const MIN: usize = 4;
const MAX: usize = 256;
/// Unit address and CRC, which surround the PDU.
const AROUND: usize = 3;

/// A length and role that the first bytes allow.
#[derive(Clone, Copy)]
struct Candidate {
    len: usize,
    role: Role,
}

/// The frame or noise at the start of the view, and how many bytes from there are known not to
/// start a good frame.
pub(super) fn next(view: &View<'_>, pairing: &Pairing) -> (Found, usize) {
    if let Some(found) = good(view, pairing) {
        return (found, 0);
    }
    if view.aligned
        && let Some(found) = guess(view)
    {
        return (found, 0);
    }
    let (gap, next_unit) = search(view);
    let end = gap == view.bytes.len() && view.at_end;
    let barren = if next_unit.is_some() || end {
        gap
    } else {
        gap.max(view.barren)
    };
    (
        damaged(view, pairing, gap, next_unit, end).unwrap_or(Found::noise(gap)),
        barren,
    )
}

/// The candidates at the start of `bytes`: request, response, and the long form of FC 17.
fn candidates(bytes: &[u8]) -> [Option<Candidate>; 3] {
    let pdu = bytes.get(1..).unwrap_or(&[]);
    let exact = |length, role| match length {
        Length::Exact(len) if len <= length::MAX_PDU => Some(Candidate {
            len: len.saturating_add(AROUND),
            role,
        }),
        _ => None,
    };
    let answer = if pdu.first().is_some_and(|f| *f >= 0x80) {
        Role::Exception
    } else {
        Role::Response
    };
    let request = exact(length::request(pdu), Role::Request);
    let response = exact(length::response(pdu), answer);
    let long = length::report(pdu).map(|len| Candidate {
        len: len.saturating_add(3),
        role: Role::Response,
    });
    [request, response, long]
}

/// A frame at the start of the view whose length is in the table and whose CRC holds.
fn good(view: &View<'_>, pairing: &Pairing) -> Option<Found> {
    let (unit, function) = (*view.bytes.first()?, *view.bytes.get(1)?);
    if !is_known(view.bytes, function) {
        return None;
    }
    let due = pairing.expects_serial(unit, function) || view.direction == Direction::FromDevice;
    let mut best: Option<Candidate> = None;
    let mut both = false;
    for candidate in candidates(view.bytes).into_iter().flatten() {
        if view.direction == Direction::ToDevice && candidate.role != Role::Request {
            continue;
        }
        // The same length was proved already; only the role is in question.
        let proved = best.is_some_and(|b| b.len == candidate.len);
        if !proved && !view.bytes.get(..candidate.len).is_some_and(crc_holds) {
            continue;
        }
        match best {
            None => best = Some(candidate),
            Some(b) if proved => {
                let differ = b.role != candidate.role && !echoes(function);
                let (request, response) = (
                    plausible_request(view.bytes),
                    plausible_response(view.bytes),
                );
                both = differ && !due && request && response;
                if response && (due || (differ && !request)) {
                    best = Some(candidate);
                }
            }
            // Two lengths with a valid CRC: the one after which the stream goes on well, else the
            // longer, for a payload may contain a valid CRC by chance but hardly around itself.
            Some(b) => {
                let (short, long) = if b.len < candidate.len {
                    (b, candidate)
                } else {
                    (candidate, b)
                };
                let keep_short = goes_on(view, short.len) && !goes_on(view, long.len);
                best = Some(if keep_short { short } else { long });
            }
        }
    }
    let chosen = best?;
    let marks = if both {
        Marks::AMBIGUOUS
    } else {
        Marks::default()
    };
    Some(Found {
        len: chosen.len,
        unit,
        function,
        role: chosen.role,
        marks,
        transaction: 0,
    })
}

/// Functions whose response repeats the request, so that shape can't tell them apart.
const fn echoes(function: u8) -> bool {
    matches!(function, 5 | 6 | 8 | 21 | 22)
}

/// True if the table knows this function. Of exceptions to other functions, those with a known
/// exception code.
fn is_known(bytes: &[u8], function: u8) -> bool {
    length::is_known(function & 0x7F)
        || (function > 0x80 && bytes.get(2).is_some_and(|code| (1..=0x0B).contains(code)))
}

/// Reads the bytes as a request: is its quantity allowed, are its references what they must be?
fn plausible_request(bytes: &[u8]) -> bool {
    match bytes.get(1..6) {
        Some(&[1 | 2, _, _, high, low]) => (1..=2000).contains(&u16::from_be_bytes([high, low])),
        Some(&[3 | 4, _, _, high, low]) => (1..=125).contains(&u16::from_be_bytes([high, low])),
        // Groups of seven bytes that begin with reference type 6.
        Some(&[20, count, 6, ..]) => count % 7 == 0,
        Some(&[20, ..]) => false,
        _ => true,
    }
}

/// Reads the bytes as a response: may it look like this?
fn plausible_response(bytes: &[u8]) -> bool {
    match bytes.get(1..5) {
        // A group of length, reference type 6 and words.
        Some(&[20, _, length, reference]) => length % 2 == 1 && reference == 6,
        _ => true,
    }
}

/// True if the stream ends, or another good frame begins, `len` bytes on.
fn goes_on(view: &View<'_>, len: usize) -> bool {
    match view.bytes.get(len..) {
        None | Some([]) => view.at_end,
        Some(rest) => starts_good(rest),
    }
}

/// True if a frame with a length from the table and a valid CRC starts here.
fn starts_good(bytes: &[u8]) -> bool {
    bytes.get(1).is_some_and(|f| is_known(bytes, *f))
        && candidates(bytes)
            .into_iter()
            .flatten()
            .any(|c| bytes.get(..c.len).is_some_and(crc_holds))
}

/// A frame of a function whose length the standard does not fix: the first length at which the
/// CRC holds and the stream goes on well, else the first at which it holds.
fn guess(view: &View<'_>) -> Option<Found> {
    let (unit, function) = (*view.bytes.first()?, *view.bytes.get(1)?);
    let pdu = view.bytes.get(1..)?;
    let (min, step) = match (length::request(pdu), length::response(pdu)) {
        (Length::Open { min, step }, _) | (_, Length::Open { min, step }) => (min, step),
        // "Return query data" may carry more than one word.
        _ if pdu.get(..3) == Some(&[8, 0, 0]) => (5, 2),
        _ => return None,
    };
    let mut first = None;
    let mut len = min.saturating_add(AROUND).max(MIN);
    while len <= MAX.min(view.bytes.len()) {
        if view.bytes.get(..len).is_some_and(crc_holds) {
            if goes_on(view, len) {
                first = Some(len);
                break;
            }
            first = first.or(Some(len));
        }
        len = len.saturating_add(step);
    }
    let role = match view.direction {
        Direction::ToDevice => Role::Request,
        Direction::FromDevice => Role::Response,
        Direction::Unknown => Role::Unknown,
    };
    Some(Found {
        len: first?,
        unit,
        function,
        role,
        marks: Marks::GUESS,
        transaction: 0,
    })
}

/// How far it is to the next good frame, and its unit. Without one: as far as is certain.
fn search(view: &View<'_>) -> (usize, Option<u8>) {
    let all = view.bytes.len();
    // A start this close to the end of the view could be a frame that is not in view as a whole.
    let limit = if view.at_end {
        all
    } else {
        LOOKAHEAD.saturating_sub(2 * MAX)
    };
    for at in view.barren.max(1)..limit {
        if let Some(rest) = view.bytes.get(at..)
            && starts_good(rest)
        {
            return (at, rest.first().copied());
        }
    }
    (limit.max(1).min(all), None)
}

/// Decides whether the bytes before the next good frame are a damaged frame rather than noise.
///
/// The function must be in the table, and the unit one that is heard on this line (or nothing is
/// known of the line yet).
fn damaged(
    view: &View<'_>,
    pairing: &Pairing,
    gap: usize,
    next_unit: Option<u8>,
    end: bool,
) -> Option<Found> {
    let (unit, function) = (*view.bytes.first()?, *view.bytes.get(1)?);
    if gap < 2 || !is_known(view.bytes, function) {
        return None;
    }
    let heard = view.last_unit == Some(unit) || next_unit == Some(unit);
    let first_words = view.last_unit.is_none() && next_unit.is_none() && view.aligned;
    let due = pairing.expects_serial(unit, function) || view.direction == Direction::FromDevice;
    let [request, response, long] = candidates(view.bytes);
    let options = if due {
        [response, long, request]
    } else {
        [request, response, long]
    };
    let fits =
        |test: &dyn Fn(usize) -> bool| options.iter().flatten().find(|c| test(c.len)).copied();
    let found = |len, role, marks| {
        Some(Found {
            len,
            unit,
            function,
            role,
            marks,
            transaction: 0,
        })
    };
    // Exactly as long as the table says: only the CRC is wrong.
    if let Some(c) = fits(&|len| len == gap)
        && (heard || first_words || gap >= 6)
    {
        return found(c.len, c.role, Marks::BAD_CHECK);
    }
    if !heard && !first_words {
        return None;
    }
    // Longer than what is there: cut short. In the midst of a stream a few bytes prove nothing.
    let role = options
        .iter()
        .flatten()
        .next()
        .map_or(Role::Unknown, |c| c.role);
    let needs_more = matches!(length::request(view.bytes.get(1..gap)?), Length::Needs(_))
        || matches!(length::response(view.bytes.get(1..gap)?), Length::Needs(_));
    if (end || (next_unit.is_some() && gap >= 4)) && gap < MAX {
        if let Some(c) = fits(&|len| len > gap) {
            return found(gap, c.role, Marks::TRUNCATED);
        }
        if needs_more {
            return found(gap, role, Marks::TRUNCATED);
        }
    }
    // Shorter: a damaged frame, and noise behind it.
    if let Some(c) = fits(&|len| len < gap) {
        return found(c.len, c.role, Marks::BAD_CHECK);
    }
    None
}
