//! What the simulated device does at the edges of its signal: readings H19, H20 and R43, and that it
//! behaves as the simulator's options say.

use shared::capture::Micros;
use shared::device::Family;
use shared::hart::frame::seal;
use shared::sim::hart::{HartDevice, HartLine, HartLoss, HartSetup};

/// Long address of the device from a primary master.
const LONG: [u8; 5] = [0xAE, 0xDD, 0x01, 0x23, 0x45];

/// A device alone on its line, with a master that asks when it likes.
struct Bench {
    line: HartLine,
    at: Micros,
}

impl Bench {
    fn of(setup: HartSetup) -> Self {
        let device = HartDevice::new("FV-401", setup);
        let mut bench = Self {
            line: HartLine::new(setup.baud, vec![device]),
            at: Micros::new(1_000_000),
        };
        bench.wait(0);
        bench.ask(0);
        bench
    }

    fn device(&mut self) -> &mut HartDevice {
        &mut self.line.devices_mut()[0]
    }

    fn wait(&mut self, ms: u64) {
        self.at = self.at.plus(ms * 1000);
        assert!(self.line.advance(self.at).is_empty(), "nobody was asked");
    }

    /// Device status and data of a command that must succeed.
    fn ask(&mut self, command: u8) -> (u8, Vec<u8>) {
        let data: &[u8] = if command == 9 { &[0, 1] } else { &[] };
        let frame = [vec![0xFF; 5], seal(0x82, &LONG, command, data)].concat();
        self.line.push(&frame, self.at);
        self.at = self.at.plus(1_200_000);
        let answer = self.line.advance(self.at);
        assert_eq!(answer[13], 0, "command {command}: {answer:02X?}");
        (answer[14], answer[15..answer.len() - 1].to_vec())
    }

    fn floats(&mut self, command: u8) -> Vec<f32> {
        let (_, data) = self.ask(command);
        let words = data.chunks_exact(4);
        words
            .map(|c| f32::from_be_bytes(c.try_into().unwrap()))
            .collect()
    }
}

fn near(one: f32, other: f32) -> bool {
    (one - other).abs() < 0.001
}

/// Half a milliampere outside 4 to 20 mA the loop current is saturated and the primary variable out
/// of limits, both at once and not before; what is reported stops at 3.125 % outside.
#[test]
fn saturation_begins_at_the_printed_current() {
    // Percent by hand: (mA - 4) / 16, and at most 0.5 / 16 = 3.125 % outside.
    for (current, outside, percent, limit) in [
        (3.49, true, -3.125, 0x10),
        (3.51, false, -3.0625, 0),
        (4.0, false, 0.0, 0),
        (20.0, false, 100.0, 0),
        (20.49, false, 103.0625, 0),
        (20.51, true, 103.125, 0x20),
        (22.0, true, 103.125, 0x20),
    ] {
        for family in Family::ALL {
            let mut bench = Bench::of(HartSetup::of(family));
            bench.device().set_signal(current);
            bench.wait(1_000);
            let (status, _) = bench.ask(3);
            // Bits 2 and 0 of the device status (table 4).
            let flags = if outside { 0x05 } else { 0 };
            assert_eq!(status & 0x0F, flags, "{family:?} {current} mA");
            let loop_current = bench.floats(2);
            assert!(
                near(loop_current[0], current) && near(loop_current[1], percent),
                "{family:?} {current} mA: {loop_current:?}"
            );
            // Status of variables 0 and 1: good, low or high limited.
            let (_, data) = bench.ask(9);
            assert_eq!((data[8], data[16]), (0xC0 | limit, 0xC0 | limit));
            let pv = f32::from_be_bytes(data[12..16].try_into().unwrap());
            assert!(near(pv, percent), "{family:?} {current} mA: {pv}");
        }
    }
}

/// From 4 mA down to 2 mA the valve is sent to 0 % and the signal does not count as lost; below, it
/// does after a second, and the set time-out later the action follows.
#[test]
fn three_milliamperes_close_and_are_no_lost_signal() {
    for family in Family::ALL {
        let mut setup = HartSetup::of(family);
        // A lost signal would open it at once.
        setup.loss = (HartLoss::Open, 0);
        let mut bench = Bench::of(setup);
        bench.device().set_signal(12.0);
        bench.wait(30_000);
        assert!((bench.device().position() - 50.0).abs() < 0.6);
        for current in [3.0, 2.01] {
            bench.device().set_signal(current);
            bench.wait(60_000);
            let position = bench.device().position();
            assert!(position < 0.6, "{family:?} {current} mA: {position}");
            let (status, own) = bench.ask(48);
            assert_eq!(status & 0x05, 0x05, "saturated, and out of limits");
            match family {
                // Table 9, byte 0 bit 1 and byte 1 bit 1: the CMA says when it lost its signal.
                Family::Cma => assert_eq!((own[0] & 0x02, own[1] & 0x02), (0, 0)),
                _ => assert_eq!(own[..4], [0; 4], "{family:?}"),
            }
            // The demand is below its limits: it is reported as such and no number of the valve.
            let (_, data) = bench.ask(1);
            let pv = f32::from_be_bytes(data[1..5].try_into().unwrap());
            assert!(near(pv, -3.125), "{family:?} {current} mA: {pv}");
            let loop_current = bench.floats(2)[0];
            assert!(near(loop_current, current), "{loop_current}");
        }
        bench.device().set_signal(1.99);
        bench.wait(60_000);
        let position = bench.device().position();
        assert!(position > 99.0, "{family:?} lost: {position}");
    }
}
