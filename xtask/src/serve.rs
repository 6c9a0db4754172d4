//! `cargo xtask serve`: build everything, start the bridge, open the page.
//!
//! The bridge is built in the dev profile: a fresh machine starts sooner, and the artefacts are
//! those of `cargo xtask test`. The work that needs an optimiser is decoding in the browser, and
//! the page is always optimised.

use crate::{Result, shell, web};
use std::env;
use std::io::{BufRead, BufReader};
use std::net::TcpListener;
use std::process::{Command, Stdio};

/// Where the bridge listens when neither an option nor a configuration says otherwise.
const ADDRESS: &str = "127.0.0.1:8080";

/// What the bridge says before the address of the page.
const LISTENING: &str = "listening on ";

/// Builds everything and serves it; `args` go to `valvescope serve`.
pub fn serve(args: &[String]) -> Result {
    // `cargo xtask serve -- --listen …` and `cargo xtask serve --listen …` are the same.
    let args = args.strip_prefix(&["--".to_owned()]).unwrap_or(args);
    if args.iter().any(|arg| arg == "--help" || arg == "-h") {
        let help = ["run", "-q", "-p", "backend", "--", "serve", "--help"];
        return shell::run(&mut shell::cargo(help));
    }
    web::web()?;
    shell::run(&mut shell::cargo([
        "build",
        "-p",
        "backend",
        "--bin",
        "valvescope",
    ]))?;

    let binary = shell::target_dir().join("debug/valvescope");
    // A relative path among the options is one from where the person stands, not from the root.
    let mut command = Command::new(binary);
    command.arg("serve").args(args);
    if args.is_empty() && TcpListener::bind(ADDRESS).is_err() {
        println!("{ADDRESS} is taken by another program; using a free port");
        command.args(["--listen", "127.0.0.1:0"]);
    }
    let mut server = command.stdout(Stdio::piped()).spawn()?;
    let output = server.stdout.take().ok_or("no output")?;
    for line in BufReader::new(output)
        .lines()
        .map_while(std::result::Result::ok)
    {
        println!("{line}");
        if let Some((_, url)) = line.split_once(LISTENING) {
            open(url);
        }
    }
    let status = server.wait()?;
    if status.success() {
        return Ok(());
    }
    Err(format!("valvescope ended: {status}").into())
}

/// Opens the page in the browser of this desktop, or says where it is.
fn open(url: &str) {
    let has_desktop = ["DISPLAY", "WAYLAND_DISPLAY"]
        .iter()
        .any(|name| env::var_os(name).is_some());
    let mut command = Command::new("xdg-open");
    command
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if has_desktop && command.spawn().is_ok() {
        println!("opened {url} in the browser; Ctrl-C ends it");
    } else {
        println!("open {url} in a browser; Ctrl-C ends it");
    }
}
