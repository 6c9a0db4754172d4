//! The messages about DDC-100 networks, for the program that shows them.

use shared::proto::{DDC_PREFIX, DdcAsk, DdcNews, DdcShape, DdcUnit};

use super::{Fields, OUTCOMES, STATES, Writer};
use crate::state::json::Json;

const SHAPES: [(&str, DdcShape); 3] = [
    ("loop", DdcShape::Loop),
    ("single_ended", DdcShape::SingleEnded),
    ("multi_drop", DdcShape::MultiDrop),
];

/// Reads news of the backend; `None` if it is something else.
#[must_use]
pub fn read(text: &str) -> Option<DdcNews> {
    if !text.starts_with(DDC_PREFIX) {
        return None;
    }
    let json = Json::parse(text)?;
    let (kind, body) = json.only()?.1.only()?;
    news(Fields { kind, body }).ok()
}

fn news(fields: Fields<'_>) -> Result<DdcNews, String> {
    let bus = fields.text("bus")?;
    Ok(match fields.kind {
        "network" => DdcNews::Network {
            bus,
            shape: fields.word("shape", &SHAPES)?,
            framing: fields.text("framing")?,
            baud: fields.small("baud")?,
            ports: texts(fields)?,
            start: fields.small("start")?,
            count: fields.small("count")?,
            turn_ms: fields.small("turn_ms")?,
            timeout_ms: fields.small("timeout_ms")?,
            retries: fields.small("retries")?,
            units: fields.list("units", unit)?,
            hint: said(fields, "hint")?,
        },
        "unit" => DdcNews::Unit {
            bus,
            unit: fields.small("unit")?,
            port: fields.small("port")?,
            outcome: fields.word("outcome", &OUTCOMES)?,
            text: fields.text("text")?,
            fault_a: flag(fields, "fault_a")?,
            fault_b: flag(fields, "fault_b")?,
            request: fields.text("request")?,
            response: fields.text("response")?,
            at_us: fields.maybe("at_us")?,
            took_us: fields.maybe("took_us")?,
        },
        "poll" => DdcNews::Poll {
            bus,
            unit: fields.small("unit")?,
            port: fields.small("port")?,
        },
        "pass" => DdcNews::Pass {
            bus,
            port: fields.small("port")?,
            number: fields.number("number")?,
            took_us: fields.number("took_us")?,
            expected_us: fields.number("expected_us")?,
        },
        "port" => DdcNews::Port {
            bus,
            port: fields.small("port")?,
            state: fields.word("state", &STATES)?,
            text: fields.text("text")?,
        },
        "read" => DdcNews::Read {
            id: fields.small("id")?,
            bus,
            unit: fields.small("unit")?,
            outcome: fields.word("outcome", &OUTCOMES)?,
            text: fields.text("text")?,
            request: fields.text("request")?,
            response: fields.text("response")?,
            at_us: fields.number("at_us")?,
        },
        other => return Err(format!("`{other}` is not known")),
    })
}

fn unit(fields: Fields<'_>) -> Result<DdcUnit, String> {
    Ok(DdcUnit {
        unit: fields.small("unit")?,
        kind: fields.text("kind")?,
        tag: fields.text("tag")?,
        description: fields.text("description")?,
        scaling: said(fields, "scaling")?,
    })
}

/// Where the ports go.
fn texts(fields: Fields<'_>) -> Result<Vec<String>, String> {
    let list = fields.get("ports", Json::list)?;
    let text = |json: &Json<'_>| json.text().map(str::to_owned);
    let all: Option<_> = list.iter().map(text).collect();
    all.ok_or_else(|| fields.wrong("ports"))
}

/// A text that may be `null` or missing.
fn said(fields: Fields<'_>, name: &str) -> Result<Option<String>, String> {
    match fields.body.get(name) {
        None | Some(Json::Null) => Ok(None),
        Some(_) => fields.text(name).map(Some),
    }
}

/// A flag that may be `null` or missing.
fn flag(fields: Fields<'_>, name: &str) -> Result<Option<bool>, String> {
    match fields.body.get(name) {
        None | Some(Json::Null) => Ok(None),
        Some(Json::Bool(flag)) => Ok(Some(*flag)),
        Some(_) => Err(fields.wrong(name)),
    }
}

