//! What changed between two snapshots, by meaning.

use super::logs;
use super::{Snapshot, Sort};
use crate::address::{Address, Table};
use crate::icon3000::counters;
use crate::icon3000::model::Mirror;
use crate::icon3000::say;
use crate::map::row::{Access, Kind, Row, Source};

/// One change.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Change {
    /// What sort of thing it is about.
    pub sort: Sort,
    /// Where it stands: `holding.3017`, `file.2`, `counter.11`, `identity.valve_tag`.
    pub path: String,
    /// What people read.
    pub label: String,
    /// What it said in the first snapshot; empty if it was not there.
    pub was: String,
    /// What it says in the second; empty if it is not there any more.
    pub now: String,
    /// Further places that show the same and changed alike.
    pub also: Vec<String>,
    /// Where it is described.
    pub source: Option<Source>,
}

/// Something that only one of the snapshots has, so that it cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OnlyOne {
    /// Where it stands.
    pub path: String,
    /// What people read.
    pub label: String,
    /// True if the second has it, false if the first has.
    pub in_second: bool,
}

/// What two snapshots have to say of each other.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Diff {
    /// What changed, sorted by [`Sort`]; within one, in the order of the map.
    pub changes: Vec<Change>,
    /// What cannot be compared, because it was read only once.
    pub only_one: Vec<OnlyOne>,
    /// What speaks against comparing them: another model, another serial number.
    pub remarks: Vec<String>,
}

impl Diff {
    /// True if nothing changed; counters, clock and measurements are changes too.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty()
    }

    /// The changes that somebody made, or that the device noted: without counters, clock and
    /// measurements.
    pub fn lasting(&self) -> impl Iterator<Item = &Change> {
        self.changes.iter().filter(|c| !c.sort.is_passing())
    }
}

/// Compares two snapshots.
#[must_use]
pub fn diff(first: &Snapshot, second: &Snapshot) -> Diff {
    let mut out = Diff::default();
    if first.model != second.model {
        out.remarks.push(format!(
            "The first is of an {}, the second of an {}; what only one of them has is not compared.",
            first.model.map().name,
            second.model.map().name
        ));
    }
    tables(first, second, &mut out);
    identity(first, second, &mut out);
    for counter in &counters::NAMES {
        let (was, now) = (
            first.counters.get(&counter.sub),
            second.counters.get(&counter.sub),
        );
        let place = format!("counter.{}", counter.sub);
        match (was, now) {
            (Some(was), Some(now)) if was != now => out.changes.push(Change {
                sort: Sort::Counter,
                path: place,
                label: counter.label.to_owned(),
                was: was.to_string(),
                now: now.to_string(),
                also: Vec::new(),
                source: Some(counters::SOURCE),
            }),
            (Some(_), None) | (None, Some(_)) => out.only_one.push(OnlyOne {
                path: place,
                label: counter.label.to_owned(),
                in_second: now.is_some(),
            }),
            _ => {}
        }
    }
    logs::compare(first, second, &mut out);
    out.changes.sort_by_key(|c| c.sort);
    out
}

/// The place of a value: `holding.3017`.
fn path(row: &Row) -> String {
    format!("{}.{}", row.table.key(), row.address)
}

