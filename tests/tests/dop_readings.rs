//! Every reading of the manual of diagnostic objects is held by a test, or says why it needs none.

use shared::dop::object::{Axis, Field, FieldKind, Layout, Part};
use shared::dop::profile::{LogCommand, Ne107, Profile, Setting};
use shared::dop::{ObjectRead, READINGS, Request, Stamp, error_name, object, reading};
use shared::map::row::{Settled, Trust};
use shared::value::{Quality, Value};
use std::collections::BTreeSet;
use tests::dop::{FILES, cases};

/// How a reading is held.
enum Held {
    /// By this.
    By(fn()),
    /// Elsewhere, or not at all, for this reason.
    Because(&'static str),
}
use Held::{Because, By};

/// All readings, in the order of the manual's sections.
const HELD: [(&str, Held); 69] = [
    ("A1", By(|| request(0x0007, "vibration_exceeded", "rated"))),
    (
        "A2",
        By(|| {
            request(0x1007, "vibration_exceeded", "hi");
            request(0x2007, "vibration_exceeded", "deviation");
            unknown(0x3007);
        }),
    ),
    ("A3", By(|| request(0x00CD, "last_seat", "data"))),
    (
        "A4",
        By(|| {
            for word in [0x10CD, 0x20CD, 0x30CD] {
                unknown(word);
            }
            // What the unit is expected to say to them.
            let read = read(0x10CD, &[3]);
            assert_eq!(read.error, Some(3));
            assert_eq!(error_name(3), Some("Command option invalid"));
        }),
    ),
    ("A5", By(|| request(0x00CE, "final_deviation", "data"))),
    ("A6", By(|| request(0x00CF, "starts_indicators", "data"))),
    (
        "A7",
        By(|| {
            request(0x0192, "torque_summary", "data");
            request(0x0193, "torque_deviation", "data");
        }),
    ),
    (
        "A8",
        By(|| {
            request(0x0194, "torque_hi", "data");
            request(0x0195, "torque_maximum", "data");
        }),
    ),
    (
        "A9",
        By(|| {
            request(0x025A, "motor_temperature_statistics", "data");
            unknown(0x125A);
        }),
    ),
    (
        "A10",
        By(|| {
            request(0x03EB, "power", "data");
            request(0x03EC, "operation", "data");
            request(0x03ED, "alarms", "data");
            request(0x03EE, "identity", "data");
            request(0x03EF, "clock", "data");
        }),
    ),
    (
        "A11",
        By(|| {
            request(0x00CC, "final_close_trend", "hours_24");
            request(0x30CC, "final_close_trend", "years_10");
        }),
    ),
    ("A12", By(|| request(0x04B3, "movement_log", "newest"))),
    (
        "A13",
        By(|| {
            assert_eq!(Request::from_word(0x04B2).object(), 1202);
            assert_eq!(Request::from_word(0x04B3).object(), 1203);
            assert_eq!(Request::from_word(0x04B2).option(), 0);
        }),
    ),
    (
        "B1",
        By(|| {
            request(0x0259, "motor_temperature_trend", "hours_24");
            request(0x3259, "motor_temperature_trend", "years_10");
            assert_eq!(words_of(0x1259), 189);
            assert_eq!(words_of(0x025A), 23);
        }),
    ),
    (
        "B1a",
        By(|| {
            for (asked, registers, layout) in [
                (0x0259, 23, "motor_temperature_statistics"),
                (0x025A, 153, "motor_temperature_trend_24"),
                (0x025A, 189, "motor_temperature_trend_30"),
                (0x025A, 81, "motor_temperature_trend_12"),
                (0x025A, 69, "motor_temperature_trend_10"),
                (0x0259, 69, "motor_temperature_trend_10"),
            ] {
                let read = read(asked, &vec![0; registers]);
                assert_eq!(read.layout.map(|l| l.key), Some(layout), "{}", read.why);
                assert!(read.why.contains("reading B1a"), "{}", read.why);
            }
        }),
    ),
    (
        "B2",
        By(|| {
            assert_eq!(at(0x0191, "lta"), (300, 100));
            assert_eq!(at(0x0191, "start"), (400, 1));
            assert_eq!(at(0x0191, "end"), (404, 1));
            assert_eq!(at(0x0191, "start_position"), (408, 1));
            assert_eq!(at(0x0191, "end_position"), (409, 1));
            assert_eq!(words_of(0x0191), 410);
        }),
    ),
    (
        "B2a",
        By(|| {
            let read = read(0x2191, &[0; 312]);
            assert!(read.why.contains("reading B2a"), "{}", read.why);
            let field = |key| read.field(key).map(|f| (f.at, f.count));
            assert_eq!(field("lta"), Some((300, 2)));
            assert_eq!(field("start"), Some((302, 1)));
            assert_eq!(field("end_position"), Some((311, 1)));
        }),
    ),
    (
        "B3",
        By(|| {
            for (key, first) in [("max", 1), ("min", 61), ("avg", 121)] {
                assert_eq!(at(0x10CB, key), (first, 30));
                assert_eq!(field(0x10CB, key).kind, FieldKind::S32);
            }
        }),
    ),
    (
        "B4",
        By(|| {
            assert_eq!(at(0x30CB, "seats"), (69, 1));
            assert_eq!(field(0x30CB, "seats").kind, FieldKind::U32);
            names(0x30CB, "seats", "B4");
        }),
    ),
    (
        "B5",
        By(|| {
            assert_eq!(field(0x10CA, "open").label, "Open starts per hour");
            assert_eq!(field(0x10CA, "open").unit, "starts/h");
        }),
    ),
    (
        "B6",
        By(|| {
            assert_eq!(at(0x0192, "open_ref_breakout"), (38, 1));
            assert_eq!(at(0x0192, "open_ref_breakout_position"), (39, 1));
        }),
    ),
    (
        "B7",
        By(|| {
            assert_eq!(at(0x0192, "close_ref_ending"), (86, 1));
            assert_eq!(at(0x0192, "close_ref_ending_position"), (87, 1));
        }),
    ),
    (
        "B8",
        By(|| assert!(field(6, "rated_rms_vector").label.ends_with("vector"))),
    ),
    (
        "B9",
        By(|| {
            let step = |word, key| match field(word, key).axis {
                Axis::Ago(step) => step,
                other => panic!("{other:?}"),
            };
            assert_eq!(step(0x0259, "max"), "hour");
            assert_eq!(step(0x2259, "max"), "month");
            assert_eq!(step(0x3259, "avg"), "year");
            assert_eq!(at(0x2259, "max"), (1, 12));
            assert_eq!(field(0x0259, "start").label, "Start");
        }),
    ),
    (
        "B10",
        By(|| {
            assert_eq!(field(0x125C, "min").axis, Axis::Ago("day"));
            assert_eq!(field(0x325C, "min").axis, Axis::Ago("year"));
        }),
    ),
    (
        "B11",
        By(|| {
            assert_eq!(field(0x0001, "max").axis, Axis::Ago("hour"));
            assert_eq!(field(0x1001, "max").axis, Axis::Ago("day"));
            assert_eq!(field(0x2001, "avg").axis, Axis::Ago("month"));
            assert_eq!(field(0x3001, "avg").axis, Axis::Ago("year"));
        }),
    ),
    (
        "B12",
        By(|| {
            assert_eq!(words_of(2), 91);
            let label = |key, index| field(2, key).axis.label(index);
            assert_eq!(label("time_low", 0), "0 to 0.4 G");
            assert_eq!(label("time_low", 9), "3.6 to 4 G");
            assert_eq!(label("time_high", 0), "4 to 7.2 G");
            assert_eq!(label("time_high", 4), "16.8 to 20 G");
        }),
    ),
    (
        "B13",
        By(|| {
            assert_eq!(words_of(0x03ED), 4);
            assert_eq!(at(0x03ED, "warnings"), (2, 1));
        }),
    ),
    (
        "B14",
        By(|| {
            assert_eq!(field(0x04B2, "id").kind, FieldKind::U32);
            assert_eq!(field(0x04B3, "id").kind, FieldKind::U16);
            let stride = |word| layout(word).record.map(|r| (r.stride, r.max));
            assert_eq!(stride(0x04B2), Some((27, 18)));
            assert_eq!(stride(0x04B3), Some((28, 18)));
            assert_eq!((words_of(0x04B2), words_of(0x04B3)), (487, 505));
        }),
    ),
    (
        "B15",
        By(|| {
            let part = |id| object(id).map(|o| o.section.part);
            assert_eq!(part(1006), Some("section 7.5, p. 24"));
            assert_eq!(part(1007), Some("section 7.4, p. 23"));
        }),
    ),
    (
        "B16",
        By(|| {
            let part = |id| object(id).map(|o| o.section.part);
            assert_eq!(part(5), Some("section 3.1.4, p. 8"));
            assert_eq!(part(209), Some("section 4.9, p. 15"));
            assert_eq!(part(405), Some("section 5.5, p. 18"));
            assert_eq!(part(604), Some("section 6.3, p. 21"));
        }),
    ),
    ("B17", By(|| names(0x00D0, "open_starts_count", "B17"))),
    (
        "B18",
        By(|| {
            assert_eq!(field(0x00D0, "service_count").kind, FieldKind::U16);
            assert_eq!(at(0x00D0, "service_remaining"), (23, 1));
        }),
    ),
    (
        "B19",
        By(|| {
            assert_eq!(error_name(0), Some("None"));
            assert_eq!(error_name(1), Some("Unhandled command"));
            assert_eq!(error_name(2), Some("Object too large"));
            assert_eq!(error_name(14), Some("Parameter count mismatch"));
            assert_eq!(error_name(15), None);
        }),
    ),
    (
        "B20",
        By(|| {
            let name = |code| shared::dop::STATUSES.get(code).map(|m| m.label);
            assert_eq!(
                [1, 2, 3].map(name),
                [Some("Busy"), Some("Ready"), Some("Error")]
            );
            assert_eq!([0, 4, 5, 6, 7].map(name), [None; 5]);
        }),
    ),
    (
        "C1",
        By(|| {
            assert_eq!(field(7, "motor_temperature").unit, "°C");
            says(7, 29, 17, 0xFF97, "motor_temperature", "-10.5 °C");
        }),
    ),
    (
        "C2",
        By(|| says(0x0192, 88, 14, 455, "open_recent_average", "45.5 %")),
    ),
    (
        "C3",
        By(|| {
            says(
                0x00CD,
                40,
                10,
                215,
                "last_open_motor_temperature",
                "21.5 °C",
            );
            says(
                0x0192,
                88,
                5,
                215,
                "open_recent_start_temperature",
                "21.5 °C",
            );
        }),
    ),
    (
        "C4",
        By(|| {
            disputed(
                "temperature",
                "degF",
                Setting::Temperature,
                0x025A,
                "average",
                23,
            );
            let profile = Profile::from_json(r#"{"temperature":"degF"}"#).expect("a profile");
            let mut words = [0; 23];
            words[0] = 705;
            let read = ObjectRead::read(Request::from_word(0x025A), &words, &profile);
            assert_eq!(read.text("average").as_deref(), Some("70.5 °F"));
            assert_eq!(read.number("average").map(|n| n.unit), Some("°F"));
        }),
    ),
    (
        "C5",
        By(|| {
            for key in ["fault_count", "hi_count"] {
                assert_eq!(
                    (
                        field(0x025A, key).unit,
                        field(0x025A, key).scale.to_string()
                    ),
                    ("", "1".to_owned())
                );
            }
        }),
    ),
    (
        "C6",
        By(|| {
            for (word, key) in [(3, "max"), (4, "avg"), (0xC9, "open"), (0xC9, "close")] {
                let axis = field(word, key).axis;
                assert_eq!(
                    (axis.label(0), axis.label(9)),
                    ("0 to 10 %".to_owned(), "90 to 100 %".to_owned())
                );
            }
        }),
    ),
    (
        "C7",
        By(|| {
            for (word, key) in [
                (6, "hi_time"),
                (0xC9, "open_when"),
                (0xC9, "close_when"),
                (0xCA, "open_when"),
                (0x10CA, "close_when"),
            ] {
                assert_eq!(
                    (field(word, key).kind, field(word, key).unit),
                    (FieldKind::Time, "")
                );
            }
        }),
    ),
    (
        "C8",
        By(|| {
            assert_eq!(field(0x00CB, "max").scale.to_string(), "0.001");
            assert_eq!(field(0x20CC, "avg").scale.to_string(), "0.001");
            assert_eq!(
                field(0x00CD, "last_open_distance").scale.to_string(),
                "0.0001"
            );
            assert_eq!(field(0x00CE, "close_deviation").scale.to_string(), "0.0001");
            scaled("dst_trend", 10_000, 0x30CB, "max", 71, "0.0001");
            scaled(
                "dst_statistics",
                1000,
                0x00CE,
                "open_deviation",
                16,
                "0.001",
            );
        }),
    ),
    (
        "C9",
        By(|| {
            for (key, first) in [
                ("last_open_average", 6),
                ("open_average", 14),
                ("open_max", 16),
                ("open_min", 18),
                ("last_close_average", 26),
                ("close_average", 34),
                ("close_max", 36),
                ("close_min", 38),
            ] {
                assert_eq!(at(0x00CD, key), (first, 1));
                assert_eq!(field(0x00CD, key).scale.to_string(), "0.0001");
                names(0x00CD, key, "C9");
            }
        }),
    ),
    (
        "C10",
        By(|| {
            assert_eq!(at(0x00CE, "open_deviation"), (6, 1));
            assert_eq!(field(0x00CE, "open_deviation").scale.to_string(), "0.0001");
        }),
    ),
    (
        "C11",
        By(|| assert_eq!(field(0x00CF, "hi_minutes").unit, "min")),
    ),
    (
        "C12",
        By(|| {
            says(0x0191, 410, 408, 1000, "start_position", "100.0 %");
            says(0x0192, 88, 15, 455, "open_recent_stop", "45.5 %");
            says(0x0195, 10, 4, 455, "open", "45.5 %");
            says(0x025D, 10, 4, 455, "max", "45.5 °C");
            says(0x03EB, 22, 4, 455, "max_voltage", "455 V");
            says(0x00CD, 40, 11, 455, "last_open_voltage", "455 V");
        }),
    ),
    (
        "C13",
        By(|| {
            assert_eq!(field(0x0193, "open_ref_positions").unit, "");
            let read = read(0x0193, &[1; 36]);
            assert_eq!(
                read.number("open_ref_positions")
                    .map(|n| (n.raw, n.quality)),
                Some((1, Quality::Disputed))
            );
        }),
    ),
    (
        "C14",
        By(|| {
            for (key, name) in [
                ("position", "movement_position"),
                ("speed", "movement_speed"),
                ("torque", "movement_torque"),
            ] {
                assert_eq!(field(0x04B3, key).scale.to_string(), "1");
                scaled(name, 100, 0x04B3, key, 29, "0.01");
            }
        }),
    ),
    (
        "C15",
        By(|| {
            for (key, first) in [("demand", 10), ("deadband", 11), ("proportional_band", 12)] {
                assert_eq!(at(0x04B3, key), (first, 1));
                assert_eq!(
                    (
                        field(0x04B3, key).unit,
                        field(0x04B3, key).scale.to_string()
                    ),
                    ("%", "0.1".to_owned())
                );
            }
        }),
    ),
    (
        "C16",
        By(|| {
            let clock = |words: [u16; 4], json: &str| {
                let profile = Profile::from_json(json).expect("a profile");
                let words = [&words[..], &[0, 0]].concat();
                ObjectRead::read(Request::from_word(0x03EF), &words, &profile).time("now")
            };
            // 0x60269ECB seconds are 2021-02-12T15:29:15Z.
            assert_eq!(
                clock([0x9ECB, 0x6026, 0, 0], "{}"),
                Some(Stamp::At(1_613_143_755))
            );
            assert_eq!(clock([0; 4], "{}"), Some(Stamp::Never));
            assert_eq!(clock([0xFFFF; 4], "{}"), Some(Stamp::Never));
            assert_eq!(
                clock([0xFFFF, 0xFFFF, 0xFFFF, 0x7FFF], "{}"),
                Some(Stamp::Odd(i64::MAX))
            );
            assert_eq!(
                clock([1000, 0, 0, 0], r#"{"time":{"unit":"ms"}}"#),
                Some(Stamp::At(1))
            );
            assert_eq!(
                clock([1, 0, 0, 0], r#"{"time":{"epoch":946684800}}"#),
                Some(Stamp::At(946_684_801))
            );
            // Never stays never, whatever the epoch.
            assert_eq!(
                clock([0; 4], r#"{"time":{"epoch":946684800}}"#),
                Some(Stamp::Never)
            );
            assert!(Profile::default().is_assumed(Setting::TimeEpoch));
        }),
    ),
    (
        "C17",
        By(|| {
            let tag = |json: &str| {
                let profile = Profile::from_json(json).expect("a profile");
                let mut words = vec![0; 128];
                // "MX-301" with the first of two characters in the low byte.
                words[..3].copy_from_slice(&[0x584D, 0x332D, 0x3130]);
                ObjectRead::read(Request::from_word(0x03EE), &words, &profile).text("user_tag")
            };
            assert_eq!(tag("{}").as_deref(), Some("MX-301"));
            assert_eq!(
                tag(r#"{"words":{"text_low_byte_first":false}}"#).as_deref(),
                Some("XM3-10")
            );
            assert_eq!(
                tag(r#"{"words":{"byte_swap":true}}"#).as_deref(),
                Some("XM3-10")
            );
        }),
    ),
    (
        "C18",
        By(|| {
            // Single bytes stand in texts only: no other field is narrower than a register.
            for object in &shared::dop::OBJECTS {
                for field in object.options.iter().flat_map(|c| c.layout.fields) {
                    assert!(field.kind.words() > 0 && field.kind.key() != "U8");
                }
            }
        }),
    ),
    (
        "C19",
        By(|| {
            let mut words = [0; 105];
            words[0] = 2;
            words[1] = 7;
            words[3] = 8;
            words[5] = 9;
            let read = read(1, &words);
            let raw = |key| read.series(key).iter().map(|n| n.raw).collect::<Vec<_>>();
            assert_eq!(raw("max"), [7, 8]);
            assert_eq!(raw("avg"), [0, 0]);
            // The others are there all the same, without a value.
            let beyond = read
                .decoded
                .fields()
                .iter()
                .filter(|f| matches!(f.value, Value::Unavailable(w) if w.contains("points")));
            assert_eq!(beyond.count(), 22 + 22);
        }),
    ),
    (
        "C20",
        By(|| {
            for word in [0x00CB, 0x00CC] {
                let graphs = layout(word).fields.iter().filter(|f| f.count > 1);
                assert_eq!(
                    graphs.map(|f| f.part).collect::<Vec<_>>(),
                    [Part::Max, Part::Min, Part::Avg]
                );
                assert_eq!(field(word, "max").label, "Maximum final position");
            }
        }),
    ),
    (
        "C21",
        By(|| {
            assert!(field(0x00CA, "close").label.contains("starts"));
            assert!(field(0x025D, "max").label.contains("internal"));
        }),
    ),
    (
        "C22",
        By(|| {
            use shared::address::{Address, Table};
            use shared::map::row::Model;
            let bit_7 = |model: Model| {
                let row = model.map().row_at(Table::Holding, Address::new(9));
                let set = row
                    .and_then(|r| r.set)
                    .expect("the fault register has bits");
                set.get(7).map(|bit| bit.label)
            };
            assert_eq!(bit_7(Model::Ddc100MxB), Some("Any user indicator active"));
            assert_eq!(bit_7(Model::Ddc100Mx), None, "older units do not use it");
            assert_eq!(
                bit_7(Model::Ddc100Uec),
                Some("Manually moved from open to mid-travel")
            );
        }),
    ),
    (
        "C23",
        By(|| assert_eq!(field(0x04B3, "position").label, "Position")),
    ),
    (
        "C24",
        By(|| {
            let text = |bytes: &[u8]| {
                let mut words = vec![1, 1, 0, 0, 0, 0, 0, 0];
                let mut padded = bytes.to_vec();
                padded.resize(40, 0);
                words.extend(
                    padded
                        .chunks(2)
                        .map(|pair| u16::from_le_bytes([pair[0], pair[1]])),
                );
                let records = read(0x04B2, &words).records();
                records[0].text.clone()
            };
            assert_eq!(text(b"short"), "short");
            // Forty characters without a NUL, and what stands behind the first NUL.
            let full = b"0123456789012345678901234567890123456789";
            assert_eq!(text(full).as_bytes(), full);
            assert_eq!(text(b"end\0ghost"), "end");
        }),
    ),
    (
        "M1",
        By(|| {
            let parts = |word| {
                (
                    Request::from_word(word).object(),
                    Request::from_word(word).option(),
                )
            };
            assert_eq!(
                [0x1001, 0x2001, 0x3001].map(parts),
                [(1, 1), (1, 2), (1, 3)]
            );
            assert_eq!(Request::new(1, 3).map(Request::word), Some(0x3001));
            assert_eq!(Request::new(2048, 0), None);
            assert_eq!(Request::new(1, 16), None);
            // Bit 11 is zero in every request that is let through.
            unknown(0x0801);
        }),
    ),
    (
        "M2",
        Because("the state machine of the handshake learns the position; its tests hold all three"),
    ),
    (
        "M3",
        By(|| {
            let profile = Profile::default();
            // Four registers, the low word first: bits 0, 17 and 63.
            let raw = profile.indicators([0x0001, 0x0002, 0, 0x8000]);
            use shared::dop::profile::BitWord::Indicators;
            let names: Vec<String> = profile
                .active(Indicators, raw)
                .into_iter()
                .map(|b| b.name)
                .collect();
            assert_eq!(
                names,
                [
                    "User indicator bit 0",
                    "User indicator bit 17",
                    "User indicator bit 63"
                ]
            );
            assert!(profile.bit(Indicators, 17).assumed);
            let named = Profile::from_json(
                r#"{"indicators":[{"bit":17,"name":"Vibration HI","ne107":"S"}]}"#,
            )
            .expect("a profile");
            let bit = named.bit(Indicators, 17);
            assert_eq!(
                (bit.name.as_str(), bit.ne107.map(Ne107::letter), bit.assumed),
                ("Vibration HI", Some("S"), false)
            );
        }),
    ),
    (
        "M4",
        By(|| {
            let read = read(0x03ED, &[1, 0x8000, 0x0100, 0]);
            assert_eq!(
                read.text("alarms").as_deref(),
                Some("Alarm bit 0, Alarm bit 31")
            );
            assert_eq!(read.text("warnings").as_deref(), Some("Warning bit 8"));
            assert!(read.active("alarms").iter().all(|bit| bit.assumed));
            names(0x03ED, "warnings", "M4");
        }),
    ),
    (
        "M5",
        By(|| {
            for (option, key) in (0..).zip(["newest", "oldest", "older", "newer", "present"]) {
                request(option << 12 | 0x04B2, "event_log", key);
                request(option << 12 | 0x04B3, "movement_log", key);
            }
            unknown(0x54B2);
            let profile = Profile::from_json(
                r#"{"log":{"newest":8,"oldest":9,"older":10,"newer":11,"present":0}}"#,
            )
            .expect("a profile");
            let log = object(1203).expect("the log");
            assert_eq!(
                log.log_request(LogCommand::Older, &profile)
                    .map(Request::word),
                Some(0xA4B3)
            );
            assert!(Request::from_word(0xA4B3).is_known(&profile));
            assert!(!Request::from_word(0x24B3).is_known(&profile));
        }),
    ),
    (
        "M6",
        By(|| {
            let read = read(0x44B3, &[1]);
            assert_eq!(
                (read.number("present").map(|n| n.raw), read.error),
                (Some(1), None)
            );
        }),
    ),
    (
        "M7",
        By(|| {
            let registers = Profile::default().registers;
            assert_eq!(
                [
                    registers.request,
                    registers.indicators,
                    registers.status,
                    registers.count,
                    registers.response
                ],
                [None; 5]
            );
        }),
    ),
    (
        "M8",
        By(|| {
            assert_eq!(Profile::default().max_registers(), 125);
            assert!(Profile::from_json(r#"{"reading":{"max_registers":126}}"#).is_err());
            assert_eq!(
                Profile::from_json(r#"{"reading":{"max_registers":16}}"#)
                    .map(|p| p.max_registers()),
                Ok(16)
            );
        }),
    ),
    (
        "M9",
        By(|| {
            let profile = Profile::default();
            assert_eq!((profile.poll_ms(), profile.timeout_ms()), (250, 10_000));
        }),
    ),
    (
        "M10",
        Because("the figures show samples only; no value depends on them"),
    ),
];

fn read(word: u16, words: &[u16]) -> ObjectRead {
    ObjectRead::read(Request::from_word(word), words, &Profile::default())
}

/// The request reads this option of this object.
fn request(word: u16, key: &str, option: &str) {
    let found = Request::from_word(word).find(&Profile::default());
    let found = found.map(|(object, choice)| (object.key, choice.key));
    assert_eq!(found, Some((key, option)), "{word:#06x}");
}

fn unknown(word: u16) {
    assert!(
        !Request::from_word(word).is_known(&Profile::default()),
        "{word:#06x}"
    );
}

fn layout(word: u16) -> &'static Layout {
    let found = Request::from_word(word).find(&Profile::default());
    found.expect("a known request").1.layout
}

fn words_of(word: u16) -> u16 {
    layout(word).words
}

fn field(word: u16, key: &str) -> &'static Field {
    layout(word)
        .field(key)
        .unwrap_or_else(|| panic!("no {key} in {word:#06x}"))
}

/// First register and number of values.
fn at(word: u16, key: &str) -> (u16, u16) {
    (field(word, key).at, field(word, key).count)
}

/// The reading is visible at the field.
fn names(word: u16, key: &str, id: &str) {
    let field = field(word, key);
    assert!(
        field.readings().any(|r| r.id == id),
        "{key} does not name {id}"
    );
    assert_eq!(field.trust, Trust::Reading);
}

/// An object of so many registers, one of them set, says this.
fn says(word: u16, registers: usize, register: usize, value: u16, key: &str, text: &str) {
    let mut words = vec![0; registers];
    words[register] = value;
    assert_eq!(read(word, &words).text(key).as_deref(), Some(text));
}

/// The value is disputed until the profile decides.
fn disputed(name: &str, value: &str, setting: Setting, word: u16, key: &str, registers: usize) {
    let words = vec![1; registers];
    let quality = |profile: &Profile| {
        ObjectRead::read(Request::from_word(word), &words, profile)
            .number(key)
            .map(|n| n.quality)
    };
    let set = Profile::from_json(&format!("{{\"{name}\":\"{value}\"}}")).expect("a profile");
    assert_eq!(quality(&Profile::default()), Some(Quality::Disputed));
    assert_eq!(quality(&set), Some(Quality::Good));
    assert!(Profile::default().is_assumed(setting) && !set.is_assumed(setting));
}

/// A scale of the profile takes the place of the printed one, which is disputed.
fn scaled(name: &str, counts: u32, word: u16, key: &str, registers: usize, scale: &str) {
    let words = vec![1; registers];
    let number = |profile: &Profile| {
        let read = ObjectRead::read(Request::from_word(word), &words, profile);
        let number = read.number(key).expect("a number");
        (number.scale.to_string(), number.quality)
    };
    let set =
        Profile::from_json(&format!("{{\"scales\":{{\"{name}\":{counts}}}}}")).expect("a profile");
    assert_eq!(number(&Profile::default()).1, Quality::Disputed);
    assert_eq!(number(&set), (scale.to_owned(), Quality::Good));
}

#[test]
fn every_reading_is_held() {
    let ids: Vec<&str> = READINGS.iter().map(|r| r.id).collect();
    let held: Vec<&str> = HELD.iter().map(|(id, _)| *id).collect();
    assert_eq!(held, ids);
    for (id, how) in &HELD {
        println!("{id}");
        match how {
            By(test) => test(),
            Because(reason) => assert!(reason.len() > 20, "{id}"),
        }
        assert!(reading(id).is_some_and(|r| !r.text.is_empty()));
    }
}

/// What the readings call open is open here, and nothing else.
#[test]
fn open_readings_are_open() {
    let open: BTreeSet<&str> = READINGS
        .iter()
        .filter(|r| r.settled == Settled::No)
        .map(|r| r.id)
        .collect();
    let expected = [
        "B17", "C4", "C8", "C13", "C14", "C18", "M2", "M3", "M4", "M5", "M6", "M7", "M9",
    ];
    assert_eq!(open, expected.into_iter().collect());
}

/// Readings that concern values are also in the written cases.
#[test]
fn cases_name_their_readings() {
    let names: String = FILES
        .iter()
        .flat_map(|(_, text)| cases(text))
        .map(|case| format!("{} ", case.name))
        .collect();
    for id in [
        "A1", "A3", "A5", "A6", "A8", "A9", "A10", "B1a", "B2", "B2a", "B3", "B4", "C4", "C16",
        "C17", "C24", "M4", "M5", "M6",
    ] {
        let named = names
            .split(|c: char| !c.is_ascii_alphanumeric())
            .any(|word| word == id);
        assert!(named, "no case names {id}");
    }
}
