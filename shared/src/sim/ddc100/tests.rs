//! The simulated network against the guide's tables, message by message.

use super::*;
use crate::device::Device;

const MX: Device = Device::Ddc100Mx;
const UEC: Device = Device::Ddc100Uec;
const CLAMSHELL: Device = Device::Ddc100Clamshell;
const IO: Device = Device::Ddc100Io;
const SECOND: u64 = 1_000_000;

/// A network and its clock.
struct Line {
    network: Loop,
    now: Micros,
}

impl Line {
    fn new(shape: DdcShape, kinds: &[Device]) -> Self {
        let members = (1..)
            .zip(kinds)
            .map(|(unit, kind)| Member { unit, kind: *kind });
        Self {
            network: Loop::new(shape, &members.collect::<Vec<_>>()),
            now: Micros::new(0),
        }
    }

    fn wait(&mut self, seconds: u64) {
        self.now = self.now.plus(seconds * SECOND);
    }

    fn through(&mut self, port: HostPort, unit: u8, pdu: &[u8]) -> Option<Vec<u8>> {
        let answer = self.network.request(port, unit, pdu, self.now);
        answer.map(|a| a.pdu)
    }

    fn ask(&mut self, unit: u8, pdu: &[u8]) -> Vec<u8> {
        self.through(HostPort::One, unit, pdu).expect("an answer")
    }

    /// A register by its number, through port 1.
    fn register(&mut self, unit: u8, number: u16) -> u16 {
        let [a, b] = (number - 1).to_be_bytes();
        let answer = self.ask(unit, &[3, a, b, 0, 1]);
        assert_eq!(answer[..2], [3, 2]);
        u16::from_be_bytes([answer[2], answer[3]])
    }

    fn command(&mut self, unit: u8, value: u16) -> Vec<u8> {
        let [a, b] = value.to_be_bytes();
        self.ask(unit, &[6, 0, 0, a, b])
    }

    fn trouble(&mut self, name: &str) {
        // Time goes on in the network only when somebody asks or looks.
        self.network.advance(self.now);
        assert!(self.network.inject(name.parse().unwrap()), "{name}");
    }

    fn heal(&mut self, name: &str) {
        self.network.advance(self.now);
        assert!(self.network.heal(name.parse().unwrap()), "{name}");
    }
}

const OPENED: u16 = 1;
const CLOSED: u16 = 1 << 1;
const STOPPED: u16 = 1 << 2;
const OPENING: u16 = 1 << 3;
const CLOSING: u16 = 1 << 4;
const JAMMED: u16 = 1 << 5;
const LOCAL: u16 = 1 << 6;
const COMBINED: u16 = 1 << 7;
const A: u16 = 1 << 10;
const B: u16 = 1 << 11;

#[test]
fn a_stroke() {
    for kind in [MX, UEC, CLAMSHELL] {
        let mut line = Line::new(DdcShape::Loop, &[kind]);
        assert_eq!(line.register(1, 9) & 0x1F, CLOSED);
        assert_eq!(line.command(1, 256), [6, 0, 0, 1, 0], "an echo");
        assert_eq!(
            line.register(1, 9) & 0x1F,
            OPENING | CLOSED,
            "still at its limit"
        );
        assert_eq!(line.register(1, 11) & 3, 2, "the open contactor");
        line.wait(1);
        assert_eq!(line.register(1, 9) & 0x1F, OPENING);
        // Unit 1 takes 37 s.
        line.wait(17);
        assert_eq!(line.register(1, 8), 48);
        line.command(1, 512);
        assert_eq!(line.register(1, 9) & 0x1F, STOPPED);
        line.command(1, 19_230);
        assert_eq!(line.register(1, 9) & 0x1F, CLOSING);
        line.wait(20);
        assert_eq!(
            (line.register(1, 8), line.register(1, 9) & 0x1F),
            (30, STOPPED)
        );
        line.command(1, 256);
        line.wait(40);
        assert_eq!(
            (line.register(1, 8), line.register(1, 9) & 0x1F),
            (100, OPENED)
        );
        assert_eq!(
            line.register(1, 12) & 0x29,
            0x09,
            "remote, open limit switch"
        );
    }
}

