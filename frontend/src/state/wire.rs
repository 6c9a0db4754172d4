//! The messages of [`shared::proto`] as the page reads and writes them.
//!
//! The form is that of the derived serializers, which the backend uses; the tests hold both against
//! each other.

pub mod ddc;
pub mod dop;
pub mod hart;
pub mod icon;
#[cfg(test)]
mod tests;

use core::fmt::Write as _;

use shared::proto::{
    Block, Bus, DeviceInfo, LineState, Outcome, TableName, ToBackend, ToPage, Way,
};

use super::json::{Json, quoted};

/// Reads a message of the backend.
///
/// # Errors
///
/// What was not understood, for people.
pub fn read(text: &str) -> Result<ToPage, String> {
    let json = Json::parse(text).ok_or("it is no JSON")?;
    let (kind, body) = json.only().ok_or("it has not exactly one name")?;
    message(Fields { kind, body })
}

fn message(fields: Fields<'_>) -> Result<ToPage, String> {
    Ok(match fields.kind {
        "hello" => ToPage::Hello {
            version: fields.small("version")?,
            app: fields.text("app")?,
            run: fields.number("run")?,
            now_us: fields.number("now_us")?,
            wall_ms: fields.number("wall_ms")?,
            read_only: fields.flag("read_only")?,
            buses: fields.list("buses", bus)?,
            devices: fields.list("devices", device)?,
        },
        "capture" => ToPage::Capture {
            bus: fields.text("bus")?,
            seq: fields.number("seq")?,
            at_us: fields.number("at_us")?,
            way: fields.word("way", &WAYS)?,
            ends: fields.flag("ends")?,
            hex: fields.text("hex")?,
        },
        "lagged" => ToPage::Lagged {
            bus: fields.text("bus")?,
            missed: fields.number("missed")?,
        },
        "line" => ToPage::Line {
            bus: fields.text("bus")?,
            state: fields.word("state", &STATES)?,
            text: fields.text("text")?,
            since_us: fields.number("since_us")?,
        },
        "device" => ToPage::Device {
            tag: fields.text("tag")?,
            outcome: fields.word("outcome", &OUTCOMES)?,
            text: fields.text("text")?,
            last_ok_us: fields.maybe("last_ok_us")?,
            latency_us: fields.maybe("latency_us")?,
        },
        "done" => ToPage::Done {
            id: fields.small("id")?,
            outcome: fields.word("outcome", &OUTCOMES)?,
            text: fields.text("text")?,
        },
        "refused" => ToPage::Refused {
            text: fields.text("text")?,
        },
        "tick" => ToPage::Tick {
            now_us: fields.number("now_us")?,
        },
        other => return Err(format!("`{other}` is not known")),
    })
}

const WAYS: [(&str, Way); 2] = [("tx", Way::Tx), ("rx", Way::Rx)];

const STATES: [(&str, LineState); 3] = [
    ("starting", LineState::Starting),
    ("up", LineState::Up),
    ("down", LineState::Down),
];

const OUTCOMES: [(&str, Outcome); 6] = [
    ("ok", Outcome::Ok),
    ("exception", Outcome::Exception),
    ("silence", Outcome::Silence),
    ("damaged", Outcome::Damaged),
    ("down", Outcome::Down),
    ("refused", Outcome::Refused),
];

fn bus(fields: Fields<'_>) -> Result<Bus, String> {
    Ok(Bus {
        name: fields.text("name")?,
        line: fields.text("line")?,
        framing: fields.text("framing")?,
        simulated: fields.flag("simulated")?,
    })
}

fn device(fields: Fields<'_>) -> Result<DeviceInfo, String> {
    Ok(DeviceInfo {
        tag: fields.text("tag")?,
        kind: fields.text("kind")?,
        bus: fields.text("bus")?,
        unit: fields.small("unit")?,
        description: fields.text("description")?,
    })
}

/// The members of an object, and what it is, for errors.
#[derive(Clone, Copy)]
struct Fields<'a> {
    kind: &'a str,
    body: &'a Json<'a>,
}

impl<'a> Fields<'a> {
    /// An error about a member. Not inlined: it stands behind each of them.
    #[inline(never)]
    fn wrong(self, name: &str) -> String {
        format!("`{name}` of `{}` is missing or of another kind", self.kind)
    }

    fn get<T>(self, name: &str, read: impl Fn(&'a Json<'a>) -> Option<T>) -> Result<T, String> {
        let found = self.body.get(name).and_then(read);
        found.ok_or_else(|| self.wrong(name))
    }

