//! What stands in the frame besides lines: bars, names, the cursor.

use super::pen::{Pen, n};
use super::{Frame, LINE, STUB, within};
use crate::chart::cursor::{point_at, stops};
use crate::chart::legend::{Names, apart, text_width};
use crate::chart::{Chart, Point, Series, Shape, Stroke, View};

pub(super) fn bars(pen: &mut Pen, chart: &Chart, frame: &Frame) {
    let all: Vec<_> = chart
        .series
        .iter()
        .filter(|s| s.shape == Shape::Bar)
        .collect();
    let count = u32::try_from(all.len()).map_or(1.0, f64::from).max(1.0);
    for (index, series) in (0_u32..).zip(&all) {
        for (at, point) in series.points.iter().enumerate() {
            let Some(value) = point.y else { continue };
            let (from, to) = (frame.px(point.from), frame.px(point.to));
            // A little air between places, none between the bars of one.
            let air = within((to - from) * 0.12, 0.5, 8.0);
            let width = (to - from - 2.0 * air) / count;
            let left = from + air + f64::from(index) * width;
            let base = frame.py(0.0);
            // What is not zero is seen, however small it is.
            let y = match frame.py(value) {
                y if value > 0.0 => y.min(base - STUB),
                y if value < 0.0 => y.max(base + STUB),
                y => y,
            };
            let (x, top) = (n(left), n(y.min(base)));
            let (width, height, at) = (n(width), n((y - base).abs()), at.to_string());
            let hatch = format!("url(#{}-hatch)", chart.key);
            let mut own = vec![
                ("data-series", series.key.as_str()),
                ("data-at", &at),
                ("x", &x),
                ("y", &top),
                ("width", &width),
                ("height", &height),
            ];
            if series.stroke == Stroke::Dashed {
                own.push(("fill", &hatch));
            }
            pen.shape("rect", &bar_class(series.stroke), &own, "");
            // The value stands at the end of its bar where there is room.
            if text_width(&point.text) <= (to - from) / count {
                let end = if value < 0.0 { y + 13.0 } else { y - 4.0 };
                let middle = left + (to - from - 2.0 * air) / count / 2.0;
                pen.text("bar-value middle", (middle, end), &point.text, &[]);
            }
        }
    }
}

fn bar_class(stroke: Stroke) -> String {
    format!("bar-{}", stroke.class())
}

pub(super) fn names(pen: &mut Pen, chart: &Chart, frame: &Frame) {
    match &frame.names {
        Names::None => {}
        Names::Right(_) => {
            let last = |s: &Series| {
                let inside = |p: &&Point| p.y.is_some() && p.from <= frame.x.1;
                s.points.iter().rfind(inside).and_then(|p| p.y)
            };
            let named: Vec<_> = chart
                .series
                .iter()
                .filter_map(|s| Some((s, last(s)?)))
                .collect();
            let wanted: Vec<_> = named.iter().map(|(_, y)| frame.py(*y)).collect();
            let placed = apart(&wanted, frame.top, frame.bottom(), 14.0);
            let right = frame.left + frame.width;
            for ((series, _), (y, line)) in named.iter().zip(placed.iter().zip(&wanted)) {
                if (y - line).abs() > 3.0 {
                    pen.line("grid", (right + 1.0, *line), (right + 7.0, *y));
                }
                let at = (right + 9.0, y + 4.0);
                pen.text("name", at, &series.label, &[("data-name", &series.key)]);
            }
        }
        Names::Above(places) => {
            for (series, (row, left)) in chart.lines().zip(places) {
                let row = u32::try_from(*row).map_or(0.0, f64::from);
                let y = 12.0 + LINE * (row + 1.0);
                swatch(pen, chart, series, (*left, y - 4.0));
                let at = (left + 32.0, y);
                pen.text("name", at, &series.label, &[("data-name", &series.key)]);
            }
        }
    }
}

/// Upright lines over the whole height, each with its name at the top.
pub(super) fn rules(pen: &mut Pen, chart: &Chart, frame: &Frame) {
    let rules = chart.series.iter().filter(|s| s.shape == Shape::Rule);
    for (row, series) in (0_u32..).zip(rules) {
        let class = format!("series {}", series.stroke.class());
        for point in &series.points {
            let place = point.middle();
            if place < frame.x.0 || place > frame.x.1 {
                continue;
            }
            let x = frame.px(place);
            let d = format!("M{} {}V{}", n(x), n(frame.top), n(frame.bottom()));
            pen.path(&class, &d, &[("data-series", &series.key)]);
            // Beside the line, on the side that has room, and none over another.
            let y = frame.top + 11.0 + LINE * f64::from(row);
            let fits = x + 5.0 + text_width(&series.label) < frame.left + frame.width;
            let (class, x) = if fits {
                ("name", x + 5.0)
            } else {
                ("name end", x - 5.0)
            };
            pen.text(class, (x, y), &series.label, &[("data-name", &series.key)]);
        }
    }
}

/// A piece of a series beside its name.
fn swatch(pen: &mut Pen, chart: &Chart, series: &Series, (x, y): (f64, f64)) {
    if series.shape == Shape::Bar {
        let (left, top) = (n(x), n(y - 5.0));
        let hatch = format!("url(#{}-hatch)", chart.key);
        let mut own = vec![
            ("x", left.as_str()),
            ("y", &top),
            ("width", "26"),
            ("height", "10"),
        ];
        if series.stroke == Stroke::Dashed {
            own.push(("fill", &hatch));
        }
        pen.shape("rect", &bar_class(series.stroke), &own, "");
    } else {
        let class = format!("series {}", series.stroke.class());
        pen.line(&class, (x, y), (x + 26.0, y));
    }
}

/// The cursor, and what is being dragged.
pub(super) fn cursor(pen: &mut Pen, chart: &Chart, frame: &Frame, view: View) {
    pen.html.open("g", &[("class", "chart-cursor")]);
    if let Some((from, to)) = view.drag {
        let (a, b) = (frame.px(from.min(to)), frame.px(from.max(to)));
        let (x, y) = (n(a), n(frame.top));
        let (width, height) = (n(b - a), n(frame.height));
        let own = [
            ("x", x.as_str()),
            ("y", &y),
            ("width", &width),
            ("height", &height),
        ];
        pen.shape("rect", "drag", &own, "");
    }
    let stop = view.cursor.and_then(|at| stops(chart).get(at).copied());
    if let Some(stop) = stop.filter(|s| s.middle() >= frame.x.0 && s.middle() <= frame.x.1) {
        let x = frame.px(stop.middle());
        pen.line("cursor", (x, frame.top), (x, frame.bottom()));
        for series in chart.series.iter().filter(|s| s.shape != Shape::Bar) {
            if let Some(y) = point_at(series, stop).and_then(|p| p.y) {
                pen.circle("cursor-dot", (x, frame.py(y)), 3.5);
            }
        }
    }
    pen.html.close("g");
}
