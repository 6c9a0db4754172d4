use super::*;
use crate::proto::Outcome;

/// A device as the manual describes it, with its status at some position. Times are microseconds.
struct Device {
    shift: u8,
    busy: u64,
    request: u16,
    since: u64,
    /// Written requests are passed over so often.
    deaf: u32,
    /// The status stays what it was for so long after a write.
    lag: u64,
    before: u16,
    words: Vec<u16>,
    count: Option<u16>,
    error: Option<u16>,
    /// Foreign requests: when, and which word.
    foreign: Vec<(u64, u16)>,
    writes: Vec<u16>,
}

const MS: u64 = 1000;

impl Device {
    fn new(shift: u8, busy_ms: u64, words: &[u16]) -> Self {
        Self {
            shift,
            busy: busy_ms * MS,
            request: 0,
            since: 0,
            deaf: 0,
            lag: 0,
            before: 0,
            words: words.to_vec(),
            count: None,
            error: None,
            foreign: Vec::new(),
            writes: Vec::new(),
        }
    }

    fn status(&self, now: u64) -> u16 {
        if now < self.since + self.lag || self.request == 0 {
            return self.before;
        }
        let value: u16 = if now < self.since + self.busy {
            1
        } else if self.error.is_some() {
            3
        } else {
            2
        };
        self.request & 0x07FF | value << self.shift
    }

    fn take(&mut self, word: u16, now: u64) {
        self.before = self.status(now);
        self.request = word;
        self.since = now;
    }

    fn write(&mut self, word: u16, now: u64) {
        self.writes.push(word);
        if self.deaf > 0 {
            self.deaf -= 1;
        } else {
            self.take(word, now);
        }
    }

    fn read(&self, start: u16, count: u16, now: u64) -> Vec<u16> {
        (start..start + count)
            .map(|at| match at {
                20 => self.status(now),
                21 => self.count.unwrap_or(self.words.len() as u16),
                at if self.error.is_some() && at == 100 => self.error.unwrap(),
                at => self.words.get(usize::from(at - 100)).copied().unwrap_or(0),
            })
            .collect()
    }
}

/// An object that no test asks for.
const ANOTHER: u16 = 2046;

fn setup(position: Position) -> Setup {
    Setup {
        request: 10,
        status: 20,
        count: 21,
        response: 100,
        table: crate::address::Table::Holding,
        function: 6,
        max_registers: 125,
        poll: 250 * MS,
        timeout: 10_000 * MS,
        retries: 2,
        position,
        previous: Some(ANOTHER),
    }
}

/// Every step on the wire takes 10 ms.
const STEP: u64 = 10 * MS;

/// Runs a handshake against a device; gives it back with the time at its end.
fn run(request: u16, setup: Setup, device: &mut Device, start: u64) -> (Handshake, u64) {
    let mut now = start;
    let mut handshake = Handshake::new(Request::from_word(request), setup, Micros::new(now));
    for _ in 0..2000 {
        while device.foreign.first().is_some_and(|f| f.0 <= now) {
            let (_, word) = device.foreign.remove(0);
            device.take(word, now);
        }
        match handshake.next(Micros::new(now)) {
            Next::Over => return (handshake, now),
            Next::Wait(until) => {
                assert!(until.get() > now, "waits for what is past");
                now = until.get();
            }
            Next::Write {
                address,
                request,
                function,
            } => {
                assert_eq!((address, function), (10, 6));
                now += STEP;
                device.write(request.word(), now);
                handshake.reply(Reply::Written, Micros::new(now));
            }
            Next::Read(read) => {
                now += STEP;
                let words = device.read(read.start.get(), read.count(), now);
                handshake.reply(Reply::Words(&words), Micros::new(now));
            }
        }
    }
    panic!("goes on for ever");
}

fn words(handshake: &Handshake) -> &[u16] {
    handshake.outcome().unwrap().unwrap()
}

fn why(handshake: &Handshake) -> Why {
    handshake.outcome().unwrap().unwrap_err().clone()
}

const LEARNED: Position = Position::Learned(Shift::Twelve);

