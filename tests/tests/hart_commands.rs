//! Every command has a worked request and a worked answer, and what depends on more than the bytes
//! of a command: units with their classification, commands in a direct PDU of HART-IP.

use shared::decode::{Context, decode_frame};
use shared::device::{Device, Family};
use shared::frame::{Framing, Role, scan};
use shared::hart::frame::{Head, extended, long_address, preamble, seal};
use shared::hart::model::{Class, Form};
use shared::hart::{COMMANDS, class, unit};
use shared::problem::Problem;
use shared::text::import;
use shared::tree::Decoded;
use std::collections::BTreeSet;
use tests::golden::{Case, FILES, cases};

/// Commands of which nobody knows the data: three reserved ones, and the one that the manual forbids
/// (reading G22). They are never sent.
const UNKNOWN: [u16; 4] = [4, 5, 10, 130];

fn decoded(bytes: &[u8], framing: Framing, device: Device) -> Decoded {
    let frames = scan(bytes, framing);
    assert_eq!(frames.len(), 1, "{bytes:02X?}");
    decode_frame(&frames[0], bytes, None, &Context { framing, device })
}

fn text(tree: &Decoded, path: &str) -> String {
    let found = tree.iter().find(|(id, _)| tree.path(*id) == path);
    let (_, field) = found.unwrap_or_else(|| panic!("{path} in {tree:#?}"));
    tree.text(field)
}

fn codes(tree: &Decoded) -> Vec<&'static str> {
    tree.problems().iter().map(Problem::code).collect()
}

/// Number and role of a sound frame that carries out a command, and its index in the case.
fn carried(case: &Case) -> Vec<(usize, u16, &'static str)> {
    let input = import(case.input.as_bytes(), case.framing);
    if input.framing != Framing::Hart {
        return Vec::new();
    }
    let mut found = Vec::new();
    for (index, frame) in scan(&input.bytes, Framing::Hart).iter().enumerate() {
        let role = match frame.role {
            Role::Request => "request",
            Role::Response => "response",
            _ => continue,
        };
        let bytes = &input.bytes[frame.offset as usize..frame.end() as usize];
        let body = &bytes[preamble(bytes)..];
        let Some(head) = Head::of(body).filter(|_| !frame.marks.is_damaged()) else {
            continue;
        };
        // A refusal has no data.
        let status = body[head.data];
        if role == "response" && (status & 0x80 != 0 || class(status).0 == Class::Error) {
            continue;
        }
        found.push((index, u16::from(head.command), role));
        found.extend(extended(&head, body).map(|number| (index, number, role)));
    }
    found
}

/// Each with expected values, where it has any data.
#[test]
fn every_command_is_worked_out_in_both_roles() {
    let mut worked = BTreeSet::new();
    for (name, file, _) in FILES {
        for case in cases(file).iter().filter(|_| name.starts_with("hart-")) {
            for (index, number, role) in carried(case) {
                let value = format!("{index} command.{number}.");
                let said = case.expect.iter().any(|line| line.starts_with(&value));
                let known = COMMANDS.iter().find(|c| c.number == number);
                let forms = known.map(|c| match role {
                    "request" => c.request,
                    _ => c.response,
                });
                let empty = |form: &Form| form.lengths == [0];
                if said || forms.is_some_and(|forms| forms.iter().any(empty)) {
                    worked.insert((number, role));
                }
            }
        }
    }
    let missing: Vec<_> = COMMANDS
        .iter()
        .filter(|c| !UNKNOWN.contains(&c.number))
        .flat_map(|c| [(c.number, "request"), (c.number, "response")])
        .filter(|key| !worked.contains(key))
        .collect();
    assert_eq!(missing, []);
    for number in UNKNOWN {
        let known = COMMANDS.iter().find(|c| c.number == number).unwrap();
        assert!(known.request.is_empty() && known.response.is_empty());
    }
}

