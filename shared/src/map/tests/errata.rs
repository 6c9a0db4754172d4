//! Rows where the print is wrong, silent or contradicts itself.

use super::{at, members, of, reading};
use crate::address::Table;
use crate::map::row::{Kind, Level, Model, Trust};

/// The rows of a table at these addresses rest on the reading.
fn rests_on(id: &str, table: Table, addresses: impl IntoIterator<Item = u16>) {
    for address in addresses {
        let row = at(table, address);
        assert_eq!(reading(row).id, id, "{table:?} {address}");
        assert_eq!(row.trust, Trust::Reading);
    }
}

fn holding(id: &str, addresses: impl IntoIterator<Item = u16>) {
    rests_on(id, Table::Holding, addresses);
}

#[test]
fn e01_e22_login_is_at_3482_to_3486_for_every_level() {
    let (level, password) = (at(Table::Holding, 3482), at(Table::Holding, 3483));
    assert_eq!((level.key, level.words), ("user_level", 1));
    assert_eq!((password.key, password.words), ("user_password", 4));
    for row in [level, password] {
        assert_eq!(
            (row.access.key(), row.level),
            ("rw!", Some(Level::Observer))
        );
    }
    holding("E22", [3482]);
    holding("E01", [3483]);
    assert_eq!(at(Table::Holding, 3844).key, "valve_serial_number");
}

#[test]
fn e02_temperatures_reach_from_minus_127_to_127() {
    let addresses = || (99..=103).chain(106..=110);
    rests_on("E02", Table::Input, addresses());
    for address in addresses() {
        let row = at(Table::Input, address);
        assert_eq!(
            (row.kind, row.range, row.unit),
            (Kind::I16, Some((-127, 127)), "°C")
        );
    }
    assert_eq!(at(Table::Holding, 3161).range, Some((-127, 127)));
}

#[test]
fn e03_stroke_test_travel_is_no_date() {
    holding("E03", [3615]);
    assert_eq!(at(Table::Holding, 3615).range, Some((5, 40)));
}

#[test]
fn e04_a_torque_unit_is_no_speed() {
    holding("E04", [3784]);
    assert_eq!(members(at(Table::Holding, 3784)), "0=lbf 1=Nm 2=lb 3=kN");
    assert_eq!(
        members(at(Table::Holding, 3779)),
        "0=s/90° 1=rpm 2=mm/s 3=in/s"
    );
    holding("E43", [3779, 3881]);
    assert_eq!(at(Table::Holding, 3881).label, "Valve Max Stem Thrust");
}

#[test]
fn e05_both_channels() {
    holding("E05", [21, 3022, 3646]);
    for address in [21, 3022, 3646] {
        assert!(members(at(Table::Holding, address)).ends_with("2=CH1 Enabled, CH2 Enabled"));
    }
}

#[test]
fn e07_the_fifth_alarm_log_has_alarm_codes() {
    holding("E07", [3110]);
    assert_eq!(at(Table::Holding, 3110).set, at(Table::Holding, 3090).set);
    assert_ne!(at(Table::Holding, 3110).set, at(Table::Holding, 3115).set);
}

#[test]
fn e10_esd_signal_type_is_kept_apart() {
    holding("E10", [3657]);
    assert_eq!(members(at(Table::Holding, 3657)), "0=Present 1=Absent");
    assert_eq!(members(at(Table::Holding, 3611)), "0=Absent 1=Present");
}

#[test]
fn e11_e47_bit_fields() {
    holding("E11", [3659]);
    assert_eq!(
        at(Table::Holding, 3659).set.map(|s| s.members.len()),
        Some(7)
    );
    rests_on("E47", Table::Input, [4]);
    holding("E47", [3016, 3521, 3605, 3647]);
}

#[test]
fn e12_reset_conditions_are_one_value() {
    holding("E12", [3517, 3518]);
    let row = at(Table::Holding, 3518);
    assert_eq!(
        (row.address.get(), row.words, row.kind),
        (3517, 2, Kind::Bits)
    );
    let label = |bit| row.set.and_then(|s| s.get(bit)).map(|m| m.label);
    assert_eq!(label(0), Some("Selector in OFF"));
    assert_eq!(label(15), Some("K2 Contactor Alarm"));
    assert_eq!(label(16), Some("Hardware Alarm"));
    assert_eq!(label(17), Some("EFS Mid Travel (EFS Only)"));
    assert_eq!(label(18), None);
}

#[test]
fn e14_relays_and_inputs_share_a_list() {
    holding("E14", (3580..=3587).chain(3622..=3627));
    let range = |address| at(Table::Holding, address).range;
    assert!((3580..=3586).all(|a| range(a) == Some((0, 29))));
    assert!(
        (3622..=3627)
            .chain([3587])
            .all(|a| range(a) == Some((0, 30)))
    );
    assert_eq!(at(Table::Holding, 3580).set, at(Table::Holding, 3622).set);
}

