//! Records → Rust source of static tables. The rules hold by now, so every lookup succeeds.

use std::fmt::{self, Write};

use toml::Spanned;

use super::data::{Command, Data, Field, Form, Forms, Kind, Part, Sourced};
use crate::types::{Doc, SETTLED, Word};

/// The text of `hart.rs`.
pub fn emit(data: &Data, docs: &[Doc]) -> String {
    let mut out = String::from("// Written by shared/build.rs from shared/data/hart.\n\n");
    let emitter = Emitter { data, docs };
    // Writing to a String cannot fail.
    let _ = emitter.all(&mut out);
    out
}

/// Writes the tables.
pub(super) struct Emitter<'a> {
    pub data: &'a Data,
    docs: &'a [Doc],
}

pub(super) fn screaming(key: &str) -> String {
    key.to_ascii_uppercase()
}

/// `reads` → `Reads`, the variant of an enumeration.
pub(super) fn variant(key: &str) -> String {
    let (first, rest) = key.split_at_checked(1).unwrap_or((key, ""));
    format!("{}{rest}", first.to_ascii_uppercase())
}

pub(super) fn word(words: &[Word], key: &str) -> &'static str {
    words.iter().find(|w| w.0 == key).map_or("", |w| w.1)
}

pub(super) fn part(table: u8, page: Option<u16>) -> String {
    page.map_or(format!("table {table}"), |page| {
        format!("table {table}, p. {page}")
    })
}

