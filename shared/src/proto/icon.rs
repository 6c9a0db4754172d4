//! What page and backend say to each other about what an ICON3000 offers beyond its registers:
//! files (FC 20), its identity (FC 17) and its counters (FC 08), and blocks of registers that come
//! with their bytes.
//!
//! All answers travel as PDUs; the page decodes them.

use super::{Block, Outcome};
use serde::{Deserialize, Serialize};

/// Steps that one job of a page may have.
pub const MAX_ICON_STEPS: usize = 256;

/// How the text of every [`IconNews`] begins.
pub const ICON_PREFIX: &str = "{\"icon\":";

/// One thing to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IconStep {
    /// Registers or bits.
    Block(Block),
    /// Registers of a file, in as many requests as they need.
    File {
        /// Number of the file.
        file: u16,
        /// First register of it.
        start: u16,
        /// Number of registers.
        count: u16,
    },
    /// Who it is (FC 17).
    Identity,
    /// A counter or register of the diagnostics (FC 08). Only sub-functions that read are allowed.
    Diagnostic {
        /// The sub-function.
        sub_function: u16,
    },
}

/// From the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum IconAsk {
    /// Read these, one after the other.
    Read {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Tag of the device.
        device: String,
        /// What to read.
        steps: Vec<IconStep>,
    },
    /// End a read; what is under way on the line is finished first.
    Cancel {
        /// Its id.
        id: u32,
    },
}

/// From the backend.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum IconNews {
    /// A request was answered, or not. A step may need several.
    Exchange {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// Index of the step.
        step: u32,
        /// Request PDU.
        request: String,
        /// Response PDU, that of an exception too; empty without one.
        response: String,
        /// How it ended.
        outcome: Outcome,
        /// In words.
        text: String,
        /// When the answer came, in microseconds since the start of the backend.
        at_us: u64,
    },
    /// A read goes on.
    Progress {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// Requests that are done.
        done: u32,
        /// Requests in all, as far as known.
        total: u32,
        /// In words.
        text: String,
    },
    /// A read is over.
    Done {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// Requests that were answered well.
        ok: u32,
        /// Requests that were not, or not sent.
        failed: u32,
    },
}

/// The wrapping of all news.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Wrapped {
    icon: IconNews,
}

impl IconNews {
    /// The text that travels.
    #[must_use]
    pub fn to_text(self) -> String {
        // These types always have a JSON form.
        serde_json::to_string(&Wrapped { icon: self }).unwrap_or_default()
    }

    /// Reads a text that travelled; `None` if it is something else.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        if !text.starts_with(ICON_PREFIX) {
            return None;
        }
        serde_json::from_str::<Wrapped>(text).ok().map(|w| w.icon)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{TableName, ToBackend};
    use super::*;

    /// Changing one of these lines means a new version of the protocol.
    #[test]
    fn messages_are_what_they_were() {
        let asks = [
            (
                IconAsk::Read {
                    id: 1,
                    device: "XV-101".into(),
                    steps: vec![
                        IconStep::Block(Block {
                            table: TableName::Holding,
                            start: 3000,
                            count: 2,
                        }),
                        IconStep::File {
                            file: 2,
                            start: 0,
                            count: 10,
                        },
                        IconStep::Identity,
                        IconStep::Diagnostic { sub_function: 11 },
                    ],
                },
                r#"{"icon":{"read":{"id":1,"device":"XV-101","steps":[{"block":{"table":"holding","start":3000,"count":2}},{"file":{"file":2,"start":0,"count":10}},"identity",{"diagnostic":{"sub_function":11}}]}}}"#,
            ),
            (IconAsk::Cancel { id: 1 }, r#"{"icon":{"cancel":{"id":1}}}"#),
        ];
        for (ask, json) in asks {
            let message = ToBackend::Icon(ask);
            assert_eq!(serde_json::to_string(&message).unwrap(), json);
            assert_eq!(serde_json::from_str::<ToBackend>(json).unwrap(), message);
        }
        let news = [
            (
                IconNews::Exchange {
                    id: 1,
                    device: "XV-101".into(),
                    step: 2,
                    request: "11".into(),
                    response: "9101".into(),
                    outcome: Outcome::Exception,
                    text: "illegal function".into(),
                    at_us: 3,
                },
                r#"{"icon":{"exchange":{"id":1,"device":"XV-101","step":2,"request":"11","response":"9101","outcome":"exception","text":"illegal function","at_us":3}}}"#,
            ),
            (
                IconNews::Progress {
                    id: 1,
                    device: "XV-101".into(),
                    done: 1,
                    total: 4,
                    text: "file 2".into(),
                },
                r#"{"icon":{"progress":{"id":1,"device":"XV-101","done":1,"total":4,"text":"file 2"}}}"#,
            ),
            (
                IconNews::Done {
                    id: 1,
                    device: "XV-101".into(),
                    ok: 3,
                    failed: 1,
                },
                r#"{"icon":{"done":{"id":1,"device":"XV-101","ok":3,"failed":1}}}"#,
            ),
        ];
        for (message, json) in news {
            assert!(json.starts_with(ICON_PREFIX));
            assert_eq!(message.clone().to_text(), json);
            assert_eq!(IconNews::from_text(json), Some(message));
        }
        assert_eq!(IconNews::from_text(r#"{"tick":{"now_us":1}}"#), None);
    }

    #[test]
    fn no_message_writes_a_file() {
        for json in [
            r#"{"icon":{"write":{"device":"x","file":2}}}"#,
            r#"{"icon":{"read":{"id":1,"device":"x","steps":[{"file":{"file":2,"start":0,"count":1,"data":"00"}}]}}}"#,
        ] {
            assert!(serde_json::from_str::<ToBackend>(json).is_err(), "{json}");
        }
    }
}
