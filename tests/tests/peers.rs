//! Other implementations of Modbus as judges of ours: pymodbus and mbpoll (libmodbus) read our
//! simulated actuator, our backend reads a device of pymodbus.

use std::collections::BTreeMap;
use std::net::TcpListener;
use std::path::PathBuf;
use std::process::Command;

use serde_json::{Value, json};
use shared::frame::Framing;
use shared::icon3000::read::{Item, Log};
use shared::icon3000::records::Records;
use shared::proto::{Block, DdcAsk, DdcNews, DopNews, IconStep, Outcome, TableName, ToBackend};
use tests::page::Page;
use tests::peers::{mbpoll, python};
use tests::process::Process;
use tests::server::{Server, binary};

/// A script of ours that runs a peer.
fn script(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("peers")
        .join(name)
}

/// A port that was free a moment ago.
fn free_port() -> u16 {
    let listener = TcpListener::bind("127.0.0.1:0").expect("loopback");
    listener.local_addr().expect("an address").port()
}

/// Our simulator on Modbus TCP.
fn simulator() -> (Process, u16) {
    simulator_with(&[])
}

/// The same with options.
fn simulator_with(options: &[&str]) -> (Process, u16) {
    let mut command = Command::new(binary());
    command.args(["simulate", "--listen", "127.0.0.1:0"]);
    command.args(options);
    Process::start(&mut command, "build the backend first", |line| {
        line.split_once("listening on 127.0.0.1:")?
            .1
            .trim()
            .parse()
            .ok()
    })
}

/// Two pseudo terminals that are connected like the ends of a cable.
fn cable() -> (Process, String, String) {
    let (process, (one, other)) =
        Process::start(python().arg(script("ptys.py")), "see the peers", |line| {
            let mut words = line.strip_prefix("ptys ")?.split(' ');
            Some((words.next()?.to_owned(), words.next()?.to_owned()))
        });
    (process, one, other)
}

/// Our simulator on a serial line.
fn serial_simulator(path: &str) -> Process {
    serial_simulator_with(path, &[])
}

/// The same with options.
fn serial_simulator_with(path: &str, options: &[&str]) -> Process {
    let mut command = Command::new(binary());
    command.args(["simulate", "--serial", path, "--baud", "38400"]);
    command.args(options);
    Process::start(&mut command, "build the backend first", |line| {
        line.contains(path).then_some(())
    })
    .0
}

