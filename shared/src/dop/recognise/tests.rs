use super::*;
use crate::capture::{Capture, Direction};
use crate::encode::frame;
use crate::frame::Framing;
use crate::session::Session;

/// Records a session: what a master asked, and what came back.
struct Bus {
    session: Session,
    framing: Framing,
    now: u64,
    transaction: u16,
}

impl Bus {
    fn new(framing: Framing) -> Self {
        Self {
            session: Session::new(framing),
            framing,
            now: 0,
            transaction: 0,
        }
    }

    fn bytes(&mut self, bytes: &[u8], direction: Direction) {
        self.now += 10_000;
        self.session.push(&Capture {
            bytes,
            at: Some(Micros::new(self.now)),
            direction,
            ends: true,
        });
    }

    /// A request and its answer; each takes 10 ms.
    fn ask(&mut self, unit: u8, request: &[u8], response: &[u8]) {
        self.transaction += 1;
        let out = frame(self.framing, self.transaction, unit, request);
        self.bytes(&out, Direction::ToDevice);
        if !response.is_empty() {
            let back = frame(self.framing, self.transaction, unit, response);
            self.bytes(&back, Direction::FromDevice);
        }
    }

    fn write(&mut self, unit: u8, address: u16, word: u16) {
        let ([a, b], [c, d]) = (address.to_be_bytes(), word.to_be_bytes());
        self.ask(unit, &[6, a, b, c, d], &[6, a, b, c, d]);
    }

    fn read(&mut self, unit: u8, start: u16, words: &[u16]) {
        let ([a, b], [c, d]) = (start.to_be_bytes(), (words.len() as u16).to_be_bytes());
        let mut response = vec![3, 2 * words.len() as u8];
        response.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        self.ask(unit, &[3, a, b, c, d], &response);
    }

    fn found(&self, profile: &Profile) -> Found {
        recognise(&Exchange::all(&self.session), profile)
    }
}

