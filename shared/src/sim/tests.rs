mod faults;

use super::*;

/// Noon of 23 November 2026, UTC.
const NOON: u64 = 1_795_435_200;

/// A device that does nothing by itself, switched on.
fn idle(model: Model) -> Icon3000 {
    let mut icon = Icon3000::new(model, "XV-1", Programme::Idle);
    icon.advance(Micros::new(0), NOON);
    icon
}

fn v2() -> Icon3000 {
    idle(Model::Icon3000v2)
}

/// Sends a PDU as hexadecimal text and compares the answer.
fn check(icon: &mut Icon3000, asked: &str, answered: &str) {
    let (pdu, _) = crate::text::read_hex(asked.as_bytes());
    let answer = icon.answer(&pdu).unwrap();
    let (expected, _) = crate::text::read_hex(answered.as_bytes());
    assert_eq!(answer, expected, "{asked}");
}

fn register(icon: &mut Icon3000, address: u16) -> u16 {
    let [high, low] = address.to_be_bytes();
    match icon.answer(&[3, high, low, 0, 1]).unwrap()[..] {
        [3, 2, high, low] => u16::from_be_bytes([high, low]),
        ref other => panic!("{other:?}"),
    }
}

fn write(icon: &mut Icon3000, address: u16, value: u16) {
    let [a, b] = address.to_be_bytes();
    let [c, d] = value.to_be_bytes();
    assert_eq!(icon.answer(&[6, a, b, c, d]).unwrap(), [6, a, b, c, d]);
}

/// Lets so many seconds pass.
fn wait(icon: &mut Icon3000, seconds: u64) {
    let now = icon.now.get() + seconds * 1_000_000;
    icon.advance(Micros::new(now), NOON + now / 1_000_000);
}

fn log_in(icon: &mut Icon3000, level: u8, password: &[u8; 8]) {
    let mut pdu = vec![16, 0x0D, 0x9A, 0, 5, 10, 0, level];
    pdu.extend(password);
    assert_eq!(icon.answer(&pdu).unwrap(), [16, 0x0D, 0x9A, 0, 5]);
}

/// Sections 8.1 to 8.4: limits of quantity give 03, of addresses 02; readings E53, E55, E56.
#[test]
fn reads_are_limited_as_the_manual_says() {
    let mut icon = v2();
    for (asked, answered) in [
        ("01 0000 0000", "81 03"),
        ("01 0000 000C", "81 03"),
        ("01 0001 000B", "81 02"),
        ("01 000B 0001", "81 02"),
        ("01 0000 000B", "01 02 00 00"),
        ("02 0000 0021", "82 03"),
        ("02 001F 0002", "82 02"),
        ("03 0000 0000", "83 03"),
        ("03 0000 007E", "83 03"),
        ("03 0F95 0001", "83 02"),
        ("03 0F94 0002", "83 02"),
        ("03 FFFF 0001", "83 02"),
        ("03 0F94 0001", "03 02 0000"),
        ("03 002C 0002", "03 04 9000 0001"),
        ("04 0171 0001", "84 02"),
        ("04 0170 0002", "84 02"),
        ("04 0000 007E", "84 03"),
        // Quantity goes before address (reading E81).
        ("03 FFFF 007E", "83 03"),
        ("03 00", "83 03"),
        ("03 0000 0001 00", "83 03"),
    ] {
        check(&mut icon, asked, answered);
    }
}

/// Table 6 and section 8.11: FC 20 on the ICON3000v2 only; reading E56 for the end of its registers.
#[test]
fn models_differ() {
    let mut old = idle(Model::Icon3000);
    check(&mut old, "03 0D91 0001", "03 02 2020");
    check(&mut old, "03 0D92 0001", "83 02");
    check(&mut old, "14 07 06 0002 0000 0001", "94 01");
    for function in [7_u8, 11, 12, 21, 22, 23, 24, 43, 65, 100] {
        assert_eq!(
            v2().answer(&[function, 0, 0]).unwrap(),
            [function | 0x80, 1]
        );
    }
    assert_eq!(v2().answer(&[]), None);
}

