//! HART-IP against a gateway written here byte by byte, with the frames of published captures.

use backend::bus::gate::Gate;
use backend::bus::hart::{Exchange, Fault, Gateway, IpLine};
use backend::bus::recorder::Recorder;
use backend::clock::Clock;
use shared::hart::frame::Address;
use shared::hart::link::{Failure, Identity, Request};
use std::io;
use std::net::SocketAddr;
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::sync::{mpsc, watch};
use tokio::time::{advance, pause, resume, timeout};

/// Command 0 of a gateway: readings/hart.md, P1 and P4.
const P1: &str = "02 80 00 00 82";
const P4: &str =
    "06 80 00 18 00 50 FE 26 4E 05 07 05 02 0E 0C 0B 6F E4 05 04 00 02 00 00 26 00 26 84 58";
/// Command 20 of the same gateway: P5 and P6.
const P5: &str = "82 A6 4E 0B 6F E4 14 00 FE";
const P6: &str = "86 A6 4E 0B 6F E4 14 22 00 50 77 69 68 61 72 74 67 77 \
                  00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 89";

fn bytes(hex: &str) -> Vec<u8> {
    hex.split_whitespace()
        .map(|b| u8::from_str_radix(b, 16).unwrap())
        .collect()
}

/// A message of the gateway: type, id, status, sequence number, body.
fn message(kind: u8, id: u8, status: u8, sequence: [u8; 2], body: &[u8]) -> Vec<u8> {
    let mut message = vec![
        1,
        kind,
        id,
        status,
        sequence[0],
        sequence[1],
        0,
        8 + body.len() as u8,
    ];
    message.extend_from_slice(body);
    message
}

async fn take(stream: &mut TcpStream) -> io::Result<Vec<u8>> {
    let mut message = vec![0; 8];
    stream.read_exact(&mut message).await?;
    let mut body = vec![0; usize::from(message[7]) - 8];
    stream.read_exact(&mut body).await?;
    message.extend(body);
    Ok(message)
}

/// What a gateway answers to a frame; each of the messages is sent.
type Answers = fn(usize, &[u8], [u8; 2]) -> Vec<Vec<u8>>;

/// A gateway that opens sessions with this status and answers frames like this. Gives its address,
/// and what it was told.
async fn gateway(status: u8, answers: Answers) -> (SocketAddr, mpsc::UnboundedReceiver<Vec<u8>>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (sender, told) = mpsc::unbounded_channel();
    tokio::spawn(async move {
        let mut count = 0;
        loop {
            let (mut stream, _) = listener.accept().await.unwrap();
            while let Ok(heard) = take(&mut stream).await {
                sender.send(heard.clone()).unwrap();
                let sequence = [heard[4], heard[5]];
                let out = match heard[2] {
                    3 => {
                        count += 1;
                        answers(count, &heard[8..], sequence)
                    }
                    id => vec![message(1, id, status, sequence, &heard[8..])],
                };
                for message in out {
                    stream.write_all(&message).await.unwrap();
                }
            }
        }
    });
    (address, told)
}

async fn open(address: SocketAddr, udp: bool, retries: u8) -> io::Result<IpLine> {
    let clock = Clock::start();
    let recorder = Recorder::new("g", clock, watch::Sender::new(0));
    let gateway = Gateway {
        host: &address.to_string(),
        udp,
        primary: true,
        timeout: Duration::from_millis(300),
        retries,
    };
    IpLine::open(gateway, Gate::hart(), recorder, clock).await
}

fn published(_: usize, frame: &[u8], sequence: [u8; 2]) -> Vec<Vec<u8>> {
    let reply = match frame {
        f if f == bytes(P1) => P4,
        f if f == bytes(P5) => P6,
        other => panic!("{other:02X?}"),
    };
    vec![message(1, 3, 0, sequence, &bytes(reply))]
}

fn poll_0() -> Request {
    Request::new(Address::Short(0), 0, &[])
}

