//! What stands over a network: its name, how it is made up, the tabs; its ports and its polling.

use shared::proto::{DdcShape, LineState};

use crate::components::ne107::Sign;
use crate::format::{age, count, encode, millis, thousands};
use crate::markup::Markup;
use crate::markup::device::sign;
use crate::network::state::net::{Net, Port};
use crate::network::state::scan::table_4_2;

/// The words for a shape.
#[must_use]
pub const fn shape(shape: DdcShape, ports: usize) -> &'static str {
    match (shape, ports) {
        (DdcShape::Loop, 2..) => "redundant loop",
        (DdcShape::Loop, _) => "loop with one port in use",
        (DdcShape::SingleEnded, _) => "single-ended loop",
        (DdcShape::MultiDrop, _) => "multi-drop line",
    }
}

/// The address of a screen of a network.
#[must_use]
pub fn address(bus: &str, tab: &str) -> String {
    let bus = encode(bus);
    match (bus.is_empty(), tab.is_empty()) {
        (true, true) => "#/network".to_owned(),
        (_, true) => format!("#/network/{bus}"),
        _ => format!("#/network/{bus}/{tab}"),
    }
}

/// The tabs of a network, or of the offline side.
const LIVE: [(&str, &str); 5] = [
    ("", "Network"),
    ("log", "Lately"),
    ("tags", "Tag list"),
    ("faults", "Fault table"),
    ("scan", "Scan time"),
];
const OFFLINE: [(&str, &str); 2] = [("", "Fault table"), ("scan", "Scan time")];

/// The name, how the network is made up, and the other networks.
pub fn head(html: &mut Markup, bus: &str, net: &Net, others: &[&str]) {
    if bus.is_empty() {
        html.node("h1", "", "DDC-100 networks");
        html.node("span", "quiet", "worked out by hand, without a bridge");
    } else {
        html.node("h1", "", bus);
        if let Some(of) = net.shape {
            let units = count(u64::try_from(net.units.len()).unwrap_or(0), "unit");
            let framing = if net.framing == "modbus-ascii" {
                "Modbus ASCII"
            } else {
                "Modbus RTU"
            };
            let first = u32::from(net.start) + 1;
            let last = u32::from(net.start) + u32::from(net.count);
            html.node(
                "span",
                "quiet",
                &format!(
                    "{} · {units} · {framing}, {} baud · each poll reads registers {first} to {last}",
                    shape(of, net.ports.len()),
                    thousands(u64::from(net.baud)),
                ),
            );
        }
    }
    html.open(
        "nav",
        &[("class", "net-others"), ("aria-label", "Networks")],
    );
    for other in others.iter().filter(|other| **other != bus) {
        html.open(
            "a",
            &[
                ("href", &address(other, "")),
                ("data-testid", "other-network"),
            ],
        );
        html.text(other).close("a");
    }
    html.close("nav");
}

/// The tabs.
pub fn tabs(html: &mut Markup, bus: &str, open: &str) {
    let all: &[(&str, &str)] = if bus.is_empty() { &OFFLINE } else { &LIVE };
    for (key, words) in all {
        html.open(
            "a",
            &[
                ("class", "tab"),
                ("role", "tab"),
                ("href", &address(bus, key)),
                ("data-testid", "net-tab"),
                ("data-tab", if key.is_empty() { "main" } else { key }),
                ("aria-selected", if *key == open { "true" } else { "false" }),
            ],
        );
        html.text(words).close("a");
    }
}

/// Why there is no network to see, or what to look at although it is polled.
pub fn missing(html: &mut Markup, bus: &str, net: &Net, online: bool) {
    if bus.is_empty() {
        return;
    }
    if !online {
        html.node(
            "p",
            "notice",
            "No connection to the bridge: what is shown is what was known before. Check that \
             valvescope is running; the page connects again by itself.",
        );
    } else if net.shape.is_none() {
        html.open("p", &[("class", "empty"), ("data-testid", "no-network")]);
        html.text(&format!(
            "The bridge has not told of a network on \"{bus}\" yet. If nothing comes, the bus is \
             not polled as one: give it the kind \"ddc100\" in the configuration of the bridge."
        ));
        html.close("p");
    } else if let Some(hint) = &net.hint {
        html.open("p", &[("class", "notice"), ("data-testid", "net-hint")]);
        html.text(hint).close("p");
    }
}