impl Emitter<'_> {
    fn doc(&self, key: &str) -> &str {
        let doc = self.docs.iter().find(|d| d.key == key);
        doc.map_or("", |d| d.name.as_str())
    }

    pub fn source(&self, doc: &str, part: &str) -> String {
        format!("Source {{ doc: {:?}, part: {part:?} }}", self.doc(doc))
    }

    pub fn reading(&self, id: &str) -> String {
        let at = self.data.readings.iter().position(|(_, r)| r.id == id);
        at.map_or("None".to_owned(), |at| format!("Some(&READINGS[{at}])"))
    }

    fn all_readings(&self, ids: &[String]) -> String {
        let all = ids.iter().filter_map(|id| {
            let at = self.data.readings.iter().position(|(_, r)| r.id == *id)?;
            Some(format!("&READINGS[{at}]"))
        });
        format!("&[{}]", all.collect::<Vec<_>>().join(", "))
    }

    fn all(&self, out: &mut String) -> fmt::Result {
        writeln!(out, "/// The document of the fields around the data.")?;
        writeln!(
            out,
            "pub(crate) const LINK: &str = {:?};\n",
            self.doc("hart-link")
        )?;
        writeln!(out, "/// The document of HART-IP.")?;
        writeln!(
            out,
            "pub(crate) const IP: &str = {:?};\n",
            self.doc("hart-ip")
        )?;
        writeln!(out, "/// All readings of the manual and the standard.")?;
        let count = self.data.readings.len();
        writeln!(out, "pub static READINGS: [Reading; {count}] = [")?;
        for (_, reading) in &self.data.readings {
            writeln!(
                out,
                "    Reading {{ id: {:?}, settled: Settled::{}, text: {:?} }},",
                reading.id,
                word(SETTLED, &reading.settled),
                reading.text
            )?;
        }
        writeln!(out, "];\n")?;
        self.sets(out)?;
        self.additional(out)?;
        self.tables(out)?;
        self.commands(out)
    }

    fn tables(&self, out: &mut String) -> fmt::Result {
        let data = self.data;
        for (_, file) in &data.files {
            let name = screaming(file.file.trim_end_matches(".csv"));
            let source = self.source(&file.doc, &file.part);
            writeln!(out, "/// Where the lines of `{}` come from.", file.file)?;
            writeln!(out, "pub const {name}_SOURCE: Source = {source};\n")?;
        }
        writeln!(out, "/// Engineering units, table 2 of the standard.")?;
        writeln!(out, "pub static UNITS: [Unit; {}] = [", data.units.len())?;
        for (_, u) in &data.units {
            writeln!(
                out,
                "    Unit {{ code: {}, class: {}, symbol: {:?}, name: {:?} }},",
                u.code,
                u.classification.unwrap_or(0),
                u.symbol,
                u.name
            )?;
        }
        let count = data.responses.len();
        writeln!(out, "];\n\n/// Response codes by class.")?;
        writeln!(out, "pub static CODES: [Codes; {count}] = [")?;
        for (_, c) in &data.responses {
            writeln!(
                out,
                "    Codes {{ first: {}, last: {}, class: Class::{}, label: {:?}, reading: {} }},",
                c.first,
                c.last,
                variant(&c.class),
                c.label,
                self.reading(&c.reading)
            )?;
        }
        let count = data.timers.len();
        writeln!(out, "];\n\n/// Times of the link at 1200 bit/s.")?;
        writeln!(out, "pub static TIMERS: [Timer; {count}] = [")?;
        for (_, t) in &data.timers {
            writeln!(
                out,
                "    Timer {{ key: {:?}, label: {:?}, characters: {}, note: {:?}, reading: {} }},",
                t.key,
                t.label,
                t.characters,
                t.note,
                self.reading(&t.reading)
            )?;
        }
        writeln!(out, "];\n")?;
        self.presets(out)
    }

    fn presets(&self, out: &mut String) -> fmt::Result {
        let mut keys: Vec<&str> = Vec::new();
        for (_, preset) in &self.data.presets {
            if !keys.contains(&preset.preset.as_str()) {
                keys.push(&preset.preset);
            }
        }
        writeln!(
            out,
            "/// Examples of the manual for the condensed status map."
        )?;
        writeln!(out, "pub static PRESETS: [Preset; {}] = [", keys.len())?;
        for key in keys {
            let lines = self.data.presets.iter().map(|(_, p)| p);
            let lines: Vec<_> = lines.filter(|p| p.preset == key).collect();
            let Some(first) = lines.first() else { continue };
            writeln!(
                out,
                "    Preset {{ key: {key:?}, label: {:?}, family: Family::{}, bits: &[",
                first.label,
                variant(&first.family)
            )?;
            for p in &lines {
                writeln!(
                    out,
                    "        Mapped {{ byte: {}, bit: {}, category: {}, printed: {:?}, source: {}, reading: {} }},",
                    p.byte,
                    p.bit,
                    p.category,
                    p.printed,
                    self.source("rotork-hart", &part(p.table, Some(p.page))),
                    self.reading(&p.reading)
                )?;
            }
            writeln!(out, "    ] }},")?;
        }
        writeln!(out, "];\n")
    }

    fn commands(&self, out: &mut String) -> fmt::Result {
        let data = self.data;
        let status = [
            ("process_data", "Process data", 7, 6, "enum:dv_process_data"),
            ("limit", "Limit", 5, 4, "enum:dv_limit"),
            ("more", "More status available", 3, 3, "u8"),
            ("family", "Family status", 2, 0, "u8"),
        ];
        let source = self.source("hart-universal", "device variable status");
        writeln!(out, "/// The parts of a device variable status.")?;
        writeln!(out, "pub static VARIABLE_STATUS: [Part; 4] = [")?;
        for (key, label, high, low, kind) in status {
            let part = Part {
                key: key.to_owned(),
                label: label.to_owned(),
                high,
                low,
                kind: kind.to_owned(),
            };
            writeln!(out, "    {},", self.part(&part, &source))?;
        }
        let mut all: Vec<&Command> = data.commands.list.iter().map(Spanned::get_ref).collect();
        all.sort_by_key(|c| c.number);
        writeln!(out, "];\n\n/// All commands, by number.")?;
        writeln!(out, "pub static COMMANDS: [Command; {}] = [", all.len())?;
        for command in all {
            self.command(command, out)?;
        }
        writeln!(out, "];")
    }

    fn command(&self, c: &Command, out: &mut String) -> fmt::Result {
        let own_part = match (&c.part, c.table, c.page) {
            (Some(part), ..) => part.clone(),
            (None, Some(table), page) if c.layout == "rotork-hart" => part(table, page),
            _ => format!("command {}", c.number),
        };
        let layout = self.source(&c.layout, &own_part);
        let listed = match c.table {
            Some(table) => self.source("rotork-hart", &part(table, c.page)),
            None => layout.clone(),
        };
        let families: Vec<_> = c
            .families
            .iter()
            .map(|f| format!("Family::{}", variant(f)))
            .collect();
        writeln!(
            out,
            "    Command {{ number: {}, key: {:?}, label: {:?}, group: Group::{}, effects: {}, \
             families: &[{}], reach: Reach::{},",
            c.number,
            c.key,
            c.label,
            variant(&c.group),
            effects(&c.effect),
            families.join(", "),
            variant(c.address.as_deref().unwrap_or("long")),
        )?;
        for (name, forms) in [("request", &c.request), ("response", &c.response)] {
            writeln!(out, "        {name}: &[")?;
            for form in self.forms(c, forms) {
                self.form(form, &layout, out)?;
            }
            writeln!(out, "        ],")?;
        }
        write!(out, "        codes: &[")?;
        let mut codes: Vec<(u8, &String)> = c
            .codes
            .iter()
            .filter_map(|(code, words)| Some((code.parse().ok()?, words)))
            .collect();
        codes.sort_unstable();
        for (code, words) in codes {
            let sourced = match &c.sourced {
                Sourced::Word(_) => true,
                Sourced::Codes(codes) => codes.contains(&code),
            };
            write!(
                out,
                "Code {{ code: {code}, words: {words:?}, sourced: {sourced} }}, "
            )?;
        }
        writeln!(
            out,
            "], note: {:?}, source: {listed}, readings: {} }},",
            c.note,
            self.all_readings(&c.readings)
        )
    }

    /// The forms themselves, or those that a word refers to.
    fn forms<'a>(&'a self, command: &'a Command, forms: &'a Forms) -> &'a [Form] {
        match forms {
            Forms::Own(forms) => forms,
            Forms::Same(of) if of == "request" => match &command.request {
                Forms::Own(forms) => forms,
                Forms::Same(_) => &[],
            },
            Forms::Same(of) => match self.data.command(of).map(|c| &c.response) {
                Some(Forms::Own(forms)) => forms,
                _ => &[],
            },
        }
    }

    fn form(&self, form: &Form, source: &str, out: &mut String) -> fmt::Result {
        let mut lengths = form.lengths.clone();
        lengths.sort_unstable();
        lengths.reverse();
        let effect = form
            .effect
            .as_ref()
            .map_or("None".to_owned(), |e| format!("Some({})", effects(e)));
        writeln!(
            out,
            "            Form {{ lengths: &{lengths:?}, ends_anywhere: {}, revision: {}, \
             effects: {effect}, readings: {}, items: {} }},",
            form.ends_anywhere,
            form.revision,
            self.all_readings(&form.readings),
            self.items(&form.fields, source)
        )
    }

    fn items(&self, fields: &[Field], source: &str) -> String {
        let items: Vec<_> = fields.iter().map(|f| self.item(f, source)).collect();
        format!("&[{}]", items.join(",\n                "))
    }

    fn item(&self, f: &Field, source: &str) -> String {
        let names = |set: &str| format!("&{}", screaming(set));
        let kind = match Kind::of(&f.kind, f.max) {
            Some(Kind::Unsigned(n)) => format!("Unsigned({n})"),
            Some(Kind::Float) => "Float".to_owned(),
            Some(Kind::Date) => "Date".to_owned(),
            Some(Kind::Time) => "Time".to_owned(),
            Some(Kind::Packed(n)) => format!("Packed({n})"),
            Some(Kind::Latin(n)) => format!("Latin({n})"),
            Some(Kind::Named(n, set)) => format!("Named({n}, {})", names(set)),
            Some(Kind::Bits(n, set)) => format!("Bits({n}, {})", names(set)),
            Some(Kind::Unit) => "Unit".to_owned(),
            Some(Kind::Variable) => "Variable".to_owned(),
            Some(Kind::VariableStatus) => "Split(&VARIABLE_STATUS)".to_owned(),
            Some(Kind::Additional(byte)) => format!("Additional({byte})"),
            Some(Kind::Nibbles(set)) => format!("Nibbles({})", names(set)),
            Some(Kind::Split) => {
                let parts: Vec<_> = f.parts.iter().map(|p| self.part(p, source)).collect();
                format!("Split(&[{}])", parts.join(", "))
            }
            Some(Kind::Repeat(most)) => {
                format!("Repeat({most}, {})", self.items(&f.fields, source))
            }
            Some(Kind::Raw(n)) => format!("Raw({n})"),
            None => String::new(),
        };
        // The limits of repeated fields are in their kind.
        let counted = kind.starts_with("Repeat") || kind.starts_with("Nibbles");
        let range = match (f.min, f.max) {
            (None, None) => "None".to_owned(),
            _ if counted => "None".to_owned(),
            (min, max) => format!("Some(({}, {}))", min.unwrap_or(0), max.unwrap_or(i32::MAX)),
        };
        let trust = if f.readings.is_empty() {
            "Manual"
        } else {
            "Reading"
        };
        format!(
            "Item {{ key: {:?}, label: {:?}, kind: Kind::{kind}, unit: {:?}, by_code: {}, \
             hex: {}, expected: {:?}, range: {range}, source: {source}, trust: Trust::{trust}, \
             readings: {} }}",
            f.key,
            f.label,
            f.unit,
            f.of.is_some(),
            f.hex,
            f.expected,
            self.all_readings(&f.readings)
        )
    }

    fn part(&self, p: &Part, source: &str) -> String {
        let names = p.kind.strip_prefix("enum:");
        let names = names.map_or("None".to_owned(), |set| {
            format!("Some(&{})", screaming(set))
        });
        format!(
            "Part {{ high: {}, low: {}, names: {names}, item: Item {{ key: {:?}, label: {:?}, \
             kind: Kind::Unsigned(1), unit: \"\", by_code: false, hex: false, expected: None, \
             range: None, source: {source}, trust: Trust::Manual, readings: &[] }} }}",
            p.high, p.low, p.key, p.label
        )
    }
}

fn effects(words: &[String]) -> String {
    let all: Vec<_> = words
        .iter()
        .map(|w| format!("Effect::{}", variant(w)))
        .collect();
    format!("&[{}]", all.join(", "))
}
