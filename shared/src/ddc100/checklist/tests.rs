use super::*;

const MX: Device = Device::Ddc100Mx;
const UEC: Device = Device::Ddc100Uec;
const IO: Device = Device::Ddc100Io;

const REACHED: Pair<Option<bool>> = Pair {
    one: Some(false),
    two: Some(false),
};

/// An image of registers, by number.
pub(crate) fn image(words: &[(u16, u16)]) -> Image {
    let mut image = Image::new();
    for (number, word) in words {
        let ([a, b], [c, d]) = ((number - 1).to_be_bytes(), word.to_be_bytes());
        let at = Micros::new(u64::from(*number) * 10);
        image.absorb(&[3, a, b, 0, 1], &[3, 2, c, d], at).unwrap();
    }
    image
}

/// A unit that may be moved: half open at 61 %, remote, without a fault. Channel B of a UEC is
/// not fitted.
const READY: [(u16, u16); 5] = [(8, 61), (9, 0x0004), (10, 0), (11, 0), (12, 0x0801)];

/// The same with one register changed.
fn but(number: u16, word: u16) -> Image {
    image(&READY.map(|(n, w)| (n, if n == number { word } else { w })))
}

/// The same with one register never read.
fn without(number: u16) -> Image {
    let words: Vec<_> = READY.into_iter().filter(|(n, _)| *n != number).collect();
    image(&words)
}

fn list(kind: Device, image: &Image, wish: Wish) -> Checklist {
    checklist(kind, image, REACHED, Scaling::Percent, wish)
}

/// The items in short: key and verdict.
fn short(list: &Checklist) -> Vec<(&'static str, &'static str)> {
    list.items
        .iter()
        .map(|i| (i.key, i.verdict.key()))
        .collect()
}

/// An item stands so, and says this.
fn says(list: &Checklist, key: &str, verdict: Verdict, words: &str) {
    let item = list.items.iter().find(|i| i.key == key);
    let item = item.unwrap_or_else(|| panic!("no item {key}"));
    assert_eq!(item.verdict, verdict, "{}", item.text);
    assert!(item.text.contains(words), "{:?} lacks {words:?}", item.text);
    assert!(item.source.contains("section") || item.source.contains("table"));
}

use Verdict::{Fail, Pass, Unknown};

#[test]
fn a_valve_that_may_be_opened() {
    let all = [
        ("communication", "pass"),
        ("remote", "pass"),
        ("combined_fault", "pass"),
        ("position", "pass"),
        ("torque", "pass"),
        ("emergency_shutdown", "pass"),
    ];
    let uec = list(UEC, &image(&READY), Wish::Open);
    assert_eq!(short(&uec), all);
    assert_eq!(uec.verdict(), Pass);
    let mx = list(MX, &image(&READY), Wish::Close);
    assert_eq!(short(&mx)[..6], all);
    assert_eq!(short(&mx)[6], ("local_stop", "pass"));
    assert_eq!(list(UEC, &image(&READY), Wish::MoveTo(30)).verdict(), Pass);
    // The oldest register counts: 9 was read before 12.
    assert_eq!(uec.items[1].at, Some(Micros::new(90)));
}

#[test]
fn communication_first() {
    let with = |one, two| {
        let faults = Pair { one, two };
        checklist(UEC, &image(&READY), faults, Scaling::Percent, Wish::Stop)
    };
    says(
        &with(Some(false), Some(false)),
        "communication",
        Pass,
        "both host ports",
    );
    says(
        &with(Some(true), Some(false)),
        "communication",
        Pass,
        "host port 2",
    );
    says(
        &with(Some(false), None),
        "communication",
        Pass,
        "host port 1",
    );
    says(
        &with(Some(true), Some(true)),
        "communication",
        Fail,
        "would not reach it",
    );
    says(
        &with(Some(true), None),
        "communication",
        Fail,
        "would not reach it",
    );
    says(
        &with(None, None),
        "communication",
        Unknown,
        "not polled yet",
    );
}

