//! The frames on a bus, as they come.

use std::sync::Arc;

use leptos::prelude::*;
use shared::capture::Micros;
use shared::device::Device;
use shared::proto::LineState;
use shared::session::Session;
use shared::tree::Decoded;

use crate::browser::offset_minutes;
use crate::components::drawn::{Act, Draw};
use crate::components::traffic_panes::{TrafficPanes, draw_row, end, latency, pause, save_frames};
use crate::components::windowed::DrawRow;
use crate::erased::{effect, memo};
use crate::format::{clock, millis};
use crate::keys::on_action;
use crate::live::Live;
use crate::markup::{Markup, toolbar};
use crate::state::shortcuts::Action;
use crate::state::traffic::{Filter, listed};
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
    let bus = StoredValue::new(bus);
    let filter = RwSignal::new(Filter {
        unit: only,
        ..Filter::default()
    });
    let frozen = RwSignal::new(None::<Session>);
    let cursor = RwSignal::new(None::<usize>);
    let chosen = RwSignal::new(None::<u32>);
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
            if let Some(frame) = session.frame(index) {
                let place = time(session.at(index));
                draw_row(html, session, index, kind(frame.unit), place, scratch);
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
        "pause" => pause(frozen, &with),
        "clear" => {
            let end = end(&with);
            filter.update(|f| f.from = end);
        }
        "save" => save_frames(&bus.get_value(), &frames.get_untracked(), &with),
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
        <TrafficPanes
            frames=frames
            cursor=cursor
            draw=draw
            shown=shown
            aside=aside
            go=go
            in_detail=in_detail
            tools=tools
            on_act=on_act
        />
    }
}