/// The whole of it, with the times by hand, in milliseconds: write 10, look 20 (busy), pause an
/// eighth of 250, look 61.25 (busy), pause a quarter, look 133.75 (ready), count 143.75, four
/// blocks of 125, 125, 125 and 35 until 183.75, look again 193.75.
#[test]
fn an_object_of_410_registers_is_read_in_four_blocks() {
    let data: Vec<u16> = (0..410).collect();
    let mut device = Device::new(12, 100, &data);
    let (done, end) = run(0x1191, setup(LEARNED), &mut device, 0);
    assert_eq!(words(&done), data);
    assert_eq!(device.writes, [0x1191]);
    let course = done.course();
    assert_eq!((course.blocks, course.polls, course.retries), (4, 4, 0));
    assert_eq!((course.busy(), course.took()), (133_750, 193_750));
    assert_eq!(end, 193_750);
    assert!(done.text().starts_with("410 registers in 4 blocks, 193 ms"));
}

/// Before the first write to a device its status is looked at: whether the address is right, and
/// which object stands there.
#[test]
fn nothing_is_written_before_the_status_was_read_once() {
    let mut first = setup(LEARNED);
    first.previous = None;
    let mut handshake = Handshake::new(Request::from_word(1), first.clone(), Micros::new(0));
    let Next::Read(read) = handshake.next(Micros::new(0)) else {
        panic!("writes at once");
    };
    assert_eq!((read.start.get(), read.count()), (20, 1));
    handshake.reply(Reply::Exception(2), Micros::new(1));
    assert_eq!(handshake.next(Micros::new(2)), Next::Over);
    assert_eq!(handshake.stands(), None);
    assert!(handshake.text().contains("status register (address 20)"));
    // What stands there is not another master's later on.
    let mut device = Device::new(12, 100, &[5]);
    device.take(1003, 0);
    device.deaf = 1;
    let (done, _) = run(1005, first, &mut device, 1_000 * MS);
    assert_eq!((words(&done), done.stands()), (&[5][..], Some(1005)));
    assert_eq!((done.course().foreign, done.course().retries), (0, 1));
}

/// Reading M2: busy, then ready, is a step of one at the position of the status.
#[test]
fn all_three_positions_are_learned_from_a_complete_exchange() {
    for (bit, shift) in [
        (11, Shift::Eleven),
        (12, Shift::Twelve),
        (13, Shift::Thirteen),
    ] {
        let mut device = Device::new(bit, 600, &[1, 2]);
        let (done, _) = run(1005, setup(Position::Unknown), &mut device, 0);
        assert_eq!(words(&done), [1, 2], "{bit}");
        assert_eq!(done.position(), Position::Learned(shift));
        // The same when the device refuses: error is 3 wherever it stands.
        let mut device = Device::new(bit, 0, &[]);
        device.error = Some(3);
        let (done, _) = run(0x10CD, setup(Position::Unknown), &mut device, 0);
        assert_eq!(why(&done), Why::Code(3));
        assert_eq!(done.position(), Position::Learned(shift));
    }
}

/// A device that is ready at once never shows a step. At bit 13 one word is proof; at 11 and 12
/// the word could be busy of the next position, and is waited for.
#[test]
fn a_device_that_is_never_busy_teaches_only_what_it_proves() {
    for (bit, position) in [
        (11, Position::Likely(Shift::Eleven)),
        (12, Position::Likely(Shift::Twelve)),
        (13, Position::Learned(Shift::Thirteen)),
    ] {
        let mut device = Device::new(bit, 0, &[7]);
        let (done, end) = run(1005, setup(Position::Unknown), &mut device, 0);
        assert_eq!(words(&done), [7]);
        assert_eq!(done.position(), position, "{bit}");
        if bit == 13 {
            assert!(end < 100 * MS);
        } else {
            assert!((5_000..5_500).contains(&(end / MS)), "{end}");
            assert!(done.text().contains(&format!("bit {bit}")));
        }
        // What is likely is taken the next time, and proved when a step is seen.
        let (next, end) = run(1003, setup(position), &mut device, 20_000 * MS);
        assert_eq!(words(&next), [7]);
        assert!(end < 20_100 * MS);
    }
}

/// What was learned gives way to a word that makes sense only elsewhere.
#[test]
fn a_wrong_position_is_learned_anew() {
    let mut device = Device::new(13, 600, &[1, 2]);
    let (done, _) = run(1005, setup(Position::Likely(Shift::Eleven)), &mut device, 0);
    assert_eq!(words(&done), [1, 2]);
    assert_eq!(done.position(), Position::Learned(Shift::Thirteen));
}

