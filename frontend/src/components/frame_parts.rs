//! What the parts of a frame share, and what clicks and keys do in them.

use leptos::html::Article;
use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::tree::FieldId;
use wasm_bindgen::JsCast;

use crate::browser::{copy, reveal};
use crate::state::selection::{Origin, Selection};
use crate::state::tree::{Line, Step, all_open, lines, reveal as open_to, step};
use crate::state::work::Shown;

/// Everything that the parts of a frame share.
#[derive(Clone, Copy)]
pub(super) struct Parts {
    pub shown: Memo<Option<Shown>>,
    pub selected: RwSignal<Option<(u32, Selection)>>,
    pub hovered: RwSignal<Option<u32>>,
    pub toggled: RwSignal<Vec<u32>>,
    pub article: NodeRef<Article>,
    pub per_row: Memo<usize>,
}

impl Parts {
    /// The selection, if it is in the frame that is shown.
    pub fn selection(self) -> Option<Selection> {
        let index = self.shown.with(|s| s.as_ref().map(|s| s.index))?;
        self.selected
            .get()
            .filter(|(f, _)| *f == index)
            .map(|s| s.1)
    }

    fn select(self, make: impl Fn(&Shown) -> Option<Selection>) {
        let made = self
            .shown
            .with_untracked(|s| s.as_ref().and_then(|s| Some((s.index, make(s)?))));
        self.selected.set(made);
    }

    pub fn toggle(self, id: u32) {
        self.toggled
            .update(|t| match t.iter().position(|toggled| *toggled == id) {
                Some(at) => {
                    t.swap_remove(at);
                }
                None => t.push(id),
            });
    }

    fn expand(self) {
        let all = self
            .shown
            .with_untracked(|s| s.as_ref().map_or_else(Vec::new, |s| all_open(&s.decoded)));
        self.toggled
            .update(|t| *t = if t.is_empty() { all } else { Vec::new() });
    }

    fn lines(self) -> Vec<Line> {
        self.shown.with_untracked(|s| {
            s.as_ref().map_or_else(Vec::new, |s| {
                self.toggled.with_untracked(|t| lines(&s.decoded, t))
            })
        })
    }

    /// Sets class and tab stop of bytes and fields.
    pub fn mark(self) {
        let Some(article) = self.article.get() else {
            return;
        };
        let hovered = self.hovered.get();
        let selection = self.selection();
        let marked = self.shown.with(|s| {
            let id = FieldId::new(hovered?);
            s.as_ref()?.decoded.field(id).map(|f| f.place)
        });
        let byte_tab = selection.map_or(0, |s| s.byte);
        each(&article, "[data-offset]", |element, at| {
            let at = u16::try_from(at).unwrap_or(u16::MAX);
            class(element, "marked", marked.is_some_and(|p| p.contains(at)));
            let is_selected = selection.is_some_and(|s| s.place.contains(at));
            class(element, "selected", is_selected);
            tab(element, at == byte_tab);
        });
        let field = selection.and_then(|s| s.field).map(FieldId::get);
        each(&article, "[data-field]", |element, id| {
            class(element, "marked", hovered == Some(id));
            class(element, "selected", field == Some(id));
            let chosen = if field == Some(id) { "true" } else { "false" };
            // Fails only for names that are none.
            let _infallible = element.set_attribute("aria-selected", chosen);
            tab(element, field.unwrap_or(0) == id);
        });
    }

    fn find(self, attribute: &str, value: u32) -> Option<web_sys::HtmlElement> {
        // The page may be gone by now.
        let article = self.article.try_get_untracked()??;
        let found = article.query_selector(&format!("[{attribute}=\"{value}\"]"));
        found.ok()??.dyn_into().ok()
    }

    fn focus(self, attribute: &'static str, value: u32) {
        request_animation_frame(move || {
            if let Some(element) = self.find(attribute, value) {
                // Fails only without a window.
                let _infallible = element.focus();
            }
        });
    }
}

/// Brings what somebody else selected into view.
pub(super) fn come_into_view(parts: Parts, selection: Selection) {
    if selection.origin != Origin::Tree
        && let Some(id) = selection.field
        && parts.lines().iter().all(|line| line.id != id)
    {
        parts.shown.with_untracked(|s| {
            if let Some(shown) = s {
                parts.toggled.update(|t| open_to(&shown.decoded, t, id));
            }
        });
    }
    request_animation_frame(move || {
        let byte = parts.find("data-offset", u32::from(selection.place.start));
        if let Some(byte) = byte.filter(|_| selection.origin != Origin::Hex) {
            reveal(&byte);
        }
        let line = selection
            .field
            .and_then(|id| parts.find("data-field", id.get()));
        if let Some(line) = line.filter(|_| selection.origin != Origin::Tree) {
            reveal(&line);
        }
    });
}

