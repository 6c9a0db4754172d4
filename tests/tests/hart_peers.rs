//! Other implementations of HART as judges of ours: the HART-IP dissector of Wireshark (tshark)
//! and hart-protocol of PyPI read the same frames, and what hart-protocol builds is decoded.

use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;
use shared::capture::Micros;
use shared::decode::{Context, decode_frame};
use shared::device::{Device, Family};
use shared::frame::{Framing, scan};
use shared::hart::frame::{FILL, long_address, preamble, seal};
use shared::json;
use shared::render::hex;
use shared::sim::hart::{HartDevice, HartLine, HartSetup};
use tests::peers::python;

/// Frames of the readings, section 5: published ones (P) and ones constructed by hand (R).
const FRAMES: [&str; 14] = [
    "02 80 00 00 82",
    "06 80 00 18 00 50 FE 26 4E 05 07 05 02 0E 0C 0B 6F E4 05 04 00 02 00 00 26 00 26 84 58",
    "82 A6 4E 0B 6F E4 14 00 FE",
    "86 A6 4E 0B 6F E4 14 22 00 50 77 69 68 61 72 74 67 77 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 89",
    "82 26 4E 00 00 D2 09 04 00 01 02 03 35",
    "86 26 4E 00 00 D2 09 27 00 D0 02 00 00 FB 00 00 00 00 10 01 00 FB 00 00 00 00 C0 02 40 20 42 02 00 00 C0 03 40 20 42 00 00 00 C0 68 FF 65 00 E0",
    "06 80 00 18 00 20 FE 6E DD 05 07 02 01 08 00 01 23 45 05 05 00 07 00 00 6E 00 6E 01 9B",
    "82 AE DD 01 23 45 03 00 95",
    "86 AE DD 01 23 45 03 1A 00 00 41 40 00 00 39 42 48 00 00 39 42 46 00 00 39 41 48 00 00 39 7F A0 00 00 52",
    "86 AE DD 01 23 45 30 0B 00 90 02 00 02 00 A4 40 08 00 00 D5",
    "86 AE DD 01 23 45 0D 17 00 00 58 13 16 16 DC 31 20 14 94 80 10 D4 54 15 0F 4A 08 20 1B 0A 6D 9A",
    "82 AE DD 01 23 45 4F 08 01 01 39 41 C8 00 00 00 61",
    "86 AE DD 01 23 45 03 02 88 00 1B",
    "86 AE DD 01 23 45 23 02 40 40 B3",
];

fn bytes(text: &str) -> Vec<u8> {
    text.split_whitespace()
        .map(|b| u8::from_str_radix(b, 16).expect("hexadecimal"))
        .collect()
}

/// Requests and answers of the simulated device, without preamble: other bytes than those above,
/// read by both sides.
fn exchanges() -> Vec<Vec<u8>> {
    let requests: [(u8, &[u8]); 15] = [
        (0, &[]),
        (1, &[]),
        (2, &[]),
        (3, &[]),
        (7, &[]),
        (8, &[]),
        (9, &[0, 1, 2, 3]),
        (12, &[]),
        (13, &[]),
        (14, &[]),
        (15, &[]),
        (16, &[]),
        (20, &[]),
        (48, &[]),
        (38, &[0, 0]),
    ];
    let device = HartDevice::new("FV-401", HartSetup::of(Family::Iq));
    let mut line = HartLine::new(1200, vec![device]);
    let mut at = 60_000_000;
    line.devices_mut()[0].set_signal(14.4);
    let _ = line.advance(Micros::new(at));
    let mut all = Vec::new();
    for (command, data) in requests {
        let request = seal(0x82, &long_address(0x6EDD, 0x01_2345, true), command, data);
        line.push(&[vec![FILL; 5], request.clone()].concat(), Micros::new(at));
        at += 2_000_000;
        let answer = line.advance(Micros::new(at));
        let body = answer[preamble(&answer)..].to_vec();
        assert!(body.len() > 8, "command {command} is answered");
        all.extend([request, body]);
    }
    all
}

/// Our fields of a frame as the command line prints them.
fn ours(framing: Framing, bytes: &[u8]) -> Value {
    let frames = scan(bytes, framing);
    assert_eq!(frames.len(), 1, "{bytes:02X?}");
    let context = Context {
        framing,
        device: Device::Rotork(Family::Iq),
    };
    let tree = decode_frame(&frames[0], bytes, None, &context);
    let mut line = String::new();
    json::write_frame(&mut line, 0, &frames[0], framing, &tree).expect("a string");
    serde_json::from_str(&line).expect("JSON")
}

/// A frame as a HART-IP message: version 1, request or response, token-passing PDU.
fn message(frame: &[u8], sequence: u8) -> Vec<u8> {
    let response = u8::from(frame[0] & 7 == 6);
    let len = u8::try_from(frame.len() + 8).expect("short");
    [&[1, response, 3, 0, 0, sequence, 0, len], frame].concat()
}

