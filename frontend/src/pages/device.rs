//! One device: what its valve does, all its values, its frames.

use std::sync::Arc;

use leptos::prelude::*;
use shared::device::Device;
use shared::map::row::DeviceMap;

use crate::components::conn::ConnNotice;
use crate::components::drawn::{Draw, Drawn};
use crate::components::program::{ACTUATOR, DIAGNOSTICS, HART, NETWORK, Program};
use crate::components::traffic::TrafficView;
use crate::components::values::ValuesView;
use crate::erased::{effect, memo};
use crate::live::Live;
use crate::markup::{Markup, device, valve};
use crate::router::Router;
use crate::state::overview::{Overview, read_once};
use crate::state::plant::DeviceState;
use crate::state::route::{Screen, Tab};

/// Draws a part from a device, its overview, the time, and whether there is a connection.
type DrawDevice = fn(&mut Markup, &DeviceState, &Overview, u64, bool);

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
    let kind = memo(move || {
        live.plant
            .with(|p| tag.with_value(|t| p.device(t).map(|d| d.device)))
    });
    // The program that draws all of its page.
    let own = memo(move || {
        let own = |d: &DeviceState| {
            if d.is_dop() {
                return Some(DIAGNOSTICS);
            }
            d.is_hart().then_some(HART)
        };
        live.plant
            .with(|p| tag.with_value(|t| p.device(t).and_then(own)))
    });
    effect(move || {
        if let (true, Some(kind)) = (live.conn.get().is_up(), kind.get()) {
            live.read(&tag.get_value(), read_once(kind));
        }
    });
    let draw = move |make: DrawDevice| -> Draw {
        Arc::new(move |html: &mut Markup| {
            let (now, up) = (live.now.get(), live.conn.get().is_up());
            live.plant.with(|p| {
                if let Some(d) = tag.with_value(|t| p.device(t)) {
                    make(html, d, &d.overview(), now, up);
                }
            });
        })
    };
    let tabs: Draw = Arc::new(move |html: &mut Markup| {
        if kind.with(Option::is_none) {
            html.node("p", "empty", "There is no such device here.");
        }
        // Programs draw their own tabs.
        if own.get().is_none() {
            let deep = kind.get().is_some_and(Device::is_icon);
            tag.with_value(|t| device::tabs(html, t, tab.get(), deep));
        }
    });
    // A program follows the tabs by itself, so that all of its tabs are one here.
    let shown = memo(move || match tab.get() {
        deep if deep.is_deep() && kind.get().is_some_and(Device::is_icon) => Tab::Curves,
        deep if deep.is_deep() => Tab::Overview,
        tab => tab,
    });
    let body = move || {
        // Its program follows the tabs by itself.
        if let Some(name) = own.get() {
            return program(name, tag.get_value());
        }
        match (kind.get(), shown.get()) {
        (Some(kind), Tab::Overview) if kind.key().starts_with("ddc100") => {
            program(NETWORK, tag.get_value())
        }
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
        (Some(_), Tab::Curves) => program(ACTUATOR, tag.get_value()),
        (Some(_), _) => view! {
            <div class="overview" data-testid="overview">
                <Drawn class="overview-valve" draw=draw(|html, _, o, _, _| valve::valve(html, o))/>
                <Drawn class="overview-figures" draw=draw(|html, d, o, _, up| device::figures(html, o, device::is_stale(d, up)))/>
                <Drawn
                    class="overview-conditions"
                    draw=draw(|html, _, o, _, _| device::conditions(html, o))
                />
            </div>
        }
        .into_any(),
    }
    };
    view! {
        <div class="page" data-testid="page-device">
            <ConnNotice/>
            <Drawn class="device-header" draw=draw(device::header) testid="device-header"/>
            <Drawn class="tabs" role="tablist" label="Device" draw=tabs/>
            {body}
        </div>
    }
}

fn values(tag: String, map: &'static DeviceMap) -> AnyView {
    view! { <ValuesView tag=tag map=map/> }.into_any()
}

fn program(name: &'static str, tag: String) -> AnyView {
    view! { <Program name=name device=Some(tag)/> }.into_any()
}

/// The page of the device that the address names.
#[component]
pub fn DeviceRoute() -> impl IntoView {
    let screen = Router::get().screen();
    let tag = memo(move || match screen.get() {
        Screen::Device(tag, _) => tag,
        _ => String::new(),
    });
    let tab = Signal::derive(move || match screen.get() {
        Screen::Device(_, tab) => Tab::from_key(&tab),
        _ => Tab::Overview,
    });
    move || view! { <DevicePage tag=tag.get() tab=tab/> }
}
