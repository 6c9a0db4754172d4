//! Diagnostic objects, read from the simulated unit over every kind of line, and what of it
//! reaches the line.

mod common;

use axum::extract::ws::Utf8Bytes;
use backend::bus::board::Board;
use backend::bus::recorder::Recorder;
use backend::bus::{self, ClientId, Command, Handle, Outlet, Plug};
use backend::clock::Clock;
use backend::config::{BusConfig, Config, DeviceConfig, LISTEN, LineConfig, Mode};
use backend::sim::{Actuators, Pace, dop_profile, serve_rtu, serve_tcp};
use common::{Page, WAIT, serve};
use shared::address::{Address, Table};
use shared::capture::{Capture, Direction, Micros};
use shared::decode::pdu_of;
use shared::device::Device;
use shared::dop::handshake::Shift;
use shared::dop::recognise::{Exchange, recognise};
use shared::dop::{OBJECTS, ObjectRead, Profile, Request, Stamp};
use shared::encode::{Read, frame};
use shared::frame::Framing;
use shared::frame::check::crc_holds;
use shared::proto::{Block, DopAsk, DopNews, LogFrom, Outcome, TableName, ToBackend, ToPage, Way};
use shared::session::Session;
use shared::sim::DopSetup;
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream};
use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;
use tokio_serial::{SerialPort, SerialStream};

const UNIT: u8 = 4;

fn device(profile: Arc<Profile>) -> DeviceConfig {
    DeviceConfig {
        tag: "MX-1".into(),
        device: Device::Dop,
        bus: 0,
        unit: UNIT,
        description: String::new(),
        faults: Vec::new(),
        profile: Some(profile),
        target: None,
    }
}

fn profile(json: &str) -> Arc<Profile> {
    Arc::new(Profile::from_json(json).unwrap())
}

fn config(line: LineConfig) -> BusConfig {
    BusConfig {
        name: "a".into(),
        line,
        timeout: Duration::from_millis(300),
        retries: 1,
        turnaround: Duration::ZERO,
    }
}

/// A page without a socket.
struct Client {
    handle: Handle,
    id: ClientId,
    out: Outlet,
    news: mpsc::Receiver<Utf8Bytes>,
}

impl Client {
    fn of(handle: &Handle, id: u64) -> Self {
        let (sender, news) = mpsc::channel(Outlet::SIZE);
        Self {
            handle: handle.clone(),
            id: ClientId(id),
            out: Outlet::new(sender),
            news,
        }
    }

    async fn ask(&self, ask: DopAsk) {
        let command = Command::Dop {
            client: self.id,
            device: 0,
            ask,
            out: self.out.clone(),
        };
        assert!(self.handle.ask(command).await);
    }

    async fn hear(&mut self) -> DopNews {
        let text = timeout(WAIT, self.news.recv()).await.expect("news");
        DopNews::from_text(&text.unwrap()).unwrap()
    }

    /// Reads objects; gives what came of each, and the numbers at the end.
    async fn read(&mut self, id: u32, requests: &[u16]) -> (Vec<DopNews>, u32, u32) {
        self.ask(DopAsk::Read {
            id,
            device: "MX-1".into(),
            requests: requests.to_vec(),
        })
        .await;
        let mut news = Vec::new();
        loop {
            match self.hear().await {
                DopNews::Done {
                    id: over,
                    ok,
                    failed,
                    ..
                } if over == id => {
                    return (news, ok, failed);
                }
                DopNews::Progress { .. } | DopNews::Profile { .. } => {}
                other => news.push(other),
            }
        }
    }

    /// Reads one object; gives its registers.
    async fn object(&mut self, request: u16) -> Vec<u16> {
        let (news, ok, failed) = self.read(u32::from(request) + 100_000, &[request]).await;
        assert_eq!((ok, failed), (1, 0), "{news:?}");
        match news.as_slice() {
            [
                DopNews::Object {
                    hex, request: word, ..
                },
            ] => {
                assert_eq!(*word, request);
                words(hex)
            }
            other => panic!("{other:?}"),
        }
    }
}

/// Registers from hexadecimal, four digits each.
fn words(hex: &str) -> Vec<u16> {
    assert_eq!(hex.len() % 4, 0);
    (0..hex.len() / 4)
        .map(|at| u16::from_str_radix(&hex[4 * at..4 * at + 4], 16).unwrap())
        .collect()
}

fn start(bus: BusConfig, devices: &[DeviceConfig], plug: Plug) -> Handle {
    let (clock, activity) = (Clock::start(), watch::Sender::new(0));
    let board = Board::new(activity.clone());
    let recorder = Recorder::new("a", clock, activity);
    bus::start(bus, devices, plug, clock, board, recorder)
}

/// A bus with the built-in simulated unit.
fn simulated(setup: DopSetup, profile: Arc<Profile>) -> Handle {
    let devices = [device(profile)];
    let actuators = Actuators::with(&devices, Clock::start(), setup);
    start(
        config(LineConfig::Simulator),
        &devices,
        Plug::Simulated(actuators),
    )
}

/// The tag by the decoder and the printed place of it: object 1006, registers 0 to 8.
async fn tag_is_read(client: &mut Client) {
    let identity = client.object(1006).await;
    assert_eq!(identity.len(), 128);
    let bytes: Vec<u8> = identity[..9].iter().flat_map(|w| w.to_le_bytes()).collect();
    assert_eq!(&bytes[..5], b"MX-1\0");
}

