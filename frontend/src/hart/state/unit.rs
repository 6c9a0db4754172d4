//! One device: the exchanges with it, and what they say.

#[cfg(test)]
pub(crate) mod tests;

use std::collections::BTreeMap;
use std::collections::VecDeque;

use shared::capture::{Capture, Direction};
use shared::device::{Device, Family};
use shared::frame::Framing;
use shared::hart::class;
use shared::hart::frame::Address;
use shared::hart::link::{Answer, Identity};
use shared::hart::model::Class;
use shared::proto::{HartCommand, Outcome};
use shared::session::Session;
use shared::tree::{Field, FieldId, Name};
use shared::value::Value;

use crate::state::tree::Facts;
use crate::state::work::Shown;

/// Points of the trend that are kept: half an hour at two a second.
const TREND: usize = 3600;

/// Microseconds after which an answer does not tell of now any more.
const FRESH: u64 = 15_000_000;
/// Bit of the device status: the configuration was changed.
const CONFIGURED: u8 = 0x40;
/// Key of the counter of changes of the configuration.
const COUNTER: &str = "change_counter";

/// A command with its data, as asked: what tells one reading from another.
pub type Key = (u16, String);

/// The command with this number and no data.
#[must_use]
pub const fn plain(number: u16) -> Key {
    (number, String::new())
}

/// The same for the wire.
#[must_use]
pub fn to_wire(key: &Key) -> HartCommand {
    HartCommand {
        number: key.0,
        data: key.1.clone(),
    }
}

/// An answer with data.
#[derive(Clone, Debug, PartialEq)]
pub struct Good {
    /// The response, decoded; entry 1 of its exchange.
    pub shown: Shown,
    /// The request, decoded.
    pub request: Option<Shown>,
    /// When its last byte came, in microseconds since the start of the backend.
    pub at_us: u64,
    /// How long the exchange took.
    pub took_us: u64,
    /// How often it was sent.
    pub tries: u8,
}

/// Why there is no answer with data.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bad {
    /// How it ended.
    pub outcome: Outcome,
    /// In words.
    pub text: String,
    /// When.
    pub at_us: u64,
}

/// What is known of one command.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The last answer with data.
    pub good: Option<Good>,
    /// What went wrong since.
    pub bad: Option<Bad>,
}

/// The dynamic variables at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Moment {
    /// Microseconds since the start of the backend.
    pub at_us: u64,
    /// Loop current, then PV, SV and TV: number and text; `None` where the device has no value.
    pub values: [Option<(f64, String)>; 4],
}

/// Keys of command 3 that the trend keeps.
pub const TRACED: [&str; 4] = ["loop_current", "pv", "sv", "tv"];

/// The device.
#[derive(Clone, Debug, PartialEq)]
pub struct Unit {
    /// Its tag.
    pub tag: String,
    /// Its family.
    pub family: Option<Family>,
    /// The bus that it is on.
    pub bus: String,
    /// What is known, by command.
    pub readings: BTreeMap<Key, Reading>,
    /// The dynamic variables over time.
    pub trend: VecDeque<Moment>,
    /// When it last answered, whatever it said.
    pub answered_us: Option<u64>,
    /// How the last exchange ended, and in words.
    pub last: Option<(Outcome, String)>,
    /// True while the connection is gone, until something is heard again.
    pub away: bool,
    /// The last device status byte with its time.
    pub status: Option<(u8, u64)>,
    /// When its mode may have changed: the device status did, or the primary variable came or went.
    pub moded_us: u64,
    /// When its configuration changed last, by the device status or the counter of command 0.
    pub configured_us: u64,
    /// What was asked once and is not over.
    pending: Vec<Key>,
}

impl Unit {
    /// A device of which nothing is known.
    #[must_use]
    pub const fn new(tag: String, family: Option<Family>, bus: String) -> Self {
        Self {
            tag,
            family,
            bus,
            readings: BTreeMap::new(),
            trend: VecDeque::new(),
            answered_us: None,
            last: None,
            away: false,
            status: None,
            moded_us: 0,
            configured_us: 0,
            pending: Vec::new(),
        }
    }

