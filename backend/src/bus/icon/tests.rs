use super::*;
use axum::extract::ws::Utf8Bytes;
use shared::device::Device;
use shared::proto::{Block, IconStep, TableName};
use tokio::sync::mpsc;

const CLIENT: ClientId = ClientId(1);

fn unit() -> IconUnit {
    IconUnit::of(&DeviceConfig::simple("XV-1", Device::Icon3000v2, 1)).unwrap()
}

fn outlet() -> (Outlet, mpsc::Receiver<Utf8Bytes>) {
    let (sender, receiver) = mpsc::channel(Outlet::SIZE);
    (Outlet::new(sender), receiver)
}

fn news(from: &mut mpsc::Receiver<Utf8Bytes>) -> Vec<IconNews> {
    std::iter::from_fn(|| from.try_recv().ok())
        .map(|text| IconNews::from_text(&text).unwrap())
        .filter(|n| !matches!(n, IconNews::Progress { .. }))
        .collect()
}

fn read(steps: Vec<IconStep>) -> IconAsk {
    IconAsk::Read {
        id: 7,
        device: "XV-1".into(),
        steps,
    }
}

const fn file(file: u16, start: u16, count: u16) -> IconStep {
    IconStep::File { file, start, count }
}

fn report(outcome: Outcome, pdu: Option<&[u8]>, code: Option<u8>) -> Report {
    Report {
        outcome,
        text: String::new(),
        pdu: pdu.map(<[u8]>::to_vec),
        code,
    }
}

fn good(pdu: &[u8]) -> Report {
    report(Outcome::Ok, Some(pdu), None)
}

/// The next request, which is answered with this.
fn step(unit: &mut IconUnit, report: &Report) -> Vec<u8> {
    let query = unit.take().unwrap();
    unit.reply(&query, report, Micros::new(5));
    query.pdu()
}

#[test]
fn steps_become_requests_in_order() {
    let (out, mut from) = outlet();
    let mut unit = unit();
    let block = Block {
        table: TableName::Holding,
        start: 3000,
        count: 2,
    };
    let steps = vec![
        IconStep::Block(block),
        file(5300, 0, 16),
        file(5301, 0, 16),
        IconStep::Identity,
        IconStep::Diagnostic { sub_function: 12 },
    ];
    unit.ask(CLIENT, read(steps), out);
    assert_eq!(step(&mut unit, &good(&[3])), [3, 0x0B, 0xB8, 0, 2]);
    let both = [
        20, 14, 6, 0x14, 0xB4, 0, 0, 0, 16, 6, 0x14, 0xB5, 0, 0, 0, 16,
    ];
    assert_eq!(
        step(&mut unit, &good(&[20])),
        both,
        "two files in one request"
    );
    assert_eq!(step(&mut unit, &good(&[17])), [17]);
    assert_eq!(step(&mut unit, &good(&[8])), [8, 0, 12, 0, 0]);
    assert!(unit.take().is_none() && unit.due(Instant::now()).is_none());
    let news = news(&mut from);
    let steps: Vec<u32> = news
        .iter()
        .filter_map(|n| match n {
            IconNews::Exchange { step, .. } => Some(*step),
            _ => None,
        })
        .collect();
    assert_eq!(steps, [0, 1, 3, 4]);
    let end = IconNews::Done {
        id: 7,
        device: "XV-1".into(),
        ok: 4,
        failed: 0,
    };
    assert_eq!(news.last(), Some(&end));
}

/// A device that refuses several groups at once is asked for each.
#[test]
fn a_refused_request_is_asked_for_in_parts() {
    let (out, mut from) = outlet();
    let mut unit = unit();
    unit.ask(
        CLIENT,
        read(vec![file(5300, 0, 16), file(5301, 0, 16)]),
        out,
    );
    let refused = report(Outcome::Exception, None, Some(2));
    assert_eq!(step(&mut unit, &refused).len(), 16);
    assert_eq!(step(&mut unit, &good(&[20])).len(), 9);
    assert_eq!(step(&mut unit, &refused).len(), 9);
    let news = news(&mut from);
    let [
        IconNews::Exchange { outcome: a, .. },
        IconNews::Exchange {
            outcome: b,
            response,
            ..
        },
        IconNews::Done {
            ok: 1, failed: 1, ..
        },
    ] = &news[..]
    else {
        panic!("{news:?}");
    };
    assert_eq!((*a, *b), (Outcome::Ok, Outcome::Exception));
    assert_eq!(response, "9402");
}

