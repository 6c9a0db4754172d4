//! Bytes to registers: pairs, or the data of responses.

use super::{Form, Input, InputProblem, Token};
use crate::frame::check::crc_holds;

/// Registers of a run of bytes. Frames are only taken for such if every byte belongs to one.
pub(super) fn read(
    bytes: &[u8],
    places: &[Token<'_>],
    form: Form,
    why: String,
    mut problems: Vec<InputProblem>,
) -> Input {
    if let Some((words, count, kind)) = rtu(bytes).or_else(|| tcp(bytes)) {
        // They were met between bytes of which not all are data.
        for problem in &mut problems {
            problem.at = problem.at.min(words.len());
        }
        let one = if count == 1 { "" } else { "s" };
        return Input {
            words,
            form: Form::Frames,
            said: format!("Read as the data of {count} Modbus {kind} response{one}."),
            problems,
        };
    }
    if bytes.is_empty() && problems.is_empty() {
        problems.push(super::nothing());
    }
    let words: Vec<u16> = bytes
        .chunks_exact(2)
        .filter_map(|pair| Some(u16::from_be_bytes(pair.try_into().ok()?)))
        .collect();
    if !bytes.len().is_multiple_of(2)
        && let Some(token) = places.last()
    {
        let text = "The last byte has no partner and is left out: a register has two bytes.";
        problems.push(token.problem(words.len(), text));
    }
    let why = if form == Form::Frames {
        "they are no complete responses".to_owned()
    } else {
        why
    };
    Input {
        words,
        form: Form::Bytes,
        said: format!("Read as {} ({why}).", Form::Bytes.label()),
        problems,
    }
}

/// The data of a response to a read of registers: function code 3 or 4, byte count, registers.
fn data(pdu: &[u8]) -> Option<impl Iterator<Item = u16>> {
    let [3 | 4, count, data @ ..] = pdu else {
        return None;
    };
    let fits = usize::from(*count) == data.len() && data.len().is_multiple_of(2);
    fits.then(|| {
        data.chunks_exact(2)
            .filter_map(|pair| Some(u16::from_be_bytes(pair.try_into().ok()?)))
    })
}

type Found = (Vec<u16>, usize, &'static str);

/// RTU frames one after the other, requests between them included.
fn rtu(mut bytes: &[u8]) -> Option<Found> {
    let (mut words, mut count) = (Vec::new(), 0_usize);
    while let [_, 3 | 4, len, ..] = bytes {
        let response = usize::from(*len).saturating_add(5);
        let len = [response, 8]
            .into_iter()
            .find(|len| bytes.get(..*len).is_some_and(crc_holds))?;
        let (frame, rest) = bytes.split_at_checked(len)?;
        bytes = rest;
        let pdu = frame.get(1..len.checked_sub(2)?)?;
        if let Some(data) = data(pdu) {
            words.extend(data);
            count = count.saturating_add(1);
        }
    }
    (bytes.is_empty() && count > 0).then_some((words, count, "RTU"))
}

/// TCP frames one after the other, requests between them included.
fn tcp(mut bytes: &[u8]) -> Option<Found> {
    let (mut words, mut count) = (Vec::new(), 0_usize);
    while let [_, _, 0, 0, high, low, _, 3 | 4, ..] = bytes {
        let len = usize::from(u16::from_be_bytes([*high, *low]));
        let (frame, rest) = bytes.split_at_checked(len.saturating_add(6))?;
        bytes = rest;
        let pdu = frame.get(7..)?;
        if let Some(data) = data(pdu) {
            words.extend(data);
            count = count.saturating_add(1);
        } else if pdu.len() != 5 {
            return None;
        }
    }
    (bytes.is_empty() && count > 0).then_some((words, count, "TCP"))
}
