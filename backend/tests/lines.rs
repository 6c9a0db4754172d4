//! Lines that are really there: pseudo terminals and loopback TCP.

mod common;

use backend::bus::Handle;
use backend::clock::Clock;
use backend::config::{BusConfig, Config, DeviceConfig, LISTEN, LineConfig, Mode};
use backend::plant::Plant;
use backend::sim::{Actuators, Pace, serve_rtu, serve_tcp};
use shared::address::{Address, Table};
use shared::decode::pdu_of;
use shared::device::Device;
use shared::encode::{Read, frame};
use shared::frame::Framing;
use shared::proto::{Outcome, ToPage};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{sleep, timeout};
use tokio_serial::{SerialPort, SerialStream};

fn config(line: LineConfig, timeout: Duration) -> Config {
    Config {
        listen: LISTEN,
        hosts: Vec::new(),
        buses: vec![BusConfig {
            name: "a".into(),
            line,
            timeout,
            retries: 1,
            turnaround: Duration::ZERO,
        }],
        devices: vec![device(1)],
    }
}

fn device(unit: u8) -> DeviceConfig {
    DeviceConfig {
        tag: "XV-1".into(),
        device: Device::Icon3000v2,
        bus: 0,
        unit,
        description: String::new(),
        faults: Vec::new(),
        profile: None,
        target: None,
    }
}

fn serial(framing: Framing, port: &str, baud: u32, mode: &str) -> LineConfig {
    LineConfig::Serial {
        framing,
        port: port.into(),
        baud,
        mode: Mode::parse(mode).unwrap(),
    }
}

fn read(start: u16, count: u16) -> Read {
    Read::new(Table::Holding, Address::new(start), count).unwrap()
}

fn bus(plant: &Plant) -> Handle {
    plant.bus("a").unwrap().clone()
}

/// A pseudo terminal: the end of the device, its other end kept open, and the path of that.
fn pty() -> (SerialStream, SerialStream, String) {
    let (device, line) = SerialStream::pair().unwrap();
    let path = line.name().unwrap();
    (device, line, path)
}

/// Reads until it goes well.
async fn until_ok(handle: &Handle) -> Duration {
    let began = Instant::now();
    let tries = async {
        while handle.read(0, read(3000, 1)).await.outcome != Outcome::Ok {
            sleep(Duration::from_millis(5)).await;
        }
    };
    timeout(Duration::from_secs(20), tries)
        .await
        .expect("a good read");
    began.elapsed()
}

/// What the line says of itself.
fn line_text(plant: &Plant) -> String {
    let (news, _) = plant.board().news(0);
    let texts = news
        .iter()
        .filter_map(|text| match serde_json::from_str(text) {
            Ok(ToPage::Line { text, .. }) => Some(text),
            _ => None,
        });
    texts.last().unwrap_or_default()
}

#[tokio::test]
async fn rtu_over_a_serial_port() {
    for mode in ["8N1", "8N2"] {
        let (device_end, _line, path) = pty();
        let actuators = Actuators::new([&device(1)], Clock::start());
        tokio::spawn(async move {
            serve_rtu(device_end, &actuators, Pace::real(Duration::from_millis(4))).await
        });
        let line = serial(Framing::Rtu, &path, 38_400, mode);
        let plant = Plant::start(&config(line, Duration::from_millis(500)));
        let handle = bus(&plant);
        let report = handle.read(0, read(44, 2)).await;
        assert_eq!(
            report.pdu.as_deref(),
            Some(&[3, 4, 0x90, 0, 0, 1][..]),
            "{}",
            report.text
        );
        let report = handle.read(0, read(3000, 125)).await;
        assert_eq!(report.pdu.map(|p| p.len()), Some(252));
        let report = handle.read(0, read(3980, 10)).await;
        assert_eq!(report.outcome, Outcome::Exception);
        assert!(report.text.contains("02"), "{}", report.text);
    }
}

/// A device of our own that speaks ASCII, because the simulated one does not.
#[tokio::test]
async fn ascii_over_a_serial_port() {
    let (mut device_end, _line, path) = pty();
    tokio::spawn(async move {
        let mut heard = Vec::new();
        loop {
            let mut bytes = [0; 64];
            let Ok(count) = device_end.read(&mut bytes).await else {
                return;
            };
            heard.extend_from_slice(&bytes[..count]);
            if !heard.ends_with(b"\r\n") {
                continue;
            }
            assert_eq!(pdu_of(&heard, Framing::Ascii).unwrap(), [3, 0, 7, 0, 2]);
            heard.clear();
            let answer = frame(Framing::Ascii, 0, 1, &[3, 4, 1, 2, 3, 4]);
            // As a real port hands it over: in pieces.
            for piece in answer.chunks(5) {
                device_end.write_all(piece).await.unwrap();
                sleep(Duration::from_millis(3)).await;
            }
        }
    });
    let line = serial(Framing::Ascii, &path, 9600, "7E1");
    let plant = Plant::start(&config(line, Duration::from_millis(500)));
    let report = bus(&plant).read(0, read(7, 2)).await;
    assert_eq!(
        report.pdu.as_deref(),
        Some(&[3, 4, 1, 2, 3, 4][..]),
        "{}",
        report.text
    );
}