/// The same values in all tables (E41, E44): positions, limits, dates, torque.
#[test]
fn tables_agree() {
    let mut icon = v2();
    write(&mut icon, 3008, command::OPEN);
    wait(&mut icon, 9);
    let position = register(&mut icon, 3004);
    assert!((300..500).contains(&position), "{position}");
    let torque = register(&mut icon, 3005).cast_signed();
    assert!((-60..0).contains(&torque), "towards open: {torque}");
    let answer = icon.answer(&[4, 0, 0, 0, 2]).unwrap();
    let [p0, p1] = position.to_be_bytes();
    let [t0, t1] = torque.to_be_bytes();
    assert_eq!(answer, [4, 4, p0, p1, t0, t1]);
    // Moving, monitor relay, remote; opening.
    let status = register(&mut icon, 3001);
    assert_eq!(status & 0xFF, 0b0010_1100);
    assert_eq!(register(&mut icon, 3002) & 0b110, 0b010);
    let inputs = icon.answer(&[2, 0, 0, 0, 32]).unwrap();
    let words = [
        status.to_le_bytes(),
        register(&mut icon, 3002).to_le_bytes(),
    ]
    .concat();
    assert_eq!(inputs[2..5], words[..3]);
    assert_eq!(inputs[5], words[3] & 0x1F, "29 to 31 are no mirrors");
    for (input, holding, count) in [
        (14, 3078, 2),
        (45, 3090, 50),
        (95, 3074, 4),
        (113, 3200, 256),
    ] {
        for n in 0..count {
            assert_eq!(
                icon.store.input(input + n),
                register(&mut icon, holding + n)
            );
        }
    }
    for (old, new, count) in [
        (0, 3008, 1),
        (15, 3023, 4),
        (3742, 3042, 14),
        (3610, 3028, 1),
    ] {
        for n in 0..count {
            assert_eq!(register(&mut icon, old + n), register(&mut icon, new + n));
        }
    }
}

/// Table 5, notes 2 and 3: 0xDDMM 0xYYYY, 0x00HH 0xMMSS.
#[test]
fn the_clock_is_bcd_and_can_be_set() {
    let mut icon = v2();
    wait(&mut icon, 3661);
    check(&mut icon, "03 0BCF 0004", "03 08 2311 2026 0013 0101");
    // 31 December 1999, 23:59:59, in one request; a second later it is 2000.
    check(
        &mut icon,
        "10 000F 0004 08 3112 1999 0023 5959",
        "10 000F 0004",
    );
    check(&mut icon, "03 0BCF 0004", "03 08 3112 1999 0023 5959");
    wait(&mut icon, 1);
    check(&mut icon, "03 0BCF 0004", "03 08 0101 2000 0000 0000");
    // The thirtieth of February does not exist.
    check(&mut icon, "06 000F 3002", "06 000F 3002");
    check(&mut icon, "03 0BCF 0001", "03 02 0101");
}

#[test]
fn dates_by_hand() {
    let check = |seconds, year, month, day| {
        let stamp = Stamp::at(seconds);
        assert_eq!((stamp.year, stamp.month, stamp.day), (year, month, day));
        assert_eq!(stamp.seconds(), Some(seconds));
    };
    check(0, 1970, 1, 1);
    check(946_684_800, 2000, 1, 1);
    check(951_782_400, 2000, 2, 29);
    check(951_868_800, 2000, 3, 1);
    check(4_107_542_399, 2100, 2, 28);
    check(4_107_542_400, 2100, 3, 1);
    check(NOON, 2026, 11, 23);
}

/// Note 1: enumerated commands are cleared at the end of travel; HR 0 and 3008 are one.
#[test]
fn registers_move_the_valve() {
    let mut icon = v2();
    write(&mut icon, 0, command::OPEN);
    assert_eq!(register(&mut icon, 3008), command::OPEN);
    wait(&mut icon, 10);
    assert!((350..480).contains(&icon.position()));
    write(&mut icon, 0, command::CLOSE);
    wait(&mut icon, 20);
    assert_eq!(icon.position(), 0);
    assert_eq!(register(&mut icon, 0), command::NONE);
    write(&mut icon, 0, command::OPEN);
    wait(&mut icon, 30);
    assert_eq!((icon.position(), register(&mut icon, 0)), (1000, 0));
    assert_eq!(register(&mut icon, 3001) & 3, 0b10, "open limit");
    write(&mut icon, 0, command::ESD);
    wait(&mut icon, 30);
    assert_eq!((icon.position(), register(&mut icon, 0)), (0, command::ESD));
}

