//! The messages about HART devices, for the program that shows them.

use shared::proto::{HART_PREFIX, HartAsk, HartCommand, HartNews};

use super::{Fields, OUTCOMES, Writer};
use crate::state::absorb::bytes_of;
use crate::state::json::{Json, quoted};

/// Reads news of the backend; `None` if it is something else.
#[must_use]
pub fn read(text: &str) -> Option<HartNews> {
    if !text.starts_with(HART_PREFIX) {
        return None;
    }
    let json = Json::parse(text)?;
    let (kind, body) = json.only()?.1.only()?;
    news(Fields { kind, body }).ok()
}

fn news(fields: Fields<'_>) -> Result<HartNews, String> {
    Ok(match fields.kind {
        "exchange" => HartNews::Exchange {
            id: fields.maybe("id")?,
            device: fields.text("device")?,
            command: fields.small("command")?,
            request: fields.text("request")?,
            response: fields.text("response")?,
            outcome: fields.word("outcome", &OUTCOMES)?,
            text: fields.text("text")?,
            at_us: fields.number("at_us")?,
            took_us: fields.number("took_us")?,
            tries: fields.small("tries")?,
        },
        "progress" => HartNews::Progress {
            id: fields.small("id")?,
            done: fields.small("done")?,
            total: fields.small("total")?,
            text: fields.text("text")?,
        },
        "found" => HartNews::Found {
            id: fields.small("id")?,
            bus: fields.text("bus")?,
            polling: fields.maybe("polling")?,
            response: fields.text("response")?,
            at_us: fields.number("at_us")?,
        },
        "done" => HartNews::Done {
            id: fields.small("id")?,
            ok: fields.small("ok")?,
            failed: fields.small("failed")?,
            text: fields.text("text")?,
        },
        "link" => HartNews::Link {
            bus: fields.text("bus")?,
            primary: match fields.body.get("primary") {
                None | Some(Json::Null) => None,
                Some(_) => Some(fields.flag("primary")?),
            },
            other_master: fields.flag("other_master")?,
            burst: fields.flag("burst")?,
            sent: fields.number("sent")?,
            answered: fields.number("answered")?,
            retried: fields.number("retried")?,
            damaged: fields.number("damaged")?,
            text: fields.text("text")?,
        },
        other => return Err(format!("`{other}` is not known")),
    })
}

/// Time between two polls of a device in the list of all, in milliseconds: HART is slow.
const LIST_MS: u32 = 5000;

/// Begins or ends what the list of all devices polls of a HART device: command 3. The same as
/// [`write`] of it, without the others.
#[must_use]
pub fn watch_in_list(device: &str, on: bool) -> String {
    let mut out = String::from("{\"hart\":{\"watch\":{\"device\":");
    quoted(&mut out, device);
    out.push_str(",\"commands\":[");
    out.push_str(if on {
        "{\"number\":3,\"data\":\"\"}"
    } else {
        ""
    });
    out.push_str("],\"period_ms\":");
    out.push_str(&LIST_MS.to_string());
    out.push_str("}}}");
    out
}

/// What the list of all devices takes of news: the tag, the answer to command 3, and when it came.
#[must_use]
pub fn polled(text: &str) -> Option<(String, Vec<u8>, u64)> {
    let json = Json::parse(text)?;
    let (kind, body) = json.only()?.1.only()?;
    let fields = Fields { kind, body };
    let is = kind == "exchange" && fields.number("command") == Ok(3);
    let answer = fields.text("response").ok().filter(|_| is)?;
    let tag = fields.text("device").ok()?;
    Some((tag, bytes_of(&answer), fields.number("at_us").ok()?))
}