/// What was told of requests: request, and the code of a refusal.
fn told(from: &mut mpsc::Receiver<Utf8Bytes>) -> Vec<(String, String)> {
    let exchange = |news| match news {
        IconNews::Exchange {
            request, response, ..
        } => Some((request, response)),
        _ => None,
    };
    news(from).into_iter().filter_map(exchange).collect()
}

/// A device that has everything but what lies within these holding registers; asked for this block.
fn ask_without(
    gone: core::ops::Range<u16>,
    start: u16,
    count: u16,
) -> (usize, Vec<(String, String)>) {
    let (out, mut from) = outlet();
    let mut unit = unit();
    let block = Block {
        table: TableName::Holding,
        start,
        count,
    };
    unit.ask(CLIENT, read(vec![IconStep::Block(block)]), out);
    let mut requests = 0;
    while let Some(query) = unit.take() {
        requests += 1;
        let Query::Read(read) = &query else {
            panic!("{query:?}");
        };
        let first = read.start.get();
        let report = if first < gone.end && gone.start < first + read.count() {
            report(Outcome::Exception, None, Some(2))
        } else {
            good(&[3])
        };
        unit.reply(&query, &report, Micros::new(5));
    }
    (requests, told(&mut from))
}

/// Reading E84: firmware before 2.03 has no HR 3460 to 3473, and refuses what holds them. Around them
/// are a curve of 64 registers from 3392, four reserved ones and the level logged in, HR 3480.
#[test]
fn a_refused_block_is_asked_for_in_pieces() {
    let (requests, told) = ask_without(3460..3474, 3392, 89);
    let told: Vec<_> = told.iter().map(|(q, a)| (q.as_str(), a.as_str())).collect();
    assert_eq!(
        told,
        [
            ("030D400040", "03"),
            ("030D980001", "03"),
            ("030D84000E", "8302"),
        ],
        "the failure comes last"
    );
    // The whole; 3392 to 3455; 3460 to 3480, and its two parts.
    assert_eq!(requests, 5);
}

/// Of a block of which the device has nothing, eight pieces are tried, and one failure tells of all.
#[test]
fn a_block_that_is_not_there_costs_few_requests() {
    let (requests, told) = ask_without(0..4000, 3615, 60);
    assert_eq!(requests, 9);
    assert_eq!(told, [("030E1F003C".to_owned(), "8302".to_owned())]);
    // One row alone, as those that tell the model, is one request.
    assert_eq!(ask_without(0..4000, 3480, 1).0, 1);
}

/// Cancelled while pieces are left, they are neither asked for nor said to be refused.
#[test]
fn cancelling_ends_between_pieces() {
    let (out, mut from) = outlet();
    let mut unit = unit();
    let block = Block {
        table: TableName::Holding,
        start: 3392,
        count: 89,
    };
    unit.ask(CLIENT, read(vec![IconStep::Block(block)]), out.clone());
    let refused = report(Outcome::Exception, None, Some(2));
    step(&mut unit, &refused);
    let query = unit.take().unwrap();
    unit.ask(CLIENT, IconAsk::Cancel { id: 7 }, out);
    unit.reply(&query, &good(&[3]), Micros::new(1));
    assert!(unit.take().is_none() && unit.due(Instant::now()).is_none());
    assert!(matches!(
        news(&mut from)[..],
        [
            IconNews::Exchange { .. },
            IconNews::Done {
                ok: 1,
                failed: 0,
                ..
            }
        ]
    ));
}

