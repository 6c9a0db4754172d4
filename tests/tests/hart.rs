//! HART: every bit that the manual prints, every command, and promises that hold for any bytes.

use proptest::collection::vec;
use proptest::prelude::*;
use shared::decode::{Context, decode_frame};
use shared::device::{Device, Family};
use shared::frame::{Framing, Role, scan};
use shared::hart::frame::{FILL, long_address, seal};
use shared::hart::model::Effect;
use shared::hart::{COMMANDS, PRESETS, TIMERS, command};
use shared::tree::{Decoded, Name};
use shared::value::Value;

/// The bits of the tables as the manual prints them.
const BITS: &str = include_str!("../fixtures/hart-bits.txt");

fn family(key: &str) -> Option<Family> {
    Family::ALL
        .into_iter()
        .find(|f| f.key() == format!("rotork-{key}"))
}

/// A reply of the device 012345 to a primary master.
fn reply(number: u8, status: u8, data: &[u8]) -> Vec<u8> {
    let address = long_address(0x6EDD, 0x01_2345, true);
    let body = [&[0, status][..], data].concat();
    [vec![FILL; 5], seal(0x86, &address, number, &body)].concat()
}

fn decoded(bytes: &[u8], family: Option<Family>) -> Decoded {
    let frames = scan(bytes, Framing::Hart);
    assert_eq!(frames.len(), 1, "one frame in {bytes:02X?}");
    let context = Context {
        framing: Framing::Hart,
        device: family.map_or(Device::None, Device::Rotork),
    };
    decode_frame(&frames[0], bytes, None, &context)
}

/// Paths and labels of the bits that are set.
fn active(tree: &Decoded) -> Vec<(String, String)> {
    tree.iter()
        .filter(|(_, f)| matches!(f.value, Value::Bit { on: true, .. }))
        .map(|(id, f)| (tree.path(id), f.name.label()))
        .collect()
}

/// True if this is one of the names of the label.
fn is_named(label: &str, printed: &str) -> bool {
    let (name, alias) = label.split_once(" (also: ").unwrap_or((label, ""));
    let alias = alias.strip_suffix(')').unwrap_or(alias);
    name.eq_ignore_ascii_case(printed) || alias.eq_ignore_ascii_case(printed)
}

#[test]
fn every_printed_bit_has_its_name() {
    let mut count = 0;
    let bits = BITS
        .lines()
        .filter(|l| !l.is_empty() && !l.starts_with("# ") && !l.starts_with("map|"));
    for line in bits {
        count += 1;
        let cells: Vec<&str> = line.split('|').collect();
        let [_, owner, byte, bit, printed] = cells[..] else {
            panic!("five cells: {line}");
        };
        let raw = 1 << bit.parse::<u8>().unwrap();
        let (mut status, mut data) = (0, [0; 9]);
        match owner {
            "device" => status = raw,
            "extended" => data[6] = raw,
            _ => data[byte.parse::<usize>().unwrap()] = raw,
        }
        let tree = decoded(&reply(48, status, &data), family(owner));
        let active = active(&tree);
        if printed.eq_ignore_ascii_case("reserved") || printed == "Unused" {
            assert!(active.is_empty(), "{line}: {active:?}");
            let said = tree.problems().iter().any(|p| p.code() == "unused-bits");
            assert!(said, "{line}: a reserved bit is noticed");
            continue;
        }
        let [(path, label)] = &active[..] else {
            panic!("{line}: one bit, not {active:?}");
        };
        assert!(is_named(label, printed), "{line}: {label}");
        let place = match owner {
            "device" => "device_status.".to_owned(),
            "extended" => "command.48.extended_status.".to_owned(),
            _ => format!("command.48.byte_{byte}."),
        };
        assert!(path.starts_with(&place), "{line}: {path}");
    }
    assert_eq!(count, 333, "all rows of tables 4 to 11, 19, 21 and 22");
}

#[test]
fn examples_of_the_condensed_map_are_as_printed() {
    let mut count = 0;
    for line in BITS.lines().filter_map(|l| l.strip_prefix("map|")) {
        count += 1;
        let cells: Vec<&str> = line.split('|').collect();
        let [_, owner, byte, bit, category] = cells[..] else {
            panic!("five cells: {line}");
        };
        let owner = family(owner).unwrap();
        let preset = PRESETS.iter().find(|p| p.family == owner).unwrap();
        let (byte, bit): (u8, u8) = (byte.parse().unwrap(), bit.parse().unwrap());
        let known = preset.bits.iter().find(|m| (m.byte, m.bit) == (byte, bit));
        let known = known.map_or(0, |m| m.category);
        assert_eq!(known.to_string(), category, "{line}");
    }
    assert_eq!(count, 72, "three bytes of three examples");
}

