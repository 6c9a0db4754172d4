//! The page's reader and writer against the derived ones.

use super::*;

const TEXT: &str = "a \"quoted\"\\ \n é 𝄞 {}";

/// One message of each kind at least, with every word and both ends of every number.
fn to_page() -> Vec<ToPage> {
    let text = || TEXT.to_owned();
    let mut all = vec![
        ToPage::Hello {
            version: u32::MAX,
            app: text(),
            run: u64::MAX,
            now_us: 0,
            wall_ms: 1,
            read_only: true,
            buses: vec![
                Bus {
                    name: text(),
                    line: String::new(),
                    framing: "modbus-rtu".into(),
                    simulated: true,
                };
                2
            ],
            devices: vec![DeviceInfo {
                tag: text(),
                kind: "dop".into(),
                bus: text(),
                unit: 255,
                description: text(),
            }],
        },
        ToPage::Hello {
            version: 0,
            app: String::new(),
            run: 0,
            now_us: 0,
            wall_ms: 0,
            read_only: false,
            buses: Vec::new(),
            devices: Vec::new(),
        },
        ToPage::Lagged {
            bus: text(),
            missed: 7,
        },
        ToPage::Refused { text: text() },
        ToPage::Tick { now_us: u64::MAX },
    ];
    all.extend(WAYS.map(|(_, way)| ToPage::Capture {
        bus: text(),
        seq: 9,
        at_us: 10,
        way,
        ends: way == Way::Rx,
        hex: "0103".into(),
    }));
    all.extend(STATES.map(|(_, state)| ToPage::Line {
        bus: text(),
        state,
        text: text(),
        since_us: 3,
    }));
    for (_, outcome) in OUTCOMES {
        all.push(ToPage::Done {
            id: u32::MAX,
            outcome,
            text: text(),
        });
        all.extend([None, Some(u64::MAX)].map(|time| ToPage::Device {
            tag: text(),
            outcome,
            text: text(),
            last_ok_us: time,
            latency_us: time,
        }));
    }
    all
}

/// A variant that is added to the protocol stops the build here, and belongs into the list.
const fn kind(message: &ToPage) -> usize {
    match message {
        ToPage::Hello { .. } => 0,
        ToPage::Capture { .. } => 1,
        ToPage::Lagged { .. } => 2,
        ToPage::Line { .. } => 3,
        ToPage::Device { .. } => 4,
        ToPage::Done { .. } => 5,
        ToPage::Refused { .. } => 6,
        ToPage::Tick { .. } => 7,
    }
}

#[test]
fn both_readers_agree() {
    let mut seen = [false; 8];
    for message in to_page() {
        seen[kind(&message)] = true;
        for json in [
            serde_json::to_string(&message).unwrap(),
            serde_json::to_string_pretty(&message).unwrap(),
        ] {
            assert_eq!(read(&json).as_ref(), Ok(&message), "{json}");
        }
    }
    assert_eq!(seen, [true; 8]);
}

/// Cut short or with a member less, a message is refused by both or read the same by both.
#[test]
fn both_readers_refuse() {
    let agree = |text: &str| {
        let theirs = serde_json::from_str::<ToPage>(text).ok();
        assert_eq!(read(text).ok(), theirs, "{text}");
    };
    for message in to_page() {
        let json = serde_json::to_string(&message).unwrap();
        for (at, _) in json.char_indices() {
            agree(&json[..at]);
        }
        let value = serde_json::to_value(&message).unwrap();
        let (kind, body) = value.as_object().unwrap().iter().next().unwrap();
        for name in body.as_object().unwrap().keys() {
            let mut less = value.clone();
            less[kind].as_object_mut().unwrap().remove(name);
            agree(&less.to_string());
            for other in ["-1", "1.5", "\"x\"", "null", "[]", "{}", "true", "300"] {
                let mut changed = value.clone();
                changed[kind][name] = serde_json::from_str(other).unwrap();
                agree(&changed.to_string());
            }
        }
        let mut more = value.clone();
        more[kind]["new"] = serde_json::json!({ "later": [1.5e9, -7, null] });
        agree(&more.to_string());
    }
    for text in [
        "",
        "[]",
        "{}",
        "7",
        "{\"x\":{}}",
        "\"tick\"",
        "{\"tick\":[]}",
    ] {
        agree(text);
    }
}

#[test]
fn errors_say_what_is_wrong() {
    let error = read(r#"{"tick":{"now_us":"soon"}}"#).unwrap_err();
    assert_eq!(error, "`now_us` of `tick` is missing or of another kind");
    assert_eq!(read(r#"{"new":{}}"#).unwrap_err(), "`new` is not known");
}

#[test]
fn both_writers_agree() {
    let block = |table| Block {
        table,
        start: 3000,
        count: u16::MAX,
    };
    let tables = [
        TableName::Coil,
        TableName::Discrete,
        TableName::Input,
        TableName::Holding,
    ];
    let mut all = vec![
        ToBackend::Hello { version: 1 },
        ToBackend::Unsubscribe { bus: TEXT.into() },
    ];
    all.extend(
        [None, Some(0), Some(u64::MAX)].map(|after| ToBackend::Subscribe {
            bus: TEXT.into(),
            after,
        }),
    );
    all.extend(tables.map(|table| ToBackend::Read {
        id: 7,
        device: TEXT.into(),
        block: block(table),
    }));
    all.extend([0, 1, 4].map(|n| ToBackend::Watch {
        device: TEXT.into(),
        blocks: tables.into_iter().take(n).map(block).collect(),
        period_ms: 1000,
    }));
    for message in all {
        let text = write(&message).unwrap();
        // Control signs may be escaped in two ways.
        assert_eq!(serde_json::from_str::<ToBackend>(&text).unwrap(), message);
        assert_eq!(
            text.replace("\\u000a", "\\n"),
            serde_json::to_string(&message).unwrap()
        );
    }
}
