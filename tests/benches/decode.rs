//! Decoding, beside tokio-modbus and rmodbus in the same run. `cargo bench -p tests --bench decode`.
//!
//! What is compared: finding the frames of an RTU stream of requests (36 bytes on average) and
//! proving their CRC. tokio-modbus keeps its codec to itself, so its server reads the stream from
//! memory and answers nothing; rmodbus is asked for the length of each frame and parses it.

use std::future::{Ready, ready};
use std::hint::black_box;
use std::io;
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::task::{Context as Task, Poll};

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use shared::address::{Address, Table};
use shared::decode::{Context, decode_into};
use shared::device::{Device, Family};
use shared::frame::{Frame, Framing, Role, scan_into};
use shared::map::decode::each_value;
use shared::map::row::Model;
use shared::tree::Decoded;
use tests::load::{Load, polls, requests, response};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

const MESSAGES: u64 = 100_000;

/// Frames, CRC and pairs of a stream, ours and the peers'.
fn scanning(c: &mut Criterion) {
    let mut group = c.benchmark_group("scan");
    let load = requests(MESSAGES);
    group.throughput(Throughput::Elements(load.messages));
    let mut index: Vec<Frame> = Vec::new();
    group.bench_function(BenchmarkId::new("valvescope", "requests"), |b| {
        b.iter(|| {
            scan_into(black_box(&load.bytes), Framing::Rtu, &mut index);
            assert_eq!(index.len() as u64, load.messages);
        });
    });
    group.bench_function(BenchmarkId::new("rmodbus", "requests"), |b| {
        b.iter(|| assert_eq!(rmodbus_frames(black_box(&load.bytes)), load.messages));
    });
    let mut peer = TokioModbus::new(&load);
    group.bench_function(BenchmarkId::new("tokio-modbus", "requests"), |b| {
        b.iter(|| assert_eq!(peer.run(), load.messages));
    });

    let load = polls(MESSAGES);
    group.bench_function(BenchmarkId::new("valvescope", "polls"), |b| {
        b.iter(|| {
            scan_into(black_box(&load.bytes), Framing::Rtu, &mut index);
            assert_eq!(index.len() as u64, load.messages);
        });
    });
    group.finish();
}

/// HART: frames, check byte and pairs of a stream, then the tree of each frame. The stream is a
/// master that polls commands 3 and 48 of a Rotork actuator (frames R5, R6, R9 and R10 of the
/// fixtures), so every second frame is an answer.
fn hart(c: &mut Criterion) {
    const POLL: [&[u8]; 4] = [
        &[0x82, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x03, 0x00, 0x95],
        &[
            0x86, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x03, 0x1A, 0x00, 0x00, 0x41, 0x40, 0x00, 0x00,
            0x39, 0x42, 0x48, 0x00, 0x00, 0x39, 0x42, 0x46, 0x00, 0x00, 0x39, 0x41, 0x48, 0x00,
            0x00, 0x39, 0x7F, 0xA0, 0x00, 0x00, 0x52,
        ],
        &[0x82, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x30, 0x00, 0xA6],
        &[
            0x86, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x30, 0x0B, 0x00, 0x90, 0x02, 0x00, 0x02, 0x00,
            0xA4, 0x40, 0x08, 0x00, 0x00, 0xD5,
        ],
    ];
    let one: Vec<u8> = POLL
        .iter()
        .flat_map(|frame| [&[0xFF; 5], *frame].concat())
        .collect();
    let bytes = one.repeat(usize::try_from(MESSAGES / 4).expect("it fits"));
    let mut group = c.benchmark_group("hart");
    let mut index: Vec<Frame> = Vec::new();
    group.throughput(Throughput::Elements(MESSAGES));
    group.bench_function("stream to frames", |b| {
        b.iter(|| {
            scan_into(black_box(&bytes), Framing::Hart, &mut index);
            assert_eq!(index.len() as u64, MESSAGES);
        });
    });
    let context = Context {
        framing: Framing::Hart,
        device: Device::Rotork(Family::Iq),
    };
    scan_into(&one, Framing::Hart, &mut index);
    let frames = index.clone();
    let mut tree = Decoded::default();
    group.throughput(Throughput::Elements(4));
    group.bench_function("field trees of a poll of two commands", |b| {
        b.iter(|| {
            for frame in &frames {
                let from = usize::try_from(frame.offset).expect("small");
                let to = usize::try_from(frame.end()).expect("small");
                decode_into(frame, black_box(&one[from..to]), None, &context, &mut tree);
                assert!(tree.is_ok());
            }
        });
    });
    group.finish();
}

/// Frames and values of the ICON3000 map, without and with a tree.
fn decoding(c: &mut Criterion) {
    let mut group = c.benchmark_group("decode");
    let load = polls(MESSAGES);
    let mut index = Vec::new();
    group.throughput(Throughput::Elements(load.messages));
    group.bench_function("stream to values of the map", |b| {
        b.iter(|| black_box(mapped(&load, &mut index)));
    });

    let context = Context {
        framing: Framing::Rtu,
        device: Device::Icon3000v2,
    };
    let request = shared::encode::frame(Framing::Rtu, 0, 1, &[3, 0x0B, 0xB8, 0, 10]);
    let answer = shared::encode::frame(Framing::Rtu, 0, 1, &response(3000, 10, 5));
    let both = [request.clone(), answer.clone()].concat();
    scan_into(&both, Framing::Rtu, &mut index);
    let frame = index[1];
    assert_eq!(frame.role, Role::Response);
    let mut tree = Decoded::default();
    group.throughput(Throughput::Elements(1));
    group.bench_function("field tree of 10 registers", |b| {
        b.iter(|| {
            decode_into(
                black_box(&frame),
                &answer,
                Some(&request),
                &context,
                &mut tree,
            );
            assert!(tree.fields().len() > 10);
        });
    });
    group.finish();
}

