//! Sets of codes and bits → Rust source.

use std::fmt::{self, Write};

use super::data::{Named, Status};
use super::emit::{Emitter, part, screaming, variant, word};
use super::rules::MAKERS;
use super::status::BYTES;
use crate::types::TRUST;

/// One bit as it is written.
struct Line<'a> {
    bit: u8,
    key: &'a str,
    label: &'a str,
    alias: &'a str,
    alarm: bool,
    states: (&'a str, &'a str),
    source: String,
    trust: &'a str,
    reading: &'a str,
}

impl Emitter<'_> {
    /// Every set, and the manufacturers.
    pub fn sets(&self, out: &mut String) -> fmt::Result {
        for (_, set) in &self.data.sets {
            writeln!(out, "/// {}.", set.label)?;
            if set.kind == "enum" {
                let mut members: Vec<&Named> = self.data.codes.iter().map(|(_, c)| c).collect();
                members.retain(|c| c.set == set.set);
                members.sort_by_key(|c| c.value);
                let members: Vec<_> = members
                    .iter()
                    .map(|c| (c.value, c.key.clone(), c.label.clone()))
                    .collect();
                let source = self.source(&set.doc, &set.part);
                names(out, &set.set, &members, set.tail == "yes", &source)?;
                continue;
            }
            let source = self.source(&set.doc, &set.part);
            let from_sets = self.data.bits.iter().map(|(_, b)| b);
            let mut lines: Vec<Line<'_>> = from_sets
                .filter(|b| b.set == set.set)
                .map(|b| Line {
                    bit: b.bit,
                    key: &b.key,
                    label: &b.label,
                    alias: "",
                    alarm: false,
                    states: states(&b.zero, &b.one),
                    source: source.clone(),
                    trust: if b.reading.is_empty() {
                        "manual"
                    } else {
                        "reading"
                    },
                    reading: &b.reading,
                })
                .collect();
            let status = self.data.status.iter().map(|(_, s)| s);
            lines.extend(
                status
                    .filter(|s| s.part == set.set)
                    .filter_map(|s| self.line(s)),
            );
            self.bits(out, &screaming(&set.set), &set.set, lines)?;
        }
        writeln!(out, "/// Manufacturers.")?;
        let mut makers: Vec<_> = self
            .data
            .makers
            .iter()
            .map(|(_, m)| (m.id, format!("maker_{}", m.id), m.name.clone()))
            .collect();
        makers.sort();
        names(out, MAKERS, &makers, false, "MANUFACTURERS_SOURCE")?;
        for (kind, sort, doc) in [
            ("enum", "Names", "/// Every set of codes."),
            (
                "bits",
                "Bits",
                "/// Every set of bits besides those of the families.",
            ),
        ] {
            let sets = self.data.sets.iter().filter(|(_, s)| s.kind == kind);
            let all: Vec<_> = sets
                .map(|(_, s)| format!("&{}", screaming(&s.set)))
                .collect();
            let name = format!("{}_SETS", screaming(kind));
            writeln!(out, "{doc}")?;
            writeln!(
                out,
                "pub static {name}: [&{sort}; {}] = [{}];\n",
                all.len(),
                all.join(", ")
            )?;
        }
        Ok(())
    }

    fn line<'a>(&self, status: &'a Status) -> Option<Line<'a>> {
        if status.is_reserved() {
            return None;
        }
        Some(Line {
            bit: *status.bits()?.start(),
            key: &status.key,
            label: &status.label,
            alias: &status.alias,
            alarm: status.kind == "alarm",
            states: states("", ""),
            source: self.source(&status.doc, &part(status.table, status.page)),
            trust: &status.trust,
            reading: &status.reading,
        })
    }

    fn bits(
        &self,
        out: &mut String,
        name: &str,
        set: &str,
        mut lines: Vec<Line<'_>>,
    ) -> fmt::Result {
        lines.sort_by_key(|l| l.bit);
        let mask = lines.iter().fold(0_u32, |mask, l| mask | 1 << l.bit);
        writeln!(
            out,
            "pub static {name}: Bits = Bits {{ set: Set {{ name: {set:?}, bits: true, \
             mask: {mask:#x}, members: &["
        )?;
        for l in &lines {
            writeln!(
                out,
                "    Member {{ value: {0}, last: {0}, key: {1:?}, label: {2:?}, states: Some(({3:?}, {4:?})) }},",
                l.bit, l.key, l.label, l.states.0, l.states.1
            )?;
        }
        writeln!(out, "] }}, bits: &[")?;
        for l in &lines {
            writeln!(
                out,
                "    Bit {{ bit: {}, key: {:?}, label: {:?}, alias: {:?}, alarm: {}, \
                 states: ({:?}, {:?}), source: {}, trust: Trust::{}, reading: {} }},",
                l.bit,
                l.key,
                l.label,
                l.alias,
                l.alarm,
                l.states.0,
                l.states.1,
                l.source,
                word(TRUST, l.trust),
                self.reading(l.reading)
            )?;
        }
        writeln!(out, "] }};\n")
    }

    /// The bytes of the device's own status, for every family.
    pub fn additional(&self, out: &mut String) -> fmt::Result {
        let mut table = String::new();
        for (_, family) in &self.data.families {
            let key = &family.key;
            write!(table, "    (Family::{}, [", variant(key))?;
            for byte in 0..BYTES {
                let status = self.data.status.iter().map(|(_, s)| s);
                let own = |s: &&Status| {
                    s.part == "additional" && s.family == *key && s.byte == Some(byte)
                };
                let lines: Vec<_> = status.filter(own).filter_map(|s| self.line(s)).collect();
                if lines.is_empty() {
                    table.push_str("None, ");
                    continue;
                }
                let name = format!("{}_{byte}", screaming(key));
                writeln!(out, "/// Byte {byte} of command 48, {}.", family.name)?;
                self.bits(out, &name, &format!("{key}_{byte}"), lines)?;
                write!(table, "Some(&{name}), ")?;
            }
            table.push_str("]),\n");
        }
        let count = self.data.families.len();
        writeln!(out, "/// The device's own status, by family and byte.")?;
        writeln!(
            out,
            "pub static ADDITIONAL: [(Family, [Option<&Bits>; {BYTES}]); {count}] = [\n{table}];\n"
        )?;
        writeln!(out, "/// What the names of the families stand for.")?;
        writeln!(out, "pub static FAMILIES: [(Family, &str); {count}] = [")?;
        for (_, family) in &self.data.families {
            let (key, range) = (variant(&family.key), &family.range);
            writeln!(out, "    (Family::{key}, {range:?}),")?;
        }
        writeln!(out, "];\n")
    }
}

fn states<'a>(zero: &'a str, one: &'a str) -> (&'a str, &'a str) {
    if zero.is_empty() {
        ("not active", "active")
    } else {
        (zero, one)
    }
}

fn names(
    out: &mut String,
    name: &str,
    members: &[(u16, String, String)],
    tail: bool,
    source: &str,
) -> fmt::Result {
    writeln!(
        out,
        "pub static {}: Names = Names {{ tail: {tail}, source: {source}, set: Set {{ name: {name:?}, bits: false, \
         mask: 0, members: &[",
        screaming(name)
    )?;
    for (value, key, label) in members {
        writeln!(
            out,
            "    Member {{ value: {value}, last: {value}, key: {key:?}, label: {label:?}, states: None }},"
        )?;
    }
    writeln!(out, "] }} }};\n")
}
