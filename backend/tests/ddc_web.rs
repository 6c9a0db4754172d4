//! Pages that look at a DDC-100 network: what they are told, what they may ask, and that a slow one
//! holds up nobody.

mod common;
mod networks;

use backend::bus::query::Query;
use backend::config::Config;
use common::{Page, serve};
use networks::{Ends, Setting, units};
use shared::capture::{Capture, Direction, Micros};
use shared::device::Device;
use shared::frame::{Framing, Role};
use shared::image::Image;
use shared::proto::{
    Block, DdcAsk, DdcNews, DdcShape, LineState, Outcome, TableName, ToBackend, ToPage, Way,
};
use shared::session::Session;
use std::collections::BTreeMap;
use std::time::Duration;
use tokio::time::{Instant, sleep};

const LOOP: &str = "Simulated DDC-100 loop";

fn follow(bus: &str) -> ToBackend {
    ToBackend::Ddc(DdcAsk::Follow { bus: bus.into() })
}

fn holding(start: u16, count: u16) -> Block {
    Block {
        table: TableName::Holding,
        start,
        count,
    }
}

#[tokio::test]
async fn a_page_that_follows_a_network_is_told_all_of_it() {
    let address = serve(&Config::simulated()).await;
    let (mut page, hello) = Page::greet(address).await;
    let ToPage::Hello { buses, devices, .. } = hello else {
        panic!("{hello:?}");
    };
    let names: Vec<&str> = buses.iter().map(|b| b.name.as_str()).collect();
    let ports = [
        LOOP,
        "Simulated DDC-100 loop, port 1",
        "Simulated DDC-100 loop, port 2",
    ];
    assert!(names.windows(3).any(|three| three == ports), "{names:?}");
    let own: Vec<_> = devices.iter().filter(|d| d.bus == LOOP).collect();
    assert_eq!(own.len(), 12);
    page.say(&follow(LOOP)).await;
    // How it is made up comes first.
    let network = page.ddc(Some).await;
    let DdcNews::Network {
        shape,
        ports,
        start,
        count,
        units,
        turn_ms,
        timeout_ms,
        retries,
        baud,
        ..
    } = network
    else {
        panic!("{network:?}");
    };
    assert_eq!((shape, ports.len(), baud), (DdcShape::Loop, 2, 9600));
    assert!(start <= 8 && start + count >= 10, "registers 9 and 10");
    assert!((21..50).contains(&turn_ms) && timeout_ms > 200 && retries <= 3);
    assert_eq!(units.len(), 12);
    // Then whatever is known, and what changes.
    let mut seen = BTreeMap::new();
    let (mut polls, mut up) = (0, 0);
    page.ddc(|news| {
        match news {
            DdcNews::Unit {
                unit,
                outcome,
                request,
                response,
                fault_a,
                ..
            } => {
                assert_eq!((outcome, fault_a), (Outcome::Ok, Some(false)));
                let words = usize::from_str_radix(&request[6..10], 16).unwrap();
                assert_eq!(response.len(), 4 + 4 * words);
                seen.insert(unit, response);
            }
            DdcNews::Poll { .. } => polls += 1,
            DdcNews::Port { state, .. } => up += i32::from(state == LineState::Up),
            DdcNews::Pass {
                took_us,
                expected_us,
                ..
            } => {
                println!("a pass took {took_us} us, expected {expected_us} us");
                assert!(took_us >= expected_us);
                return Some(());
            }
            DdcNews::Network { .. } | DdcNews::Read { .. } => panic!("{news:?}"),
        }
        None
    })
    .await;
    assert_eq!(seen.len(), 12);
    assert!(polls > 0 && up >= 2, "{polls} {up}");
    // Nothing more after that.
    page.say(&ToBackend::Ddc(DdcAsk::Leave { bus: LOOP.into() }))
        .await;
    page.say(&follow("Simulated plant")).await;
    let text = page
        .until(|message| match message {
            ToPage::Refused { text } => Some(text),
            _ => None,
        })
        .await;
    assert!(text.contains("no DDC-100 network"), "{text}");
    page.say(&follow("nowhere")).await;
    let text = page
        .until(|message| match message {
            ToPage::Refused { text } => Some(text),
            _ => None,
        })
        .await;
    assert!(text.contains("nowhere"), "{text}");
}

