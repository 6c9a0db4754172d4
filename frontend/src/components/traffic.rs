//! The frames on a bus, as they come.

use std::sync::Arc;

use leptos::prelude::*;
use shared::capture::Micros;
use shared::decode::Context;
use shared::device::Device;
use shared::frame::Role;
use shared::proto::LineState;
use shared::session::Session;
use shared::tree::Decoded;

use crate::browser::{Narrow, offset_minutes, save};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::frame_detail::{FrameDetail, Selected};
use crate::components::windowed::{DrawRow, Windowed};
use crate::erased::{effect, memo};
use crate::format::{clock, millis};
use crate::keys::on_action;
use crate::live::Live;
use crate::markup::Markup;
use crate::markup::frame::{Beside, head, row};
use crate::markup::toolbar;
use crate::state::shortcuts::Action;
use crate::state::summary::summary;
use crate::state::traffic::{Filter, export, listed};
use crate::state::window::moved;
use crate::state::work::Shown;

/// The frames of a bus, decoded as they come: pause, filter, one frame in detail, export.
#[component]
pub fn TrafficView(
    /// Name of the bus.
    bus: String,
    /// Only this unit, on the page of a device.
    #[prop(default = None)]
    only: Option<u8>,
) -> impl IntoView {
    let live = Live::get();
    let Narrow(narrow) = expect_context();
    let bus = StoredValue::new(bus);
    let filter = RwSignal::new(Filter {
        unit: only,
        ..Filter::default()
    });
    let frozen = RwSignal::new(None::<Session>);
    let cursor = RwSignal::new(None::<usize>);
    let chosen = RwSignal::new(None::<u32>);
    let selected = RwSignal::new(None);
    let in_detail = RwSignal::new(false);

    // While paused, a copy is shown that stands still.
    let with = move |act: &mut dyn FnMut(&Session)| {
        frozen.with(|frozen| match frozen {
            Some(session) => act(session),
            None => live.plant.with(|p| {
                if let Some(bus) = bus.with_value(|b| p.bus(b)) {
                    act(&bus.session);
                }
            }),
        });
    };
    let frames = memo(move || {
        let mut found = Vec::new();
        filter.with(|filter| with(&mut |session| found = listed(session, filter)));
        Arc::new(found)
    });
    let kind = move |unit: u8| {
        live.plant.with_untracked(|p| {
            bus.with_value(|b| p.at(b, unit))
                .map_or(Device::None, |d| d.device)
        })
    };
    let time = move |at: Option<Micros>| {
        let wall = live
            .plant
            .with_untracked(|p| p.wall_ms(at.map_or(0, Micros::get)));
        clock(wall, offset_minutes(wall))
    };
    let scratch = StoredValue::new(Decoded::default());
    let draw: DrawRow = Arc::new(move |at: usize, html: &mut Markup| {
        let Some(index) = frames.with(|f| f.get(at).copied()) else {
            return;
        };
        with(&mut |session| {
            let Some(frame) = session.frame(index) else {
                return;
            };
            let context = Context {
                framing: session.framing(),
                device: kind(frame.unit),
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

    // The cursor stays on its frame when older ones are forgotten or the filter changes.
    effect(move || {
        let at = cursor.get();
        let frame = at.and_then(|at| frames.with_untracked(|f| f.get(at).copied()));
        if at.is_some() && chosen.get_untracked() != frame {
            chosen.set(frame);
        }
    });
    effect(move || {
        let at = frames.with(|f| f.binary_search(&chosen.get_untracked()?).ok());
        if cursor.get_untracked() != at {
            cursor.set(at);
        }
    });
    let shown = memo(move || {
        let index = chosen.get()?;
        let mut shown = None;
        with(&mut |session| {
            let unit = session.frame(index).map_or(0, |f| f.unit);
            shown = Shown::of(session, index, kind(unit));
        });
        shown
    });
    let aside = Signal::derive(move || {
        let mut words = String::new();
        if let Some(index) = chosen.get() {
            with(&mut |session| {
                words = format!(" · {}", time(session.at(index)));
                if let Some(latency) = latency(session, index) {
                    words.push_str(&format!(" · answered after {}", millis(latency)));
                }
            });
        }
        words
    });
    let go = Callback::new(move |frame: u32| {
        let at = frames.with_untracked(|f| f.binary_search(&frame).ok());
        chosen.set(Some(frame));
        cursor.set(at);
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
            let key = if action == Action::Next { "j" } else { "k" };
            let count = frames.with_untracked(|f| f.len());
            cursor.update(|at| *at = moved(key, *at, count, 1).or(*at));
        }
        Action::Close => {
            chosen.set(None);
            cursor.set(None);
            in_detail.set(false);
        }
        _ => {}
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
            filter.update(|f| f.from = end);
        }
        "save" => {
            let mut text = String::new();
            let listed = frames.get_untracked();
            untrack(|| with(&mut |session| text = export(session, &listed)));
            save(&format!("{}.hex", bus.get_value()), &text);
        }
        name => filter.update(|f| match name {
            "unit" => f.unit = act.value.trim().parse().ok(),
            "function" => f.function = act.value.parse().ok(),
            _ => f.problems = !act.value.is_empty(),
        }),
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let now = live.plant.with(|p| {
            let bus = bus.with_value(|b| p.bus(b));
            toolbar::Traffic {
                paused: frozen.with(Option::is_some),
                frames: frames.with(|f| f.len()),
                missed: bus.map_or(0, |b| b.missed),
                line: bus.map_or_else(String::new, |b| match b.line {
                    LineState::Up => b.info.line.clone(),
                    _ => format!("{}: {}", b.info.line, b.line_text),
                }),
                fixed_unit: only.is_some(),
            }
        });
        filter.with(|f| toolbar::traffic(html, &now, f));
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
    let frame = session.frame(index)?;
    let is_answer = matches!(frame.role, Role::Response | Role::Exception);
    let pair = frame.pair().filter(|pair| is_answer && *pair < index)?;
    Some(session.at(index)?.since(session.at(pair)?))
}
