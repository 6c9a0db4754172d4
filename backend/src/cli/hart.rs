//! `valvescope hart`: look for HART devices and read them, without a page.

mod show;

use super::decode::Format;
use super::{DeviceArg, block_on, log_to_stderr, refuse};
use crate::bus::hart::{Exchange, Line, gate, words};
use crate::bus::recorder::Recorder;
use crate::bus::{Plug, words as lines};
use crate::clock::Clock;
use crate::config::hart::{HartConfig, HartWay, Keying, PORT};
use crate::config::{BusConfig, LineConfig};
use clap::{Subcommand, ValueEnum};
use shared::device::Device as Kind;
use shared::hart::link::{Device, Identity, Scan, Sighting, Step, Target, overview, usual_data};
use shared::proto::HartCommand;
use shared::render::hex;
use show::Show;
use std::io;
use std::process::ExitCode;
use std::time::Duration;
use tokio::sync::watch;

/// Read HART devices.
#[derive(Debug, Subcommand)]
pub(super) enum Verb {
    /// Look for devices at polling addresses.
    Scan(ScanArgs),
    /// Read commands of a device: those named, or all that show what it is and how it is.
    Read(ReadArgs),
    /// Ask a device who it is: by polling address, tag or long tag.
    Identify(IdentifyArgs),
}

/// Where the devices are.
#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("line").required(true)))]
struct LineArgs {
    /// A HART modem on this serial port.
    #[arg(long, value_name = "PATH", group = "line")]
    port: Option<String>,
    /// A HART-IP gateway; without a port, 5094.
    #[arg(long, value_name = "HOST", group = "line")]
    host: Option<String>,
    /// Speak to the gateway over UDP instead of TCP.
    #[arg(long, requires = "host")]
    udp: bool,
    /// Which master to be. Beside a control system: secondary.
    #[arg(long, value_enum, default_value_t = MasterArg::Secondary)]
    master: MasterArg,
    /// Bits a second; 1200 on any real line.
    #[arg(long, default_value_t = 1200, value_parser = clap::value_parser!(u32).range(1200..=115_200))]
    baud: u32,
    /// Tries beyond the first (usually 3; 1 with a gateway).
    #[arg(long, value_parser = clap::value_parser!(u8).range(0..=10))]
    retries: Option<u8>,
    /// Longest silence within a frame, in milliseconds, as the port delivers it (usually 100).
    #[arg(long, value_parser = clap::value_parser!(u64).range(1..=500))]
    gap_ms: Option<u64>,
    /// Which family it is, so that its own status is decoded.
    #[arg(long, value_enum, default_value_t = DeviceArg::None)]
    device: DeviceArg,
    /// What to print: readable text, or one JSON object a line.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Masters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum MasterArg {
    /// The only master, or the control system.
    Primary,
    /// A master beside another one.
    Secondary,
}

/// Which addresses to look at.
#[derive(Debug, clap::Args)]
pub(super) struct ScanArgs {
    #[command(flatten)]
    line: LineArgs,
    /// First polling address.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=63))]
    first: u8,
    /// Last polling address; HART 5 stops at 15.
    #[arg(long, default_value_t = 63, value_parser = clap::value_parser!(u8).range(0..=63))]
    last: u8,
}

/// Which device is meant.
#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("target")))]
struct TargetArgs {
    /// Polling address (0 if nothing else is said).
    #[arg(long, group = "target", value_parser = clap::value_parser!(u8).range(0..=63))]
    poll: Option<u8>,
    /// Long address, ten hexadecimal digits.
    #[arg(long, group = "target", value_name = "DIGITS", value_parser = unique)]
    address: Option<Target>,
    /// Tag, 8 characters at most.
    #[arg(long, group = "target", value_parser = tag)]
    tag: Option<Target>,
    /// Long tag, 32 characters at most.
    #[arg(long, group = "target", value_parser = long_tag)]
    long_tag: Option<Target>,
}

impl TargetArgs {
    fn target(&self) -> Target {
        let given = [&self.address, &self.tag, &self.long_tag];
        let given = given.into_iter().flatten().next().cloned();
        given.unwrap_or(Target::Polling(self.poll.unwrap_or(0)))
    }
}

