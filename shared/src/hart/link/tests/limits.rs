//! Answers and characters that come as late as they may, and later.

use super::world::{By, Device, World, reply};
use super::*;

/// Characters as the table of timers counts them: 11 bits at 1200 bit/s.
const CHARACTER: u64 = 11_000_000 / 1200;
const STO: u64 = 28 * 11 * 1_000_000 / 1200;
const RT1: u64 = 33 * 11 * 1_000_000 / 1200;

/// The first answer begins so late and carries 1 mA; the others come soon and carry 2 mA.
fn late(delay: u64) -> World {
    let mut world = World::new(&[Setup::primary()]);
    let mut count = 0;
    world.devices.push(Device::new(Box::new(move |request| {
        count += 1;
        let (delay, current) = match count {
            1 => (delay, 1.0_f32),
            _ => (20_000, 2.0),
        };
        let data = [current, 0.0].map(f32::to_be_bytes).concat();
        Some((delay, reply(request, [0, 0], &data)))
    })));
    ask(
        &mut world,
        0,
        Request::new(DEVICE, 2, &[]).with_preambles(5),
    );
    world
}

/// STO: an answer that begins with the last of 28 characters is the answer to the first try.
#[test]
fn an_answer_may_begin_as_late_as_sto() {
    for delay in [0, STO - 1, STO] {
        let mut world = late(delay);
        let done = world.outcome(0, 10_000_000).unwrap();
        assert_eq!(done.tries, 1, "{delay}");
        assert_eq!(done.outcome.unwrap().data()[..4], 1.0_f32.to_be_bytes());
        let [asked, answered] = &world.runs[..] else {
            panic!("{:?}", world.runs);
        };
        assert_eq!(answered.start - asked.end(world.character), delay);
        let stats = world.links[0].stats();
        assert_eq!((stats.answered, stats.silent, stats.strays), (1, 0, 0));
    }
}

/// Until RT1 nobody else may begin, so that an answer behind STO is still taken; the standard gives
/// the device no right to it.
#[test]
fn an_answer_between_sto_and_rt1_is_still_heard() {
    let mut world = late(RT1 - 2 * CHARACTER);
    let done = world.outcome(0, 10_000_000).unwrap();
    assert_eq!((done.tries, done.outcome.is_ok()), (1, true));
}

/// Behind RT1 the request counts as not answered: it is sent again, and what the device says into
/// that answers nothing.
#[test]
fn an_answer_behind_rt1_is_not_taken() {
    for beyond in [0, 1, CHARACTER, 10 * CHARACTER] {
        let mut world = late(RT1 + beyond);
        let done = world.outcome(0, 10_000_000).unwrap();
        assert!(done.tries > 1, "{beyond}");
        assert_eq!(
            done.outcome.unwrap().data()[..4],
            2.0_f32.to_be_bytes(),
            "{beyond}"
        );
        let asked = world.of(By::Master(0));
        assert_eq!(asked.len(), usize::from(done.tries));
        let silence = asked[1].start - asked[0].end(world.character);
        assert_eq!((silence + 50) / 100, (RT1 + 50) / 100, "{beyond}");
        let stats = world.links[0].stats();
        assert_eq!(stats.answered, 1, "{beyond}");
        assert!(stats.silent >= 1, "{beyond}");
    }
}

/// How the first try ended whose answer has so long a silence behind this byte; `None` if the
/// request is sent again.
fn broken(behind: usize, silence: u64) -> Option<Done> {
    let mut link = Link::new(
        Setup {
            retries: 1,
            ..Setup::primary()
        },
        Micros::new(0),
    );
    link.ask(command_3(), Micros::new(0)).unwrap();
    let mut now = Micros::new(0);
    let request = loop {
        match link.next(now) {
            Next::Transmit(bytes) => break bytes,
            Next::Wait(until) => now = until,
            Next::Idle => panic!("nothing to do"),
        }
    };
    now = now.plus(CHARACTER * request.len() as u64);
    link.sent(now);
    now = now.plus(STO / 2);
    for (at, byte) in reply(&request[5..], [0, 0], &DATA_3).iter().enumerate() {
        if at == behind {
            now = now.plus(silence);
        }
        now = now.plus(CHARACTER);
        link.heard(&[*byte], now);
    }
    let done = link.done();
    if done.is_none() {
        // What was heard is damage; behind RT1 the request goes out again.
        loop {
            match link.next(now) {
                Next::Transmit(again) => break assert_eq!(again, request),
                Next::Wait(until) => now = now.plus(1).max(until),
                Next::Idle => panic!("given up"),
            }
        }
        assert_eq!((link.stats().answered, link.stats().retried), (0, 1));
        assert!(link.stats().damaged > 0, "{behind}");
    }
    done
}

/// A gap of one character is allowed between any two characters of a frame, a longer one breaks it.
#[test]
fn a_gap_may_be_one_character_long() {
    // Behind the first preamble bytes only less of the preamble is left.
    for behind in 4..40 {
        let done = broken(behind, CHARACTER).unwrap_or_else(|| panic!("{behind}"));
        assert_eq!((done.tries, done.outcome.is_ok()), (1, true), "{behind}");
    }
    for behind in 6..40 {
        assert_eq!(broken(behind, CHARACTER + 1), None, "{behind}");
        assert_eq!(broken(behind, 5 * CHARACTER), None, "{behind}");
    }
}
