//! `valvescope ddc100 poll`: polls a network without a page, for people at a terminal.

use crate::bus::board::Board;
use crate::bus::ddc::{Common, start};
use crate::cli::refuse;
use crate::clock::Clock;
use crate::config::{Config, DdcConfig, DeviceConfig};
use crate::sim;
use shared::capture::Micros;
use shared::ddc100::HostPort;
use shared::ddc100::diagnosis::{Diagnosis, Finding, diagnose};
use shared::ddc100::follow::Follower;
use shared::ddc100::scaling::Scaling;
use shared::ddc100::view::View;
use shared::device::Device;
use shared::image::Image;
use shared::proto::{DdcNews, DdcShape, LineState, Outcome};
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
    /// End after so many passes; 0 goes on for ever. After two, each unit was tried on each port;
    /// two more bear that out.
    #[arg(long, default_value_t = 4)]
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
    let mut state = State::new(bus.name.clone(), ddc, devices);
    let mut seen = 0;
    loop {
        let (news, version) = network.news.news(seen);
        seen = version;
        let before = state.pass;
        news.iter()
            .filter_map(|text| DdcNews::from_text(text))
            .for_each(|news| state.take(news));
        if state.pass > before {
            let table = state.table(clock.now());
            match io::stdout().lock().write_all(table.as_bytes()) {
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
    devices: Vec<DeviceConfig>,
    scalings: BTreeMap<u8, Scaling>,
    units: BTreeMap<u8, Unit>,
    faults: Follower,
    /// What happened to host ports that are lost.
    lost: BTreeMap<u8, String>,
    hint: Option<String>,
    /// Number of the last pass, and how long it took.
    pass: u64,
    took_us: u64,
}

#[derive(Default)]
struct Unit {
    outcome: Option<Outcome>,
    text: String,
    image: Image,
    /// When the last good answer came, and how long it took.
    good: Option<(Micros, u64)>,
}

impl State {
    fn new(bus: String, ddc: &DdcConfig, devices: Vec<DeviceConfig>) -> Self {
        let second = ddc.paths().len() > 1;
        Self {
            bus,
            shape: ddc.shape,
            faults: Follower::new(devices.iter().map(|d| d.unit), second),
            devices,
            scalings: ddc.scalings.clone(),
            units: BTreeMap::new(),
            lost: BTreeMap::new(),
            hint: None,
            pass: 0,
            took_us: 0,
        }
    }

    fn take(&mut self, news: DdcNews) {
        self.faults.hear(&news);
        match news {
            DdcNews::Network { hint, .. } => self.hint = hint,
            DdcNews::Unit {
                unit,
                outcome,
                text,
                request,
                response,
                at_us,
                took_us,
                ..
            } => {
                let unit = self.units.entry(unit).or_default();
                unit.outcome = Some(outcome);
                unit.text = text;
                unit.good = at_us.map(Micros::new).zip(took_us);
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
                port, text, state, ..
            } => {
                if state == LineState::Down {
                    self.lost.insert(port, text);
                } else {
                    self.lost.remove(&port);
                }
            }
            DdcNews::Poll { .. } | DdcNews::Read { .. } => {}
        }
    }

    /// All that is known at a time.
    fn table(&self, now: Micros) -> String {
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
        let faults = self.faults.table();
        for device in &self.devices {
            let fault = |port| match faults.fault(device.unit, port) {
                None => "-",
                Some(false) => "ok",
                Some(true) => "FAULT",
            };
            let [position, answer, state] = self.cells(device, now);
            let _ = writeln!(
                out,
                "{:>4}  {:width$}  {:16}  {:6}  {:6}  {position:>8}  {answer:>7}  {state}",
                device.unit,
                device.tag,
                device.device.key(),
                fault(HostPort::One),
                fault(HostPort::Two),
            );
        }
        for (port, text) in &self.lost {
            let _ = writeln!(out, "host port {port} is lost: {text}");
        }
        if let Some(hint) = &self.hint {
            let _ = writeln!(out, "note: {hint}");
        }
        out.push_str(&meaning(&diagnose(self.shape, faults)));
        out
    }

    /// Position, time of the answer and state of a unit. What a unit said before its last poll
    /// failed is told as such, with its age.
    fn cells(&self, device: &DeviceConfig, now: Micros) -> [String; 3] {
        let none = || "-".to_owned();
        let Some(unit) = self.units.get(&device.unit) else {
            return [none(), none(), "not polled yet".to_owned()];
        };
        let scaling = self.scalings.get(&device.unit).copied();
        let view = View::of(device.device, &unit.image, |_| scaling.unwrap_or_default());
        // An I/O module has no selector.
        let mode = (device.device != Device::Ddc100Io).then(|| view.mode.label());
        let faults = view.faults.iter().map(|bit| bit.member.label);
        let words: Vec<&str> = [Some(view.state.as_str()), mode]
            .into_iter()
            .flatten()
            .chain(faults)
            .collect();
        let words = words.join(", ");
        let position = view.position.map(|p| p.to_string());
        match (unit.good, unit.outcome) {
            (Some((_, took_us)), Some(Outcome::Ok)) => {
                let answer = format!("{} ms", (took_us + 500) / 1000);
                [position.unwrap_or_else(none), answer, words]
            }
            (Some((at, _)), _) => {
                let seconds = now.since(at) / 1_000_000;
                let position = position.map(|p| format!("{p}, ")).unwrap_or_default();
                let state = format!("{}; was: {position}{words}, {seconds} s ago", unit.text);
                [none(), none(), state]
            }
            (None, _) => [none(), none(), unit.text.clone()],
        }
    }
}

/// What the pattern of faults means, how sure that is, and what else it could be.
fn meaning(diagnosis: &Diagnosis) -> String {
    let mut out = String::new();
    let caution = diagnosis.caution();
    if !caution.is_empty() {
        let _ = writeln!(out, "{caution}");
    }
    for finding in &diagnosis.findings {
        let sure = match diagnosis.is_certain(finding) {
            true => "certain",
            false if matches!(finding, Finding::Untried(_)) => "unknown",
            false if finding.is_ambiguous() => "ambiguous",
            false if diagnosis.unsettled > 0 => "preliminary",
            false => "in doubt",
        };
        let _ = writeln!(out, "{sure}: {finding}");
        let why = finding.why();
        if !why.is_empty() {
            let _ = writeln!(out, "    {why}");
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::{DdcPorts, Mode};
    use shared::frame::Framing;

    /// A loop of a UEC-3-DDC, an MX/DDC and an I/O module.
    fn state() -> State {
        let kinds = [Device::Ddc100Uec, Device::Ddc100Mx, Device::Ddc100Io];
        let devices = (1..).zip(kinds).map(|(unit, device)| DeviceConfig {
            tag: format!("MOV-{unit}"),
            device,
            bus: 0,
            unit,
            description: String::new(),
            faults: Vec::new(),
            profile: None,
            target: None,
        });
        let ddc = DdcConfig {
            ports: DdcPorts::Simulated(Vec::new()),
            framing: Framing::Rtu,
            baud: 9600,
            mode: Mode::parse("8N1").unwrap(),
            shape: DdcShape::Loop,
            start: 7,
            count: 9,
            retry_faulty: false,
            scalings: BTreeMap::from([(2, Scaling::TwelveBits)]),
        };
        State::new("Jetty".into(), &ddc, devices.collect())
    }

    /// A poll through a port, and registers 8, 9 and 12 at a second if it answered.
    fn unit(unit: u8, port: u8, faults: [u8; 2], good: Option<(u64, [u16; 2])>) -> DdcNews {
        let [fault_a, fault_b] = faults.map(|f| (f < 2).then_some(f == 1));
        let known = good.is_some_and(|(_, words)| words != [0, 0]);
        let words = good.map_or([0; 2], |(_, words)| words);
        DdcNews::Unit {
            bus: "Jetty".into(),
            unit,
            port,
            outcome: if known { Outcome::Ok } else { Outcome::Silence },
            text: if known { "" } else { "no answer" }.into(),
            fault_a,
            fault_b,
            request: "0300070005".into(),
            response: match known {
                true => format!("030a{:04x}{:04x}000000000801", words[0], words[1]),
                false => String::new(),
            },
            at_us: good.map(|(at, _)| at * 1_000_000),
            took_us: good.map(|_| 109_400),
        }
    }

    fn pass(port: u8, number: u64) -> DdcNews {
        DdcNews::Pass {
            bus: "Jetty".into(),
            port,
            number,
            took_us: 1_234_567,
            expected_us: 1,
        }
    }

    fn hear(state: &mut State, news: impl IntoIterator<Item = DdcNews>) {
        news.into_iter().for_each(|news| state.take(news));
    }

    /// Lines of the table that begin so, with single spaces.
    fn lines(state: &State, second: u64, start: &str) -> Vec<String> {
        let table = state.table(Micros::new(second * 1_000_000));
        let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        let all = table.lines().map(words);
        all.filter(|l| l.starts_with(start)).collect()
    }

    const GOOD: [Option<(u64, [u16; 2])>; 3] = [
        Some((5, [61, 0x0804])),
        Some((5, [4095, 0x0001])),
        Some((5, [50, 0x0800])),
    ];

    fn round(state: &mut State, faults: [[u8; 2]; 3], from: u64) {
        for number in from..from + 2 {
            let port = if number % 2 == 1 { 1 } else { 2 };
            let polls = (1..).zip(faults).zip(GOOD);
            hear(
                state,
                polls.map(|((at, faults), good)| unit(at, port, faults, good)),
            );
            hear(state, [pass(port, number)]);
        }
    }

    #[test]
    fn units_as_they_are() {
        let mut state = state();
        assert_eq!(
            lines(&state, 0, "1 "),
            ["1 MOV-1 ddc100-uec - - - - not polled yet"]
        );
        assert_eq!(lines(&state, 0, "unknown").len(), 1, "not known yet");
        round(&mut state, [[0, 0]; 3], 1);
        round(&mut state, [[0, 0]; 3], 3);
        assert_eq!(lines(&state, 6, "Jetty"), ["Jetty, pass 4: 1.23 s"]);
        // 4095 of 4095, as the tag list scales unit 2.
        assert_eq!(
            [1, 2, 3].map(|n| lines(&state, 6, &format!("{n} ")).concat()),
            [
                "1 MOV-1 ddc100-uec ok ok 61 % 109 ms Stopped between the ends, Remote",
                "2 MOV-2 ddc100-mx ok ok 100.0 % 109 ms Open, Remote",
                "3 MOV-3 ddc100-io ok ok - 109 ms I/O module",
            ]
        );
        let found = lines(&state, 6, "certain");
        assert_eq!(
            found,
            ["certain: No fault: every unit answers through every port."]
        );
    }

    /// What a unit said before it fell silent is told with its age; one that never spoke has nothing.
    #[test]
    fn what_was_is_told_as_such() {
        let mut state = state();
        round(&mut state, [[0, 0]; 3], 1);
        let DdcNews::Unit {
            bus,
            unit,
            port,
            request,
            response,
            at_us,
            took_us,
            ..
        } = unit(1, 1, [1, 1], GOOD[0])
        else {
            unreachable!()
        };
        state.take(DdcNews::Unit {
            bus,
            unit,
            port,
            outcome: Outcome::Silence,
            text: "no answer within 250 ms".into(),
            fault_a: Some(true),
            fault_b: Some(true),
            request,
            response,
            at_us,
            took_us,
        });
        assert_eq!(
            lines(&state, 17, "1 "),
            [
                "1 MOV-1 ddc100-uec FAULT FAULT - - no answer within 250 ms; was: 61 %, Stopped between the ends, Remote, 12 s ago"
            ]
        );
        let mut state = self::state();
        state.take(self::unit(2, 1, [1, 1], None));
        assert_eq!(
            lines(&state, 17, "2 "),
            ["2 MOV-2 ddc100-mx FAULT FAULT - - no answer"]
        );
    }

    /// A change is preliminary until each unit was polled again on each port; then it is certain, or
    /// ambiguous with the reason.
    #[test]
    fn findings_say_how_sure_they_are() {
        let mut state = state();
        round(&mut state, [[0, 0]; 3], 1);
        state.take(unit(1, 1, [0, 1], GOOD[0]));
        let table = state.table(Micros::new(0));
        assert!(table.contains("\nPreliminary: "), "{table}");
        assert!(!table.contains("certain: "), "{table}");
        round(&mut state, [[0, 1], [1, 0], [1, 0]], 3);
        round(&mut state, [[0, 1], [1, 0], [1, 0]], 5);
        assert_eq!(
            lines(&state, 9, "certain"),
            [
                "certain: Break or short between unit 1 and unit 2: look at the cable, its terminals and its termination there."
            ]
        );
        assert!(lines(&state, 9, "Preliminary").is_empty());
        round(&mut state, [[0, 1], [1, 1], [1, 0]], 7);
        round(&mut state, [[0, 1], [1, 1], [1, 0]], 9);
        let table = state.table(Micros::new(0));
        assert!(
            table.contains("\nambiguous: Break or short somewhere"),
            "{table}"
        );
        assert!(
            table.contains("\n    unit 2 between: without power"),
            "{table}"
        );
    }

    /// A port that the host itself lost is no cable that is broken.
    #[test]
    fn a_lost_port_is_told() {
        let mut state = state();
        round(&mut state, [[0, 0]; 3], 1);
        let port = |state, text: &str| DdcNews::Port {
            bus: "Jetty".into(),
            port: 2,
            state,
            text: text.into(),
        };
        state.take(port(LineState::Down, "unplugged"));
        for unit in 1..=3 {
            state.take(self::unit(unit, 1, [0, 1], GOOD[usize::from(unit) - 1]));
        }
        assert_eq!(
            lines(&state, 9, "host port"),
            ["host port 2 is lost: unplugged"]
        );
        let table = state.table(Micros::new(0));
        assert!(
            table.contains(": The host lost host port 2: see to"),
            "{table}"
        );
        assert!(!table.contains("Loss of host port 2"), "{table}");
        assert!(lines(&state, 9, "1 ").concat().contains("ok FAULT"));
        state.take(port(LineState::Up, "open"));
        assert!(lines(&state, 9, "host port").is_empty());
        assert!(lines(&state, 9, "1 ").concat().contains("ok - "));
    }

    #[test]
    fn a_hint_is_told() {
        let mut state = state();
        assert!(lines(&state, 0, "note").is_empty());
        state.hint = Some("many units".into());
        assert_eq!(lines(&state, 0, "note"), ["note: many units"]);
    }
}
