//! A whole simulated device through the collector. The simulator has layouts of its own, so that
//! what both say is more than an echo; the golden files of the manual's tables are the oracle.

use crate::capture::Micros;
use crate::icon3000::collect::{Answer, Collector, Wire};
use crate::icon3000::read::Log;
use crate::icon3000::snapshot::{Snapshot, Sort, diff, parse};
use crate::map::row::Model;
use crate::sim::{Fault, Icon3000, Programme};

/// 2026-11-26 00:00:00 UTC.
const WALL: u64 = 1_795_651_200;

fn device(model: Model) -> Icon3000 {
    let mut sim = Icon3000::new(model, "XV-101", Programme::Idle);
    sim.advance(Micros::new(0), WALL);
    sim
}

/// Reads everything; the snapshot and what the wire carried.
fn read(sim: &mut Icon3000, model: Model) -> (Snapshot, Wire) {
    let mut collector = Collector::new(Snapshot::new(model, 1, "XV-101"));
    while let Some(step) = collector.step().cloned() {
        assert!(step.pdu.len() <= 253 && step.response_len <= 253);
        let response = sim.answer(&step.pdu).unwrap();
        if response[0] < 0x80 {
            assert_eq!(response.len(), step.response_len, "{}", step.text());
        }
        collector.answer(Answer::Response(&response));
        let (done, total) = collector.progress();
        assert!(done <= total);
    }
    let wire = collector.wire();
    (collector.finish(), wire)
}

#[test]
fn a_whole_device_is_read_and_kept() {
    let mut sim = device(Model::Icon3000v2);
    let (snapshot, wire) = read(&mut sim, Model::Icon3000v2);
    assert_eq!(snapshot.failures, []);
    // Only reserved stretches are missing.
    for hole in snapshot.holes() {
        assert_eq!(hole.why, "reserved", "{hole:?}");
    }
    // 4 alarms and warnings in all, 6 connections; curves and cards with their reference.
    let stored = |number: u16| {
        let log = Log::read(number, snapshot.files.get(number).unwrap()).unwrap();
        assert!(log.complete, "{number}");
        assert_eq!(log.problems, [], "{number}");
        log.stored
    };
    assert_eq!(stored(2), Some(2));
    assert_eq!(stored(3), Some(2));
    assert_eq!(stored(4), Some(6));
    for number in [5000, 5100, 5200] {
        assert!(stored(number).unwrap() >= 40, "{number}");
    }
    for (first, count) in [(1000, 13), (2000, 13), (3000, 5), (3500, 3), (5300, 5)] {
        for number in first..first + count {
            assert_eq!(stored(number), None);
        }
        assert!(snapshot.files.get(first + count).is_none());
    }
    // Nothing is asked twice: every request byte is accounted for below.
    let text = snapshot.to_text();
    let (back, problems) = parse(text.as_bytes());
    assert_eq!(problems, []);
    assert_eq!(back.as_ref(), Some(&snapshot));
    // 9600 8E1 by hand: 11 bits a character, 3.5 characters of silence after each frame.
    let characters = u64::from(wire.request_bytes + wire.response_bytes);
    let by_hand = (characters * 11 * 1_000_000) / 9600
        + (u64::from(wire.exchanges) * 2 * 7 * 11 * 1_000_000 / 2) / 9600;
    assert!(wire.micros(9600, 11).abs_diff(by_hand) <= 2);
    assert!(wire.exchanges < 90, "{wire:?}");
}

#[test]
fn an_icon3000_has_no_files() {
    let mut sim = device(Model::Icon3000);
    let (snapshot, _) = read(&mut sim, Model::Icon3000);
    assert!(snapshot.files.is_empty());
    assert_eq!(snapshot.failures, []);
    // Read as the newer model, it refuses: that is said, and the rest is there.
    let (snapshot, _) = read(&mut sim, Model::Icon3000v2);
    assert!(!snapshot.failures.is_empty());
    assert!(
        snapshot
            .failures
            .iter()
            .any(|f| f.why.contains("exception 01"))
    );
    assert!(
        snapshot
            .failures
            .iter()
            .any(|f| f.why.contains("exception 02"))
    );
    assert!(snapshot.identity.is_some());
}

