//! The picture of a chart, as SVG text.

mod marks;
mod pen;

use marks::{bars, cursor, names, rules};
use pen::{Pen, n};

use super::legend::{Names, text_width};
use super::ticks::{Tick, range, ticks};
use super::{Chart, Kind, Point, Series, Shape, View, time};
use crate::format::within;
use crate::markup::Markup;

/// Height of a line of text.
const LINE: f64 = 16.0;

/// Height of a bar whose value is not zero, at least.
const STUB: f64 = 1.5;

/// Size of a picture in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    /// From left to right.
    pub width: f64,
    /// From top to bottom.
    pub height: f64,
}

impl Size {
    /// The size of a picture in a page that has this width for it. Many names take many rows; the
    /// plot keeps its height.
    #[must_use]
    pub fn of(chart: &Chart, width: f64) -> Self {
        let rows = Names::of(chart, width).rows().saturating_sub(2);
        let names = LINE * u32::try_from(rows).map_or(0.0, f64::from);
        let height = names + if width < 560.0 { 260.0 } else { 320.0 };
        Self { width, height }
    }
}

/// Where a picture is to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// In the page, whose style sheet has the colours.
    Page,
    /// In a file of its own, black on white.
    Paper,
}

/// Where the plot lies in the picture, and what it spans.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Left edge in pixels.
    pub left: f64,
    /// Upper edge in pixels.
    pub top: f64,
    /// Width in pixels.
    pub width: f64,
    /// Height in pixels.
    pub height: f64,
    /// What is at the left and right edge.
    pub x: (f64, f64),
    /// What is at the lower and upper edge.
    pub y: (f64, f64),
    names: Names,
    y_ticks: Vec<Tick>,
}

impl Frame {
    /// The frame of a chart in a picture of this size.
    #[must_use]
    pub fn of(chart: &Chart, size: Size, view: View) -> Self {
        let names = Names::of(chart, size.width);
        let rows = u32::try_from(names.rows()).map_or(0.0, f64::from);
        let top = 12.0 + LINE * (1.0 + rows) + if rows > 0.0 { 4.0 } else { 0.0 };
        let height = (size.height - top - 2.0 * LINE - 10.0).max(40.0);
        let x = widened(view.range.or_else(|| chart.extent()).unwrap_or((0.0, 1.0)));
        let most = parts(height, 44.0);
        let in_view = |p: &&Point| p.to >= x.0 && p.from <= x.1;
        let points = chart.series.iter().flat_map(|s| &s.points).filter(in_view);
        let y = range(points.filter_map(|p| p.y), chart.has_bars(), most);
        let y_ticks = ticks(y.0, y.1, most);
        let widest = y_ticks
            .iter()
            .map(|t| text_width(&t.text))
            .fold(14.0, f64::max);
        let left = widest + 10.0;
        let right = match names {
            Names::Right(width) => width,
            _ => 14.0,
        };
        Self {
            left,
            top,
            width: (size.width - left - right).max(40.0),
            height,
            x,
            y,
            names,
            y_ticks,
        }
    }

    /// Pixels from the left of the picture.
    #[must_use]
    pub fn px(&self, x: f64) -> f64 {
        self.left + (x - self.x.0) / (self.x.1 - self.x.0) * self.width
    }

    /// Pixels from the top of the picture.
    #[must_use]
    pub fn py(&self, y: f64) -> f64 {
        self.top + self.height - (y - self.y.0) / (self.y.1 - self.y.0) * self.height
    }

    /// What is at so many pixels from the left.
    #[must_use]
    pub fn at(&self, pixels: f64) -> f64 {
        let part = within((pixels - self.left) / self.width, 0.0, 1.0);
        self.x.0 + part * (self.x.1 - self.x.0)
    }

    fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// A range of no width gets some.
fn widened((low, high): (f64, f64)) -> (f64, f64) {
    if high > low {
        (low, high)
    } else {
        (low - 0.5, low + 0.5)
    }
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "pixels of a screen"
)]
fn parts(pixels: f64, each: f64) -> usize {
    within(pixels / each, 1.0, 40.0) as usize
}