/// A configured position stays; the words that contradict it are named.
#[test]
fn a_configured_position_is_not_overruled() {
    let mut device = Device::new(11, 0, &[1]);
    device.busy = 60_000 * MS;
    let configured = Position::Configured(Shift::Twelve);
    let (done, _) = run(1005, setup(configured), &mut device, 0);
    assert_eq!(why(&done), Why::Undefined(1005 | 1 << 11));
    assert!(done.text().contains("status.shift 11"), "{}", done.text());
    assert_eq!(done.position(), configured);
}

/// Section 2.1.3 and reading B20: 0 and 4 to 7 are not defined.
#[test]
fn every_status_value_has_one_meaning_at_a_position() {
    for shift in Shift::ALL {
        for value in 0..8 {
            let want = match value {
                1 => Status::Busy,
                2 => Status::Ready,
                3 => Status::Error,
                _ => Status::Undefined,
            };
            assert_eq!(shift.read(shift.word(1202, value)), want);
        }
    }
    // Bits that belong to no field.
    assert_eq!(Shift::Eleven.read(0x8000 | 0x1000), Status::Undefined);
    assert_eq!(Shift::Twelve.read(0x0800 | 0x2000), Status::Undefined);
    assert_eq!(Shift::Thirteen.read(0x0800 | 0x4000), Status::Undefined);
    for value in [0, 4, 5, 6, 7] {
        let word = 1 | value << 12;
        let mut configured = setup(Position::Configured(Shift::Twelve));
        configured.timeout = 1_000 * MS;
        let mut now = 0;
        let mut handshake = Handshake::new(Request::from_word(1), configured, Micros::new(0));
        loop {
            now += 100 * MS;
            match handshake.next(Micros::new(now)) {
                Next::Over => break,
                Next::Write { .. } => handshake.reply(Reply::Written, Micros::new(now)),
                Next::Read(_) => handshake.reply(Reply::Words(&[word]), Micros::new(now)),
                Next::Wait(_) => {}
            }
        }
        assert_eq!(why(&handshake), Why::Undefined(word));
        assert!(handshake.text().contains(&format!("0x{word:04X}")));
    }
}

#[test]
fn a_device_that_stays_busy_is_given_up_after_the_time_out() {
    let mut device = Device::new(12, 1_000_000, &[1]);
    let (done, end) = run(1005, setup(LEARNED), &mut device, 0);
    assert_eq!(why(&done), Why::Busy(10_000 * MS));
    assert!((10_000..10_600).contains(&(end / MS)), "{end}");
    // Four looks in the first half second, then one each quarter of a second and 10 ms.
    assert!((40..=43).contains(&done.course().polls));
    assert_eq!(device.writes.len(), 1);
    assert_eq!(why(&done).outcome(), Outcome::Silence);
}

/// Codes 0 to 14 and the first undefined one (reading B19).
#[test]
fn error_codes_are_said_in_words() {
    for code in 0..=15_u16 {
        let mut device = Device::new(12, 300, &[]);
        device.error = Some(code);
        let (done, _) = run(0x30CC, setup(LEARNED), &mut device, 0);
        assert_eq!(why(&done).code(), Some(code));
        assert_eq!(why(&done).outcome(), Outcome::Ok);
        let text = done.text();
        assert!(text.contains(&format!("error {code}")), "{text}");
        assert_eq!(text.contains("not defined"), code == 15, "{text}");
        // "Could not queue", "link busy" and "board did not answer" pass; the others do not.
        let again = [4, 10, 11].contains(&code);
        assert_eq!(device.writes.len(), if again { 3 } else { 1 }, "{code}");
    }
}

#[test]
fn a_foreign_request_while_busy_is_seen_and_ours_repeated() {
    let mut device = Device::new(12, 600, &[5]);
    device.foreign = vec![(300 * MS, 203)];
    let (done, _) = run(1005, setup(LEARNED), &mut device, 0);
    assert_eq!(words(&done), [5]);
    assert_eq!((done.course().foreign, done.course().retries), (1, 1));
    assert_eq!(done.course().foreign_object, Some(203));
    assert_eq!(device.writes, [1005, 1005]);
    assert!(done.text().contains("object 203"), "{}", done.text());
    assert!(done.text().contains("asked again once"), "{}", done.text());
}

/// The data of another object must never be taken for ours: whenever the foreign request comes,
/// what is handed over was there when the status still was ours.
#[test]
fn a_foreign_request_at_any_moment_is_noticed() {
    for at in (0..500).map(|at| at * MS) {
        let mut device = Device::new(12, 40, &[5; 300]);
        device.foreign = vec![(at, 203)];
        let (done, end) = run(1005, setup(LEARNED), &mut device, 0);
        assert_eq!(words(&done), [5; 300]);
        if device.foreign.is_empty() {
            let clean = done.course().retries == 0;
            // Only before our write, or behind the last look, it makes no difference.
            assert!(!clean || at <= 10 * MS || at >= end - STEP, "{at} {end}");
        }
    }
}

