//! Every reading of the DDC-100 guide is held by a test, or says why it needs none.
//!
//! The numbers in the checks are those of the guide's tables and examples.

use shared::address::{Address, Table};
use shared::ddc100::checklist::Wish;
use shared::ddc100::estimate::{Compared, compared};
use shared::ddc100::scaling::Scaling;
use shared::ddc100::timing::{Line, timeout};
use shared::ddc100::view::{Mode, combined};
use shared::device::Device;
use shared::encode::Read;
use shared::map::row::{Access, Kind, Reading, Row, Settled};

/// How a reading is held.
enum Held {
    /// By this.
    By(fn()),
    /// Elsewhere, or not at all, for this reason.
    Because(&'static str),
}
use Held::{Because, By};

const MX: Device = Device::Ddc100Mx;
const UEC: Device = Device::Ddc100Uec;
const CLAMSHELL: Device = Device::Ddc100Clamshell;
const IO: Device = Device::Ddc100Io;

fn row(kind: Device, table: Table, number: u16) -> &'static Row {
    let map = kind.map().expect("a map");
    map.row_at(table, Address::new(number - 1)).expect("a row")
}

fn label(kind: Device, table: Table, number: u16) -> &'static str {
    row(kind, table, number).label
}

/// The label of a bit of a holding register; empty if it has none.
fn bit(kind: Device, number: u16, bit: u32) -> &'static str {
    let set = row(kind, Table::Holding, number).set.expect("bits");
    set.get(bit).map_or("", |m| m.label)
}

fn command(kind: Device, value: u32) -> String {
    let set = row(kind, Table::Holding, 1).set.expect("commands");
    set.get(value)
        .map_or_else(String::new, |m| m.name(value).into_owned())
}

/// A row rests on a reading.
fn rests(kind: Device, table: Table, number: u16, id: &str) {
    let reading = row(kind, table, number).reading;
    assert_eq!(reading.map(|r| r.id), Some(id), "{kind:?} {number}");
}

/// A row's note mentions a reading.
fn mentions(kind: Device, table: Table, number: u16, id: &str) {
    let map = kind.map().expect("a map");
    let note = row(kind, table, number).note;
    assert!(map.mentioned(note).any(|r| r.id == id), "{note}");
}

fn reading(id: &str) -> Option<&'static Reading> {
    MX.map().expect("a map").reading(id)
}

