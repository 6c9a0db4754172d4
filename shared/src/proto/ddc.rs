//! What page and backend say to each other about a DDC-100 network.
//!
//! The backend polls all units of a network by itself, as the guide demands. A page that follows it
//! gets what the last poll of each unit brought, and which of both host ports reached it. What the
//! registers mean, and what the pattern of faults means, the page works out itself.

use super::{LineState, Outcome};
use serde::{Deserialize, Serialize};

/// How the text of every [`DdcNews`] begins.
pub const DDC_PREFIX: &str = "{\"ddc\":";

/// From the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DdcAsk {
    /// Tell everything about a network: first all that is known, then what changes.
    Follow {
        /// Name of the bus.
        bus: String,
    },
    /// No more of it.
    Leave {
        /// Name of the bus.
        bus: String,
    },
    /// Read more registers of a unit once, between two polls.
    Read {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Name of the bus.
        bus: String,
        /// The unit.
        unit: u8,
        /// What to read.
        block: super::Block,
    },
    /// Read a counter or the diagnostic register of a unit once (FC 08), between two polls. Only
    /// sub-functions that read are allowed. The answer is [`DdcNews::Read`].
    Counter {
        /// Chosen by the page, repeated in what comes of it.
        id: u32,
        /// Name of the bus.
        bus: String,
        /// The unit.
        unit: u8,
        /// The sub-function.
        sub_function: u16,
    },
}

/// How the cable runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DdcShape {
    /// From one host port through all units back to the other.
    Loop,
    /// From one host port through all units, open at the end.
    SingleEnded,
    /// All units beside each other on one cable.
    MultiDrop,
}

/// A unit of a network.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DdcUnit {
    /// Its address, 1 to 250.
    pub unit: u8,
    /// Key of its kind: `ddc100-uec`.
    pub kind: String,
    /// Its tag.
    pub tag: String,
    /// What it does in the plant; may be empty.
    pub description: String,
    /// Key of the scaling of its analog values, if the tag list says it: `0-4095`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scaling: Option<String>,
}

/// From the backend.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DdcNews {
    /// How a network is made up; once, at first.
    Network {
        /// Name of the bus.
        bus: String,
        /// How the cable runs.
        shape: DdcShape,
        /// Key of the framing.
        framing: String,
        /// Bits a second.
        baud: u32,
        /// Where host port 1 and, if there is one, host port 2 go.
        ports: Vec<String>,
        /// First register of each poll.
        start: u16,
        /// Registers of each poll.
        count: u16,
        /// From an answer to the next request.
        turn_ms: u32,
        /// How long an answer is waited for.
        timeout_ms: u32,
        /// How often a poll is repeated on the same port.
        retries: u8,
        /// The units in the order of the cable, from host port 1.
        units: Vec<DdcUnit>,
        /// What to look at although the network is polled: more units than the cable carries alone.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        hint: Option<String>,
    },
    /// What a poll of a unit brought, and what is known of its ports since.
    Unit {
        /// Name of the bus.
        bus: String,
        /// The unit.
        unit: u8,
        /// Host port that was used, 1 or 2.
        port: u8,
        /// How the poll ended.
        outcome: Outcome,
        /// In words; empty if it is good.
        text: String,
        /// Fault of the unit on host port 1; null if it was not tried yet.
        fault_a: Option<bool>,
        /// The same on host port 2; null also if there is none.
        fault_b: Option<bool>,
        /// Request PDU of the last good answer; before there was one, that of this poll. It may ask
        /// for a few registers more than `start` and `count` of the network say.
        request: String,
        /// Response PDU of the last good answer; empty if there never was one.
        response: String,
        /// When that came, in microseconds since the start of the backend.
        at_us: Option<u64>,
        /// How long it took from the end of the request.
        took_us: Option<u64>,
    },
    /// Which unit is being polled, as often as a page can follow.
    Poll {
        /// Name of the bus.
        bus: String,
        /// The unit.
        unit: u8,
        /// Host port that is used.
        port: u8,
    },
    /// All units were polled on a port.
    Pass {
        /// Name of the bus.
        bus: String,
        /// The port on which it began.
        port: u8,
        /// Passes since the start.
        number: u64,
        /// How long it took.
        took_us: u64,
        /// How long it should take without a fault.
        expected_us: u64,
    },
    /// State of a host port, at first and when it changes.
    Port {
        /// Name of the bus.
        bus: String,
        /// The port.
        port: u8,
        /// Its state.
        state: LineState,
        /// What happened, and what to do.
        text: String,
    },
    /// A `read` or a `counter` is over.
    Read {
        /// The page's id.
        id: u32,
        /// Name of the bus.
        bus: String,
        /// The unit.
        unit: u8,
        /// How it ended.
        outcome: Outcome,
        /// In words.
        text: String,
        /// Request PDU.
        request: String,
        /// Response PDU, empty without one.
        response: String,
        /// When it came, in microseconds since the start of the backend.
        at_us: u64,
    },
}

