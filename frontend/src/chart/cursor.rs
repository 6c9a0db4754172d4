//! The cursor: where it can stand, what the keys do, and the values it reads.

use super::ticks::ordered;
use super::time::stretch;
use super::{Chart, Kind, Point, Series, View};
use crate::format::within;
use crate::markup::Markup;

/// A place where the cursor can stand: the extent of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stop {
    /// Where it begins.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
}

impl Stop {
    /// Its middle.
    #[must_use]
    pub fn middle(self) -> f64 {
        f64::midpoint(self.from, self.to)
    }
}

/// All places that have a point, from left to right.
#[must_use]
pub fn stops(chart: &Chart) -> Vec<Stop> {
    let points = chart.lines().flat_map(|s| &s.points);
    let all: Vec<_> = points
        .map(|p| Stop {
            from: p.from,
            to: p.to,
        })
        .collect();
    let key = |at: usize| (all[at].from, all[at].to);
    let order = ordered(all.len(), &|a, b| key(a) < key(b));
    let mut stops: Vec<_> = order.into_iter().map(|at| all[at]).collect();
    stops.dedup();
    stops
}

/// The stop nearest to a place.
#[must_use]
pub fn nearest(stops: &[Stop], at: f64) -> Option<usize> {
    let distance = |s: &Stop| (s.middle() - at).abs();
    let best = stops.iter().enumerate();
    best.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
        .map(|(at, _)| at)
}

/// The point of a series at a stop.
#[must_use]
pub fn point_at(series: &Series, stop: Stop) -> Option<&Point> {
    let exact = |p: &&Point| p.from == stop.from && p.to == stop.to;
    let around = |p: &&Point| p.from <= stop.middle() && stop.middle() < p.to;
    let points = || series.points.iter();
    points().find(exact).or_else(|| points().find(around))
}

/// A place of the x axis in words, with its unit.
#[must_use]
pub fn place(chart: &Chart, stop: Stop) -> String {
    match &chart.x.kind {
        Kind::Time => {
            let unit = &chart.x.unit;
            format!("{} {unit}", stretch(whole(stop.from), whole(stop.to)))
        }
        Kind::Names(names) => {
            let at = usize::try_from(whole(stop.from)).unwrap_or(0);
            names.get(at).cloned().unwrap_or_default()
        }
        Kind::Number => {
            let unit = &chart.x.unit;
            let text = if stop.from == stop.to {
                tenths(stop.from)
            } else {
                format!("{} to {}", tenths(stop.from), tenths(stop.to))
            };
            format!("{text} {unit}").trim_end().to_owned()
        }
    }
}

/// A number with at most one decimal. Bins and positions have no more.
fn tenths(value: f64) -> String {
    let counts = whole(value * 10.0);
    let sign = if counts < 0 { "\u{2212}" } else { "" };
    match (counts.unsigned_abs() / 10, counts.unsigned_abs() % 10) {
        (whole, 0) => format!("{sign}{whole}"),
        (whole, tenth) => format!("{sign}{whole}.{tenth}"),
    }
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "seconds and positions are far below"
)]
fn whole(value: f64) -> i64 {
    value.round() as i64
}

/// What a key makes of a view; `None` if the key means nothing here.
#[must_use]
pub fn key(chart: &Chart, view: View, key: &str) -> Option<View> {
    let stops = stops(chart);
    let shown = shown(&stops, view);
    let at = view.cursor;
    let to = |cursor: Option<usize>| Some(View { cursor, ..view });
    match key {
        "ArrowRight" => to(Some(
            at.map_or(*shown.first()?, |a| (a + 1).min(stops.len() - 1)),
        )),
        "ArrowLeft" => to(Some(at.map_or(*shown.last()?, |a| a.saturating_sub(1)))),
        "Home" => to(shown.first().copied()),
        "End" => to(shown.last().copied()),
        "+" | "=" => Some(zoomed(chart, view, 0.5)),
        "-" => Some(zoomed(chart, view, 2.0)),
        "0" => Some(View {
            range: None,
            ..view
        }),
        "Escape" if view != View::default() => Some(View::default()),
        _ => None,
    }
    .map(|next| kept_in_view(chart, &stops, next))
}

/// The stops in the part that is shown.
fn shown(stops: &[Stop], view: View) -> Vec<usize> {
    let inside = |s: &Stop| {
        view.range
            .is_none_or(|(l, h)| s.middle() >= l && s.middle() <= h)
    };
    let all = stops.iter().enumerate();
    all.filter(|(_, s)| inside(s)).map(|(at, _)| at).collect()
}

/// Moves the part that is shown so that the cursor is in it.
fn kept_in_view(chart: &Chart, stops: &[Stop], mut view: View) -> View {
    let stop = view.cursor.and_then(|at| stops.get(at));
    if let (Some(stop), Some((low, high)), Some((first, last))) = (stop, view.range, chart.extent())
        && (stop.middle() < low || stop.middle() > high)
    {
        let span = high - low;
        let low = within(stop.middle() - span / 2.0, first, (last - span).max(first));
        view.range = Some((low, low + span));
    }
    view
}

