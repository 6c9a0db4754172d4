use super::*;

/// Decodes an input; what was printed and what was found.
fn decoded(input: &[u8], framing: FramingArg, format: Format) -> (String, Tally) {
    let args = Args {
        file: None,
        framing,
        device: DeviceArg::None,
        format,
    };
    let mut out = Vec::new();
    let mut printer = Printer {
        format,
        colour: false,
        buffer: String::new(),
        out: &mut out,
        tally: Tally::default(),
    };
    decode(input, &args, &mut printer).unwrap();
    printer.finish().unwrap();
    let tally = printer.tally;
    (String::from_utf8(out).unwrap(), tally)
}

fn json(input: &[u8]) -> (Vec<serde_json::Value>, Tally) {
    let (text, tally) = decoded(input, FramingArg::Auto, Format::Json);
    let lines = text.lines().map(|l| serde_json::from_str(l).unwrap());
    (lines.collect(), tally)
}

/// DDC-100 Direct-to-Host Programming Guide, section 3.2.3: poll of unit 125.
const POLL: &[u8] = b"7D 03 00 07 00 03 BF F6";

#[test]
fn pasted_text_is_decoded() {
    let (lines, tally) = json(POLL);
    assert_eq!(lines.len(), 1);
    assert_eq!(lines[0]["framing"], "modbus-rtu");
    assert_eq!(lines[0]["role"], "request");
    assert_eq!(lines[0]["unit"], 125);
    assert_eq!((tally.frames, tally.errors), (1, 0));
}

#[test]
fn requests_know_their_answers() {
    let text = b"010300000001840A\n010302002A3845B\n".to_vec();
    let answer = shared::encode::frame(Framing::Rtu, 0, 1, &[3, 2, 0, 42]);
    let text = [&text[..17], shared::render::hex(&answer).as_bytes()].concat();
    let (lines, tally) = json(&text);
    assert_eq!(tally.errors, 0, "{lines:?}");
    assert_eq!(lines[0]["pairs_with"], 1);
    assert_eq!(lines[1]["pairs_with"], 0);
}

#[test]
fn nothing_is_an_error() {
    for input in [&b""[..], b"\n\n"] {
        let (lines, tally) = json(input);
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0]["problems"][0]["code"], "empty");
        assert_eq!(tally.errors, 1);
    }
}

#[test]
fn text_that_is_no_hexadecimal_is_an_error() {
    let (_, tally) = json(b"01 03 zz 00");
    assert!(tally.errors > 0);
}

#[test]
fn colon_lines_are_modbus_ascii() {
    let (lines, tally) = json(b":01030000000AF2\r\n");
    assert_eq!(lines[0]["framing"], "modbus-ascii");
    assert_eq!(tally.errors, 0);
}

#[test]
fn binary_captures_are_taken_as_they_are() {
    let frame = shared::encode::frame(Framing::Tcp, 7, 1, &[3, 0, 0, 0, 2]);
    let (lines, tally) = json(&frame);
    assert_eq!(lines[0]["framing"], "modbus-tcp");
    assert_eq!(tally.errors, 0);
}

/// Every frame is printed once, in order, with the pair that it has in memory.
#[test]
fn long_streams_lose_nothing() {
    let mut input = Vec::new();
    for at in 0..20_000_u16 {
        let [high, low] = at.to_be_bytes();
        let asked = [3, high, low, 0, 1];
        input.extend(shared::encode::frame(Framing::Rtu, 0, 9, &asked));
        input.extend(shared::encode::frame(
            Framing::Rtu,
            0,
            9,
            &[3, 2, high, low],
        ));
    }
    let (lines, tally) = json(&input);
    assert_eq!((tally.frames, tally.errors), (40_000, 0));
    for (at, line) in lines.iter().enumerate() {
        assert_eq!(line["index"], at);
        assert_eq!(line["pairs_with"], at ^ 1);
    }
}

