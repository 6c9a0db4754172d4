//! Faults, stroke tests that fail and emergency strokes, by hand from tables 5, 32, 34, 39 and 40.

use super::*;

/// `count` records of a file.
fn records(icon: &mut Icon3000, file: u16, start: u8, count: u8) -> Vec<u16> {
    let [high, low] = file.to_be_bytes();
    let answer = icon.answer(&[20, 7, 6, high, low, 0, start, 0, count]);
    let answer = answer.unwrap();
    assert_eq!(answer[0], 20, "file {file}");
    answer[4..]
        .chunks(2)
        .map(|pair| u16::from_be_bytes([pair[0], pair[1]]))
        .collect()
}

/// Result, T-PST, T-RET, OV-TR, travel, status and reset conditions of the latest test: records 108
/// and 110 to 113, 115 to 117.
fn latest(icon: &mut Icon3000) -> (u16, [u16; 4], u16, u32) {
    let words = records(icon, 3001, 108, 10);
    let long = u32::from(words[8]) << 16 | u32::from(words[9]);
    (
        words[0],
        [words[2], words[3], words[4], words[5]],
        words[7],
        long,
    )
}

/// An open valve.
fn open() -> Icon3000 {
    let mut icon = v2();
    write(&mut icon, 3008, command::OPEN);
    wait(&mut icon, 30);
    assert_eq!(icon.position(), 1000);
    icon
}

/// Carries out a test to its end.
fn test(icon: &mut Icon3000) -> (u16, [u16; 4], u16, u32) {
    write(icon, 3008, command::PST);
    wait(icon, 1);
    assert_ne!(register(icon, 3002) & 1 << 15, 0, "it runs");
    wait(icon, 60);
    assert_eq!(register(icon, 3002) & 1 << 15, 0, "it is over");
    latest(icon)
}

/// Table 39, notes 1 and 4: what came of a test, and the bits of HR 3516 and 3009 that say the same.
#[test]
fn tests_end_as_their_limits_say() {
    let mut icon = open();
    let (result, [away, back, over, travel], status, reset) = test(&mut icon);
    assert_eq!((result, status, reset, travel), (1, 1, 0, 15));
    assert!(
        (38..=44).contains(&away) && (34..=40).contains(&back),
        "{away} {back}"
    );
    assert!(
        over < 50,
        "HR 3619 allows 5 %, in tenths here (reading E79)"
    );
    assert_eq!(register(&mut icon, 3516), 1);
    assert_eq!(register(&mut icon, 3009) & 0x0F00, 0);
    assert_eq!(register(&mut icon, 3003) & 0b11, 0b10, "last PST passed");
    assert_eq!(icon.position(), 1000);

    // Half of the time of the reference is less than the valve takes: HR 3616 and 3618.
    for (limit, result, status, warning, code) in
        [(3616, 4, 1 << 1, 1 << 8, 11), (3618, 5, 1 << 2, 1 << 9, 12)]
    {
        write(&mut icon, limit, 50);
        let found = test(&mut icon);
        assert_eq!((found.0, found.2), (result, status), "HR {limit}");
        assert_eq!(register(&mut icon, 3516), status);
        // The specific bit, PST failed, and the general warning.
        let warnings = register(&mut icon, 3009);
        assert_eq!(warnings & 0x8F00, 1 << 15 | 1 << 11 | warning);
        assert_eq!(records(&mut icon, 3, 0, 4)[3], code, "table 34");
        assert_eq!(icon.position(), 1000, "it goes back all the same");
        write(&mut icon, limit, 150);
    }
    // A test that passes, and HR 3015, take the warning away.
    assert_eq!(test(&mut icon).0, 1);
    assert_eq!(register(&mut icon, 3009) & 0x8F00, 0);
}

