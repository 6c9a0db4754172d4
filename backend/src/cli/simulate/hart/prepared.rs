//! Options that set a HART device up before anybody asks it.

use shared::device::Family;
use shared::hart::PRESETS;
use shared::hart::ne107::Map;
use shared::sim::Programme;
use shared::sim::hart::{HartDevice, HartSetup};

/// How the device was left by whoever had it before.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "With --hart")]
pub(super) struct PreparedArgs {
    /// The condensed status map of an example of the manual, as iq_example.
    #[arg(long, value_name = "KEY")]
    map: Option<String>,
    /// A fixed loop current in mA, 3.5 to 20.5, as command 40 leaves it.
    #[arg(long, value_name = "MA", value_parser = current)]
    fixed: Option<f32>,
    /// The current on the loop in mA, 0 to 24; it stays.
    #[arg(long, value_name = "MA", value_parser = current)]
    signal: Option<f32>,
    /// The valve is stuck: after 10 s of trying to move it, the actuator is stalled.
    #[arg(long)]
    stuck: bool,
    /// The field unit does not reach the main board of the actuator.
    #[arg(long)]
    no_board: bool,
    /// Commands 22 and 42 take so many milliseconds, and answer with "delayed" until then.
    #[arg(long, value_name = "MS", default_value_t = 0, value_parser = clap::value_parser!(u32).range(0..=600_000))]
    delayed: u32,
    /// Leave so many requests unanswered.
    #[arg(long, value_name = "N", default_value_t = 0)]
    silent: u32,
}

fn current(text: &str) -> Result<f32, String> {
    let current = text.parse().ok().filter(|ma| (0.0..=24.0).contains(ma));
    current.ok_or_else(|| "write milliamperes from 0 to 24, as 12.5".into())
}

impl PreparedArgs {
    /// The device with what has to be known when it is made.
    pub(super) fn setup(&self, setup: HartSetup) -> HartSetup {
        HartSetup {
            delayed_ms: self.delayed,
            signal: self.signal.unwrap_or(setup.signal),
            programme: match self.signal {
                Some(_) => Programme::Idle,
                None => setup.programme,
            },
            ..setup
        }
    }

    /// Leaves the device as it is to be found.
    pub(super) fn prepare(&self, device: &mut HartDevice) -> Result<(), String> {
        let family = device.setup().family;
        if let Some(key) = &self.map {
            let preset = PRESETS.iter().find(|p| p.family == family && p.key == *key);
            for bit in preset.ok_or_else(|| no_map(family, key))?.bits {
                device.set_category(Map::index(bit.byte, bit.bit), bit.category);
            }
        }
        if let Some(current) = self.fixed
            && !device.set_fixed(current)
        {
            return Err(match family {
                Family::Cma => "a CMA has no command 40, so it has no fixed current".into(),
                _ => format!("{current} mA can't be fixed; write 3.5 to 20.5"),
            });
        }
        device.set_stuck(self.stuck);
        device.set_main_board(!self.no_board);
        device.set_silent(self.silent);
        Ok(())
    }
}

