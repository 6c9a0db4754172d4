//! A network: the drawing, its ports and its polling, the table of all units.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;

use super::save;
use crate::browser::{Narrow, copy};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::windowed::{DrawRow, Windowed};
use crate::erased::memo;
use crate::format::encode;
use crate::markup::Markup;
use crate::network::markup::{drawing, findings, head, line, table};
use crate::network::state::findings::marks;
use crate::network::state::net::Net;
use crate::network::state::picture::Picture;
use crate::network::state::table::{Filter, Order, as_text, rows};
use crate::network::store::Store;
use crate::state::sorted::Columns as _;

/// The network that is followed.
#[component]
pub(super) fn NetworkView() -> impl IntoView {
    let store = Store::get();
    let Narrow(narrow) = expect_context();
    let diagnosis = memo(move || store.net.with(Net::diagnosis));
    let picture = memo(move || {
        store.net.with(|net| {
            let marks = diagnosis.with(|d| {
                d.as_ref()
                    .map(|d| marks(d, net.units.len()))
                    .unwrap_or_default()
            });
            let judged = store.judged.get();
            store
                .tags
                .with(|tags| Picture::of(net, &judged, tags, marks))
        })
    });
    let said: Draw = Arc::new(move |html: &mut Markup| {
        let name = store.names();
        diagnosis.with(|d| {
            if let Some(d) = d {
                findings::findings(html, d, &*name);
            }
        });
    });
    let drawn: Draw = Arc::new(move |html: &mut Markup| {
        let chosen = store.chosen.get();
        picture.with(|picture| match narrow.get() {
            true => line::line(html, picture, chosen),
            false => drawing::drawing(html, picture, chosen),
        });
    });
    let poll: Draw = Arc::new(move |html: &mut Markup| {
        if narrow.get() {
            return;
        }
        let poll = store.poll.get();
        picture.with(|picture| {
            let place = |unit| picture.nodes.iter().position(|n| n.unit == unit);
            let at = poll.and_then(|(unit, port)| Some((place(unit)?, port)));
            drawing::poll(html, picture.nodes.len(), picture.shape, at);
        });
    });
    let choose = Callback::new(move |act: Act| {
        let at = act.element.get_attribute("data-at");
        store.chosen.set(at.and_then(|at| at.parse().ok()));
    });
    let on_key = move |event: web_sys::KeyboardEvent| {
        if event.ctrl_key() || event.alt_key() || event.meta_key() {
            return;
        }
        let key = event.key();
        let at = store.chosen.get_untracked();
        if let (Some(at), "Enter") = (at, key.as_str()) {
            event.prevent_default();
            open(store, at);
            return;
        }
        // Along the cable, whichever way it runs on the screen.
        let key = match key.as_str() {
            "ArrowRight" => "ArrowDown",
            "ArrowLeft" => "ArrowUp",
            other => other,
        };
        let count = picture.with_untracked(|p| p.nodes.len());
        if let Some(next) = crate::state::window::moved(key, at, count, 10) {
            event.prevent_default();
            store.chosen.set(Some(next));
        }
    };
    let legend: Draw = Arc::new(move |html: &mut Markup| {
        if !narrow.get() {
            picture.with(|picture| drawing::legend(html, picture));
        }
    });
    // Beside a low drawing there is no room for the figures; they stand below it.
    let low = move || picture.with(|p| p.nodes.len() <= 52);
    let ports: Draw = Arc::new(move |html: &mut Markup| {
        store.net.with(|net| head::ports(html, net));
    });
    let progress: Draw = Arc::new(move |html: &mut Markup| {
        let poll = store.poll.get();
        store.net.with(|net| head::progress(html, net, poll));
    });
    let passes: Draw = Arc::new(move |html: &mut Markup| {
        store.net.with(|net| head::passes(html, net));
    });
    let chosen: Draw = Arc::new(move |html: &mut Markup| {
        let (at, now) = (store.chosen.get(), store.now_us.get());
        let name = picture.with(|p| at.map_or_else(String::new, |at| p.name(at)));
        store
            .net
            .with(|net| head::chosen(html, net, &name, at, now));
    });
    view! {
        <div class="net-page" data-testid="network">
            <Drawn class="net-findings" role="status" draw=said/>
            <div class="net-picture" class:low=low>
                <div>
                    <div class="net-drawing" on:keydown=on_key>
                        <Drawn class="net-ring" draw=drawn on_act=choose/>
                        <Drawn class="net-poll" draw=poll/>
                    </div>
                    <Drawn class="net-legend quiet" draw=legend/>
                </div>
                <div class="net-side">
                    <Drawn class="net-ports" draw=ports/>
                    <Drawn class="net-progress" draw=progress/>
                    <Drawn class="net-passes" draw=passes/>
                    <Drawn class="net-chosen" draw=chosen/>
                </div>
            </div>
            <UnitTable/>
        </div>
    }
}