/// The end of an axis, to a millionth.
#[expect(
    clippy::cast_possible_truncation,
    reason = "seconds since 1970 and smaller"
)]
fn exact(value: f64) -> String {
    let counts = (value * 1e6).round() as i64;
    let sign = if counts < 0 { "-" } else { "" };
    let counts = counts.unsigned_abs();
    let text = format!("{sign}{}.{:06}", counts / 1_000_000, counts % 1_000_000);
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// Draws a chart.
#[must_use]
pub fn draw(chart: &Chart, size: Size, view: View, look: Look) -> String {
    let frame = Frame::of(chart, size, view);
    let mut pen = Pen {
        html: Markup::new(),
        look,
    };
    let (width, height) = (n(size.width), n(size.height));
    let view_box = format!("0 0 {width} {height}");
    let mut attributes = vec![
        ("width", width.as_str()),
        ("height", &height),
        ("viewBox", &view_box),
        ("role", "img"),
        ("aria-label", &chart.title),
    ];
    let plot = format!(
        "{} {} {} {}",
        n(frame.left),
        n(frame.top),
        n(frame.width),
        n(frame.height)
    );
    let (x, y) = (
        format!("{} {}", exact(frame.x.0), exact(frame.x.1)),
        format!("{} {}", exact(frame.y.0), exact(frame.y.1)),
    );
    if look == Look::Paper {
        attributes.push(("xmlns", "http://www.w3.org/2000/svg"));
        attributes.push(("font-family", "Helvetica, Arial, sans-serif"));
        attributes.push(("font-size", "12"));
    } else {
        attributes.extend([
            ("class", "chart-picture"),
            ("data-testid", "chart-svg"),
            ("data-plot", &plot),
            ("data-x", &x),
            ("data-y", &y),
        ]);
    }
    pen.html.open("svg", &attributes);
    if look == Look::Paper {
        let all = [("width", "100%"), ("height", "100%"), ("fill", "#fff")];
        pen.html.open("rect", &all).close("rect");
    }
    definitions(&mut pen, chart, &frame);
    axes(&mut pen, chart, &frame);
    let clip = format!("url(#{}-clip)", chart.key);
    pen.html.open("g", &[("clip-path", &clip)]);
    for &(low, high) in &chart.bands {
        if let (Some(low), Some(high)) = (chart.series.get(low), chart.series.get(high)) {
            pen.path("band", &band(low, high, &frame), &[]);
        }
    }
    bars(&mut pen, chart, &frame);
    for series in chart.lines().filter(|s| s.shape != Shape::Bar) {
        let class = format!("series {}", series.stroke.class());
        pen.path(
            &class,
            &path(series, &frame),
            &[("data-series", &series.key)],
        );
        for point in lonely(series) {
            if let Some(y) = point.y {
                pen.circle("dot", (frame.px(point.middle()), frame.py(y)), 2.5);
            }
        }
    }
    pen.html.close("g");
    rules(&mut pen, chart, &frame);
    names(&mut pen, chart, &frame);
    if look == Look::Page {
        cursor(&mut pen, chart, &frame, view);
    }
    pen.html.close("svg");
    pen.html.finish()
}

fn definitions(pen: &mut Pen, chart: &Chart, frame: &Frame) {
    let clip = format!("{}-clip", chart.key);
    let (x, y) = (n(frame.left), n(frame.top - 2.0));
    let (width, height) = (n(frame.width), n(frame.height + 4.0));
    pen.html
        .open("defs", &[])
        .open("clipPath", &[("id", &clip)]);
    let place = [
        ("x", x.as_str()),
        ("y", &y),
        ("width", &width),
        ("height", &height),
    ];
    pen.shape("rect", "", &place, "");
    pen.html.close("clipPath");
    if chart.has_bars() {
        let hatch = format!("{}-hatch", chart.key);
        let pattern = [
            ("id", hatch.as_str()),
            ("width", "6"),
            ("height", "6"),
            ("patternUnits", "userSpaceOnUse"),
        ];
        pen.html.open("pattern", &pattern);
        pen.path("series thin", "M-1 1l2 -2M0 6l6 -6M5 7l2 -2", &[]);
        pen.html.close("pattern");
    }
    pen.html.close("defs");
}

fn axes(pen: &mut Pen, chart: &Chart, frame: &Frame) {
    let (left, bottom) = (frame.left, frame.bottom());
    let right = left + frame.width;
    for tick in &frame.y_ticks {
        let y = frame.py(tick.at);
        pen.line("grid", (left, y), (right, y));
        pen.text(
            "tick end",
            (left - 6.0, y + 4.0),
            &tick.text,
            &[("data-tick", "y")],
        );
    }
    for tick in x_ticks(chart, frame) {
        let x = frame.px(tick.at);
        if !matches!(chart.x.kind, Kind::Names(_)) {
            pen.line("axis-line", (x, bottom), (x, bottom + 4.0));
        }
        let place = (x, bottom + LINE + 2.0);
        pen.text("tick middle", place, &tick.text, &[("data-tick", "x")]);
    }
    let base = frame.py(within(0.0, frame.y.0, frame.y.1));
    pen.line("axis-line", (left, base), (right, base));
    pen.text("caption", (0.0, 12.0), &chart.y.caption(), &[]);
    let low = bottom + 2.0 * LINE + 6.0;
    let words = match chart.x.kind {
        Kind::Time => {
            let stretch = time::stretch(whole(frame.x.0), whole(frame.x.1));
            format!("{stretch} {}", chart.x.unit)
        }
        _ => chart.x.caption(),
    };
    pen.text("caption end", (right, low), &words, &[]);
}

#[expect(clippy::cast_possible_truncation, reason = "seconds since 1970")]
fn whole(value: f64) -> i64 {
    value.round() as i64
}

fn x_ticks(chart: &Chart, frame: &Frame) -> Vec<Tick> {
    let (low, high) = frame.x;
    match &chart.x.kind {
        Kind::Number => ticks(low, high, parts(frame.width, 64.0)),
        Kind::Time => time::ticks(
            whole(low.ceil()),
            whole(high.floor()),
            parts(frame.width, 76.0),
        ),
        Kind::Names(names) => (0_u32..)
            .zip(names)
            .map(|(at, name)| Tick {
                at: f64::from(at) + 0.5,
                text: name.clone(),
            })
            .collect(),
    }
}

/// The line of a series; it breaks where there is no value.
fn path(series: &Series, frame: &Frame) -> String {
    let mut d = String::new();
    let mut last: Option<f64> = None;
    for point in &series.points {
        let Some(y) = point.y else {
            last = None;
            continue;
        };
        let (from, to) = (frame.px(point.from), frame.px(point.to));
        let y = n(frame.py(y));
        match (series.shape, last) {
            (Shape::Step, Some(end)) if end == point.from => d.push('L'),
            (Shape::Step, _) | (_, None) => d.push('M'),
            _ => d.push('L'),
        }
        let first = if series.shape == Shape::Step {
            from
        } else {
            frame.px(point.middle())
        };
        d.push_str(&format!("{} {y}", n(first)));
        if series.shape == Shape::Step {
            d.push_str(&format!("H{}", n(to)));
        }
        last = Some(point.to);
    }
    d
}

/// Points of a line without neighbours, which a line alone would not show.
fn lonely(series: &Series) -> impl Iterator<Item = &Point> {
    let has = |at: Option<usize>| {
        let point = at.and_then(|at| series.points.get(at));
        point.is_some_and(|p| p.y.is_some())
    };
    let points = series.points.iter().enumerate();
    points
        .filter(move |(at, _)| {
            series.shape == Shape::Line && !has(at.checked_sub(1)) && !has(Some(at + 1))
        })
        .map(|(_, p)| p)
}

/// The area between two series, one shape for each place where both have a value.
fn band(low: &Series, high: &Series, frame: &Frame) -> String {
    let mut d = String::new();
    let pairs = low.points.iter().zip(&high.points);
    let values = pairs.filter_map(|(l, h)| Some((l, l.y?, h.y?)));
    if low.shape == Shape::Step {
        for (point, l, h) in values {
            let (from, to) = (n(frame.px(point.from)), n(frame.px(point.to)));
            let (l, h) = (n(frame.py(l)), n(frame.py(h)));
            d.push_str(&format!("M{from} {l}V{h}H{to}V{l}z"));
        }
        return d;
    }
    // Up along the lower line, back along the upper one; a gap begins a new shape.
    let mut run: Vec<(f64, f64, f64)> = Vec::new();
    let mut close = |run: &mut Vec<(f64, f64, f64)>| {
        let there = run.iter().map(|r| (r.0, r.1));
        let back = run.iter().rev().map(|r| (r.0, r.2));
        for (at, (x, y)) in there.chain(back).enumerate() {
            d.push(if at == 0 { 'M' } else { 'L' });
            d.push_str(&format!("{} {}", n(x), n(y)));
        }
        if !run.is_empty() {
            d.push('z');
        }
        run.clear();
    };
    for (l, h) in low.points.iter().zip(&high.points) {
        match (l.y, h.y) {
            (Some(a), Some(b)) => run.push((frame.px(l.middle()), frame.py(a), frame.py(b))),
            _ => close(&mut run),
        }
    }
    close(&mut run);
    d
}

#[cfg(test)]
mod tests;