/// Every object and option of the manual, over the built-in line.
#[tokio::test(start_paused = true)]
async fn all_objects_are_read() {
    let profile = dop_profile();
    let handle = simulated(
        DopSetup {
            busy_ms: 5,
            moves: false,
            ..DopSetup::default()
        },
        profile.clone(),
    );
    let mut client = Client::of(&handle, 1);
    let all: Vec<u16> = OBJECTS
        .iter()
        .flat_map(|o| o.options.iter().map(|c| o.request(c, &profile).word()))
        .collect();
    assert_eq!(all.len(), 65);
    let (news, ok, failed) = client.read(7, &all).await;
    assert_eq!((ok, failed, news.len()), (65, 0, 65));
    for (news, asked) in news.iter().zip(&all) {
        let DopNews::Object {
            request,
            hex,
            text,
            retries,
            foreign,
            ..
        } = news
        else {
            panic!("{news:?}");
        };
        assert_eq!((request, *retries, *foreign), (asked, 0, 0), "{text}");
        let read = ObjectRead::read(Request::from_word(*request), &words(hex), &profile);
        assert!(read.layout.is_some(), "{request:04X}: {}", read.why);
        // 0xF is a bare answer to "is there a log", of which the layout says nothing more.
        assert_eq!(read.decoded.problems().len(), 0, "{request:04X}");
    }
}

#[tokio::test(start_paused = true)]
async fn the_status_position_is_learned_and_told() {
    for shift in [11, 12, 13] {
        let handle = simulated(
            DopSetup {
                shift,
                busy_ms: 60,
                ..DopSetup::default()
            },
            profile(
                r#"{"registers":{"request":4000,"status":4014,"count":4015,"response":4100},
                "reading":{"poll_ms":50}}"#,
            ),
        );
        let mut client = Client::of(&handle, 1);
        tag_is_read(&mut client).await;
        client
            .ask(DopAsk::Profile {
                device: "MX-1".into(),
            })
            .await;
        let learned = loop {
            if let DopNews::Profile { shift, profile, .. } = client.hear().await {
                assert_eq!(profile["registers"]["request"], 4000);
                break shift;
            }
        };
        assert_eq!(learned, Some(shift));
    }
}

#[tokio::test(start_paused = true)]
async fn errors_of_the_device_have_their_code() {
    // A profile that numbers the log commands otherwise than the device.
    let handle = simulated(
        DopSetup::default(),
        profile(
            r#"{"registers":{"request":4000,"status":4014,"count":4015,"response":4100},
            "log":{"newest":9,"oldest":10,"older":11,"newer":12,"present":13}}"#,
        ),
    );
    let mut client = Client::of(&handle, 1);
    let (news, ok, failed) = client.read(1, &[0x94B2, 1005, 0x04B2, 0x4001]).await;
    assert_eq!((ok, failed), (1, 3));
    let [
        DopNews::Failed {
            code: Some(3),
            outcome: Outcome::Ok,
            ..
        },
        DopNews::Object { request: 1005, .. },
        DopNews::Failed {
            code: None,
            outcome: Outcome::Refused,
            request: 0x04B2,
            ..
        },
        DopNews::Failed {
            code: None,
            outcome: Outcome::Refused,
            text,
            ..
        },
    ] = news.as_slice()
    else {
        panic!("{news:?}");
    };
    assert!(text.contains("0x4001"), "{text}");
}

/// A whole log in both directions, without a record twice or missing.
#[tokio::test(start_paused = true)]
async fn logs_are_read_to_their_end() {
    let profile = dop_profile();
    let setup = DopSetup {
        busy_ms: 2,
        events: 100,
        moves: false,
        ..DopSetup::default()
    };
    let handle = simulated(setup, profile.clone());
    let mut client = Client::of(&handle, 1);
    for (object, from, total) in [
        (1202, LogFrom::Newest, 100),
        (1202, LogFrom::Oldest, 100),
        (1203, LogFrom::Newest, 260),
    ] {
        client
            .ask(DopAsk::Log {
                id: 3,
                device: "MX-1".into(),
                object,
                from,
                after: None,
                limit: 0,
            })
            .await;
        let mut seen = BTreeSet::new();
        let mut last = None;
        let mut end = None;
        loop {
            match client.hear().await {
                DopNews::Object { request, hex, .. } => {
                    let read =
                        ObjectRead::read(Request::from_word(request), &words(&hex), &profile);
                    for record in read.records() {
                        let Stamp::At(time) = record.time else {
                            panic!("{record:?}");
                        };
                        let falls = last.is_none_or(|last| time <= last);
                        let rises = last.is_none_or(|last| time >= last);
                        assert!(if from == LogFrom::Newest {
                            falls
                        } else {
                            rises
                        });
                        last = Some(time);
                        assert!(seen.insert((time, record.id)));
                    }
                }
                DopNews::LogEnd { pages, text, .. } => end = Some((pages, text)),
                DopNews::Done { ok, failed, .. } => {
                    assert_eq!(failed, 0);
                    assert!(ok > 0);
                    break;
                }
                DopNews::Progress { .. } | DopNews::Profile { .. } => {}
                other => panic!("{other:?}"),
            }
        }
        assert_eq!(seen.len(), total);
        // Pages of eighteen, and the empty one.
        let (pages, text) = end.expect("the end is said");
        assert_eq!(pages as usize, total.div_ceil(18) + 1, "{text}");
    }
}

