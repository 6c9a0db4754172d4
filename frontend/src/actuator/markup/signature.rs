//! What is measured on torque curves, how far they moved from their reference, and a verdict whose
//! thresholds are said.

use shared::address::{Address, Table};
use shared::icon3000::curve::{
    BREAK_AWAY_ZONE, Curve, DRIFT_ACT, DRIFT_WATCH, Direction, Drift, MARGIN_WATCH, Peak,
    RUNNING_FROM, SEATING_ZONE, Signature, Verdict, drift, judge, margin,
};
use shared::problem::Severity;

use super::heading;
use crate::actuator::state::curves::Trace;
use crate::actuator::state::dossier::Dossier;
use crate::markup::Markup;

/// Torque settings of the opening and of the closing stroke, in percent.
pub const SETTINGS: (u16, u16) = (3670, 2);

/// The numbers of the curves that are shown, each against the reference of its direction: the one
/// in a file for files, the one in the registers for registers, or the other where there is none.
pub fn signatures(html: &mut Markup, dossier: &Dossier, shown: &[&Trace], all: &[Trace]) {
    if shown.is_empty() {
        return;
    }
    heading(
        html,
        "Measured",
        "break-away, running and seating are our zones",
    );
    html.open("div", &[("class", "icon-table")]);
    html.open(
        "table",
        &[("class", "plain"), ("data-testid", "signatures")],
    )
    .open("thead", &[])
    .open("tr", &[]);
    for name in [
        "Stroke",
        "Break-away",
        "Running",
        "Seating",
        "Peak",
        "Left to the setting",
        "Verdict",
    ] {
        html.open("th", &[("scope", "col")]).text(name).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for trace in shown {
        let reference = reference_of(trace, all);
        row(html, dossier, trace, reference);
    }
    html.close("tbody").close("table").close("div");
    html.open("p", &[("class", "quiet"), ("data-testid", "thresholds")]);
    html.text(&thresholds()).close("p");
}

/// What the numbers are and when they count, in words.
#[must_use]
pub fn thresholds() -> String {
    format!(
        "Break-away is the largest torque in the first {BREAK_AWAY_ZONE} % of travel, seating that \
         in the last {SEATING_ZONE} %, running the mean from {RUNNING_FROM} to {} %. A change of \
         one of them against the reference by {DRIFT_WATCH} points of percent or more pays a look, \
         by {DRIFT_ACT} an inspection; so does a peak within {MARGIN_WATCH} points of the torque \
         setting (HR 3670, 3671), or at it. Zones and thresholds are ours, not the manufacturer's.",
        100 - RUNNING_FROM
    )
}

/// The reference that a curve is compared with.
#[must_use]
pub fn reference_of<'t>(trace: &Trace, all: &'t [Trace]) -> Option<&'t Trace> {
    if trace.is_reference() {
        return None;
    }
    let fits = |t: &&Trace| t.is_reference() && t.opening == trace.opening;
    let kind = |t: &Trace| t.key.starts_with("file");
    let mut references = all.iter().filter(fits);
    let same = references.clone().find(|t| kind(t) == kind(trace));
    same.or_else(|| references.next())
}

fn row(html: &mut Markup, dossier: &Dossier, trace: &Trace, reference: Option<&Trace>) {
    let measured = trace.curve.signature();
    let moved = reference.and_then(|r| drift(&r.curve, &trace.curve));
    html.open(
        "tr",
        &[("data-testid", "signature"), ("data-trace", &trace.key)],
    );
    html.open("th", &[("scope", "row")]);
    html.text(&trace.label).text(" ");
    html.node("span", "quiet", &trace.place).close("th");
    let Signature {
        break_away,
        running_tenths,
        seating,
        peak,
    } = measured;
    cell(
        html,
        "break-away",
        break_away.map(at),
        moved.and_then(|d| d.break_away).map(points),
    );
    let running = running_tenths.map(|t| format!("{} %", tenths(t)));
    let moved_running = moved.and_then(|d| d.running_tenths);
    let change = moved_running.map(|t| format!("{}{}", sign(t), tenths(t.abs())));
    cell(html, "running", running, change);
    cell(
        html,
        "seating",
        seating.map(at),
        moved.and_then(|d| d.seating).map(points),
    );
    cell(html, "peak", peak.map(at), None);
    let left = peak.and_then(|peak| Some(margin(peak, setting(dossier, &trace.curve)?)));
    let words = left.map(|(left, _)| format!("{left} points"));
    cell(html, "margin", words, None);
    html.open("td", &[("data-cell", "verdict")]);
    verdict(html, trace, reference, moved.as_ref(), left.map(|(_, v)| v));
    html.close("td").close("tr");
}

