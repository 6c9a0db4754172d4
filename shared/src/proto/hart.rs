//! What page and backend say to each other about HART devices.
//!
//! A page names commands by their number; the backend sends them as frames to the device of that
//! tag, and ships the frames as they were on the line. Only commands that change nothing can be
//! asked for: the gate of the line looks at the number and at the data.

use super::Outcome;
use serde::{Deserialize, Serialize};

/// Commands that a page may have waiting for one device at once, or watch on it.
pub const MAX_HART_COMMANDS: usize = 64;

/// How the text of every [`HartNews`] begins.
pub const HART_PREFIX: &str = "{\"hart\":";

/// A command that reads.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HartCommand {
    /// Its number; from 256 on it travels in command 31.
    pub number: u16,
    /// Data of the request, two digits a byte; empty for most.
    pub data: String,
}

/// From the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum HartAsk {
    /// Send these commands once, one after the other.
    Read {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Tag of the device.
        device: String,
        /// What to ask.
        commands: Vec<HartCommand>,
    },
    /// Send these commands again and again; replaces what this page watched on the device before.
    Watch {
        /// Tag of the device.
        device: String,
        /// What to ask; none ends the watch.
        commands: Vec<HartCommand>,
        /// Time from one round to the next.
        period_ms: u32,
    },
    /// Look for devices at polling addresses.
    Scan {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Name of the bus.
        bus: String,
        /// First polling address, 0 to 63.
        first: u8,
        /// Last polling address, 0 to 63.
        last: u8,
    },
    /// Ask which device has a tag (commands 11 and 21).
    Find {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Name of the bus.
        bus: String,
        /// The tag: 8 characters at most, or 32 if it is the long one.
        tag: String,
        /// True for the long tag.
        long: bool,
    },
    /// End a read, scan or search; what is under way on the line is finished first.
    Cancel {
        /// Its id.
        id: u32,
    },
    /// Ask for the state of a line, now and whenever it changes.
    Link {
        /// Name of the bus.
        bus: String,
    },
}

/// From the backend.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum HartNews {
    /// A command was sent, and answered or not.
    Exchange {
        /// The id of the read; `None` for a watch.
        id: Option<u32>,
        /// Tag of the device.
        device: String,
        /// The command.
        command: u16,
        /// The request, from the delimiter to the check byte.
        request: String,
        /// The response, from the delimiter to the check byte; empty if there is none.
        response: String,
        /// How it ended; `ok` if the device answered, whatever its response code.
        outcome: Outcome,
        /// In words.
        text: String,
        /// When the last byte came, in microseconds since the start of the backend.
        at_us: u64,
        /// From the first byte of the request to the last of the response.
        took_us: u64,
        /// How often it was sent.
        tries: u8,
    },
    /// A read, scan or search goes on.
    Progress {
        /// The page's id.
        id: u32,
        /// Commands or addresses that are done.
        done: u32,
        /// All of them.
        total: u32,
        /// In words.
        text: String,
    },
    /// A scan or search found a device.
    Found {
        /// The page's id.
        id: u32,
        /// Name of the bus.
        bus: String,
        /// The polling address that answered; `None` for a search by tag.
        polling: Option<u8>,
        /// The response, from the delimiter to the check byte.
        response: String,
        /// When it came, in microseconds since the start of the backend.
        at_us: u64,
    },
    /// A read, scan or search is over.
    Done {
        /// The page's id.
        id: u32,
        /// Commands answered, or devices found.
        ok: u32,
        /// Commands not answered, or addresses silent.
        failed: u32,
        /// In words.
        text: String,
    },
    /// Who else is on a line, and how its traffic goes.
    Link {
        /// Name of the bus.
        bus: String,
        /// True if we are the primary master; `None` on HART-IP, where a gateway is.
        primary: Option<bool>,
        /// True while another master is heard.
        other_master: bool,
        /// True while a device sends bursts.
        burst: bool,
        /// Requests that we sent.
        sent: u64,
        /// Good answers to them.
        answered: u64,
        /// Requests sent again after an error of the line.
        retried: u64,
        /// Damaged frames that were heard.
        damaged: u64,
        /// In words.
        text: String,
    },
}

/// The wrapping of all news.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Wrapped {
    hart: HartNews,
}

impl HartNews {
    /// The text that travels.
    #[must_use]
    pub fn to_text(self) -> String {
        // These types always have a JSON form.
        serde_json::to_string(&Wrapped { hart: self }).unwrap_or_default()
    }

    /// Reads a text that travelled; `None` if it is something else.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        if !text.starts_with(HART_PREFIX) {
            return None;
        }
        serde_json::from_str::<Wrapped>(text).ok().map(|w| w.hart)
    }
}

