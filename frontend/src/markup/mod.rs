//! Dense parts of the page as HTML text: rows of lists, bytes, fields.
//!
//! A reactive component for every byte and cell would cost a third of the bundle and most of the
//! drawing time; these functions are pure, tested natively, and draw a screen of rows at once. All
//! text is escaped; there are no `style` attributes, which the server's policy forbids.

pub mod about;
pub mod control;
pub mod decode;
pub mod device;
pub mod facts;
pub mod frame;
pub mod hex;
pub mod toolbar;
pub mod tree;
pub mod values;
pub mod valve;

use crate::components::icon::Glyph;
use shared::problem::Severity;

/// HTML under construction.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Markup(String);

impl Markup {
    /// Nothing yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Opens an element.
    pub fn open(&mut self, tag: &str, attributes: &[(&str, &str)]) -> &mut Self {
        self.0.push('<');
        self.0.push_str(tag);
        for (name, value) in attributes {
            self.0.push(' ');
            self.0.push_str(name);
            self.0.push_str("=\"");
            self.escape(value);
            self.0.push('"');
        }
        self.0.push('>');
        self
    }

    /// Closes an element.
    pub fn close(&mut self, tag: &str) -> &mut Self {
        self.0.push_str("</");
        self.0.push_str(tag);
        self.0.push('>');
        self
    }

    /// Text.
    pub fn text(&mut self, text: &str) -> &mut Self {
        self.escape(text);
        self
    }

    /// An element with a class and nothing but text in it.
    pub fn node(&mut self, tag: &str, class: &str, text: &str) -> &mut Self {
        self.open(tag, &[("class", class)]).text(text).close(tag)
    }

    /// An icon beside a text that says the same.
    pub fn icon(&mut self, glyph: Glyph) -> &mut Self {
        self.drawing(("icon", "16"), "1.5", glyph.path(), None)
    }

    /// An icon of 20 pixels.
    pub fn large_icon(&mut self, glyph: Glyph) -> &mut Self {
        self.drawing(("icon", "20"), "1.5", glyph.path(), None)
    }

    /// The mark of a severity: shape besides colour.
    pub fn severity(&mut self, severity: Severity) -> &mut Self {
        let (class, path) = match severity {
            Severity::Error => (
                "severity error",
                "M6.5 6.5l7 7M13.5 6.5l-7 7M10 2a8 8 0 1 0 .01 0z",
            ),
            Severity::Warning => ("severity warning", "M10 2.5l8.5 15h-17zM10 8v4.5M10 15v.2"),
            Severity::Note => ("severity note", "M10 3a7 7 0 1 0 .01 0M10 9v4.5M10 6.3v.2"),
        };
        self.drawing((class, "16"), "1.8", path, Some(severity.key()))
    }

    fn drawing(
        &mut self,
        (class, size): (&str, &str),
        stroke: &str,
        path: &str,
        label: Option<&str>,
    ) -> &mut Self {
        let name = match label {
            Some(label) => ("aria-label", label),
            None => ("aria-hidden", "true"),
        };
        self.open(
            "svg",
            &[
                ("class", class),
                ("width", size),
                ("height", size),
                ("viewBox", "0 0 20 20"),
                ("fill", "none"),
                ("stroke", "currentColor"),
                ("stroke-width", stroke),
                ("stroke-linecap", "round"),
                ("stroke-linejoin", "round"),
                ("role", "img"),
                name,
            ],
        )
        .open("path", &[("d", path)])
        .close("path")
        .close("svg")
    }

    /// HTML that other markup made.
    pub fn append(&mut self, html: &str) -> &mut Self {
        self.0.push_str(html);
        self
    }

    fn escape(&mut self, text: &str) {
        for c in text.chars() {
            match c {
                '&' => self.0.push_str("&amp;"),
                '<' => self.0.push_str("&lt;"),
                '>' => self.0.push_str("&gt;"),
                '"' => self.0.push_str("&quot;"),
                c => self.0.push(c),
            }
        }
    }

    /// The HTML.
    #[must_use]
    pub fn finish(self) -> String {
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_can_not_become_markup() {
        let mut html = Markup::new();
        html.open("b", &[("title", "\"><script>")])
            .text("<i>&")
            .close("b");
        assert_eq!(
            html.finish(),
            "<b title=\"&quot;&gt;&lt;script&gt;\">&lt;i&gt;&amp;</b>"
        );
    }

    #[test]
    fn icons_are_labelled_or_hidden() {
        let mut html = Markup::new();
        html.icon(Glyph::Right).severity(Severity::Error);
        let html = html.finish();
        assert!(html.contains("aria-hidden=\"true\"") && html.contains("aria-label=\"error\""));
        assert!(!html.contains("style="));
    }
}
