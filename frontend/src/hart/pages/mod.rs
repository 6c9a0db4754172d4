//! The program's screens.

mod bus;
mod decode;
mod device;
mod map;
mod traffic;
mod trend;

use std::sync::Arc;

use leptos::prelude::*;

use super::markup::overview;
use super::state::plan::{TABS, tab};
use super::store::Store;
use crate::components::drawn::{Draw, Drawn};
use crate::erased::memo;
use crate::guest::Guest;
use crate::keys::KeyBus;
use crate::markup::Markup;

/// Which part of the program is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Decode,
    Bus,
    Device,
}

/// The program: pasted frames, a device on the line, or a line.
#[component]
pub fn Hart() -> impl IntoView {
    KeyBus::provide();
    let place = Guest::get().place;
    let shown = memo(move || {
        place.with(|p| match p.tab.as_str() {
            _ if p.device.is_some() => Part::Device,
            "bus" => Part::Bus,
            _ => Part::Decode,
        })
    });
    part(move || match shown.get() {
        Part::Decode => view! { <div class="hart"><decode::DecodePage/></div> }.into_any(),
        Part::Bus => {
            Store::provide();
            view! { <div class="hart"><bus::BusPage/></div> }.into_any()
        }
        Part::Device => {
            Store::provide();
            view! { <div class="hart"><Device/></div> }.into_any()
        }
    })
}

#[component]
fn Device() -> impl IntoView {
    let store = Store::get();
    let open = memo(move || store.tab.with(|word| tab(word)));
    let tabs: Draw = Arc::new(move |html: &mut Markup| {
        let base = format!("#/device/{}", store.tag.with(|t| crate::format::encode(t)));
        let open = open.get();
        for (key, label) in TABS {
            html.open(
                "a",
                &[
                    ("class", "tab"),
                    ("role", "tab"),
                    ("href", &format!("{base}/{key}")),
                    ("data-testid", "hart-tab"),
                    ("data-tab", key),
                    ("aria-selected", if key == open { "true" } else { "false" }),
                ],
            );
            html.text(label).close("a");
        }
    });
    let body = part(move || match open.get() {
        "setup" => view! { <device::SetupPage/> }.into_any(),
        "variables" => view! { <device::VariablesPage/> }.into_any(),
        "status" => view! { <device::StatusPage/> }.into_any(),
        "map" => view! { <map::DeviceMapPage/> }.into_any(),
        "traffic" => view! { <traffic::TrafficPage only=true/> }.into_any(),
        _ => view! { <device::OverviewPage/> }.into_any(),
    });
    // Whatever is shown of a device, nobody may overlook that it does not follow its loop.
    let forced: Draw = Arc::new(move |html: &mut Markup| {
        store.unit.with(|unit| overview::forced(html, unit));
    });
    view! {
        <Drawn class="hart-forced-all" role="status" draw=forced/>
        <Drawn class="tabs" role="tablist" label="HART device" draw=tabs/>
        {body}
    }
}

/// A part of a view that changes, behind a box: Leptos would compile the machinery around each such
/// closure anew.
fn part(make: impl Fn() -> AnyView + Send + 'static) -> AnyView {
    let make: Box<dyn Fn() -> AnyView + Send> = Box::new(make);
    make.into_any()
}