/// Section 7.2, note 1, and E36: open is coil 0 and bit 1.
#[test]
fn coils_move_the_valve() {
    let mut icon = v2();
    check(&mut icon, "05 0000 FF00", "05 0000 FF00");
    check(&mut icon, "01 0000 0004", "01 01 01");
    assert_eq!(register(&mut icon, 3006), bit::OPEN);
    wait(&mut icon, 12);
    assert!((400..600).contains(&icon.position()));
    // Clearing it without stop does nothing; the other reverses it.
    check(&mut icon, "05 0000 0000", "05 0000 0000");
    assert_eq!(register(&mut icon, 3006), bit::OPEN);
    check(&mut icon, "05 0001 FF00", "05 0001 FF00");
    assert_eq!(register(&mut icon, 3006), bit::CLOSE);
    wait(&mut icon, 2);
    assert_eq!(register(&mut icon, 3002) & 0b110, 0b100, "closing");
    check(&mut icon, "05 0002 FF00", "05 0002 FF00");
    let stopped = {
        wait(&mut icon, 1);
        icon.position()
    };
    wait(&mut icon, 10);
    assert_eq!(icon.position(), stopped);
    check(&mut icon, "05 0001 0000", "05 0001 0000");
    check(&mut icon, "05 0002 0000", "05 0002 0000");
    wait(&mut icon, 10);
    assert_eq!(icon.position(), stopped, "nothing is left of the command");
    // ESD goes before everything (ESD action: close).
    check(&mut icon, "0F 0000 0005 01 08", "0F 0000 0005");
    wait(&mut icon, 30);
    assert_eq!(icon.position(), 0);
    assert_eq!(register(&mut icon, 3002) & 1 << 14, 1 << 14);
}

/// Section 9.2: difference greater than the dead band, and a pause between two starts.
#[test]
fn the_positioner_positions() {
    let mut icon = v2();
    // Table 24: positioner mode, 50.0 %, dead band 1.0 %.
    check(&mut icon, "10 0000 0003 06 0004 01F4 000A", "10 0000 0003");
    wait(&mut icon, 20);
    assert_eq!(icon.position(), 500);
    write(&mut icon, 3007, 509);
    wait(&mut icon, 10);
    assert_eq!(icon.position(), 500, "within the dead band");
    write(&mut icon, 3007, 511);
    wait(&mut icon, 10);
    assert_eq!(icon.position(), 511);
    assert_eq!(register(&mut icon, 3002) & 1 << 6, 1 << 6);
}

/// Sections 8.5, 8.6, 8.8, 8.9.
#[test]
fn writes_are_checked() {
    let mut icon = v2();
    for (asked, answered) in [
        ("05 000B FF00", "85 02"),
        ("05 0000 FF01", "85 03"),
        ("05 000B 1234", "85 03"),
        ("05 0006 FF00", "05 0006 FF00"),
        ("06 0000 0007", "86 03"),
        ("06 0BBF 03E9", "86 03"),
        ("06 0F95 0000", "86 02"),
        ("06 0BBC 0001", "06 0BBC 0001"),
        ("06 0F8D 0000", "86 03"),
        ("0F 0000 000C 02 0000", "8F 03"),
        ("0F 0000 0005 02 0000", "8F 03"),
        ("0F 0008 0004 01 00", "8F 02"),
        ("10 0000 0000 00", "90 03"),
        ("10 0000 0002 03 000000", "90 03"),
        ("10 0F94 0002 04 0000 0000", "90 02"),
        ("10 0000 0002 04 0000 03E9", "90 03"),
        ("10 0000 0002 04 0000 03E8", "10 0000 0002"),
    ] {
        check(&mut icon, asked, answered);
    }
    // A refused block changes nothing; a read-only register does not change either.
    assert_eq!(register(&mut icon, 1), 1000);
    assert_eq!(register(&mut icon, 3004), 0);
    assert_eq!(register(&mut icon, 3006), 0, "coil 6 is reserved");
}

