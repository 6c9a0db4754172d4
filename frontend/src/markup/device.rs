//! A device in the list of all, and what its valve does.

use shared::proto::Outcome;

use super::Markup;
use crate::components::ne107::Sign;
use crate::format::age;
use crate::state::health::{Health, outcome};
use crate::state::overview::{Active, Figure, Overview, Travel};
use crate::state::plant::DeviceState;
use crate::state::route::{Route, Screen, Tab};

/// Draws a sign of NE 107.
pub fn sign(html: &mut Markup, sign: Sign, size: &str) {
    let (outline, inner) = sign.paths();
    html.open(
        "span",
        &[
            ("class", sign.class()),
            ("role", "img"),
            ("aria-label", sign.label()),
        ],
    );
    html.open(
        "svg",
        &[
            ("width", size),
            ("height", size),
            ("viewBox", "0 0 20 20"),
            ("aria-hidden", "true"),
        ],
    );
    html.open("path", &[("class", "sign-shape"), ("d", outline)])
        .close("path");
    html.open("path", &[("class", "sign-inner"), ("d", inner)])
        .close("path")
        .close("svg");
    html.node("b", "", sign.letter()).close("span");
}

/// The sign of a device's state, if it has one.
#[must_use]
pub const fn health_sign(health: Health) -> Option<Sign> {
    match health {
        Health::Alarm => Some(Sign::Failure),
        Health::Warning => Some(Sign::Warning),
        Health::Good | Health::Unread | Health::Silent => None,
    }
}

/// A device in the list.
pub fn row(html: &mut Markup, device: &DeviceState, overview: &Overview, now: u64, up: bool) {
    let health = Health::of(device.outcome, overview);
    let silent = health == Health::Silent || !up;
    html.open(
        "div",
        &[
            (
                "class",
                if silent {
                    "device-row stale"
                } else {
                    "device-row"
                },
            ),
            ("data-testid", "device-row"),
            ("data-tag", &device.info.tag),
        ],
    );
    html.open("span", &[("class", "device-sign")]);
    if let Some(mark) = health_sign(health) {
        sign(html, mark, "18");
    }
    html.close("span");
    html.open("span", &[("class", "device-tag")]);
    html.node("b", "", &device.info.tag)
        .node("span", "quiet", &device.info.description)
        .close("span");
    html.open("span", &[("class", "device-position num")]);
    match &overview.position {
        Some(position) => {
            html.node("b", "", &position.text)
                .text(" ")
                .node("i", "unit", position.unit);
        }
        None => {
            html.text("–");
        }
    }
    html.close("span");
    bar(html, overview.position.as_ref());
    let state = match health {
        Health::Silent => device.outcome.map_or("", outcome),
        _ => &overview.state,
    };
    html.node("span", "device-state", state);
    html.node("span", "device-alarms", &alarm_words(overview));
    html.node("span", "quiet device-model", device.device.label());
    let place = format!("{} · unit {}", device.info.bus, device.info.unit);
    html.node("span", "quiet device-bus", &place);
    html.node("span", "num quiet device-age", &since(device, now));
    html.close("div");
}

fn since(device: &DeviceState, now: u64) -> String {
    device
        .last_ok
        .map_or_else(|| "never".to_owned(), |at| age(now.saturating_sub(at)))
}

/// A thin bar; a picture of the number beside it.
fn bar(html: &mut Markup, position: Option<&Figure>) {
    html.open(
        "svg",
        &[
            ("class", "bar"),
            ("viewBox", "0 0 100 6"),
            ("preserveAspectRatio", "none"),
            ("aria-hidden", "true"),
        ],
    );
    rect(html, "bar-track", (0, 0, 100, 6));
    if let Some(position) = position {
        rect(html, "bar-fill", (0, 0, percent(position), 6));
    }
    html.close("svg");
}

fn rect(html: &mut Markup, class: &str, (x, y, width, height): (i32, i32, i32, i32)) {
    html.open(
        "rect",
        &[
            ("class", class),
            ("x", &x.to_string()),
            ("y", &y.to_string()),
            ("width", &width.to_string()),
            ("height", &height.to_string()),
        ],
    );
    html.close("rect");
}

/// A figure as a whole number from -100 to 100, for drawing.
#[expect(
    clippy::cast_possible_truncation,
    reason = "clamped to what fits in a picture"
)]
fn percent(figure: &Figure) -> i32 {
    figure.value.clamp(-100.0, 100.0).round() as i32
}

/// The alarms and warnings that are set, in words.
fn alarm_words(overview: &Overview) -> String {
    let all = overview.alarms.iter().chain(&overview.warnings);
    let names: Vec<_> = all.map(|a| a.member.label).collect();
    match names.len() {
        0 => String::new(),
        1..=2 => names.join(", "),
        n => format!("{}, {} and {} more", names[0], names[1], n - 2),
    }
}

