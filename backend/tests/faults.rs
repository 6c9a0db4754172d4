//! A line with faults: no answer may be taken for that of another request.
//!
//! The device answers every request with other numbers, so that an answer in the wrong place is
//! seen. Time is simulated; set `VALVESCOPE_FAULTS` to the number of requests for each fault.

use backend::bus::board::Board;
use backend::bus::master::Stream;
use backend::bus::recorder::Recorder;
use backend::bus::{Handle, Plug, start};
use backend::clock::Clock;
use backend::config::{BusConfig, DeviceConfig, LineConfig, Mode, Parity};
use shared::address::{Address, Table};
use shared::capture::{Capture, Direction};
use shared::decode::pdu_of;
use shared::device::Device;
use shared::encode::{Read, frame};
use shared::frame::check::crc_holds;
use shared::frame::{Framing, Role};
use shared::proto::{Outcome, ToPage, Way};
use shared::session::Session;
use std::collections::HashMap;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream, duplex, split};
use tokio::sync::watch;
use tokio::time::{Instant, sleep};

const TIMEOUT: Duration = Duration::from_millis(200);
const UNIT: u8 = 9;

/// What goes wrong with an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fault {
    /// Up to three bits are flipped.
    Flip,
    /// The end is missing, or all of it.
    Cut,
    /// It comes twice.
    Twice,
    /// Up to 20 bytes of noise stand before it.
    Garbage,
    /// It comes up to three time-outs too late, and so do those behind it.
    Late,
    /// It comes up to three time-outs too late, and others may pass it.
    Passed,
    /// Any of these.
    Mixed,
}

/// Numbers that look random and are the same in every run.
struct Dice(u64);

impl Dice {
    fn roll(&mut self, sides: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % sides
    }
}

/// What the device did.
#[derive(Default)]
struct Log {
    /// The answer to each read.
    truth: Vec<Vec<u8>>,
    faults: u64,
}

/// A device on a line with faults in so many answers of a thousand.
struct Line {
    framing: Framing,
    fault: Fault,
    per_mille: u64,
    /// It answers FC 08.
    echo: bool,
    log: Arc<Mutex<Log>>,
}

impl Line {
    async fn serve(self, stream: DuplexStream) {
        let mut dice = Dice(0x9E37_79B9_7F4A_7C15 ^ self.per_mille);
        let (mut from, to) = split(stream);
        let to = Arc::new(tokio::sync::Mutex::new(to));
        let mut heard = Vec::new();
        let mut number = 0_u16;
        loop {
            let mut bytes = [0; 256];
            match from.read(&mut bytes).await {
                Ok(count) if count > 0 => heard.extend_from_slice(&bytes[..count]),
                _ => return,
            }
            let Some((pdu, len)) = request(self.framing, &heard) else {
                continue;
            };
            heard.drain(..len);
            number = number.wrapping_add(1);
            let Some(answer) = self.answer(&pdu, number) else {
                continue;
            };
            let mut answer = frame(self.framing, 0, UNIT, &answer);
            let mut late = Duration::ZERO;
            let mut passed = false;
            if dice.roll(1000) < self.per_mille {
                self.log.lock().unwrap().faults += 1;
                let fault = match self.fault {
                    Fault::Mixed => {
                        use Fault::{Cut, Flip, Garbage, Late, Passed, Twice};
                        [Flip, Cut, Twice, Garbage, Late, Passed][dice.roll(6) as usize]
                    }
                    fault => fault,
                };
                match fault {
                    Fault::Flip => {
                        for _ in 0..=dice.roll(3) {
                            let at = dice.roll(answer.len() as u64) as usize;
                            answer[at] ^= 1 << dice.roll(8);
                        }
                    }
                    Fault::Cut => answer.truncate(dice.roll(answer.len() as u64) as usize),
                    Fault::Twice => answer = [answer.as_slice(), &answer].concat(),
                    Fault::Garbage => {
                        let noise = (0..=dice.roll(20)).map(|_| dice.roll(256) as u8);
                        answer = noise.chain(answer).collect();
                    }
                    _ => {
                        late = TIMEOUT + TIMEOUT * dice.roll(2000) as u32 / 1000;
                        passed = fault == Fault::Passed;
                    }
                }
            }
            let to = Arc::clone(&to);
            // A device that thinks, and a line that takes its time.
            let send = async move {
                sleep(Duration::from_millis(20) + late).await;
                let _gone = to.lock().await.write_all(&answer).await;
            };
            if passed {
                tokio::spawn(send);
            } else {
                send.await;
            }
        }
    }

