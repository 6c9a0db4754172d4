mod limits;
mod storm;
mod world;

use super::*;
use crate::hart::frame::seal;
use world::{By, Device, World, reply};

const DEVICE: Address = Address::Long(0x2EDD, 0x01_2345);
/// Reading, section 5.2, R6 without its status: 12 mA and four variables.
const DATA_3: [u8; 24] = [
    0x41, 0x40, 0, 0, 0x39, 0x42, 0x48, 0, 0, 0x39, 0x42, 0x46, 0, 0, 0x39, 0x41, 0x48, 0, 0, 0x39,
    0x7F, 0xA0, 0, 0,
];

fn command_3() -> Request {
    Request::new(DEVICE, 3, &[]).with_preambles(5)
}

/// A device that answers command 3 so many microseconds after the request.
fn device(delay: u64) -> Device {
    Device::new(Box::new(move |request| {
        Some((delay, reply(request, [0, 0], &DATA_3)))
    }))
}

fn alone(setup: Setup) -> World {
    let mut world = World::new(&[setup]);
    world.devices.push(device(20_000));
    world
}

fn ask(world: &mut World, master: usize, request: Request) {
    let now = world.at();
    world.links[master].ask(request, now).unwrap();
}

/// RT1: 33 characters of silence for a primary master, 41 for a secondary one.
#[test]
fn the_first_request_waits_for_rt1() {
    for (setup, tenths) in [(Setup::primary(), 3025), (Setup::secondary(), 3758)] {
        let mut world = alone(setup);
        ask(&mut world, 0, command_3());
        let done = world.outcome(0, 5_000_000).unwrap();
        assert_eq!((world.runs[0].start + 50) / 100, tenths);
        assert_eq!(done.tries, 1);
        let answer = done.outcome.unwrap();
        assert_eq!((answer.code(), answer.data()), (Some(0), &DATA_3[..]));
        // Reading, section 5.2, R5; a secondary master has no bit 7, in the check byte as well.
        let bit = if setup.primary { 0x80 } else { 0 };
        let want = [0x82, 0x2E | bit, 0xDD, 1, 0x23, 0x45, 3, 0, 0x15 | bit];
        assert_eq!(done.request, want);
    }
}

/// RT2: behind its own exchange a master leaves the line for 8 characters.
#[test]
fn the_next_request_waits_for_rt2() {
    let mut world = alone(Setup::primary());
    for _ in 0..5 {
        ask(&mut world, 0, command_3());
        assert!(world.outcome(0, 10_000_000).unwrap().outcome.is_ok());
    }
    let (masters, devices) = (world.of(By::Master(0)), world.of(By::Device(0)));
    for (reply, next) in devices.iter().zip(&masters[1..]) {
        let gap = next.start - reply.end(world.character);
        assert_eq!((gap + 50) / 100, 733);
    }
}

/// Polling with command 3 goes at the rate of the line: 14 characters of request, the device's
/// turn, 40 of reply, and RT2.
#[test]
fn polling_reaches_the_rate_of_the_line() {
    let mut world = alone(Setup::primary());
    ask(&mut world, 0, command_3());
    world.outcome(0, 10_000_000).unwrap();
    let (from, count) = (world.now, 100);
    for _ in 0..count {
        ask(&mut world, 0, command_3());
        assert!(world.outcome(0, u64::MAX).unwrap().outcome.is_ok());
    }
    let actual = (world.now - from) / count;
    // By hand: 8 + 14 + 40 characters of 11 bits at 1200 bit/s, and 20 ms.
    let ideal = (8 + 14 + 40) * 11 * 1_000_000 / 1200 + 20_000;
    let percent = ideal * 1000 / actual;
    println!("command 3: ideal {ideal} us, actual {actual} us, {percent} per mille");
    assert!(percent >= 950, "{percent}");
    assert!(
        actual + 100 >= ideal,
        "faster than the line: {actual} {ideal}"
    );
}

