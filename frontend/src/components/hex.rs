//! The bytes of a frame.

use leptos::html::Div;
use leptos::prelude::*;
use shared::place::Place;
use shared::problem::{Finding, Severity};
use shared::tree::Decoded;
use wasm_bindgen::JsCast;

use crate::browser::{Narrow, reveal};
use crate::components::frame_detail::{Hovered, Marked, Selected};
use crate::state::selection::{Origin, Selection};
use crate::state::work::Shown;

/// Bytes in hexadecimal and as characters, with problems marked where they are. Hovering or
/// selecting a byte lights its field, and the other way round; arrow keys move the cursor.
#[component]
pub fn HexView(
    /// The frame.
    shown: Shown,
) -> impl IntoView {
    let Hovered(hovered) = expect_context();
    let selected: Selected = expect_context();
    let Narrow(narrow) = use_context().unwrap_or_else(|| Narrow(signal(false).0));
    let grid = NodeRef::<Div>::new();
    let decoded = StoredValue::new(shown.decoded.clone());
    let len = shown.decoded.bytes().len();
    let bad = worst_by_byte(&shown.decoded);
    let missing = missing(&shown.decoded);
    let per_row = move || if narrow.get() { 8_usize } else { 16 };

    let select = move |byte: u16| {
        let selection = decoded.with_value(|d| Selection::byte(d, byte));
        selected.set(Some(selection));
    };
    let on_over = move |event: web_sys::MouseEvent| {
        let field = offset_of(&event).and_then(|at| decoded.with_value(|d| d.owner(at)));
        hovered.set(field);
    };
    let on_click = move |event: web_sys::MouseEvent| {
        if let Some(at) = offset_of(&event) {
            select(at);
        }
    };
    let on_key = move |event: web_sys::KeyboardEvent| {
        let Some(at) = selected.get_untracked().map(|s| usize::from(s.byte)) else {
            return;
        };
        let row = untrack(per_row);
        let next = match event.key().as_str() {
            "ArrowRight" => at + 1,
            "ArrowLeft" => at.saturating_sub(1),
            "ArrowDown" => at + row,
            "ArrowUp" => at.checked_sub(row).unwrap_or(at),
            "Home" => at - at % row,
            "End" => at - at % row + row - 1,
            _ => return,
        };
        event.prevent_default();
        let last = len.saturating_sub(1);
        let next = if next > last && event.key() == "ArrowDown" {
            at
        } else {
            next.min(last)
        };
        select(u16::try_from(next).unwrap_or(u16::MAX));
        if let Some(byte) = byte_element(grid, next) {
            // Fails only without a window.
            let _infallible = byte.focus();
        }
    };

    // Somebody else selected: come into view.
    Effect::new(move |_| {
        if let Some(selection) = selected.get()
            && selection.origin != Origin::Hex
        {
            request_animation_frame(move || {
                if let Some(byte) = byte_element(grid, usize::from(selection.place.start)) {
                    reveal(&byte);
                }
            });
        }
    });

    let rows = {
        let shown = shown.clone();
        move || {
            let per_row = per_row();
            let bytes = shown.decoded.bytes();
            let rows = bytes.chunks(per_row).enumerate();
            rows.map(|(row, bytes)| {
                let from = row * per_row;
                let last = from + bytes.len() == len;
                let cells: Vec<_> = bytes
                    .iter()
                    .enumerate()
                    .map(|(at, byte)| {
                        let class = bad.get(from + at).copied().flatten();
                        view! { <HexByte offset=from + at byte=*byte problem=class/> }
                    })
                    .collect();
                let ghosts = (last).then(|| {
                    let room = missing.min(8);
                    (0..room)
                        .map(|_| view! { <span class="byte ghost" aria-hidden="true">"··"</span> })
                        .collect::<Vec<_>>()
                });
                view! {
                    <div class="hex-row" role="row">
                        <span class="hex-offset" role="rowheader">{format!("{from:04X}")}</span>
                        <span class="hex-bytes">{cells}{ghosts}</span>
                        <span class="hex-text" aria-hidden="true">{characters(bytes)}</span>
                    </div>
                }
            })
            .collect::<Vec<_>>()
        }
    };
    let hidden = shown.hidden();
    view! {
        <div
            class="hex"
            class:hex-8=narrow
            role="grid"
            aria-label="Bytes"
            node_ref=grid
            on:mouseover=on_over
            on:mouseleave=move |_| hovered.set(None)
            on:click=on_click
            on:keydown=on_key
        >
            {rows}
            {(hidden > 0)
                .then(|| {
                    view! { <p class="quiet">{crate::format::count(hidden, "more byte")} " not shown"</p> }
                })}
        </div>
    }
}

