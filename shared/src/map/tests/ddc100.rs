//! The maps of the DDC-100 field units against the guide (FCD LMAIM4019-00) and its readings.
//!
//! Readings that are about other things than a map: D23 and D24 (times of tables 4.1 and 4.2), D29
//! (what a master must know). D30 (examples in ASCII framing) is a golden case.

use super::{members, of, reading};
use crate::address::{Address, Table};
use crate::device::Device;
use crate::map::plan::plan;
use crate::map::row::{Access, Kind, Model, Row, Trust};

const MX: Model = Model::Ddc100Mx;
const UEC: Model = Model::Ddc100Uec;
const CLAMSHELL: Model = Model::Ddc100Clamshell;
const IO: Model = Model::Ddc100Io;
const ALL: [Model; 4] = [MX, UEC, CLAMSHELL, IO];

/// A register by its number in the guide, which is one more than its address.
fn register(model: Model, number: u16) -> &'static Row {
    of(model, Table::Holding, number - 1)
}

fn coil(model: Model, number: u16) -> &'static Row {
    of(model, Table::Coil, number - 1)
}

fn input(model: Model, number: u16) -> &'static Row {
    of(model, Table::Discrete, number - 1)
}

/// Label of a bit of a register.
fn bit(model: Model, number: u16, bit: u32) -> &'static str {
    let set = register(model, number).set.expect("the register has bits");
    set.get(bit).map_or("", |member| member.label)
}

/// Name of a value of the command register.
fn command(model: Model, value: u32) -> String {
    let set = register(model, 1).set.expect("the register has codes");
    set.get(value)
        .map_or(String::new(), |member| member.name(value).into_owned())
}

/// The row rests on this reading, or its note mentions it.
fn concerns(row: &Row, id: &str) -> bool {
    let mentioned = MX.map().mentioned(row.note).any(|r| r.id == id);
    mentioned || row.reading.is_some_and(|r| r.id == id)
}

