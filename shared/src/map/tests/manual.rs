//! Rows as the manual prints them (VCIOM-16345-EN, tables 1 to 5).

use super::{at, members};
use crate::address::Table;
use crate::map::row::Level;

/// Compares a row with `label | type words | scale unit | min..max | access level | group`.
fn check(table: Table, address: u16, expected: &str) {
    let row = at(table, address);
    let range = row
        .range
        .map_or("-".to_owned(), |(min, max)| format!("{min}..{max}"));
    let level = row.level.map_or("-", Level::key);
    let found = format!(
        "{} | {} {} | {} {} | {range} | {} {level} | {}",
        row.label,
        row.kind.key(),
        row.words,
        row.scale,
        if row.unit.is_empty() { "-" } else { row.unit },
        row.access.key(),
        row.group,
    );
    assert_eq!(found, expected, "{table:?} {address}");
}

/// Tables 1 and 3.
#[test]
fn bits() {
    use Table::{Coil, Discrete};
    check(
        Coil,
        0,
        "Open Command | bool 1 | 1 - | - | rw! user | Commands",
    );
    check(
        Coil,
        2,
        "Stop Command | bool 1 | 1 - | - | rw! user | Commands",
    );
    check(
        Coil,
        4,
        "Positioner Mode | bool 1 | 1 - | - | rw! user | Commands",
    );
    check(Coil, 10, "Reserved | reserved 1 | 1 - | - | r - | Reserved");
    check(Discrete, 0, "Close Limit | bool 1 | 1 - | - | r - | Status");
    check(
        Discrete,
        8,
        "DIN1 | bool 1 | 1 - | - | r - | Digital inputs",
    );
    check(
        Discrete,
        16,
        "Fail-Safe Action | bool 1 | 1 - | - | r - | Fail-safe",
    );
    check(
        Discrete,
        28,
        "Hardwired BUS-on | bool 1 | 1 - | - | r - | Remote controls",
    );
}

/// Table 4.
#[test]
fn input_registers() {
    let check = |address, expected| check(Table::Input, address, expected);
    check(
        0,
        "Actuator Position | u16 1 | 0.1 % | 0..1000 | r - | Status",
    );
    check(1, "Output Torque | i16 1 | 1 % | -100..100 | r - | Status");
    check(2, "Warnings | bits 1 | 1 - | 0..65535 | r - | Alarms");
    check(
        5,
        "Opening Time | u16 1 | 1 s | 0..65535 | r - | Statistics",
    );
    check(
        7,
        "General Log - Contactor Cycles | u32 2 | 1 - | - | r - | Statistics",
    );
    check(
        9,
        "General Log - Motor Run Time | u32 2 | 1 h | - | r - | Statistics",
    );
    check(
        13,
        "General Log - Utilization Rate | u16 1 | 1 % | 0..100 | r - | Statistics",
    );
    check(14, "Test Date | bcd-date 2 | 1 - | - | r - | Identity");
    check(45, "Alarm Log 1 - Code | enum 1 | 1 - | 0..32 | r - | Logs");
    check(48, "Alarm Log 1 - Time | bcd-time 2 | 1 - | - | r - | Logs");
    check(
        90,
        "Warning Log 5 - Code | enum 1 | 1 - | 0..13 | r - | Logs",
    );
    check(
        95,
        "Nominal torque/thrust | torque 4 | 1 - | - | r - | Identity",
    );
    check(
        113,
        "Last Close Torque Curve | curve 64 | 1 - | - | r - | Torque curves",
    );
    check(
        305,
        "Reference Open Torque Curve | curve 64 | 1 - | - | r - | Torque curves",
    );
}

/// Table 5, blocks of the ICON2000v4 and ICON3000.
#[test]
fn holding_registers_of_all_models() {
    let check = |address, expected| check(Table::Holding, address, expected);
    check(
        0,
        "Actuator Commands | enum 1 | 1 - | 0..6 | rw! user | Commands",
    );
    check(
        1,
        "Position Request | u16 1 | 0.1 % | 0..1000 | rw! user | Positioner",
    );
    check(
        3,
        "Motion Inhibit Time | u16 1 | 1 s | 1..255 | rw! user | Positioner",
    );
    check(4, "Reserved | reserved 3 | 1 - | - | r observer | Reserved");
    check(
        9,
        "Fail-Safe Position | u16 1 | 1 % | 0..100 | rw! user | Fail-safe",
    );
    check(
        13,
        "Last Maintenance Date | bcd-date 2 | 1 - | - | rw user | Maintenance",
    );
    check(
        46,
        "Reserved | reserved 2954 | 1 - | - | r observer | Reserved",
    );
    check(
        3000,
        "ICON3000 Identifier | hex 1 | 1 - | 36864..36864 | r observer | Identity",
    );
    check(
        3004,
        "Actuator Position | u16 1 | 0.1 % | 0..1000 | r observer | Status",
    );
    check(
        3005,
        "Output Torque | i16 1 | 1 % | -100..100 | r observer | Status",
    );
    check(
        3012,
        "Aux. Analog Input mA | u16 1 | 0.01 mA | 0..65535 | r observer | Analog",
    );
    check(
        3034,
        "Actuator Identifier | ascii 8 | 1 - | - | r observer | Identity",
    );
    check(
        3056,
        "Valve Tag Name | ascii 14 | 1 - | - | rw user | Valve",
    );
    check(
        3072,
        "Modbus Interface SW Version | ascii 2 | 1 - | - | r observer | Identity",
    );
    check(
        3074,
        "Nominal Torque/Thrust | torque 4 | 1 - | - | r observer | Identity",
    );
    check(
        3392,
        "Reference Open Torque Curve | curve 64 | 1 - | - | r observer | Torque curves",
    );
    check(
        3460,
        "Actuator Type | ascii 14 | 1 - | - | r service | Identity",
    );
}

