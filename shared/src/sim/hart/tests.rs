use super::*;
use crate::capture::Micros;
use crate::device::Family;

/// Long address of the device 012345 from a primary master.
const LONG: [u8; 5] = [0xAE, 0xDD, 0x01, 0x23, 0x45];

/// A master that asks when it likes, with a device alone on its line.
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
        assert!(bench.line.advance(bench.at).is_empty());
        bench
    }

    fn new(family: Family) -> Self {
        Self::of(HartSetup::of(family))
    }

    fn device(&mut self) -> &mut HartDevice {
        &mut self.line.devices_mut()[0]
    }

    /// Lets time go on.
    fn wait(&mut self, ms: u64) {
        self.at = Micros::new(self.at.get() + ms * 1000);
        assert!(self.line.advance(self.at).is_empty(), "nobody was asked");
    }

    /// Sends characters and gives what comes back, preamble included.
    fn raw(&mut self, bytes: &[u8]) -> Vec<u8> {
        self.line.push(bytes, self.at);
        let us = bytes.len() as u64 * 9_167 + 1_200_000;
        self.at = Micros::new(self.at.get() + us);
        self.line.advance(self.at)
    }

    /// Asks by the long address; response code, device status and data.
    fn ask(&mut self, command: u8, data: &[u8]) -> (u8, u8, Vec<u8>) {
        self.ask_as(LONG, command, data)
    }

    fn ask_as(&mut self, address: [u8; 5], command: u8, data: &[u8]) -> (u8, u8, Vec<u8>) {
        let mut frame = vec![0xFF; 5];
        frame.push(0x82);
        frame.extend(address);
        frame.extend([command, data.len() as u8]);
        frame.extend(data);
        frame.push(frame[5..].iter().fold(0, |sum, b| sum ^ b));
        let answer = self.raw(&frame);
        assert!(answer.len() > 15, "command {command}: {answer:02X?}");
        assert_eq!(answer[..5], [0xFF; 5]);
        assert_eq!(answer[5], 0x86);
        assert_eq!(answer[6..11], address);
        assert_eq!(answer[11], command);
        assert_eq!(usize::from(answer[12]) + 14, answer.len());
        assert_eq!(answer[5..].iter().fold(0, |sum, b| sum ^ b), 0);
        (
            answer[13],
            answer[14],
            answer[15..answer.len() - 1].to_vec(),
        )
    }

    /// Data of an answer that must be a success.
    fn get(&mut self, command: u8, data: &[u8]) -> Vec<u8> {
        let (code, _, data) = self.ask(command, data);
        assert_eq!(code, 0, "command {command}");
        data
    }

    /// The response code of an answer.
    fn code(&mut self, command: u8, data: &[u8]) -> u8 {
        self.ask(command, data).0
    }

    /// An extended command: code and data behind the number.
    fn extended(&mut self, number: u16, data: &[u8]) -> (u8, Vec<u8>) {
        let body = [&number.to_be_bytes()[..], data].concat();
        let (code, _, answer) = self.ask(31, &body);
        assert_eq!(answer[..2], number.to_be_bytes());
        (code, answer[2..].to_vec())
    }

    fn floats(&mut self, command: u8) -> Vec<f32> {
        let data = self.get(command, &[]);
        data.chunks(4)
            .map(|c| f32::from_be_bytes(c.try_into().unwrap()))
            .collect()
    }
}

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace()
        .map(|b| u8::from_str_radix(b, 16).unwrap())
        .collect()
}

