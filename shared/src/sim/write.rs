//! Writes: what is checked, what is discarded without a word, what moves (sections 8.5 to 8.9, 11).

use super::answer::{ILLEGAL_ADDRESS, ILLEGAL_VALUE, Outcome, range, two_words};
use super::clock::Stamp;
use super::store::{Store, at};
use super::{Icon3000, bit, command};
use crate::address::{Address, Table};
use crate::map::row::{Access, Kind, Level, Row};

/// User levels with their passwords in this simulation.
const PASSWORDS: [(u16, Level, &[u8; 8]); 3] = [
    (1, Level::User, b"USER0000"),
    (2, Level::Service, b"SERVICE0"),
    (3, Level::Manufacturer, b"MAKER000"),
];

const COILS: u16 = 11;

impl Icon3000 {
    /// FC 05.
    pub(super) fn write_coil(&mut self, data: &[u8]) -> Outcome {
        let Some((address, value, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let on = match value {
            0xFF00 => true,
            0 => false,
            _ => return Err(ILLEGAL_VALUE),
        };
        range(address, 1, 1, COILS)?;
        if self.may_write(Table::Coil, address) {
            self.command_coil(address, on);
        }
        Ok(data.to_vec())
    }

    /// FC 15.
    pub(super) fn write_coils(&mut self, data: &[u8]) -> Outcome {
        let Some((start, quantity, [count, values @ ..])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let bytes = usize::from(quantity.div_ceil(8));
        if usize::from(*count) != bytes || values.len() != bytes {
            return Err(ILLEGAL_VALUE);
        }
        range(start, quantity, COILS, COILS)?;
        for index in 0..quantity {
            let byte = values.get(usize::from(index >> 3)).copied().unwrap_or(0);
            let on = byte.wrapping_shr(u32::from(index & 7)) & 1 != 0;
            let address = start.saturating_add(index);
            if self.may_write(Table::Coil, address)
                && let Some(mask) = self.coil_bit(address)
            {
                let bits = if on {
                    self.bits | mask
                } else {
                    self.bits & !mask
                };
                self.set_bits(bits);
            }
        }
        Ok(data.get(..4).unwrap_or(data).to_vec())
    }

    /// FC 06.
    pub(super) fn write_register(&mut self, data: &[u8]) -> Outcome {
        let Some((address, value, [])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        self.check(address, value)?;
        self.store_register(address, value);
        self.after_writes(address, 1);
        Ok(data.to_vec())
    }

    /// FC 16. Reading E61: a value out of range refuses the whole block.
    pub(super) fn write_registers(&mut self, data: &[u8]) -> Outcome {
        let Some((start, quantity, [count, values @ ..])) = two_words(data) else {
            return Err(ILLEGAL_VALUE);
        };
        let bytes = usize::from(quantity).saturating_mul(2);
        if usize::from(*count) != bytes || values.len() != bytes {
            return Err(ILLEGAL_VALUE);
        }
        range(start, quantity, 123, self.end_of_holding())?;
        let words: Vec<u16> = values
            .chunks_exact(2)
            .filter_map(|pair| pair.first_chunk::<2>())
            .map(|pair| u16::from_be_bytes(*pair))
            .collect();
        for (address, word) in (start..).zip(&words) {
            self.check(address, *word)?;
        }
        for (address, word) in (start..).zip(&words) {
            self.store_register(address, *word);
        }
        self.after_writes(start, quantity);
        Ok(data.get(..4).unwrap_or(data).to_vec())
    }

    fn row(&self, table: Table, address: u16) -> Option<&'static Row> {
        self.model.map().row_at(table, Address::new(address))
    }

    /// Value and address of a register write. Registers that can't be written are not refused.
    fn check(&self, address: u16, value: u16) -> Result<(), u8> {
        if address >= self.end_of_holding() {
            return Err(ILLEGAL_ADDRESS);
        }
        let Some(row) = self.row(Table::Holding, address) else {
            return Ok(());
        };
        let (Some((min, max)), Access::Write | Access::WriteGuarded, 1) =
            (row.range, row.access, row.words)
        else {
            return Ok(());
        };
        let raw = match row.kind {
            Kind::I16 => i32::from(value.cast_signed()),
            _ => i32::from(value),
        };
        // Reading E32: 0 only says that no reference curve is set.
        let unset = (at::SET_REFERENCES..at::SET_PROFILE).contains(&address) && value == 0;
        if (min..=max).contains(&raw) && !unset {
            Ok(())
        } else {
            Err(ILLEGAL_VALUE)
        }
    }

    /// True if the level that is logged in may write here. Without it a write is discarded, and
    /// nobody is told (section 11).
    fn may_write(&self, table: Table, address: u16) -> bool {
        let Some(row) = self.row(table, address) else {
            return false;
        };
        let writable = matches!(row.access, Access::Write | Access::WriteGuarded);
        // Levels came with the ICON3000v2. Reading E22: everybody may log in.
        let allowed = !self.is_v2() || row.level.is_none_or(|l| l <= self.level);
        writable && allowed
    }

    fn store_register(&mut self, address: u16, value: u16) {
        if !self.may_write(Table::Holding, address) {
            return;
        }
        match Store::home(address) {
            at::COMMAND_BITS => self.set_bits(value & bit::ALL),
            at::COMMAND => self.set_command(value),
            at::CLEAR_LOG if value == 1 => {
                self.alarms.clear();
                self.warnings.clear();
            }
            at::RESET if value == 1 => {
                self.drive.hi_torque = false;
                self.test_warnings = 0;
            }
            // These read as 0 whatever is written.
            at::CLEAR_LOG | at::RESET | at::WINK | at::SET_PROFILE | at::CLEAR_RECENT => {}
            at::DISPLAY_PASSWORD..=at::DISPLAY_PASSWORD_END => {}
            home => self.store.set(home, value),
        }
    }

    /// What takes several registers together.
    fn after_writes(&mut self, start: u16, quantity: u16) {
        let written = |first: u16, last: u16| {
            (start..start.saturating_add(quantity))
                .map(Store::home)
                .any(|a| (first..=last).contains(&a))
        };
        if written(at::DATE, at::TIME.saturating_add(1)) {
            let word = |offset| self.store.get(at::DATE.saturating_add(offset));
            let set = Stamp::read([word(0), word(1), word(2), word(3)]).and_then(Stamp::seconds);
            // What is no date does not set the clock.
            if let Some(set) = set {
                let set = i64::try_from(set).unwrap_or(i64::MAX);
                self.clock_offset = set.saturating_sub_unsigned(self.wall);
            }
        }
        if written(at::LEVEL, at::PASSWORD_END) {
            self.log_in();
        }
    }

    /// Level and password together say who it is; the password is not kept. A wrong one changes
    /// nothing (reading E83).
    fn log_in(&mut self) {
        let wanted = self.store.get(at::LEVEL);
        let password = self.store.run(at::PASSWORD, 4);
        if wanted == 0 {
            self.level = Level::Observer;
        } else if let Some((_, level, _)) = PASSWORDS
            .iter()
            .find(|(number, _, word)| *number == wanted && word.as_slice() == password)
        {
            self.level = *level;
        } else {
            // Word by word the password may still become right.
            return;
        }
        self.store.fill(at::PASSWORD, [0; 4]);
    }

    /// FC 05 on a command (section 7.2, note 1).
    fn command_coil(&mut self, address: u16, on: bool) {
        let Some(mask) = self.coil_bit(address) else {
            return;
        };
        let travel = mask & (bit::OPEN | bit::CLOSE) != 0;
        let bits = match (on, travel) {
            // The one reverses the other.
            (true, true) => self.bits & !(bit::OPEN | bit::CLOSE) | mask,
            (true, false) => self.bits | mask,
            // They keep themselves up until stop is on.
            (false, true) if self.bits & bit::STOP == 0 => self.bits,
            (false, _) => self.bits & !mask,
        };
        self.set_bits(bits);
    }

    fn set_bits(&mut self, bits: u16) {
        let rising = bits & !self.bits;
        self.bits = bits;
        self.since_command_ms = 0;
        if rising & bit::PST != 0 {
            self.begin_test();
        }
    }

    fn set_command(&mut self, value: u16) {
        self.command = value;
        self.since_command_ms = 0;
        if matches!(value, command::PST | command::BASELINE_PST) {
            self.begin_test();
        }
    }
}
