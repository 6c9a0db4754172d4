//! The `valvescope` binary, serving on a free port of loopback.

use crate::process::Process;
use std::env;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::Command;

/// A running `valvescope serve`. Dropping it kills it.
#[derive(Debug)]
pub struct Server {
    /// The process, for its output and its end.
    pub process: Process,
    address: SocketAddr,
}

impl Server {
    /// Starts the server on a free port with these options besides `--listen`.
    ///
    /// # Panics
    ///
    /// If the binary is missing or does not say `listening on http://…`.
    #[must_use]
    pub fn start(options: &[&str]) -> Self {
        Self::start_at("127.0.0.1:0", options)
    }

    /// Starts the server where another one may have been before.
    ///
    /// # Panics
    ///
    /// If the binary is missing or does not say `listening on http://…`.
    #[must_use]
    pub fn start_at(listen: &str, options: &[&str]) -> Self {
        let mut command = Command::new(binary());
        command.args(["serve", "--listen", listen]).args(options);
        let advice = "run the tests with `cargo xtask test`, or build first: \
            `cargo xtask web && cargo build -p backend`";
        let (process, address) = Process::start(&mut command, advice, |line| {
            let (_, url) = line.split_once("listening on http://")?;
            url.split(['/', ' ']).next()?.parse().ok()
        });
        Self { process, address }
    }

    /// Where it listens.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// The URL of a path that begins with `/`.
    #[must_use]
    pub fn url(&self, path: &str) -> String {
        format!("http://{}{path}", self.address)
    }
}

/// The binary under test.
///
/// # Panics
///
/// If it is not there.
#[must_use]
pub fn binary() -> PathBuf {
    let path = env::var_os("VALVESCOPE_BIN").map_or_else(
        || crate::target_dir().join("debug").join("valvescope"),
        PathBuf::from,
    );
    assert!(
        path.is_file(),
        "{} is not there; run `cargo xtask test`, or `cargo build -p backend` first",
        path.display()
    );
    path
}
