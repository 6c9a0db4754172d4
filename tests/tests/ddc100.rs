//! DDC-100: the guide's examples, scan times and the diagnosis, by the poller and the simulated
//! network together. The same over real ports is in the tests of the backend.

use shared::capture::Micros;
use shared::ddc100::estimate::estimate;
use shared::ddc100::follow::Follower;
use shared::ddc100::setup::Member;
use shared::ddc100::tables::{RESPONSE_TIMES, SCAN_TIMES};
use shared::ddc100::timing::Line;
use shared::ddc100::{FaultTable, Finding, HostPort, Setup, diagnose};
use shared::device::Device;
use shared::frame::Framing;
use shared::proto::{DdcNews, DdcShape, LineState};
use shared::sim::ddc100::{Trouble, UnitTrouble};
use tests::ddc100::{Bench, registers, units};

fn five(shape: DdcShape, trouble: Option<Trouble>) -> Bench {
    let second = shape == DdcShape::Loop;
    let mut bench = Bench::new(Setup::new(
        shape,
        second,
        units(5, Device::Ddc100Mx),
        registers(8, 9),
    ));
    if let Some(trouble) = trouble {
        assert!(bench.network.inject(trouble));
    }
    bench
}

/// Truth tables of examples 1 to 7: A and B of units 1 to 5.
#[test]
fn the_examples_of_the_guide() {
    use DdcShape::{Loop as Ring, SingleEnded};
    let off = |unit| Some(Trouble::Unit(unit, UnitTrouble::Off));
    let clear = [(0, 0); 5];
    let examples = [
        (Ring, None, clear, "no_fault"),
        (
            Ring,
            off(3),
            [(0, 0), (0, 0), (1, 1), (0, 0), (0, 0)],
            "off_line",
        ),
        (
            Ring,
            Some(Trouble::Break(3)),
            [(0, 1), (0, 1), (0, 1), (1, 0), (1, 0)],
            "break",
        ),
        (
            Ring,
            Some(Trouble::Port(HostPort::Two)),
            [(0, 1); 5],
            "port_lost",
        ),
        (SingleEnded, None, clear, "no_fault"),
        (
            SingleEnded,
            off(2),
            [(0, 0), (1, 0), (0, 0), (0, 0), (0, 0)],
            "off_line",
        ),
        (
            SingleEnded,
            Some(Trouble::Short(2)),
            [(0, 0), (0, 0), (1, 0), (1, 0), (1, 0)],
            "beyond",
        ),
    ];
    for (number, (shape, trouble, table, key)) in (1..).zip(examples) {
        let mut bench = five(shape, trouble);
        for _ in 0..4 {
            bench.pass();
        }
        assert_eq!(bench.table(), table, "example {number}");
        let found = diagnose(shape, bench.poller.faults());
        assert_eq!(found.unsettled, 0, "example {number}");
        let keys: Vec<_> = found.findings.iter().map(Finding::key).collect();
        assert_eq!(keys, [key], "example {number}");
    }
}

/// Section 4.3.1: five units, unit 3 off, poll by poll.
#[test]
fn the_worked_sequence() {
    let mut bench = five(DdcShape::Loop, Some(Trouble::Unit(3, UnitTrouble::Off)));
    bench.pass();
    bench.pass();
    bench.pass();
    let (ok, fail) = (true, false);
    let first = [
        (1, 1, ok),
        (2, 1, ok),
        (3, 1, fail),
        (3, 2, fail),
        (4, 1, ok),
        (5, 1, ok),
    ];
    let second = [
        (1, 2, ok),
        (2, 2, ok),
        (3, 2, fail),
        (3, 1, fail),
        (4, 2, ok),
        (5, 2, ok),
    ];
    assert_eq!(bench.log, [first, second, first].concat());
}

/// A measured pass in microseconds, without faults.
fn measured(kind: Device, count: u8, read: u16) -> u64 {
    let setup = Setup::new(DdcShape::Loop, true, units(count, kind), registers(1, read));
    let mut bench = Bench::new(setup);
    let first = bench.pass();
    let second = bench.pass();
    assert_eq!(first.took_us, second.took_us);
    assert!(bench.log.iter().all(|(_, _, good)| *good));
    assert!(first.expected_us.abs_diff(first.took_us) <= 2 * u64::from(count));
    first.took_us
}

/// Scan times against table 4.2 and the turn time of the host: 10 to 250 units that answer as
/// slowly as table 4.1 says. Run with `--nocapture` for the comparison.
#[test]
fn scan_times_of_table_4_2() {
    println!("| units | registers | type | scanned | table 4.2 | and turn time | least |");
    println!("|---|---|---|---|---|---|---|");
    let mut slower = Vec::new();
    for scan in &SCAN_TIMES {
        for kind in [Device::Ddc100Mx, Device::Ddc100Uec] {
            let printed = scan.of(kind);
            let count = u8::try_from(scan.units).expect("at most 250");
            // After the last answer the pass is over.
            let turn = 21_000 * (u64::from(scan.units) - 1);
            let took = measured(kind, count, scan.registers);
            let e = estimate(kind, scan.units, scan.registers, Line::GUIDE, 21_000);
            let least = e.expect("legal").least_scan_us;
            assert!(least < took);
            println!(
                "| {count} | {} | {} | {:.2} | {} | {:.2} | {:.2} |",
                scan.registers,
                if kind == Device::Ddc100Mx {
                    "MX"
                } else {
                    "UEC"
                },
                took as f64 / 1e6,
                printed.text,
                (printed.us + turn) as f64 / 1e6,
                least as f64 / 1e6,
            );
            // Characters are counted in whole microseconds.
            let rounding = 2 * u64::from(scan.units);
            if took > printed.us + turn + rounding {
                slower.push((count, scan.registers, kind));
                // Only where table 4.2 contradicts table 4.1 (reading D23), which is held then.
                let response = RESPONSE_TIMES
                    .iter()
                    .find(|r| r.registers == scan.registers);
                let each = response.expect("a line of table 4.1").of(kind);
                let bound = each * u64::from(scan.units) + turn;
                assert!(took <= bound + rounding, "{took} > {bound}");
            }
        }
    }
    let mx = Device::Ddc100Mx;
    assert_eq!(slower, [(10, 10, mx), (20, 5, mx), (250, 5, mx)]);
}