/// One code, many meanings: the classification decides, and without one nobody knows.
#[test]
fn units_follow_the_classification() {
    let reply = |number: u8, data: &[u8]| {
        let address = long_address(0x3E01, 5, true);
        let bytes = seal(0x86, &address, number, &[&[0, 0], data].concat());
        decoded(&bytes, Framing::Hart, Device::None)
    };
    for (code, meanings) in [
        (
            170,
            &[
                (65, "cmH2O (4 °C)"),
                (66, "beer bbl/s"),
                (68, "beer bbl"),
                (69, "µm"),
                (70, "ms"),
                (73, "mg/L"),
                (74, "Pa·s"),
                (78, "kN"),
                (79, "MW"),
                (84, "nA"),
                (85, "MΩ"),
                (90, "‰"),
                (97, "FNU"),
                (103, "beer bbl/s"),
                (107, "1/°C"),
                (108, "kJ/L"),
            ][..],
        ),
        (
            174,
            &[
                (65, "hPa"),
                (66, "normal L/d"),
                (79, "10⁶ BTU/d"),
                (85, "mΩ"),
                (102, "normal L/d"),
                (103, "imp fl oz/s"),
                (106, "imp fl oz/d"),
            ],
        ),
        (
            178,
            &[
                (65, "ftH2O (60 °F)"),
                (66, "std L/h"),
                (101, "std L/h"),
                (104, "hL/min"),
            ],
        ),
        (
            189,
            &[
                (66, "std m³/min"),
                (100, "std m³/min"),
                (105, "bbl (US liquid)/h"),
            ],
        ),
        (192, &[(103, "imp beer bbl/s"), (106, "imp beer bbl/d")]),
    ] {
        for (class, symbol) in meanings {
            // Command 9 has the classification before the unit, command 54 behind it.
            let slot = [0, 0, *class, code, 0x3F, 0x80, 0, 0, 0xC0, 0, 0, 0, 0];
            let tree = reply(9, &slot);
            assert_eq!(
                text(&tree, "command.9.slot[0].units"),
                format!("{symbol} ({code})")
            );
            assert_eq!(
                text(&tree, "command.9.slot[0].value"),
                format!("1 {symbol}")
            );
            let mut data = [0; 28];
            (data[4], data[21]) = (code, *class);
            let tree = reply(54, &data);
            assert_eq!(
                text(&tree, "command.54.upper_limit"),
                format!("0 {symbol}"),
                "{class}"
            );
        }
    }
    let alone = reply(1, &[178, 0x3F, 0x80, 0, 0]);
    assert_eq!(
        text(&alone, "command.1.pv_units"),
        "depends on the classification (178)"
    );
    assert_eq!(text(&alone, "command.1.pv"), "1");
    // A classification that does not have the code: nobody knows either, and it is said otherwise.
    let other = reply(9, &[0, 0, 64, 178, 0x3F, 0x80, 0, 0, 0xC0, 0, 0, 0, 0]);
    assert_eq!(text(&other, "command.9.slot[0].units"), "unknown (178)");
    // The slot before does not lend its own.
    let two = [
        0, 0, 65, 170, 0, 0, 0, 0, 0xC0, 1, 0, 170, 0, 0, 0, 0, 0xC0, 0, 0, 0, 0,
    ];
    let two = reply(9, &two);
    assert_eq!(
        text(&two, "command.9.slot[1].units"),
        "depends on the classification (170)"
    );
    // Codes that everybody understands need none.
    assert!(unit(57, 0).is_some() && unit(57, 64).is_some() && unit(170, 0).is_none());
}

/// A message of HART-IP with this body: version, type, direct PDU, status, sequence, length.
fn direct(kind: u8, body: &[u8]) -> Vec<u8> {
    let mut bytes = vec![1, kind, 4, 0, 0, 1, 0, 8 + body.len() as u8];
    bytes.extend(body);
    bytes
}

/// Commands of a direct PDU are held to the same rules as those of a frame.
#[test]
fn direct_pdus_say_what_frames_say() {
    let iq = Device::Rotork(Family::Iq);
    let heard = |kind, body: &[u8]| decoded(&direct(kind, body), Framing::HartIp, iq);
    // An error has no data, and that is no wrong length.
    let refused = heard(1, &[0, 0, 0, 3, 1, 32]);
    assert_eq!(text(&refused, "response_code"), "Busy (32)");
    assert_eq!(codes(&refused), ["response-error"]);
    // A meaning of its command, with data.
    let warned = heard(1, &[0, 0, 0, 35, 10, 8, 57, 0x42, 0xC8, 0, 0, 0, 0, 0, 0]);
    assert_eq!(
        text(&warned, "response_code"),
        "Set to nearest possible value (8)"
    );
    assert_eq!(text(&warned, "command.35.upper_range"), "100 %");
    assert_eq!(codes(&warned), ["response-warning"]);
    // Data behind an error, and too few without one.
    let unasked = heard(1, &[0, 0, 0, 7, 3, 16, 5, 1]);
    assert_eq!(codes(&unasked), ["response-error", "data-after-error"]);
    assert_eq!(codes(&heard(1, &[0, 0, 0, 7, 2, 0, 5])), ["data-length"]);
    // What a request does, and what the manual does not list.
    let moves = heard(0, &[0, 0, 0, 132, 1, 0x22]);
    assert_eq!(
        text(&moves, "command.132.actcon"),
        "Close, Force digital position"
    );
    assert_eq!(codes(&moves), ["effect"]);
    let both = heard(0, &[0, 0, 0, 45, 4, 0x40, 0x80, 0, 0]);
    assert_eq!(
        codes(&both),
        ["effect", "effect"],
        "configuration, and moves"
    );
    let reads = heard(0, &[0, 0, 0, 3, 0]);
    assert_eq!(codes(&reads), [""; 0]);
    assert_eq!(
        codes(&heard(0, &[0, 0, 0, 129, 3, 2, 0, 0])),
        ["not-listed"]
    );
    assert_eq!(
        codes(&heard(1, &[0, 0, 0, 200, 3, 0, 1, 2])),
        ["unknown-command"]
    );
    // A frame says the same of the same.
    let address = long_address(0x6EDD, 0x01_2345, true);
    let in_frame = |delimiter, number, data: &[u8]| {
        let bytes = [vec![0xFF; 5], seal(delimiter, &address, number, data)].concat();
        codes(&decoded(&bytes, Framing::Hart, iq))
    };
    assert_eq!(in_frame(0x86, 3, &[32, 0]), codes(&refused));
    assert_eq!(in_frame(0x86, 7, &[16, 0, 5, 1]), codes(&unasked));
    assert_eq!(in_frame(0x82, 132, &[0x22]), codes(&moves));
    assert_eq!(in_frame(0x82, 45, &[0x40, 0x80, 0, 0]), codes(&both));
    // Extended numbers stand in the PDU as they are.
    let map = heard(0, &[0, 0, 2, 0x0B, 2, 0, 64]);
    assert_eq!(text(&map, "command.523.count"), "64");
    assert_eq!(codes(&map), [""; 0]);
}
