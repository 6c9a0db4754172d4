//! Independent implementations of Modbus and HART.

use std::env;
use std::path::PathBuf;
use std::process::Command;

/// A Python that can import pymodbus and hart-protocol.
///
/// # Panics
///
/// If it is not there.
#[must_use]
pub fn python() -> Command {
    let path = env::var_os("PEERS_PYTHON").map_or_else(
        || crate::target_dir().join("peers/bin/python"),
        PathBuf::from,
    );
    assert!(
        path.is_file(),
        "{} is not there; run `cargo xtask test`",
        path.display()
    );
    Command::new(path)
}

/// The command-line master of libmodbus.
#[must_use]
pub fn mbpoll() -> Command {
    Command::new("mbpoll")
}
