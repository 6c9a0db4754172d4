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

/// Half a second after everything was read, with a connection.
const NOW: Moment = Moment {
    now: Micros::new(500_000),
    most: 10_000_000,
    online: true,
};

fn list(kind: Device, image: &Image, wish: Wish) -> Checklist {
    checklist(kind, image, REACHED, Some(Scaling::Percent), NOW, wish)
}

/// The notes in one text.
fn notes_of(kind: Device, wish: Wish) -> String {
    let list = list(kind, &image(&READY), wish);
    let notes = list.notes.iter();
    notes
        .map(|(text, source)| format!("{text} ({source})\n"))
        .collect()
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

use Verdict::{Fail, Pass, Unknown, Warn};

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
        checklist(
            UEC,
            &image(&READY),
            faults,
            Some(Scaling::Percent),
            NOW,
            Wish::Stop,
        )
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
        Some(Scaling::Byte),
        NOW,
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
        (0, Warn, "better give Close"),
        (100, Warn, "better give Open"),
        (1, Warn, "outside 2 to 98"),
        (99, Warn, "outside 2 to 98"),
        (101, Fail, "does not exist"),
        (255, Fail, "does not exist"),
    ] {
        let move_to = list(MX, &image(&READY), Wish::MoveTo(percent));
        says(&move_to, "range", verdict, words);
        assert_eq!(move_to.verdict(), verdict);
        assert!(
            move_to
                .notes
                .iter()
                .any(|(text, _)| text.contains("06, or 16"))
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
                Wish::StartEsd,
                Wish::StopEsd,
            ] {
                let list = list(kind, &image, wish);
                assert!(list.items.iter().all(|i| !i.text.is_empty()));
            }
        }
    }
}

/// "Already there" is the count next to the position: 50 % of 255 is 127.5, of 4095 is 2047.5.
#[test]
fn there_already_on_each_scale() {
    for (scaling, word, percent, there) in [
        (Scaling::Byte, 126, 50, false),
        (Scaling::Byte, 127, 50, true),
        (Scaling::Byte, 128, 50, true),
        (Scaling::Byte, 129, 50, false),
        (Scaling::TwelveBits, 2047, 50, true),
        (Scaling::TwelveBits, 2048, 50, true),
        (Scaling::TwelveBits, 2049, 50, false),
        (Scaling::Percent, 50, 50, true),
        (Scaling::Percent, 49, 50, false),
        // 2 % of 255 is 5.1.
        (Scaling::Byte, 5, 2, true),
        (Scaling::Byte, 6, 2, false),
    ] {
        let image = but(8, word);
        let list = checklist(
            UEC,
            &image,
            REACHED,
            Some(scaling),
            NOW,
            Wish::MoveTo(percent),
        );
        let (verdict, words) = if there {
            (Fail, "already")
        } else {
            (Pass, "The valve is at")
        };
        says(&list, "position", verdict, words);
    }
    // No scale, no percent.
    let raw = checklist(
        UEC,
        &but(8, 50),
        REACHED,
        Some(Scaling::Raw),
        NOW,
        Wish::MoveTo(50),
    );
    says(&raw, "position", Unknown, "no position");
}