/// Tag, model, position, state and mode of a device.
pub fn header(html: &mut Markup, device: &DeviceState, overview: &Overview, now: u64, up: bool) {
    let health = Health::of(device.outcome, overview);
    html.node("h1", "", &device.info.tag);
    html.open("p", &[("class", "quiet device-place")]);
    html.text(&format!(
        "{} · {} · unit {}",
        device.device.label(),
        device.info.bus,
        device.info.unit
    ));
    if !device.info.description.is_empty() {
        html.text(" · ").text(&device.info.description);
    }
    html.close("p").open("p", &[("class", "device-now")]);
    if let Some(mark) = health_sign(health) {
        sign(html, mark, "20");
    }
    if let Some(position) = &overview.position {
        html.node("b", "", &format!("{} {}", position.text, position.unit));
    }
    html.node("span", "", &overview.state)
        .node("span", "quiet", overview.mode);
    html.close("p");
    let silent = device.outcome.is_some_and(|o| o != Outcome::Ok);
    if silent || !up {
        html.open(
            "p",
            &[("class", "device-silent"), ("data-testid", "device-silent")],
        );
        let words = match (up, device.outcome) {
            (false, _) => "No connection",
            (true, Some(o)) => outcome(o),
            (true, None) => "",
        };
        html.text(words)
            .text(", last good answer ")
            .text(&match device.last_ok {
                Some(_) => format!("{} ago", since(device, now)),
                None => "never".to_owned(),
            });
        html.close("p");
        if up && !device.text.is_empty() {
            html.node("p", "quiet device-why", &device.text);
        }
    }
}

/// The tabs of a device.
pub fn tabs(html: &mut Markup, tag: &str, now: Tab) {
    for tab in Tab::ALL {
        let screen = Screen::Device(tag.to_owned(), tab);
        html.open(
            "a",
            &[
                ("class", "tab"),
                ("role", "tab"),
                ("href", &Route::to(screen).to_string()),
                ("data-testid", &format!("tab-{}", tab.key())),
                ("aria-selected", if tab == now { "true" } else { "false" }),
            ],
        );
        html.text(tab.label()).close("a");
    }
}

/// The figures of the overview: position, torque, mode and facts.
pub fn figures(html: &mut Markup, overview: &Overview) {
    html.open("p", &[("class", "big"), ("data-testid", "position")]);
    match &overview.position {
        Some(position) => {
            html.text(&position.text)
                .text(" ")
                .node("i", "unit", position.unit);
        }
        None => {
            html.text("–");
        }
    }
    html.close("p");
    html.open("p", &[("class", "big-state")]);
    html.text(&overview.state).close("p");
    html.node("h3", "", "Torque");
    torque(html, overview);
    html.open("dl", &[("class", "fact-list")]);
    if !overview.mode.is_empty() {
        super::facts::fact(html, "Selector", overview.mode);
    }
    for (label, text) in &overview.facts {
        super::facts::fact(html, label, text);
    }
    html.close("dl");
}

/// Torque as a bar from the middle, with its limits.
fn torque(html: &mut Markup, overview: &Overview) {
    let Some(torque) = &overview.torque else {
        html.node("p", "quiet", "not read yet");
        return;
    };
    html.open("p", &[("class", "torque-now")]);
    html.node("b", "", &torque.text)
        .text(" ")
        .node("i", "unit", torque.unit);
    if let Some(quality) = torque.quality {
        html.text(" ").node("em", "quality", quality);
    }
    html.close("p");
    let limits = (
        overview.torque_limits.0.as_ref().map(percent),
        overview.torque_limits.1.as_ref().map(percent),
    );
    html.open(
        "svg",
        &[
            ("class", "torque"),
            ("viewBox", "-104 -8 208 48"),
            ("role", "img"),
            ("aria-label", "Torque against its limits"),
        ],
    );
    rect(html, "bar-track", (-100, 12, 200, 10));
    let now = percent(torque);
    let beyond = limits.0.is_some_and(|l| now < -l) || limits.1.is_some_and(|l| now > l);
    let class = if beyond { "bar-beyond" } else { "bar-fill" };
    rect(html, class, (now.min(0), 12, now.abs(), 10));
    line(html, "axis", (0, 8), (0, 26));
    for limit in [limits.0.map(|l| -l), limits.1].into_iter().flatten() {
        line(html, "limit", (limit, 9), (limit, 25));
        label(html, "limit-text", limit, 6, &limit.abs().to_string());
    }
    label(html, "scale-text", 0, 35, "0");
    label(html, "scale-text start", -100, 35, "100 open");
    label(html, "scale-text end", 100, 35, "close 100");
    html.close("svg");
}

fn line(html: &mut Markup, class: &str, from: (i32, i32), to: (i32, i32)) {
    html.open(
        "path",
        &[
            ("class", class),
            ("d", &format!("M{} {}L{} {}", from.0, from.1, to.0, to.1)),
        ],
    );
    html.close("path");
}

fn label(html: &mut Markup, class: &str, x: i32, y: i32, text: &str) {
    html.open(
        "text",
        &[
            ("class", class),
            ("x", &x.to_string()),
            ("y", &y.to_string()),
        ],
    );
    html.text(text).close("text");
}

