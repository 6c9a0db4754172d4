//! A DDC-100 network with faults: no answer may be taken for that of another request, be it on the
//! same port, on the other one, or that of a page.
//!
//! The unit answers every request with other numbers, so that an answer in the wrong place is seen.
//! What it says comes out of both ends of the loop, as on a cable that is whole. Time is simulated;
//! set `VALVESCOPE_FAULTS` to the number of polls for each fault.

mod networks;

use backend::bus::board::Board;
use backend::bus::ddc::{Common, Network, start};
use backend::bus::master::Stream;
use backend::bus::{Handle, Plug};
use backend::clock::Clock;
use backend::config::{BusConfig, DdcConfig, DdcPorts, LineConfig, Mode};
use shared::address::{Address, Table};
use shared::decode::pdu_of;
use shared::device::Device;
use shared::encode::{Read, frame};
use shared::frame::Framing;
use shared::frame::check::crc_holds;
use shared::proto::{DdcNews, DdcShape, Outcome};
use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tokio::io::{AsyncReadExt, AsyncWriteExt, DuplexStream, ReadHalf, WriteHalf, duplex, split};
use tokio::sync::watch;
use tokio::time::sleep;

const TIMEOUT: Duration = Duration::from_millis(250);

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

/// What the unit did.
#[derive(Debug, Default)]
struct Log {
    /// Its answer to the last request.
    truth: Vec<u8>,
    requests: u64,
    faults: u64,
}

type Out = Arc<tokio::sync::Mutex<Vec<WriteHalf<DuplexStream>>>>;

/// The unit, as it hears requests at one end of the cable.
struct End {
    framing: Framing,
    fault: Fault,
    per_mille: u64,
    log: Arc<Mutex<Log>>,
    dice: Arc<Mutex<Dice>>,
    from: ReadHalf<DuplexStream>,
    /// Both ends.
    to: Out,
    /// One answer after the other.
    turn: Arc<tokio::sync::Mutex<()>>,
}

impl End {
    async fn serve(mut self) {
        let mut heard = Vec::new();
        loop {
            let mut bytes = [0; 256];
            match self.from.read(&mut bytes).await {
                Ok(count) if count > 0 => heard.extend_from_slice(&bytes[..count]),
                _ => return,
            }
            let Some((unit, pdu)) = request(self.framing, &mut heard) else {
                continue;
            };
            let (answer, late, passed) = self.answer(unit, &pdu);
            let (to, turn) = (Arc::clone(&self.to), Arc::clone(&self.turn));
            tokio::spawn(async move {
                let guard = if passed {
                    None
                } else {
                    Some(turn.lock().await)
                };
                sleep(Duration::from_millis(20) + late).await;
                for end in to.lock().await.iter_mut() {
                    let _gone = end.write_all(&answer).await;
                }
                drop(guard);
            });
        }
    }

    /// The frame to send, how much too late, and whether others may pass it.
    fn answer(&self, unit: u8, pdu: &[u8]) -> (Vec<u8>, Duration, bool) {
        let mut log = self.log.lock().unwrap();
        let mut dice = self.dice.lock().unwrap();
        let count = u64::from(pdu[4]);
        log.requests += 1;
        let number = log.requests;
        let mut good = vec![pdu[0], pdu[4] * 2];
        let words = (0..count).map(|n| (number.wrapping_mul(31).wrapping_add(n)) as u16);
        good.extend(words.flat_map(u16::to_be_bytes));
        log.truth.clone_from(&good);
        let mut bytes = frame(self.framing, 0, unit, &good);
        let (mut late, mut passed) = (Duration::ZERO, false);
        if dice.roll(1000) < self.per_mille {
            log.faults += 1;
            match self.fault {
                Fault::Flip => {
                    for _ in 0..=dice.roll(3) {
                        let at = dice.roll(bytes.len() as u64) as usize;
                        bytes[at] ^= 1 << dice.roll(8);
                    }
                }
                Fault::Cut => bytes.truncate(dice.roll(bytes.len() as u64) as usize),
                Fault::Twice => bytes = [bytes.as_slice(), &bytes].concat(),
                Fault::Garbage => {
                    let noise = (0..=dice.roll(20)).map(|_| dice.roll(256) as u8);
                    bytes = noise.chain(bytes).collect();
                }
                Fault::Late | Fault::Passed => {
                    late = TIMEOUT + TIMEOUT * dice.roll(2000) as u32 / 1000;
                    passed = self.fault == Fault::Passed;
                }
            }
        }
        (bytes, late, passed)
    }
}

fn request(framing: Framing, heard: &mut Vec<u8>) -> Option<(u8, Vec<u8>)> {
    let (unit, len) = match framing {
        Framing::Ascii => {
            let end = heard.iter().position(|b| *b == b'\n')? + 1;
            (shared::frame::ascii::hex_pair(&heard[1..3])?, end)
        }
        _ => {
            heard.get(..8).filter(|f| crc_holds(f))?;
            (heard[0], 8)
        }
    };
    let bytes: Vec<u8> = heard.drain(..len).collect();
    Some((unit, pdu_of(&bytes, framing)?))
}

