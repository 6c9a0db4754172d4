//! What page and backend say to each other about the diagnostic objects of a DOP device.
//!
//! A page asks for objects by their request words; the backend performs the handshakes and sends
//! the response registers as they came. The page decodes them. Nothing here carries an address or
//! a frame: where the request is written is the backend's configuration, not the page's wish.
//!
//! All news is wrapped once, so that its text begins with `{"dop":` and can be passed on unread.

use super::Outcome;
use serde::{Deserialize, Serialize};

/// Requests that a page may have waiting for one device at once.
pub const MAX_DOP_REQUESTS: usize = 128;

/// How the text of every [`DopNews`] begins.
pub const DOP_PREFIX: &str = "{\"dop\":";

/// Which end of a log comes first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LogFrom {
    /// From the newest record to the oldest.
    Newest,
    /// From the oldest record to the newest.
    Oldest,
}

/// From the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DopAsk {
    /// Read these objects, one after the other.
    Read {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Tag of the device.
        device: String,
        /// Request words: `option << 12 | object`.
        requests: Vec<u16>,
    },
    /// Read a log page by page.
    Log {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Tag of the device.
        device: String,
        /// 1202 or 1203.
        object: u16,
        /// Where to begin.
        from: LogFrom,
        /// To resume: records up to and including this record id are not sent again.
        after: Option<u64>,
        /// Records at most; 0 leaves it to the profile.
        limit: u32,
    },
    /// End a read or a log; what is under way on the line is finished first.
    Cancel {
        /// The id of the read or log.
        id: u32,
    },
    /// Read the user indicators again and again; replaces the page's watch of this device.
    Watch {
        /// Tag of the device.
        device: String,
        /// Time from one reading to the next; 0 ends the watch.
        period_ms: u32,
    },
    /// Ask for the profile of a device.
    Profile {
        /// Tag of the device.
        device: String,
    },
}

/// Where a handshake is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DopStep {
    /// The request is being written.
    Requesting,
    /// The device works on it.
    Busy,
    /// The number of registers is being read.
    Counting,
    /// The registers are being read.
    Reading,
}

/// From the backend.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DopNews {
    /// The profile of a device.
    Profile {
        /// Tag of the device.
        device: String,
        /// The profile, as in its file.
        profile: serde_json::Value,
        /// Position of the status bits that was learned from a complete exchange.
        shift: Option<u8>,
    },
    /// A read goes on.
    Progress {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// The request word.
        request: u16,
        /// Where its handshake is.
        step: DopStep,
        /// Objects, or for a log records, that are done.
        done: u32,
        /// Objects that were asked for; 0 for a log, whose length nobody knows.
        total: u32,
        /// In words.
        text: String,
    },
    /// An object was read.
    Object {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// The request word.
        request: u16,
        /// The response registers, four digits each.
        hex: String,
        /// When the last register came, in microseconds since the start of the backend.
        at_us: u64,
        /// From the request to the last register.
        took_us: u64,
        /// From the request until the device was ready.
        busy_us: u64,
        /// How often the status was read.
        polls: u32,
        /// How often the handshake was begun anew.
        retries: u32,
        /// How often the request of another master was seen in between.
        foreign: u32,
        /// In words.
        text: String,
    },
    /// An object could not be read.
    Failed {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// The request word.
        request: u16,
        /// The error code of the device, if it gave one.
        code: Option<u16>,
        /// How it ended: `ok` if the device answered, but with an error.
        outcome: Outcome,
        /// In words.
        text: String,
    },
    /// A log is at its end; `done` follows.
    LogEnd {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// 1202 or 1203.
        object: u16,
        /// Pages that were read.
        pages: u32,
        /// Why it ended there.
        text: String,
    },
    /// A read or a log is over.
    Done {
        /// The page's id.
        id: u32,
        /// Tag of the device.
        device: String,
        /// Objects that were read.
        ok: u32,
        /// Objects that were not.
        failed: u32,
    },
    /// The user indicators.
    Indicators {
        /// Tag of the device.
        device: String,
        /// The four registers, four digits each.
        hex: String,
        /// When they came, in microseconds since the start of the backend.
        at_us: u64,
    },
}

/// The wrapping of all news.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Wrapped {
    dop: DopNews,
}

impl DopNews {
    /// The text that travels.
    #[must_use]
    pub fn to_text(self) -> String {
        // These types always have a JSON form.
        serde_json::to_string(&Wrapped { dop: self }).unwrap_or_default()
    }