#[tokio::test]
async fn a_unit_is_read_once_between_two_polls() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    let mut ask = async |id, bus: &str, unit, block| {
        let ask = DdcAsk::Read {
            id,
            bus: bus.into(),
            unit,
            block,
        };
        page.say(&ToBackend::Ddc(ask)).await;
        page.ddc(|news| match news {
            DdcNews::Read {
                id: of,
                outcome,
                text,
                request,
                response,
                ..
            } if of == id => Some((outcome, text, request, response)),
            _ => None,
        })
        .await
    };
    let (outcome, text, request, response) = ask(7, LOOP, 3, holding(0, 56)).await;
    assert_eq!((outcome, text.as_str()), (Outcome::Ok, ""));
    assert_eq!(
        (request.as_str(), response.len()),
        ("0300000038", 4 + 4 * 56)
    );
    let (outcome, text, _, response) = ask(8, LOOP, 3, holding(500, 1)).await;
    assert_eq!(outcome, Outcome::Exception, "{text}");
    assert_eq!(response, "8302");
    for (bus, unit, block) in [
        (LOOP, 200, holding(0, 1)),
        ("Simulated plant", 1, holding(0, 1)),
        ("nowhere", 1, holding(0, 1)),
        (LOOP, 3, holding(0, 126)),
    ] {
        let (outcome, text, _, response) = ask(9, bus, unit, block).await;
        assert_eq!(
            (outcome, response.as_str()),
            (Outcome::Refused, ""),
            "{text}"
        );
        assert!(!text.is_empty());
    }
}

/// Counters of function 08 (table 3.8): a request that the unit refuses raises that of exceptions by
/// one, every request that of messages; sub-functions that change something are not sent.
#[tokio::test]
async fn counters_are_read_between_two_polls() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    let mut ask = async |ask: DdcAsk| {
        page.say(&ToBackend::Ddc(ask)).await;
        page.ddc(|news| match news {
            DdcNews::Read {
                outcome,
                text,
                request,
                response,
                unit,
                ..
            } => Some((outcome, text, request, response, unit)),
            _ => None,
        })
        .await
    };
    let counter = |sub_function, bus: &str, unit| DdcAsk::Counter {
        id: 1,
        bus: bus.into(),
        unit,
        sub_function,
    };
    let mut value = async |sub: u16| {
        let (outcome, text, request, response, unit) = ask(counter(sub, LOOP, 3)).await;
        assert_eq!((outcome, text.as_str(), unit), (Outcome::Ok, "", 3));
        assert_eq!(request, format!("08{sub:04X}0000"));
        let value = response.strip_prefix(&request[..6]).expect("an echo");
        assert_eq!(value.len(), 4, "{response}");
        u16::from_str_radix(value, 16).unwrap()
    };
    let (messages, exceptions) = (value(11).await, value(13).await);
    assert!(messages > 0, "polls are messages");
    assert_eq!(value(13).await, exceptions, "nothing was refused");
    let refused = DdcAsk::Read {
        id: 2,
        bus: LOOP.into(),
        unit: 3,
        block: holding(500, 1),
    };
    assert_eq!(ask(refused).await.3, "8302");
    let mut value = async |sub: u16| {
        let response = ask(counter(sub, LOOP, 3)).await.3;
        u16::from_str_radix(&response[6..], 16).unwrap()
    };
    assert_eq!(value(13).await, exceptions + 1);
    // The one above, and at least the five of this test since.
    assert!(value(11).await >= messages + 5);
    for (sub, bus, unit) in [
        (0, LOOP, 3),
        (1, LOOP, 3),
        (4, LOOP, 3),
        (10, LOOP, 3),
        (11, LOOP, 200),
        (11, "Simulated plant", 1),
        (11, "nowhere", 1),
    ] {
        let (outcome, text, _, response, _) = ask(counter(sub, bus, unit)).await;
        assert_eq!(
            (outcome, response.as_str()),
            (Outcome::Refused, ""),
            "{sub}: {text}"
        );
        assert!(!text.is_empty());
    }
}