#[tokio::test(start_paused = true)]
async fn a_log_is_cancelled_resumed_and_limited() {
    let handle = simulated(
        DopSetup {
            busy_ms: 2,
            moves: false,
            ..DopSetup::default()
        },
        dop_profile(),
    );
    let mut client = Client::of(&handle, 1);
    let log = |id, after, limit| DopAsk::Log {
        id,
        device: "MX-1".into(),
        object: 1202,
        from: LogFrom::Newest,
        after,
        limit,
    };
    // Ids run from 1001 to 1420; twenty records leave 400 to 1400.
    for (ask, cancel, word, records) in [
        (log(1, None, 20), false, "as many as", 36),
        (log(2, None, 0), true, "cancelled", 0),
        (log(3, Some(1401), 20), false, "as many as", 36),
    ] {
        client.ask(ask).await;
        let mut sent = 0;
        let mut first = None;
        let (text, id) = loop {
            match client.hear().await {
                DopNews::Object { hex, id, .. } => {
                    let words = words(&hex);
                    sent += usize::from(words[0]);
                    first = first.or(Some(words[1]));
                    if cancel {
                        client.ask(DopAsk::Cancel { id }).await;
                    }
                }
                DopNews::LogEnd { text, id, .. } => break (text, id),
                _ => {}
            }
        };
        assert!(text.contains(word), "{text}");
        if !cancel {
            assert_eq!(sent, records);
            // Pages without a record that is wanted are not sent.
            assert_eq!(first, Some(if id == 1 { 1420 } else { 1402 }));
        }
        assert!(matches!(client.hear().await, DopNews::Done { .. }));
    }
    // A page that is gone takes its log with it: the next client is served.
    client.ask(log(9, None, 0)).await;
    client
        .handle
        .ask(Command::Leave { client: client.id })
        .await;
    drop(client);
    let mut other = Client::of(&handle, 2);
    let began = Instant::now();
    tag_is_read_as(&mut other, "MX-1").await;
    assert!(began.elapsed() < Duration::from_secs(3));
}

async fn tag_is_read_as(client: &mut Client, tag: &str) {
    let identity = client.object(1006).await;
    let bytes: Vec<u8> = identity[..9].iter().flat_map(|w| w.to_le_bytes()).collect();
    assert!(bytes.starts_with(tag.as_bytes()));
}

/// Two pages ask the same device at once: the handshakes do not mix.
#[tokio::test(start_paused = true)]
async fn clients_are_queued() {
    let handle = simulated(DopSetup::default(), dop_profile());
    let ask = |id: u64, requests: [u16; 6]| {
        let mut client = Client::of(&handle, id);
        async move {
            let (news, ok, failed) = client.read(1, &requests).await;
            assert_eq!((ok, failed), (6, 0), "{news:?}");
            for (news, asked) in news.iter().zip(requests) {
                let DopNews::Object {
                    request,
                    hex,
                    foreign: 0,
                    retries: 0,
                    ..
                } = news
                else {
                    panic!("{news:?}");
                };
                assert_eq!(*request, asked);
                let want = match asked {
                    1003 => 22,
                    1004 => 23,
                    1005 => 4,
                    1007 => 6,
                    405 => 10,
                    _ => 14,
                };
                assert_eq!(words(hex).len(), want);
            }
        }
    };
    tokio::join!(
        ask(1, [1003, 1004, 1005, 1007, 405, 5]),
        ask(2, [5, 405, 1007, 1005, 1004, 1003]),
        ask(3, [1005, 1005, 1005, 1003, 1003, 1003]),
    );
}

/// Another master asks once a second; everything is read all the same, and it is said.
#[tokio::test(start_paused = true)]
async fn another_master_in_between_is_noticed() {
    let handle = simulated(
        DopSetup {
            busy_ms: 150,
            foreign_ms: 900,
            ..DopSetup::default()
        },
        profile(
            r#"{"registers":{"request":4000,"status":4014,"count":4015,"response":4100},
            "status":{"shift":12},"reading":{"poll_ms":20,"retries":5}}"#,
        ),
    );
    let mut client = Client::of(&handle, 1);
    let (news, ok, failed) = client
        .read(1, &[0x0191, 1004, 0x1191, 1007, 0x2191, 1005])
        .await;
    assert_eq!((ok, failed), (6, 0), "{news:?}");
    let mut foreign = 0;
    for news in &news {
        let DopNews::Object {
            request,
            hex,
            foreign: seen,
            retries,
            text,
            ..
        } = news
        else {
            panic!("{news:?}");
        };
        let want = match request {
            1004 => 23,
            1005 => 4,
            1007 => 6,
            _ => 410,
        };
        assert_eq!(words(hex).len(), want, "{text}");
        assert!(retries >= seen);
        if *seen > 0 {
            assert!(text.contains("object 1003"), "{text}");
        }
        foreign += seen;
    }
    assert!(foreign > 0, "six objects take longer than its period");
}

