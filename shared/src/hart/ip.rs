//! HART-IP: HART frames in TCP or UDP, behind a header of eight bytes.

use core::fmt;

use super::content::{answered, content};
use super::decode::{inner, named_field, unknown};
use super::frame::Address;
use super::payload::{Data, Way};
use super::who::{identity, write_head};
use super::{
    DEVICE_STATUS, EXTENDED_DEVICE_STATUS, HART_IP_MASTER, HART_IP_MESSAGE_ID,
    HART_IP_MESSAGE_TYPE, HART_IP_STATUS, command, decode,
};
use crate::device::Device;
use crate::frame::{Found, Marks, Role, View};
use crate::map::row::Source;
use crate::place::Place;
use crate::problem::{Finding, Problem};
use crate::reader::{Layout, Reader};
use crate::scale::Scale;
use crate::tree::{Decoded, FieldDef, Name};
use crate::value::Value;

/// Length of the header.
pub const HEADER: usize = 8;
/// Longest message that is looked for: a direct PDU with several commands.
const MOST: u16 = 900;
/// Message that carries a frame from delimiter to check byte.
const TOKEN_PASSING: u8 = 3;
/// Message that carries commands without a frame around them.
const DIRECT: u8 = 4;

/// Declares the fields of a message.
macro_rules! defs {
    ($($name:ident = $key:literal, $label:literal, $unit:literal, $part:literal;)*) => {
        $(static $name: FieldDef = FieldDef {
            key: $key,
            label: $label,
            unit: $unit,
            source: Source { doc: super::IP, part: $part },
        };)*
    };
}

defs! {
    VERSION = "version", "Version", "", "header";
    TYPE = "message_type", "Message type", "", "header";
    ID = "message_id", "Message id", "", "header";
    STATUS = "status", "Status", "", "header";
    SEQUENCE = "sequence", "Sequence number", "", "header";
    LENGTH = "length", "Length", "", "header";
    MASTER = "master_type", "Master type", "", "session initiate";
    INACTIVITY = "inactivity", "Inactivity close time", "ms", "session initiate";
    NUMBER = "command", "Command", "", "direct PDU";
    COUNT = "data_count", "Byte count of the command", "", "direct PDU";
    CODE = "response_code", "Response code", "", "direct PDU";
    DEVICE = "device_status", "Device status", "", "direct PDU";
    EXTENDED = "extended_status", "Extended device status", "", "direct PDU";
}

/// What framing needs of a header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Header {
    kind: u8,
    id: u8,
    sequence: u16,
    len: u16,
}

impl Header {
    /// The header at the start of the bytes, if it can be one.
    pub(crate) fn of(bytes: &[u8]) -> Option<Self> {
        let &[version, kind, id, _, s0, s1, l0, l1] = bytes.first_chunk::<HEADER>()?;
        let header = Self {
            kind: kind & 0x0F,
            id,
            sequence: u16::from_be_bytes([s0, s1]),
            len: u16::from_be_bytes([l0, l1]),
        };
        let possible = matches!(version, 1 | 2)
            && matches!(kind & 0x0F, 0..=2 | 15)
            && id <= 5
            && (8..=MOST).contains(&header.len);
        possible.then_some(header)
    }

    const fn role(self) -> Role {
        match self.kind {
            0 => Role::Request,
            2 => Role::Burst,
            _ => Role::Response,
        }
    }
}

/// The message or noise at the start of the view.
pub(crate) fn next(view: &View<'_>) -> Found {
    let found = |header: Header, len, marks| Found {
        len,
        unit: 0,
        function: header.id,
        role: header.role(),
        marks,
        transaction: header.sequence,
    };
    if let Some(header) = Header::of(view.bytes) {
        let len = usize::from(header.len);
        if len <= view.bytes.len() {
            return found(header, len, Marks::default());
        }
        if view.at_end && view.aligned {
            return found(header, view.bytes.len(), Marks::TRUNCATED);
        }
    }
    let limit = if view.at_end {
        view.bytes.len()
    } else {
        view.bytes.len().saturating_sub(usize::from(MOST))
    };
    let starts = |at: &usize| {
        let rest = view.bytes.get(*at..).unwrap_or(&[]);
        Header::of(rest).is_some_and(|h| usize::from(h.len) <= rest.len())
    };
    Found::noise((1..limit).find(starts).unwrap_or(limit.max(1)))
}

/// Decodes a message into `out`, which holds its bytes. `request` is the one that it answers.
pub(crate) fn message(bytes: &[u8], request: Option<&[u8]>, device: Device, out: &mut Decoded) {
    let mut reader = Reader::new(bytes, 0, Layout::Plain);
    let header = Header::of(bytes);
    head(&mut reader, out);
    if let Some(header) = header {
        let missing = header
            .len
            .saturating_sub(u16::try_from(bytes.len()).unwrap_or(u16::MAX));
        match header.id {
            0 if !reader.is_empty() => {
                session(&mut reader, out);
            }
            TOKEN_PASSING if missing == 0 && !reader.is_empty() => {
                let request = request.and_then(|r| r.get(HEADER..));
                inner(reader, HEADER, request, device, out);
                return;
            }
            DIRECT => {
                direct(header, missing == 0, &mut reader, device, out);
            }
            _ => {}
        }
        if missing > 0 {
            cut(missing.into(), Place::new(bytes.len(), 0), out);
        }
    }
    unknown(&mut reader, out);
}

fn number(def: &'static FieldDef, raw: i64, place: Place, out: &mut Decoded) {
    let scale = Scale::ONE;
    out.push(None, Name::Def(def), Value::Number { raw, scale }, place);
}

