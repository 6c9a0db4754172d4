use super::*;

/// Friday 2026-06-05 10:00:00 UTC.
const WALL: u64 = 1_780_653_600;

fn at(ms: u64) -> Micros {
    Micros::new(ms * 1000)
}

fn unit(setup: DopSetup) -> Dop {
    let mut unit = Dop::new("MX-301", setup);
    unit.advance(at(0), WALL);
    unit
}

/// A unit that is never busy.
const AT_ONCE: DopSetup = DopSetup {
    request: 4000,
    indicators: 4010,
    status: 4014,
    count: 4015,
    response: 4100,
    shift: 12,
    busy_ms: 0,
    foreign_ms: 0,
    events: 420,
    moves: true,
};

/// Reads registers as another master would.
fn read(unit: &mut Dop, start: u16, count: u16) -> Vec<u16> {
    let mut words = Vec::new();
    let mut from = start;
    while from < start + count {
        let block = (start + count - from).min(125);
        let [a, b] = from.to_be_bytes();
        let [c, d] = block.to_be_bytes();
        let pdu = unit.answer(&[3, a, b, c, d]).unwrap();
        assert_eq!(pdu[..2], [3, 2 * block as u8], "{from} {block}");
        words.extend(pdu[2..].chunks(2).map(|p| u16::from_be_bytes([p[0], p[1]])));
        from += block;
    }
    words
}

fn write(unit: &mut Dop, word: u16) {
    let [a, b] = unit.setup.request.to_be_bytes();
    let [c, d] = word.to_be_bytes();
    let pdu = [6, a, b, c, d];
    assert_eq!(unit.answer(&pdu).unwrap(), pdu);
}

/// A whole exchange by hand; gives the status word and the registers.
fn fetch(unit: &mut Dop, word: u16, ms: u64) -> (u16, Vec<u16>) {
    unit.advance(at(ms), WALL + ms / 1000);
    write(unit, word);
    unit.advance(at(ms + u64::from(unit.setup.busy_ms)), WALL + ms / 1000);
    let status = read(unit, 4014, 1)[0];
    let count = read(unit, 4015, 1)[0];
    (status, read(unit, 4100, count))
}

fn u32_at(words: &[u16], at: usize) -> u32 {
    u32::from(words[at]) | u32::from(words[at + 1]) << 16
}

fn time_at(words: &[u16], at: usize) -> i64 {
    (0..4).fold(0, |sum, n| sum | i64::from(words[at + n]) << (16 * n))
}

/// First character in the low byte, up to the first NUL.
fn text_at(words: &[u16], at: usize, registers: usize) -> String {
    let bytes = words[at..at + registers]
        .iter()
        .flat_map(|w| w.to_le_bytes());
    bytes.take_while(|b| *b != 0).map(char::from).collect()
}

/// Registers of each object and option: last printed offset and its type (with the readings B2,
/// B1 and A4), added up by hand.
const SIZES: [(u16, &[usize]); 30] = [
    (1, &[105, 129, 57, 49]),
    (2, &[91]),
    (3, &[100, 100, 100]),
    (4, &[100, 100, 100]),
    (5, &[14]),
    (6, &[28]),
    (7, &[29, 29, 29]),
    (201, &[120]),
    (202, &[100, 100]),
    (203, &[155, 191, 83, 71]),
    (204, &[155, 191, 83, 71]),
    (205, &[40]),
    (206, &[16]),
    (207, &[26]),
    (208, &[33]),
    (209, &[26]),
    (401, &[410, 410, 410, 410]),
    (402, &[88]),
    (403, &[36]),
    (404, &[24]),
    (405, &[10]),
    (601, &[153, 189, 81, 69]),
    (602, &[23]),
    (604, &[153, 189, 81, 69]),
    (605, &[10]),
    (1003, &[22]),
    (1004, &[23]),
    (1005, &[4]),
    (1006, &[128]),
    (1007, &[6]),
];

