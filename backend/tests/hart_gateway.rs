//! HART-IP from end to end: a page's socket, and the command line, through a gateway with simulated
//! actuators behind it, over TCP and UDP. The bytes of the messages are held in `hart_ip.rs`.

mod common;

use backend::config::hart::HartWay;
use backend::config::{Config, DeviceConfig, HartConfig};
use serde_json::Value;
use shared::capture::Micros;
use shared::device::{Device, Family};
use shared::hart::link::Target;
use shared::proto::{HartAsk, HartCommand, HartNews, Outcome, ToBackend, ToPage};
use shared::sim::hart::{HartDevice, HartLine, HartSetup};
use std::net::SocketAddr;
use std::process::Command;
use std::sync::{Arc, Mutex};
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, UdpSocket};

/// A gateway: its line in simulated time, and the frames that it handed on.
#[derive(Clone)]
struct Gateway(Arc<Mutex<(HartLine, Micros)>>, Arc<Mutex<Vec<Vec<u8>>>>);

impl Gateway {
    /// An IQ at polling address 0 and a CVA at 1.
    fn new() -> Self {
        let device = |(tag, family, polling)| {
            let setup = HartSetup {
                polling,
                device_id: 0x01_2345 + u32::from(polling),
                signal: 12.0,
                ..HartSetup::of(family)
            };
            HartDevice::new(tag, setup)
        };
        let devices = [("FV-401", Family::Iq, 0), ("FV-402", Family::Cva, 1)].map(device);
        let line = HartLine::new(1200, devices.into());
        Self(Arc::new(Mutex::new((line, Micros::new(0)))), Arc::default())
    }

    /// What it answers to a message, by the layout of the readings: version, type, id, status,
    /// sequence number, length; token-passing PDUs are frames without preamble.
    fn answer(&self, message: &[u8]) -> Vec<u8> {
        let body = &message[8..];
        let body = match message[2] {
            3 => {
                self.1.lock().unwrap().push(body.to_vec());
                let mut own = self.0.lock().unwrap();
                let now = own.1;
                own.0.push(&[&[0xFF; 5], body].concat(), now);
                own.1 = now.plus(2_000_000);
                let later = own.1;
                let heard = own.0.advance(later);
                heard.into_iter().skip_while(|b| *b == 0xFF).collect()
            }
            _ => body.to_vec(),
        };
        let [high, low] = (8 + body.len() as u16).to_be_bytes();
        let head = [1, 1, message[2], 0, message[4], message[5], high, low];
        [&head[..], &body].concat()
    }

    async fn tcp(&self) -> SocketAddr {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let (address, gateway) = (listener.local_addr().unwrap(), self.clone());
        tokio::spawn(async move {
            loop {
                let (mut stream, _) = listener.accept().await.unwrap();
                let mut head = [0; 8];
                while stream.read_exact(&mut head).await.is_ok() {
                    let len = usize::from(u16::from_be_bytes([head[6], head[7]]));
                    let mut message = head.to_vec();
                    message.resize(len, 0);
                    stream.read_exact(&mut message[8..]).await.unwrap();
                    let answer = gateway.answer(&message);
                    stream.write_all(&answer).await.unwrap();
                }
            }
        });
        address
    }

    async fn udp(&self) -> SocketAddr {
        let socket = UdpSocket::bind("127.0.0.1:0").await.unwrap();
        let (address, gateway) = (socket.local_addr().unwrap(), self.clone());
        tokio::spawn(async move {
            let mut message = [0; 600];
            loop {
                let (count, from) = socket.recv_from(&mut message).await.unwrap();
                let answer = gateway.answer(&message[..count]);
                socket.send_to(&answer, from).await.unwrap();
            }
        });
        address
    }

    async fn serve(&self, udp: bool) -> SocketAddr {
        if udp {
            self.udp().await
        } else {
            self.tcp().await
        }
    }
}

fn config(host: SocketAddr, udp: bool) -> Config {
    let way = HartWay::Ip {
        host: host.to_string(),
        udp,
    };
    let device = |tag: &str, family, target| DeviceConfig {
        tag: tag.into(),
        device: Device::Rotork(family),
        bus: 0,
        unit: 0,
        description: String::new(),
        faults: Vec::new(),
        profile: None,
        target: Some(target),
    };
    Config {
        buses: vec![HartConfig::of(way).bus("gateway")],
        devices: vec![
            device("FV-401", Family::Iq, Target::Polling(0)),
            device("FV-402", Family::Cva, Target::tag("FV-402").unwrap()),
        ],
        ..Config::simulated()
    }
}

fn command(number: u16, data: &str) -> HartCommand {
    HartCommand {
        number,
        data: data.into(),
    }
}

