//! Fields and registers of an object: each lights the other.

use std::sync::Arc;

use leptos::html::Section;
use leptos::prelude::*;
use shared::tree::{FieldId, Name};
use wasm_bindgen::JsCast;

use crate::browser::{Narrow, listen, reveal};
use crate::components::drawn::{Draw, Drawn};
use crate::dop::markup::registers::registers;
use crate::dop::state::kept::Decoded;
use crate::erased::{effect, memo};
use crate::markup::{Markup, facts, tree};
use crate::state::tree::{Facts, Line, Step, lines, step};

/// Arrays longer than this begin closed.
const SHORT: u16 = 4;

/// Registers, fields, and what is known of the chosen one.
#[component]
pub(super) fn FieldsView(
    /// The object.
    decoded: Memo<Option<Decoded>>,
) -> impl IntoView {
    let narrow = use_context::<Narrow>();
    let selected = RwSignal::new(None::<u32>);
    let toggled = RwSignal::new(Vec::<u32>::new());
    let section = NodeRef::<Section>::new();
    // Another object begins with nothing chosen and its arrays closed.
    let shape = memo(move || {
        decoded.with(|d| {
            d.as_ref().map_or_else(String::new, |d| {
                let layout = d.read.layout.map_or("", |l| l.key);
                format!("{} {layout} {}", d.kept.request, d.kept.words.len())
            })
        })
    });
    effect(move || {
        shape.track();
        selected.set(None);
        toggled.set(decoded.with_untracked(|d| d.as_ref().map_or_else(Vec::new, closed)));
    });
    let with = move |make: fn(&mut Markup, &Decoded, Option<u32>, &[u32], usize)| -> Draw {
        Arc::new(move |html: &mut Markup| {
            let per_row = if narrow.is_some_and(|n| n.0.get()) {
                4
            } else {
                8
            };
            decoded.with(|d| {
                if let Some(d) = d {
                    toggled.with(|t| make(html, d, selected.get(), t, per_row));
                }
            });
        })
    };
    let mark = move || {
        let Some(section) = section.try_get_untracked().flatten() else {
            return;
        };
        let chosen = selected.try_get_untracked().flatten();
        let place = decoded.with_untracked(|d| {
            let field = d.as_ref()?.read.decoded.field(FieldId::new(chosen?))?;
            Some(field.place)
        });
        each(&section, "data-field", |element, id| {
            class(element, "selected", Some(id) == chosen);
        });
        each(&section, "data-offset", |element, offset| {
            let at = u16::try_from(offset).unwrap_or(u16::MAX);
            let lit = place.is_some_and(|p| p.contains(at) || p.contains(at.saturating_add(1)));
            class(element, "selected", lit);
        });
    };
    effect(move || {
        selected.track();
        toggled.track();
        decoded.track();
        // After the parts were drawn.
        request_animation_frame(mark);
    });
    let toggle = move |id: u32| {
        toggled.update(|t| match t.iter().position(|open| *open == id) {
            Some(at) => {
                t.swap_remove(at);
            }
            None => t.push(id),
        });
    };
    let choose = move |id: u32, attribute: &'static str| {
        selected.set(Some(id));
        request_animation_frame(move || {
            let element = section.try_get_untracked().flatten().and_then(|section| {
                section
                    .query_selector(&format!("[{attribute}=\"{id}\"]"))
                    .ok()?
            });
            if let Some(element) = element {
                reveal(&element);
            }
        });
    };
    let on_click = move |event: &web_sys::Event| {
        if let Some(offset) = number(event, "data-offset") {
            let at = u16::try_from(offset).unwrap_or(u16::MAX);
            let owner = decoded.with_untracked(|d| d.as_ref()?.read.decoded.owner(at));
            if let Some(owner) = owner {
                let owner = shown(decoded, &toggled.get_untracked(), owner);
                choose(owner.get(), "data-field");
            }
        } else if let Some(id) = number(event, "data-field") {
            if within(event, ".tree-chevron").is_some() || selected.get_untracked() == Some(id) {
                toggle(id);
            }
            choose(id, "data-field");
        } else if within(event, "[data-expand]").is_some() {
            let all = decoded.with_untracked(|d| d.as_ref().map_or_else(Vec::new, closed));
            toggled.update(|t| *t = if t.is_empty() { all } else { Vec::new() });
        }
    };
    let on_key = move |event: &web_sys::KeyboardEvent| {
        if event.ctrl_key()
            || event.alt_key()
            || event.meta_key()
            || within(event, ".tree").is_none()
        {
            return;
        }
        let all: Vec<Line> = decoded.with_untracked(|d| {
            d.as_ref().map_or_else(Vec::new, |d| {
                toggled.with_untracked(|t| lines(&d.read.decoded, t))
            })
        });
        let chosen = selected.get_untracked();
        let at = all.iter().position(|l| Some(l.id.get()) == chosen);
        match step(&event.key(), &all, at) {
            Step::To(id) => {
                event.prevent_default();
                choose(id.get(), "data-field");
            }
            Step::Toggle(id) => {
                event.prevent_default();
                toggle(id.get());
            }
            Step::Nothing => {}
        }
    };
    section.on_load(move |element| {
        listen(&element, &["click", "keydown"], move |event| {
            // The element may serve another object by now.
            if selected.try_get_untracked().is_none() {
                return;
            }
            match event.dyn_ref::<web_sys::KeyboardEvent>() {
                Some(event) => on_key(event),
                None => on_click(event),
            }
        });
    });
    let facts_draw = with(|html, d, chosen, _, _| {
        let facts = chosen.and_then(|id| Facts::of(&d.read.decoded, FieldId::new(id)));
        facts::field(html, facts.as_ref());
    });
    view! {
        <section class="object-fields" node_ref=section>
            <h3>"Registers and fields"</h3>
            <Drawn
                class="hex words"
                role="grid"
                label="Registers"
                draw=with(|html, d, _, _, per_row| registers(html, &d.read.decoded, per_row))
            />
            <Drawn class="facts" testid="field-facts" draw=facts_draw/>
            <Drawn class="tree-head" draw=with(|html, _, _, t, _| tree::head(html, !t.is_empty()))/>
            <div class="tree-box" tabindex="0">
                <Drawn
                    class="tree"
                    role="tree"
                    label="Fields"
                    draw=with(|html, d, _, t, _| { html.append(&tree::tree(&d.read.decoded, t)); })
                />
            </div>
        </section>
    }
}

