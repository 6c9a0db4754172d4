//! What changed since an earlier read, as a table.

use crate::dop::state::compare::Difference;
use crate::markup::Markup;

/// The values that changed; all of them if asked.
pub fn differences(html: &mut Markup, all: &[Difference], with_same: bool) {
    let shown: Vec<_> = all.iter().filter(|d| with_same || !d.is_same()).collect();
    if shown.is_empty() {
        html.node("p", "quiet", "Nothing changed.");
        return;
    }
    html.open(
        "table",
        &[
            ("class", "plain differences"),
            ("data-testid", "differences"),
        ],
    );
    html.open("thead", &[]).open("tr", &[]);
    for name in ["Value", "Now", "Earlier", "Change", ""] {
        html.open("th", &[("scope", "col")]).text(name).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for difference in shown {
        html.open(
            "tr",
            &[
                ("data-testid", "difference"),
                ("data-path", &difference.path),
            ],
        );
        html.open("th", &[("scope", "row")])
            .text(&difference.label)
            .close("th");
        for text in [&difference.now, &difference.then] {
            html.node("td", "num", text.as_deref().unwrap_or("–"));
        }
        html.node("td", "num", &difference.change);
        html.node("td", "quiet", difference.unit).close("tr");
    }
    html.close("tbody").close("table");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_changes_unless_asked() {
        let row = |path: &str, now: &str, then: &str| Difference {
            path: path.into(),
            label: "Torque".into(),
            unit: "%",
            now: Some(now.into()),
            then: Some(then.into()),
            change: "+1".into(),
        };
        let all = [row("a", "2", "1"), row("b", "3", "3")];
        let drawn = |with_same| {
            let mut html = Markup::new();
            differences(&mut html, &all, with_same);
            html.finish()
        };
        assert_eq!(
            drawn(false).matches("data-testid=\"difference\"").count(),
            1
        );
        assert_eq!(drawn(true).matches("data-testid=\"difference\"").count(), 2);
        let mut html = Markup::new();
        differences(&mut html, &all[1..], false);
        assert!(html.finish().contains("Nothing changed"));
    }
}
