//! Functions 17 and 43: who a device is.

use super::{Pdu, defs, names};
use crate::frame::Role;
use crate::problem::Finding;
use crate::tree::{FieldId, Name};
use crate::value::Value;

/// Bytes of additional data in the report of an ICON3000.
const ICON_REPORT: u8 = 0x52;

impl Pdu<'_, '_> {
    /// FC 17, response: byte count, server ID, run indicator, additional data.
    ///
    /// Reading E63: the ICON3000 manual counts the 82 additional bytes only; both ways of counting
    /// are accepted.
    pub(super) fn report(&mut self) -> Option<()> {
        let (count, place) = self.byte(None, &defs::BYTE_COUNT)?;
        let left = self.reader.left();
        let short = count == ICON_REPORT && left == usize::from(count).saturating_add(2);
        let counted = u16::try_from(left).unwrap_or(u16::MAX);
        if short {
            self.find(
                Finding::ReportCount {
                    got: u16::from(count),
                    want: counted,
                },
                place,
            );
        } else if usize::from(count) > left {
            self.find(
                Finding::Count {
                    got: u16::from(count),
                    want: counted,
                },
                place,
            );
        }
        let is_icon = self.device.is_icon() && (short || usize::from(count) == 84);
        if is_icon {
            let (id, place) = self.reader.u8()?;
            self.def(&defs::SERVER_ID, Value::Hex(u32::from(id)), place);
            self.run_indicator()?;
            for (def, len) in defs::ICON_REPORT {
                let (_, place) = self.reader.take(len)?;
                self.def(def, Value::Text, place);
            }
            return Some(());
        }
        // The standard leaves the length of the server ID to the device, so where it ends and the
        // run indicator stands is not known; one byte is usual.
        let mut data = self.data(usize::from(count));
        if let Some((id, place)) = data.u8() {
            self.def(&defs::SERVER_ID, Value::Hex(u32::from(id)), place);
        }
        if let Some((run, place)) = data.u8() {
            self.def(
                &defs::RUN,
                Value::Named(u32::from(run), run_name(run)),
                place,
            );
        }
        let (_, place) = data.take_rest();
        self.raw(&defs::ADDITIONAL, place);
        Some(())
    }

    fn run_indicator(&mut self) -> Option<()> {
        let (run, place) = self.reader.u8()?;
        self.def(
            &defs::RUN,
            Value::Named(u32::from(run), run_name(run)),
            place,
        );
        Some(())
    }

    /// FC 43: MEI type, and for type 14 the device identification.
    pub(super) fn encapsulated(&mut self) -> Option<()> {
        let (mei, place) = self.reader.u8()?;
        let name = match mei {
            13 => Some("CANopen general reference"),
            14 => Some("Read device identification"),
            _ => None,
        };
        self.def(&defs::MEI, Value::Named(u32::from(mei), name), place);
        if mei != 14 {
            if name.is_none() {
                self.find(
                    Finding::UnknownSub {
                        code: u16::from(mei),
                    },
                    place,
                );
            }
            let (_, place) = self.reader.take_rest();
            self.raw(&defs::DATA, place);
            return Some(());
        }
        let (code, place) = self.reader.u8()?;
        self.def(
            &defs::READ_ID,
            Value::Named(u32::from(code), names::read_id(code)),
            place,
        );
        if names::read_id(code).is_none() {
            self.find(
                Finding::FieldValue {
                    got: u32::from(code),
                    allowed: "1 to 4",
                },
                place,
            );
        }
        if self.role == Role::Response {
            self.identification()
        } else {
            let (id, place) = self.reader.u8()?;
            self.def(
                &defs::OBJECT_ID,
                Value::Named(u32::from(id), names::object(id)),
                place,
            );
            Some(())
        }
    }

    fn identification(&mut self) -> Option<()> {
        let (level, place) = self.reader.u8()?;
        self.def(&defs::CONFORMITY, Value::Hex(u32::from(level)), place);
        let (more, place) = self.reader.u8()?;
        let name = match more {
            0 => Some("No"),
            0xFF => Some("Yes"),
            _ => None,
        };
        self.def(&defs::MORE, Value::Named(u32::from(more), name), place);
        let (next, place) = self.reader.u8()?;
        self.def(&defs::NEXT_OBJECT, Value::Hex(u32::from(next)), place);
        let (count, _) = self.byte(None, &defs::OBJECTS)?;
        for at in 0..u16::from(count) {
            self.object(at)?;
        }
        Some(())
    }

    fn object(&mut self, at: u16) -> Option<()> {
        let len = usize::from(*self.reader.rest().get(1)?);
        let mut whole = self.reader;
        let place = whole.sub(len.saturating_add(2).min(self.reader.left()))?;
        let name = Name::Item(&defs::OBJECT, at);
        let id: FieldId = self.out.push(None, name, Value::Group, place.here());
        let (object, place) = self.reader.u8()?;
        let value = Value::Named(u32::from(object), names::object(object));
        self.out
            .push(Some(id), Name::Def(&defs::OBJECT_ID), value, place);
        self.byte(Some(id), &defs::OBJECT_LENGTH)?;
        let (_, place) = self.reader.take(len)?;
        if len > 0 {
            self.out
                .push(Some(id), Name::Def(&defs::OBJECT_VALUE), Value::Text, place);
        }
        Some(())
    }
}

/// Source: Modbus Application Protocol V1.1b3, section 6.13.
const fn run_name(run: u8) -> Option<&'static str> {
    match run {
        0 => Some("Off"),
        0xFF => Some("On"),
        _ => None,
    }
}
