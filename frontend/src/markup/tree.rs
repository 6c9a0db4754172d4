//! The fields of a frame.

use shared::map::row::Trust;
use shared::tree::Decoded;
use shared::value::{ACTIVE, Quality};

use super::Markup;
use crate::components::icon::Glyph;
use crate::state::tree::{Facts, Line, lines};

/// Names of the columns, and a button that opens or closes all bits.
pub fn head(html: &mut Markup, all_closed: bool) {
    html.node("span", "", "Field")
        .node("span", "right", "Value")
        .node("span", "", "Raw")
        .node("span", "", "Source");
    html.open(
        "button",
        &[
            ("class", "quiet-button"),
            ("data-expand", ""),
            ("data-testid", "expand-all"),
        ],
    );
    html.text(if all_closed { "All bits" } else { "Fewer" })
        .close("button");
}

/// The field tree; `toggled` are the fields that the user opened or closed.
#[must_use]
pub fn tree(decoded: &Decoded, toggled: &[u32]) -> String {
    let mut html = Markup::new();
    for line in lines(decoded, toggled) {
        if let Some(facts) = Facts::of(decoded, line.id) {
            row(&mut html, line, &facts);
        }
    }
    html.finish()
}

fn row(html: &mut Markup, line: Line, facts: &Facts) {
    let mut class = format!("tree-row depth-{}", line.depth.min(4));
    for (is, name) in [
        (facts.value.is_empty(), " group"),
        (facts.value == ACTIVE.0, " off"),
    ] {
        if is {
            class.push_str(name);
        }
    }
    let (level, id) = ((line.depth + 1).to_string(), line.id.get().to_string());
    let mut attributes = vec![
        ("class", class.as_str()),
        ("role", "treeitem"),
        ("tabindex", "-1"),
        ("aria-level", &level),
        ("data-testid", "field-row"),
        ("data-path", &facts.path),
        ("data-field", &id),
    ];
    if !line.leaf {
        let open = if line.open { "true" } else { "false" };
        attributes.push(("aria-expanded", open));
    }
    html.open("div", &attributes);
    html.open("span", &[("class", "tree-label")]);
    if !line.leaf {
        html.open("span", &[("class", "tree-chevron")]);
        html.icon(Glyph::Chevron).close("span");
    }
    html.text(&facts.label).close("span");
    let numeric = if facts.numeric {
        "tree-value numeric"
    } else {
        "tree-value"
    };
    html.open("span", &[("class", numeric)]);
    html.node("b", "", &facts.value);
    html.text(" ").node("i", "unit", facts.unit);
    if facts.quality != Quality::Good {
        html.text(" ").node("em", "quality", facts.quality.label());
    }
    html.close("span");
    html.node("code", "tree-raw", &facts.short_raw());
    html.open("span", &[("class", "tree-source")]);
    if let Some(source) = facts.source {
        if facts.trust != Trust::Manual {
            html.node("em", "trust", facts.trust.key()).text(" ");
        }
        html.text(&source.to_string());
    }
    html.close("span").close("div");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::load::load;
    use crate::state::work::Shown;
    use shared::device::Device;

    #[test]
    fn every_field_has_its_path() {
        let loaded = load(b"7D0300070003BFF6", None);
        let shown = Shown::of(&loaded.session, 0, Device::None).unwrap();
        let html = tree(&shown.decoded, &[]);
        for path in ["unit", "function", "crc"] {
            assert!(html.contains(&format!("data-path=\"{path}\"")), "{html}");
        }
        assert_eq!(
            html.matches("data-testid=\"field-row\"").count(),
            shown.decoded.fields().len()
        );
    }
}
