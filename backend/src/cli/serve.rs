//! `valvescope serve`: the page and the buses.

use super::{address, asked_to_end, block_on, log_to_stderr, refuse};
use crate::app::{App, app};
use crate::config::Config;
use crate::listen::Limited;
use crate::plant::Plant;
use crate::ws::Hosts;
use std::io::Write;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use tokio::net::TcpListener;

/// Serve the page and read the buses.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// What is connected where.
    ///
    /// Without it `valvescope.toml` in the current directory is read; if that is not there either,
    /// a simulated plant is served.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Where to listen; port 0 takes a free one. Goes before the configuration.
    #[arg(long, value_name = "ADDRESS", value_parser = address)]
    listen: Option<SocketAddr>,
}

/// Serves until it is asked to end.
pub(super) fn run(args: &Args) -> ExitCode {
    log_to_stderr();
    let config = match Config::load(args.config.as_deref()) {
        Ok(config) => config,
        Err(error) => return refuse(error),
    };
    let listen = args.listen.unwrap_or(config.listen);
    block_on(serve(config, listen))
}

async fn serve(config: Config, listen: SocketAddr) -> ExitCode {
    let (listener, listening) = match bind(listen).await {
        Ok(bound) => bound,
        Err(error) => {
            return refuse(format_args!(
                "can't listen on {listen}: {error}; choose another address with --listen"
            ));
        }
    };
    if !listening.ip().is_loopback() {
        tracing::warn!(
            "{listening} can be reached from other computers; whoever reaches it sees the plant"
        );
    }
    let plant = Arc::new(Plant::start(&config));
    let router = app(App::new(plant, Hosts::new(listening, &config.hosts)));
    say(&format!("listening on http://{listening}"));
    // Open sockets of pages would keep a graceful end waiting for ever; pages connect again.
    tokio::select! {
        served = axum::serve(Limited::new(listener), router) => match served {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => refuse(format_args!("stopped serving: {error}")),
        },
        () = asked_to_end() => {
            tracing::info!("ending");
            ExitCode::SUCCESS
        }
    }
}

/// Listens, and says where if the port was left open.
pub(super) async fn bind(address: SocketAddr) -> std::io::Result<(TcpListener, SocketAddr)> {
    let listener = TcpListener::bind(address).await?;
    let bound = listener.local_addr()?;
    Ok((listener, bound))
}

/// Writes a line that programs wait for.
pub(super) fn say(line: &str) {
    let mut out = std::io::stdout().lock();
    // Nobody may be listening.
    let _closed = writeln!(out, "{line}").and_then(|()| out.flush());
}