/// Section 3.2.6: the move-to in one step wants a unit that is scaled 0-100, and new firmware.
#[test]
fn rules_of_the_one_step_move() {
    let move_to = |scaling| {
        let wish = Wish::MoveTo(30);
        checklist(UEC, &image(&READY), REACHED, Some(scaling), NOW, wish)
    };
    says(&move_to(Scaling::Percent), "scale", Pass, "scaled 0-100");
    assert_eq!(move_to(Scaling::Percent).verdict(), Pass);
    says(&move_to(Scaling::Byte), "scale", Fail, "scaled 0-255");
    says(
        &move_to(Scaling::TwelveBits),
        "scale",
        Fail,
        "scaled 0-4095",
    );
    says(&move_to(Scaling::Raw), "scale", Unknown, "not known");
    assert_eq!(move_to(Scaling::Byte).verdict(), Fail);
    // Nobody said it: the default is no knowledge.
    let unsaid = checklist(UEC, &image(&READY), REACHED, None, NOW, Wish::MoveTo(30));
    says(&unsaid, "scale", Unknown, "nobody said it");
    assert_eq!(unsaid.verdict(), Unknown);
    // Open and Close do not count in percent.
    assert_eq!(
        checklist(
            UEC,
            &image(&READY),
            REACHED,
            Some(Scaling::Byte),
            NOW,
            Wish::Open
        )
        .verdict(),
        Pass
    );
    for (kind, words) in [
        (UEC, "from Modbus firmware 2.00 on"),
        (MX, "from firmware 02/01.00 on"),
        (Device::Ddc100Clamshell, "UEC-3-DDC and MX-DDC only"),
    ] {
        let notes = notes_of(kind, Wish::MoveTo(30));
        assert!(
            notes.contains(words) && notes.contains("(section 3.2.6)"),
            "{notes}"
        );
        assert!(notes.contains("register 2, then 6656"));
    }
}

/// Items 1, 4, 6, 7, 8, 9 and 10 of section 6.2 say how to command, not whether: they are notes.
#[test]
fn notes_have_the_words_of_the_guide() {
    let open = notes_of(UEC, Wish::Open);
    let close = notes_of(MX, Wish::Close);
    let (stop, move_to) = (notes_of(UEC, Wish::Stop), notes_of(UEC, Wish::MoveTo(50)));
    let engage = notes_of(MX, Wish::Engage(6));
    let all = [&open, &close, &stop, &move_to, &engage];
    for notes in all {
        // Item 1.
        assert!(notes.contains("between two polls, after an answer"));
        assert!(
            notes.contains(
                "Polling goes on after the acknowledge. (sections 4.3.2 and 6.2, item 1)"
            )
        );
        // Item 6.
        assert!(notes.contains("sent once, and again only if no acknowledge came"));
        assert!(notes.contains("repeating it can stop the valve. (section 6.2, item 6)"));
    }
    for notes in [&open, &close] {
        assert!(notes.contains("By function 05 or 06. (section 6.2, item 4)"));
        assert!(notes.contains(
            "stops by itself at the end of travel: no Stop is needed there. (section 6.2, item 7)"
        ));
        assert!(notes.contains("No Stop is needed before turning round"));
        assert!(
            notes.contains("the unit stops first, then runs the other way. (section 6.2, item 9)")
        );
    }
    assert!(engage.contains("By function 05 or 06. (section 6.2, item 4)"));
    assert!(notes_of(MX, Wish::Disengage(7)).contains("05 or 06 for relays 1 to 6 only"));
    assert!(move_to.contains("By function 06, or 16 (reading D22)"));
    assert!(move_to.contains("position control, which no register tells. (section 6.2, item 4)"));
    assert!(stop.contains(
        "bit 2 of register 9 (stopped) is 1 once the valve stands. (section 6.2, item 8)"
    ));
    assert!(stop.contains("works in REMOTE and in LOCAL. (section 6.2, item 10)"));
    assert!(
        engage.contains(
            "the first is disengaged before the second is engaged. (section 6.2, item 3)"
        )
    );
}