fn tables(first: &Snapshot, second: &Snapshot, out: &mut Diff) {
    // The newer model has what the older one has.
    let model = first.model.max(second.model);
    // Homes come before their mirrors only by chance, so changes are kept with their home.
    let mut changed: Vec<((Table, Address), Change)> = Vec::new();
    for row in model.map().rows {
        // The logs in registers move on with each entry and are compared as logs.
        if row.kind == Kind::Reserved || row.access == Access::Absent || row.group == "Logs" {
            continue;
        }
        let (was, now) = (first.image.bytes(row), second.image.bytes(row));
        let (was, now) = match (was, now) {
            (Some(was), Some(now)) => (was, now),
            (None, None) => continue,
            (_, now) => {
                out.only_one.push(OnlyOne {
                    path: path(row),
                    label: row.label.to_owned(),
                    in_second: now.is_some(),
                });
                continue;
            }
        };
        if was == now {
            continue;
        }
        let (table, address, bit) = Mirror::home(row.table, row.address);
        if let Some(bit) = bit
            && follows(first, row, address, bit)
            && follows(second, row, address, bit)
        {
            // The register tells it.
            continue;
        }
        let mut was_text = say::bytes_of(row, &was);
        let mut now_text = say::bytes_of(row, &now);
        if was_text == now_text {
            // The words differ where the text does not: padding, unused bits.
            was_text = format!("{was_text} ({})", crate::render::hex(&was));
            now_text = format!("{now_text} ({})", crate::render::hex(&now));
        }
        let home = (table, address);
        let same = |(of, c): &&mut ((Table, Address), Change)| {
            *of == home && c.was == was_text && c.now == now_text
        };
        if let Some((_, change)) = changed.iter_mut().find(same) {
            // The home names the change, its mirrors are mentioned.
            if (row.table, row.address) == home {
                let before = core::mem::replace(&mut change.path, path(row));
                change.also.push(before);
                change.label = row.label.to_owned();
                change.sort = Sort::of(row);
                change.source = Some(row.source);
            } else {
                change.also.push(path(row));
            }
            continue;
        }
        changed.push((
            home,
            Change {
                sort: Sort::of(row),
                path: path(row),
                label: row.label.to_owned(),
                was: was_text,
                now: now_text,
                also: Vec::new(),
                source: Some(row.source),
            },
        ));
    }
    out.changes.extend(changed.into_iter().map(|(_, c)| c));
}

/// True if a coil or input is the bit of its register that it should be.
fn follows(snapshot: &Snapshot, row: &Row, home: Address, bit: u8) -> bool {
    let cell = snapshot.image.cell(row.table, row.address);
    let register = snapshot.image.cell(Table::Holding, home);
    match (cell, register) {
        (Some(cell), Some(register)) => {
            (register.word.wrapping_shr(bit.into()) & 1 != 0) == (cell.word != 0)
        }
        _ => false,
    }
}

/// The fields of function 17 that the registers do not tell as well.
fn identity(first: &Snapshot, second: &Snapshot, out: &mut Diff) {
    let (was, now) = match (first.report(), second.report()) {
        (Some(was), Some(now)) => (was, now),
        (None, None) => return,
        (was, _) => {
            out.only_one.push(OnlyOne {
                path: "identity".to_owned(),
                label: "Report of server ID (FC 17)".to_owned(),
                in_second: was.is_none(),
            });
            return;
        }
    };
    if was.serial_number != now.serial_number {
        out.remarks.push(format!(
            "The serial numbers differ ({:?} and {:?}): these may be two actuators.",
            was.serial_number, now.serial_number
        ));
    }
    let pairs = [
        (
            "actuator_type",
            "Actuator type",
            3034,
            was.actuator_type,
            now.actuator_type,
        ),
        (
            "serial_number",
            "Actuator serial number",
            3042,
            was.serial_number,
            now.serial_number,
        ),
        ("valve_tag", "Valve tag", 3056, was.valve_tag, now.valve_tag),
        (
            "base_card",
            "Base card software",
            3070,
            was.base_card,
            now.base_card,
        ),
        (
            "interface",
            "Modbus interface software",
            3072,
            was.interface,
            now.interface,
        ),
    ];
    for (key, label, register, was, now) in pairs {
        if was == now {
            continue;
        }
        let path = format!("identity.{key}");
        let home = format!("holding.{register}");
        let told = out
            .changes
            .iter_mut()
            .find(|c| c.path == home && c.was == was && c.now == now);
        if let Some(change) = told {
            change.also.push(path);
            continue;
        }
        out.changes.push(Change {
            sort: Sort::Identity,
            path,
            label: label.to_owned(),
            was,
            now,
            also: Vec::new(),
            source: Some(crate::icon3000::identity::REPORT),
        });
    }
}