/// Table 5, block of the ICON3000v2.
#[test]
fn holding_registers_of_the_newest_model() {
    let check = |address, expected| check(Table::Holding, address, expected);
    check(
        3480,
        "User level logged | enum 1 | 1 - | 0..3 | r observer | Security",
    );
    check(
        3502,
        "Motor Speed | u16 1 | 1 rpm | 0..4000 | r observer | Motor",
    );
    check(
        3505,
        "Temperature | i16 1 | 1 °C | -40..125 | r observer | Temperatures",
    );
    check(
        3510,
        "Position Request for Logic Card | i16 1 | 0.1 % | -300..1300 | r observer | Positioner",
    );
    check(
        3519,
        "Encoder Absolute Position | u32 2 | 1 - | - | r observer | Encoder",
    );
    check(
        3549,
        "Actuator Reset | u16 1 | 1 - | 0..65535 | rw! service | Service",
    );
    check(
        3553,
        "Local Display Language | enum 1 | 1 - | 0..9 | rw user | Local controls",
    );
    check(3613, "PST Period | u16 1 | 1 d | 1..1000 | rw! user | PST");
    check(
        3648,
        "Modbus CH1 Address | u16 1 | 1 - | 1..247 | rw! user | Modbus",
    );
    check(
        3649,
        "Modbus CH1 Baud Rate | enum 1 | 1 - | 2..9 | rw! user | Modbus",
    );
    check(
        3662,
        "Positioner Open Position | u16 1 | 1 % | 25..100 | rw! user | Positioner",
    );
    check(
        3670,
        "Standard Opening Torque | u16 1 | 1 % | 40..100 | rw! user | Torque",
    );
    check(
        3796,
        "Power Supply Voltage | u16 1 | 1 V | 10..1000 | rw! service | Power supply",
    );
    check(
        3915,
        "Heater Base Reference | i16 1 | 1 °C | -50..50 | rw! service | Temperatures",
    );
    check(
        3931,
        "4 - 20 mA Input Configuration - 20 mA | u16 1 | 1 - | 2100..4095 | rw! service | Calibration",
    );
    check(
        3956,
        "Sample Interval | u16 1 | 1 s | 1..3600 | rw! user | Recorder",
    );
    check(
        3980,
        "Word Free 7 | u16 1 | 1 - | 0..65535 | rw user | Free memory",
    );
    check(
        3988,
        "Maintenance Operation Command | enum 1 | 1 - | 0..1 | rw! service | Service",
    );
}

#[test]
fn codes() {
    let check =
        |address, expected: &str| assert_eq!(members(at(Table::Holding, address)), expected);
    check(
        3008,
        "0=Clear Commands 1=Close Command 2=Open Command 3=ESD Command 4=Enable Positioner Mode \
         5=PST Command 6=Baseline PST Command",
    );
    check(3482, "0=Observer 1=User 2=Service 3=Manufacturer");
    check(3563, "0=Absent 1=Present 2=Off");
    check(3608, "0=Close 1=Open");
    check(3612, "0=Off 1=Auto 2=Manual 3=Manual + Auto");
    check(3653, "0=None 1=Even 2=Odd");
    check(3665, "0=CW 1=CCW");
    check(3954, "0=Off 1=Event 2=Recorder 3=T-Recorder");
    assert_eq!(
        members(at(Table::Input, 45)),
        members(at(Table::Holding, 3090))
    );
    assert!(
        members(at(Table::Input, 70))
            .ends_with("12=PST Failed - Max T2 13=PST Failed - Over Travel")
    );
    assert!(members(at(Table::Holding, 3649)).starts_with("2=Auto Baud 3=600 bps"));
    assert!(members(at(Table::Holding, 3800)).ends_with("15=32 poles"));
}

/// Open and close change places between the bit fields; each is taken as printed.
#[test]
fn bit_names() {
    let check = |table, address, expected: &str| assert_eq!(members(at(table, address)), expected);
    check(
        Table::Holding,
        3006,
        "0=Close Command 1=Open Command 2=Stop Command 3=ESD Command 4=Enable Positioner Mode \
         5=PST Command",
    );
    check(
        Table::Holding,
        3029,
        "0=Interlock Open Command 1=Interlock Close Command 2=Fail-Safe Command",
    );
    check(
        Table::Holding,
        3030,
        "0=Maintenance Operation 1=Remote Stop",
    );
    assert!(members(at(Table::Input, 2)).ends_with("11=PST Error - PST Failed 15=General Warning"));
    assert!(members(at(Table::Input, 4)).starts_with(
        "0=Max. Torque intermediate position 1=Jammed CL 2=Jammed OP 3=Direction Test Fail"
    ));
}

#[test]
fn bits_with_states_of_their_own() {
    let states = |address, bit| at(Table::Holding, address).set?.get(bit)?.states;
    assert_eq!(states(3500, 0), Some(("Contact Open", "Contact Closed")));
    assert_eq!(states(3501, 6), Some(("Low", "High")));
    assert_eq!(states(3521, 0), Some(("CW", "CCW")));
    assert_eq!(states(3521, 7), Some(("Not calibrated", "Calibrated")));
    assert_eq!(states(3579, 4), Some(("Not involved", "Involved")));
    assert_eq!(
        states(3659, 0),
        Some(("Has priority over ESD", "ESD has priority"))
    );
    assert_eq!(states(3685, 1), Some(("Red", "Green")));
    assert_eq!(states(3685, 2), Some(("Red", "Yellow")));
    assert_eq!(states(3001, 0), None);
}
