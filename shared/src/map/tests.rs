//! The tables that the build made, against the manual.

mod ddc100;
mod errata;
mod lookup;
mod manual;

use super::row::{Model, Reading, Row, Set};
use crate::address::{Address, Table};

/// The row of the newest model at an address.
fn at(table: Table, address: u16) -> &'static Row {
    of(Model::Icon3000v2, table, address)
}

fn of(model: Model, table: Table, address: u16) -> &'static Row {
    let row = model.map().row_at(table, Address::new(address));
    row.expect("the map covers the address")
}

fn reading(row: &Row) -> &'static Reading {
    row.reading.expect("the row names a reading")
}

/// The codes or bits of a set in short: `0=Off 1=On`.
fn members(row: &Row) -> String {
    let members = row.set.map_or(&[][..], |set: &Set| set.members);
    let members: Vec<_> = members
        .iter()
        .map(|m| format!("{}={}", m.value, m.label))
        .collect();
    members.join(" ")
}
