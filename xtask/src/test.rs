//! `cargo xtask test`: everything that must hold before a change goes in.
//!
//! # Which test runs where
//!
//! | what | where it lies | how it runs |
//! |---|---|---|
//! | unit tests | beside the code | natively |
//! | golden files, properties, the bridge | `tests/tests/*.rs` | natively |
//! | the page and `shared` in a browser | `frontend/tests/wasm_*.rs`, `tests/tests/wasm_*.rs` | headless, as wasm |
//! | other implementations as peers | `tests/tests/peers.rs`, `hart_peers.rs`, feature `peers` | natively |
//! | end to end | `tests/tests/e2e/`, feature `browser` | the built binary and a browser |
//!
//! A file `wasm_*.rs` begins with `#![cfg(target_arch = "wasm32")]`, so that it is empty natively.

pub mod browser;
mod peers;
mod report;

use crate::toolchain::{self, WASM};
use crate::{Result, shell, size, tidy, web};
use report::Report;
use std::process::Command;

/// The packages whose native tests run together; always this selection, so that cargo unifies
/// features once and compiles each dependency once. xtask shares nothing with them.
const NATIVE: [&str; 5] = [
    "--workspace",
    "--exclude",
    "xtask",
    "--features",
    "frontend/hart,frontend/icon",
];

/// Runs every step, stops at the first that fails, and prints the sum as the last line.
pub fn test() -> Result {
    let mut report = Report::new();
    let result = steps(&mut report);
    report.finish(result.as_ref().err());
    // Nothing may follow the sum, so the error is told by the report.
    result.map_err(|_| "".into())
}

fn steps(report: &mut Report) -> Result {
    report.step("tidy", |_| {
        toolchain::ensure_checkers()?;
        tidy::tidy()
    })?;
    report.step("clippy and page", |_| {
        toolchain::ensure_wasm_target()?;
        side_by_side(lint, || size::size(&web::web()?))
    })?;
    report.step("native tests", |log| {
        log.run_tests("native", &mut native("test", &["--no-fail-fast"]))?;
        log.run_tests("xtask", &mut shell::cargo(["test", "-p", "xtask"]))
    })?;
    let browser = report.step("browser", |_| browser::ensure())?;
    report.step("tests in the browser", |log| {
        let packages = [
            "test", "-p", "frontend", "-p", "tests", "--test", "wasm_*", "--target", WASM,
        ];
        let mut command = shell::cargo(packages);
        log.run_tests("wasm", browser.environment(command.arg("--no-fail-fast")))
    })?;
    let peers = report.step("peers", |_| peers::ensure())?;
    report.step("tests against peers", |log| {
        shell::run(&mut native("build", &binary_and_its_tests()))?;
        PEERS
            .iter()
            .try_for_each(|test| log.run_tests(test, peers.environment(&mut with_binary(test))))
    })?;
    report.step("end to end", |log| {
        let mut command = with_binary(END_TO_END);
        command.args(["--", BROWSERS]);
        log.run_tests(END_TO_END, browser.environment(&mut command))
    })
}

/// Clippy over everything, natively and as wasm.
fn lint() -> Result {
    clippy(&["--workspace", "--all-targets", "--all-features"])?;
    clippy(&[
        "-p", "shared", "-p", "frontend", "-p", "tests", "--lib", "--bins", "--test", "wasm_*",
        "--target", WASM,
    ])
}

/// Does two things at the same time. The linker of the page keeps one core busy for most of its
/// time, and cargo locks the folders of its profile only.
fn side_by_side(one: fn() -> Result, other: fn() -> Result) -> Result {
    let told = |result: Result| result.map_err(|error| error.to_string());
    let (one, other) = std::thread::scope(|scope| {
        let one = scope.spawn(|| told(one()));
        let other = told(other());
        (one.join(), other)
    });
    one.unwrap_or_else(|_| Err("the thread panicked; see above".into()))
        .and(other)
        .map_err(Into::into)
}

/// A cargo verb over the packages tested natively.
fn native(verb: &str, args: &[&str]) -> Command {
    let mut command = shell::cargo([verb]);
    command.args(NATIVE).args(args);
    command
}

/// Tests against other implementations.
const PEERS: [&str; 2] = ["peers", "hart_peers"];

/// The tests of the binary with a browser.
const END_TO_END: &str = "e2e";

/// How many browsers run side by side: they wait for most of the time.
const BROWSERS: &str = "--test-threads=4";

/// Selects the binary together with the tests that start it: without a test among the targets,
/// cargo would leave out the dev-dependencies, unify other features and compile most of it again.
fn binary_and_its_tests() -> Vec<&'static str> {
    let mut args = vec!["--bin", "valvescope", "--features", BINARY_FEATURES];
    let tests = PEERS.into_iter().chain([END_TO_END]);
    args.extend(tests.flat_map(|test| ["--test", test]));
    args
}

/// The features of those tests; the same for both, so that the helpers compile once.
const BINARY_FEATURES: &str = "tests/peers,tests/browser";

/// One of the tests that start the binary.
fn with_binary(test: &str) -> Command {
    let mut command = native("test", &["--features", BINARY_FEATURES, "--test", test]);
    let binary = shell::target_dir().join("debug/valvescope");
    command.env("VALVESCOPE_BIN", binary);
    command
}

/// Clippy, where every warning counts.
fn clippy(args: &[&str]) -> Result {
    let mut command = shell::cargo(["clippy"]);
    shell::run(command.args(args).args(["--", "-D", "warnings"]))
}
