//! A HART line: who is on it, and its frames.

use std::sync::Arc;

use leptos::prelude::*;

use super::traffic::TrafficPage;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::hart::markup::bus;
use crate::hart::store::Store;
use crate::markup::Markup;

/// The line: its state, a search, its frames.
#[component]
pub(super) fn BusPage() -> impl IntoView {
    let store = Store::get();
    let tag = RwSignal::new(String::new());
    let link: Draw = Arc::new(move |html: &mut Markup| {
        store.link.with(|link| bus::link(html, link.as_ref()));
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let (job, online) = (store.search.get(), store.online.get());
        tag.with(|tag| bus::search(html, &job, online, tag));
    });
    let found: Draw = Arc::new(move |html: &mut Markup| {
        let name = store.bus.get();
        store.found.with(|all| {
            store
                .plant
                .with(|plant| bus::found(html, all, plant, &name));
        });
    });
    let on_act = Callback::new(move |act: Act| {
        let wanted = || tag.get_untracked().trim().to_owned();
        match act.name.as_str() {
            "scan" => store.scan(),
            "tag" => tag.set(act.value),
            "find" => store.find(wanted().to_ascii_uppercase(), false),
            "find-long" => store.find(wanted(), true),
            _ => store.cancel(store.search),
        }
    });
    view! {
        <div class="hart-bus" data-testid="hart-bus">
            <Drawn class="hart-line" role="status" draw=link/>
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="hart-devices" draw=found/>
            <TrafficPage only=false/>
        </div>
    }
}