/// Tables 12 to 14, section 8.1 and the standard: what may be sent without changing anything.
#[test]
fn only_these_commands_read() {
    let reads: Vec<u16> = COMMANDS
        .iter()
        .filter(|c| c.is_read())
        .map(|c| c.number)
        .collect();
    let expected = [
        0, 1, 2, 3, 7, 8, 9, 11, 12, 13, 14, 15, 16, 20, 21, 33, 54, 95, 128, 129, 131, 133, 523,
    ];
    assert_eq!(reads, expected);
    // Command 48 reads without data; with data it clears a flag.
    let status = command(48).unwrap();
    assert_eq!(status.effects_of(0), [Effect::Reads]);
    assert_eq!(status.effects_of(9), [Effect::Config]);
    for moves in [6, 35, 40, 42, 45, 46, 79, 132, 134] {
        let effects = command(moves).unwrap().effects;
        assert!(effects.contains(&Effect::Moves), "{moves}");
    }
    assert_eq!(command(42).unwrap().effects[0], Effect::Ends);
    for number in [4, 5, 10, 130] {
        assert_eq!(command(number).unwrap().effects, [Effect::Unknown]);
    }
}

#[test]
fn families_have_the_commands_of_the_manual() {
    let lacks = |number: u16| -> Vec<Family> {
        let own = command(number).unwrap().families;
        Family::ALL
            .into_iter()
            .filter(|f| !own.contains(f))
            .collect()
    };
    assert_eq!(lacks(34), [Family::Cma]);
    assert_eq!(lacks(40), [Family::Cma]);
    assert!(lacks(79).is_empty());
    assert_eq!(
        lacks(129),
        [Family::Iq, Family::Cma, Family::Ck, Family::Si]
    );
    assert_eq!(lacks(134), [Family::Cva, Family::Ck, Family::Si]);
    let tree = decoded(&reply(134, 0, &[1, 0, 0, 0]), Some(Family::Cva));
    assert!(tree.problems().iter().any(|p| p.code() == "not-listed"));
}

/// Characters of 11 bits at 1200 bit/s.
#[test]
fn timers_are_those_of_the_standard() {
    let micros: Vec<_> = TIMERS.iter().map(|t| (t.key, t.micros())).collect();
    let expected = [
        ("slave_time_out", 256_666),
        ("hold", 18_333),
        ("link_grant", 73_333),
        ("link_quiet_primary", 302_500),
        ("link_quiet_secondary", 375_833),
        ("gap", 9_166),
    ];
    assert_eq!(micros, expected);
}

#[test]
fn response_codes_have_the_meaning_of_their_command() {
    let said = |number: u8, code: u8| {
        let mut frame = reply(number, 0, &[]);
        let at = frame.len() - 3;
        frame[at] = code;
        let last = frame.len() - 1;
        frame[last] ^= code;
        let tree = decoded(&frame, None);
        let (_, field) = tree
            .iter()
            .find(|(id, _)| tree.path(*id) == "response_code")
            .unwrap();
        let codes: Vec<_> = tree
            .problems()
            .iter()
            .map(shared::problem::Problem::code)
            .collect();
        (tree.text(field), codes.join(" "))
    };
    let expect = |text: &str, codes: &str| (text.to_owned(), codes.to_owned());
    assert_eq!(said(3, 0).0, "Success (0)");
    assert_eq!(
        said(35, 9),
        expect("Lower range value too high (9)", "response-error")
    );
    assert_eq!(
        said(18, 9),
        expect("Invalid date code detected (9)", "response-error")
    );
    assert_eq!(said(3, 32), expect("Busy (32)", "response-error"));
    assert_eq!(said(134, 74), expect("Invalid data (74)", "response-error"));
    assert_eq!(said(3, 9), expect("unknown (9)", "response-error"));
    assert!(said(1, 8).1.starts_with("response-warning"));
}