/// Reading D9: what bits 6 of register 9 and 0 of register 12 say, before and after 1999.
#[test]
fn d9_remote() {
    let open = |image: &Image| list(MX, image, Wish::Open);
    says(&open(&image(&READY)), "remote", Pass, "REMOTE");
    let local = image(&[(9, 0x0044), (12, 0x0800)]);
    says(&open(&local), "remote", Fail, "LOCAL or STOP");
    let old_stop = image(&[(9, 0x0004), (12, 0x0800)]);
    says(
        &open(&old_stop),
        "remote",
        Fail,
        "before the second quarter of 1999",
    );
    // The paragraphs on 1999 are about the MX.
    for kind in [UEC, Device::Ddc100Clamshell] {
        let list = list(kind, &old_stop, Wish::Open);
        says(&list, "remote", Fail, "Look at the selector");
        let text = &list.items.iter().find(|i| i.key == "remote").unwrap().text;
        assert!(!text.contains("1999"), "{text}");
    }
    says(
        &open(&but(9, 0x0044)),
        "remote",
        Fail,
        "register 9 says LOCAL",
    );
    says(
        &open(&without(12)),
        "remote",
        Unknown,
        "tells REMOTE from STOP",
    );
    says(
        &open(&without(9)),
        "remote",
        Unknown,
        "register 9 was not read",
    );
    says(
        &open(&image(&[(9, 0x0044)])),
        "remote",
        Fail,
        "LOCAL or STOP",
    );
    says(&open(&Image::new()), "remote", Unknown, "9 and 12");
}

#[test]
fn capable_of_movement() {
    says(
        &list(UEC, &but(9, 0x0184), Wish::Open),
        "combined_fault",
        Fail,
        "able to move",
    );
    says(
        &list(UEC, &without(9), Wish::Open),
        "combined_fault",
        Unknown,
        "Register 9",
    );
    says(
        &list(UEC, &image(&READY), Wish::Open),
        "combined_fault",
        Pass,
        "No combined fault",
    );
}

#[test]
fn not_there_already() {
    says(
        &list(UEC, &but(9, 0x0001), Wish::Open),
        "position",
        Fail,
        "open already",
    );
    says(
        &list(UEC, &but(9, 0x0001), Wish::Close),
        "position",
        Pass,
        "not closed yet",
    );
    says(
        &list(UEC, &but(9, 0x0002), Wish::Close),
        "position",
        Fail,
        "closed already",
    );
    says(
        &list(UEC, &without(9), Wish::Close),
        "position",
        Unknown,
        "Register 9",
    );
    says(
        &list(UEC, &image(&READY), Wish::MoveTo(61)),
        "position",
        Fail,
        "61 % already",
    );
    says(
        &list(UEC, &image(&READY), Wish::MoveTo(60)),
        "position",
        Pass,
        "61.0 %",
    );
    says(
        &list(UEC, &without(8), Wish::MoveTo(60)),
        "position",
        Unknown,
        "Register 8",
    );
    says(
        &list(UEC, &but(8, 0xFFFF), Wish::MoveTo(60)),
        "position",
        Unknown,
        "no position",
    );
    // 61 of 255 is 23.9 %.
    let bytes = checklist(
        UEC,
        &image(&READY),
        REACHED,
        Scaling::Byte,
        Wish::MoveTo(61),
    );
    says(&bytes, "position", Pass, "23.9 %");
}

