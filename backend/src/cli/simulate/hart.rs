//! `valvescope simulate --hart`: a HART device, and who else is on its line.

mod prepared;

use super::super::serve::say;
use super::super::{DeviceArg, asked_to_end, refuse};
use crate::bus::hart::MODE;
use crate::clock::Clock;
use crate::serial;
use crate::sim::hart::{Loop, serve};
use shared::device::{Device, Family};
use shared::hart::link::BAUD;
use shared::sim::Programme;
use shared::sim::hart::{HartBurst, HartDevice, HartLine, HartMaster, HartSetup};
use std::process::ExitCode;
use tokio::io::{AsyncRead, AsyncWrite};
use tokio_serial::{SerialPort, SerialStream};

/// How a HART device behaves, and who else is on its line.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "With --hart")]
pub(super) struct HartArgs {
    #[command(flatten)]
    prepared: prepared::PreparedArgs,
    /// Polling address.
    #[arg(long, default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=63))]
    poll: u8,
    /// Device id, six hexadecimal digits.
    #[arg(long, default_value = "012345", value_parser = id)]
    device_id: u32,
    /// Status bits that stand: a key of `valvescope maps --device rotork-…`, or byte.bit of command
    /// 48; may be given more than once.
    #[arg(long, value_name = "BIT")]
    inject: Vec<String>,
    /// Answer so many requests with "busy".
    #[arg(long, default_value_t = 0)]
    busy: u32,
    /// Damage so many answers.
    #[arg(long, default_value_t = 0)]
    damaged: u32,
    /// Send so many answers too late.
    #[arg(long, default_value_t = 0)]
    late: u32,
    /// A second master on the line, of the other kind: it reads command 3 over and over.
    #[arg(long)]
    second_master: bool,
    /// A neighbour that bursts, as often as it may.
    #[arg(long)]
    burst: bool,
    /// The modem repeats what is sent.
    #[arg(long)]
    echo: bool,
    /// The valve stays where it is.
    #[arg(long)]
    resting: bool,
    /// Under digital control (command 79, variable 1) with this demand: it does not follow the loop.
    #[arg(long, value_name = "PERCENT", value_parser = percent, conflicts_with = "factory")]
    digital: Option<f32>,
    /// Under factory control (command 79, variable 4) at this percentage of the factory stroke.
    #[arg(long, value_name = "PERCENT", value_parser = percent)]
    factory: Option<f32>,
}

fn id(text: &str) -> Result<u32, String> {
    let good = text.len() == 6 && text.bytes().all(|b| b.is_ascii_hexdigit());
    let number = u32::from_str_radix(text, 16).ok().filter(|_| good);
    number.ok_or_else(|| "write six hexadecimal digits, as 012345".into())
}

fn percent(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|n| (0.0..=100.0).contains(n));
    number.ok_or_else(|| "write 0 to 100".into())
}

/// Serves the device until it is asked to end. Without a device named it is an IQ.
pub(super) async fn run(
    args: &HartArgs,
    path: &str,
    device: DeviceArg,
    tag: &str,
    baud: Option<u32>,
) -> ExitCode {
    let family = match Device::from(device).family() {
        Some(family) => family,
        None if device == DeviceArg::Icon3000v2 => Family::Iq,
        None => {
            return refuse(
                "with --hart it is a Rotork device; choose rotork-cva, rotork-iq, rotork-cma, \
                 rotork-ck or rotork-si",
            );
        }
    };
    let baud = baud.unwrap_or(BAUD);
    let setup = HartSetup {
        polling: args.poll,
        device_id: args.device_id,
        baud,
        programme: if args.resting {
            Programme::Idle
        } else {
            Programme::Modulating
        },
        ..HartSetup::of(family)
    };
    let mut valve = HartDevice::new(tag, args.prepared.setup(setup));
    if let Err(text) = args.prepared.prepare(&mut valve) {
        return refuse(text);
    }
    for bit in &args.inject {
        if !valve.inject(bit, true) {
            return refuse(format_args!(
                "{bit} is no status bit of a {}; `valvescope maps --device {}` lists them",
                family.label(),
                family.key()
            ));
        }
    }
    if let Some(demand) = args.digital {
        valve.set_digital(demand);
    }
    if let Some(place) = args.factory {
        valve.set_factory(place);
    }
    valve.set_busy(args.busy);
    valve.set_damaged(args.damaged);
    valve.set_late(args.late);
    let address = valve.long_address();
    let mut line = HartLine::new(baud, vec![valve]);
    if args.second_master {
        let mut master = HartMaster::new(baud, false, 0);
        master.ask(&address, 3, &[]);
        line.set_master(Some(master));
    }
    if args.burst {
        line.add_burst(HartBurst::new(baud, 63, 0));
    }
    line.set_echo(args.echo);
    let simulated = Loop::new(line, Clock::start());
    let what = format!("{baud} {MODE}, polling address {}", args.poll);
    if path != "pty" {
        return match serial::open(path, baud, MODE) {
            Ok(port) => {
                say(&format!("serving on {path} {what}"));
                until_end(port, &simulated).await
            }
            Err(error) => refuse(crate::bus::words::serial(path, &error)),
        };
    }
    match SerialStream::pair() {
        Ok((ours, theirs)) => {
            let path = theirs.name().unwrap_or_default();
            say(&format!("serving on {path} {what}"));
            // Their end stays open here, so that a client may come and go.
            let code = until_end(ours, &simulated).await;
            drop(theirs);
            code
        }
        Err(error) => refuse(format_args!("can't make a pseudo terminal: {error}")),
    }
}

async fn until_end<S>(line: S, simulated: &Loop) -> ExitCode
where
    S: AsyncRead + AsyncWrite + Unpin,
{
    tokio::select! {
        served = serve(line, simulated) => match served {
            Ok(()) => ExitCode::SUCCESS,
            Err(error) => refuse(format_args!("the line is lost: {error}")),
        },
        () = asked_to_end() => ExitCode::SUCCESS,
    }
}