/// The arrays that begin closed.
fn closed(decoded: &Decoded) -> Vec<u32> {
    let tree = &decoded.read.decoded;
    let long = tree.iter().filter(|(id, field)| match field.name {
        Name::DopArray(def) => def.count > SHORT && !tree.is_leaf(*id),
        _ => false,
    });
    long.map(|(id, _)| id.get()).collect()
}

/// The field itself, or the closed array that it is in.
fn shown(decoded: Memo<Option<Decoded>>, toggled: &[u32], id: FieldId) -> FieldId {
    decoded.with_untracked(|d| {
        let Some(d) = d else { return id };
        let tree = &d.read.decoded;
        let parent = tree.field(id).and_then(|f| f.parent);
        parent.filter(|p| toggled.contains(&p.get())).unwrap_or(id)
    })
}

fn within(event: &web_sys::Event, selector: &str) -> Option<web_sys::Element> {
    let target = event.target()?.dyn_into::<web_sys::Element>().ok()?;
    target.closest(selector).ok()?
}

fn number(event: &web_sys::Event, attribute: &str) -> Option<u32> {
    let element = within(event, &format!("[{attribute}]"))?;
    element.get_attribute(attribute)?.parse().ok()
}

fn each(root: &web_sys::Element, attribute: &str, act: impl Fn(&web_sys::Element, u32)) {
    let Ok(found) = root.query_selector_all(&format!("[{attribute}]")) else {
        return;
    };
    for at in 0..found.length() {
        let Some(element) = found.item(at) else {
            continue;
        };
        let element: web_sys::Element = element.unchecked_into();
        let value = element
            .get_attribute(attribute)
            .and_then(|v| v.parse().ok());
        if let Some(value) = value {
            act(&element, value);
        }
    }
}

fn class(element: &web_sys::Element, name: &str, on: bool) {
    // Fails only for names that are none.
    let _infallible = element.class_list().toggle_with_force(name, on);
}
