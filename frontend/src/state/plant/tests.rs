//! The plant of a page that hears made-up messages.

use super::*;
use shared::address::{Address, Table};
use shared::encode::frame;
use shared::frame::Framing;
use shared::proto::TableName;
use shared::render::hex;

fn hello(run: u64) -> ToPage {
    ToPage::Hello {
        version: VERSION,
        app: "test".into(),
        run,
        now_us: 5_000_000,
        wall_ms: 1_000_000,
        read_only: true,
        buses: vec![Bus {
            name: "a".into(),
            line: "simulated".into(),
            framing: "modbus-rtu".into(),
            simulated: true,
        }],
        devices: vec![DeviceInfo {
            tag: "XV-1".into(),
            kind: "icon3000v2".into(),
            bus: "a".into(),
            unit: 9,
            description: String::new(),
        }],
    }
}

fn capture(seq: u64, way: Way, pdu: &[u8]) -> ToPage {
    ToPage::Capture {
        bus: "a".into(),
        seq,
        at_us: seq * 1000,
        way,
        ends: true,
        hex: hex(&frame(Framing::Rtu, 0, 9, pdu)),
    }
}

fn plant() -> Plant {
    let mut plant = Plant::default();
    let sent = plant.take(hello(1), 0.0);
    assert_eq!(
        sent,
        [ToBackend::Subscribe {
            bus: "a".into(),
            after: None
        }]
    );
    plant
}

fn position(plant: &Plant) -> Option<u16> {
    let image = &plant.device("XV-1").unwrap().image;
    image
        .cell(Table::Holding, Address::new(3004))
        .map(|c| c.word)
}

#[test]
fn values_come_from_captures() {
    let mut plant = plant();
    plant.take(capture(1, Way::Tx, &[3, 0x0B, 0xBC, 0, 1]), 0.0);
    assert_eq!(position(&plant), None);
    plant.take(capture(2, Way::Rx, &[3, 2, 1, 0xC4]), 0.0);
    assert_eq!(position(&plant), Some(452));
    assert_eq!(plant.buses[0].session.len(), 2);
}

#[test]
fn a_reconnection_goes_on_and_a_restart_begins_anew() {
    let mut plant = plant();
    plant.take(capture(1, Way::Tx, &[3, 0x0B, 0xBC, 0, 1]), 0.0);
    plant.take(capture(2, Way::Rx, &[3, 2, 1, 0xC4]), 0.0);
    plant.lost();
    let again = plant.take(hello(1), 0.0);
    assert_eq!(
        again,
        [ToBackend::Subscribe {
            bus: "a".into(),
            after: Some(2)
        }]
    );
    assert_eq!(position(&plant), Some(452));
    let anew = plant.take(hello(2), 0.0);
    assert_eq!(
        anew,
        [ToBackend::Subscribe {
            bus: "a".into(),
            after: None
        }]
    );
    assert_eq!(position(&plant), None);
}

#[test]
fn holes_are_counted_and_repeats_ignored() {
    let mut plant = plant();
    plant.take(capture(1, Way::Tx, &[17]), 0.0);
    plant.take(capture(1, Way::Tx, &[17]), 0.0);
    assert_eq!(plant.buses[0].session.len(), 1);
    plant.take(capture(5, Way::Tx, &[17]), 0.0);
    assert_eq!(plant.buses[0].missed, 3);
    plant.take(
        ToPage::Lagged {
            bus: "a".into(),
            missed: 10,
        },
        0.0,
    );
    plant.take(capture(16, Way::Tx, &[17]), 0.0);
    assert_eq!(plant.buses[0].missed, 13);
}

#[test]
fn frames_are_bounded() {
    let mut plant = plant();
    for seq in 1..=u64::from(KEPT) + 5000 {
        plant.take(capture(seq, Way::Tx, &[17]), 0.0);
    }
    let session = &plant.buses[0].session;
    let kept = session.len() - session.first();
    assert!((KEPT..=KEPT + BATCH).contains(&kept), "{kept}");
}

#[test]
fn watches_are_sent_when_they_change() {
    let mut plant = plant();
    let block = Block {
        table: TableName::Holding,
        start: 3000,
        count: 31,
    };
    let wanted = || vec![("XV-1".to_owned(), vec![block], 1000)];
    assert_eq!(plant.watch(wanted()).len(), 1);
    assert_eq!(plant.watch(wanted()).len(), 0);
    let end = plant.watch(Vec::new());
    assert!(matches!(&end[..], [ToBackend::Watch { blocks, .. }] if blocks.is_empty()));
}

#[test]
fn a_job_asks_on_until_it_is_done() {
    let mut plant = plant();
    let block = Block {
        table: TableName::Coil,
        start: 0,
        count: 11,
    };
    let sent = plant.read("XV-1", vec![block; 3]);
    assert_eq!(sent.len(), 2);
    let ToBackend::Read { id, .. } = sent[0] else {
        panic!("{sent:?}");
    };
    let done = ToPage::Done {
        id,
        outcome: Outcome::Ok,
        text: String::new(),
    };
    assert_eq!(plant.take(done, 0.0).len(), 1);
    assert_eq!(plant.device("XV-1").unwrap().job.as_ref().unwrap().done, 1);
}

#[test]
fn another_version_is_said() {
    let mut plant = Plant::default();
    let ToPage::Hello {
        app,
        run,
        now_us,
        wall_ms,
        read_only,
        buses,
        devices,
        ..
    } = hello(1)
    else {
        panic!("hello");
    };
    let other = ToPage::Hello {
        version: VERSION + 1,
        app,
        run,
        now_us,
        wall_ms,
        read_only,
        buses,
        devices,
    };
    assert!(plant.take(other, 0.0).is_empty());
    assert!(plant.mismatch.is_some());
}

#[test]
fn the_clock_goes_on_between_ticks() {
    let plant = plant();
    assert_eq!(plant.now(1500.0), 6_500_000);
    assert_eq!(plant.wall_ms(5_000_000), 1_000_000);
}

/// Polls of a HART device for the list: the worked answer R6, silence, then no value.
#[test]
fn the_position_of_a_hart_device_is_kept() {
    let mut plant = plant();
    let mut hear = |command: u16, response: &str| {
        let news = shared::proto::HartNews::Exchange {
            id: None,
            device: "XV-1".into(),
            command,
            request: "82AEDD012345030095".into(),
            response: response.into(),
            outcome: Outcome::Ok,
            text: String::new(),
            at_us: 9,
            took_us: 2,
            tries: 1,
        };
        let changed = plant.hart(&news.to_text());
        let position = plant.device("XV-1").unwrap().overview().position;
        (changed, position.map(|p| p.text))
    };
    let answer = "86AEDD012345031A000041400000394248000039424600003941480000397FA0000052";
    assert_eq!(hear(48, answer), (false, None));
    assert_eq!(hear(3, answer), (true, Some("49.5".into())));
    assert_eq!(hear(3, ""), (false, Some("49.5".into())));
    let none = answer.replace("3942460000", "397FA00000");
    assert_eq!(hear(3, &none), (true, None));
}
