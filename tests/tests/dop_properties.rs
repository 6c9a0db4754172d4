//! Promises that hold for any registers of a diagnostic object, any profile and any pasted text.

use proptest::collection::vec;
use proptest::prelude::*;
use shared::dop::input::{self, Form};
use shared::dop::profile::Profile;
use shared::dop::{OBJECTS, ObjectRead, Request, export};
use tests::dop::tiles;

/// Requests: any word, or a known one so that layouts are met.
fn request() -> impl Strategy<Value = Request> {
    let known: Vec<Request> = OBJECTS
        .iter()
        .flat_map(|object| {
            let request = |choice| object.request(choice, &Profile::default());
            object.options.iter().map(request)
        })
        .collect();
    prop_oneof![
        3 => prop::sample::select(known),
        1 => any::<u16>().prop_map(Request::from_word),
    ]
}

/// A word as devices send them, or any.
fn word() -> impl Strategy<Value = u16> {
    prop_oneof![Just(0), Just(0xFFFF), 0..64_u16, any::<u16>()]
}

/// Registers in the number that the request wants, near it, or any.
fn registers() -> impl Strategy<Value = (Request, Vec<u16>)> {
    request().prop_flat_map(|request| {
        let wanted = request
            .find(&Profile::default())
            .map_or(9, |(_, choice)| usize::from(choice.layout.words));
        let len = prop_oneof![
            2 => Just(wanted),
            1 => wanted.saturating_sub(3)..wanted + 4,
            1 => 0..=512_usize,
        ];
        let words = len.prop_flat_map(|len| vec(word(), len));
        (Just(request), words)
    })
}

fn profile() -> impl Strategy<Value = Profile> {
    prop::sample::select(vec![
        "{}",
        r#"{"words":{"low_word_first":false,"text_low_byte_first":false,"byte_swap":true}}"#,
        r#"{"temperature":"degF","time":{"unit":"ms","epoch":253402300799}}"#,
        r#"{"scales":{"dst_trend":1000000,"movement_speed":100},"log":{"newest":15}}"#,
        r#"{"alarms":[{"bit":31,"name":"Überdrehmoment \"A\"","ne107":"F"}]}"#,
    ])
    .prop_map(|text| Profile::from_json(text).expect("a sound profile"))
}

