//! Partial strokes (PST) and emergency strokes (EFS): time over position, limits, the result in
//! words.

use shared::icon3000::stroke::{Stroke as Told, limits as told_limits};
use shared::icon3000::{Item, Log};
use shared::scale::Scale;
use shared::value::{Quality, Value};

use super::curves::points;
use super::dossier::Dossier;
use super::logs::Y2K;
use crate::chart::time::stamp;
use crate::chart::{Axis, Chart, Point, Series, Shape, Stroke as Line};

/// Settings of partial strokes: HR 3615 travel, 3616 Max T-PST, 3618 Max T-RET, 3619 Max OV-TR.
pub const LIMITS: (u16, u16) = (3614, 6);

/// What kind of stroke.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Partial stroke: there and back.
    Pst,
    /// Emergency stroke by the EFS: one way.
    Efs,
}

impl Kind {
    /// The file of its reference.
    #[must_use]
    pub const fn first(self) -> u16 {
        match self {
            Self::Pst => 3000,
            Self::Efs => 3500,
        }
    }
}

/// A stroke.
#[derive(Clone, Debug, PartialEq)]
pub struct Stroke {
    /// Which kind.
    pub kind: Kind,
    /// Its number: 0 is the reference, 1 the latest.
    pub number: u16,
    /// True if it opens.
    pub opening: Option<bool>,
    /// Tenths of a second to each percent of travel from the start, 0 being the start itself.
    pub out: Vec<Option<i64>>,
    /// The same on the way back, from 1 percent on; empty for an EFS.
    pub back: Vec<Option<i64>>,
    /// When, in seconds since 1970 by the clock of the device.
    pub time: Option<i64>,
    /// Travel in percent that it was to reach; `None` for an EFS, which goes all the way.
    pub travel: Option<i64>,
    /// The stroke as its file tells it.
    pub told: Told,
    /// All other values of the file.
    pub items: Vec<Item>,
    /// Where the manual describes it.
    pub source: String,
}

impl Stroke {
    /// A value of the file.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Item> {
        self.items.iter().find(|item| item.field.key == key)
    }

    /// What it is called.
    #[must_use]
    pub fn label(&self) -> String {
        let kind = match self.kind {
            Kind::Pst => "PST",
            Kind::Efs => "EFS",
        };
        match self.number {
            0 => format!("{kind} reference"),
            1 => format!("{kind} latest"),
            n => format!("{kind} {n} back", n = n - 1),
        }
    }

    /// When it was made, or that nothing tells.
    #[must_use]
    pub fn when(&self) -> String {
        self.time.map_or_else(|| "no date".to_owned(), stamp)
    }

    /// The code of its result; only a PST has one.
    #[must_use]
    pub fn result(&self) -> Option<u32> {
        match self.get("result")?.value {
            Value::Code { raw, .. } => Some(raw),
            _ => None,
        }
    }

    /// How it ended, in words.
    #[must_use]
    pub fn verdict(&self) -> String {
        let mut words = self.told.in_words();
        if self.told.is_contradictory() {
            words.push_str(" The status bits say otherwise; the file keeps both.");
        }
        words
    }
}

/// All strokes of a kind that were read, the reference first, then the latest.
#[must_use]
pub fn strokes(dossier: &Dossier, kind: Kind) -> Vec<Stroke> {
    let first = kind.first();
    let files = dossier.files.range(first..=first + 16);
    files
        .filter_map(|(&number, _)| {
            let told = Told::of_file(number, &dossier.records(number, 0))?;
            Some(of_file(&dossier.log(number)?, told, kind, number - first))
        })
        .collect()
}

fn of_file(log: &Log, told: Told, kind: Kind, number: u16) -> Stroke {
    let run = |key: &str| -> Vec<Option<i64>> {
        let items = log.run(key);
        items.iter().map(|i| i.and_then(Item::number)).collect()
    };
    let runs = ["t_pst_at", "t_ret_at", "t_efs_at"];
    let items = log.head.iter().flatten();
    let items: Vec<Item> = items
        .filter(|i| !runs.contains(&i.field.key) && i.field.key != "reserved")
        .cloned()
        .collect();
    let find = |key: &str| items.iter().find(|i| i.field.key == key);
    let travel = find("travel_limit").and_then(Item::number);
    let opening = find("direction").and_then(|i| match (i.value, i.quality) {
        (Value::Code { raw, .. }, Quality::Good) => Some(raw == 1),
        _ => None,
    });
    let (mut out, mut back) = match kind {
        Kind::Pst => (run("t_pst_at"), run("t_ret_at")),
        Kind::Efs => (run("t_efs_at"), Vec::new()),
    };
    if kind == Kind::Pst {
        unreached(&mut out);
        unreached(&mut back);
    }
    Stroke {
        kind,
        number,
        opening,
        out,
        back,
        time: find("time")
            .and_then(Item::time)
            .map(|t| Y2K + i64::from(t)),
        travel,
        source: log.file.source.to_string(),
        told,
        items,
    }
}

