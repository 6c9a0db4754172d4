//! Torque signatures: every curve that a device holds, from its registers and from its files.

use shared::few;
use shared::icon3000::curve::{Curve, Direction, Origin, Which};
use shared::map::row::{Kind, Row};
use shared::scale::Scale;

use super::dossier::Dossier;
use crate::chart::{Axis, Chart, Point, Series, Shape, Stroke};

/// Files of torque curves: those of the opening and of the closing strokes.
pub const FILES: [(u16, bool); 2] = [(1000, true), (2000, false)];

/// A torque curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Identifier: `hr-3328`, `ir-241`, `file-1001`.
    pub key: String,
    /// What it is: `Open, latest`.
    pub label: String,
    /// Where it is from: `HR 3328 to 3391`, `file 1001`.
    pub place: String,
    /// True for an opening stroke.
    pub opening: bool,
    /// Its number among those of its kind: 0 is the reference, 1 the latest.
    pub number: u16,
    /// The curve itself.
    pub curve: Curve,
}

impl Trace {
    /// True for a reference.
    #[must_use]
    pub const fn is_reference(&self) -> bool {
        self.number == 0
    }

    /// When it was made by the clock of the device, or that nothing tells.
    #[must_use]
    pub fn when(&self) -> String {
        let when = self.curve.when.clone();
        when.unwrap_or_else(|| "no date".to_owned())
    }

    /// Torque in percent at 0 to 100 %; `None` where it was not read.
    #[must_use]
    pub fn samples(&self) -> Vec<Option<i64>> {
        let samples = self.curve.samples.iter();
        samples.map(|s| s.map(i64::from)).collect()
    }

    /// What else was noted at the stroke: name, text, unit. What was not read is empty.
    #[must_use]
    pub fn facts(&self) -> [(&'static str, String, &'static str); 5] {
        let curve = &self.curve;
        let [electronics, terminals, motor] = curve
            .temperatures
            .map(|t| t.map_or_else(String::new, |t| t.to_string()));
        let word = |word: Option<u16>| word.map_or_else(String::new, |w| w.to_string());
        [
            ("Stroke time", word(curve.stroke_time), "s"),
            ("Voltage", word(curve.voltage), "V"),
            ("Electronics", electronics, "°C"),
            ("Terminal board", terminals, "°C"),
            ("Motor", motor, "°C"),
        ]
    }
}

/// Every curve that was read and holds one, the opening ones first, by number.
#[must_use]
pub fn traces(dossier: &Dossier) -> Vec<Trace> {
    let mut found: Vec<Trace> = rows(dossier)
        .into_iter()
        .filter_map(|row| of_registers(dossier, row))
        .collect();
    for (first, _) in FILES {
        for (&number, _) in dossier.files.range(first..=first + 100) {
            let curve = Curve::of_file(number, &dossier.records(number, 0));
            found.extend(curve.map(|curve| trace(curve, format!("file-{number}"))));
        }
    }
    few::sort_by_key(&mut found, |trace| (!trace.opening, trace.number));
    found
}

/// Rows of the map that hold a curve.
#[must_use]
pub fn rows(dossier: &Dossier) -> Vec<&'static Row> {
    dossier.rows(&|row| row.kind == Kind::Curve)
}

fn of_registers(dossier: &Dossier, row: &'static Row) -> Option<Trace> {
    let bytes = dossier.image.bytes(row)?;
    let curve = Curve::of_registers(row, &bytes)?;
    let key = format!("{}-{}", row.table.short().to_ascii_lowercase(), row.address);
    Some(trace(curve, key))
}

fn trace(curve: Curve, key: String) -> Trace {
    let opening = curve.direction == Direction::Open;
    let number = match curve.which {
        Which::Reference => 0,
        Which::Stored(number) => number,
    };
    let place = match curve.origin {
        Origin::Register(row) => {
            let first = row.address.get();
            let last = first.saturating_add(row.words).saturating_sub(1);
            format!("{} {first} to {last}", row.table.short())
        }
        Origin::File(number) => format!("file {number}"),
    };
    Trace {
        key,
        label: name(opening, number),
        place,
        opening,
        number,
        curve,
    }
}

