//! Pictures of data: the valve, its torque, its position as a bar. SVG without inline styles.

use super::Markup;
use crate::format::within;
use crate::state::overview::{Figure, Overview, Travel};

/// A thin bar; a picture of the number beside it.
pub(super) fn bar(html: &mut Markup, position: Option<&Figure>) {
    html.open(
        "svg",
        &[
            ("class", "bar"),
            ("viewBox", "0 0 100 6"),
            ("preserveAspectRatio", "none"),
            ("aria-hidden", "true"),
        ],
    );
    // An empty track would look like a closed valve.
    if let Some(position) = position {
        rect(html, "bar-track", (0, 0, 100, 6));
        rect(html, "bar-fill", (0, 0, percent(position), 6));
    }
    html.close("svg");
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
            ("viewBox", "0 4 260 308"),
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
    // A stem of 110 above a gate of 90 that travels 90.
    let gate = 206 - position.unwrap_or(0).clamp(0, 100) * 9 / 10;
    if position.is_some() {
        line(html, "stem", (130, gate), (130, gate - 110));
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
    for (is, y, below, text) in [
        (overview.open_limit, 116, -14, "open limit"),
        (overview.close_limit, 206, 20, "close limit"),
    ] {
        if is {
            line(html, "reached", (182, y), (194, y));
            label(html, "limit-text start", 172, y + below, text);
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

/// Torque as a bar from the middle, with its limits.
pub(super) fn torque(html: &mut Markup, overview: &Overview) {
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

/// A rectangle.
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
    within(figure.value, -100.0, 100.0).round() as i32
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

    fn drawn(overview: &Overview) -> String {
        let mut html = Markup::new();
        valve(&mut html, overview);
        html.finish()
    }

    #[test]
    fn the_valve_is_a_picture_of_the_data() {
        let html = drawn(&overview());
        assert!(html.contains("45 % open"));
        assert!(html.contains("opening"));
        assert!(!html.contains("style="));
        assert!(drawn(&Overview::default()).contains("not read yet"));
    }
}
