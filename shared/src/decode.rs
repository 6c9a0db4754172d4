//! One frame to its decode tree.

use crate::device::Device;
use crate::frame::ascii::Payload;
use crate::frame::check::{crc, crc_cause, lrc};
use crate::frame::{Frame, Framing, Marks, Role, tcp_header};
use crate::pdu::{Asked, Pdu, defs};
use crate::place::Place;
use crate::problem::{Cause, Finding, Problem};
use crate::reader::{Layout, Reader};
use crate::scale::Scale;
use crate::tree::{Decoded, Name};
use crate::value::{Quality, Value};

/// What decoding may assume besides the bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Context {
    /// How frames are marked off.
    pub framing: Framing,
    /// What is at the other end.
    pub device: Device,
}

/// False in a program that shows no registers: it decodes no Modbus.
const MODBUS: bool = cfg!(feature = "maps");

/// Decodes one entry of the index: `bytes` are its bytes, `request` those of the request that it
/// answers. Never fails: what can't be understood becomes raw fields and problems.
#[must_use]
pub fn decode_frame(
    frame: &Frame,
    bytes: &[u8],
    request: Option<&[u8]>,
    context: &Context,
) -> Decoded {
    let mut out = Decoded::default();
    decode_into(frame, bytes, request, context, &mut out);
    out
}

/// Like [`decode_frame`], into a tree that is cleared first and whose memory is used again.
pub fn decode_into(
    frame: &Frame,
    bytes: &[u8],
    request: Option<&[u8]>,
    context: &Context,
    out: &mut Decoded,
) {
    out.clear();
    out.bytes.extend_from_slice(bytes);
    if frame.is_noise() {
        let place = Place::new(0, bytes.len());
        out.push(None, Name::Def(&defs::NOISE), Value::Raw, place);
        out.problem(Problem::new(Finding::Noise { len: frame.len }, place));
        return;
    }
    match context.framing {
        Framing::Rtu if MODBUS => rtu(frame, bytes, request, context, out),
        Framing::Ascii if MODBUS => ascii(frame, bytes, request, context, out),
        Framing::Tcp if MODBUS => tcp(frame, bytes, request, context, out),
        Framing::Rtu | Framing::Ascii | Framing::Tcp => {
            let place = Place::new(0, bytes.len());
            out.push(None, Name::Def(&defs::UNKNOWN), Value::Raw, place);
        }
        #[cfg(feature = "hart")]
        Framing::Hart => {
            crate::hart::decode::frame(frame.marks, bytes, request, context.device, out);
        }
        #[cfg(feature = "hart")]
        Framing::HartIp => crate::hart::ip::message(bytes, request, context.device, out),
    }
    if frame.marks.has(Marks::AMBIGUOUS) {
        out.problem(Problem::new(Finding::Ambiguous, Place::new(0, bytes.len())));
    }
    if frame.role == Role::Unknown && !frame.marks.is_damaged() {
        out.problem(Problem::new(
            Finding::EitherRole,
            Place::new(0, bytes.len()),
        ));
    }
    if frame.marks.is_damaged() {
        for field in &mut out.fields {
            field.quality = Quality::Damaged;
        }
    }
}

/// The PDU of a frame, for pairing a response with what its request asked.
#[must_use]
pub fn pdu_of(frame: &[u8], framing: Framing) -> Option<Vec<u8>> {
    match framing {
        Framing::Rtu => frame
            .get(1..frame.len().checked_sub(2)?)
            .map(<[u8]>::to_vec),
        Framing::Tcp => frame.get(7..).map(<[u8]>::to_vec),
        // A command is no PDU of Modbus.
        #[cfg(feature = "hart")]
        Framing::Hart | Framing::HartIp => None,
        Framing::Ascii => {
            let payload = Payload::of(frame);
            let bytes = payload.bytes();
            bytes
                .get(1..bytes.len().checked_sub(1)?)
                .map(<[u8]>::to_vec)
        }
    }
}