#[test]
fn endless_noise_is_printed_in_parts() {
    let (lines, tally) = json(&vec![0_u8; 1_000_000]);
    assert!(lines.len() > 5);
    assert_eq!(tally.noise, 1_000_000);
    assert_eq!(lines[1]["index"], 1);
    let total: u64 = lines.iter().map(|l| l["length"].as_u64().unwrap()).sum();
    assert_eq!(total, 1_000_000);
}

#[test]
fn readable_text_begins_with_what_is_wrong() {
    let (text, tally) = decoded(b"7D 03 00 07 00 03 BF F7", FramingArg::Auto, Format::Text);
    assert_eq!(tally.errors, 1);
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("#0  request  unit 125  FC 03 Read holding registers"));
    assert!(lines[1].starts_with("  error at 6: "), "{text}");
    assert!(
        lines[2].contains("7D") && lines[2].contains("125"),
        "{text}"
    );
    assert!(text.ends_with("1 frame, errors in 1 entry\n"));
}

/// Worked by hand: command 3 of a Rotork actuator, answered with 12 mA and 50 %.
const HART: &[u8] = b"FF FF FF FF FF 82 AE DD 01 23 45 03 00 95
    FF FF FF FF FF 86 AE DD 01 23 45 03 1A 00 00 41 40 00 00 39 42 48 00 00 39 42 46 00 00
    39 41 48 00 00 39 7F A0 00 00 52";

#[test]
fn hart_frames_say_who_and_what() {
    for framing in [FramingArg::Auto, FramingArg::Hart] {
        let (text, tally) = decoded(HART, framing, Format::Json);
        let lines: Vec<serde_json::Value> = text
            .lines()
            .map(|l| serde_json::from_str(l).unwrap())
            .collect();
        assert_eq!((lines.len(), tally.errors), (2, 0), "{text}");
        for (line, role) in lines.iter().zip(["request", "response"]) {
            assert_eq!(line["framing"], "hart");
            assert_eq!(line["role"], role);
            assert_eq!(line["address"], "2EDD012345");
            assert_eq!(line["master"], "primary");
            assert_eq!(line["command"], 3);
            assert!(line.get("unit").is_none());
        }
        assert_eq!(lines[0]["pairs_with"], 1);
        let pv = lines[1]["fields"]
            .as_array()
            .unwrap()
            .iter()
            .find(|f| f["path"] == "command.3.pv")
            .unwrap();
        assert_eq!((&pv["value"], &pv["unit"]), (&50.into(), &"%".into()));
        assert_eq!(pv["source"], "HART universal commands, command 3");
    }
    let (text, _) = decoded(HART, FramingArg::Hart, Format::Text);
    let who = "#0  request  2EDD012345, primary master, command 3 Read dynamic variables";
    assert!(text.starts_with(who), "{text}");
}

/// Command 40 with 4 mA and the answer to it (section 8.1 of PUB092-003-00), and no end of it.
#[test]
fn procedures_are_followed_and_what_stands_is_said() {
    let list = b"FFFFFFFFFF 82AEDD012345 28 04 40800000 7A\n\
        FFFFFFFFFF 86AEDD012345 28 06 0008 40800000 74\n";
    let (text, tally) = decoded(list, FramingArg::Hart, Format::Text);
    assert_eq!(tally.errors, 0, "{text}");
    assert!(
        text.contains("Fixed current and trim (run 1): Asks to fix"),
        "{text}"
    );
    let last = "Fixed current mode was not left again";
    assert!(text.contains(last), "{text}");
    let (text, _) = decoded(list, FramingArg::Hart, Format::Json);
    let lines: Vec<serde_json::Value> = text
        .lines()
        .map(|l| serde_json::from_str(l).unwrap())
        .collect();
    assert_eq!(lines[1]["procedure"]["step"], "fix-current");
    assert_eq!(
        (&lines[2]["kind"], &lines[2]["since"]),
        (&"procedure".into(), &1.into())
    );
}
