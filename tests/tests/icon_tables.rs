//! Every code of every table of the log and curve files of VCIOM-16345-EN, section 8.11, worked by hand:
//! the name as it is printed, and what the decoder says of a record that holds the code.

use shared::icon3000::File;
use shared::icon3000::read::Log;
use shared::icon3000::records::Records;

/// A file of these records, from record 0.
fn log(number: u16, words: Vec<u16>) -> Log {
    Log::read(number, &Records::of(0, words)).expect("the manual describes it")
}

/// Letters and digits only, in lower case: the tables differ from each other in hyphens and capitals.
fn plain(text: &str) -> String {
    let kept = text.chars().filter(|c| c.is_alphanumeric());
    kept.flat_map(char::to_lowercase).collect()
}

/// What a code is called: the printed name, or another one where the manual has two (reading E42), or
/// where it prints less than its table is about.
struct Name(u16, &'static str, Option<&'static str>);

/// The printed name is what we say.
const fn same(code: u16, printed: &'static str) -> Name {
    Name(code, printed, None)
}

/// We say something else.
const fn other(code: u16, printed: &'static str, ours: &'static str) -> Name {
    Name(code, printed, Some(ours))
}

/// Each code is called so; the next one behind the last has no name.
fn check(table: &str, names: &[Name], said: impl Fn(u16) -> String) {
    for Name(code, printed, ours) in names {
        let said = said(*code);
        let name = said.strip_suffix(&format!(" ({code})"));
        let name = name.unwrap_or_else(|| panic!("table {table}, {code}: {said}"));
        match ours {
            None => assert_eq!(plain(name), plain(printed), "table {table}, {code}"),
            Some(ours) => assert_eq!(name, *ours, "table {table}, {code}: printed {printed}"),
        }
    }
    let next = names.iter().map(|n| n.0).max().expect("names") + 1;
    assert_eq!(
        said(next),
        format!("unknown code ({next})"),
        "table {table}"
    );
}

/// Table 32; 6 stands there twice (reading E70), and three texts are those of note 9 (reading E42).
#[test]
fn table_32_alarms() {
    let names = [
        same(0, "None"),
        other(1, "Configuration", "Configuration Error"),
        other(2, "Thermostat", "Motor Thermostat"),
        other(3, "Over Temperature", "Hi-Hi Temperature"),
        same(4, "Low Battery"),
        other(
            5,
            "Hi-Hi Torque in Close",
            "Hi-Hi Torque in close direction",
        ),
        other(6, "Hi-Hi Torque in Open", "Hi-Hi Torque in open direction"),
        other(7, "Jammed Valve in Close", "Valve Jammed in close"),
        other(8, "Jammed Valve in Open", "Valve Jammed in open"),
        same(9, "Position Sensor"),
        other(10, "Speed Sensor", "Speed Sensor or Direction"),
        other(11, "Main Supply", "Main Voltage"),
        same(12, "Lost Phase"),
        same(13, "K1 Contactor"),
        same(14, "K2 Contactor"),
        other(15, "Mid Travel in Close", "Mid travel alarm in close"),
        other(16, "Mid Travel in Open", "Mid travel alarm in open"),
        same(17, "Hardware 1"),
        same(18, "Request Signal"),
        same(19, "Direction Test"),
        same(20, "Hardware 2"),
        same(21, "Hardware 3"),
        same(22, "Hardware 4"),
        same(23, "Hardware 5"),
        same(24, "Hardware 6"),
        same(25, "Hardware 7"),
        same(26, "Hardware 8"),
        same(27, "Hardware 9"),
        same(28, "Hardware 10"),
        same(29, "EFS Mid Travel"),
        same(30, "Hardware 11"),
        same(31, "Hardware 12"),
        same(32, "Hardware 13"),
    ];
    let said = |code| {
        let log = log(2, vec![1, 0, 5, code]);
        log.entries[0].get("code").expect("it was read").text()
    };
    check("32", &names, said);
}