/// Writes what the program asks.
#[must_use]
pub fn write(ask: &DdcAsk) -> String {
    let mut out = String::from("{\"ddc\":{");
    let mut body = Writer {
        out: &mut out,
        first: true,
    };
    match ask {
        DdcAsk::Follow { bus } => {
            body.begin("follow").text("bus", bus);
        }
        DdcAsk::Leave { bus } => {
            body.begin("leave").text("bus", bus);
        }
        DdcAsk::Read {
            id,
            bus,
            unit,
            block,
        } => {
            let body = body.begin("read");
            body.number("id", u64::from(*id)).text("bus", bus);
            body.number("unit", u64::from(*unit));
            body.name("block").block(*block);
        }
        DdcAsk::Counter {
            id,
            bus,
            unit,
            sub_function,
        } => {
            let body = body.begin("counter");
            body.number("id", u64::from(*id)).text("bus", bus);
            body.number("unit", u64::from(*unit))
                .number("sub_function", u64::from(*sub_function));
        }
    }
    out.push_str("}}}");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::proto::{Block, TableName, ToBackend};

    const TEXT: &str = "a \"quoted\"\\ é 𝄞 {}";

    /// One message of each kind at least, with every word and both ends of every number.
    fn all_news() -> Vec<DdcNews> {
        let bus = || TEXT.to_owned();
        let mut all = vec![
            DdcNews::Poll {
                bus: bus(),
                unit: u8::MAX,
                port: 2,
            },
            DdcNews::Pass {
                bus: bus(),
                port: 1,
                number: u64::MAX,
                took_us: 1,
                expected_us: 2,
            },
        ];
        all.extend(SHAPES.map(|(_, shape)| DdcNews::Network {
            bus: bus(),
            shape,
            framing: "modbus-rtu".into(),
            baud: u32::MAX,
            ports: vec!["/dev/ttyS0".into(), TEXT.into()],
            start: u16::MAX,
            count: 9,
            turn_ms: 30,
            timeout_ms: 250,
            retries: 3,
            units: vec![DdcUnit {
                unit: 1,
                kind: "ddc100-uec".into(),
                tag: TEXT.into(),
                description: String::new(),
                scaling: (shape == DdcShape::Loop).then(|| "0-255".into()),
            }],
            hint: (shape == DdcShape::MultiDrop).then(|| TEXT.into()),
        }));
        all.extend(STATES.map(|(_, state)| DdcNews::Port {
            bus: bus(),
            port: 1,
            state,
            text: TEXT.into(),
        }));
        for (_, outcome) in OUTCOMES {
            all.push(DdcNews::Read {
                id: u32::MAX,
                bus: bus(),
                unit: 250,
                outcome,
                text: TEXT.into(),
                request: "0300000038".into(),
                response: String::new(),
                at_us: 7,
            });
            for fault in [None, Some(false), Some(true)] {
                all.push(DdcNews::Unit {
                    bus: bus(),
                    unit: 1,
                    port: 2,
                    outcome,
                    text: String::new(),
                    fault_a: fault,
                    fault_b: None,
                    request: "0300080001".into(),
                    response: "03020000".into(),
                    at_us: fault.map(|_| 5),
                    took_us: None,
                });
            }
        }
        all
    }

    /// A variant that is added to the protocol stops the build here, and belongs into the list.
    const fn kind(news: &DdcNews) -> usize {
        match news {
            DdcNews::Network { .. } => 0,
            DdcNews::Unit { .. } => 1,
            DdcNews::Poll { .. } => 2,
            DdcNews::Pass { .. } => 3,
            DdcNews::Port { .. } => 4,
            DdcNews::Read { .. } => 5,
        }
    }

    #[test]
    fn both_readers_agree() {
        let mut seen = [false; 6];
        for news in all_news() {
            seen[kind(&news)] = true;
            assert_eq!(read(&news.clone().to_text()), Some(news));
        }
        assert_eq!(seen, [true; 6]);
    }

    /// Cut short or with a member less or another one, both refuse or read the same.
    #[test]
    fn both_readers_refuse() {
        let agree = |text: &str| assert_eq!(read(text), DdcNews::from_text(text), "{text}");
        for news in all_news() {
            let text = news.clone().to_text();
            for (at, _) in text.char_indices() {
                agree(&text[..at]);
            }
            let value: serde_json::Value = serde_json::from_str(&text).unwrap();
            let (kind, body) = value["ddc"].as_object().unwrap().iter().next().unwrap();
            for name in body.as_object().unwrap().keys() {
                let mut less = value.clone();
                less["ddc"][kind].as_object_mut().unwrap().remove(name);
                agree(&less.to_string());
                for other in ["-1", "1.5", "\"x\"", "null", "[]", "true", "70000"] {
                    let mut changed = value.clone();
                    changed["ddc"][kind][name] = serde_json::from_str(other).unwrap();
                    agree(&changed.to_string());
                }
            }
        }
        for text in [
            "",
            "{\"ddc\":",
            "{\"ddc\":{}}",
            "{\"ddc\":7}",
            "{\"tick\":{}}",
        ] {
            agree(text);
        }
    }

    #[test]
    fn both_writers_agree() {
        let bus = || TEXT.to_owned();
        let block = Block {
            table: TableName::Holding,
            start: 0,
            count: 56,
        };
        for ask in [
            DdcAsk::Follow { bus: bus() },
            DdcAsk::Leave { bus: bus() },
            DdcAsk::Read {
                id: u32::MAX,
                bus: bus(),
                unit: 250,
                block,
            },
            DdcAsk::Counter {
                id: 0,
                bus: bus(),
                unit: 1,
                sub_function: u16::MAX,
            },
        ] {
            let text = write(&ask);
            let message = ToBackend::Ddc(ask);
            assert_eq!(text, serde_json::to_string(&message).unwrap());
            assert_eq!(serde_json::from_str::<ToBackend>(&text).unwrap(), message);
        }
    }
}
