//! Functions 07, 08, 11 and 12: what a device says of the line.

use super::{Pdu, defs, names};
use crate::frame::Role;
use crate::problem::Finding;
use crate::scale::Scale;
use crate::tree::Name;
use crate::value::Value;

impl Pdu<'_, '_> {
    /// FC 07: eight bits whose meaning belongs to the device.
    pub(super) fn exception_status(&mut self) -> Option<()> {
        let (status, place) = self.reader.u8()?;
        self.def(
            &defs::EXCEPTION_STATUS,
            Value::Hex(u32::from(status)),
            place,
        );
        Some(())
    }

    /// FC 08: sub-function and data.
    pub(super) fn diagnostics(&mut self) -> Option<()> {
        let (sub, place) = self.reader.u16()?;
        let name = names::diagnostic(sub);
        self.def(
            &defs::SUB_FUNCTION,
            Value::Named(u32::from(sub), name),
            place,
        );
        self.echoed(1, sub, place);
        if name.is_none() {
            self.find(Finding::UnknownSub { code: sub }, place);
        }
        let answer = self.role == Role::Response;
        match sub {
            // Counters, and the diagnostic register.
            2 | 11..=18 => {
                let (data, place) = self.reader.u16()?;
                let value = match (answer, sub) {
                    (true, 11..) => Value::Number {
                        raw: i64::from(data),
                        scale: Scale::ONE,
                    },
                    _ => Value::Hex(u32::from(data)),
                };
                let def = if answer && sub > 10 {
                    &defs::COUNTER
                } else {
                    &defs::DIAGNOSTIC
                };
                self.def(def, value, place);
                if !answer && data != 0 {
                    self.find(
                        Finding::FieldValue {
                            got: u32::from(data),
                            allowed: "0000",
                        },
                        place,
                    );
                }
            }
            1 => {
                let (data, place) = self.hex_word(None, &defs::DIAGNOSTIC)?;
                if data != 0 && data != 0xFF00 {
                    let allowed = "0000 or FF00";
                    self.find(
                        Finding::FieldValue {
                            got: u32::from(data),
                            allowed,
                        },
                        place,
                    );
                }
            }
            _ => {
                let (data, place) = self.reader.take_rest();
                self.raw(&defs::DIAGNOSTIC, place);
                let sent = self.asked.and_then(|a| a.pdu.get(3..));
                // Only "return query data" must come back unchanged.
                if sub == 0
                    && answer
                    && let Some(sent) = sent
                    && sent != data
                {
                    let word =
                        |b: &[u8]| b.first_chunk::<2>().map_or(0, |w| u16::from_be_bytes(*w));
                    self.find(
                        Finding::EchoDiffers {
                            got: word(data),
                            want: word(sent),
                        },
                        place,
                    );
                }
            }
        }
        Some(())
    }

    /// FC 11: status and event count.
    pub(super) fn event_counter(&mut self) -> Option<()> {
        self.status()?;
        self.word(None, &defs::EVENTS).map(|_| ())
    }

    /// FC 12: byte count, status, event count, message count, up to 64 events.
    pub(super) fn event_log(&mut self) -> Option<()> {
        self.byte_count()?;
        self.status()?;
        self.word(None, &defs::EVENTS)?;
        self.word(None, &defs::MESSAGES)?;
        let mut at = 0_u16;
        while let Some((event, place)) = self.reader.u8() {
            let value = Value::Named(u32::from(event), Some(event_name(event)));
            self.out
                .push(None, Name::Item(&defs::EVENT, at), value, place);
            at = at.saturating_add(1);
        }
        Some(())
    }

    fn status(&mut self) -> Option<()> {
        let (status, place) = self.reader.u16()?;
        let name = match status {
            0 => Some("Ready"),
            0xFFFF => Some("Busy with an earlier program command"),
            _ => None,
        };
        self.def(&defs::STATUS, Value::Named(u32::from(status), name), place);
        Some(())
    }
}

/// What an event byte records. Source: Modbus Application Protocol V1.1b3, section 6.10.
const fn event_name(event: u8) -> &'static str {
    match event {
        0x00 => "Communication restart",
        0x04 => "Entered listen only mode",
        0x40..=0x7F => "Response sent",
        0x80.. => "Message received",
        _ => "Unknown event",
    }
}