/// Many short steps go as far as a long one.
#[test]
fn time_in_pieces() {
    let positions = [1, 7, 1000].map(|steps| {
        let mut line = Line::new(DdcShape::Loop, &[MX]);
        line.command(1, 256);
        for _ in 0..steps {
            line.now = line.now.plus(10 * SECOND / steps);
            line.network.advance(line.now);
        }
        line.register(1, 8)
    });
    assert_eq!(positions, [27; 3], "10 of 37 s");
    // A clock that goes back changes nothing.
    let mut line = Line::new(DdcShape::Loop, &[MX]);
    line.wait(100);
    line.register(1, 9);
    line.now = Micros::new(0);
    assert_eq!(line.register(1, 9) & CLOSED, CLOSED);
}

/// Reading D20, section 3.2.9: argument and command in two messages, or in one of function 16.
#[test]
fn d20_argument_and_command() {
    let mut line = Line::new(DdcShape::Loop, &[MX]);
    line.ask(1, &[6, 0, 1, 0, 42]);
    line.command(1, 6656);
    line.wait(60);
    assert_eq!(line.register(1, 8), 42);
    assert_eq!(
        line.ask(1, &[16, 0, 0, 0, 2, 4, 0x1A, 0, 0, 50]),
        [16, 0, 0, 0, 2]
    );
    line.wait(60);
    assert_eq!(line.register(1, 8), 50);
}

/// Reading D28: off to coil 1 or 2 stops, whichever way it moves.
#[test]
fn d28_off_stops() {
    let mut line = Line::new(DdcShape::Loop, &[UEC]);
    line.ask(1, &[5, 0, 1, 0xFF, 0]);
    assert_eq!(line.register(1, 9) & OPENING, OPENING);
    line.ask(1, &[5, 0, 0, 0, 0]);
    assert_eq!(line.register(1, 9) & OPENING, 0, "coil 1 off stops opening");
    // Section 3.2.8: coil 1 on, coil 2 off: the off comes last.
    line.ask(1, &[5, 0, 1, 0xFF, 0]);
    line.wait(5);
    assert_eq!(line.ask(1, &[15, 0, 0, 0, 2, 1, 0b01]), [15, 0, 0, 0, 2]);
    assert_eq!(line.register(1, 9) & (OPENING | CLOSING), 0);
    assert_eq!(line.ask(1, &[15, 0, 0, 0, 1, 1, 1]), [15, 0, 0, 0, 1]);
    assert_eq!(line.register(1, 9) & CLOSING, CLOSING);
}

#[test]
fn local_stop_and_torque() {
    let mut line = Line::new(DdcShape::Loop, &[MX, UEC]);
    for unit in [1, 2] {
        line.trouble(&format!("local-{unit}"));
        line.command(unit, 256);
        assert_eq!(
            line.register(unit, 9) & (OPENING | LOCAL),
            LOCAL,
            "not in local"
        );
        line.heal(&format!("local-{unit}"));
        line.command(unit, 256);
        line.trouble(&format!("local-{unit}"));
        line.command(unit, 512);
        assert_eq!(line.register(unit, 9) & OPENING, 0, "a stop works in local");
        line.heal(&format!("local-{unit}"));

        line.trouble(&format!("torque-open-{unit}"));
        line.command(unit, 256);
        // Half way, 19 and 22 s; then it pushes for a second.
        for _ in 0..500 {
            line.now = line.now.plus(SECOND / 10);
            if line.register(unit, 9) & JAMMED != 0 {
                break;
            }
        }
        let word = line.register(unit, 9);
        assert_eq!(
            word & (JAMMED | OPENING | COMBINED),
            JAMMED | OPENING | COMBINED
        );
        line.wait(2);
        let word = line.register(unit, 9);
        assert_eq!(
            word & (JAMMED | OPENING | COMBINED),
            0,
            "only while it moves"
        );
        assert_eq!(word & (1 << 12), 1 << 12);
        assert_eq!(line.register(unit, 8), 50);
        line.command(unit, 256);
        assert_eq!(line.register(unit, 9) & OPENING, 0, "not this way");
        line.command(unit, 768);
        line.wait(1);
        assert_eq!(line.register(unit, 9) & (CLOSING | 1 << 12), CLOSING);
    }
    line.trouble("stop-1");
    assert_eq!(
        line.register(1, 10) & (1 << 13),
        1 << 13,
        "local stop on an MX"
    );
    line.trouble("stop-2");
    assert_eq!(
        line.register(2, 10) & (1 << 13),
        0,
        "on a UEC this bit is another"
    );
    line.trouble("thermal-1");
    assert_eq!(line.register(1, 9) & (COMBINED | 1 << 8), COMBINED | 1 << 8);
    line.trouble("phase-2");
    assert_eq!(
        line.register(2, 9) & (COMBINED | 1 << 15),
        COMBINED | 1 << 15
    );
}

