//! The messages about diagnostic objects, for the program that shows them.

use shared::proto::{DOP_PREFIX, DopAsk, DopNews, DopStep, LogFrom};

use super::{Fields, OUTCOMES, Writer};
use crate::state::json::Json;

const STEPS: [(&str, DopStep); 4] = [
    ("requesting", DopStep::Requesting),
    ("busy", DopStep::Busy),
    ("counting", DopStep::Counting),
    ("reading", DopStep::Reading),
];

/// Reads news of the backend; `None` if it is something else.
#[must_use]
pub fn read(text: &str) -> Option<DopNews> {
    if !text.starts_with(DOP_PREFIX) {
        return None;
    }
    let json = Json::parse(text)?;
    let (kind, body) = json.only()?.1.only()?;
    news(Fields { kind, body }, text).ok()
}

fn news(fields: Fields<'_>, text: &str) -> Result<DopNews, String> {
    let device = fields.text("device")?;
    Ok(match fields.kind {
        "profile" => DopNews::Profile {
            device,
            profile: profile(text).ok_or_else(|| fields.wrong("profile"))?,
            shift: fields.maybe("shift")?,
        },
        "progress" => DopNews::Progress {
            id: fields.small("id")?,
            device,
            request: fields.small("request")?,
            step: fields.word("step", &STEPS)?,
            done: fields.small("done")?,
            total: fields.small("total")?,
            text: fields.text("text")?,
        },
        "object" => DopNews::Object {
            id: fields.small("id")?,
            device,
            request: fields.small("request")?,
            hex: fields.text("hex")?,
            at_us: fields.number("at_us")?,
            took_us: fields.number("took_us")?,
            busy_us: fields.number("busy_us")?,
            polls: fields.small("polls")?,
            retries: fields.small("retries")?,
            foreign: fields.small("foreign")?,
            text: fields.text("text")?,
        },
        "failed" => DopNews::Failed {
            id: fields.small("id")?,
            device,
            request: fields.small("request")?,
            code: fields.maybe("code")?,
            outcome: fields.word("outcome", &OUTCOMES)?,
            text: fields.text("text")?,
        },
        "log_end" => DopNews::LogEnd {
            id: fields.small("id")?,
            device,
            object: fields.small("object")?,
            pages: fields.small("pages")?,
            text: fields.text("text")?,
        },
        "done" => DopNews::Done {
            id: fields.small("id")?,
            device,
            ok: fields.small("ok")?,
            failed: fields.small("failed")?,
        },
        "indicators" => DopNews::Indicators {
            device,
            hex: fields.text("hex")?,
            at_us: fields.number("at_us")?,
        },
        other => return Err(format!("`{other}` is not known")),
    })
}

/// The profile is of a form of its own, which its own reader checks.
fn profile(text: &str) -> Option<serde_json::Value> {
    let mut all: serde_json::Value = serde_json::from_str(text).ok()?;
    Some(all.pointer_mut("/dop/profile/profile")?.take())
}