/// A valve that is slow or goes too far, by faults of the simulation.
#[test]
fn faults_make_tests_fail() {
    for (fault, result, status) in [
        (Fault::PstTravel, 4, 1 << 1),
        (Fault::PstReturn, 5, 1 << 2),
        (Fault::PstOverTravel, 6, 1 << 3),
    ] {
        let mut icon = open();
        icon.set_fault(fault, true);
        let found = test(&mut icon);
        assert_eq!((found.0, found.2), (result, status), "{fault:?}");
        write(&mut icon, 3015, 1);
        assert_eq!(register(&mut icon, 3009) & 0x8F00, 0, "reset");
        icon.set_fault(fault, false);
        assert_eq!(test(&mut icon).0, 1, "{fault:?} is gone");
    }
    // 6 % beyond are too much for 5 %, and not for 10 %.
    let mut icon = open();
    icon.set_fault(Fault::PstOverTravel, true);
    let (result, [.., over, _], ..) = test(&mut icon);
    assert_eq!((result, over), (6, 60));
    write(&mut icon, 3619, 10);
    assert_eq!(test(&mut icon).0, 1);
    // The slow return has left a file before any test was asked for.
    let mut icon = v2();
    let before = register(&mut icon, 3513);
    icon.set_fault(Fault::PstReturn, true);
    assert_eq!(register(&mut icon, 3513), before + 1);
    let (result, [_, back, ..], status, _) = latest(&mut icon);
    assert_eq!((result, status), (5, 1 << 2));
    let reference = records(&mut icon, 3000, 111, 1)[0];
    assert!(
        back * 2 > reference * 3,
        "more than 150 %: {back}, {reference}"
    );
    assert_eq!(register(&mut icon, 3009), 1 << 15 | 1 << 11 | 1 << 9);
}

/// Section 12 and table 5, for an ICON3000: bit 5 of HR 3006 and value 5 of HR 3008 start a test while
/// HR 3027 says 1 (Advanced) and HR 3028 says 0 (PST-EFS). What came of it is in HR 3003 (bit 1
/// passed, bit 0 aborted), HR 3009 and the log of warnings; it has no files.
#[test]
fn an_icon3000_tests_too() {
    let open = || {
        let mut icon = idle(Model::Icon3000);
        write(&mut icon, 3008, command::OPEN);
        wait(&mut icon, 30);
        assert_eq!(icon.position(), 1000);
        icon
    };
    for (address, value) in [(3006, 1 << 5), (3008, 5), (0, 5)] {
        let mut icon = open();
        let modes = [register(&mut icon, 3027), register(&mut icon, 3028)];
        assert_eq!(modes, [1, 0]);
        write(&mut icon, address, value);
        wait(&mut icon, 5);
        assert_ne!(register(&mut icon, 3002) & 1 << 15, 0, "HR {address}");
        assert!((845..=850).contains(&icon.position()), "15 % of travel");
        wait(&mut icon, 15);
        assert_eq!(
            (icon.position(), register(&mut icon, 3002) & 1 << 15),
            (1000, 0)
        );
        assert_eq!(register(&mut icon, 3003) & 0b11, 0b10, "passed");
        assert_eq!(register(&mut icon, 3009), 0);
        assert_eq!(
            icon.answer(&[20, 7, 6, 0x0B, 0xB9, 0, 0, 0, 1]).unwrap(),
            [0x94, 1]
        );
    }
    // The modes are set on the spot: they cannot be written here.
    for (home, mode) in [(at::INTERLOCK_MODE, 0), (at::EFS_INPUT_MODE, 1)] {
        let mut icon = open();
        icon.store.set(home, mode);
        write(&mut icon, 3008, command::PST);
        wait(&mut icon, 5);
        assert_eq!(icon.position(), 1000, "HR {home}");
        assert_eq!(register(&mut icon, 3008), 0);
    }
    // Tables 5 and 34: bits 8 to 10 with 11 and 15; codes 11 to 13.
    for (fault, bit, code) in [
        (Fault::PstTravel, 8, 11),
        (Fault::PstReturn, 9, 12),
        (Fault::PstOverTravel, 10, 13),
    ] {
        let mut icon = open();
        icon.set_fault(fault, true);
        write(&mut icon, 3008, command::PST);
        wait(&mut icon, 60);
        let warnings = register(&mut icon, 3009);
        assert_eq!(warnings, 1 << 15 | 1 << 11 | 1 << bit, "{fault:?}");
        assert_eq!(register(&mut icon, 3115), code, "{fault:?}");
        assert!(fault.is_of_tests());
    }
    // An alarm ends it.
    let mut icon = open();
    write(&mut icon, 3008, command::PST);
    wait(&mut icon, 2);
    icon.set_fault(Fault::LostPhase, true);
    wait(&mut icon, 1);
    assert_eq!(register(&mut icon, 3003) & 0b11, 0b01, "aborted");
    // HR 0 of an ICON2000v4 has the value too; that it would test is not stated (reading E37).
    let mut icon = idle(Model::Icon2000v4);
    write(&mut icon, 0, command::OPEN);
    wait(&mut icon, 30);
    write(&mut icon, 0, command::PST);
    wait(&mut icon, 5);
    assert_eq!(icon.position(), 1000);
}

