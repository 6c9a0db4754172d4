//! The Modbus interface of the device: its channels, its counters, its settings.

use shared::address::Table;
use shared::map::row::{Access, Kind, Row};

use crate::actuator::state::dossier::Dossier;

/// Registers of the Modbus interface, in the order of the map.
#[must_use]
pub fn registers(dossier: &Dossier) -> Vec<&'static Row> {
    let Some(map) = dossier.device.map() else {
        return Vec::new();
    };
    let rows = map.rows_of(Table::Holding).iter().copied();
    rows.filter(|row| row.group == "Modbus")
        .filter(|row| row.kind != Kind::Reserved && row.access != Access::Absent)
        .collect()
}
