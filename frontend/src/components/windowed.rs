//! A list that draws only the rows in view, however many there are.

use core::ops::Range;
use std::cell::RefCell;
use std::collections::VecDeque;
use std::sync::Arc;

use leptos::html::Div;
use leptos::prelude::*;
use wasm_bindgen::prelude::*;

use crate::components::drawn::morph_into;
use crate::erased::effect;
use crate::markup::Markup;
use crate::state::window::{Slice, Window, moved};

/// Draws one row; it is drawn again when a signal that it follows changes.
pub type DrawRow = Arc<dyn Fn(usize, &mut Markup) + Send + Sync>;

/// A row as it stands in the page.
#[derive(Debug)]
struct Slot {
    element: web_sys::Element,
    at: usize,
    chosen: bool,
    html: String,
}

/// A list of rows of equal height. Arrow keys, Home, End and paging move the cursor.
#[component]
pub fn Windowed(
    /// Name for those who do not see it.
    label: &'static str,
    /// Number of rows.
    #[prop(into)]
    count: Signal<usize>,
    /// Height of a row in pixels.
    #[prop(into)]
    row_height: Signal<i32>,
    /// The row under the cursor.
    cursor: RwSignal<Option<usize>>,
    /// Draws a row.
    draw: DrawRow,
    /// Stays at the end while rows are added, as long as the end is in view.
    #[prop(optional)]
    follow: bool,
    /// Told which rows are in view.
    #[prop(optional)]
    in_view: Option<RwSignal<Range<usize>>>,
    /// Called when Enter is pressed on a row or it is clicked, with the element that was clicked.
    #[prop(optional)]
    on_open: Option<Callback<(usize, Option<web_sys::Element>)>>,
    /// `data-testid` of the list.
    #[prop(default = "list")]
    testid: &'static str,
) -> impl IntoView {
    let list = NodeRef::<Div>::new();
    let rows = NodeRef::<Div>::new();
    let scroll = RwSignal::new(0_i32);
    let height = RwSignal::new(600_i32);
    let at_end = StoredValue::new(true);
    let window = move || Window {
        count: count.get(),
        row: f64::from(row_height.get()),
        view: f64::from(height.get()),
    };
    observe_height(list, height);
    let on_scroll = move |_| {
        if let Some(list) = list.get_untracked() {
            let top = list.scroll_top();
            scroll.set(top);
            at_end.set_value(top + height.get_untracked() + 4 >= list.scroll_height());
        }
    };
    let scroll_to = move |top: f64| {
        // The list may be gone by now.
        if let Some(Some(list)) = list.try_get_untracked() {
            list.set_scroll_top(whole(top));
        }
    };

    let slots = RefCell::new(VecDeque::<Slot>::new());
    effect(move || {
        let Some(rows) = rows.get() else { return };
        let slice = window().at(f64::from(scroll.get()));
        place(&rows, &slice);
        let chosen = cursor.get();
        fill(
            &rows,
            &mut slots.borrow_mut(),
            &slice,
            chosen,
            testid,
            &draw,
        );
    });

    // The cursor is always in view.
    effect(move || {
        if let Some(at) = cursor.get() {
            let now = f64::from(scroll.get_untracked());
            let wanted = untrack(window).reveal(at, now);
            if (wanted - now).abs() > 0.5 {
                // The spacer may not have grown yet.
                request_animation_frame(move || scroll_to(wanted.ceil()));
            }
        }
    });
    effect(move || {
        let window = window();
        if follow && at_end.get_value() && cursor.with_untracked(Option::is_none) {
            request_animation_frame(move || scroll_to(window.spacer()));
        }
    });
    effect(move || {
        if let Some(in_view) = in_view {
            let now = window().visible(f64::from(scroll.get()));
            if in_view.with_untracked(|before| *before != now) {
                in_view.set(now);
            }
        }
    });

    let open = move |at: usize, target: Option<web_sys::Element>| {
        if let Some(on_open) = on_open {
            on_open.run((at, target));
        }
    };
    let on_key = move |event: web_sys::KeyboardEvent| {
        if event.ctrl_key() || event.alt_key() || event.meta_key() {
            return;
        }
        let key = event.key();
        let at = cursor.get_untracked();
        if let (Some(at), true) = (at, key == "Enter") {
            event.prevent_default();
            open(at, None);
        }
        let next = moved(&key, at, count.get_untracked(), untrack(window).page());
        if let Some(next) = next {
            event.prevent_default();
            cursor.set(Some(next));
        }
    };
    let on_click = move |event: web_sys::MouseEvent| {
        let target = event
            .target()
            .and_then(|t| t.dyn_into::<web_sys::Element>().ok());
        let at = target
            .as_ref()
            .and_then(|t| t.closest("[data-at]").ok().flatten())
            .and_then(|row| row.get_attribute("data-at")?.parse().ok());
        if let Some(at) = at {
            cursor.set(Some(at));
            open(at, target);
        }
    };
    view! {
        <div
            class="windowed"
            role="listbox"
            tabindex="0"
            aria-label=label
            aria-activedescendant=move || cursor.get().map(|at| format!("{testid}-{at}"))
            data-testid=testid
            node_ref=list
            on:scroll=on_scroll
            on:keydown=on_key
            on:click=on_click
        >
            <div
                class="windowed-space"
                style:height=move || format!("{}px", whole(window().spacer()))
            >
                <div
                    class="windowed-rows"
                    role="presentation"
                    style:--row=move || format!("{}px", row_height.get())
                    node_ref=rows
                ></div>
            </div>
        </div>
    }
}

