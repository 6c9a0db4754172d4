//! The Modbus application layer: PDUs to fields.
//!
//! Source: Modbus Application Protocol V1.1b3.

mod asked;
mod bits;
pub(crate) mod defs;
mod diagnostics;
mod files;
mod identity;
pub mod length;
pub mod names;
mod registers;

pub use asked::Asked;

use crate::device::Device;
use crate::frame::Role;
use crate::map::row::DeviceMap;
use crate::place::Place;
use crate::problem::{Finding, Problem};
use crate::reader::Reader;
use crate::scale::Scale;
use crate::tree::{Decoded, FieldDef, FieldId, Name};
use crate::value::Value;

/// What a PDU decoder works on. Its methods take bytes and leave fields; `None` means that the
/// bytes ran out, and ends the decoding of this PDU.
pub(crate) struct Pdu<'a, 'b> {
    pub out: &'b mut Decoded,
    pub reader: Reader<'a>,
    pub device: Device,
    pub role: Role,
    pub unit: u8,
    /// The frame is damaged: counts that disagree say nothing new.
    pub damaged: bool,
    /// What the request of this response asked for.
    pub asked: Option<Asked<'a>>,
}

impl<'a> Pdu<'a, '_> {
    /// Decodes the PDU; what is left of it becomes an "unknown" field.
    pub(crate) fn decode(&mut self) {
        let complete = self.body();
        if self.reader.is_empty() {
            return;
        }
        let (bytes, place) = self.reader.take_rest();
        self.out
            .push(None, Name::Def(&defs::UNKNOWN), Value::Raw, place);
        if complete.is_some() && !self.damaged {
            let len = u16::try_from(bytes.len()).unwrap_or(u16::MAX);
            self.find(Finding::Surplus { len }, place);
        }
    }

    fn body(&mut self) -> Option<()> {
        let (code, place) = self.reader.u8()?;
        let function = code & 0x7F;
        let known = names::function(function);
        self.out.push(
            None,
            Name::Def(&defs::FUNCTION),
            Value::Named(u32::from(code), known),
            place,
        );
        if known.is_none() {
            self.find(Finding::UnknownFunction { code: function }, place);
        } else if !self.device.implements(function) && self.role == Role::Request {
            self.find(Finding::NotImplemented { code: function }, place);
        }
        if code >= 0x80 {
            let (exception, place) = self.reader.u8()?;
            let name = names::exception(exception).map(|e| e.0);
            self.def(
                &defs::EXCEPTION,
                Value::Named(u32::from(exception), name),
                place,
            );
            self.find(Finding::Exception { code: exception }, place);
            return Some(());
        }
        let answer = self.role == Role::Response;
        match (function, answer) {
            (1..=4, false) => self.read_request(function),
            (1 | 2, true) => self.bits_response(),
            (3 | 4, true) => self.registers_response(function),
            (5, _) => self.write_coil(),
            (6, _) => self.write_register(),
            (7, true) => self.exception_status(),
            (7 | 11 | 12 | 17, false) => Some(()),
            (8, _) => self.diagnostics(),
            (11, true) => self.event_counter(),
            (12, true) => self.event_log(),
            (15, _) => self.write_coils(),
            (16, _) => self.write_registers(),
            (17, true) => self.report(),
            (20, false) => self.files_request(),
            (20, true) => self.files_response(),
            (21, _) => self.files_write(),
            (22, _) => self.mask_write(),
            (23, false) => self.read_write_request(),
            (23, true) => self.registers_response(function),
            (24, false) => self.fifo_request(),
            (24, true) => self.fifo_response(),
            (43, _) => self.encapsulated(),
            _ => {
                let (_, place) = self.reader.take_rest();
                self.raw(&defs::DATA, place);
                Some(())
            }
        }
    }

    // ---- small steps shared by all functions

    fn map(&self) -> Option<&'static DeviceMap> {
        self.device.map()
    }

    fn find(&mut self, finding: Finding, place: Place) {
        self.out.problem(Problem::new(finding, place));
    }

    fn def(&mut self, def: &'static FieldDef, value: Value, place: Place) -> FieldId {
        self.out.push(None, Name::Def(def), value, place)
    }

    fn raw(&mut self, def: &'static FieldDef, place: Place) {
        if place.len > 0 {
            self.def(def, Value::Raw, place);
        }
    }

    fn byte(&mut self, parent: Option<FieldId>, def: &'static FieldDef) -> Option<(u8, Place)> {
        let (value, place) = self.reader.u8()?;
        let number = Value::Number {
            raw: i64::from(value),
            scale: Scale::ONE,
        };
        self.out.push(parent, Name::Def(def), number, place);
        Some((value, place))
    }

    fn word(&mut self, parent: Option<FieldId>, def: &'static FieldDef) -> Option<(u16, Place)> {
        let (value, place) = self.reader.u16()?;
        let number = Value::Number {
            raw: i64::from(value),
            scale: Scale::ONE,
        };
        self.out.push(parent, Name::Def(def), number, place);
        Some((value, place))
    }

    fn hex_word(
        &mut self,
        parent: Option<FieldId>,
        def: &'static FieldDef,
    ) -> Option<(u16, Place)> {
        let (value, place) = self.reader.u16()?;
        self.out
            .push(parent, Name::Def(def), Value::Hex(u32::from(value)), place);
        Some((value, place))
    }

    /// A byte count, compared with the bytes that are there.
    fn byte_count(&mut self) -> Option<u8> {
        let (count, place) = self.byte(None, &defs::BYTE_COUNT)?;
        let left = u16::try_from(self.reader.left()).unwrap_or(u16::MAX);
        if u16::from(count) > left && !self.damaged {
            self.find(
                Finding::Count {
                    got: u16::from(count),
                    want: left,
                },
                place,
            );
        }
        Some(count)
    }

    /// A quantity, compared with what the function allows.
    fn quantity(&mut self, def: &'static FieldDef, max: u16) -> Option<(u16, Place)> {
        let (quantity, place) = self.word(None, def)?;
        if quantity == 0 || quantity > max {
            self.find(Finding::Quantity { got: quantity, max }, place);
        }
        Some((quantity, place))
    }
}
