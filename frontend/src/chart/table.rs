//! The numbers behind a chart: one row for each place.

use super::cursor::{place, point_at, stops};
use super::{Chart, Kind};
use crate::markup::Markup;

/// Names of the columns: the place, then the series with their unit.
#[must_use]
pub fn head(chart: &Chart) -> Vec<String> {
    let mut head = vec![chart.x.label.clone()];
    for series in chart.lines() {
        let unit = &chart.y.unit;
        head.push(if unit.is_empty() {
            series.label.clone()
        } else {
            format!("{}, {unit}", series.label)
        });
        if has_notes(chart, &series.key) {
            head.push(format!("{}, entered", series.label));
        }
    }
    head
}

fn has_notes(chart: &Chart, key: &str) -> bool {
    let series = chart.series.iter().find(|s| s.key == key);
    series.is_some_and(|s| s.points.iter().any(|p| !p.note.is_empty()))
}

/// The rows, as text; a place without value has an empty cell.
#[must_use]
pub fn rows(chart: &Chart) -> Vec<Vec<String>> {
    let row = |stop| {
        let mut cells = vec![place(chart, stop)];
        for series in chart.lines() {
            let point = point_at(series, stop).filter(|p| p.y.is_some());
            cells.push(point.map(|p| p.text.clone()).unwrap_or_default());
            if has_notes(chart, &series.key) {
                cells.push(point.map(|p| p.note.clone()).unwrap_or_default());
            }
        }
        cells
    };
    stops(chart).into_iter().map(row).collect()
}

/// Draws the table.
pub fn draw(html: &mut Markup, chart: &Chart) {
    html.open(
        "table",
        &[
            ("class", "plain chart-table"),
            ("data-testid", "chart-table"),
        ],
    );
    html.open("thead", &[]).open("tr", &[]);
    for name in head(chart) {
        html.open("th", &[("scope", "col")]).text(&name).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for row in rows(chart) {
        html.open("tr", &[]);
        for (at, cell) in row.iter().enumerate() {
            if at == 0 {
                html.open("th", &[("scope", "row")]).text(cell).close("th");
            } else {
                html.node("td", "num", if cell.is_empty() { "–" } else { cell });
            }
        }
        html.close("tr");
    }
    html.close("tbody").close("table");
}

/// The table as comma-separated values with a head line. Minus signs are those of programs.
#[must_use]
pub fn csv(chart: &Chart) -> String {
    let mut out = String::new();
    let mut head = head(chart);
    if let (Some(first), true) = (head.first_mut(), chart.x.kind != Kind::Time) {
        *first = chart.x.caption();
    }
    for row in core::iter::once(head).chain(rows(chart)) {
        for (at, cell) in row.iter().enumerate() {
            if at > 0 {
                out.push(',');
            }
            quote(&mut out, cell);
        }
        out.push('\n');
    }
    out
}

/// Writes a cell of comma-separated values.
pub fn quote(out: &mut String, cell: &str) {
    let cell = cell.replace('\u{2212}', "-");
    // A program of spreadsheets runs what begins like a formula; a number is none.
    let risky = cell.starts_with(['=', '+', '@', '\t'])
        || (cell.starts_with('-') && !cell[1..].starts_with(|c: char| c.is_ascii_digit()));
    if risky || cell.contains([',', '"', '\n', '\r']) {
        out.push('"');
        if risky {
            out.push('\'');
        }
        out.push_str(&cell.replace('"', "\"\""));
        out.push('"');
    } else {
        out.push_str(&cell);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::sample::{bars, torque};

    #[test]
    fn every_place_has_its_row() {
        assert_eq!(
            csv(&torque()),
            "\"Position, %\",\"reference, %\",\"recent, %\"\n0 %,10,0\n50 %,,40\n100 %,30,20\n"
        );
        assert_eq!(csv(&bars()).lines().nth(3), Some("4 to 10 G,25,2026-01-01"));
        let mut html = Markup::new();
        draw(&mut html, &torque());
        let html = html.finish();
        assert_eq!(html.matches("<tr>").count(), 4, "{html}");
        assert!(html.contains("<td class=\"num\">–</td>"));
    }

    #[test]
    fn cells_are_quoted_and_never_formulas() {
        let quoted = |cell: &str| {
            let mut out = String::new();
            quote(&mut out, cell);
            out
        };
        assert_eq!(quoted("\u{2212}12.5"), "-12.5");
        assert_eq!(quoted("a \"b\", c"), "\"a \"\"b\"\", c\"");
        assert_eq!(quoted("=1+1"), "\"'=1+1\"");
        assert_eq!(quoted("-x"), "\"'-x\"");
    }
}