/// A field of a dissector: name, place in the message, and how it shows the bytes.
#[derive(Debug)]
struct Dissected {
    name: String,
    start: usize,
    len: usize,
    show: String,
}

/// The value of an attribute in a line of PDML.
fn attribute<'a>(line: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = line.split_once(&format!(" {name}=\""))?;
    rest.split_once('"').map(|(value, _)| value)
}

/// What tshark makes of messages, one list of fields each.
fn tshark(folder: &Path, messages: &[Vec<u8>]) -> Vec<Vec<Dissected>> {
    let dump: String = messages
        .iter()
        .map(|m| {
            let words: Vec<String> = m.iter().map(|b| format!("{b:02x}")).collect();
            format!("000000 {}\n", words.join(" "))
        })
        .collect();
    let (text, capture) = (folder.join("hart.txt"), folder.join("hart.pcap"));
    std::fs::write(&text, dump).expect("written");
    let wrapped = Command::new("text2pcap")
        .args(["-q", "-u", "5094,5094"])
        .args([&text, &capture])
        .output()
        .expect("text2pcap starts");
    assert!(wrapped.status.success(), "{wrapped:?}");
    let output = Command::new("tshark")
        .arg("-r")
        .arg(&capture)
        .args(["-T", "pdml"])
        .output()
        .expect("tshark starts");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut packets: Vec<Vec<Dissected>> = Vec::new();
    let mut base = 0;
    for line in text.lines() {
        let number = |name| attribute(line, name).and_then(|v| v.parse::<usize>().ok());
        if line.contains("<proto name=\"hart_ip\"") {
            base = number("pos").expect("a place");
            packets.push(Vec::new());
            continue;
        }
        if line.contains("<proto ") || line.contains("<packet>") {
            continue;
        }
        let name = attribute(line, "name").filter(|n| n.starts_with("hart_ip."));
        if let (Some(name), Some(packet)) = (name, packets.last_mut()) {
            packet.push(Dissected {
                name: name.to_owned(),
                start: number("pos").expect("a place") - base,
                len: number("size").expect("a size"),
                show: attribute(line, "show").unwrap_or("").to_owned(),
            });
        }
    }
    assert_eq!(packets.len(), messages.len(), "every message is dissected");
    packets
}

fn place(field: &Value) -> (usize, usize) {
    let number =
        |key: &str| usize::try_from(field[key].as_u64().expect("a number")).expect("small");
    (number("offset"), number("length"))
}

/// True if tshark shows the same as we do.
fn agrees(theirs: &Dissected, field: &Value) -> bool {
    let raw = field["raw"].as_str().expect("raw").to_ascii_lowercase();
    let show = theirs.show.trim_end();
    if theirs.name.ends_with(".short_addr") {
        // It leaves the bits of master and burst mode out of the number.
        let number = u8::from_str_radix(&raw, 16).expect("a byte") & 0x3F;
        return show == number.to_string();
    }
    if let Some(digits) = show.strip_prefix("0x") {
        return raw.trim_start_matches('0') == digits.trim_start_matches('0');
    }
    if show.contains(':') {
        return show.replace(':', "") == raw;
    }
    if show.eq_ignore_ascii_case("nan") || show == "-nan" {
        return field["value"].is_null();
    }
    let value = &field["value"];
    if let (Ok(number), Some(own)) = (show.parse::<f64>(), value.as_f64()) {
        return (number - own).abs() <= own.abs() * 1e-5;
    }
    let code = u64::from_str_radix(&raw, 16).ok();
    let same_code = show.parse::<u64>().ok().is_some_and(|n| Some(n) == code);
    let text = field["text"].as_str().unwrap_or("");
    let own = value.as_str().unwrap_or(text);
    // Text is padded with blanks or NUL.
    same_code || own.trim_end_matches(['\0', ' ']) == show.trim_end_matches("\\000")
}

