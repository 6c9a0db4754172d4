//! The way to the screens, and the state of the connection.

use leptos::prelude::*;

use crate::components::icon::{Glyph, Icon};
use crate::router::Router;
use crate::state::route::{Route, Screen};

/// The rail at the left; a bar at the bottom of narrow windows.
#[component]
pub fn Rail(
    /// What stands at its foot.
    children: Children,
) -> impl IntoView {
    let screen = Router::get().screen();
    let is_device = move || matches!(screen.get(), Screen::Devices | Screen::Device(..));
    view! {
        <nav class="rail" aria-label="Screens">
            <RailLink
                to=Screen::Decode
                label="Decode"
                testid="nav-decode"
                glyph=Glyph::Decode
                here=Signal::derive(move || screen.get() == Screen::Decode)
            />
            <RailLink
                to=Screen::Devices
                label="Devices"
                testid="nav-devices"
                glyph=Glyph::Devices
                here=Signal::derive(is_device)
            />
            <RailLink
                to=Screen::Traffic(None)
                label="Traffic"
                testid="nav-traffic"
                glyph=Glyph::Traffic
                here=Signal::derive(move || matches!(screen.get(), Screen::Traffic(_)))
            />
            <RailLink
                to=Screen::Settings
                label="Settings"
                testid="nav-settings"
                glyph=Glyph::Settings
                here=Signal::derive(move || screen.get() == Screen::Settings)
            />
            <div class="rail-foot">{children()}</div>
        </nav>
    }
}

#[component]
fn RailLink(
    /// Where it leads.
    to: Screen,
    /// Its word.
    label: &'static str,
    /// Its `data-testid`.
    testid: &'static str,
    /// Its icon.
    glyph: Glyph,
    /// True while its screen is shown.
    here: Signal<bool>,
) -> impl IntoView {
    view! {
        <a
            class="rail-link"
            href=Route::to(to).to_string()
            data-testid=testid
            aria-current=move || here.get().then_some("page")
        >
            <Icon glyph=glyph size=20/>
            <span>{label}</span>
        </a>
    }
}
