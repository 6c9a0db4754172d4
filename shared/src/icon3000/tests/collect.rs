//! Devices that refuse, are busy or lack registers: what the collector asks then, and what it says.

use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::icon3000::collect::{Answer, BUSY_TRIES, BUSY_WAIT_MS, Collector};
use crate::icon3000::identity::{PROBES, Report, detect};
use crate::icon3000::records::Records;
use crate::icon3000::snapshot::{Part, Snapshot};
use crate::image::Image;
use crate::map::row::Model;
use crate::sim::{Icon3000, Programme};

const ALL: [Model; 3] = [Model::Icon2000v4, Model::Icon3000, Model::Icon3000v2];

fn device(model: Model) -> Icon3000 {
    let mut sim = Icon3000::new(model, "XV-101", Programme::Idle);
    sim.advance(Micros::new(0), 1_795_651_200);
    sim
}

/// Reads a simulated device; `filter` may answer in its place. Gives the snapshot and the requests
/// with the wait before each.
fn read(
    sim: &mut Icon3000,
    model: Model,
    mut filter: impl FnMut(&[u8]) -> Option<Vec<u8>>,
) -> (Snapshot, Vec<(Vec<u8>, u32)>) {
    let mut collector = Collector::new(Snapshot::new(model, 1, "XV-101"));
    let mut asked = Vec::new();
    while let Some(step) = collector.step().cloned() {
        asked.push((step.pdu.clone(), step.wait_ms));
        let response = filter(&step.pdu).unwrap_or_else(|| sim.answer(&step.pdu).unwrap());
        collector.answer(Answer::Response(&response));
    }
    (collector.finish(), asked)
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from(u16::from_be_bytes([bytes[at], bytes[at + 1]]))
}

/// Whether a read of holding registers touches one of these.
fn touches(pdu: &[u8], first: u32, last: u32) -> bool {
    pdu[0] == 3 && word(pdu, 1) <= last && word(pdu, 1) + word(pdu, 3) > first
}

/// Each kind of device from the answers to three requests: one register beyond 3473, one beyond 21,
/// and function 17, which each of them knows (table 6).
#[test]
fn each_model_is_told_by_single_probes() {
    for model in ALL {
        let mut sim = device(model);
        let [beyond_3473, beyond_21] = PROBES.map(|at| {
            let [high, low] = at.to_be_bytes();
            let response = sim.answer(&[3, high, low, 0, 1]).unwrap();
            Some(response == [0x83, 2])
        });
        let report = Report::of_pdu(&sim.answer(&[17]).unwrap()).unwrap();
        let none = Image::new();
        let guess = detect(&none, Some(&report), beyond_3473, beyond_21);
        assert_eq!(guess.model, Some(model), "{}", guess.why);
        // Without function 17 the registers tell it too.
        let guess = detect(&none, None, beyond_3473, beyond_21);
        assert_eq!(guess.model, Some(model), "{}", guess.why);
        // What its whole map gave does so too; without HR 22 only the newest is told from others.
        let (snapshot, _) = read(&mut sim, model, |_| None);
        let guess = detect(&snapshot.image, Some(&report), None, None);
        let told = (model != Model::Icon2000v4).then_some(model);
        assert_eq!(guess.model, told, "{}", guess.why);
        // Function 17 alone: 2.03 is no ICON3000v2, and no more than that.
        let guess = detect(&none, Some(&report), None, None);
        assert_eq!(guess.model, told.filter(|m| *m == Model::Icon3000v2));
        if model != Model::Icon3000v2 {
            assert!(guess.why.contains("2.03") && guess.why.contains("HR 22"));
        }
    }
    // Software of an ICON3000v2 and no register of it: nobody knows.
    let sim = &mut device(Model::Icon3000v2);
    let report = Report::of_pdu(&sim.answer(&[17]).unwrap()).unwrap();
    let guess = detect(&Image::new(), Some(&report), Some(true), Some(false));
    assert_eq!(guess.model, None, "{}", guess.why);
}

/// Every model is read without a failure, and file 5 with its 64 records too.
#[test]
fn a_whole_device_of_every_model() {
    for model in ALL {
        let (snapshot, _) = read(&mut device(model), model, |_| None);
        assert_eq!(snapshot.failures, [], "{model:?}");
        assert!(snapshot.identity.is_some() && snapshot.counters.len() == 6);
        let limits = snapshot.files.get(5).map(Records::len);
        assert_eq!(limits, (model == Model::Icon3000v2).then_some(64));
        // 32 discrete inputs without the two that are reserved, 369 input registers.
        let cells = |of: Table| snapshot.image.iter().filter(|(t, ..)| *t == of).count();
        assert_eq!((cells(Table::Discrete), cells(Table::Input)), (30, 369));
    }
}

