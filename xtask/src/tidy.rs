//! `cargo xtask tidy`: what neither rustc nor clippy checks.
//!
//! Each rule is a pure function from a file to its [`Problem`]s, so that it is tested without a
//! tree of files; this module finds the files and prints what was found.

mod licences;
mod manifest;
mod purity;
mod source;
mod text;

use crate::{Result, shell};
use std::fmt;

/// Something that a rule found.
#[derive(Debug, PartialEq, Eq)]
struct Problem {
    /// The file, from the root of the workspace.
    path: String,
    /// The line, counted from one; zero for the file as a whole.
    line: usize,
    /// What is wrong and what to do.
    what: String,
    /// A warning does not fail the run.
    warning: bool,
}

impl Problem {
    /// Something that must not go in.
    fn error(path: &str, line: usize, what: impl Into<String>) -> Self {
        Self {
            path: path.to_owned(),
            line,
            what: what.into(),
            warning: false,
        }
    }

    /// Something to look at.
    fn warning(path: &str, line: usize, what: impl Into<String>) -> Self {
        Self {
            warning: true,
            ..Self::error(path, line, what)
        }
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.warning { "warning: " } else { "" };
        write!(f, "{}:{}: {kind}{}", self.path, self.line, self.what)
    }
}

/// Runs every rule over every file that git tracks or would track.
pub fn tidy() -> Result {
    let mut problems = manifest::missing_files(shell::root());
    for path in files()? {
        // A file removed but still in git's index, or one that is not text.
        let Ok(text) = std::fs::read_to_string(shell::root().join(&path)) else {
            continue;
        };
        problems.extend(check(&path, &text));
    }
    problems.extend(licences::check()?);
    problems.extend(unformatted()?);
    problems.iter().for_each(|problem| println!("{problem}"));
    match problems.iter().filter(|problem| !problem.warning).count() {
        0 => Ok(()),
        count => Err(format!("{count} problem(s) of tidiness, see above").into()),
    }
}

/// The files that rustfmt would change.
fn unformatted() -> Result<Vec<Problem>> {
    // It fails when it lists a file, so its status says nothing new.
    let output = shell::cargo(["fmt", "--all", "--check", "--", "-l"]).output()?;
    if !output.status.success() && output.stdout.is_empty() {
        let what = format!(
            "cargo fmt: {}",
            String::from_utf8_lossy(&output.stderr).trim()
        );
        return Ok(vec![Problem::error("Cargo.toml", 0, what)]);
    }
    let list = String::from_utf8_lossy(&output.stdout);
    let name = |path: &str| {
        let path = std::path::Path::new(path);
        path.strip_prefix(shell::root())
            .unwrap_or(path)
            .display()
            .to_string()
    };
    Ok(list
        .lines()
        .map(|path| Problem::error(&name(path), 0, "run `cargo fmt --all`"))
        .collect())
}

/// The files of the repository, new ones included and ignored ones left out.
fn files() -> Result<Vec<String>> {
    let args = ["ls-files", "--cached", "--others", "--exclude-standard"];
    let list = shell::capture(&mut shell::program("git", args))?;
    Ok(list.lines().map(str::to_owned).collect())
}

/// Everything that is wrong with one file.
fn check(path: &str, text: &str) -> Vec<Problem> {
    let mut problems = text::check(path, text);
    if path.ends_with(".rs") {
        problems.extend(source::check(path, text));
        problems.extend(purity::check(path, text));
    }
    if path == "Cargo.toml" {
        problems.extend(manifest::unsorted(path, text));
    }
    problems
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_problem_names_its_place() {
        let problem = Problem::warning("a.rs", 3, "long");
        assert_eq!(problem.to_string(), "a.rs:3: warning: long");
    }
}
