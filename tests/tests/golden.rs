//! The golden cases, natively. `cargo xtask bless` writes the JSON lines anew.

use tests::golden::{FILES, cases, differences, json_lines};

/// Every case says what its source says.
#[test]
fn cases_decode_as_their_sources_say() {
    let mut wrong = Vec::new();
    let mut count = 0;
    for (name, text, _) in FILES {
        for case in cases(text) {
            count += 1;
            assert!(
                !case.expect.is_empty(),
                "{name}: {} expects nothing",
                case.name
            );
            wrong.extend(
                differences(&case)
                    .into_iter()
                    .map(|d| format!("{name}: {}: {d}", case.name)),
            );
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {count} cases:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
    assert!(count > 60, "only {count} cases found");
}

/// The whole JSON of every case is what it was: a change of the contract is seen.
#[test]
fn json_is_what_it_was() {
    let bless = std::env::var_os("BLESS").is_some();
    for (name, text, blessed) in FILES {
        let now: String = cases(text).iter().map(json_lines).collect();
        for line in now.lines() {
            let parsed: Result<serde_json::Value, _> = serde_json::from_str(line);
            assert!(parsed.is_ok(), "{name}: {parsed:?} in {line}");
        }
        if bless {
            let path = tests::fixture(&format!("{name}.jsonl"));
            std::fs::write(&path, now).expect("the fixture can be written");
        } else {
            // The first line that differs says more than all of them.
            let differs = now.lines().zip(blessed.lines()).find(|(a, b)| a != b);
            assert_eq!(
                differs, None,
                "{name}.jsonl; `cargo xtask bless` if that is meant"
            );
            assert_eq!(now.lines().count(), blessed.lines().count(), "{name}.jsonl");
        }
    }
}
