//! What page and backend say to each other: JSON text frames over one WebSocket.
//!
//! Bytes travel as hexadecimal; the page decodes them itself. Both sides begin with `hello`. There
//! is no message that carries a value, an address to write to, or a frame of the page's making.
//! Reading a diagnostic object ([`DopAsk`]) is the one thing for which the backend writes: the
//! request word of that object, to the register that its own configuration names.
//!
//! Changing a variant means a new [`VERSION`].

mod ddc;
mod dop;
mod hart;
mod icon;

pub use ddc::{DDC_PREFIX, DdcAsk, DdcNews, DdcShape, DdcUnit};
pub use dop::{DOP_PREFIX, DopAsk, DopNews, DopStep, LogFrom, MAX_DOP_REQUESTS};
pub use hart::{HART_PREFIX, HartAsk, HartCommand, HartNews, MAX_HART_COMMANDS};
pub use icon::{ICON_PREFIX, IconAsk, IconNews, IconStep, MAX_ICON_STEPS};

use serde::{Deserialize, Serialize};

use crate::address::{Address, Table};
use crate::encode::Read;

/// Version of this protocol.
pub const VERSION: u32 = 3;

/// How the texts begin that a page passes on, unread, to the program that it hosts.
pub const PROGRAM_PREFIXES: [&str; 4] = [DOP_PREFIX, HART_PREFIX, DDC_PREFIX, ICON_PREFIX];

/// Largest message that a page may send, in bytes.
pub const MAX_MESSAGE: usize = 64 * 1024;

/// Fastest period of a watch, in milliseconds.
pub const MIN_PERIOD_MS: u32 = 100;

/// The unit of a HART device that is found by its tag or long address.
pub const NO_POLLING: u8 = u8::MAX;

/// News for a program that the page hosts.
pub trait News {
    /// The text that travels: JSON that begins with one of [`PROGRAM_PREFIXES`].
    fn into_text(self) -> String;
}

impl News for DopNews {
    fn into_text(self) -> String {
        self.to_text()
    }
}

impl News for HartNews {
    fn into_text(self) -> String {
        self.to_text()
    }
}

impl News for DdcNews {
    fn into_text(self) -> String {
        self.to_text()
    }
}

impl News for IconNews {
    fn into_text(self) -> String {
        self.to_text()
    }
}

/// A table, as it travels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TableName {
    /// Coils.
    Coil,
    /// Discrete inputs.
    Discrete,
    /// Input registers.
    Input,
    /// Holding registers.
    Holding,
}

impl From<Table> for TableName {
    fn from(table: Table) -> Self {
        match table {
            Table::Coil => Self::Coil,
            Table::Discrete => Self::Discrete,
            Table::Input => Self::Input,
            Table::Holding => Self::Holding,
        }
    }
}

impl From<TableName> for Table {
    fn from(name: TableName) -> Self {
        match name {
            TableName::Coil => Self::Coil,
            TableName::Discrete => Self::Discrete,
            TableName::Input => Self::Input,
            TableName::Holding => Self::Holding,
        }
    }
}

/// A block to read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Block {
    /// Which table.
    pub table: TableName,
    /// First address, zero-based.
    pub start: u16,
    /// Number of registers or bits.
    pub count: u16,
}

impl Block {
    /// The read that this block asks for; `None` if the standard does not allow it.
    #[must_use]
    pub fn read(self) -> Option<Read> {
        Read::new(self.table.into(), Address::new(self.start), self.count)
    }
}

impl From<Read> for Block {
    fn from(read: Read) -> Self {
        Self {
            table: read.table.into(),
            start: read.start.get(),
            count: read.count(),
        }
    }
}

/// From the page.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum ToBackend {
    /// First message.
    Hello {
        /// The page's [`VERSION`].
        version: u32,
    },
    /// Send the captures of a bus, those after `after` first as far as they are still kept.
    Subscribe {
        /// Name of the bus.
        bus: String,
        /// Sequence number of the last capture that the page has.
        after: Option<u64>,
    },
    /// Stop sending the captures of a bus.
    Unsubscribe {
        /// Name of the bus.
        bus: String,
    },
    /// Read once.
    Read {
        /// Chosen by the page, repeated in `done`.
        id: u32,
        /// Tag of the device.
        device: String,
        /// What to read.
        block: Block,
    },
    /// Read these blocks again and again; replaces what this page watched on the device before.
    Watch {
        /// Tag of the device.
        device: String,
        /// What to read; none ends the watch.
        blocks: Vec<Block>,
        /// Time from one round to the next.
        period_ms: u32,
    },
    /// About the diagnostic objects of a DOP device; the answers are [`DopNews`].
    Dop(DopAsk),
    /// About HART devices; the answers are [`HartNews`].
    Hart(HartAsk),
    /// About a DDC-100 network; the answers are [`DdcNews`].
    Ddc(DdcAsk),
    /// About the files, identity and counters of an ICON3000; the answers are [`IconNews`].
    Icon(IconAsk),
}

/// A bus of the configuration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Bus {
    /// Its name.
    pub name: String,
    /// Where it goes: `/dev/ttyUSB0 9600 8E1`.
    pub line: String,
    /// Key of its framing: `modbus-rtu`.
    pub framing: String,
    /// True for the built-in plant.
    pub simulated: bool,
}