/// The view with the shown part made larger or smaller around the cursor.
#[must_use]
pub fn zoomed(chart: &Chart, view: View, factor: f64) -> View {
    let Some((first, last)) = chart.extent() else {
        return view;
    };
    let (low, high) = view.range.unwrap_or((first, last));
    let stops = stops(chart);
    let middle = view
        .cursor
        .and_then(|at| stops.get(at))
        .map_or(f64::midpoint(low, high), |s| s.middle());
    // Never nearer than two points.
    let count = u32::try_from(stops.len().max(2)).map_or(2.0, f64::from);
    let smallest = (last - first) / count * 2.0;
    let span = ((high - low) * factor).max(smallest);
    let range = if span >= last - first {
        None
    } else {
        let low = within(middle - span / 2.0, first, last - span);
        Some((low, low + span))
    };
    View { range, ..view }
}

/// The view after dragging from one place to another: that part, if anything is in it.
#[must_use]
pub fn dragged(chart: &Chart, view: View, from: f64, to: f64) -> View {
    let (low, high) = (from.min(to), from.max(to));
    let some = stops(chart).iter().any(|s| s.to >= low && s.from <= high);
    View {
        range: if some && high > low {
            Some((low, high))
        } else {
            view.range
        },
        drag: None,
        ..view
    }
}

/// Draws the values at the cursor, or what to do to see some.
pub fn readout(html: &mut Markup, chart: &Chart, view: View) {
    let stops = stops(chart);
    let Some(stop) = view.cursor.and_then(|at| stops.get(at).copied()) else {
        let words = "Point at the picture or use the arrow keys to read values.";
        html.node("span", "quiet", words);
        return;
    };
    html.node("b", "readout-place", &place(chart, stop));
    for series in chart.lines() {
        let point = point_at(series, stop);
        html.open(
            "span",
            &[("class", "readout-value"), ("data-series", &series.key)],
        );
        html.node("span", "quiet", &series.label).text(" ");
        match point.filter(|p| p.y.is_some()) {
            Some(point) => {
                html.node("b", "", &point.text)
                    .text(" ")
                    .node("i", "unit", &chart.y.unit);
                if !point.note.is_empty() {
                    html.text(" ").node("span", "quiet", &point.note);
                }
            }
            None => {
                html.node("span", "quiet", "no value");
            }
        }
        html.close("span");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::sample::{bars, torque};

    fn at(cursor: usize) -> View {
        View {
            cursor: Some(cursor),
            ..View::default()
        }
    }

    #[test]
    fn the_cursor_stops_at_every_place_once() {
        let stops = stops(&torque());
        let places: Vec<_> = stops.iter().map(|s| s.middle()).collect();
        assert_eq!(places, [0.0, 50.0, 100.0]);
        assert_eq!(nearest(&stops, 70.0), Some(1));
        assert_eq!(nearest(&stops, -5.0), Some(0));
        assert_eq!(nearest(&[], 0.0), None);
    }

    #[test]
    fn keys_walk_and_zoom() {
        let chart = torque();
        let press = |view, k| key(&chart, view, k);
        assert_eq!(press(View::default(), "ArrowRight"), Some(at(0)));
        assert_eq!(press(View::default(), "ArrowLeft"), Some(at(2)));
        assert_eq!(press(at(2), "ArrowRight"), Some(at(2)));
        assert_eq!(press(at(1), "Home"), Some(at(0)));
        assert_eq!(press(at(1), "x"), None);
        assert_eq!(press(View::default(), "Escape"), None);
        assert_eq!(press(at(1), "Escape"), Some(View::default()));
        // Three points over 100: never nearer than 66.7.
        let near = press(at(1), "+").unwrap();
        let (low, high) = near.range.unwrap();
        assert!(
            (low - 16.67).abs() < 0.1 && (high - 83.33).abs() < 0.1,
            "{near:?}"
        );
        // Beyond the part that is shown, the part follows.
        let moved = press(near, "ArrowRight").unwrap();
        assert_eq!(moved.cursor, Some(2));
        assert!((moved.range.unwrap().1 - 100.0).abs() < 0.1);
        assert_eq!(press(near, "-").unwrap().range, None);
        assert_eq!(press(near, "0").unwrap().range, None);
    }

    #[test]
    fn dragging_shows_a_part() {
        let chart = bars();
        assert_eq!(
            dragged(&chart, View::default(), 5.0, 1.0).range,
            Some((1.0, 5.0))
        );
        assert_eq!(dragged(&chart, View::default(), 50.0, 60.0).range, None);
        assert_eq!(dragged(&chart, View::default(), 3.0, 3.0).range, None);
    }

    #[test]
    fn values_are_read_as_decoded() {
        let mut html = Markup::new();
        readout(&mut html, &bars(), at(2));
        let html = html.finish();
        assert!(html.contains(">4 to 10 G<"), "{html}");
        assert!(
            html.contains("<b class=\"\">25</b>") && html.contains(">s<"),
            "{html}"
        );
        assert!(html.contains("2026-01-01"));
        // The reference has no point in the middle of the recent stroke.
        let mut html = Markup::new();
        readout(&mut html, &torque(), at(1));
        let html = html.finish();
        assert!(
            html.contains(">50 %<") && html.contains("no value"),
            "{html}"
        );
        assert!(html.contains("<b class=\"\">40</b>"), "{html}");
    }
}
