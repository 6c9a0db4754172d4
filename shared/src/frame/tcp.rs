//! Modbus TCP in a stream: the MBAP header gives the length, the PDU's own length confirms it.

use super::{Found, Marks, Role, View};
use crate::capture::Direction;
use crate::pdu::length::{self, Length};
use crate::transaction::Pairing;

/// Bytes before those that the length field counts.
pub(crate) const BEFORE: usize = 6;
/// Header including the unit address.
pub(crate) const HEADER: usize = 7;
/// Smallest and largest length field: unit and PDU.
const MIN: u16 = 2;
const MAX: u16 = 254;

/// The fields of the header that framing needs.
struct Header {
    transaction: u16,
    protocol: u16,
    length: u16,
    unit: u8,
    function: u8,
}

fn header(bytes: &[u8]) -> Option<Header> {
    let &[t0, t1, p0, p1, l0, l1, unit, function] = bytes.first_chunk::<8>()?;
    Some(Header {
        transaction: u16::from_be_bytes([t0, t1]),
        protocol: u16::from_be_bytes([p0, p1]),
        length: u16::from_be_bytes([l0, l1]),
        unit,
        function,
    })
}

/// How well the PDU fits the length in the header.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Fit {
    Request,
    Response,
    Both,
    Open,
    None,
}

fn fit(bytes: &[u8], header: &Header) -> Fit {
    let len = usize::from(header.length).saturating_sub(1);
    let end = HEADER.saturating_add(len).min(bytes.len());
    let Some(pdu) = bytes.get(HEADER..end) else {
        return Fit::None;
    };
    let (request, response) = (length::request(pdu), length::response(pdu));
    let exact = Length::Exact(len);
    let report = pdu.get(..2) == Some(&[17, 0x52]) && len == 86;
    match (request == exact, response == exact || report) {
        (true, true) => Fit::Both,
        (true, false) => Fit::Request,
        (false, true) => Fit::Response,
        _ if matches!(request, Length::Open { .. }) || matches!(response, Length::Open { .. }) => {
            Fit::Open
        }
        _ if pdu.get(..3) == Some(&[8, 0, 0]) => Fit::Both,
        _ => Fit::None,
    }
}

/// The frame or noise at the start of the view.
pub(super) fn next(view: &View<'_>, pairing: &Pairing) -> Found {
    if let Some(h) = header(view.bytes)
        && h.protocol == 0
        && (MIN..=MAX).contains(&h.length)
        && h.function != 0
    {
        let len = BEFORE.saturating_add(usize::from(h.length));
        if len <= view.bytes.len() {
            let fit = fit(view.bytes, &h);
            if fit != Fit::None {
                let mut marks = Marks::default();
                if fit == Fit::Open {
                    marks = Marks::GUESS;
                }
                return found(view, pairing, &h, len, fit, marks);
            }
            // The header is sound but the PDU has another length: believe the header if the
            // stream goes on well behind it.
            if view.aligned && goes_on(view, len) {
                return found(view, pairing, &h, len, fit, Marks::MALFORMED);
            }
        } else if view.at_end && search(view) == view.bytes.len() {
            let fit = fit(view.bytes, &h);
            return found(view, pairing, &h, view.bytes.len(), fit, Marks::TRUNCATED);
        }
    } else if view.at_end && view.aligned && cut_header(view.bytes) {
        let unit = view.bytes.get(6).copied().unwrap_or(0);
        return Found {
            len: view.bytes.len(),
            unit,
            function: 0,
            role: Role::Unknown,
            marks: Marks::TRUNCATED,
            transaction: 0,
        };
    }
    Found::noise(search(view))
}

/// True if a header has begun and the stream ends within it.
fn cut_header(bytes: &[u8]) -> bool {
    (4..8).contains(&bytes.len()) && bytes.get(2..4) == Some(&[0, 0])
}

/// Distance to the next sound frame, else as far as is certain.
fn search(view: &View<'_>) -> usize {
    let all = view.bytes.len();
    let limit = if view.at_end {
        all
    } else {
        all.saturating_sub(270)
    };
    (1..limit)
        .find(|at| view.bytes.get(*at..).is_some_and(starts_good))
        .unwrap_or(limit.max(1))
}

fn goes_on(view: &View<'_>, len: usize) -> bool {
    match view.bytes.get(len..) {
        None | Some([]) => view.at_end,
        Some(rest) => starts_good(rest),
    }
}

/// True if a header with protocol 0 and a PDU of exactly its length and a known function start here.
fn starts_good(bytes: &[u8]) -> bool {
    header(bytes).is_some_and(|h| {
        h.protocol == 0
            && (MIN..=MAX).contains(&h.length)
            && length::is_known(h.function & 0x7F)
            && bytes.len() >= BEFORE.saturating_add(usize::from(h.length))
            && !matches!(fit(bytes, &h), Fit::None | Fit::Open)
    })
}

fn found(
    view: &View<'_>,
    pairing: &Pairing,
    header: &Header,
    len: usize,
    fit: Fit,
    marks: Marks,
) -> Found {
    let due = pairing.expects(header.transaction, header.unit, header.function);
    let answer = if header.function >= 0x80 {
        Role::Exception
    } else {
        Role::Response
    };
    let role = match (fit, view.direction) {
        (_, Direction::ToDevice) => Role::Request,
        (_, Direction::FromDevice) => answer,
        (Fit::Request, _) => Role::Request,
        (Fit::Response, _) => answer,
        _ if due => answer,
        (Fit::Both, _) => Role::Request,
        _ if header.function >= 0x80 => Role::Exception,
        _ => Role::Unknown,
    };
    Found {
        len,
        unit: header.unit,
        function: header.function,
        role,
        marks,
        transaction: header.transaction,
    }
}