/// Section 11: without the level a write is discarded and nobody is told (E65); readings E22, E83.
#[test]
fn levels_decide_silently() {
    let mut icon = v2();
    assert_eq!(register(&mut icon, 3480), 1, "power-up is USER");
    write(&mut icon, 3920, 0);
    assert_eq!(register(&mut icon, 3920), 1, "SERVICE only");
    log_in(&mut icon, 2, b"wrong   ");
    assert_eq!(register(&mut icon, 3480), 1);
    log_in(&mut icon, 2, b"SERVICE0");
    assert_eq!(register(&mut icon, 3480), 2);
    check(&mut icon, "03 0D9B 0004", "03 08 0000 0000 0000 0000");
    write(&mut icon, 3920, 0);
    assert_eq!(
        (register(&mut icon, 3920), register(&mut icon, 3027)),
        (0, 0)
    );
    log_in(&mut icon, 0, b"        ");
    assert_eq!(register(&mut icon, 3480), 0);
    check(&mut icon, "05 0000 FF00", "05 0000 FF00");
    assert_eq!(register(&mut icon, 3006), 0, "an observer commands nothing");
    log_in(&mut icon, 1, b"USER0000");
    assert_eq!(register(&mut icon, 3480), 1);
}

/// Passwords and commands that read as 0 (notes 6, 7, 13; E48).
#[test]
fn some_registers_read_as_zero() {
    let mut icon = v2();
    assert!(register(&mut icon, 3090) > 0);
    for address in [3014, 3015, 3555, 3985, 3986] {
        write(&mut icon, address, 1);
        assert_eq!(register(&mut icon, address), 0, "{address}");
    }
    assert_eq!(register(&mut icon, 3090), 0, "the log was cleared");
    write(&mut icon, 3948, 0x3132);
    assert_eq!(register(&mut icon, 3948), 0);
}

/// Section 8.7 with readings E59 and E60.
#[test]
fn diagnostics_count() {
    let mut icon = v2();
    check(&mut icon, "08 0000 A5B6", "08 0000 A5B6");
    check(&mut icon, "08 0000 A5B6 01", "08 0000 A5B6 01");
    check(&mut icon, "08 0001 0000", "88 01");
    check(&mut icon, "08 000A 0000", "88 01");
    check(&mut icon, "08 000B 0001", "88 03");
    check(&mut icon, "08 000D 0000", "08 000D 0003");
    check(&mut icon, "08 000E 0000", "08 000E 0007");
    icon.overheard(true);
    icon.overheard(false);
    icon.overheard(false);
    // This is the eighth message for it, and one was for another unit.
    check(&mut icon, "08 000B 0000", "08 000B 0009");
    check(&mut icon, "08 000C 0000", "08 000C 0002");
    icon.set_busy(true);
    check(&mut icon, "03 0000 0001", "83 06");
    icon.set_busy(false);
    check(&mut icon, "08 0011 0000", "08 0011 0001");
    check(&mut icon, "08 0012 0000", "08 0012 0000");
    // HR 3531 to 3536: 11, 14, 12, 13, 17, 18.
    check(
        &mut icon,
        "03 0DCB 0006",
        "03 0C 000E 000D 0002 0004 0001 0000",
    );
    icon.overrun();
    check(&mut icon, "08 0012 0000", "08 0012 0001");
    // A broadcast is a message on the bus and for this unit.
    icon.broadcast(&[6, 0x0B, 0xC9, 0, 12]);
    check(&mut icon, "08 000B 0000", "08 000B 0011");
    check(&mut icon, "08 000E 0000", "08 000E 0011");
    // HR 3537 to 3542 are those of the other channel, which has counts of its own.
    let other: Vec<u16> = (3537..=3542).map(|at| register(&mut icon, at)).collect();
    assert!(other.iter().all(|count| *count > 0) && other[0] >= other[1]);
}