/// What pymodbus got for its questions.
fn pymodbus_asks(kind: &str, place: &str) -> Vec<Value> {
    let output = python()
        .arg(script("client.py"))
        .args([kind, place])
        .output()
        .expect("python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    text.lines()
        .map(|l| serde_json::from_str(l).expect("JSON lines"))
        .collect()
}

/// Checks the answers of the simulated actuator against VCIOM-16345-EN, sections 7 and 8.
fn check_answers(answers: &[Value]) {
    let of = |ask: &str| {
        let found = answers.iter().find(|a| a["ask"] == ask);
        found
            .unwrap_or_else(|| panic!("nothing about {ask}"))
            .clone()
    };
    let registers = |ask: &str| -> Vec<u64> {
        let answer = of(ask);
        let words = answer["registers"]
            .as_array()
            .unwrap_or_else(|| panic!("{answer}"));
        words.iter().filter_map(Value::as_u64).collect()
    };
    // Table 5: "always" values.
    assert_eq!(registers("actuator id"), [0x9000, 0x0001]);
    assert_eq!(registers("identifier"), [0x9000]);
    let position = registers("position")[0];
    assert!(position <= 1000, "position {position}");
    // It moves; in the moment between the two questions not by more than a tenth of the stroke.
    let input = registers("input position")[0];
    assert!(
        position.abs_diff(input) <= 100,
        "{position} and {input} are the same position"
    );
    // Notes 2 and 3: BCD date 0xDDMM 0xYYYY, time 0x00HH 0xMMSS.
    let clock = registers("clock");
    let digits = |word: u64| (0..4).all(|n| (word >> (4 * n)) & 0xF < 10);
    assert!(clock.iter().all(|w| digits(*w)), "{clock:x?}");
    assert!(
        (0x2024..0x2100).contains(&clock[1]),
        "the year {:x}",
        clock[1]
    );
    assert!(clock[2] <= 0x23, "the hour {:x}", clock[2]);
    assert_eq!(registers("whole block").len(), 125);
    assert_eq!(registers("last register").len(), 1);
    // Note 13: always read as 0.
    assert_eq!(registers("password"), [0, 0, 0, 0]);
    assert_eq!(registers("curve").len(), 64);
    assert_eq!(
        of("coils")["bits"].as_array().map(Vec::len),
        Some(16),
        "11 coils in two bytes"
    );
    assert_eq!(of("discrete")["bits"].as_array().map(Vec::len), Some(32));
    // Section 8: exceptions.
    for (ask, code) in [
        ("beyond the last", 2),
        ("beyond the last input", 2),
        ("too many coils", 3),
        ("beyond the last coil", 2),
        ("too many discrete", 3),
        ("coil that is not there", 2),
        ("register out of range", 3),
        ("mask write", 1),
        ("restart", 1),
    ] {
        assert_eq!(of(ask)["exception"], json!(code), "{ask}: {}", of(ask));
    }
    // Section 8.7.1: the echo.
    let echo = of("echo").to_string();
    assert!(
        echo.contains("[165,182]") || echo.contains("[165, 182]") || echo.contains("42422"),
        "{echo}"
    );
}

#[test]
fn pymodbus_reads_the_simulator_over_tcp() {
    let (_simulator, port) = simulator();
    check_answers(&pymodbus_asks("tcp", &port.to_string()));
}

#[test]
fn pymodbus_reads_the_simulator_over_a_serial_line() {
    let (_cable, ours, theirs) = cable();
    let _simulator = serial_simulator(&ours);
    check_answers(&pymodbus_asks("rtu", &theirs));
}

/// What our side makes of the words of a file: head and entries by name, numbers as raw counts.
fn our_values(number: u16, records: &Records) -> BTreeMap<String, Value> {
    let mut values = BTreeMap::new();
    // Without a layout there are no values.
    let Some(log) = Log::read(number, records) else {
        return values;
    };
    assert!(log.complete && log.problems.is_empty(), "file {number}");
    let mut put = |place: &str, item: &Item| {
        let value = match item.value {
            shared::value::Value::Number { raw, .. } => json!(raw),
            shared::value::Value::Code { raw, .. } | shared::value::Value::Flags { raw, .. } => {
                json!(raw)
            }
            shared::value::Value::Text | shared::value::Value::DeviceTime(_) => json!(item.text()),
            _ => return,
        };
        values.insert(format!("{place}.{}.{}", item.field.key, item.index), value);
    };
    log.head.iter().flatten().for_each(|item| put("head", item));
    for entry in &log.entries {
        let place = format!("entry{}", entry.number);
        entry
            .items
            .iter()
            .flatten()
            .for_each(|item| put(&place, item));
    }
    values
}

/// What pymodbus reads of the files, counters and report of the simulated ICON3000v2, checked
/// against VCIOM-16345-EN, section 8. Gives the words of every file.
fn check_files(kind: &str, place: &str) -> BTreeMap<u16, Vec<u16>> {
    let output = python()
        .arg(script("icon.py"))
        .args([kind, place])
        .output()
        .expect("python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{text}{error}");
    let answers: Vec<Value> = text
        .lines()
        .map(|l| serde_json::from_str(l).expect("JSON lines"))
        .collect();
    let of = |ask: &str| {
        let found = answers.iter().find(|a| a["ask"] == ask);
        found.unwrap_or_else(|| panic!("nothing about {ask}: {text}"))
    };
    let mut files = BTreeMap::new();
    for answer in answers.iter().filter(|a| a["ask"] == "file") {
        let number: u16 = serde_json::from_value(answer["file"].clone()).expect("a number");
        let words: Vec<u16> = serde_json::from_value(answer["words"].clone()).expect("words");
        let theirs: BTreeMap<String, Value> =
            serde_json::from_value(answer["values"].clone()).expect("values");
        let ours = our_values(number, &Records::of(0, words.iter().copied()));
        assert_eq!(ours, theirs, "file {number}");
        files.insert(number, words);
    }
    // Table 30: what the simulated device holds of each kind.
    let count = |first: u16, last: u16| files.range(first..=last).count();
    assert_eq!(
        (count(2, 5), count(5000, 5200), count(5300, 5304)),
        (4, 3, 5)
    );
    assert!(count(1000, 1100) > 10 && count(2000, 2100) > 10, "{text}");
    assert!(count(3000, 3016) > 3 && count(3500, 3516) > 2, "{text}");
    // A file or record that is not there: exception 02 (reading E66).
    for ask in [
        "beyond 1000",
        "beyond 2000",
        "beyond 3000",
        "beyond 3500",
        "beyond 5",
        "no such file",
    ] {
        assert_eq!(of(ask)["code"], 2, "{ask}");
    }
    // The first halves of five card reports in one answer.
    let reports = of("reports")["groups"].as_array().expect("groups");
    for (number, report) in (5300..).zip(reports) {
        assert_eq!(*report, json!(files[&number][..16]), "{number}");
    }
    // Between the two rounds of four questions: five reads, one that is refused, and on a serial line
    // two frames that nobody could read. Each round asks for 11 first and for 14 last.
    let counts = |key: &str| -> Vec<u16> {
        serde_json::from_value(of("counters")[key].clone()).expect("counts")
    };
    let (before, after) = (counts("before"), counts("after"));
    let since: Vec<u16> = after
        .iter()
        .zip(&before)
        .map(|(a, b)| a.wrapping_sub(*b))
        .collect();
    let damaged = if kind == "tcp" { 0 } else { 2 };
    assert_eq!(since, [10, damaged, 1, 10], "{before:?} {after:?}");
    // HR 3531 to 3536 are 11, 14, 12, 13, 17, 18 (reading E60); they count their own read too, and
    // the three questions that came after the one for 11.
    let registers = counts("registers");
    let [of_bus, errors, exceptions, of_unit] = after[..] else {
        panic!("{after:?}");
    };
    assert_eq!(
        registers,
        [of_bus + 4, of_unit + 1, errors, exceptions, 0, 0]
    );
    // Server ID, run indicator, and the texts of table 26.
    let report = of("report")["hex"].as_str().expect("hexadecimal");
    let ascii = |text: &str| -> String { text.bytes().map(|b| format!("{b:02x}")).collect() };
    let begin = report.find(&ascii("Biffi ICON3000")).expect("the type");
    let text = &report[begin..];
    assert!(
        text[88..].starts_with(&ascii("XV-101")),
        "the tag: {report}"
    );
    // Reading E63: who takes the printed count of 82 for the length, as pymodbus does, loses the last
    // two characters; in bytes of our own they are there.
    let versions = if kind == "tcp" {
        "9.02  4"
    } else {
        "9.02  4.01"
    };
    assert!(text[144..].starts_with(&ascii(versions)), "{report}");
    if kind == "rtu" {
        assert_eq!(
            report.len(),
            2 * 84,
            "server ID, run indicator, 82 characters"
        );
    }
    files
}

#[test]
fn pymodbus_reads_files_counters_and_the_report_over_tcp() {
    let (_simulator, port) = simulator();
    let theirs = check_files("tcp", &port.to_string());
    // Our own master reads the same words by itself, file 5 with its unknown length too.
    let host = format!("127.0.0.1:{port}");
    let output = Command::new(binary())
        .args(["snapshot", "--host", &host])
        .output()
        .expect("it starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    let (snapshot, problems) = shared::icon3000::snapshot::parse(&output.stdout);
    assert!(problems.is_empty(), "{problems:?}");
    let files = snapshot.expect("a snapshot").files;
    let ours: BTreeMap<u16, Vec<u16>> = files
        .iter()
        .map(|(number, records)| (number, records.iter().map(|(_, word)| word).collect()))
        .collect();
    assert_eq!(ours, theirs);
}

#[test]
fn pymodbus_reads_files_and_counters_over_a_serial_line() {
    let (_cable, ours, theirs) = cable();
    let _simulator = serial_simulator(&ours);
    check_files("rtu", &theirs);
}

/// mbpoll counts registers from 1: number 45 is address 44.
#[test]
fn mbpoll_reads_the_simulator() {
    let (_simulator, port) = simulator();
    let read = |args: &[&str]| {
        let port = port.to_string();
        let mut command = mbpoll();
        command
            .args(["-m", "tcp", "-p", &port, "-a", "1", "-1"])
            .args(args)
            .arg("127.0.0.1");
        let output = command.output().expect("mbpoll starts");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(
            output.status.success(),
            "{text}{}",
            String::from_utf8_lossy(&output.stderr)
        );
        text
    };
    let text = read(&["-t", "4:hex", "-r", "45", "-c", "2"]);
    assert!(text.contains("0x9000") && text.contains("0x0001"), "{text}");
    assert!(read(&["-t", "3", "-r", "1", "-c", "1"]).contains("[1]:"));
    assert!(read(&["-t", "1", "-r", "1", "-c", "32"]).contains("[32]:"));
    assert!(read(&["-t", "0", "-r", "1", "-c", "11"]).contains("[11]:"));
}

#[test]
fn mbpoll_reads_the_simulator_over_a_serial_line() {
    let (_cable, ours, theirs) = cable();
    let _simulator = serial_simulator(&ours);
    let mut command = mbpoll();
    command.args(["-m", "rtu", "-b", "38400", "-P", "none", "-a", "1", "-1"]);
    command
        .args(["-t", "4:hex", "-r", "3001", "-c", "1"])
        .arg(&theirs);
    let output = command.output().expect("mbpoll starts");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        text.contains("0x9000"),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

/// A device of pymodbus, and a backend that has it on a bus of this kind.
fn backend_beside(kind: &str, place: &str, bus: &str) -> (Process, Server, PathBuf) {
    let mut command = python();
    command.arg(script("server.py")).args([kind, place]);
    let (device, ()) = Process::start(&mut command, "see the peers", |line| {
        (line == "ready").then_some(())
    });
    let config = format!(
        "[[bus]]\nname = \"peer\"\n{bus}\n\n[[device]]\ntag = \"P-7\"\nkind = \"icon3000v2\"\n\
         bus = \"peer\"\nunit = 7\n"
    );
    let file = std::env::temp_dir().join(format!(
        "valvescope-peer-{}-{kind}.toml",
        std::process::id()
    ));
    std::fs::write(&file, config).expect("a temporary file");
    let server = Server::start(&["--config", file.to_str().expect("a path in UTF-8")]);
    (device, server, file)
}

/// Reads blocks of all four tables and compares them with what the peer was told to hold.
fn check_reads(server: &Server, framing: Framing) {
    let mut page = Page::open(server.address(), "peer", framing);
    let block = |table, start, count| Block {
        table,
        start,
        count,
    };
    let mut words = |table, start: u16, count: u16, factor: u16, offset: u16| {
        assert_eq!(page.read("P-7", block(table, start, count)).0, Outcome::Ok);
        let want: Vec<u8> = (start..start + count)
            .flat_map(|a| a.wrapping_mul(factor).wrapping_add(offset).to_be_bytes())
            .collect();
        assert_eq!(page.last_data(), Some(want), "{table:?} {start}+{count}");
    };
    words(TableName::Holding, 3004, 1, 31, 7);
    words(TableName::Holding, 3000, 125, 31, 7);
    words(TableName::Holding, 3900, 89, 31, 7);
    words(TableName::Input, 0, 100, 17, 3);
    assert_eq!(
        page.read("P-7", block(TableName::Coil, 0, 11)).0,
        Outcome::Ok
    );
    assert_eq!(
        page.last_data().map(|d| d[0]),
        Some(0b0100_1001),
        "coils 0, 3 and 6"
    );
    assert_eq!(
        page.read("P-7", block(TableName::Discrete, 0, 32)).0,
        Outcome::Ok
    );
    assert_eq!(
        page.last_data().map(|d| d[0]),
        Some(0b0010_0001),
        "inputs 0 and 5"
    );
    // Beyond what the peer holds it answers with an exception, and the next read is good again.
    let (outcome, text) = page.read("P-7", block(TableName::Holding, 3989, 1));
    assert_eq!(outcome, Outcome::Exception, "{text}");
    assert_eq!(
        page.read("P-7", block(TableName::Holding, 3988, 1)).0,
        Outcome::Ok
    );
}

/// Reads a file, the report and a counter of the peer. Its file is a text of 20 bytes, whichever is
/// asked for; its report has the usual form, of one byte for who it is.
fn check_steps(server: &Server, framing: Framing) {
    let mut page = Page::open(server.address(), "peer", framing);
    let file = |count| IconStep::File {
        file: 4,
        start: 1,
        count,
    };
    let found = page.steps("P-7", &[file(10), IconStep::Identity]);
    assert_eq!(found.len(), 2, "{found:?}");
    let text: String = b"SERVER DUMMY RECORD."
        .iter()
        .map(|b| format!("{b:02X}"))
        .collect();
    assert_eq!(found[0], (Outcome::Ok, format!("14161506{text}")));
    assert_eq!(found[1].0, Outcome::Ok, "{found:?}");
    assert!(found[1].1.starts_with("11"), "{found:?}");
    // Twenty bytes are no answer to a question for ten.
    let found = page.steps("P-7", &[file(5)]);
    assert_eq!(found[0].0, Outcome::Damaged, "{found:?}");
    let found = page.steps("P-7", &[IconStep::Diagnostic { sub_function: 14 }]);
    assert_eq!(found[0].0, Outcome::Ok, "{found:?}");
    assert!(found[0].1.starts_with("08000E"), "{found:?}");
}

#[test]
fn our_backend_reads_pymodbus_over_tcp() {
    let port = free_port();
    let bus = format!("kind = \"tcp\"\nhost = \"127.0.0.1:{port}\"");
    let (_device, server, file) = backend_beside("tcp", &port.to_string(), &bus);
    check_reads(&server, Framing::Tcp);
    check_steps(&server, Framing::Tcp);
    std::fs::remove_file(file).expect("it was there");
}

#[test]
fn our_backend_reads_pymodbus_over_rtu() {
    let (_cable, ours, theirs) = cable();
    let bus = format!("kind = \"rtu\"\nport = \"{ours}\"\nbaud = 38400\nmode = \"8N1\"");
    let (_device, server, file) = backend_beside("rtu", &theirs, &bus);
    check_reads(&server, Framing::Rtu);
    check_steps(&server, Framing::Rtu);
    std::fs::remove_file(file).expect("it was there");
}

#[test]
fn our_backend_reads_pymodbus_over_ascii() {
    let (_cable, ours, theirs) = cable();
    let bus = format!("kind = \"ascii\"\nport = \"{ours}\"\nbaud = 38400\nmode = \"8N1\"");
    let (_device, server, file) = backend_beside("ascii", &theirs, &bus);
    check_reads(&server, Framing::Ascii);
    check_steps(&server, Framing::Ascii);
    std::fs::remove_file(file).expect("it was there");
}

// ---- diagnostic objects

/// A unit that stands still, so that most of its registers stay what they are.
const DOP: [&str; 5] = ["--device", "dop", "--tag", "MX-PEER", "--still"];

/// Registers by request word, as the script of pymodbus read them.
type Objects = BTreeMap<u16, Vec<u16>>;

/// The script performs the handshake by itself and checks what the objects mean.
fn pymodbus_reads_objects(kind: &str, place: &str) -> Objects {
    let output = python()
        .arg(script("dop.py"))
        .args([kind, place])
        .output()
        .expect("python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let objects: BTreeMap<String, Vec<u16>> = serde_json::from_str(&text).expect("JSON");
    let word = |(word, words): (String, Vec<u16>)| (word.parse().expect("a word"), words);
    objects.into_iter().map(word).collect()
}

/// What our backend reads is what pymodbus read.
fn check_objects(bus: &str, framing: Framing, name: &str, want: &Objects) {
    let profile = r#"{"registers":{"request":4000,"indicators":4010,"status":4014,"count":4015,
        "response":4100}}"#;
    let directory =
        std::env::temp_dir().join(format!("valvescope-peer-dop-{}-{name}", std::process::id()));
    std::fs::create_dir_all(&directory).expect("a temporary directory");
    std::fs::write(directory.join("site.json"), profile).expect("a temporary file");
    let config = format!(
        "[[bus]]\nname = \"peer\"\n{bus}\n\n[[device]]\ntag = \"M-1\"\nkind = \"dop\"\n\
         bus = \"peer\"\nunit = 1\nprofile = \"site.json\"\n"
    );
    let file = directory.join("plant.toml");
    std::fs::write(&file, config).expect("a temporary file");
    let server = Server::start(&["--config", file.to_str().expect("a path in UTF-8")]);
    let mut page = Page::open(server.address(), "peer", framing);
    let requests: Vec<u16> = want.keys().copied().collect();
    assert!(requests.len() >= 5);
    let news = page.objects("M-1", &requests);
    assert_eq!(news.len(), requests.len(), "{news:?}");
    for (news, (word, words)) in news.iter().zip(want) {
        let DopNews::Object { request, hex, .. } = news else {
            panic!("{news:?}");
        };
        let bytes: Vec<u8> = words.iter().flat_map(|w| w.to_be_bytes()).collect();
        assert_eq!((request, hex), (word, &shared::render::hex(&bytes)));
    }
    std::fs::remove_dir_all(directory).expect("it was there");
}

#[test]
fn pymodbus_and_we_read_the_same_objects_over_tcp() {
    let (_simulator, port) = simulator_with(&DOP);
    let objects = pymodbus_reads_objects("tcp", &port.to_string());
    let bus = format!("kind = \"tcp\"\nhost = \"127.0.0.1:{port}\"");
    check_objects(&bus, Framing::Tcp, "tcp", &objects);
}

#[test]
fn pymodbus_and_we_read_the_same_objects_over_a_serial_line() {
    let (_cable, ours, theirs) = cable();
    let _simulator = serial_simulator_with(&ours, &DOP);
    let objects = pymodbus_reads_objects("rtu", &theirs);
    let bus = format!("kind = \"rtu\"\nport = \"{theirs}\"\nbaud = 38400\nmode = \"8N1\"");
    check_objects(&bus, Framing::Rtu, "rtu", &objects);
}

// ---- DDC-100

/// What the simulated units report, so that there are bits to compare.
const TROUBLES: [&str; 8] = [
    "input-5-1",
    "analog-lost-2-1",
    "verify-close-2",
    "analog-lost-3-2",
    "input-9-2",
    "rotation-3",
    "input-8-4",
    "input-17-4",
];

/// Our simulated network behind one serial line, and what pymodbus reads of it.
fn pymodbus_reads_field_units(framing: &str) -> Vec<Value> {
    let (_cable, ours, theirs) = cable();
    let mut command = Command::new(binary());
    command.args(["simulate", "--ddc100", &ours, "--framing", framing]);
    command.args(["--units", "mx:1,uec:1,clamshell:1,io:1"]);
    for fault in TROUBLES {
        command.args(["--fault", fault]);
    }
    let (_simulator, ()) = Process::start(&mut command, "build the backend first", |line| {
        line.contains("units 1 to 4").then_some(())
    });
    let output = python()
        .arg(script("ddc100.py"))
        .args([framing, &theirs])
        .output()
        .expect("python starts");
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{text}{}",
        String::from_utf8_lossy(&output.stderr)
    );
    text.lines()
        .map(|l| serde_json::from_str(l).expect("JSON lines"))
        .collect()
}

/// Checks the answers of the simulated units against LMAIM4019-00, section 3.
fn check_field_units(answers: &[Value]) {
    let of = |unit: u64, ask: &str| {
        let found = answers
            .iter()
            .find(|a| a["unit"] == unit && a["ask"] == ask);
        found
            .unwrap_or_else(|| panic!("nothing about {ask} of unit {unit}"))
            .clone()
    };
    let list = |unit: u64, ask: &str, key: &str| -> Vec<Value> {
        let answer = of(unit, ask);
        let list = answer[key].as_array();
        list.unwrap_or_else(|| panic!("{answer}")).clone()
    };
    let registers = |unit, ask: &str| -> Vec<u64> {
        let words = list(unit, ask, "registers");
        words.iter().filter_map(Value::as_u64).collect()
    };
    let bits = |unit, ask: &str| -> Vec<bool> {
        let bits = list(unit, ask, "bits");
        bits.iter().filter_map(Value::as_bool).collect()
    };
    let word = |bits: &[bool]| {
        let bits = bits.iter().rev();
        bits.fold(0, |sum, bit| sum * 2 + u64::from(*bit))
    };
    for unit in 1..=4 {
        // Table 3.5: registers 1 to 56; the poll of section 3.2.3 is a part of them.
        let (mut all, poll) = (registers(unit, "all"), registers(unit, "poll"));
        // Register 10 bit 12, "unit was reset", is said once; an I/O module has no such bit.
        let reset = u64::from(unit != 4);
        assert_eq!(
            (all[9] >> 12 & 1, poll[2] >> 12 & 1),
            (reset, 0),
            "unit {unit}"
        );
        all[9] &= !(1 << 12);
        assert_eq!(
            (all.len(), &all[7..13]),
            (56, poll.as_slice()),
            "unit {unit}"
        );
        // Function 04 reads the same registers (reading D6).
        assert_eq!(registers(unit, "input registers"), poll[..2], "unit {unit}");
        // Coil n is bit n - 1 of register 11 on every type (readings D2, D3, D33).
        let coils = bits(unit, "coils");
        assert_eq!(coils.len(), 16, "nine coils in two bytes");
        assert_eq!(word(&coils) & 0x1FF, poll[3] & 0x1FF, "unit {unit}");
        // The relay that was engaged: coil 3, 3, 4 and 8 (table 3.7).
        let relay = [3, 3, 4, 8][usize::try_from(unit).expect("small") - 1];
        let on: Vec<usize> = (1..=9).filter(|n| coils[n - 1]).collect();
        assert_eq!(on, [relay], "unit {unit}");
        // Table 3.2: no function 02 in an MX/DDC, and no 17 in any.
        if unit == 1 {
            assert_eq!(of(unit, "inputs")["exception"], json!(1));
        } else {
            // Table 3.4: inputs 129 to 208 are the bits of registers 9 to 13.
            let inputs = bits(unit, "inputs");
            let words: Vec<u64> = inputs.chunks(16).map(word).collect();
            assert_eq!(words, poll[1..], "unit {unit}");
        }
        // Tables 3.4 and 3.5: the bits of what was brought about, by register and bit.
        let expected: &[(usize, u64)] = match unit {
            1 => &[(12, 13), (13, 3)],
            2 => &[(10, 1), (13, 2), (13, 15)],
            3 => &[(10, 13)],
            // Reading D17: input 17 is bit 15 of register 13.
            _ => &[(12, 0), (13, 15)],
        };
        for (register, bit) in expected {
            assert_eq!(poll[register - 8] >> bit & 1, 1, "unit {unit}, {register}");
        }
        assert_eq!(of(unit, "report")["exception"], json!(1), "unit {unit}");
        assert_eq!(of(unit, "beyond")["exception"], json!(2), "unit {unit}");
        let echo = of(unit, "echo").to_string();
        assert!(
            echo.contains("[165,182]") || echo.contains("[165, 182]") || echo.contains("42422"),
            "{echo}"
        );
    }
    // A valve that is closed: register 8 says 0 percent, register 9 bit 1 closed, bit 0 not open;
    // register 12 bit 0 remote (table 3.5).
    for unit in [1, 2] {
        let poll = registers(unit, "poll");
        assert_eq!((poll[0], poll[1] & 0b11), (0, 0b10), "unit {unit}");
        assert_eq!(poll[4] & 1, 1, "unit {unit}");
    }
    // Section 4.3.1: a UEC-3-DDC without its second channel says so in bit 11 of register 9; bit 10
    // is clear on both, since channel A was just used.
    assert_eq!(registers(2, "poll")[1] >> 10 & 0b11, 0b10);
    assert_eq!(registers(1, "poll")[1] >> 10 & 0b01, 0b00);
    // Table 3.7: 256 opens. Bit 3 of register 9 is "opening", coil 2 the open contactor.
    let opening = registers(2, "opening");
    assert_eq!(opening[1] >> 3 & 1, 1, "{opening:?}");
    assert!(bits(2, "opening coils")[1]);
    // And 512 stops: neither opening nor closing, both contactors off.
    assert_eq!(registers(2, "stopped")[1] >> 3 & 0b11, 0);
    assert!(!bits(2, "stopped coils")[0] && !bits(2, "stopped coils")[1]);
    // Table 3.8. Unit 2 saw three requests for it and one for unit 1, one was an exception, then
    // those that asked.
    for (ask, value) in [
        ("bus messages", 4),
        ("communication errors", 0),
        ("exceptions", 1),
        ("own messages", 6),
    ] {
        assert_eq!(of(2, ask)["message"], json!(value), "{ask}");
    }
    let nobody = of(9, "nobody");
    assert!(nobody.get("error").is_some(), "{nobody}");
}

#[test]
fn pymodbus_reads_the_simulated_network_over_rtu() {
    check_field_units(&pymodbus_reads_field_units("rtu"));
}

#[test]
fn pymodbus_reads_the_simulated_network_over_ascii() {
    check_field_units(&pymodbus_reads_field_units("ascii"));
}

/// A device of pymodbus as the only unit of a multi-drop line; our backend polls it.
fn backend_polls_pymodbus(kind: &str, framing: Framing) {
    let (_cable, ours, theirs) = cable();
    let mut command = python();
    command.arg(script("server.py")).args([kind, &theirs]);
    let (_device, ()) = Process::start(&mut command, "see the peers", |line| {
        (line == "ready").then_some(())
    });
    let config = format!(
        "[[bus]]\nname = \"peer\"\nkind = \"ddc100\"\nshape = \"multi-drop\"\nport = \"{ours}\"\n\
         framing = \"{kind}\"\nregisters = \"5-16\"\n\n\
         [[device]]\ntag = \"P-6\"\nkind = \"ddc100-mx\"\nbus = \"peer\"\nunit = 6\n\n\
         [[device]]\ntag = \"P-7\"\nkind = \"ddc100-uec\"\nbus = \"peer\"\nunit = 7\n"
    );
    let file = std::env::temp_dir().join(format!(
        "valvescope-peer-ddc-{}-{kind}.toml",
        std::process::id()
    ));
    std::fs::write(&file, config).expect("a temporary file");
    let server = Server::start(&["--config", file.to_str().expect("a path in UTF-8")]);
    let mut page = Page::open(server.address(), "peer", framing);
    page.send(&ToBackend::Ddc(DdcAsk::Follow { bus: "peer".into() }));
    let mut seen = (None, None);
    page.network(|news| {
        if let DdcNews::Unit {
            unit,
            outcome,
            request,
            response,
            fault_a,
            fault_b,
            ..
        } = news
        {
            assert_eq!(fault_b, None, "there is one port");
            match unit {
                7 => seen.1 = Some((outcome, fault_a, request, response)),
                _ => seen.0 = Some((outcome, fault_a)),
            }
        }
        (seen.0.is_some() && seen.1.is_some()).then_some(())
    });
    // Nobody is there with address 6. (A server of pymodbus answers with exception 4 or not at all.)
    let absent = seen.0.expect("it was polled");
    assert_ne!(absent.0, Outcome::Ok);
    let want: Vec<u8> = (4..16)
        .flat_map(|a: u16| a.wrapping_mul(31).wrapping_add(7).to_be_bytes())
        .collect();
    let want = format!("0318{}", shared::render::hex(&want));
    let good = (Outcome::Ok, Some(false), "030004000C".to_owned(), want);
    assert_eq!(seen.1, Some(good));
    std::fs::remove_file(file).expect("it was there");
}

#[test]
fn our_backend_polls_pymodbus_as_a_field_unit_over_rtu() {
    backend_polls_pymodbus("rtu", Framing::Rtu);
}

#[test]
fn our_backend_polls_pymodbus_as_a_field_unit_over_ascii() {
    backend_polls_pymodbus("ascii", Framing::Ascii);
}