#[test]
fn emergency_shutdown() {
    let mut line = Line::new(DdcShape::Loop, &[MX]);
    line.command(1, 19_250);
    line.wait(60);
    line.trouble("local-esd-1");
    assert_eq!(line.register(1, 10) & (1 << 11), 1 << 11);
    line.wait(60);
    assert_eq!(
        line.register(1, 9) & CLOSED,
        CLOSED,
        "the default is to close"
    );
    line.command(1, 256);
    assert_eq!(line.register(1, 9) & OPENING, 0);
    line.heal("local-esd-1");
    line.command(1, 1280);
    line.command(1, 256);
    assert_eq!(line.register(1, 10) & (1 << 10), 1 << 10);
    assert_eq!(line.register(1, 9) & OPENING, 0);
    line.command(1, 1536);
    line.command(1, 256);
    assert_eq!(line.register(1, 9) & OPENING, OPENING);
}

/// Readings D2, D3, D33: commands, coils and bits of register 11 of the relays of each type.
#[test]
fn relays() {
    let mut line = Line::new(DdcShape::Loop, &[MX, UEC, CLAMSHELL, IO]);
    for (unit, engage, coil) in [
        (1, 2304, 3),
        (1, 3840, 9),
        (2, 2816, 3),
        (2, 3584, 6),
        (3, 3072, 4),
        (4, 2304, 7),
        (4, 2560, 8),
        (4, 2816, 3),
    ] {
        let bit = 1_u16 << (coil - 1);
        line.command(unit, engage);
        assert_eq!(line.register(unit, 11) & bit, bit, "{unit} {engage}");
        assert_eq!(line.ask(unit, &[1, 0, (coil - 1) as u8, 0, 1]), [1, 1, 1]);
        line.command(unit, engage + 2048);
        assert_eq!(line.register(unit, 11) & bit, 0);
        line.ask(unit, &[5, 0, (coil - 1) as u8, 0xFF, 0]);
        assert_eq!(line.register(unit, 11) & bit, bit, "by its coil");
        line.ask(unit, &[5, 0, (coil - 1) as u8, 0, 0]);
    }
    for (unit, value) in [
        (2, 2304),
        (3, 3840),
        (4, 3840),
        (4, 256),
        (1, 4096),
        (1, 1),
        (1, 19_301),
    ] {
        assert_eq!(line.command(unit, value), [0x86, 3], "{unit} {value}");
    }
    for (unit, coil) in [(2, 4), (3, 7), (4, 1), (4, 9)] {
        assert_eq!(line.ask(unit, &[5, 0, coil - 1, 0xFF, 0]), [0x85, 2]);
    }
}