#[test]
fn it_answers_command_0_at_its_polling_address() {
    // Frame P1 of the readings, and the form of R2: HART 7, 22 bytes, cold start, type 6EDD.
    let mut bench = Bench::new(Family::Iq);
    let answer = bench.raw(&bytes("FF FF FF FF FF 02 80 00 00 82"));
    let expected = bytes(
        "FF FF FF FF FF 06 80 00 18 00 20 FE 6E DD 05 07 02 01 08 00 01 23 45 05 04 00 00 00 00 6E 00 6E 01",
    );
    assert_eq!(answer[..answer.len() - 1], expected);
    // The cold start was told to the primary master; the secondary has not heard it.
    assert_eq!(bench.ask(0, &[]).1, 0x00);
    assert_eq!(bench.ask_as([0x2E, 0xDD, 1, 0x23, 0x45], 0, &[]).1, 0x20);
    assert_eq!(bench.ask_as([0x2E, 0xDD, 1, 0x23, 0x45], 0, &[]).1, 0x00);
    // Another polling address, and another command at the right one: silence.
    assert!(
        bench
            .raw(&bytes("FF FF FF FF FF 02 81 00 00 83"))
            .is_empty()
    );
    assert!(
        bench
            .raw(&bytes("FF FF FF FF FF 02 80 03 00 81"))
            .is_empty()
    );
    // Expansion bytes that it does not know: silence (reading G10).
    assert!(
        bench
            .raw(&bytes("FF FF FF FF FF 22 80 00 00 00 A2"))
            .is_empty()
    );
}

#[test]
fn answers_come_at_the_pace_of_the_line() {
    let setup = HartSetup::of(Family::Iq);
    let mut line = HartLine::new(1200, vec![HartDevice::new("FV-401", setup)]);
    let start = Micros::new(5_000_000);
    line.push(&bytes("FF FF FF FF FF 82 AE DD 01 23 45 03 00 95"), start);
    // 14 characters, 4 of turn, 40 of answer, of 9.1666 ms each.
    let mut times = Vec::new();
    while let Some(at) = line.next_event() {
        let heard = line.advance(at);
        times.extend(heard.iter().map(|_| at.since(start)));
    }
    assert_eq!(times.len(), 40);
    let character = 9_166;
    assert_eq!(times[0], 14 * character + characters(4, 1200) + character);
    assert_eq!(times[39] - times[0], 39 * character);
    assert!(times[0] - 15 * character < 256_666, "below STO");
}

#[test]
fn dynamic_variables_follow_the_signal() {
    let mut bench = Bench::new(Family::Cva);
    bench.device().set_signal(12.0);
    bench.wait(60_000);
    let data = bench.get(3, &[]);
    assert_eq!(data.len(), 24, "all four variables (section 7)");
    let at = |offset: usize| f32::from_be_bytes(data[offset..offset + 4].try_into().unwrap());
    assert!((at(0) - 12.0).abs() < 0.01);
    assert_eq!([data[4], data[9], data[14], data[19]], [57; 4]);
    assert!((at(5) - 50.0).abs() < 0.1 && (at(10) - 50.0).abs() < 0.6);
    assert_eq!(data[20..24], [0x7F, 0xA0, 0, 0], "variable 4 has no value");
    let percent = bench.floats(2);
    assert!((percent[0] - 12.0).abs() < 0.01 && (percent[1] - 50.0).abs() < 0.1);
    // It moved there in half of its 24 s, with torque.
    bench.device().set_signal(20.0);
    bench.wait(3_000);
    let data = bench.get(9, &[2, 3, 77]);
    assert_eq!(data[1..4], [2, 81, 57]);
    assert_eq!(data[8], 0xC0);
    let torque = f32::from_be_bytes(data[12..16].try_into().unwrap());
    assert!(torque > 10.0, "{torque}");
    assert_eq!(
        data[17..25],
        [77, 0, 250, 0x7F, 0xA0, 0, 0, 0x30],
        "no such variable"
    );
    assert_eq!(data.len(), 1 + 3 * 8 + 4);
}

