//! The frames of a bus beside one of them in detail: what all pages of traffic have alike.

use std::sync::Arc;

use leptos::prelude::*;
use shared::decode::Context;
use shared::device::Device;
use shared::frame::Role;
use shared::session::Session;
use shared::tree::Decoded;

use crate::browser::{Narrow, save};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::frame_detail::{FrameDetail, Selected};
use crate::components::windowed::{DrawRow, Windowed};
use crate::format::millis;
use crate::markup::Markup;
use crate::markup::frame::{Beside, head, row};
use crate::state::summary::summary;
use crate::state::traffic::export;
use crate::state::work::Shown;

/// Calls with the session that is shown.
pub type WithSession = dyn Fn(&mut dyn FnMut(&Session));

/// The list with its tools, and a frame in detail; on a narrow screen one of them.
#[component]
pub fn TrafficPanes(
    /// The frames in the list.
    frames: Memo<Arc<Vec<u32>>>,
    /// Where the cursor is in it.
    cursor: RwSignal<Option<usize>>,
    /// Draws a row.
    draw: DrawRow,
    /// The frame in detail.
    shown: Memo<Option<Shown>>,
    /// What stands beside its title.
    aside: Signal<String>,
    /// Goes to a frame.
    go: Callback<u32>,
    /// True while a narrow screen shows the frame.
    in_detail: RwSignal<bool>,
    /// Draws the tools.
    tools: Draw,
    /// Called when one of them is used.
    on_act: Callback<Act>,
) -> impl IntoView {
    let Narrow(narrow) = expect_context();
    let selected = RwSignal::new(None);
    let on_open = Callback::new(move |(_, target): (usize, Option<web_sys::Element>)| {
        let pair = target
            .and_then(|t| t.closest("[data-pair]").ok().flatten())
            .and_then(|t| t.get_attribute("data-pair")?.parse().ok());
        match pair {
            Some(pair) => go.run(pair),
            None => in_detail.set(true),
        }
    });
    view! {
        <div class="traffic" class:show-detail=move || narrow.get() && in_detail.get()>
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <div class="panes">
                <section class="pane list-pane" aria-label="Frames">
                    <div
                        class="frame-row frame-head with-latency"
                        aria-hidden="true"
                        inner_html=head("Time", true)
                    ></div>
                    <Windowed
                        label="Frames"
                        count=Signal::derive(move || frames.with(|f| f.len()))
                        row_height=Signal::derive(move || if narrow.get() { 56 } else { 28 })
                        cursor=cursor
                        draw=draw
                        follow=true
                        on_open=on_open
                        testid="traffic-list"
                    />
                </section>
                <section class="pane detail-pane" aria-label="Frame">
                    <button class="button back" on:click=move |_| in_detail.set(false)>
                        "Back to the frames"
                    </button>
                    <FrameDetail
                        shown=shown
                        selected=Selected(selected)
                        aside=aside
                        on_pair=go
                    />
                </section>
            </div>
        </div>
    }
}

/// Draws a frame as a row; `scratch` is used to decode it.
pub fn draw_row(
    html: &mut Markup,
    session: &Session,
    index: u32,
    device: Device,
    place: String,
    scratch: StoredValue<Decoded>,
) {
    let context = Context {
        framing: session.framing(),
        device,
    };
    let summary = scratch
        .try_update_value(|s| summary(session, index, &context, s))
        .flatten();
    if let Some(summary) = summary {
        let beside = Beside {
            place,
            latency: Some(latency(session, index).map_or_else(String::new, millis)),
        };
        row(html, index, &summary, &beside);
    }
}

/// Stops or lets go: while stopped, a copy is shown that stands still.
pub fn pause(frozen: RwSignal<Option<Session>>, with: &WithSession) {
    let mut copy = None;
    if frozen.with_untracked(Option::is_none) {
        untrack(|| with(&mut |session| copy = Some(session.clone())));
    }
    frozen.set(copy);
}

/// The number behind the last frame: what was heard before is left out from now on.
pub fn end(with: &WithSession) -> u32 {
    let mut end = 0;
    untrack(|| with(&mut |session| end = session.len()));
    end
}

/// Saves the frames of the list as text.
pub fn save_frames(bus: &str, frames: &[u32], with: &WithSession) {
    let mut text = String::new();
    untrack(|| with(&mut |session| text = export(session, frames)));
    save(&format!("{bus}.hex"), &text);
}

/// Time from the request to its answer.
#[must_use]
pub fn latency(session: &Session, index: u32) -> Option<u64> {
    let frame = session.frame(index)?;
    let is_answer = matches!(frame.role, Role::Response | Role::Exception);
    let pair = frame.pair().filter(|pair| is_answer && *pair < index)?;
    Some(session.at(index)?.since(session.at(pair)?))
}
