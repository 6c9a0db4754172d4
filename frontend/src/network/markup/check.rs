//! Could a command be given now: the wish, the checklist, the frame that it would be.

use shared::ddc100::checklist::{Checklist, Verdict};
use shared::ddc100::command::Part;

use crate::components::ne107::Sign;
use crate::format::age;
use crate::markup::Markup;
use crate::markup::control::Choice;
use crate::markup::device::sign;

/// What somebody might want, and where to.
pub fn wishes(html: &mut Markup, choices: &[(String, String)], wish: &str, percent: u8) {
    html.node("h3", "", "Could a command be given now?");
    html.open("div", &[("class", "toolbar wishes")]);
    Choice {
        act: "wish",
        testid: "wish",
        label: "Command",
        none: "Choose a command",
        value: wish,
        ..Choice::default()
    }
    .draw(
        html,
        choices
            .iter()
            .map(|(key, name)| (key.as_str(), name.as_str())),
    );
    if wish == "move" {
        let value = percent.to_string();
        html.open("label", &[("class", "choice")]).text("to");
        html.open(
            "input",
            &[
                ("type", "number"),
                ("min", "0"),
                ("max", "100"),
                ("data-act", "percent"),
                ("data-testid", "wish-percent"),
                ("data-value", &value),
                ("value", &value),
                ("aria-label", "Position in percent"),
            ],
        );
        html.text("%").close("label");
    }
    html.close("div");
}

/// The checklist of section 6.2.
pub fn checklist(html: &mut Markup, list: &Checklist, now_us: u64) {
    let (mark, words) = match list.verdict() {
        Verdict::Pass => (None, "Nothing speaks against it now."),
        Verdict::Warn => (
            Some(Sign::Warning),
            "It can be given, but another one fits better.",
        ),
        Verdict::Unknown => (
            Some(Sign::OutOfSpecification),
            "Not known: something was not read, or too long ago.",
        ),
        Verdict::Fail => (Some(Sign::Failure), "It should not be given now."),
    };
    html.open(
        "p",
        &[
            ("class", "verdict"),
            ("data-testid", "verdict"),
            ("data-verdict", list.verdict().key()),
        ],
    );
    if let Some(mark) = mark {
        sign(html, mark, "18");
        html.text(" ");
    }
    html.node("b", "", words).close("p");
    html.open("ul", &[("class", "checklist")]);
    for item in &list.items {
        html.open(
            "li",
            &[
                ("data-testid", "check-item"),
                ("data-key", item.key),
                ("data-verdict", item.verdict.key()),
            ],
        );
        let (class, letter) = match item.verdict {
            Verdict::Pass => ("check-mark", "\u{2713}"),
            Verdict::Warn => ("check-mark", "!"),
            Verdict::Unknown => ("check-mark", "?"),
            Verdict::Fail => ("check-mark fail", "\u{2717}"),
        };
        html.node("b", class, letter);
        html.open("span", &[]).text(&item.text).text(" ");
        html.node("span", "quiet net-small", item.source);
        if let Some(at) = item.at {
            let old = format!(", read {} ago", age(now_us.saturating_sub(at.get())));
            html.node("span", "quiet net-small", &old);
        }
        html.close("span").close("li");
    }
    html.close("ul");
    html.open("ul", &[("class", "check-notes quiet net-small")]);
    for (text, source) in &list.notes {
        html.node("li", "", &format!("{text} ({source})"));
    }
    html.close("ul");
}

/// The frame that the command would be.
pub fn frame(html: &mut Markup, parts: &[Part]) {
    if parts.is_empty() {
        return;
    }
    html.open("div", &[("data-testid", "would-be")]);
    html.node("h3", "", "What the frame would be");
    html.node(
        "p",
        "quiet net-small",
        "For information, by table 3.7. Nothing is sent from here: this page only reads.",
    );
    html.open("dl", &[("class", "frame-parts net-small")]);
    for part in parts {
        html.node("dt", "mono", &part.bytes)
            .node("dd", "", &part.text);
    }
    html.close("dl").close("div");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::net::tests::{network, poll};
    use crate::network::state::wish::{choices, from_key};
    use shared::capture::Micros;
    use shared::ddc100::Pair;
    use shared::ddc100::checklist::{Moment, checklist as check};
    use shared::ddc100::command::parts;
    use shared::ddc100::scaling::Scaling;
    use shared::frame::Framing;
    use shared::proto::DdcShape;

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn the_checklist_has_words_and_sources() {
        let mut net = network(3, DdcShape::Loop, 2);
        let words = [61, 0x1884, 0, 0x0004, 0x0801, 0, 0x0001, 0x0004, 0];
        poll(&mut net, 2, [Some(false), Some(true)], &words);
        let unit = &net.units[1];
        let faults = Pair {
            one: unit.fault[0],
            two: unit.fault[1],
        };
        let list = |key: &str, percent, now: u64, online| {
            let moment = Moment {
                now: Micros::new(now),
                most: net.values_last_us(),
                online,
            };
            let wish = from_key(key, percent).unwrap();
            let scaling = Scaling::Percent;
            let list = check(
                unit.device,
                &unit.image,
                faults,
                Some(scaling),
                moment,
                wish,
            );
            drawn(|html| checklist(html, &list, now))
        };
        let html = list("open", 0, 8_000_000, true);
        assert!(html.contains("data-testid=\"verdict\" data-verdict=\"fail\""));
        assert!(html.contains("data-key=\"torque\" data-verdict=\"fail\""));
        assert!(html.contains("data-key=\"communication\" data-verdict=\"pass\""));
        assert!(html.contains("section 6.2, item 2c") && html.contains("read 3.0 s ago"));
        // Read at 5 s; a passes' worth of time is not known, so ten seconds count.
        let html = list("open", 0, 16_000_000, true);
        assert!(
            html.contains("data-testid=\"verdict\" data-verdict=\"unknown\""),
            "{html}"
        );
        assert!(html.contains("Read 11 s ago, too long to rely on"));
        let html = list("stop", 0, 8_000_000, false);
        assert!(html.contains("data-testid=\"verdict\" data-verdict=\"unknown\""));
        assert!(html.contains("No connection"));
        let all = choices(unit.device);
        let html = drawn(|html| wishes(html, &all, "move", 50));
        assert!(html.contains("wish-percent") && html.contains("value=\"50\""));
    }

    #[test]
    fn the_frame_is_shown_and_not_sent() {
        let wish = from_key("open", 0).unwrap();
        let parts = parts(shared::device::Device::Ddc100Mx, Framing::Rtu, 179, wish);
        let html = drawn(|html| frame(html, &parts));
        // Section 3.2.6 of the guide.
        assert!(
            html.contains("<dt class=\"mono\">B3</dt>") && html.contains(">9388<"),
            "{html}"
        );
        assert!(html.contains("256, Open") && html.contains("Nothing is sent from here"));
    }
}
