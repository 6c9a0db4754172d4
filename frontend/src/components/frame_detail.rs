//! One frame: its bytes and its meaning as one picture.
//!
//! Hovering or selecting a byte lights its field and the other way round; who selected does not
//! scroll, the others do.

use std::sync::Arc;

use leptos::html::Div;
use leptos::prelude::*;

use super::frame_parts::{Parts, come_into_view, hovered, number, on_click, on_key};
use crate::browser::Narrow;
use crate::components::drawn::{Draw, Drawn};
use crate::erased::{effect, memo};
use crate::markup::{Markup, facts, frame, hex, tree};
use crate::state::selection::Selection;
use crate::state::tree::Facts;
use crate::state::work::Shown;

/// What is selected, with the number of its frame.
#[derive(Clone, Copy, Debug)]
pub struct Selected(pub RwSignal<Option<(u32, Selection)>>);

/// The frame that is shown, with bytes, fields, problems and facts; says what to do if there is
/// none.
#[component]
pub fn FrameDetail(
    /// The frame.
    shown: Memo<Option<Shown>>,
    /// What is selected.
    selected: Selected,
    /// More about the frame, such as its time.
    #[prop(optional)]
    aside: Option<Signal<String>>,
    /// Called to go to the other frame of a pair.
    on_pair: Callback<u32>,
) -> impl IntoView {
    let narrow = use_context::<Narrow>();
    let is_narrow = move || narrow.is_some_and(|n| n.0.get());
    let parts = Parts {
        shown,
        selected: selected.0,
        hovered: RwSignal::new(None),
        toggled: RwSignal::new(Vec::new()),
        article: NodeRef::new(),
        per_row: memo(move || if is_narrow() { 8 } else { 16 }),
    };
    let (bytes, fields) = (NodeRef::<Div>::new(), NodeRef::<Div>::new());

    // Another frame: nothing is hovered or toggled in it.
    effect(move || {
        parts.shown.track();
        parts.hovered.set(None);
        parts.toggled.set(Vec::new());
    });
    // Bytes and fields are marked in place, so they are not morphed.
    effect(move || {
        let per_row = parts.per_row.get();
        fill(bytes, parts, |s| hex::bytes(s, per_row));
    });
    effect(move || {
        let toggled = parts.toggled.get();
        fill(fields, parts, |s| tree::tree(&s.decoded, &toggled));
    });
    effect(move || parts.mark());
    effect(move || {
        if let Some(selection) = parts.selection() {
            come_into_view(parts, selection);
        }
    });

    let head: Draw = Arc::new(move |html: &mut Markup| {
        let aside = aside.map_or_else(String::new, |a| a.get());
        parts.shown.with(|s| match s {
            Some(shown) => frame::head_of(html, shown, &aside),
            None => {
                html.node("p", "empty", "Select a frame to see its bytes and fields.");
            }
        });
    });
    let columns: Draw = Arc::new(move |html: &mut Markup| {
        tree::head(html, parts.toggled.with(Vec::is_empty));
    });
    let facts: Draw = Arc::new(move |html: &mut Markup| {
        let field = parts.selection().and_then(|s| s.field);
        let known = parts
            .shown
            .with(|s| Facts::of(&s.as_ref()?.decoded, field?));
        facts::field(html, known.as_ref());
    });
    view! {
        <article
            class="detail"
            class:none=move || parts.shown.with(Option::is_none)
            class:hex-8=move || parts.per_row.get() == 8
            data-testid="frame-detail"
            aria-label="Frame"
            node_ref=parts.article
            on:click=move |event| on_click(&event, parts, on_pair)
            on:dblclick=move |event| {
                if let Some(id) = number(&event, "data-field") {
                    parts.toggle(id);
                }
            }
            on:mouseover=move |event| parts.hovered.set(hovered(&event, parts))
            on:mouseleave=move |_| parts.hovered.set(None)
            on:keydown=move |event| on_key(&event, parts)
        >
            <Drawn class="detail-top" draw=head/>
            <div class="hex" role="grid" aria-label="Bytes" node_ref=bytes></div>
            <Drawn class="tree-head" draw=columns/>
            <div class="tree" role="tree" aria-label="Fields" node_ref=fields></div>
            <Drawn class="facts" testid="field-facts" draw=facts/>
        </article>
    }
}

/// Draws bytes or fields of the frame, and marks them.
fn fill(node: NodeRef<Div>, parts: Parts, draw: impl Fn(&Shown) -> String) {
    let html = parts
        .shown
        .with(|s| s.as_ref().map_or_else(String::new, draw));
    if let Some(node) = node.get() {
        node.set_inner_html(&html);
    }
    untrack(|| parts.mark());
}
