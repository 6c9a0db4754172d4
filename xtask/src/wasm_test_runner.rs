//! Runs one compiled wasm test in a browser. Cargo calls this, see `.cargo/config.toml`.

use crate::Result;
use wasm_bindgen_cli::wasm_bindgen_test_runner;

/// Hands over to the runner of wasm-bindgen, whose version is the one in the lock file.
pub fn run(args: &[String]) -> Result {
    let name = "wasm-bindgen-test-runner".to_owned();
    let args = std::iter::once(name).chain(args.iter().cloned());
    wasm_bindgen_test_runner::run_cli_with_args(args).map_err(|error| format!("{error:?}").into())
}