#[test]
fn forced_modes_take_the_primary_variable_away() {
    for (family, number) in [(Family::Iq, 1), (Family::Cma, 4)] {
        let mut bench = Bench::new(family);
        assert_eq!(bench.get(133, &[]), [0]);
        // Frame R14: 25 %.
        let force = [number, 1, 57, 0x41, 0xC8, 0, 0, 0];
        assert_eq!(bench.get(79, &force), force);
        assert_eq!(bench.get(133, &[]), [if number == 1 { 1 } else { 2 }]);
        let pv = bench.get(1, &[]);
        assert_eq!(pv, [57, 0x7F, 0xA0, 0, 0], "table 17");
        assert_eq!(bench.get(48, &[])[8], 1, "device variable simulation");
        bench.wait(30_000);
        let device = bench.device();
        let reached = if number == 1 {
            device.position()
        } else {
            device.valve.factory()
        };
        assert!((reached - 25.0).abs() < 0.6, "{reached}");
        // Only one at a time.
        let other = [5 - number, 1, 57, 0x41, 0xC8, 0, 0, 0];
        assert_eq!(bench.code(79, &other), 6);
        assert_eq!(bench.code(79, &[2, 1, 57, 0, 0, 0, 0, 0]), 19);
        assert_eq!(bench.code(79, &[9, 1, 57, 0, 0, 0, 0, 0]), 17);
        assert_eq!(bench.code(79, &[number, 2, 57, 0, 0, 0, 0, 0]), 10);
        assert_eq!(bench.code(79, &[number, 1, 39, 0, 0, 0, 0, 0]), 18);
        assert_eq!(bench.code(79, &[number, 1, 57]), 5);
        // Back to the signal.
        bench.get(79, &[number, 0, 57, 0, 0, 0, 0, 0]);
        assert_eq!(bench.get(133, &[]), [0]);
        bench.wait(30_000);
        assert!(bench.device().position() < 0.6);
    }
}

#[test]
fn command_132_moves_and_gives_back() {
    let mut bench = Bench::new(Family::Iq);
    // 24h opens, 21h stops, 22h closes, 00h returns (section 9.4; reading G15).
    assert_eq!(bench.get(132, &[0x24]), [0x24]);
    assert_eq!(bench.get(133, &[]), [3]);
    bench.wait(5_000);
    let (_, _, status) = bench.ask(48, &[]);
    assert_eq!(status[4], 0x01 | 0x10 | 0x20, "moving, opening, remote");
    bench.get(132, &[0x21]);
    bench.wait(1_000);
    let stopped = bench.device().position();
    bench.wait(5_000);
    assert_eq!(bench.device().position(), stopped);
    bench.get(132, &[0x22]);
    bench.wait(30_000);
    assert_eq!(bench.get(48, &[])[4], 0x02 | 0x20, "closed, remote");
    // Without bit 5 the others do nothing.
    bench.get(132, &[0x04]);
    assert_eq!(bench.get(133, &[]), [0]);
    assert_eq!(bench.code(132, &[0x40]), 2);
    assert_eq!(bench.code(132, &[]), 5);
    // A partial stroke: a little way and back, and the bit meanwhile.
    bench.get(132, &[0x30]);
    bench.wait(500);
    assert_eq!(bench.get(48, &[])[5], 0x02);
    bench.wait(30_000);
    assert_eq!(bench.get(48, &[])[5], 0);
    assert!(bench.device().position() < 1.0);
    // CVA and CMA have none.
    assert_eq!(Bench::new(Family::Cva).code(132, &[0x30]), 2);
}

#[test]
fn fixed_current_simulates_an_input() {
    let mut bench = Bench::new(Family::Ck);
    let current = 16.0_f32.to_be_bytes();
    assert_eq!(bench.get(40, &current), current);
    let (_, status, _) = bench.ask(3, &[]);
    assert_eq!(status, 0x08, "loop current fixed (table 4)");
    bench.wait(30_000);
    assert!((bench.device().position() - 75.0).abs() < 0.6);
    assert_eq!(bench.code(40, &30.0_f32.to_be_bytes()), 3);
    assert_eq!(bench.code(40, &1.0_f32.to_be_bytes()), 4);
    assert_eq!(bench.code(40, &[0, 0]), 5);
    bench.get(40, &[0; 4]);
    assert_eq!(bench.ask(3, &[]).1, 0);
    // In multidrop there is no signal to simulate; the CMA has no such command.
    bench.get(6, &[5, 0]);
    assert_eq!(bench.code(40, &current), 11);
    assert_eq!(Bench::new(Family::Cma).code(40, &current), 64);
    assert_eq!(Bench::new(Family::Cma).code(34, &[0; 4]), 64);
}

