//! The dynamic variables over time, as a chart.

use shared::device::Family;

use super::condition::third;
use super::unit::Moment;
use crate::chart::{Axis, Chart, Point, Series, Shape, Stroke};

/// A pause longer than this, in microseconds, is a gap.
const GAP: u64 = 10_000_000;

/// Demand, position and torque over time; the time is that of the bridge, whose start is given in
/// seconds since 1970. A pause is a gap: nobody knows what happened in it.
#[must_use]
pub fn chart<'m>(
    moments: impl Iterator<Item = &'m Moment> + Clone,
    family: Option<Family>,
    start_s: u64,
) -> Chart {
    let series = [
        ("torque", third(family), 3, Stroke::Thin),
        ("demand", "Demand", 1, Stroke::Dashed),
        ("position", "Position", 2, Stroke::Solid),
    ];
    Chart {
        key: "trend".to_owned(),
        title: "Demand and position".to_owned(),
        x: Axis::time(),
        y: Axis::number("Percent of range", "%"),
        series: series
            .map(|(key, label, at, stroke)| Series {
                key: key.to_owned(),
                label: label.to_owned(),
                shape: Shape::Line,
                stroke,
                points: points(moments.clone(), at, start_s),
            })
            .into_iter()
            .collect(),
        bands: Vec::new(),
        notes: vec![
            "As answered to command 3 since this page was opened; times are those of the bridge. A \
             pause of more than ten seconds is a gap."
                .to_owned(),
        ],
    }
}

#[expect(
    clippy::cast_precision_loss,
    reason = "microseconds since 1970 in seconds, far below 2^52"
)]
fn points<'m>(moments: impl Iterator<Item = &'m Moment>, at: usize, start_s: u64) -> Vec<Point> {
    let mut points = Vec::new();
    let mut before: Option<u64> = None;
    let place = |us: u64| start_s as f64 + us as f64 / 1e6;
    for moment in moments {
        if before.is_some_and(|b| moment.at_us.saturating_sub(b) > GAP) {
            let x = place(moment.at_us);
            points.push(Point {
                from: x,
                to: x,
                y: None,
                text: String::new(),
                note: String::new(),
            });
        }
        before = Some(moment.at_us);
        let value = moment.values.get(at).and_then(Option::as_ref);
        let x = place(moment.at_us);
        points.push(Point {
            from: x,
            to: x,
            y: value.map(|(y, _)| *y),
            text: value.map_or_else(String::new, |(_, text)| text.clone()),
            note: String::new(),
        });
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(at_s: u64, position: Option<f64>) -> Moment {
        let value = position.map(|p| (p, p.to_string()));
        Moment {
            at_us: at_s * 1_000_000,
            values: [None, value.clone(), value, None],
        }
    }

    #[test]
    fn pauses_and_missing_values_are_gaps() {
        let moments = [
            moment(1, Some(10.0)),
            moment(2, None),
            moment(3, Some(12.0)),
            moment(30, Some(50.0)),
        ];
        let chart = chart(moments.iter(), None, 1000);
        let position = chart.series.iter().find(|s| s.key == "position").unwrap();
        let ys: Vec<_> = position.points.iter().map(|p| p.y).collect();
        assert_eq!(ys, [Some(10.0), None, Some(12.0), None, Some(50.0)]);
        assert!((position.points[0].from - 1001.0).abs() < 1e-9);
        assert!(chart.series[0].points.iter().all(|p| p.y.is_none()));
    }
}