/// Table 3.2: function 02 is not for an MX (reading D18); addresses end where the tables do.
#[test]
fn functions() {
    let mut line = Line::new(DdcShape::Loop, &[MX, UEC, CLAMSHELL, IO]);
    assert_eq!(line.ask(1, &[2, 0, 128, 0, 16]), [0x82, 1]);
    // A poll of register 10 clears the bit of a reset.
    line.register(2, 10);
    // Inputs 129 to 208 are the bits of registers 9 to 13, 10 bytes.
    let words: Vec<u8> = (9..=13)
        .flat_map(|n| line.register(2, n).swap_bytes().to_be_bytes())
        .collect();
    let inputs = line.ask(2, &[2, 0, 128, 0, 80]);
    assert_eq!((inputs[1], &inputs[2..]), (10, &words[..]));
    for unit in 1..=4 {
        assert_eq!(line.ask(unit, &[3, 0, 0, 0, 56]).len(), 114);
        assert_eq!(line.ask(unit, &[3, 0, 0, 0, 57]), [0x83, 2]);
        assert_eq!(line.ask(unit, &[3, 0, 0, 0, 0]), [0x83, 3]);
        assert_eq!(line.ask(unit, &[4, 0, 4, 0, 12]).len(), 26);
        assert_eq!(line.ask(unit, &[4, 0, 3, 0, 1]), [0x84, 2]);
        assert_eq!(line.ask(unit, &[4, 0, 4, 0, 13]), [0x84, 2]);
        let watchdog = line.ask(unit, &[3, 0, 111, 0, 1]);
        let expected: &[u8] = if unit == 2 {
            &[3, 2, 0, 60]
        } else {
            &[0x83, 2]
        };
        assert_eq!(watchdog, expected, "reading D27");
        assert_eq!(
            line.ask(unit, &[6, 0, 4, 0, 1]),
            [0x86, 2],
            "registers 5 to 16 stay"
        );
        assert_eq!(line.ask(unit, &[8, 0, 0, 1, 2, 3]), [8, 0, 0, 1, 2, 3]);
        assert_eq!(line.ask(unit, &[8, 0, 9, 0, 0]), [0x88, 1]);
        assert_eq!(line.ask(unit, &[17]), [0x91, 1]);
        assert_eq!(line.ask(unit, &[15, 0, 0, 0, 9, 1, 0]), [0x8F, 3]);
        assert_eq!(line.ask(unit, &[16, 0, 1, 0, 2, 4, 0, 0, 0, 0]), [0x90, 2]);
    }
    assert_eq!(
        line.through(HostPort::One, 5, &[3, 0, 8, 0, 1]),
        None,
        "no such unit"
    );
    assert_eq!(
        line.through(HostPort::One, 0, &[6, 0, 0, 1, 0]),
        None,
        "nobody answers all"
    );
    assert_eq!(line.register(1, 9) & OPENING, OPENING);
}

/// Modbus application protocol 1.1b3, section 6.8; the guide has the names of table 3.8 only.
#[test]
fn diagnostics() {
    let mut line = Line::new(DdcShape::Loop, &[MX, UEC]);
    let counters = |line: &mut Line, unit| {
        [11, 12, 13, 14].map(|sub| {
            let answer = line.ask(unit, &[8, 0, sub, 0, 0]);
            assert_eq!(answer[..3], [8, 0, sub]);
            u16::from_be_bytes([answer[3], answer[4]])
        })
    };
    for unit in [1, 2] {
        line.ask(unit, &[8, 0, 10, 0, 0]);
    }
    // Unit 1 counts the request that cleared unit 2, and each of its own, this one too.
    assert_eq!(counters(&mut line, 1), [2, 0, 0, 4]);
    line.ask(1, &[17]);
    line.register(2, 9);
    // 5 before, 17, the other one's, and this one.
    assert_eq!(counters(&mut line, 1), [8, 0, 1, 9]);
    // A damaged frame reaches unit 1 only, if the cable is broken behind it.
    line.trouble("break-1");
    line.network.damaged(HostPort::One, line.now);
    line.network.damaged(HostPort::Two, line.now);
    line.heal("break-1");
    line.network.damaged(HostPort::One, line.now);
    assert_eq!(counters(&mut line, 1)[1], 2);
    assert_eq!(counters(&mut line, 2)[1], 2);
    assert_eq!(line.ask(1, &[8, 0, 2, 0, 0]), [8, 0, 2, 0, 0]);
    // What does not get through is not counted either.
    line.trouble("off-2");
    line.network.damaged(HostPort::One, line.now);
    line.heal("off-2");
    assert_eq!(counters(&mut line, 2), [1, 0, 0, 4], "since power-up");
}

