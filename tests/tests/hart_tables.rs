//! Tables 12 to 18, 20 and 23 to 25 of PUB092-003-00, row by row (tables 4 to 11, 19, 21 and 22 are
//! in `hart.rs`). What is printed stands in `fixtures/hart-tables.txt` and `hart-bits.txt`.

use shared::decode::{Context, decode_frame};
use shared::device::{Device, Family};
use shared::frame::{Framing, scan};
use shared::hart::frame::{long_address, seal};
use shared::hart::ne107::{Map, report};
use shared::hart::{PRESETS, command};
use shared::tree::Decoded;
use shared::value::Value;

const TABLES: &str = include_str!("../fixtures/hart-tables.txt");
const BITS: &str = include_str!("../fixtures/hart-bits.txt");

/// Number or bit, and name, of the rows of a table.
fn rows(table: &str) -> Vec<(&'static str, &'static str)> {
    TABLES
        .lines()
        .filter(|l| !l.starts_with('#'))
        .filter_map(|l| {
            let mut cells = l.splitn(3, '|');
            (cells.next()? == table).then_some((cells.next()?, cells.next()?))
        })
        .collect()
}

/// Words that carry the meaning: letters and digits, in small letters, without the most common
/// words and endings.
fn words(text: &str) -> Vec<String> {
    let small = [
        "the", "is", "at", "in", "a", "of", "are", "has", "set", "to", "for", "and", "hart", "ma",
        "array", "when", "position", "present",
    ];
    text.to_lowercase()
        .split(|c: char| !c.is_alphanumeric())
        .filter(|w| !small.contains(w))
        // "s" alone is the unit, which the print spells out.
        .map(|w| w.trim_end_matches('s').replace("second", ""))
        .filter(|w| !w.is_empty())
        .collect()
}

/// True if all words of the shorter stand in the longer, in any order.
fn is_named(ours: &str, printed: &str) -> bool {
    let (one, other) = (words(ours), words(printed));
    let (short, long) = if one.len() < other.len() {
        (one, other)
    } else {
        (other, one)
    };
    !short.is_empty() && short.iter().all(|w| long.contains(w))
}

fn reply(number: u8, data: &[u8], family: Family) -> Decoded {
    let address = long_address(0x6EDD, 0x01_2345, true);
    let bytes = seal(0x86, &address, number, &[&[0, 0], data].concat());
    decoded(&bytes, family)
}

fn request(number: u8, data: &[u8], family: Family) -> Decoded {
    let address = long_address(0x6EDD, 0x01_2345, true);
    decoded(&seal(0x82, &address, number, data), family)
}

fn decoded(bytes: &[u8], family: Family) -> Decoded {
    let frames = scan(bytes, Framing::Hart);
    let context = Context {
        framing: Framing::Hart,
        device: Device::Rotork(family),
    };
    decode_frame(&frames[0], bytes, None, &context)
}

/// Path and label of the bits that are set in the data.
fn active(tree: &Decoded) -> Vec<(String, String)> {
    tree.iter()
        .filter(|(_, f)| matches!(f.value, Value::Bit { on: true, .. }))
        .map(|(id, f)| (tree.path(id), f.name.label()))
        .collect()
}

/// Where our label says it in other words: number, label, print. "PV" and "primary value" are the
/// primary variable; its current is that of the loop; one "variable" or "class" stands for all four;
/// table 14 has another name for command 132 than section 9.4 (reading R25).
const REWORDED: [(u16, &str, &str); 6] = [
    (1, "Read primary variable", "Read Primary Value"),
    (
        2,
        "Read loop current and percent of range",
        "Read PV Current and percentage of range",
    ),
    (
        3,
        "Read dynamic variables and loop current",
        "Read dynamic variable and PV current",
    ),
    (
        8,
        "Read dynamic variable classifications",
        "Read dynamic variable class",
    ),
    (
        131,
        "Read current zero and span",
        "Read Current Zero & Span",
    ),
    (132, "Control digitally", "Command digitally"),
];

#[test]
fn tables_12_to_14_name_the_commands() {
    let mut count = 0;
    for (table, source) in [("12", "table 12"), ("13", "table 13"), ("14", "table 14")] {
        for (number, printed) in rows(table) {
            count += 1;
            let known = command(number.parse().unwrap()).unwrap_or_else(|| panic!("{number}"));
            let place = known.source.to_string();
            assert!(place.contains(source), "{number}: {place}");
            match REWORDED.iter().find(|(n, ..)| *n == known.number) {
                Some((_, label, print)) => assert_eq!((known.label, printed), (*label, *print)),
                None => assert!(
                    is_named(known.label, printed),
                    "{number}: {} is not {printed}",
                    known.label
                ),
            }
            // Reserved ones and "do not use" are never asked.
            let barred = printed == "Reserved" || printed == "Do Not Use";
            assert_eq!(known.request.is_empty(), barred, "{number}");
            assert_eq!(known.families.is_empty(), barred, "{number}");
        }
    }
    assert_eq!(count, 25 + 13 + 7);
}

#[test]
fn table_15_names_the_bits_of_command_129() {
    let rows = rows("15");
    assert_eq!(rows.len(), 16);
    for (bit, printed) in rows {
        let raw = 1_u16 << bit.parse::<u32>().unwrap();
        let [high, low] = raw.to_be_bytes();
        let tree = reply(129, &[2, 1, 0, high, low], Family::Cva);
        let active = active(&tree);
        let [(path, label)] = &active[..] else {
            panic!("{bit}: {active:?}");
        };
        assert!(path.starts_with("command.129.status."), "{path}");
        assert!(is_named(label, printed), "{bit}: {label} is not {printed}");
    }
}