    fn text(self, name: &str) -> Result<String, String> {
        self.get(name, Json::text).map(str::to_owned)
    }

    fn number(self, name: &str) -> Result<u64, String> {
        self.get(name, Json::number)
    }

    fn small<T: TryFrom<u64>>(self, name: &str) -> Result<T, String> {
        T::try_from(self.number(name)?).map_err(|_| self.wrong(name))
    }

    /// A number that may be `null` or missing.
    fn maybe<T: TryFrom<u64>>(self, name: &str) -> Result<Option<T>, String> {
        match self.body.get(name) {
            None | Some(Json::Null) => Ok(None),
            Some(_) => self.small(name).map(Some),
        }
    }

    fn flag(self, name: &str) -> Result<bool, String> {
        self.get(name, |json| match json {
            Json::Bool(flag) => Some(*flag),
            _ => None,
        })
    }

    fn word<T: Copy>(self, name: &str, words: &[(&str, T)]) -> Result<T, String> {
        let word = self.get(name, Json::text)?;
        let found = words.iter().find(|(key, _)| *key == word);
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| self.wrong(name))
    }

    fn list<T>(self, name: &'a str, read: fn(Self) -> Result<T, String>) -> Result<Vec<T>, String> {
        let list = self.get(name, Json::list)?;
        list.iter()
            .map(|body| read(Fields { kind: name, body }))
            .collect()
    }
}

/// Writes a message of the page. `None` for those that only a program of its own sends, see [`dop`].
#[must_use]
pub fn write(message: &ToBackend) -> Option<String> {
    let mut out = String::from("{");
    let mut body = Writer {
        out: &mut out,
        first: true,
    };
    match message {
        ToBackend::Hello { version } => {
            body.begin("hello").number("version", u64::from(*version));
        }
        ToBackend::Subscribe { bus, after } => {
            body.begin("subscribe")
                .text("bus", bus)
                .maybe("after", *after);
        }
        ToBackend::Unsubscribe { bus } => {
            body.begin("unsubscribe").text("bus", bus);
        }
        ToBackend::Read { id, device, block } => {
            body.begin("read")
                .number("id", u64::from(*id))
                .text("device", device)
                .name("block")
                .block(*block);
        }
        ToBackend::Watch {
            device,
            blocks,
            period_ms,
        } => {
            let body = body.begin("watch").text("device", device);
            body.name("blocks").raw("[");
            for (at, block) in blocks.iter().enumerate() {
                body.raw(if at == 0 { "" } else { "," }).block(*block);
            }
            body.raw("]").number("period_ms", u64::from(*period_ms));
        }
        ToBackend::Dop(_) | ToBackend::Hart(_) | ToBackend::Ddc(_) | ToBackend::Icon(_) => {
            return None;
        }
    }
    out.push_str("}}");
    Some(out)
}

struct Writer<'a> {
    out: &'a mut String,
    first: bool,
}

impl Writer<'_> {
    fn raw(&mut self, text: &str) -> &mut Self {
        self.out.push_str(text);
        self
    }

    /// Begins an object under a name.
    fn begin(&mut self, name: &str) -> &mut Self {
        quoted(self.out, name);
        self.first = true;
        self.raw(":{")
    }

    fn name(&mut self, name: &str) -> &mut Self {
        if !core::mem::take(&mut self.first) {
            self.out.push(',');
        }
        quoted(self.out, name);
        self.raw(":")
    }

    fn text(&mut self, name: &str, text: &str) -> &mut Self {
        quoted(self.name(name).out, text);
        self
    }

    fn number(&mut self, name: &str, number: u64) -> &mut Self {
        let out = &mut self.name(name).out;
        // Writing to a string does not fail.
        let _infallible = write!(out, "{number}");
        self
    }

    fn maybe(&mut self, name: &str, number: Option<u64>) -> &mut Self {
        match number {
            Some(number) => self.number(name, number),
            None => self.name(name).raw("null"),
        }
    }

    fn block(&mut self, block: Block) -> &mut Self {
        let table = match block.table {
            TableName::Coil => "coil",
            TableName::Discrete => "discrete",
            TableName::Input => "input",
            TableName::Holding => "holding",
        };
        self.first = true;
        self.raw("{")
            .text("table", table)
            .number("start", u64::from(block.start))
            .number("count", u64::from(block.count))
            .raw("}")
    }
}
