//! `cargo xtask`: what cargo cannot express. Run `cargo xtask help` for the verbs.
//!
//! Each verb is a short function in a module of its own name. A verb that fails says what to do
//! next; nothing here needs a tool that is not locked with the rest, except the browser and the
//! peers of the tests, which `test` installs by apt where it may.

mod apt;
mod lab;
mod serve;
mod shell;
mod size;
mod test;
mod tidy;
mod toolchain;
mod wasm_test_runner;
mod web;

use std::process::ExitCode;

/// What a verb failed with, written for the person at the terminal.
type Error = Box<dyn std::error::Error>;

/// The outcome of a verb or of a part of it.
type Result<T = ()> = std::result::Result<T, Error>;

const HELP: &str = "\
cargo xtask <verb>

  serve [options]   build everything and open the page; options go to `valvescope serve`
  test              everything: tidy, clippy, native, browser, peers, end to end
  web               build the page into static/dist
  size              build the page and hold its compressed size against the bar
  tidy              the checks that neither rustc nor clippy makes
  bless             rewrite the expected output of the golden tests
  bench             native and browser benchmarks
  fuzz [seconds]    fuzz each target for so long (default 60)
  soak [hours]      DDC-100 networks polled for so long in simulated time (default 24)
  help              this text
";

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let verb = args.next();
    let rest: Vec<String> = args.collect();
    match run(verb.as_deref(), &rest) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // An error without words has been told already.
            let words = error.to_string();
            if !words.is_empty() {
                eprintln!("error: {words}");
            }
            ExitCode::FAILURE
        }
    }
}

/// Runs one verb.
fn run(verb: Option<&str>, rest: &[String]) -> Result {
    match verb {
        Some("serve") => serve::serve(rest),
        Some("test") => test::test(),
        Some("web") => web::web().map(drop),
        Some("size") => size::size(&web::web()?),
        Some("tidy") => tidy::tidy(),
        Some("bless") => lab::bless(),
        Some("bench") => lab::bench(),
        Some("fuzz") => lab::fuzz(rest.first().map(String::as_str)),
        Some("soak") => lab::soak(rest.first().map(String::as_str)),
        // Called by cargo for every wasm test; not for people, so not in the help.
        Some("wasm-test-runner") => wasm_test_runner::run(rest),
        Some("help" | "--help" | "-h") => {
            print!("{HELP}");
            Ok(())
        }
        None => Err(format!("no verb given\n\n{HELP}").into()),
        Some(other) => Err(format!("unknown verb `{other}`\n\n{HELP}").into()),
    }
}
