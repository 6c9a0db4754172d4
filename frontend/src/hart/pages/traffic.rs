//! The frames on a HART line, as they come.

use std::sync::Arc;

use leptos::prelude::*;
use shared::capture::Micros;
use shared::decode::Context;
use shared::device::{Device, Family};
use shared::session::Session;
use shared::tree::Decoded;

use crate::browser::{Narrow, save};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::frame_detail::{FrameDetail, Selected};
use crate::components::icon::Glyph;
use crate::components::windowed::{DrawRow, Windowed};
use crate::erased::memo;
use crate::format::{clock, count, millis};
use crate::hart::state::site::is_about;
use crate::hart::state::unit::raw_of;
use crate::hart::store::Store;
use crate::markup::Markup;
use crate::markup::control::{Button, tick};
use crate::markup::frame::{Beside, head, row};
use crate::state::summary::summary;
use crate::state::traffic::export;
use crate::state::work::Shown;

/// The frames of the bus; only those of the device on its own page.
#[component]
pub(super) fn TrafficPage(
    /// Only the frames about the device.
    only: bool,
) -> impl IntoView {
    let store = Store::get();
    let Narrow(narrow) = expect_context();
    let frozen = RwSignal::new(None::<Session>);
    let from = RwSignal::new(0_u32);
    let problems = RwSignal::new(false);
    let cursor = RwSignal::new(None::<usize>);
    let in_detail = RwSignal::new(false);
    let selected = RwSignal::new(None);

    let with = move |act: &mut dyn FnMut(&Session)| {
        frozen.with(|frozen| match frozen {
            Some(session) => act(session),
            None => store.traffic.with(|t| {
                if let Some(traffic) = t {
                    act(&traffic.session);
                }
            }),
        });
    };
    // The families of the devices on this bus decide about their bits.
    let device = move || {
        let family: Option<Family> = if only {
            store.unit.with_untracked(|u| u.family)
        } else {
            None
        };
        family.map_or(Device::None, Device::Rotork)
    };
    let frames = memo(move || {
        let (from, problems) = (from.get(), problems.get());
        let polling = store
            .plant
            .with(|p| store.tag.with(|t| p.device(t).map_or(0, |d| d.polling)));
        let long = store.unit.with_untracked(|unit| {
            let good = unit.good(0)?;
            let (kind, id) = (
                raw_of(&good.shown, "expanded_type")? & 0x3FFF,
                raw_of(&good.shown, "device_id")?,
            );
            Some(format!("{kind:04X}{id:06X}"))
        });
        let mut found = Vec::new();
        with(&mut |session| {
            let all = session.first().max(from)..session.len();
            found = all
                .filter(|at| {
                    let bad = session
                        .frame(*at)
                        .is_some_and(|f| f.is_noise() || f.marks.is_damaged());
                    let mine = || {
                        let bytes = session.bytes(*at).unwrap_or(&[]);
                        is_about(bytes, polling, long.as_deref())
                    };
                    (!problems || bad) && (!only || bad || mine())
                })
                .collect();
        });
        Arc::new(found)
    });
    let (start, offset) = store.times();
    let time = move |at: Option<Micros>| {
        let us = at.map_or(0, Micros::get);
        clock(start.saturating_add(us / 1000), offset)
    };
    let scratch = StoredValue::new(Decoded::default());
    let draw: DrawRow = Arc::new(move |at: usize, html: &mut Markup| {
        let Some(index) = frames.with(|f| f.get(at).copied()) else {
            return;
        };
        with(&mut |session| {
            let context = Context {
                framing: session.framing(),
                device: device(),
            };
            let summary = scratch
                .try_update_value(|s| summary(session, index, &context, s))
                .flatten();
            if let Some(summary) = summary {
                let beside = Beside {
                    place: time(session.at(index)),
                    latency: Some(latency(session, index).map_or_else(String::new, millis)),
                };
                row(html, index, &summary, &beside);
            }
        });
    });
    let shown = memo(move || {
        let index = frames.with(|f| cursor.get().and_then(|at| f.get(at).copied()))?;
        let mut shown = None;
        with(&mut |session| shown = Shown::of(session, index, device()));
        shown
    });
    let aside = Signal::derive(move || {
        let index = shown.with(|s| s.as_ref().map(|s| s.index));
        let mut words = String::new();
        if let Some(index) = index {
            with(&mut |session| words = format!(" · {}", time(session.at(index))));
        }
        words
    });
    let go = Callback::new(move |frame: u32| {
        cursor.set(frames.with_untracked(|f| f.binary_search(&frame).ok()));
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
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let paused = frozen.with(Option::is_some);
        Button {
            act: "pause",
            testid: "pause",
            words: if paused { "Go on" } else { "Pause" },
            pressed: Some(paused),
            ..Button::default()
        }
        .draw(html);
        Button {
            act: "clear",
            testid: "clear-traffic",
            words: "Clear",
            ..Button::default()
        }
        .draw(html);
        tick(
            html,
            "problems",
            "filter-problems",
            "Problems only",
            problems.get(),
        );
        Button {
            act: "save",
            testid: "export",
            words: "Save as hex",
            glyph: Some(Glyph::Save),
            ..Button::default()
        }
        .draw(html);
        html.open(
            "span",
            &[("class", "quiet"), ("data-testid", "traffic-count")],
        );
        let frames = frames.with(|f| u64::try_from(f.len()).unwrap_or(0));
        html.text(&count(frames, "frame")).close("span");
        let missed = store.traffic.with(|t| t.as_ref().map_or(0, |t| t.missed));
        if missed > 0 {
            html.open("span", &[("class", "missed"), ("data-testid", "missed")]);
            html.text(&count(missed, "capture"))
                .text(" did not reach this page.")
                .close("span");
        }
    });
    let on_act = Callback::new(move |act: Act| match act.name.as_str() {
        "pause" => {
            let mut copy = None;
            if frozen.with_untracked(Option::is_none) {
                untrack(|| with(&mut |session| copy = Some(session.clone())));
            }
            frozen.set(copy);
        }
        "clear" => {
            let mut end = 0;
            untrack(|| with(&mut |session| end = session.len()));
            from.set(end);
        }
        "save" => {
            let mut text = String::new();
            let listed = frames.get_untracked();
            untrack(|| with(&mut |session| text = export(session, &listed)));
            save(&format!("{}.hex", store.bus.get_untracked()), &text);
        }
        _ => problems.set(!act.value.is_empty()),
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

/// Time from the request to its answer.
fn latency(session: &Session, index: u32) -> Option<u64> {
    let pair = session.frame(index)?.pair().filter(|pair| *pair < index)?;
    Some(session.at(index)?.since(session.at(pair)?))
}