#[tokio::test(start_paused = true)]
async fn indicators_are_watched() {
    let handle = simulated(DopSetup::default(), dop_profile());
    let mut client = Client::of(&handle, 1);
    let watch = |period_ms| DopAsk::Watch {
        device: "MX-1".into(),
        period_ms,
    };
    client.ask(watch(100)).await;
    let mut times = Vec::new();
    while times.len() < 4 {
        if let DopNews::Indicators { hex, at_us, .. } = client.hear().await {
            // Bits 1, 13 and 40, low word first.
            assert_eq!(hex, "2002000001000000");
            times.push(at_us);
        }
    }
    for pair in times.windows(2) {
        assert!(
            (90_000..200_000).contains(&(pair[1] - pair[0])),
            "{times:?}"
        );
    }
    client.ask(watch(0)).await;
    while timeout(Duration::from_millis(300), client.news.recv())
        .await
        .is_ok()
    {}
    assert!(
        timeout(Duration::from_millis(300), client.news.recv())
            .await
            .is_err()
    );
}

/// Without addresses nothing is sent, and the page is told which one is missing.
#[tokio::test]
async fn a_device_without_addresses_is_not_asked() {
    for (json, key) in [
        ("{}", "registers.response"),
        (
            r#"{"registers":{"status":1,"count":2,"response":100}}"#,
            "registers.request",
        ),
        (
            r#"{"registers":{"request":1,"count":2,"response":100}}"#,
            "registers.status",
        ),
        (
            r#"{"registers":{"request":1,"status":2,"response":100}}"#,
            "registers.count",
        ),
    ] {
        let handle = simulated(DopSetup::default(), profile(json));
        let mut client = Client::of(&handle, 1);
        let (news, ok, failed) = client.read(1, &[1006, 1004]).await;
        assert_eq!((ok, failed), (0, 2));
        let [
            DopNews::Failed {
                outcome: Outcome::Refused,
                text,
                ..
            },
            _,
        ] = news.as_slice()
        else {
            panic!("{news:?}");
        };
        assert!(text.contains(key), "{text}");
        assert_eq!(handle.recorder().last(), 0, "nothing was on the line");
    }
}

// ---- over real lines

fn setup() -> DopSetup {
    DopSetup {
        busy_ms: 30,
        ..DopSetup::default()
    }
}

#[tokio::test]
async fn over_a_serial_port() {
    let (near, far) = SerialStream::pair().unwrap();
    let devices = [device(dop_profile())];
    let actuators = Actuators::with(&devices, Clock::start(), setup());
    let path = far.name().unwrap();
    tokio::spawn(
        async move { serve_rtu(near, &actuators, Pace::real(Duration::from_millis(4))).await },
    );
    let line = LineConfig::Serial {
        framing: Framing::Rtu,
        port: path,
        baud: 38_400,
        mode: Mode::parse("8N1").unwrap(),
    };
    let handle = start(config(line), &devices, Plug::Configured);
    let mut client = Client::of(&handle, 1);
    tag_is_read(&mut client).await;
    assert_eq!(client.object(0x1191).await.len(), 410);
}

#[tokio::test]
async fn over_tcp_with_either_function() {
    for function in [6, 16] {
        let json = format!(
            r#"{{"registers":{{"request":4000,"status":4014,"count":4015,"response":4100}},
            "table":"input","request_function":{function}}}"#
        );
        let devices = [device(profile(&json))];
        let actuators = Actuators::with(&devices, Clock::start(), setup());
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let host = listener.local_addr().unwrap().to_string();
        tokio::spawn(serve_tcp(listener, actuators));
        let handle = start(config(LineConfig::Tcp { host }), &devices, Plug::Configured);
        let mut client = Client::of(&handle, 1);
        tag_is_read(&mut client).await;
        assert_eq!(client.object(0x0191).await.len(), 410);
        let (news, _, failed) = client.read(5, &[0x04B2, 0x14B2]).await;
        assert_eq!((failed, news.len()), (0, 2));
    }
}

/// The device end of a line that keeps every frame that it gets, and may answer.
type Frames = Arc<Mutex<Vec<Vec<u8>>>>;

/// Serves the simulated unit over a stream and keeps what was asked, byte for byte.
async fn listen(mut line: DuplexStream, framing: Framing, actuators: Actuators, frames: Frames) {
    let mut heard = Vec::new();
    let mut bytes = [0; 512];
    while let Ok(count @ 1..) = line.read(&mut bytes).await {
        heard.extend_from_slice(&bytes[..count]);
        let whole = match framing {
            Framing::Ascii => heard.ends_with(b"\r\n"),
            _ => heard.len() >= 8 && crc_holds(&heard),
        };
        if !whole {
            continue;
        }
        frames.lock().unwrap().push(heard.clone());
        let pdu = pdu_of(&heard, framing).unwrap();
        let unit = match framing {
            Framing::Ascii => u8::from_str_radix(std::str::from_utf8(&heard[1..3]).unwrap(), 16),
            _ => Ok(heard[0]),
        };
        let unit = unit.unwrap();
        heard.clear();
        if let Some(answer) = actuators.answer(unit, &pdu) {
            line.write_all(&frame(framing, 0, unit, &answer))
                .await
                .unwrap();
        }
    }
}

