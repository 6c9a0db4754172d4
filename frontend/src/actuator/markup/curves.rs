//! Curves: what there is, what is shown, and the numbers behind them.

use shared::few;

use super::super::state::curves::{Preset, Trace};
use super::super::state::dossier::Dossier;
use super::super::state::strokes::{Kind, Limits, Stroke};
use super::super::state::trends::RECORDERS;
use super::super::state::wanted::stored;
use super::reading;
use crate::format::count;
use crate::markup::Markup;
use shared::map::row::Trust;
use shared::problem::Severity;
use shared::value::Quality;

/// Which curves are open. `address` makes the address of a choice.
pub fn choose(html: &mut Markup, open: &str, address: impl Fn(&str) -> String) {
    for (key, name) in [
        ("", "Torque signatures"),
        ("pst", "Partial strokes (PST)"),
        ("efs", "Emergency strokes (EFS)"),
        ("trends", "Trends"),
    ] {
        let query = if key.is_empty() {
            String::new()
        } else {
            format!("show={key}")
        };
        let here = key == open;
        html.open(
            "a",
            &[
                ("class", "option"),
                ("href", &address(&query)),
                ("data-testid", "curves-show"),
                ("data-show", key),
                ("aria-current", if here { "page" } else { "false" }),
            ],
        );
        html.text(name).close("a");
    }
}

/// How many curves the device has stored.
pub fn stored_line(html: &mut Markup, dossier: &Dossier) {
    let stored = stored(dossier);
    if stored.iter().all(Option::is_none) {
        return;
    }
    let names = ["opening", "closing", "PST", "EFS"];
    let words = names.iter().zip(stored).map(|(name, n)| match n {
        Some(n) => format!("{n} {name}"),
        None => format!("{name} not read"),
    });
    let words: Vec<_> = words.collect();
    html.open("p", &[("class", "quiet"), ("data-testid", "stored")]);
    html.text(&format!(
        "Stored in the device besides the references: {} (HR 3511 to 3514).",
        words.join(", ")
    ))
    .close("p");
}

/// Why there is nothing to see, and what to do.
pub fn nothing(html: &mut Markup, dossier: &Dossier, live: bool) {
    html.open("p", &[("class", "empty"), ("data-testid", "icon-nothing")]);
    let old = dossier.device.map().is_some_and(|map| !map.implements(20));
    html.text(if old {
        "This model has no files (FC 20 came with the ICON3000v2). The torque curves in its registers are all it tells."
    } else if live {
        "No curve was read that holds one. Read them; if the device answers and stays empty, it has stored none."
    } else {
        "The snapshot holds no curve of this kind."
    })
    .close("p");
}

/// Choices of one click, and every curve with a box to tick.
pub fn list(html: &mut Markup, traces: &[Trace], shown: &[String]) {
    if traces.is_empty() {
        return;
    }
    html.open("div", &[("class", "icon-presets")]);
    for (preset, key, words) in Preset::ALL {
        let mut keys = preset.of(traces);
        if keys.is_empty() {
            continue;
        }
        let mut now = shown.to_vec();
        few::sort_by(&mut keys, Ord::cmp);
        few::sort_by(&mut now, Ord::cmp);
        html.open(
            "button",
            &[
                ("class", "option"),
                ("data-act", "preset"),
                ("data-key", key),
                ("data-testid", "preset"),
                ("aria-pressed", if keys == now { "true" } else { "false" }),
            ],
        );
        html.text(words).close("button");
    }
    html.close("div");
    html.open("ul", &[("class", "icon-traces")]);
    for trace in traces {
        html.open(
            "li",
            &[("data-testid", "trace"), ("data-trace", &trace.key)],
        );
        html.open("span", &[("data-key", &trace.key)]);
        let on = shown.contains(&trace.key);
        ticked(html, &trace.key, &trace.label, on);
        html.close("span");
        let about = format!("{} · {}", trace.when(), trace.place);
        html.node("span", "quiet trace-about", &about).close("li");
    }
    html.close("ul");
}

