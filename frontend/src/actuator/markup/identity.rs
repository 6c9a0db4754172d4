//! Who the device is: its registers, its answer to FC 17, its cards.

use shared::address::Table;
use shared::map::row::{Access, Kind, Row};

use crate::actuator::state::dossier::Dossier;

/// Groups of registers that say who it is.
const GROUPS: [&str; 2] = ["Identity", "Valve"];

/// Registers that say who the device is, in the order of the map.
#[must_use]
pub fn registers(dossier: &Dossier) -> Vec<&'static Row> {
    let Some(map) = dossier.device.map() else {
        return Vec::new();
    };
    let rows = map.rows_of(Table::Holding).iter().copied();
    rows.filter(|row| GROUPS.contains(&row.group))
        .filter(|row| row.kind != Kind::Reserved && row.access != Access::Absent)
        .collect()
}