/// Table 50: "the master should retransmit the request later".
#[test]
fn a_busy_device_is_asked_again() {
    let mut left = BUSY_TRIES;
    let (snapshot, asked) = read(&mut device(Model::Icon3000v2), Model::Icon3000v2, |pdu| {
        let busy = pdu == [17] && left > 0;
        left -= u8::from(busy);
        busy.then(|| vec![0x91, 6])
    });
    assert_eq!(snapshot.failures, []);
    assert!(snapshot.identity.is_some());
    let waits: Vec<_> = asked.iter().filter(|a| a.0 == [17]).map(|a| a.1).collect();
    assert_eq!(waits, [0, 200, 200, 200]);
    assert_eq!((BUSY_TRIES, BUSY_WAIT_MS), (3, 200));
    // Busy for longer: that is said, and a request for several files is not taken apart for it.
    let (snapshot, asked) = read(&mut device(Model::Icon3000v2), Model::Icon3000v2, |pdu| {
        (pdu[0] == 20 && word(pdu, 3) == 2).then(|| vec![0x94, 6])
    });
    let of_file_2 = asked.iter().filter(|a| a.0[0] == 20 && word(&a.0, 3) == 2);
    assert_eq!(of_file_2.count(), 4);
    assert!(snapshot.files.get(2).is_none());
    assert!(
        snapshot
            .failures
            .iter()
            .all(|f| f.why.contains("exception 06")),
        "{:?}",
        snapshot.failures
    );
    assert!(!snapshot.failures.is_empty());
}

/// Reading E84: HR 3460 to 3473 came with firmware 2.03. Without them the rest of their block is
/// read all the same.
#[test]
fn one_register_that_is_missing_costs_no_block() {
    for model in [Model::Icon3000, Model::Icon3000v2] {
        let (snapshot, asked) = read(&mut device(model), model, |pdu| {
            touches(pdu, 3460, 3473).then(|| vec![0x83, 2])
        });
        let lost: Vec<_> = snapshot
            .failures
            .iter()
            .map(|f| (f.part, f.why.as_str()))
            .collect();
        let part = Part::Block(Table::Holding, Address::new(3460), 14);
        assert_eq!(lost, [(part, "exception 02: illegal data address")]);
        for hole in snapshot.holes() {
            let known = hole.start.get() == 3460 && hole.count == 14 || hole.why == "reserved";
            assert!(known, "{hole:?}");
        }
        // A block of 125 rows at most is halved seven times: two requests each.
        let blocks = asked.iter().filter(|a| a.0[0] == 3).count();
        assert!(blocks <= 9 + 14, "{blocks}");
    }
    // Of a block that the device has nothing of, that is said once, after few requests.
    let (snapshot, asked) = read(&mut device(Model::Icon3000), Model::Icon3000v2, |_| None);
    let blocks = |f: &&crate::icon3000::snapshot::Failure| matches!(f.part, Part::Block(Table::Holding, start, _) if start.get() >= 3474);
    assert!(
        snapshot.failures.iter().filter(blocks).count() <= 6,
        "{:?}",
        snapshot.failures
    );
    let asked = asked.iter().filter(|a| a.0[0] == 3).count();
    assert!(asked <= 9 + 6 * 10, "{asked}");
    for address in [3000, 3473] {
        let cell = snapshot.image.cell(Table::Holding, Address::new(address));
        assert!(cell.is_some(), "{address}");
    }
}

/// HR 3511 to 3514 count the curves. Unread, they are no zeros: the latest curves are tried, and the
/// snapshot says that there may be more.
#[test]
fn an_unknown_number_of_curves_is_said() {
    let (snapshot, _) = read(&mut device(Model::Icon3000v2), Model::Icon3000v2, |pdu| {
        let lost = touches(pdu, 3511, 3514) || touches(pdu, 3981, 3984);
        lost.then(|| vec![0x83, 4])
    });
    for first in [1000, 2000, 3000, 3500] {
        assert!(snapshot.files.get(first).is_some(), "reference {first}");
        assert!(snapshot.files.get(first + 1).is_some(), "latest of {first}");
        assert!(snapshot.files.get(first + 2).is_none());
    }
    for (register, files) in [
        (3511, "1001 to 1100"),
        (3512, "2001 to 2100"),
        (3513, "3001 to 3016"),
        (3514, "3501 to 3516"),
    ] {
        let part = Part::Block(Table::Holding, Address::new(register), 1);
        let said = snapshot.failures.iter().find(|f| f.part == part).unwrap();
        assert!(said.why.contains(files), "{}", said.why);
    }
}

/// File 5 of some other length, or none at all (readings E66, E69).
#[test]
fn file_5_is_read_to_its_end_or_said_to_be_missing() {
    let short = |records: u32| {
        move |pdu: &[u8]| {
            let of_it = pdu[0] == 20 && word(pdu, 3) == 5;
            (of_it && word(pdu, 5) + word(pdu, 7) > records).then(|| vec![0x94, 2])
        }
    };
    let (snapshot, asked) = read(&mut device(Model::Icon3000v2), Model::Icon3000v2, short(37));
    assert_eq!(snapshot.files.get(5).map(Records::len), Some(37));
    assert_eq!(snapshot.failures, []);
    let of_it = |a: &&(Vec<u8>, u32)| a.0[0] == 20 && word(&a.0, 3) == 5;
    let spans: Vec<_> = asked
        .iter()
        .filter(of_it)
        .map(|a| (word(&a.0, 5), word(&a.0, 7)))
        .collect();
    assert_eq!(spans[..4], [(0, 121), (0, 60), (0, 30), (30, 30)]);
    let (snapshot, _) = read(&mut device(Model::Icon3000v2), Model::Icon3000v2, short(0));
    assert!(snapshot.files.get(5).is_none());
    assert_eq!(snapshot.failures.len(), 1);
    assert_eq!(
        snapshot.failures[0].part.to_string(),
        "file 5, records 0 to 0"
    );
    assert_eq!(
        snapshot.failures[0].why,
        "exception 02: illegal data address"
    );
}