/// No answer: after RT1 it is sent again, four times in all; then the line is left free until a
/// secondary master had its turn.
#[test]
fn silence_is_retried_and_then_said() {
    let mut world = World::new(&[Setup::primary()]);
    ask(&mut world, 0, command_3());
    let done = world.outcome(0, 60_000_000).unwrap();
    assert_eq!((done.outcome, done.tries), (Err(Failure::Silence), 4));
    let gap =
        |world: &World, at: usize| world.runs[at + 1].start - world.runs[at].end(world.character);
    for at in 0..3 {
        assert_eq!((gap(&world, at) + 50) / 100, 3025);
    }
    ask(&mut world, 0, Request::new(Address::Short(1), 0, &[]));
    world.outcome(0, 60_000_000).unwrap();
    let left = gap(&world, 3);
    assert!(left >= 375_800, "{left}");
    assert_eq!(world.links[0].stats().sent, 8);
    assert_eq!(world.links[0].stats().retried, 6);
}

/// A damaged reply and a communication error are retried, response codes are not.
#[test]
fn errors_of_the_line_are_retried_and_codes_are_not() {
    for (status, tries, ok) in [
        ([0x88, 0x00], 4, false),
        ([32, 0x00], 1, true),
        ([64, 0x40], 1, true),
        ([5, 0x00], 1, true),
    ] {
        let mut world = World::new(&[Setup::primary()]);
        world.devices.push(Device::new(Box::new(move |request| {
            Some((10_000, reply(request, status, &[])))
        })));
        ask(&mut world, 0, command_3());
        let done = world.outcome(0, 60_000_000).unwrap();
        assert_eq!(
            (done.tries, done.outcome.is_ok()),
            (tries, ok),
            "{status:?}"
        );
        if !ok {
            assert_eq!(done.outcome, Err(Failure::Communication(0x88)));
            assert!(Failure::Communication(0x88).to_string().contains("0x88"));
        }
    }
    let mut world = World::new(&[Setup::primary()]);
    let mut count = 0;
    world.devices.push(Device::new(Box::new(move |request| {
        let mut bytes = reply(request, [0, 0], &DATA_3);
        count += 1;
        if count < 3 {
            bytes[20] ^= 0x10;
        }
        Some((10_000, bytes))
    })));
    ask(&mut world, 0, command_3());
    let done = world.outcome(0, 60_000_000).unwrap();
    assert_eq!((done.tries, done.outcome.is_ok()), (3, true));
    assert_eq!(world.links[0].stats().damaged, 2);
}

/// A line that repeats what we send.
#[test]
fn our_own_bytes_are_no_other_master() {
    let mut world = alone(Setup::primary());
    world.echo = true;
    for _ in 0..3 {
        ask(&mut world, 0, command_3());
        let done = world.outcome(0, 10_000_000).unwrap();
        assert_eq!((done.tries, done.outcome.is_ok()), (1, true));
    }
    let link = &world.links[0];
    assert_eq!((link.stats().echoes, link.stats().overheard), (3, 0));
    assert!(!link.hears_other_master(world.at()));
}

/// A second master of our kind is said.
#[test]
fn a_twin_is_told() {
    let mut link = Link::new(Setup::primary(), Micros::new(0));
    let frame = command_3().bytes(true);
    link.heard(&frame, Micros::new(200_000));
    assert_eq!(link.event(), Some(Event::Twin));
    assert!(!link.hears_other_master(Micros::new(200_000)));
}

/// Two masters that always have something to ask take turns, and each begins within HOLD behind
/// the answer to the other.
#[test]
fn two_masters_take_turns() {
    let mut world = World::new(&[Setup::primary(), Setup::secondary()]);
    world.devices.push(device(15_000));
    let mut counts = [0_u32, 0];
    while world.now < 60_000_000 {
        for (master, count) in counts.iter_mut().enumerate() {
            if let Some(done) = world.links[master].done() {
                assert_eq!((done.tries, done.outcome.is_ok()), (1, true));
                *count += 1;
            }
            if !world.links[master].is_busy() {
                ask(&mut world, master, command_3());
            }
        }
        world.step(60_000_000);
    }
    assert!(world.runs.iter().all(|r| !r.hit));
    assert!(
        counts[0] > 50 && counts[0].abs_diff(counts[1]) <= 1,
        "{counts:?}"
    );
    let hold = Timing::new(BAUD, None).hold;
    for pair in world.runs.windows(2).skip(1) {
        if matches!((pair[0].by, pair[1].by), (By::Device(_), By::Master(_))) {
            let gap = pair[1].start - pair[0].end(world.character);
            assert!(gap > 0 && gap <= hold, "{gap}");
        }
    }
    let now = world.at();
    assert!(world.links.iter().all(|l| l.hears_other_master(now)));
}

