//! The fields of a frame.

use std::collections::BTreeSet;

use leptos::html::Div;
use leptos::prelude::*;
use shared::map::row::Trust;
use shared::tree::FieldId;
use shared::value::Quality;
use wasm_bindgen::JsCast;

use crate::browser::reveal;
use crate::components::frame_detail::{Hovered, Selected};
use crate::components::icon::{Glyph, Icon};
use crate::state::selection::{Origin, Selection};
use crate::state::tree::{Facts, Line, all_open, lines, reveal as open_to};
use crate::state::work::Shown;

/// Which fields the user opened or closed.
#[derive(Clone, Copy, Debug)]
struct Toggled(RwSignal<BTreeSet<u32>>);

/// The field tree: label, value, unit, raw bytes and source of every field. Arrow keys move, open
/// and close.
#[component]
pub fn FieldTree(
    /// The frame.
    shown: Shown,
) -> impl IntoView {
    let Hovered(hovered) = expect_context();
    let selected: Selected = expect_context();
    let tree = NodeRef::<Div>::new();
    let toggled = RwSignal::new(BTreeSet::new());
    provide_context(Toggled(toggled));
    let decoded = StoredValue::new(shown.decoded.clone());
    let lines = Memo::new(move |_| toggled.with(|t| decoded.with_value(|d| lines(d, t))));
    let has_closed = decoded.with_value(|d| !all_open(d).is_empty());

    let select = move |id: FieldId| {
        selected.set(decoded.with_value(|d| Selection::field(d, id)));
    };
    let toggle = move |id: FieldId| {
        toggled.update(|t| {
            if !t.remove(&id.get()) {
                t.insert(id.get());
            }
        });
    };
    let on_over = move |event: web_sys::MouseEvent| hovered.set(id_of(&event));
    let on_click = move |event: web_sys::MouseEvent| {
        let Some(id) = id_of(&event) else { return };
        let on_chevron = event
            .target()
            .and_then(|t| t.dyn_into::<web_sys::Element>().ok())
            .is_some_and(|t| t.closest(".tree-chevron").is_ok_and(|e| e.is_some()));
        if on_chevron {
            toggle(id);
        } else {
            select(id);
        }
    };
    let on_double = move |event: web_sys::MouseEvent| {
        if let Some(id) = id_of(&event) {
            toggle(id);
        }
    };
    let on_key = move |event: web_sys::KeyboardEvent| {
        if event.ctrl_key() || event.alt_key() || event.meta_key() {
            return;
        }
        let lines = lines.get_untracked();
        let field = selected.get_untracked().and_then(|s| s.field);
        let at = lines.iter().position(|l| Some(l.id) == field);
        match step(&event.key(), &lines, at) {
            Step::To(id) => {
                event.prevent_default();
                select(id);
                request_animation_frame(move || focus_line(tree, id));
            }
            Step::Toggle(id) => {
                event.prevent_default();
                toggle(id);
            }
            Step::Nothing => {}
        }
    };

    // Somebody else selected: open what is around it, and come into view.
    Effect::new(move |_| {
        if let Some(selection) = selected.get()
            && selection.origin != Origin::Tree
            && let Some(id) = selection.field
        {
            let hidden = untrack(|| lines.with(|l| l.iter().all(|l| l.id != id)));
            if hidden {
                toggled.update(|t| decoded.with_value(|d| open_to(d, t, id)));
            }
            request_animation_frame(move || {
                if let Some(line) = line_element(tree, id) {
                    reveal(&line);
                }
            });
        }
    });

    let open_all = move |_| {
        let all = decoded.with_value(|d| all_open(d));
        toggled.update(|t| *t = if t.is_empty() { all } else { BTreeSet::new() });
    };
    view! {
        <div class="tree-head">
            <span>"Field"</span>
            <span class="right">"Value"</span>
            <span>"Raw"</span>
            <span>"Source"</span>
            {has_closed
                .then(|| {
                    view! {
                        <button class="quiet-button" data-testid="expand-all" on:click=open_all>
                            {move || if toggled.with(BTreeSet::is_empty) { "All bits" } else { "Set bits" }}
                        </button>
                    }
                })}
        </div>
        <div
            class="tree"
            role="tree"
            aria-label="Fields"
            node_ref=tree
            on:mouseover=on_over
            on:mouseleave=move |_| hovered.set(None)
            on:click=on_click
            on:dblclick=on_double
            on:keydown=on_key
        >
            <For
                each=move || lines.get()
                key=|line| line.id
                children=move |line| {
                    decoded
                        .with_value(|d| Facts::of(d, line.id))
                        .map(|facts| view! { <FieldRow line=line facts=facts lines=lines/> })
                }
            />
        </div>
    }
}

