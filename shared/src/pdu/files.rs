//! Functions 20 and 21: file records.

use super::{Pdu, defs};
use crate::place::Place;
use crate::problem::Finding;
use crate::reader::Reader;
use crate::scale::Scale;
use crate::tree::{FieldDef, FieldId, Name};
use crate::value::Value;

impl<'a> Pdu<'a, '_> {
    /// FC 20, request: groups of reference type, file, first record and length.
    pub(super) fn files_request(&mut self) -> Option<()> {
        let count = self.byte_count()?;
        if count % 7 != 0 {
            let allowed = "a multiple of 7";
            self.find(
                Finding::FieldValue {
                    got: u32::from(count),
                    allowed,
                },
                self.reader.here(),
            );
        }
        let mut data = self.data(usize::from(count));
        let mut at = 0_u16;
        while let Some(mut group) = data.sub(7) {
            self.group(&defs::SUB_REQUEST, at, &mut group);
            at = at.saturating_add(1);
        }
        let (_, place) = data.take_rest();
        self.raw(&defs::UNKNOWN, place);
        Some(())
    }

    /// FC 20, response: groups of length, reference type and records.
    pub(super) fn files_response(&mut self) -> Option<()> {
        let count = self.byte_count()?;
        let mut data = self.data(usize::from(count));
        if self.asked.is_none() {
            self.find(Finding::NoRequest, data.here());
        }
        let mut at = 0_u16;
        while let Some(&length) = data.rest().first() {
            let whole = usize::from(length).saturating_add(1);
            let Some(mut group) = data.sub(whole.min(data.left())) else {
                break;
            };
            let id = self.item(&defs::SUB_RESPONSE, at, group.here());
            let (_, place) = self.sub_byte(id, &defs::FILE_LENGTH, &mut group)?;
            if group.left() < usize::from(length) {
                let got = u16::from(length);
                let want = u16::try_from(group.left()).unwrap_or(u16::MAX);
                self.find(Finding::Count { got, want }, place);
            }
            if !group.is_empty() {
                self.reference(id, &mut group);
            }
            self.answered(id, at, &mut group);
            at = at.saturating_add(1);
        }
        Some(())
    }

    /// The records of a response: values of the file if it is known which file it is.
    #[cfg(feature = "icon")]
    fn answered(&mut self, id: FieldId, at: u16, group: &mut Reader<'a>) {
        use crate::device::Device;
        let start = self.first_record(at);
        let asked = |offset: usize| {
            let at = usize::from(at).checked_mul(7)?.checked_add(offset)?;
            self.asked.as_ref()?.word(at)
        };
        let (file, count) = (asked(3), asked(7));
        if let Some(count) = count
            && usize::from(count).saturating_mul(2) != group.left()
            && !self.damaged
        {
            let bytes = |n: usize| u16::try_from(n).unwrap_or(u16::MAX);
            let got = bytes(group.left());
            let want = bytes(usize::from(count).saturating_mul(2));
            self.find(Finding::NotAsAsked { got, want }, group.here());
        }
        if let (Device::Icon3000v2, Some(file), Some(start)) = (self.device, file, start)
            && crate::icon3000::tree::records(self.out, id, file, start, group)
        {
            return;
        }
        self.records(id, start, group);
    }

    /// The records of a response, as words.
    #[cfg(not(feature = "icon"))]
    fn answered(&mut self, id: FieldId, at: u16, group: &mut Reader<'a>) {
        self.records(id, self.first_record(at), group);
    }

    /// FC 21: groups of reference type, file, first record, length and records; the response is
    /// the request again.
    pub(super) fn files_write(&mut self) -> Option<()> {
        let count = self.byte_count()?;
        let mut data = self.data(usize::from(count));
        let mut at = 0_u16;
        while data.left() >= 7 {
            let words = data.rest().get(5..7)?;
            let words = usize::from(u16::from_be_bytes(words.try_into().ok()?));
            let whole = words.saturating_mul(2).saturating_add(7).min(data.left());
            let mut group = data.sub(whole)?;
            let first = group
                .rest()
                .get(3..5)
                .and_then(|w| w.try_into().ok())
                .map(u16::from_be_bytes);
            let id = self.group(&defs::SUB_REQUEST, at, &mut group);
            self.records(id, first, &mut group);
            at = at.saturating_add(1);
        }
        let (_, place) = data.take_rest();
        self.raw(&defs::UNKNOWN, place);
        Some(())
    }

    /// Reference type, file number, first record and length; what follows stays in `group`.
    fn group(&mut self, def: &'static FieldDef, at: u16, group: &mut Reader<'a>) -> FieldId {
        let id = self.item(def, at, group.here());
        self.reference(id, group);
        for field in [&defs::FILE, &defs::RECORD, &defs::RECORDS] {
            if let Some((value, place)) = group.u16() {
                let number = Value::Number {
                    raw: i64::from(value),
                    scale: Scale::ONE,
                };
                self.out.push(Some(id), Name::Def(field), number, place);
                if field.key == defs::RECORD.key && value > 9999 {
                    self.find(
                        Finding::FieldValue {
                            got: u32::from(value),
                            allowed: "0 to 9999",
                        },
                        place,
                    );
                }
            }
        }
        id
    }

    fn reference(&mut self, id: FieldId, group: &mut Reader<'a>) {
        if let Some((value, place)) = self.sub_byte(id, &defs::REFERENCE, group)
            && value != 6
        {
            self.find(
                Finding::FieldValue {
                    got: u32::from(value),
                    allowed: "6",
                },
                place,
            );
        }
    }

    /// Words of a file, numbered from the first record that was asked for.
    fn records(&mut self, id: FieldId, first: Option<u16>, group: &mut Reader<'a>) {
        let mut at = first.unwrap_or(0);
        while let Some((word, place)) = group.u16() {
            let value = Value::Hex(u32::from(word));
            self.out
                .push(Some(id), Name::Item(&defs::RECORD_DATA, at), value, place);
            at = at.saturating_add(1);
        }
        let (_, place) = group.take_rest();
        if place.len > 0 {
            self.out
                .push(Some(id), Name::Def(&defs::UNKNOWN), Value::Raw, place);
        }
    }

    /// First record of sub-request number `at`, if the request is known.
    fn first_record(&self, at: u16) -> Option<u16> {
        let start = usize::from(at).checked_mul(7)?.checked_add(5)?;
        self.asked.as_ref()?.word(start)
    }

    fn item(&mut self, def: &'static FieldDef, at: u16, place: Place) -> FieldId {
        self.out
            .push(None, Name::Item(def, at), Value::Group, place)
    }

    fn sub_byte(
        &mut self,
        id: FieldId,
        def: &'static FieldDef,
        group: &mut Reader<'a>,
    ) -> Option<(u8, Place)> {
        let (value, place) = group.u8()?;
        let number = Value::Number {
            raw: i64::from(value),
            scale: Scale::ONE,
        };
        self.out.push(Some(id), Name::Def(def), number, place);
        Some((value, place))
    }
}
