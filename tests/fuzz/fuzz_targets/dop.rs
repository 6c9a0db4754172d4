//! Any registers, any pasted text and any profile of a diagnostic object: nothing panics, and the
//! leaves tile the registers.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::dop::profile::Profile;
use shared::dop::{ObjectRead, Request, export, input};
use shared::tree::Name;

const PROFILES: [&str; 3] = [
    "{}",
    r#"{"words":{"low_word_first":false,"text_low_byte_first":false,"byte_swap":true},"temperature":"degF"}"#,
    r#"{"time":{"unit":"ms","epoch":253402300799},"scales":{"dst_trend":1000000},"log":{"newest":9}}"#,
];

fuzz_target!(|data: &[u8]| {
    let [choice, high, low, rest @ ..] = data else {
        return;
    };
    let text = String::from_utf8_lossy(rest);
    if *choice == 0xFF {
        match Profile::from_json(&text) {
            Ok(profile) => {
                let again =
                    Profile::from_json(&profile.to_json()).expect("what was written is sound");
                assert_eq!(again.to_json(), profile.to_json());
            }
            Err(problems) => assert!(!problems.is_empty()),
        }
    }
    let pasted = input::read(&text, None);
    for problem in &pasted.problems {
        assert!(problem.at <= pasted.words.len());
    }
    let words: Vec<u16> = if *choice & 1 == 0 {
        let pairs = rest.chunks_exact(2).take(520);
        pairs
            .map(|pair| u16::from_be_bytes([pair[0], pair[1]]))
            .collect()
    } else {
        pasted.words.into_iter().take(520).collect()
    };
    let profile = Profile::from_json(PROFILES[usize::from(*choice >> 1) % PROFILES.len()]);
    let profile = profile.expect("a sound profile");
    let request = Request::from_word(u16::from_be_bytes([*high, *low]));
    let read = if *choice & 0x40 == 0 {
        ObjectRead::read(request, &words, &profile)
    } else {
        ObjectRead::error(request, &words, &profile)
    };

    // Only leaves count: a group is followed by its parts, a word of bits by its bits.
    let tree = &read.decoded;
    let mut owned = 0_usize;
    for (id, field) in tree.iter() {
        assert!(field.place.range().end <= tree.bytes().len());
        let parts = tree
            .iter()
            .any(|(_, f)| f.parent == Some(id) && !matches!(f.name, Name::DopBit(..)));
        if !parts && !matches!(field.name, Name::DopBit(..)) {
            owned += usize::from(field.place.len);
        }
    }
    assert_eq!(owned, tree.bytes().len(), "leaves tile the registers");
    let mut json = String::new();
    export::write_object(&mut json, 0, &read).expect("a string");
    let _ = (
        read.records(),
        read.plausible_times(),
        read.active("alarms"),
    );
    assert!(ObjectRead::candidates(words.len()).all(|c| c.layout.fits(words.len())));
});