/// The silence before each request is never shorter than 3.5 characters, and little longer.
#[tokio::test]
async fn the_line_is_silent_before_each_request() {
    for (baud, least) in [(9600, 4010), (38_400, 1750)] {
        let (mut device_end, _line, path) = pty();
        let (gaps, mut measured) = tokio::sync::mpsc::unbounded_channel();
        tokio::spawn(async move {
            let mut answered: Option<Instant> = None;
            loop {
                let mut bytes = [0; 64];
                let Ok(count) = device_end.read(&mut bytes).await else {
                    return;
                };
                if let Some(at) = answered {
                    gaps.send(at.elapsed()).unwrap();
                }
                assert_eq!(count, 8);
                // Not before the request could have passed on a real line.
                sleep(Duration::from_millis(10)).await;
                let answer = frame(Framing::Rtu, 0, 1, &[3, 2, 0, 7]);
                device_end.write_all(&answer).await.unwrap();
                answered = Some(Instant::now());
            }
        });
        let line = serial(Framing::Rtu, &path, baud, "8N1");
        let plant = Plant::start(&config(line, Duration::from_millis(500)));
        let handle = bus(&plant);
        for _ in 0..200 {
            assert_eq!(handle.read(0, read(0, 1)).await.outcome, Outcome::Ok);
        }
        let mut gaps = Vec::new();
        while let Ok(gap) = measured.try_recv() {
            gaps.push(gap);
        }
        gaps.sort_unstable();
        let (first, middle) = (gaps[0], gaps[gaps.len() / 2]);
        let late = gaps[gaps.len() * 99 / 100];
        println!("{baud} baud: gaps from {first:?}, median {middle:?}, 99 of 100 below {late:?}");
        // The device's own clock starts a little after its last byte left.
        assert!(first >= Duration::from_micros(least - 200), "{first:?}");
    }
}

/// A port that is pulled out is noticed, said, and found again when it is back.
#[tokio::test]
async fn unplugged_and_plugged_in_again() {
    let directory = std::env::temp_dir().join(format!("valvescope-{}", std::process::id()));
    std::fs::create_dir_all(&directory).unwrap();
    let link = directory.join("ttyUSB0");
    let line = serial(Framing::Rtu, link.to_str().unwrap(), 38_400, "8N1");
    let plant = Plant::start(&config(line, Duration::from_millis(200)));
    let handle = bus(&plant);
    let files = || std::fs::read_dir("/proc/self/fd").unwrap().count();
    let mut before = 0;
    for round in 0..5 {
        let report = handle.read(0, read(3000, 1)).await;
        assert_eq!(report.outcome, Outcome::Down, "{round}");
        assert!(
            line_text(&plant).contains("ttyUSB0"),
            "{}",
            line_text(&plant)
        );
        let (device_end, kept, path) = pty();
        let _old = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(&path, &link).unwrap();
        let actuators = Actuators::new([&device(1)], Clock::start());
        let device = tokio::spawn(async move {
            serve_rtu(device_end, &actuators, Pace::real(Duration::from_millis(4))).await
        });
        let took = until_ok(&handle).await;
        println!("round {round}: good read {took:?} after it was plugged in");
        // The longest pause between attempts is five seconds; here it never gets that long.
        assert!(took < Duration::from_secs(3), "{took:?}");
        device.abort();
        let _aborted = device.await;
        drop(kept);
        std::fs::remove_file(&link).unwrap();
        // Noticed without being asked.
        let noticed = async {
            while line_text(&plant) == "open" {
                sleep(Duration::from_millis(1)).await;
            }
        };
        timeout(Duration::from_secs(2), noticed).await.unwrap();
        match round {
            0 => before = files(),
            _ => assert!(files() <= before + 2, "descriptors are given back"),
        }
    }
    std::fs::remove_dir_all(&directory).unwrap();
}

#[tokio::test]
async fn modbus_tcp_with_a_device_that_is_sound() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let host = listener.local_addr().unwrap().to_string();
    let actuators = Actuators::new([&device(1)], Clock::start());
    tokio::spawn(serve_tcp(listener, actuators));
    let plant = Plant::start(&config(
        LineConfig::Tcp { host },
        Duration::from_millis(500),
    ));
    let handle = bus(&plant);
    let report = handle.read(0, read(44, 2)).await;
    assert_eq!(
        report.pdu.as_deref(),
        Some(&[3, 4, 0x90, 0, 0, 1][..]),
        "{}",
        report.text
    );
    for table in Table::ALL {
        let report = handle
            .read(0, Read::new(table, Address::new(0), 9).unwrap())
            .await;
        let expected = if table.is_bits() { 4 } else { 20 };
        assert_eq!(
            report.pdu.map(|p| p.len()),
            Some(expected),
            "{}",
            report.text
        );
    }
    let report = handle.read(0, read(4000, 1)).await;
    assert_eq!(report.outcome, Outcome::Exception);
}

