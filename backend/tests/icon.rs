//! Files, identity and counters of an ICON3000, over every kind of line, and from the simulated
//! one through a page.

mod common;

use axum::extract::ws::Utf8Bytes;
use backend::bus::board::Board;
use backend::bus::recorder::Recorder;
use backend::bus::{self, ClientId, Command, Outlet, Plug};
use backend::clock::Clock;
use backend::config::{BusConfig, Config, DeviceConfig, LISTEN, LineConfig, Mode};
use backend::plant::Plant;
use backend::sim::{Actuators, Pace, serve_rtu};
use backend::snapshot::{Taken, take, which};
use common::{Page, WAIT, serve};
use shared::decode::pdu_of;
use shared::device::Device;
use shared::encode::frame;
use shared::frame::Framing;
use shared::icon3000::snapshot::{Snapshot, diff, parse};
use shared::map::row::Model;
use shared::proto::{IconAsk, IconNews, IconStep, Outcome, ToBackend};
use shared::render::hex;
use std::time::Duration;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};
use tokio::time::timeout;
use tokio_serial::{SerialPort, SerialStream};

const UNIT: u8 = 1;

/// What the devices of these tests answer, by hand from the layouts that the manual prints.
///
/// FC 17: table 28 of VCIOM-16345-EN, its count of 82 bytes with the 84 that follow. FC 20:
/// Modbus V1.1b3, section 6.14. FC 08: table 21.
fn answer(pdu: &[u8]) -> Vec<u8> {
    match pdu {
        [17] => {
            let mut report = vec![17, 0x52, 0, 0];
            report.extend(b"Biffi ICON3000  ");
            report.extend(b"SN-0042                     ");
            report.extend(b"XV-1                        ");
            report.extend(b"0400  0403");
            assert_eq!(report.len(), 86);
            report
        }
        // Two groups at once are refused, as some devices do; one by one they are answered.
        [20, 14, ..] => vec![0x94, 3],
        [20, 7, 6, f0, f1, 0, start, 0, 2] => {
            vec![20, 6, 5, 6, *f0, *f1, 0, *start]
        }
        [8, 0, sub, 0, 0] => vec![8, 0, *sub, 0x12, 0x34],
        [function, ..] => vec![function | 0x80, 1],
        [] => vec![],
    }
}

/// Answers requests of any framing until the line is closed.
async fn device(
    mut line: impl AsyncRead + AsyncWrite + Unpin,
    framing: Framing,
    answer: fn(&[u8]) -> Vec<u8>,
) {
    let mut heard = Vec::new();
    let mut bytes = [0; 300];
    while let Ok(count @ 1..) = line.read(&mut bytes).await {
        heard.extend_from_slice(&bytes[..count]);
        let Some(pdu) = pdu_of(&heard, framing).filter(|p| !p.is_empty()) else {
            continue;
        };
        let whole = |transaction| frame(framing, transaction, UNIT, &pdu) == heard;
        let transaction = match framing {
            Framing::Tcp => u16::from_be_bytes([heard[0], heard[1]]),
            _ => 0,
        };
        if whole(transaction) {
            heard.clear();
            let response = frame(framing, transaction, UNIT, &answer(&pdu));
            line.write_all(&response).await.unwrap();
        }
    }
}

fn config(line: LineConfig) -> Config {
    Config {
        listen: LISTEN,
        hosts: Vec::new(),
        buses: vec![BusConfig {
            name: "a".into(),
            line,
            timeout: Duration::from_millis(500),
            retries: 1,
            turnaround: Duration::ZERO,
        }],
        devices: vec![DeviceConfig::simple("XV-1", Device::Icon3000v2, UNIT)],
    }
}

/// Reads steps; gives the exchanges as step, request, response and outcome.
async fn read(plant: &Plant, steps: Vec<IconStep>) -> Vec<(u32, String, String, Outcome)> {
    let (sender, mut news) = mpsc::channel::<Utf8Bytes>(Outlet::SIZE);
    let (bus, device) = plant.device("XV-1").unwrap();
    let ask = IconAsk::Read {
        id: 1,
        device: "XV-1".into(),
        steps,
    };
    let command = Command::Icon {
        client: ClientId(1),
        device,
        ask,
        out: Outlet::new(sender),
    };
    assert!(bus.ask(command).await);
    let mut exchanges = Vec::new();
    loop {
        let text = timeout(WAIT, news.recv()).await.expect("news").unwrap();
        match IconNews::from_text(&text).unwrap() {
            IconNews::Exchange {
                step,
                request,
                response,
                outcome,
                ..
            } => exchanges.push((step, request, response, outcome)),
            IconNews::Progress { .. } => {}
            IconNews::Done { .. } => return exchanges,
        }
    }
}

