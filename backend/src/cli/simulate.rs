//! `valvescope simulate`: an actuator for other programs.

mod ddc;
mod hart;

use super::serve::{bind, say};
use super::{DeviceArg, address, asked_to_end, block_on, log_to_stderr, refuse};
use crate::bus::timing::gap;
use crate::clock::Clock;
use crate::config::{DeviceConfig, Mode, Parity};
use crate::serial;
use crate::sim::{self, Actuators, Pace};
use clap::ValueEnum;
use shared::device::Device;
use shared::sim::{DopSetup, Fault};
use std::net::SocketAddr;
use std::path::PathBuf;
use std::process::ExitCode;
use std::str::FromStr;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio_serial::{SerialPort, SerialStream};

/// Baud rate if nothing else is said.
const BAUD: u32 = 9600;
/// Shortest silence that ends a frame: less can't be told apart from a busy computer.
const SHORTEST_GAP: Duration = Duration::from_millis(4);

/// Be a device. It moves by itself, and it obeys other masters: it is no real valve.
#[derive(Debug, clap::Args)]
#[command(group(clap::ArgGroup::new("line").required(true)))]
pub(super) struct Args {
    /// Modbus TCP on this address; port 0 takes a free one.
    #[arg(long, value_name = "ADDRESS", value_parser = address, group = "line")]
    listen: Option<SocketAddr>,
    /// Modbus RTU on this serial port.
    #[arg(long, value_name = "PATH", group = "line")]
    serial: Option<PathBuf>,
    /// Modbus RTU on a new pseudo terminal, whose path is printed.
    #[arg(long, group = "line")]
    pty: bool,
    /// A DDC-100 network of many units on this serial port, or on these two as a loop: its ends at
    /// host port 1 and 2. `pty` instead of a path makes a pseudo terminal, whose path is printed.
    #[arg(long, value_name = "PATH", num_args = 1..=2, group = "line")]
    ddc100: Vec<String>,
    /// A Rotork actuator with HART on this serial port; `pty` makes a pseudo terminal.
    #[arg(long, value_name = "PATH", group = "line")]
    hart: Option<String>,
    /// Unit address.
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=247))]
    unit: u8,
    /// Baud rate of the serial port: 9600 if nothing else is said, 1200 for HART.
    #[arg(long, value_parser = clap::value_parser!(u32).range(300..=921_600))]
    baud: Option<u32>,
    /// Parity of the serial port.
    #[arg(long, value_enum, default_value_t = ParityArg::Even)]
    parity: ParityArg,
    /// Which device to be; with --hart a rotork-iq if nothing else is said.
    #[arg(long, value_enum, default_value_t = DeviceArg::Icon3000v2)]
    device: DeviceArg,
    /// The tag that it reports. Tags that begin with FV or PV are control valves.
    #[arg(long, default_value = "XV-101")]
    tag: String,
    /// What is wrong: with an ICON `lost-phase` and the like, with a DDC-100 network `break-3` and the
    /// like; `--help` lists them. May be given several times.
    #[arg(long, long_help = fault_help(), value_name = "FAULT", value_parser = str::parse::<FaultArg>)]
    fault: Vec<FaultArg>,
    #[command(flatten)]
    dop: DopArgs,
    #[command(flatten)]
    network: ddc::NetworkArgs,
    #[command(flatten)]
    valve: hart::HartArgs,
}

/// Every name of a fault.
fn fault_help() -> String {
    let keys = Fault::ALL.map(Fault::key).join(", ");
    let network = ddc::fault_help();
    format!(
        "What is wrong from the start; may be given several times. With an ICON {keys}; {network}"
    )
}

/// A fault of any simulated device.
#[derive(Clone, Copy, Debug)]
enum FaultArg {
    Icon(Fault),
    Network(sim::ddc::Fault),
}

impl FromStr for FaultArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if let Some(fault) = Fault::from_key(text) {
            return Ok(Self::Icon(fault));
        }
        let keys = Fault::ALL.map(Fault::key).join(", ");
        text.parse()
            .map(Self::Network)
            .map_err(|why| format!("{why}; an ICON has: {keys}"))
    }
}