/// All readings, in their order.
const HELD: [(&str, Held); 36] = [
    (
        "D1",
        By(|| {
            assert_eq!(label(CLAMSHELL, Table::Coil, 2), "Open / Stop");
            rests(CLAMSHELL, Table::Coil, 2, "D1");
        }),
    ),
    (
        "D2",
        By(|| {
            assert_eq!(command(MX, 2816), "Engage AS-3");
            assert_eq!(label(MX, Table::Coil, 5), "AS-3");
            assert_eq!(bit(MX, 11, 4), "AS-3");
            assert_eq!(command(UEC, 2816), "Engage relay 3");
            assert_eq!(label(UEC, Table::Coil, 3), "Lockout or Relay 3");
            assert_eq!(Wish::Engage(3).name(MX).as_deref(), Some("Engage AS-3"));
        }),
    ),
    (
        "D3",
        By(|| {
            assert_eq!(command(IO, 2304), "Engage relay K2");
            assert_eq!(command(IO, 2560), "Engage relay K1");
            assert_eq!(label(IO, Table::Coil, 7), "Relay 2 (K2)");
            assert_eq!(bit(IO, 11, 6), "Relay 2 (K2)");
            rests(IO, Table::Coil, 7, "D3");
        }),
    ),
    (
        "D4",
        By(|| {
            // 16 02 02 01 08: inputs 129 and 140, not 132.
            let on = bits_of(UEC, &[2, 0, 0x80, 0, 16], &[2, 2, 0x01, 0x08]);
            assert_eq!(on, ["Opened", "Network Channel B fault"]);
            mentions(UEC, Table::Discrete, 140, "D4");
        }),
    ),
    (
        "D5",
        By(|| {
            assert_eq!(label(MX, Table::Holding, 8), "Valve position");
            assert_eq!(label(IO, Table::Holding, 8), "Analog input 1");
            rests(UEC, Table::Holding, 8, "D5");
        }),
    ),
    (
        "D6",
        By(|| {
            mentions(UEC, Table::Input, 5, "D6");
            assert_eq!(label(UEC, Table::Input, 8), label(UEC, Table::Holding, 8));
        }),
    ),
    (
        "D7",
        By(|| {
            let keys = Scaling::ALL.map(Scaling::key);
            assert_eq!(keys, ["0-100", "0-255", "0-4095", "raw"]);
            mentions(UEC, Table::Holding, 8, "D7");
        }),
    ),
    (
        "D8",
        By(|| {
            for bits in [1 << 5, 1 << 8, 1 << 9, 1 << 15, 1 << 10 | 1 << 11] {
                assert!(combined(bits));
            }
            assert!(!combined(1 << 12 | 1 << 13 | 1 << 14 | 1 << 11));
            rests(UEC, Table::Holding, 9, "D8");
        }),
    ),
    (
        "D9",
        By(|| {
            rests(MX, Table::Holding, 9, "D9");
            // STOP: bit 6 is 0 before and 1 after the second quarter of 1999; register 12 decides.
            assert_eq!(Mode::of(MX, Some(false), Some(false)), Mode::Stop);
            assert_eq!(Mode::of(UEC, Some(false), Some(false)), Mode::LocalOrStop);
            assert_eq!(Mode::of(MX, Some(true), Some(false)), Mode::LocalOrStop);
            assert_eq!(Mode::of(MX, Some(false), None), Mode::NotLocal);
        }),
    ),
    (
        "D10",
        By(|| {
            assert_eq!(row(MX, Table::Holding, 15).kind, Kind::Reserved);
            rests(MX, Table::Holding, 15, "D10");
        }),
    ),
    (
        "D11",
        By(|| assert_eq!(label(UEC, Table::Holding, 55), "TP_BEFORE_MID_T_HIGH")),
    ),
    (
        "D12",
        By(|| {
            for number in (145..=155).chain([157, 164, 165]) {
                rests(UEC, Table::Discrete, number, "D12");
            }
            assert_eq!(label(UEC, Table::Discrete, 157), bit(UEC, 10, 12));
        }),
    ),
    (
        "D13",
        By(|| {
            for (number, place) in [(167, 6), (168, 7)] {
                assert_eq!(label(UEC, Table::Discrete, number), bit(UEC, 11, place));
                assert_eq!(label(IO, Table::Discrete, number), bit(IO, 11, place));
            }
        }),
    ),
    (
        "D14",
        By(|| {
            for (number, place) in (169..=176).zip(8..) {
                assert_eq!(label(UEC, Table::Discrete, number), bit(UEC, 11, place));
                assert!(bit(UEC, 11, place).starts_with("Field unit software"));
            }
        }),
    ),
    (
        "D15",
        By(|| {
            assert_eq!(bit(UEC, 11, 6), "Close contactor (non-interlocked)");
            assert_eq!(bit(UEC, 11, 7), "Open contactor (non-interlocked)");
        }),
    ),
    ("D16", By(|| assert_eq!(bit(UEC, 11, 5), "User relay 6"))),
    (
        "D17",
        By(|| {
            let inputs = [12, 13, 14, 15].map(|at| bit(IO, 13, at));
            let numbers = ["18", "19", "16", "17"].map(|n| format!("User input {n}"));
            assert_eq!(inputs.map(str::to_owned), numbers);
        }),
    ),
    (
        "D18",
        By(|| {
            assert!(!MX.implements(2));
            assert!([UEC, CLAMSHELL, IO].iter().all(|k| k.implements(2)));
        }),
    ),
    (
        "D19",
        By(|| {
            assert_eq!(command(MX, 19_250), "Move to 50 %");
            assert_eq!(command(UEC, 6656), "Move to the argument");
            assert_eq!(Wish::MoveTo(50).command(), Some(19_250));
        }),
    ),
    (
        "D20",
        Because(
            "the fixtures have the one message, the simulator carries out both orders: simulator test d20_argument_and_command",
        ),
    ),
    (
        "D21",
        By(|| {
            assert_eq!(row(MX, Table::Holding, 2).range, Some((0, 100)));
            assert_eq!(Wish::MoveTo(100).command(), Some(19_300));
            assert_eq!(Wish::MoveTo(101).command(), None);
        }),
    ),
    (
        "D22",
        By(|| {
            for function in [6, 16] {
                assert!(MX.implements(function));
            }
            mentions(MX, Table::Holding, 1, "D22");
        }),
    ),
    (
        "D23",
        By(|| {
            // 50 units 3.8 s, 100 units 6.5 s: 76 and 65 ms each.
            let all = compared(MX);
            let each = |units| {
                let cell = all.iter().find(|c| c.units == units && c.registers == 10);
                cell.expect("printed").each_us
            };
            assert_eq!((each(50), each(100)), (76_000, 65_000));
            assert!(compared(UEC).iter().all(|c| c.percent() >= 117));
            assert_eq!(all.iter().filter(|c| c.is_too_short()).count(), 2);
            assert_eq!(all.iter().map(Compared::percent).min(), Some(96));
        }),
    ),
    (
        "D24",
        By(|| {
            let read = |n| Read::new(Table::Holding, Address::new(0), n).expect("legal");
            // 117 characters at 9600 baud are 122 ms, 25 at 1200 are 208 ms, before the unit thinks.
            assert_eq!(Line::GUIDE.answer(&read(56)) / 1000, 121);
            let slow = Line {
                baud: 1200,
                ..Line::GUIDE
            };
            assert!(timeout(slow, MX, &read(10), 0) > 400_000);
            assert!(timeout(Line::GUIDE, UEC, &read(56), 0) > 1_000_000);
        }),
    ),
    (
        "D25",
        By(|| {
            assert_eq!(label(MX, Table::Coil, 1), "Close / Stop");
            assert_eq!(row(MX, Table::Coil, 1).address, Address::new(0));
            mentions(MX, Table::Coil, 2, "D25");
        }),
    ),
    (
        "D26",
        By(|| {
            for number in 3..=56 {
                assert_eq!(row(UEC, Table::Holding, number).access, Access::Read);
            }
            for number in 1..=2 {
                assert_eq!(row(UEC, Table::Holding, number).access, Access::WriteOnly);
            }
        }),
    ),
    ("D27", By(|| rests(UEC, Table::Holding, 112, "D27"))),
    (
        "D28",
        Because(
            "coils 1 and 2 of the maps mention it, and the simulator stops either way: simulator test d28_off_stops",
        ),
    ),
    (
        "D29",
        Because(
            "a demand on masters; ours sends reads (01 to 04) and the counters of function 08, and needs no more: backend test only_reads_come_out_of_the_ports",
        ),
    ),
    (
        "D30",
        Because(
            "all 26 printed messages are fixtures with their CRC (ddc100-guide.txt); ASCII is checked against pymodbus",
        ),
    ),
    (
        "D31",
        By(|| {
            mentions(MX, Table::Holding, 9, "D31");
            mentions(UEC, Table::Holding, 9, "D31");
        }),
    ),
    (
        "D32",
        By(|| {
            let set = row(MX, Table::Holding, 12).set.expect("bits");
            let states = set.get(11).and_then(|m| m.states);
            assert_eq!(states, Some(("active", "not active")));
        }),
    ),
    (
        "D33",
        By(|| {
            let labels = [3, 4, 5, 6, 7, 8].map(|n| label(IO, Table::Coil, n));
            assert_eq!(
                labels,
                [
                    "Relay 3",
                    "Relay 4",
                    "Relay 5",
                    "Relay 6",
                    "Relay 2 (K2)",
                    "Relay 1 (K1)"
                ]
            );
        }),
    ),
    ("D34", By(|| mentions(MX, Table::Holding, 12, "D34"))),
    (
        "D35",
        By(|| {
            for value in [1024, 6912, 7168] {
                assert_eq!(command(MX, value), "", "{value} has no name");
            }
            assert_eq!(Wish::Engage(8).command(), None);
        }),
    ),
    (
        "D36",
        By(|| {
            assert_eq!(bit(Device::Ddc100MxB, 10, 7), "Any user indicator active");
            assert_eq!(bit(MX, 10, 7), "");
        }),
    ),
];