async fn all_is_read(plant: &Plant) {
    let file = |file, start| IconStep::File {
        file,
        start,
        count: 2,
    };
    let steps = vec![
        IconStep::Identity,
        file(5300, 0),
        file(1000, 7),
        IconStep::Diagnostic { sub_function: 13 },
    ];
    let read = read(plant, steps).await;
    let expected = [
        (0, "11".to_owned(), hex(&answer(&[17])), Outcome::Ok),
        (
            1,
            "14070614B400000002".into(),
            "1406050614B40000".into(),
            Outcome::Ok,
        ),
        (
            1,
            "14070603E800070002".into(),
            "1406050603E80007".into(),
            Outcome::Ok,
        ),
        (3, "08000D0000".into(), "08000D1234".into(), Outcome::Ok),
    ];
    assert_eq!(read, expected);
}

#[tokio::test(flavor = "multi_thread")]
async fn over_a_serial_port() {
    for (framing, mode) in [(Framing::Rtu, "8E1"), (Framing::Ascii, "7E1")] {
        let (far, near) = SerialStream::pair().unwrap();
        let port = near.name().unwrap();
        // Kept open, so that the line is there before and after the backend opens it.
        let _near = near;
        tokio::spawn(device(far, framing, answer));
        let line = LineConfig::Serial {
            framing,
            port,
            baud: 38_400,
            mode: Mode::parse(mode).unwrap(),
        };
        all_is_read(&Plant::start(&config(line))).await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn over_tcp() {
    for framing in [Framing::Tcp, Framing::Rtu] {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let host = listener.local_addr().unwrap().to_string();
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                tokio::spawn(device(stream, framing, answer));
            }
        });
        let line = match framing {
            Framing::Tcp => LineConfig::Tcp { host },
            _ => LineConfig::RtuOverTcp { host },
        };
        all_is_read(&Plant::start(&config(line))).await;
    }
}

/// The simulated plant, through the socket of a page.
#[tokio::test(flavor = "multi_thread")]
async fn through_a_page() {
    let address = serve(&Config::simulated()).await;
    let (mut page, _) = Page::greet(address).await;
    let ask = |device: &str, steps: Vec<IconStep>| {
        ToBackend::Icon(IconAsk::Read {
            id: 3,
            device: device.into(),
            steps,
        })
    };
    let counter = IconStep::Diagnostic { sub_function: 11 };
    let file = IconStep::File {
        file: 2,
        start: 0,
        count: 1,
    };
    let steps = vec![IconStep::Identity, counter, file];
    page.say(&ask("XV-101", steps)).await;
    let mut read = Vec::new();
    loop {
        match page.icon_news().await {
            IconNews::Exchange {
                outcome, response, ..
            } => {
                assert_eq!(outcome, Outcome::Ok, "{response}");
                read.push(response);
            }
            IconNews::Done { ok, failed, .. } => {
                assert_eq!((ok, failed), (3, 0));
                break;
            }
            IconNews::Progress { .. } => {}
        }
    }
    assert!(read[0].starts_with("1152"), "{}", read[0]);
    assert!(read[1].starts_with("08000B"), "{}", read[1]);
    assert!(read[2].starts_with("14040306"), "{}", read[2]);

    for (tag, words) in [("MX-301", "no ICON3000"), ("XV-9", "There is no device")] {
        page.say(&ask(tag, vec![IconStep::Identity])).await;
        let IconNews::Exchange { outcome, text, .. } = page.icon_news().await else {
            panic!("an exchange");
        };
        assert_eq!(outcome, Outcome::Refused);
        assert!(text.contains(words), "{text}");
        assert!(matches!(page.icon_news().await, IconNews::Done { .. }));
    }
    page.say(&ask("XV-101", vec![IconStep::Identity; 257]))
        .await;
    let IconNews::Exchange { text, .. } = page.icon_news().await else {
        panic!("an exchange");
    };
    assert!(text.contains("at most 256"), "{text}");
}

/// A device on a line of 9600 8E1 whose time is simulated.
fn slow(device: Device) -> bus::Handle {
    let devices = [DeviceConfig::simple("XV-1", device, UNIT)];
    let clock = Clock::start();
    let actuators = Actuators::new(&devices, clock);
    let plug = Plug::Stream(Box::new(move || {
        let (near, far) = tokio::io::duplex(4096);
        let actuators = actuators.clone();
        tokio::spawn(async move { serve_rtu(far, &actuators, Pace::of(9600)).await });
        Ok(Box::new(near))
    }));
    plugged(&devices, plug, clock)
}