/// One line of the tree.
#[component]
fn FieldRow(
    /// Its place in the tree.
    line: Line,
    /// What it says.
    facts: Facts,
    /// The lines shown, for what is open now.
    lines: Memo<Vec<Line>>,
) -> impl IntoView {
    let Hovered(hovered) = expect_context();
    let selected: Selected = expect_context();
    let id = line.id;
    let open = move || lines.with(|l| l.iter().any(|l| l.id == id && l.open));
    let is_selected = move || selected.get().is_some_and(|s| s.field == Some(id));
    let tab = move || match selected.get().and_then(|s| s.field) {
        Some(field) if field == id => "0",
        None if id.get() == 0 => "0",
        _ => "-1",
    };
    let raw = facts.short_raw();
    let numeric = facts.numeric;
    let group = facts.value.is_empty();
    let off = facts.value == shared::value::ACTIVE.0;
    let quality = (facts.quality != Quality::Good).then(|| facts.quality.label());
    let trust = (facts.trust != Trust::Manual && facts.source.is_some()).then(|| facts.trust.key());
    let source = facts.source.map(|s| s.to_string()).unwrap_or_default();
    let chevron = (!line.leaf).then(|| {
        view! {
            <span class="tree-chevron" class:open=open>
                <Icon glyph=Glyph::Chevron/>
            </span>
        }
    });
    view! {
        <div
            class=format!("tree-row depth-{}", line.depth.min(4))
            class:marked=move || hovered.get() == Some(id)
            class:selected=is_selected
            class:group=group
            class:off=off
            role="treeitem"
            tabindex=tab
            attr:aria-level=(line.depth + 1).to_string()
            aria-selected=move || is_selected().to_string()
            aria-expanded=move || (!line.leaf).then(|| open().to_string())
            data-testid="field-row"
            data-path=facts.path
            data-field=id.get().to_string()
        >
            <span class="tree-label">{chevron} {facts.label}</span>
            <span class="tree-value" class:numeric=numeric>
                <b>{facts.value}</b>
                " "
                <i class="unit">{facts.unit}</i>
                {quality.map(|q| view! { <em class="quality">{q}</em> })}
            </span>
            <code class="tree-raw">{raw}</code>
            <span class="tree-source">
                {trust.map(|t| view! { <em class="trust">{t}</em> })} {source}
            </span>
        </div>
    }
}

/// What a key does in the tree.
enum Step {
    To(FieldId),
    Toggle(FieldId),
    Nothing,
}

fn step(key: &str, lines: &[Line], at: Option<usize>) -> Step {
    let to = |line: Option<&Line>| line.map_or(Step::Nothing, |l| Step::To(l.id));
    let Some((at, line)) = at.and_then(|at| Some((at, lines.get(at)?))) else {
        return match key {
            "ArrowDown" | "Home" => to(lines.first()),
            "ArrowUp" | "End" => to(lines.last()),
            _ => Step::Nothing,
        };
    };
    match key {
        "ArrowDown" => to(lines.get(at + 1)),
        "ArrowUp" => to(at.checked_sub(1).and_then(|at| lines.get(at))),
        "Home" => to(lines.first()),
        "End" => to(lines.last()),
        "ArrowRight" if !line.leaf && !line.open => Step::Toggle(line.id),
        "ArrowRight" if !line.leaf => to(lines.get(at + 1)),
        "ArrowLeft" if line.open => Step::Toggle(line.id),
        "ArrowLeft" => line.parent.map_or(Step::Nothing, Step::To),
        "Enter" | " " if !line.leaf => Step::Toggle(line.id),
        _ => Step::Nothing,
    }
}

/// The field of the line that an event happened on.
fn id_of(event: &web_sys::MouseEvent) -> Option<FieldId> {
    let target = event.target()?.dyn_into::<web_sys::Element>().ok()?;
    let line = target.closest("[data-field]").ok()??;
    let id = line.get_attribute("data-field")?.parse().ok()?;
    Some(FieldId::new(id))
}

fn line_element(tree: NodeRef<Div>, id: FieldId) -> Option<web_sys::HtmlElement> {
    let found = tree
        .get_untracked()?
        .query_selector(&format!("[data-field=\"{}\"]", id.get()))
        .ok()??;
    found.dyn_into().ok()
}

fn focus_line(tree: NodeRef<Div>, id: FieldId) {
    if let Some(line) = line_element(tree, id) {
        // Fails only without a window.
        let _infallible = line.focus();
    }
}