/// The torque setting of a direction.
fn setting(dossier: &Dossier, curve: &Curve) -> Option<u16> {
    let address = match curve.direction {
        Direction::Open => SETTINGS.0,
        Direction::Close => SETTINGS.0 + 1,
    };
    let cell = dossier.image.cell(Table::Holding, Address::new(address));
    cell.map(|c| c.word).filter(|percent| *percent > 0)
}

/// The verdict of a curve, with the reason.
fn verdict(
    html: &mut Markup,
    trace: &Trace,
    reference: Option<&Trace>,
    moved: Option<&Drift>,
    left: Option<Verdict>,
) {
    let judged = moved.map_or(Verdict::Unknown, judge);
    let mark = match judged.max(left.unwrap_or(Verdict::Unknown)) {
        Verdict::Act => Some(Severity::Error),
        Verdict::Watch => Some(Severity::Warning),
        Verdict::Steady | Verdict::Unknown => None,
    };
    if let Some(mark) = mark {
        html.severity(mark).text(" ");
    }
    match (trace.is_reference(), reference) {
        (true, _) => {
            html.text("is the reference");
        }
        (false, None) => {
            html.text("no reference of this direction was read");
        }
        (false, Some(reference)) => {
            html.node("b", "", judged.label());
            if let Some(moved) = moved {
                let largest = moved.largest.map(|(position, by)| {
                    format!("largest change {} points at {position} %", points(by))
                });
                let mean = moved
                    .mean_tenths
                    .map(|t| format!("mean {} points", tenths(t)));
                let words: Vec<_> = [largest, mean].into_iter().flatten().collect();
                let words = format!(" {}, against {}", words.join(", "), reference.place);
                html.node("span", "quiet", &words);
            }
        }
    }
    match left {
        Some(Verdict::Act) => {
            html.text("; the peak is at the torque setting");
        }
        Some(Verdict::Watch) => {
            html.text("; the peak is near the torque setting");
        }
        _ => {}
    }
}

fn cell(html: &mut Markup, key: &str, text: Option<String>, change: Option<String>) {
    html.open("td", &[("class", "num"), ("data-cell", key)]);
    match text {
        Some(text) => {
            html.text(&text);
        }
        None => {
            html.node("span", "quiet", "not known");
        }
    }
    if let Some(change) = change {
        html.text(" ")
            .node("span", "quiet change", &format!("({change})"));
    }
    html.close("td");
}

fn at(peak: Peak) -> String {
    format!("{} % at {} %", peak.torque, peak.position)
}

/// A change with its sign.
fn points(by: i32) -> String {
    format!("{}{}", sign(by), by.unsigned_abs())
}

const fn sign(by: i32) -> &'static str {
    match by {
        0 => "±",
        1.. => "+",
        _ => "\u{2212}",
    }
}

fn tenths(value: i32) -> String {
    let sign = if value < 0 { "\u{2212}" } else { "" };
    let value = value.unsigned_abs();
    format!("{sign}{}.{}", value / 10, value % 10)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;
    use crate::actuator::state::curves::traces;
    use crate::actuator::state::logs::tests::put;

    /// 20 % everywhere; the latest has 45 % at 3 % of an opening stroke and 23 % in the middle.
    fn dossier() -> Dossier {
        let mut dossier = device(&[(3670, &[50, 50])]);
        let mut words = vec![20; 101];
        words.extend([0; 7]);
        put(&mut dossier, 1000, &words);
        words[3] = 45;
        words[20..=80].fill(23);
        put(&mut dossier, 1001, &words);
        dossier
    }

    #[test]
    fn numbers_drift_and_verdict() {
        let dossier = dossier();
        let all = traces(&dossier);
        let shown: Vec<_> = all.iter().collect();
        let mut html = Markup::new();
        signatures(&mut html, &dossier, &shown, &all);
        let html = html.finish();
        for part in [
            "45 % at 3 %",
            "(+25)",
            "23.0 %",
            "(+3.0)",
            "20 % at 90 %",
            "(±0)",
            "5 points",
            "inspect the valve",
            "largest change +25 points at 3 %",
            "against file 1000",
            "near the torque setting",
            "is the reference",
            "by 10 points of percent or more",
        ] {
            assert!(html.contains(part), "{part}: {html}");
        }
    }

    #[test]
    fn without_a_reference_nothing_is_judged() {
        let mut dossier = device(&[]);
        put(&mut dossier, 2001, &[9; 108]);
        let all = traces(&dossier);
        let shown: Vec<_> = all.iter().collect();
        let mut html = Markup::new();
        signatures(&mut html, &dossier, &shown, &all);
        let html = html.finish();
        assert!(html.contains("no reference of this direction was read"));
        assert!(html.contains("not known"), "{html}");
    }
}
