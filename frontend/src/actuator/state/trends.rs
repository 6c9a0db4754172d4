//! What the recorders of the device wrote down over time: temperatures, voltage, torque.

use shared::icon3000::model::Kind;
use shared::value::Quality;

use super::dossier::Dossier;
use super::logs::Y2K;
use crate::chart::{Axis, Chart, Kind as AxisKind, Point, Series, Shape, Stroke};

/// Files of the recorders.
pub const RECORDERS: [(u16, &str); 2] = [(5100, "Recorder"), (5200, "T-Recorder")];

/// One chart for each unit of a recorder's file: temperatures together, voltage, torque.
#[must_use]
pub fn charts(dossier: &Dossier, file: u16) -> Vec<Chart> {
    let Some(log) = dossier.log(file) else {
        return Vec::new();
    };
    let Some(layout) = log.file.layout else {
        return Vec::new();
    };
    let measured = |kind| matches!(kind, Kind::Unsigned | Kind::Signed);
    let fields: Vec<_> = layout.entry.iter().filter(|f| measured(f.kind)).collect();
    let mut units: Vec<&str> = Vec::new();
    for field in &fields {
        if !units.contains(&field.unit) {
            units.push(field.unit);
        }
    }
    let valid = |number: u16| log.stored.is_none_or(|stored| number <= stored);
    // The latest comes first in the file, the oldest stands at the left of the picture.
    let entries: Vec<_> = log
        .entries
        .iter()
        .rev()
        .filter(|e| valid(e.number))
        .filter_map(|e| Some((e, Y2K + i64::from(e.time()?))))
        .collect();
    let chart = |unit: &&str| {
        let of_unit: Vec<_> = fields.iter().filter(|f| f.unit == *unit).collect();
        let series = of_unit.iter().enumerate().map(|(at, field)| Series {
            key: field.key.to_owned(),
            label: field.label.to_owned(),
            shape: Shape::Line,
            stroke: [Stroke::Solid, Stroke::Dashed, Stroke::Dotted][at.min(2)],
            points: entries
                .iter()
                .map(|(entry, time)| {
                    let item = entry.get(field.key);
                    let at = seconds(*time);
                    Point {
                        from: at,
                        to: at,
                        y: item.and_then(|i| Some(field.scale.to_f64(i.number()?))),
                        text: item.map_or_else(String::new, shared::icon3000::Item::text),
                        note: item
                            .filter(|i| i.quality != Quality::Good)
                            .map_or_else(String::new, |i| i.quality.label().to_owned()),
                    }
                })
                .collect(),
        });
        let label = match of_unit[..] {
            [one] => one.label,
            _ => "Temperature",
        };
        Chart {
            key: format!("trend-{file}-{}", of_unit.first().map_or("", |f| f.key)),
            title: format!("{}: {}", log.name(), label.to_ascii_lowercase()),
            x: Axis {
                label: "Time".to_owned(),
                unit: "device clock".to_owned(),
                kind: AxisKind::Time,
            },
            y: Axis::number(label, unit),
            series: series.collect(),
            bands: Vec::new(),
            notes: Vec::new(),
        }
    };
    if entries.is_empty() {
        return Vec::new();
    }
    units.iter().map(chart).collect()
}

#[expect(
    clippy::cast_precision_loss,
    reason = "seconds since 1970 are far below 2^52"
)]
const fn seconds(time: i64) -> f64 {
    time as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::state::logs::tests::put;
    use shared::device::Device;

    /// Two entries of file 5100, the latest first: 100 s after 2000 with 21 and 45 °C and 400 V,
    /// 40 s after it with 20 °C, -3 °C and 398 V (table 45).
    #[test]
    fn recorders_become_lines_from_left_to_right() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let head = [2, 0, 10, 0, 60];
        let latest = [0, 100, 21, 45, 400, 0];
        let first = [0, 40, 20, 0xFFFD, 398, 0];
        put(&mut dossier, 5100, &[&head[..], &latest, &first].concat());
        let charts = charts(&dossier, 5100);
        assert_eq!(charts.len(), 2);
        let [electronics, motor] = &charts[0].series[..] else {
            panic!("{charts:?}");
        };
        let values = |s: &Series| -> Vec<_> { s.points.iter().filter_map(|p| p.y).collect() };
        assert_eq!(values(electronics), [20.0, 21.0]);
        assert_eq!(values(motor), [-3.0, 45.0]);
        assert_eq!(values(&charts[1].series[0]), [398.0, 400.0]);
        let width = charts[0].extent().map(|(a, b)| b - a);
        assert_eq!(width, Some(60.0));
        assert!(super::charts(&dossier, 5200).is_empty());
    }
}