/// Section 8.10, table 29, reading E63.
#[test]
fn the_report_counts_as_printed_or_as_the_standard() {
    let mut icon = v2();
    let report = icon.answer(&[17]).unwrap();
    assert_eq!(report.len(), 86);
    assert_eq!(report[..4], [17, 0x52, 0, 0]);
    assert_eq!(&report[4..20], b"Biffi ICON3000  ");
    assert_eq!(&report[48..52], b"XV-1");
    assert_eq!(&report[76..], b"9.02  4.01");
    icon.set_full_report(true);
    assert_eq!(icon.answer(&[17]).unwrap()[1], 0x54);
}

/// Section 8.11.1: number, then seconds since 2000 and code, the latest first.
#[test]
fn logs_are_files_too() {
    let mut icon = v2();
    let file = icon.answer(&[20, 7, 6, 0, 2, 0, 0, 0, 7]).unwrap();
    assert_eq!(file[..6], [20, 16, 15, 6, 0, 2]);
    let seconds = u32::from_be_bytes([file[6], file[7], file[8], file[9]]);
    let stamp = Stamp::at(u64::from(seconds) + 946_684_800);
    assert_eq!(register(&mut icon, 3091), stamp.date()[0]);
    assert_eq!(register(&mut icon, 3094), stamp.time()[1]);
    assert_eq!(
        register(&mut icon, 3090),
        u16::from_be_bytes([file[10], file[11]])
    );
    for (asked, answered) in [
        ("14 07 06 0002 0000 0008", "94 02"),
        ("14 07 06 0006 0000 0001", "94 02"),
        ("14 07 07 0002 0000 0001", "94 02"),
        ("14 06 06 0002 0000 0001", "94 03"),
        ("14 00", "94 03"),
        (
            "14 0E 06 0002 0000 0001 06 0003 0000 0001",
            "14 08 03 06 0002 03 06 0002",
        ),
    ] {
        check(&mut icon, asked, answered);
    }
}

/// Section 5: nobody answers a broadcast; writes are carried out, reads are not allowed.
#[test]
fn broadcasts_are_obeyed_in_silence() {
    let mut icon = v2();
    icon.broadcast(&[5, 0, 0, 0xFF, 0]);
    assert_eq!(register(&mut icon, 3006), bit::OPEN);
    let before = icon.counters.exceptions;
    icon.broadcast(&[3, 0, 0, 0, 0]);
    assert_eq!(icon.counters.exceptions, before);
}

/// Section 9.3: ten seconds and the delay after the last message.
#[test]
fn without_a_bus_the_valve_goes_to_its_safe_place() {
    let mut icon = v2();
    write(&mut icon, 3019, 4);
    write(&mut icon, 3020, 5);
    write(&mut icon, 3021, 30);
    wait(&mut icon, 14);
    assert_eq!(icon.position(), 0);
    wait(&mut icon, 20);
    assert_eq!(icon.position(), 300);
}

/// Section 12: only with EFS input mode 0 and interlock mode 1, from the open end.
#[test]
fn a_partial_stroke_is_partial() {
    let mut icon = v2();
    write(&mut icon, 0, command::OPEN);
    wait(&mut icon, 30);
    write(&mut icon, 0, command::PST);
    wait(&mut icon, 5);
    // It coasts by less than half a percent.
    let position = icon.position();
    assert!(
        (845..=850).contains(&position),
        "travel is 15 %: {position}"
    );
    assert_eq!(register(&mut icon, 3002) & 1 << 15, 1 << 15);
    wait(&mut icon, 10);
    assert_eq!((icon.position(), register(&mut icon, 3516)), (1000, 1));
    assert_eq!(
        register(&mut icon, 0),
        command::NONE,
        "cleared by the device"
    );
    log_in(&mut icon, 2, b"SERVICE0");
    write(&mut icon, 3920, 0);
    write(&mut icon, 0, command::PST);
    wait(&mut icon, 5);
    assert_eq!(icon.position(), 1000, "ignored");
}

