//! One device: what its valve does, all its values, its frames.

use leptos::prelude::*;
use shared::map::row::DeviceMap;

use crate::components::conn::ConnNotice;
use crate::components::traffic::TrafficView;
use crate::components::values::ValuesView;
use crate::live::Live;
use crate::markup::device;
use crate::router::Router;
use crate::state::overview::{Overview, read_once};
use crate::state::plant::DeviceState;
use crate::state::route::{Route, Screen, Tab};

/// A device, by its tag.
#[component]
pub fn DevicePage(
    /// Its tag.
    tag: String,
    /// The tab that is open.
    tab: Signal<Tab>,
) -> impl IntoView {
    let live = Live::get();
    let tag = StoredValue::new(tag);
    // What seldom changes is read once, when the connection is there.
    let kind = Memo::new(move |_| {
        live.plant
            .with(|p| tag.with_value(|t| p.device(t).map(|d| d.device)))
    });
    Effect::new(move |_| {
        if let (true, Some(kind)) = (live.conn.get().is_up(), kind.get()) {
            live.read(&tag.get_value(), read_once(kind));
        }
    });
    let draw = move |make: fn(&DeviceState, &Overview, u64, bool) -> String| {
        let (now, up) = (live.now.get(), live.conn.get().is_up());
        live.plant.with(|p| {
            tag.with_value(|t| p.device(t))
                .map_or_else(String::new, |d| {
                    make(d, &Overview::of(d.device, &d.image), now, up)
                })
        })
    };
    let missing = move || {
        kind.with(Option::is_none)
            .then(|| format!("There is no device {} here.", tag.get_value()))
    };
    let tabs = Tab::ALL
        .map(|t| {
            view! {
                <a
                    role="tab"
                    class="tab"
                    href=Route::to(Screen::Device(tag.get_value(), t)).to_string()
                    data-testid=format!("tab-{}", t.key())
                    aria-selected=move || (tab.get() == t).to_string()
                >
                    {t.label()}
                </a>
            }
            .into_any()
        })
        .into_iter()
        .collect::<Vec<_>>();
    let body = move || match (kind.get(), tab.get()) {
        (None, _) => ().into_any(),
        (Some(kind), Tab::Values) => match kind.map() {
            Some(map) => values(tag.get_value(), map),
            None => {
                view! { <p class="empty">"No map describes this kind of device."</p> }.into_any()
            }
        },
        (Some(_), Tab::Traffic) => {
            let place = live.plant.with_untracked(|p| {
                tag.with_value(|t| p.device(t).map(|d| (d.info.bus.clone(), d.info.unit)))
            });
            place
                .map(|(bus, unit)| view! { <TrafficView bus=bus only=Some(unit)/> })
                .into_any()
        }
        (Some(_), Tab::Overview) => view! {
            <div class="overview" data-testid="overview">
                <section
                    class="overview-valve"
                    aria-label="Valve"
                    inner_html=move || draw(|_, o, _, _| device::valve(o))
                ></section>
                <section
                    class="overview-figures"
                    aria-label="Figures"
                    inner_html=move || draw(|_, o, _, _| device::figures(o))
                ></section>
                <section
                    class="overview-conditions"
                    aria-label="Conditions"
                    inner_html=move || draw(|_, o, _, _| device::conditions(o))
                ></section>
            </div>
        }
        .into_any(),
    };
    view! {
        <div class="page" data-testid="page-device">
            <ConnNotice/>
            <p class="empty" hidden=move || missing().is_none()>
                {missing}
            </p>
            <div
                class="device-header"
                data-testid="device-header"
                inner_html=move || draw(device::header)
            ></div>
            <div class="tabs" role="tablist" aria-label="Device">
                {tabs}
            </div>
            {body}
        </div>
    }
}

fn values(tag: String, map: &'static DeviceMap) -> AnyView {
    view! { <ValuesView tag=tag map=map/> }.into_any()
}

/// The page of the device that the address names.
#[component]
pub fn DeviceRoute() -> impl IntoView {
    let screen = Router::get().screen();
    let tag = Memo::new(move |_| match screen.get() {
        Screen::Device(tag, _) => tag,
        _ => String::new(),
    });
    let tab = Signal::derive(move || match screen.get() {
        Screen::Device(_, tab) => tab,
        _ => Tab::Overview,
    });
    move || view! { <DevicePage tag=tag.get() tab=tab/> }
}