    /// Notes what is asked, to tell the answers apart whose request never went out.
    pub fn ask(&mut self, keys: &[Key]) {
        self.pending = keys.to_vec();
    }

    /// Takes an exchange in: request and response as on the line, from delimiter to check byte.
    pub fn take(
        &mut self,
        request: &[u8],
        response: &[u8],
        command: u16,
        (outcome, text): (Outcome, &str),
        (at_us, took_us, tries): (u64, u64, u8),
    ) {
        self.last = Some((outcome, text.to_owned()));
        self.away = false;
        let device = self.family.map_or(Device::None, Device::Rotork);
        let session = exchange(request, response);
        let asked = Shown::of(&session, 0, device);
        let answer = Shown::of(&session, 1, device).filter(|_| !response.is_empty());
        // A command that was refused before it was sent has no request to tell its data.
        let at = self.pending.iter().position(|key| key.0 == command);
        let waited = at.map(|at| self.pending.remove(at));
        let key = match &asked {
            Some(asked) if !request.is_empty() => (command, data_of(asked)),
            _ => waited.unwrap_or_else(|| plain(command)),
        };
        if let Some(answer) = &answer {
            self.answered_us = Some(at_us);
            if let Some(status) = raw_of(answer, "device_status") {
                let status = u8::try_from(status).unwrap_or(0);
                let moved = self.status.map_or(0, |(before, _)| before ^ status);
                self.note(moved != 0, moved & CONFIGURED != 0, at_us);
                self.status = Some((status, at_us));
            }
        }
        let refused = answer.as_ref().and_then(refusal);
        if let (0, Some(counter)) = (command, answer.as_ref().and_then(counter)) {
            let before = self.raw(0, COUNTER).is_some_and(|before| before != counter);
            self.note(false, before, at_us);
        }
        let reading = self.readings.entry(key).or_default();
        match (answer, refused) {
            (Some(shown), None) if outcome == Outcome::Ok => {
                let good = Good {
                    shown,
                    request: asked,
                    at_us,
                    took_us,
                    tries,
                };
                let moment = (command == 3).then(|| moment(&good));
                reading.good = Some(good);
                reading.bad = None;
                if let Some(moment) = moment {
                    let has = |m: &Moment| m.values[1].is_some();
                    let came = self.trend.back().is_some_and(|b| has(b) != has(&moment));
                    self.note(came, false, at_us);
                    self.trend.push_back(moment);
                    if self.trend.len() > TREND {
                        self.trend.pop_front();
                    }
                }
            }
            (_, refused) => {
                reading.bad = Some(Bad {
                    outcome,
                    text: refused.unwrap_or_else(|| text.to_owned()),
                    at_us,
                });
            }
        }
    }

    fn note(&mut self, mode: bool, configuration: bool, at_us: u64) {
        if mode {
            self.moded_us = at_us;
        }
        if configuration {
            self.configured_us = at_us;
        }
    }

    /// Where its commands go, by its answer to command 0, of whatever revision.
    #[must_use]
    pub fn address(&self) -> Option<Address> {
        Some(identity(&self.good(0)?.shown)?.address)
    }

    /// What is known of a command.
    #[must_use]
    pub fn reading(&self, key: &Key) -> Option<&Reading> {
        self.readings.get(key)
    }

    /// The last answer with data to a command without data.
    #[must_use]
    pub fn good(&self, command: u16) -> Option<&Good> {
        self.reading(&plain(command))?.good.as_ref()
    }

    /// The raw value of a field: a code, bits, or a whole number.
    #[must_use]
    pub fn raw(&self, command: u16, field: &str) -> Option<u32> {
        raw_of(&self.good(command)?.shown, field)
    }

    /// A value as text with its unit.
    #[must_use]
    pub fn text(&self, command: u16, field: &str) -> Option<String> {
        let shown = &self.good(command)?.shown;
        let (_, field) = find(shown, field)?;
        Some(shown.decoded.text(field))
    }

