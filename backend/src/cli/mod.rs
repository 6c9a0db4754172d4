//! The command line.

mod ddc100;
mod decode;
mod diff;
mod dop;
mod hart;
mod live;
mod maps;
mod serve;
mod simulate;
mod snapshot;

use clap::{Parser, Subcommand, ValueEnum};
use shared::device::{Device, Family};
use std::fmt::Display;
use std::future::Future;
use std::io::IsTerminal;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use tracing_subscriber::EnvFilter;

/// Exit status of misuse: an option that makes no sense, a file that is not there.
const MISUSE: u8 = 2;

/// See what your valves say: an inspector for electric valve actuators on plant fieldbuses.
#[derive(Debug, Parser)]
#[command(
    name = "valvescope",
    version,
    args_conflicts_with_subcommands = true,
    disable_help_subcommand = true
)]
pub struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    serve: serve::Args,
}

/// What the program can do.
#[derive(Debug, Subcommand)]
enum Verb {
    /// Serve the page and read the buses (what happens without a subcommand).
    Serve(serve::Args),
    /// Decode frames from a file, a capture or pasted text.
    Decode(decode::Args),
    /// Decode the registers of a diagnostic object of a Limitorque MX or QX actuator.
    Dop(dop::Args),
    /// Save a whole ICON3000 as one file: registers, identity, counters, logs, curves.
    Snapshot(snapshot::Args),
    /// Compare two snapshots, or one with the device, by meaning.
    Diff(diff::Args),
    /// DDC-100 networks: poll one at the terminal, estimate how long a scan takes.
    Ddc100(ddc100::Ddc100Args),
    /// Print the register map of a device.
    Maps(maps::Args),
    /// Look for HART devices on a line or behind a gateway, and read them.
    #[command(subcommand)]
    Hart(hart::Verb),
    /// Be an actuator, or a DDC-100 network of many, that other programs can read.
    Simulate(simulate::Args),
}

/// Runs the program; the exit status says how it went.
#[must_use]
pub fn run(cli: Cli) -> ExitCode {
    match cli.verb {
        None => serve::run(&cli.serve),
        Some(Verb::Serve(args)) => serve::run(&args),
        Some(Verb::Decode(args)) => decode::run(&args),
        Some(Verb::Dop(args)) => dop::run(&args),
        Some(Verb::Snapshot(args)) => snapshot::run(&args),
        Some(Verb::Diff(args)) => diff::run(&args),
        Some(Verb::Ddc100(args)) => ddc100::run(&args),
        Some(Verb::Maps(args)) => maps::run(&args),
        Some(Verb::Hart(verb)) => hart::run(&verb),
        Some(Verb::Simulate(args)) => simulate::run(&args),
    }
}

/// Devices whose map can be applied.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum DeviceArg {
    /// Biffi ICON2000v4.
    #[value(name = "icon2000v4")]
    Icon2000v4,
    /// Biffi ICON3000.
    Icon3000,
    /// Biffi ICON3000v2.
    Icon3000v2,
    /// Limitorque with diagnostic objects.
    Dop,
    /// Rotork CVA with HART.
    RotorkCva,
    /// Rotork IQ with HART.
    RotorkIq,
    /// Rotork CMA with HART.
    RotorkCma,
    /// Rotork CK with HART.
    RotorkCk,
    /// Rotork SI with HART.
    RotorkSi,
    /// Limitorque DDC-100: MX/DDC field unit.
    Ddc100Mx,
    /// Limitorque DDC-100: MX or QX of series B.
    Ddc100MxB,
    /// Limitorque DDC-100: UEC-3-DDC field unit.
    Ddc100Uec,
    /// Limitorque DDC-100: clamshell field unit.
    Ddc100Clamshell,
    /// Limitorque DDC-100: I/O module.
    Ddc100Io,
    /// No map: registers by address, raw numbers.
    None,
}

impl From<DeviceArg> for Device {
    fn from(arg: DeviceArg) -> Self {
        match arg {
            DeviceArg::Icon2000v4 => Self::Icon2000v4,
            DeviceArg::Icon3000 => Self::Icon3000,
            DeviceArg::Icon3000v2 => Self::Icon3000v2,
            DeviceArg::Dop => Self::Dop,
            DeviceArg::RotorkCva => Self::Rotork(Family::Cva),
            DeviceArg::RotorkIq => Self::Rotork(Family::Iq),
            DeviceArg::RotorkCma => Self::Rotork(Family::Cma),
            DeviceArg::RotorkCk => Self::Rotork(Family::Ck),
            DeviceArg::RotorkSi => Self::Rotork(Family::Si),
            DeviceArg::Ddc100Mx => Self::Ddc100Mx,
            DeviceArg::Ddc100MxB => Self::Ddc100MxB,
            DeviceArg::Ddc100Uec => Self::Ddc100Uec,
            DeviceArg::Ddc100Clamshell => Self::Ddc100Clamshell,
            DeviceArg::Ddc100Io => Self::Ddc100Io,
            DeviceArg::None => Self::None,
        }
    }
}

/// Says why the program can't do what it was asked.
fn refuse(why: impl Display) -> ExitCode {
    eprintln!("valvescope: {why}");
    ExitCode::from(MISUSE)
}

/// Sends log lines to standard error; `RUST_LOG` chooses which.
fn log_to_stderr() {
    let filter = EnvFilter::try_from_default_env().unwrap_or_else(|_| EnvFilter::new("info"));
    let subscriber = tracing_subscriber::fmt()
        .with_env_filter(filter)
        .with_writer(std::io::stderr)
        .with_ansi(std::io::stderr().is_terminal())
        .with_target(false);
    // Fails only if a test has installed one already.
    let _installed = subscriber.try_init();
}

/// What a command gives when its threads can't be started.
trait Refused {
    fn refused(why: String) -> Self;
}

impl Refused for ExitCode {
    fn refused(why: String) -> Self {
        refuse(why)
    }
}

impl<T> Refused for Result<T, String> {
    fn refused(why: String) -> Self {
        Err(why)
    }
}

/// Runs a future on a runtime of its own.
fn block_on<T: Refused>(future: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(2)
        .thread_name("valvescope")
        .enable_all()
        .build();
    match runtime {
        Ok(runtime) => {
            let outcome = runtime.block_on(future);
            // A serial port may hang in the kernel; the program ends all the same.
            runtime.shutdown_background();
            outcome
        }
        Err(error) => T::refused(format!("can't start its threads: {error}")),
    }
}

/// Ends when the program is asked to end: Ctrl-C, or SIGTERM where there are signals.
async fn asked_to_end() {
    let interrupt = tokio::signal::ctrl_c();
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        if let Ok(mut terminate) = signal(SignalKind::terminate()) {
            tokio::select! {
                _ = interrupt => {}
                _ = terminate.recv() => {}
            }
            return;
        }
    }
    let _error = interrupt.await;
}

/// Where to listen, from the command line.
fn address(text: &str) -> Result<SocketAddr, String> {
    let full = text
        .strip_prefix("localhost:")
        .map_or_else(|| text.to_owned(), |port| format!("127.0.0.1:{port}"));
    full.parse().map_err(|_| {
        format!("`{text}` is no address; write it as 127.0.0.1:8080, or with port 0 for a free one")
    })
}

/// A path, or `-` for standard input.
fn path_or_stdin(path: Option<&PathBuf>) -> Option<&PathBuf> {
    path.filter(|p| p.as_os_str() != "-")
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    /// No two options or groups of a command have the same name, and what one asks for exists.
    #[test]
    fn the_command_line_is_sound() {
        Cli::command().debug_assert();
    }
}