/// Table 3.7: 1280 and 1536; section 6.1, item 5 on bit 10 of register 10.
#[test]
fn emergency_shutdown_of_the_network() {
    assert_eq!(Wish::StartEsd.command(), Some(1280));
    assert_eq!(Wish::StopEsd.command(), Some(1536));
    assert_eq!(
        Wish::StartEsd.name(UEC).as_deref(),
        Some("Start network ESD")
    );
    assert_eq!(Wish::StopEsd.name(MX).as_deref(), Some("Stop network ESD"));
    assert_eq!(Wish::StartEsd.name(IO), None);
    let idle = image(&READY);
    let active = but(10, 0x0400);
    let start = list(UEC, &idle, Wish::StartEsd);
    says(&start, "network_esd", Pass, "No emergency shutdown");
    says(&start, "torque", Pass, "either direction");
    assert_eq!(start.verdict(), Pass);
    says(
        &list(UEC, &active, Wish::StartEsd),
        "network_esd",
        Fail,
        "active already",
    );
    says(
        &list(UEC, &active, Wish::StopEsd),
        "network_esd",
        Pass,
        "is active",
    );
    says(
        &list(UEC, &idle, Wish::StopEsd),
        "network_esd",
        Unknown,
        "set to ignore it",
    );
    says(
        &list(UEC, &without(10), Wish::StopEsd),
        "network_esd",
        Unknown,
        "Register 10",
    );
    says(
        &list(UEC, &but(12, 0x0800), Wish::StartEsd),
        "remote",
        Fail,
        "REMOTE",
    );
    says(
        &list(UEC, &but(9, 0x1004), Wish::StartEsd),
        "torque",
        Unknown,
        "not known whether",
    );
    says(
        &list(MX, &but(10, 0x2000), Wish::StartEsd),
        "local_stop",
        Fail,
        "Stopped",
    );
    says(
        &list(IO, &idle, Wish::StartEsd),
        "command",
        Fail,
        "works no valve",
    );
    assert!(notes_of(UEC, Wish::StartEsd).contains("a setting of it, which may be to ignore it"));
}

/// What was read too long ago is not known now, whatever it was.
#[test]
fn old_values_are_not_relied_on() {
    let at = |seconds: u64, image: &Image, wish| {
        let moment = Moment {
            now: Micros::new(seconds * 1_000_000),
            ..NOW
        };
        checklist(UEC, image, REACHED, Some(Scaling::Percent), moment, wish)
    };
    // Read at about 0.1 ms; ten seconds are allowed.
    assert_eq!(at(10, &image(&READY), Wish::Open).verdict(), Pass);
    let old = at(11, &image(&READY), Wish::Open);
    assert_eq!(old.verdict(), Unknown);
    assert!(
        old.items.iter().all(|i| i.verdict == Unknown),
        "{:?}",
        short(&old)
    );
    says(
        &old,
        "remote",
        Unknown,
        "Read 10 s ago, too long to rely on; it was: The selector stands at REMOTE.",
    );
    says(&old, "communication", Unknown, "last answer came 10 s ago");
    says(
        &at(60, &but(9, 1), Wish::Open),
        "position",
        Unknown,
        "it was: The valve is open already.",
    );
    // One old register among new ones.
    let mut mixed = image(&READY);
    let fresh = Micros::new(60_000_000);
    mixed.absorb(&[3, 0, 8, 0, 1], &[3, 2, 0, 4], fresh);
    let mixed = at(61, &mixed, Wish::Open);
    says(&mixed, "communication", Pass, "both host ports");
    says(&mixed, "combined_fault", Pass, "No combined fault");
    says(&mixed, "remote", Unknown, "Read 60 s ago");
    says(&mixed, "emergency_shutdown", Unknown, "Read 60 s ago");
    // What rests on no register stays.
    says(
        &at(60, &image(&READY), Wish::MoveTo(101)),
        "range",
        Fail,
        "does not exist",
    );
}

#[test]
fn without_a_connection_nothing_is_known() {
    let off = Moment {
        online: false,
        ..NOW
    };
    let list =
        |image: &Image, wish| checklist(UEC, image, REACHED, Some(Scaling::Percent), off, wish);
    let open = list(&image(&READY), Wish::Open);
    assert!(
        open.items.iter().all(|i| i.verdict == Unknown),
        "{:?}",
        short(&open)
    );
    says(&open, "communication", Unknown, "No connection");
    says(
        &open,
        "combined_fault",
        Unknown,
        "No connection; when it was read last: No combined fault.",
    );
    says(
        &list(&without(9), Wish::Open),
        "combined_fault",
        Unknown,
        "Register 9 was not read",
    );
    assert_eq!(list(&image(&READY), Wish::Stop).verdict(), Unknown);
}