/// Answers on TCP that are late, mad or cut do not end the program and are taken by nobody.
#[tokio::test]
async fn modbus_tcp_with_a_device_that_is_not() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let host = listener.local_addr().unwrap().to_string();
    let turn = Arc::new(AtomicUsize::new(0));
    tokio::spawn(async move {
        loop {
            let (mut stream, _) = listener.accept().await.unwrap();
            let turn = Arc::clone(&turn);
            tokio::spawn(async move {
                let mut request = [0; 12];
                while stream.read_exact(&mut request).await.is_ok() {
                    let number = turn.fetch_add(1, Ordering::Relaxed);
                    let transaction = u16::from_be_bytes([request[0], request[1]]);
                    let good = [3, 2, request[8], request[9]];
                    let sound = frame(Framing::Tcp, transaction, 1, &good);
                    let bytes = match number % 10 {
                        // Counts that lie: tokio-modbus would index by them.
                        1 => frame(Framing::Tcp, transaction, 1, &[3, 250, 1, 2]),
                        2 => frame(Framing::Tcp, transaction, 1, &[1, 9, 1]),
                        3 => frame(Framing::Tcp, transaction.wrapping_add(1), 1, &good),
                        4 => frame(Framing::Tcp, transaction, 1, &[3, 4, 1, 2, 3, 4]),
                        5 => b"HTTP/1.1 400 Bad Request\r\n\r\n".to_vec(),
                        6 => frame(Framing::Tcp, transaction, 2, &good),
                        7 => {
                            sleep(Duration::from_millis(150)).await;
                            sound
                        }
                        8 => sound[..8].to_vec(),
                        9 => return,
                        _ => sound,
                    };
                    if stream.write_all(&bytes).await.is_err() {
                        return;
                    }
                }
            });
        }
    });
    let plant = Plant::start(&config(LineConfig::Tcp { host }, Duration::from_millis(50)));
    let handle = bus(&plant);
    let mut good = 0;
    for address in 0..100 {
        let report = handle.read(0, read(address, 1)).await;
        match report.outcome {
            Outcome::Ok => {
                let [high, low] = address.to_be_bytes();
                assert_eq!(report.pdu.as_deref(), Some(&[3, 2, high, low][..]));
                good += 1;
            }
            Outcome::Silence | Outcome::Damaged => assert!(!report.text.is_empty()),
            other => panic!("{other:?}: {}", report.text),
        }
    }
    assert!(good >= 15, "{good}");
}

#[tokio::test]
async fn rtu_over_tcp() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let host = listener.local_addr().unwrap().to_string();
    let actuators = Actuators::new([&device(1)], Clock::start());
    tokio::spawn(async move {
        let (stream, _) = listener.accept().await.unwrap();
        serve_rtu(stream, &actuators, Pace::real(Duration::from_millis(4))).await
    });
    let plant = Plant::start(&config(
        LineConfig::RtuOverTcp { host },
        Duration::from_millis(500),
    ));
    let report = bus(&plant).read(0, read(44, 2)).await;
    assert_eq!(
        report.pdu.as_deref(),
        Some(&[3, 4, 0x90, 0, 0, 1][..]),
        "{}",
        report.text
    );
}

#[tokio::test]
async fn a_host_that_is_not_there_is_said() {
    // A port that was free a moment ago.
    let host = TcpListener::bind("127.0.0.1:0")
        .await
        .unwrap()
        .local_addr()
        .unwrap();
    let line = LineConfig::Tcp {
        host: host.to_string(),
    };
    let plant = Plant::start(&config(line, Duration::from_millis(50)));
    let report = bus(&plant).read(0, read(0, 1)).await;
    assert_eq!(report.outcome, Outcome::Down);
    assert!(report.text.contains(&host.to_string()), "{}", report.text);
    assert!(report.text.contains("refuses"), "{}", report.text);
    assert!(TcpStream::connect(host).await.is_err());
}

/// A device that is not there does not keep the line from the others.
#[tokio::test]
async fn a_silent_device_does_not_stop_the_others() {
    let (device_end, _line, path) = pty();
    let actuators = Actuators::new([&device(1)], Clock::start());
    tokio::spawn(async move {
        serve_rtu(device_end, &actuators, Pace::real(Duration::from_millis(4))).await
    });
    let mut config = config(
        serial(Framing::Rtu, &path, 38_400, "8N1"),
        Duration::from_millis(50),
    );
    let mut absent = device(7);
    absent.tag = "XV-7".into();
    config.devices.push(absent);
    let plant = Plant::start(&config);
    let handle = bus(&plant);
    let silent = {
        let handle = handle.clone();
        tokio::spawn(async move { handle.read(1, read(0, 1)).await })
    };
    let mut done = 0;
    while !silent.is_finished() {
        assert_eq!(handle.read(0, read(0, 1)).await.outcome, Outcome::Ok);
        done += 1;
    }
    let report = silent.await.unwrap();
    assert_eq!(report.outcome, Outcome::Silence);
    assert!(report.text.contains("address is 7"), "{}", report.text);
    assert!(done > 5, "{done} reads meanwhile");
}