    /// Reads a text that travelled; `None` if it is something else.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        if !text.starts_with(DOP_PREFIX) {
            return None;
        }
        serde_json::from_str::<Wrapped>(text).ok().map(|w| w.dop)
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
                DopAsk::Read {
                    id: 1,
                    device: "MX-301".into(),
                    requests: vec![0x1001],
                },
                r#"{"dop":{"read":{"id":1,"device":"MX-301","requests":[4097]}}}"#,
            ),
            (
                DopAsk::Log {
                    id: 2,
                    device: "MX-301".into(),
                    object: 1202,
                    from: LogFrom::Newest,
                    after: Some(7),
                    limit: 0,
                },
                r#"{"dop":{"log":{"id":2,"device":"MX-301","object":1202,"from":"newest","after":7,"limit":0}}}"#,
            ),
            (DopAsk::Cancel { id: 2 }, r#"{"dop":{"cancel":{"id":2}}}"#),
            (
                DopAsk::Watch {
                    device: "MX-301".into(),
                    period_ms: 1000,
                },
                r#"{"dop":{"watch":{"device":"MX-301","period_ms":1000}}}"#,
            ),
            (
                DopAsk::Profile {
                    device: "MX-301".into(),
                },
                r#"{"dop":{"profile":{"device":"MX-301"}}}"#,
            ),
        ];
        for (ask, json) in asks {
            let message = ToBackend::Dop(ask);
            assert_eq!(serde_json::to_string(&message).unwrap(), json);
            assert_eq!(serde_json::from_str::<ToBackend>(json).unwrap(), message);
        }
        let news = [
            (
                DopNews::Progress {
                    id: 1,
                    device: "MX-301".into(),
                    request: 1,
                    step: DopStep::Busy,
                    done: 0,
                    total: 3,
                    text: "busy".into(),
                },
                r#"{"dop":{"progress":{"id":1,"device":"MX-301","request":1,"step":"busy","done":0,"total":3,"text":"busy"}}}"#,
            ),
            (
                DopNews::Object {
                    id: 1,
                    device: "MX-301".into(),
                    request: 1005,
                    hex: "0001000200030004".into(),
                    at_us: 9,
                    took_us: 5,
                    busy_us: 4,
                    polls: 3,
                    retries: 0,
                    foreign: 0,
                    text: "4 registers".into(),
                },
                r#"{"dop":{"object":{"id":1,"device":"MX-301","request":1005,"hex":"0001000200030004","at_us":9,"took_us":5,"busy_us":4,"polls":3,"retries":0,"foreign":0,"text":"4 registers"}}}"#,
            ),
            (
                DopNews::Failed {
                    id: 1,
                    device: "MX-301".into(),
                    request: 1,
                    code: Some(3),
                    outcome: Outcome::Ok,
                    text: "option".into(),
                },
                r#"{"dop":{"failed":{"id":1,"device":"MX-301","request":1,"code":3,"outcome":"ok","text":"option"}}}"#,
            ),
            (
                DopNews::LogEnd {
                    id: 2,
                    device: "MX-301".into(),
                    object: 1202,
                    pages: 4,
                    text: "no more".into(),
                },
                r#"{"dop":{"log_end":{"id":2,"device":"MX-301","object":1202,"pages":4,"text":"no more"}}}"#,
            ),
            (
                DopNews::Done {
                    id: 1,
                    device: "MX-301".into(),
                    ok: 3,
                    failed: 0,
                },
                r#"{"dop":{"done":{"id":1,"device":"MX-301","ok":3,"failed":0}}}"#,
            ),
            (
                DopNews::Indicators {
                    device: "MX-301".into(),
                    hex: "0001000000000000".into(),
                    at_us: 1,
                },
                r#"{"dop":{"indicators":{"device":"MX-301","hex":"0001000000000000","at_us":1}}}"#,
            ),
            (
                DopNews::Profile {
                    device: "MX-301".into(),
                    profile: serde_json::json!({"name": "a"}),
                    shift: None,
                },
                r#"{"dop":{"profile":{"device":"MX-301","profile":{"name":"a"},"shift":null}}}"#,
            ),
        ];
        for (message, json) in news {
            assert!(json.starts_with(DOP_PREFIX));
            assert_eq!(message.clone().to_text(), json);
            assert_eq!(DopNews::from_text(json), Some(message));
        }
        assert_eq!(DopNews::from_text(r#"{"tick":{"now_us":1}}"#), None);
    }

    /// A page can't say where or with which function something is written.
    #[test]
    fn no_message_names_an_address() {
        for json in [
            r#"{"dop":{"read":{"id":1,"device":"x","requests":[1],"address":5}}}"#,
            r#"{"dop":{"read":{"id":1,"device":"x","requests":[1],"function":16}}}"#,
            r#"{"dop":{"write":{"device":"x","value":1}}}"#,
            r#"{"dop":{"profile":{"device":"x","registers":{"request":1}}}}"#,
            r#"{"dop":{"read":{"id":1,"device":"x","requests":[65536]}}}"#,
        ] {
            assert!(serde_json::from_str::<ToBackend>(json).is_err(), "{json}");
        }
    }
}