/// Scans a stream and reads every value of every response; the number of values.
fn mapped(load: &Load, index: &mut Vec<Frame>) -> u64 {
    scan_into(&load.bytes, Framing::Rtu, index);
    let map = Model::Icon3000v2.map();
    let bytes = |f: &Frame| &load.bytes[f.offset as usize..f.end() as usize];
    let mut count = 0;
    for frame in index.iter().filter(|f| f.role == Role::Response) {
        let Some(request) = frame.pair().map(|p| bytes(&index[p as usize])) else {
            continue;
        };
        let start = Address::new(u16::from_be_bytes([request[2], request[3]]));
        let data = bytes(frame);
        let words = &data[3..data.len() - 2];
        each_value(map, Table::Holding, start, words, |row, judged| {
            black_box((row, &judged));
            count += 1;
        });
    }
    count
}

/// rmodbus: length, then unit, function and CRC of each request.
fn rmodbus_frames(mut bytes: &[u8]) -> u64 {
    use rmodbus::server::ModbusFrame;
    use rmodbus::{ModbusProto, guess_request_frame_len};
    let mut response: Vec<u8> = Vec::with_capacity(256);
    let mut count = 0;
    while bytes.len() >= 8 {
        let len = guess_request_frame_len(&bytes[..7], ModbusProto::Rtu).expect("a request");
        let (frame, rest) = bytes.split_at(usize::from(len));
        response.clear();
        let mut parsed = ModbusFrame::new(frame[0], frame, ModbusProto::Rtu, &mut response);
        parsed.parse().expect("a sound request");
        count += u64::from(
            parsed.processing_required || parsed.error.is_some() || parsed.response_required,
        );
        bytes = rest;
    }
    count
}

/// tokio-modbus' RTU codec behind its only door, the server.
struct TokioModbus {
    runtime: tokio::runtime::Runtime,
    bytes: Arc<Vec<u8>>,
}

impl TokioModbus {
    fn new(load: &Load) -> Self {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_all()
            .build()
            .expect("a runtime starts");
        Self {
            runtime,
            bytes: Arc::new(load.bytes.clone()),
        }
    }

    /// Has the server read the whole stream; the number of requests it saw.
    fn run(&mut self) -> u64 {
        let seen = Arc::new(AtomicU64::new(0));
        let bytes = Arc::clone(&self.bytes);
        let (done, finished) = tokio::sync::oneshot::channel();
        let done = std::sync::Mutex::new(Some(done));
        let count = Arc::clone(&seen);
        self.runtime.block_on(async move {
            let listener = tokio::net::TcpListener::bind("127.0.0.1:0")
                .await
                .expect("loopback");
            let address = listener.local_addr().expect("an address");
            let server = tokio_modbus::server::rtu_over_tcp::Server::new(listener);
            let connected = |_, _| {
                let end = done.lock().ok().and_then(|mut d| d.take());
                let memory = Memory {
                    bytes: Arc::clone(&bytes),
                    at: 0,
                    end,
                };
                ready(Ok::<_, io::Error>(Some((
                    Counter(Arc::clone(&count)),
                    memory,
                ))))
            };
            let _client = tokio::net::TcpStream::connect(address)
                .await
                .expect("loopback");
            let stop = async { finished.await.unwrap_or(()) };
            server
                .serve_until(&connected, |_| {}, stop)
                .await
                .expect("serves");
        });
        seen.load(Ordering::Relaxed)
    }
}

/// Counts requests and answers none.
struct Counter(Arc<AtomicU64>);

impl tokio_modbus::server::Service for Counter {
    type Request = tokio_modbus::SlaveRequest<'static>;
    type Response = Option<tokio_modbus::Response>;
    type Exception = tokio_modbus::ExceptionCode;
    type Future = Ready<Result<Self::Response, Self::Exception>>;

    fn call(&self, request: Self::Request) -> Self::Future {
        black_box(request);
        self.0.fetch_add(1, Ordering::Relaxed);
        ready(Ok(None))
    }
}

/// A transport that reads from memory; its drop says that the server is through.
struct Memory {
    bytes: Arc<Vec<u8>>,
    at: usize,
    end: Option<tokio::sync::oneshot::Sender<()>>,
}

impl Drop for Memory {
    fn drop(&mut self) {
        if let Some(end) = self.end.take() {
            let _receiver_may_be_gone = end.send(());
        }
    }
}

impl AsyncRead for Memory {
    fn poll_read(
        mut self: Pin<&mut Self>,
        _: &mut Task<'_>,
        buf: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let len = buf.remaining().min(self.bytes.len() - self.at);
        let at = self.at;
        buf.put_slice(&self.bytes[at..at + len]);
        self.at += len;
        Poll::Ready(Ok(()))
    }
}

impl AsyncWrite for Memory {
    fn poll_write(self: Pin<&mut Self>, _: &mut Task<'_>, buf: &[u8]) -> Poll<io::Result<usize>> {
        Poll::Ready(Ok(buf.len()))
    }

    fn poll_flush(self: Pin<&mut Self>, _: &mut Task<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(self: Pin<&mut Self>, _: &mut Task<'_>) -> Poll<io::Result<()>> {
        Poll::Ready(Ok(()))
    }
}

criterion_group!(benches, scanning, decoding, hart);
criterion_main!(benches);
