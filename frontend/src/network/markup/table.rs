//! The table of all units.

use shared::ddc100::scaling::Scaled;
use shared::ddc100::view::{Analog, Own};

use crate::components::icon::Glyph;
use crate::format::{age, millis};
use crate::markup::Markup;
use crate::markup::control::{Button, Choice, search, tick};
use crate::markup::device::sign;
use crate::network::state::net::{Net, Reach, Unit};
use crate::network::state::table::{Column, Order};
use crate::network::state::tags::Tags;
use crate::network::state::unit::{Judged, kind};
use crate::state::sorted::Columns as _;

/// Search, filter and what can be done with the rows.
pub fn tools(
    html: &mut Markup,
    (query, only_faults): (&str, bool),
    order: Order,
    (shown, all): (usize, usize),
) {
    search(
        html,
        "q",
        "unit-search",
        "Tag, address, state or fault",
        query,
    );
    tick(
        html,
        "faults",
        "only-faults",
        "Only what is wrong",
        only_faults,
    );
    html.open(
        "span",
        &[
            ("class", "quiet"),
            ("data-testid", "unit-count"),
            ("role", "status"),
        ],
    );
    html.text(&format!("{shown} of {all}")).close("span");
    Button {
        act: "copy",
        testid: "copy-units",
        words: "Copy",
        glyph: Some(Glyph::Copy),
        disabled: shown == 0,
        ..Button::default()
    }
    .draw(html);
    Button {
        act: "csv",
        testid: "save-units",
        words: "CSV",
        glyph: Some(Glyph::Save),
        disabled: shown == 0,
        ..Button::default()
    }
    .draw(html);
    // Where there is no room for a head.
    html.open("span", &[("class", "narrow-sort")]);
    Choice {
        act: "order",
        testid: "order-units",
        label: "Sort by",
        value: order.column.key(),
        ..Choice::default()
    }
    .draw(html, Column::ALL.iter().map(|c| (c.key(), c.label())));
    tick(html, "down", "order-down", "Reversed", order.down);
    html.close("span");
    html.open("span", &[("class", "quiet net-small")]);
    html.text("n/f: not fitted. Without the board of channel B its bit is always 1.")
        .close("span");
}

/// Columns of the head: class, words, and the column that it sorts by.
const HEAD: [(&str, &str, Option<Column>); 11] = [
    ("", "", Some(Column::Worst)),
    ("num", "", Some(Column::Place)),
    ("num", "", Some(Column::Unit)),
    ("", "", Some(Column::Tag)),
    ("", "Type", None),
    ("num", "", Some(Column::Position)),
    ("", "", Some(Column::Status)),
    ("", "", Some(Column::Faults)),
    ("", "Host A B / own A B", None),
    ("num", "", Some(Column::Age)),
    ("num", "", Some(Column::Response)),
];

/// The head; each column that can be is a button.
pub fn head(html: &mut Markup, order: Order) {
    for (class, words, column) in HEAD {
        let Some(column) = column else {
            html.node("span", class, words);
            continue;
        };
        html.open("span", &[("class", class)]);
        let name = format!("sort-{}", column.key());
        let title = format!("Sort by {}", column.label().to_ascii_lowercase());
        html.open(
            "button",
            &[
                ("class", "sort"),
                ("data-act", "sort"),
                ("data-sort", column.key()),
                ("data-testid", &name),
                ("data-order", order.aria(column)),
                ("title", &title),
            ],
        );
        html.text(column.label());
        html.text(match order.aria(column) {
            "ascending" => " ▲",
            "descending" => " ▼",
            _ => "",
        });
        html.close("button").close("span");
    }
}