/// Devices behind a plug.
fn plugged(devices: &[DeviceConfig], plug: Plug, clock: Clock) -> bus::Handle {
    let line = LineConfig::Serial {
        framing: Framing::Rtu,
        port: "simulated".into(),
        baud: 9600,
        mode: Mode::parse("8E1").unwrap(),
    };
    let activity = watch::Sender::new(0);
    let bus = config(line).buses.remove(0);
    let board = Board::new(activity.clone());
    let recorder = Recorder::new("a", clock, activity);
    bus::start(bus, devices, plug, clock, board, recorder)
}

/// All of it.
async fn whole(device: Device, model: Model) -> (Taken, Duration) {
    let handle = slow(device);
    let began = tokio::time::Instant::now();
    let empty = Snapshot::new(model, UNIT, "XV-1");
    let taken = take(&handle, 0, empty, |_, _, _| {}).await.unwrap();
    (taken, began.elapsed())
}

/// Every character of the exchanges, and the silences that the standard demands, by hand from the
/// number of bytes: 11 bits a character, 3.5 characters after each frame.
#[tokio::test(start_paused = true)]
async fn a_snapshot_takes_little_more_than_the_wire() {
    for (device, model) in [
        (Device::Icon3000v2, Model::Icon3000v2),
        (Device::Icon3000, Model::Icon3000),
        (Device::Icon2000v4, Model::Icon2000v4),
    ] {
        let (Taken { snapshot, wire }, took) = whole(device, model).await;
        let bytes = f64::from(wire.request_bytes + wire.response_bytes);
        let frames = f64::from(wire.exchanges * 2);
        let ideal = (bytes + 3.5 * frames) * 11.0 / 9600.0;
        let ratio = took.as_secs_f64() / ideal;
        println!(
            "{device:?}: {} exchanges, {:.1} s, the wire alone {ideal:.1} s, {:.1} %",
            wire.exchanges,
            took.as_secs_f64(),
            100.0 * ratio
        );
        assert!((1.0..=1.1).contains(&ratio), "{ratio}");
        assert!(snapshot.failures.is_empty(), "{:?}", snapshot.failures);
        assert!(snapshot.identity.is_some());
        assert_eq!(snapshot.files.is_empty(), model != Model::Icon3000v2);
        // What is written is read back the same, and the same is no change.
        let (back, problems) = parse(snapshot.to_text().as_bytes());
        assert!(problems.is_empty(), "{problems:?}");
        let back = back.unwrap();
        assert!(diff(&snapshot, &back).is_empty());
        assert_eq!(back.to_text(), snapshot.to_text());
    }
}

/// The device itself tells which model it is, whatever it is taken for.
#[tokio::test(start_paused = true)]
async fn a_device_tells_its_model() {
    for (device, model) in [
        (Device::Icon3000v2, Model::Icon3000v2),
        (Device::Icon3000, Model::Icon3000),
        (Device::Icon2000v4, Model::Icon2000v4),
    ] {
        let guess = which(&slow(device), 0).await.unwrap();
        assert_eq!(guess.model, Some(model), "{}", guess.why);
    }
}

/// A device without function 17 that has trouble with HR 3480 (exception 04): the software in HR 3072
/// and 3073 tells (reading E84: 4.00 or later is an ICON3000v2).
fn silent_of_itself(pdu: &[u8], software: &[u8; 4]) -> Vec<u8> {
    match pdu {
        // HR 3480.
        [3, 0x0D, 0x98, 0, 1] => vec![0x83, 4],
        [3, 0, 22, 0, 1] => vec![3, 2, 0, 0],
        // HR 3072.
        [3, 0x0C, 0, 0, 2] => [&[3, 4], &software[..]].concat(),
        [function, ..] => vec![function | 0x80, 1],
        [] => vec![],
    }
}

#[tokio::test(start_paused = true)]
async fn the_register_of_the_software_is_asked_too() {
    let old: fn(&[u8]) -> Vec<u8> = |pdu| silent_of_itself(pdu, b"2.03");
    let new: fn(&[u8]) -> Vec<u8> = |pdu| silent_of_itself(pdu, b"4.01");
    for (answer, model, software) in [
        (old, Model::Icon3000, "2.03"),
        (new, Model::Icon3000v2, "4.01"),
    ] {
        let plug = Plug::Stream(Box::new(move || {
            let (near, far) = tokio::io::duplex(4096);
            tokio::spawn(device(far, Framing::Rtu, answer));
            Ok(Box::new(near))
        }));
        let devices = [DeviceConfig::simple("XV-1", Device::Icon3000v2, UNIT)];
        let guess = which(&plugged(&devices, plug, Clock::start()), 0)
            .await
            .unwrap();
        assert_eq!(guess.model, Some(model), "{}", guess.why);
        assert!(guess.why.contains(software), "{}", guess.why);
    }
}
