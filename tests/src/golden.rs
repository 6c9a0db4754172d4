//! Golden cases: pasted text in, written expectations out.
//!
//! A case file is plain text. `# …` is a comment, `== …` begins a case and names its source,
//! `device …` and `as …` choose what the command line would choose, `> …` is the input. The other
//! lines are expectations, written by hand from the named source:
//!
//! | line | means |
//! |---|---|
//! | `0 request unit=3 function=1 ok pairs=1` | entry 0 is a sound request, answered by entry 1 |
//! | `1 noise offset=8 length=4` | entry 1 is noise there |
//! | `1 holding.3004 = 24.0 %` | the field with this path says so |
//! | `1 ! crc-mismatch 6+2` | problem at byte 6 of the entry, two bytes long |
//! | `0 text not-hex` | problem of the text itself |
//!
//! Warnings and errors that are not expected fail the case, and so does a tree whose leaves do not
//! tile its frame.

use shared::decode::{Context, decode_frame};
use shared::device::Device;
use shared::frame::{Frame, Framing, scan};
use shared::json;
use shared::problem::{Problem, Severity};
use shared::text::import;
use shared::tree::{Decoded, Field};
use shared::value::Value;

/// Name, cases and JSON lines of a case file.
macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../fixtures/", $name, ".txt")),
            include_str!(concat!("../fixtures/", $name, ".jsonl")),
        )
    };
}
/// The case files with their blessed JSON lines.
pub const FILES: [(&str, &str, &str); 9] = [
    file!("icon3000-manual"),
    file!("icon3000-values"),
    file!("icon3000-files"),
    file!("ddc100-guide"),
    file!("ddc100-values"),
    file!("modbus-application"),
    file!("bad-input"),
    file!("hart-frames"),
    file!("hart-commands"),
];

/// One case.
#[derive(Debug, Default)]
pub struct Case {
    /// Where it comes from.
    pub name: String,
    /// What is at the other end.
    pub device: Device,
    /// How frames are marked off, `None` to detect.
    pub framing: Option<Framing>,
    /// The pasted text.
    pub input: String,
    /// The expectations.
    pub expect: Vec<String>,
}

/// The cases of a file.
///
/// # Panics
///
/// If the file is not in the format.
#[must_use]
pub fn cases(text: &str) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for line in text
        .lines()
        .filter(|l| !l.is_empty() && !l.starts_with("# "))
    {
        if let Some(name) = line.strip_prefix("== ") {
            cases.push(Case {
                name: name.to_owned(),
                ..Case::default()
            });
            continue;
        }
        let case = cases.last_mut().expect("a case begins with ==");
        if let Some(device) = line.strip_prefix("device ") {
            case.device = Device::from_key(device).expect("a known device");
        } else if let Some(framing) = line.strip_prefix("as ") {
            case.framing = Framing::from_key(framing);
        } else if let Some(input) = line.strip_prefix("> ") {
            case.input.push_str(input);
            case.input.push('\n');
        } else {
            case.expect.push(line.to_owned());
        }
    }
    cases
}

/// A case decoded.
struct Run {
    framing: Framing,
    frames: Vec<Frame>,
    trees: Vec<Decoded>,
    text: Vec<shared::text::TextProblem>,
    total: u64,
}

fn run(case: &Case) -> Run {
    let input = import(case.input.as_bytes(), case.framing);
    let frames = scan(&input.bytes, input.framing);
    let context = Context {
        framing: input.framing,
        device: case.device,
    };
    let bytes = |f: &Frame| &input.bytes[f.offset as usize..f.end() as usize];
    let trees = frames
        .iter()
        .zip(0..)
        .map(|(frame, index)| {
            let request = frame
                .pair()
                .filter(|r| *r < index)
                .map(|r| bytes(&frames[r as usize]));
            decode_frame(frame, bytes(frame), request, &context)
        })
        .collect();
    let total = input.bytes.len() as u64;
    Run {
        framing: input.framing,
        frames,
        trees,
        text: input.problems,
        total,
    }
}

/// The JSON lines of a case, as the command line writes them.
#[must_use]
pub fn json_lines(case: &Case) -> String {
    let run = run(case);
    let mut out = String::new();
    for (index, (frame, tree)) in (0..).zip(run.frames.iter().zip(&run.trees)) {
        json::write_frame(&mut out, index, frame, run.framing, tree).expect("a string takes all");
        out.push('\n');
    }
    out
}

