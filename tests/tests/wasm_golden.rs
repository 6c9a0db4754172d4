//! The golden cases in a browser: the same expectations, and the same JSON as natively.
#![cfg(target_arch = "wasm32")]

use tests::dop;
use tests::golden::{FILES, cases, differences, json_lines};
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_browser);

#[wasm_bindgen_test]
fn cases_decode_as_their_sources_say() {
    for (name, text, _) in FILES {
        for case in cases(text) {
            assert_eq!(
                differences(&case),
                Vec::<String>::new(),
                "{name}: {}",
                case.name
            );
        }
    }
}

/// The lines on disk were written by the native build.
#[wasm_bindgen_test]
fn wasm_says_what_the_native_build_says() {
    for (name, text, native) in FILES {
        let here: String = cases(text).iter().map(json_lines).collect();
        let differs = here.lines().zip(native.lines()).find(|(a, b)| a != b);
        assert_eq!(differs, None, "{name}");
        assert_eq!(here.lines().count(), native.lines().count(), "{name}");
    }
}

/// Diagnostic objects: the written expectations, and the JSON of the native build.
#[wasm_bindgen_test]
fn objects_decode_as_their_sources_say() {
    for (name, text) in dop::FILES {
        for case in dop::cases(text) {
            let differences = dop::differences(&case);
            assert_eq!(differences, Vec::<String>::new(), "{name}: {}", case.name);
        }
    }
    assert_eq!(dop::blessed_now(), dop::BLESSED.1);
}
