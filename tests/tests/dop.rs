//! Diagnostic objects: every object and option against what the manual's tables say.

use shared::dop::profile::Profile;
use shared::dop::{OBJECTS, Request, export};
use std::collections::BTreeSet;
use tests::dop::{BLESSED, Case, FILES, blessed_now, cases, differences};

fn all_cases() -> Vec<(&'static str, Case)> {
    let of =
        |(name, text): (&'static str, &str)| cases(text).into_iter().map(move |case| (name, case));
    FILES.into_iter().flat_map(of).collect()
}

/// Every case says what its source says.
#[test]
fn cases_decode_as_their_sources_say() {
    let cases = all_cases();
    let mut wrong = Vec::new();
    for (name, case) in &cases {
        assert!(
            !case.expect.is_empty(),
            "{name}: {} expects nothing",
            case.name
        );
        let found = differences(case);
        wrong.extend(found.iter().map(|d| format!("{name}: {}: {d}", case.name)));
    }
    assert!(
        wrong.is_empty(),
        "{} of {} cases:\n{}",
        wrong.len(),
        cases.len(),
        wrong.join("\n")
    );
}

/// No object, no option and no layout is left out.
#[test]
fn every_option_has_a_case() {
    let cases = all_cases();
    let profile = Profile::default();
    let asked: BTreeSet<Request> = cases
        .iter()
        .filter(|(_, case)| case.profile.is_empty() && !case.error)
        .map(|(_, case)| Request::from_word(case.request))
        .collect();
    let chosen: BTreeSet<(u16, &str)> = cases
        .iter()
        .filter_map(|(_, case)| {
            let read = case.read();
            Some((read.request.object(), read.layout?.key))
        })
        .collect();
    for object in &OBJECTS {
        for choice in object.options {
            let request = object.request(choice, &profile);
            // All commands of a log have the same answer, but for the last.
            let same = choice.command.is_some()
                && cases
                    .iter()
                    .any(|(_, case)| Request::from_word(case.request).object() == object.id);
            assert!(asked.contains(&request) || same, "no case for {request}");
            for layout in choice.layouts() {
                let other = (object.id, layout.key);
                // Object 601 answered with its own trends is the same layout under another option.
                assert!(
                    chosen.contains(&other) || layout.key == "log_present",
                    "{other:?}"
                );
            }
        }
    }
}

/// The whole JSON of these cases is what it was: a change of the contract is seen.
#[test]
fn json_is_what_it_was() {
    let (name, blessed) = BLESSED;
    let now = blessed_now();
    for line in now.lines() {
        let parsed: Result<serde_json::Value, _> = serde_json::from_str(line);
        assert!(parsed.is_ok(), "{parsed:?} in {line}");
    }
    if std::env::var_os("BLESS").is_some() {
        let path = tests::fixture(&format!("dop/{name}.jsonl"));
        std::fs::write(&path, now).expect("the fixture can be written");
        return;
    }
    // The first line that differs says more than all of them.
    let differs = now.lines().zip(blessed.lines()).find(|(a, b)| a != b);
    assert_eq!(differs, None, "`cargo xtask bless` if that is meant");
    assert_eq!(now.lines().count(), blessed.lines().count());
}

/// One line for each field of every request, in the form that the documentation promises.
#[test]
fn the_list_of_fields_keeps_its_contract() {
    let lines: Vec<String> = export::lines(false)
        .map(|line| {
            let mut text = String::new();
            line.write_json(&mut text).expect("writing to a String");
            text
        })
        .collect();
    let parsed: Vec<serde_json::Value> = lines
        .iter()
        .map(|line| serde_json::from_str(line).expect("a JSON object"))
        .collect();
    // Object 1, 30 days: 1 to 59 in steps of two registers.
    let of = |request: &str, key: &str| {
        let found = parsed
            .iter()
            .find(|line| line["request"] == request && line["key"] == key);
        found
            .cloned()
            .unwrap_or_else(|| panic!("no {key} in {request}"))
    };
    let max = of("0x1001", "max");
    for (key, value) in [
        ("device", serde_json::json!("dop")),
        ("object", 1.into()),
        ("option", 1.into()),
        ("offset", 1.into()),
        ("count", 30.into()),
        ("type", "S32".into()),
        ("label", "Maximum vibration".into()),
        ("unit", "mG".into()),
        ("scale", "1".into()),
        ("source", "AIIOM000698-01, section 3.1.1, p. 6".into()),
        ("trust", "reading".into()),
    ] {
        assert_eq!(max[key], value, "{key}");
    }
    // One record of a log, with what repeats it.
    let text = of("0x04B3", "text");
    assert_eq!(
        (&text["offset"], &text["stride"], &text["max"]),
        (&13.into(), &28.into(), &18.into())
    );
    assert_eq!(of("0x04B3", "records").get("stride"), None);
    assert_eq!(of("0x00CF", "hi_max")["trust"], "inferred");
    assert_eq!(of("0x0005", "frequency")["scale"], "0.1");
    assert_eq!(of("0x0005", "frequency")["trust"], "manual");
    // All objects and options, and the registers of each request without a hole.
    let requests: BTreeSet<String> = parsed
        .iter()
        .filter_map(|l| Some(l["request"].as_str()?.to_owned()))
        .collect();
    let options: usize = OBJECTS.iter().map(|o| o.options.len()).sum();
    assert_eq!(requests.len(), options);
    for request in requests {
        let mut next = 0;
        for line in parsed.iter().filter(|l| l["request"] == request.as_str()) {
            assert_eq!(line["offset"], next, "{request} {line}");
            next += line["count"].as_u64().unwrap() * line["words"].as_u64().unwrap();
        }
        assert!(next <= 512, "{request}");
    }
    // Other layouts are listed when asked for, and only then.
    assert!(export::lines(true).count() > lines.len());
    assert!(parsed.iter().all(|line| line["recommended"] == true));
}

#[test]
fn csv_lines_have_the_columns_of_their_header() {
    let columns = export::CSV_HEADER.split(',').count();
    for line in export::lines(true) {
        let mut text = String::new();
        line.write_csv(&mut text).expect("writing to a String");
        // Cells with commas are in quotes.
        let quoted = text
            .split('"')
            .skip(1)
            .step_by(2)
            .map(|cell| cell.matches(',').count());
        let commas = text.matches(',').count() - quoted.sum::<usize>();
        assert_eq!(commas + 1, columns, "{text}");
    }
}