#[cfg(test)]
mod tests {
    use super::super::ToBackend;
    use super::*;

    /// Changing one of these lines means a new version of the protocol.
    #[test]
    fn messages_are_what_they_were() {
        let asks = [
            (
                HartAsk::Read {
                    id: 1,
                    device: "FV-401".into(),
                    commands: vec![HartCommand {
                        number: 523,
                        data: "0040".into(),
                    }],
                },
                r#"{"hart":{"read":{"id":1,"device":"FV-401","commands":[{"number":523,"data":"0040"}]}}}"#,
            ),
            (
                HartAsk::Watch {
                    device: "FV-401".into(),
                    commands: Vec::new(),
                    period_ms: 500,
                },
                r#"{"hart":{"watch":{"device":"FV-401","commands":[],"period_ms":500}}}"#,
            ),
            (
                HartAsk::Scan {
                    id: 2,
                    bus: "h".into(),
                    first: 0,
                    last: 63,
                },
                r#"{"hart":{"scan":{"id":2,"bus":"h","first":0,"last":63}}}"#,
            ),
            (
                HartAsk::Find {
                    id: 3,
                    bus: "h".into(),
                    tag: "FV-401".into(),
                    long: false,
                },
                r#"{"hart":{"find":{"id":3,"bus":"h","tag":"FV-401","long":false}}}"#,
            ),
            (HartAsk::Cancel { id: 3 }, r#"{"hart":{"cancel":{"id":3}}}"#),
            (
                HartAsk::Link { bus: "h".into() },
                r#"{"hart":{"link":{"bus":"h"}}}"#,
            ),
        ];
        for (ask, json) in asks {
            let message = ToBackend::Hart(ask);
            assert_eq!(serde_json::to_string(&message).unwrap(), json);
            assert_eq!(serde_json::from_str::<ToBackend>(json).unwrap(), message);
        }
        let news = [
            (
                HartNews::Exchange {
                    id: None,
                    device: "FV-401".into(),
                    command: 3,
                    request: "82AEDD0123450300".into(),
                    response: String::new(),
                    outcome: Outcome::Silence,
                    text: "no answer".into(),
                    at_us: 1,
                    took_us: 2,
                    tries: 4,
                },
                r#"{"hart":{"exchange":{"id":null,"device":"FV-401","command":3,"request":"82AEDD0123450300","response":"","outcome":"silence","text":"no answer","at_us":1,"took_us":2,"tries":4}}}"#,
            ),
            (
                HartNews::Progress {
                    id: 1,
                    done: 2,
                    total: 3,
                    text: "address 2".into(),
                },
                r#"{"hart":{"progress":{"id":1,"done":2,"total":3,"text":"address 2"}}}"#,
            ),
            (
                HartNews::Found {
                    id: 1,
                    bus: "h".into(),
                    polling: Some(0),
                    response: "06".into(),
                    at_us: 3,
                },
                r#"{"hart":{"found":{"id":1,"bus":"h","polling":0,"response":"06","at_us":3}}}"#,
            ),
            (
                HartNews::Done {
                    id: 1,
                    ok: 1,
                    failed: 63,
                    text: "one device".into(),
                },
                r#"{"hart":{"done":{"id":1,"ok":1,"failed":63,"text":"one device"}}}"#,
            ),
            (
                HartNews::Link {
                    bus: "h".into(),
                    primary: Some(true),
                    other_master: false,
                    burst: false,
                    sent: 4,
                    answered: 3,
                    retried: 1,
                    damaged: 0,
                    text: "alone".into(),
                },
                r#"{"hart":{"link":{"bus":"h","primary":true,"other_master":false,"burst":false,"sent":4,"answered":3,"retried":1,"damaged":0,"text":"alone"}}}"#,
            ),
        ];
        for (message, json) in news {
            assert!(json.starts_with(HART_PREFIX));
            assert_eq!(message.clone().to_text(), json);
            assert_eq!(HartNews::from_text(json), Some(message));
        }
        assert_eq!(HartNews::from_text(r#"{"tick":{"now_us":1}}"#), None);
    }

    /// A page can't send a frame of its own making, nor say to which address.
    #[test]
    fn no_message_carries_a_frame() {
        for json in [
            r#"{"hart":{"send":{"device":"x","hex":"82AEDD01234584012231"}}}"#,
            r#"{"hart":{"read":{"id":1,"device":"x","commands":[],"address":"AEDD012345"}}}"#,
            r#"{"hart":{"write":{"device":"x","number":35}}}"#,
        ] {
            assert!(serde_json::from_str::<ToBackend>(json).is_err(), "{json}");
        }
    }
}
