//! The frames on a bus, as they come.

use std::sync::Arc;

use leptos::prelude::*;
use shared::capture::Micros;
use shared::decode::Context;
use shared::device::Device;
use shared::frame::Role;
use shared::pdu::names;
use shared::session::Session;
use shared::tree::Decoded;

use crate::browser::{Narrow, offset_minutes, save, value_of};
use crate::components::frame_detail::{FrameDetail, Selected};
use crate::components::icon::{Glyph, Icon};
use crate::components::windowed::{DrawRow, Windowed};
use crate::format::{clock, count, millis};
use crate::keys::on_action;
use crate::live::Live;
use crate::markup::Markup;
use crate::markup::frame::{Beside, head, row};
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
    let (in_detail, set_in_detail) = signal(false);

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
    let frames = Memo::new(move |_| {
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
    Effect::new(move |_| {
        let at = cursor.get();
        let frame = at.and_then(|at| frames.with_untracked(|f| f.get(at).copied()));
        if at.is_some() && chosen.get_untracked() != frame {
            chosen.set(frame);
        }
    });
    Effect::new(move |_| {
        let at = frames.with(|f| f.binary_search(&chosen.get_untracked()?).ok());
        if cursor.get_untracked() != at {
            cursor.set(at);
        }
    });
    let shown = Memo::new(move |_| {
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
            None => set_in_detail.set(true),
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
            set_in_detail.set(false);
        }
        _ => {}
    });

    let pause = move |_| {
        if frozen.with_untracked(Option::is_some) {
            frozen.set(None);
        } else {
            let mut copy = None;
            untrack(|| with(&mut |session| copy = Some(session.clone())));
            frozen.set(copy);
        }
    };
    let clear = move |_| {
        let mut end = 0;
        untrack(|| with(&mut |session| end = session.len()));
        filter.update(|f| f.from = end);
    };
    let save_all = move |_| {
        let mut text = String::new();
        untrack(|| with(&mut |session| text = frames.with(|f| export(session, f))));
        save(&format!("{}.hex", bus.get_value()), &text);
    };
    let is_paused = move || frozen.with(Option::is_some);
    let missed = move || {
        let missed = live
            .plant
            .with(|p| bus.with_value(|b| p.bus(b)).map_or(0, |b| b.missed));
        (missed > 0).then(|| format!("{} did not reach this page.", count(missed, "capture")))
    };
    let line = move || {
        live.plant.with(|p| {
            bus.with_value(|b| p.bus(b))
                .map_or_else(String::new, |b| match b.line {
                    shared::proto::LineState::Up => b.info.line.clone(),
                    _ => format!("{}: {}", b.info.line, b.line_text),
                })
        })
    };
    view! {
        <div class="traffic" class:show-detail=move || narrow.get() && in_detail.get()>
            <div class="toolbar">
                <button
                    class="button"
                    data-testid="pause"
                    aria-pressed=move || is_paused().to_string()
                    on:click=pause
                >
                    {move || if is_paused() { "Go on" } else { "Pause" }}
                </button>
                <button class="button" data-testid="clear-traffic" on:click=clear>
                    "Clear"
                </button>
                <FilterFields filter=filter only=only/>
                <button class="button" data-testid="export" on:click=save_all>
                    <Icon glyph=Glyph::Save/>
                    "Save as hex"
                </button>
                <span class="quiet" data-testid="traffic-count">
                    {move || count(u64::try_from(frames.with(|f| f.len())).unwrap_or(0), "frame")}
                </span>
                <span class="quiet line-words">{line}</span>
                <span class="missed" role="status" data-testid="missed">
                    {missed}
                </span>
            </div>
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
                    <button class="button back" on:click=move |_| set_in_detail.set(false)>
                        <Icon glyph=Glyph::Left/>
                        "Frames"
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

/// Unit, function and problems.
#[component]
fn FilterFields(
    /// The filter that they set.
    filter: RwSignal<Filter>,
    /// The unit is fixed.
    only: Option<u8>,
) -> impl IntoView {
    let functions = [1_u8, 2, 3, 4, 5, 6, 8, 15, 16, 17, 20]
        .map(|code| {
            let name = names::function(code).unwrap_or_default();
            view! { <option value=code.to_string()>{format!("{code:02} {name}")}</option> }
                .into_any()
        })
        .into_iter()
        .collect::<Vec<_>>();
    view! {
        <input
            type="search"
            class="unit-field"
            inputmode="numeric"
            placeholder="Unit"
            aria-label="Only this unit"
            data-find
            data-testid="filter-unit"
            hidden=only.is_some()
            on:input=move |e| {
                let unit = value_of(&e).trim().parse().ok();
                filter.update(|f| f.unit = unit);
            }
        />
        <select
            aria-label="Only this function"
            data-testid="filter-function"
            on:change=move |e| {
                let function = value_of(&e).parse().ok();
                filter.update(|f| f.function = function);
            }
        >
            <option value="">"Function"</option>
            {functions}
        </select>
        <label class="check">
            <input
                type="checkbox"
                data-testid="filter-problems"
                on:change=move |e| {
                    let problems = event_target_checked(&e);
                    filter.update(|f| f.problems = problems);
                }
            />
            "Problems only"
        </label>
    }
}

/// Time from the request to its answer.
fn latency(session: &Session, index: u32) -> Option<u64> {
    let frame = session.frame(index)?;
    let is_answer = matches!(frame.role, Role::Response | Role::Exception);
    let pair = frame.pair().filter(|pair| is_answer && *pair < index)?;
    Some(session.at(index)?.since(session.at(pair)?))
}
