//! The page and its WebSocket, over real sockets.

mod common;

use backend::config::Config;
use common::{Page, WAIT, get, serve};
use shared::capture::{Capture, Direction, Micros};
use shared::frame::{Framing, Role};
use shared::image::Image;
use shared::proto::{Block, LineState, Outcome, TableName, ToBackend, ToPage, Way};
use shared::session::Session;
use std::time::Duration;
use tokio_tungstenite::tungstenite::{Error, Message};

const BUS: &str = "Simulated plant";

fn block(table: TableName, start: u16, count: u16) -> Block {
    Block {
        table,
        start,
        count,
    }
}

fn bytes(hex: &str) -> Vec<u8> {
    let (bytes, problems) = shared::text::read_hex(hex.as_bytes());
    assert!(problems.is_empty());
    bytes
}

#[tokio::test]
async fn the_first_words_are_hello_and_the_states_of_lines() {
    let address = serve(&Config::simulated()).await;
    let (mut page, hello) = Page::greet(address).await;
    let ToPage::Hello {
        read_only,
        buses,
        devices,
        run,
        ..
    } = hello
    else {
        panic!("{hello:?}");
    };
    assert!(read_only && run > 0);
    assert_eq!(buses[0].framing, "modbus-rtu");
    assert!(buses[0].simulated);
    assert_eq!(devices[0].tag, "XV-101");
    let state = page
        .until(|m| match m {
            ToPage::Line { bus, state, .. } if state != LineState::Starting => Some((bus, state)),
            _ => None,
        })
        .await;
    assert_eq!(state, (BUS.into(), LineState::Up));
}

/// What a page does: watches a device, follows the bus, decodes the bytes itself.
#[tokio::test]
async fn a_watched_device_is_seen_in_the_captures() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    page.say(&ToBackend::Subscribe {
        bus: BUS.into(),
        after: None,
    })
    .await;
    page.say(&ToBackend::Watch {
        device: "XV-101".into(),
        blocks: vec![
            block(TableName::Holding, 3000, 32),
            block(TableName::Discrete, 0, 32),
            block(TableName::Coil, 0, 11),
            block(TableName::Input, 0, 125),
        ],
        period_ms: 1,
    })
    .await;
    let mut session = Session::new(Framing::Rtu);
    let mut image = Image::new();
    let (mut seq, mut answers, mut decoded) = (0, 0, 0);
    let mut states = 0;
    page.until(|message| {
        match message {
            ToPage::Capture {
                seq: number,
                at_us,
                way,
                ends,
                hex,
                ..
            } => {
                seq += 1;
                assert_eq!(number, seq, "without holes");
                session.push(&Capture {
                    bytes: &bytes(&hex),
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
                    if let (Role::Response, Some(request)) = (frame.role, frame.pair()) {
                        let pdu = |i| {
                            let frame = session.bytes(i).unwrap();
                            frame[1..frame.len() - 2].to_vec()
                        };
                        let at = Micros::new(at_us);
                        image.absorb(&pdu(request), &pdu(decoded), at).unwrap();
                        answers += 1;
                    }
                    decoded += 1;
                }
            }
            // The loop of field units is polled whether anybody watches or not.
            ToPage::Device { tag, .. } if tag.starts_with("MOV") || tag.starts_with("IO") => {}
            ToPage::Device { tag, outcome, .. } => {
                assert_eq!((tag.as_str(), outcome), ("XV-101", Outcome::Ok));
                states += 1;
            }
            ToPage::Line { .. } | ToPage::Tick { .. } => {}
            other => panic!("{other:?}"),
        }
        (answers >= 12 && states >= 2).then_some(())
    })
    .await;
    assert_eq!(image.len(), 32 + 32 + 11 + 125);
}

#[tokio::test]
async fn reads_are_done_or_refused_with_a_reason() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    let cases = [
        ("XV-101", block(TableName::Holding, 3000, 10), Outcome::Ok),
        ("XV-201", block(TableName::Holding, 3000, 125), Outcome::Ok),
        (
            "XV-201",
            block(TableName::Holding, 3480, 1),
            Outcome::Exception,
        ),
        ("XV-101", block(TableName::Coil, 0, 12), Outcome::Exception),
        (
            "XV-101",
            block(TableName::Holding, 0, 126),
            Outcome::Refused,
        ),
        (
            "XV-101",
            block(TableName::Holding, 65_535, 2),
            Outcome::Refused,
        ),
        ("nobody", block(TableName::Holding, 0, 1), Outcome::Refused),
    ];
    for (id, (device, block, expected)) in (0..).zip(cases) {
        page.say(&ToBackend::Read {
            id,
            device: device.into(),
            block,
        })
        .await;
        let (outcome, text) = page
            .until(|m| match m {
                ToPage::Done {
                    id: i,
                    outcome,
                    text,
                } if i == id => Some((outcome, text)),
                _ => None,
            })
            .await;
        assert_eq!(outcome, expected, "{device} {block:?}: {text}");
        assert!(!text.is_empty());
    }
}

#[tokio::test]
async fn a_page_that_comes_back_goes_on_where_it_was() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    let read = |id| ToBackend::Read {
        id,
        device: "XV-101".into(),
        block: block(TableName::Holding, 3000, 10),
    };
    for id in 0..3 {
        page.say(&read(id)).await;
    }
    page.until(|m| matches!(m, ToPage::Done { id: 2, .. }).then_some(()))
        .await;
    let first = |after| ToBackend::Subscribe {
        bus: BUS.into(),
        after,
    };
    for (after, expected) in [(None, 1), (Some(0), 1), (Some(4), 5), (Some(1_000_000), 1)] {
        page.say(&first(after)).await;
        let seq = page
            .until(|m| match m {
                ToPage::Capture { seq, .. } => Some(seq),
                ToPage::Lagged { missed, .. } => panic!("missed {missed}"),
                _ => None,
            })
            .await;
        assert_eq!(seq, expected, "after {after:?}");
        // The rest of what is kept must not be taken for the next answer.
        page.say(&ToBackend::Unsubscribe { bus: BUS.into() }).await;
        page.say(&ToBackend::Unsubscribe { bus: "?".into() }).await;
        page.say(&read(9)).await;
        page.until(|m| matches!(m, ToPage::Done { id: 9, .. }).then_some(()))
            .await;
    }
}

