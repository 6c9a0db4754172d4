//! The objects as text for tools and people, and a decoded object as the command line prints it.

use core::fmt::{self, Write};

use super::object::{Choice, Field, Layout, Object};
use super::profile::Profile;
use super::read::ObjectRead;
use super::{Candidate, OBJECTS};
use crate::json::{self, Quoted};
use crate::map::row::Reading;

/// One line of the list of all fields: an object, an option, a layout of it and a field of that.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// The object.
    pub object: &'static Object,
    /// The option.
    pub choice: &'static Choice,
    /// The layout; not the recommended one if a count can choose another.
    pub layout: &'static Layout,
    /// The field.
    pub field: &'static Field,
}

/// Every field of every option, in the order of the requests. With `others`, also those of the
/// layouts that a number of registers can choose.
pub fn lines(others: bool) -> impl Iterator<Item = Line> {
    OBJECTS.iter().flat_map(move |object| {
        object.options.iter().flat_map(move |choice| {
            let layouts = if others { usize::MAX } else { 1 };
            choice.layouts().take(layouts).flat_map(move |layout| {
                layout.fields.iter().map(move |field| Line {
                    object,
                    choice,
                    layout,
                    field,
                })
            })
        })
    })
}

impl Line {
    /// The line as a JSON object.
    ///
    /// # Errors
    /// Only if writing fails.
    pub fn write_json(&self, out: &mut impl Write) -> fmt::Result {
        let Self {
            object,
            choice,
            layout,
            field,
        } = self;
        let request = object.request(choice, &Profile::default());
        write!(
            out,
            r#"{{"device":"dop","object":{},"option":{},"request":"{request}","offset":{},"count":{},"type":"{}","key":{},"label":{},"unit":{},"scale":"{}","source":{},"trust":"{}""#,
            object.id,
            choice.option,
            field.at,
            field.count,
            field.kind.key(),
            Quoted(field.key),
            Quoted(field.label),
            Quoted(field.unit),
            field.scale,
            Quoted(&field.source.to_string()),
            field.trust.key(),
        )?;
        write!(
            out,
            r#","words":{},"layout":{},"recommended":{}"#,
            field.kind.words(),
            Quoted(layout.key),
            core::ptr::eq(*layout, choice.layout),
        )?;
        if let (true, Some(record)) = (field.record, layout.record) {
            write!(out, r#","stride":{},"max":{}"#, record.stride, record.max)?;
        }
        out.write_str(r#","readings":["#)?;
        write_readings(out, self.readings())?;
        write!(out, r#"],"note":{}}}"#, Quoted(field.note))
    }

    /// All readings that concern the line: of field, layout, option and object.
    pub fn readings(&self) -> impl Iterator<Item = &'static Reading> {
        let object = self.object;
        self.field
            .readings()
            .chain(self.layout.reading)
            .chain(self.choice.reading)
            .chain(object.reading)
            .chain(object.also.iter().copied())
    }

    /// The line as a CSV line, columns as in [`CSV_HEADER`].
    ///
    /// # Errors
    /// Only if writing fails.
    pub fn write_csv(&self, out: &mut impl Write) -> fmt::Result {
        let record = self.layout.record.filter(|_| self.field.record);
        let readings: Vec<&str> = self.readings().map(|reading| reading.id).collect();
        let cells = [
            "dop".to_owned(),
            self.object.id.to_string(),
            self.choice.option.to_string(),
            self.object
                .request(self.choice, &Profile::default())
                .to_string(),
            self.layout.key.to_owned(),
            self.field.at.to_string(),
            self.field.count.to_string(),
            self.field.kind.key().to_owned(),
            self.field.key.to_owned(),
            self.field.label.to_owned(),
            self.field.unit.to_owned(),
            self.field.scale.to_string(),
            record.map_or_else(String::new, |r| r.stride.to_string()),
            record.map_or_else(String::new, |r| r.max.to_string()),
            self.field.source.to_string(),
            self.field.trust.key().to_owned(),
            readings.join(" "),
        ];
        for (at, cell) in cells.iter().enumerate() {
            if at > 0 {
                out.write_char(',')?;
            }
            out.write_str(&crate::map::export::csv_cell(cell))?;
        }
        Ok(())
    }

    /// The line as aligned columns for people.
    ///
    /// # Errors
    /// Only if writing fails.
    pub fn write_text(&self, out: &mut impl Write) -> fmt::Result {
        let field = self.field;
        let count = if field.count > 1 {
            format!("x{}", field.count)
        } else {
            String::new()
        };
        write!(
            out,
            "{:>5} {:<5} {count:<5} {:<52} {:<9} {:<7} {}",
            field.at,
            field.kind.key(),
            field.label,
            field.unit,
            field.scale.to_string(),
            field.source
        )?;
        if let Some(reading) = field.reading {
            write!(out, " ({})", reading.id)?;
        }
        Ok(())
    }
}

/// The first line of a CSV file of lines.
pub const CSV_HEADER: &str = "device,object,option,request,layout,offset,count,type,key,label,\
unit,scale,stride,max,source,trust,readings";

/// A decoded object as one JSON object; `index` counts the objects of an output.
///
/// # Errors
/// Only if writing fails.
pub fn write_object(out: &mut impl Write, index: u32, read: &ObjectRead) -> fmt::Result {
    write!(
        out,
        r#"{{"kind":"object","index":{index},"request":"{}","object":{},"option":{},"label":{},"option_label":{},"words":{},"layout":"#,
        read.request,
        read.request.object(),
        read.request.option(),
        optional(read.object.map(|object| object.label)),
        optional(read.choice.map(|choice| choice.label)),
        read.words.len(),
    )?;
    write!(
        out,
        r#"{},"why":{},"error":"#,
        optional(read.layout.map(|layout| layout.key)),
        Quoted(&read.why)
    )?;
    match read.error {
        Some(code) => write!(out, "{code}")?,
        None => out.write_str("null")?,
    }
    out.write_str(r#","assumed":["#)?;
    for (at, setting) in read.assumed.iter().enumerate() {
        let comma = if at > 0 { "," } else { "" };
        write!(out, r#"{comma}"{}""#, setting.key())?;
    }
    out.write_str(r#"],"readings":["#)?;
    write_readings(out, read.readings())?;
    write!(out, r#"],"ok":{},"fields":["#, read.decoded.is_ok())?;
    for (id, field) in read.decoded.iter() {
        if id.get() > 0 {
            out.write_char(',')?;
        }
        json::write_field(out, 0, &read.decoded, id, field)?;
    }
    out.write_str(r#"],"problems":["#)?;
    for (at, problem) in read.decoded.problems().iter().enumerate() {
        if at > 0 {
            out.write_char(',')?;
        }
        json::write_problem(out, problem, u64::from(problem.place.start))?;
    }
    out.write_str("]}")
}

/// The requests that so many registers can answer, as one JSON object.
///
/// # Errors
/// Only if writing fails.
pub fn write_candidates(out: &mut impl Write, words: &[u16]) -> fmt::Result {
    write!(
        out,
        r#"{{"kind":"candidates","words":{},"candidates":["#,
        words.len()
    )?;
    for (at, candidate) in ObjectRead::candidates(words.len()).enumerate() {
        let Candidate {
            request,
            object,
            choice,
            layout,
        } = candidate;
        let comma = if at > 0 { "," } else { "" };
        write!(
            out,
            r#"{comma}{{"request":"{request}","object":{},"option":{},"label":{},"option_label":{},"layout":{}}}"#,
            object.id,
            choice.option,
            Quoted(object.label),
            Quoted(choice.label),
            Quoted(layout.key)
        )?;
    }
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
    write!(out, r#"],"raw":"{}"}}"#, crate::render::hex(&bytes))
}

/// Readings as JSON objects with commas between them.
fn write_readings(
    out: &mut impl Write,
    readings: impl Iterator<Item = &'static Reading>,
) -> fmt::Result {
    for (at, reading) in readings.enumerate() {
        let comma = if at > 0 { "," } else { "" };
        write!(
            out,
            r#"{comma}{{"id":"{}","settled":"{}","text":{}}}"#,
            reading.id,
            reading.settled.key(),
            Quoted(reading.text)
        )?;
    }
    Ok(())
}

fn optional(text: Option<&str>) -> String {
    text.map_or_else(|| "null".to_owned(), |text| Quoted(text).to_string())
}