/// Moves the rows to where they belong.
fn place(rows: &web_sys::HtmlElement, slice: &Slice) {
    let top = format!("translateY({}px)", whole(slice.top));
    // Fails only for names that are none.
    let _infallible = rows.style().set_property("transform", &top);
}

/// Brings the rows up to date; one that did not change is left alone.
fn fill(
    rows: &web_sys::Element,
    slots: &mut VecDeque<Slot>,
    slice: &Slice,
    chosen: Option<usize>,
    testid: &str,
    draw: &DrawRow,
) {
    rotate(rows, slots, slice.rows.start);
    while slots.len() > slice.rows.len() {
        if let Some(slot) = slots.pop_back() {
            slot.element.remove();
        }
    }
    while slots.len() < slice.rows.len() {
        let Some(element) = new_row(rows) else { return };
        slots.push_back(Slot {
            element,
            at: usize::MAX,
            chosen: false,
            html: String::new(),
        });
    }
    for (slot, at) in slots.iter_mut().zip(slice.rows.clone()) {
        let mut html = Markup::new();
        draw(at, &mut html);
        let html = html.finish();
        let is_chosen = chosen == Some(at);
        if slot.at != at {
            set(&slot.element, "data-at", &at.to_string());
            set(&slot.element, "id", &format!("{testid}-{at}"));
            set(&slot.element, "aria-posinset", &(at + 1).to_string());
        }
        if slot.at != at || slot.chosen != is_chosen {
            let class = if is_chosen {
                "windowed-row selected"
            } else {
                "windowed-row"
            };
            set(&slot.element, "class", class);
            let selected = if is_chosen { "true" } else { "false" };
            set(&slot.element, "aria-selected", selected);
        }
        if slot.html != html {
            morph_into(&slot.element, &html);
            slot.html = html;
        }
        slot.at = at;
        slot.chosen = is_chosen;
    }
}

/// After a short scroll most rows stay: those that left at one end are used again at the other.
fn rotate(rows: &web_sys::Element, slots: &mut VecDeque<Slot>, start: usize) {
    let Some(first) = slots.front().map(|s| s.at) else {
        return;
    };
    let many = slots.len();
    if start > first && start - first < many {
        for _ in first..start {
            if let Some(slot) = slots.pop_front() {
                // Moves the element, which is there already.
                let _infallible = rows.append_child(&slot.element);
                slots.push_back(slot);
            }
        }
    } else if first > start && first - start < many {
        for _ in start..first {
            let before = slots.front().map(|s| s.element.clone());
            if let (Some(slot), Some(before)) = (slots.pop_back(), before) {
                let _infallible = rows.insert_before(&slot.element, Some(&before));
                slots.push_front(slot);
            }
        }
    }
}

fn new_row(rows: &web_sys::Element) -> Option<web_sys::Element> {
    let element = document().create_element("div").ok()?;
    set(&element, "role", "option");
    rows.append_child(&element).ok()?;
    Some(element)
}

fn set(element: &web_sys::Element, name: &str, value: &str) {
    // Fails only for names that are none.
    let _infallible = element.set_attribute(name, value);
}

/// Keeps the height of the list's window.
fn observe_height(list: NodeRef<Div>, height: RwSignal<i32>) {
    list.on_load(move |element| {
        let watched = element.clone();
        let closure = Closure::<dyn Fn()>::new(move || {
            let now = watched.client_height();
            // The list may be hidden, or gone already.
            if now > 0 && height.try_get_untracked().is_some_and(|h| h != now) {
                let _gone = height.try_set(now);
            }
        });
        if let Ok(observer) = web_sys::ResizeObserver::new(closure.as_ref().unchecked_ref()) {
            observer.observe(&element);
            // Lives until the element does not.
            closure.forget();
        }
    });
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the spacer is at most eight million pixels"
)]
fn whole(pixels: f64) -> i32 {
    pixels as i32
}