/// Opens the page of a unit, by its place.
fn open(store: Store, at: usize) {
    let tag = store
        .net
        .with_untracked(|net| net.units.get(at).map(|u| u.info.tag.clone()));
    if let Some(tag) = tag {
        store.go(&format!("#/device/{}", encode(&tag)));
    }
}

/// All units in a table.
#[component]
fn UnitTable() -> impl IntoView {
    let store = Store::get();
    let Narrow(narrow) = expect_context();
    let cursor = RwSignal::new(None);
    let order = memo(move || Order::parse(&store.query("sort")));
    let query = RwSignal::new(store.query("q"));
    let only = RwSignal::new(!store.query("faults").is_empty());
    let shown = memo(move || {
        let (order, query) = (order.get(), query.get());
        let filter = Filter {
            order,
            query: &query,
            only_faults: only.get(),
        };
        store.net.with(|net| {
            let judged = store.judged.get();
            store.tags.with(|tags| rows(net, &judged, tags, filter))
        })
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let all = store.net.with(|net| net.units.len());
        let many = shown.with(Vec::len);
        table::tools(html, (&query.get(), only.get()), order.get(), (many, all));
    });
    let heads: Draw = Arc::new(move |html: &mut Markup| table::head(html, order.get()));
    let on_act = Callback::new(move |act: Act| match act.name.as_str() {
        "q" => query.set(act.value),
        "faults" => only.set(!act.value.is_empty()),
        "sort" => {
            let chosen = act.element.get_attribute("data-sort").unwrap_or_default();
            store.set_query("sort", &order.get_untracked().after(&chosen));
        }
        "order" => {
            let down = order.get_untracked().down;
            store.set_query(
                "sort",
                &Order::setting(&act.value, down && !act.value.is_empty()),
            );
        }
        "down" => {
            let column = order.get_untracked().column.key();
            store.set_query("sort", &Order::setting(column, !act.value.is_empty()));
        }
        name => {
            let copied = name == "copy";
            let comma = if copied { '\t' } else { ',' };
            let text = store.net.with_untracked(|net| {
                let (rows, now) = (shown.get_untracked(), store.now_us.get_untracked());
                let judged = store.judged.get_untracked();
                store
                    .tags
                    .with_untracked(|tags| as_text(net, tags, (&judged, &rows), now, comma))
            });
            if copied {
                spawn_local(async move {
                    // Without a clipboard the file is left.
                    let _copied = copy(text).await;
                });
            } else {
                save(
                    &format!("units-{}", store.bus.get_untracked()),
                    "csv",
                    &text,
                );
            }
        }
    });
    let draw: DrawRow = Arc::new(move |at: usize, html: &mut Markup| {
        let now = store.now_us.get();
        let place = shown.with(|rows| rows.get(at).copied());
        let Some(place) = place else { return };
        store.judged.with(|judged| {
            let Some(judged) = judged.get(place) else {
                return;
            };
            store.net.with(|net| {
                store
                    .tags
                    .with(|tags| table::row(html, net, tags, (place, judged), now));
            });
        });
    });
    let on_open = Callback::new(move |(at, _): (usize, Option<web_sys::Element>)| {
        if let Some(place) = shown.with_untracked(|rows| rows.get(at).copied()) {
            open(store, place);
        }
    });
    let count = Signal::derive(move || shown.with(Vec::len));
    view! {
        <section class="net-table" aria-label="All units">
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="unit-row unit-head" draw=heads on_act=on_act/>
            <Windowed
                label="Units"
                count=count
                row_height=Signal::derive(move || if narrow.get() { 84 } else { 36 })
                cursor=cursor
                draw=draw
                on_open=on_open
                testid="unit-list"
            />
        </section>
    }
}
