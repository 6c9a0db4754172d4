//! Settings, sources, keys: text that does not change while it is shown.

use super::Markup;
use super::control::Button;
use crate::components::icon::Glyph;
use crate::state::shortcuts::KEYS;
use crate::theme::Theme;

/// Documents that facts were taken from: short name, title, revision.
const SOURCES: [[&str; 3]; 5] = [
    [
        "VCIOM-16345-EN",
        "Biffi ICON3000 Modbus RTU Module",
        "PC-15081, 2022",
    ],
    [
        "LMAIM4019-00",
        "Limitorque DDC-100 Direct-to-Host Programming Guide",
        "September 2004; one sample",
    ],
    [
        "Modbus Application Protocol V1.1b3",
        "Modbus Application Protocol Specification",
        "V1.1b3, 2012",
    ],
    [
        "Modbus over Serial Line V1.02",
        "Modbus over Serial Line, Specification and Implementation Guide",
        "V1.02, 2006",
    ],
    [
        "Modbus Messaging on TCP/IP V1.0b",
        "Modbus Messaging on TCP/IP Implementation Guide",
        "V1.0b, 2006",
    ],
];

/// The keys as a table.
pub fn keys(html: &mut Markup) {
    html.open("table", &[("class", "keys")]).open("tbody", &[]);
    for (keys, what) in KEYS {
        html.open("tr", &[]).open("th", &[("scope", "row")]);
        for key in keys.split(' ').filter(|k| !k.is_empty()) {
            html.node("kbd", "", key).text(" ");
        }
        html.close("th").node("td", "", what).close("tr");
    }
    html.close("tbody").close("table");
}

/// The keys in a window over the page.
pub fn help(html: &mut Markup) {
    html.open("div", &[("class", "overlay")]).open(
        "div",
        &[
            ("class", "dialog"),
            ("role", "dialog"),
            ("aria-modal", "true"),
            ("aria-label", "Keys"),
            ("data-testid", "help"),
        ],
    );
    html.open("header", &[]).node("h2", "", "Keys");
    Button {
        act: "close-help",
        words: "Close",
        ..Button::default()
    }
    .draw(html);
    html.close("header");
    keys(html);
    html.close("div").close("div");
}

/// The whole settings screen; `file` is true for a page from a disk.
pub fn settings(html: &mut Markup, theme: Theme, file: bool) {
    html.node("h1", "", "Settings");
    html.open("section", &[]).node("h2", "", "Appearance");
    html.open(
        "div",
        &[
            ("class", "segments"),
            ("role", "radiogroup"),
            ("aria-label", "Appearance"),
        ],
    );
    for choice in Theme::ALL {
        html.open("label", &[("class", "segment")]);
        let mut attributes = vec![
            ("type", "radio"),
            ("name", "theme"),
            ("value", choice.key()),
            ("data-act", "theme"),
        ];
        let testid = format!("theme-{}", choice.key());
        attributes.push(("data-testid", &testid));
        if choice == theme {
            attributes.push(("checked", ""));
        }
        html.open("input", &attributes)
            .node("span", "", choice.label())
            .close("label");
    }
    html.close("div").close("section");
    html.open("section", &[]).node("h2", "", "Keys");
    keys(html);
    html.close("section");
    sources(html);
    html.open("section", &[]).node("h2", "", "About");
    html.node(
        "p",
        "",
        concat!(
            "Valvescope ",
            env!("CARGO_PKG_VERSION"),
            ". It reads, and never writes to a device. Licence: MIT or Apache-2.0, as you like."
        ),
    );
    if !file {
        html.open("p", &[]).open(
            "a",
            &[
                ("class", "button"),
                ("href", "valvescope.html"),
                ("download", "valvescope.html"),
                ("data-testid", "download"),
            ],
        );
        html.icon(Glyph::Save).text("Save as one file").close("a");
        html.node(
            "span",
            "quiet",
            " The whole page in one file, for a computer without a network: decoding works from a double click.",
        );
        html.close("p");
    }
    html.close("section");
}

fn sources(html: &mut Markup) {
    html.open("section", &[]).node("h2", "", "Sources");
    html.node(
        "p",
        "quiet",
        "Every value names the document and place that it was taken from. Only facts were taken: addresses, ranges, units, codes and names.",
    );
    html.open("table", &[("class", "plain")]).open("tbody", &[]);
    for document in SOURCES {
        html.open("tr", &[]);
        for cell in document {
            html.node("td", "", cell);
        }
        html.close("tr");
    }
    html.close("tbody").close("table").close("section");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_present_theme_is_checked() {
        let mut html = Markup::new();
        settings(&mut html, Theme::Dark, true);
        let html = html.finish();
        assert!(html.contains("data-testid=\"theme-dark\" checked"));
        assert!(!html.contains("data-testid=\"download\""));
        assert!(html.contains("<kbd"));
    }
}