fn network(framing: Framing, retries: u8, mut ends: Vec<DuplexStream>) -> Network {
    let ddc = DdcConfig {
        ports: DdcPorts::Serial("1".into(), Some("2".into())),
        framing,
        baud: 19_200,
        mode: Mode::parse("8N1").unwrap(),
        shape: DdcShape::Loop,
        start: 7,
        count: 6,
        retry_faulty: false,
        scalings: BTreeMap::new(),
    };
    let bus = BusConfig {
        name: "Loop".into(),
        line: LineConfig::Ddc(Arc::new(ddc.clone())),
        timeout: TIMEOUT,
        retries,
        turnaround: Duration::from_millis(21),
    };
    let plugs = ends
        .drain(..)
        .map(|end| {
            let mut end = Some(end);
            Plug::Stream(Box::new(move || {
                let stream = end.take().ok_or(io::ErrorKind::NotFound)?;
                Ok(Box::new(stream) as Box<dyn Stream>)
            }))
        })
        .collect();
    let activity = watch::Sender::new(0);
    let common = Common {
        clock: Clock::start(),
        board: Board::new(activity.clone()),
        activity,
    };
    // One unit: nothing but its own answers can be mistaken for each other.
    let devices = networks::units(&[Device::Ddc100Uec]);
    start(&bus, &ddc, &devices, plugs, common).unwrap()
}

/// The last good answer to a poll, and when it came.
fn polled(news: &Board) -> Option<(u64, String)> {
    let (texts, _) = news.news(0);
    texts
        .iter()
        .find_map(|text| match DdcNews::from_text(text) {
            Some(DdcNews::Unit {
                response, at_us, ..
            }) => Some((at_us?, response)),
            _ => None,
        })
}

async fn check(framing: Framing, retries: u8, fault: Fault, per_mille: u64) {
    let wanted: u64 = std::env::var("VALVESCOPE_FAULTS")
        .ok()
        .and_then(|n| n.parse().ok())
        .unwrap_or(250);
    let log = Arc::new(Mutex::new(Log::default()));
    let dice = Arc::new(Mutex::new(Dice(0x9E37_79B9_7F4A_7C15 ^ per_mille)));
    let (turn, to) = (Arc::default(), Out::default());
    let mut nears = Vec::new();
    let mut tasks = Vec::new();
    for _ in 0..2 {
        let (near, far) = duplex(4096);
        nears.push(near);
        let (from, half) = split(far);
        to.lock().await.push(half);
        let end = End {
            framing,
            fault,
            per_mille,
            log: Arc::clone(&log),
            dice: Arc::clone(&dice),
            from,
            to: Arc::clone(&to),
            turn: Arc::clone(&turn),
        };
        tasks.push(tokio::spawn(end.serve()));
    }
    let network = network(framing, retries, nears);
    let handle: Handle = network.lines[0].1.clone();
    let (mut wrong, mut good, mut reads, mut lost) = (0, 0, 0, 0);
    let mut seen = 0;
    while good < wanted {
        // A page reads as many registers as a poll does, now and then.
        tokio::select! {
            report = handle.read(0, Read::new(Table::Holding, Address::new(30), 6).unwrap()) => {
                reads += 1;
                if report.outcome == Outcome::Ok {
                    wrong += u64::from(report.pdu.as_ref() != Some(&log.lock().unwrap().truth));
                } else {
                    lost += 1;
                }
            }
            () = watch(&network.news, &log, &mut seen, &mut good, &mut wrong, wanted) => {}
        }
        watch_for(&network.news, &log, &mut seen, &mut good, &mut wrong, 5).await;
    }
    let (requests, faults) = {
        let log = log.lock().unwrap();
        (log.requests, log.faults)
    };
    println!(
        "{framing:?} {fault:?} {per_mille}, {retries} retries: {requests} requests, {faults} faults, \
         {good} good polls, {reads} reads of a page, {lost} lost, {wrong} wrong"
    );
    assert_eq!(wrong, 0, "{fault:?} at {per_mille} of 1000");
    assert!(faults > requests * per_mille / 2000, "{faults} faults");
    tasks.iter().for_each(tokio::task::JoinHandle::abort);
}

/// Looks at every answer to a poll until there are enough.
async fn watch(
    news: &Board,
    log: &Mutex<Log>,
    seen: &mut u64,
    good: &mut u64,
    wrong: &mut u64,
    wanted: u64,
) {
    while *good < wanted {
        look(news, log, seen, good, wrong).await;
    }
}

/// The same for so many.
async fn watch_for(
    news: &Board,
    log: &Mutex<Log>,
    seen: &mut u64,
    good: &mut u64,
    wrong: &mut u64,
    count: u64,
) {
    let until = *good + count;
    watch(news, log, seen, good, wrong, until).await;
}

async fn look(news: &Board, log: &Mutex<Log>, seen: &mut u64, good: &mut u64, wrong: &mut u64) {
    // Less than the turn time, so that the next request is not out yet.
    sleep(Duration::from_millis(3)).await;
    if let Some((at, response)) = polled(news)
        && at != *seen
    {
        *seen = at;
        *good += 1;
        let truth = shared::render::hex(&log.lock().unwrap().truth);
        *wrong += u64::from(response != truth);
    }
}

macro_rules! faults {
    ($($name:ident: $framing:ident $retries:literal $fault:ident;)*) => {$(
        #[tokio::test(start_paused = true)]
        async fn $name() {
            for per_mille in [30, 300] {
                check(Framing::$framing, $retries, Fault::$fault, per_mille).await;
            }
        }
    )*};
}

faults! {
    flipped_bits: Rtu 1 Flip;
    cut_answers: Rtu 3 Cut;
    answers_twice: Rtu 1 Twice;
    garbage_before: Rtu 1 Garbage;
    late_answers: Rtu 0 Late;
    late_answers_with_retries: Rtu 3 Late;
    late_answers_out_of_order: Rtu 3 Passed;
    late_answers_in_ascii: Ascii 1 Late;
    answers_twice_in_ascii: Ascii 1 Twice;
}
