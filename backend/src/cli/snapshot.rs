//! `valvescope snapshot`: a whole device as one file.

use super::live::{Live, Where};
use super::{block_on, refuse};
use shared::icon3000::snapshot::{Snapshot, parse};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Save a whole ICON3000 as one file: registers, identity, counters, logs, curves.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(flatten)]
    live: Where,
    /// Where to write the snapshot; without it, to standard output.
    #[arg(long, short, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// Takes a snapshot. 0: all was read; 1: some of it could not be; 2: nothing could.
pub(super) fn run(args: &Args) -> ExitCode {
    block_on(async {
        let Live { snapshot, summary } = match args.live.read().await {
            Ok(live) => live,
            Err(why) => return refuse(why),
        };
        if let Err(error) = write(args.output.as_deref(), &snapshot.to_text()) {
            return refuse(format_args!("can't write the snapshot: {error}"));
        }
        eprintln!("{summary}");
        ExitCode::from(u8::from(!snapshot.failures.is_empty()))
    })
}

fn write(path: Option<&Path>, text: &str) -> std::io::Result<()> {
    match path {
        Some(path) => fs::write(path, text),
        None => std::io::stdout().lock().write_all(text.as_bytes()),
    }
}

/// Reads a file; says which, and what is wrong with it, if it holds no snapshot. What could not be
/// read of one is told on standard error.
pub(super) fn open(path: &Path) -> Result<Snapshot, String> {
    let name = path.display();
    let bytes = fs::read(path).map_err(|error| format!("can't read {name}: {error}"))?;
    let (snapshot, problems) = parse(&bytes);
    for problem in &problems {
        eprintln!("{name}: {problem}");
    }
    snapshot.ok_or_else(|| {
        format!("{name} is no snapshot; `valvescope snapshot` and the page write them")
    })
}