/// Table 34; three texts are those of note 10 (reading E42).
#[test]
fn table_34_warnings() {
    let names = [
        same(0, "None"),
        same(1, "Hi Torque in Opening"),
        same(2, "Hi Torque in Closing"),
        other(3, "Over Temperature", "Hi Temperature"),
        same(4, "Main Supply"),
        same(5, "Max. Contactor Cycles"),
        same(6, "Maintenance Request"),
        same(7, "Motor Current"),
        same(8, "Wrong Stroke Limits"),
        same(9, "Bus"),
        other(10, "PST", "PST Failed"),
        other(11, "PST Failed - T1", "PST Failed - Max T1"),
        other(12, "PST Failed - T2", "PST Failed - Max T2"),
        same(13, "PST Failed - Over Travel"),
    ];
    let said = |code| {
        let log = log(3, vec![1, 0, 5, code]);
        log.entries[0].get("code").expect("it was read").text()
    };
    check("34", &names, said);
}

/// Table 36, and the devices that table 35 names in its rows.
#[test]
fn table_36_levels_and_devices() {
    let entry = |key: &'static str, at: usize| {
        move |code: u16| {
            let mut words = vec![0; 33];
            (words[0], words[at]) = (1, code);
            let log = log(4, words);
            log.entries[0].get(key).expect("it was read").text()
        }
    };
    let levels = [
        same(0, "Observer"),
        same(1, "User"),
        same(2, "Service"),
        same(3, "Manufacturer"),
    ];
    check("36", &levels, entry("level", 1));
    let devices = [same(0, "Bluetooth"), same(1, "RS232")];
    check("35", &devices, entry("device", 30));
}

/// Tables 42, 46 and 48 are the same one, each in record 3 of its file.
#[test]
fn tables_42_46_48_memory_modes() {
    for (table, number) in [("42", 5000), ("46", 5100), ("48", 5200)] {
        let names = [same(0, "Continuous"), same(1, "Stop when full")];
        let said = |code| {
            let log = log(number, vec![0, 0, 0, code, 60]);
            log.get("memory_mode").expect("it was read").text()
        };
        check(table, &names, said);
    }
}

/// What record 6 and 7 of the events log say.
fn event(key: &'static str, at: usize) -> impl Fn(u16) -> String {
    move |code| {
        let mut words = vec![1, 0, 0, 0, 0, 7, 0, 0, 0];
        words[at] = code;
        let log = log(5000, words);
        log.entries[0].get(key).expect("it was read").text()
    }
}

#[test]
fn table_43_events() {
    let names = [same(0, "Off"), same(1, "Open"), same(2, "Close")];
    check("43", &names, event("code", 6));
}

#[test]
fn table_44_sources() {
    let names = [
        same(0, "None"),
        same(1, "Bus Command"),
        same(2, "Remote Command"),
        same(3, "Local Command"),
        same(4, "ESD"),
        same(5, "Position Calibration"),
        same(6, "Torque Calibration"),
        same(7, "Fail-Safe"),
        same(8, "Position Request from bus"),
        same(9, "Position Request from 4 - 20 mA Input"),
        same(10, "Serial/Bluetooth command"),
        other(11, "Start Positioner Mode", "Start positioner mode"),
        same(12, "Stop Positioner Mode"),
        same(13, "Movement without electrical signal"),
        same(14, "K1 Contactor fail"),
        same(15, "K2 Contactor fail"),
        same(16, "Configuration On"),
        same(17, "PST"),
        same(18, "EFS Fail-Safe"),
        same(19, "Reserved"),
        same(20, "Reserved"),
        same(21, "Power Up"),
        same(22, "Selector moved from REMOTE to LOCAL/OFF"),
        same(23, "STOP in Remote"),
    ];
    check("44", &names, event("source", 7));
}

/// What a record of a PST curve says.
fn stroke(number: u16, records: usize, key: &'static str, at: usize) -> impl Fn(u16) -> String {
    move |code| {
        let mut words = vec![0; records];
        words[at] = code;
        log(number, words).get(key).expect("it was read").text()
    }
}