/// Note 12: 101 samples, then date, time, temperatures, voltage and time of the stroke.
#[test]
fn a_full_stroke_leaves_its_curve() {
    let mut icon = v2();
    write(&mut icon, 0, command::OPEN);
    wait(&mut icon, 30);
    let curve = icon.store.run(3328, 64);
    assert!(
        curve[..101].iter().all(|s| (1..=100).contains(s)),
        "{curve:?}"
    );
    assert!(curve[0] > 50 && curve[50] < 40, "break-out, then running");
    assert_eq!(curve[101..104], [0x23, 0x11, 0x26]);
    assert_eq!(curve[110..114], [1, 144, 0, 24]);
    assert_eq!(register(&mut icon, 3145), 24);
    assert_eq!(
        register(&mut icon, 3180),
        u16::from(curve[..10].iter().copied().max().unwrap())
    );
    let reference = icon.store.run(3392, 64);
    assert_ne!(curve[..101], reference[..101]);
}

/// The programme lives: strokes, warnings and alarms come by themselves; a command ends it.
#[test]
fn the_programme_keeps_the_plant_alive() {
    for model in [Model::Icon3000, Model::Icon3000v2] {
        let mut icon = Icon3000::new(model, "XV-101", Programme::Strokes);
        let (mut opened, mut closed, mut moved) = (false, false, 0);
        let mut last = 0;
        for second in 0..2000 {
            icon.advance(Micros::new(second * 1_000_000), NOON + second);
            opened |= icon.position() == 1000;
            closed |= opened && icon.position() == 0;
            moved += u32::from(icon.position() != last);
            last = icon.position();
        }
        assert!(opened && closed && moved > 500);
        assert_eq!(icon.alarms.count(&[11]), 3, "one of old, two in 2000 s");
        assert!(icon.warnings.count(&[2]) > 2, "a tight seat");
        write(&mut icon, 3008, command::OPEN);
        wait(&mut icon, 30);
        for _ in 0..5 {
            wait(&mut icon, 5);
            assert_eq!(icon.position(), 1000);
        }
    }
    let mut icon = Icon3000::new(Model::Icon3000v2, "FV-1", Programme::Modulating);
    let mut seen = std::collections::BTreeSet::new();
    for second in 0..300 {
        icon.advance(Micros::new(second * 1_000_000), NOON + second);
        seen.insert(icon.position());
    }
    assert!(seen.len() > 20, "{seen:?}");
}

/// The same times give the same answers, in whatever steps they come.
#[test]
fn time_alone_decides() {
    let run = |step: u64| {
        let mut icon = Icon3000::new(Model::Icon3000v2, "XV-101", Programme::Strokes);
        for at in 0..=(600_000 / step) {
            icon.advance(Micros::new(at * step * 1000), NOON);
        }
        icon.store.run(3000, 900)
    };
    assert_eq!(run(100), run(1000));
    assert_eq!(run(100), run(30_000));
}

/// Whatever comes, something sensible goes back: no panic, never longer than a PDU may be.
#[test]
fn any_bytes_are_answered() {
    let mut icon = v2();
    let mut seed = 1_u32;
    for _ in 0..5_000 {
        let mut byte = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            seed.to_be_bytes()[0]
        };
        let len = usize::from(byte() % 20);
        let mut pdu: Vec<u8> = (0..len).map(|_| byte()).collect();
        if let Some(first) = pdu.first_mut() {
            *first %= 32;
        }
        if let Some(answer) = icon.answer(&pdu) {
            assert!((2..=253).contains(&answer.len()), "{pdu:?} {answer:?}");
        }
        icon.broadcast(&pdu);
        icon.advance(Micros::new(icon.now.get() + 1_000_000), NOON);
    }
}

/// Every row of the map is answered, and read-only rows with a range hold a value within it.
#[test]
fn values_are_within_their_ranges() {
    use crate::address::Table;
    use crate::map::row::Kind;
    for model in [Model::Icon3000, Model::Icon3000v2] {
        let mut icon = Icon3000::new(model, "XV-101", Programme::Strokes);
        for second in 0..120 {
            icon.advance(Micros::new(second * 1_000_000), NOON + second);
            for row in model.map().rows_of(Table::Holding) {
                let Some((min, max)) = row.range.filter(|_| row.words == 1) else {
                    continue;
                };
                let word = icon.store.get(row.address.get());
                let raw = match row.kind {
                    Kind::I16 => i32::from(word.cast_signed()),
                    _ => i32::from(word),
                };
                assert!((min..=max).contains(&raw), "{} is {raw}", row.key);
            }
        }
    }
}