fn name(opening: bool, number: u16) -> String {
    let way = if opening { "Open" } else { "Close" };
    match number {
        0 => format!("{way}, reference"),
        1 => format!("{way}, latest"),
        n => format!("{way}, {n} back", n = n - 1),
    }
}

/// Which curves are chosen by one click.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Reference and latest of the opening strokes.
    Opening,
    /// Reference and latest of the closing strokes.
    Closing,
    /// The latest of both.
    Both,
    /// All.
    All,
}

impl Preset {
    /// All presets with their key and words.
    pub const ALL: [(Self, &'static str, &'static str); 4] = [
        (
            Self::Opening,
            "opening",
            "Opening: latest against reference",
        ),
        (
            Self::Closing,
            "closing",
            "Closing: latest against reference",
        ),
        (Self::Both, "both", "Open against close"),
        (Self::All, "all", "All"),
    ];

    /// The keys of its curves. Of a curve that is in registers and in a file, the file is taken.
    #[must_use]
    pub fn of(self, traces: &[Trace]) -> Vec<String> {
        let wanted = |t: &&Trace| match self {
            Self::Opening => t.opening && t.number <= 1,
            Self::Closing => !t.opening && t.number <= 1,
            Self::Both => t.number == 1,
            Self::All => true,
        };
        let doubled = |t: &Trace| {
            self != Self::All
                && !t.key.starts_with("file")
                && traces.iter().any(|other| {
                    other.key.starts_with("file")
                        && (other.opening, other.number) == (t.opening, t.number)
                })
        };
        let chosen = traces.iter().filter(wanted).filter(|t| !doubled(t));
        chosen.map(|t| t.key.clone()).collect()
    }
}

/// Curves over position, the references first so that the latest lie on top.
#[must_use]
pub fn chart(traces: &[&Trace]) -> Chart {
    let mut order: Vec<&Trace> = traces.to_vec();
    few::sort_by_key(&mut order, |t| {
        (!t.is_reference(), core::cmp::Reverse(t.number))
    });
    let both = order.iter().any(|t| t.opening) && order.iter().any(|t| !t.opening);
    let twice = |t: &Trace| order.iter().filter(|o| o.label == t.label).count() > 1;
    let series = order.iter().map(|t| Series {
        key: t.key.clone(),
        label: if twice(t) {
            format!("{} ({})", t.label, t.place)
        } else {
            t.label.clone()
        },
        shape: Shape::Line,
        stroke: stroke(t, both),
        points: points(0, &t.samples(), Scale::ONE),
    });
    Chart {
        key: "torque".to_owned(),
        title: "Torque over position".to_owned(),
        x: Axis::number("Position", "%"),
        y: Axis::number("Torque", "%"),
        series: series.collect(),
        bands: Vec::new(),
        notes: vec![
            "Percent is presumed for the torque, as in HR 3005: neither registers nor files state \
             its unit (readings E34, E74)."
                .to_owned(),
        ],
    }
}

const fn stroke(trace: &Trace, both: bool) -> Stroke {
    match (trace.number, trace.opening || !both) {
        (0, true) => Stroke::Dashed,
        (0, false) => Stroke::DashDot,
        (1, true) => Stroke::Solid,
        (1, false) => Stroke::Dotted,
        _ => Stroke::Thin,
    }
}