/// Table 39, note 5: each alarm ends a test that runs as reset (result 3, status bit 4), and its bit
/// stands in records 116 and 117 and in HR 3517 and 3518.
#[test]
fn alarms_reset_a_test() {
    for (fault, bit) in [
        (Fault::ConfigurationError, 5),
        (Fault::PositionSensor, 6),
        (Fault::Thermostat, 7),
        (Fault::MainVoltage, 8),
        (Fault::LostPhase, 9),
        (Fault::HiHiTemperature, 10),
        (Fault::JammedClose, 11),
        (Fault::JammedOpen, 11),
        (Fault::HiHiTorqueOpen, 12),
        (Fault::SpeedSensor, 13),
        (Fault::K1Contactor, 14),
        (Fault::K2Contactor, 15),
        (Fault::Hardware1, 16),
        // Reading E12.
        (Fault::EfsMidTravel, 17),
    ] {
        let mut icon = open();
        write(&mut icon, 3008, command::PST);
        wait(&mut icon, 2);
        icon.set_fault(fault, true);
        wait(&mut icon, 1);
        assert_eq!(register(&mut icon, 3002) & 1 << 15, 0, "{fault:?} ends it");
        let (result, _, status, reset) = latest(&mut icon);
        assert_eq!((result, status, reset), (3, 1 << 4, 1 << bit), "{fault:?}");
        assert_eq!(register(&mut icon, 3516), 1 << 4);
        let words = [register(&mut icon, 3517), register(&mut icon, 3518)];
        assert_eq!(u32::from(words[0]) << 16 | u32::from(words[1]), 1 << bit);
        assert_eq!(register(&mut icon, 3003) & 0b11, 0b01, "last PST aborted");
        let held = icon.position();
        wait(&mut icon, 20);
        assert_eq!(icon.position(), held, "and nothing moves on");
    }
    for fault in [
        Fault::LowBattery,
        Fault::RequestSignal,
        Fault::MidTravelOpen,
    ] {
        let mut icon = open();
        icon.set_fault(fault, true);
        assert_eq!(test(&mut icon).0, 1, "{fault:?} ends no test");
    }
}