/// A bus over a stream that is listened to.
fn tapped(framing: Framing, devices: &[DeviceConfig]) -> (Handle, Frames) {
    let frames = Frames::default();
    let actuators = Actuators::with(
        devices,
        Clock::start(),
        DopSetup {
            busy_ms: 0,
            ..DopSetup::default()
        },
    );
    let mode = if framing == Framing::Ascii {
        "7E1"
    } else {
        "8N1"
    };
    let line = LineConfig::Serial {
        framing,
        port: "tapped".into(),
        baud: 115_200,
        mode: Mode::parse(mode).unwrap(),
    };
    let kept = frames.clone();
    let plug = Plug::Stream(Box::new(move || {
        let (near, far) = tokio::io::duplex(4096);
        tokio::spawn(listen(far, framing, actuators.clone(), kept.clone()));
        Ok(Box::new(near))
    }));
    (start(config(line), devices, plug), frames)
}

#[tokio::test]
async fn over_ascii() {
    let devices = [device(dop_profile())];
    let (handle, frames) = tapped(Framing::Ascii, &devices);
    let mut client = Client::of(&handle, 1);
    tag_is_read(&mut client).await;
    // The request as it must stand on the line: unit 4, function 6, register 4000, word 0x03EE;
    // the LRC by hand: 0x100 - (04 + 06 + 0F + A0 + 03 + EE) = 0x100 - 0x1AA modulo 256 = 0x56.
    // The first frame looks at the status.
    assert_eq!(frames.lock().unwrap()[1], b":04060FA003EE56\r\n");
}

