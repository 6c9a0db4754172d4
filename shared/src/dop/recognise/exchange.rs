//! A request with its answer, and what it means as far as diagnostic objects go.

use crate::address::Table;
use crate::capture::Micros;
use crate::decode::pdu_of;
use crate::frame::Role;
use crate::pdu::Asked;
use crate::session::Session;

/// A request and its answer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exchange {
    /// Unit address.
    pub unit: u8,
    /// The request PDU.
    pub request: Vec<u8>,
    /// The response PDU, if there was a sound one.
    pub response: Option<Vec<u8>>,
    /// When the request went out.
    pub at: Option<Micros>,
    /// When the answer came.
    pub answered: Option<Micros>,
    /// Index of the request among the frames.
    pub frame: u32,
    /// Index of the response.
    pub answer: Option<u32>,
}

/// What an exchange means as far as diagnostic objects go.
pub(super) enum Act<'a> {
    /// One register was written.
    Write(u16, u16),
    /// Registers were read: table, first address, data.
    Read(Table, u16, &'a [u8]),
    /// The device refused to be written to at this address.
    Refused(u16, u8),
    /// Anything else.
    Other,
}

impl Exchange {
    /// The exchanges of a session, as far as its frames are kept.
    #[must_use]
    pub fn all(session: &Session) -> Vec<Self> {
        (session.first()..session.len())
            .filter_map(|index| Self::of(session, index))
            .collect()
    }

    fn of(session: &Session, index: u32) -> Option<Self> {
        let framing = session.framing();
        let frame = session.frame(index)?;
        if frame.role != Role::Request || frame.marks.is_damaged() {
            return None;
        }
        let answer = frame.pair().filter(|pair| *pair > index);
        let response = answer.and_then(|pair| {
            let frame = session.frame(pair)?;
            if frame.marks.is_damaged() {
                return None;
            }
            pdu_of(session.bytes(pair)?, framing)
        });
        Some(Self {
            unit: frame.unit,
            request: pdu_of(session.bytes(index)?, framing)?,
            response,
            at: session.at(index),
            answered: answer.and_then(|pair| session.at(pair)),
            frame: index,
            answer,
        })
    }

    pub(super) fn act(&self) -> Act<'_> {
        let asked = Asked::new(&self.request);
        let address = asked.word(1).unwrap_or(0);
        let value = match self.request.as_slice() {
            [6, _, _, high, low] | [16, _, _, 0, 1, 2, high, low] => {
                Some(u16::from_be_bytes([*high, *low]))
            }
            _ => None,
        };
        match (value, self.response.as_deref()) {
            (Some(_), Some([function, code])) if *function >= 0x80 => Act::Refused(address, *code),
            // Without an answer it may have arrived; what follows tells.
            (Some(value), _) => Act::Write(address, value),
            (None, Some([function @ (3 | 4), _, data @ ..])) => {
                match Table::of_read_function(*function) {
                    Some(table) if asked.function() == *function => Act::Read(table, address, data),
                    _ => Act::Other,
                }
            }
            _ => Act::Other,
        }
    }
}

/// The registers in `data`, with their addresses.
pub(super) fn registers(start: u16, data: &[u8]) -> impl Iterator<Item = (u16, u16)> + '_ {
    let words = data.chunks_exact(2).filter_map(|pair| match pair {
        [high, low] => Some(u16::from_be_bytes([*high, *low])),
        _ => None,
    });
    (0_u16..).zip(words).map_while(move |(offset, word)| {
        let address = start.checked_add(offset)?;
        Some((address, word))
    })
}