#[test]
fn a_master_that_never_stops_is_named() {
    let mut device = Device::new(12, 400, &[5]);
    device.foreign = (1..400).map(|n| (n * 100 * MS, 1003)).collect();
    let (done, _) = run(1005, setup(LEARNED), &mut device, 0);
    assert_eq!(why(&done), Why::Foreign(1003));
    assert_eq!(why(&done).outcome(), Outcome::Damaged);
    assert_eq!(device.writes.len(), 3);
}

#[test]
fn a_request_that_was_not_taken_up_is_repeated() {
    let mut device = Device::new(12, 100, &[5]);
    device.take(1003, 0);
    device.deaf = 1;
    let mut known = setup(LEARNED);
    known.previous = Some(1003);
    let (done, _) = run(1005, known.clone(), &mut device, 1_000 * MS);
    assert_eq!(words(&done), [5]);
    assert_eq!((done.course().foreign, done.course().retries), (0, 1));
    device.deaf = 9;
    let (done, _) = run(601, known, &mut device, 9_000 * MS);
    assert!(matches!(why(&done), Why::NotTaken(_) | Why::Foreign(1005)));
}

/// The status of the request before may still stand there when ours is for the same object.
#[test]
fn an_old_ready_of_the_same_object_is_looked_at_twice() {
    let mut device = Device::new(12, 100, &[1]);
    let mut again = setup(LEARNED);
    again.previous = Some(1);
    run(0x0001, setup(LEARNED), &mut device, 0);
    // The device shows the old status for 15 ms: the first look meets it, the second does not.
    device.lag = 15 * MS;
    device.words = vec![2];
    let (done, _) = run(0x1001, again.clone(), &mut device, 5_000 * MS);
    assert!(done.course().busy() > 100 * MS, "was busy in between");
    assert_eq!(words(&done), [2]);
    // With a longer lag the look behind the data meets "busy", and the data are read again.
    device.lag = 35 * MS;
    let (done, _) = run(0x2001, again, &mut device, 9_000 * MS);
    assert_eq!((done.course().retries, done.course().blocks), (0, 2));
    assert!(done.course().busy() > 100 * MS);
    assert_eq!(words(&done), [2]);
    assert_eq!(device.writes, [0x0001, 0x1001, 0x2001]);
}

/// Section 8: no records is a count of one register holding 0; a count of 0 is no data at all.
#[test]
fn no_registers_are_no_error() {
    let mut device = Device::new(12, 100, &[]);
    let (done, _) = run(1202, setup(LEARNED), &mut device, 0);
    assert!(words(&done).is_empty());
    assert_eq!(done.course().blocks, 0);
}

#[test]
fn a_count_that_can_not_be_is_refused() {
    for (count, good) in [(512, true), (513, false), (0xFFFF, false)] {
        let mut device = Device::new(12, 100, &[9; 512]);
        device.count = Some(count);
        let (done, _) = run(1202, setup(LEARNED), &mut device, 0);
        match good {
            true => assert_eq!(words(&done).len(), 512),
            false => assert_eq!(why(&done), Why::Count(count)),
        }
    }
}