/// A page reads, watches, scans and finds through the gateway, and writes do not reach it.
#[tokio::test]
async fn a_page_reads_through_a_gateway() {
    for udp in [false, true] {
        let gateway = Gateway::new();
        let address = gateway.serve(udp).await;
        let backend = common::serve(&config(address, udp)).await;
        let (mut page, hello) = common::Page::greet(backend).await;
        let ToPage::Hello { buses, devices, .. } = hello else {
            panic!("{hello:?}");
        };
        assert_eq!((buses.len(), devices.len()), (1, 2));
        assert_eq!(
            (buses[0].framing.as_str(), buses[0].simulated),
            ("hart-ip", false)
        );
        let read = |device: &str, commands| {
            ToBackend::Hart(HartAsk::Read {
                id: 7,
                device: device.into(),
                commands,
            })
        };
        // 12 mA and 50 % of an IQ; the CVA is found by its tag and answers with its own address.
        for (tag, address, commands, begins) in [
            (
                "FV-401",
                "AEDD012345",
                vec![command(3, ""), command(523, "0040")],
                ["031A", "1F26"],
            ),
            (
                "FV-402",
                "AEDD012346",
                vec![command(129, "020000"), command(48, "")],
                ["8107", "300B"],
            ),
        ] {
            page.say(&read(tag, commands)).await;
            for begin in begins {
                let news = page.hart().await;
                let HartNews::Exchange {
                    outcome,
                    response,
                    tries,
                    text,
                    ..
                } = news
                else {
                    panic!("{news:?}");
                };
                assert_eq!((outcome, tries), (Outcome::Ok, 1), "{udp} {text}");
                assert!(
                    response.starts_with(&format!("86{address}{begin}")),
                    "{response}"
                );
            }
            let done = page.hart().await;
            let HartNews::Done { id, ok, failed, .. } = done else {
                panic!("{done:?}");
            };
            assert_eq!((id, ok, failed), (7, 2, 0));
        }
        // A watch goes on by itself, and stops.
        let watch = |commands| {
            ToBackend::Hart(HartAsk::Watch {
                device: "FV-401".into(),
                commands,
                period_ms: 100,
            })
        };
        page.say(&watch(vec![command(2, "")])).await;
        for _ in 0..3 {
            let news = page.hart().await;
            // 4140 0000h is 12.0, 4248 0000h is 50.0.
            assert!(
                matches!(&news, HartNews::Exchange { command: 2, response, .. }
                    if response.contains("414000") && response.contains("424800")),
                "{news:?}"
            );
        }
        page.say(&watch(Vec::new())).await;
        let scan = HartAsk::Scan {
            id: 8,
            bus: "gateway".into(),
            first: 0,
            last: 1,
        };
        page.say(&ToBackend::Hart(scan)).await;
        let mut found = Vec::new();
        loop {
            match page.hart().await {
                HartNews::Found { polling, .. } => found.push(polling),
                HartNews::Done { id: 8, ok, .. } => {
                    assert_eq!(ok, 2);
                    break;
                }
                // What the watch had under way.
                HartNews::Exchange { .. } => {}
                other => panic!("{other:?}"),
            }
        }
        assert_eq!(found, [Some(0), Some(1)]);
        let before = gateway.1.lock().unwrap().len();
        page.say(&read("FV-401", vec![command(132, "22")])).await;
        let news = page.hart().await;
        assert!(
            matches!(
                news,
                HartNews::Exchange {
                    outcome: Outcome::Refused,
                    ..
                }
            ),
            "{news:?}"
        );
        assert_eq!(gateway.1.lock().unwrap().len(), before);
    }
}

/// The command line in a process of its own: the lines of JSON, and the exit status.
async fn cli(address: SocketAddr, udp: bool, arguments: &[&str]) -> (Vec<Value>, i32) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_valvescope"));
    let (verb, rest) = arguments.split_first().unwrap();
    program.args(["hart", verb, "--host", &address.to_string()]);
    program.args(["--format", "json"]).args(rest);
    if udp {
        program.arg("--udp");
    }
    let ran = tokio::task::spawn_blocking(move || program.output().unwrap());
    let output = ran.await.unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let lines = text.lines().map(|l| serde_json::from_str(l).unwrap());
    (lines.collect(), output.status.code().unwrap())
}

fn answers(lines: &[Value]) -> Vec<&Value> {
    lines.iter().filter(|l| l["role"] == "response").collect()
}

fn text<'a>(frame: &'a Value, path: &str) -> &'a Value {
    let fields = frame["fields"].as_array().unwrap();
    let found = fields.iter().find(|f| f["path"] == path);
    &found.unwrap_or_else(|| panic!("{path} in {frame}"))["text"]
}

/// `valvescope hart … --host GATEWAY [--udp]`.
#[tokio::test]
async fn the_command_line_reads_through_a_gateway() {
    for udp in [false, true] {
        let gateway = Gateway::new();
        let address = gateway.serve(udp).await;
        let iq = ["--device", "rotork-iq"];
        let read = ["read", "3", "523:0040", "128"];
        let (lines, status) = cli(address, udp, &[&read[..], &iq].concat()).await;
        let found = answers(&lines);
        assert_eq!((status, found.len()), (0, 3), "{udp} {lines:?}");
        assert_eq!(text(found[0], "command.3.loop_current"), "12 mA");
        assert_eq!(text(found[0], "command.3.pv"), "50 %");
        assert_eq!(text(found[1], "command.523.count"), "64");
        assert_eq!(text(found[2], "command.128.version"), "v105+( 0312)");
        // A secondary master unless something else is said; the frame says so too.
        assert_eq!(found[0]["master"], "secondary");
        let (lines, status) = cli(address, udp, &["identify", "--tag", "FV-402"]).await;
        let found = answers(&lines);
        assert_eq!((status, found.len()), (0, 1), "{udp} {lines:?}");
        assert_eq!(found[0]["address"], "2EDD012346");
        let (lines, status) = cli(address, udp, &["scan", "--last", "1"]).await;
        assert_eq!((status, answers(&lines).len()), (0, 2), "{udp} {lines:?}");
    }
    // Nobody there: no answer, and the exit status of a line that is lost.
    let socket = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let nobody = socket.local_addr().unwrap();
    drop(socket);
    let (lines, status) = cli(nobody, false, &["read", "3"]).await;
    assert_eq!((lines.len(), status), (0, 2));
}