/// How a DOP device behaves.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "With --device dop")]
struct DopArgs {
    /// Lowest of the three status bits: 11, 12 or 13.
    #[arg(long, default_value_t = 12, value_parser = clap::value_parser!(u8).range(11..=13))]
    shift: u8,
    /// How long it is busy with a request, in milliseconds.
    #[arg(long, default_value_t = 120, value_parser = clap::value_parser!(u32).range(0..=60_000))]
    busy_ms: u32,
    /// Another master asks for an object so often, in milliseconds; 0 for never.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=3_600_000))]
    foreign_ms: u32,
    /// Records in its event log at the start.
    #[arg(long, default_value_t = 420, value_parser = clap::value_parser!(u16).range(0..=4096))]
    events: u16,
    /// It does not stroke by itself.
    #[arg(long)]
    still: bool,
    /// Addresses of its request, indicator, status, count and response registers.
    #[arg(
        long,
        value_name = "REQUEST,INDICATORS,STATUS,COUNT,RESPONSE",
        default_value = "4000,4010,4014,4015,4100",
        value_parser = registers
    )]
    registers: [u16; 5],
}

impl DopArgs {
    fn setup(&self) -> DopSetup {
        let [request, indicators, status, count, response] = self.registers;
        DopSetup {
            request,
            indicators,
            status,
            count,
            response,
            shift: self.shift,
            busy_ms: self.busy_ms,
            foreign_ms: self.foreign_ms,
            events: self.events.into(),
            moves: !self.still,
        }
    }
}

/// Five addresses that leave room for what stands there.
fn registers(text: &str) -> Result<[u16; 5], String> {
    let numbers: Result<Vec<u16>, _> = text.split(',').map(|n| n.trim().parse()).collect();
    let five = numbers.ok().and_then(|n| <[u16; 5]>::try_from(n).ok());
    let Some(five) = five else {
        return Err("write five addresses from 0 to 65535 with commas between them".into());
    };
    let ranges = five.iter().zip([1, 4, 1, 1, 512]);
    let ranges: Vec<(u32, u32)> = ranges
        .map(|(start, len)| (u32::from(*start), u32::from(*start) + len))
        .collect();
    let apart = ranges.iter().enumerate().all(|(at, one)| {
        let others = ranges.iter().skip(at + 1);
        one.1 <= 65_536 && others.into_iter().all(|o| o.1 <= one.0 || one.1 <= o.0)
    });
    if apart {
        Ok(five)
    } else {
        Err("the areas overlap (they have 1, 4, 1, 1 and 512 registers)".into())
    }
}

/// Parities.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum ParityArg {
    /// No parity, two stop bits.
    None,
    /// Even parity, one stop bit.
    Even,
    /// Odd parity, one stop bit.
    Odd,
}

impl ParityArg {
    /// The mode that the ICON3000 has with this parity (VCIOM-16345-EN, section 3).
    const fn mode(self) -> Mode {
        let (parity, stop) = match self {
            Self::None => (Parity::None, 2),
            Self::Even => (Parity::Even, 1),
            Self::Odd => (Parity::Odd, 1),
        };
        Mode {
            data: 8,
            parity,
            stop,
        }
    }
}

/// Runs the device until it is asked to end.
pub(super) fn run(args: &Args) -> ExitCode {
    log_to_stderr();
    if args.device == DeviceArg::None {
        return refuse("it must be some device; choose icon3000v2, icon3000, icon2000v4 or dop");
    }
    if Device::from(args.device).is_ddc() {
        return refuse(
            "field units are simulated as a network: write --ddc100 PATH, or --ddc100 pty",
        );
    }
    if !args.ddc100.is_empty() {
        let mut faults = Vec::new();
        for fault in &args.fault {
            match fault {
                FaultArg::Network(fault) => faults.push(*fault),
                FaultArg::Icon(fault) => {
                    return refuse(format_args!("--fault {} is one of an ICON", fault.key()));
                }
            }
        }
        return block_on(ddc::run(
            &args.network,
            &faults,
            &args.ddc100,
            args.baud.unwrap_or(BAUD),
        ));
    }
    if let Some(path) = &args.hart {
        if !args.fault.is_empty() {
            return refuse("--fault is for an ICON or a --ddc100 network, not for --hart");
        }
        return block_on(hart::run(
            &args.valve,
            path,
            args.device,
            &args.tag,
            args.baud,
        ));
    }
    if Device::from(args.device).family().is_some() {
        return refuse("a Rotork device speaks HART: write --hart PATH, or --hart pty");
    }
    block_on(simulate(args))
}