/// Writes what the program asks.
#[must_use]
pub fn write(ask: &DopAsk) -> String {
    let mut out = String::from("{\"dop\":{");
    let mut body = Writer {
        out: &mut out,
        first: true,
    };
    match ask {
        DopAsk::Read {
            id,
            device,
            requests,
        } => {
            let body = body.begin("read");
            body.number("id", u64::from(*id)).text("device", device);
            body.name("requests").raw("[");
            for (at, request) in requests.iter().enumerate() {
                body.raw(if at == 0 { "" } else { "," });
                body.raw(&request.to_string());
            }
            body.raw("]");
        }
        DopAsk::Log {
            id,
            device,
            object,
            from,
            after,
            limit,
        } => {
            let body = body.begin("log");
            body.number("id", u64::from(*id)).text("device", device);
            body.number("object", u64::from(*object));
            let from = match from {
                LogFrom::Newest => "newest",
                LogFrom::Oldest => "oldest",
            };
            body.text("from", from).maybe("after", *after);
            body.number("limit", u64::from(*limit));
        }
        DopAsk::Cancel { id } => {
            body.begin("cancel").number("id", u64::from(*id));
        }
        DopAsk::Watch { device, period_ms } => {
            let body = body.begin("watch").text("device", device);
            body.number("period_ms", u64::from(*period_ms));
        }
        DopAsk::Profile { device } => {
            body.begin("profile").text("device", device);
        }
    }
    out.push_str("}}}");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::proto::ToBackend;

    const TEXT: &str = "a \"quoted\"\\ é 𝄞 {}";

    /// One message of each kind at least, with every word and both ends of every number.
    fn all_news() -> Vec<DopNews> {
        let device = || TEXT.to_owned();
        let mut all = vec![
            DopNews::Object {
                id: u32::MAX,
                device: device(),
                request: u16::MAX,
                hex: "0001".into(),
                at_us: u64::MAX,
                took_us: 1,
                busy_us: 2,
                polls: 3,
                retries: 4,
                foreign: 5,
                text: TEXT.into(),
            },
            DopNews::LogEnd {
                id: 1,
                device: device(),
                object: 1203,
                pages: 7,
                text: String::new(),
            },
            DopNews::Done {
                id: 1,
                device: device(),
                ok: 2,
                failed: 3,
            },
            DopNews::Indicators {
                device: device(),
                hex: "0000000000000001".into(),
                at_us: 9,
            },
        ];
        let profiles = [
            serde_json::json!({ "status": { "shift": null }, "time": { "epoch": -7 }, "x": [1.5] }),
            serde_json::Value::Null,
        ];
        all.extend(
            profiles
                .into_iter()
                .zip([None, Some(13)])
                .map(|(profile, shift)| DopNews::Profile {
                    device: device(),
                    profile,
                    shift,
                }),
        );
        all.extend(STEPS.map(|(_, step)| DopNews::Progress {
            id: 1,
            device: device(),
            request: 0x1001,
            step,
            done: 1,
            total: 0,
            text: TEXT.into(),
        }));
        all.extend(OUTCOMES.map(|(_, outcome)| DopNews::Failed {
            id: 1,
            device: device(),
            request: 0x1001,
            code: Some(3),
            outcome,
            text: TEXT.into(),
        }));
        all
    }

    /// A variant that is added to the protocol stops the build here, and belongs into the list.
    const fn kind(news: &DopNews) -> usize {
        match news {
            DopNews::Profile { .. } => 0,
            DopNews::Progress { .. } => 1,
            DopNews::Object { .. } => 2,
            DopNews::Failed { .. } => 3,
            DopNews::LogEnd { .. } => 4,
            DopNews::Done { .. } => 5,
            DopNews::Indicators { .. } => 6,
        }
    }

    #[test]
    fn both_readers_agree() {
        let mut seen = [false; 7];
        for news in all_news() {
            seen[kind(&news)] = true;
            assert_eq!(read(&news.clone().to_text()), Some(news));
        }
        assert_eq!(seen, [true; 7]);
    }

    /// Cut short or with a member less or another one, both refuse or read the same.
    #[test]
    fn both_readers_refuse() {
        let agree = |text: &str| assert_eq!(read(text), DopNews::from_text(text), "{text}");
        for news in all_news() {
            let text = news.clone().to_text();
            for (at, _) in text.char_indices() {
                agree(&text[..at]);
            }
            let value: serde_json::Value = serde_json::from_str(&text).unwrap();
            let (kind, body) = value["dop"].as_object().unwrap().iter().next().unwrap();
            for name in body.as_object().unwrap().keys() {
                let mut less = value.clone();
                less["dop"][kind].as_object_mut().unwrap().remove(name);
                agree(&less.to_string());
                for other in ["-1", "1.5", "\"x\"", "null", "[]", "true", "70000"] {
                    let mut changed = value.clone();
                    changed["dop"][kind][name] = serde_json::from_str(other).unwrap();
                    agree(&changed.to_string());
                }
            }
        }
        for text in [
            "",
            "{\"dop\":",
            "{\"dop\":{}}",
            "{\"dop\":7}",
            "{\"tick\":{}}",
        ] {
            agree(text);
        }
    }

    #[test]
    fn both_writers_agree() {
        let device = || TEXT.to_owned();
        let mut all = vec![
            DopAsk::Cancel { id: u32::MAX },
            DopAsk::Profile { device: device() },
            DopAsk::Watch {
                device: device(),
                period_ms: 0,
            },
        ];
        all.extend(
            [vec![], vec![4097], vec![1, u16::MAX]].map(|requests| DopAsk::Read {
                id: 1,
                device: device(),
                requests,
            }),
        );
        for from in [LogFrom::Newest, LogFrom::Oldest] {
            all.extend([None, Some(u64::MAX)].map(|after| DopAsk::Log {
                id: 2,
                device: device(),
                object: 1202,
                from,
                after,
                limit: 10_000,
            }));
        }
        for ask in all {
            let text = write(&ask);
            let message = ToBackend::Dop(ask);
            assert_eq!(text, serde_json::to_string(&message).unwrap());
            assert_eq!(serde_json::from_str::<ToBackend>(&text).unwrap(), message);
        }
    }
}
