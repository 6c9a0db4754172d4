//! The tag list of a network.

use shared::ddc100::tags::TagList;

use crate::components::icon::Glyph;
use crate::format::count;
use crate::markup::Markup;
use crate::markup::control::Button;
use crate::network::state::list::contradictions;
use crate::network::state::net::Net;
use crate::network::state::tags::Tags;
use crate::network::state::unit::kind;

/// Problems that are told; the rest is counted.
const MOST: usize = 50;

/// What can be done with the list.
pub fn tools(html: &mut Markup, tags: &Tags, imported: &TagList) {
    Button {
        act: "export",
        testid: "export-tags",
        words: "Export CSV",
        glyph: Some(Glyph::Save),
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "forget",
        testid: "forget-tags",
        words: "Forget what was imported",
        glyph: Some(Glyph::Clear),
        disabled: tags.is_empty() && imported.tags.is_empty(),
        ..Button::default()
    }
    .draw(html);
}

/// How the import went.
pub fn said(html: &mut Markup, list: &TagList, units: usize) {
    let many = |n: usize, noun: &str| count(u64::try_from(n).unwrap_or(0), noun);
    html.open("p", &[("data-testid", "import-said"), ("role", "status")]);
    html.text(&format!(
        "{} of {} read; {}.",
        many(list.tags.len(), "line"),
        many(units, "unit"),
        match list.problems.len() {
            0 => "nothing is wrong with it".to_owned(),
            n => many(n, "problem"),
        }
    ));
    html.close("p");
    html.open("ul", &[("class", "object-problems")]);
    for problem in list.problems.iter().take(MOST) {
        html.open(
            "li",
            &[
                ("data-testid", "tag-problem"),
                ("data-line", &problem.line.to_string()),
                ("data-column", &problem.column.to_string()),
            ],
        );
        html.severity(shared::problem::Severity::Warning);
        html.text(" ").text(&problem.to_string()).close("li");
    }
    let more = list.problems.len().saturating_sub(MOST);
    if more > 0 {
        html.node("li", "quiet", &format!("and {more} more"));
    }
    html.close("ul");
}

/// The units with their tags, and the points that the list has for them.
pub fn units(html: &mut Markup, net: &Net, tags: &Tags, list: &TagList) {
    html.open(
        "table",
        &[("class", "plain tag-table"), ("data-testid", "tag-table")],
    );
    html.open("thead", &[]).open("tr", &[]);
    for words in ["Unit", "Tag", "Description", "Type", "Scale", "Points"] {
        html.open("th", &[("scope", "col")]).text(words).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for unit in &net.units {
        let number = unit.info.unit;
        html.open(
            "tr",
            &[
                ("data-testid", "tag-row"),
                ("data-unit", &number.to_string()),
            ],
        );
        html.node("td", "num", &number.to_string());
        html.open("th", &[("scope", "row")])
            .text(tags.tag(unit))
            .close("th");
        html.node("td", "", tags.description(unit));
        html.node("td", "quiet", kind(unit.device));
        html.node("td", "", tags.scaling(unit, 8).key());
        html.open("td", &[]).open("div", &[("class", "tag-points")]);
        for point in list.tags.iter().filter(|t| t.unit == number) {
            let Some(register) = point.register else {
                continue;
            };
            html.open("span", &[]);
            html.text(&format!("{} ", point.tag));
            if !point.description.is_empty() {
                html.node("span", "quiet", &format!("{} ", point.description));
            }
            html.node("code", "quiet", &(40_000 + u32::from(register)).to_string());
            if let Some(data) = point.data {
                html.node("code", "quiet", &format!(" = {data}"));
            }
            if register != 8 && point.scaling.is_some() {
                let scaling = tags.scaling(unit, register).key();
                html.node("span", "quiet", &format!(" scaled {scaling}"));
            }
            html.close("span");
        }
        html.close("div").close("td").close("tr");
    }
    html.close("tbody").close("table");
    for text in contradictions(net, list) {
        html.open("p", &[("class", "notice"), ("data-testid", "tag-type")])
            .text(&text)
            .close("p");
    }
    let known = |unit: u8| net.units.iter().any(|u| u.info.unit == unit);
    let strangers: Vec<String> = (1..=250)
        .filter(|unit| list.of_unit(*unit).is_some() && !known(*unit))
        .map(|unit| unit.to_string())
        .collect();
    if !strangers.is_empty() {
        html.open(
            "p",
            &[("class", "notice"), ("data-testid", "tag-strangers")],
        );
        html.text(&format!(
            "The list names units that are not on this network: {}.",
            strangers.join(", ")
        ));
        html.close("p");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::list::laid_over;
    use crate::network::state::net::tests::network;
    use shared::proto::DdcShape;

    #[test]
    fn a_list_is_shown_with_what_is_wrong() {
        let net = network(2, DdcShape::Loop, 2);
        let list = TagList::read(
            "Tag name,Description,Unit,Register,Command data,Type\nXV-1,Inlet,1,,,ddc100-mx\nXV-1-O,Open,1,40001,256,\nXV-9,x,9,,,\nXV-2,y,700,,,\n",
        );
        let tags = laid_over(&Tags::default(), &list);
        let mut html = Markup::new();
        said(&mut html, &list, 2);
        units(&mut html, &net, &tags, &list);
        tools(&mut html, &tags, &list);
        let html = html.finish();
        assert!(html.contains("data-line=\"5\""), "{html}");
        assert!(html.contains(">XV-1</th>") && html.contains(">MOV-002</th>"));
        assert!(html.contains(
            "XV-1-O <span class=\"quiet\">Open </span><code class=\"quiet\">40001</code>"
        ));
        assert!(html.contains("The list says that unit 1 is MX"));
        assert!(html.contains(" = 256") && html.contains("not on this network: 9."));
    }
}