    /// The response PDU: an echo, or other numbers each time.
    fn answer(&self, pdu: &[u8], number: u16) -> Option<Vec<u8>> {
        match pdu {
            [8, ..] if self.echo => Some(pdu.to_vec()),
            [8, ..] => None,
            [function, _, _, _, count] => {
                let words = (0..u16::from(*count)).map(|n| number.wrapping_mul(31).wrapping_add(n));
                let mut answer = vec![*function, count * 2];
                answer.extend(words.flat_map(u16::to_be_bytes));
                self.log.lock().unwrap().truth.push(answer.clone());
                Some(answer)
            }
            _ => None,
        }
    }
}

/// A page: sees what the tap recorded, and pairs it itself.
struct Watcher {
    session: Session,
    /// The last capture seen, and the next entry to look at.
    last: u64,
    next: u32,
    /// Which read each request in the session is.
    reads: HashMap<u32, usize>,
    count: usize,
    wrong: u64,
    answers: u64,
}

impl Watcher {
    fn new(framing: Framing) -> Self {
        Self {
            session: Session::new(framing),
            last: 0,
            next: 0,
            reads: HashMap::new(),
            count: 0,
            wrong: 0,
            answers: 0,
        }
    }

    fn look(&mut self, handle: &Handle, truth: &[Vec<u8>]) {
        let pulled = handle.recorder().after(self.last, usize::MAX);
        assert_eq!(pulled.missed, 0);
        self.last = pulled.last;
        for text in pulled.messages {
            let ToPage::Capture { way, ends, hex, .. } = serde_json::from_str(&text).unwrap()
            else {
                panic!("{text:?}");
            };
            let (bytes, _) = shared::text::read_hex(hex.as_bytes());
            self.session.push(&Capture {
                bytes: &bytes,
                at: None,
                direction: match way {
                    Way::Tx => Direction::ToDevice,
                    Way::Rx => Direction::FromDevice,
                },
                ends,
            });
        }
        while self.next < self.session.len() {
            let frame = *self.session.frame(self.next).unwrap();
            let sent = self.session.direction(self.next) == Direction::ToDevice;
            if sent && frame.function == 3 {
                self.reads.insert(self.next, self.count);
                self.count += 1;
            }
            if let (Role::Response, Some(request)) = (frame.role, frame.pair())
                && let Some(read) = self.reads.remove(&request)
            {
                let bytes = self.session.bytes(self.next).unwrap();
                let pdu = pdu_of(bytes, self.session.framing()).unwrap();
                self.answers += 1;
                self.wrong += u64::from(pdu != truth[read]);
            }
            self.next += 1;
        }
        self.session.forget_before(self.next.saturating_sub(64));
    }
}

/// A request at the start of the bytes.
fn request(framing: Framing, bytes: &[u8]) -> Option<(Vec<u8>, usize)> {
    match framing {
        Framing::Ascii => {
            let end = bytes.iter().position(|b| *b == b'\n')? + 1;
            Some((pdu_of(&bytes[..end], framing)?, end))
        }
        _ => {
            let frame = bytes.get(..8).filter(|f| crc_holds(f))?;
            Some((frame[1..6].to_vec(), 8))
        }
    }
}