#[test]
fn e15_to_e19_texts_and_dates_without_a_format() {
    holding("E15", [3620, 3621]);
    assert_eq!(at(Table::Holding, 3620).kind, Kind::BcdDate);
    holding("E16", [3775, 3777]);
    assert_eq!(at(Table::Holding, 3775).kind, Kind::Hex);
    rests_on("E17", Table::Input, [95]);
    holding("E17", [3074]);
    assert_eq!(
        members(at(Table::Holding, 3074)),
        members(at(Table::Holding, 3784))
    );
    holding("E18", [3780, 3785]);
    assert_eq!(at(Table::Holding, 3785).kind, Kind::Ascii7);
    holding("E19", [3034, 3042, 3056, 3806]);
}

#[test]
fn e20_signed_values() {
    rests_on("E20", Table::Input, [1]);
    holding("E20", [3005, 3161, 3505, 3510, 3915]);
    let signed = [3161, 3172, 3506, 3507, 3668, 3669, 3916, 3917];
    assert!(
        signed
            .into_iter()
            .all(|a| at(Table::Holding, a).kind == Kind::I16)
    );
}

#[test]
fn e21_e23_to_e26_levels_and_references() {
    holding("E21", [3947]);
    let span = at(Table::Holding, 3947);
    assert_eq!(
        (span.access.key(), span.level),
        ("rw!", Some(Level::Observer))
    );
    holding("E23", [3027, 3460, 3911]);
    holding("E24", [3610]);
    holding("E25", [3987, 3988]);
    holding("E26", [3028]);
    assert_eq!(at(Table::Holding, 3028).label, "EFS Input Mode");
    assert_eq!(at(Table::Holding, 3028).set, at(Table::Holding, 3610).set);
}

#[test]
fn e28_e29_e87_scales() {
    let shown = |address, raw| {
        let row = at(Table::Holding, address);
        format!("{} {}", row.scale.apply(raw), row.unit)
    };
    holding("E28", [3013]);
    assert_eq!(shown(3013, 4095), "100.00 %");
    holding("E29", [3799]);
    assert_eq!(shown(3799, 10), "0.10 kW");
    holding("E87", [2, 3017, 3504, 3508, 3529, 3668, 3669, 3801, 3924]);
    assert_eq!(shown(3504, 15), "1.5 A");
    assert_eq!(shown(3508, 1000), "10.00 mA");
    assert_eq!(shown(3529, 90), "9.0 V");
    assert_eq!(shown(3668, -10), "-1.0 %");
    assert_eq!(shown(3924, 12), "1.2 s");
}

#[test]
fn e30_to_e33_what_is_not_said() {
    holding("E30", [3654, 3655, 3772]);
    rests_on("E31", Table::Input, [25, 32, 36, 42]);
    holding("E31", [3180, 3197, 3918, 3943]);
    holding("E32", 3981..=3984);
    assert_eq!(at(Table::Holding, 3981).range, Some((0, 100)));
    holding(
        "E33",
        (3965..=3972).chain([3549, 3555, 3913, 3914, 3985, 3986]),
    );
    assert_eq!(at(Table::Holding, 3549).set, None);
}

#[test]
fn e34_curves() {
    rests_on("E34", Table::Input, [113, 177, 241, 305]);
    holding("E34", [3200, 3264, 3328, 3392]);
}

#[test]
fn e35_blocks_begin_at_22_and_3474() {
    let since = |address| {
        at(Table::Holding, address)
            .since
            .expect("a line of descent")
    };
    assert_eq!((since(21), since(22)), (Model::Icon2000v4, Model::Icon3000));
    assert_eq!(
        (since(3473), since(3474)),
        (Model::Icon3000, Model::Icon3000v2)
    );
    assert_eq!(reading(of(Model::Icon3000, Table::Holding, 3474)).id, "E35");
}

#[test]
fn e37_coils_3_and_5_differ_by_model() {
    let label = |model, address| of(model, Table::Coil, address).label;
    for old in [Model::Icon2000v4, Model::Icon3000] {
        assert_eq!(label(old, 3), "ESD/PST Command");
        assert_eq!(label(old, 5), "Reserved");
        assert_eq!(of(old, Table::Coil, 3).level, None);
        assert_eq!(reading(of(old, Table::Coil, 3)).id, "E37");
    }
    assert_eq!(label(Model::Icon3000v2, 3), "ESD Command");
    assert_eq!(label(Model::Icon3000v2, 5), "PST Command");
    assert_eq!(at(Table::Coil, 3).level, Some(Level::User));
}

#[test]
fn e40_commands_that_stay() {
    holding("E40", [0, 3006, 3008]);
    rests_on("E40", Table::Coil, [5]);
}

#[test]
fn e41_fixed_discrete_inputs() {
    rests_on("E41", Table::Discrete, 29..=31);
    assert_eq!(at(Table::Discrete, 30).kind, Kind::Reserved);
}

#[test]
fn e45_e46_e48_e86_to_e89() {
    holding("E45", [8, 3020]);
    holding("E46", (3789..=3794).chain([3528]));
    holding("E48", [3948]);
    assert_eq!(at(Table::Holding, 3948).words, 2);
    // Open for two bits only; the rest of the word is not in question.
    assert!(at(Table::Holding, 3003).note.contains("E86"));
    holding("E88", [3921]);
    holding("E89", [3616, 3618, 3619]);
}