/// Writes what the program asks.
#[must_use]
pub fn write(ask: &HartAsk) -> String {
    let mut out = String::from("{\"hart\":{");
    let mut body = Writer {
        out: &mut out,
        first: true,
    };
    match ask {
        HartAsk::Read {
            id,
            device,
            commands,
        } => {
            let body = body.begin("read").number("id", u64::from(*id));
            list(body.text("device", device), commands);
        }
        HartAsk::Watch {
            device,
            commands,
            period_ms,
        } => {
            let body = body.begin("watch").text("device", device);
            list(body, commands);
            body.number("period_ms", u64::from(*period_ms));
        }
        HartAsk::Scan {
            id,
            bus,
            first,
            last,
        } => {
            let body = body.begin("scan").number("id", u64::from(*id));
            body.text("bus", bus)
                .number("first", u64::from(*first))
                .number("last", u64::from(*last));
        }
        HartAsk::Find { id, bus, tag, long } => {
            let body = body.begin("find").number("id", u64::from(*id));
            body.text("bus", bus)
                .text("tag", tag)
                .name("long")
                .raw(if *long { "true" } else { "false" });
        }
        HartAsk::Cancel { id } => {
            body.begin("cancel").number("id", u64::from(*id));
        }
        HartAsk::Link { bus } => {
            body.begin("link").text("bus", bus);
        }
    }
    out.push_str("}}}");
    out
}

fn list(body: &mut Writer<'_>, commands: &[HartCommand]) {
    body.name("commands").raw("[");
    for (at, command) in commands.iter().enumerate() {
        body.raw(if at == 0 { "{" } else { ",{" });
        body.first = true;
        body.number("number", u64::from(command.number))
            .text("data", &command.data)
            .raw("}");
    }
    body.raw("]");
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::proto::{Outcome, ToBackend};

    /// The page's writer against the derived one.
    #[test]
    fn asks_are_written_as_the_backend_reads_them() {
        let command = |number, data: &str| HartCommand {
            number,
            data: data.to_owned(),
        };
        let text = || "a \"q\"\\ é".to_owned();
        for ask in [
            HartAsk::Read {
                id: u32::MAX,
                device: text(),
                commands: vec![command(3, ""), command(523, "0040")],
            },
            HartAsk::Watch {
                device: text(),
                commands: Vec::new(),
                period_ms: 1000,
            },
            HartAsk::Watch {
                device: text(),
                commands: vec![command(9, "00010203")],
                period_ms: 1,
            },
            HartAsk::Scan {
                id: 0,
                bus: text(),
                first: 0,
                last: 63,
            },
            HartAsk::Find {
                id: 1,
                bus: text(),
                tag: text(),
                long: true,
            },
            HartAsk::Cancel { id: 2 },
            HartAsk::Link { bus: text() },
        ] {
            let message = ToBackend::Hart(ask.clone());
            assert_eq!(write(&ask), serde_json::to_string(&message).unwrap());
        }
    }

    #[test]
    fn the_list_asks_in_the_same_way() {
        for on in [true, false] {
            let commands = vec![HartCommand {
                number: 3,
                data: String::new(),
            }];
            let ask = HartAsk::Watch {
                device: "FV \"1\"".into(),
                commands: if on { commands } else { Vec::new() },
                period_ms: LIST_MS,
            };
            assert_eq!(watch_in_list("FV \"1\"", on), write(&ask));
        }
    }

    #[test]
    fn news_are_read_as_the_backend_writes_them() {
        let text = || "a \"q\"\\ é".to_owned();
        let exchange = |id, outcome| HartNews::Exchange {
            id,
            device: text(),
            command: 523,
            request: "82".into(),
            response: String::new(),
            outcome,
            text: text(),
            at_us: u64::MAX,
            took_us: 2,
            tries: 4,
        };
        let link = |primary| HartNews::Link {
            bus: text(),
            primary,
            other_master: true,
            burst: false,
            sent: 1,
            answered: 2,
            retried: 3,
            damaged: 4,
            text: text(),
        };
        for news in [
            exchange(None, Outcome::Silence),
            exchange(Some(7), Outcome::Ok),
            HartNews::Progress {
                id: 1,
                done: 2,
                total: 3,
                text: text(),
            },
            HartNews::Found {
                id: 1,
                bus: text(),
                polling: Some(63),
                response: "06".into(),
                at_us: 9,
            },
            HartNews::Found {
                id: 1,
                bus: text(),
                polling: None,
                response: "06".into(),
                at_us: 9,
            },
            HartNews::Done {
                id: 1,
                ok: 2,
                failed: 3,
                text: text(),
            },
            link(None),
            link(Some(true)),
            link(Some(false)),
        ] {
            assert_eq!(read(&news.clone().to_text()), Some(news));
        }
        for other in ["", "{\"tick\":{\"now_us\":1}}", "{\"hart\":{\"new\":{}}}"] {
            assert_eq!(read(other), None);
        }
    }
}
