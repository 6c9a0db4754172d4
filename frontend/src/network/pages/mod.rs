//! The program's screens.

mod network;

use std::sync::Arc;

use leptos::prelude::*;

use super::markup::head;
use super::store::Store;
use crate::components::drawn::{Draw, Drawn};
use crate::erased::memo;
use crate::markup::Markup;

/// The program: a network, what is worked out by hand, or a unit.
#[component]
pub fn Network() -> impl IntoView {
    let store = Store::provide();
    let heads: Draw = Arc::new(move |html: &mut Markup| {
        let bus = store.bus.get();
        let mut others: Vec<String> = Vec::new();
        store.devices.with(|devices| {
            for device in devices {
                if !others.contains(&device.bus) {
                    others.push(device.bus.clone());
                }
            }
        });
        let others: Vec<&str> = others.iter().map(String::as_str).collect();
        store.net.with(|net| head::head(html, &bus, net, &others));
    });
    let tabs: Draw = Arc::new(move |html: &mut Markup| {
        head::tabs(html, &store.bus.get(), &store.tab.get());
    });
    let notes: Draw = Arc::new(move |html: &mut Markup| {
        let (bus, online) = (store.bus.get(), store.online.get());
        store.net.with(|net| head::missing(html, &bus, net, online));
    });
    let has = memo(move || store.net.with(|net| net.shape.is_some()));
    let body = part(move || match has.get() {
        true => view! { <network::NetworkView/> }.into_any(),
        false => ().into_any(),
    });
    view! {
        <div class="net">
            <Drawn class="net-head" draw=heads/>
            <Drawn class="tabs" role="tablist" label="Network" draw=tabs/>
            <Drawn class="net-notes" draw=notes/>
            {body}
        </div>
    }
}

/// A part of a view that changes, behind a box: Leptos would compile the machinery around each such
/// closure anew.
fn part(make: impl Fn() -> AnyView + Send + 'static) -> AnyView {
    let make: Box<dyn Fn() -> AnyView + Send> = Box::new(make);
    make.into_any()
}

/// Saves text as a file named after what it is of.
fn save(what: &str, extension: &str, text: &str) {
    let safe = |c: char| {
        if c.is_ascii_alphanumeric() || c == '-' {
            c
        } else {
            '-'
        }
    };
    let what: String = what.chars().map(safe).collect();
    crate::browser::save(&format!("valvescope-{what}.{extension}"), text);
}