/// Compares a case with its expectations; the differences, empty if there are none.
#[must_use]
pub fn differences(case: &Case) -> Vec<String> {
    let run = run(case);
    let mut wrong = Vec::new();
    let mut expected: Vec<(usize, String)> = Vec::new();
    for line in &case.expect {
        let (index, rest) = line.split_once(' ').expect("an index and more");
        let index: usize = index.parse().expect("an index");
        if let Some(problem) = rest.strip_prefix("! ") {
            expected.push((index, problem.to_owned()));
        } else if let Some(code) = rest.strip_prefix("text ") {
            let code_of =
                |p: &shared::text::TextProblem| Problem::new(p.finding, Default::default()).code();
            if !run.text.iter().any(|p| code_of(p) == code) {
                wrong.push(format!("no text problem {code}"));
            }
        } else if let Some((path, text)) = rest.split_once(" = ") {
            match said(&run, index, path) {
                Some(said) if said == text => {}
                said => wrong.push(format!("{index} {path}: expected {text:?}, is {said:?}")),
            }
        } else {
            let is = summary(&run, index);
            let missing: Vec<_> = rest
                .split(' ')
                .filter(|w| !is.split(' ').any(|i| i == *w))
                .collect();
            if !missing.is_empty() {
                wrong.push(format!("{index}: expected {rest:?}, is {is:?}"));
            }
        }
    }
    let mut found: Vec<(usize, String)> = Vec::new();
    for (index, tree) in run.trees.iter().enumerate() {
        let bad = tree
            .problems()
            .iter()
            .filter(|p| p.severity() > Severity::Note);
        found.extend(bad.map(|p| {
            (
                index,
                format!("{} {}+{}", p.code(), p.place.start, p.place.len),
            )
        }));
        wrong.extend(untiled(tree).map(|t| format!("{index}: {t}")));
    }
    expected.sort();
    found.sort();
    if expected != found {
        wrong.push(format!("problems: expected {expected:?}, found {found:?}"));
    }
    let mut at = 0;
    for frame in &run.frames {
        if frame.offset != at {
            wrong.push(format!("a hole or overlap before byte {}", frame.offset));
        }
        at = frame.end();
    }
    if at != run.total {
        wrong.push(format!("{at} of {} bytes accounted for", run.total));
    }
    wrong
}

fn said(run: &Run, index: usize, path: &str) -> Option<String> {
    let tree = run.trees.get(index)?;
    let (_, field) = tree.iter().find(|(id, _)| tree.path(*id) == path)?;
    Some(tree.text(field))
}

fn summary(run: &Run, index: usize) -> String {
    let (Some(frame), Some(tree)) = (run.frames.get(index), run.trees.get(index)) else {
        return "nothing".to_owned();
    };
    let pair = frame
        .pair()
        .map(|p| format!(" pairs={p}"))
        .unwrap_or_default();
    let ok = if tree.is_ok() { "ok" } else { "error" };
    format!(
        "{} offset={} length={} unit={} function={} {ok}{pair}",
        frame.role.key(),
        frame.offset,
        frame.len,
        frame.unit,
        frame.function
    )
}

/// True for bits and other parts of a byte, which share it with the field around them.
fn is_part(field: &Field) -> bool {
    let is_bit = matches!(field.value, Value::Bit { .. }) && field.parent.is_some();
    is_bit || field.name.shares_bytes()
}

/// Says where the leaves of a tree do not tile its frame. Bits share the byte of their word.
fn untiled(tree: &Decoded) -> Option<String> {
    let mut owners = vec![0_u32; tree.bytes().len()];
    for (id, field) in tree.iter() {
        let has_parts = tree
            .iter()
            .any(|(_, f)| f.parent == Some(id) && !is_part(f));
        if has_parts || is_part(field) {
            continue;
        }
        for owner in owners.get_mut(field.place.range())? {
            *owner += 1;
        }
    }
    let at = owners.iter().position(|o| *o != 1)?;
    Some(format!("byte {at} belongs to {} leaves", owners[at]))
}