fn no_map(family: Family, key: &str) -> String {
    let of = |p: &shared::hart::model::Preset| format!("{} for {}", p.key, p.family.key());
    let all: Vec<String> = PRESETS.iter().map(of).collect();
    format!(
        "{key} is no example of the manual for a {}; there are {}",
        family.label(),
        all.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use shared::capture::Micros;
    use shared::hart::frame::{FILL, seal};
    use shared::sim::hart::HartLine;

    #[derive(Debug, Parser)]
    struct Line {
        #[command(flatten)]
        prepared: PreparedArgs,
    }

    fn device(family: Family, options: &[&str]) -> Result<HartDevice, String> {
        let line = [&["simulate"], options].concat();
        let line = Line::try_parse_from(line).map_err(|e| e.to_string())?;
        let setup = line.prepared.setup(HartSetup {
            programme: Programme::Modulating,
            ..HartSetup::of(family)
        });
        let mut device = HartDevice::new("FV-401", setup);
        line.prepared.prepare(&mut device)?;
        Ok(device)
    }

    /// A line with the device, some seconds later.
    struct Bench(HartLine, Micros);

    impl Bench {
        fn new(family: Family, options: &[&str], seconds: u64) -> Self {
            let device = device(family, options).unwrap();
            let mut line = HartLine::new(1200, vec![device]);
            assert!(line.advance(Micros::new(0)).is_empty());
            let now = Micros::new(seconds * 1_000_000);
            assert!(line.advance(now).is_empty());
            Self(line, now)
        }

        /// Response code, device status and data; `None` for silence.
        fn ask(&mut self, command: u8, data: &[u8]) -> Option<(u8, u8, Vec<u8>)> {
            let address = [0xAE, 0xDD, 0x01, 0x23, 0x45];
            let frame = seal(0x82, &address, command, data);
            self.0.push(&[vec![FILL; 5], frame].concat(), self.1);
            self.1 = self.1.plus(1_500_000);
            let answer = self.0.advance(self.1);
            let body = answer.get(13..answer.len().checked_sub(1)?)?;
            Some((body[0], body[1], body[2..].to_vec()))
        }
    }

    #[test]
    fn the_map_of_an_example_is_there() {
        let mut bench = Bench::new(Family::Iq, &["--map", "iq_example"], 1);
        // Frame R23 of the readings: table 20, two entries a byte, the smaller index in the low half.
        let (code, _, data) = bench.ask(31, &[0x02, 0x0B, 8, 24]).unwrap();
        let by_hand = [2, 0x0B, 8, 24, 0x30, 0x40, 0, 0x51, 4, 5, 0, 0, 5, 3, 0, 0];
        assert_eq!((code, &data[..]), (0, &by_hand[..]));
        let mut bench = Bench::new(Family::Ck, &[], 1);
        let (_, _, data) = bench.ask(31, &[0x02, 0x0B, 8, 24]).unwrap();
        assert_eq!(data[4..], [0; 12]);
    }

    #[test]
    fn an_unknown_map_says_which_there_are() {
        for (family, key) in [
            (Family::Iq, "table20"),
            (Family::Ck, "iq_example"),
            (Family::Cma, "cma_example"),
        ] {
            let error = device(family, &["--map", key]).unwrap_err();
            assert!(error.contains(key), "{error}");
            for known in [
                "iq_example for rotork-iq",
                "ck_example for rotork-ck",
                "si_example for rotork-si",
            ] {
                assert!(error.contains(known), "{error}");
            }
        }
    }

    #[test]
    fn currents_are_fixed_or_flow() {
        let loop_current = |bench: &mut Bench| {
            let (_, status, data) = bench.ask(2, &[]).unwrap();
            let current = f32::from_be_bytes(data[..4].try_into().unwrap());
            (current, status & 0x0D)
        };
        // Table 4: bit 3 fixed, bits 2 and 0 saturated and out of limits.
        let mut bench = Bench::new(Family::Si, &["--fixed", "16"], 30);
        assert_eq!(loop_current(&mut bench), (16.0, 0x08));
        for (current, flags) in [("7.5", 0), ("3", 0x05), ("21", 0x05)] {
            let mut bench = Bench::new(Family::Si, &["--signal", current], 90);
            let (measured, status) = loop_current(&mut bench);
            let wanted: f32 = current.parse().unwrap();
            assert!((measured - wanted).abs() < 0.001, "{measured}");
            assert_eq!(status, flags, "{current}");
        }
        for bad in ["3.4", "20.6", "0"] {
            let error = device(Family::Iq, &["--fixed", bad]).unwrap_err();
            assert!(error.contains("3.5 to 20.5"), "{error}");
        }
        for bad in ["-1", "25", "NaN", "12 mA", ""] {
            assert!(
                device(Family::Iq, &["--signal", bad]).is_err(),
                "{bad} is taken"
            );
        }
        let error = device(Family::Cma, &["--fixed", "12"]).unwrap_err();
        assert!(error.contains("no command 40"), "{error}");
    }

    #[test]
    fn faults_of_the_actuator_show() {
        // Stuck at the closed end with 20 mA: stalled after 10 s (table 8, bits 1.0 and 2.1).
        let mut bench = Bench::new(Family::Iq, &["--stuck", "--signal", "20"], 15);
        let (_, _, own) = bench.ask(48, &[]).unwrap();
        assert_eq!(own[..4], [0, 0x01, 0x02, 0]);
        // Without the main board command 133 has code 73, and the device says malfunction.
        let mut bench = Bench::new(Family::Ck, &["--no-board"], 1);
        assert_eq!(bench.ask(133, &[]).unwrap().0, 73);
        let (_, status, own) = bench.ask(48, &[]).unwrap();
        assert_eq!((status & 0x80, own[5] & 0x04), (0x80, 0x04));
    }

    #[test]
    fn answers_are_delayed_or_missing() {
        let mut bench = Bench::new(Family::Iq, &["--delayed", "4000"], 1);
        let tag = [b'A'; 32];
        let codes: Vec<u8> = (0..4).map(|_| bench.ask(22, &tag).unwrap().0).collect();
        // Asked every 1.5 s: begun, running, running, done after 4.5 s.
        assert_eq!(codes, [33, 34, 34, 0]);
        let mut bench = Bench::new(Family::Iq, &["--silent", "2"], 1);
        let silent: Vec<bool> = (0..3).map(|_| bench.ask(3, &[]).is_none()).collect();
        assert_eq!(silent, [true, true, false]);
        assert!(device(Family::Iq, &["--delayed", "600001"]).is_err());
    }
}
