//! Charts of measured values: lines, steps, bars and bands as SVG text.
//!
//! ```text
//!  Chart (series of points, each with its exact text)
//!    ├─► ticks, time ──► svg ──► picture     pure, tested natively by numbers worked out by hand
//!    ├─► cursor ───────► readout             values of one place, always in the same spot
//!    ├─► table ────────► data table, CSV
//!    └─► view, export ─► the page            pointer, keys, files
//! ```
//!
//! # Invariants
//!
//! - **A point keeps the text it was decoded to.** Floats place marks; they are never printed.
//! - **Never colour alone.** Series differ by stroke and fill and carry their name; a print in
//!   black and white says the same.
//! - **A missing value is a gap**, never a point at zero.
//!
//! # Hooks for tests
//!
//! `chart` (`data-chart`), in it `chart-svg` (`data-plot`: left, top, width and height of the plot
//! in pixels; `data-x`, `data-y`: the range of each axis), `path[data-series]`,
//! `rect[data-series][data-at]`, `text[data-tick=x|y]`, `chart-readout`, `chart-data` (button),
//! `chart-table`, `chart-save-svg`, `chart-save-png`, `chart-save-csv`, `chart-in`, `chart-out`,
//! `chart-whole`.

pub mod cursor;
pub mod export;
pub mod legend;
pub mod svg;
pub mod table;
pub mod ticks;
pub mod time;
pub mod view;

/// What an axis measures.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers.
    Number,
    /// Seconds since 1970-01-01 UTC.
    Time,
    /// Named places at 0 to 1, 1 to 2 and so on.
    Names(Vec<String>),
}

/// An axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Axis {
    /// What it measures, in words.
    pub label: String,
    /// Its unit, empty if it has none.
    pub unit: String,
    /// What its numbers are.
    pub kind: Kind,
}

impl Axis {
    /// An axis of numbers.
    #[must_use]
    pub fn number(label: &str, unit: &str) -> Self {
        Self {
            label: label.to_owned(),
            unit: unit.to_owned(),
            kind: Kind::Number,
        }
    }

    /// An axis of dates and times.
    #[must_use]
    pub fn time() -> Self {
        Self {
            label: "Time".to_owned(),
            unit: "UTC".to_owned(),
            kind: Kind::Time,
        }
    }

    /// An axis of named places.
    #[must_use]
    pub fn names(label: &str, names: &[&str]) -> Self {
        Self {
            label: label.to_owned(),
            unit: String::new(),
            kind: Kind::Names(names.iter().map(|&n| n.to_owned()).collect()),
        }
    }

    /// Label and unit: `Torque, %`.
    #[must_use]
    pub fn caption(&self) -> String {
        if self.unit.is_empty() {
            self.label.clone()
        } else {
            format!("{}, {}", self.label, self.unit)
        }
    }
}

/// How a series joins its points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Straight from point to point.
    Line,
    /// Level over the extent of each point.
    Step,
    /// A bar over the extent of each point.
    Bar,
    /// An upright line at each point, which has no value of its own: a limit of the x axis.
    Rule,
}

/// How a series is told from the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// The one to look at; bars are filled.
    Solid,
    /// A reference; bars are hatched.
    Dashed,
    /// Bars are outlined.
    Dotted,
    /// A second reference beside a dashed one; not for bars.
    DashDot,
    /// Accompanies another; bars are grey.
    Thin,
}

impl Stroke {
    /// Its class in the style sheet.
    #[must_use]
    pub const fn class(self) -> &'static str {
        match self {
            Self::Solid => "solid",
            Self::Dashed => "dashed",
            Self::Dotted => "dotted",
            Self::DashDot => "dashdot",
            Self::Thin => "thin",
        }
    }
}

/// A value over a stretch of the x axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Where it begins.
    pub from: f64,
    /// Where it ends; the same as `from` for a point without extent.
    pub to: f64,
    /// Where it stands, `None` if the device has no value here.
    pub y: Option<f64>,
    /// The value as decoded, without unit.
    pub text: String,
    /// What else is known, such as when it was entered.
    pub note: String,
}

impl Point {
    /// The middle of its extent.
    #[must_use]
    pub fn middle(&self) -> f64 {
        f64::midpoint(self.from, self.to)
    }
}

/// Points that belong together.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Identifier, for hooks and files.
    pub key: String,
    /// Its name, short enough to stand at the end of a line.
    pub label: String,
    /// How its points are joined.
    pub shape: Shape,
    /// How it is told from the others.
    pub stroke: Stroke,
    /// Its points, by ascending place.
    pub points: Vec<Point>,
}

