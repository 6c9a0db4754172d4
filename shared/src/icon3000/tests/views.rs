//! Health, signatures, stroke tests, identity, configuration and sentences, by hand.

use crate::address::{Address, Table};
use crate::capture::Micros;
use crate::icon3000::config::{LoggedIn, configuration, logged_in};
use crate::icon3000::curve::{
    Curve, Direction, Drift, Peak, Verdict, Which, drift, judge, margin, trend,
};
use crate::icon3000::health::{alarm, health, warning};
use crate::icon3000::identity::{Report, facts};
use crate::icon3000::model::Ne107;
use crate::icon3000::read::Log;
use crate::icon3000::records::{Files, Records};
use crate::icon3000::stroke::{Point, Stroke, limits};
use crate::icon3000::{collect::Wire, counters};
use crate::image::Image;
use crate::map::row::{Level, Model};

const V2: Model = Model::Icon3000v2;

fn image(words: &[(u16, u16)]) -> Image {
    let mut image = Image::new();
    for (address, word) in words {
        image.set(
            Table::Holding,
            Address::new(*address),
            *word,
            Micros::default(),
        );
    }
    image
}

/// HR 3009, bit 15: General Warning stands by itself only while no other bit explains it (reading
/// E50); so it does in the input register of an ICON2000v4.
#[test]
fn a_general_warning_is_told_where_nothing_else_is() {
    for (word, by_hand) in [
        (
            0x8A00,
            &["pst_error_max_t_ret_t2", "pst_error_pst_failed"][..],
        ),
        (0x8001, &["hi_torque_op"]),
        (0x8000, &["general_warning"]),
        (0x0000, &[]),
    ] {
        let mut old = Image::new();
        old.set(Table::Input, Address::new(2), word, Micros::default());
        for (model, seen) in [(V2, image(&[(3009, word)])), (Model::Icon2000v4, old)] {
            let found = health(model, &seen);
            let keys: Vec<_> = found.findings.iter().map(|f| f.meaning.key).collect();
            assert_eq!(keys, by_hand, "{word:04X}");
        }
    }
    let alone = health(V2, &image(&[(3009, 0x8000)]));
    let words = alone.findings[0].meaning;
    assert!(words.reason.starts_with("At least one warning is active"));
}