fn handle(framing: Framing, device: Device, stream: DuplexStream) -> Handle {
    let bus = BusConfig {
        name: "a".into(),
        line: LineConfig::Serial {
            framing,
            port: "-".into(),
            baud: 38_400,
            mode: Mode {
                data: 8,
                parity: Parity::Even,
                stop: 1,
            },
        },
        timeout: TIMEOUT,
        retries: 2,
        turnaround: Duration::ZERO,
    };
    let devices = [DeviceConfig {
        tag: "x".into(),
        device,
        bus: 0,
        unit: UNIT,
        description: String::new(),
        faults: Vec::new(),
        profile: None,
        target: None,
    }];
    let (clock, activity) = (Clock::start(), watch::Sender::new(0));
    let board = Board::new(activity.clone());
    let recorder = Recorder::new("a", clock, activity);
    let mut stream = Some(stream);
    let plug = Plug::Stream(Box::new(move || {
        let stream = stream.take().ok_or(std::io::ErrorKind::NotFound)?;
        Ok(Box::new(stream) as Box<dyn Stream>)
    }));
    start(bus, &devices, plug, clock, board, recorder)
}

/// Reads again and again; counts what was lost and what was wrong.
async fn check(framing: Framing, device: Device, fault: Fault, per_mille: u64) {
    let requests: u64 = std::env::var("VALVESCOPE_FAULTS")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(2_000);
    let (near, far) = duplex(4096);
    let log = Arc::new(Mutex::new(Log::default()));
    let line = Line {
        framing,
        fault,
        per_mille,
        echo: device.is_icon(),
        log: Arc::clone(&log),
    };
    tokio::spawn(line.serve(far));
    let handle = handle(framing, device, near);
    let (mut wrong, mut lost) = (0, 0);
    let mut watcher = Watcher::new(framing);
    let began = Instant::now();
    for turn in 0..requests {
        // Mostly the same block, as a watch does.
        let count = if turn % 10 == 9 { 3 } else { 5 };
        let read = Read::new(Table::Holding, Address::new(3000), count).unwrap();
        let report = handle.read(0, read).await;
        if report.outcome == Outcome::Ok {
            wrong += u64::from(report.pdu.as_ref() != log.lock().unwrap().truth.last());
        } else {
            lost += 1;
        }
        watcher.look(&handle, &log.lock().unwrap().truth);
    }
    let took = began.elapsed();
    let faults = log.lock().unwrap().faults;
    println!(
        "{framing:?} {device:?} {fault:?} {per_mille}: {requests} requests, {faults} faults, \
         {lost} lost, {wrong} wrong, {} wrong of {} for a page, {took:?} of line time",
        watcher.wrong, watcher.answers
    );
    assert_eq!(wrong, 0, "{fault:?} at {per_mille} of 1000");
    assert_eq!(
        watcher.wrong, 0,
        "{fault:?} at {per_mille} of 1000, as a page sees it"
    );
    assert!(faults > requests * per_mille / 2000, "{faults} faults");
    assert!(lost * 10 <= faults * 11, "{lost} lost of {faults} faults");
}

macro_rules! faults {
    ($($name:ident: $framing:ident $device:ident $fault:ident;)*) => {$(
        #[tokio::test(start_paused = true)]
        async fn $name() {
            for per_mille in [30, 300] {
                check(Framing::$framing, Device::$device, Fault::$fault, per_mille).await;
            }
        }
    )*};
}

faults! {
    flipped_bits: Rtu Icon3000v2 Flip;
    cut_answers: Rtu Icon3000v2 Cut;
    answers_twice: Rtu Icon3000v2 Twice;
    garbage_before: Rtu Icon3000v2 Garbage;
    late_answers: Rtu Icon3000v2 Late;
    late_answers_out_of_order: Rtu Icon3000v2 Passed;
    all_mixed: Rtu Icon3000v2 Mixed;
    flipped_bits_without_echo: Rtu None Flip;
    answers_twice_without_echo: Rtu None Twice;
    late_answers_without_echo: Rtu None Late;
    late_answers_out_of_order_without_echo: Rtu None Passed;
    all_mixed_without_echo: Rtu None Mixed;
    cut_answers_in_ascii: Ascii Icon3000v2 Cut;
    answers_twice_in_ascii: Ascii Icon3000v2 Twice;
    garbage_before_in_ascii: Ascii Icon3000v2 Garbage;
    late_answers_in_ascii: Ascii Icon3000v2 Late;
}