fn rtu(frame: &Frame, bytes: &[u8], request: Option<&[u8]>, context: &Context, out: &mut Decoded) {
    let cut = frame.marks.has(Marks::TRUNCATED);
    // A cut frame has no check bytes, or not all: everything may be data.
    let (body, check) = match bytes.split_last_chunk::<2>() {
        Some((body, check)) if !cut => (body, Some(*check)),
        _ => (bytes, None),
    };
    let asked = request.and_then(|r| r.get(1..r.len().saturating_sub(2)));
    let mut reader = Reader::new(body, 0, Layout::Plain);
    unit(frame, &mut reader, out, context.device.last_unit());
    pdu(frame, reader, asked, context, out);
    let place = Place::new(body.len(), 2);
    if let Some(check) = check {
        let got = u16::from_le_bytes(check);
        out.push(
            None,
            Name::Def(&defs::CRC),
            Value::Hex(u32::from(got)),
            place,
        );
        if frame.marks.has(Marks::BAD_CHECK) {
            let cause = crc_cause(bytes);
            out.problem(Problem::new(
                Finding::Crc {
                    got,
                    want: crc(body),
                    cause,
                },
                place,
            ));
        }
    } else if let Some(missing) = missing(frame, bytes) {
        let want = crc(bytes);
        let end = Place::new(bytes.len(), 0);
        out.problem(if missing == 2 {
            Problem::new(
                Finding::Crc {
                    got: 0,
                    want,
                    cause: Cause::Missing,
                },
                end,
            )
        } else {
            Problem::new(Finding::Truncated { missing }, end)
        });
    }
}

/// How many bytes a cut RTU frame lacks, check bytes included.
fn missing(frame: &Frame, bytes: &[u8]) -> Option<u16> {
    use crate::pdu::length::{self, Length};
    let pdu = bytes.get(1..)?;
    let length = match frame.role {
        Role::Request | Role::Unknown => length::request(pdu),
        _ => length::response(pdu),
    };
    let want = match length {
        Length::Exact(n) | Length::Needs(n) => n,
        Length::Open { min, .. } => min,
        Length::Never => pdu.len(),
    };
    // An exact length short of its CRC lacks two bytes; a needed byte comes before more of them.
    let lacking = want.saturating_sub(pdu.len()).saturating_add(2);
    let lacking = if lacking == 2 && matches!(length, Length::Needs(_)) {
        3
    } else {
        lacking
    };
    // One of the two check bytes may be there.
    let over = pdu.len().saturating_sub(want);
    u16::try_from(lacking.saturating_sub(over).max(1)).ok()
}

fn ascii(
    frame: &Frame,
    bytes: &[u8],
    request: Option<&[u8]>,
    context: &Context,
    out: &mut Decoded,
) {
    out.layout = Layout::HexPairs;
    out.push(None, Name::Def(&defs::COLON), Value::Raw, Place::new(0, 1));
    let payload = Payload::of(bytes);
    let asked = request.map(Payload::of);
    let asked = asked
        .as_ref()
        .and_then(|p| p.bytes().split_last())
        .and_then(|(_, b)| b.get(1..));
    // Without sound digits up to the end there is no telling which of them are the LRC.
    let (sent, body) = match payload.bytes().split_last() {
        Some((sent, body)) if payload.sound => (Some(*sent), body),
        _ => (None, payload.bytes()),
    };
    let mut reader = Reader::new(body, 0, Layout::HexPairs);
    unit(frame, &mut reader, out, context.device.last_unit());
    pdu(frame, reader, asked, context, out);
    let place = Layout::HexPairs.place(body.len(), 1);
    if let Some(got) = sent {
        out.push(
            None,
            Name::Def(&defs::LRC),
            Value::Hex(u32::from(got)),
            place,
        );
        if frame.marks.has(Marks::TRUNCATED) {
            out.problem(Problem::new(
                Finding::Truncated { missing: 1 },
                Place::new(bytes.len(), 0),
            ));
        }
        let want = lrc(body);
        if got != want {
            out.problem(Problem::new(Finding::Lrc { got, want }, place));
        }
    }
    let read = Layout::HexPairs.place(payload.bytes().len(), 0).start;
    let digits_end = payload.digits.saturating_add(1);
    if usize::from(read) < digits_end {
        let bad = Place::new(
            usize::from(read),
            digits_end.saturating_sub(usize::from(read)),
        );
        out.push(None, Name::Def(&defs::UNKNOWN), Value::Raw, bad);
        let finding = if bad.len == 1 {
            Finding::OddDigits
        } else {
            Finding::BadDigit
        };
        out.problem(Problem::new(finding, bad));
    }
    let end = Place::new(digits_end, bytes.len().saturating_sub(digits_end));
    if end.len > 0 {
        out.push(None, Name::Def(&defs::LINE_END), Value::Raw, end);
    }
    if !bytes.ends_with(b"\r\n") {
        out.problem(Problem::new(Finding::NoLineEnd, end));
    }
}