/// Table 5, HR 3009 to 3011: worst first, whatever the order of the registers; what was not read is
/// not good.
#[test]
fn health_is_one_list_worst_first() {
    let all = image(&[
        (3001, 1 << 4),
        (3002, 0),
        (3003, 0),
        (3009, 1 << 5 | 1 << 1),
        (3010, 1 << 13 | 1 << 8),
        (3011, 0),
        (3016, 0),
        (3030, 0),
    ]);
    let found = health(V2, &all);
    let list: Vec<_> = found
        .findings
        .iter()
        .map(|f| (f.meaning.status.letter(), f.meaning.key, f.place()))
        .collect();
    let place = str::to_owned;
    assert_eq!(
        list,
        [
            ("F", "main_voltage", place("HR 3010, bit 8")),
            ("C", "selector_in_local", place("HR 3001, bit 4")),
            ("S", "hi_torque_cl", place("HR 3009, bit 1")),
            ("M", "low_battery", place("HR 3010, bit 13")),
            ("M", "maintenance_request", place("HR 3009, bit 5")),
        ]
    );
    assert_eq!(found.worst(), Some(Ne107::Failure));
    assert_eq!(found.unread, Vec::<&_>::new());
    let part = health(V2, &image(&[(3010, 0)]));
    assert!(part.findings.is_empty() && !part.is_good() && part.unread.len() >= 6);
    // An ICON2000v4 has its alarms in input registers only.
    let mut old = Image::new();
    old.set(Table::Input, Address::new(3), 1 << 14, Micros::default());
    let found = health(Model::Icon2000v4, &old);
    assert_eq!(found.findings[0].place(), "IR 3, bit 14");
    old.set(Table::Input, Address::new(3), 0, Micros::default());
    for address in [2, 4] {
        old.set(Table::Input, Address::new(address), 0, Micros::default());
    }
    // Its status is in discrete inputs 0 to 28 (table 1): not read, so not known to be good.
    let found = health(Model::Icon2000v4, &old);
    let mut bits: Vec<_> = found.unread.iter().map(|row| row.address.get()).collect();
    bits.sort_unstable();
    assert_eq!(bits, [4, 16, 19, 23]);
    assert!(found.findings.is_empty() && !found.is_good());
    for address in 0..30 {
        let on = u16::from(address == 4);
        old.set(
            Table::Discrete,
            Address::new(address),
            on,
            Micros::default(),
        );
    }
    let found = health(Model::Icon2000v4, &old);
    assert_eq!(found.findings[0].meaning.key, "selector_in_local");
    assert_eq!(found.findings[0].place(), "DI 4");
    old.set(Table::Discrete, Address::new(4), 0, Micros::default());
    let found = health(Model::Icon2000v4, &old);
    assert!(found.is_good(), "{found:?}");
    // Handwheel, maintenance and the like stand nowhere in tables 1 and 4; ESD and PST in progress
    // have no input of their own (reading E41).
    let untold: Vec<_> = found.untold.iter().map(|m| m.key).collect();
    for key in [
        "manual_operation_handwheel",
        "local_configuration",
        "maintenance_operation",
        "esd_in_progress",
        "pst_in_progress",
        "base_card_communication_error",
        "efs_mid_travel",
    ] {
        assert!(untold.contains(&key), "{key}: {untold:?}");
    }
    assert_eq!(alarm(4).unwrap().status, Ne107::Maintenance);
    assert_eq!(warning(10).unwrap().status, Ne107::Maintenance);
    assert_eq!((alarm(0), alarm(33)), (None, None));
}

/// A curve: 60 % at the start, 20 % on the way, 40 % at the end.
fn curve(direction: Direction, start: u16, middle: u16, end: u16) -> Curve {
    let mut words: Vec<u16> = (0..=100)
        .map(|position: u16| {
            let travel = direction.position(position);
            match travel {
                0..=10 => start,
                90.. => end,
                _ => middle,
            }
        })
        .collect();
    words.extend([0, 0, 31, 28, 46, 400, 24]);
    let number = if direction == Direction::Open {
        1001
    } else {
        2000
    };
    Curve::of_file(number, &Records::of(0, words)).unwrap()
}

#[test]
fn signatures_are_measured_by_their_rules() {
    for direction in [Direction::Open, Direction::Close] {
        let measured = curve(direction, 60, 20, 40).signature();
        let start = direction.position(0);
        assert_eq!(
            measured.break_away,
            Some(Peak {
                position: start,
                torque: 60
            })
        );
        assert_eq!(measured.running_tenths, Some(200));
        assert_eq!(measured.seating.map(|p| p.torque), Some(40));
        assert_eq!(measured.peak.map(|p| p.torque), Some(60));
    }
    let open = curve(Direction::Open, 60, 20, 40);
    assert_eq!((open.which, open.stroke_time), (Which::Stored(1), Some(24)));
    assert_eq!(open.temperatures, [Some(31), Some(28), Some(46)]);
    // Samples that were not read are not zero.
    let part = Curve::of_file(1000, &Records::of(0, [50, 51])).unwrap();
    let measured = part.signature();
    assert_eq!(measured.break_away.map(|p| p.torque), Some(51));
    assert_eq!((measured.running_tenths, measured.seating), (None, None));
    assert!(!part.is_complete());
}

