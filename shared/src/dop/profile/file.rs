//! A profile to and from JSON, key by key.
//!
//! The types have derived serializers, too. In a page these would be a tenth of the program, and
//! the check has seen to every type and range before anything is read here.

use core::fmt::Write as _;

use serde_json::Value;

use super::parts::{
    BitName, Log, Ne107, ReadTable, Reading, Registers, Scales, Status, Temperature, Time,
    TimeUnit, Words,
};
use super::{FORMAT, Profile, VERSION};

/// A profile from a value that passed the check.
pub(super) fn read(value: &Value) -> Profile {
    let text = |name: &str| value.get(name).and_then(Value::as_str);
    let registers = Part(value.get("registers"));
    let words = Part(value.get("words"));
    let time = Part(value.get("time"));
    let scales = Part(value.get("scales"));
    let log = Part(value.get("log"));
    let reading = Part(value.get("reading"));
    Profile {
        format: text("format").map(str::to_owned),
        version: Part(Some(value)).number("version"),
        name: text("name").unwrap_or_default().to_owned(),
        registers: Registers {
            request: registers.number("request"),
            indicators: registers.number("indicators"),
            status: registers.number("status"),
            count: registers.number("count"),
            response: registers.number("response"),
        },
        table: match text("table") {
            Some("holding") => Some(ReadTable::Holding),
            Some("input") => Some(ReadTable::Input),
            _ => None,
        },
        request_function: Part(Some(value)).number("request_function"),
        status: Status {
            shift: Part(value.get("status")).number("shift"),
        },
        words: Words {
            low_word_first: words.truth("low_word_first"),
            text_low_byte_first: words.truth("text_low_byte_first"),
            byte_swap: words.truth("byte_swap"),
        },
        time: Time {
            epoch: time.get("epoch").and_then(Value::as_i64),
            unit: match time.get("unit").and_then(Value::as_str) {
                Some("s") => Some(TimeUnit::S),
                Some("ms") => Some(TimeUnit::Ms),
                _ => None,
            },
        },
        temperature: match text("temperature") {
            Some("degC") => Some(Temperature::DegC),
            Some("degF") => Some(Temperature::DegF),
            _ => None,
        },
        scales: Scales {
            dst_trend: scales.number("dst_trend"),
            dst_statistics: scales.number("dst_statistics"),
            movement_position: scales.number("movement_position"),
            movement_speed: scales.number("movement_speed"),
            movement_torque: scales.number("movement_torque"),
        },
        log: Log {
            newest: log.number("newest"),
            oldest: log.number("oldest"),
            older: log.number("older"),
            newer: log.number("newer"),
            present: log.number("present"),
        },
        reading: Reading {
            max_registers: reading.number("max_registers"),
            poll_ms: reading.number("poll_ms"),
            timeout_ms: reading.number("timeout_ms"),
            retries: reading.number("retries"),
            log_limit: reading.number("log_limit"),
        },
        indicators: bits(value, "indicators"),
        alarms: bits(value, "alarms"),
        warnings: bits(value, "warnings"),
    }
}

/// A section of the file, if it is there.
#[derive(Clone, Copy)]
struct Part<'a>(Option<&'a Value>);

impl<'a> Part<'a> {
    fn get(self, name: &str) -> Option<&'a Value> {
        self.0?.get(name)
    }

    fn number<T: TryFrom<u64>>(self, name: &str) -> Option<T> {
        T::try_from(self.get(name)?.as_u64()?).ok()
    }

    fn truth(self, name: &str) -> Option<bool> {
        self.get(name)?.as_bool()
    }
}

fn bits(value: &Value, name: &str) -> Vec<BitName> {
    let list = value.get(name).and_then(Value::as_array);
    let bit = |entry: &Value| {
        let entry = Part(Some(entry));
        Some(BitName {
            bit: entry.number("bit")?,
            name: entry.get("name")?.as_str()?.to_owned(),
            ne107: match entry.get("ne107").and_then(Value::as_str) {
                Some("F") => Some(Ne107::Failure),
                Some("C") => Some(Ne107::CheckFunction),
                Some("S") => Some(Ne107::OutOfSpecification),
                Some("M") => Some(Ne107::Maintenance),
                _ => None,
            },
        })
    };
    list.map_or_else(Vec::new, |list| list.iter().filter_map(bit).collect())
}