/// Mixed types, other lines: what is predicted is what is measured.
#[test]
fn predicted_and_measured() {
    for (baud, framing) in [
        (1200, Framing::Rtu),
        (19_200, Framing::Rtu),
        (9600, Framing::Ascii),
    ] {
        let kinds = [
            Device::Ddc100Mx,
            Device::Ddc100Uec,
            Device::Ddc100Clamshell,
            Device::Ddc100Io,
        ];
        let members = (1..=40).map(|unit| Member {
            unit,
            kind: kinds[usize::from(unit) % 4],
        });
        let mut setup = Setup::new(
            DdcShape::SingleEnded,
            false,
            members.collect(),
            registers(1, 56),
        );
        setup.line = Line {
            framing,
            baud,
            bits: 10,
        };
        let mut bench = Bench::new(setup);
        let pass = bench.pass();
        assert!(
            bench.log.iter().all(|(_, _, good)| *good),
            "time-outs are long enough"
        );
        assert!(pass.expected_us.abs_diff(pass.took_us) <= 80);
    }
}

/// A unit without power is found, and found again when it comes back; so is a UEC-3-DDC that its
/// watchdog has reset.
#[test]
fn units_come_back() {
    let mut bench = five(DdcShape::Loop, None);
    for name in ["off-3", "deaf-3", "break-2", "port-1"] {
        let trouble: Trouble = name.parse().expect("a name");
        assert!(bench.network.inject(trouble));
        for _ in 0..4 {
            bench.pass();
        }
        assert_ne!(bench.table(), [(0, 0); 5], "{name}");
        assert!(bench.network.heal(trouble));
        for _ in 0..4 {
            bench.pass();
        }
        assert_eq!(bench.table(), [(0, 0); 5], "{name}");
    }
    // Two breaks cut unit 3 off for so long that its watchdog resets it again and again.
    let setup = Setup::new(
        DdcShape::Loop,
        true,
        units(5, Device::Ddc100Uec),
        registers(8, 9),
    );
    let mut bench = Bench::new(setup);
    for place in [2, 3] {
        assert!(bench.network.inject(Trouble::Break(place)));
    }
    while bench.now < Micros::new(400_000_000) {
        bench.pass();
    }
    let found = diagnose(DdcShape::Loop, bench.poller.faults());
    assert_eq!(
        found.findings.iter().map(Finding::key).collect::<Vec<_>>(),
        ["break_among"]
    );
    for place in [2, 3] {
        assert!(bench.network.heal(Trouble::Break(place)));
    }
    for _ in 0..4 {
        bench.pass();
    }
    assert_eq!(bench.table(), [(0, 0); 5]);
}

/// A page that hears all news has the faults of the host, whatever happens, and comes to the same
/// diagnosis when it is certain.
#[test]
fn the_page_comes_to_the_same_table() {
    let mut bench = five(DdcShape::Loop, None);
    let mut page = Follower::new(1..=5, true);
    let same = |page: &Follower, faults: &FaultTable| {
        let page = page.table();
        assert!(page.units().eq(faults.units()), "{page:?} {faults:?}");
        let [said, known] = [page, faults].map(|t| diagnose(DdcShape::Loop, t));
        if said.unsettled == 0 && known.unsettled == 0 {
            assert_eq!(said, known);
        }
    };
    let troubles = ["off-3", "break-2", "port-1", "break-4", "deaf-5", "short-0"];
    for (round, name) in troubles.into_iter().cycle().take(60).enumerate() {
        let trouble: Trouble = name.parse().expect("a name");
        if !bench.network.heal(trouble) {
            bench.network.inject(trouble);
        }
        if round == 30 {
            let port = |state| DdcNews::Port {
                bus: String::new(),
                port: 2,
                state,
                text: String::new(),
            };
            for (up, state) in [(false, LineState::Down), (true, LineState::Up)] {
                bench.poller.set_port(HostPort::Two, up);
                page.hear(&port(state));
                same(&page, bench.poller.faults());
            }
        }
        for _ in 0..40 + round {
            let before = bench.log.len();
            let pass = bench.step();
            if let Some((unit, port, _)) = bench.log.get(before).copied() {
                let faults = bench.poller.faults();
                let news = tests::ddc100::unit_news(faults, unit, port);
                page.hear(&news);
                same(&page, faults);
            }
            if let Some(pass) = pass {
                page.hear(&tests::ddc100::pass_news(pass));
            }
        }
    }
}