#[test]
fn drift_is_told_in_numbers_and_judged() {
    let reference = curve(Direction::Open, 60, 20, 40);
    let stiff = curve(Direction::Open, 72, 23, 40);
    let by = drift(&reference, &stiff).unwrap();
    assert_eq!(
        by,
        Drift {
            break_away: Some(12),
            running_tenths: Some(30),
            seating: Some(0),
            largest: Some((0, 12)),
            // 11 × 12 and 79 × 3 points over 101 positions: 369 / 101.
            mean_tenths: Some(36),
        }
    );
    assert_eq!(judge(&by), Verdict::Watch);
    let judged = |start, middle, end| {
        judge(&drift(&reference, &curve(Direction::Open, start, middle, end)).unwrap())
    };
    assert_eq!(judged(60, 20, 40), Verdict::Steady);
    assert_eq!(judged(69, 29, 49), Verdict::Steady);
    assert_eq!(judged(60, 20, 60), Verdict::Act);
    assert_eq!(judged(60, 1, 40), Verdict::Watch, "a fall is a change too");
    let part = Curve::of_file(1001, &Records::of(0, [60])).unwrap();
    assert_eq!(judge(&drift(&reference, &part).unwrap()), Verdict::Unknown);
    assert_eq!(
        drift(&reference, &curve(Direction::Close, 60, 20, 40)),
        None
    );
    let peak = |torque| Peak {
        position: 0,
        torque,
    };
    assert_eq!(margin(peak(60), 85), (25, Verdict::Steady));
    assert_eq!(margin(peak(-80), 85), (5, Verdict::Watch));
    assert_eq!(margin(peak(85), 85), (0, Verdict::Act));
}

fn test_curve(result: u16, status: u16, direction: u16) -> Stroke {
    let mut words = vec![0_u16; 118];
    for (at, word) in words.iter_mut().enumerate().take(16) {
        *word = 4 + 3 * u16::try_from(at).unwrap();
    }
    for (at, word) in words.iter_mut().enumerate().skip(51).take(15) {
        *word = 50 - 3 * u16::try_from(at - 50).unwrap();
    }
    words[108] = result;
    words[109] = direction;
    (words[110], words[111], words[112], words[113]) = (49, 47, 4, 15);
    words[115] = status;
    (words[116], words[117]) = (0, 8);
    Stroke::of_file(3001, &Records::of(0, words)).unwrap()
}

/// Table 39 with its notes 1 and 2.
#[test]
fn stroke_tests_in_words() {
    let passed = test_curve(1, 1, 0);
    assert_eq!(
        passed.in_words(),
        "Passed: went in T-PST (4.9 s), came back in T-RET (4.7 s)."
    );
    assert!(!passed.is_contradictory() && test_curve(1, 2, 0).is_contradictory());
    assert_eq!(passed.out.len(), 16);
    let first = Point {
        position: 100,
        tenths: 4,
    };
    assert_eq!(passed.out[0], first);
    assert_eq!(passed.out[15].position, 85);
    // The way back begins at the far end.
    assert_eq!(passed.back[0].position, 85);
    assert_eq!(passed.back.last().unwrap().position, 99);
    assert_eq!(test_curve(1, 1, 1).out[15].position, 15, "an open PST");
    assert_eq!(
        test_curve(3, 16, 0).in_words(),
        "Reset before its end by: ESD."
    );
    assert!(
        test_curve(5, 4, 0)
            .in_words()
            .contains("T-RET allows (4.7 s)")
    );
    assert!(
        test_curve(6, 8, 0)
            .in_words()
            .contains("OV-TR allows (0.4 %)")
    );
    let set = limits(&image(&[(3616, 150), (3619, 5)]), Some(&passed));
    // 150 % of 4.9 s; 5 % of the stroke; T-RET was not read.
    assert_eq!(set.map(|l| l.presumed_tenths), [Some(73), None, Some(50)]);
}