/// The wrapping of all news.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Wrapped {
    ddc: DdcNews,
}

impl DdcNews {
    /// The text that travels.
    #[must_use]
    pub fn to_text(self) -> String {
        // These types always have a JSON form.
        serde_json::to_string(&Wrapped { ddc: self }).unwrap_or_default()
    }

    /// Reads a text that travelled; `None` if it is something else.
    #[must_use]
    pub fn from_text(text: &str) -> Option<Self> {
        if !text.starts_with(DDC_PREFIX) {
            return None;
        }
        serde_json::from_str::<Wrapped>(text).ok().map(|w| w.ddc)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Block, TableName, ToBackend};
    use super::*;

    /// Changing one of these lines means a new version of the protocol.
    #[test]
    fn messages_are_what_they_were() {
        let asks = [
            (
                DdcAsk::Follow { bus: "Loop".into() },
                r#"{"ddc":{"follow":{"bus":"Loop"}}}"#,
            ),
            (
                DdcAsk::Leave { bus: "Loop".into() },
                r#"{"ddc":{"leave":{"bus":"Loop"}}}"#,
            ),
            (
                DdcAsk::Read {
                    id: 4,
                    bus: "Loop".into(),
                    unit: 250,
                    block: Block {
                        table: TableName::Holding,
                        start: 0,
                        count: 56,
                    },
                },
                r#"{"ddc":{"read":{"id":4,"bus":"Loop","unit":250,"block":{"table":"holding","start":0,"count":56}}}}"#,
            ),
            (
                DdcAsk::Counter {
                    id: 5,
                    bus: "Loop".into(),
                    unit: 3,
                    sub_function: 11,
                },
                r#"{"ddc":{"counter":{"id":5,"bus":"Loop","unit":3,"sub_function":11}}}"#,
            ),
        ];
        for (ask, json) in asks {
            let message = ToBackend::Ddc(ask);
            assert_eq!(serde_json::to_string(&message).unwrap(), json);
            assert_eq!(serde_json::from_str::<ToBackend>(json).unwrap(), message);
        }
        let news = [
            (
                DdcNews::Network {
                    bus: "Loop".into(),
                    shape: DdcShape::SingleEnded,
                    framing: "modbus-rtu".into(),
                    baud: 9600,
                    ports: vec!["/dev/ttyS0".into()],
                    start: 7,
                    count: 9,
                    turn_ms: 30,
                    timeout_ms: 250,
                    retries: 3,
                    units: vec![DdcUnit {
                        unit: 1,
                        kind: "ddc100-uec".into(),
                        tag: "MOV-1".into(),
                        description: String::new(),
                        scaling: None,
                    }],
                    hint: None,
                },
                r#"{"ddc":{"network":{"bus":"Loop","shape":"single_ended","framing":"modbus-rtu","baud":9600,"ports":["/dev/ttyS0"],"start":7,"count":9,"turn_ms":30,"timeout_ms":250,"retries":3,"units":[{"unit":1,"kind":"ddc100-uec","tag":"MOV-1","description":""}]}}}"#,
            ),
            (
                DdcNews::Network {
                    bus: "Line".into(),
                    shape: DdcShape::MultiDrop,
                    framing: "modbus-rtu".into(),
                    baud: 9600,
                    ports: vec![],
                    start: 7,
                    count: 9,
                    turn_ms: 21,
                    timeout_ms: 250,
                    retries: 1,
                    units: vec![DdcUnit {
                        unit: 1,
                        kind: "ddc100-io".into(),
                        tag: "IO-1".into(),
                        description: String::new(),
                        scaling: Some("0-4095".into()),
                    }],
                    hint: Some("many".into()),
                },
                r#"{"ddc":{"network":{"bus":"Line","shape":"multi_drop","framing":"modbus-rtu","baud":9600,"ports":[],"start":7,"count":9,"turn_ms":21,"timeout_ms":250,"retries":1,"units":[{"unit":1,"kind":"ddc100-io","tag":"IO-1","description":"","scaling":"0-4095"}],"hint":"many"}}}"#,
            ),
            (
                DdcNews::Unit {
                    bus: "Loop".into(),
                    unit: 3,
                    port: 2,
                    outcome: Outcome::Ok,
                    text: String::new(),
                    fault_a: Some(true),
                    fault_b: None,
                    request: "0300080001".into(),
                    response: "03020000".into(),
                    at_us: Some(5),
                    took_us: None,
                },
                r#"{"ddc":{"unit":{"bus":"Loop","unit":3,"port":2,"outcome":"ok","text":"","fault_a":true,"fault_b":null,"request":"0300080001","response":"03020000","at_us":5,"took_us":null}}}"#,
            ),
            (
                DdcNews::Poll {
                    bus: "Loop".into(),
                    unit: 3,
                    port: 1,
                },
                r#"{"ddc":{"poll":{"bus":"Loop","unit":3,"port":1}}}"#,
            ),
            (
                DdcNews::Pass {
                    bus: "Loop".into(),
                    port: 1,
                    number: 2,
                    took_us: 3,
                    expected_us: 4,
                },
                r#"{"ddc":{"pass":{"bus":"Loop","port":1,"number":2,"took_us":3,"expected_us":4}}}"#,
            ),
            (
                DdcNews::Port {
                    bus: "Loop".into(),
                    port: 2,
                    state: LineState::Down,
                    text: "gone".into(),
                },
                r#"{"ddc":{"port":{"bus":"Loop","port":2,"state":"down","text":"gone"}}}"#,
            ),
            (
                DdcNews::Read {
                    id: 4,
                    bus: "Loop".into(),
                    unit: 1,
                    outcome: Outcome::Silence,
                    text: "no answer".into(),
                    request: "0300000038".into(),
                    response: String::new(),
                    at_us: 6,
                },
                r#"{"ddc":{"read":{"id":4,"bus":"Loop","unit":1,"outcome":"silence","text":"no answer","request":"0300000038","response":"","at_us":6}}}"#,
            ),
        ];
        for (message, json) in news {
            assert!(json.starts_with(DDC_PREFIX));
            assert_eq!(message.clone().to_text(), json);
            assert_eq!(DdcNews::from_text(json), Some(message));
        }
        assert_eq!(DdcNews::from_text(r#"{"tick":{"now_us":1}}"#), None);
    }

    #[test]
    fn no_message_commands_a_unit() {
        for json in [
            r#"{"ddc":{"command":{"bus":"Loop","unit":1,"value":256}}}"#,
            r#"{"ddc":{"read":{"id":1,"bus":"x","unit":1,"function":6,"block":{"table":"coil","start":0,"count":1}}}}"#,
        ] {
            assert!(serde_json::from_str::<ToBackend>(json).is_err(), "{json}");
        }
    }
}