/// Every reading of the manual and every contradiction found in it is known by its number, and each
/// that concerns data is visible where it matters (rule R50 of the build).
#[test]
fn readings_are_complete() {
    let numbered =
        |prefix: &'static str, last: u32| (1..=last).map(move |n| format!("{prefix}{n}"));
    for id in numbered("R", 44)
        .chain(numbered("H", 36))
        .chain(numbered("G", 25))
    {
        assert!(shared::hart::reading(&id).is_some(), "{id}");
    }
    let of = |tree: &Decoded, path: &str| {
        let (_, field) = tree.iter().find(|(id, _)| tree.path(*id) == path).unwrap();
        field.name.reading().map(|r| r.id)
    };
    let cva = decoded(&reply(48, 0, &[0; 9]), Some(Family::Cva));
    let byte = |path: &str| of(&cva, &format!("command.48.{path}"));
    assert_eq!(byte("byte_0.over_back_drive_close"), Some("R1"));
    assert_eq!(byte("byte_1.force_sensor_unknown"), Some("R2"));
    assert_eq!(byte("byte_4.control_by_enlight"), Some("R3"));
    assert_eq!(byte("byte_0.thermostat_trip"), None);
    let iq = decoded(&reply(48, 0, &[0; 9]), Some(Family::Iq));
    let byte = |path: &str| of(&iq, &format!("command.48.{path}"));
    assert_eq!(byte("byte_0.high_torque"), Some("R4"));
    assert_eq!(byte("byte_4.selector_in_local"), Some("R5"));
    assert_eq!(byte("byte_1.control_failure"), Some("R6"));
    assert_eq!(byte("extended_status.failure"), Some("R11"));
    assert_eq!(of(&iq, "device_status.more_status_available"), Some("R12"));
    let cma = decoded(&reply(48, 0, &[0; 9]), Some(Family::Cma));
    assert_eq!(of(&cma, "command.48.byte_1.current_ee_fault"), Some("R8"));
    assert_eq!(of(&cma, "command.48.byte_2.esd_active"), Some("H9"));
    let mode = decoded(&reply(133, 0, &[3]), Some(Family::Iq));
    assert_eq!(of(&mode, "command.133.mode"), Some("R27"));
}

