//! Independent implementations that the tests talk to: mbpoll (libmodbus) and pymodbus for Modbus,
//! tshark (Wireshark) and hart-protocol for HART.

use crate::{Result, apt, shell};
use std::path::{Path, PathBuf};
use std::process::Command;

/// The version of pymodbus that the tests are written for.
const PYMODBUS: &str = "3.16.1";

/// The version of hart-protocol that the tests are written for.
const HART_PROTOCOL: &str = "2023.6.0";

/// The peers of this machine.
pub struct Peers {
    python: PathBuf,
}

impl Peers {
    /// Tells a command where they are: `PEERS_PYTHON` is a Python that can import pymodbus and
    /// hart-protocol. mbpoll and tshark are in the search path.
    pub fn environment<'a>(&self, command: &'a mut Command) -> &'a mut Command {
        command
            .env("PEERS_PYTHON", &self.python)
            .env("PATH", shell::search_path())
    }
}

/// Finds all peers, and installs what is missing where that is allowed.
pub fn ensure() -> Result<Peers> {
    if shell::find(&["mbpoll"], &shell::search_path()).is_none() {
        apt::install(&["mbpoll"])?;
    }
    if shell::find(&["tshark"], &shell::search_path()).is_none() {
        apt::install(&["tshark"])?;
    }
    let folder = shell::target_dir().join("peers");
    let python = folder.join("bin/python");
    if !has_packages(&python) {
        make_venv(&folder)?;
        let pip = [
            "-m",
            "pip",
            "install",
            "--quiet",
            "--disable-pip-version-check",
        ];
        let mut install = shell::program(&python, pip);
        install.arg(format!("pymodbus[serial]=={PYMODBUS}"));
        install.arg(format!("hart-protocol=={HART_PROTOCOL}"));
        shell::run(&mut install).map_err(|error| {
            format!(
                "{error}\n  The tests need pymodbus {PYMODBUS} and hart-protocol {HART_PROTOCOL}; see why pip cannot get them."
            )
        })?;
    }
    println!(
        "mbpoll, tshark, and pymodbus {PYMODBUS} and hart-protocol {HART_PROTOCOL} in {}",
        folder.display()
    );
    Ok(Peers { python })
}

/// True when this Python has the right versions.
fn has_packages(python: &Path) -> bool {
    let script = format!(
        "import pymodbus, serial, hart_protocol
from importlib.metadata import version
assert pymodbus.__version__ == '{PYMODBUS}'
assert version('hart-protocol') == '{HART_PROTOCOL}'"
    );
    shell::succeeds(&mut shell::program(python, ["-c", &script]))
}

/// Makes a virtual environment; Debian keeps the module for that in a package of its own.
fn make_venv(folder: &Path) -> Result {
    let command = || {
        let mut command = shell::program("python3", ["-m", "venv", "--clear"]);
        command.arg(folder);
        command
    };
    if shell::succeeds(&mut command()) {
        return Ok(());
    }
    apt::install(&["python3", "python3-venv"])?;
    shell::run(&mut command())
}
