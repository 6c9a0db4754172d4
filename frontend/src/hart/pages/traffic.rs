//! The frames on a HART line, as they come.

use std::sync::Arc;

use leptos::prelude::*;
use shared::capture::Micros;
use shared::device::{Device, Family};
use shared::session::Session;
use shared::tree::Decoded;

use crate::components::drawn::{Act, Draw};
use crate::components::icon::Glyph;
use crate::components::traffic_panes::{TrafficPanes, draw_row, end, pause, save_frames};
use crate::components::windowed::DrawRow;
use crate::erased::memo;
use crate::format::{clock, count};
use crate::hart::state::site::{body, is_about};
use crate::hart::state::unit::Unit;
use crate::hart::store::Store;
use crate::markup::Markup;
use crate::markup::control::{Button, tick};
use crate::state::work::Shown;

/// The frames of the bus; only those of the device on its own page.
#[component]
pub(super) fn TrafficPage(
    /// Only the frames about the device.
    only: bool,
) -> impl IntoView {
    let store = Store::get();
    let frozen = RwSignal::new(None::<Session>);
    let from = RwSignal::new(0_u32);
    let problems = RwSignal::new(false);
    let cursor = RwSignal::new(None::<usize>);
    let in_detail = RwSignal::new(false);

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
            .with(|p| store.tag.with(|t| p.device(t).and_then(|d| d.polling)));
        let own = store.unit.with_untracked(Unit::address);
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
                        is_about(body(session.framing(), bytes), polling, own)
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
            let place = time(session.at(index));
            draw_row(html, session, index, device(), place, scratch);
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
        "pause" => pause(frozen, &with),
        "clear" => from.set(end(&with)),
        "save" => save_frames(&store.bus.get_untracked(), &frames.get_untracked(), &with),
        _ => problems.set(!act.value.is_empty()),
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
