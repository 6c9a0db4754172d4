//! The program's screens.

mod log;
mod network;
mod scan;
mod tags;
mod typed;
mod unit;

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
    let is_unit = memo(move || !store.tag.with(String::is_empty));
    let heads: Draw = Arc::new(move |html: &mut Markup| {
        // The page of a device has its own head and tabs.
        if is_unit.get() {
            return;
        }
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
        if is_unit.get() {
            return;
        }
        head::tabs(html, &store.bus.get(), &store.tab.get());
    });
    let notes: Draw = Arc::new(move |html: &mut Markup| {
        let (bus, online) = (store.bus.get(), store.online.get());
        store.net.with(|net| head::missing(html, &bus, net, online));
    });
    let has = memo(move || store.net.with(|net| net.shape.is_some()));
    let screen = memo(move || {
        let bus = store.bus.with(|bus| !bus.is_empty());
        Screen::of(&store.tag.get(), bus, &store.tab.get(), has.get())
    });
    let body = part(move || match screen.get() {
        Screen::Unit => view! { <unit::UnitPage/> }.into_any(),
        Screen::Network => view! { <network::NetworkView/> }.into_any(),
        Screen::Log => view! { <log::LogPage/> }.into_any(),
        Screen::Tags => view! { <tags::TagsPage/> }.into_any(),
        Screen::Faults => view! { <typed::FaultTablePage/> }.into_any(),
        Screen::Scan => view! { <scan::ScanPage/> }.into_any(),
        Screen::Nothing => ().into_any(),
    });
    view! {
        <div class="net">
            <Drawn class="net-head" draw=heads/>
            <Drawn class="tabs net-tabs" role="tablist" label="Network" draw=tabs/>
            <Drawn class="net-notes" draw=notes/>
            {body}
        </div>
    }
}

/// What is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Screen {
    Unit,
    Network,
    Log,
    Tags,
    Faults,
    Scan,
    /// What the backend tells is waited for.
    Nothing,
}

impl Screen {
    /// What an address leads to. `has` is true once the network is known.
    fn of(tag: &str, bus: bool, tab: &str, has: bool) -> Self {
        match (tag.is_empty(), bus, tab) {
            (true, false, "scan") => Self::Scan,
            (true, false, _) => Self::Faults,
            _ if !has => Self::Nothing,
            (false, ..) => Self::Unit,
            (_, _, "log") => Self::Log,
            (_, _, "tags") => Self::Tags,
            (_, _, "faults") => Self::Faults,
            (_, _, "scan") => Self::Scan,
            _ => Self::Network,
        }
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

#[cfg(test)]
mod tests {
    use super::Screen;

    #[test]
    fn addresses_lead_to_screens() {
        assert_eq!(Screen::of("", false, "", false), Screen::Faults);
        assert_eq!(Screen::of("", false, "scan", false), Screen::Scan);
        assert_eq!(Screen::of("", true, "scan", false), Screen::Nothing);
        assert_eq!(Screen::of("", true, "", true), Screen::Network);
        assert_eq!(Screen::of("", true, "log", true), Screen::Log);
        assert_eq!(Screen::of("", true, "tags", true), Screen::Tags);
        assert_eq!(Screen::of("MOV-1", true, "", true), Screen::Unit);
        assert_eq!(Screen::of("MOV-1", false, "", false), Screen::Nothing);
    }
}