#[test]
fn configuration_changes_are_told_to_each_master() {
    let secondary = [0x2E, 0xDD, 0x01, 0x23, 0x45];
    let mut bench = Bench::new(Family::Si);
    bench.get(0, &[]);
    bench.ask_as(secondary, 0, &[]);
    // Tag VALVE-01, packed (frame R13).
    let tag = bytes("58 13 16 16 DC 31 20 14 94 80 10 D4 54 15 0F 4A 08 20 1B 0A 6D");
    assert_eq!(bench.get(18, &tag), tag);
    assert_eq!(bench.get(13, &[]), tag);
    assert_eq!(bench.ask(3, &[]).1 & 0x40, 0x40);
    assert_eq!(bench.get(0, &[])[14..16], [0, 1]);
    assert_eq!(bench.code(38, &[0, 2]), 9, "another counter");
    assert_eq!(bench.code(38, &[0]), 5);
    bench.get(38, &[0, 1]);
    assert_eq!(bench.ask(3, &[]).1 & 0x40, 0);
    assert_eq!(
        bench.ask_as(secondary, 3, &[]).1 & 0x40,
        0x40,
        "the other one's stands"
    );
    bench.ask_as(secondary, 38, &[]);
    assert_eq!(bench.ask_as(secondary, 3, &[]).1 & 0x40, 0);
    // Month 13, and days that are not in the calendar: 1900 and 2100 are no leap years.
    for bad in [
        [31, 13, 100],
        [31, 4, 100],
        [31, 2, 100],
        [29, 2, 0],
        [29, 2, 200],
        [29, 2, 101],
        [0, 1, 100],
    ] {
        let bad = [&tag[..18], &bad].concat();
        assert_eq!(bench.code(18, &bad), 9, "{bad:?}");
    }
    let leap = [&tag[..18], &[29, 2, 100]].concat();
    assert_eq!(bench.get(18, &leap), leap);
    assert_eq!(bench.get(18, &tag), tag);
    // It is found by its tag, from a broadcast, with its own address.
    let find = [&[0x82, 0x80, 0, 0, 0, 0, 11, 6][..], &tag[..6]].concat();
    let check = find.iter().fold(0, |sum, b| sum ^ b);
    let answer = bench.raw(&[&[0xFF; 5][..], &find, &[check]].concat());
    assert_eq!(answer[5..12], [0x86, 0xAE, 0xDD, 1, 0x23, 0x45, 11]);
    let other = bytes("FF FF FF FF FF 82 80 00 00 00 00 0B 06 58 13 16 16 DC 32 94");
    assert!(bench.raw(&other).is_empty(), "another tag");
}

#[test]
fn more_status_follows_the_map() {
    let mut bench = Bench::new(Family::Iq);
    bench.get(0, &[]);
    assert!(bench.device().inject("local_control_fault", true));
    assert!(!bench.device().inject("no_such_bit", true));
    // No category yet: the bit stands, the flags do not.
    let (_, status, data) = bench.ask(48, &[]);
    assert_eq!((status, data[0], data[6]), (0, 0x02, 0));
    // Table 20: local control fault is a failure (index 8 + 1, high half of its byte).
    let map = bytes("08 08 30 40 00 51");
    let (code, answer) = bench.extended(524, &map);
    assert_eq!((code, answer), (0, map));
    let (_, status, data) = bench.ask(48, &[]);
    assert_eq!(
        status,
        0x80 | 0x40 | 0x10,
        "malfunction, changed, more status"
    );
    assert_eq!(data[6], 0x08, "failure");
    // Writing back what was read ends More Status Available, not the rest.
    assert_eq!(bench.code(48, &[1; 9]), 14, "not what stands");
    assert_eq!(bench.code(48, &data[..5]), 5);
    assert_eq!(bench.get(48, &data), data);
    assert_eq!(bench.ask(3, &[]).1 & 0x90, 0x80);
    // A new bit sets it again, and so does the old one when it comes back.
    bench.device().inject("0.3", true);
    assert_eq!(bench.ask(3, &[]).1 & 0x10, 0x10);
    let now = bench.get(48, &[]);
    assert_eq!(now[6], 0x18, "failure and out of specification");
    bench.get(48, &now);
    assert_eq!(bench.ask(3, &[]).1 & 0x10, 0);
    bench.device().inject("0.3", false);
    assert_eq!(bench.ask(3, &[]).1 & 0x10, 0);
    bench.device().inject("0.3", true);
    assert_eq!(bench.ask(3, &[]).1 & 0x10, 0x10);
    // Reset of the map: no category, no flags.
    assert_eq!(bench.extended(525, &[]), (0, vec![]));
    assert_eq!(bench.ask(3, &[]).1 & 0x90, 0);
}

