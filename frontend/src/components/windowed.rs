//! A list that draws only the rows in view, however many there are.

use core::ops::Range;
use std::sync::Arc;

use leptos::html::Div;
use leptos::prelude::*;
use wasm_bindgen::prelude::*;

use crate::state::window::{Window, moved};

/// Draws one row.
pub type DrawRow = Arc<dyn Fn(usize) -> AnyView + Send + Sync>;

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
    row_height: Signal<f64>,
    /// Rows are drawn anew when this changes.
    #[prop(into, default = Signal::stored(0))]
    epoch: Signal<u32>,
    /// The row under the cursor.
    cursor: RwSignal<Option<usize>>,
    /// Draws a row.
    draw: DrawRow,
    /// Stays at the end while rows are added, as long as the end is in view.
    #[prop(optional)]
    follow: bool,
    /// Told which rows are in view.
    #[prop(optional)]
    in_view: Option<WriteSignal<Range<usize>>>,
    /// Called when Enter is pressed on a row.
    #[prop(optional)]
    on_enter: Option<Callback<usize>>,
    /// `data-testid` of the list.
    #[prop(default = "list")]
    testid: &'static str,
) -> impl IntoView {
    let list = NodeRef::<Div>::new();
    let (scroll, set_scroll) = signal(0.0_f64);
    let (height, set_height) = signal(600.0_f64);
    let at_end = StoredValue::new(true);
    let window = move || Window {
        count: count.get(),
        row: row_height.get(),
        view: height.get(),
    };
    let slice = Memo::new(move |_| window().at(scroll.get()));

    observe_height(list, set_height);
    let on_scroll = move |_| {
        if let Some(list) = list.get_untracked() {
            let top = f64::from(list.scroll_top());
            set_scroll.set(top);
            at_end.set_value(top + height.get_untracked() + 4.0 >= window().spacer());
        }
    };
    let scroll_to = move |top: f64| {
        if let Some(list) = list.get_untracked() {
            list.set_scroll_top(whole(top));
        }
    };

    // The cursor is always in view.
    Effect::new(move |_| {
        if let Some(at) = cursor.get() {
            let now = scroll.get_untracked();
            let window = untrack(window);
            let wanted = window.reveal(at, now);
            if (wanted - now).abs() > 0.5 {
                // The spacer may not have grown yet.
                request_animation_frame(move || scroll_to(wanted.ceil()));
            }
        }
    });
    if follow {
        Effect::new(move |_| {
            let spacer = window().spacer();
            if at_end.get_value() && cursor.with_untracked(Option::is_none) {
                request_animation_frame(move || scroll_to(spacer));
            }
        });
    }
    if let Some(in_view) = in_view {
        Effect::new(move |before: Option<Range<usize>>| {
            let now = window().visible(scroll.get());
            if before.as_ref() != Some(&now) {
                in_view.set(now.clone());
            }
            now
        });
    }

    let on_key = move |event: web_sys::KeyboardEvent| {
        if event.ctrl_key() || event.alt_key() || event.meta_key() {
            return;
        }
        let key = event.key();
        if key == "Enter"
            && let (Some(at), Some(enter)) = (cursor.get_untracked(), on_enter)
        {
            event.prevent_default();
            enter.run(at);
        }
        let at = cursor.get_untracked();
        let next = moved(&key, at, count.get_untracked(), untrack(window).page());
        if let Some(next) = next {
            event.prevent_default();
            cursor.set(Some(next));
        }
    };
    let active = move || cursor.get().map(|at| format!("{testid}-{at}"));
    let draw = StoredValue::new(draw);

    view! {
        <div
            class="windowed"
            role="listbox"
            tabindex="0"
            aria-label=label
            aria-activedescendant=active
            data-testid=testid
            node_ref=list
            on:scroll=on_scroll
            on:keydown=on_key
        >
            <div class="windowed-space" style:height=move || format!("{}px", window().spacer())>
                <div
                    class="windowed-rows"
                    style:transform=move || format!("translateY({}px)", slice.get().top)
                >
                    <For
                        each=move || {
                            let epoch = epoch.get();
                            slice.get().rows.map(move |at| (at, epoch))
                        }
                        key=|key| *key
                        children=move |(at, _)| {
                            let chosen = move || cursor.get() == Some(at);
                            view! {
                                <div
                                    class="windowed-row"
                                    class:selected=chosen
                                    role="option"
                                    id=format!("{testid}-{at}")
                                    aria-selected=move || chosen().to_string()
                                    aria-setsize=move || count.get().to_string()
                                    aria-posinset=(at + 1).to_string()
                                    style:height=move || format!("{}px", row_height.get())
                                    on:click=move |_| cursor.set(Some(at))
                                >
                                    {draw.with_value(|draw| draw(at))}
                                </div>
                            }
                        }
                    />
                </div>
            </div>
        </div>
    }
}

/// Keeps the height of the list's window.
fn observe_height(list: NodeRef<Div>, set: WriteSignal<f64>) {
    list.on_load(move |element| {
        let watched = element.clone();
        let closure = Closure::<dyn Fn()>::new(move || {
            let height = f64::from(watched.client_height());
            // The list may be hidden, or gone already.
            if height > 0.0 {
                let _gone = set.try_set(height);
            }
        });
        if let Ok(observer) = web_sys::ResizeObserver::new(closure.as_ref().unchecked_ref()) {
            observer.observe(&element);
            let kept = StoredValue::new_local((observer, closure));
            on_cleanup(move || {
                let _gone = kept.try_with_value(|(observer, _)| observer.disconnect());
            });
        }
    });
}

#[expect(
    clippy::cast_possible_truncation,
    reason = "the spacer is below eight million pixels"
)]
fn whole(pixels: f64) -> i32 {
    pixels as i32
}
