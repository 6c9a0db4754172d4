//! Torque over a stroke, and several strokes over each other.

use shared::dop::ObjectRead;
use shared::dop::object::{Axis as FieldAxis, Field, Part};

use super::{ORDER, band, fields, key, point, role, title};
use crate::chart::{Axis, Chart, Point, Series, Shape, Stroke};

/// What of a stroke can be laid over others: its key, its name, the part it plays.
pub const QUANTITIES: [(&str, &str, Part); 4] = [
    ("avg", "Average", Part::Avg),
    ("max", "Max", Part::Max),
    ("min", "Min", Part::Min),
    ("lta", "Long-term average", Part::Lta),
];

/// The chart of a stroke.
pub(super) fn charts(read: &ObjectRead) -> Vec<Chart> {
    let mut series = Vec::new();
    for part in ORDER {
        let Some((label, stroke)) = role(part) else {
            continue;
        };
        if let Some(field) = array(read, part) {
            let points = points(read, field);
            // Of the layout of 312 registers only one percent of the long-term average is left.
            if !points.is_empty() {
                series.push(Series {
                    key: label.to_ascii_lowercase(),
                    label: label.to_owned(),
                    shape: Shape::Line,
                    stroke,
                    points,
                });
            }
        }
    }
    let unit = array(read, Part::Avg).map_or("", |f| f.unit);
    vec![Chart {
        key: key(read, ""),
        title: title(read),
        x: Axis::number("Position", "% open"),
        y: Axis::number("Torque", unit),
        bands: band(&series),
        series,
        notes: Vec::new(),
    }]
}

/// One quantity of several strokes over each other; `None` unless at least two have it.
#[must_use]
pub fn overlay(reads: &[&ObjectRead], quantity: &str) -> Option<Chart> {
    let (key, name, part) = *QUANTITIES.iter().find(|q| q.0 == quantity)?;
    let mut series = Vec::new();
    let mut unit = "";
    // The recent strokes are drawn over their references.
    let order = [1_u8, 3, 2, 0];
    for option in order {
        let Some(read) = reads.iter().find(|r| r.request.option() == option) else {
            continue;
        };
        let Some(field) = array(read, part) else {
            continue;
        };
        unit = field.unit;
        let stroke = match option {
            0 => Stroke::Solid,
            1 => Stroke::Dashed,
            2 => Stroke::Thin,
            _ => Stroke::Dotted,
        };
        series.push(Series {
            key: format!("option-{option}"),
            label: read.choice.map_or("", |c| c.label).to_owned(),
            shape: Shape::Line,
            stroke,
            points: points(read, field),
        });
    }
    (series.len() > 1).then(|| Chart {
        key: format!("dop-strokes-{key}"),
        title: format!("{name} torque, strokes over each other"),
        x: Axis::number("Position", "% open"),
        y: Axis::number("Torque", unit),
        series,
        bands: Vec::new(),
        notes: Vec::new(),
    })
}

/// The array of a part; bins of position, not a single value that plays the same part.
fn array(read: &ObjectRead, part: Part) -> Option<&'static Field> {
    fields(read).find(|f| f.part == part && matches!(f.axis, FieldAxis::Bins { .. }) && f.count > 2)
}

fn points(read: &ObjectRead, field: &'static Field) -> Vec<Point> {
    let numbers = (0_u16..).zip(read.series(field.key));
    numbers
        .filter_map(|(at, number)| {
            let (from, to) = field.axis.bounds(at)?;
            Some(point(
                f64::from(from) / 10.0,
                f64::from(to) / 10.0,
                Some(number),
            ))
        })
        .collect()
}