    /// True for a device that has this command by the manual.
    #[must_use]
    pub fn has(&self, command: u16) -> bool {
        let known = shared::hart::command(command);
        known.is_some_and(|c| self.family.is_none_or(|f| c.families.contains(&f)))
    }

    /// Everything about a field of a good answer.
    #[must_use]
    pub fn facts(good: &Good, field: &str) -> Option<Facts> {
        let (id, _) = find(&good.shown, field)?;
        Facts::of(&good.shown.decoded, id)
    }

    /// The connection is gone: what was told stays, and grows old.
    pub fn lost(&mut self) {
        self.last = None;
        self.away = true;
    }

    /// True for an answer that tells of now: the last of its command, and not older than a
    /// quarter of a minute.
    #[must_use]
    pub fn is_fresh(&self, command: u16, now_us: u64) -> bool {
        let reading = self.reading(&plain(command)).filter(|r| r.bad.is_none());
        let good = reading.and_then(|r| r.good.as_ref()).filter(|_| !self.away);
        good.is_some_and(|good| now_us.saturating_sub(good.at_us) <= FRESH)
    }
}

/// Request and response, one after the other.
fn exchange(request: &[u8], response: &[u8]) -> Session {
    let mut session = Session::new(Framing::Hart);
    for (bytes, direction) in [
        (request, Direction::ToDevice),
        (response, Direction::FromDevice),
    ] {
        session.push(&Capture {
            bytes,
            at: None,
            direction,
            ends: true,
        });
    }
    session.finish();
    session
}

/// The data of a request as digits, without the number of an extended command.
fn data_of(request: &Shown) -> String {
    use shared::hart::frame::{Head, extended};
    let bytes = request.decoded.bytes();
    let data = Head::of(bytes).and_then(|head| {
        let skip = if extended(&head, bytes).is_some() {
            2
        } else {
            0
        };
        bytes.get(head.data + skip..head.data + usize::from(head.count))
    });
    shared::render::hex(data.unwrap_or(&[]))
}

/// Why an answer has no data, in words.
fn refusal(shown: &Shown) -> Option<String> {
    let decoded = &shown.decoded;
    if let Some((_, field)) = find(shown, "communication_error") {
        return Some(format!(
            "The device did not understand the request: {}.",
            decoded.bare_text(field)
        ));
    }
    let code = u8::try_from(raw_of(shown, "response_code")?).ok()?;
    let (_, field) = find(shown, "response_code")?;
    (class(code).0 == Class::Error).then(|| format!("Refused: {}.", decoded.bare_text(field)))
}

/// Who answered: from the answer to command 0, 11 or 21, from the delimiter to the check byte.
#[must_use]
pub fn identity(shown: &Shown) -> Option<Identity> {
    Identity::of(&Answer::of(shown.decoded.bytes())?)
}

/// The counter of changes in an answer to command 0; HART 5 has none.
fn counter(shown: &Shown) -> Option<u32> {
    raw_of(shown, COUNTER)
}

/// A field of the protocol or of the data, by its key.
#[must_use]
pub fn find<'s>(shown: &'s Shown, key: &str) -> Option<(FieldId, &'s Field)> {
    shown.decoded.iter().find(|(_, field)| match field.name {
        Name::Def(def) => def.key == key,
        Name::Hart(item, ..) | Name::HartPart(item, _) => item.key == key,
        _ => false,
    })
}

/// The raw value of a field.
#[must_use]
pub fn raw_of(shown: &Shown, key: &str) -> Option<u32> {
    let (_, field) = find(shown, key)?;
    match field.value {
        Value::Named(raw, _)
        | Value::Hex(raw)
        | Value::Flags { raw, .. }
        | Value::Code { raw, .. } => Some(raw),
        Value::Number { raw, .. } => u32::try_from(raw).ok(),
        _ => None,
    }
}

fn moment(good: &Good) -> Moment {
    Moment {
        at_us: good.at_us,
        values: TRACED.map(|key| {
            let (_, field) = find(&good.shown, key)?;
            match field.value {
                Value::Number { raw, scale } => {
                    Some((scale.to_f64(raw), good.shown.decoded.bare_text(field)))
                }
                _ => None,
            }
        }),
    }
}