/// A box to tick that carries its key.
fn ticked(html: &mut Markup, key: &str, words: &str, on: bool) {
    html.open("label", &[("class", "check")]);
    let mut attributes = vec![
        ("type", "checkbox"),
        ("data-act", "trace"),
        ("data-key", key),
        ("data-testid", "trace-box"),
        ("data-value", if on { "on" } else { "" }),
    ];
    if on {
        attributes.push(("checked", ""));
    }
    html.open("input", &attributes).text(words).close("label");
}

/// What was noted at the strokes that are shown, beside each other.
pub fn numbers(html: &mut Markup, traces: &[&Trace]) {
    if traces.is_empty() {
        return;
    }
    html.open("div", &[("class", "icon-table")]);
    html.open(
        "table",
        &[("class", "plain"), ("data-testid", "curve-facts")],
    );
    html.open("thead", &[]).open("tr", &[]);
    html.open("th", &[("scope", "col")])
        .text("Stroke")
        .close("th");
    for trace in traces {
        html.open("th", &[("scope", "col")]);
        html.text(&trace.label).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    row(html, "Made, device clock", traces, |t| (t.when(), ""));
    row(html, "From", traces, |t| {
        (format!("{}, {}", t.place, t.curve.source), "")
    });
    for name in [
        "Stroke time",
        "Voltage",
        "Electronics",
        "Terminal board",
        "Motor",
    ] {
        row(html, name, traces, |t| {
            let fact = t.facts().into_iter().find(|f| f.0 == name);
            fact.map_or((String::new(), ""), |f| (f.1, f.2))
        });
    }
    html.close("tbody").close("table").close("div");
}

fn row(
    html: &mut Markup,
    name: &str,
    traces: &[&Trace],
    cell: impl Fn(&Trace) -> (String, &'static str),
) {
    html.open("tr", &[("data-row", name)]);
    html.open("th", &[("scope", "row")]).text(name).close("th");
    for trace in traces {
        let (text, unit) = cell(trace);
        html.open("td", &[("class", "num"), ("data-trace", &trace.key)]);
        if text.is_empty() {
            html.node("span", "quiet", "not read");
        } else {
            html.text(&text);
            if !unit.is_empty() {
                html.text(" ").node("i", "unit", unit);
            }
        }
        html.close("td");
    }
    html.close("tr");
}

/// Strokes to choose from, each with its result.
pub fn stroke_list(html: &mut Markup, strokes: &[Stroke], open: Option<u16>) {
    html.open("ul", &[("class", "icon-traces")]);
    for stroke in strokes {
        let number = stroke.number.to_string();
        let here = open == Some(stroke.number);
        html.open("li", &[]);
        html.open(
            "button",
            &[
                ("class", "icon-stroke-button"),
                ("data-act", "stroke"),
                ("data-key", &number),
                ("data-testid", "stroke"),
                ("aria-pressed", if here { "true" } else { "false" }),
            ],
        );
        html.node("b", "", &stroke.label()).text(" ");
        html.node("span", "quiet", &stroke.when());
        if let Some(item) = stroke.get("result") {
            html.text(" ").text(&item.text());
        }
        html.close("button").close("li");
    }
    html.close("ul");
}

/// One stroke: how it ended, its limits, and all its values with their sources.
pub fn stroke(html: &mut Markup, stroke: &Stroke, limits: &Limits) {
    html.open(
        "p",
        &[("class", "icon-verdict"), ("data-testid", "verdict")],
    );
    match (stroke.kind, stroke.result()) {
        (Kind::Pst, Some(1)) | (Kind::Efs, _) => {}
        (Kind::Pst, Some(2 | 4..=6)) => {
            html.severity(Severity::Error).text(" ");
        }
        (Kind::Pst, _) => {
            html.severity(Severity::Warning).text(" ");
        }
    }
    html.text(&stroke.verdict()).close("p");
    html.open("dl", &[("class", "icon-items")]);
    for item in &stroke.items {
        html.open(
            "div",
            &[("data-testid", "stroke-item"), ("data-key", item.field.key)],
        );
        html.node("dt", "", &item.label());
        html.open("dd", &[]);
        html.node("b", "", &item.text());
        if item.number().is_some() && !item.field.unit.is_empty() {
            html.text(" ").node("i", "unit", item.field.unit);
        }
        if item.quality != Quality::Good {
            html.text(" ").node("em", "quality", item.quality.label());
        }
        if let Some(read) = item
            .field
            .reading
            .filter(|_| item.field.trust != Trust::Manual)
        {
            html.text(" ");
            reading(html, read);
        }
        html.close("dd").close("div");
    }
    html.close("dl");
    html.open("details", &[("class", "raw")]);
    html.open("summary", &[])
        .text("Records and raw words")
        .close("summary");
    html.open("ul", &[("class", "icon-traces")]);
    for item in &stroke.items {
        html.open("li", &[("data-testid", "stroke-raw")]);
        html.text(&format!("{}: record {}, ", item.label(), item.record));
        html.node("code", "", &item.raw());
        html.text(&format!(" · {}", item.field.source)).close("li");
    }
    html.close("ul").close("details");
    if stroke.kind == Kind::Pst && limits.words.is_empty() {
        html.node(
            "p",
            "quiet",
            "The limits are not known: they are percent of the reference (HR 3616, 3618, 3619), and either was not read.",
        );
    }
    html.node("p", "quiet", &stroke.source);
}

/// What the recorders say about themselves.
pub fn recorders(html: &mut Markup, dossier: &Dossier) {
    for (file, name) in RECORDERS {
        let Some(log) = dossier.log(file) else {
            continue;
        };
        html.open("p", &[("class", "quiet"), ("data-testid", "recorder")]);
        html.node("b", "", name).text(": ");
        let entries = u64::try_from(log.entries.len()).unwrap_or(0);
        html.text(&count(entries, "sample"));
        for item in log.head.iter().flatten().filter(|i| i.field.key != "count") {
            html.text(&format!(" · {} {}", item.label(), item.text_with_unit()));
        }
        html.text(&format!(" · file {file}, {}", log.file.source))
            .close("p");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::actuator::markup::rows::tests::device;
    use crate::actuator::state::curves::traces;
    use crate::actuator::state::logs::tests::put;

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn curves_can_be_chosen() {
        let mut dossier = device(&[]);
        for file in [1000, 1001] {
            put(&mut dossier, file, &[9; 108]);
        }
        let traces = traces(&dossier);
        let shown = vec!["file-1001".to_owned()];
        let html = drawn(|html| list(html, &traces, &shown));
        assert_eq!(html.matches("data-testid=\"trace\"").count(), 2);
        assert_eq!(html.matches("checked").count(), 1);
        let both = Preset::Opening.of(&traces);
        let html = drawn(|html| list(html, &traces, &both));
        assert!(html.contains("data-key=\"opening\" data-testid=\"preset\" aria-pressed=\"true\""));
        let all: Vec<_> = traces.iter().collect();
        let html = drawn(|html| numbers(html, &all));
        assert!(
            html.contains("Stroke time") && html.contains("file 1001"),
            "{html}"
        );
    }

    #[test]
    fn what_is_stored_is_counted() {
        let dossier = device(&[(3511, &[7, 0xFFFF, 2, 0])]);
        assert_eq!(stored(&dossier), [Some(7), Some(100), Some(2), Some(0)]);
        let html = drawn(|html| stored_line(html, &dossier));
        assert!(
            html.contains("7 opening, 100 closing, 2 PST, 0 EFS"),
            "{html}"
        );
        assert_eq!(drawn(|html| stored_line(html, &device(&[]))), "");
    }
}