/// The direction counts; for a move-to it follows from the position. Reading D8: the combined
/// fault does not include these bits.
#[test]
fn d8_torque_switches() {
    let open_tripped = but(9, 0x1004);
    says(
        &list(UEC, &open_tripped, Wish::Open),
        "torque",
        Fail,
        "open torque switch",
    );
    says(
        &list(UEC, &open_tripped, Wish::Open),
        "combined_fault",
        Pass,
        "No combined",
    );
    says(
        &list(UEC, &open_tripped, Wish::Close),
        "torque",
        Pass,
        "closing direction",
    );
    says(
        &list(UEC, &open_tripped, Wish::MoveTo(80)),
        "torque",
        Fail,
        "open torque switch",
    );
    says(
        &list(UEC, &open_tripped, Wish::MoveTo(20)),
        "torque",
        Pass,
        "closing direction",
    );
    let close_tripped = but(9, 0x2004);
    says(
        &list(MX, &close_tripped, Wish::Close),
        "torque",
        Fail,
        "close torque switch",
    );
    says(
        &list(MX, &close_tripped, Wish::Open),
        "torque",
        Pass,
        "opening direction",
    );
    let nowhere = image(&[(9, 0x1004), (10, 0), (12, 1)]);
    says(
        &list(UEC, &nowhere, Wish::MoveTo(80)),
        "torque",
        Unknown,
        "not known whether",
    );
    let free = image(&[(9, 0x0004), (10, 0), (12, 1)]);
    says(
        &list(UEC, &free, Wish::MoveTo(80)),
        "torque",
        Pass,
        "either direction",
    );
    says(
        &list(UEC, &without(9), Wish::Open),
        "torque",
        Unknown,
        "Register 9",
    );
}

#[test]
fn emergency_shutdown_and_local_stop() {
    says(
        &list(UEC, &but(10, 0x0400), Wish::Open),
        "emergency_shutdown",
        Fail,
        "network",
    );
    says(
        &list(UEC, &but(10, 0x0800), Wish::Open),
        "emergency_shutdown",
        Fail,
        "user input 0",
    );
    says(
        &list(UEC, &image(&READY), Wish::Open),
        "emergency_shutdown",
        Pass,
        "set to ignore it",
    );
    says(
        &list(UEC, &without(10), Wish::Open),
        "emergency_shutdown",
        Unknown,
        "Register 10",
    );
    // Bit 13 is local stop on an MX, and wrong rotation on a UEC.
    says(
        &list(MX, &but(10, 0x2000), Wish::Open),
        "local_stop",
        Fail,
        "Stopped at the valve",
    );
    says(
        &list(MX, &image(&READY), Wish::Open),
        "local_stop",
        Pass,
        "No local stop",
    );
    says(
        &list(MX, &without(10), Wish::Open),
        "local_stop",
        Unknown,
        "Register 10",
    );
    let uec = list(UEC, &but(10, 0x2000), Wish::Open);
    assert!(uec.items.iter().all(|i| i.key != "local_stop"));
}

/// Section 6.2, item 10: a stop needs nothing but the way to the unit.
#[test]
fn a_stop_works_always() {
    let bad = image(&[(9, 0x31C0), (10, 0x2C00), (12, 0)]);
    for kind in [MX, UEC] {
        let stop = list(kind, &bad, Wish::Stop);
        assert_eq!(short(&stop), [("communication", "pass")]);
        assert!(stop.notes.iter().any(|(text, _)| text.contains("LOCAL")));
    }
}

/// Item 5 and readings D21, D22.
#[test]
fn d21_d22_range_of_a_move_to() {
    for (percent, verdict, words) in [
        (2, Pass, "within 2 to 98"),
        (98, Pass, "within 2 to 98"),
        (0, Fail, "give Close"),
        (100, Fail, "give Open"),
        (1, Fail, "outside 2 to 98"),
        (99, Fail, "outside 2 to 98"),
        (101, Fail, "does not exist"),
        (255, Fail, "does not exist"),
    ] {
        let move_to = list(MX, &image(&READY), Wish::MoveTo(percent));
        says(&move_to, "range", verdict, words);
        assert!(
            move_to
                .notes
                .iter()
                .any(|(text, _)| text.contains("06 or 16"))
        );
    }
}

