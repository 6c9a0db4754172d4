//! Coverage and lookups.

use super::{at, of};
use crate::address::{Address, Table};
use crate::map::row::{Access, Kind, Model, Row};

/// Number of addresses of each table of a model.
fn lengths(model: Model) -> [(Table, u16); 4] {
    let [coil, discrete, input, holding] = match model {
        Model::Icon2000v4 | Model::Icon3000 | Model::Icon3000v2 => [11, 32, 369, 3989],
        Model::Ddc100Mx | Model::Ddc100MxB => [9, 0, 16, 56],
        Model::Ddc100Uec => [9, 208, 16, 112],
        Model::Ddc100Clamshell | Model::Ddc100Io => [9, 208, 16, 56],
    };
    [
        (Table::Coil, coil),
        (Table::Discrete, discrete),
        (Table::Input, input),
        (Table::Holding, holding),
    ]
}

#[test]
fn every_address_is_in_exactly_one_row() {
    for model in Model::ALL {
        let map = model.map();
        assert_eq!(map.model, model);
        for (table, length) in lengths(model) {
            for address in (0..length).map(Address::new) {
                let holders = map
                    .rows
                    .iter()
                    .filter(|r| r.table == table && r.contains(address));
                assert_eq!(holders.count(), 1, "{model:?} {table:?} {address}");
                assert!(
                    map.row_at(table, address)
                        .is_some_and(|r| r.contains(address))
                );
            }
            assert_eq!(map.row_at(table, Address::new(length)), None);
            assert_eq!(map.row_at(table, Address::new(u16::MAX)), None);
        }
    }
}

#[test]
fn rows_are_sorted_and_tables_are_slices_of_them() {
    for model in Model::ALL {
        let map = model.map();
        assert!(map.rows.is_sorted_by_key(|row| (row.table, row.address)));
        let rows: Vec<&Row> = Table::ALL
            .into_iter()
            .flat_map(|table| map.rows_of(table).iter().copied())
            .collect();
        assert_eq!(rows, map.rows);
    }
}

#[test]
fn a_range_gives_the_rows_it_touches() {
    let keys = |start, count| -> Vec<&str> {
        let map = Model::Icon3000v2.map();
        let rows = map.rows_in(Table::Holding, Address::new(start), count);
        rows.map(|row| row.key).collect()
    };
    assert_eq!(keys(3004, 2), ["actuator_position", "output_torque"]);
    assert_eq!(keys(3024, 2), ["current_date", "current_time"]);
    assert_eq!(keys(3045, 1), ["actuator_serial_number"]);
    assert_eq!(
        keys(3987, 125),
        ["bus_monitor", "maintenance_operation_command"]
    );
    assert_eq!(keys(3989, 1), [""; 0]);
    assert_eq!(keys(3004, 0), [""; 0]);
    let map = Model::Icon3000v2.map();
    let inputs = map.rows_in(Table::Input, Address::new(0), u16::MAX);
    assert_eq!(inputs.count(), map.rows_of(Table::Input).len());
}

#[test]
fn keys_find_their_row() {
    let map = Model::Icon3000v2.map();
    for row in map.rows {
        assert_eq!(map.by_key(row.table, row.key), Some(*row));
    }
    assert_eq!(map.by_key(Table::Coil, "actuator_position"), None);
}

#[test]
fn models_have_keys() {
    for model in Model::ALL {
        assert_eq!(Model::from_key(model.key()), Some(model));
    }
    assert_eq!(Model::from_key("icon4000"), None);
}

/// What a model lacks is one row for each block, so that a capture of it still has names.
#[test]
fn older_models_lack_the_newer_blocks() {
    let check = |model, address, start, words| {
        let row = of(model, Table::Holding, address);
        assert_eq!((row.address.get(), row.words), (start, words));
        assert_eq!((row.access, row.kind), (Access::Absent, Kind::Reserved));
    };
    check(Model::Icon3000, 3988, 3474, 515);
    check(Model::Icon2000v4, 3988, 3474, 515);
    check(Model::Icon2000v4, 3004, 22, 3452);
    assert_eq!(
        of(Model::Icon3000, Table::Holding, 3988).label,
        "Not present (ICON3000v2 only)"
    );
    assert_eq!(
        of(Model::Icon2000v4, Table::Holding, 21),
        at(Table::Holding, 21)
    );
    assert_eq!(
        of(Model::Icon3000, Table::Holding, 3473),
        at(Table::Holding, 3473)
    );
}

/// 471 words of table 5 are printed as RW, 417 of them in the block of the ICON3000v2.
#[test]
fn writable_words_add_up() {
    let words = |model: Model| -> u16 {
        let rows = model.map().rows_of(Table::Holding).iter();
        rows.filter(|r| matches!(r.access, Access::Write | Access::WriteGuarded))
            .map(|r| r.words)
            .sum()
    };
    assert_eq!(words(Model::Icon3000v2), 471);
    assert_eq!(words(Model::Icon3000), 54);
    assert_eq!(words(Model::Icon2000v4), 18);
}

/// Notes mention readings by id; the map can tell what they say.
#[test]
fn readings_are_found_by_id() {
    let map = Model::Icon3000.map();
    assert!(
        map.reading("E50")
            .is_some_and(|r| r.text.contains("one to one"))
    );
    assert_eq!(map.reading("E00"), None);
}