/// The part of a stroke that has values: what was not reached takes no room in a picture.
fn reached(times: &[Option<i64>]) -> &[Option<i64>] {
    let last = times.iter().rposition(Option::is_some);
    times.get(..last.map_or(0, |at| at + 1)).unwrap_or(times)
}

/// Reading E78: what stands in places that were not reached is not stated, 0 is presumed. Zeros at
/// the end are left out; the first is the start.
fn unreached(times: &mut [Option<i64>]) {
    for time in times.iter_mut().skip(1).rev() {
        if time.is_some_and(|t| t != 0) {
            break;
        }
        *time = None;
    }
}

/// Limits of partial strokes as they are set, and what they come to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Tenths of a second that the way out may take.
    pub out: Option<i64>,
    /// Tenths of a second that the way back may take.
    pub back: Option<i64>,
    /// Percent of travel, in tenths, that it may go beyond its limit.
    pub beyond: Option<i64>,
    /// How they were worked out, in words.
    pub words: Vec<String>,
}

/// The limits: those in HR 3616, 3618 and 3619 are percent. Reading E89: of what is not stated; times
/// are taken as relative to the reference, OV-TR as percent of the stroke.
#[must_use]
pub fn limits(dossier: &Dossier, reference: Option<&Stroke>) -> Limits {
    let mut limits = Limits::default();
    for limit in told_limits(&dossier.image, reference.map(|r| &r.told)) {
        let (Some(percent), Some(tenths)) = (limit.percent, limit.presumed_tenths) else {
            continue;
        };
        let tenths = i64::from(tenths);
        let (slot, unit, of) = match limit.key {
            "t_pst" => (&mut limits.out, "s", "time of the reference"),
            "t_ret" => (&mut limits.back, "s", "time of the reference"),
            _ => (&mut limits.beyond, "% beyond the travel", "stroke"),
        };
        *slot = Some(tenths);
        limits.words.push(format!(
            "{} {} {unit}: {percent} % (HR {}) of the {of}, presumed (reading E89)",
            limit.label,
            Scale::TENTH.apply(tenths),
            limit.register
        ));
    }
    limits
}