/// Listen only: what comes is neither carried out nor answered until the restart, which is not
/// answered either; a restart at another time is.
#[test]
fn listen_only() {
    let mut line = Line::new(DdcShape::Loop, &[MX]);
    assert_eq!(line.ask(1, &[8, 0, 1, 0, 0]), [8, 0, 1, 0, 0]);
    let silent = |line: &mut Line, pdu: &[u8]| {
        assert_eq!(line.through(HostPort::One, 1, pdu), None, "{pdu:?}");
    };
    silent(&mut line, &[8, 0, 4, 0, 0]);
    for pdu in [
        &[3, 0, 8, 0, 1][..],
        &[6, 0, 0, 1, 0],
        &[8, 0, 0, 1, 2],
        &[8, 0, 10, 0, 0],
        &[8, 0, 1, 0, 0],
    ] {
        silent(&mut line, pdu);
    }
    assert_eq!(line.register(1, 9) & OPENING, 0, "256 did nothing");
    silent(&mut line, &[8, 0, 4, 0, 0]);
    line.trouble("off-1");
    line.heal("off-1");
    line.register(1, 9);
}

/// Every trouble sets the bit that table 3.5 has for it in the column of the type, and no other of
/// registers 9 (5, 8, 9, 12 to 15), 10 and 12 to 16 than those named.
#[test]
fn troubles_are_the_bits_of_the_table() {
    type Bits = &'static [(u16, u16)];
    let check = |kind, trouble: &str, expected: Bits| {
        let mut line = Line::new(DdcShape::Loop, &[kind]);
        let words = |line: &mut Line| {
            [9, 10, 12, 13, 14, 15, 16].map(|number| (number, line.register(1, number)))
        };
        line.register(1, 10);
        let before = words(&mut line);
        line.trouble(&format!("{trouble}-1"));
        let after = words(&mut line);
        for ((number, before), (_, after)) in before.into_iter().zip(after) {
            let bits = expected.iter().filter(|(n, _)| *n == number);
            let expected = bits.fold(0, |word, (_, bit)| word | 1 << bit);
            // Opened, closed, stopped and combined fault follow from others.
            let follows = if number == 9 { 0b1001_1111 } else { 0 };
            let follows = if number == 12 { 0b10_1000 } else { follows };
            assert_eq!(
                (before ^ after) & !follows,
                expected,
                "{kind:?} {trouble}: register {number}"
            );
        }
        line.heal(&format!("{trouble}-1"));
        let healed = words(&mut line);
        for ((number, before), (_, healed)) in before.into_iter().zip(healed).skip(1) {
            // A valve that was moved stays there, off its limit switch.
            let moved = if number == 12 { 0b10_1000 } else { 0 };
            assert_eq!(
                before & !moved,
                healed & !moved,
                "{kind:?} {trouble} healed"
            );
        }
    };
    for kind in [UEC, CLAMSHELL] {
        for (trouble, bits) in [
            ("verify-open", &[(10, 0)][..]),
            ("verify-close", &[(10, 1)]),
            ("verify-open-stays", &[(10, 2)]),
            ("verify-close-stays", &[(10, 3)]),
            ("phase", &[(9, 15), (10, 4), (13, 12)]),
            ("sequence", &[(9, 15), (10, 5), (13, 13)]),
            ("rotation", &[(10, 13)]),
            ("energized", &[(9, 9)]),
            ("analog-lost", &[(13, 0)]),
            ("analog-lost-4", &[(13, 3)]),
            ("local", &[(9, 6), (12, 0)]),
            ("local-open", &[(9, 6), (10, 14), (12, 0)]),
            ("input", &[(12, 9)]),
            ("input-0", &[(10, 11), (12, 8)]),
            ("local-esd", &[(10, 11), (12, 8)]),
            ("input-3", &[(12, 11)]),
            ("input-7", &[(12, 15)]),
            ("input-8", &[(13, 14)]),
            ("input-9", &[(13, 15)]),
        ] {
            check(kind, trouble, bits);
        }
    }
    for (trouble, bits) in [
        ("phase", &[(9, 15), (10, 4), (13, 12)][..]),
        ("sequence", &[(9, 15), (10, 5), (13, 13)]),
        ("manual", &[(9, 14)]),
        ("stop", &[(9, 6), (10, 13), (12, 0)]),
        ("local-open", &[(9, 6), (10, 14), (12, 0)]),
        ("analog-lost", &[(13, 2)]),
        ("analog-lost-2", &[(13, 3)]),
        ("input-3", &[(12, 11)]),
        // The option board is there then.
        ("input-6", &[(12, 14), (13, 7)]),
        ("input-8", &[(13, 7), (13, 14)]),
    ] {
        check(MX, trouble, bits);
    }
    // Reading D17: inputs 18, 19, 16, 17 are bits 12 to 15 of register 13.
    for (trouble, bits) in [
        ("input-0", &[(12, 8)][..]),
        ("input-3", &[(12, 11)]),
        ("input-7", &[(12, 15)]),
        ("input-8", &[(12, 0)]),
        ("input-15", &[(12, 7)]),
        ("input-16", &[(13, 14)]),
        ("input-17", &[(13, 15)]),
        ("input-18", &[(13, 12)]),
        ("input-19", &[(13, 13)]),
        ("analog-lost-2", &[(13, 1)]),
    ] {
        check(IO, trouble, bits);
    }
    for kind in [UEC, CLAMSHELL, IO] {
        for (trouble, bits) in [
            ("user-fault", &[(15, 0)][..]),
            ("user-fault-9", &[(15, 9)]),
            ("timer", &[(14, 13)]),
            ("timer-0", &[(14, 0)]),
            ("timer-10", &[(14, 10)]),
            ("timer-15", &[(14, 15)]),
            ("state", &[(16, 5)]),
            ("state-0", &[(16, 0)]),
            // With the board neither bit is set; without it both are (section 4.3.1).
            ("channel-b", &[(9, 11), (14, 12)]),
        ] {
            check(kind, trouble, bits);
        }
    }
}