#[test]
fn the_map_is_read_and_written_within_limits() {
    let mut bench = Bench::new(Family::Ck);
    // Frames R22 and R23: 64 entries, two a byte.
    let (code, all) = bench.extended(523, &[0, 64]);
    assert_eq!((code, all.len()), (0, 34));
    assert_eq!(all[..2], [0, 64]);
    assert_eq!(
        bench.extended(523, &[9, 5]).1,
        [8, 4, 0, 0],
        "even ones only"
    );
    assert_eq!(
        bench.extended(523, &[60, 64]).1,
        [60, 4, 0, 0],
        "as far as there are any"
    );
    assert_eq!(bench.extended(523, &[64, 2]).0, 2);
    assert_eq!(bench.extended(523, &[0]).0, 5);
    for wrong in [[6, 4, 0x33, 0x33], [38, 4, 0x33, 0x33], [9, 2, 0x33, 0]] {
        assert_eq!(bench.extended(524, &wrong).0, 2, "{wrong:?}");
    }
    assert_eq!(bench.extended(524, &[8, 2, 0x23]).0, 2, "2 is reserved");
    assert_eq!(bench.extended(524, &[8, 4, 0x33]).0, 5);
    assert_eq!(bench.extended(524, &[38, 2, 0x61]).0, 0);
    assert_eq!(bench.extended(523, &[38, 2]).1, [38, 2, 0x61]);
    assert_eq!(bench.extended(600, &[]).0, 64);
    assert_eq!(bench.code(31, &[2]), 5);
}

#[test]
fn simulated_status_stands_still() {
    let mut bench = Bench::new(Family::Cma);
    bench.get(0, &[]);
    bench.extended(524, &[8, 2, 0x01]);
    assert_eq!(
        bench.extended(527, &[8, 1]).0,
        16,
        "only while simulation is on"
    );
    assert_eq!(bench.extended(526, &[2]).0, 2);
    assert_eq!(bench.extended(526, &[1]), (0, vec![1]));
    bench.device().inject("over_temperature", true);
    assert_eq!(bench.extended(527, &[8, 1]), (0, vec![8, 1]));
    assert_eq!(bench.extended(527, &[7, 1]).0, 2);
    assert_eq!(bench.extended(527, &[40, 1]).0, 2);
    let (_, status, data) = bench.ask(48, &[]);
    assert_eq!(data[0], 0x01, "the simulated bit alone");
    assert_eq!(data[6], 0x01, "maintenance required");
    assert_eq!(data[9], 0x01, "status simulation active");
    assert_eq!(status & 0x90, 0x10);
    // The end of the simulation: what really is.
    bench.extended(526, &[0]);
    let (_, status, data) = bench.ask(48, &[]);
    assert_eq!((data[0], data.len(), status & 0x10), (0x80, 9, 0));
}

#[test]
fn damaged_requests_get_a_communication_error_or_silence() {
    let mut bench = Bench::new(Family::Iq);
    // Frame R27: bad check byte, so 88h, and no data.
    let answer = bench.raw(&bytes("FF FF FF FF FF 82 AE DD 01 23 45 03 00 94"));
    assert_eq!(answer[11..15], [3, 2, 0x88, 0x20]);
    assert_eq!(answer.len(), 16);
    // Another device, damaged: not ours to answer. A damaged count never ends.
    assert!(
        bench
            .raw(&bytes("FF FF FF FF FF 82 AE DD 01 23 46 03 00 94"))
            .is_empty()
    );
    assert!(
        bench
            .raw(&bytes("FF FF FF FF FF 82 AE DD 01 23 45 03 07 95"))
            .is_empty()
    );
    assert!(
        bench.raw(&bytes("82 AE DD 01 23 45 03 00 95")).is_empty(),
        "no preamble"
    );
    // Its modem misses two characters; of five preamble bytes three are left, of three one.
    assert!(
        bench
            .raw(&bytes("FF FF FF 82 AE DD 01 23 45 03 00 95"))
            .is_empty()
    );
    assert_eq!(
        bench
            .raw(&bytes("FF FF FF FF 82 AE DD 01 23 45 03 00 95"))
            .len(),
        40
    );
    // After all of this it answers as always.
    assert_eq!(bench.get(7, &[]), [0, 1]);
    // Busy, silent and damaged on demand.
    bench.device().set_busy(2);
    assert_eq!(
        (bench.code(3, &[]), bench.code(3, &[]), bench.code(3, &[])),
        (32, 32, 0)
    );
    bench.device().set_silent(1);
    assert!(
        bench
            .raw(&bytes("FF FF FF FF FF 82 AE DD 01 23 45 03 00 95"))
            .is_empty()
    );
}

