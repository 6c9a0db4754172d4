//! The verbs of the laboratory: `bless`, `bench`, `fuzz`, `soak`.

use crate::toolchain::{self, WASM};
use crate::{Result, shell, test};

/// Rewrites the expected output of the golden tests. Look at the difference before committing it.
pub fn bless() -> Result {
    shell::run(
        shell::cargo(["test", "-p", "tests", "--test", "golden", "--test", "dop"])
            .env("BLESS", "1"),
    )?;
    shell::run(&mut shell::program(
        "git",
        ["status", "--short", "tests/fixtures"],
    ))
}

/// Measures native code with criterion, then the same work in a browser.
pub fn bench() -> Result {
    shell::run(&mut shell::cargo(["bench", "-p", "tests"]))?;
    toolchain::ensure_wasm_target()?;
    let browser = test::browser::ensure()?;
    let args = [
        "test",
        "-p",
        "tests",
        "--release",
        "--features",
        "bench",
        "--target",
        WASM,
    ];
    let mut command = shell::cargo(args);
    command.args(["--test", "bench_browser", "--", "--nocapture"]);
    shell::run(browser.environment(&mut command))
}

/// Polls DDC-100 networks of all shapes with random troubles for some hours of simulated time, and
/// holds that no certain finding is wrong.
pub fn soak(hours: Option<&str>) -> Result {
    let hours: u32 = hours
        .unwrap_or("24")
        .parse()
        .map_err(|_| "usage: cargo xtask soak [hours]")?;
    let args = ["test", "-p", "tests", "--release", "--test", "ddc100_soak"];
    let mut command = shell::cargo(args);
    command.env("DDC100_SOAK_HOURS", hours.to_string());
    shell::run(command.args(["--", "--nocapture"]))
}

/// Fuzzes each target for some seconds.
pub fn fuzz(seconds: Option<&str>) -> Result {
    let seconds: u32 = seconds
        .unwrap_or("60")
        .parse()
        .map_err(|_| "usage: cargo xtask fuzz [seconds]")?;
    if !shell::succeeds(&mut nightly(&["--version"])) {
        return Err(
            "fuzzing needs the nightly compiler and cargo-fuzz; install them with\n  \
            rustup toolchain install nightly\n  cargo install cargo-fuzz --locked"
                .into(),
        );
    }
    let targets = shell::capture(&mut nightly(&["list", "--fuzz-dir", "tests/fuzz"]))?;
    for target in targets.lines().filter(|line| !line.is_empty()) {
        println!("fuzzing {target} for {seconds} s");
        let limit = format!("-max_total_time={seconds}");
        shell::run(&mut nightly(&[
            "run",
            "--fuzz-dir",
            "tests/fuzz",
            target,
            "--",
            &limit,
        ]))?;
    }
    Ok(())
}

/// cargo-fuzz under the nightly compiler. `rustup run`, because `cargo +nightly` does not work
/// below a cargo that rustup has already chosen.
fn nightly(args: &[&str]) -> std::process::Command {
    let mut command = shell::program("rustup", ["run", "nightly", "cargo", "fuzz"]);
    command.args(args).env_remove("CARGO").env_remove("RUSTC");
    command
}