/// Labels of the bits that an answer says are on.
fn bits_of(kind: Device, request: &[u8], response: &[u8]) -> Vec<&'static str> {
    let mut image = shared::image::Image::new();
    let filled = image.absorb(request, response, shared::capture::Micros::new(1));
    let (table, start, count) = filled.expect("a good answer");
    let on = |at: &u16| {
        let cell = image.cell(table, Address::new(start.get() + at));
        cell.is_some_and(|c| c.word == 1)
    };
    let numbers = (0..count).filter(on);
    numbers
        .map(|at| label(kind, table, start.get() + at + 1))
        .collect()
}

#[test]
fn every_reading_is_held() {
    let expected: Vec<String> = (1..=36).map(|n| format!("D{n}")).collect();
    let held: Vec<&str> = HELD.iter().map(|(id, _)| *id).collect();
    assert_eq!(held, expected);
    for (id, how) in &HELD {
        println!("{id}");
        match how {
            By(test) => test(),
            Because(reason) => assert!(reason.len() > 20, "{id}"),
        }
        // What no value of a map depends on has no text there.
        let silent = matches!(*id, "D29" | "D30");
        assert_eq!(reading(id).is_none(), silent, "{id}");
    }
    let all = MX.map().expect("a map").readings;
    assert_eq!(all.len(), 34);
    assert!(
        all.iter()
            .all(|r| r.settled != Settled::No && !r.text.is_empty())
    );
}
