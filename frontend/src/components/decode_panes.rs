//! The frames of what was opened: the problems of all, a list, one in detail.

use std::sync::Arc;

use leptos::prelude::*;
use shared::tree::Decoded;

use crate::browser::{Narrow, focus};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::frame_detail::{FrameDetail, Selected};
use crate::components::problems::ProblemStrip;
use crate::components::windowed::{DrawRow, Windowed};
use crate::decode_store::DecodeStore;
use crate::erased::{effect, memo};
use crate::format::thousands;
use crate::keys::on_action;
use crate::markup::frame::{Beside, head, row};
use crate::markup::{self, Markup};
use crate::state::samples::by_key;
use crate::state::shortcuts::Action;
use crate::state::summary::summary;
use crate::state::work::Shown;

/// What to do with an input without bytes.
const NOTHING: &str =
    "No bytes in this. Write bytes as two hexadecimal digits, such as 01 03 00 00 00 02.";

/// The frames of what was opened, or what to do to see some.
#[component]
pub fn DecodePanes() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let Narrow(narrow) = expect_context();
    let in_detail = RwSignal::new(false);

    let count = memo(move || {
        store.epoch.track();
        store.work.with(|w| {
            w.as_ref()
                .map_or(0, |w| usize::try_from(w.session.len()).unwrap_or(0))
        })
    });
    let shown = memo(move || {
        let index = u32::try_from(store.cursor.get()?).ok()?;
        let device = store.device.get();
        store.work.with(|w| {
            let work = w.as_ref()?;
            Shown::of(&work.session, index, work.device(device))
        })
    });
    let go = Callback::new(move |index: u32| {
        store.cursor.set(usize::try_from(index).ok());
    });
    let scratch = StoredValue::new(Decoded::default());
    let draw: DrawRow = Arc::new(move |at: usize, html: &mut Markup| {
        let index = u32::try_from(at).unwrap_or(u32::MAX);
        let device = store.device.get();
        store.epoch.track();
        let summary = store.work.with_untracked(|w| {
            let work = w.as_ref()?;
            let context = work.context(device);
            scratch
                .try_update_value(|s| summary(&work.session, index, &context, s))
                .flatten()
        });
        if let Some(summary) = summary {
            let beside = Beside {
                place: thousands(summary.frame.offset),
                latency: None,
            };
            row(html, index, &summary, &beside);
        }
    });
    let on_open = Callback::new(move |(_, target): (usize, Option<web_sys::Element>)| {
        let pair = target
            .and_then(|t| t.closest("[data-pair]").ok().flatten())
            .and_then(|t| t.get_attribute("data-pair")?.parse().ok());
        match pair {
            Some(pair) => go.run(pair),
            None => in_detail.set(true),
        }
    });
    on_action(move |action| match action {
        Action::Next | Action::Previous => {
            let count = count.get_untracked();
            let key = if action == Action::Next { "j" } else { "k" };
            let next = crate::state::window::moved(key, store.cursor.get_untracked(), count, 1);
            if next.is_some() {
                store.cursor.set(next);
            }
        }
        Action::Find => focus("[data-find]"),
        Action::Close => {
            store.selected.set(None);
            in_detail.set(false);
        }
        _ => {}
    });
    // A jump from the strip opens the detail.
    effect(move || {
        if store.selected.get().is_some() {
            in_detail.set(true);
        }
    });

    let welcome: Draw = Arc::new(move |html: &mut Markup| {
        if store.work.with(Option::is_some) {
            if count.get() == 0 {
                html.node("p", "empty", NOTHING);
            }
        } else if store.progress.with(Option::is_none) {
            markup::decode::welcome(html);
        }
    });
    let on_sample = Callback::new(move |act: Act| {
        if let Some(sample) = by_key(&act.name) {
            store.open_sample(sample);
        }
    });
    let row_height = Signal::derive(move || if narrow.get() { 56 } else { 28 });
    view! {
        <div class="decode-panes" class:show-detail=move || narrow.get() && in_detail.get()>
            <ProblemStrip/>
            <div class="welcome" hidden=move || { count.get() > 0 }>
                <Drawn class="" draw=welcome on_act=on_sample/>
            </div>
            <div class="panes" hidden=move || count.get() == 0>
                <section class="pane list-pane" aria-label="Frames">
                    <div
                        class="frame-row frame-head"
                        aria-hidden="true"
                        inner_html=head("Offset", false)
                    ></div>
                    <Windowed
                        label="Frames"
                        count=count
                        row_height=row_height
                        cursor=store.cursor
                        draw=draw
                        on_open=on_open
                        testid="frame-list"
                    />
                </section>
                <section class="pane detail-pane" aria-label="Frame">
                    <button class="button back" on:click=move |_| in_detail.set(false)>
                        "Back to the frames"
                    </button>
                    <FrameDetail shown=shown selected=Selected(store.selected) on_pair=go/>
                </section>
            </div>
        </div>
    }
}
