//! `valvescope ddc100 poll`: polls a network without a page, for people at a terminal.

use crate::bus::board::Board;
use crate::bus::ddc::{Common, start};
use crate::cli::refuse;
use crate::clock::Clock;
use crate::config::{Config, DeviceConfig};
use crate::sim;
use shared::capture::Micros;
use shared::ddc100::diagnosis::diagnose;
use shared::ddc100::scaling::Scaling;
use shared::ddc100::view::View;
use shared::ddc100::{FaultTable, HostPort};
use shared::device::Device;
use shared::image::Image;
use shared::proto::{DdcNews, DdcShape, Outcome};
use shared::text::read_hex;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, ErrorKind, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;
use tokio::sync::watch;

/// What to poll.
#[derive(Debug, clap::Args)]
pub(super) struct PollArgs {
    /// What is connected where; see `valvescope serve`.
    #[arg(long, value_name = "FILE")]
    config: Option<PathBuf>,
    /// Name of the network, if the file has several.
    #[arg(long)]
    bus: Option<String>,
    /// End after so many passes; 0 goes on for ever. After two, each unit was tried on each port.
    #[arg(long, default_value_t = 2)]
    passes: u64,
}

/// Polls, and prints a table after each pass.
pub(super) async fn run(args: &PollArgs) -> ExitCode {
    let config = match Config::load(args.config.as_deref()) {
        Ok(config) => config,
        Err(error) => return refuse(error),
    };
    let networks = || config.buses.iter().filter(|b| b.line.ddc().is_some());
    let found = match &args.bus {
        Some(name) => networks().find(|b| b.name == *name),
        None => networks().next(),
    };
    let Some((bus, ddc)) = found.and_then(|bus| Some((bus, bus.line.ddc()?))) else {
        let names: Vec<String> = networks().map(|b| format!("\"{}\"", b.name)).collect();
        return refuse(match names.is_empty() {
            true => "the configuration has no bus of kind \"ddc100\"; add one".to_owned(),
            false => format!("there is no such network; write {}", names.join(" or ")),
        });
    };
    let devices: Vec<DeviceConfig> = config.on(bus).cloned().collect();
    let clock = Clock::start();
    let activity = watch::Sender::new(0);
    let mut changes = activity.subscribe();
    let plugs = sim::ddc::plugs(ddc, &devices, clock);
    let common = Common {
        clock,
        board: Board::new(activity.clone()),
        activity,
    };
    let Some(network) = start(bus, ddc, &devices, plugs, common) else {
        return refuse("so many registers can't be read at once");
    };
    let mut state = State {
        bus: bus.name.clone(),
        shape: ddc.shape,
        second: ddc.paths().len() > 1,
        devices,
        units: BTreeMap::new(),
        pass: 0,
        took_us: 0,
    };
    let mut seen = 0;
    loop {
        let (news, version) = network.news.news(seen);
        seen = version;
        let before = state.pass;
        news.iter()
            .filter_map(|text| DdcNews::from_text(text))
            .for_each(|news| state.take(news));
        if state.pass > before {
            match io::stdout().lock().write_all(state.table().as_bytes()) {
                Ok(()) => {}
                Err(error) if error.kind() == ErrorKind::BrokenPipe => return ExitCode::SUCCESS,
                Err(error) => return refuse(format_args!("can't print the table: {error}")),
            }
            if args.passes != 0 && state.pass >= args.passes {
                return ExitCode::SUCCESS;
            }
        }
        tokio::select! {
            changed = changes.changed() => if changed.is_err() { return ExitCode::SUCCESS },
            () = crate::cli::asked_to_end() => return ExitCode::SUCCESS,
        }
    }
}

/// What is known of a network.
struct State {
    bus: String,
    shape: DdcShape,
    second: bool,
    devices: Vec<DeviceConfig>,
    units: BTreeMap<u8, Unit>,
    /// Number of the last pass, and how long it took.
    pass: u64,
    took_us: u64,
}