/// Masters that ask now and then, at any moment, also after long silences, never meet.
#[test]
fn masters_that_wake_at_the_same_moment_do_not_meet() {
    let mut world = World::new(&[Setup::primary(), Setup::secondary()]);
    world.devices.push(device(15_000));
    let mut seed = 1_u64;
    for round in 0..400_u64 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let pause = (seed >> 33) % 3_000_000;
        // Every fourth time both ask at the same moment.
        let both = round % 4 == 0;
        let wake = world.now + pause;
        world.run(wake);
        for master in 0..2 {
            if both || (seed >> 20) % 2 == master as u64 {
                world.links[master].done();
                if !world.links[master].is_busy() {
                    ask(&mut world, master, command_3());
                }
            }
        }
    }
    let end = world.now + 10_000_000;
    world.run(end);
    assert!(world.runs.iter().all(|r| !r.hit), "a collision");
    assert!(world.runs.len() > 600);
}

/// A device that bursts between two masters: nobody begins while it sends, and all come to speak.
#[test]
fn bursts_hand_the_turn_on() {
    for quiet in [8, 20, 30] {
        let mut world = World::new(&[Setup::primary(), Setup::secondary()]);
        world.devices.push(device(15_000));
        let mut burst = Device::new(Box::new(|_| None));
        let mut data = vec![0, 0];
        data.extend(DATA_3);
        burst.burst = Some((quiet, seal(0x81, &[0x2E | 0x40, 0xDD, 0, 0, 7], 3, &data)));
        world.devices.push(burst);
        let mut counts = [0, 0];
        let end = 600_000_000;
        while world.now < end {
            for (master, count) in counts.iter_mut().enumerate() {
                if let Some(done) = world.links[master].done() {
                    assert!(done.outcome.is_ok(), "{done:?}");
                    *count += 1;
                }
                if !world.links[master].is_busy() {
                    ask(&mut world, master, command_3());
                }
            }
            world.step(end);
        }
        let ours = |r: &&world::Run| r.hit && matches!(r.by, By::Master(_));
        let hit = world.runs.iter().filter(ours).count();
        assert_eq!(hit, 0, "quiet {quiet}");
        let bursts = world.of(By::Device(1)).len();
        println!("burst after {quiet} characters: {counts:?} exchanges, {bursts} bursts");
        assert!(
            counts[0] > 100 && counts[1] > 100 && bursts > 100,
            "{counts:?} {bursts}"
        );
        let now = world.at();
        assert!(world.links.iter().all(|l| l.hears_bursts(now)));
        assert!(world.links[0].stats().bursts > 100);
    }
}

/// An answer that comes too late answers nothing, least of all the next request.
#[test]
fn a_late_answer_is_not_taken_for_another() {
    let mut world = World::new(&[Setup {
        retries: 0,
        ..Setup::primary()
    }]);
    // Command 9 names the variables in its request; the device is far too slow for the first.
    let mut count = 0;
    world.devices.push(Device::new(Box::new(move |request| {
        count += 1;
        let late = if count == 1 { 560_000 } else { 20_000 };
        Some((late, reply(request, [0, 0], &request[8..9])))
    })));
    ask(
        &mut world,
        0,
        Request::new(DEVICE, 9, &[0]).with_preambles(5),
    );
    assert_eq!(
        world.outcome(0, 9_000_000).unwrap().outcome,
        Err(Failure::Silence)
    );
    ask(
        &mut world,
        0,
        Request::new(DEVICE, 9, &[1]).with_preambles(5),
    );
    let answer = world.outcome(0, 20_000_000).unwrap().outcome.unwrap();
    assert_eq!(answer.data(), [1]);
    assert_eq!(world.links[0].stats().strays, 1);
    // The same for a command that the device has answered before: another one is not held up.
    assert!(world.runs.iter().all(|r| !r.hit));
}