fn unique(text: &str) -> Result<Target, String> {
    let target = Target::unique(text);
    target.ok_or_else(|| "write ten hexadecimal digits, as AEDD012345".into())
}

fn tag(text: &str) -> Result<Target, String> {
    let target = Target::tag(text);
    target.ok_or_else(|| {
        "a tag has 1 to 8 characters: capital letters, digits and signs up to \"_\"".into()
    })
}

fn long_tag(text: &str) -> Result<Target, String> {
    let target = Target::long_tag(text);
    target.ok_or_else(|| "a long tag has 1 to 32 characters of ISO 8859-1".into())
}

/// What to read.
#[derive(Debug, clap::Args)]
pub(super) struct ReadArgs {
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    target: TargetArgs,
    /// Commands: a number, or a number and the data of the request, as 523:0040. Without any, those
    /// that together show what the device says of itself.
    #[arg(value_parser = command)]
    commands: Vec<Ask>,
}

/// Who is asked.
#[derive(Debug, clap::Args)]
pub(super) struct IdentifyArgs {
    #[command(flatten)]
    line: LineArgs,
    #[command(flatten)]
    target: TargetArgs,
}

/// A command that may be sent, with its data.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Ask(u16, Vec<u8>);

/// Reads `3` or `523:0040`; without data a command gets those with which it is usually read.
fn command(text: &str) -> Result<Ask, String> {
    let (number, data) = match text.split_once(':') {
        Some((number, data)) => (number, Some(data)),
        None => (text, None),
    };
    let number: u16 = number
        .parse()
        .map_err(|_| "write a number, or a number and data, as 523:0040".to_owned())?;
    let usual = || usual_data(number).map(|d| hex(&d)).unwrap_or_default();
    let ask = HartCommand {
        number,
        data: data.map_or_else(usual, str::to_owned),
    };
    gate::command(&ask).map(|data| Ask(number, data))
}