/// The valve, drawn simply: the gate in its bore, the stem above it, the travel and its limits.
pub fn valve(html: &mut Markup, overview: &Overview) {
    let position = overview.position.as_ref().map(percent);
    let words = match position {
        Some(p) => format!("Valve {p} % open, {}", overview.state),
        None => "Position not read yet".to_owned(),
    };
    html.open(
        "svg",
        &[
            ("class", "valve"),
            ("viewBox", "0 22 260 290"),
            ("role", "img"),
            ("aria-label", &words),
        ],
    );
    // Pipe, bonnet and actuator.
    for d in [
        "M20 206h76M164 206h76M20 296h76M164 296h76",
        "M96 206v-106h68v106M96 296h68",
        "M20 200v102M240 200v102",
    ] {
        html.open("path", &[("class", "body"), ("d", d)])
            .close("path");
    }
    rect(html, "actuator", (88, 58, 84, 42));
    // A stem of 84 above a gate of 90 that travels 90.
    let gate = 206 - position.unwrap_or(0).clamp(0, 100) * 9 / 10;
    if position.is_some() {
        line(html, "stem", (130, gate), (130, gate - 84));
        rect(html, "gate", (104, gate, 52, 90));
        let pointer = format!("M172 {gate}l10 -5v10z");
        html.open("path", &[("class", "pointer"), ("d", &pointer)])
            .close("path");
    }
    // The scale: 0 where the gate is closed, 100 where it is open.
    line(html, "axis", (188, 116), (188, 206));
    for percent in [0, 25, 50, 75, 100] {
        let y = 206 - percent * 9 / 10;
        line(html, "axis", (188, y), (193, y));
        if percent % 50 == 0 {
            label(html, "scale-text start", 197, y + 4, &percent.to_string());
        }
    }
    for (is, y, text) in [
        (overview.open_limit, 116, "open limit"),
        (overview.close_limit, 206, "close limit"),
    ] {
        if is {
            line(html, "reached", (182, y), (194, y));
            label(html, "limit-text start", 197, y - 9, text);
        }
    }
    let arrow = match overview.travel {
        Travel::Opening => Some("M62 150v-56M50 108l12 -14 12 14"),
        Travel::Closing => Some("M62 94v56M50 136l12 14 12 -14"),
        Travel::Stopped => None,
    };
    if let Some(d) = arrow {
        html.open("path", &[("class", "travel"), ("d", d)])
            .close("path");
        let word = if overview.travel == Travel::Opening {
            "opening"
        } else {
            "closing"
        };
        label(html, "scale-text", 62, 172, word);
    }
    html.close("svg");
}

/// The alarms, warnings and status bits that are set.
pub fn conditions(html: &mut Markup, overview: &Overview) {
    if !overview.known {
        html.node("p", "quiet", "The status was not read yet.");
        return;
    }
    list(html, "Alarms", &overview.alarms, Some(Sign::Failure));
    list(html, "Warnings", &overview.warnings, Some(Sign::Warning));
    list(html, "Status", &overview.status, None);
}

fn list(html: &mut Markup, title: &str, bits: &[Active], mark: Option<Sign>) {
    html.node("h3", "", title);
    if bits.is_empty() {
        html.node("p", "quiet", "none");
        return;
    }
    html.open("ul", &[("class", "conditions")]);
    for bit in bits {
        html.open(
            "li",
            &[("data-testid", "condition"), ("data-key", bit.member.key)],
        );
        if let Some(mark) = mark {
            sign(html, mark, "18");
        }
        html.node("span", "", bit.member.label);
        let place = format!("{} bit {}", bit.row.address, bit.member.value);
        html.node("code", "quiet", &place).close("li");
    }
    html.close("ul");
}

#[cfg(test)]
mod tests {
    use super::*;

    fn overview() -> Overview {
        Overview {
            known: true,
            position: Some(Figure {
                value: 45.2,
                text: "45.2".into(),
                unit: "%",
                at: 0,
                quality: None,
            }),
            travel: Travel::Opening,
            state: "Opening".into(),
            ..Overview::default()
        }
    }

    fn drawn(draw: fn(&mut Markup, &Overview), overview: &Overview) -> String {
        let mut html = Markup::new();
        draw(&mut html, overview);
        html.finish()
    }

    #[test]
    fn the_valve_is_a_picture_of_the_data() {
        let html = drawn(valve, &overview());
        assert!(html.contains("45 % open"));
        assert!(html.contains("opening"));
        assert!(!html.contains("style="));
        assert!(drawn(valve, &Overview::default()).contains("not read yet"));
    }

    #[test]
    fn figures_and_conditions() {
        let figures = drawn(figures, &overview());
        assert!(figures.contains("data-testid=\"position\">45.2"));
        assert!(drawn(conditions, &overview()).contains("none"));
        assert!(drawn(conditions, &Overview::default()).contains("not read yet"));
    }

    #[test]
    fn tabs_lead_to_their_addresses() {
        let mut html = Markup::new();
        tabs(&mut html, "XV 1", Tab::Values);
        let html = html.finish();
        assert!(html.contains("href=\"#/device/XV%201/overview\""));
        assert_eq!(html.matches("aria-selected=\"true\"").count(), 1);
    }
}
