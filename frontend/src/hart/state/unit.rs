//! One device: the exchanges with it, and what they say.

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
const FRESH: u64 = 10_000_000;
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

    /// True for an answer that tells of now: the last of its command, and not older than ten
    /// seconds.
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

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::state::absorb::bytes_of;

    /// The worked exchange R5, R6: 12 mA, demand 50 %, position 49.5 %, torque 12.5 %, no fourth.
    pub(crate) const POLL: (&str, &str) = (
        "82AEDD012345030095",
        "86AEDD012345031A0000414000003942480000394246000039414800003 97FA0000052",
    );
    /// The worked exchange R9, R10 of command 48.
    pub(crate) const STATUS: (&str, &str) = (
        "82AEDD0123453000A6",
        "86AEDD012345300B009002000200A440080000D5",
    );

    pub(crate) fn hex(text: &str) -> Vec<u8> {
        bytes_of(&text.replace(' ', ""))
    }

    pub(crate) fn unit(exchanges: &[(u16, &str, &str)]) -> Unit {
        let mut unit = Unit::new("FV-1".into(), Some(Family::Iq), "loop".into());
        for (command, request, response) in exchanges {
            let (request, response) = (hex(request), hex(response));
            unit.take(&request, &response, *command, (Outcome::Ok, ""), (7, 2, 1));
        }
        unit
    }

    #[test]
    fn values_come_from_the_bytes() {
        let unit = unit(&[(3, POLL.0, POLL.1), (48, STATUS.0, STATUS.1)]);
        assert_eq!(unit.text(3, "pv").as_deref(), Some("50 %"));
        assert_eq!(unit.text(3, "sv").as_deref(), Some("49.5 %"));
        assert_eq!(unit.text(3, "loop_current").as_deref(), Some("12 mA"));
        assert_eq!(unit.raw(48, "byte_4"), Some(0xA4));
        assert_eq!(unit.status, Some((0x90, 7)));
        let moment = &unit.trend[0];
        assert_eq!(moment.values[2], Some((49.5, "49.5".into())));
        assert_eq!(unit.reading(&plain(13)), None, "not read is not there");
        assert!(unit.has(133) && !unit.has(129) && !unit.has(33));
    }

    /// A frame of the device with its check byte.
    pub(crate) fn answer(command: u8, status: u8, data: &[u8]) -> Vec<u8> {
        let data = [&[0, status], data].concat();
        shared::hart::frame::seal(0x86, &[0xAE, 0xDD, 1, 0x23, 0x45], command, &data)
    }

    /// A request to it.
    pub(crate) fn request(command: u8, data: &[u8]) -> Vec<u8> {
        shared::hart::frame::seal(0x82, &[0xAE, 0xDD, 1, 0x23, 0x45], command, data)
    }

    /// Takes an answer in that came at a second.
    pub(crate) fn hear(unit: &mut Unit, command: u8, status: u8, data: &[u8], second: u64) {
        let (asked, answer) = (request(command, &[]), answer(command, status, data));
        let ok = (Outcome::Ok, "");
        let at = (second * 1_000_000, 2, 1);
        unit.take(&asked, &answer, command.into(), ok, at);
    }

    /// Loop current 12 mA, and this primary variable in percent; no others.
    pub(crate) fn poll(pv: f32) -> Vec<u8> {
        let [a, b, c, d] = pv.to_be_bytes();
        vec![0x41, 0x40, 0, 0, 57, a, b, c, d]
    }

    /// Command 0 by its lengths: HART 5 answers 12 bytes, HART 6 17 and HART 7 22; the counter is
    /// bytes 14 and 15.
    pub(crate) fn identity_of(revision: u8, counter: u8) -> Vec<u8> {
        let mut data = vec![254, 0x6E, 0xDD, 7, revision, 2, 1, 8, 0, 1, 0x23, 0x45];
        match revision {
            6 => data.extend([5, 5, 0, counter, 0]),
            7 => data.extend([5, 4, 0, counter, 0, 0, 0x6E, 0, 0x6E, 1]),
            _ => {}
        }
        data
    }

    #[test]
    fn devices_of_every_revision_have_their_long_address() {
        for revision in 5..=7 {
            let mut unit = unit(&[]);
            assert_eq!(unit.address(), None);
            hear(&mut unit, 0, 0, &identity_of(revision, 1), 1);
            assert_eq!(unit.address(), Some(Address::Long(0x2EDD, 0x01_2345)));
        }
    }

    #[test]
    fn answers_grow_old() {
        let mut unit = unit(&[]);
        assert!(!unit.is_fresh(48, 0));
        hear(&mut unit, 48, 0, &[0; 9], 1);
        assert!(unit.is_fresh(48, 11_000_000) && !unit.is_fresh(48, 11_000_001));
        unit.lost();
        assert!(!unit.is_fresh(48, 1_000_000));
        hear(&mut unit, 3, 0, &poll(1.0), 2);
        assert!(unit.is_fresh(48, 2_000_000));
        let silence = (Outcome::Silence, "no answer");
        unit.take(&request(48, &[]), &[], 48, silence, (3_000_000, 1, 4));
        assert!(!unit.is_fresh(48, 3_000_000));
    }

    #[test]
    fn what_moves_is_noted() {
        let mut unit = unit(&[]);
        hear(&mut unit, 3, 0, &poll(50.0), 1);
        hear(&mut unit, 3, 0, &poll(51.0), 2);
        assert_eq!((unit.moded_us, unit.configured_us), (0, 0));
        hear(&mut unit, 3, 0, &poll(f32::NAN), 3);
        assert_eq!(unit.moded_us, 3_000_000, "no demand any more");
        hear(&mut unit, 3, 8, &poll(f32::NAN), 4);
        assert_eq!(unit.moded_us, 4_000_000, "loop current fixed");
        assert_eq!(unit.configured_us, 0);
        hear(&mut unit, 3, 0x48, &poll(f32::NAN), 5);
        assert_eq!(unit.configured_us, 5_000_000, "configuration changed");
        hear(&mut unit, 0, 0x48, &identity_of(7, 1), 6);
        hear(&mut unit, 0, 0x48, &identity_of(7, 1), 7);
        assert_eq!(unit.configured_us, 5_000_000);
        hear(&mut unit, 0, 0x48, &identity_of(7, 2), 8);
        assert_eq!(unit.configured_us, 8_000_000, "the counter went on");
    }

    #[test]
    fn a_refusal_keeps_the_last_value_and_says_why() {
        // The worked answer R28: command 35, code 64.
        let mut unit = unit(&[(3, POLL.0, POLL.1)]);
        let refused = hex("86AEDD012345230240 40B3");
        unit.take(
            &hex("82AEDD0123452300B5"),
            &refused,
            35,
            (Outcome::Ok, ""),
            (9, 1, 1),
        );
        let reading = unit.reading(&plain(35)).unwrap();
        assert!(reading.good.is_none());
        let why = &reading.bad.as_ref().unwrap().text;
        assert!(why.contains("Command not implemented"), "{why}");
        let poll = hex(POLL.0);
        unit.take(&poll, &[], 3, (Outcome::Silence, "no answer"), (11, 1, 4));
        let reading = unit.reading(&plain(3)).unwrap();
        assert!(reading.good.is_some(), "the last value stays");
        assert_eq!(reading.bad.as_ref().unwrap().outcome, Outcome::Silence);
        assert_eq!(unit.answered_us, Some(9));
    }

    #[test]
    fn what_never_went_out_is_known_as_asked() {
        let mut unit = unit(&[]);
        let key = (523, "0040".to_owned());
        unit.ask(core::slice::from_ref(&key));
        unit.take(&[], &[], 523, (Outcome::Down, "no line"), (1, 0, 0));
        let bad = unit.reading(&key).unwrap().bad.as_ref().unwrap();
        assert_eq!(bad.text, "no line");
    }

    #[test]
    fn extended_commands_are_told_apart_by_their_data() {
        let unit = unit(&[(
            523,
            "82AEDD0123451F04020B0040C4",
            "86AEDD0123451F260000020B0040 00000000304000510405000005030000000000000000000000000000000000 00C4",
        )]);
        let key = (523, "0040".to_owned());
        let reading = unit.reading(&key).unwrap();
        assert!(reading.good.is_some(), "{:?}", unit.readings.keys());
    }
}
