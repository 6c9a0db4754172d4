//! Masters and neighbours on one line, character by character in simulated time: nobody of ours
//! ever begins while another sends, and everybody gets a fair share.
//!
//! The line is `shared::sim::hart`: its second master and its burst neighbour are written apart
//! from the link layer of the product.

use shared::capture::Micros;
use shared::device::Family;
use shared::hart::frame::Address;
use shared::hart::link::{Link, Next, Request, Setup};
use shared::sim::hart::{
    Character, HartBurst, HartDevice, HartMaster, HartSetup, Medium, Party, characters,
};

const BAUD: u32 = 1200;
const HOUR: u64 = 3_600_000_000;
/// Devices on every line here: polling address and device id.
const DEVICES: [(u8, u32); 2] = [(1, 0x01_2345), (2, 0x01_2346)];

/// Our link layer as a party of the line. It asks the devices in turn, as fast as it may.
struct Ours {
    link: Link,
    round: usize,
    due: Option<Micros>,
    /// True if its modem tells of the carriers of others.
    detects: bool,
    answered: u32,
    failed: Vec<String>,
}

impl Ours {
    fn new(primary: bool) -> Self {
        let setup = if primary {
            Setup::primary()
        } else {
            Setup::secondary()
        };
        Self {
            link: Link::new(setup, Micros::new(0)),
            round: 0,
            due: Some(Micros::new(0)),
            detects: true,
            answered: 0,
            failed: Vec::new(),
        }
    }

    fn pump(&mut self, now: Micros) -> Option<Vec<u8>> {
        if let Some(done) = self.link.done() {
            match done.outcome {
                Ok(answer) if answer.code() == Some(0) => self.answered += 1,
                other => self.failed.push(format!("{now}: {other:?}")),
            }
        }
        if !self.link.is_busy() {
            let (_, id) = DEVICES[self.round % DEVICES.len()];
            let command = [3, 48, 9][self.round % 3];
            let data: &[u8] = if command == 9 { &[1, 2, 3] } else { &[] };
            self.round += 1;
            let request = Request::new(Address::Long(0x2EDD, id), command, data);
            let asked = self.link.ask(request.with_preambles(5), now);
            assert!(asked.is_ok(), "it is not busy");
        }
        match self.link.next(now) {
            Next::Transmit(bytes) => {
                self.due = None;
                Some(bytes)
            }
            Next::Wait(until) => {
                self.due = Some(until);
                None
            }
            Next::Idle => {
                self.due = None;
                None
            }
        }
    }
}

impl Party for Ours {
    fn hear(&mut self, character: Character, at: Micros) {
        let damage = if character.sound { 0 } else { 0x5A };
        self.link.heard(&[character.byte ^ damage], at);
        self.due = Some(at);
    }

    fn carrier(&mut self, on: bool, at: Micros) {
        if self.detects {
            self.link.carrier(on, at);
            self.due = Some(at);
        }
    }

    fn due(&self) -> Option<Micros> {
        self.due
    }

    fn act(&mut self, now: Micros) -> Option<Vec<u8>> {
        self.pump(now)
    }

    fn sent(&mut self, at: Micros) {
        self.link.sent(at);
        self.due = Some(at);
    }
}

fn devices() -> Vec<HartDevice> {
    let device = |(polling, device_id)| {
        let setup = HartSetup {
            polling,
            device_id,
            ..HartSetup::of(Family::Iq)
        };
        HartDevice::new("FV-401", setup)
    };
    DEVICES.into_iter().map(device).collect()
}

/// A second master that asks the same devices as fast as it may.
fn other(primary: bool, period_ms: u32) -> HartMaster {
    let mut master = HartMaster::new(BAUD, primary, period_ms);
    for (_, id) in DEVICES {
        let [_, a, b, c] = u32::to_be_bytes(id);
        master.ask(&[0x2E, 0xDD, a, b, c], 3, &[]);
    }
    master
}

/// Lets them share a line and gives the medium; all transmissions of the last minutes are kept.
fn share(parties: &mut [&mut dyn Party], us: u64) -> Medium {
    let mut medium = Medium::new(BAUD, 4_000);
    medium.run(parties, Micros::new(us));
    medium
}

/// Nothing collided, and every transmission that is remembered was whole.
fn assert_clean(medium: &Medium) {
    assert_eq!(medium.collisions(), [], "first of them above");
    assert!(medium.history().all(|sent| !sent.collided));
    assert!(medium.history().count() > 1_000, "the line was used");
}

/// Of two shares the smaller is at least so many percent of the larger.
fn assert_fair(one: u32, other: u32, percent: u32) {
    let (small, large) = (one.min(other), one.max(other));
    assert!(
        small * 100 >= large * percent,
        "{one} and {other} exchanges"
    );
}

