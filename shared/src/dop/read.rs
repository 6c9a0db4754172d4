//! A response as values.

use super::choose::{self, Candidate};
use super::fields;
use super::object::{Choice, Field, FieldKind, Layout, Object, Part, Request};
use super::profile::{BitLabel, BitWord, Profile, Setting};
use super::values;
use super::words::Stamp;
use crate::map::row::Reading;
use crate::scale::Scale;
use crate::tree::{Decoded, Name};
use crate::value::{Quality, Value};

/// A number with what is needed to show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Number {
    /// Counts as transmitted.
    pub raw: i64,
    /// Factor to the unit.
    pub scale: Scale,
    /// Engineering unit, empty if it has none.
    pub unit: &'static str,
    /// How far to rely on it.
    pub quality: Quality,
}

impl Number {
    /// The value for a plot.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.scale.to_f64(self.raw)
    }

    /// The value with its unit: `21.5 °C`.
    #[must_use]
    pub fn text(self) -> String {
        let value = self.scale.apply(self.raw);
        if self.unit.is_empty() {
            value.to_string()
        } else {
            format!("{value} {}", self.unit)
        }
    }
}

/// A record of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct LogRecord {
    /// Its place in the response, from 0.
    pub index: u16,
    /// Its number in the log; 16 bits that wrap in the movement log (reading B14).
    pub id: u32,
    /// When it happened.
    pub time: Stamp,
    /// NE 107 category of an event, as transmitted.
    pub category: Option<u16>,
    /// What happened.
    pub text: String,
    /// The values at that time.
    pub numbers: Vec<(&'static Field, Number)>,
}

/// The registers of a response, decoded.
#[derive(Clone, Debug)]
pub struct ObjectRead {
    /// What was asked for.
    pub request: Request,
    /// The object, if the manual has it.
    pub object: Option<&'static Object>,
    /// The option, if the object has it.
    pub choice: Option<&'static Choice>,
    /// What the registers were taken for.
    pub layout: Option<&'static Layout>,
    /// How the layout was chosen, in words.
    pub why: String,
    /// The code, if the response is an error.
    pub error: Option<u16>,
    /// The settings behind its values that no profile sets, each once.
    pub assumed: Vec<Setting>,
    /// The registers as received.
    pub words: Vec<u16>,
    /// The tree; its bytes are the registers, high byte first.
    pub decoded: Decoded,
    names: [Vec<BitLabel>; 2],
}

impl ObjectRead {
    /// Decodes the registers of a response. Any registers give a tree; what does not fit is a
    /// problem, and nothing is left out.
    #[must_use]
    pub fn read(request: Request, words: &[u16], profile: &Profile) -> Self {
        let chosen = choose::choose(request, words.len(), profile);
        let mut read = Self::new(request, words);
        read.object = chosen.object;
        read.choice = chosen.choice;
        read.layout = chosen.layout;
        read.why = chosen.why;
        if chosen.error {
            read.error = words.first().copied();
        }
        read.fill(profile);
        read
    }

    /// Decodes the registers of a response whose status was Error: the first is an error code.
    #[must_use]
    pub fn error(request: Request, words: &[u16], profile: &Profile) -> Self {
        let mut read = Self::new(request, words);
        let found = request.find(profile);
        read.object = super::object(request.object());
        read.choice = found.map(|(_, choice)| choice);
        read.error = words.first().copied();
        "The status is Error, so the first register is an error code.".clone_into(&mut read.why);
        read.fill(profile);
        read
    }

    /// Every request whose response can have this number of registers, with the options of the
    /// default profile.
    pub fn candidates(words: usize) -> impl Iterator<Item = Candidate> {
        choose::candidates(words)
    }

    fn new(request: Request, words: &[u16]) -> Self {
        Self {
            request,
            object: None,
            choice: None,
            layout: None,
            why: String::new(),
            error: None,
            assumed: Vec::new(),
            words: words.to_vec(),
            decoded: Decoded::default(),
            names: [Vec::new(), Vec::new()],
        }
    }

    fn fill(&mut self, profile: &Profile) {
        let mut writer = fields::Writer::new(&mut self.decoded, self.request, &self.words, profile);
        match (self.error, self.layout) {
            (Some(_), _) => writer.error(),
            (None, Some(layout)) => writer.layout(layout),
            (None, None) => writer.unknown(),
        }
        self.assumed = self.assumptions(profile);
        for (word, names) in [BitWord::Alarms, BitWord::Warnings]
            .into_iter()
            .zip(&mut self.names)
        {
            *names = (0..32).map(|bit| profile.bit(word, bit)).collect();
        }
    }

    /// Which settings its values rest on without a profile that says so.
    fn assumptions(&self, profile: &Profile) -> Vec<Setting> {
        let mut assumed: Vec<Setting> = Vec::new();
        let mut add = |setting: Setting| {
            if profile.is_assumed(setting) && !assumed.contains(&setting) {
                assumed.push(setting);
            }
        };
        if self.choice.is_some_and(|choice| choice.command.is_some()) {
            add(Setting::LogCommands);
        }
        for field in self.decoded.fields() {
            let Name::Dop(def, _) = field.name else {
                continue;
            };
            match def.kind {
                FieldKind::U32 | FieldKind::S32 => add(Setting::LowWordFirst),
                FieldKind::Time => {
                    add(Setting::LowWordFirst);
                    add(Setting::TimeEpoch);
                    add(Setting::TimeUnit);
                }
                FieldKind::Text(_) => add(Setting::TextLowByteFirst),
                FieldKind::U16 | FieldKind::S16 => {}
            }
            if let Some(setting) = def.setting {
                add(setting);
            }
        }
        assumed
    }

