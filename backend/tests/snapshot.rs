//! `valvescope snapshot` and `valvescope diff` as commands, against a simulated device in a process of
//! its own.

use serde_json::Value;
use shared::address::{Address, Table};
use shared::icon3000::snapshot::parse;
use shared::map::row::Model;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

const PROGRAM: &str = env!("CARGO_BIN_EXE_valvescope");

/// A simulated actuator. Dropping it ends it.
struct Simulated {
    child: Child,
    host: String,
}

impl Simulated {
    fn start(options: &[&str]) -> Self {
        let mut child = Command::new(PROGRAM)
            .args(["simulate", "--listen", "127.0.0.1:0"])
            .args(options)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let out = child.stdout.take().unwrap();
        BufReader::new(out).read_line(&mut line).unwrap();
        let host = line.trim().rsplit(' ').next().unwrap();
        let host = host.trim_start_matches("http://").trim_end_matches('/');
        Self {
            host: host.to_owned(),
            child,
        }
    }

    /// Writes a register with bytes of our own: transaction 7, FC 06.
    fn write_to(&self, unit: u8, register: u16, word: u16) {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        let mut request = vec![0, 7, 0, 0, 0, 6, unit, 6];
        request.extend(register.to_be_bytes());
        request.extend(word.to_be_bytes());
        stream.write_all(&request).unwrap();
        let mut echo = [0; 12];
        stream.read_exact(&mut echo).unwrap();
        assert_eq!(echo.as_slice(), request);
    }

    fn write(&self, register: u16, word: u16) {
        self.write_to(1, register, word);
    }

    /// Clears the commands, which stops the programme of the simulated valve for a minute.
    fn hold_still(&self) {
        self.write(3008, 0);
    }

    fn snapshot(&self, file: &Path, options: &[&str]) -> Output {
        let output = Command::new(PROGRAM)
            .args(["snapshot", "--host", &self.host, "--output"])
            .arg(file)
            .args(options)
            .output()
            .unwrap();
        assert!(output.stdout.is_empty());
        output
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        let _ended = self.child.kill();
        let _status = self.child.wait();
    }
}

/// A folder of a test. Dropping it removes it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = format!("valvescope-{name}-{}", std::process::id());
        let path = std::env::temp_dir().join(folder);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _gone = fs::remove_dir_all(&self.0);
    }
}

fn compare(first: &Path, second: Option<&Path>, options: &[&str]) -> Output {
    Command::new(PROGRAM)
        .arg("diff")
        .arg(first)
        .args(second)
        .args(options)
        .output()
        .unwrap()
}