fn labels(model: Model, row: fn(Model, u16) -> &'static Row, numbers: &[u16]) -> Vec<&'static str> {
    numbers.iter().map(|n| row(model, *n).label).collect()
}

/// Tables 3.3 and 3.6.
#[test]
fn coils() {
    let all = [1, 2, 3, 4, 5, 6, 7, 8, 9];
    assert_eq!(
        labels(MX, coil, &all),
        [
            "Close / Stop",
            "Open / Stop",
            "AS-1",
            "AS-2",
            "AS-3",
            "AS-4",
            "AR-1",
            "AR-2",
            "AR-3"
        ]
    );
    assert_eq!(
        labels(UEC, coil, &all[2..]),
        [
            "Lockout or Relay 3",
            "Do not use",
            "Do not use",
            "Relay 6",
            "Do not use",
            "Do not use",
            "Do not use"
        ]
    );
    assert_eq!(
        labels(CLAMSHELL, coil, &all[2..6]),
        ["Lockout or Relay 3", "Relay 4", "Relay 5", "Relay 6"]
    );
    assert_eq!(
        labels(IO, coil, &all[..3]),
        ["Do not use", "Do not use", "Relay 3"]
    );
    for model in ALL {
        for row in model.map().rows_of(Table::Coil) {
            let unused = row.label == "Do not use";
            assert_eq!(row.kind == Kind::Reserved, unused);
            assert_eq!(row.access.is_guarded(), !unused, "{} moves", row.label);
        }
    }
}

/// Every address that the guide covers is in one row; what it leaves open says so.
#[test]
fn the_tables_are_covered() {
    let ends = |model: Model, table| {
        let rows = model.map().rows_of(table);
        let first = rows
            .iter()
            .find(|r| r.trust != Trust::Inferred || r.words == 1);
        let start = first.map_or(0, |r| u32::from(r.address.get()));
        (start, rows.last().map_or(0, |r| r.end()))
    };
    for model in ALL {
        assert_eq!(ends(model, Table::Coil), (0, 9));
        assert_eq!(ends(model, Table::Input), (4, 16), "registers 5 to 16");
        let inputs = if model == MX { (0, 0) } else { (128, 208) };
        assert_eq!(ends(model, Table::Discrete), inputs);
        let registers = if model == UEC { 112 } else { 56 };
        assert_eq!(ends(model, Table::Holding), (0, registers));
        assert!(!model.map().whole);
        assert_eq!(model.map().last_unit, 250, "table 3.1");
    }
}

/// Table 3.4: inputs are the bits of registers 9 to 13, in order.
#[test]
fn inputs_are_the_bits_of_registers() {
    for model in [UEC, CLAMSHELL, IO] {
        for number in 129..=208_u16 {
            let row = input(model, number);
            let (register_number, place) =
                (9 + (number - 129) / 16, u32::from((number - 129) % 16));
            if register(model, register_number).kind == Kind::Reserved {
                assert_eq!(row.kind, Kind::Reserved, "{model:?} {number}");
                continue;
            }
            let label = bit(model, register_number, place);
            // Two bits that the module only has as a MOV, where it takes the map of the UEC-3-DDC.
            if row.kind == Kind::Reserved {
                assert!(
                    label.is_empty() || label.ends_with("as MOV)"),
                    "{model:?} {number} {label}"
                );
            } else {
                assert_eq!(row.label, label, "{model:?} {number}");
            }
        }
    }
    assert_eq!(MX.map().rows_of(Table::Discrete), [] as [&Row; 0]);
}

/// Table 3.5, register by register.
#[test]
fn registers() {
    let all = [2, 3, 4, 5, 6, 7, 8, 9, 10];
    assert_eq!(
        labels(MX, register, &all),
        [
            "Argument",
            "APT scaled output value",
            "ATT scaled output value",
            "Main power value",
            "Analog input 1",
            "Analog input 2",
            "Valve position",
            "Status register",
            "Fault register"
        ]
    );
    assert_eq!(
        labels(UEC, register, &all[1..7]),
        [
            "Analog output (not applicable)",
            "Average torque",
            "Analog input 4",
            "Analog input 3",
            "Analog input 2",
            "Valve position or analog input 1"
        ]
    );
    assert_eq!(register(IO, 8).label, "Analog input 1");
    assert_eq!(register(MX, 5).unit, "V");
    assert_eq!(
        (register(MX, 8).unit, register(MX, 8).range),
        ("%", Some((0, 100)))
    );
    assert_eq!(register(MX, 24).words, 21, "24 to 44");
    for model in ALL {
        for number in (17..=23).chain(45..=56) {
            assert_eq!(register(model, number).kind, Kind::Hex);
        }
        // Function 04 reads the same.
        for number in 5..=16 {
            let (a, b) = (register(model, number), of(model, Table::Input, number - 1));
            assert_eq!(
                (a.key, a.set, a.unit, a.note),
                (b.key, b.set, b.unit, b.note)
            );
        }
    }
}

#[test]
fn bits_of_the_registers() {
    assert_eq!(bit(MX, 10, 13), "Local stop");
    assert_eq!(bit(UEC, 10, 13), "Wrong rotation");
    assert_eq!(bit(MX, 10, 0), "", "not used");
    assert_eq!(bit(MX, 11, 9), "Network relay");
    assert_eq!(bit(UEC, 11, 3), "Local pushbutton switch LED");
    assert_eq!(bit(CLAMSHELL, 11, 3), "Relay 4");
    assert_eq!(bit(MX, 12, 8), "User input 0, terminal 21");
    assert_eq!(bit(UEC, 12, 14), "Input 6");
    assert_eq!(bit(IO, 12, 0), "User input 8");
    assert_eq!(bit(MX, 13, 6), "DDC board present");
    assert_eq!(bit(UEC, 13, 6), "");
    assert_eq!(bit(UEC, 14, 8), "Open reversal time-out");
    assert_eq!(bit(UEC, 15, 9), "User fault 9");
    assert_eq!(
        members(register(IO, 16)),
        "0=Waiting to open 1=Waiting to close 2=Running backward 3=Invalid configuration \
         4=Reverse switches 5=OK to modulate"
    );
    assert_eq!(
        members(register(IO, 9)),
        "10=Network Channel A fault 11=Network Channel B fault"
    );
    assert_eq!(register(IO, 10).kind, Kind::Reserved);
}

/// Table 3.7.
#[test]
fn commands() {
    for (value, name) in [
        (0, "Null command"),
        (256, "Open"),
        (512, "Stop"),
        (768, "Close"),
        (1280, "Start network ESD"),
        (1536, "Stop network ESD"),
        (6656, "Move to the argument"),
    ] {
        for model in [MX, UEC, CLAMSHELL] {
            assert_eq!(command(model, value), name);
        }
        let io = if value == 0 {
            name.to_owned()
        } else {
            format!("{name} (do not use)")
        };
        assert_eq!(command(IO, value), io);
    }
    let engage = [2304, 2560, 2816, 3072, 3328, 3584, 3840];
    let mx = ["AS-1", "AS-2", "AS-3", "AS-4", "AR-1", "AR-2", "AR-3"];
    for (value, name) in engage.into_iter().zip(mx) {
        assert_eq!(command(MX, value), format!("Engage {name}"));
        assert_eq!(command(MX, value + 2048), format!("Disengage {name}"));
    }
    let usable = |model| {
        let usable = |v: &u32| !command(model, *v).ends_with("(do not use)");
        engage.into_iter().filter(usable).collect::<Vec<_>>()
    };
    assert_eq!(usable(UEC), [2816, 3584]);
    assert_eq!(usable(CLAMSHELL), [2816, 3072, 3328, 3584]);
    assert_eq!(usable(IO), [2304, 2560, 2816, 3072, 3328, 3584]);
    for model in ALL {
        let row = register(model, 1);
        assert_eq!((row.access, row.access.key()), (Access::WriteOnly, "w!"));
        assert_eq!(command(model, 1), "", "no name");
    }
}

/// Tables 3.2 and 3.8.
#[test]
fn functions_and_diagnostics() {
    for device in [Device::Ddc100Uec, Device::Ddc100Clamshell, Device::Ddc100Io] {
        let known: Vec<u8> = (0..=127).filter(|f| device.implements(*f)).collect();
        assert_eq!(known, [1, 2, 3, 4, 5, 6, 8, 15, 16]);
    }
    for model in ALL {
        let subs = model.map().functions.iter().filter_map(|f| f.sub);
        assert_eq!(
            subs.collect::<Vec<_>>(),
            [0, 1, 2, 3, 4, 10, 11, 12, 13, 14]
        );
    }
    // The same list for the ICON3000, VCIOM-16345-EN, table 6.
    let icon: Vec<u8> = (0..=127)
        .filter(|f| Device::Icon3000v2.implements(*f))
        .collect();
    assert_eq!(icon, [1, 2, 3, 4, 5, 6, 8, 15, 16, 17, 20]);
    assert!(!Device::Icon3000.implements(20));
    assert!(Device::None.implements(20) && !Device::Icon3000.implements(255));
}

/// A whole unit takes one read; what can only be written or is reserved is left out.
#[test]
fn few_reads() {
    let reads = |model: Model, table| {
        let reads = plan(table, model.map().rows_of(table).iter().copied());
        let reads = reads.iter().map(|r| (r.start.get(), r.count()));
        reads.collect::<Vec<_>>()
    };
    assert_eq!(reads(MX, Table::Holding), [(2, 54)]);
    assert_eq!(reads(UEC, Table::Holding), [(3, 109)]);
    assert_eq!(reads(IO, Table::Discrete), [(138, 70)]);
}

#[test]
fn d1_d25_d28_coils_that_move() {
    assert_eq!(coil(CLAMSHELL, 2).label, "Open / Stop");
    assert_eq!(reading(coil(CLAMSHELL, 2)).id, "D1");
    for model in [MX, UEC, CLAMSHELL] {
        for number in [1, 2] {
            assert!(concerns(coil(model, number), "D25") && concerns(coil(model, number), "D28"));
        }
    }
}

/// Relay 3 is AS-3 and coil 5 on an MX/DDC, and relay 3 and coil 3 on the others.
#[test]
fn d2_relays_are_not_coils() {
    assert_eq!(command(MX, 2816), "Engage AS-3");
    assert_eq!((coil(MX, 5).label, bit(MX, 11, 4)), ("AS-3", "AS-3"));
    assert!(concerns(coil(MX, 5), "D2") && concerns(register(MX, 11), "D2"));
    assert_eq!(command(CLAMSHELL, 3072), "Engage relay 4");
    assert_eq!(
        (coil(CLAMSHELL, 4).label, bit(CLAMSHELL, 11, 3)),
        ("Relay 4", "Relay 4")
    );
}

#[test]
fn d3_d33_relays_of_the_module_by_their_k_number() {
    assert_eq!(
        (command(IO, 2304), command(IO, 4352)),
        ("Engage relay K2".into(), "Disengage relay K2".into())
    );
    assert_eq!(
        (command(IO, 2560), command(IO, 4608)),
        ("Engage relay K1".into(), "Disengage relay K1".into())
    );
    assert_eq!(
        (coil(IO, 7).label, bit(IO, 11, 6), input(IO, 167).label),
        ("Relay 2 (K2)", "Relay 2 (K2)", "Relay 2 (K2)")
    );
    assert_eq!(
        (coil(IO, 8).label, bit(IO, 11, 7), input(IO, 168).label),
        ("Relay 1 (K1)", "Relay 1 (K1)", "Relay 1 (K1)")
    );
    assert_eq!(reading(coil(IO, 7)).id, "D3");
    assert!(concerns(coil(IO, 7), "D33"));
}

/// D4 is also a golden case.
#[test]
fn d4_d31_d34_channels() {
    assert!(concerns(input(UEC, 140), "D4") && concerns(input(UEC, 140), "D31"));
    assert!(concerns(register(MX, 9), "D31") && concerns(register(MX, 9), "D34"));
    assert!(concerns(register(MX, 12), "D34"));
}

/// D5 and D6 are also golden cases.
#[test]
fn d5_d6_d7_analog_values() {
    assert_eq!(reading(register(MX, 8)).id, "D5");
    assert!(concerns(of(UEC, Table::Input, 4), "D6"));
    for number in [6, 7, 8] {
        assert!(concerns(register(MX, number), "D7") && concerns(register(UEC, number), "D7"));
    }
}

#[test]
fn d8_d9_status_register() {
    assert_eq!(reading(register(UEC, 9)).id, "D8");
    let text = reading(register(UEC, 9)).text;
    assert!(text.contains("5, 8, 9 or 15, or 10 and 11"));
    assert_eq!(bit(MX, 9, 9), "", "future implementation");
    let row = register(MX, 9);
    assert_eq!(reading(row).id, "D9");
    let states = row.set.and_then(|s| s.get(6)).and_then(|m| m.states);
    let (zero, one) = states.expect("bit 6 names its states");
    assert!(zero.contains("before 1999") && one.contains("after 1999"));
    assert!(
        register(UEC, 9)
            .set
            .and_then(|s| s.get(6))
            .is_some_and(|m| m.states.is_none())
    );
}

#[test]
fn d10_d11_odd_print() {
    assert_eq!(
        (register(MX, 15).kind, reading(register(MX, 15)).id),
        (Kind::Reserved, "D10")
    );
    assert_eq!(register(UEC, 55).label, "TP_BEFORE_MID_T_HIGH");
    assert_eq!(reading(register(UEC, 55)).id, "D11");
}

#[test]
fn d12_d13_d14_status_inputs() {
    for number in (145..=155).chain([157, 164, 165]) {
        assert_eq!(reading(input(UEC, number)).id, "D12");
    }
    assert_eq!(
        input(UEC, 157).label,
        "Microprocessor reset since the last poll"
    );
    assert_eq!(input(UEC, 167).address, Address::new(166));
    assert!(concerns(input(UEC, 167), "D13") && concerns(input(IO, 168), "D13"));
    for number in 169..=176 {
        assert_eq!(reading(input(IO, number)).id, "D14");
    }
    assert!(concerns(register(UEC, 11), "D14"));
}

#[test]
fn d15_d16_d17_outputs_and_inputs() {
    assert_eq!(bit(UEC, 11, 6), "Close contactor (non-interlocked)");
    assert_eq!(bit(UEC, 11, 7), "Open contactor (non-interlocked)");
    assert!(concerns(register(UEC, 11), "D15") && concerns(register(CLAMSHELL, 11), "D15"));
    assert_eq!(
        (bit(UEC, 11, 5), reading(register(UEC, 11)).id),
        ("User relay 6", "D16")
    );
    let inputs = [12, 13, 14, 15].map(|b| bit(IO, 13, b));
    assert_eq!(
        inputs,
        [
            "User input 18",
            "User input 19",
            "User input 16",
            "User input 17"
        ]
    );
    assert_eq!(reading(register(IO, 13)).id, "D17");
}

#[test]
fn d18_no_status_inputs_on_an_mx() {
    assert!(!Device::Ddc100Mx.implements(2) && Device::Ddc100Mx.implements(1));
    assert!(concerns(register(MX, 13), "D18"));
    let inputs = UEC.map().functions.iter().find(|f| f.code == 2);
    assert!(
        inputs
            .and_then(|f| f.reading)
            .is_some_and(|r| r.id == "D18")
    );
}

#[test]
fn d19_d20_d21_d22_move_to() {
    for model in [MX, UEC, CLAMSHELL] {
        assert_eq!(command(model, 19_200), "Move to 0 %");
        assert_eq!(command(model, 19_250), "Move to 50 %");
        assert_eq!(command(model, 19_300), "Move to 100 %");
        assert_eq!(command(model, 19_301), "");
        assert_eq!(command(model, 19_199), "");
        assert_eq!(reading(register(model, 1)).id, "D19");
        assert!(concerns(register(model, 1), "D22") && concerns(register(model, 2), "D20"));
        assert_eq!(reading(register(model, 2)).id, "D21");
        assert_eq!(register(model, 2).range, Some((0, 100)));
    }
    assert_eq!(command(IO, 19_250), "");
}

/// Registers 1 and 2 are for writing, and the watchdog of a UEC can be set; nothing else can.
#[test]
fn d26_d27_d35_what_can_be_written() {
    for model in ALL {
        let writable = model.map().rows_of(Table::Holding).iter();
        let writable = writable.filter(|r| r.access != Access::Read);
        let numbers: Vec<u16> = writable.map(|r| r.address.get() + 1).collect();
        let expected: &[u16] = if model == UEC { &[1, 2, 112] } else { &[1, 2] };
        assert_eq!(numbers, expected);
        assert!(concerns(register(model, 1), "D26") && concerns(register(model, 1), "D35"));
        for value in [1024, 6912, 7168] {
            assert_eq!(command(model, value), "");
        }
    }
    assert_eq!(reading(register(UEC, 112)).id, "D27");
}

#[test]
fn d32_user_input_3_is_inverted() {
    for model in [MX, UEC, CLAMSHELL] {
        let row = register(model, 12);
        assert_eq!(reading(row).id, "D32");
        let states = row.set.and_then(|s| s.get(11)).and_then(|m| m.states);
        assert_eq!(states, Some(("active", "not active")));
    }
    assert_eq!(reading(input(UEC, 188)).id, "D32");
    let io = register(IO, 12).set.and_then(|s| s.get(11));
    assert!(io.is_some_and(|m| m.states.is_none()));
}
