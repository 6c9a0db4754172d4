//! The little of HTML that the pipeline must understand: the tags of `index.html`.

use crate::Result;
use std::ops::Range;

/// The only script of the page.
const BOOT_SCRIPT: &str = r#"<script type="module" src="boot.js"></script>"#;

/// A start tag with its place in the text.
pub struct Tag<'a> {
    /// From `<` to `>`.
    pub place: Range<usize>,
    text: &'a str,
}

impl<'a> Tag<'a> {
    /// The value of an attribute in double quotes.
    pub fn attribute(&self, name: &str) -> Option<&'a str> {
        let start = self.text.find(&format!(" {name}=\""))? + name.len() + 3;
        let (value, _) = self.text.get(start..)?.split_once('"')?;
        Some(value)
    }
}

/// All start tags of this name, in order.
pub fn tags<'a>(html: &'a str, name: &str) -> Vec<Tag<'a>> {
    let open = format!("<{name}");
    let tag = |start: usize| {
        let text = html.get(start..)?;
        let end = text.find('>')? + 1;
        let named = text.get(open.len()..)?.starts_with([' ', '\n', '>']);
        named.then(|| Tag {
            place: start..start + end,
            text: &html[start..start + end],
        })
    };
    html.match_indices(&open)
        .filter_map(|(start, _)| tag(start))
        .collect()
}

/// Checks that the page keeps the contract that [`super`] states.
pub fn check(html: &str) -> Result {
    if !html.contains(BOOT_SCRIPT) || tags(html, "script").len() != 1 {
        return Err(
            format!("static/index.html must hold {BOOT_SCRIPT} and no other script").into(),
        );
    }
    for tag in tags(html, "link") {
        let Some(href) = tag.attribute("href") else {
            return Err(format!("static/index.html: a link needs href=\"…\": {}", tag.text).into());
        };
        if href.starts_with('/') || href.contains("://") {
            return Err(format!("static/index.html: `{href}` must be relative to static/").into());
        }
    }
    Ok(())
}

/// Puts `boot` where the page calls its script.
pub fn replace_boot(html: &str, boot: &str) -> String {
    html.replace(BOOT_SCRIPT, boot)
}

/// Replaces the link tags for which `by` has something better.
pub fn replace_links(
    html: &str,
    mut by: impl FnMut(&Tag<'_>) -> Result<Option<String>>,
) -> Result<String> {
    let mut result = String::with_capacity(html.len());
    let mut done = 0;
    for tag in tags(html, "link") {
        if let Some(text) = by(&tag)? {
            result.push_str(&html[done..tag.place.start]);
            result.push_str(&text);
            done = tag.place.end;
        }
    }
    result.push_str(&html[done..]);
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAGE: &str = "<head><link rel=\"icon\" href=\"i.svg\"><linked>\
        <script type=\"module\" src=\"boot.js\"></script></head>";

    #[test]
    fn tags_are_found_by_their_whole_name() {
        let links = tags(PAGE, "link");
        assert_eq!(links.len(), 1);
        assert_eq!(links[0].attribute("href"), Some("i.svg"));
        assert_eq!(links[0].attribute("type"), None);
    }

    #[test]
    fn the_contract_is_held() {
        assert!(check(PAGE).is_ok());
        assert!(check(&PAGE.replace("boot.js", "other.js")).is_err());
        assert!(check(&format!("{PAGE}<script>alert()</script>")).is_err());
        assert!(check(&PAGE.replace("i.svg", "/i.svg")).is_err());
        assert!(check(&PAGE.replace("i.svg", "https://example.org/i.svg")).is_err());
    }

    #[test]
    fn links_are_replaced_in_place() {
        let page = replace_links(PAGE, |_| Ok(Some("<style></style>".into()))).unwrap();
        assert!(page.starts_with("<head><style></style><linked>"));
        assert_eq!(replace_links(PAGE, |_| Ok(None)).unwrap(), PAGE);
    }
}