/// The proof that the line sees reads and permitted requests only: a page asks for all 65,536
/// words, for every device there is; every byte that reaches the line is looked at.
#[tokio::test(start_paused = true)]
async fn whatever_is_asked_only_known_requests_reach_the_line() {
    let mut other = device(profile(r#"{"registers":{"request":4000}}"#));
    other.tag = "XV-2".into();
    other.unit = 5;
    other.device = Device::Icon3000v2;
    let devices = [device(dop_profile()), other];
    let (handle, frames) = tapped(Framing::Rtu, &devices);
    let mut client = Client::of(&handle, 1);
    let (mut ok, mut failed) = (0, 0);
    let words: Vec<u16> = (0..=u16::MAX).collect();
    for (id, chunk) in (0..).zip(words.chunks(128)) {
        let (_, good, bad) = client.read(id, chunk).await;
        ok += good;
        failed += bad;
    }
    // The other device has no objects, whatever its profile says.
    for device in [1, 2] {
        let command = Command::Dop {
            client: client.id,
            device,
            ask: DopAsk::Read {
                id: 1,
                device: "XV-2".into(),
                requests: words[..200].to_vec(),
            },
            out: client.out.clone(),
        };
        handle.ask(command).await;
    }
    let report = handle
        .read(0, Read::new(Table::Holding, Address::new(4014), 1).unwrap())
        .await;
    assert_eq!(report.outcome, Outcome::Ok);
    assert_eq!((ok, failed), (65, 65_536 - 65));
    let frames = frames.lock().unwrap();
    let mut written = BTreeSet::new();
    for bytes in frames.iter() {
        match &bytes[..bytes.len() - 2] {
            // Reads of the four areas, of the unit that was meant.
            [UNIT, 3, a, b, 0, 1..=125] => {
                let address = u16::from_be_bytes([*a, *b]);
                assert!(
                    address == 4014 || address == 4015 || (4100..4612).contains(&address),
                    "{address}"
                );
            }
            // The one write: 4000 is 0x0FA0.
            [UNIT, 6, 0x0F, 0xA0, high, low] => {
                assert!(
                    written.insert(u16::from_be_bytes([*high, *low])),
                    "once each"
                );
            }
            other => panic!("{other:02X?}"),
        }
    }
    assert_eq!(written.len(), 65);
    let profile = dop_profile();
    assert!(
        written
            .iter()
            .all(|w| Request::from_word(*w).is_known(&profile))
    );
}

/// A log and a watch on the same line, and a watch on the same device: neither waits for the other.
#[tokio::test(start_paused = true)]
async fn a_log_and_watches_share_the_line() {
    let mut other = device(profile("{}"));
    other.tag = "XV-2".into();
    other.unit = 5;
    other.device = Device::Icon3000v2;
    other.profile = None;
    let devices = [device(dop_profile()), other];
    let (handle, frames) = tapped(Framing::Rtu, &devices);
    // A register of the other device ten times a second, and the legacy bit of this one as often
    // as it can be had.
    for (device, start, period) in [(1, 3004, 100), (0, 9, 0)] {
        let read = Read::new(Table::Holding, Address::new(start), 1).unwrap();
        let command = Command::Watch {
            client: ClientId(7),
            device,
            reads: vec![read],
            period: Duration::from_millis(period),
        };
        handle.ask(command).await;
    }
    let mut client = Client::of(&handle, 1);
    let began = tokio::time::Instant::now();
    client
        .ask(DopAsk::Log {
            id: 1,
            device: "MX-1".into(),
            object: 1203,
            from: LogFrom::Newest,
            after: None,
            limit: 0,
        })
        .await;
    loop {
        if let DopNews::Done { ok, failed, .. } = client.hear().await {
            assert_eq!((ok, failed), (16, 0));
            break;
        }
    }
    let seconds = began.elapsed().as_secs_f64();
    let frames = frames.lock().unwrap();
    let count = |f: &dyn Fn(&[u8]) -> bool| frames.iter().filter(|b| f(b)).count();
    let watched = count(&|b| b[0] == 5);
    let legacy = count(&|b| b[0] == UNIT && b[2..4] == [0, 9]);
    let objects = count(&|b| b[0] == UNIT && b[2..4] != [0, 9]);
    assert!(
        seconds > 1.0 && watched as f64 >= 9.0 * seconds,
        "{watched} in {seconds} s"
    );
    // Turn by turn, as long as the handshake does not wait for the device.
    assert!(legacy >= objects - 2, "{legacy} and {objects}");
    assert!(objects > 100, "{objects}");
}

/// A line on which one answer in ten is lost, damaged, doubled or late.
async fn faulty(mut line: DuplexStream, actuators: Actuators, mut seed: u64) {
    let mut heard = Vec::new();
    let mut bytes = [0; 512];
    while let Ok(count @ 1..) = line.read(&mut bytes).await {
        heard.extend_from_slice(&bytes[..count]);
        if heard.len() < 8 || !crc_holds(&heard) {
            continue;
        }
        let pdu = pdu_of(&heard, Framing::Rtu).unwrap();
        let answer = actuators.answer(heard[0], &pdu);
        heard.clear();
        let Some(answer) = answer else { continue };
        let mut answer = frame(Framing::Rtu, 0, UNIT, &answer);
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        match (seed >> 33) % 40 {
            0 => continue,
            1 => {
                let at = usize::try_from(seed >> 40).unwrap() % answer.len();
                answer[at] ^= 0x10;
            }
            2 => answer.extend(answer.clone()),
            // Later than the time-out of 300 ms.
            3 => tokio::time::sleep(Duration::from_millis(450)).await,
            _ => {}
        }
        line.write_all(&answer).await.unwrap();
    }
}

/// What the recorder keeps is found again as the reads that were made, with and without the
/// addresses, and whether or not the directions are known.
#[tokio::test(start_paused = true)]
async fn the_capture_of_a_session_is_recognised() {
    let profile = dop_profile();
    let handle = simulated(DopSetup::default(), profile.clone());
    let mut client = Client::of(&handle, 1);
    let requests = [1006, 0x0191, 0x04B2, 1005, 0x1001];
    let (news, ok, _) = client.read(1, &requests).await;
    assert_eq!(ok, 5);
    let captures = handle.recorder().after(0, 10_000);
    assert_eq!(captures.missed, 0);
    for sniffed in [false, true] {
        let mut session = Session::new(Framing::Rtu);
        for text in &captures.messages {
            let ToPage::Capture {
                at_us,
                way,
                ends,
                hex,
                ..
            } = serde_json::from_str(text).unwrap()
            else {
                panic!("{text}");
            };
            let bytes = shared::text::read_hex(hex.as_bytes()).0;
            session.push(&Capture {
                bytes: &bytes,
                at: Some(Micros::new(at_us)),
                direction: match way {
                    _ if sniffed => Direction::Unknown,
                    Way::Tx => Direction::ToDevice,
                    Way::Rx => Direction::FromDevice,
                },
                ends,
            });
        }
        session.finish();
        let exchanges = Exchange::all(&session);
        for profile in [&*profile, &Profile::default()] {
            let found = recognise(&exchanges, profile);
            assert_eq!(found.inferred, profile.registers.request.is_none());
            assert_eq!(found.reads.len(), 5);
            for (read, news) in found.reads.iter().zip(&news) {
                let DopNews::Object {
                    request,
                    hex,
                    took_us,
                    polls,
                    ..
                } = news
                else {
                    panic!("{news:?}");
                };
                assert_eq!(read.request.word(), *request);
                assert_eq!(read.words, words(hex));
                assert!(
                    read.complete && read.problems.is_empty(),
                    "{:?}",
                    read.problems
                );
                // The first look before the very first write belongs to no request.
                assert!(read.polls <= *polls && read.polls + 1 >= *polls);
                // The last look at the status comes behind the last register.
                assert!(read.took().unwrap() < *took_us);
                assert_eq!(read.position.shift().map(Shift::bit), Some(12));
            }
        }
    }
}

/// A two-wire adapter that repeats what it sends, before the device answers.
async fn repeating(mut line: DuplexStream, actuators: Actuators, frames: Frames) {
    let mut heard = Vec::new();
    let mut bytes = [0; 512];
    while let Ok(count @ 1..) = line.read(&mut bytes).await {
        heard.extend_from_slice(&bytes[..count]);
        if heard.len() < 8 || !crc_holds(&heard) {
            continue;
        }
        line.write_all(&heard).await.unwrap();
        tokio::time::sleep(Duration::from_millis(20)).await;
        // A master that took its own request for the answer would have sent another by now.
        assert!(
            timeout(Duration::from_millis(1), line.read(&mut bytes))
                .await
                .is_err()
        );
        frames.lock().unwrap().push(heard.clone());
        let pdu = pdu_of(&heard, Framing::Rtu).unwrap();
        heard.clear();
        if let Some(answer) = actuators.answer(UNIT, &pdu) {
            let answer = frame(Framing::Rtu, 0, UNIT, &answer);
            line.write_all(&answer).await.unwrap();
        }
    }
}

/// The answer to the one write looks like the write; it is waited for all the same.
#[tokio::test(start_paused = true)]
async fn a_line_that_repeats_does_not_mislead() {
    let devices = [device(dop_profile())];
    let actuators = Actuators::with(&devices, Clock::start(), setup());
    let frames = Frames::default();
    let kept = frames.clone();
    let plug = Plug::Stream(Box::new(move || {
        let (near, far) = tokio::io::duplex(4096);
        tokio::spawn(repeating(far, actuators.clone(), kept.clone()));
        Ok(Box::new(near))
    }));
    let bus = config(LineConfig::Serial {
        framing: Framing::Rtu,
        port: "two-wire".into(),
        baud: 19_200,
        mode: Mode::parse("8E1").unwrap(),
    });
    let mut client = Client::of(&start(bus, &devices, plug), 1);
    tag_is_read(&mut client).await;
    let writes = |frames: &Frames| frames.lock().unwrap().iter().filter(|f| f[1] == 6).count();
    assert_eq!(writes(&frames), 1);
    assert_eq!(client.object(405).await.len(), 10);
    assert_eq!(writes(&frames), 2);
}

/// Whatever the line does: an object that is handed over is the one that the device has.
#[tokio::test(start_paused = true)]
async fn a_bad_line_gives_no_wrong_object() {
    let devices = [device(dop_profile())];
    let still = DopSetup {
        busy_ms: 50,
        moves: false,
        ..DopSetup::default()
    };
    // Objects in which nothing changes with time, two of them of the same shape.
    let requests = [1006, 0x1191, 0x3191, 0x04B2, 0x04B3];
    let actuators = Actuators::with(&devices, Clock::start(), still);
    let run = |handle: Handle, times: usize| async move {
        let mut client = Client::of(&handle, 1);
        let mut found: Vec<(u16, String)> = Vec::new();
        let (mut good, mut bad) = (0, 0);
        for id in 0..times {
            let (news, ok, failed) = client.read(u32::try_from(id).unwrap(), &requests).await;
            good += ok;
            bad += failed;
            for news in news {
                if let DopNews::Object { request, hex, .. } = news {
                    found.push((request, hex));
                }
            }
        }
        (found, good, bad)
    };
    let bus = config(LineConfig::Serial {
        framing: Framing::Rtu,
        port: "bad".into(),
        baud: 115_200,
        mode: Mode::parse("8N1").unwrap(),
    });
    let plug = |seed: Option<u64>| {
        let actuators = actuators.clone();
        Plug::Stream(Box::new(move || {
            let (near, far) = tokio::io::duplex(4096);
            let actuators = actuators.clone();
            match seed {
                Some(seed) => tokio::spawn(faulty(far, actuators, seed)),
                None => tokio::spawn(listen(far, Framing::Rtu, actuators, Frames::default())),
            };
            Ok(Box::new(near))
        }))
    };
    let (truth, ..) = run(start(bus.clone(), &devices, plug(None)), 1).await;
    assert_eq!(truth.len(), 5);
    let (found, good, bad) = run(start(bus, &devices, plug(Some(42))), 60).await;
    assert!(good > 200, "{good} of 300 read, {bad} not");
    for (request, hex) in found {
        let want = &truth.iter().find(|(r, _)| *r == request).unwrap().1;
        assert_eq!(&hex, want, "{request:04X}");
    }
}

// ---- over the WebSocket

#[tokio::test]
async fn a_page_reads_objects_while_another_device_is_watched() {
    let address = serve(&Config::simulated()).await;
    assert_eq!(Config::simulated().listen, LISTEN);
    let (mut page, hello) = Page::greet(address).await;
    let ToPage::Hello {
        read_only, devices, ..
    } = hello
    else {
        panic!("{hello:?}");
    };
    assert!(read_only);
    assert!(
        devices
            .iter()
            .any(|d| (d.tag.as_str(), d.kind.as_str()) == ("MX-301", "dop"))
    );
    // A watch that takes all that the line can give.
    page.say(&ToBackend::Watch {
        device: "XV-101".into(),
        blocks: vec![Block {
            table: TableName::Holding,
            start: 3000,
            count: 31,
        }],
        period_ms: 100,
    })
    .await;
    let began = Instant::now();
    page.say(&ToBackend::Dop(DopAsk::Read {
        id: 1,
        device: "MX-301".into(),
        requests: vec![1006, 0x0191, 1004],
    }))
    .await;
    let mut steps = BTreeSet::new();
    loop {
        match page.news().await {
            DopNews::Progress {
                step,
                id: 1,
                total: 3,
                ..
            } => {
                steps.insert(format!("{step:?}"));
            }
            DopNews::Object {
                device,
                at_us,
                took_us,
                busy_us,
                polls,
                ..
            } => {
                assert_eq!(device, "MX-301");
                assert!(took_us > busy_us && busy_us >= 120_000 && at_us > took_us && polls >= 2);
            }
            DopNews::Done { ok, failed, .. } => {
                assert_eq!((ok, failed), (3, 0));
                break;
            }
            DopNews::Profile {
                shift: Some(12), ..
            } => {}
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(steps.len(), 4, "{steps:?}");
    // What was not meant for a DOP device is answered, and the line goes on.
    for (device, word) in [("XV-101", "kind"), ("XX", "no device")] {
        page.say(&ToBackend::Dop(DopAsk::Read {
            id: 2,
            device: device.into(),
            requests: vec![1006],
        }))
        .await;
        let DopNews::Failed {
            text,
            outcome: Outcome::Refused,
            ..
        } = page.news().await
        else {
            panic!("no refusal");
        };
        assert!(text.contains(word), "{text}");
        assert!(matches!(page.news().await, DopNews::Done { failed: 1, .. }));
    }
    // The watched device was served in between: its state is posted once a second.
    let state = page
        .until(|m| match m {
            ToPage::Device {
                tag,
                outcome,
                last_ok_us,
                ..
            } if tag == "XV-101" => Some((outcome, last_ok_us)),
            _ => None,
        })
        .await;
    assert_eq!(state.0, Outcome::Ok);
    assert!(began.elapsed() < Duration::from_secs(8));
}

// ---- how long it takes

/// The physical minimum at 9600 8E1, in microseconds, by the formula of the line: a transaction is
/// its characters of 11 bits, the device's turn of 6 ms, and the silence of 3.5 characters before
/// the next. An object needs a write (8 + 8), one look at the status (8 + 7), the count (8 + 7)
/// and blocks of at most 125 registers (8 + 5 + 2 n); the device is busy for 120 ms.
fn ideal_us(registers: usize) -> u64 {
    const CHARACTER_NS: u64 = 11_000_000_000 / 9600;
    const PAUSES_NS: u64 = 6_000_000 + CHARACTER_NS * 7 / 2;
    let transaction = |characters: usize| characters as u64 * CHARACTER_NS + PAUSES_NS;
    let blocks = (0..registers.div_ceil(125)).map(|at| (registers - 125 * at).min(125));
    let data: u64 = blocks.map(|n| transaction(8 + 5 + 2 * n)).sum();
    (transaction(16) + 2 * transaction(15) + data) / 1000 + 120_000
}

/// A line of 9600 baud that takes its time.
fn paced(stream: bool) -> (Handle, Option<SerialStream>) {
    let devices = [device(dop_profile())];
    let actuators = Actuators::with(&devices, Clock::start(), DopSetup::default());
    let pace = Pace::of(9600);
    let (port, plug, kept) = if stream {
        let plug = Plug::Stream(Box::new(move || {
            let (near, far) = tokio::io::duplex(4096);
            let actuators = actuators.clone();
            tokio::spawn(async move { serve_rtu(far, &actuators, pace).await });
            Ok(Box::new(near))
        }));
        ("paced".to_owned(), plug, None)
    } else {
        let (near, far) = SerialStream::pair().unwrap();
        let path = far.name().unwrap();
        tokio::spawn(async move { serve_rtu(near, &actuators, pace).await });
        (path, Plug::Configured, Some(far))
    };
    let line = LineConfig::Serial {
        framing: Framing::Rtu,
        port,
        baud: 9600,
        // As many bits as 8E1, and a pseudo terminal has no parity.
        mode: Mode::parse("8N2").unwrap(),
    };
    let mut bus = config(line);
    // What is sent over a pretended line comes all at once, when its last character would.
    bus.timeout = Duration::from_millis(500);
    (start(bus, &devices, plug), kept)
}

/// Reads objects; gives the time that it took over the least that it could take.
async fn ratio(client: &mut Client, requests: &[u16]) -> f64 {
    let began = tokio::time::Instant::now();
    let (news, ok, _) = client.read(1, requests).await;
    let took = began.elapsed().as_micros() as f64;
    assert_eq!(ok as usize, requests.len());
    let ideal: u64 = news
        .iter()
        .map(|news| match news {
            DopNews::Object { hex, .. } => ideal_us(hex.len() / 4),
            other => panic!("{other:?}"),
        })
        .sum();
    println!(
        "{} objects at 9600 baud: {:.2} s, {:.2} s at least, {:.1} %",
        requests.len(),
        took / 1e6,
        ideal as f64 / 1e6,
        100.0 * took / ideal as f64
    );
    took / ideal as f64
}

/// Every object and option within 115 % of wire time and busy time. Time is simulated, so that the
/// half minute is over at once.
#[tokio::test(start_paused = true)]
async fn a_complete_read_at_9600_baud_is_as_fast_as_the_line() {
    let (handle, _) = paced(true);
    let mut client = Client::of(&handle, 1);
    let profile = dop_profile();
    let all: Vec<u16> = OBJECTS
        .iter()
        .flat_map(|o| o.options.iter().map(|c| o.request(c, &profile).word()))
        .collect();
    let ratio = ratio(&mut client, &all).await;
    assert!((1.0..=1.15).contains(&ratio), "{ratio}");
}

/// The same in real time over a pseudo terminal, with some of them.
#[tokio::test]
async fn some_objects_over_a_real_line_of_9600_baud() {
    let (handle, _far) = paced(false);
    let mut client = Client::of(&handle, 1);
    // The first exchange finds out where the status stands.
    client.object(1007).await;
    let ratio = ratio(&mut client, &[0x0191, 0x1259, 201, 1006]).await;
    assert!((1.0..=1.15).contains(&ratio), "{ratio}");
}
