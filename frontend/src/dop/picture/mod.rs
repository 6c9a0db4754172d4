//! Pictures of an object: which charts suit it, made from what was decoded.
//!
//! What belongs together is told by the layout (the part that a field plays, what the elements of
//! an array stand for), so no object has code of its own here.

mod axes;
mod bins;
mod stroke;
mod trend;

pub use stroke::{QUANTITIES, overlay};

use shared::dop::object::{Field, Part, Shape};
use shared::dop::{Number, ObjectRead};

use crate::chart::{self, Chart, Series, Stroke};

/// All charts of a read; none for objects of single values.
#[must_use]
pub fn charts(read: &ObjectRead) -> Vec<Chart> {
    let (Some(object), None) = (read.object, read.error) else {
        return Vec::new();
    };
    // The number of registers may have decided for another layout than that of the request.
    let shape = if has(read, Part::Points) && has(read, Part::Start) {
        Shape::Trend
    } else {
        object.shape
    };
    let charts = match shape {
        Shape::Trend => trend::charts(read),
        Shape::Histogram => bins::charts(read),
        Shape::Profile => stroke::charts(read),
        Shape::Axes => axes::charts(read),
        _ => Vec::new(),
    };
    charts
        .into_iter()
        .filter(|c| !c.series.is_empty())
        .collect()
}

/// The charts of a read with those of an earlier one over them.
#[must_use]
pub fn compared(read: &ObjectRead, earlier: &ObjectRead) -> Vec<Chart> {
    let mut charts = charts(read);
    let old = self::charts(earlier);
    for chart in &mut charts {
        let Some(old) = old.iter().find(|c| c.key == chart.key) else {
            continue;
        };
        chart.key.push_str("-compared");
        let bars = chart.has_bars();
        let wanted = if bars { old.series.len() } else { 1 };
        let from = old.series.len().saturating_sub(wanted);
        let kept = chart.series.len().saturating_sub(wanted);
        if !bars {
            chart.bands.clear();
            chart.series.drain(..kept);
        }
        let earlier = old.series.get(from..).unwrap_or_default();
        let mut all: Vec<_> = earlier.iter().map(as_earlier).collect();
        all.append(&mut chart.series);
        chart.series = all;
    }
    charts
}

fn as_earlier(series: &Series) -> Series {
    Series {
        key: format!("earlier-{}", series.key),
        label: format!("{}, earlier", series.label),
        stroke: Stroke::Dashed,
        ..series.clone()
    }
}

fn has(read: &ObjectRead, part: Part) -> bool {
    fields(read).any(|f| f.part == part)
}

/// The fields of the layout that was chosen.
fn fields(read: &ObjectRead) -> impl Iterator<Item = &'static Field> {
    read.layout.map_or(&[][..], |layout| layout.fields).iter()
}

/// Title of a picture: the object and its option.
fn title(read: &ObjectRead) -> String {
    let object = read.object.map_or("", |o| o.label);
    match read.choice.map(|c| c.label).filter(|l| !l.is_empty()) {
        Some(option) => format!("{object}, {option}"),
        None => object.to_owned(),
    }
}

/// Identifier of a picture.
fn key(read: &ObjectRead, part: &str) -> String {
    let dash = if part.is_empty() { "" } else { "-" };
    format!("dop-{:04x}{dash}{part}", read.request.word())
}

/// A number over a stretch of the x axis.
fn point(from: f64, to: f64, number: Option<Number>) -> chart::Point {
    chart::Point {
        from,
        to,
        y: number.map(Number::to_f64),
        text: number.map_or_else(String::new, |n| n.scale.apply(n.raw).to_string()),
        note: String::new(),
    }
}

/// What a series is called at the end of its line, and how it is told from the others.
const fn role(part: Part) -> Option<(&'static str, Stroke)> {
    Some(match part {
        Part::Max => ("Max", Stroke::Thin),
        Part::Min => ("Min", Stroke::Thin),
        Part::Avg => ("Average", Stroke::Solid),
        Part::Lta => ("Long-term", Stroke::Dotted),
        _ => return None,
    })
}

/// The order of drawing: the most important last.
const ORDER: [Part; 4] = [Part::Min, Part::Max, Part::Lta, Part::Avg];

/// The band between the smallest and the largest values, if there are both.
fn band(series: &[Series]) -> Vec<(usize, usize)> {
    let at = |label| series.iter().position(|s| s.label == label);
    match (at("Min"), at("Max")) {
        (Some(low), Some(high)) => vec![(low, high)],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests;
