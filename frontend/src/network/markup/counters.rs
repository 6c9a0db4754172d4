//! The counters of function 08 that a unit keeps.

use crate::components::icon::Glyph;
use crate::format::age;
use crate::markup::Markup;
use crate::markup::control::Button;
use crate::network::state::net::{Counted, Unit};

/// The counters that the unit keeps of its line (function 08, table 3.8): they are read only when
/// they are asked for, between two polls.
pub fn counters(html: &mut Markup, unit: &Unit, online: bool, now_us: u64) {
    let Some(map) = unit.device.map() else { return };
    html.open(
        "section",
        &[("class", "unit-card"), ("data-testid", "counters")],
    );
    html.node("h3", "", "Counters of the line");
    let running = unit.counters.values().any(|c| *c == Counted::Asked);
    Button {
        act: "counters",
        testid: "read-counters",
        words: "Read counters",
        glyph: Some(Glyph::Poll),
        disabled: running || !online,
        ..Button::default()
    }
    .draw(html);
    html.open("table", &[("class", "plain")]).open("tbody", &[]);
    for function in map.functions.iter().filter(|f| f.code == 8) {
        let Some(sub) = function
            .sub
            .filter(|s| shared::ddc100::counters::READS.contains(s))
        else {
            continue;
        };
        let number = sub.to_string();
        html.open("tr", &[("data-testid", "counter"), ("data-sub", &number)]);
        html.open("td", &[("class", "num quiet")]);
        html.node("code", "", &format!("08/{sub:02}")).close("td");
        html.open(
            "th",
            &[("scope", "row"), ("title", &function.source.to_string())],
        );
        html.text(function.label).close("th");
        match unit.counters.get(&sub) {
            None => html.node("td", "quiet", "not read"),
            Some(Counted::Asked) => html.node("td", "quiet", "being read"),
            Some(Counted::Failed(why)) => html.node("td", "", why),
            Some(Counted::Value(value, at)) => {
                let shown = if sub == 2 {
                    format!("0x{value:04X}")
                } else {
                    value.to_string()
                };
                html.node("td", "num", &shown);
                html.node("td", "num quiet", &age(now_us.saturating_sub(*at)))
            }
        };
        html.close("tr");
    }
    html.close("tbody").close("table").close("section");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::net::Net;
    use crate::network::state::net::tests::network;
    use shared::proto::{DdcNews, DdcShape, Outcome};

    /// LMAIM4019-00, table 3.8: the answer to sub-function 11 repeats it before the count.
    #[test]
    fn counters_are_shown_as_far_as_they_were_read() {
        let mut net = network(3, DdcShape::Loop, 2);
        let shown = |net: &Net| {
            let mut html = Markup::new();
            counters(&mut html, &net.units[1], true, 9_000_000);
            html.finish()
        };
        assert_eq!(shown(&net).matches("not read").count(), 5);
        net.ask_counters(2);
        assert!(shown(&net).contains("disabled"));
        for (request, response, text) in [
            ("08000B0000", "08000B0104", ""),
            ("0800020000", "08000200A5", ""),
            ("08000C0000", "", "no answer"),
        ] {
            net.hear(DdcNews::Read {
                id: 0,
                bus: String::new(),
                unit: 2,
                outcome: Outcome::Ok,
                text: text.into(),
                request: request.into(),
                response: response.into(),
                at_us: 4_000_000,
            });
        }
        let html = shown(&net);
        assert!(html.contains(">260<") && html.contains("0x00A5") && html.contains("no answer"));
        assert_eq!(html.matches("being read").count(), 2);
        net.lost();
        assert!(!shown(&net).contains("disabled"));
    }
}