/// The file of a profile: only what is set, with format and version.
pub(super) fn write(profile: &Profile) -> String {
    let mut out = Writer::default();
    out.open('{');
    out.text("format", FORMAT);
    out.number("version", Some(VERSION));
    if !profile.name.is_empty() {
        out.text("name", &profile.name);
    }
    let areas = profile.registers;
    out.section(
        "registers",
        &[
            ("request", areas.request.map(i64::from)),
            ("indicators", areas.indicators.map(i64::from)),
            ("status", areas.status.map(i64::from)),
            ("count", areas.count.map(i64::from)),
            ("response", areas.response.map(i64::from)),
        ],
    );
    match profile.table {
        Some(ReadTable::Holding) => out.text("table", "holding"),
        Some(ReadTable::Input) => out.text("table", "input"),
        None => {}
    }
    out.number("request_function", profile.request_function);
    out.section("status", &[("shift", profile.status.shift.map(i64::from))]);
    let words = profile.words;
    if words != Words::default() {
        out.key("words");
        out.open('{');
        for (name, value) in [
            ("low_word_first", words.low_word_first),
            ("text_low_byte_first", words.text_low_byte_first),
            ("byte_swap", words.byte_swap),
        ] {
            if let Some(value) = value {
                out.key(name);
                out.out.push_str(if value { "true" } else { "false" });
            }
        }
        out.close('}');
    }
    if profile.time != Time::default() {
        out.key("time");
        out.open('{');
        out.number("epoch", profile.time.epoch);
        match profile.time.unit {
            Some(TimeUnit::S) => out.text("unit", "s"),
            Some(TimeUnit::Ms) => out.text("unit", "ms"),
            None => {}
        }
        out.close('}');
    }
    match profile.temperature {
        Some(Temperature::DegC) => out.text("temperature", "degC"),
        Some(Temperature::DegF) => out.text("temperature", "degF"),
        None => {}
    }
    let scales = profile.scales;
    out.section(
        "scales",
        &[
            ("dst_trend", scales.dst_trend.map(i64::from)),
            ("dst_statistics", scales.dst_statistics.map(i64::from)),
            ("movement_position", scales.movement_position.map(i64::from)),
            ("movement_speed", scales.movement_speed.map(i64::from)),
            ("movement_torque", scales.movement_torque.map(i64::from)),
        ],
    );
    let log = profile.log;
    out.section(
        "log",
        &[
            ("newest", log.newest.map(i64::from)),
            ("oldest", log.oldest.map(i64::from)),
            ("older", log.older.map(i64::from)),
            ("newer", log.newer.map(i64::from)),
            ("present", log.present.map(i64::from)),
        ],
    );
    let reading = profile.reading;
    out.section(
        "reading",
        &[
            ("max_registers", reading.max_registers.map(i64::from)),
            ("poll_ms", reading.poll_ms.map(i64::from)),
            ("timeout_ms", reading.timeout_ms.map(i64::from)),
            ("retries", reading.retries.map(i64::from)),
            ("log_limit", reading.log_limit.map(i64::from)),
        ],
    );
    out.bits("indicators", &profile.indicators);
    out.bits("alarms", &profile.alarms);
    out.bits("warnings", &profile.warnings);
    out.close('}');
    out.out
}

/// JSON in lines, two blanks deeper for each bracket.
#[derive(Default)]
struct Writer {
    out: String,
    depth: usize,
    /// True if something stands before what comes next in the same bracket.
    follows: bool,
}

impl Writer {
    fn line(&mut self) {
        self.out.push('\n');
        for _ in 0..self.depth {
            self.out.push_str("  ");
        }
    }

