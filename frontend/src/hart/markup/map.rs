//! The condensed status map as a matrix: bits by categories.

use shared::device::Family;
use shared::hart::model::Preset;
use shared::hart::ne107::Report;

use crate::components::ne107::Sign;
use crate::hart::state::map::{Known, bit, category, mapped, place, rows};
use crate::markup::Markup;
use crate::markup::device::sign;

/// The categories that have a column.
const COLUMNS: [u8; 5] = [0, 1, 4, 5, 3];

/// The sign of a category.
#[must_use]
pub const fn sign_of(code: u8) -> Option<Sign> {
    match code {
        1 => Some(Sign::Maintenance),
        3 => Some(Sign::Failure),
        4 => Some(Sign::OutOfSpecification),
        5 => Some(Sign::FunctionCheck),
        _ => None,
    }
}

/// A map with the example that it is.
pub type Source<'a> = (&'a Known, Option<&'static Preset>);

/// The matrix; `beside` is another map to compare with.
pub fn matrix(
    html: &mut Markup,
    family: Option<Family>,
    map: Source<'_>,
    beside: Option<Source<'_>>,
) {
    let mut rows = rows(family, map.0);
    if let Some((beside, _)) = beside {
        rows.extend(crate::hart::state::map::rows(family, beside));
        rows.sort_unstable();
        rows.dedup();
    }
    if rows.is_empty() {
        html.node(
            "p",
            "empty",
            "This family has no alarm bits, so that its map decides nothing.",
        );
        return;
    }
    html.open(
        "table",
        &[("class", "hart-map"), ("data-testid", "hart-map")],
    );
    html.open("thead", &[]).open("tr", &[]);
    for head in ["Index", "Status", "Bit"] {
        html.open("th", &[("scope", "col")]).text(head).close("th");
    }
    for code in COLUMNS {
        html.open("th", &[("scope", "col"), ("class", "map-category")]);
        if let Some(one) = sign_of(code) {
            sign(html, one, "18");
        }
        html.node("span", "", category(code)).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for index in rows {
        row(html, family, index, map, beside);
    }
    html.close("tbody").close("table");
}

fn row(
    html: &mut Markup,
    family: Option<Family>,
    index: usize,
    map: Source<'_>,
    beside: Option<Source<'_>>,
) {
    let code = map.0.get(index);
    let other = beside.map(|(b, _)| b.get(index));
    let differs = other.is_some_and(|b| b != code);
    html.open(
        "tr",
        &[
            ("class", if differs { "differs" } else { "" }),
            ("data-testid", "hart-map-row"),
            ("data-index", &index.to_string()),
            (
                "data-category",
                &code.map_or_else(String::new, |c| c.to_string()),
            ),
        ],
    );
    let (status, number) = place(index);
    html.node("td", "num quiet", &index.to_string());
    html.node("td", "quiet", &format!("{status}.{number}"));
    html.open("th", &[("scope", "row")]);
    match bit(family, index) {
        Some(bit) => {
            html.text(bit.label);
            if !bit.alias.is_empty() {
                html.text(" ")
                    .node("span", "quiet", &format!("also: {}", bit.alias));
            }
        }
        None => {
            html.node("span", "quiet", "no name known");
        }
    }
    let presets = [map.1, beside.and_then(|b| b.1)];
    for one in presets.into_iter().flatten() {
        let Some(one) = mapped(one, index) else {
            continue;
        };
        let printed = format!("{}: {}", one.source.part, one.printed);
        html.text(" ").node("span", "quiet", &printed);
        if let Some(reading) = one.reading {
            html.text(" ");
            super::reading(html, reading);
        }
    }
    html.close("th");
    let odd = code.filter(|code| !COLUMNS.contains(code));
    for column in COLUMNS {
        let (here, there) = (Some(column) == code, other == Some(Some(column)));
        html.open("td", &[("class", "map-cell")]);
        if here {
            let words = format!("is {}", category(column));
            html.open(
                "span",
                &[
                    ("class", "map-dot"),
                    ("role", "img"),
                    ("aria-label", &words),
                ],
            );
            html.text("●").close("span");
        }
        if there && differs {
            let words = format!("compared: {}", category(column));
            html.open(
                "span",
                &[
                    ("class", "map-ring"),
                    ("role", "img"),
                    ("aria-label", &words),
                ],
            );
            html.text("○").close("span");
        }
        if column == 0 {
            if let Some(code) = odd {
                html.node("em", "quality", &format!("code {code}, {}", category(code)));
            }
            if code.is_none() {
                html.node("em", "quality", "not read");
            }
        }
        html.close("td");
    }
    html.close("tr");
}

/// What a device makes of a status and a map; `None` if too little of the map is known.
pub fn result(html: &mut Markup, status: &str, report: Option<Report>) {
    html.open(
        "p",
        &[("class", "hart-ne107"), ("data-testid", "hart-result")],
    );
    html.text(&format!("With {status}, the map gives: "));
    let Some(report) = report else {
        html.text("unknown, as entries of bits that are set were not read.");
        html.close("p");
        return;
    };
    let mut some = false;
    for (bit, one) in [
        (0x08, Sign::Failure),
        (0x20, Sign::FunctionCheck),
        (0x10, Sign::OutOfSpecification),
        (0x01, Sign::Maintenance),
    ] {
        if report.extended & bit != 0 || (report.malfunction && one == Sign::Failure) {
            some = true;
            sign(html, one, "20");
            html.node("b", "", one.label()).text(" ");
        }
    }
    if !some {
        html.text("no category. ");
    }
    html.text(if report.more_status {
        "More status available is set."
    } else {
        "More status available is not set."
    });
    html.close("p");
}

#[cfg(test)]
mod tests {
    use super::*;
    use shared::hart::PRESETS;
    use shared::hart::ne107::Map;

    fn drawn(map: Source<'_>, beside: Option<Source<'_>>) -> String {
        let mut html = Markup::new();
        matrix(&mut html, Some(Family::Iq), map, beside);
        html.finish()
    }

    /// Table 20: valve obstructed (byte 1 bit 0) is out of specification, as printed.
    #[test]
    fn the_matrix_shows_the_example_of_table_20() {
        let map = Known::all(&Map::example(Family::Iq).unwrap());
        let text = drawn((&map, None), None);
        assert!(
            text.contains("data-index=\"16\" data-category=\"4\""),
            "{text}"
        );
        assert_eq!(text.matches("is Failure").count(), 2);
        assert_eq!(text.matches("is Out of specification").count(), 2);
        assert_eq!(text.matches("is Maintenance required").count(), 1);
        assert_eq!(text.matches("is Function check").count(), 3);
        let none = Known::all(&Map::default());
        let text = drawn((&none, None), Some((&map, None)));
        assert_eq!(text.matches("class=\"differs\"").count(), 8);
    }

    /// Readings R14 and R15: two cells of table 20 look swapped, one is as printed.
    #[test]
    fn an_example_shows_its_print_and_its_contradictions() {
        let preset = &PRESETS[0];
        let map = Known::all(&Map::of(preset));
        for text in [
            drawn((&map, Some(preset)), None),
            drawn((&Known::NONE, None), Some((&map, Some(preset)))),
        ] {
            assert_eq!(text.matches(">R14<").count(), 2);
            assert_eq!(text.matches(">R15<").count(), 1);
            assert!(text.contains("table 20, p. 44: Valve Obstructed"), "{text}");
            assert!(text.contains("two cells look swapped"), "in words");
        }
    }

    #[test]
    fn what_was_not_read_has_no_category() {
        let text = drawn((&Known::NONE, None), None);
        assert!(!text.contains("is No effect") && text.contains(">not read<"));
        assert!(text.contains("data-index=\"9\" data-category=\"\""));
    }

    /// Local control fault alone: failure by table 20, nothing by the factory's map.
    #[test]
    fn the_result_follows_the_map() {
        let say = |map: Known| {
            let mut html = Markup::new();
            let report = map.report(Family::Iq, &[0x02, 0, 0, 0, 0, 0]);
            result(&mut html, "this", report);
            html.finish()
        };
        let example = Map::example(Family::Iq).unwrap();
        assert!(say(Known::all(&example)).contains("Failure"));
        assert!(say(Known::all(&Map::default())).contains("no category"));
        assert!(say(Known::NONE).contains("unknown"));
    }
}