#[test]
fn relays_follow_command_134() {
    let mut bench = Bench::new(Family::Iq);
    bench.get(134, &[0x05, 0x08, 0, 0]);
    assert_eq!(bench.device().relays(), 0x0805);
    // Both bits set: no change (reading R34).
    bench.get(134, &[0x02, 0, 0x03, 0]);
    assert_eq!(bench.device().relays(), 0x0804);
    assert_eq!(bench.code(134, &[0, 0x10, 0, 0]), 74, "relay 13");
    assert_eq!(bench.code(134, &[0, 0, 0]), 5);
    assert_eq!(bench.code(134, &[0; 5]), 75);
    let mut cma = Bench::new(Family::Cma);
    assert_eq!(
        cma.code(134, &[0x04, 0, 0, 0]),
        74,
        "the CMA has no relay 3"
    );
    cma.get(134, &[0x91, 0, 0, 0]);
    let status = cma.get(48, &[]);
    assert_eq!(status[2] & 0xE0, 0xA0, "relays 1 and 5 (table 9)");
    assert_eq!(status[3] & 0x07, 0x04, "relay 8");
    for family in [Family::Cva, Family::Ck, Family::Si] {
        assert_eq!(Bench::new(family).code(134, &[0; 4]), 64);
    }
}

#[test]
fn the_cva_has_a_status_word() {
    let mut bench = Bench::new(Family::Cva);
    // At the closed limit, controls in run (table 15): bits 10 and 12.
    assert_eq!(bench.get(129, &[2, 0, 0]), [2, 1, 0, 0x14, 0x00]);
    assert_eq!(bench.code(129, &[2, 1, 0]), 2);
    bench.device().set_signal(20.0);
    bench.device().set_stuck(true);
    bench.device().set_selector(HartSelector::Remote);
    bench.wait(12_000);
    // Obstructed opening (2), fault (4), closed (10), run (12), stalled (15).
    assert_eq!(bench.get(129, &[2, 0, 0])[3..], [0x94, 0x14]);
    let (_, status, data) = bench.ask(48, &[]);
    assert_eq!(
        data[3],
        0x08 | 0x20,
        "valve obstruction opening, stalled (table 6)"
    );
    assert_eq!(
        (status & 0x10, data[6]),
        (0x10, 0),
        "any alarm counts, no NE 107"
    );
    bench.device().set_main_board(false);
    assert_eq!(bench.code(129, &[2, 0, 0]), 73);
    assert_eq!(bench.ask(3, &[]).1 & 0x80, 0x80, "malfunction");
    assert_eq!(Bench::new(Family::Iq).code(129, &[2, 0, 0]), 64);
    assert_eq!(bench.get(128, &[]), b"1.05 (0312)\0");
    assert_eq!(Bench::new(Family::Ck).get(128, &[]), b"v105+( 0312)");
}