fn code(output: &Output) -> i32 {
    output.status.code().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn json(output: &Output) -> Vec<Value> {
    let text = text(&output.stdout);
    text.lines()
        .map(|line| serde_json::from_str(line).unwrap())
        .collect()
}

/// Nothing changed, then the dead band (HR 3017, in tenths of a percent) from 1.0 to 1.5 %.
#[test]
fn two_snapshots_of_one_device() {
    let folder = Folder::new("two");
    let [first, second, third] = ["1", "2", "3"].map(|name| folder.file(name));
    let device = Simulated::start(&[]);
    device.hold_still();
    for file in [&first, &second] {
        let output = device.snapshot(file, &[]);
        let said = text(&output.stderr);
        assert_eq!(code(&output), 0, "{said}");
        assert!(said.contains("only an ICON3000v2"), "{said}");
        assert!(said.contains(" 0 parts could not be read"), "{said}");
    }
    let same = compare(&first, Some(&second), &[]);
    assert_eq!(code(&same), 0, "{}", text(&same.stdout));
    let lines: Vec<_> = text(&same.stdout).lines().map(str::to_owned).collect();
    assert!(
        lines.len() == 1 && lines[0].ends_with("--all shows them."),
        "{lines:?}"
    );
    let same = compare(&first, Some(&second), &["--format", "json"]);
    assert_eq!((code(&same), json(&same).len()), (0, 0));
    let itself = compare(&first, Some(&first), &["--all"]);
    assert_eq!(
        (code(&itself), text(&itself.stdout)),
        (0, "No difference.\n".into())
    );

    device.write(3017, 15);
    assert_eq!(code(&device.snapshot(&third, &[])), 0);
    let changed = compare(&second, Some(&third), &[]);
    assert_eq!(code(&changed), 1);
    let said = text(&changed.stdout);
    let lines: Vec<_> = said.lines().collect();
    assert_eq!(
        lines[..3],
        [
            "Configuration",
            "  Dead Band (holding.3017)",
            "    1.0 % → 1.5 %"
        ],
        "{said}"
    );
    assert_eq!(lines.len(), 4, "{said}");
    let changed = compare(&second, Some(&third), &["--format", "json"]);
    let lines = json(&changed);
    assert_eq!((code(&changed), lines.len()), (1, 1));
    for (key, value) in [
        ("kind", "change"),
        ("path", "holding.3017"),
        ("was", "1.0 %"),
        ("now", "1.5 %"),
    ] {
        assert_eq!(lines[0][key], value, "{}", lines[0]);
    }
    // Counters, clock and measurements too: each read is counted.
    let all = json(&compare(
        &second,
        Some(&third),
        &["--all", "--format", "json"],
    ));
    let paths: Vec<_> = all.iter().filter_map(|l| l["path"].as_str()).collect();
    for path in ["holding.3017", "counter.11", "counter.14"] {
        assert!(paths.contains(&path), "{paths:?}");
    }
}

/// The second side is the device itself.
#[test]
fn a_snapshot_and_the_device() {
    let folder = Folder::new("live");
    let first = folder.file("1");
    let device = Simulated::start(&["--unit", "9"]);
    let there = ["--host", &device.host, "--unit", "9", "--format", "json"];
    let output = device.snapshot(&first, &["--unit", "9"]);
    assert_eq!(code(&output), 0, "{}", text(&output.stderr));
    device.write_to(9, 3020, 40);
    let output = compare(&first, None, &there);
    let lines = json(&output);
    let delay: Vec<_> = lines
        .iter()
        .filter(|l| l["path"] == "holding.3020")
        .collect();
    assert_eq!((code(&output), delay.len()), (1, 1), "{lines:?}");
    assert_eq!(
        (&delay[0]["was"], &delay[0]["now"]),
        (&"0 s".into(), &"40 s".into())
    );
    for (second, options, said) in [
        (None, &[][..], "say what to compare with"),
        (Some(first.as_path()), &there[..2], "cannot be used with"),
        (None, &["--host", "127.0.0.1:1"], "127.0.0.1:1"),
    ] {
        let output = compare(&first, second, options);
        let why = text(&output.stderr);
        assert_eq!(code(&output), 2, "{why}");
        assert!(why.contains(said), "{why}");
        assert!(output.stdout.is_empty());
    }
}

#[test]
fn every_model_says_what_it_is() {
    let folder = Folder::new("models");
    for (model, name, files) in [
        ("icon2000v4", "ICON2000v4", false),
        ("icon3000", "ICON3000", false),
        ("icon3000v2", "ICON3000v2", true),
    ] {
        let device = Simulated::start(&["--device", model]);
        let file = folder.file(model);
        let output = device.snapshot(&file, &[]);
        assert_eq!(code(&output), 0, "{}", text(&output.stderr));
        let saved = fs::read_to_string(&file).unwrap();
        let head: Vec<_> = saved.lines().take(20).collect();
        let device_line = format!("\"device\": \"{model}\"");
        assert!(
            head.iter()
                .any(|l| l.replace("\":\"", "\": \"").contains(&device_line)),
            "{name}: {head:?}"
        );
        assert_eq!(saved.contains("\"file\":5300,"), files, "{name}");
        // It was asked, and the file says what it said.
        let guess = |file: &Path| parse(&fs::read(file).unwrap()).0.unwrap().guess;
        let said = guess(&file).unwrap();
        assert_eq!(said.model.map(Model::key), Some(model));
        assert!(text(&output.stderr).contains(&said.why), "{}", said.why);
        // Told which it is, it is not asked.
        let told = device.snapshot(&file, &["--kind", model]);
        assert_eq!(code(&told), 0, "{}", text(&told.stderr));
        assert_eq!(text(&told.stderr).lines().count(), 1);
        assert_eq!(guess(&file), None);
    }
    // Taken for a newer one, it refuses what it does not have: exit status 1, and a file all the
    // same.
    let device = Simulated::start(&["--device", "icon3000"]);
    let file = folder.file("wrong");
    let output = device.snapshot(&file, &["--kind", "icon3000v2"]);
    assert_eq!(code(&output), 1);
    assert!(fs::read_to_string(&file).unwrap().contains("exception 02"));
    // Nobody there: 2, and no file.
    let nobody = device.snapshot(&folder.file("none"), &["--unit", "77"]);
    assert_eq!(code(&nobody), 2, "{}", text(&nobody.stderr));
    assert!(!folder.file("none").exists());
}

#[test]
fn damaged_files_are_refused_or_said() {
    let folder = Folder::new("damaged");
    let good = folder.file("good");
    let device = Simulated::start(&[]);
    assert_eq!(code(&device.snapshot(&good, &[])), 0);
    let bad = folder.file("bad");
    for content in [&b""[..], b"{}", b"\xFF\xFE\x00", b"not a snapshot\n"] {
        fs::write(&bad, content).unwrap();
        for (a, b) in [(&good, &bad), (&bad, &good)] {
            let output = compare(a, Some(b), &[]);
            let why = text(&output.stderr);
            assert_eq!((code(&output), output.stdout.len()), (2, 0), "{why}");
            assert!(why.contains("bad is no snapshot"), "{why}");
        }
    }
    let missing = compare(&good, Some(&folder.file("gone")), &[]);
    assert_eq!(code(&missing), 2);
    assert!(text(&missing.stderr).contains("can't read"));
    // Half of it: what is there is compared, and what is wrong is said with its line.
    let whole = fs::read(&good).unwrap();
    fs::write(&bad, &whole[..whole.len() / 2]).unwrap();
    let half = compare(&good, Some(&bad), &[]);
    let why = text(&half.stderr);
    assert!(why.contains("bad: line "), "{why}");
    assert!(text(&half.stdout).contains("only in the first"));
}

/// Table 5: lost phase is bit 14 of HR 3010; table 39: record 108 is the result, 5 is T-RET.
#[test]
fn faults_are_there_from_the_start() {
    let folder = Folder::new("faults");
    let file = folder.file("1");
    let device = Simulated::start(&["--fault", "lost-phase", "--fault", "pst-return"]);
    assert_eq!(code(&device.snapshot(&file, &[])), 0);
    let (snapshot, problems) = parse(&fs::read(&file).unwrap());
    assert!(problems.is_empty());
    let snapshot = snapshot.unwrap();
    let word = |at| {
        snapshot
            .image
            .cell(Table::Holding, Address::new(at))
            .unwrap()
            .word
    };
    assert_eq!(word(3010), 1 << 14);
    assert_eq!(word(3090), 12, "the latest alarm is Lost Phase");
    assert_eq!(snapshot.files.get(3001).unwrap().get(108), Some(5));
    for (options, said) in [
        (&["--fault", "hunger"][..], "an ICON has: thermostat, "),
        (
            &["--device", "dop", "--fault", "lost-phase"],
            "--fault is for",
        ),
        (
            &["--device", "icon2000v4", "--fault", "pst-over-travel"],
            "--fault pst-over-travel shows in stroke tests",
        ),
    ] {
        refused(
            &[&["simulate", "--listen", "127.0.0.1:0"], options].concat(),
            said,
        );
    }
    for fault in ["lost-phase", "break-3"] {
        let options = [
            "simulate",
            "--hart",
            "pty",
            "--device",
            "rotork-iq",
            "--fault",
            fault,
        ];
        refused(&options, "not for --hart");
    }
    // An ICON3000 that comes back too slowly in a test says so: bits 9, 11 and 15 of HR 3009.
    let device = Simulated::start(&["--device", "icon3000", "--fault", "pst-return"]);
    assert_eq!(code(&device.snapshot(&file, &[])), 0);
    let old = parse(&fs::read(&file).unwrap()).0.unwrap();
    let warnings = old.image.cell(Table::Holding, Address::new(3009)).unwrap();
    assert_eq!(warnings.word, 0x8A00);
}

/// Runs the program; it must say this on standard error and do nothing.
fn refused(options: &[&str], said: &str) {
    let output = Command::new(PROGRAM).args(options).output().unwrap();
    let why = text(&output.stderr);
    assert_eq!((code(&output), output.stdout.len()), (2, 0), "{options:?}");
    assert!(why.contains(said), "{options:?}: {why}");
}

/// What an option says has an effect, or it is refused.
#[test]
fn options_without_effect_are_refused() {
    let said = "cannot be used with";
    for option in [
        &["--kind", "icon3000"][..],
        &["--unit", "3"],
        &["--baud", "9600"],
        &["--mode", "8E1"],
        &["--ascii"],
    ] {
        refused(
            &[&["snapshot", "--device", "XV-101"], option].concat(),
            said,
        );
        refused(
            &[&["diff", "a.json", "--device", "XV-101"], option].concat(),
            said,
        );
    }
    for option in [&["--baud", "9600"][..], &["--mode", "8E1"], &["--ascii"]] {
        refused(
            &[&["snapshot", "--host", "127.0.0.1:1"], option].concat(),
            said,
        );
    }
    for option in [&["--kind", "auto"][..], &["--unit", "3"]] {
        refused(&[&["diff", "a.json", "b.json"], option].concat(), said);
    }
}