/// The host ports.
pub fn ports(html: &mut Markup, net: &Net) {
    html.node("h3", "", "Host ports");
    html.open("ul", &[("class", "port-list")]);
    for (at, port) in net.ports.iter().enumerate() {
        port_line(html, at, port);
    }
    html.close("ul");
}

fn port_line(html: &mut Markup, at: usize, port: &Port) {
    let number = (at + 1).to_string();
    let state = match port.state {
        LineState::Up => "up",
        LineState::Down => "down",
        LineState::Starting => "starting",
    };
    html.open(
        "li",
        &[
            ("data-testid", "port"),
            ("data-port", &number),
            ("data-state", state),
        ],
    );
    if port.state == LineState::Down {
        sign(html, Sign::Failure, "16");
        html.text(" ");
    }
    html.node("b", "", &format!("Port {number}"));
    html.text(&format!(
        " (channel {}) {state}",
        if at == 0 { "A" } else { "B" }
    ));
    html.open("span", &[("class", "quiet port-line")])
        .text(&port.line)
        .close("span");
    if !port.text.is_empty() {
        html.node("span", "port-why", &port.text);
    }
    html.close("li");
}

/// How far the poll is: the unit and the port.
pub fn progress(html: &mut Markup, net: &Net, poll: Option<(u8, u8)>) {
    html.node("h3", "", "Poll");
    let place = poll.and_then(|(unit, port)| Some((net.place(unit)? + 1, unit, port)));
    let all = net.units.len().to_string();
    match place {
        Some((at, unit, port)) => {
            html.open(
                "progress",
                &[
                    ("max", &all),
                    ("value", &at.to_string()),
                    ("aria-label", "Poll"),
                ],
            )
            .close("progress");
            html.open("p", &[("data-testid", "poll-now")]);
            html.text("Unit ").node("b", "", &unit.to_string());
            html.text(&format!(" on port {port}, {at} of {all}"));
            html.close("p");
        }
        None => {
            html.node("p", "quiet", "Nothing is polled right now.");
        }
    }
}

/// How long the passes take, beside what they should take.
pub fn passes(html: &mut Markup, net: &Net) {
    html.open(
        "table",
        &[("class", "plain passes"), ("data-testid", "passes")],
    );
    html.open("thead", &[]).open("tr", &[]);
    for words in ["Pass", "measured", "expected"] {
        html.open("th", &[("scope", "col")]).text(words).close("th");
    }
    html.close("tr").close("thead").open("tbody", &[]);
    for (at, port) in net.ports.iter().enumerate() {
        html.open("tr", &[]);
        html.open("th", &[("scope", "row")]);
        html.text(&format!("port {}", at + 1)).close("th");
        match port.pass {
            Some((took, expected)) => {
                html.node("td", "num", &seconds(took));
                html.node("td", "num quiet", &seconds(expected));
            }
            None => {
                html.node("td", "num quiet", "not yet");
                html.node("td", "", "");
            }
        }
        html.close("tr");
    }
    html.close("tbody").close("table");
    html.open(
        "p",
        &[("class", "quiet net-small"), ("data-testid", "pass-table")],
    );
    html.text(&format!(
        "Expected by table 4.1. Table 4.2: {}.",
        table_4_2(net)
    ))
    .close("p");
    html.open("p", &[("class", "quiet net-small")]);
    html.text(&format!(
        "{} so far; turn time {} ms, time-out {} ms, {}",
        match net.passes {
            1 => "1 pass".to_owned(),
            n => format!("{} passes", thousands(n)),
        },
        net.turn_ms,
        net.timeout_ms,
        match net.retries {
            0 => "no retry".to_owned(),
            1 => "1 retry".to_owned(),
            n => format!("{n} retries"),
        },
    ));
    html.close("p");
}

/// A duration in seconds with two digits, as the tables of the guide have it.
#[must_use]
pub fn seconds(micros: u64) -> String {
    let hundredths = (micros + 5_000) / 10_000;
    format!("{}.{:02} s", hundredths / 100, hundredths % 100)
}