#[test]
fn every_object_has_its_printed_size_and_no_other_option() {
    let mut unit = unit(DopSetup::default());
    let mut ms = 0;
    for (object, sizes) in SIZES {
        for option in 0..16_u16 {
            ms += 2_000;
            let (status, words) = fetch(&mut unit, option << 12 | object, ms);
            match sizes.get(usize::from(option)) {
                Some(size) => {
                    assert_eq!(status, object | 2 << 12, "{object} {option}");
                    assert_eq!(words.len(), *size, "{object} {option}");
                }
                None => {
                    assert_eq!(status, object | 3 << 12, "{object} {option}");
                    assert_eq!(read(&mut unit, 4100, 1), [3]);
                    assert!(words.is_empty());
                }
            }
        }
    }
    for object in [0, 8, 200, 210, 406, 603, 606, 1002, 1008, 1201, 1204, 2047] {
        ms += 2_000;
        let (status, _) = fetch(&mut unit, object, ms);
        assert_eq!(status, object | 3 << 12);
        assert_eq!(read(&mut unit, 4100, 1), [1], "{object}");
    }
}

/// The decoder and the simulator know the tables independently: what one writes, the other takes
/// as the layout of that request, with every time where a time is.
#[test]
fn the_decoder_agrees_about_every_layout() {
    let profile = crate::dop::Profile::default();
    let mut unit = unit(DopSetup::default());
    let mut ms = 0;
    for (object, sizes) in SIZES {
        for option in 0..sizes.len() {
            ms += 2_000;
            let word = (option as u16) << 12 | object;
            let (_, words) = fetch(&mut unit, word, ms);
            let request = crate::dop::Request::from_word(word);
            let read = crate::dop::ObjectRead::read(request, &words, &profile);
            assert!(read.layout.is_some(), "{request}: {}", read.why);
            let problems: Vec<String> = read
                .decoded
                .problems()
                .iter()
                .map(ToString::to_string)
                .collect();
            assert!(problems.is_empty(), "{request}: {problems:?}");
            let (good, all) = read.plausible_times();
            assert_eq!(good, all, "{request}");
        }
    }
}

#[test]
fn it_is_busy_for_its_time_at_any_position_of_the_status() {
    for shift in [11, 12, 13] {
        let mut unit = unit(DopSetup {
            shift,
            busy_ms: 300,
            ..DopSetup::default()
        });
        assert_eq!(read(&mut unit, 4014, 1), [0]);
        write(&mut unit, 0x3001);
        assert_eq!(read(&mut unit, 4014, 2), [1 | 1 << shift, 0]);
        unit.advance(at(299), WALL);
        assert_eq!(read(&mut unit, 4014, 1), [1 | 1 << shift]);
        unit.advance(at(300), WALL);
        assert_eq!(read(&mut unit, 4014, 2), [1 | 2 << shift, 49]);
        write(&mut unit, 0x4001);
        unit.advance(at(700), WALL);
        assert_eq!(read(&mut unit, 4014, 1), [1 | 3 << shift]);
        assert_eq!(read(&mut unit, 4100, 1), [3]);
        assert_eq!(unit.writes(), 2);
    }
}