fn tcp(frame: &Frame, bytes: &[u8], request: Option<&[u8]>, context: &Context, out: &mut Decoded) {
    let mut reader = Reader::new(bytes, 0, Layout::Plain);
    header(&mut reader, bytes.len(), out);
    unit(frame, &mut reader, out, 255);
    let asked = request.and_then(|r| r.get(tcp_header()..));
    pdu(frame, reader, asked, context, out);
    if frame.marks.has(Marks::TRUNCATED) {
        let stated = bytes
            .get(4..6)
            .and_then(|l| l.try_into().ok())
            .map_or(2, u16::from_be_bytes);
        let there = u16::try_from(bytes.len()).unwrap_or(u16::MAX);
        let missing = stated.saturating_add(6).saturating_sub(there).max(1);
        out.problem(Problem::new(
            Finding::Truncated { missing },
            Place::new(bytes.len(), 0),
        ));
    }
}

/// The MBAP header up to the unit address.
fn header(reader: &mut Reader<'_>, total: usize, out: &mut Decoded) -> Option<()> {
    let (transaction, place) = reader.u16()?;
    let number = |raw: u16| Value::Number {
        raw: i64::from(raw),
        scale: Scale::ONE,
    };
    out.push(
        None,
        Name::Def(&defs::TRANSACTION),
        number(transaction),
        place,
    );
    let (protocol, place) = reader.u16()?;
    out.push(None, Name::Def(&defs::PROTOCOL), number(protocol), place);
    if protocol != 0 {
        out.problem(Problem::new(Finding::Protocol { got: protocol }, place));
    }
    let (length, place) = reader.u16()?;
    out.push(None, Name::Def(&defs::LENGTH), number(length), place);
    let there = u16::try_from(total.saturating_sub(6)).unwrap_or(u16::MAX);
    if length < there {
        out.problem(Problem::new(
            Finding::Count {
                got: length,
                want: there,
            },
            place,
        ));
    }
    Some(())
}

/// The unit address and what it says about the frame.
fn unit(frame: &Frame, reader: &mut Reader<'_>, out: &mut Decoded, last: u8) {
    let Some((unit, place)) = reader.u8() else {
        return;
    };
    let value = match unit {
        0 if last != 255 => Value::Named(0, Some("Broadcast")),
        _ => Value::Number {
            raw: i64::from(unit),
            scale: Scale::ONE,
        },
    };
    out.push(None, Name::Def(&defs::UNIT), value, place);
    if unit > last && !frame.marks.is_damaged() {
        out.problem(Problem::new(Finding::ReservedUnit { unit }, place));
    }
}

fn pdu(
    frame: &Frame,
    reader: Reader<'_>,
    asked: Option<&[u8]>,
    context: &Context,
    out: &mut Decoded,
) {
    // Damaged frames of unknown role are read as requests, whose fields stand at fixed places.
    let mut pdu = Pdu {
        reader,
        device: context.device,
        role: if frame.role == Role::Exception {
            Role::Response
        } else {
            frame.role
        },
        unit: frame.unit,
        damaged: frame.marks.is_damaged(),
        asked: asked.map(Asked::new),
        out,
    };
    pdu.decode();
}