#[test]
fn the_signal_is_calibrated_ranged_and_lost() {
    let mut bench = Bench::new(Family::Iq);
    assert_eq!(bench.floats(131), [4.0, 20.0]);
    // 4.02 mA measured outside while the device believes in 4.00.
    assert_eq!(
        bench.get(45, &4.02_f32.to_be_bytes()),
        4.02_f32.to_be_bytes()
    );
    assert_eq!(bench.floats(131), [4.02, 20.0]);
    assert!((bench.floats(2)[0] - 4.02).abs() < 0.001);
    assert_eq!(bench.code(46, &20.0_f32.to_be_bytes()), 9, "4 mA flow");
    assert_eq!(bench.code(45, &9.0_f32.to_be_bytes()), 3);
    // 25 to 75 %: 12 mA is still the middle.
    let range = [&[57][..], &75.0_f32.to_be_bytes(), &25.0_f32.to_be_bytes()].concat();
    assert_eq!(bench.get(35, &range), range);
    let info = bench.get(15, &[]);
    assert_eq!(info.len(), 18);
    assert_eq!(info[3..11], range[1..]);
    assert_eq!(bench.code(35, &[39, 0, 0, 0, 0, 0, 0, 0, 0]), 18);
    let wrong = [&[57][..], &175.0_f32.to_be_bytes(), &0_f32.to_be_bytes()].concat();
    assert_eq!(bench.code(35, &wrong), 11);
    // 22 mA: saturated and out of limits (reading H19).
    bench.device().set_signal(22.0);
    bench.wait(1_000);
    assert_eq!(bench.ask(3, &[]).1 & 0x0F, 0x05);
    // Lost: after a second and the time-out of the actuator it stays where it is.
    let mut setup = HartSetup::of(Family::Iq);
    setup.loss = (HartLoss::Close, 5_000);
    let mut bench = Bench::of(setup);
    bench.device().set_signal(20.0);
    bench.wait(30_000);
    bench.device().set_signal(1.5);
    bench.wait(4_000);
    assert!(bench.device().position() > 99.0);
    bench.wait(40_000);
    assert!(bench.device().position() < 1.0);
    // The damping is written and used.
    assert_eq!(bench.code(34, &300.0_f32.to_be_bytes()), 3);
    bench.get(34, &10.0_f32.to_be_bytes());
    bench.device().set_signal(20.0);
    bench.wait(1_000);
    assert!(bench.floats(2)[1] < 50.0);
}

#[test]
fn a_reset_forgets_what_is_not_stored() {
    let mut bench = Bench::new(Family::Ck);
    bench.get(40, &12.0_f32.to_be_bytes());
    bench.get(132, &[0x24]);
    bench.get(17, &[0x41; 24]);
    assert_eq!(bench.code(42, &[]), 0);
    assert!(
        bench
            .raw(&bytes("FF FF FF FF FF 82 AE DD 01 23 45 03 00 95"))
            .is_empty()
    );
    let (_, status, _) = bench.ask(3, &[]);
    assert_eq!(
        status, 0x60,
        "cold start and changed; the current is no longer fixed"
    );
    assert_eq!(bench.get(133, &[]), [0]);
    assert_eq!(bench.get(12, &[]), [0x41; 24]);
}

#[test]
fn delayed_answers_take_their_time() {
    let mut setup = HartSetup::of(Family::Iq);
    setup.delayed_ms = 4_000;
    let mut bench = Bench::of(setup);
    let tag = [b'A'; 32];
    assert_eq!(bench.code(22, &tag), 33);
    assert_eq!(bench.code(22, &tag), 34);
    assert_eq!(bench.code(22, &[b'B'; 32]), 36);
    bench.wait(4_000);
    assert_eq!(bench.get(22, &tag), tag);
    assert_eq!(bench.get(20, &[]), tag);
}

#[test]
fn every_family_has_its_commands() {
    // Tables 12, 13 and 14.
    for family in Family::ALL {
        let mut bench = Bench::new(family);
        for command in 0..=255_u8 {
            if matches!(command, 31 | 42) {
                continue;
            }
            let listed = match command {
                0..=3 | 6..=9 | 12..=20 | 22 | 38 | 48 => true,
                35 | 45 | 46 | 49 | 79 | 128 | 131..=133 => true,
                34 | 40 => family != Family::Cma,
                129 => family == Family::Cva,
                134 => matches!(family, Family::Iq | Family::Cma),
                // By tag, from a broadcast; by the long address it answers too.
                11 | 21 => true,
                _ => false,
            };
            let (code, _, _) = bench.ask(command, &[]);
            assert_eq!(code == 64, !listed, "{family:?} {command}: {code}");
        }
    }
}