/// Every line of the export is an object that names its source.
#[test]
fn exports_name_their_sources() {
    for family in Family::ALL {
        let mut text = String::new();
        shared::hart::export::write(&mut text, family).unwrap();
        let mut kinds = std::collections::BTreeMap::new();
        for line in text.lines() {
            let line: serde_json::Value = serde_json::from_str(line).expect(line);
            assert_eq!(line["device"], family.key());
            assert!(
                line["source"].as_str().is_some_and(|s| s.contains(", ")),
                "{line}"
            );
            *kinds
                .entry(line["kind"].as_str().unwrap().to_owned())
                .or_insert(0) += 1;
        }
        let commands = text.matches(r#""kind":"command""#).count();
        assert_eq!(commands, 50, "tables 12 to 14, and 31, 33, 54, 59, 95");
        // Appendix 1 and readings R24: bits of command 48, bytes 0 to 5.
        let own = text
            .lines()
            .filter(|l| l.contains(r#""kind":"bit","set":"byte_"#));
        let expected = match family {
            Family::Cva => 34,
            Family::Iq => 39,
            Family::Cma => 40,
            Family::Ck => 33,
            Family::Si => 13,
        };
        assert_eq!(own.count(), expected, "{family:?}");
        // 172 codes without and 133 with a classification.
        assert!(kinds["unit"] > 300 && kinds["code"] > 200, "{kinds:?}");
        // Response codes are told apart by class, and none from 0 to 127 is left out.
        let lines = |kind: &str| -> Vec<serde_json::Value> {
            let all = text.lines().map(|l| serde_json::from_str(l).unwrap());
            all.filter(|l: &serde_json::Value| l["kind"] == kind)
                .collect()
        };
        let mut next = 0;
        for line in lines("response_code") {
            assert_eq!(line["first"], next, "{line}");
            next = line["last"].as_u64().unwrap() + 1;
        }
        assert_eq!(next, 128);
        let timers = lines("timer");
        assert_eq!(timers.len(), 6);
        assert_eq!(
            (
                &timers[0]["label"],
                &timers[0]["characters"],
                &timers[0]["micros"]
            ),
            (&"STO".into(), &28.into(), &256_666.into())
        );
        // Tables 20, 23 and 25; CVA and CMA have no example.
        let presets = lines("preset");
        let count = match family {
            Family::Iq | Family::Si => 8,
            Family::Ck => 7,
            Family::Cva | Family::Cma => 0,
        };
        assert_eq!(presets.len(), count, "{family:?}");
        // Local control fault, byte 0 bit 1, is a failure in each of them: index 8 + 1.
        if let Some(preset) = presets.first() {
            assert_eq!(
                (
                    &preset["index"],
                    &preset["category"],
                    &preset["category_label"]
                ),
                (&9.into(), &3.into(), &"Failure".into())
            );
        }
        for set in ["lock_device", "lock_status"] {
            assert!(text.contains(&format!(r#""set":"{set}""#)), "{set}");
        }
    }
}

/// Every byte belongs to exactly one leaf; bits and parts share the byte of their field.
fn assert_tiles(tree: &Decoded) {
    let mut owners = vec![0; tree.bytes().len()];
    for (id, field) in tree.iter() {
        let whole = |name: &Name| !name.shares_bytes();
        let group = tree
            .iter()
            .any(|(_, f)| f.parent == Some(id) && whole(&f.name));
        if !group && whole(&field.name) {
            owners[field.place.range()].iter_mut().for_each(|o| *o += 1);
        }
    }
    assert!(owners.iter().all(|o| *o == 1), "{owners:?} in {tree:#?}");
}

fn delimiter() -> impl Strategy<Value = u8> {
    prop::sample::select(vec![0x02, 0x82, 0x06, 0x86, 0x01, 0x81, 0xA6, 0xE2, 0x8E])
}

proptest! {
    /// Any sound frame is found whole, whatever its command and data, and decodes without a hole.
    #[test]
    fn sound_frames_are_found_and_tiled(
        fill in 2_usize..40,
        delimiter in delimiter(),
        address in any::<[u8; 5]>(),
        expansion in any::<[u8; 3]>(),
        command in any::<u8>(),
        data in vec(any::<u8>(), 2..80),
        family in 0_usize..6,
    ) {
        let long = if delimiter & 0x80 != 0 { 5 } else { 1 };
        let extra = usize::from(delimiter >> 5 & 3);
        let head = [&address[..long], &expansion[..extra]].concat();
        let bytes = [vec![FILL; fill], seal(delimiter, &head, command, &data)].concat();
        let frames = scan(&bytes, Framing::Hart);
        prop_assert_eq!(frames.len(), 1);
        prop_assert!(!frames[0].marks.is_damaged());
        prop_assert!(frames[0].role != Role::Noise);
        let device = Family::ALL.get(family).copied().map_or(Device::None, Device::Rotork);
        let context = Context { framing: Framing::Hart, device };
        let tree = decode_frame(&frames[0], &bytes, None, &context);
        prop_assert!(tree.is_ok(), "{:?}", tree.problems());
        assert_tiles(&tree);
    }

    /// Data of any length for every known command, as request and as response.
    #[test]
    fn any_data_of_a_command_decode(
        at in any::<prop::sample::Index>(),
        data in vec(any::<u8>(), 0..80),
        code in any::<u8>(),
        request in any::<bool>(),
        family in 0_usize..6,
    ) {
        let number = COMMANDS[at.index(COMMANDS.len())].number;
        let [high, low] = number.to_be_bytes();
        let (own, inner) = if high == 0 { (low, vec![]) } else { (31, vec![high, low]) };
        let status = if request { vec![] } else { vec![code, 0x40] };
        let body = [status, inner, data].concat();
        let address = long_address(0x6EDD, 0x01_2345, false);
        let bytes = seal(if request { 0x82 } else { 0x86 }, &address, own, &body);
        let frames = scan(&bytes, Framing::Hart);
        prop_assert_eq!(frames.len(), 1);
        let device = Family::ALL.get(family).copied().map_or(Device::None, Device::Rotork);
        let context = Context { framing: Framing::Hart, device };
        let tree = decode_frame(&frames[0], &bytes, None, &context);
        assert_tiles(&tree);
        for (id, field) in tree.iter() {
            let _ = (tree.path(id), tree.text(field), field.name.label());
        }
    }

    /// Any bytes at all: nothing lost, every tree tiles.
    #[test]
    fn any_bytes_decode(bytes in vec(prop_oneof![
        3 => any::<u8>(),
        2 => Just(FILL),
        1 => prop::sample::select(vec![0x82, 0x86, 0x81, 0x02, 0x06, 0xAE]),
        1 => 0_u8..4,
    ], 0..600)) {
        let frames = scan(&bytes, Framing::Hart);
        let mut at = 0;
        let context = Context { framing: Framing::Hart, device: Device::Rotork(Family::Iq) };
        for frame in &frames {
            prop_assert_eq!(frame.offset, at);
            at = frame.end();
            let own = &bytes[frame.offset as usize..frame.end() as usize];
            assert_tiles(&decode_frame(frame, own, None, &context));
        }
        prop_assert_eq!(at, bytes.len() as u64);
    }
}