/// An hour of two of our masters beside a burst device.
fn hour_with_bursts(detects: bool) {
    let mut devices = devices();
    let (mut primary, mut secondary) = (Ours::new(true), Ours::new(false));
    (primary.detects, secondary.detects) = (detects, detects);
    let mut burst = HartBurst::new(BAUD, 5, 0);
    let [one, two] = &mut devices[..] else {
        panic!("two devices");
    };
    let medium = share(
        &mut [&mut primary, &mut secondary, &mut burst, one, two],
        HOUR,
    );
    let shares = (primary.answered, secondary.answered, burst.sent_bursts());
    println!("carriers told {detects}: primary, secondary, bursts {shares:?}");
    assert_clean(&medium);
    assert_eq!(
        (&primary.failed[..], &secondary.failed[..]),
        (&[][..], &[][..])
    );
    assert_fair(primary.answered, secondary.answered, 90);
    // A burst follows every answer.
    let answers = primary.answered + secondary.answered;
    assert!(burst.sent_bursts() >= answers, "{}", burst.sent_bursts());
    // Request and answer of command 3 with the turns between take at most 0.75 s, a burst 0.25 s:
    // the readings say about 2 a second, so an hour has room for at least 3000 of the three.
    assert!(answers > 3_000, "{answers}");
}

#[test]
fn two_of_our_masters_share_an_hour_with_a_burst_device() {
    hour_with_bursts(true);
}

#[test]
fn they_do_so_without_being_told_of_carriers() {
    hour_with_bursts(false);
}

#[test]
fn two_of_our_masters_share_an_hour_alone() {
    let mut devices = devices();
    let (mut primary, mut secondary) = (Ours::new(true), Ours::new(false));
    let [one, two] = &mut devices[..] else {
        panic!("two devices");
    };
    let medium = share(&mut [&mut primary, &mut secondary, one, two], HOUR);
    println!("alone: {} and {}", primary.answered, secondary.answered);
    assert_clean(&medium);
    assert_eq!(
        (&primary.failed[..], &secondary.failed[..]),
        (&[][..], &[][..])
    );
    assert_fair(primary.answered, secondary.answered, 90);
    assert!(primary.answered + secondary.answered > 5_000);
}

#[test]
fn ours_shares_with_a_master_that_is_not_ours() {
    for ours_is_primary in [true, false] {
        for (period_ms, bursts) in [(0, false), (1_500, false), (0, true)] {
            let mut devices = devices();
            let mut ours = Ours::new(ours_is_primary);
            let mut master = other(!ours_is_primary, period_ms);
            let mut burst = HartBurst::new(BAUD, 5, 0);
            let [one, two] = &mut devices[..] else {
                panic!("two devices");
            };
            let mut parties: Vec<&mut dyn Party> = vec![&mut ours, &mut master, one, two];
            if bursts {
                parties.push(&mut burst);
            }
            let medium = share(&mut parties, HOUR / 4);
            drop(parties);
            let case = format!("primary {ours_is_primary}, {period_ms} ms, bursts {bursts}");
            let (sent, answered, given_up) = master.counts();
            println!("{case}: ours {}, the other {answered}", ours.answered);
            assert_eq!(medium.collisions(), [], "{case}");
            assert_eq!(ours.failed, [""; 0], "{case}");
            assert_eq!(given_up, 0, "{case}");
            // The last one may be under way.
            assert!(sent <= answered + 1, "{case}: {sent} {answered}");
            if period_ms == 0 {
                assert_fair(ours.answered, answered, 80);
            } else {
                assert!(answered > 500, "{case}: {answered}");
            }
        }
    }
}

/// Two masters that are not ours, as a check of the line itself.
#[test]
fn the_other_masters_get_along_too() {
    for bursts in [false, true] {
        let mut devices = devices();
        let (mut primary, mut secondary) = (other(true, 0), other(false, 0));
        let mut burst = HartBurst::new(BAUD, 5, 0);
        let [one, two] = &mut devices[..] else {
            panic!("two devices");
        };
        let mut parties: Vec<&mut dyn Party> = vec![&mut primary, &mut secondary, one, two];
        if bursts {
            parties.push(&mut burst);
        }
        let medium = share(&mut parties, HOUR / 12);
        drop(parties);
        assert_eq!(medium.collisions(), [], "{bursts}");
        assert_fair(primary.counts().1, secondary.counts().1, 80);
    }
}

/// The line itself: two that begin at the same time spoil each other, and it is noticed.
#[test]
fn who_begins_together_collides() {
    struct Shouts(Option<Micros>, Vec<Character>);
    impl Party for Shouts {
        fn hear(&mut self, character: Character, _: Micros) {
            self.1.push(character);
        }
        fn due(&self) -> Option<Micros> {
            self.0
        }
        fn act(&mut self, _: Micros) -> Option<Vec<u8>> {
            self.0 = None;
            Some(vec![0x55; 4])
        }
    }
    let start = 1_000_000;
    let second = start + characters(1, BAUD) * 5 / 2;
    let mut one = Shouts(Some(Micros::new(start)), Vec::new());
    let mut two = Shouts(Some(Micros::new(second)), Vec::new());
    let mut ear = Shouts(None, Vec::new());
    let medium = share(&mut [&mut one, &mut two, &mut ear], 2_000_000);
    let [collision] = medium.collisions() else {
        panic!("{:?}", medium.collisions());
    };
    assert_eq!((collision.first, collision.second), (0, 1));
    assert_eq!(collision.at, Micros::new(second));
    // Two characters went alone, the next two and the first two of the other were spoilt.
    let sound: Vec<bool> = ear.1.iter().map(|c| c.sound).collect();
    assert_eq!(sound[..2], [true; 2]);
    assert_eq!(sound.iter().filter(|s| **s).count(), 4, "{sound:?}");
    assert!(one.1.len() < 4, "who sends hears nothing meanwhile");
}