/// A chart.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// Identifier, for hooks and names of files.
    pub key: String,
    /// Its title.
    pub title: String,
    /// The axis from left to right.
    pub x: Axis,
    /// The axis upwards.
    pub y: Axis,
    /// What is drawn, the most important last.
    pub series: Vec<Series>,
    /// Pairs of series between which a band is drawn.
    pub bands: Vec<(usize, usize)>,
    /// What is to be known about the picture, in words.
    pub notes: Vec<String>,
}

impl Chart {
    /// The extent of all points along x; `None` without points.
    #[must_use]
    pub fn extent(&self) -> Option<(f64, f64)> {
        if let Kind::Names(names) = &self.x.kind {
            return u32::try_from(names.len()).ok().map(|n| (0.0, f64::from(n)));
        }
        let points = self.series.iter().flat_map(|s| &s.points);
        points.fold(None, |extent, p| {
            let (low, high) = extent.unwrap_or((p.from, p.to));
            Some((low.min(p.from), high.max(p.to)))
        })
    }

    /// The series that have values: all but rules.
    pub fn lines(&self) -> impl Iterator<Item = &Series> + Clone {
        self.series.iter().filter(|s| s.shape != Shape::Rule)
    }

    /// True if there is nothing to draw.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        let mut points = self.series.iter().flat_map(|s| &s.points);
        points.all(|p| p.y.is_none())
    }

    /// True if it has bars, which stand on zero.
    #[must_use]
    pub fn has_bars(&self) -> bool {
        self.series.iter().any(|s| s.shape == Shape::Bar)
    }
}

/// What of a chart is shown, and where the cursor stands.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct View {
    /// The part of the x axis that is shown, `None` for all of it.
    pub range: Option<(f64, f64)>,
    /// The stop at which the cursor stands.
    pub cursor: Option<usize>,
    /// Two places of the x axis between which is being dragged.
    pub drag: Option<(f64, f64)>,
}

#[cfg(test)]
pub(crate) mod sample {
    use super::*;

    /// A series of points without extent, from pairs.
    pub(crate) fn line(key: &str, stroke: Stroke, points: &[(f64, f64)]) -> Series {
        Series {
            key: key.to_owned(),
            label: key.to_owned(),
            shape: Shape::Line,
            stroke,
            points: points
                .iter()
                .map(|&(x, y)| Point {
                    from: x,
                    to: x,
                    y: Some(y),
                    text: format!("{y}"),
                    note: String::new(),
                })
                .collect(),
        }
    }

    /// Torque over position, a recent stroke and its reference.
    pub(crate) fn torque() -> Chart {
        Chart {
            key: "torque".into(),
            title: "Torque".into(),
            x: Axis::number("Position", "%"),
            y: Axis::number("Torque", "%"),
            series: vec![
                line("reference", Stroke::Dashed, &[(0.0, 10.0), (100.0, 30.0)]),
                line(
                    "recent",
                    Stroke::Solid,
                    &[(0.0, 0.0), (50.0, 40.0), (100.0, 20.0)],
                ),
            ],
            bands: Vec::new(),
            notes: Vec::new(),
        }
    }

    /// Seconds by vibration, with two widths of bins.
    pub(crate) fn bars() -> Chart {
        let bin = |from, to, y: f64| Point {
            from,
            to,
            y: Some(y),
            text: format!("{y}"),
            note: "2026-01-01".into(),
        };
        Chart {
            key: "bins".into(),
            title: "Time by vibration".into(),
            x: Axis::number("Vibration", "G"),
            y: Axis::number("Time", "s"),
            series: vec![Series {
                key: "time".into(),
                label: "Time".into(),
                shape: Shape::Bar,
                stroke: Stroke::Solid,
                points: vec![
                    bin(0.0, 2.0, 100.0),
                    bin(2.0, 4.0, 50.0),
                    bin(4.0, 10.0, 25.0),
                ],
            }],
            bands: Vec::new(),
            notes: Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extents_cover_every_point() {
        assert_eq!(sample::torque().extent(), Some((0.0, 100.0)));
        assert_eq!(sample::bars().extent(), Some((0.0, 10.0)));
        let mut named = sample::bars();
        named.x = Axis::names("Axis", &["X", "Y", "Z"]);
        assert_eq!(named.extent(), Some((0.0, 3.0)));
        named.series.clear();
        named.x = Axis::time();
        assert_eq!(named.extent(), None);
        assert!(named.is_empty() && !named.has_bars());
    }

    #[test]
    fn captions_name_the_unit() {
        assert_eq!(Axis::number("Torque", "%").caption(), "Torque, %");
        assert_eq!(Axis::number("Starts", "").caption(), "Starts");
    }
}