    fn item(&mut self) {
        if self.follows {
            self.out.push(',');
        }
        self.follows = true;
        self.line();
    }

    fn open(&mut self, bracket: char) {
        self.out.push(bracket);
        self.depth = self.depth.saturating_add(1);
        self.follows = false;
    }

    fn close(&mut self, bracket: char) {
        self.depth = self.depth.saturating_sub(1);
        self.line();
        self.out.push(bracket);
        self.follows = true;
    }

    fn key(&mut self, name: &str) {
        self.item();
        // Writing to a String cannot fail.
        let _infallible = write!(self.out, "\"{name}\": ");
    }

    fn number<T: Into<i64>>(&mut self, name: &str, value: Option<T>) {
        if let Some(value) = value {
            self.key(name);
            let value: i64 = value.into();
            let _infallible = write!(self.out, "{value}");
        }
    }

    fn text(&mut self, name: &str, text: &str) {
        self.key(name);
        self.out.push('"');
        for c in text.chars() {
            match c {
                '"' => self.out.push_str("\\\""),
                '\\' => self.out.push_str("\\\\"),
                '\n' => self.out.push_str("\\n"),
                '\r' => self.out.push_str("\\r"),
                '\t' => self.out.push_str("\\t"),
                c if c < ' ' => {
                    let _infallible = write!(self.out, "\\u{:04x}", u32::from(c));
                }
                c => self.out.push(c),
            }
        }
        self.out.push('"');
    }

    fn section(&mut self, name: &str, members: &[(&str, Option<i64>)]) {
        if members.iter().all(|(_, value)| value.is_none()) {
            return;
        }
        self.key(name);
        self.open('{');
        for (name, value) in members {
            self.number(name, *value);
        }
        self.close('}');
    }

    fn bits(&mut self, name: &str, bits: &[BitName]) {
        if bits.is_empty() {
            return;
        }
        self.key(name);
        self.open('[');
        for bit in bits {
            self.item();
            self.open('{');
            self.number("bit", Some(bit.bit));
            self.text("name", &bit.name);
            if let Some(category) = bit.ne107 {
                self.text("ne107", category.letter());
            }
            self.close('}');
        }
        self.close(']');
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every key there is, with values that are not the defaults.
    const FULL: &str = r#"{"format":"valvescope-dop-profile","version":1,"name":"A \"1\"\n\u0001é",
        "registers":{"request":1,"indicators":2,"status":3,"count":4,"response":5},
        "table":"input","request_function":16,"status":{"shift":13},
        "words":{"low_word_first":false,"text_low_byte_first":true,"byte_swap":true},
        "time":{"epoch":-62135596800,"unit":"ms"},"temperature":"degF",
        "scales":{"dst_trend":10,"dst_statistics":100,"movement_position":10,
            "movement_speed":100,"movement_torque":1000},
        "log":{"newest":9,"oldest":8,"older":7,"newer":6,"present":5},
        "reading":{"max_registers":60,"poll_ms":100,"timeout_ms":5000,"retries":1,"log_limit":50},
        "indicators":[{"bit":63,"name":"a","ne107":"F"},{"bit":0,"name":"b"}],
        "alarms":[{"bit":1,"name":"c","ne107":"C"}],
        "warnings":[{"bit":2,"name":"d","ne107":"S"},{"bit":3,"name":"e","ne107":"M"}]}"#;

    /// By hand and derived, both ways.
    #[test]
    fn no_key_is_forgotten() {
        for text in [
            FULL,
            "{}",
            r#"{"registers":{"status":7},"time":{"unit":"s"}}"#,
        ] {
            let value: Value = serde_json::from_str(text).unwrap();
            let profile = read(&value);
            let derived: Profile = serde_json::from_value(value).unwrap();
            assert_eq!(profile, derived);
            let mut file = derived;
            file.format = Some(FORMAT.to_owned());
            file.version = Some(VERSION);
            assert_eq!(
                write(&profile),
                serde_json::to_string_pretty(&file).unwrap()
            );
        }
    }
}
