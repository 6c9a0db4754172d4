//! The profile of a site: its file, its defaults, and how mistakes in it are told.

use shared::address::Table;
use shared::dop::profile::{BitWord, LogCommand, Ne107, Profile, Setting, Temperature, TimeUnit};

/// A file with every key, as the README shows it.
const WHOLE: &str = r#"{
  "format": "valvescope-dop-profile",
  "version": 1,
  "name": "Site A",
  "registers": {"request": 1000, "indicators": 1001, "status": 1005, "count": 1006, "response": 1007},
  "table": "input",
  "request_function": 16,
  "status": {"shift": 12},
  "words": {"low_word_first": false, "text_low_byte_first": false, "byte_swap": true},
  "time": {"epoch": 946684800, "unit": "ms"},
  "temperature": "degF",
  "scales": {"dst_trend": 100, "dst_statistics": 1000, "movement_position": 10, "movement_speed": 100, "movement_torque": 10},
  "log": {"newest": 1, "oldest": 2, "older": 3, "newer": 4, "present": 5},
  "reading": {"max_registers": 60, "poll_ms": 100, "timeout_ms": 3000, "retries": 1, "log_limit": 500},
  "indicators": [{"bit": 63, "name": "Hunting", "ne107": "M"}],
  "alarms": [{"bit": 0, "name": "Phase lost", "ne107": "F"}],
  "warnings": [{"bit": 31, "name": "Hot"}]
}"#;

/// The problems of a text, as printed.
fn problems(text: &str) -> Vec<String> {
    match Profile::from_json(text) {
        Ok(profile) => panic!("{profile:?}"),
        Err(problems) => problems.iter().map(ToString::to_string).collect(),
    }
}

#[test]
fn an_empty_file_assumes_everything() {
    let profile = Profile::from_json("{}").expect("all keys are optional");
    assert_eq!(profile, Profile::default());
    for setting in Setting::ALL {
        assert!(profile.is_assumed(setting), "{}", setting.key());
    }
    assert_eq!(profile.table(), Table::Holding);
    assert_eq!(profile.request_function(), 6);
    assert!(profile.low_word_first() && profile.text_low_byte_first() && !profile.byte_swap());
    assert_eq!(profile.temperature(), Temperature::DegC);
    assert_eq!(profile.seconds(5), 5);
    assert_eq!(profile.scale(Setting::DstTrend), None);
    assert_eq!((profile.retries(), profile.log_limit()), (2, 10_000));
    assert_eq!(profile.log_option(LogCommand::Newer), 3);
}

#[test]
fn every_key_is_taken() {
    let profile = Profile::from_json(WHOLE).expect("a sound file");
    for setting in Setting::ALL {
        assert!(!profile.is_assumed(setting), "{}", setting.key());
    }
    assert_eq!(profile.name, "Site A");
    let registers = profile.registers;
    assert_eq!(
        [
            registers.request,
            registers.indicators,
            registers.status,
            registers.count,
            registers.response
        ],
        [Some(1000), Some(1001), Some(1005), Some(1006), Some(1007)]
    );
    assert_eq!(profile.table(), Table::Input);
    assert_eq!(
        (profile.request_function(), profile.status.shift),
        (16, Some(12))
    );
    assert!(!profile.low_word_first() && !profile.text_low_byte_first() && profile.byte_swap());
    assert_eq!(profile.time.unit, Some(TimeUnit::Ms));
    assert_eq!(profile.seconds(5999), 946_684_805);
    assert_eq!(profile.temperature(), Temperature::DegF);
    let scale = |setting| profile.scale(setting).map(|s| s.to_string());
    assert_eq!(scale(Setting::DstTrend).as_deref(), Some("0.01"));
    assert_eq!(scale(Setting::DstStatistics).as_deref(), Some("0.001"));
    assert_eq!(scale(Setting::MovementTorque).as_deref(), Some("0.1"));
    assert_eq!(profile.log_option(LogCommand::Present), 5);
    assert_eq!(
        (
            profile.max_registers(),
            profile.poll_ms(),
            profile.timeout_ms(),
            profile.retries(),
            profile.log_limit()
        ),
        (60, 100, 3000, 1, 500)
    );
    let bit = |word, bit| profile.bit(word, bit);
    assert_eq!(bit(BitWord::Indicators, 63).name, "Hunting");
    assert_eq!(bit(BitWord::Alarms, 0).ne107, Some(Ne107::Failure));
    assert_eq!(bit(BitWord::Warnings, 31).ne107, None);
    assert_eq!(bit(BitWord::Warnings, 30).name, "Warning bit 30");
    // What was set stays set, what was not stays an assumption.
    assert_eq!(
        Profile::from_json(&profile.to_json()).as_ref(),
        Ok(&Profile {
            format: Some("valvescope-dop-profile".to_owned()),
            version: Some(1),
            ..profile.clone()
        })
    );
}

