//! Functions 03, 04, 06, 16, 22, 23 and 24: registers.

use super::{Pdu, defs};
use crate::address::{Address, Table};
use crate::frame::Role;
use crate::map;
use crate::place::Place;
use crate::problem::Finding;
use crate::reader::{Layout, Reader};
use crate::scale::Scale;
use crate::tree::{FieldDef, Name};
use crate::value::Value;

impl<'a> Pdu<'a, '_> {
    /// FC 01 to 04: first address and quantity.
    pub(super) fn read_request(&mut self, function: u8) -> Option<()> {
        let table = Table::of_read_function(function)?;
        let (start, _) = self.address(&defs::START, table)?;
        let (count, place) = self.quantity(&defs::QUANTITY, table.max_read())?;
        self.check_end(table, start, count, place);
        if self.unit == 0 {
            self.find(Finding::BroadcastRead, place);
        }
        Some(())
    }

    /// An address field.
    pub(super) fn address(
        &mut self,
        def: &'static FieldDef,
        table: Table,
    ) -> Option<(Address, Place)> {
        let (wire, place) = self.reader.u16()?;
        let address = Address::new(wire);
        self.def(def, Value::Address(table, address), place);
        Some((address, place))
    }

    /// Start and quantity must stay inside the device's table, as far as its end is known, or
    /// inside 16 bits.
    pub(super) fn check_end(&mut self, table: Table, start: Address, count: u16, place: Place) {
        let map = self.map().filter(|map| map.whole);
        let limit = map.map_or(65_536, |m| map::decode::len(m, table));
        let end = u32::from(start.get()).saturating_add(u32::from(count));
        if end > limit {
            self.find(
                Finding::PastEnd {
                    start: start.get(),
                    count,
                    limit,
                },
                place,
            );
        }
    }

    /// FC 03, 04 and 23: byte count and words.
    pub(super) fn registers_response(&mut self, function: u8) -> Option<()> {
        let count = self.byte_count()?;
        let data = self.data(usize::from(count));
        let table = Table::of_read_function(function).unwrap_or(Table::Holding);
        let Some((_, start, asked)) = self.asked.and_then(|a| a.read()) else {
            self.find(Finding::NoRequest, data.here());
            self.nameless(data);
            return Some(());
        };
        self.as_asked(count, asked.saturating_mul(2), data.here());
        map::words(self.out, self.map(), table, start, data);
        Some(())
    }

    /// FC 06: address and value; the response repeats both.
    pub(super) fn write_register(&mut self) -> Option<()> {
        let (address, place) = self.address(&defs::ADDRESS, Table::Holding)?;
        self.echoed(1, address.get(), place);
        let before = self.reader.rest();
        let data = self.data(2);
        if let Some(pair) = before.first_chunk::<2>() {
            self.echoed(3, u16::from_be_bytes(*pair), data.here());
        }
        map::words(self.out, self.map(), Table::Holding, address, data);
        Some(())
    }

    /// FC 16: first address, quantity and, in a request, byte count and values.
    pub(super) fn write_registers(&mut self) -> Option<()> {
        let (start, count) = self.write_many(Table::Holding, 123)?;
        if self.role == Role::Response {
            return Some(());
        }
        let data = self.counted(count.saturating_mul(2))?;
        map::words(self.out, self.map(), Table::Holding, start, data);
        Some(())
    }

    /// FC 22: address, AND mask, OR mask.
    pub(super) fn mask_write(&mut self) -> Option<()> {
        let (address, place) = self.address(&defs::ADDRESS, Table::Holding)?;
        self.echoed(1, address.get(), place);
        let (and, place) = self.hex_word(None, &defs::AND_MASK)?;
        self.echoed(3, and, place);
        let (or, place) = self.hex_word(None, &defs::OR_MASK)?;
        self.echoed(5, or, place);
        Some(())
    }

    /// FC 23, request: what to read, then what to write.
    pub(super) fn read_write_request(&mut self) -> Option<()> {
        let (read, _) = self.address(&defs::READ_START, Table::Holding)?;
        let (count, place) = self.quantity(&defs::READ_QUANTITY, 125)?;
        self.check_end(Table::Holding, read, count, place);
        let (write, _) = self.address(&defs::WRITE_START, Table::Holding)?;
        let (count, place) = self.quantity(&defs::WRITE_QUANTITY, 121)?;
        self.check_end(Table::Holding, write, count, place);
        let data = self.counted(count.saturating_mul(2))?;
        map::words(self.out, self.map(), Table::Holding, write, data);
        Some(())
    }

    /// FC 24, request: the address of the queue.
    pub(super) fn fifo_request(&mut self) -> Option<()> {
        self.address(&defs::ADDRESS, Table::Holding).map(|_| ())
    }

    /// FC 24, response: byte count, number of values, values.
    pub(super) fn fifo_response(&mut self) -> Option<()> {
        let (bytes, place) = self.word(None, &defs::BYTE_COUNT)?;
        let (count, count_place) = self.word(None, &defs::FIFO_COUNT)?;
        let want = count.saturating_mul(2).saturating_add(2);
        if bytes != want {
            self.find(Finding::Count { got: bytes, want }, place);
        }
        if count > 31 {
            self.find(
                Finding::Quantity {
                    got: count,
                    max: 31,
                },
                count_place,
            );
        }
        for at in 0..count {
            let (value, place) = self.reader.u16()?;
            let value = Value::Hex(u32::from(value));
            self.out
                .push(None, Name::Item(&defs::FIFO_VALUE, at), value, place);
        }
        Some(())
    }

    /// Words whose addresses are not known.
    pub(super) fn nameless(&mut self, mut data: Reader<'a>) {
        let mut at = 0_u16;
        while let Some((word, place)) = data.u16() {
            let value = Value::Number {
                raw: i64::from(word),
                scale: Scale::ONE,
            };
            self.out
                .push(None, Name::Item(&defs::DATA, at), value, place);
            at = at.saturating_add(1);
        }
        let (_, place) = data.take_rest();
        self.raw(&defs::UNKNOWN, place);
    }

    /// First address and quantity of a write of many; a response repeats both.
    pub(super) fn write_many(&mut self, table: Table, max: u16) -> Option<(Address, u16)> {
        let (start, start_place) = self.address(&defs::START, table)?;
        let (count, place) = self.quantity(&defs::QUANTITY, max)?;
        self.check_end(table, start, count, place);
        self.echoed(1, start.get(), start_place);
        self.echoed(3, count, place);
        Some((start, count))
    }

    /// A byte count, which must be `want`, and as many bytes.
    pub(super) fn counted(&mut self, want: u16) -> Option<Reader<'a>> {
        let (bytes, place) = self.byte(None, &defs::BYTE_COUNT)?;
        let got = u16::from(bytes);
        if got != want {
            self.find(Finding::Count { got, want }, place);
        }
        Some(self.data(usize::from(bytes)))
    }

    /// Says if a response holds another number of bytes than was asked for.
    pub(super) fn as_asked(&mut self, count: u8, want: u16, place: Place) {
        let got = u16::from(count);
        if got != want {
            self.find(Finding::NotAsAsked { got, want }, place);
        }
    }

    /// Compares an echoed word with the request.
    pub(super) fn echoed(&mut self, at: usize, got: u16, place: Place) {
        if self.role != Role::Response {
            return;
        }
        if let Some(want) = self.asked.and_then(|a| a.word(at))
            && want != got
        {
            self.find(Finding::EchoDiffers { got, want }, place);
        }
    }

    /// A reader over the next `len` bytes, or over what there is.
    pub(super) fn data(&mut self, len: usize) -> Reader<'a> {
        let len = len.min(self.reader.left());
        self.reader
            .sub(len)
            .unwrap_or(Reader::new(&[], 0, Layout::Plain))
    }
}
