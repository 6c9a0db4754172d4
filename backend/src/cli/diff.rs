//! `valvescope diff`: what changed between two snapshots, or since one.

use super::live::Where;
use super::snapshot::open;
use super::{MISUSE, block_on, refuse};
use clap::ValueEnum;
use serde_json::json;
use shared::icon3000::snapshot::{Change, Diff, Snapshot, Sort, diff};
use std::fmt::Write as _;
use std::io::{ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;

/// Compare two snapshots, or one with the device as it is now, by meaning.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The earlier snapshot.
    first: PathBuf,
    /// The later snapshot; without it, the device that --device, --port or --host names is read.
    #[arg(conflicts_with_all = ["device", "port", "host", "unit", "kind"])]
    second: Option<PathBuf>,
    /// Also print what changes by itself: positions, counters, the clock.
    #[arg(long)]
    all: bool,
    /// What to print: readable text, or one JSON object a line.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
    #[command(flatten)]
    live: Where,
}

/// Forms of output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// Compares. 0: nothing that lasts has changed; 1: something has; 2: a file or the device could not
/// be read.
pub(super) fn run(args: &Args) -> ExitCode {
    match both(args) {
        Ok((first, second)) => compare(args, &first, &second),
        Err(why) => refuse(why),
    }
}

/// The two sides.
fn both(args: &Args) -> Result<(Snapshot, Snapshot), String> {
    let first = open(&args.first)?;
    if let Some(second) = &args.second {
        return Ok((first, open(second)?));
    }
    if !args.live.is_given() {
        return Err(
            "say what to compare with: a second snapshot, or a device with --device, --port or \
             --host"
                .to_owned(),
        );
    }
    let live = block_on(args.live.read())?;
    eprintln!("{}", live.summary);
    Ok((first, live.snapshot))
}

fn compare(args: &Args, first: &Snapshot, second: &Snapshot) -> ExitCode {
    let diff = diff(first, second);
    let out = match args.format {
        Format::Text => text(&diff, args.all),
        Format::Json => lines(&diff, args.all),
    };
    match std::io::stdout().lock().write_all(out.as_bytes()) {
        // Whoever read our output may have seen enough.
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            eprintln!("valvescope: can't print the comparison: {error}");
            ExitCode::from(MISUSE)
        }
        _ => ExitCode::from(u8::from(diff.lasting().next().is_some())),
    }
}

/// The changes that are wanted.
fn wanted(diff: &Diff, all: bool) -> impl Iterator<Item = &Change> {
    let shown = move |change: &&Change| all || !change.sort.is_passing();
    diff.changes.iter().filter(shown)
}

fn text(diff: &Diff, all: bool) -> String {
    let mut out = String::new();
    for remark in &diff.remarks {
        out.push_str(&format!("! {remark}\n"));
    }
    let mut sort: Option<Sort> = None;
    for change in wanted(diff, all) {
        if sort != Some(change.sort) {
            out.push_str(&format!("{}\n", change.sort.label()));
            sort = Some(change.sort);
        }
        // Writing to a string does not fail.
        let _ = writeln!(out, "  {} ({})", change.label, change.path);
        let _ = writeln!(out, "    {} → {}", said(&change.was), said(&change.now));
    }
    let passing = diff.changes.iter().filter(|c| c.sort.is_passing()).count();
    if diff.is_empty() {
        out.push_str("No difference.\n");
    } else if passing > 0 && !all {
        let _ = writeln!(
            out,
            "{passing} values that change by themselves are not shown; --all shows them."
        );
    }
    if !diff.only_one.is_empty() {
        let (in_second, in_first): (Vec<_>, Vec<_>) =
            diff.only_one.iter().partition(|only| only.in_second);
        let _ = writeln!(
            out,
            "Not compared: {} only in the first, {} only in the second; --format json lists them.",
            in_first.len(),
            in_second.len()
        );
    }
    out
}

/// A value, or that there is none.
fn said(value: &str) -> &str {
    if value.is_empty() { "(none)" } else { value }
}

fn lines(diff: &Diff, all: bool) -> String {
    let mut out = String::new();
    let mut line = |value: serde_json::Value| out.push_str(&format!("{value}\n"));
    for remark in &diff.remarks {
        line(json!({"kind": "remark", "text": remark}));
    }
    for change in wanted(diff, all) {
        line(json!({
            "kind": "change",
            "sort": change.sort.key(),
            "path": change.path,
            "label": change.label,
            "was": change.was,
            "now": change.now,
            "also": change.also,
            "source": change.source.map(|s| s.to_string()),
        }));
    }
    for only in &diff.only_one {
        line(json!({
            "kind": "only_one",
            "path": only.path,
            "label": only.label,
            "in": if only.in_second { "second" } else { "first" },
        }));
    }
    out
}