/// Table 5, HR 3010, 3011 and 3016, and the codes of table 32.
#[test]
fn faults_show_their_bits_and_codes() {
    let by_hand = [
        ("thermostat", 3010, 0, 2),
        ("hi-hi-torque-open", 3010, 1, 6),
        ("hi-hi-torque-close", 3010, 2, 5),
        ("jammed-open", 3011, 2, 8),
        ("jammed-close", 3011, 1, 7),
        ("hi-hi-temperature", 3010, 5, 3),
        ("position-sensor", 3010, 6, 9),
        ("speed-sensor", 3010, 7, 10),
        ("main-voltage", 3010, 8, 11),
        ("k1-contactor", 3010, 9, 13),
        ("k2-contactor", 3010, 10, 14),
        ("configuration-error", 3010, 11, 1),
        ("hardware-1", 3011, 6, 17),
        ("low-battery", 3010, 13, 4),
        ("lost-phase", 3010, 14, 12),
        ("request-signal", 3010, 15, 18),
        ("mid-travel-open", 3011, 4, 16),
        ("mid-travel-close", 3011, 5, 15),
        ("efs-mid-travel", 3016, 0, 29),
    ];
    // The other three show in stroke tests.
    assert_eq!(Fault::ALL.len(), by_hand.len() + 3);
    for (key, address, bit, code) in by_hand {
        let fault = Fault::from_key(key).unwrap();
        let mut icon = v2();
        assert_eq!(register(&mut icon, 3001) & 1 << 6, 0);
        assert!(!fault.is_of_tests());
        icon.set_fault(fault, true);
        assert_ne!(register(&mut icon, address) & 1 << bit, 0, "{key}");
        assert_ne!(register(&mut icon, 3001) & 1 << 6, 0, "{key}: alarm");
        assert_eq!(records(&mut icon, 2, 0, 4)[3], code, "{key}");
        assert_eq!(register(&mut icon, 3090), code, "{key}");
        icon.set_fault(fault, false);
        for address in [3010, 3011, 3016] {
            assert_eq!(register(&mut icon, address), 0, "{key}");
        }
    }
    assert_eq!(Fault::from_key("none"), None);
    // Without a signal the positioner stands still; open and close still work.
    let mut icon = v2();
    icon.set_fault(Fault::RequestSignal, true);
    write(&mut icon, 3007, 500);
    write(&mut icon, 3008, command::POSITIONER);
    wait(&mut icon, 20);
    assert_eq!(icon.position(), 0);
    write(&mut icon, 3008, command::OPEN);
    wait(&mut icon, 30);
    assert_eq!(icon.position(), 1000);
}

/// Table 40: an ESD from end to end leaves its times, direction 0 from 100 %.
#[test]
fn an_emergency_stroke_leaves_its_curve() {
    let mut icon = open();
    let before = register(&mut icon, 3514);
    check(&mut icon, "05 0003 FF00", "05 0003 FF00");
    wait(&mut icon, 10);
    assert_eq!(register(&mut icon, 3514), before, "not yet at its end");
    wait(&mut icon, 20);
    assert_eq!(icon.position(), 0);
    assert_eq!(register(&mut icon, 3514), before + 1);
    let times = records(&mut icon, 3501, 0, 101);
    assert!(times.is_sorted() && times[0] <= 3, "{times:?}");
    // 26 s for the whole stroke, in tenths; half of it at 50 %.
    assert!((258..=263).contains(&times[100]), "{times:?}");
    assert!((128..=133).contains(&times[50]), "{times:?}");
    let rest = records(&mut icon, 3501, 101, 9);
    let since = u32::from(rest[0]) << 16 | u32::from(rest[1]);
    // 2000-01-01 is day 10957 of 1970; the valve was opened for 30 s before.
    let began = u32::try_from(NOON - 10_957 * 86_400).unwrap() + 30;
    assert!((began + 20..=began + 30).contains(&since), "{since}");
    assert_eq!(rest[8], 0, "it closed");
    // The same ESD goes on: no second curve. One that begins between the ends leaves none either.
    wait(&mut icon, 10);
    assert_eq!(register(&mut icon, 3514), before + 1);
    check(&mut icon, "05 0003 0000", "05 0003 0000");
    write(&mut icon, 3008, command::OPEN);
    wait(&mut icon, 10);
    check(&mut icon, "05 0003 FF00", "05 0003 FF00");
    wait(&mut icon, 30);
    assert_eq!(register(&mut icon, 3514), before + 1);
    // Opening: HR 3656 = 2. The command to open would go on after the ESD.
    write(&mut icon, 3008, command::NONE);
    check(&mut icon, "05 0003 0000", "05 0003 0000");
    write(&mut icon, 3656, 2);
    wait(&mut icon, 1);
    check(&mut icon, "05 0003 FF00", "05 0003 FF00");
    wait(&mut icon, 30);
    assert_eq!(register(&mut icon, 3514), before + 2);
    assert_eq!(records(&mut icon, 3501, 109, 1), [1]);
}
