//! `cargo xtask serve`: build everything, start the bridge, open the page.
//!
//! The bridge is built in the dev profile: a fresh machine starts sooner, and the artefacts are
//! those of `cargo xtask test`. The work that needs an optimiser is decoding in the browser, and
//! the page is always optimised.

use crate::{Result, shell, web};
use std::env;
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

/// Where the page is served unless `--listen` or another program says otherwise.
const ADDRESS: &str = "127.0.0.1:8502";

/// Builds everything and serves it; `args` go to `valvescope serve`.
pub fn serve(args: &[String]) -> Result {
    // `cargo xtask serve -- --listen …` and `cargo xtask serve --listen …` are the same.
    let args = args.strip_prefix(&["--".to_owned()]).unwrap_or(args);
    if args.iter().any(|arg| arg == "--help" || arg == "-h") {
        return shell::run(&mut shell::cargo([
            "run", "-q", "-p", "backend", "--", "serve", "--help",
        ]));
    }
    web::web()?;
    shell::run(&mut shell::cargo([
        "build",
        "-p",
        "backend",
        "--bin",
        "valvescope",
    ]))?;

    let mut command = shell::program(shell::target_dir().join("debug/valvescope"), ["serve"]);
    let address = match listen_option(args) {
        Some(given) => given.to_owned(),
        None => {
            let free = free_address()?;
            command.args(["--listen", &free]);
            free
        }
    };
    let mut server = command.args(args).spawn()?;
    if let Ok(address) = address.parse::<SocketAddr>()
        && wait_for(address, &mut server)?
    {
        open(&format!("http://{address}"));
    }
    let status = server.wait()?;
    // 130 is the usual answer to Ctrl-C, which is how a server is meant to end.
    if status.success() || status.code() == Some(130) {
        Ok(())
    } else {
        Err(format!("valvescope ended: {status}").into())
    }
}

/// The value of `--listen` in the options for the server.
fn listen_option(args: &[String]) -> Option<&str> {
    let mut args = args.iter().map(String::as_str);
    while let Some(arg) = args.next() {
        match arg.strip_prefix("--listen") {
            Some("") => return args.next(),
            Some(rest) if rest.starts_with('=') => return rest.strip_prefix('='),
            _ => {}
        }
    }
    None
}

/// The usual address, or a free port when that is taken.
fn free_address() -> Result<String> {
    let listener = TcpListener::bind(ADDRESS).or_else(|_| TcpListener::bind("127.0.0.1:0"))?;
    Ok(listener.local_addr()?.to_string())
}

/// Waits until the server answers. False when it ended or stayed silent for ten seconds.
fn wait_for(address: SocketAddr, server: &mut Child) -> Result<bool> {
    for _ in 0..100 {
        if server.try_wait()?.is_some() {
            return Ok(false);
        }
        if address.port() != 0
            && TcpStream::connect_timeout(&address, Duration::from_millis(100)).is_ok()
        {
            return Ok(true);
        }
        sleep(Duration::from_millis(100));
    }
    Ok(false)
}

/// Opens the page in the browser of this desktop, or says where it is.
fn open(url: &str) {
    let desktop = env::var_os("DISPLAY").is_some() || env::var_os("WAYLAND_DISPLAY").is_some();
    let opener = if cfg!(target_os = "macos") {
        "open"
    } else {
        "xdg-open"
    };
    let mut command = Command::new(opener);
    command
        .arg(url)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if (desktop || cfg!(target_os = "macos")) && command.spawn().is_ok() {
        println!("opened {url} — Ctrl-C ends it");
    } else {
        println!("open {url} in a browser — Ctrl-C ends it");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn listen_is_found_in_both_spellings() {
        let find = |line: &str| {
            let args: Vec<String> = line.split(' ').map(str::to_owned).collect();
            listen_option(&args).map(str::to_owned)
        };
        assert_eq!(
            find("--sim x --listen 127.0.0.1:1").as_deref(),
            Some("127.0.0.1:1")
        );
        assert_eq!(find("--listen=[::1]:2").as_deref(), Some("[::1]:2"));
        assert_eq!(find("--listener a"), None);
        assert_eq!(find("--listen"), None);
    }
}