/// The first reply is given for the step named, then the handshake is looked at.
fn meet(replies: &[Reply<'_>]) -> Handshake {
    let mut handshake = Handshake::new(Request::from_word(1), setup(LEARNED), Micros::new(0));
    let mut now = 0;
    for reply in replies {
        loop {
            match handshake.next(Micros::new(now)) {
                Next::Wait(until) => now = until.get(),
                Next::Over => return handshake,
                _ => break,
            }
        }
        now += STEP;
        handshake.reply(*reply, Micros::new(now));
    }
    handshake
}

const BUSY: Reply<'_> = Reply::Words(&[0x1001]);
const READY: Reply<'_> = Reply::Words(&[0x2001]);

#[test]
fn refusals_name_the_register() {
    let denied = meet(&[Reply::Exception(2)]);
    assert_eq!(why(&denied).outcome(), Outcome::Exception);
    assert!(denied.text().contains("request register (address 10)"));
    let status = meet(&[Reply::Written, Reply::Exception(2)]);
    assert!(status.text().contains("status register (address 20)"));
    let count = meet(&[Reply::Written, READY, Reply::Exception(1)]);
    assert!(count.text().contains("count register (address 21)"));
    let data = meet(&[
        Reply::Written,
        READY,
        Reply::Words(&[3]),
        Reply::Exception(2),
    ]);
    assert!(
        data.text()
            .contains("response registers (from address 100)")
    );
}

/// "Busy" and "acknowledge" of Modbus itself are waited for (V1.1b3, section 7).
#[test]
fn modbus_exceptions_that_mean_later_are_waited_for() {
    let done = meet(&[
        Reply::Exception(6),
        Reply::Written,
        Reply::Exception(5),
        READY,
        Reply::Words(&[1]),
        Reply::Exception(6),
        READY,
        Reply::Words(&[1]),
        Reply::Words(&[77]),
        READY,
    ]);
    assert_eq!(words(&done), [77]);
    assert_eq!(done.course().retries, 1);
}

/// A write without an answer is not repeated blindly: the status says whether it arrived.
#[test]
fn a_silent_write_is_looked_for_in_the_status() {
    let silence = Reply::Lost(Outcome::Silence, "no answer");
    let done = meet(&[
        silence,
        BUSY,
        READY,
        Reply::Words(&[1]),
        Reply::Words(&[9]),
        READY,
    ]);
    assert_eq!(words(&done), [9]);
    assert_eq!(done.course().retries, 0);
    let lost = meet(&[Reply::Written, silence]);
    assert_eq!(why(&lost).outcome(), Outcome::Silence);
    assert!(lost.text().contains("no answer"));
    let down = meet(&[Reply::Lost(Outcome::Down, "unplugged")]);
    assert_eq!(why(&down).outcome(), Outcome::Down);
}

/// An answer without registers, or one to another question, ends the read and nothing else.
#[test]
fn answers_that_do_not_fit_are_no_data() {
    for replies in [
        &[Reply::Words(&[])][..],
        &[Reply::Written, Reply::Words(&[])],
        &[Reply::Written, Reply::Written],
        &[Reply::Written, READY, Reply::Words(&[])],
        &[Reply::Written, READY, Reply::Words(&[5]), Reply::Words(&[])],
    ] {
        assert_eq!(
            why(&meet(replies)).outcome(),
            Outcome::Damaged,
            "{replies:?}"
        );
    }
}

proptest::proptest! {
    /// Whatever a device answers and however long it takes: the handshake ends, hands over at most
    /// 512 registers, writes nothing but its request, and not more often than it may.
    #[test]
    fn any_device_is_survived(
        words in proptest::collection::vec(proptest::prelude::any::<u16>(), 1..400),
        kinds in proptest::collection::vec(0_u8..10, 1..400),
        request in proptest::prelude::any::<u16>(),
        previous in proptest::option::of(0_u16..2048),
    ) {
        let mut setup = setup(Position::Unknown);
        setup.previous = previous;
        let mut handshake = Handshake::new(Request::from_word(request), setup, Micros::new(0));
        let mut now = 0_u64;
        let mut writes = 0;
        let mut values = words.iter().cycle();
        let mut kinds = kinds.iter().cycle();
        let object = request & 0x07FF;
        for _ in 0..20_000 {
            match handshake.next(Micros::new(now)) {
                Next::Over => break,
                Next::Wait(until) => now = until.get(),
                Next::Write { address, request: word, function } => {
                    assert_eq!((address, word.word(), function), (10, request, 6));
                    writes += 1;
                    now += STEP;
                    handshake.reply(Reply::Written, Micros::new(now));
                }
                Next::Read(read) => {
                    now += STEP;
                    let block: Vec<u16> =
                        values.by_ref().take(usize::from(read.count())).copied().collect();
                    let ours = [object | (block[0] & 0xF800)];
                    let reply = match kinds.next() {
                        Some(0) => Reply::Exception(6),
                        Some(1) => Reply::Words(&block),
                        Some(2) => Reply::Lost(Outcome::Damaged, "x"),
                        _ if read.count() == 1 => Reply::Words(&ours),
                        _ => Reply::Words(&block),
                    };
                    handshake.reply(reply, Micros::new(now));
                }
            }
        }
        let outcome = handshake.outcome();
        assert!(outcome.is_some(), "it has to end");
        if let Some(Ok(words)) = outcome {
            assert!(words.len() <= 512);
        }
        assert!(writes <= 3);
        assert!(!handshake.text().is_empty());
    }
}