/// A unit.
pub fn row(html: &mut Markup, net: &Net, tags: &Tags, (at, judged): (usize, &Judged), now_us: u64) {
    let Some(unit) = net.units.get(at) else {
        return;
    };
    let ports = net.ports.len();
    let reach = unit.reach(ports);
    let stale = matches!(reach, Reach::Lost);
    let number = unit.info.unit.to_string();
    html.open(
        "div",
        &[
            ("class", if stale { "unit-row stale" } else { "unit-row" }),
            ("data-testid", "unit-row"),
            ("data-unit", &number),
        ],
    );
    html.open("span", &[("class", "unit-sign")]);
    if let Some(mark) = judged.health.sign() {
        sign(html, mark, "16");
    }
    html.close("span");
    html.node("span", "num quiet unit-place", &(at + 1).to_string());
    html.node("span", "num unit-number", &number);
    html.open("span", &[("class", "unit-tag")]);
    html.node("b", "", tags.tag(unit));
    let description = tags.description(unit);
    if !description.is_empty() {
        html.text(" ").node("span", "quiet", description);
    }
    html.close("span");
    html.node("span", "quiet unit-kind", kind(unit.device));
    position(html, judged.view.position.as_ref(), stale);
    html.open("span", &[("class", "unit-state")]);
    html.text(&match (judged.known, reach) {
        (false, Reach::Unknown) => "not tried yet".to_owned(),
        (false, Reach::Lost) => "off-line".to_owned(),
        (false, _) => reach.words(ports).to_owned(),
        (true, Reach::Lost) => format!("off-line; was: {}", judged.view.state),
        (true, _) => judged.view.state.clone(),
    });
    let local = judged.local();
    if !local.is_empty() {
        html.text(" · ").text(local);
    }
    html.close("span");
    html.node("span", "unit-faults", &judged.fault_words(2));
    html.open("span", &[("class", "mono unit-bits")]);
    bit(html, unit.fault[0], "host-a");
    html.text(" ");
    bit(html, unit.fault[1], "host-b");
    html.node("i", "quiet", " / ");
    own(html, judged.view.own.one, "own-a");
    html.text(" ");
    own(html, judged.view.own.two, "own-b");
    html.close("span");
    html.node("span", "num quiet unit-age", &since(unit, now_us));
    let took = unit.took.map_or_else(String::new, millis);
    html.node("span", "num quiet unit-took", &took);
    html.close("div");
}

/// How old the last good answer is.
#[must_use]
pub fn since(unit: &Unit, now_us: u64) -> String {
    unit.at
        .map_or_else(|| "never".to_owned(), |at| age(now_us.saturating_sub(at)))
}

/// A fault bit of the host: 1 is a fault.
pub fn bit(html: &mut Markup, bit: Option<bool>, testid: &str) {
    let (class, text) = match bit {
        None => ("quiet", "\u{2013}"),
        Some(false) => ("quiet", "0"),
        Some(true) => ("bit-on", "1"),
    };
    html.open("span", &[("class", class), ("data-bit", testid)]);
    html.text(text).close("span");
}

/// The same as the unit reports it of itself. The bit of a channel that is not fitted is always
/// set, and no fault.
pub fn own(html: &mut Markup, own: Own, testid: &str) {
    let (class, text) = match own {
        Own::Unknown => ("quiet", "\u{2013}"),
        Own::Good => ("quiet", "0"),
        Own::Fault => ("bit-on", "1"),
        Own::NotFitted => ("quiet", "1"),
    };
    html.open("span", &[("class", class), ("data-bit", testid)]);
    html.text(text).close("span");
    if own == Own::NotFitted {
        html.node("i", "quiet", " n/f");
    }
}

/// The position with its bar.
fn position(html: &mut Markup, analog: Option<&Analog>, stale: bool) {
    html.open("span", &[("class", "num unit-position")]);
    match analog {
        None => {
            html.text("\u{2013}");
        }
        Some(analog) => {
            html.text(&analog.to_string());
            let tenths = analog.scaled.and_then(Scaled::tenths);
            if let Some(tenths) = tenths.filter(|_| !stale) {
                bar(html, u32::from(tenths));
            }
        }
    }
    html.close("span");
}

