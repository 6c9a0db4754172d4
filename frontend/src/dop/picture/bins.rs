//! Histograms: amounts or levels by bins of vibration or position, with the time of each bin.

use shared::dop::object::{Axis as FieldAxis, Field, Part};
use shared::dop::{ObjectRead, Stamp};

use super::{ORDER, band, fields, key, point, role, title};
use crate::chart::{Axis, Chart, Point, Series, Shape, Stroke};
use crate::dop::when::exact;

/// The chart of a histogram.
pub(super) fn charts(read: &ObjectRead) -> Vec<Chart> {
    let arrays: Vec<&Field> = fields(read)
        .filter(|f| matches!(f.axis, FieldAxis::Bins { .. }))
        .collect();
    let Some(FieldAxis::Bins { unit, .. }) = arrays.first().map(|f| f.axis) else {
        return Vec::new();
    };
    let times: Vec<&Field> = arrays
        .iter()
        .copied()
        .filter(|f| f.part == Part::When)
        .collect();
    let values: Vec<&Field> = arrays
        .iter()
        .copied()
        .filter(|f| f.part != Part::When)
        .collect();
    let mut series = level_series(read, &values, &times);
    if series.is_empty() {
        series = amount_series(read, &values, &times);
    }
    let unit_of_values = values.first().map_or("", |f| f.unit);
    let what = match unit_of_values {
        "s" => "Time",
        "" => "Count",
        "mG" | "G" => "Vibration",
        _ => "Starts",
    };
    let by = if unit == "%" { "Position" } else { "Vibration" };
    let mut notes = Vec::new();
    if values.len() > 1 && values.iter().any(|f| f.axis != values[0].axis) {
        notes.push("The bins have two widths; a bar is as wide as its bin.".to_owned());
    }
    vec![Chart {
        key: key(read, ""),
        title: title(read),
        x: Axis::number(by, if unit == "%" { "% open" } else { unit }),
        y: Axis::number(what, unit_of_values),
        bands: band(&series),
        series,
        notes,
    }]
}

/// Largest, smallest and average levels as steps; the times belong to the largest.
fn level_series(
    read: &ObjectRead,
    values: &[&'static Field],
    times: &[&'static Field],
) -> Vec<Series> {
    let mut all = Vec::new();
    for part in ORDER {
        let Some((label, stroke)) = role(part) else {
            continue;
        };
        let Some(field) = values.iter().find(|f| f.part == part) else {
            continue;
        };
        let time = times.first().filter(|_| part == Part::Max);
        all.push(Series {
            key: label.to_ascii_lowercase(),
            label: label.to_owned(),
            shape: Shape::Step,
            stroke,
            points: points(read, field, time.copied()),
        });
    }
    all
}

/// Amounts as bars; of the open and the close side one beside the other.
fn amount_series(
    read: &ObjectRead,
    values: &[&'static Field],
    times: &[&'static Field],
) -> Vec<Series> {
    let mut all: Vec<Series> = Vec::new();
    for (at, field) in values.iter().enumerate() {
        let (label, stroke) = match field.part {
            Part::Open => ("Open", Stroke::Solid),
            Part::Close => ("Close", Stroke::Dotted),
            _ => ("Amount", Stroke::Solid),
        };
        let mut points = points(read, field, times.get(at).copied());
        let same = all.iter_mut().find(|s| s.label == label);
        if let Some(series) = same {
            series.points.append(&mut points);
        } else {
            all.push(Series {
                key: label.to_ascii_lowercase(),
                label: label.to_owned(),
                shape: Shape::Bar,
                stroke,
                points,
            });
        }
    }
    all
}

fn points(read: &ObjectRead, field: &'static Field, time: Option<&'static Field>) -> Vec<Point> {
    let times: Vec<Stamp> = time.map_or_else(Vec::new, |f| read.times(f.key));
    let numbers = (0_u16..).zip(read.series(field.key));
    numbers
        .filter_map(|(at, number)| {
            let (from, to) = field.axis.bounds(at)?;
            let mut point = point(f64::from(from) / 10.0, f64::from(to) / 10.0, Some(number));
            if let Some(stamp) = times.get(usize::from(at)) {
                point.note = exact(*stamp);
            }
            Some(point)
        })
        .collect()
}
