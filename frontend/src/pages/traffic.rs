//! What passes on the bus?

use leptos::prelude::*;

use crate::browser::value_of;
use crate::components::conn::ConnNotice;
use crate::components::program::{HART, Program};
use crate::components::traffic::TrafficView;
use crate::erased::memo;
use crate::live::Live;
use crate::router::Router;
use crate::state::plant::BusState;
use crate::state::route::{Route, Screen};

/// The frames of one bus.
#[component]
pub fn TrafficPage() -> impl IntoView {
    let live = Live::get();
    let router = Router::get();
    let screen = router.screen();
    let buses = memo(move || {
        live.plant.with(|p| {
            let names = p.buses.iter().map(|b| b.info.name.clone());
            names.collect::<Vec<_>>()
        })
    });
    let bus = memo(move || match screen.get() {
        Screen::Traffic(Some(bus)) => Some(bus),
        _ => buses.with(|b| b.first().cloned()),
    });
    let options = move || {
        buses
            .get()
            .into_iter()
            .map(|name| {
                let (here, value) = (name.clone(), name.clone());
                view! {
                    <option
                        value=value
                        selected=move || bus.with(|b| b.as_ref() == Some(&here))
                    >
                        {name}
                    </option>
                }
                .into_any()
            })
            .collect::<Vec<_>>()
    };
    let body = move || {
        let bus = bus.get().filter(|name| buses.with(|b| b.contains(name)))?;
        let known = live
            .plant
            .with_untracked(|p| p.bus(&bus).is_some_and(BusState::is_known));
        Some(if known {
            view! { <TrafficView bus=bus/> }.into_any()
        } else {
            view! { <Program name=HART device=None/> }.into_any()
        })
    };
    view! {
        <div class="page" data-testid="page-traffic">
            <header>
                <h1>"Traffic"</h1>
                <select
                    aria-label="Bus"
                    data-testid="traffic-bus"
                    hidden=move || buses.with(Vec::is_empty)
                    on:change=move |e| {
                        router.go(&Route::to(Screen::Traffic(Some(value_of(&e)))));
                    }
                >
                    {options}
                </select>
            </header>
            <ConnNotice/>
            {body}
        </div>
    }
}