#[test]
fn tshark_reads_the_same() {
    let folder = tests::target_dir().join("hart-peers");
    std::fs::create_dir_all(&folder).expect("a folder");
    let frames = FRAMES.iter().map(|f| bytes(f)).chain(exchanges());
    let messages: Vec<Vec<u8>> = (1..).zip(frames).map(|(n, f)| message(&f, n)).collect();
    let mut compared = 0;
    let mut apart: BTreeMap<String, u32> = BTreeMap::new();
    for (message, theirs) in messages.iter().zip(tshark(&folder, &messages)) {
        let own = ours(Framing::HartIp, message);
        assert_eq!(own["ok"], true, "{own}");
        let fields = own["fields"].as_array().expect("fields");
        for field in theirs {
            // One of ours with the same bytes, groups and bits left out by their place.
            let same = |f: &&Value| place(f) == (field.start, field.len);
            let found: Vec<&Value> = fields.iter().filter(same).collect();
            if found.is_empty() {
                *apart.entry(field.name.clone()).or_default() += 1;
                continue;
            }
            let agreed = found.iter().any(|f| agrees(&field, f));
            assert!(agreed, "{field:?} is not {found:?} in {message:02X?}");
            compared += 1;
        }
    }
    assert!(compared > 500, "{compared} fields");
    // Where the fields are cut differently. `command` of a request data block and the like do not
    // differ; what does, and why:
    let explained = EXPLAINED.map(|(name, _)| name);
    for (name, count) in &apart {
        assert!(explained.contains(&name.as_str()), "{name} ({count} times)");
    }
    for (name, why) in EXPLAINED {
        assert!(apart.contains_key(name), "{name} agrees now: {why}");
    }
}

/// Fields of tshark that have no counterpart with the same bytes, and why.
const EXPLAINED: [(&str, &str); 4] = [
    (
        "hart_ip.pt.rsp.device_sp_status",
        "six bytes of command 48 in one; ours are one a byte, each with its bits",
    ),
    (
        "hart_ip.pt.rsp.day",
        "parts of a date, which is one field of ours",
    ),
    ("hart_ip.pt.rsp.month", "the same"),
    ("hart_ip.pt.rsp.year", "the same"),
];

/// Runs the script with lines of input; one JSON value a line.
fn hart_protocol(lines: &[String]) -> Vec<Value> {
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("peers/hart.py");
    let mut child = python()
        .arg(script)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("python starts");
    let mut input = child.stdin.take().expect("a pipe");
    input
        .write_all((lines.join("\n") + "\n").as_bytes())
        .expect("it reads");
    drop(input);
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success(), "see above");
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let values: Vec<Value> = text
        .lines()
        .map(|l| serde_json::from_str(l).expect("JSON"))
        .collect();
    assert_eq!(values.len(), lines.len());
    values
}

/// What both call differently: command, its field, our path.
const NAMES: [(u64, &str, &str); 37] = [
    (0, "manufacturer_id", "expanded_type.high"),
    (0, "manufacturer_device_type", "expanded_type.low"),
    // Byte 3 is what requests need; the package takes it for the answers.
    (
        0,
        "number_response_preamble_characters",
        "request_preambles",
    ),
    (0, "universal_command_revision_level", "universal_revision"),
    (
        0,
        "transmitter_specific_command_revision_level",
        "device_revision",
    ),
    (0, "software_revision_level", "software_revision"),
    (0, "hardware_revision_level", "hardware"),
    (0, "device_id", "device_id"),
    (1, "primary_variable_units", "pv_units"),
    (1, "primary_variable", "pv"),
    (2, "analog_signal", "loop_current"),
    (2, "primary_variable", "percent"),
    (3, "analog_signal", "loop_current"),
    (3, "primary_variable_units", "pv_units"),
    (3, "primary_variable", "pv"),
    (3, "secondary_variable_units", "sv_units"),
    (3, "secondary_variable", "sv"),
    (12, "message", "message"),
    (13, "device_tag_name", "tag"),
    (13, "device_descriptor", "descriptor"),
    (13, "date", "date"),
    (14, "serial_no", "serial"),
    (14, "sensor_limits_code", "units"),
    (14, "upper_limit", "upper_limit"),
    (14, "lower_limit", "lower_limit"),
    (14, "min_span", "minimum_span"),
    (15, "alarm_code", "alarm_selection"),
    (15, "transfer_fn_code", "transfer_function"),
    (15, "primary_variable_range_code", "range_units"),
    (15, "upper_range_value", "upper_range"),
    (15, "lower_range_value", "lower_range"),
    (15, "damping_value", "damping"),
    (15, "write_protect", "write_protect"),
    // HART 5 has the distributor here, HART 7 a reserved 250.
    (15, "private_label", "reserved"),
    (16, "final_assembly_no", "final_assembly"),
    (48, "device_status", ""),
    (20, "device_status", ""),
];