fn fault(exchange: &Exchange) -> &Fault {
    exchange.outcome.as_ref().unwrap_err()
}

/// The bytes of a session by hand: initiate as primary master with a minute, two token-passing PDUs
/// without preambles, keep alive, close.
#[tokio::test]
async fn a_session_has_the_bytes_of_the_standard() {
    let (address, mut told) = gateway(0, published).await;
    let mut line = open(address, false, 0).await.unwrap();
    let exchange = line.exchange(&poll_0()).await.unwrap();
    let identity = Identity::of(&exchange.outcome.unwrap()).unwrap();
    assert_eq!(identity.address, Address::Long(0x264E, 0x0B_6FE4));
    assert_eq!((identity.preambles, identity.revision), (5, 7));
    let exchange = line.exchange(&identity.request(20, &[])).await.unwrap();
    let answer = exchange.outcome.unwrap();
    assert_eq!(&answer.data()[..9], b"wihartgw\0");
    assert_eq!((answer.code(), answer.device_status()), (Some(0), 0x50));
    pause();
    advance(Duration::from_secs(21)).await;
    resume();
    line.tend().await.unwrap();
    line.close().await;
    drop(line);
    let mut all = Vec::new();
    while let Ok(Some(heard)) = timeout(Duration::from_millis(200), told.recv()).await {
        all.push(heard);
    }
    let by_hand = [
        "01 00 00 00 00 01 00 0D 01 00 00 EA 60".to_owned(),
        format!("01 00 03 00 00 02 00 0D {P1}"),
        format!("01 00 03 00 00 03 00 11 {P5}"),
        "01 00 02 00 00 04 00 08".to_owned(),
        "01 00 01 00 00 05 00 08".to_owned(),
    ];
    assert_eq!(all, by_hand.map(|m| bytes(&m)));
}

#[tokio::test]
async fn a_gateway_that_is_full_says_so() {
    let (address, _told) = gateway(15, published).await;
    let error = open(address, false, 0).await.unwrap_err();
    assert!(error.to_string().contains("status 15"), "{error}");
    // A warning is none.
    let (address, _told) = gateway(30, published).await;
    assert!(open(address, false, 0).await.is_ok());
}

/// Late answers, bursts of devices, an answer of somebody else before ours.
#[tokio::test]
async fn the_sequence_number_says_what_answers_what() {
    let (address, _told) = gateway(0, |count, frame, sequence| {
        let reply = bytes(P4);
        let good = message(1, 3, 0, sequence, &reply);
        let burst = message(
            2,
            3,
            0,
            [0x77, 0x77],
            &bytes("81 A6 4E 0B 6F E4 01 02 00 00 28"),
        );
        let mut other = reply.clone();
        // Another device id, and the check byte that goes with it.
        other[17] ^= 0xFF;
        other[28] ^= 0xFF;
        let foreign = message(1, 3, 0, [sequence[0], sequence[1].wrapping_sub(1)], &other);
        match count {
            // The first is not answered in time; its answer comes before that to the second.
            1 => Vec::new(),
            _ if frame == bytes(P1) => vec![burst, foreign, good],
            _ => vec![good],
        }
    })
    .await;
    let mut line = open(address, false, 1).await.unwrap();
    let exchange = line.exchange(&poll_0()).await.unwrap();
    assert_eq!(exchange.tries, 2);
    let identity = Identity::of(&exchange.outcome.unwrap()).unwrap();
    assert_eq!(identity.device_id, 0x0B_6FE4);
    let stats = line.stats();
    assert_eq!(
        (stats.bursts, stats.strays, stats.silent, stats.retried),
        (1, 1, 1, 1)
    );
    // And a message whose frame answers something else is no answer.
    let exchange = line.exchange(&identity.request(20, &[])).await.unwrap();
    assert_eq!(fault(&exchange), &Fault::Link(Failure::Damaged));
}

