//! The condensed status map as a matrix: bits by categories.

use shared::device::Family;
use shared::hart::ne107::{Map, report};

use crate::components::ne107::Sign;
use crate::hart::state::map::{bit, category, place, rows};
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

/// The matrix; `beside` is another map to compare with.
pub fn matrix(html: &mut Markup, family: Option<Family>, map: &Map, beside: Option<&Map>) {
    let mut rows = rows(family, map);
    if let Some(beside) = beside {
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
        row(
            html,
            family,
            index,
            map.get(index),
            beside.map(|b| b.get(index)),
        );
    }
    html.close("tbody").close("table");
}

fn row(html: &mut Markup, family: Option<Family>, index: usize, code: u8, beside: Option<u8>) {
    let differs = beside.is_some_and(|b| b != code);
    html.open(
        "tr",
        &[
            ("class", if differs { "differs" } else { "" }),
            ("data-testid", "hart-map-row"),
            ("data-index", &index.to_string()),
            ("data-category", &code.to_string()),
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
    html.close("th");
    let odd = !COLUMNS.contains(&code);
    for column in COLUMNS {
        let (here, there) = (column == code, beside == Some(column));
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
        if odd && column == 0 {
            html.node("em", "quality", &format!("code {code}, {}", category(code)));
        }
        html.close("td");
    }
    html.close("tr");
}

/// What a device of this family makes of its status and a map.
pub fn result(html: &mut Markup, family: Family, status: &[u8], map: &Map) {
    let report = report(family, status, map);
    html.open(
        "p",
        &[("class", "hart-ne107"), ("data-testid", "hart-result")],
    );
    html.text("With the status as read, such a map gives: ");
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

    /// Table 20: valve obstructed (byte 1 bit 0) is out of specification, as printed.
    #[test]
    fn the_matrix_shows_the_example_of_table_20() {
        let map = Map::example(Family::Iq).unwrap();
        let mut html = Markup::new();
        matrix(&mut html, Some(Family::Iq), &map, None);
        let text = html.finish();
        assert!(
            text.contains("data-index=\"16\" data-category=\"4\""),
            "{text}"
        );
        assert_eq!(text.matches("is Failure").count(), 2);
        assert_eq!(text.matches("is Out of specification").count(), 2);
        assert_eq!(text.matches("is Maintenance required").count(), 1);
        assert_eq!(text.matches("is Function check").count(), 3);
        let mut html = Markup::new();
        matrix(&mut html, Some(Family::Iq), &Map::default(), Some(&map));
        assert_eq!(html.finish().matches("class=\"differs\"").count(), 8);
    }

    /// Local control fault alone: failure by table 20, nothing by the factory's map.
    #[test]
    fn the_result_follows_the_map() {
        let say = |map: &Map| {
            let mut html = Markup::new();
            result(&mut html, Family::Iq, &[0x02, 0, 0, 0, 0, 0], map);
            html.finish()
        };
        assert!(say(&Map::example(Family::Iq).unwrap()).contains("Failure"));
        assert!(say(&Map::default()).contains("no category"));
    }
}
