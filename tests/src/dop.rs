//! Cases of diagnostic objects: registers in, written expectations out.
//!
//! The format is that of [`golden`](crate::golden): `# …` is a comment, `== …` begins a case and
//! names its source, `request 0x1001` is the request word, `profile {…}` sets what a site would
//! set, `error` says that the status was Error, `> …` are registers. The other lines are
//! expectations:
//!
//! | line | means |
//! |---|---|
//! | `dop.1.max[3] @7 = -5 mG` | the field with this path begins at register 7 and says so |
//! | `why vibration_trend_24` | this layout was chosen |
//! | `! odd-time @0+4` | problem of this kind at register 0, four registers long |
//!
//! Warnings and errors that are not expected fail the case, and so do leaves that do not tile the
//! registers.

use shared::dop::{ObjectRead, Profile, Request, export, input};
use shared::problem::Severity;
use shared::tree::{Decoded, Name};

/// Name and cases of a case file.
macro_rules! file {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../fixtures/dop/", $name, ".txt")),
        )
    };
}
/// The case files.
pub const FILES: [(&str, &str); 7] = [
    file!("vibration"),
    file!("position"),
    file!("torque"),
    file!("environment"),
    file!("operation"),
    file!("logs"),
    file!("odd"),
];

/// The JSON lines of one of the [`FILES`], as the native build wrote them: the one whose objects
/// have values of every type.
pub const BLESSED: (&str, &str) = ("operation", include_str!("../fixtures/dop/operation.jsonl"));

/// The cases of the file with blessed lines, as the command line prints them now.
#[must_use]
pub fn blessed_now() -> String {
    let file = FILES.iter().filter(|(name, _)| *name == BLESSED.0);
    let cases = file.flat_map(|(_, text)| cases(text));
    cases.map(|case| json_line(&case)).collect()
}

/// One case.
#[derive(Clone, Debug, Default)]
pub struct Case {
    /// Where it comes from.
    pub name: String,
    /// The request word.
    pub request: u16,
    /// The profile as JSON, empty for none.
    pub profile: String,
    /// True if the status was Error.
    pub error: bool,
    /// The registers.
    pub words: Vec<u16>,
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
        if let Some(word) = line.strip_prefix("request 0x") {
            case.request = u16::from_str_radix(word, 16).expect("a request word");
        } else if let Some(profile) = line.strip_prefix("profile ") {
            profile.clone_into(&mut case.profile);
        } else if line == "error" {
            case.error = true;
        } else if let Some(words) = line.strip_prefix("> ") {
            let words = input::read(words, Some(input::Form::Hex)).words;
            case.words.extend(words);
        } else {
            case.expect.push(line.to_owned());
        }
    }
    cases
}

impl Case {
    /// The case decoded.
    ///
    /// # Panics
    ///
    /// If its profile has mistakes.
    #[must_use]
    pub fn read(&self) -> ObjectRead {
        let profile = match self.profile.as_str() {
            "" => Profile::default(),
            text => Profile::from_json(text).expect("a sound profile"),
        };
        let request = Request::from_word(self.request);
        if self.error {
            ObjectRead::error(request, &self.words, &profile)
        } else {
            ObjectRead::read(request, &self.words, &profile)
        }
    }
}

/// What differs from the expectations of a case.
#[must_use]
pub fn differences(case: &Case) -> Vec<String> {
    let read = case.read();
    let tree = &read.decoded;
    let mut wrong = Vec::new();
    let mut expected_problems = Vec::new();
    for line in &case.expect {
        if let Some(layout) = line.strip_prefix("why ") {
            let chosen = read.layout.map(|l| l.key);
            if chosen != Some(layout) {
                wrong.push(format!("layout {chosen:?}, not {layout}: {}", read.why));
            }
        } else if let Some(problem) = line.strip_prefix("! ") {
            expected_problems.push(problem.to_owned());
        } else if let Some(found) = field_differs(tree, line) {
            wrong.push(found);
        }
    }
    for problem in tree.problems() {
        let place = problem.place;
        let found = format!("{} @{}+{}", problem.code(), place.start / 2, place.len / 2);
        if let Some(at) = expected_problems.iter().position(|p| *p == found) {
            expected_problems.remove(at);
        } else if problem.severity() > Severity::Note {
            wrong.push(format!("problem {found}: {problem}"));
        }
    }
    wrong.extend(expected_problems.iter().map(|p| format!("no problem {p}")));
    if let Err(owners) = tiles(tree) {
        wrong.push(format!("leaves do not tile: {owners}"));
    }
    wrong
}

/// `PATH @REGISTER = TEXT` against the tree.
fn field_differs(tree: &Decoded, line: &str) -> Option<String> {
    let Some((place, text)) = line.split_once(" = ") else {
        return Some(format!("cannot read {line:?}"));
    };
    let (path, at) = place.split_once(" @").unwrap_or((place, ""));
    let found = tree.iter().find(|(id, _)| tree.path(*id) == path);
    let Some((_, field)) = found else {
        return Some(format!("no field {path}"));
    };
    let (says, starts) = (tree.text(field), (field.place.start / 2).to_string());
    (says != text || starts != at).then(|| format!("{path} @{starts} = {says}, expected {line}"))
}

/// Every byte belongs to exactly one leaf; bits share the bytes of their word.
///
/// # Errors
/// Which byte does not, and how many leaves it has.
pub fn tiles(tree: &Decoded) -> Result<(), String> {
    let mut owners = vec![0_u32; tree.bytes().len()];
    for (id, field) in tree.iter() {
        let bit = matches!(field.name, Name::DopBit(..));
        let group = tree
            .iter()
            .any(|(_, f)| f.parent == Some(id) && !matches!(f.name, Name::DopBit(..)));
        if !group && !bit {
            let bytes = owners
                .get_mut(field.place.range())
                .ok_or_else(|| format!("{} is outside", tree.path(id)))?;
            bytes.iter_mut().for_each(|owner| *owner += 1);
        }
    }
    match owners.iter().position(|owner| *owner != 1) {
        None => Ok(()),
        Some(at) => Err(format!("byte {at} has {} leaves", owners[at])),
    }
}

/// The case as the command line prints it.
///
/// # Panics
///
/// If writing to memory fails, which it does not.
#[must_use]
pub fn json_line(case: &Case) -> String {
    let mut line = String::new();
    export::write_object(&mut line, 0, &case.read()).expect("writing to a String");
    line.push('\n');
    line
}