/// The unit under the cursor of the drawing.
pub fn chosen(html: &mut Markup, net: &Net, name: &str, at: Option<usize>, now_us: u64) {
    let Some((at, unit)) = at.and_then(|at| Some((at, net.units.get(at)?))) else {
        html.node(
            "p",
            "quiet net-small",
            "Choose a unit in the drawing, with the mouse or the arrow keys, to see it here.",
        );
        return;
    };
    html.node(
        "h3",
        "",
        &format!("Place {} of {}", at + 1, net.units.len()),
    );
    html.open(
        "p",
        &[
            ("data-testid", "chosen-unit"),
            ("data-unit", &unit.info.unit.to_string()),
        ],
    );
    html.text(name).close("p");
    html.open("p", &[("class", "quiet net-small")]);
    html.text(&match (unit.at, unit.took) {
        (Some(at), Some(took)) => format!(
            "last good answer {} ago, after {}",
            age(now_us.saturating_sub(at)),
            millis(took)
        ),
        (Some(at), None) => format!("last good answer {} ago", age(now_us.saturating_sub(at))),
        _ => "never answered".to_owned(),
    });
    html.close("p");
    if !unit.text.is_empty() {
        html.node("p", "net-small", &unit.text);
    }
    html.open(
        "a",
        &[
            ("class", "button"),
            ("href", &format!("#/device/{}", encode(&unit.info.tag))),
            ("data-testid", "open-unit"),
        ],
    );
    html.text("Open the unit").close("a");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::state::net::tests::network;
    use shared::proto::DdcNews;

    fn drawn(draw: impl Fn(&mut Markup)) -> String {
        let mut html = Markup::new();
        draw(&mut html);
        html.finish()
    }

    #[test]
    fn a_network_says_what_it_is() {
        let net = network(24, DdcShape::Loop, 2);
        let html = drawn(|html| head(html, "Loop", &net, &["Loop", "Tank farm"]));
        assert!(html.contains("redundant loop · 24 units · Modbus RTU, 9\u{2009}600 baud"));
        assert!(html.contains("registers 8 to 16"));
        assert!(html.contains("#/network/Tank%20farm"));
        assert_eq!(html.matches("other-network").count(), 1);
        let html = drawn(|html| tabs(html, "Tank farm", "tags"));
        assert!(html.contains("#/network/Tank%20farm/scan"));
        assert_eq!(html.matches("aria-selected=\"true\"").count(), 1);
        let html = drawn(|html| tabs(html, "", "scan"));
        assert!(html.contains("href=\"#/network//scan\""), "{html}");
    }

    #[test]
    fn what_is_missing_is_said() {
        let none = Net::default();
        assert!(
            drawn(|html| missing(html, "Loop", &none, true)).contains("\"ddc100\"")
                || drawn(|html| missing(html, "Loop", &none, true)).contains("&quot;ddc100&quot;")
        );
        assert!(drawn(|html| missing(html, "Loop", &none, false)).contains("No connection"));
        assert_eq!(drawn(|html| missing(html, "", &none, false)), "");
        let html = drawn(|html| progress(html, &none, Some((3, 1))));
        assert!(html.contains("Nothing is polled"));
    }

    #[test]
    fn ports_and_passes() {
        let mut net = network(5, DdcShape::Loop, 2);
        net.hear(DdcNews::Pass {
            bus: "Loop".into(),
            port: 1,
            number: 3,
            took_us: 984_999,
            expected_us: 1_005_000,
        });
        net.hear(DdcNews::Port {
            bus: "Loop".into(),
            port: 2,
            state: LineState::Down,
            text: "cannot open /dev/ttyS1".into(),
        });
        let html = drawn(|html| passes(html, &net));
        assert!(html.contains("0.98 s") && html.contains("1.01 s") && html.contains("not yet"));
        assert!(html.contains("3 passes so far; turn time 30 ms"));
        // 9 registers are no line of table 4.2; the next are 10 units with 10 registers.
        assert!(html.contains("Table 4.2: none for this; 10 units with 10 registers 1.9 s."));
        let html = drawn(|html| ports(html, &net));
        assert!(html.contains("data-state=\"down\"") && html.contains("cannot open"));
        assert_eq!(html.matches("sign-f").count(), 1);
        let html = drawn(|html| progress(html, &net, Some((4, 2))));
        assert!(html.contains("on port 2, 4 of 5"));
    }
}