/// The ordinary tabs of a device: what is watched is in the captures of its bus, without damage, and
/// can be decoded, whichever port was used.
#[tokio::test]
async fn ordinary_pages_watch_a_field_unit() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    page.say(&ToBackend::Subscribe {
        bus: LOOP.into(),
        after: None,
    })
    .await;
    let coils = Block {
        table: TableName::Coil,
        start: 0,
        count: 9,
    };
    page.say(&ToBackend::Watch {
        device: "MOV-403".into(),
        blocks: vec![holding(0, 56), coils],
        period_ms: 500,
    })
    .await;
    let mut session = Session::new(Framing::Rtu);
    let mut image = Image::new();
    let mut decoded = 0;
    page.until(|message| {
        match message {
            ToPage::Capture {
                at_us,
                way,
                ends,
                hex,
                ..
            } => {
                let (bytes, _) = shared::text::read_hex(hex.as_bytes());
                session.push(&Capture {
                    bytes: &bytes,
                    at: Some(Micros::new(at_us)),
                    direction: match way {
                        Way::Tx => Direction::ToDevice,
                        Way::Rx => Direction::FromDevice,
                    },
                    ends,
                });
                while decoded < session.len() {
                    let frame = *session.frame(decoded).unwrap();
                    assert_ne!(frame.role, Role::Noise);
                    assert!(!frame.marks.is_damaged());
                    if let (3, Role::Response, Some(request)) =
                        (frame.unit, frame.role, frame.pair())
                    {
                        let pdu = |i| {
                            let frame = session.bytes(i).unwrap();
                            frame[1..frame.len() - 2].to_vec()
                        };
                        let at = Micros::new(at_us);
                        image.absorb(&pdu(request), &pdu(decoded), at).unwrap();
                    }
                    decoded += 1;
                }
            }
            ToPage::Device { tag, outcome, .. } if tag == "MOV-403" => {
                assert_eq!(outcome, Outcome::Ok);
            }
            _ => {}
        }
        (image.len() == 56 + 9).then_some(())
    })
    .await;
}

/// Whatever a page asks, only reads come out of the host ports.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn only_reads_come_out_of_the_ports() {
    let setting = Setting {
        baud: 19_200,
        ..Setting::default()
    };
    let kinds = [Device::Ddc100Mx, Device::Ddc100Uec, Device::Ddc100Io];
    let mut network = setting.start(&units(&kinds), Ends::Ptys).await;
    network.until_pass(2).await;
    for device in 0..3 {
        for block in [(0, 2), (8, 2), (0, 56), (111, 1)] {
            let _answered = network.read(device, block.0, block.1).await;
        }
        for sub in [2, 11, 14] {
            let report = network.handle().read(device, Query::Diagnostic(sub)).await;
            assert_eq!(report.outcome, Outcome::Ok, "{}", report.text);
        }
    }
    network.until_pass(6).await;
    let requests = network.requests();
    assert!(requests.len() > 25, "{}", requests.len());
    for request in requests {
        assert!(
            matches!(
                request.pdu.as_slice(),
                [1..=4, _, _, _, _] | [8, 0, 2 | 11..=14, 0, 0]
            ),
            "{request:?}"
        );
    }
}

/// A page that follows and watches everything, and then takes nothing for a while, does not slow the
/// scan; when it takes again, it gets the newest of each unit once.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_slow_page_does_not_slow_the_scan() {
    let address = serve(&Config::simulated()).await;
    let (mut quick, _) = Page::greet(address).await;
    quick.say(&follow(LOOP)).await;
    let mut passes = async || {
        let mut took = Vec::new();
        let mut last = 0;
        while took.len() < 2 {
            let next = quick
                .ddc(|news| match news {
                    DdcNews::Pass {
                        number, took_us, ..
                    } if number > last => Some((number, took_us)),
                    _ => None,
                })
                .await;
            last = next.0;
            took.push(next.1);
        }
        took.into_iter().min().unwrap()
    };
    let alone = passes().await;
    let mut slow = Vec::new();
    for _ in 0..3 {
        let (mut page, _) = Page::greet(address).await;
        page.say(&follow(LOOP)).await;
        for bus in ["", ", port 1", ", port 2"] {
            page.say(&ToBackend::Subscribe {
                bus: format!("{LOOP}{bus}"),
                after: None,
            })
            .await;
        }
        slow.push(page);
    }
    let beside = passes().await;
    println!("a pass took {alone} us alone, {beside} us beside three pages that take nothing");
    assert!(beside < alone + alone / 5, "{alone} {beside}");
    drop(slow);
}

/// What waits for a page is bounded: after a long pause there is one message of each unit.
#[tokio::test]
async fn only_the_newest_waits_for_a_page() {
    let address = serve(&Config::simulated()).await;
    sleep(Duration::from_secs(3)).await;
    let (mut page, _) = Page::greet(address).await;
    let began = Instant::now();
    page.say(&follow(LOOP)).await;
    let mut units = BTreeMap::new();
    page.ddc(|news| {
        if let DdcNews::Unit { unit, .. } = news {
            *units.entry(unit).or_insert(0) += 1;
        }
        (units.len() == 12).then_some(())
    })
    .await;
    println!("{units:?} after {:?}", began.elapsed());
    assert!(units.values().all(|count| *count <= 2), "{units:?}");
}