/// A device of the configuration.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceInfo {
    /// Its tag.
    pub tag: String,
    /// Key of its kind: `icon3000v2`.
    pub kind: String,
    /// Name of its bus.
    pub bus: String,
    /// Unit address; of a HART device its polling address, [`NO_POLLING`] if it is found by its tag or
    /// long address.
    pub unit: u8,
    /// What it does in the plant, as configured; may be empty.
    pub description: String,
}

/// Which way bytes went on a bus.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Way {
    /// From the backend to the devices.
    Tx,
    /// From the devices.
    Rx,
}

/// State of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LineState {
    /// Not opened yet.
    Starting,
    /// Open.
    Up,
    /// Can't be opened, or was lost; is tried again.
    Down,
}

/// How a read ended. No answer, a damaged answer and a refusal are different things.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    /// The device answered; the bytes are in the captures.
    Ok,
    /// The device answered with an exception.
    Exception,
    /// No answer in time, after all retries.
    Silence,
    /// Bytes came, but no sound answer, after all retries.
    Damaged,
    /// The line is not there.
    Down,
    /// The backend did not send it: not allowed, not known, or too much.
    Refused,
}

/// From the backend.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToPage {
    /// First message.
    Hello {
        /// The backend's [`VERSION`].
        version: u32,
        /// Name and version of the program.
        app: String,
        /// Changes with each start of the backend; sequence numbers begin anew then.
        run: u64,
        /// Microseconds since the backend started.
        now_us: u64,
        /// Milliseconds since 1970 at that moment.
        wall_ms: u64,
        /// True: no write leaves this backend but the request for a diagnostic object.
        read_only: bool,
        /// All buses.
        buses: Vec<Bus>,
        /// All devices.
        devices: Vec<DeviceInfo>,
    },
    /// Bytes that were on a bus.
    Capture {
        /// Name of the bus.
        bus: String,
        /// Sequence number without holes.
        seq: u64,
        /// When the last byte passed, in microseconds since the start of the backend.
        at_us: u64,
        /// Which way.
        way: Way,
        /// True if the line was silent afterwards.
        ends: bool,
        /// The bytes.
        hex: String,
    },
    /// Captures that were dropped because the page did not keep up or asked too late.
    Lagged {
        /// Name of the bus.
        bus: String,
        /// How many.
        missed: u64,
    },
    /// State of a line, at connection and when it changes.
    Line {
        /// Name of the bus.
        bus: String,
        /// The state.
        state: LineState,
        /// What happened, and what to do.
        text: String,
        /// Since when, in microseconds since the start of the backend.
        since_us: u64,
    },
    /// How reads of a device go, after each round of a watch and when it changes.
    Device {
        /// Tag of the device.
        tag: String,
        /// How the last read ended.
        outcome: Outcome,
        /// In words.
        text: String,
        /// When the device last answered well.
        last_ok_us: Option<u64>,
        /// How long the last answer took.
        latency_us: Option<u64>,
    },
    /// A `read` is over.
    Done {
        /// The page's id.
        id: u32,
        /// How it ended.
        outcome: Outcome,
        /// In words.
        text: String,
    },
    /// A message was not understood or not allowed.
    Refused {
        /// Why, and what to do.
        text: String,
    },
    /// The clock, every few seconds, so that a silent connection is noticed.
    Tick {
        /// Microseconds since the start of the backend.
        now_us: u64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Changing one of these lines means a new [`VERSION`].
    #[test]
    fn messages_are_what_they_were() {
        let check = |message: &ToBackend, json: &str| {
            assert_eq!(serde_json::to_string(message).unwrap(), json);
            assert_eq!(&serde_json::from_str::<ToBackend>(json).unwrap(), message);
        };
        check(
            &ToBackend::Hello { version: 3 },
            r#"{"hello":{"version":3}}"#,
        );
        let block = Block {
            table: TableName::Holding,
            start: 3000,
            count: 31,
        };
        check(
            &ToBackend::Watch {
                device: "XV-1".into(),
                blocks: vec![block],
                period_ms: 1000,
            },
            r#"{"watch":{"device":"XV-1","blocks":[{"table":"holding","start":3000,"count":31}],"period_ms":1000}}"#,
        );
        check(
            &ToBackend::Read {
                id: 7,
                device: "XV-1".into(),
                block,
            },
            r#"{"read":{"id":7,"device":"XV-1","block":{"table":"holding","start":3000,"count":31}}}"#,
        );
        check(
            &ToBackend::Subscribe {
                bus: "a".into(),
                after: Some(9),
            },
            r#"{"subscribe":{"bus":"a","after":9}}"#,
        );

        let capture = ToPage::Capture {
            bus: "a".into(),
            seq: 1,
            at_us: 2,
            way: Way::Rx,
            ends: true,
            hex: "0103".into(),
        };
        let json =
            r#"{"capture":{"bus":"a","seq":1,"at_us":2,"way":"rx","ends":true,"hex":"0103"}}"#;
        assert_eq!(serde_json::to_string(&capture).unwrap(), json);
        assert_eq!(serde_json::from_str::<ToPage>(json).unwrap(), capture);
    }

    #[test]
    fn no_message_writes() {
        for json in [
            r#"{"write":{"device":"XV-1"}}"#,
            r#"{"send":{"hex":"010600000002"}}"#,
            r#"{"read":{"id":1,"device":"x","function":6,"block":{"table":"coil","start":0,"count":1}}}"#,
        ] {
            assert!(serde_json::from_str::<ToBackend>(json).is_err(), "{json}");
        }
    }
}
