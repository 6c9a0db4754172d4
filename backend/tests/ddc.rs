//! DDC-100 networks: the poller of the backend against simulated units, over pseudo terminals on
//! two ports and in simulated time.
//!
//! Truth tables and times are those of LMAIM4019-00 (9/04), sections 4.3 and 4.3.2.

mod common;
mod networks;

use backend::config::DdcPorts;
use networks::{Ends, Setting, units};
use shared::device::Device;
use shared::frame::Framing;
use shared::proto::{DdcNews, DdcShape, LineState, Outcome};
use std::time::Duration;
use tokio::time::Instant;

const MIXED: [Device; 5] = [
    Device::Ddc100Mx,
    Device::Ddc100Uec,
    Device::Ddc100Clamshell,
    Device::Ddc100Io,
    Device::Ddc100MxB,
];

/// Faults (A, B) of units 1 to 5, 1 for a fault; the host with one port keeps no B.
type Truth = [(u8, u8); 5];

/// Its number, what is wrong, and what the host knows then.
type Example = (&'static str, &'static [&'static str], Truth);

/// Section 4.3.2, examples 1 to 4 (redundant loop).
const LOOP: [Example; 6] = [
    ("1", &[], [(0, 0); 5]),
    ("2", &["off-3"], [(0, 0), (0, 0), (1, 1), (0, 0), (0, 0)]),
    ("3", &["break-3"], [(0, 1), (0, 1), (0, 1), (1, 0), (1, 0)]),
    ("3", &["short-3"], [(0, 1), (0, 1), (0, 1), (1, 0), (1, 0)]),
    ("4", &["port-2"], [(0, 1); 5]),
    // Not printed: the mirror of 4.
    ("4, mirrored", &["port-1"], [(1, 0); 5]),
];

/// Examples 5 to 7 (one port). B is "always 0" there; here it is unknown, which is not a fault.
const SINGLE: [Example; 4] = [
    ("5", &[], [(0, 0); 5]),
    ("6", &["off-2"], [(0, 0), (1, 0), (0, 0), (0, 0), (0, 0)]),
    ("7", &["break-2"], [(0, 0), (0, 0), (1, 0), (1, 0), (1, 0)]),
    ("7", &["short-2"], [(0, 0), (0, 0), (1, 0), (1, 0), (1, 0)]),
];

async fn check_truth(framing: Framing, shape: DdcShape, examples: &[Example]) {
    let checks = examples.iter().map(|e| check_example(framing, shape, *e));
    futures_util::future::join_all(checks).await;
}

async fn check_example(framing: Framing, shape: DdcShape, (example, troubles, truth): Example) {
    let setting = Setting {
        framing,
        baud: 19_200,
        shape,
        retries: 0,
        troubles,
        ..Setting::default()
    };
    let mut network = setting.start(&units(&MIXED), Ends::Ptys).await;
    let second = shape == DdcShape::Loop;
    let want: Vec<_> = truth
        .iter()
        .map(|(a, b)| (Some(*a == 1), second.then_some(*b == 1)))
        .collect();
    // Each unit was tried on each port, and nothing changes in the second round.
    for passes in [2, 4] {
        network.until_pass(passes).await;
        let seen = network.faults();
        assert_eq!(seen, want, "example {example}, {troubles:?}, {framing:?}");
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn examples_of_the_redundant_loop() {
    check_truth(Framing::Rtu, DdcShape::Loop, &LOOP).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn examples_of_the_single_ended_loop() {
    check_truth(Framing::Rtu, DdcShape::SingleEnded, &SINGLE).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn examples_in_ascii() {
    check_truth(Framing::Ascii, DdcShape::Loop, &LOOP[1..3]).await;
    check_truth(Framing::Ascii, DdcShape::SingleEnded, &SINGLE[2..3]).await;
}

/// The worked example of section 4.3.2: unit 3 of 5 is off. The order of the polls on the wire.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn polls_go_out_in_the_order_of_the_worked_example() {
    let setting = Setting {
        retries: 0,
        baud: 19_200,
        troubles: &["off-3"],
        ..Setting::default()
    };
    let mut network = setting.start(&units(&MIXED), Ends::Ptys).await;
    network.until_pass(3).await;
    let polls = network.requests();
    let want = [
        (1, 1),
        (2, 1),
        (3, 1),
        (3, 2),
        (4, 1),
        (5, 1),
        (1, 2),
        (2, 2),
        (3, 2),
        (3, 1),
        (4, 2),
        (5, 2),
    ];
    let seen: Vec<(u8, u8)> = polls.iter().map(|r| (r.unit, r.port)).collect();
    assert_eq!(seen[..12], want);
    assert_eq!(seen[12..16], want[..4], "and so on from the beginning");
}

/// Section 4.3: more than 20 ms and less than 50 ms from an answer to the next request, and never
/// less than 3.5 characters, whichever port is used.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_host_turns_as_the_guide_wants() {
    for (baud, turn_ms) in [(19_200, 21), (1200, 35)] {
        let setting = Setting {
            baud,
            turn_ms,
            thinks: true,
            ..Setting::default()
        };
        let mut network = setting.start(&units(&MIXED), Ends::Ptys).await;
        network.until_pass(if baud == 1200 { 2 } else { 12 }).await;
        let requests = network.requests();
        let mut turns: Vec<Duration> = requests
            .windows(2)
            .filter_map(|pair| Some(pair[1].at - pair[0].answered?))
            .collect();
        turns.sort_unstable();
        let (first, middle) = (turns[0], turns[turns.len() / 2]);
        let last = turns[turns.len() - 1];
        println!("{baud} baud, {turn_ms} ms: turns from {first:?}, median {middle:?}, to {last:?}");
        let changes = requests.windows(2).filter(|p| p[0].port != p[1].port);
        assert!(changes.count() >= 1, "both ports were used");
        let character = Duration::from_secs_f64(11.0 / f64::from(baud));
        assert!(first > Duration::from_millis(20), "{first:?}");
        assert!(first > character * 7 / 2, "{first:?}");
        assert!(middle < Duration::from_millis(50), "{middle:?}");
    }
}

/// The same in simulated time, where no other program holds anything up: every turn is long and short
/// enough, also after a poll without an answer, by both framings and at each speed.
#[tokio::test(start_paused = true)]
async fn every_turn_is_as_the_guide_wants() {
    let (least, most) = (Duration::from_millis(20), Duration::from_millis(50));
    for framing in [Framing::Rtu, Framing::Ascii] {
        for baud in [1200, 2400, 4800, 9600, 19_200] {
            // At 1200 baud the silence of RTU alone takes 29 ms.
            for turn_ms in [21, 35, 49] {
                let setting = Setting {
                    framing,
                    baud,
                    turn_ms,
                    thinks: true,
                    troubles: &["off-3"],
                    ..Setting::default()
                };
                let mut network = setting.start(&units(&MIXED), Ends::Duplex).await;
                network.until_pass(6).await;
                let requests = network.requests();
                let turns: Vec<Duration> = requests
                    .windows(2)
                    .filter_map(|pair| Some(pair[1].at - pair[0].answered?))
                    .collect();
                assert!(turns.len() >= 6 * 4 - 1);
                for turn in turns {
                    let good = turn >= least && turn <= most;
                    assert!(good, "{framing:?}, {baud} baud, {turn_ms} ms: {turn:?}");
                }
            }
        }
    }
}

/// More units on a multi-drop line than it carries without repeaters: polled all the same, and said.
#[tokio::test(start_paused = true)]
async fn too_many_units_on_a_line_are_told() {
    for (count, told) in [(28, false), (29, true)] {
        let setting = Setting {
            shape: DdcShape::MultiDrop,
            ..Setting::default()
        };
        let kinds = vec![Device::Ddc100Mx; count];
        let mut network = setting.start(&units(&kinds), Ends::Duplex).await;
        network.until_pass(1).await;
        let hint = network.hint();
        assert_eq!(hint.is_some(), told, "{hint:?}");
        assert!(hint.is_none_or(|h| h.contains("28 units") && h.contains("29")));
    }
}

/// A port that is pulled out is a fault of all units on it; it is found again by itself.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_port_is_cut_and_comes_back() {
    let setting = Setting {
        retries: 0,
        baud: 19_200,
        ..Setting::default()
    };
    let mut network = setting.start(&units(&MIXED), Ends::Ptys).await;
    network.until_pass(2).await;
    assert_eq!(network.faults(), [(Some(false), Some(false)); 5]);
    network.unplug(2);
    network
        .until(|n| n.port(2).is_some_and(|p| p.0 == LineState::Down))
        .await;
    let text = network.port(2).unwrap().1;
    assert!(
        text.contains("port-2") && text.contains("unplugged"),
        "{text}"
    );
    network
        .until(|n| n.faults() == [(Some(false), Some(true)); 5])
        .await;
    // The other port goes on as if nothing had happened.
    let pass = network.pass();
    network.until_pass(pass + 3).await;
    assert_eq!(network.port(1).unwrap().0, LineState::Up);
    assert!(network.answers_of(1).is_some());
    network.plug(2).await;
    network
        .until(|n| n.faults() == [(Some(false), Some(false)); 5])
        .await;
    assert_eq!(network.port(2).unwrap().0, LineState::Up);
}

/// A network of which no port can be opened says so of all its units, and asks nobody.
#[tokio::test]
async fn a_network_without_any_port_says_so() {
    let setting = Setting::default();
    let ports = DdcPorts::Serial("/dev/valvescope-1".into(), Some("/dev/valvescope-2".into()));
    let mut network = setting.start(&units(&MIXED), Ends::Configured(ports)).await;
    network
        .until(|n| n.port(2).is_some_and(|p| p.0 == LineState::Down))
        .await;
    assert!(network.port(1).unwrap().1.contains("/dev/valvescope-1"));
    let report = network.read(0, 8, 2).await;
    assert_eq!(report.outcome, Outcome::Down, "{}", report.text);
    assert!(report.text.contains("/dev/valvescope-2"), "{}", report.text);
    assert_eq!(network.requests().len(), 0);
}

/// What pages read goes between two polls, one at a time, through a port that reaches the unit.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn pages_are_served_between_polls() {
    let setting = Setting {
        retries: 0,
        baud: 19_200,
        troubles: &["break-2"],
        ..Setting::default()
    };
    let mut network = setting.start(&units(&MIXED), Ends::Ptys).await;
    network.until_pass(2).await;
    let before = network.requests().len();
    // Unit 4 is reached through port 2 only.
    for _ in 0..5 {
        let report = network.read(3, 8, 2).await;
        assert_eq!(report.outcome, Outcome::Ok, "{}", report.text);
    }
    let requests = network.requests();
    let reads: Vec<usize> = (before..requests.len())
        .filter(|n| requests[*n].pdu == [3, 0, 8, 0, 2])
        .collect();
    assert_eq!(reads.len(), 5);
    assert!(reads.windows(2).all(|w| w[1] > w[0] + 1), "{reads:?}");
    assert!(reads.iter().all(|n| requests[*n].port == 2), "{reads:?}");
    // Beyond the registers of a unit it refuses, and that is an answer.
    let report = network.read(0, 900, 1).await;
    assert_eq!(report.outcome, Outcome::Exception, "{}", report.text);
}

/// Table 4.1, in milliseconds: an exchange of so many registers, MX and UEC.
const TABLE_4_1: [(u16, u64, u64); 3] = [(1, 40, 71), (5, 50, 109), (10, 62, 162)];

/// Table 4.2, in milliseconds: units, then for 1, 5 and 10 registers MX and UEC.
const TABLE_4_2: [(u8, [(u64, u64); 3]); 7] = [
    (10, [(400, 940), (500, 1_400), (610, 1_900)]),
    (20, [(800, 1_900), (980, 2_800), (1_300, 3_800)]),
    (40, [(1_600, 3_900), (2_000, 5_600), (2_500, 7_600)]),
    (50, [(2_300, 5_000), (2_900, 7_000), (3_800, 9_600)]),
    (100, [(4_600, 11_000), (6_000, 15_000), (6_500, 20_000)]),
    (200, [(9_200, 24_000), (10_000, 32_000), (13_000, 43_000)]),
    (250, [(11_500, 32_000), (12_000, 42_000), (16_000, 56_000)]),
];

/// The fastest of at most so many passes over so many units, in milliseconds, as the poller measured
/// it, and as it expected it. One that is as fast as expected, or slower by so many percent, ends the
/// search.
async fn scan(
    count: u8,
    kind: Device,
    registers: u16,
    ends: Ends,
    (passes, percent): (u64, u64),
) -> (u64, u64) {
    let setting = Setting {
        registers: (9, registers),
        thinks: true,
        ..Setting::default()
    };
    let kinds = vec![kind; usize::from(count)];
    let mut network = setting.start(&units(&kinds), ends).await;
    let mut best = (u64::MAX, 0);
    for pass in 1..=passes {
        network.until_pass(pass).await;
        if let Some(DdcNews::Pass {
            took_us,
            expected_us,
            ..
        }) = network.pass_news()
        {
            best = best.min((took_us / 1000, expected_us / 1000));
        }
        if best.0 <= best.1 + best.1 * percent / 100 {
            break;
        }
    }
    best
}

/// Units that answer as slowly as table 4.1 says are scanned within table 4.2 plus the turn time of
/// the host, except where table 4.2 itself is below so many times table 4.1 (reading D23).
#[tokio::test(start_paused = true)]
async fn scan_times_are_those_of_the_guide() {
    const TURN: u64 = 21;
    let mut contradictions = Vec::new();
    println!("units, registers: table 4.2 + turn | units x (table 4.1 + turn) | measured, in ms");
    for (count, row) in TABLE_4_2 {
        for ((registers, mx, uec), (mx_all, uec_all)) in TABLE_4_1.into_iter().zip(row) {
            for (kind, each, all) in [
                (Device::Ddc100Mx, mx, mx_all),
                (Device::Ddc100Uec, uec, uec_all),
            ] {
                // The first pass may begin with a turn.
                let (took, expected) = scan(count, kind, registers, Ends::Duplex, (2, 0)).await;
                let units = u64::from(count);
                // After the last answer the pass is over.
                let turns = (units - 1) * TURN;
                let (table, product) = (all + turns, units * each + turns);
                println!(
                    "{} {count}, {registers}: {table} | {product} | {took}",
                    kind.key()
                );
                assert!(took.abs_diff(expected) <= 1, "{took} {expected}");
                // Both are whole milliseconds, and so are the timers of simulated time.
                if product > table {
                    contradictions.push((kind.key(), count, registers));
                    assert!(took <= product, "{took} > {product}");
                } else {
                    assert!(took <= table, "{took} > {table}");
                }
            }
        }
    }
    assert_eq!(
        contradictions,
        [
            ("ddc100-mx", 10, 10),
            ("ddc100-mx", 20, 5),
            ("ddc100-mx", 250, 5),
        ]
    );
}

/// The same over real pseudo terminals, for a few units; all counts with
/// `VALVESCOPE_SCAN=1` (about ten minutes).
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn scan_times_over_ptys() {
    let all = std::env::var_os("VALVESCOPE_SCAN").is_some();
    let rows = if all { &TABLE_4_2[..] } else { &TABLE_4_2[..1] };
    for (count, row) in rows {
        for ((registers, mx, uec), (mx_all, uec_all)) in TABLE_4_1.into_iter().zip(*row) {
            for (kind, each, all_ms) in [
                (Device::Ddc100Mx, mx, mx_all),
                (Device::Ddc100Uec, uec, uec_all),
            ] {
                if !all && registers != 5 {
                    continue;
                }
                let (took, expected) = scan(*count, kind, registers, Ends::Ptys, (15, 1)).await;
                let turns = u64::from(*count - 1) * 21;
                let (table, product) = (all_ms + turns, u64::from(*count) * each + turns);
                println!(
                    "{} {count}, {registers}: table 4.2 {table} | table 4.1 {product} | expected \
                     {expected} | measured {took} ms",
                    kind.key()
                );
                // Both ends are held up by whatever else this computer does; simulated time is
                // strict.
                let bound = table.max(product);
                assert!(took <= bound + bound / 10, "{took} > {bound}");
            }
        }
    }
}

/// What the cable needs for a pass does not depend on pages that take nothing.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn polling_goes_on_while_nobody_listens() {
    let setting = Setting {
        baud: 19_200,
        ..Setting::default()
    };
    let mut network = setting.start(&units(&MIXED), Ends::Ptys).await;
    let began = Instant::now();
    network.until_pass(20).await;
    println!("20 passes of 5 units in {:?}", began.elapsed());
    // However long it runs, what waits for a page is one message for each unit and a few more.
    assert!(network.waiting() <= 5 + 5);
}
