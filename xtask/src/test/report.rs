//! The steps of a test run: what they took, and what they counted.

use crate::{Error, Result, shell};
use std::fmt;
use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Tests that passed and failed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Tally {
    passed: u64,
    failed: u64,
}

impl Tally {
    /// Reads a line such as `test result: ok. 5 passed; 0 failed; 0 ignored; …`.
    fn from_line(line: &str) -> Option<Self> {
        let (_, counts) = line
            .trim()
            .strip_prefix("test result: ")?
            .split_once(". ")?;
        let count = |what: &str| {
            let mut parts = counts.split("; ").filter_map(|part| part.split_once(' '));
            parts.find(|(_, name)| *name == what)?.0.parse().ok()
        };
        Some(Self {
            passed: count("passed")?,
            failed: count("failed")?,
        })
    }

    fn add(&mut self, other: Self) {
        self.passed += other.passed;
        self.failed += other.failed;
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} passed, {} failed", self.passed, self.failed)
    }
}

/// What a step counts while it runs.
#[derive(Default)]
pub struct Log {
    tally: Tally,
}

impl Log {
    /// Runs a command that runs tests, adds up its results, and fails if it fails.
    ///
    /// Lines of tests that passed are left out here; `target/test-logs/<name>.log` has them all.
    pub fn run_tests(&mut self, name: &str, command: &mut Command) -> Result {
        let logs = shell::target_dir().join("test-logs");
        fs::create_dir_all(&logs)?;
        let path = logs.join(format!("{name}.log"));
        let mut log = fs::File::create(&path)?;
        let mut child = command.stdout(Stdio::piped()).spawn()?;
        let output = child.stdout.take().ok_or("no output")?;
        for line in BufReader::new(output).lines() {
            // A test may print what is not UTF-8; that line is lost, the run is not.
            let line = line.unwrap_or_default();
            writeln!(log, "{line}")?;
            if let Some(tally) = Tally::from_line(&line) {
                self.tally.add(tally);
            }
            if is_news(&line) {
                println!("{line}");
            }
        }
        if child.wait()?.success() {
            return Ok(());
        }
        Err(format!(
            "`{}` failed; its output is in {}",
            shell::line(command),
            path.display()
        )
        .into())
    }
}

/// False for the lines that say only that all is well.
fn is_news(line: &str) -> bool {
    let passed =
        line.starts_with("test ") && (line.ends_with(" ... ok") || line.ends_with(" ... ignored"));
    let counted = line.starts_with("running ") && line.trim_end_matches('s').ends_with(" test");
    let empty = line.is_empty() || counted || line.starts_with("test result: ok. 0 passed");
    !passed && !empty
}

/// One step that has ended.
struct Ended {
    name: &'static str,
    took: Duration,
    tally: Tally,
    good: bool,
}

/// All steps so far.
#[derive(Default)]
pub struct Report {
    ended: Vec<Ended>,
}

impl Report {
    /// A report without steps.
    pub fn new() -> Self {
        Self::default()
    }

    /// Runs a step and prints how long it took.
    pub fn step<T>(
        &mut self,
        name: &'static str,
        run: impl FnOnce(&mut Log) -> Result<T>,
    ) -> Result<T> {
        println!("\n━━ {name}");
        let start = Instant::now();
        let mut log = Log::default();
        let result = run(&mut log);
        let good = result.is_ok();
        let mut tally = log.tally;
        if !good && tally.failed == 0 {
            tally.failed = 1; // the step itself: it did not compile, or a tool is missing
        }
        let took = start.elapsed();
        println!(
            "━━ {name}: {}, {:.1} s",
            if good { "good" } else { "FAILED" },
            took.as_secs_f64()
        );
        self.ended.push(Ended {
            name,
            took,
            tally,
            good,
        });
        result.map_err(|error| format!("{name}: {error}").into())
    }

    /// Prints the steps, the error that ended them, and the sum alone on the last line.
    pub fn finish(&self, error: Option<&Error>) {
        println!();
        for Ended {
            name,
            took,
            tally,
            good,
        } in &self.ended
        {
            let mark = if *good { "good  " } else { "FAILED" };
            println!("{mark} {name:<22} {:>6.1} s  {tally}", took.as_secs_f64());
        }
        if let Some(error) = error {
            println!("\nerror: {error}");
        }
        println!("\n{}", self.sum());
    }

    fn sum(&self) -> Tally {
        let mut sum = Tally::default();
        self.ended.iter().for_each(|step| sum.add(step.tally));
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn result_lines_are_counted() {
        let line = "test result: FAILED. 12 passed; 3 failed; 0 ignored; 0 measured; 0 filtered out; finished in 0.1s";
        assert_eq!(
            Tally::from_line(line),
            Some(Tally {
                passed: 12,
                failed: 3
            })
        );
        assert_eq!(
            Tally::from_line("test result: ok. 1 passed; 0 failed").map(|t| t.passed),
            Some(1)
        );
        assert_eq!(Tally::from_line("test a::b ... ok"), None);
        assert_eq!(Tally::from_line("running 3 tests"), None);
    }

    #[test]
    fn only_news_is_printed() {
        assert!(!is_news("test a::b ... ok"));
        assert!(!is_news("running 0 tests"));
        assert!(!is_news("running 1 test"));
        assert!(is_news("running out of patience"));
        assert!(is_news("test a::b ... FAILED"));
        assert!(is_news("test result: ok. 2 passed; 0 failed"));
        assert!(is_news("thread 'a' panicked"));
    }

    #[test]
    fn a_step_that_fails_counts() {
        let mut report = Report::new();
        report.step("good", |_| Ok(())).unwrap();
        assert!(
            report
                .step::<()>("bad", |_| Err("no".into()))
                .unwrap_err()
                .to_string()
                .contains("bad: no")
        );
        assert_eq!(
            report.sum(),
            Tally {
                passed: 0,
                failed: 1
            }
        );
    }
}
