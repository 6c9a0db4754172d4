//! Trends: points from the newest to the oldest, drawn from the start date to the end date.

use shared::dop::object::{Axis as FieldAxis, Field, Part};
use shared::dop::{Number, ObjectRead, Stamp};

use super::{ORDER, band, fields, key, point, role, title};
use crate::chart::{Axis, Chart, Kind, Series, Shape};

/// The chart of a trend.
pub(super) fn charts(read: &ObjectRead) -> Vec<Chart> {
    let arrays: Vec<&Field> = fields(read)
        .filter(|f| matches!(f.axis, FieldAxis::Ago(_)))
        .collect();
    let Some(FieldAxis::Ago(unit)) = arrays.first().map(|f| f.axis) else {
        return Vec::new();
    };
    let span = span(read);
    let mut series = Vec::new();
    let mut unit_of_values = "";
    for part in ORDER {
        let Some((label, stroke)) = role(part) else {
            continue;
        };
        // The oldest come first: an array may be split into two fields.
        let mut numbers: Vec<Number> = Vec::new();
        for field in arrays.iter().filter(|f| f.part == part) {
            numbers.extend(read.series(field.key));
        }
        if let Some(first) = numbers.first() {
            unit_of_values = first.unit;
            series.push(Series {
                key: label.to_ascii_lowercase(),
                label: label.to_owned(),
                shape: Shape::Step,
                stroke,
                points: points(&numbers, span),
            });
        }
    }
    let mut notes = Vec::new();
    match span {
        Some(_) => notes.push(
            "Every point covers an equal part of the time from start to end; the manual does not \
             say how long a point lasts. Times are those of the unit's clock."
                .to_owned(),
        ),
        None => notes.push(
            "Start and end give no span of time, so the points are counted back from the newest."
                .to_owned(),
        ),
    }
    let valid = series.iter().map(|s| s.points.len()).max().unwrap_or(0);
    let most = arrays
        .iter()
        .filter(|f| f.part == Part::Max)
        .map(|f| usize::from(f.count))
        .sum::<usize>();
    if valid < most {
        notes.push(format!("{valid} of at most {most} points are valid."));
    }
    let what = read.object.map_or("", |o| o.group.label());
    vec![Chart {
        key: key(read, ""),
        title: title(read),
        x: match span {
            Some(_) => Axis::time(),
            None => Axis {
                label: "Before the newest point".to_owned(),
                unit: format!("{unit}s"),
                kind: Kind::Number,
            },
        },
        y: Axis::number(what, unit_of_values),
        bands: band(&series),
        series,
        notes,
    }]
}

/// Start and end of the trend in seconds.
fn span(read: &ObjectRead) -> Option<(i64, i64)> {
    let time = |part| {
        let field = fields(read).find(|f| f.part == part)?;
        read.time(field.key).and_then(Stamp::seconds)
    };
    let (start, end) = (time(Part::Start)?, time(Part::End)?);
    (start < end).then_some((start, end))
}

/// The points from the oldest to the newest.
#[expect(
    clippy::cast_precision_loss,
    reason = "seconds since 1970 are far below 2^52"
)]
fn points(newest_first: &[Number], span: Option<(i64, i64)>) -> Vec<crate::chart::Point> {
    let count = u32::try_from(newest_first.len()).unwrap_or(1);
    let (start, step) = match span {
        Some((start, end)) => (start as f64, (end - start) as f64 / f64::from(count)),
        None => (-f64::from(count), 1.0),
    };
    let oldest_first = newest_first.iter().rev();
    (0..count)
        .zip(oldest_first)
        .map(|(at, number)| {
            // Both ends by the same rule, so that neighbours touch exactly.
            let from = start + f64::from(at) * step;
            let to = start + f64::from(at + 1) * step;
            point(from, to, Some(*number))
        })
        .collect()
}
