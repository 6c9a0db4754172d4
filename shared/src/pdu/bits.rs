//! Functions 01, 02, 05 and 15: coils and discrete inputs.

use super::{Pdu, defs};
use crate::address::{Address, Table};
use crate::frame::Role;
use crate::problem::Finding;
use crate::reader::Reader;
use crate::tree::Name;
use crate::value::{ON_OFF, Value};

impl<'a> Pdu<'a, '_> {
    /// FC 01 and 02: byte count and packed bits, the first in bit 0.
    pub(super) fn bits_response(&mut self) -> Option<()> {
        let count = self.byte_count()?;
        let data = self.data(usize::from(count));
        let Some((table, start, asked)) = self.asked.and_then(|a| a.read()) else {
            self.find(Finding::NoRequest, data.here());
            self.raw(&defs::DATA, data.here());
            return Some(());
        };
        self.as_asked(count, asked.div_ceil(8), data.here());
        self.packed(table, start, asked, data);
        Some(())
    }

    /// FC 05: address and `FF00` or `0000`; the response repeats both.
    pub(super) fn write_coil(&mut self) -> Option<()> {
        let (address, place) = self.address(&defs::ADDRESS, Table::Coil)?;
        self.echoed(1, address.get(), place);
        self.check_end(Table::Coil, address, 1, place);
        let (word, place) = self.reader.u16()?;
        self.echoed(3, word, place);
        let name = self.bit_name(Table::Coil, address);
        match word {
            0xFF00 | 0 => {
                let value = Value::Bit {
                    on: word != 0,
                    words: &ON_OFF,
                };
                self.out.push(None, name, value, place);
            }
            got => {
                self.out.push(None, name, Value::Hex(u32::from(got)), place);
                self.find(Finding::CoilValue { got }, place);
            }
        }
        Some(())
    }

    /// FC 15: first address, quantity and, in a request, byte count and packed bits.
    pub(super) fn write_coils(&mut self) -> Option<()> {
        let (start, count) = self.write_many(Table::Coil, 1968)?;
        if self.role == Role::Response {
            return Some(());
        }
        let data = self.counted(count.div_ceil(8))?;
        self.packed(Table::Coil, start, count, data);
        Some(())
    }

    /// Packed bits: one field a byte, and in it one a bit.
    fn packed(&mut self, table: Table, start: Address, count: u16, mut data: Reader<'a>) {
        let mut done = 0_u16;
        let mut index = 0_u16;
        while let Some((byte, place)) = data.u8() {
            if done >= count {
                self.out
                    .push(None, Name::Item(&defs::DATA, index), Value::Raw, place);
                continue;
            }
            let parent = self.out.push(
                None,
                Name::Item(&defs::DATA, index),
                Value::Hex(u32::from(byte)),
                place,
            );
            index = index.saturating_add(1);
            for bit in 0..8_u32 {
                let on = byte.wrapping_shr(bit) & 1 != 0;
                let address = if done < count {
                    start.checked_add(done)
                } else {
                    None
                };
                let Some(address) = address else {
                    if on {
                        self.find(Finding::PaddingBits, place);
                        break;
                    }
                    continue;
                };
                let name = self.bit_name(table, address);
                self.out
                    .push(Some(parent), name, Value::Bit { on, words: &ON_OFF }, place);
                done = done.saturating_add(1);
            }
        }
    }

    fn bit_name(&self, table: Table, address: Address) -> Name {
        match self.map().and_then(|m| m.row_at(table, address)) {
            Some(row) if row.words == 1 => Name::Row(row),
            Some(row) => Name::Part(row, address),
            None => Name::Register(table, address),
        }
    }
}