fn head(reader: &mut Reader<'_>, out: &mut Decoded) -> Option<()> {
    let (version, place) = reader.u8()?;
    number(&VERSION, i64::from(version), place, out);
    for (def, names, mask) in [
        (&TYPE, &HART_IP_MESSAGE_TYPE, 0x0F),
        (&ID, &HART_IP_MESSAGE_ID, 0xFF),
        (&STATUS, &HART_IP_STATUS, 0xFF),
    ] {
        let (code, place) = reader.u8()?;
        named_field(def, names, u32::from(code & mask), place, out);
    }
    let (sequence, place) = reader.u16()?;
    number(&SEQUENCE, i64::from(sequence), place, out);
    let (len, place) = reader.u16()?;
    number(&LENGTH, i64::from(len), place, out);
    Some(())
}

fn session(reader: &mut Reader<'_>, out: &mut Decoded) -> Option<()> {
    let (master, place) = reader.u8()?;
    named_field(&MASTER, &HART_IP_MASTER, u32::from(master), place, out);
    let (bytes, place) = reader.take(4)?;
    let raw = bytes.try_into().map(u32::from_be_bytes).ok()?;
    number(&INACTIVITY, i64::from(raw), place, out);
    Some(())
}

/// Commands one after the other, without the frames around them; `whole` if the message is.
fn direct(
    header: Header,
    whole: bool,
    reader: &mut Reader<'_>,
    device: Device,
    out: &mut Decoded,
) -> Option<()> {
    let (status, place) = reader.u8()?;
    let name = Name::Def(&DEVICE);
    decode::flags(out, None, name, u32::from(status), &DEVICE_STATUS, place);
    let (status, place) = reader.u8()?;
    let name = Name::Def(&EXTENDED);
    let bits = &EXTENDED_DEVICE_STATUS;
    decode::flags(out, None, name, u32::from(status), bits, place);
    let way = match header.role() {
        Role::Request => Way::Request,
        _ => Way::Response,
    };
    while !reader.is_empty() {
        let (raw, place) = reader.u16()?;
        let known = command(raw);
        let value = Value::Named(u32::from(raw), known.map(|c| c.label));
        out.push(None, Name::Def(&NUMBER), value, place);
        let (count, place) = reader.u8()?;
        number(&COUNT, i64::from(count), place, out);
        let want = usize::from(count);
        let missing = want.saturating_sub(reader.left());
        let mut own = reader.sub(want.min(reader.left()))?;
        let mut open = true;
        if way == Way::Response {
            let Some((code, place)) = own.u8() else {
                // At least the response code; what the message itself lacks is said there.
                if whole {
                    cut(missing.max(1), own.here(), out);
                }
                continue;
            };
            open = answered(known, code, &CODE, place, out);
        }
        if missing > 0 {
            unknown(&mut own, out);
            // What the message itself lacks is said there.
            if whole {
                cut(missing, reader.here(), out);
            }
            return None;
        }
        let mut data = Data::new(way, device.family(), out);
        content(raw, open, &mut own, &mut data);
        unknown(&mut own, out);
    }
    Some(())
}

fn cut(missing: usize, place: Place, out: &mut Decoded) {
    let missing = u16::try_from(missing).unwrap_or(u16::MAX);
    out.problem(Problem::new(Finding::Truncated { missing }, place));
}

/// The frame inside a message, from its delimiter on, if it carries one.
pub(super) fn carried(bytes: &[u8]) -> Option<&[u8]> {
    let carries = Header::of(bytes)?.id == TOKEN_PASSING;
    bytes
        .get(HEADER..)
        .filter(|frame| carries && !frame.is_empty())
}

/// Address, master and command of the frame inside, as keys of a JSON object.
pub(crate) fn write_who(out: &mut impl fmt::Write, bytes: &[u8]) -> fmt::Result {
    write_head(out, carried(bytes).and_then(identity))
}

/// Requests that wait for an answer, by their sequence number.
#[derive(Clone, Debug)]
pub(crate) struct Sequence {
    open: [Option<(u16, u8, u32)>; 16],
    next: usize,
}

impl Sequence {
    pub(crate) const fn new() -> Self {
        Self {
            open: [None; 16],
            next: 0,
        }
    }

    /// Notes a request, or finds the request of a response.
    pub(crate) fn settle(&mut self, found: &Found, index: u32) -> Option<u32> {
        let key = (found.transaction, found.function);
        match found.role {
            Role::Request => {
                if let Some(slot) = self.open.get_mut(self.next) {
                    *slot = Some((key.0, key.1, index));
                }
                self.next = self.next.wrapping_add(1) % 16;
                None
            }
            Role::Response => {
                let fits = |o: &&mut Option<(u16, u8, u32)>| o.is_some_and(|o| (o.0, o.1) == key);
                self.open.iter_mut().find(fits)?.take().map(|o| o.2)
            }
            _ => None,
        }
    }
}

/// Whom a message is about, in a few words.
pub(super) fn who(bytes: &[u8]) -> String {
    let header = Header::of(bytes);
    let name = header.and_then(|h| HART_IP_MESSAGE_ID.name(u32::from(h.id)));
    let name = name.unwrap_or("HART-IP").to_ascii_lowercase();
    let carried = header.is_some_and(|h| h.id == TOKEN_PASSING);
    match bytes.get(HEADER..).filter(|_| carried).and_then(identity) {
        Some((head, number)) if head.address != Address::BROADCAST => {
            let label = command(number).map_or("unknown command", |c| c.label);
            format!("{name}, {}, command {number} {label}", head.address)
        }
        _ => name,
    }
}