/// n known changes are n changes: dead band and fail-safe delay (each with its legacy copy and
/// other mirrors), one alarm, and the counters of the reads themselves.
#[test]
fn known_changes_are_found_and_no_others() {
    let mut sim = device(Model::Icon3000v2);
    let (first, _) = read(&mut sim, Model::Icon3000v2);
    assert!(diff(&first, &first).is_empty());
    // User level may set both.
    sim.answer(&[6, 0x0B, 0xC9, 0, 15]).unwrap();
    sim.answer(&[6, 0x0B, 0xCC, 0, 40]).unwrap();
    let (second, _) = read(&mut sim, Model::Icon3000v2);
    let found = diff(&first, &second);
    let lasting: Vec<_> = found
        .lasting()
        .map(|c| format!("{}: {} → {}", c.path, c.was, c.now))
        .collect();
    assert_eq!(
        lasting,
        ["holding.3017: 1.0 % → 1.5 %", "holding.3020: 0 s → 40 s",]
    );
    let passing = |c: &&crate::icon3000::snapshot::Change| c.sort.is_passing();
    for change in found.changes.iter().filter(passing) {
        assert_eq!(change.sort, Sort::Counter, "{change:?}");
    }
    // An alarm: its bits are state, its entry is one change of the log.
    sim.set_fault(Fault::LowBattery, true);
    let (third, _) = read(&mut sim, Model::Icon3000v2);
    let found = diff(&second, &third);
    let logs: Vec<_> = found
        .changes
        .iter()
        .filter(|c| c.sort == Sort::Log)
        .collect();
    assert_eq!(logs.len(), 1, "{logs:?}");
    assert_eq!(logs[0].now, "2026-11-26 00:00:00, Low Battery (4)");
    assert_eq!(found.lasting().count(), 1);
}

/// A log that grows while it is read is told.
#[test]
fn a_log_that_changes_is_noticed() {
    let mut sim = device(Model::Icon3000v2);
    let mut collector = Collector::new(Snapshot::new(Model::Icon3000v2, 1, ""));
    let mut files = 0;
    while let Some(step) = collector.step().cloned() {
        if step.pdu[0] == 20 {
            files += 1;
        }
        if files == 10 {
            sim.set_fault(Fault::LowBattery, true);
        }
        let response = sim.answer(&step.pdu).unwrap();
        collector.answer(Answer::Response(&response));
    }
    let why: Vec<_> = collector
        .snapshot()
        .failures
        .iter()
        .map(|f| f.why.as_str())
        .collect();
    assert_eq!(why, ["the log changed while it was read; read it again"]);
}

/// A stroke test of the simulated device: 15 % of travel, with its times.
#[test]
fn a_stroke_test_leaves_its_curve() {
    let mut sim = device(Model::Icon3000v2);
    sim.answer(&[6, 0x0B, 0xC0, 0, 2]).unwrap();
    sim.advance(Micros::new(60_000_000), WALL + 60);
    assert_eq!(sim.position(), 1000);
    sim.answer(&[6, 0x0B, 0xC0, 0, 5]).unwrap();
    sim.advance(Micros::new(120_000_000), WALL + 120);
    let (snapshot, _) = read(&mut sim, Model::Icon3000v2);
    let log = Log::read(3001, snapshot.files.get(3001).unwrap()).unwrap();
    assert_eq!(log.get("result").unwrap().text(), "Passed (1)");
    assert_eq!(log.get("travel_limit").unwrap().text_with_unit(), "15 %");
    // 26 s for 100 %: 15 % take 3.9 s.
    let t = log.get("t_pst").unwrap().number().unwrap();
    assert!((38..=42).contains(&t), "{t}");
    let times: Vec<_> = log
        .run("t_pst_at")
        .into_iter()
        .map(|i| i.unwrap().number().unwrap())
        .collect();
    assert!(times[1..=15].is_sorted() && times[1] > 0);
    assert_eq!(times[16], 0);
    let back: Vec<_> = log
        .run("t_ret_at")
        .into_iter()
        .map(|i| i.unwrap().number().unwrap())
        .collect();
    assert!(back[..15].is_sorted_by(|a, b| a >= b), "{back:?}");
}