/// Runs it. 0: answered; 1: not everything was; 2: there is no line.
pub(super) fn run(verb: &Verb) -> ExitCode {
    log_to_stderr();
    block_on(async {
        let outcome = match verb {
            Verb::Scan(args) => scan(args).await,
            Verb::Read(args) => read(args).await,
            Verb::Identify(args) => identify(args).await,
        };
        match outcome {
            Ok(complete) => ExitCode::from(u8::from(!complete)),
            Err(Lost::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => {
                ExitCode::SUCCESS
            }
            Err(Lost::Output(error)) => refuse(format_args!("can't write: {error}")),
            Err(Lost::Line(text)) => refuse(text),
        }
    })
}

/// Why nothing more can be done.
enum Lost {
    /// The line, in words.
    Line(String),
    /// Our output.
    Output(io::Error),
}

impl From<io::Error> for Lost {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

/// An open line.
struct Open {
    line: Line,
    config: LineConfig,
}

impl LineArgs {
    fn bus(&self) -> BusConfig {
        let way = match (&self.port, &self.host) {
            (Some(port), _) => HartWay::Serial {
                port: port.clone(),
                baud: self.baud,
                keying: Keying::default(),
            },
            (None, host) => HartWay::Ip {
                host: with_port(host.as_deref().unwrap_or_default()),
                udp: self.udp,
            },
        };
        let mut bus = HartConfig {
            primary: self.master == MasterArg::Primary,
            gap: self.gap_ms.map(Duration::from_millis),
            ..HartConfig::of(way)
        }
        .bus("line");
        if let Some(retries) = self.retries {
            bus.retries = retries;
        }
        bus
    }

    async fn open(&self) -> Result<Open, Lost> {
        let bus = self.bus();
        let clock = Clock::start();
        let recorder = Recorder::new("line", clock, watch::Sender::new(0));
        let opened = Line::open(&bus, recorder, &mut Plug::Configured, clock).await;
        let line = opened.map_err(|error| Lost::Line(lines::down(&bus.line, &error)))?;
        Ok(Open {
            line,
            config: bus.line,
        })
    }

    fn kind(&self) -> Kind {
        self.device.into()
    }
}

/// The usual port where none is named.
fn with_port(host: &str) -> String {
    match host.rsplit_once(':') {
        Some((before, _)) if before.ends_with(']') || !before.contains(':') => host.to_owned(),
        Some(_) if !host.starts_with('[') => format!("[{host}]:{PORT}"),
        _ => format!("{host}:{PORT}"),
    }
}

impl Open {
    async fn exchange(&mut self, request: shared::hart::link::Request) -> Result<Exchange, Lost> {
        let done = self.line.exchange(request).await;
        done.map_err(|error| Lost::Line(lines::down(&self.config, &error)))
    }

    fn words(&self, exchange: &Exchange, target: &Target) -> String {
        words::exchange(exchange, target, &self.config)
    }

    /// Finds a device; what came of it, and whether it was found.
    async fn find(&mut self, device: &mut Device) -> Result<(Exchange, bool), Lost> {
        let exchange = self.exchange(device.target().identify()).await?;
        let found = exchange.outcome.as_ref().is_ok_and(|a| device.found(a));
        Ok((exchange, found))
    }
}

async fn scan(args: &ScanArgs) -> Result<bool, Lost> {
    if args.first > args.last {
        return Err(Lost::Line(
            "--first is behind --last; turn them round".into(),
        ));
    }
    let mut show = Show::new(args.line.format, args.line.kind());
    let mut open = args.line.open().await?;
    let mut scan = Scan::new(args.first, args.last);
    while let Some((polling, request)) = scan.next() {
        let exchange = open.exchange(request).await?;
        let answer = exchange.outcome.as_ref().ok();
        match scan.take(answer) {
            Sighting::Nobody => show.progress(&format!("nobody at {polling}")),
            Sighting::Device(identity) => show.found(polling, &identity, &exchange)?,
            Sighting::Again(before) => show.remark(&format!(
                "at {polling} the device of {before} answers again: it looks at four bits of the \
                 address only"
            )),
            Sighting::Unknown => {
                show.remark(&format!("something at {polling} does not say who it is"));
            }
        }
    }
    open.line.close().await;
    let found = scan.found().len();
    show.total(&match found {
        1 => "1 device".to_owned(),
        n => format!("{n} devices"),
    })?;
    Ok(found > 0)
}

async fn identify(args: &IdentifyArgs) -> Result<bool, Lost> {
    let mut show = Show::new(args.line.format, args.line.kind());
    let mut open = args.line.open().await?;
    let mut device = Device::new(args.target.target());
    let (exchange, found) = open.find(&mut device).await?;
    open.line.close().await;
    let words = open.words(&exchange, device.target());
    show.exchange(0, &exchange, &words)?;
    if let Some(identity) = device.identity() {
        show.total(&describe(identity))?;
    }
    Ok(found)
}

async fn read(args: &ReadArgs) -> Result<bool, Lost> {
    let mut show = Show::new(args.line.format, args.line.kind());
    let mut open = args.line.open().await?;
    let mut device = Device::new(args.target.target());
    let asks: Vec<Ask> = if args.commands.is_empty() {
        let all = overview(args.line.kind().family());
        all.into_iter().map(|(n, data)| Ask(n, data)).collect()
    } else {
        args.commands.clone()
    };
    let (mut complete, mut answered) = (true, 0);
    for Ask(number, data) in &asks {
        let exchange = match device.request(*number, data) {
            Step::Ask(request) => open.exchange(request).await?,
            Step::Find(_) => {
                let (exchange, found) = open.find(&mut device).await?;
                match device.request(*number, data) {
                    Step::Ask(request) if found => open.exchange(request).await?,
                    _ => {
                        let words = open.words(&exchange, device.target());
                        show.exchange(*number, &exchange, &words)?;
                        complete = false;
                        break;
                    }
                }
            }
        };
        let words = open.words(&exchange, device.target());
        show.exchange(*number, &exchange, &words)?;
        complete &= exchange.outcome.is_ok();
        answered += u32::from(exchange.outcome.is_ok());
    }
    open.line.close().await;
    show.total(&format!("{answered} of {} commands answered", asks.len()))?;
    Ok(complete)
}

/// A device in one line.
fn describe(identity: &Identity) -> String {
    let kind = match identity.expanded_type {
        shared::hart::frame::ROTORK => "Rotork actuator".to_owned(),
        other => format!("device type {other:04X}"),
    };
    format!(
        "{}  {kind}, device id {:06X}, HART {}, {} preambles",
        identity.address, identity.device_id, identity.revision, identity.preambles
    )
}