/// Points at `from`, one further and so on.
pub(crate) fn points(from: u32, samples: &[Option<i64>], scale: Scale) -> Vec<Point> {
    (from..)
        .zip(samples)
        .map(|(at, sample)| Point {
            from: f64::from(at),
            to: f64::from(at),
            y: sample.map(|raw| scale.to_f64(raw)),
            text: sample.map_or_else(String::new, |raw| scale.apply(raw).to_string()),
            note: String::new(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::put as put_registers;
    use crate::actuator::state::logs::tests::put;
    use shared::device::Device;

    /// HR 3328 to 3391, last open curve: 10 % everywhere but 40 % at 0 %; 2024-02-29 12:34:56; 25,
    /// 24 and -5 °C; 400 V; 30 s (note 12 of table 5, reading E34).
    fn registers() -> Dossier {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let mut bytes = vec![10_u8; 101];
        bytes[0] = 40;
        bytes.extend([0x29, 0x02, 0x24, 0x56, 0x34, 0x12, 25, 24, 0xFB]);
        bytes.extend([0x01, 0x90, 0x00, 0x1E]);
        bytes.resize(128, 0);
        let words: Vec<u16> = bytes
            .chunks(2)
            .map(|p| u16::from_be_bytes([p[0], p[1]]))
            .collect();
        put_registers(&mut dossier, 3328, &words, 1);
        dossier
    }

    #[test]
    fn register_curves_are_read_byte_by_byte() {
        let traces = traces(&registers());
        let [trace] = &traces[..] else {
            panic!("{traces:?}");
        };
        assert_eq!(
            (trace.key.as_str(), trace.opening, trace.number),
            ("hr-3328", true, 1)
        );
        let samples = trace.samples();
        assert_eq!(samples.len(), 101);
        assert_eq!((samples[0], samples[100]), (Some(40), Some(10)));
        assert_eq!(trace.when(), "2024-02-29 12:34:56");
        let facts = trace.facts().map(|f| f.1);
        assert_eq!(facts, ["30", "400", "25", "24", "-5"]);
    }

    /// The ICON2000v4 has its curves in input registers: 113 last close, 177 reference close, 241
    /// last open, 305 reference open (table 3).
    #[test]
    fn curves_of_an_older_model_are_in_input_registers() {
        let mut dossier = registers();
        let words = dossier.image.bytes(rows(&dossier)[2]).unwrap();
        dossier = Dossier::new("XV", Device::Icon2000v4);
        let starts: Vec<_> = rows(&dossier).iter().map(|r| r.address.get()).collect();
        assert_eq!(starts, [113, 177, 241, 305]);
        let mut response = vec![4, 128];
        response.extend(words);
        assert!(dossier.absorb(&[4, 0, 241, 0, 64], &response, 1));
        let traces = traces(&dossier);
        let [trace] = &traces[..] else {
            panic!("{traces:?}");
        };
        assert_eq!(trace.key, "ir-241");
        assert_eq!(
            (trace.label.as_str(), trace.place.as_str()),
            ("Open, latest", "IR 241 to 304")
        );
        assert_eq!(Preset::Opening.of(&traces), ["ir-241"]);
    }

    /// An actuator that never stored a curve has zeros there, not a curve of no torque.
    #[test]
    fn zeros_are_no_curve() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        put_registers(&mut dossier, 3328, &[0; 64], 1);
        assert!(traces(&dossier).is_empty());
    }

    #[test]
    fn files_and_registers_lie_over_each_other() {
        let mut dossier = registers();
        let mut words = vec![12; 101];
        words.extend([0, 0, 0, 0, 0, 0, 0]);
        for file in [1000, 1001, 1003, 2001] {
            put(&mut dossier, file, &words);
        }
        let traces = traces(&dossier);
        let keys: Vec<_> = traces.iter().map(|t| t.key.as_str()).collect();
        assert_eq!(
            keys,
            [
                "file-1000",
                "hr-3328",
                "file-1001",
                "file-1003",
                "file-2001"
            ]
        );
        assert_eq!(traces[3].label, "Open, 2 back");
        assert_eq!(Preset::Opening.of(&traces), ["file-1000", "file-1001"]);
        assert_eq!(Preset::Both.of(&traces), ["file-1001", "file-2001"]);
        assert_eq!(Preset::All.of(&traces).len(), 5);
        let all: Vec<_> = traces.iter().collect();
        let chart = chart(&all);
        let first = &chart.series[0];
        assert_eq!(
            (first.key.as_str(), first.stroke),
            ("file-1000", Stroke::Dashed)
        );
        assert_eq!(first.points[100].y, Some(12.0));
        let labels: Vec<_> = chart.series.iter().map(|s| s.label.as_str()).collect();
        assert!(
            labels.contains(&"Open, latest (HR 3328 to 3391)"),
            "{labels:?}"
        );
        let close = chart.series.iter().find(|s| s.key == "file-2001").unwrap();
        assert_eq!(close.stroke, Stroke::Dotted);
    }

    /// A curve that was read in part has gaps, never zeros.
    #[test]
    fn what_was_not_read_is_a_gap() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        put(&mut dossier, 1001, &[7; 50]);
        let traces = traces(&dossier);
        let samples = traces[0].samples();
        assert_eq!((samples[49], samples[50]), (Some(7), None));
        assert_eq!(traces[0].when(), "no date");
    }
}