#[derive(Default)]
struct Unit {
    faults: [Option<bool>; 2],
    outcome: Option<Outcome>,
    text: String,
    image: Image,
    took_us: Option<u64>,
}

impl State {
    fn take(&mut self, news: DdcNews) {
        match news {
            DdcNews::Unit {
                unit,
                outcome,
                text,
                fault_a,
                fault_b,
                request,
                response,
                at_us,
                took_us,
                ..
            } => {
                let unit = self.units.entry(unit).or_default();
                unit.faults = [fault_a, fault_b];
                unit.outcome = Some(outcome);
                unit.text = text;
                unit.took_us = took_us;
                let (request, response) = (
                    read_hex(request.as_bytes()).0,
                    read_hex(response.as_bytes()).0,
                );
                let at = Micros::new(at_us.unwrap_or(0));
                // An answer that makes no sense changes nothing.
                let _refused = unit.image.absorb(&request, &response, at);
            }
            DdcNews::Pass {
                number, took_us, ..
            } => {
                self.pass = number;
                self.took_us = took_us;
            }
            DdcNews::Port {
                port,
                text,
                state: shared::proto::LineState::Down,
                ..
            } => eprintln!("valvescope: host port {port}: {text}"),
            _ => {}
        }
    }

    fn table(&self) -> String {
        let mut out = String::new();
        let seconds = self.took_us / 10_000;
        // Writing to a String cannot fail.
        let _ = writeln!(
            out,
            "\n{}, pass {}: {}.{:02} s",
            self.bus,
            self.pass,
            seconds / 100,
            seconds % 100
        );
        let width = self.devices.iter().map(|d| d.tag.chars().count());
        let width = width.max().unwrap_or(0).max(3);
        let _ = writeln!(
            out,
            "unit  {:width$}  {:16}  port 1  port 2  position  answer   state",
            "tag", "type"
        );
        let mut faults = FaultTable::new(self.devices.iter().map(|d| d.unit), self.second);
        for device in &self.devices {
            let unit = self.units.get(&device.unit);
            let fault = |at: usize| unit.and_then(|u| u.faults.get(at).copied().flatten());
            for (at, port) in HostPort::BOTH.into_iter().enumerate() {
                if let Some(failed) = fault(at) {
                    faults.note(device.unit, port, failed);
                }
            }
            let word = |fault| match fault {
                None => "-",
                Some(false) => "ok",
                Some(true) => "FAULT",
            };
            let view = unit.map(|u| View::of(device.device, &u.image, |_| Scaling::default()));
            let (position, state) = match &view {
                Some(view) if unit.is_some_and(|u| u.took_us.is_some()) => {
                    let position = view.position.map(|p| p.to_string());
                    // An I/O module has no selector.
                    let valve = device.device != Device::Ddc100Io;
                    let mode = valve.then(|| view.mode.label());
                    let faults = view.faults.iter().map(|bit| bit.member.label);
                    let words: Vec<&str> = [Some(view.state.as_str()), mode]
                        .into_iter()
                        .flatten()
                        .chain(faults)
                        .collect();
                    (position.unwrap_or_default(), words.join(", "))
                }
                _ => (
                    String::new(),
                    unit.map(|u| u.text.clone()).unwrap_or_default(),
                ),
            };
            let answer = match unit.and_then(|u| u.took_us) {
                Some(us) => format!("{} ms", (us + 500) / 1000),
                None => String::new(),
            };
            let _ = writeln!(
                out,
                "{:>4}  {:width$}  {:16}  {:6}  {:6}  {position:>8}  {answer:>7}  {state}",
                device.unit,
                device.tag,
                device.device.key(),
                word(fault(0)),
                word(fault(1)),
            );
        }
        for finding in &diagnose(self.shape, &faults).findings {
            let _ = writeln!(out, "{finding}");
        }
        out
    }
}