async fn simulate(args: &Args) -> ExitCode {
    let baud = args.baud.unwrap_or(BAUD);
    let mut faults = Vec::new();
    let is_old = args.device == DeviceArg::Icon2000v4;
    for fault in &args.fault {
        match fault {
            FaultArg::Icon(_) if !Device::from(args.device).is_icon() => {
                return refuse("such a --fault is for --device icon3000v2, icon3000, icon2000v4");
            }
            FaultArg::Icon(fault) if fault.is_of_tests() && is_old => {
                return refuse(format_args!(
                    "--fault {} shows in stroke tests; choose --device icon3000v2 or icon3000",
                    fault.key()
                ));
            }
            FaultArg::Icon(fault) => faults.push(*fault),
            FaultArg::Network(fault) => {
                return refuse(format_args!("--fault {fault} is one of a --ddc100 network"));
            }
        }
    }
    let device = DeviceConfig {
        tag: args.tag.clone(),
        device: args.device.into(),
        bus: 0,
        unit: args.unit,
        description: String::new(),
        faults,
        profile: None,
        target: None,
    };
    let actuators = Actuators::with([&device], Clock::start(), args.dop.setup());
    if let Some(address) = args.listen {
        return tcp(address, actuators).await;
    }
    let pace = Pace::real(gap(baud).max(SHORTEST_GAP));
    if let Some(path) = &args.serial {
        let path = path.to_string_lossy();
        return match serial::open(&path, baud, args.parity.mode()) {
            Ok(port) => {
                let mode = args.parity.mode();
                say(&format!(
                    "serving on {path} {baud} {mode}, unit {}",
                    args.unit
                ));
                rtu(port, &actuators, pace).await
            }
            Err(error) => refuse(crate::bus::words::serial(&path, &error)),
        };
    }
    match SerialStream::pair() {
        Ok((ours, theirs)) => {
            let path = theirs.name().unwrap_or_default();
            say(&format!("serving on {path}, unit {}", args.unit));
            // Their end stays open here, so that a client may come and go.
            let code = rtu(ours, &actuators, pace).await;
            drop(theirs);
            code
        }
        Err(error) => refuse(format_args!("can't make a pseudo terminal: {error}")),
    }
}

async fn tcp(address: SocketAddr, actuators: Actuators) -> ExitCode {
    let (listener, listening) = match bind(address).await {
        Ok(bound) => bound,
        Err(error) => {
            return refuse(format_args!(
                "can't listen on {address}: {error}; choose another address with --listen"
            ));
        }
    };
    say(&format!("listening on {listening}"));
    tokio::select! {
        served = sim::serve_tcp(listener, actuators) => match served {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => refuse(format_args!("stopped serving: {error}")),
        },
        () = asked_to_end() => ExitCode::SUCCESS,
    }
}

async fn rtu<S>(line: S, actuators: &Actuators, pace: Pace) -> ExitCode
where
    S: AsyncRead + AsyncWrite + Unpin,
{
    tokio::select! {
        served = sim::serve_rtu(line, actuators, pace) => match served {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => refuse(format_args!("the line is lost: {error}")),
        },
        () = asked_to_end() => ExitCode::SUCCESS,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn registers_have_room() {
        assert_eq!(
            registers("4000,4010,4014,4015,4100"),
            Ok([4000, 4010, 4014, 4015, 4100])
        );
        assert!(registers("0, 1, 5, 6, 7").is_ok());
        assert!(registers("1,2,6,7,65024").is_ok());
        for bad in [
            "",
            "1,2,6,7",
            "1,2,6,7,8,9",
            "1,2,6,7,x",
            "1,2,5,7,8",
            "500,2,6,7,8",
            "1,2,6,7,65025",
            "1,2,6,7,70000",
            "1,1,6,7,8",
        ] {
            assert!(registers(bad).is_err(), "{bad}");
        }
    }
}