#[tokio::test]
async fn strangers_are_refused_before_the_upgrade() {
    let address = serve(&Config::simulated()).await;
    let own = format!("http://{address}");
    assert!(Page::open(address, &[]).await.is_ok());
    assert!(Page::open(address, &[("Origin", &own)]).await.is_ok());
    for headers in [
        vec![("Origin", "null")],
        vec![("Origin", "http://evil.example")],
        vec![("Origin", "http://localhost:1")],
        vec![("Host", "evil.example"), ("Origin", "http://evil.example")],
    ] {
        match Page::open(address, &headers).await {
            Err(Error::Http(answer)) => assert_eq!(answer.status(), 403, "{headers:?}"),
            other => panic!("{headers:?}: {:?}", other.err()),
        }
    }
}

#[tokio::test]
async fn who_does_not_say_hello_is_sent_away() {
    let address = serve(&Config::simulated()).await;
    for (text, word) in [
        (r#"{"hello":{"version":999}}"#, "999"),
        (r#"{"read":{}}"#, "hello"),
        ("[]", "hello"),
    ] {
        let mut page = Page::open(address, &[]).await.unwrap();
        page.send(Message::text(text)).await;
        assert!(matches!(page.hear().await, Some(ToPage::Hello { .. })));
        match page.hear().await {
            Some(ToPage::Refused { text }) => assert!(text.contains(word), "{text}"),
            other => panic!("{other:?}"),
        }
        assert_eq!(page.hear().await, None);
    }
}

/// Nothing that a page can say writes, and nothing that it says ends the backend.
#[tokio::test]
async fn nonsense_is_answered_with_reasons() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    for text in [
        r#"{"write":{"device":"XV-101","address":0,"value":2}}"#,
        r#"{"send":{"hex":"010600000002"}}"#,
        r#"{"subscribe":{"bus":"?","after":null}}"#,
        r#"{"watch":{"device":"?","blocks":[],"period_ms":1}}"#,
        r#"{"watch":{"device":"XV-101","blocks":[{"table":"coil","start":0,"count":0}],"period_ms":1}}"#,
        "",
        "{",
    ] {
        page.send(Message::text(text)).await;
        let why = page
            .until(|m| match m {
                ToPage::Refused { text } => Some(text),
                _ => None,
            })
            .await;
        assert!(!why.is_empty(), "{text}");
    }
    page.send(Message::binary(vec![1, 2, 3])).await;
    page.until(|m| matches!(m, ToPage::Refused { .. }).then_some(()))
        .await;
    assert_eq!(page.hear().await, None, "binary ends it");
    let (mut page, _) = Page::greet(address).await;
    page.send(Message::text("x".repeat(70_000))).await;
    while page.hear().await.is_some() {}
    let (_page, hello) = Page::greet(address).await;
    assert!(matches!(hello, ToPage::Hello { .. }));
}

#[tokio::test]
async fn seats_are_limited_and_given_back() {
    let address = serve(&Config::simulated()).await;
    let mut pages = Vec::new();
    for _ in 0..64 {
        pages.push(Page::open(address, &[]).await.unwrap());
    }
    assert!(matches!(Page::open(address, &[]).await, Err(Error::Http(a)) if a.status() == 503));
    drop(pages);
    let free = async {
        while Page::open(address, &[]).await.is_err() {
            tokio::time::sleep(Duration::from_millis(10)).await;
        }
    };
    tokio::time::timeout(WAIT, free).await.unwrap();
}

#[tokio::test]
async fn the_page_comes_with_its_headers() {
    let address = serve(&Config::simulated()).await;
    let (head, _) = get(address, "/", "").await;
    for header in [
        "content-security-policy: default-src 'self'; script-src 'self' 'wasm-unsafe-eval'",
        "x-content-type-options: nosniff",
        "referrer-policy: no-referrer",
    ] {
        assert!(head.contains(header), "{head}");
    }
    // Without a bundle the page says how to build it; these hold with and without.
    let built = head.starts_with("http/1.1 200");
    for (path, known) in [
        ("/device/XV-101", built),
        ("/nothing.js", false),
        ("/a/b.br", false),
    ] {
        let (head, _) = get(address, path, "").await;
        assert_eq!(head.starts_with("http/1.1 200"), known, "{path}: {head}");
    }
    if built {
        let (head, plain) = get(address, "/valvescope_bg.wasm", "").await;
        assert!(head.contains("content-type: application/wasm"), "{head}");
        assert!(!head.contains("content-encoding"), "{head}");
        let (small, compressed) = get(
            address,
            "/valvescope_bg.wasm",
            "Accept-Encoding: gzip, br\r\n",
        )
        .await;
        assert!(small.contains("content-encoding: br"), "{small}");
        assert!(compressed.len() < plain.len());
        let tag = small
            .lines()
            .find_map(|l| l.strip_prefix("etag: "))
            .unwrap();
        let again = format!(
            "Accept-Encoding: br\r\nIf-None-Match: {}\r\n",
            tag.to_uppercase()
        );
        let (head, body) = get(address, "/valvescope_bg.wasm", &again).await;
        assert!(
            head.starts_with("http/1.1 304") && body.is_empty(),
            "{head}"
        );
    }
}