fn profile() -> Profile {
    Profile::from_json(r#"{"registers":{"request":10,"status":20,"count":21,"response":100}}"#)
        .unwrap()
}

/// Object 401, option 1, of unit 7, with a busy status at bit 12 first; polls 250 ms apart.
fn profile_read(bus: &mut Bus, data: &[u16]) {
    bus.write(7, 10, 0x1191);
    bus.read(7, 20, &[0x1191 & 0x07FF | 1 << 12]);
    bus.now += 250_000;
    bus.read(7, 20, &[0x1191 & 0x07FF | 2 << 12]);
    bus.read(7, 21, &[data.len() as u16]);
    for (at, block) in data.chunks(125).enumerate() {
        bus.read(7, 100 + 125 * at as u16, block);
    }
}

/// The times by hand: the write at 10, ready at 10 + 30 + 250 + 20 ms, the last block eleven
/// messages later.
#[test]
fn a_read_is_found_with_its_timing_in_every_framing() {
    let data: Vec<u16> = (0..410).map(|n| n * 3).collect();
    for framing in Framing::MODBUS {
        let mut bus = Bus::new(framing);
        // Something else before, between and behind, of this unit and of others.
        bus.read(7, 0, &[1, 2, 3]);
        bus.now = 0;
        profile_read(&mut bus, &data);
        // One more look, and what somebody reads later.
        bus.read(7, 20, &[0x1191 & 0x07FF | 2 << 12]);
        bus.read(7, 100, &[5; 10]);
        bus.read(9, 100, &[5; 10]);
        bus.read(7, 3000, &[5; 10]);
        let found = bus.found(&profile());
        assert!(!found.inferred);
        let [read] = found.reads.as_slice() else {
            panic!("{framing:?} {found:?}");
        };
        assert_eq!((read.unit, read.request.word()), (7, 0x1191));
        assert_eq!((&read.words, read.count), (&data, Some(410)));
        assert!(
            read.complete && read.problems.is_empty(),
            "{:?}",
            read.problems
        );
        assert_eq!(read.position, Position::Learned(Shift::Twelve));
        assert_eq!(read.polls, 3);
        assert_eq!(read.started, Some(Micros::new(10_000)));
        assert_eq!(read.busy(), Some(300_000));
        assert_eq!(read.took(), Some(400_000));
        // One write, two looks, the count, four blocks and the last look, with their answers.
        assert_eq!(read.frames, (2..20).collect::<Vec<u32>>());
    }
}

/// The same without addresses in the profile.
#[test]
fn addresses_are_inferred_from_the_pattern() {
    let data: Vec<u16> = (0..410).map(|n| n * 3).collect();
    let mut bus = Bus::new(Framing::Tcp);
    bus.read(7, 3000, &[410, 1]);
    profile_read(&mut bus, &data);
    bus.write(7, 10, 1005);
    bus.read(7, 20, &[1005 | 2 << 12]);
    bus.read(7, 21, &[4]);
    bus.read(7, 100, &[1, 0, 2, 0]);
    let found = bus.found(&Profile::default());
    assert!(found.inferred);
    let want = Areas {
        table: Table::Holding,
        request: 10,
        status: 20,
        count: 21,
        response: 100,
    };
    assert_eq!(found.areas, Some(want));
    let sizes: Vec<usize> = found.reads.iter().map(|r| r.words.len()).collect();
    assert_eq!(sizes, [410, 4]);
    assert!(found.reads.iter().all(|r| r.complete));
}

#[test]
fn ordinary_traffic_is_no_object() {
    let mut bus = Bus::new(Framing::Rtu);
    for n in 0..50 {
        bus.read(1, 3000, &[n, 2, 3, 4]);
        bus.read(2, 8, &[0x00FF, n]);
    }
    // A write of a word that is a request, and nothing like it behind.
    bus.write(1, 8, 1);
    bus.read(1, 8, &[1]);
    bus.read(1, 3000, &[1, 2, 3, 4]);
    let found = bus.found(&Profile::default());
    assert_eq!(found, Found::default());
    assert!(bus.found(&profile()).reads.is_empty());
}

/// One read over status, count and response at once.
#[test]
fn areas_that_touch_may_be_read_together() {
    let together =
        Profile::from_json(r#"{"registers":{"request":10,"status":98,"count":99,"response":100}}"#)
            .unwrap();
    let mut bus = Bus::new(Framing::Rtu);
    bus.write(7, 10, 1005);
    bus.read(7, 98, &[1005 | 2 << 13, 4, 1, 0, 2, 0]);
    let found = bus.found(&together);
    assert_eq!(found.reads[0].words, [1, 0, 2, 0]);
    assert!(found.reads[0].complete);
    assert_eq!(found.reads[0].position, Position::Learned(Shift::Thirteen));
}

/// A device that is ready at once at bit 11: that the master went on to the data tells so.
#[test]
fn reading_on_means_ready() {
    let mut bus = Bus::new(Framing::Rtu);
    bus.write(7, 10, 1005);
    bus.read(7, 20, &[1005 | 2 << 11]);
    bus.read(7, 21, &[4]);
    bus.read(7, 100, &[1, 0, 2, 0]);
    let read = bus.found(&profile()).reads.remove(0);
    assert_eq!(read.position, Position::Likely(Shift::Eleven));
    assert!(read.complete, "{:?}", read.problems);
}

#[test]
fn what_is_wrong_is_said() {
    let check = |build: &dyn Fn(&mut Bus), complete: bool, word: &str| {
        let mut bus = Bus::new(Framing::Rtu);
        build(&mut bus);
        let found = bus.found(&profile());
        let read = &found.reads[0];
        assert_eq!(read.complete, complete, "{read:?}");
        let said = read.problems.iter().any(|p| p.contains(word));
        assert!(said, "{:?} lacks {word}", read.problems);
    };
    let ready = |bus: &mut Bus, object: u16| {
        bus.write(7, 10, object);
        bus.read(7, 20, &[object | 1 << 12]);
        bus.read(7, 20, &[object | 2 << 12]);
    };
    check(
        &|bus| {
            ready(bus, 1005);
            bus.read(7, 21, &[4]);
            bus.read(7, 100, &[1, 0]);
        },
        false,
        "2 of 4 registers",
    );
    check(
        &|bus| {
            ready(bus, 1005);
            bus.read(7, 21, &[600]);
        },
        false,
        "600 registers",
    );
    check(
        &|bus| {
            bus.write(7, 10, 1005);
            bus.read(7, 20, &[1003 | 2 << 12]);
            bus.read(7, 20, &[1005 | 1 << 12]);
            bus.read(7, 20, &[1005 | 2 << 12]);
            bus.read(7, 21, &[4]);
            bus.read(7, 100, &[1, 0, 2, 0]);
        },
        true,
        "object 1003",
    );
    check(
        &|bus| bus.write(7, 10, 1005),
        false,
        "Nothing but the request",
    );
    check(&|bus| bus.write(7, 10, 0x7FFF), false, "names no object");
    check(
        &|bus| bus.ask(7, &[6, 0, 10, 3, 0xED], &[0x86, 2]),
        false,
        "exception 02",
    );
    check(
        &|bus| {
            bus.ask(7, &[6, 0, 10, 3, 0xED], &[]);
            bus.read(7, 20, &[1005 | 2 << 13]);
            bus.read(7, 21, &[4]);
            bus.read(7, 100, &[1, 0, 2, 0]);
        },
        true,
        "was not answered",
    );
    check(
        &|bus| {
            ready(bus, 1005);
            bus.read(7, 100, &[1, 0, 2]);
        },
        false,
        "count was not read",
    );
}

/// Status error with code 3, as it answers 0x10CD (reading A4).
#[test]
fn errors_have_their_code() {
    let mut bus = Bus::new(Framing::Rtu);
    bus.write(7, 10, 0x10CB);
    bus.read(7, 20, &[203 | 3 << 12]);
    bus.read(7, 100, &[3]);
    bus.write(7, 10, 1005);
    bus.read(7, 20, &[1005 | 3 << 12]);
    let found = bus.found(&profile());
    assert_eq!(found.reads[0].error, Some(Some(3)));
    assert!(found.reads[0].problems[0].contains("option"));
    assert_eq!(found.reads[1].error, Some(None));
    assert!(!found.reads[0].complete);
}

/// Requests of two units interleave; each gets its own answers. Function 16 asks as well.
#[test]
fn units_are_kept_apart() {
    let mut bus = Bus::new(Framing::Tcp);
    bus.ask(7, &[16, 0, 10, 0, 1, 2, 0x03, 0xED], &[16, 0, 10, 0, 1]);
    bus.write(8, 10, 1007);
    bus.read(7, 20, &[1005 | 2 << 13]);
    bus.read(8, 20, &[1007 | 2 << 13]);
    bus.read(8, 21, &[6]);
    bus.read(7, 21, &[4]);
    bus.read(8, 100, &[1, 2, 3, 4, 5, 6]);
    bus.read(7, 100, &[9, 0, 8, 0]);
    let found = bus.found(&profile());
    let got: Vec<(u8, u16, &[u16])> = found
        .reads
        .iter()
        .map(|r| (r.unit, r.request.word(), r.words.as_slice()))
        .collect();
    assert_eq!(
        got,
        [(7, 1005, &[9, 0, 8, 0][..]), (8, 1007, &[1, 2, 3, 4, 5, 6])]
    );
}

proptest::proptest! {
    /// Any exchanges are survived, whatever the profile knows, and none gives more than 512 registers.
    #[test]
    fn any_traffic_is_survived(
        exchanges in proptest::collection::vec(
            (0_u8..3,
             proptest::collection::vec(proptest::prelude::any::<u8>(), 0..12),
             proptest::option::of(proptest::collection::vec(proptest::prelude::any::<u8>(), 0..30))),
            0..60),
        configured in proptest::prelude::any::<bool>(),
    ) {
        let exchanges: Vec<Exchange> = (0..).zip(exchanges).map(|(n, (unit, mut request, response))| {
            // Small addresses, so that something meets.
            if let Some(function) = request.first_mut() {
                *function = [3, 6, 16, 3][usize::from(*function & 3)];
            }
            if let Some(high) = request.get_mut(1) {
                *high = 0;
            }
            Exchange {
                unit, request, response, at: None, answered: None, frame: n, answer: None,
            }
        }).collect();
        let profile = if configured { profile() } else { Profile::default() };
        for read in recognise(&exchanges, &profile).reads {
            assert!(read.words.len() <= 512);
            assert!(!read.frames.is_empty());
        }
    }
}
