//! The registers of a unit, wherever they were read: function 03 gives all, function 04 gives 5 to
//! 16 again.

use crate::address::{Address, Table};
use crate::image::{Cell, Image};

/// Register 9: status.
pub const STATUS: u16 = 9;
/// Register 10: faults.
pub const FAULTS: u16 = 10;
/// Register 11: digital outputs.
pub const OUTPUTS: u16 = 11;
/// Register 12: digital inputs.
pub const INPUTS_1: u16 = 12;
/// Register 13: more digital inputs.
pub const INPUTS_2: u16 = 13;
/// Register 8: position, or an analog input.
pub const POSITION: u16 = 8;

/// The last word of a register, by its number; the newer one if both functions read it.
#[must_use]
pub fn register(image: &Image, number: u16) -> Option<Cell> {
    let address = Address::new(number.checked_sub(1)?);
    let cells = [Table::Holding, Table::Input].map(|table| image.cell(table, address).copied());
    cells.into_iter().flatten().max_by_key(|cell| cell.at)
}

/// True if a bit of a register was 0 at some time.
#[must_use]
pub fn was_clear(image: &Image, number: u16, bit: u32) -> bool {
    let address = number.checked_sub(1).map(Address::new);
    let cells = [Table::Holding, Table::Input].map(|table| image.cell(table, address?));
    let zeros = cells
        .into_iter()
        .flatten()
        .fold(0, |all, c| all | c.cleared);
    zeros.wrapping_shr(bit) & 1 == 1
}

/// One bit of a register.
#[must_use]
pub fn bit(image: &Image, number: u16, bit: u32) -> Option<bool> {
    let cell = register(image, number)?;
    Some(cell.word.wrapping_shr(bit) & 1 == 1)
}