/// A click anywhere in the frame.
pub(super) fn on_click(event: &web_sys::MouseEvent, parts: Parts, on_pair: Callback<u32>) {
    if let Some(pair) = number(event, "data-pair") {
        on_pair.run(pair);
    } else if let Some(at) = number(event, "data-problem") {
        parts.select(|s| {
            let problem = s.decoded.problems().get(usize::try_from(at).ok()?)?;
            Some(Selection::problem(&s.decoded, problem.place))
        });
    } else if let Some(at) = number(event, "data-offset") {
        let at = u16::try_from(at).unwrap_or(u16::MAX);
        parts.select(|s| Some(Selection::byte(&s.decoded, at)));
    } else if let Some(id) = number(event, "data-field") {
        if within(event, ".tree-chevron").is_some() {
            parts.toggle(id);
        } else {
            parts.select(|s| Selection::field(&s.decoded, FieldId::new(id)));
        }
    } else if within(event, "[data-expand]").is_some() {
        parts.expand();
    } else if let Some(button) = within(event, "[data-copy]") {
        let form = button.get_attribute("data-copy").unwrap_or_default();
        let text = parts.shown.with_untracked(|s| {
            s.as_ref().map(|s| match form.as_str() {
                "JSON" => s.json(),
                "Text" => s.text(),
                _ => shared::render::Spaced(s.decoded.bytes()).to_string(),
            })
        });
        spawn_local(say_copied(button, form, text.unwrap_or_default()));
    }
}

/// Copies, and says in the button whether it worked.
async fn say_copied(button: web_sys::Element, label: String, text: String) {
    let done = copy(text).await;
    let words = button.query_selector("span").ok().flatten();
    let say = |text: &str| {
        if let Some(words) = &words {
            words.set_text_content(Some(text));
        }
    };
    say(if done { "Copied" } else { "No clipboard" });
    crate::task::sleep(1500).await;
    say(&label);
}

/// The field under the pointer.
pub(super) fn hovered(event: &web_sys::MouseEvent, parts: Parts) -> Option<u32> {
    number(event, "data-field").or_else(|| {
        let at = u16::try_from(number(event, "data-offset")?).ok()?;
        let owner = |s: &Option<Shown>| s.as_ref()?.decoded.owner(at);
        parts.shown.with_untracked(owner).map(FieldId::get)
    })
}

/// A key pressed in the frame: in its bytes or in its tree.
pub(super) fn on_key(event: &web_sys::KeyboardEvent, parts: Parts) {
    if event.ctrl_key() || event.alt_key() || event.meta_key() {
        return;
    }
    if within(event, ".hex").is_some() {
        hex_key(event, parts);
    } else if within(event, ".tree").is_some() {
        tree_key(event, parts);
    }
}

fn hex_key(event: &web_sys::KeyboardEvent, parts: Parts) {
    let len = parts
        .shown
        .with_untracked(|s| s.as_ref().map_or(0, |s| s.decoded.bytes().len()));
    let at = untrack(|| parts.selection()).map_or(0, |s| usize::from(s.byte));
    let row = parts.per_row.get_untracked();
    let next = match event.key().as_str() {
        "ArrowRight" => at + 1,
        "ArrowLeft" => at.saturating_sub(1),
        "ArrowDown" if at + row < len => at + row,
        "ArrowUp" if at >= row => at - row,
        "ArrowDown" | "ArrowUp" => at,
        "Home" => at - at % row,
        "End" => at - at % row + row - 1,
        _ => return,
    };
    event.prevent_default();
    let next = u16::try_from(next.min(len.saturating_sub(1))).unwrap_or(u16::MAX);
    parts.select(|s| Some(Selection::byte(&s.decoded, next)));
    parts.focus("data-offset", u32::from(next));
}

fn tree_key(event: &web_sys::KeyboardEvent, parts: Parts) {
    let lines = parts.lines();
    let field = untrack(|| parts.selection()).and_then(|s| s.field);
    let at = lines.iter().position(|l| Some(l.id) == field);
    match step(&event.key(), &lines, at) {
        Step::To(id) => {
            event.prevent_default();
            parts.select(|s| Selection::field(&s.decoded, id));
            parts.focus("data-field", id.get());
        }
        Step::Toggle(id) => {
            event.prevent_default();
            parts.toggle(id.get());
            parts.focus("data-field", id.get());
        }
        Step::Nothing => {}
    }
}

/// The element around the target of an event that has this selector.
fn within(event: &web_sys::Event, selector: &str) -> Option<web_sys::Element> {
    let target = event.target()?.dyn_into::<web_sys::Element>().ok()?;
    target.closest(selector).ok()?
}

/// The number in an attribute of the target of an event, or of an element around it.
pub(super) fn number(event: &web_sys::Event, attribute: &str) -> Option<u32> {
    let element = within(event, &format!("[{attribute}]"))?;
    element.get_attribute(attribute)?.parse().ok()
}

/// Calls `act` for every element with the selector `[attribute]`, with the attribute's number.
fn each(root: &web_sys::Element, selector: &str, act: impl Fn(&web_sys::Element, u32)) {
    let Ok(found) = root.query_selector_all(selector) else {
        return;
    };
    let name = selector.trim_matches(['[', ']']);
    for at in 0..found.length() {
        let Some(element) = found.item(at) else {
            continue;
        };
        let element: web_sys::Element = element.unchecked_into();
        let value = element.get_attribute(name).and_then(|v| v.parse().ok());
        if let Some(value) = value {
            act(&element, value);
        }
    }
}

fn class(element: &web_sys::Element, name: &str, on: bool) {
    // Fails only for names that are none.
    let _infallible = element.class_list().toggle_with_force(name, on);
}

fn tab(element: &web_sys::Element, on: bool) {
    let _infallible = element.set_attribute("tabindex", if on { "0" } else { "-1" });
}