/// A thin bar, in tenths of a percent.
pub fn bar(html: &mut Markup, tenths: u32) {
    html.open(
        "svg",
        &[
            ("class", "bar"),
            ("viewBox", "0 0 1000 6"),
            ("preserveAspectRatio", "none"),
            ("aria-hidden", "true"),
        ],
    );
    let class = if tenths > 1000 {
        "bar-beyond"
    } else {
        "bar-fill"
    };
    for (class, width) in [("bar-track", 1000), (class, tenths.min(1000))] {
        html.open(
            "rect",
            &[
                ("class", class),
                ("width", &width.to_string()),
                ("height", "6"),
            ],
        )
        .close("rect");
    }
    html.close("svg");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::net::tests::{network, poll};
    use shared::ddc100::scaling::Scaling;
    use shared::proto::DdcShape;

    fn drawn(net: &Net, tags: &Tags, at: usize) -> String {
        let mut html = Markup::new();
        let judged = Judged::of(&net.units[at], net, tags);
        row(&mut html, net, tags, (at, &judged), 8_000_000);
        html.finish()
    }

    #[test]
    fn host_faults_and_own_bits_are_kept_apart() {
        let mut net = network(2, DdcShape::Loop, 2);
        let words = [61, 0x0801, 0, 0, 0, 0, 0, 0, 0];
        poll(&mut net, 1, [Some(false), Some(true)], &words);
        let html = drawn(&net, &Tags::default(), 0);
        assert!(html.contains("<span class=\"bit-on\" data-bit=\"host-b\">1</span>"));
        // The bit of a channel that the type does not have is no alarm.
        assert!(html.contains("data-bit=\"own-b\">1</span><i class=\"quiet\"> n/f</i>"));
        assert!(html.contains("<span class=\"quiet\" data-bit=\"host-a\">0</span>"));
        assert!(html.contains(">61 %<svg"));
        assert!(html.contains(">Open · Local or stop</span>") && html.contains("3.0 s"));
        let html = drawn(&net, &Tags::default(), 1);
        assert!(html.contains("not tried yet") && html.contains("never"));
        assert!(html.contains("data-bit=\"host-a\">\u{2013}"));
    }

    #[test]
    fn a_position_has_its_scale() {
        let mut net = network(1, DdcShape::Loop, 2);
        poll(
            &mut net,
            1,
            [Some(false); 2],
            &[2048, 0, 0, 0, 0, 0, 0, 0, 0],
        );
        let mut tags = Tags::default();
        assert!(
            drawn(&net, &tags, 0).contains("2048, beyond 0 to 100"),
            "no percent"
        );
        tags.set_scaling(1, Scaling::TwelveBits);
        assert!(drawn(&net, &tags, 0).contains(">50.0 %<svg"));
        tags.set_scaling(1, Scaling::Raw);
        assert!(drawn(&net, &tags, 0).contains(">2048 counts<"));
    }

    #[test]
    fn an_off_line_unit_says_so() {
        let mut net = network(1, DdcShape::Loop, 2);
        poll(
            &mut net,
            1,
            [Some(false); 2],
            &[10, 0x0802, 0, 0, 0, 0, 0, 0, 0],
        );
        poll(&mut net, 1, [Some(true); 2], &[]);
        let html = drawn(&net, &Tags::default(), 0);
        assert!(html.contains("off-line; was: Closed") && html.contains("stale"));
        assert!(html.contains("sign-f"));
    }

    #[test]
    fn the_head_tells_the_order() {
        let mut html = Markup::new();
        head(&mut html, Order::parse("-age"));
        let html = html.finish();
        assert!(html.contains("data-testid=\"sort-age\" data-order=\"descending\""));
        assert_eq!(html.matches(" ▼").count(), 1);
        assert!(html.contains("sort-faults"));
    }

    #[test]
    fn a_narrow_screen_sorts_by_a_list() {
        let mut html = Markup::new();
        tools(&mut html, ("", false), Order::parse("-faults"), (2, 4));
        let html = html.finish();
        assert!(
            html.contains("value=\"faults\" selected=\"\">Faults"),
            "{html}"
        );
        assert!(html.contains("2 of 4") && html.contains("n/f: not fitted"));
        assert_eq!(html.matches("<option").count(), 10);
        assert!(html.contains("data-testid=\"order-down\" data-value=\"on\""));
    }
}