/// Time over position: the stroke, its reference dashed, the limits.
#[must_use]
pub fn chart(stroke: &Stroke, reference: Option<&Stroke>, limits: &Limits) -> Chart {
    let mut series = Vec::new();
    let reference = reference.filter(|r| r.number != stroke.number);
    let line = |key: &str, label: String, line, from, times: &[Option<i64>]| Series {
        key: key.to_owned(),
        label,
        shape: Shape::Line,
        stroke: line,
        points: points(from, reached(times), Scale::TENTH),
    };
    if let Some(reference) = reference {
        series.push(line(
            "reference",
            "reference".into(),
            Line::Dashed,
            0,
            &reference.out,
        ));
        if !reference.back.is_empty() {
            let label = "reference, back".to_owned();
            series.push(line(
                "reference-back",
                label,
                Line::DashDot,
                1,
                &reference.back,
            ));
        }
    }
    let pst = stroke.kind == Kind::Pst;
    let reach = stroke.travel.filter(|t| (1..=50).contains(t)).unwrap_or(50);
    let level = |key: &str, label: &str, tenths: Option<i64>| {
        let tenths = tenths.filter(|_| pst)?;
        let count = usize::try_from(reach).unwrap_or(50) + 1;
        let level = vec![Some(tenths); count];
        Some(line(key, label.to_owned(), Line::Thin, 0, &level))
    };
    series.extend(level("limit", "T-PST limit", limits.out));
    series.extend(level("limit-back", "T-RET limit", limits.back));
    if let (Some(travel), true) = (stroke.travel, pst) {
        let rule = |key: &str, label: String, tenths: i64| Series {
            key: key.to_owned(),
            label,
            shape: Shape::Rule,
            stroke: Line::Dotted,
            points: vec![Point {
                from: Scale::TENTH.to_f64(tenths),
                to: Scale::TENTH.to_f64(tenths),
                y: None,
                text: String::new(),
                note: String::new(),
            }],
        };
        series.push(rule("travel", format!("travel {travel} %"), travel * 10));
        if let Some(beyond) = limits.beyond {
            let end = travel * 10 + beyond;
            let label = format!("OV-TR {} %", Scale::TENTH.apply(end));
            series.push(rule("ov-tr", label, end));
        }
    }
    if pst {
        series.push(line("back", "back".into(), Line::Dotted, 1, &stroke.back));
    }
    series.push(line(
        "out",
        if pst { "out" } else { "stroke" }.into(),
        Line::Solid,
        0,
        &stroke.out,
    ));
    let start = match stroke.opening {
        Some(true) => "Travel from 0 %",
        Some(false) => "Travel from 100 %",
        None => "Travel from the start",
    };
    Chart {
        key: if pst { "pst" } else { "efs" }.to_owned(),
        title: format!("{}, {}: time over position", stroke.label(), stroke.when()),
        x: Axis::number(start, "%"),
        y: Axis::number("Time", "s"),
        series,
        bands: Vec::new(),
        notes: if pst {
            limits.words.clone()
        } else {
            Vec::new()
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::put as put_registers;
    use crate::actuator::state::logs::tests::put;
    use shared::device::Device;

    /// A PST of table 39: 0.2 s to start, then `out` tenths for each percent of 20 and 0.1 s back;
    /// its result, direction 1 (open), T-PST, T-RET, OV-TR in tenths, travel 20 %, its status.
    fn pst(out: u16, result: u16, status: u16) -> Vec<u16> {
        let mut words = vec![2];
        words.extend((1..=50).map(|p| if p <= 20 { 2 + p * out } else { 0 }));
        words.extend((1..=50).map(|p| if p <= 20 { 21 - p } else { 0 }));
        words.extend([0, 60, 21, 22, 30, 25, 400]);
        words.extend([result, 1, 2 + 20 * out, 20, 5, 20, 1, status, 0, 0b10]);
        assert_eq!(words.len(), 118);
        words
    }

    fn device() -> Dossier {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        put(&mut dossier, 3000, &pst(2, 1, 1));
        put(&mut dossier, 3001, &pst(3, 4, 0b10));
        put_registers(&mut dossier, 3614, &[0, 20, 150, 0, 200, 10], 1);
        dossier
    }

    #[test]
    fn times_limits_and_result_are_read() {
        let dossier = device();
        let all = strokes(&dossier, Kind::Pst);
        let [reference, latest] = &all[..] else {
            panic!("{all:?}");
        };
        assert_eq!(latest.out[20], Some(62));
        assert_eq!(
            (latest.out[21], latest.back[19], latest.back[20]),
            (None, Some(1), None)
        );
        assert_eq!((latest.opening, latest.travel), (Some(true), Some(20)));
        let verdict = reference.verdict();
        assert!(
            verdict.starts_with("Passed") && verdict.contains("4.2 s"),
            "{verdict}"
        );
        assert!(latest.verdict().contains("longer than T-PST allows"));
        assert_eq!(latest.when(), "2000-01-01 00:01:00");
        // 150 % of 4.2 s, 200 % of 2.0 s.
        let limits = limits(&dossier, Some(reference));
        assert_eq!(
            (limits.out, limits.back, limits.beyond),
            (Some(63), Some(40), Some(100))
        );
        let chart = chart(latest, Some(reference), &limits);
        let series = |key: &str| chart.series.iter().find(|s| s.key == key).unwrap();
        assert_eq!(series("out").points[20].y, Some(6.2));
        assert_eq!(series("out").points[20].text, "6.2");
        assert_eq!(series("limit").points[0].y, Some(6.3));
        assert_eq!(series("ov-tr").points[0].from, 30.0);
        assert_eq!(series("back").points[0].from, 1.0);
        assert_eq!(chart.notes.len(), 3);
    }

    #[test]
    fn codes_without_a_name_say_so() {
        let mut dossier = device();
        put(&mut dossier, 3001, &pst(3, 0, 0));
        let all = strokes(&dossier, Kind::Pst);
        assert!(
            all[1].verdict().contains("unknown code 0"),
            "{}",
            all[1].verdict()
        );
    }

    /// An EFS of table 40: a tenth of a second for each percent.
    #[test]
    fn an_efs_goes_one_way() {
        let mut dossier = Dossier::new("XV", Device::Icon3000v2);
        let mut words: Vec<u16> = (0..=100).collect();
        words.extend([0, 60, 21, 22, 30, 25, 400, 0, 0]);
        put(&mut dossier, 3501, &words);
        let all = strokes(&dossier, Kind::Efs);
        assert_eq!(all[0].verdict(), "Emergency stroke to 0 % in 10.0 s.");
        assert_eq!(all[0].opening, Some(false));
        let chart = chart(&all[0], None, &Limits::default());
        assert_eq!(chart.series.len(), 1);
        assert_eq!(chart.x.label, "Travel from 100 %");
    }
}
