//! The command line against a simulated device in another process, over a pseudo terminal.

use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Output, Stdio};
use std::time::Instant;

const PROGRAM: &str = env!("CARGO_BIN_EXE_valvescope");
/// Eight times as fast as a real line.
const FAST: &str = "9600";
/// A real one: where others take turns with us, a busy computer has to keep up.
const REAL: &str = "1200";

/// A simulated device in a process of its own. Dropping it ends it.
struct Simulated {
    child: Child,
    path: String,
    baud: &'static str,
}

impl Simulated {
    fn start(baud: &'static str, options: &[&str]) -> Self {
        let mut child = Command::new(PROGRAM)
            .args(["simulate", "--hart", "pty", "--baud", baud])
            .args(options)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let out = child.stdout.take().unwrap();
        BufReader::new(out).read_line(&mut line).unwrap();
        let path = line.split_whitespace().nth(2).unwrap_or_default();
        assert!(path.starts_with("/dev/"), "{line}");
        let path = path.to_owned();
        Self { child, path, baud }
    }

    fn hart(&self, arguments: &[&str]) -> Output {
        let (verb, rest) = arguments.split_first().unwrap();
        Command::new(PROGRAM)
            .args(["hart", verb, "--port", &self.path, "--baud", self.baud])
            .args(rest)
            .output()
            .unwrap()
    }

    /// The lines of JSON, and the exit status.
    fn json(&self, arguments: &[&str]) -> (Vec<Value>, i32) {
        let output = self.hart(&[arguments, &["--format", "json"]].concat());
        let text = String::from_utf8(output.stdout).unwrap();
        let lines = text.lines().map(|l| serde_json::from_str(l).unwrap());
        (lines.collect(), output.status.code().unwrap())
    }
}

impl Drop for Simulated {
    fn drop(&mut self) {
        let _ended = self.child.kill();
        let _status = self.child.wait();
    }
}

fn responses(lines: &[Value]) -> Vec<&Value> {
    lines.iter().filter(|l| l["role"] == "response").collect()
}

fn field<'a>(frame: &'a Value, path: &str) -> &'a Value {
    let fields = frame["fields"].as_array().unwrap();
    let found = fields.iter().find(|f| f["path"] == path);
    found.unwrap_or_else(|| panic!("{path} is not in {frame}"))
}

#[test]
fn a_device_is_found_and_read() {
    let device = Simulated::start(
        FAST,
        &["--device", "rotork-iq", "--poll", "2", "--tag", "FV-401"],
    );
    let (lines, status) = device.json(&["scan", "--last", "4", "--retries", "0"]);
    assert_eq!((status, responses(&lines).len()), (0, 1));
    let found = responses(&lines)[0];
    assert_eq!(
        (&found["address"], &found["command"]),
        (&"02".into(), &0.into())
    );
    assert_eq!(found["ok"], true);

    let iq = ["--device", "rotork-iq"];
    let read = ["read", "--poll", "2", "3", "48", "523:0040", "131"];
    let (lines, status) = device.json(&[&read[..], &iq].concat());
    let answers = responses(&lines);
    let numbers: Vec<i64> = answers
        .iter()
        .filter_map(|a| a["command"].as_i64())
        .collect();
    assert_eq!((status, numbers), (0, vec![3, 48, 523, 131]));
    for answer in &answers {
        assert_eq!(
            (&answer["address"], &answer["ok"]),
            (&"2EDD012345".into(), &true.into())
        );
        assert!(!answer["pairs_with"].is_null());
    }
    // Secondary master, and all four variables of an IQ.
    assert_eq!(answers[0]["master"], "secondary");
    field(answers[0], "command.3.pv");
    field(answers[1], "command.48.byte_0");

    let (lines, status) = device.json(&["identify", "--tag", "fv-401", "--master", "primary"]);
    let answer = responses(&lines)[0];
    assert_eq!((status, &answer["command"]), (0, &11.into()));
    assert_eq!(answer["master"], "primary");
    let (lines, status) = device.json(&["identify", "--tag", "FV-402", "--retries", "0"]);
    assert_eq!((status, responses(&lines).len()), (1, 0));

    // Everything at once, as text.
    let output = device.hart(&[&["read", "--address", "AEDD012345"][..], &iq].concat());
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{text}");
    let total = text.lines().last().unwrap();
    let (answered, all) = total.split_once(" of ").unwrap();
    assert!(
        all.starts_with(&format!("{answered} ")) && answered.len() == 2,
        "{total}"
    );
    for words in ["command 3 ", "Category 39", "2EDD012345"] {
        assert!(
            text.to_lowercase().contains(&words.to_lowercase()),
            "{words}: {text}"
        );
    }
}