#[test]
fn a_written_profile_keeps_its_assumptions() {
    let profile = Profile::from_json(r#"{"temperature":"degF","registers":{"status":7}}"#)
        .expect("a sound file");
    let again = Profile::from_json(&profile.to_json()).expect("a sound file");
    for setting in Setting::ALL {
        assert_eq!(
            again.is_assumed(setting),
            setting != Setting::Temperature,
            "{}",
            setting.key()
        );
    }
    assert_eq!(again.registers, profile.registers);
}

/// Each mistake names its line and key, and says what to write.
#[test]
fn mistakes_are_told() {
    let check = |text: &str, expected: &[&str]| assert_eq!(problems(text), expected, "{text}");
    check(
        "{\n  \"registers\": {\n    \"request\": 70000\n  }\n}",
        &[
            "line 3: registers.request: 70000 does not fit; write a whole number from 0 to 65535, or null",
        ],
    );
    check(
        "{\"registers\": {\"status\": \"40001\"}}",
        &[
            "line 1: registers.status: \"40001\" does not fit; write a whole number from 0 to 65535, or null",
        ],
    );
    check(
        "{\n\"registers\": {\"response\": 65100}}",
        &[
            "line 2: registers.response: 65100 does not fit; write a whole number from 0 to 65024, or null",
        ],
    );
    check(
        "{\n\n \"temperatur\": \"degC\"}",
        &[
            "line 3: temperatur: not a key of a profile; write one of format, version, name, registers, table, \
           request_function, status, words, time, temperature, scales, log, reading, indicators, alarms, warnings",
        ],
    );
    check(
        "{\"words\": {\"low_first\": true}}",
        &[
            "line 1: words.low_first: not a key of a profile; write one of low_word_first, text_low_byte_first, byte_swap",
        ],
    );
    check(
        "{\"temperature\": \"C\"}",
        &["line 1: temperature: \"C\" does not fit; write \"degC\" or \"degF\""],
    );
    check(
        "{\"status\": {\"shift\": 10}}",
        &["line 1: status.shift: 10 does not fit; write a whole number from 11 to 13, or null"],
    );
    check(
        "{\"request_function\": 5}",
        &["line 1: request_function: 5 does not fit; write 6 or 16"],
    );
    check(
        "{\"scales\": {\"dst_trend\": 500}}",
        &[
            "line 1: scales.dst_trend: 500 does not fit; write 1, 10, 100, 1000 and so on to 1000000: counts of one unit",
        ],
    );
    check(
        "{\"format\": \"profile\", \"version\": 2}",
        &[
            "line 1: format: \"profile\" does not fit; write \"valvescope-dop-profile\"",
            "line 1: version: 2 does not fit; write 1",
        ],
    );
    check(
        "{\"words\": 5}",
        &["line 1: words: 5 does not fit; write an object in braces"],
    );
    check("[]", &["line 1: write an object in braces"]);
    check(
        "",
        &["line 1: no JSON at column 0: EOF while parsing a value"],
    );
    check(
        "{\n\"name\": \"A\",\n}",
        &["line 3: no JSON at column 1: trailing comma"],
    );
    check(
        "{\"temperature\": \"degC\",\n \"temperature\": \"degF\"}",
        &["line 2: temperature: is there twice; remove one"],
    );
    check(
        "{\"table\": \"holding\",\n\"words\": {},\n\"words\": {}}",
        &["line 3: words: is there twice; remove one"],
    );
}

/// A file full of mistakes is told in short.
#[test]
fn many_mistakes_are_told_in_short() {
    let keys: Vec<String> = (0..5000).map(|n| format!("\"k{n}\":1")).collect();
    assert_eq!(problems(&format!("{{{}}}", keys.join(","))).len(), 100);
}

#[test]
fn mistakes_in_names_of_bits_are_told() {
    let list = |items: &str| format!("{{\"alarms\": [\n{items}\n]}}");
    let check =
        |items: &str, expected: &[&str]| assert_eq!(problems(&list(items)), expected, "{items}");
    check(
        "{\"bit\": 32, \"name\": \"A\"}",
        &["line 2: alarms[0].bit: there are 32 bits, 0 to 31"],
    );
    check(
        "{\"bit\": 1, \"name\": \"A\"},\n{\"bit\": 1, \"name\": \"B\"}",
        &["line 3: alarms[1].bit: bit 1 has a name already"],
    );
    check(
        "{\"name\": \"A\"}",
        &["line 2: alarms[0]: has no bit; write its number"],
    );
    check(
        "{\"bit\": 1}",
        &["line 2: alarms[0]: has no name; write one in quotes"],
    );
    check(
        "{\"bit\": 1, \"name\": \"A\",\n\"ne107\": \"X\"}",
        &["line 3: alarms[0].ne107: \"X\" does not fit; write \"F\" or \"C\" or \"S\" or \"M\""],
    );
    check(
        "{\"bit\": 1, \"name\": \"A\", \"color\": \"red\"}",
        &["line 2: alarms[0].color: not a key of a profile; write one of bit, name, ne107"],
    );
    check(
        "7",
        &[
            "line 2: alarms[0]: write a list of objects with bit (0 to 31), name, and ne107 if it has a category",
        ],
    );
    assert_eq!(
        problems("{\"warnings\": {}}"),
        [
            "line 1: warnings: {} does not fit; write a list of objects with bit (0 to 31), name, and ne107 if it has a category"
        ]
    );
    // 64 bits for indicators.
    assert!(Profile::from_json("{\"indicators\": [{\"bit\": 63, \"name\": \"A\"}]}").is_ok());
    assert_eq!(
        problems("{\"indicators\": [{\"bit\": 64, \"name\": \"A\"}]}").len(),
        2,
        "no bit, and not one of 64"
    );
}

/// What only two keys together can tell.
#[test]
fn keys_that_contradict_each_other_are_told() {
    assert_eq!(
        problems("{\"registers\": {\n\"status\": 100,\n\"response\": 0}}"),
        ["line 3: registers.response: 0 to 511 overlap registers.status"]
    );
    assert_eq!(
        problems("{\"registers\": {\"request\": 8,\n\"indicators\": 5}}"),
        ["line 2: registers.indicators: 5 to 8 overlap registers.request"]
    );
    // The request is a holding register, the others can be input registers of the same number.
    assert!(
        Profile::from_json("{\"table\":\"input\",\"registers\": {\"request\": 8, \"status\": 8}}")
            .is_ok()
    );
    assert_eq!(
        problems("{\"log\": {\"older\": 1}}"),
        ["line 1: log.older: option 1 is that of log.oldest; every command needs its own"]
    );
}

/// The file that the README shows sets every key to what is assumed without it.
#[test]
fn a_file_of_defaults_changes_nothing() {
    let text = r#"{
  "format": "valvescope-dop-profile", "version": 1, "name": "Site A",
  "registers": {"request": null, "indicators": null, "status": null, "count": null, "response": null},
  "table": "holding", "request_function": 6,
  "status": {"shift": null},
  "words": {"low_word_first": true, "text_low_byte_first": true, "byte_swap": false},
  "time": {"epoch": 0, "unit": "s"},
  "temperature": "degC",
  "scales": {"dst_trend": 1000, "dst_statistics": 10000, "movement_position": 1, "movement_speed": 1, "movement_torque": 1},
  "log": {"newest": 0, "oldest": 1, "older": 2, "newer": 3, "present": 4},
  "reading": {"max_registers": 125, "poll_ms": 250, "timeout_ms": 10000, "retries": 2, "log_limit": 10000},
  "indicators": [{"bit": 0, "name": "Vibration HI", "ne107": "S"}],
  "alarms": [], "warnings": []
}"#;
    let set = Profile::from_json(text).expect("a sound file");
    let none = Profile::default();
    assert_eq!(set.registers, none.registers);
    assert_eq!(set.table(), none.table());
    assert_eq!(set.request_function(), none.request_function());
    assert_eq!(
        (
            set.low_word_first(),
            set.text_low_byte_first(),
            set.byte_swap()
        ),
        (
            none.low_word_first(),
            none.text_low_byte_first(),
            none.byte_swap()
        )
    );
    assert_eq!(set.seconds(1_613_143_755), none.seconds(1_613_143_755));
    assert_eq!(set.temperature(), none.temperature());
    // The scales are those that the fields have without a profile.
    for (setting, id, key) in [
        (Setting::DstTrend, 203, "max"),
        (Setting::DstStatistics, 205, "last_open_distance"),
        (Setting::MovementPosition, 1203, "position"),
        (Setting::MovementSpeed, 1203, "speed"),
        (Setting::MovementTorque, 1203, "torque"),
    ] {
        let object = shared::dop::object(id).expect("the object");
        let field = object.options[0].layout.field(key).expect("the field");
        assert_eq!(field.setting, Some(setting));
        assert_eq!(set.scale(setting), Some(field.scale), "{key}");
    }
    use LogCommand::{Newer, Newest, Older, Oldest, Present};
    for command in [Newest, Oldest, Older, Newer, Present] {
        assert_eq!(set.log_option(command), none.log_option(command));
    }
    assert_eq!(
        (
            set.max_registers(),
            set.poll_ms(),
            set.timeout_ms(),
            set.retries(),
            set.log_limit()
        ),
        (
            none.max_registers(),
            none.poll_ms(),
            none.timeout_ms(),
            none.retries(),
            none.log_limit()
        )
    );
    // Only the position of the status is still to be learned.
    let assumed = Setting::ALL.into_iter().filter(|s| set.is_assumed(*s));
    assert_eq!(assumed.collect::<Vec<_>>(), [Setting::StatusShift]);
}