#[tokio::test]
async fn refusals_of_the_gateway_are_said() {
    // Status of the header, a NAK, and 84h as servers send it when a device does not answer (P29).
    let (address, _told) = gateway(0, |count, _, sequence| match count {
        1 => vec![message(1, 3, 6, sequence, &[])],
        2 => vec![message(15, 3, 2, sequence, &[])],
        _ => vec![message(1, 3, 0, sequence, &bytes("06 80 00 02 84 00 00"))],
    })
    .await;
    let mut line = open(address, false, 0).await.unwrap();
    for words in ["status 6", "status 2"] {
        let exchange = line.exchange(&poll_0()).await.unwrap();
        match fault(&exchange) {
            Fault::Gateway(text) => assert!(text.contains(words), "{text}"),
            other => panic!("{other:?}"),
        }
    }
    let exchange = line.exchange(&poll_0()).await.unwrap();
    assert_eq!(fault(&exchange), &Fault::Link(Failure::Communication(0x84)));
}

#[tokio::test]
async fn a_connection_that_ends_is_an_error_of_the_line() {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        let (mut stream, _) = listener.accept().await.unwrap();
        let heard = take(&mut stream).await.unwrap();
        let answer = message(1, 0, 0, [heard[4], heard[5]], &heard[8..]);
        stream.write_all(&answer).await.unwrap();
        take(&mut stream).await.unwrap();
    });
    let mut line = open(address, false, 0).await.unwrap();
    assert!(line.exchange(&poll_0()).await.is_err());
    // Something that is no HART-IP server.
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    tokio::spawn(async move {
        let (mut stream, _) = listener.accept().await.unwrap();
        stream
            .write_all(b"220 mail.example ready\r\n")
            .await
            .unwrap();
        let _end = take(&mut stream).await;
    });
    let error = open(address, false, 0).await.unwrap_err();
    assert!(error.to_string().contains("HART-IP"), "{error}");
}

/// Over UDP the first datagram of each kind is lost; a damaged one is none.
#[tokio::test]
async fn lost_datagrams_are_sent_again() {
    let socket = UdpSocket::bind("127.0.0.1:0").await.unwrap();
    let address = socket.local_addr().unwrap();
    tokio::spawn(async move {
        let mut seen = [0; 6];
        loop {
            let mut heard = [0; 300];
            let (count, from) = socket.recv_from(&mut heard).await.unwrap();
            let (id, sequence) = (heard[2], [heard[4], heard[5]]);
            seen[usize::from(id)] += 1;
            if seen[usize::from(id)] == 1 {
                continue;
            }
            let out = match id {
                3 => published(0, &heard[8..count], sequence).remove(0),
                id => message(1, id, 0, sequence, &heard[8..count]),
            };
            socket.send_to(&out[..5], from).await.unwrap();
            socket.send_to(&out, from).await.unwrap();
        }
    });
    let mut line = open(address, true, 2).await.unwrap();
    let exchange = line.exchange(&poll_0()).await.unwrap();
    assert_eq!(exchange.tries, 2);
    assert!(exchange.outcome.is_ok());
}

/// Nothing but reads gets out, whoever asks.
#[tokio::test]
async fn a_write_does_not_reach_the_gateway() {
    let (address, mut told) = gateway(0, published).await;
    let mut line = open(address, false, 0).await.unwrap();
    told.recv().await.unwrap();
    let device = Address::Long(0x2EDD, 0x01_2345);
    for (number, data) in [
        (132, vec![0x22]),
        (48, vec![0; 9]),
        (6, vec![0, 0]),
        (524, vec![8, 2, 0]),
    ] {
        let error = line
            .exchange(&Request::new(device, number, &data))
            .await
            .unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::PermissionDenied);
        assert!(error.to_string().contains(&number.to_string()), "{error}");
    }
    line.exchange(&poll_0()).await.unwrap().outcome.unwrap();
    let next = told.recv().await.unwrap();
    assert_eq!(&next[8..], bytes(P1));
}