/// Everything that can be asked of a decoded object, so that nothing of it panics.
fn ask(read: &ObjectRead) {
    let tree = &read.decoded;
    for (id, field) in tree.iter() {
        assert!(tree.path(id).starts_with("dop."), "{}", tree.path(id));
        let _ = (tree.text(field), tree.raw(field), field.name.label());
        assert!(usize::from(field.place.end()) <= tree.bytes().len());
    }
    for problem in tree.problems() {
        assert!(!problem.to_string().is_empty());
        assert!(usize::from(problem.place.end()) <= tree.bytes().len());
    }
    for field in read.layout.into_iter().flat_map(|layout| layout.fields) {
        let numbers = read.series(field.key);
        let most = read.layout.and_then(|l| l.record).map_or(1, |r| r.max);
        assert!(numbers.len() <= usize::from(field.count.max(most)));
        assert!(numbers.iter().all(|n| n.to_f64().is_finite()));
        let _ = (
            read.number(field.key),
            read.time(field.key),
            read.text(field.key),
            read.active(field.key),
        );
    }
    for record in read.records() {
        assert!(record.text.len() <= 2 * 80);
    }
    let mut line = String::new();
    export::write_object(&mut line, 0, read).expect("writing to a String");
    let parsed: Result<serde_json::Value, _> = serde_json::from_str(&line);
    assert!(parsed.is_ok(), "{parsed:?} in {line}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Any registers of any request decode without a panic, and their leaves tile them.
    #[test]
    fn any_registers_tile((request, words) in registers(), profile in profile()) {
        let read = ObjectRead::read(request, &words, &profile);
        prop_assert_eq!(&read.words, &words);
        prop_assert_eq!(tiles(&read.decoded), Ok(()));
        ask(&read);
    }

    /// The same for an answer whose status is Error.
    #[test]
    fn any_error_tiles((request, words) in registers(), profile in profile()) {
        let read = ObjectRead::error(request, &words, &profile);
        prop_assert_eq!(tiles(&read.decoded), Ok(()));
        prop_assert_eq!(read.error, words.first().copied());
        ask(&read);
    }

    /// Registers in the number of a layout are never called too few or too many.
    #[test]
    fn a_fitting_number_has_no_problem((request, words) in registers()) {
        let read = ObjectRead::read(request, &words, &Profile::default());
        let fits = read.layout.is_some_and(|layout| layout.fits(words.len()));
        let told = read.decoded.problems().iter().any(|p| p.code() == "register-count");
        prop_assert!(!(fits && told), "{}", read.why);
    }

    /// Every candidate has a layout of that size.
    #[test]
    fn candidates_fit(count in 0..=600_usize) {
        for candidate in ObjectRead::candidates(count) {
            prop_assert!(candidate.layout.fits(count));
            prop_assert!(candidate.request.is_known(&Profile::default()));
        }
    }

    /// Registers written in any of the usual ways are read back as they were.
    #[test]
    fn any_writing_is_read_back(words in vec(word(), 1..130)) {
        let join = |text: Vec<String>, mark: &str| text.join(mark);
        let of = |text: fn(&u16) -> String| words.iter().map(text).collect::<Vec<_>>();
        let pairs = of(|w| { let [a, b] = w.to_be_bytes(); format!("{a:02x} {b:02X}") });
        let numbered = words.iter().enumerate().map(|(at, w)| format!("[{at}]: \t{w}"));
        let table = words.iter().enumerate().map(|(at, w)| format!("{};{w}", 40_001 + at));
        let cases = [
            (join(of(|w| format!("0x{w:04X}")), " "), None),
            (join(of(|w| format!("0x{w:X},")), "\n"), None),
            (join(of(|w| format!("{w:04x}")), " "), None),
            (join(of(|w| format!("{w:04X}")), ""), Some(Form::Hex)),
            (join(of(|w| format!("{w:04X}h")), "; "), None),
            (join(of(u16::to_string), ", "), Some(Form::Decimal)),
            (join(of(|w| w.cast_signed().to_string()), " "), Some(Form::Decimal)),
            (join(pairs, " "), None),
            (join(numbered.collect(), "\n"), Some(Form::Decimal)),
            (format!("register;value\n{}", join(table.clone().collect(), "\n")), None),
            (join(table.collect(), "\n"), Some(Form::Table)),
        ];
        for (text, form) in cases {
            let input = input::read(&text, form);
            prop_assert_eq!(&input.words, &words, "{}\n{}", input.said, text);
            prop_assert!(input.problems.is_empty(), "{:?}", input.problems);
        }
    }

    /// Any text is read without a panic, and what is no register is told with its place.
    #[test]
    fn any_text_is_read(text in any_text(), form in prop::option::of(prop::sample::select(Form::ALL.to_vec()))) {
        let input = input::read(&text, form);
        prop_assert!(!input.said.is_empty());
        prop_assert!(!input.words.is_empty() || !input.problems.is_empty() || text.trim().is_empty());
        for problem in &input.problems {
            prop_assert!(problem.line >= 1 && problem.column >= 1);
            prop_assert!(problem.at <= input.words.len() && !problem.text.is_empty());
        }
    }

    /// Any text is a profile or has problems with a line of it.
    #[test]
    fn any_text_is_a_profile_or_told(text in any_text()) {
        if let Err(problems) = Profile::from_json(&text) {
            prop_assert!(!problems.is_empty());
            for problem in problems {
                let lines = u32::try_from(text.lines().count()).unwrap().max(1);
                prop_assert!((1..=lines + 1).contains(&problem.line), "{problem}");
            }
        }
    }
}

fn any_text() -> impl Strategy<Value = String> {
    let piece = prop::sample::select(vec![
        "0x12",
        "FFFF",
        "-5",
        "65536",
        "12",
        " ",
        "\n",
        ",",
        ";",
        "\t",
        "[3]:",
        "value",
        "ä",
        "{",
        "}",
        "\"words\"",
        ":",
        "\"byte_swap\"",
        "true",
        "null",
        "\"alarms\"",
        "[",
        "]",
        "\"bit\"",
        "#",
        "h",
        "(7)",
        "01 03 02 00 07 F9 86",
        "1.5",
        "\\",
        "\"",
    ]);
    prop_oneof![
        vec(piece, 0..30).prop_map(|pieces| pieces.concat()),
        any::<String>(),
    ]
}