#[test]
fn hart_protocol_reads_the_same() {
    let fixed = FRAMES.iter().map(|f| bytes(f));
    let answers: Vec<Vec<u8>> = fixed.chain(exchanges()).filter(|f| f[0] & 7 == 6).collect();
    let lines: Vec<String> = answers
        .iter()
        .map(|f| format!("read {}", hex(&[&[FILL; 5][..], f].concat())))
        .collect();
    let mut compared = 0;
    for (frame, theirs) in answers.iter().zip(hart_protocol(&lines)) {
        let own = ours(Framing::Hart, frame);
        let command = own["command"].as_u64().expect("a command");
        let field = |path: &str| {
            let fields = own["fields"].as_array().expect("fields");
            fields.iter().find(|f| f["path"] == path).cloned()
        };
        let raw = |path: &str| field(path).map(|f| f["raw"].as_str().unwrap_or("").to_owned());
        assert_eq!(theirs["command"].as_u64(), Some(command));
        let count = usize::from_str_radix(&raw("byte_count").expect("a count"), 16).expect("hex");
        assert_eq!(theirs["bytecount"].as_u64(), Some(count as u64));
        // A communication error is a response code of 128 and more to it.
        let first = raw("response_code").or_else(|| raw("communication_error"));
        let first = u64::from_str_radix(&first.expect("a status"), 16).ok();
        assert_eq!(theirs["response_code"].as_u64(), first);
        let status = raw("device_status").expect("a status");
        let status = u64::from_str_radix(&status, 16).ok();
        assert_eq!(theirs["device_status"].as_u64(), status);
        compared += 4;
        // Its data are two bytes too long: the count includes the status, which it takes off twice.
        let data = theirs["data"].as_str().expect("data");
        let from = frame.len() - 1 - (count - 2);
        let rest = hex(&frame[from..]).to_lowercase();
        assert_eq!(data, rest, "the data and the check byte");
        for (_, name, path) in NAMES.iter().filter(|n| n.0 == command && !n.2.is_empty()) {
            // Its error answers have no fields.
            let Some(value) = theirs.get(*name) else {
                assert_eq!(count, 2, "{name} is missing");
                continue;
            };
            let (path, half) = match path.split_once('.') {
                Some((path, half)) => (path, Some(half)),
                None => (*path, None),
            };
            let path = format!("command.{command}.{path}");
            let field = field(&path).unwrap_or_else(|| panic!("{path} in {own}"));
            let raw = field["raw"].as_str().expect("raw").to_lowercase();
            let raw = match half {
                Some("high") => raw[..2].to_owned(),
                Some(_) => raw[2..].to_owned(),
                None => raw,
            };
            let same = match value {
                Value::Null => field["value"].is_null(),
                Value::String(text) => *text == raw,
                number if field["text"].as_str().is_some() && number.is_f64() => {
                    let own = field["value"].as_f64().expect("a number");
                    (number.as_f64().expect("a number") - own).abs() <= own.abs() * 1e-5
                }
                number => number.as_u64() == u64::from_str_radix(&raw, 16).ok(),
            };
            assert!(same, "{path}: {value} is not {field}");
            compared += 1;
        }
    }
    assert!(compared > 120, "{compared} values");
}

#[test]
fn what_hart_protocol_builds_is_decoded() {
    let names = [
        ("read_unique_identifier", 0),
        ("read_primary_variable", 1),
        ("read_loop_current", 2),
        ("read_dynamic_variables", 3),
        ("read_message", 12),
        ("read_tag", 13),
        ("read_final_assembly", 16),
        ("own_address", 1),
        ("tag", 11),
        ("descriptor", 18),
    ];
    let lines: Vec<String> = names.iter().map(|(n, _)| format!("build {n}")).collect();
    for ((name, command), built) in names.iter().zip(hart_protocol(&lines)) {
        let text = built.as_str().expect("hexadecimal");
        let spaced: Vec<&str> = (0..text.len() / 2)
            .map(|i| &text[2 * i..2 * i + 2])
            .collect();
        let own = ours(Framing::Hart, &bytes(&spaced.join(" ")));
        assert_eq!(own["role"], "request", "{name}");
        assert_eq!(own["command"].as_u64(), Some(*command), "{name}");
        assert_eq!(own["address"], "2EDD012345", "{name}");
        assert_eq!(own["master"], "primary", "{name}");
        assert_eq!(own["ok"], true, "{own}");
        let fields = own["fields"].as_array().expect("fields");
        let text = |path: &str| {
            let field = fields.iter().find(|f| f["path"] == path);
            field.map_or("", |f| f["text"].as_str().unwrap_or(""))
        };
        // It does not mask the maker's number to six bits, so 6E sets the bit of burst mode
        // (readings, section 8): a frame of its address looks like one of a bursting device.
        assert_eq!(
            text("address").contains("in burst mode"),
            *name == "own_address",
            "{name}: {}",
            text("address")
        );
        match *name {
            "tag" => assert_eq!(text("command.11.tag"), "VALVE-01"),
            // It packs the last eight characters of a longer text only, in the last bytes.
            "descriptor" => {
                assert_eq!(text("command.18.tag"), "VALVE-01");
                assert_eq!(text("command.18.descriptor"), "@@@@@@@@UATOR");
                assert_eq!(text("command.18.date"), "2009-10-27");
            }
            _ => {}
        }
    }
}