/// Replies of other devices, to other masters, to other commands or of other extended commands.
#[test]
fn only_the_reply_to_the_request_answers_it() {
    let request = Request::new(DEVICE, 523, &[0, 64]);
    let frame = request.frame(true);
    assert_eq!(
        frame,
        [
            0x82, 0xAE, 0xDD, 1, 0x23, 0x45, 0x1F, 4, 2, 0x0B, 0, 0x40, 0xC4
        ]
    );
    let own = [0xAE, 0xDD, 1, 0x23, 0x45];
    let fits = |delimiter, address: &[u8], command, data: &[u8]| {
        let frame = seal(delimiter, address, command, data);
        let head = crate::hart::frame::Head::of(&frame).unwrap();
        request.fits(&head, &frame, true)
    };
    assert!(fits(0x86, &own, 31, &[0, 0, 2, 0x0B, 0, 0x40]));
    // With the burst bit of the device, and a refusal without the number.
    assert!(fits(
        0x86,
        &[0xEE, 0xDD, 1, 0x23, 0x45],
        31,
        &[0, 0, 2, 0x0B]
    ));
    assert!(fits(0x86, &own, 31, &[64, 0]));
    assert!(!fits(0x86, &own, 31, &[0, 0, 2, 0x0C, 0, 0x40]));
    assert!(!fits(0x86, &own, 30, &[0, 0, 2, 0x0B]));
    assert!(!fits(
        0x86,
        &[0x2E, 0xDD, 1, 0x23, 0x45],
        31,
        &[0, 0, 2, 0x0B]
    ));
    assert!(!fits(
        0x86,
        &[0xAE, 0xDD, 1, 0x23, 0x46],
        31,
        &[0, 0, 2, 0x0B]
    ));
    assert!(!fits(0x06, &[0x80], 31, &[0, 0, 2, 0x0B]));
    // A broadcast is answered by whoever is meant, with its own address.
    let all = Request::new(Address::BROADCAST, 11, &[0; 6]);
    let frame = seal(0x86, &own, 11, &[0, 0]);
    let head = crate::hart::frame::Head::of(&frame).unwrap();
    assert!(all.fits(&head, &frame, true) && !all.fits(&head, &frame, false));
    assert_eq!(all.frame(true)[1..6], [0x80, 0, 0, 0, 0]);
    assert_eq!(
        Request::new(Address::Short(5), 0, &[]).frame(false),
        [2, 5, 0, 0, 7]
    );
}

#[test]
fn one_request_at_a_time() {
    let mut link = Link::new(Setup::primary(), Micros::new(0));
    assert_eq!(link.next(Micros::new(0)), Next::Idle);
    link.ask(command_3(), Micros::new(0)).unwrap();
    assert!(link.is_busy());
    assert_eq!(link.ask(command_3(), Micros::new(0)), Err(command_3()));
}

/// A carrier, or a line that is never silent, holds us back; in the end that is said.
#[test]
fn a_line_that_is_never_free_is_said() {
    let mut link = Link::new(Setup::primary(), Micros::new(0));
    link.ask(command_3(), Micros::new(0)).unwrap();
    link.carrier(true, Micros::new(0));
    let mut now = Micros::new(0);
    for _ in 0..100_000 {
        match link.next(now) {
            Next::Transmit(_) => panic!("sent into a carrier"),
            Next::Wait(at) => now = at.max(now.plus(1)),
            Next::Idle => break,
        }
    }
    assert_eq!(link.done().unwrap().outcome, Err(Failure::Crowded));
    // And babble.
    let mut link = Link::new(Setup::secondary(), Micros::new(0));
    link.ask(command_3(), Micros::new(0)).unwrap();
    let mut now = Micros::new(0);
    while link.done().is_none() {
        now = now.plus(5_000);
        link.heard(&[0x55], now);
        assert!(!matches!(link.next(now), Next::Transmit(_)));
        assert!(now.get() < 60_000_000);
    }
}

/// Whatever is heard, whenever: no panic, and never a byte into somebody else's.
#[test]
fn anything_may_be_heard() {
    let mut seed = 7_u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        seed >> 33
    };
    let mut link = Link::new(Setup::primary(), Micros::new(0));
    let mut now = Micros::new(0);
    for _ in 0..20_000 {
        now = now.plus(random() % 40_000);
        let len = random() % 12;
        let pick = [0xFF, 0xFF, 0xFF, 0x86, 0x82, 0x06, 0xAE, 0x00, 0x03];
        let bytes: Vec<u8> = (0..len)
            .map(|_| match random() % 10 {
                0 => random() as u8,
                n => pick[(n as usize) % pick.len()],
            })
            .collect();
        link.heard(&bytes, now);
        if !link.is_busy() {
            link.ask(command_3(), now).unwrap();
        }
        if let Next::Transmit(_) = link.next(now) {
            now = now.plus(128_000);
            link.sent(now);
        }
        link.done();
        while link.event().is_some() {}
    }
}