/// Table 39 with its notes 1 to 5; a result of 0 is none (reading E78).
#[test]
fn table_39_partial_strokes() {
    let result = stroke(3001, 118, "result", 108);
    let names = [
        same(1, "Passed"),
        same(2, "Failed"),
        same(3, "Reset"),
        other(4, "T-PST", "Failed - T-PST"),
        other(5, "T-RET", "Failed - T-RET"),
        other(6, "OV-TR", "Failed - OV-TR"),
    ];
    check("39, note 1", &names, &result);
    assert_eq!(result(0), "unknown code (0)");
    let names = [
        other(
            0,
            "PST Close (Start from 100%)",
            "PST close (starts from 100 %)",
        ),
        other(1, "PST Open (Start from 0%)", "PST open (starts from 0 %)"),
    ];
    check("39, note 2", &names, stroke(3016, 118, "direction", 109));
    let names = [
        same(0, "Off"),
        same(1, "Auto"),
        same(2, "Manual"),
        same(3, "Manual + Auto"),
    ];
    check("39, note 3", &names, stroke(3001, 118, "mode", 114));
    // Note 4, as HR 3516 calls the same bits.
    let status = stroke(3001, 118, "status", 115);
    for (bit, printed) in [
        "Passed",
        "Failed - T-PST (T1)",
        "Failed - T-RET (T2)",
        "Failed - Over Travel",
        "Reset",
    ]
    .into_iter()
    .enumerate()
    {
        assert!(status(1 << bit).contains(printed), "{}", status(1 << bit));
    }
    // Note 5: bits 0 to 15 in record 117, the rest in 116 (reading E12).
    let low = stroke(3001, 118, "reset_conditions", 117);
    for (bit, printed) in [
        "Selector in Off",
        "Local Stop",
        "Remote Stop",
        "ESD",
        "Fail-Safe",
        "Configuration Alarm",
        "Position Sensor Alarm",
        "Thermostat Alarm",
        "Main Supply Alarm",
        "Lost Phase Alarm",
        "Hi Temperature Alarm",
        "Jammed Valve Alarm",
        "Hi Torque Alarm",
        "Speed Sensor Alarm",
        "K1 Contactor Alarm",
        "K2 Contactor Alarm",
    ]
    .into_iter()
    .enumerate()
    {
        let said = low(1 << bit);
        assert!(plain(&said).contains(&plain(printed)), "bit {bit}: {said}");
    }
    let high = stroke(3001, 118, "reset_conditions", 116);
    assert!(high(1).contains("Hardware"), "{}", high(1));
    assert!(high(2).contains("EFS Mid Travel"), "{}", high(2));
}

/// Table 40 with its note.
#[test]
fn table_40_emergency_strokes() {
    let names = [
        other(
            0,
            "EFS Close (Start from 100%)",
            "EFS close (starts from 100 %)",
        ),
        other(1, "EFS Open (Start from 0%)", "EFS open (starts from 0 %)"),
    ];
    check("40", &names, stroke(3501, 110, "direction", 109));
}

/// Section 8.11.11 and table 49: which card is which, and where its texts stand.
#[test]
fn table_49_cards() {
    for (number, printed) in [
        (5300, "Base Card"),
        (5301, "4 - 20 mA Card"),
        (5302, "Terminal Board Card"),
        (5303, "EFS Card"),
        (5304, "Modbus Interface Card"),
    ] {
        let file = File::of(number).expect("a file");
        let name = plain(&file.name(number));
        // The terminal board is a board and no card.
        let printed = plain(printed.trim_end_matches("Board Card"));
        assert!(name.contains(&printed), "{name}, {printed}");
    }
    assert!(File::of(5305).is_none_or(|f| f.key != "card_reports"));
    // Each record two letters: its number as two digits.
    let words = (0..32_u16)
        .map(|at| {
            u16::from_be_bytes([
                b'0' + u8::try_from(at / 10).unwrap(),
                b'0' + u8::try_from(at % 10).unwrap(),
            ])
        })
        .collect();
    let card = log(5300, words);
    for (key, text) in [
        ("card_code", "0001020304"),
        ("week", "06"),
        ("year", "07"),
        ("serial_number", "080910"),
        ("revision", "1112131415"),
        ("free_text", "16171819202122232425262728293031"),
    ] {
        assert_eq!(card.get(key).expect("it was read").text(), text, "{key}");
    }
}