/// Registers 10 of a UEC-3-DDC, bits 6 to 9: from where to where the valve was moved by hand.
#[test]
fn moved_by_hand() {
    let mut line = Line::new(DdcShape::Loop, &[UEC]);
    let mut turn = |from: u16, bit: u16, to: u16| {
        line.command(1, 19_200 + from);
        line.wait(100);
        line.trouble("manual-1");
        assert_eq!(line.register(1, 10) & 0x03C0, 1 << bit, "from {from}");
        assert_eq!(line.register(1, 9) & 1 << 14, 1 << 14);
        assert_eq!(line.register(1, 8), to);
        line.heal("manual-1");
        assert_eq!(line.register(1, 10) & 0x03C0, 0);
        assert_eq!(line.register(1, 8), to, "it stays where it is");
    };
    turn(70, 6, 100);
    turn(100, 7, 50);
    turn(30, 8, 0);
    turn(0, 9, 50);
}

/// An I/O module has two analog inputs: at rest, or, if lively, between 0 and 100 % all the time.
#[test]
fn analog_inputs_of_a_module() {
    let mut line = Line::new(DdcShape::Loop, &[IO]);
    assert_eq!((line.register(1, 8), line.register(1, 7)), (40, 60));
    assert_eq!((line.register(1, 6), line.register(1, 5)), (0xFFFF, 0xFFFF));
    line.wait(30);
    assert_eq!(line.register(1, 8), 40);
    line.network.set_lively();
    let seen: Vec<u16> = (0..240)
        .map(|_| {
            line.wait(1);
            line.register(1, 8)
        })
        .collect();
    assert_eq!(
        (seen.iter().min(), seen.iter().max()),
        (Some(&0), Some(&100))
    );
    assert!(seen.windows(2).all(|w| w[0].abs_diff(w[1]) <= 2));
    line.trouble("analog-lost-1");
    assert_eq!(line.register(1, 8), 0);
    assert_ne!(line.register(1, 7), 0);
}

/// What a type does not have can't happen to it.
#[test]
fn troubles_of_other_types() {
    let mut line = Line::new(DdcShape::Loop, &[MX, UEC, CLAMSHELL, IO]);
    for name in [
        "user-fault-1",
        "timer-1",
        "state-1",
        "rotation-1",
        "verify-open-1",
        "energized-1",
        "channel-b-1",
        "analog-lost-3-1",
        "input-9-1",
        "input-10-2",
        "input-10-3",
        "local-4",
        "thermal-4",
        "manual-4",
    ] {
        assert!(!line.network.inject(name.parse().unwrap()), "{name}");
    }
    assert!(line.network.troubles().is_empty());
    for (name, same) in [("user-fault-0-2", "user-fault-2"), ("input-1-2", "input-2")] {
        let trouble: Trouble = name.parse().unwrap();
        assert_eq!(trouble.to_string(), same);
    }
}

