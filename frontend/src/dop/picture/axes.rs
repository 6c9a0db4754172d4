//! The same values for the axes X, Y and Z: levels, and the peak of the spectrum.

use shared::dop::ObjectRead;
use shared::dop::object::{Axis as FieldAxis, Field};

use super::{fields, key, point, title};
use crate::chart::{Axis, Chart, Series, Shape, Stroke};

const STROKES: [Stroke; 4] = [Stroke::Solid, Stroke::Thin, Stroke::Dotted, Stroke::Dashed];

/// One chart for each unit: levels in mG, frequencies in Hz.
pub(super) fn charts(read: &ObjectRead) -> Vec<Chart> {
    let arrays: Vec<&Field> = fields(read)
        .filter(|f| f.axis == FieldAxis::Xyz && f.count == 3)
        .collect();
    let mut units: Vec<&str> = Vec::new();
    for field in &arrays {
        if !units.contains(&field.unit) {
            units.push(field.unit);
        }
    }
    units
        .into_iter()
        .map(|unit| {
            let of_unit = arrays.iter().filter(|f| f.unit == unit);
            let series = of_unit
                .zip(STROKES.into_iter().cycle())
                .map(|(field, stroke)| series(read, field, stroke))
                .collect();
            let (what, part) = if unit == "Hz" {
                ("Frequency", "spectrum")
            } else {
                ("Vibration", "level")
            };
            let title = title(read);
            Chart {
                key: key(read, part),
                title: if unit == "Hz" {
                    format!("{title}: peak of the spectrum")
                } else {
                    title
                },
                x: Axis::names("Axis", &["X", "Y", "Z"]),
                y: Axis::number(what, unit),
                series,
                bands: Vec::new(),
                notes: Vec::new(),
            }
        })
        .collect()
}

fn series(read: &ObjectRead, field: &'static Field, stroke: Stroke) -> Series {
    let numbers = (0_u32..).zip(read.series(field.key));
    Series {
        key: field.key.to_owned(),
        label: field.label.to_owned(),
        shape: Shape::Bar,
        stroke,
        points: numbers
            .map(|(at, number)| point(f64::from(at), f64::from(at + 1), Some(number)))
            .collect(),
    }
}
