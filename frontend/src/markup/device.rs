//! A device in the list of all, and what its valve does.

use shared::address::Table;
use shared::proto::{NO_POLLING, Outcome};

use super::Markup;
use super::valve::{bar, torque};
use crate::components::ne107::Sign;
use crate::format::age;
use crate::state::health::{Health, health, outcome};
use crate::state::overview::{Active, Overview};
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
    let health = health(device, overview);
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
        // Without a map of its registers, all that is known is whether it answers.
        _ if overview.state.is_empty() => device.outcome.map_or("not asked yet", outcome),
        _ => &overview.state,
    };
    html.node("span", "device-state", state);
    html.node("span", "device-alarms", &alarm_words(overview));
    html.node("span", "quiet device-model", device.device.label());
    let place = format!("{} · {}", unit(device), device.info.bus);
    html.node("span", "quiet device-bus", &place);
    html.node("span", "num quiet device-age", &since(device, now));
    html.close("div");
}

/// Where a device is on its bus.
fn unit(device: &DeviceState) -> String {
    match device.info.unit {
        NO_POLLING if device.is_hart() => "by tag or address".to_owned(),
        unit if device.is_hart() => format!("poll {unit}"),
        unit => format!("unit {unit}"),
    }
}

fn since(device: &DeviceState, now: u64) -> String {
    device
        .last_ok
        .map_or_else(|| "never".to_owned(), |at| age(now.saturating_sub(at)))
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
        "{} · {} · {}",
        device.device.label(),
        device.info.bus,
        unit(device)
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
    if !is_stale(device, up) {
        let words = format!("last answer {} ago", since(device, now));
        html.node("p", "quiet", &words);
    } else {
        html.open(
            "p",
            &[("class", "device-silent"), ("data-testid", "device-silent")],
        );
        let words = match (up, device.outcome) {
            (false, _) => "No connection",
            (true, Some(o)) => outcome(o),
            (true, None) => "Not asked yet",
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

/// True while nobody knows what the device does now.
#[must_use]
pub fn is_stale(device: &DeviceState, up: bool) -> bool {
    // A refusal is an answer, too.
    !up || !matches!(device.outcome, Some(Outcome::Ok | Outcome::Exception))
}

/// The tabs of a device; `deep` if a program of its own shows more of it.
pub fn tabs(html: &mut Markup, tag: &str, now: Tab, deep: bool) {
    for tab in Tab::ALL.into_iter().filter(|t| deep || !t.is_deep()) {
        let screen = Screen::Device(tag.to_owned(), tab.key().to_owned());
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

/// The figures of the overview: position, torque, mode and facts. Stale ones are faint and said to
/// be so.
pub fn figures(html: &mut Markup, overview: &Overview, stale: bool) {
    let class = if stale { "big stale" } else { "big" };
    html.open("p", &[("class", class), ("data-testid", "position")]);
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
    html.text(&overview.state);
    if stale {
        html.text(" ").node("em", "quality stale-mark", "stale");
    }
    html.close("p").node("h3", "", "Torque");
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
        let mut place = bit.row.address.to_string();
        if bit.row.table != Table::Holding {
            place = format!("{} {place}", bit.row.table.short());
        }
        if !bit.row.table.is_bits() {
            place.push_str(&format!(" bit {}", bit.member.value));
        }
        html.node("code", "quiet", &place).close("li");
    }
    html.close("ul");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::overview::{Figure, Travel};

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
    fn figures_and_conditions() {
        let figures = drawn(|html, o| figures(html, o, true), &overview());
        assert!(figures.contains("data-testid=\"position\">45.2"));
        assert!(figures.contains("stale"));
        assert!(drawn(conditions, &overview()).contains("none"));
        assert!(drawn(conditions, &Overview::default()).contains("not read yet"));
    }

    #[test]
    fn tabs_lead_to_their_addresses() {
        let mut html = Markup::new();
        tabs(&mut html, "XV 1", Tab::Values, false);
        let html = html.finish();
        assert!(!html.contains("curves"));
        assert!(html.contains("href=\"#/device/XV%201/overview\""));
        assert_eq!(html.matches("aria-selected=\"true\"").count(), 1);
        let mut html = Markup::new();
        tabs(&mut html, "XV 1", Tab::Logs, true);
        let html = html.finish();
        assert!(html.contains("data-testid=\"tab-logs\" aria-selected=\"true\""));
        assert_eq!(html.matches("role=\"tab\"").count(), 9);
    }
}
