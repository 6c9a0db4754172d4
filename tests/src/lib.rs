//! Helpers of the tests: the binary as a process, a browser that drives it, the peers.
//!
//! `cargo xtask test` says which test lies where (see `xtask/src/test.rs`) and sets the
//! environment that these helpers read:
//!
//! | variable | what | without it |
//! |---|---|---|
//! | `VALVESCOPE_BIN` | the built `valvescope` | `target/debug/valvescope` |
//! | `CHROMEDRIVER` | the driver of the browser | `chromedriver` |
//! | `CHROMIUM` | the browser itself | what the driver finds |
//! | `PEERS_PYTHON` | a Python with pymodbus | `target/peers/bin/python` |

#[cfg(all(feature = "browser", not(target_arch = "wasm32")))]
pub mod browser;
#[cfg(not(target_arch = "wasm32"))]
pub mod ddc100;
pub mod dop;
pub mod golden;
pub mod load;
#[cfg(all(feature = "peers", not(target_arch = "wasm32")))]
pub mod page;
#[cfg(all(feature = "peers", not(target_arch = "wasm32")))]
pub mod peers;
#[cfg(not(target_arch = "wasm32"))]
pub mod process;
#[cfg(not(target_arch = "wasm32"))]
pub mod registers;
#[cfg(not(target_arch = "wasm32"))]
pub mod server;

use std::path::{Path, PathBuf};

/// A file or folder below `tests/fixtures`.
#[must_use]
pub fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("fixtures")
        .join(name)
}

/// The folder of cargo's results: the running test is `<target>/debug/deps/<name>`.
///
/// # Panics
///
/// If this is not a test that cargo built.
#[must_use]
pub fn target_dir() -> PathBuf {
    let test = std::env::current_exe().expect("a running test has a path");
    test.ancestors()
        .nth(3)
        .expect("cargo puts tests three folders deep")
        .to_path_buf()
}