/// A stroke adds to on-time, counts, starts, turns, torque profile and movement log alike.
#[test]
fn a_stroke_leaves_its_marks_everywhere() {
    let mut unit = unit(AT_ONCE);
    let before = fetch(&mut unit, 1004, 100).1;
    let on_before = fetch(&mut unit, 201, 1_200).1;
    // Four cycles later: the opening of the fifth is under way at 240 s, none of them partial
    // at 239 s.
    let after = fetch(&mut unit, 1004, 238_000).1;
    let on_after = fetch(&mut unit, 201, 239_900).1;
    // The first opening had begun when the first reading was made.
    assert_eq!(u32_at(&after, 3) - u32_at(&before, 3), 3);
    assert_eq!(u32_at(&after, 5) - u32_at(&before, 5), 4);
    assert_eq!(u32_at(&after, 1) - u32_at(&before, 1), 7 * 18);
    // Motor runtime is the sum of all on-times, within the rounding of twenty bins.
    let sum = |words: &[u16]| (0..20).map(|n| u32_at(words, 2 * n)).sum::<u32>();
    assert!(u32_at(&after, 7) - sum(&on_after) <= 20);
    // Eight strokes of 12.5 s, spread evenly over the bins; a second had passed before.
    let more = sum(&on_after) - sum(&on_before);
    assert!((88..=100).contains(&more), "{more}");
    // Starts: four in the last hour from the closed and four from the open end.
    let starts = fetch(&mut unit, 202, 239_950).1;
    assert_eq!((starts[0], starts[19]), (4, 4));
    assert_eq!(starts[1..19], [0; 18]);
    // The newest record of the movement log is the end of the last closing, at 222 s.
    let moves = fetch(&mut unit, 1203, 239_970).1;
    assert_eq!(moves[0], 18);
    assert_eq!(text_at(&moves, 13, 16), "Stopped: close torque");
    assert_eq!(time_at(&moves, 2), WALL as i64 + 222);
    assert_eq!(moves[6], 0);
    // So does the torque curve, which runs from open to closed.
    let curve = fetch(&mut unit, 0x2191, 239_980).1;
    assert_eq!(time_at(&curve, 400), WALL as i64 + 210);
    assert_eq!(time_at(&curve, 404), WALL as i64 + 222);
    assert_eq!(curve[408..], [1000, 0]);
    // And the summary of the strokes says the same as the curve.
    let profile = fetch(&mut unit, 402, 239_990).1;
    assert_eq!(time_at(&profile, 44), WALL as i64 + 210);
    let average: u32 = curve[200..300].iter().map(|w| u32::from(*w)).sum::<u32>() / 100;
    assert_eq!(u32::from(profile[58]), average);
    let peak = curve[10..90].iter().max().unwrap();
    assert_eq!(profile[62], *peak);
}

#[test]
fn trends_have_as_many_points_as_the_unit_has_lived() {
    let mut unit = unit(AT_ONCE);
    // Fourteen months of thirty days: two years have begun.
    let points = [0_u16, 1, 2, 3].map(|option| fetch(&mut unit, option << 12 | 601, 1).1[0]);
    assert_eq!(points, [24, 30, 12, 2]);
    let years = fetch(&mut unit, 0x3259, 5_000).1;
    let value = |at: usize| u32_at(&years, at) as i32;
    for point in 0..10 {
        let (max, min, avg) = (
            value(1 + 2 * point),
            value(21 + 2 * point),
            value(41 + 2 * point),
        );
        if point < 2 {
            assert!(min < avg && avg < max, "{point}: {min} {avg} {max}");
        } else {
            assert_eq!((max, min, avg), (0, 0, 0));
        }
    }
    // A winter was below zero.
    assert!(value(21) < 0 || value(23) < 0);
}

/// The ids of the movement log come round within its history.
#[test]
fn logs_are_paged_in_both_directions() {
    for object in [1202_u16, 1203] {
        let (stride, at_time, total) = if object == 1202 {
            (27, 3, 420)
        } else {
            (28, 2, 260)
        };
        for (first, then) in [(0_u16, 2_u16), (1, 3)] {
            let mut unit = unit(DopSetup {
                moves: false,
                ..DopSetup::default()
            });
            let mut times = Vec::new();
            let mut ids = Vec::new();
            let mut command = first;
            for page in 0.. {
                let (_, words) = fetch(&mut unit, command << 12 | object, page * 2_000);
                command = then;
                let count = usize::from(words[0]);
                assert_eq!(words.len(), 1 + count * stride);
                if count == 0 {
                    break;
                }
                assert!(count <= 18);
                for record in 0..count {
                    times.push(time_at(&words, record * stride + at_time));
                    ids.push(words[1 + record * stride]);
                }
            }
            assert_eq!(times.len(), total, "{object} {first}");
            let falls = times.windows(2).all(|w| w[0] >= w[1]);
            let rises = times.windows(2).all(|w| w[0] <= w[1]);
            assert_eq!((falls, rises), (first == 0, first == 1));
            let wraps = ids.windows(2).any(|w| w[0].abs_diff(w[1]) > 1000);
            assert_eq!(wraps, object == 1203);
        }
    }
    let mut unit = unit(DopSetup {
        events: 0,
        ..DopSetup::default()
    });
    assert_eq!(fetch(&mut unit, 0x44B2, 1).1, [0]);
    assert_eq!(fetch(&mut unit, 0x04B2, 2_000).1, [0]);
    assert_eq!(fetch(&mut unit, 0x44B3, 4_000).1, [1]);
    assert_eq!(fetch(&mut unit, 0x54B3, 6_000).0, 1203 | 3 << 12);
}