#[test]
fn configuration_says_what_may_be_set() {
    let set = image(&[(3017, 300), (2, 10), (3480, 2), (3612, 9)]);
    let groups = configuration(V2, &set);
    let find = |address: u16| {
        let all = groups.iter().flat_map(|g| &g.settings);
        all.clone()
            .find(|s| s.row.address.get() == address)
            .unwrap()
    };
    let band = find(3017);
    assert_eq!(band.value.as_deref(), Some("30.0 %"));
    assert!(band.outside && !find(3018).outside);
    assert_eq!(
        (band.range.as_str(), band.level),
        ("0.1 to 25.5 %", Some(Level::User))
    );
    assert!(find(3612).outside, "a code without a name");
    let legacy = find(2);
    assert_eq!(legacy.mirror_of, Some(Address::new(3017)));
    assert!(legacy.differs);
    assert_eq!(find(3018).value, None);
    assert_eq!(logged_in(V2, &set), LoggedIn::Level(Level::Service));
    assert_eq!(logged_in(V2, &Image::new()), LoggedIn::Unread);
    assert_eq!(logged_in(Model::Icon3000, &set), LoggedIn::NoLevels);
    assert_eq!(logged_in(V2, &image(&[(3480, 7)])), LoggedIn::Unknown(7));
}

#[test]
fn identity_names_its_sources() {
    let mut pdu = vec![17, 0x54, 0, 0];
    pdu.extend(b"Biffi ICON3000  ");
    pdu.extend(format!("{:28}{:28}9.02  4.01", "SIM004711", "XV-101").bytes());
    let report = Report::of_pdu(&pdu).unwrap();
    let mut known = Image::new();
    for (at, pair) in (3056..).zip("XV-102                      ".as_bytes().chunks(2)) {
        let word = u16::from_be_bytes([pair[0], pair[1]]);
        known.set(Table::Holding, Address::new(at), word, Micros::default());
    }
    let mut files = Files::default();
    files
        .entry(5300)
        .put(0, [0x3439, 0x3442, 0x4333, 0x3230, 0x3030]);
    let told = facts(V2, &known, Some(&report), &files);
    let of = |key: &str| -> Vec<String> {
        let found = told.iter().filter(|f| f.key == key);
        found
            .map(|f| {
                format!(
                    "{}: {}{}",
                    f.from,
                    f.value,
                    if f.disputed { " (disputed)" } else { "" }
                )
            })
            .collect()
    };
    assert_eq!(
        of("valve_tag"),
        ["FC 17: XV-101 (disputed)", "HR 3056: XV-102 (disputed)"]
    );
    assert_eq!(of("serial_number"), ["FC 17: SIM004711"]);
    assert_eq!(
        of("card_code"),
        ["file 5300 (Card Report: Base Card): 494BC32000"]
    );
}

#[test]
fn trends_run_forwards_and_counters_go_round() {
    let mut words = vec![2, 0, 0, 0, 60];
    words.extend([0, 120, 31, 46, 400, 0]);
    words.extend([0, 60, 30, 0xFFFB, 399, 0]);
    let log = Log::read(5100, &Records::of(0, words)).unwrap();
    assert_eq!(trend(&log, "motor_temperature"), [(60, -5), (120, 46)]);
    assert_eq!(counters::since(0xFFFE, 3), 5);
    // 3 of 4000 messages: 0.075 %.
    assert_eq!(counters::rate(3, 4000), Some(75));
    assert_eq!(counters::rate(0, 0), None);
    assert_eq!(counters::request(11), Some([8, 0, 11, 0, 0]));
    assert_eq!(counters::request(1), None, "a restart is no read");
    assert_eq!(counters::request(10), None, "clearing is no read");
}

/// Two frames of 8 and 255 bytes at 9600 8E1: 263 × 11 bits and twice 3.5 characters are
/// 2970 bits, 309.375 ms; at 38400 the silence is 1.75 ms: 75.338 ms and 3.5 ms.
#[test]
fn wire_times_by_hand() {
    let wire = Wire {
        exchanges: 1,
        request_bytes: 8,
        response_bytes: 255,
    };
    assert_eq!(wire.micros(9600, 11), 301_354 + 8_020);
    assert_eq!(wire.micros(38_400, 11), 75_338 + 3_500);
}