#[test]
fn troubles_of_the_line_are_survived() {
    let trouble = [
        "--damaged",
        "1",
        "--late",
        "1",
        "--echo",
        "--burst",
        "--second-master",
    ];
    let device = Simulated::start(REAL, &trouble);
    let (lines, status) = device.json(&["read", "--master", "primary", "--retries", "6", "3", "2"]);
    assert_eq!(status, 0, "{lines:?}");
    assert_eq!(responses(&lines).len(), 2);
    let busy = Simulated::start(FAST, &["--busy", "2", "--inject", "0.1"]);
    let (lines, _) = busy.json(&["read", "12"]);
    let answer = responses(&lines)[0];
    // Busy is an answer.
    assert_eq!(field(answer, "response_code")["value"], 32, "{answer}");
}

/// The rate of a line at real pace, between two processes. It is printed and not judged: a busy
/// machine is late. In simulated time it is held by `polling_reaches_the_rate_of_the_line` of the
/// link layer and by `a_watch_goes_at_the_rate_of_the_line`.
#[test]
fn the_rate_of_command_3_is_measured() {
    const READS: usize = 16;
    let device = Simulated::start(REAL, &["--device", "rotork-iq"]);
    let mut reader = Command::new(PROGRAM)
        .args(["hart", "read", "--port", &device.path, "--format", "json"])
        .args(["--master", "primary"])
        .args(["3"; READS])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let lines = BufReader::new(reader.stdout.take().unwrap()).lines();
    // Each line comes when its exchange is over.
    let mut moments = Vec::new();
    for line in lines {
        let line: Value = serde_json::from_str(&line.unwrap()).unwrap();
        if line["role"] == "response" && line["command"] == 3 {
            moments.push(Instant::now());
        }
    }
    assert!(reader.wait().unwrap().success());
    assert_eq!(moments.len(), READS);
    let took = moments[READS - 1] - moments[0];
    let each = took.as_secs_f64() * 1000.0 / (READS - 1) as f64;
    // 66 characters of 11 bits: RT2, request, turn of the device, reply.
    let ideal = 66.0 * 11.0 * 1000.0 / 1200.0;
    println!(
        "command 3 at 1200 bit/s: {each:.1} ms each, ideal {ideal:.1} ms, {:.1} % of the line",
        ideal / each * 100.0
    );
    // Nobody can be faster than the line; timers of the machine are a little apart.
    assert!(each > ideal - 10.0, "{each} ms");
}

#[test]
fn what_is_no_read_is_refused_before_the_line_is_opened() {
    for (command, words) in [
        ("132:22", "may move the valve"),
        ("48:00", "no read"),
        ("6:0000", "changes the configuration"),
        ("700", "not known"),
        ("x", "write a number"),
        ("9:00112233445566778899", "no read"),
    ] {
        let output = Command::new(PROGRAM)
            .args(["hart", "read", "--port", "/dev/null/none", command])
            .output()
            .unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.contains(words), "{said}");
    }
    let output = Command::new(PROGRAM)
        .args(["hart", "scan", "--port", "/dev/does-not-exist"])
        .output()
        .unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(said.contains("plug the adapter in"), "{said}");
}