/// Table 50: a busy device is asked again later, three times; a request for several files is not
/// taken apart for it.
#[tokio::test(start_paused = true)]
async fn a_busy_device_is_asked_again() {
    let (out, mut from) = outlet();
    let mut unit = unit();
    let steps = vec![file(5300, 0, 16), file(5301, 0, 16)];
    unit.ask(CLIENT, read(steps.clone()), out.clone());
    let busy = report(Outcome::Exception, None, Some(6));
    for _ in 0..3 {
        assert_eq!(step(&mut unit, &busy).len(), 16);
        assert!(unit.take().is_none(), "not at once");
        let wait = unit.due(Instant::now()).unwrap() - Instant::now();
        assert_eq!(wait, Duration::from_millis(200));
        tokio::time::advance(wait).await;
    }
    assert!(news(&mut from).is_empty());
    assert_eq!(step(&mut unit, &busy).len(), 16);
    let [
        IconNews::Exchange { response, .. },
        IconNews::Done {
            ok: 0, failed: 1, ..
        },
    ] = &news(&mut from)[..]
    else {
        panic!("one failure");
    };
    assert_eq!(response, "9406");
    // Who cancels is not kept waiting.
    unit.ask(CLIENT, read(steps), out);
    let query = unit.take().unwrap();
    unit.ask(CLIENT, IconAsk::Cancel { id: 7 }, outlet().0);
    unit.reply(&query, &busy, Micros::new(1));
    assert!(unit.take().is_none() && unit.due(Instant::now()).is_none());
}

#[test]
fn a_silent_device_is_given_up() {
    let (out, mut from) = outlet();
    let mut unit = unit();
    unit.ask(CLIENT, read(vec![IconStep::Identity; 5]), out);
    let silence = report(Outcome::Silence, None, None);
    step(&mut unit, &silence);
    step(&mut unit, &silence);
    assert!(unit.take().is_none());
    let news = news(&mut from);
    assert!(matches!(
        news.last(),
        Some(IconNews::Done {
            ok: 0,
            failed: 5,
            ..
        })
    ));
}

#[test]
fn cancelling_ends_after_what_is_under_way() {
    let (out, mut from) = outlet();
    let mut unit = unit();
    unit.ask(CLIENT, read(vec![IconStep::Identity; 5]), out.clone());
    let query = unit.take().unwrap();
    unit.ask(CLIENT, IconAsk::Cancel { id: 8 }, out.clone());
    unit.ask(CLIENT, IconAsk::Cancel { id: 7 }, out.clone());
    assert!(news(&mut from).is_empty(), "it is not over yet");
    unit.reply(&query, &good(&[17]), Micros::new(1));
    assert!(matches!(
        news(&mut from)[..],
        [
            IconNews::Exchange { .. },
            IconNews::Done {
                ok: 1,
                failed: 0,
                ..
            }
        ]
    ));
    unit.ask(CLIENT, read(vec![IconStep::Identity; 5]), out);
    unit.leave(CLIENT);
    assert!(unit.take().is_none());
}

#[test]
fn what_does_not_read_is_refused() {
    for bad in [
        IconStep::Diagnostic { sub_function: 0 },
        IconStep::Diagnostic { sub_function: 1 },
        IconStep::Diagnostic { sub_function: 4 },
        IconStep::Diagnostic { sub_function: 10 },
        file(2, 0, 0),
        file(2, 9999, 2),
        IconStep::Block(Block {
            table: TableName::Holding,
            start: 0,
            count: 126,
        }),
    ] {
        let (out, mut from) = outlet();
        let mut unit = unit();
        unit.ask(CLIENT, read(vec![IconStep::Identity, bad]), out);
        assert!(unit.take().is_none(), "{bad:?}");
        let news = news(&mut from);
        let [
            IconNews::Exchange {
                step: 1, outcome, ..
            },
            IconNews::Done {
                ok: 0, failed: 1, ..
            },
        ] = &news[..]
        else {
            panic!("{bad:?}: {news:?}");
        };
        assert_eq!(*outcome, Outcome::Refused);
    }
}

#[test]
fn a_line_that_is_down_ends_all() {
    let (out, mut from) = outlet();
    let mut unit = unit();
    unit.ask(CLIENT, read(vec![IconStep::Identity; 3]), out);
    unit.down("the port is gone", Micros::new(1));
    let news = news(&mut from);
    assert!(matches!(
        &news[..],
        [
            IconNews::Exchange {
                outcome: Outcome::Down,
                ..
            },
            IconNews::Done { failed: 3, .. }
        ]
    ));
}