/// Section 4.3.1: bits 10 and 11 as each type reports them.
#[test]
fn own_channels() {
    let mut line = Line::new(DdcShape::Loop, &[MX, UEC, IO]);
    for _ in 0..3 {
        line.wait(20);
        for port in HostPort::BOTH {
            for unit in 1..=3 {
                line.through(port, unit, &[3, 0, 8, 0, 1]);
            }
        }
    }
    assert_eq!(line.register(1, 9) & (A | B), 0);
    assert_eq!(
        line.register(2, 9) & (A | B),
        B,
        "the board of channel B is not there"
    );
    assert_eq!(line.register(3, 9) & (A | B), B);
    // Without port 2 an MX notices after 60 s, on channel B, and is not reset.
    for _ in 0..4 {
        line.wait(16);
        line.register(1, 9);
    }
    assert_eq!(line.register(1, 9) & (A | B), B);
    line.wait(1000);
    assert_eq!(
        line.register(1, 9) & (A | B),
        B,
        "channel A works again with this very poll"
    );
}

/// Section 4.3: three waits of 60 s and UART resets, then the processor, then nothing more. The
/// resets of unit 1 take 11 s.
#[test]
fn the_watchdog_of_a_uec() {
    let listens = |at: u64| {
        let mut line = Line::new(DdcShape::Loop, &[UEC]);
        line.register(1, 10);
        line.wait(at);
        line.network.advance(line.now);
        let listens = line.network.listens(1);
        let answer = line.through(HostPort::One, 1, &[3, 0, 9, 0, 1]);
        assert_eq!(answer.is_some(), listens);
        (listens, answer.map(|a| a[2] & 0x10 != 0))
    };
    for (at, expected) in [
        (59, (true, Some(false))),
        (61, (false, None)),
        (70, (false, None)),
        (72, (true, Some(false))),
        (130, (true, Some(false))),
        (132, (false, None)),
        (143, (true, Some(false))),
        (203, (false, None)),
        // The third is followed by the reset of the processor.
        (214, (false, None)),
        (223, (false, None)),
        (225, (true, Some(true))),
        (100_000, (true, Some(true))),
    ] {
        assert_eq!(listens(at), expected, "after {at} s");
    }
    // An MX does not do that.
    let mut line = Line::new(DdcShape::Loop, &[MX]);
    line.register(1, 10);
    line.wait(65);
    assert_eq!(line.register(1, 10), 0);
    // A poll begins all anew, and the time can be set.
    let mut line = Line::new(DdcShape::Loop, &[UEC]);
    line.ask(1, &[6, 0, 111, 0, 10]);
    line.wait(9);
    line.register(1, 9);
    line.wait(9);
    line.register(1, 9);
    line.wait(11);
    assert_eq!(line.through(HostPort::One, 1, &[3, 0, 8, 0, 1]), None);
}

/// Who answers through ports 1 and 2, as `12`, `1`, `2` or `-` for each unit.
fn reached(shape: DdcShape, troubles: &[&str]) -> String {
    let mut line = Line::new(shape, &[MX; 4]);
    for name in troubles {
        line.trouble(name);
    }
    let of = |unit: u8| {
        let mut text = String::new();
        for port in HostPort::BOTH {
            let answer = line.network.request(port, unit, &[3, 0, 8, 0, 1], line.now);
            if answer.is_some() {
                text.push_str(&port.number().to_string());
            }
        }
        if text.is_empty() {
            "-".to_owned()
        } else {
            text
        }
    };
    (1..=4).map(of).collect::<Vec<_>>().join(" ")
}

