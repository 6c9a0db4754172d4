//! The messages about what an ICON3000 offers beyond its registers, for the program that shows it.

use shared::proto::{ICON_PREFIX, IconAsk, IconNews, IconStep};

use super::{Fields, OUTCOMES, Writer};
use crate::state::json::Json;

/// Reads news of the backend; `None` if it is something else.
#[must_use]
pub fn read(text: &str) -> Option<IconNews> {
    if !text.starts_with(ICON_PREFIX) {
        return None;
    }
    let json = Json::parse(text)?;
    let (kind, body) = json.only()?.1.only()?;
    news(Fields { kind, body }).ok()
}

fn news(fields: Fields<'_>) -> Result<IconNews, String> {
    let device = fields.text("device")?;
    let id = fields.small("id")?;
    Ok(match fields.kind {
        "exchange" => IconNews::Exchange {
            id,
            device,
            step: fields.small("step")?,
            request: fields.text("request")?,
            response: fields.text("response")?,
            outcome: fields.word("outcome", &OUTCOMES)?,
            text: fields.text("text")?,
            at_us: fields.number("at_us")?,
        },
        "progress" => IconNews::Progress {
            id,
            device,
            done: fields.small("done")?,
            total: fields.small("total")?,
            text: fields.text("text")?,
        },
        "done" => IconNews::Done {
            id,
            device,
            ok: fields.small("ok")?,
            failed: fields.small("failed")?,
        },
        other => return Err(format!("`{other}` is not known")),
    })
}

/// Writes what the program asks.
#[must_use]
pub fn write(ask: &IconAsk) -> String {
    let mut out = String::from("{\"icon\":{");
    let mut body = Writer {
        out: &mut out,
        first: true,
    };
    match ask {
        IconAsk::Read { id, device, steps } => {
            let body = body.begin("read");
            body.number("id", u64::from(*id)).text("device", device);
            body.name("steps").raw("[");
            for (at, step) in steps.iter().enumerate() {
                body.raw(if at == 0 { "" } else { "," });
                write_step(body, *step);
            }
            body.raw("]");
        }
        IconAsk::Cancel { id } => {
            body.begin("cancel").number("id", u64::from(*id));
        }
    }
    out.push_str("}}}");
    out
}

fn write_step(body: &mut Writer<'_>, step: IconStep) {
    body.first = true;
    match step {
        IconStep::Block(block) => {
            body.raw("{").name("block").block(block).raw("}");
        }
        IconStep::File { file, start, count } => {
            body.raw("{")
                .begin("file")
                .number("file", u64::from(file))
                .number("start", u64::from(start))
                .number("count", u64::from(count))
                .raw("}}");
        }
        IconStep::Identity => {
            body.raw("\"identity\"");
        }
        IconStep::Diagnostic { sub_function } => {
            body.raw("{")
                .begin("diagnostic")
                .number("sub_function", u64::from(sub_function))
                .raw("}}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::proto::{Block, TableName, ToBackend};

    const TEXT: &str = "a \"quoted\"\\ é 𝄞 {}";

    fn all_news() -> Vec<IconNews> {
        let device = || TEXT.to_owned();
        let mut all = vec![
            IconNews::Progress {
                id: u32::MAX,
                device: device(),
                done: 1,
                total: u32::MAX,
                text: String::new(),
            },
            IconNews::Done {
                id: 0,
                device: device(),
                ok: 3,
                failed: u32::MAX,
            },
        ];
        all.extend(OUTCOMES.map(|(_, outcome)| IconNews::Exchange {
            id: 1,
            device: device(),
            step: u32::MAX,
            request: "14".into(),
            response: "9402".into(),
            outcome,
            text: TEXT.into(),
            at_us: u64::MAX,
        }));
        all
    }

    /// A variant that is added to the protocol stops the build here, and belongs into the list.
    const fn kind(news: &IconNews) -> usize {
        match news {
            IconNews::Exchange { .. } => 0,
            IconNews::Progress { .. } => 1,
            IconNews::Done { .. } => 2,
        }
    }

    #[test]
    fn both_readers_agree() {
        let mut seen = [false; 3];
        for news in all_news() {
            seen[kind(&news)] = true;
            assert_eq!(read(&news.clone().to_text()), Some(news));
        }
        assert_eq!(seen, [true; 3]);
    }

    /// Cut short or with a member less or another one, both refuse or read the same.
    #[test]
    fn both_readers_refuse() {
        let agree = |text: &str| assert_eq!(read(text), IconNews::from_text(text), "{text}");
        for news in all_news() {
            let text = news.clone().to_text();
            for (at, _) in text.char_indices() {
                agree(&text[..at]);
            }
            let value: serde_json::Value = serde_json::from_str(&text).unwrap();
            let (kind, body) = value["icon"].as_object().unwrap().iter().next().unwrap();
            for name in body.as_object().unwrap().keys() {
                let mut less = value.clone();
                less["icon"][kind].as_object_mut().unwrap().remove(name);
                agree(&less.to_string());
                for other in ["-1", "1.5", "\"x\"", "null", "[]", "true", "5000000000"] {
                    let mut changed = value.clone();
                    changed["icon"][kind][name] = serde_json::from_str(other).unwrap();
                    agree(&changed.to_string());
                }
            }
        }
        for text in [
            "",
            "{\"icon\":",
            "{\"icon\":{}}",
            "{\"icon\":7}",
            "{\"tick\":{}}",
        ] {
            agree(text);
        }
    }

    #[test]
    fn both_writers_agree() {
        let block = Block {
            table: TableName::Holding,
            start: 3000,
            count: 125,
        };
        let file = IconStep::File {
            file: u16::MAX,
            start: 0,
            count: 121,
        };
        let diagnostic = IconStep::Diagnostic { sub_function: 18 };
        let lists = [
            vec![],
            vec![IconStep::Identity],
            vec![IconStep::Block(block), file, IconStep::Identity, diagnostic],
            vec![diagnostic, IconStep::Identity, IconStep::Block(block), file],
        ];
        let mut all = vec![IconAsk::Cancel { id: u32::MAX }];
        all.extend(lists.map(|steps| IconAsk::Read {
            id: 1,
            device: TEXT.into(),
            steps,
        }));
        for ask in all {
            let text = write(&ask);
            let message = ToBackend::Icon(ask);
            assert_eq!(text, serde_json::to_string(&message).unwrap());
            assert_eq!(serde_json::from_str::<ToBackend>(&text).unwrap(), message);
        }
    }
}
