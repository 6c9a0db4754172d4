//! The way to the screens, and the state of the connection.

use std::sync::Arc;

use leptos::prelude::*;

use crate::components::drawn::{Draw, Drawn};
use crate::components::icon::Glyph;
use crate::erased::memo;
use crate::live::Live;
use crate::markup::Markup;
use crate::router::Router;
use crate::state::plant::Plant;
use crate::state::route::{Route, Screen};

/// The rail at the left; a bar at the bottom of narrow windows.
#[component]
pub fn Rail(
    /// What stands at its foot.
    children: Children,
) -> impl IntoView {
    let screen = Router::get().screen();
    let live = Live::get();
    let network = memo(move || live.plant.with(Plant::network));
    let draw: Draw =
        Arc::new(move |html: &mut Markup| links(html, &screen.get(), network.get().as_deref()));
    view! {
        <nav class="rail" aria-label="Screens">
            <Drawn class="rail-links" draw=draw/>
            <div class="rail-foot">{children()}</div>
        </nav>
    }
}

/// The links, the one to the present screen marked. `network` is the address of a DDC-100 network,
/// if there is one.
fn links(html: &mut Markup, now: &Screen, network: Option<&str>) {
    let is_decode = matches!(now, Screen::Decode | Screen::Dop(_));
    let is_device = matches!(now, Screen::Devices | Screen::Device(..));
    let is_traffic = matches!(now, Screen::Traffic(_));
    let is_network = matches!(now, Screen::Network(_));
    let mut links = vec![
        (
            Screen::Decode,
            "Decode",
            "nav-decode",
            Glyph::Decode,
            is_decode,
        ),
        (
            Screen::Devices,
            "Devices",
            "nav-devices",
            Glyph::Devices,
            is_device,
        ),
        (
            Screen::Traffic(None),
            "Traffic",
            "nav-traffic",
            Glyph::Traffic,
            is_traffic,
        ),
        (
            Screen::Snapshots(String::new()),
            "Snapshots",
            "nav-snapshots",
            Glyph::File,
            matches!(now, Screen::Snapshots(_)),
        ),
        (
            Screen::Settings,
            "Settings",
            "nav-settings",
            Glyph::Settings,
            *now == Screen::Settings,
        ),
    ];
    if let Some(rest) = network {
        let to = Screen::Network(rest.to_owned());
        links.insert(2, (to, "Network", "nav-network", Glyph::Poll, is_network));
    }
    for (to, label, testid, glyph, here) in links {
        let address = Route::to(to).to_string();
        let mut attributes = vec![
            ("class", "rail-link"),
            ("href", address.as_str()),
            ("data-testid", testid),
        ];
        if here {
            attributes.push(("aria-current", "page"));
        }
        html.open("a", &attributes);
        html.large_icon(glyph).node("span", "", label).close("a");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_present_screen_is_marked() {
        let mut html = Markup::new();
        links(
            &mut html,
            &Screen::Device("X".into(), "values".into()),
            None,
        );
        let html = html.finish();
        assert!(!html.contains("nav-network"));
        assert_eq!(html.matches("aria-current").count(), 1);
        assert!(html.contains("data-testid=\"nav-devices\" aria-current"));
        let mut html = Markup::new();
        links(
            &mut html,
            &Screen::Network("Loop%201/tags".into()),
            Some("Loop%201"),
        );
        let html = html.finish();
        assert!(
            html.contains("href=\"#/network/Loop%201\" data-testid=\"nav-network\" aria-current")
        );
    }
}