    /// The readings that concern request and layout, each once; those of fields are at the fields.
    pub fn readings(&self) -> impl Iterator<Item = &'static Reading> {
        let of_object = self.object.into_iter();
        let of_object = of_object.flat_map(|o| o.reading.into_iter().chain(o.also.iter().copied()));
        let of_choice = self.choice.and_then(|choice| choice.reading);
        let of_layout = self.layout.and_then(|layout| layout.reading);
        of_choice
            .into_iter()
            .chain(of_layout.filter(move |l| of_choice.is_none_or(|c| c.id != l.id)))
            .chain(of_object)
    }

    /// The fields with this key: index, unit from the name, value, quality.
    fn items<'a>(
        &'a self,
        key: &'a str,
    ) -> impl Iterator<Item = (&'static Field, u16, Value, Quality)> + 'a {
        self.decoded
            .fields()
            .iter()
            .filter_map(move |field| match field.name {
                Name::Dop(def, index) if def.key == key => {
                    Some((def, index, field.value, field.quality))
                }
                _ => None,
            })
    }

    /// A number: a count, a code or a word of bits as well.
    #[must_use]
    pub fn number(&self, key: &str) -> Option<Number> {
        self.items(key)
            .find_map(|(def, _, value, quality)| number(def, value, quality))
    }

    /// The valid numbers of an array, in the order of the registers (reading C19).
    #[must_use]
    pub fn series(&self, key: &str) -> Vec<Number> {
        self.items(key)
            .filter_map(|(def, _, value, quality)| number(def, value, quality))
            .collect()
    }

    /// A time.
    #[must_use]
    pub fn time(&self, key: &str) -> Option<Stamp> {
        self.times(key).into_iter().next()
    }

    /// The valid times of an array, in the order of the registers.
    #[must_use]
    pub fn times(&self, key: &str) -> Vec<Stamp> {
        self.items(key)
            .filter_map(|(_, _, value, _)| stamp(value))
            .collect()
    }

    /// A value in words.
    #[must_use]
    pub fn text(&self, key: &str) -> Option<String> {
        let named = |name: Name| matches!(name, Name::Dop(def, _) if def.key == key);
        let field = self.decoded.fields().iter().find(|f| named(f.name))?;
        Some(match field.value {
            Value::Unavailable("empty") => String::new(),
            _ => self.decoded.text(field),
        })
    }

    /// The definition of a field of this layout.
    #[must_use]
    pub fn field(&self, key: &str) -> Option<&'static Field> {
        self.layout?.field(key)
    }

    /// The bits of a word of alarms or warnings that are set, as the site calls them.
    #[must_use]
    pub fn active(&self, key: &str) -> Vec<BitLabel> {
        let raw = self.number(key).map_or(0, |number| number.raw);
        let names = match key {
            "alarms" => self.names.first(),
            "warnings" => self.names.get(1),
            _ => None,
        };
        names
            .into_iter()
            .flatten()
            .filter(|name| raw.wrapping_shr(u32::from(name.bit)) & 1 != 0)
            .cloned()
            .collect()
    }

    /// The records of a log, as many as the response says and has.
    #[must_use]
    pub fn records(&self) -> Vec<LogRecord> {
        let mut records: Vec<LogRecord> = Vec::new();
        for field in self.decoded.fields() {
            let Name::Dop(def, index) = field.name else {
                continue;
            };
            if !def.record {
                continue;
            }
            if records.last().is_none_or(|last| last.index != index) {
                records.push(LogRecord {
                    index,
                    id: 0,
                    time: Stamp::Never,
                    category: None,
                    text: String::new(),
                    numbers: Vec::new(),
                });
            }
            let Some(record) = records.last_mut() else {
                continue;
            };
            match (def.part, field.value) {
                (Part::Id, Value::Number { raw, .. }) => {
                    record.id = u32::try_from(raw).unwrap_or(0);
                }
                (Part::Category, Value::Code { raw, .. }) => {
                    record.category = u16::try_from(raw).ok();
                }
                (_, Value::Text) => record.text = self.decoded.text(field),
                (_, value) => {
                    if let Some(stamp) = stamp(value)
                        && def.kind == FieldKind::Time
                    {
                        record.time = stamp;
                    } else if let Some(number) = number(def, value, field.quality) {
                        record.numbers.push((def, number));
                    }
                }
            }
        }
        records
    }

    /// How many times in it are possible for such a unit, and how many there are: tells which
    /// of several candidates is the likely one.
    #[must_use]
    pub fn plausible_times(&self) -> (usize, usize) {
        let times = self
            .decoded
            .fields()
            .iter()
            .filter_map(|field| match field.value {
                Value::Stamp(_) => Some(field.quality != Quality::OutOfRange),
                _ => None,
            });
        times.fold((0, 0), |(good, all), is_good| {
            (
                good.saturating_add(usize::from(is_good)),
                all.saturating_add(1),
            )
        })
    }
}

fn number(def: &'static Field, value: Value, quality: Quality) -> Option<Number> {
    let (raw, scale) = match value {
        Value::Number { raw, scale } => (raw, scale),
        Value::Code { raw, .. } | Value::Flags { raw, .. } => (i64::from(raw), Scale::ONE),
        _ => return None,
    };
    Some(Number {
        raw,
        scale,
        unit: def.unit,
        quality,
    })
}

fn stamp(value: Value) -> Option<Stamp> {
    match value {
        Value::Stamp(seconds) => Some(Stamp::of(seconds)),
        Value::Unavailable(values::NEVER) => Some(Stamp::Never),
        _ => None,
    }
}
