use super::super::net::Net;
use super::super::net::tests::{network, poll};
use super::*;
use shared::proto::{DdcNews, DdcShape};

const GOOD: [Option<bool>; 2] = [Some(false), Some(false)];
/// Open, channel B not fitted, without a fault.
const WELL: [u16; 9] = [100, 0x0801, 0, 0, 1, 0, 0, 0, 0];

fn texts(net: &Net) -> Vec<String> {
    net.log.events.iter().map(Event::text).collect()
}

fn pass(net: &mut Net, port: u8) {
    let number = net.passes + 1;
    net.hear(DdcNews::Pass {
        bus: "Loop".into(),
        port,
        number,
        took_us: 1,
        expected_us: 1,
    });
}

fn port(net: &mut Net, state: LineState) {
    net.hear(DdcNews::Port {
        bus: "Loop".into(),
        port: 2,
        state,
        text: "no such device".into(),
    });
}

/// Example 3 of section 4.3.2 comes and goes: both stay in the list.
#[test]
fn a_break_that_heals_leaves_a_trace() {
    let mut net = network(5, DdcShape::Loop, 2);
    let all = |net: &mut Net, broken: bool| {
        net.log.now_ms += 10_000;
        for unit in 1..=5 {
            let fault = [Some(broken && unit > 3), Some(broken && unit <= 3)];
            poll(net, unit, fault, &WELL);
        }
        for port in [1, 2, 1, 2] {
            pass(net, port);
        }
    };
    all(&mut net, false);
    assert_eq!(texts(&net), [] as [&str; 0]);
    all(&mut net, true);
    all(&mut net, false);
    let texts = texts(&net);
    assert_eq!(
        texts,
        [
            "No longer: Break or short between unit 3 and unit 4.",
            "units 4 and 5: answers on port 1 again",
            "units 1, 2 and 3: answers on port 2 again",
            "Break or short between unit 3 and unit 4: look at the cable, its terminals and its termination there.",
            "units 4 and 5: no answer on port 1",
            "units 1, 2 and 3: no answer on port 2",
        ]
    );
    let times: Vec<u64> = net.log.events.iter().map(|e| e.at_ms).collect();
    assert_eq!(times, [30_000, 30_000, 30_000, 20_000, 20_000, 20_000]);
}

#[test]
fn a_port_that_flaps_is_told_each_time() {
    let mut net = network(2, DdcShape::Loop, 2);
    for state in [
        LineState::Starting,
        LineState::Up,
        LineState::Down,
        LineState::Down,
        LineState::Up,
        LineState::Down,
    ] {
        port(&mut net, state);
    }
    let ports: Vec<_> = texts(&net)
        .into_iter()
        .filter(|t| t.starts_with("Host port 2"))
        .collect();
    assert_eq!(
        ports,
        [
            "Host port 2 is lost: no such device",
            "Host port 2 is back.",
            "Host port 2 is lost: no such device"
        ]
    );
}

/// Table 3.5: bit 8 of register 10 is cleared by the next poll.
#[test]
fn a_reset_that_the_next_poll_clears_is_kept() {
    let mut net = network(2, DdcShape::Loop, 2);
    let mut reset = WELL;
    let bit = View::of(
        Device::Ddc100Uec,
        &{
            let mut image = Image::new();
            image.absorb(
                &[3, 0, 9, 0, 1],
                &[3, 2, 0xFF, 0xFF],
                shared::capture::Micros::new(1),
            );
            image
        },
        |_: &Row| Scaling::default(),
    )
    .faults
    .iter()
    .find(|b| b.member.key == "processor_reset")
    .unwrap()
    .member
    .value;
    reset[2] = 1 << bit;
    poll(&mut net, 1, GOOD, &WELL);
    poll(&mut net, 1, GOOD, &reset);
    poll(&mut net, 1, GOOD, &WELL);
    poll(&mut net, 2, GOOD, &reset);
    assert_eq!(
        texts(&net),
        [format!(
            "units 1 and 2: Microprocessor reset since the last poll (10.{bit})"
        )]
    );
    // A fault that ends is told, though.
    let mut torque = WELL;
    torque[1] |= 0x1000;
    poll(&mut net, 1, GOOD, &torque);
    poll(&mut net, 1, GOOD, &WELL);
    assert_eq!(
        texts(&net)[..2],
        [
            "unit 1: no longer: Open torque switch fault (9.12)",
            "unit 1: Open torque switch fault (9.12)"
        ]
    );
}

#[test]
fn the_list_is_bounded_and_outlives_the_connection() {
    let mut net = network(2, DdcShape::Loop, 2);
    for _ in 0..300 {
        port(&mut net, LineState::Down);
        port(&mut net, LineState::Up);
    }
    assert_eq!(net.log.events.len(), MOST);
    net.lost();
    net.lost();
    assert!(texts(&net)[0].contains("not seen here") && !texts(&net)[1].contains("not seen"));
    let again = network(2, DdcShape::Loop, 2);
    net.hear(DdcNews::Network {
        bus: "Loop".into(),
        shape: DdcShape::Loop,
        framing: again.framing.clone(),
        baud: again.baud,
        ports: again.ports.iter().map(|p| p.line.clone()).collect(),
        start: again.start,
        count: again.count,
        turn_ms: 30,
        timeout_ms: 250,
        retries: 3,
        units: again.units.iter().map(|u| u.info.clone()).collect(),
        hint: None,
    });
    assert_eq!(net.log.events.len(), MOST);
    assert!(texts(&net)[0].contains("is back"));
}

#[test]
fn events_as_csv() {
    let mut net = network(1, DdcShape::Loop, 2);
    net.log.now_ms = 5;
    poll(&mut net, 1, [Some(true), Some(false)], &WELL);
    let csv = net.log.as_text(
        &|ms| format!("t{ms}"),
        &|text| text.replace("unit 1", "unit 1, A"),
        ',',
    );
    assert_eq!(csv, "time,found\nt5,\"unit 1, A: no answer on port 1\"\n");
}

/// The same on another unit every 50 seconds: each minute has a row of its own.
#[test]
fn rows_last_a_minute() {
    let mut net = network(4, DdcShape::Loop, 2);
    for (unit, seconds) in [(1, 0), (2, 50), (3, 100), (4, 150)] {
        net.log.now_ms = seconds * 1000;
        poll(&mut net, unit, [Some(true), Some(false)], &WELL);
    }
    let rows: Vec<(u64, String)> = net
        .log
        .events
        .iter()
        .map(|e| (e.at_ms / 1000, e.text()))
        .collect();
    let row = |at: u64, text: &str| (at, text.to_owned());
    assert_eq!(
        rows,
        [
            row(100, "units 3 and 4: no answer on port 1"),
            row(0, "units 1 and 2: no answer on port 1"),
        ]
    );
}