#[test]
fn table_16_names_the_bits_of_command_132() {
    let rows = rows("16");
    for (bit, printed) in &rows {
        let raw = 1_u8 << bit.parse::<u32>().unwrap();
        for tree in [
            request(132, &[raw], Family::Iq),
            reply(132, &[raw], Family::Iq),
        ] {
            let active = active(&tree);
            let [(path, label)] = &active[..] else {
                panic!("{bit}: {active:?}");
            };
            assert!(path.starts_with("command.132.actcon."), "{path}");
            assert!(is_named(label, printed), "{bit}: {label} is not {printed}");
        }
    }
    // Bits 6 and 7 are not printed (reading R29).
    for raw in [0x40, 0x80] {
        let tree = request(132, &[raw], Family::Iq);
        assert!(tree.problems().iter().any(|p| p.code() == "unused-bits"));
    }
    // The example of section 9.4: 22h sends the actuator closed.
    let close: Vec<String> = active(&request(132, &[0x22], Family::Iq))
        .into_iter()
        .map(|(_, label)| label)
        .collect();
    assert_eq!(close, ["Close", "Force digital position"]);
}

#[test]
fn table_17_names_the_control_modes() {
    for (mode, printed) in rows("17") {
        let tree = reply(133, &[mode.parse().unwrap()], Family::Iq);
        let (_, field) = tree
            .iter()
            .find(|(id, _)| tree.path(*id) == "command.133.mode")
            .unwrap();
        let text = tree.text(field);
        // "AI control" is written out.
        let printed = printed.replace("AI Control", "Analogue input");
        assert!(is_named(&text, &printed), "{mode}: {text} is not {printed}");
    }
    let beyond = reply(133, &[4], Family::Iq);
    assert!(
        beyond.problems().iter().any(|p| p.code() == "unknown-code"),
        "{:?}",
        beyond.problems()
    );
}

#[test]
fn table_18_names_the_bytes_of_command_134() {
    for (byte, printed) in rows("18") {
        let at = byte.parse::<usize>().unwrap();
        for bit in 0..8_usize {
            let mut data = [0; 4];
            data[at] = 1 << bit;
            let tree = request(134, &data, Family::Iq);
            let active = active(&tree);
            let [(path, label)] = &active[..] else {
                panic!("{byte}.{bit}: {active:?}");
            };
            // The lowest bit is the lowest relay (reading H23).
            let relay = if printed.ends_with("9-16") {
                9 + bit
            } else {
                1 + bit
            };
            let digits =
                |text: &str| -> String { text.chars().filter(char::is_ascii_digit).collect() };
            assert_eq!(
                digits(label.split(" (").next().unwrap()),
                relay.to_string(),
                "{byte}.{bit}"
            );
            let set = printed.starts_with("Set");
            assert_eq!(path.contains(".set_"), set, "{path}");
            assert_eq!(path.contains(".reset_"), !set, "{path}");
            // There are twelve relays at most (reading R33).
            assert_eq!(label.contains("does not exist"), relay > 12, "{label}");
        }
    }
}

/// Tables 20, 23 and 25: the presets have all rows, and the device makes of each what it says.
#[test]
fn the_examples_have_their_effect() {
    let mut count = 0;
    for line in BITS.lines().filter_map(|l| l.strip_prefix("map|")) {
        let cells: Vec<&str> = line.split('|').collect();
        let [_, owner, byte, bit, category] = cells[..] else {
            panic!("{line}");
        };
        let family = Device::from_key(&format!("rotork-{owner}"))
            .and_then(Device::family)
            .unwrap();
        let map = Map::example(family).unwrap();
        let (byte, bit): (u8, u8) = (byte.parse().unwrap(), bit.parse().unwrap());
        assert_eq!(
            map.get(Map::index(byte, bit)).to_string(),
            category,
            "{line}"
        );
        let mut status = [0; 6];
        status[usize::from(byte)] = 1 << bit;
        let made = report(family, &status, &map);
        // Table 5: one bit a category, on IQ and CMA (reading R11).
        let bit_of = match category {
            "1" => 0x01,
            "3" => 0x08,
            "4" => 0x10,
            "5" => 0x20,
            _ => 0,
        };
        let extended = if family == Family::Iq { bit_of } else { 0 };
        assert_eq!(made.extended, extended, "{line}");
        assert_eq!(made.more_status, category != "0", "{line}");
        // A failure is a malfunction, on CK by reading R13; SI has no alarms.
        let fails = category == "3" && family != Family::Si;
        assert_eq!(made.malfunction, fails, "{line}");
        count += 1;
    }
    assert_eq!(count, 72);
    assert_eq!(PRESETS.len(), 3);
}

/// Table 24 lists the alarms of the IQ for SI, of which table 11 has none (readings R10, H15).
#[test]
fn table_24_repeats_the_alarms_of_the_iq() {
    let rows = rows("24");
    assert_eq!(rows.len(), 24);
    for (place, printed) in rows {
        let (byte, bit) = place.split_once('.').unwrap();
        let mut status = [0; 9];
        status[byte.parse::<usize>().unwrap()] = 1 << bit.parse::<u8>().unwrap();
        let active = active(&reply(48, &status, Family::Iq));
        let [(_, label)] = &active[..] else {
            panic!("{place}: {active:?}");
        };
        let mut names = label.trim_end_matches(')').split(" (also: ");
        assert!(
            names.any(|n| n.eq_ignore_ascii_case(printed)),
            "{place}: {label} is not {printed}"
        );
        // The same bit of an SI is reserved, and noticed.
        let tree = reply(48, &status, Family::Si);
        assert!(self::active(&tree).is_empty());
        assert!(
            tree.problems().iter().any(|p| p.code() == "unused-bits"),
            "{place}"
        );
    }
}