/// One byte, marked while the hovered field owns it.
#[component]
fn HexByte(
    /// Place in the frame.
    offset: usize,
    /// The byte.
    byte: u8,
    /// The worst problem about it.
    problem: Option<Severity>,
) -> impl IntoView {
    let Marked(marked) = expect_context();
    let selected: Selected = expect_context();
    let at = u16::try_from(offset).unwrap_or(u16::MAX);
    let holds = move |place: Option<Place>| place.is_some_and(|p| p.contains(at));
    let is_selected = move || holds(selected.get().map(|s| s.place));
    // One byte is reached by Tab: the one under the cursor, or the first.
    let tab = move || match selected.get().map(|s| s.byte) {
        Some(byte) if byte == at => "0",
        None if at == 0 => "0",
        _ => "-1",
    };
    let class = match problem {
        Some(Severity::Error) => "byte bad-error",
        Some(Severity::Warning) => "byte bad-warning",
        _ => "byte",
    };
    view! {
        <span
            class=class
            class:marked=move || holds(marked.get())
            class:selected=is_selected
            role="gridcell"
            tabindex=tab
            data-testid="hex-byte"
            data-offset=offset.to_string()
            aria-selected=move || is_selected().to_string()
        >
            {format!("{byte:02X}")}
        </span>
    }
}

/// The worst error or warning about each byte. Problems of the whole frame mark none: they would
/// mark all.
fn worst_by_byte(decoded: &Decoded) -> Vec<Option<Severity>> {
    let len = decoded.bytes().len();
    let mut worst = vec![None; len];
    for problem in decoded.problems() {
        let range = problem.place.range();
        if range.len() >= len && len > 1 {
            continue;
        }
        for at in range {
            if let Some(slot) = worst.get_mut(at) {
                *slot = (*slot).max(Some(problem.severity()));
            }
        }
    }
    worst
}

/// How many bytes are known to be missing at the end.
fn missing(decoded: &Decoded) -> usize {
    let of = |finding: &Finding| match finding {
        Finding::Truncated { missing } => usize::from(*missing),
        Finding::Crc {
            cause: shared::problem::Cause::Missing,
            ..
        } => 2,
        _ => 0,
    };
    let problems = decoded.problems().iter();
    problems.map(|p| of(&p.finding)).max().unwrap_or(0)
}

fn characters(bytes: &[u8]) -> String {
    let printable = |b: &u8| match b {
        0x20..=0x7E => char::from(*b),
        _ => '·',
    };
    bytes.iter().map(printable).collect()
}

/// The offset of the byte that an event happened on.
fn offset_of(event: &web_sys::MouseEvent) -> Option<u16> {
    let target = event.target()?.dyn_into::<web_sys::Element>().ok()?;
    target.get_attribute("data-offset")?.parse().ok()
}

fn byte_element(grid: NodeRef<Div>, offset: usize) -> Option<web_sys::HtmlElement> {
    let found = grid
        .get_untracked()?
        .query_selector(&format!("[data-offset=\"{offset}\"]"))
        .ok()??;
    found.dyn_into().ok()
}