/// Item 3, and table 3.7: a module works relays, no valve.
#[test]
fn modules() {
    for wish in [Wish::Open, Wish::Close, Wish::Stop, Wish::MoveTo(50)] {
        says(
            &list(IO, &image(&READY), wish),
            "command",
            Fail,
            "works no valve",
        );
    }
    let idle = image(&[(11, 0x2000)]);
    let engage = list(IO, &idle, Wish::Engage(1));
    assert_eq!(
        short(&engage),
        [
            ("communication", "pass"),
            ("relay", "pass"),
            ("interlock", "pass")
        ]
    );
    // K1 (bit 7) is engaged when K2 (bit 6), the relay of command 2304, is wanted.
    let other = image(&[(11, 0x2080)]);
    says(
        &list(IO, &other, Wish::Engage(1)),
        "interlock",
        Unknown,
        "disengage that one first",
    );
    says(
        &list(IO, &other, Wish::Engage(2)),
        "relay",
        Fail,
        "engaged already",
    );
    assert_eq!(list(IO, &other, Wish::Disengage(2)).verdict(), Pass);
    says(
        &list(IO, &Image::new(), Wish::Engage(1)),
        "interlock",
        Unknown,
        "Register 11",
    );
    says(
        &list(IO, &idle, Wish::Engage(7)),
        "command",
        Fail,
        "no relay 7",
    );
}

/// Readings D2, D3: the bit that tells the state of a relay, by type.
#[test]
fn d2_d3_relays_of_each_type() {
    for (kind, relay, bit) in [
        (MX, 1, 2),
        (MX, 7, 8),
        (UEC, 3, 2),
        (UEC, 6, 5),
        (Device::Ddc100Clamshell, 4, 3),
        (IO, 1, 6),
        (IO, 2, 7),
        (IO, 3, 2),
    ] {
        let on = image(&[(9, 4), (11, 1 << bit), (12, 0x0801)]);
        says(
            &list(kind, &on, Wish::Engage(relay)),
            "relay",
            Fail,
            "engaged already",
        );
        says(
            &list(kind, &on, Wish::Disengage(relay)),
            "relay",
            Pass,
            "is engaged",
        );
        let off = image(&[(9, 4), (11, !(1_u16 << bit)), (12, 0x0801)]);
        says(
            &list(kind, &off, Wish::Engage(relay)),
            "relay",
            Pass,
            "is disengaged",
        );
        says(
            &list(kind, &off, Wish::Disengage(relay)),
            "relay",
            Fail,
            "disengaged already",
        );
        assert_eq!(
            short(&list(kind, &off, Wish::Engage(relay)))[1].0 == "remote",
            kind != IO
        );
    }
    for (kind, relay) in [
        (UEC, 1),
        (UEC, 4),
        (UEC, 7),
        (Device::Ddc100Clamshell, 2),
        (MX, 8),
        (MX, 0),
    ] {
        says(
            &list(kind, &image(&READY), Wish::Engage(relay)),
            "command",
            Fail,
            "no relay",
        );
    }
    assert_eq!(Wish::Engage(3).name(MX).as_deref(), Some("Engage AS-3"));
    assert_eq!(Wish::Engage(1).name(IO).as_deref(), Some("Engage relay K2"));
    assert_eq!(Wish::MoveTo(50).name(UEC).as_deref(), Some("Move to 50 %"));
    assert_eq!(Wish::Disengage(7).command(), Some(5888));
}

/// Function 04 reads the same registers, and the newer word counts.
#[test]
fn either_function_serves() {
    let mut image = image(&READY);
    let newer = Micros::new(10_000);
    image.absorb(&[4, 0, 8, 0, 1], &[4, 2, 0, 1], newer);
    says(
        &list(UEC, &image, Wish::Open),
        "position",
        Fail,
        "open already",
    );
}

#[test]
fn any_words_are_judged() {
    for kind in [
        MX,
        Device::Ddc100MxB,
        UEC,
        Device::Ddc100Clamshell,
        IO,
        Device::None,
    ] {
        for word in (0..=u16::MAX).step_by(251) {
            let image = image(&[(8, word), (9, word), (10, word), (11, word), (12, word)]);
            for wish in [
                Wish::Open,
                Wish::Close,
                Wish::Stop,
                Wish::MoveTo(7),
                Wish::Engage(3),
            ] {
                let list = list(kind, &image, wish);
                assert!(list.items.iter().all(|i| !i.text.is_empty()));
            }
        }
    }
}