#[test]
fn the_cable() {
    use DdcShape::{Loop as Ring, MultiDrop, SingleEnded};
    for (shape, troubles, expected) in [
        (Ring, &[][..], "12 12 12 12"),
        (Ring, &["off-2"], "12 - 12 12"),
        (Ring, &["deaf-2"], "12 - 12 12"),
        (Ring, &["break-2"], "1 1 2 2"),
        (Ring, &["short-2"], "1 1 2 2"),
        (Ring, &["break-0"], "2 2 2 2"),
        (Ring, &["break-4"], "1 1 1 1"),
        (Ring, &["port-1"], "2 2 2 2"),
        (Ring, &["port-2"], "1 1 1 1"),
        (Ring, &["break-1", "break-3"], "1 - - 2"),
        (Ring, &["break-2", "off-1", "off-3"], "- 1 - 2"),
        (SingleEnded, &[], "1 1 1 1"),
        (SingleEnded, &["break-3"], "1 1 1 -"),
        (SingleEnded, &["short-1"], "1 - - -"),
        (SingleEnded, &["off-3"], "1 1 - 1"),
        (MultiDrop, &["break-1"], "1 - - -"),
        (MultiDrop, &["short-3"], "- - - -"),
    ] {
        assert_eq!(reached(shape, troubles), expected, "{shape:?} {troubles:?}");
    }
}

#[test]
fn troubles_by_name() {
    let mut all = vec![
        Trouble::Break(0),
        Trouble::Short(250),
        Trouble::Port(HostPort::Two),
    ];
    all.extend(UnitTrouble::all().map(|what| Trouble::Unit(7, what)));
    let mut line = Line::new(DdcShape::Loop, &[UEC; 8]);
    let mut count = 0;
    for trouble in all {
        assert_eq!(trouble.to_string().parse(), Ok(trouble));
        let there = match trouble {
            Trouble::Short(250) => false,
            // Those of an I/O module.
            Trouble::Unit(_, UnitTrouble::Input(n)) => n < 10,
            _ => true,
        };
        assert_eq!(line.network.inject(trouble), there, "{trouble}");
        assert!(!line.network.inject(trouble), "only once");
        count += usize::from(there);
    }
    // 20 without a number; 10 user faults, 4 analog inputs, 16 timers, 10 inputs, 6 states.
    assert_eq!((line.network.troubles().len(), count), (68, 68));
    for trouble in line.network.troubles().to_vec() {
        assert!(line.network.heal(trouble) && !line.network.heal(trouble));
    }
    line.register(7, 9);
    assert!(!line.network.inject(Trouble::Unit(99, UnitTrouble::Off)));
    for wrong in [
        "",
        "off",
        "off-",
        "off-256",
        "port-3",
        "break--1",
        "gone-1",
        "break-x",
        "off-1-7",
        "user-fault-10-7",
        "analog-lost-0-7",
        "analog-lost-5-7",
        "timer-16-7",
        "state-6-7",
        "input-20-7",
        "user-7",
    ] {
        assert!(wrong.parse::<Trouble>().is_err(), "{wrong}");
    }
}

/// Table 4.1: query, unit and answer together.
#[test]
fn units_answer_as_slowly_as_the_table_says() {
    use crate::ddc100::timing::Line as Wire;
    for (kind, expected) in [(MX, [40, 50, 62]), (UEC, [71, 109, 162])] {
        for (registers, ms) in [1_u8, 5, 10].into_iter().zip(expected) {
            let mut line = Line::new(DdcShape::Loop, &[kind]);
            let answer = line
                .network
                .request(HostPort::One, 1, &[3, 0, 0, 0, registers], line.now);
            let answer = answer.unwrap();
            let wire = Wire::GUIDE;
            let characters = wire.frame(5) + wire.frame(answer.pdu.len());
            let all = wire.characters(characters) + answer.after_us;
            assert_eq!(all, ms * 1000);
            line.wait(1);
        }
    }
}

/// Any request gives an answer of a legal length, or none.
#[test]
fn any_bytes() {
    let mut line = Line::new(DdcShape::Loop, &[MX, UEC, CLAMSHELL, IO]);
    let mut seed = 1_u64;
    for _ in 0..20_000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let bytes = seed.to_be_bytes();
        let length = usize::from(bytes[0] % 8);
        let mut pdu = vec![bytes[7] % 24];
        pdu.extend(&bytes[1..=length.min(6)]);
        line.now = line.now.plus(u64::from(bytes[5]) * 1000);
        let answer = line.through(HostPort::One, bytes[6] % 5, &pdu);
        assert!(answer.is_none_or(|a| (2..=253).contains(&a.len())));
        assert_eq!(line.network.request(HostPort::One, 1, &[], line.now), None);
    }
}
