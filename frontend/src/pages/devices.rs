//! Is anything wrong, and where?

use std::sync::Arc;

use leptos::prelude::*;

use crate::browser::Narrow;
use crate::components::conn::ConnNotice;
use crate::components::windowed::{DrawRow, Windowed};
use crate::erased::memo;
use crate::keys::on_action;
use crate::live::Live;
use crate::markup::{Markup, device};
use crate::router::Router;
use crate::state::health::{Health, health};
use crate::state::plant::Plant;
use crate::state::route::{Route, Screen};
use crate::state::shortcuts::Action;
use crate::state::window::moved;

/// All devices, the worst first.
#[component]
pub fn DevicesPage() -> impl IntoView {
    let live = Live::get();
    let router = Router::get();
    let Narrow(narrow) = expect_context();
    let cursor = RwSignal::new(None);
    let order = memo(move || {
        live.plant.with(|plant| {
            let mut order: Vec<(Health, usize)> = Vec::new();
            for (at, d) in plant.devices.iter().enumerate() {
                let health = health(d, &d.overview());
                // The worst first, equal ones as configured.
                let place = order.partition_point(|(other, _)| *other >= health);
                order.insert(place, (health, at));
            }
            order.into_iter().map(|(_, at)| at).collect::<Vec<_>>()
        })
    });
    let draw: DrawRow = Arc::new(move |at: usize, html: &mut Markup| {
        let up = live.conn.get().is_up();
        let now = live.now.get();
        live.plant.with(|plant| {
            let device = order.with(|o| o.get(at).copied());
            if let Some(d) = device.and_then(|at| plant.devices.get(at)) {
                device::row(html, d, &d.overview(), now, up);
            }
        });
    });
    let open = Callback::new(move |(at, _): (usize, Option<web_sys::Element>)| {
        let tag = order.with_untracked(|o| o.get(at).copied()).and_then(|at| {
            live.plant
                .with_untracked(|p| Some(p.devices.get(at)?.info.tag.clone()))
        });
        if let Some(tag) = tag {
            router.go(&Route::to(Screen::device(&tag)));
        }
    });
    on_action(move |action| {
        let key = match action {
            Action::Next => "j",
            Action::Previous => "k",
            _ => return,
        };
        let count = order.with_untracked(Vec::len);
        cursor.update(|at| *at = moved(key, *at, count, 1).or(*at));
    });
    let count = Signal::derive(move || order.with(Vec::len));
    let network = memo(move || live.plant.with(Plant::network));
    let none = move || live.conn.get().is_up() && count.get() == 0;
    view! {
        <div class="page" data-testid="page-devices">
            <header>
                <h1>"Devices"</h1>
                <span class="quiet">"worst first"</span>
                <a
                    href=move || network.with(|n| n.as_ref().map(|n| format!("#/network/{n}")))
                    data-testid="network-of-devices"
                    hidden=move || network.with(Option::is_none)
                >
                    "DDC-100 network"
                </a>
            </header>
            <ConnNotice/>
            <p class="empty" hidden=move || !none()>
                "No devices are configured. Add them to the configuration of the bridge, or start it with the simulated plant."
            </p>
            <div class="device-row device-head" aria-hidden="true">
                <span></span>
                <span>"Tag"</span>
                <span class="num">"Position"</span>
                <span></span>
                <span>"State"</span>
                <span>"Alarms and warnings"</span>
                <span>"Model"</span>
                <span>"Bus"</span>
                <span class="num">"Age"</span>
            </div>
            <Windowed
                label="Devices"
                count=count
                row_height=Signal::derive(move || if narrow.get() { 84 } else { 48 })
                cursor=cursor
                draw=draw
                on_open=open
                testid="device-list"
            />
        </div>
    }
}