#[test]
fn identity_is_text_with_its_first_character_in_the_low_byte() {
    let mut unit = unit(DopSetup::default());
    let words = fetch(&mut unit, 1006, 1).1;
    assert_eq!(words[0].to_le_bytes(), *b"MX");
    assert_eq!(text_at(&words, 0, 9), "MX-301");
    assert_eq!(text_at(&words, 63, 10), "00:1B:63:84:45:E6");
    assert_eq!(text_at(&words, 107, 3), "");
    assert_eq!(text_at(&words, 125, 3), "E 1.3");
}

/// Reading C22: one bit of the legacy map says that any user indicator is active.
#[test]
fn the_legacy_bit_stands_for_all_indicators() {
    let mut unit = unit(DopSetup::default());
    let indicators = read(&mut unit, 4010, 4);
    assert_eq!(indicators, [1 << 1 | 1 << 13, 0, 1 << 8, 0]);
    assert_eq!(read(&mut unit, 9, 1), [1 << 7]);
    // While a phase is lost, bit 63 and the alarm say so.
    unit.advance(at(610_000), WALL + 610);
    assert_eq!(read(&mut unit, 4013, 1), [0x8000]);
    assert_eq!(fetch(&mut unit, 1005, 611_000).1[..2], [4, 0]);
}

#[test]
fn nothing_else_can_be_written_or_read() {
    let mut unit = unit(DopSetup::default());
    for address in 0..=u16::MAX {
        if address == 4000 {
            continue;
        }
        let [a, b] = address.to_be_bytes();
        assert_eq!(unit.answer(&[6, a, b, 0, 1]), Some(vec![0x86, 2]));
    }
    assert_eq!(unit.writes(), 0);
    for pdu in [
        &[5, 0, 1, 0xFF, 0][..],
        &[15, 0, 0, 0, 1, 1, 1],
        &[23, 0],
        &[],
    ] {
        let answer = unit.answer(pdu);
        assert_eq!(answer, pdu.first().map(|f| vec![f | 0x80, 1]));
    }
    assert_eq!(unit.answer(&[3, 0x10, 0x04, 0, 126]), Some(vec![0x83, 3]));
    assert_eq!(unit.answer(&[3, 0x0F, 0xA0, 0, 2]), Some(vec![0x83, 2]));
    assert_eq!(unit.answer(&[8, 0, 0, 1, 2]), Some(vec![8, 0, 0, 1, 2]));
}

#[test]
fn another_master_may_come_in_between() {
    let mut unit = unit(DopSetup {
        foreign_ms: 5_000,
        ..DopSetup::default()
    });
    write(&mut unit, 1004);
    unit.advance(at(1_000), WALL);
    assert_eq!(read(&mut unit, 4014, 2), [1004 | 2 << 12, 23]);
    unit.advance(at(5_000), WALL);
    assert_eq!(read(&mut unit, 4014, 1), [1003 | 1 << 12]);
    unit.advance(at(5_120), WALL);
    assert_eq!(read(&mut unit, 4014, 2), [1003 | 2 << 12, 22]);
    assert_eq!(unit.writes(), 1);
}

#[test]
fn the_same_times_give_the_same_answers() {
    let setup = DopSetup::default();
    let (mut one, mut two) = (unit(setup), unit(setup));
    two.advance(at(60_000), WALL + 60);
    for ms in (0..600).map(|n| n * 100) {
        one.advance(at(ms), WALL + ms / 1000);
    }
    assert_eq!(
        fetch(&mut one, 201, 60_000).1,
        fetch(&mut two, 201, 60_000).1
    );
    assert_eq!(
        fetch(&mut one, 1203, 61_500).1,
        fetch(&mut two, 1203, 61_500).1
    );
}
