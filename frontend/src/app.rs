//! The shell: what every screen shares.

use leptos::prelude::*;

use crate::browser::provide_narrow;
use crate::components::conn::ConnState;
use crate::components::help::HelpOverlay;
use crate::components::rail::Rail;
use crate::decode_store::DecodeStore;
use crate::erased::memo;
use crate::keys::{KeyBus, on_action};
use crate::live::Live;
use crate::pages::decode::DecodePage;
use crate::pages::device::DeviceRoute;
use crate::pages::devices::DevicesPage;
use crate::pages::dop::{DopPage, SnapshotsPage};
use crate::pages::network::NetworkPage;
use crate::pages::settings::SettingsPage;
use crate::pages::traffic::TrafficPage;
use crate::router::Router;
use crate::state::route::{Route, Screen};
use crate::state::shortcuts::Action;
use crate::theme::provide_theme;

/// What is drawn anew when it changes; a tab or a setting is not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Page {
    Decode,
    Devices,
    Device,
    Dop,
    Snapshots,
    Network,
    Traffic,
    Settings,
}

/// The whole page.
#[component]
pub fn App() -> impl IntoView {
    let router = Router::provide();
    KeyBus::provide();
    provide_theme();
    provide_narrow();
    DecodeStore::provide();
    on_action(move |action| {
        let screen = match action {
            Action::Decode => Screen::Decode,
            Action::Dop => Screen::Dop(String::new()),
            Action::Devices => Screen::Devices,
            Action::Traffic => Screen::Traffic(None),
            Action::Snapshots => Screen::Snapshots(String::new()),
            Action::Settings => Screen::Settings,
            _ => return,
        };
        router.go(&Route::to(screen));
    });
    Live::provide();
    let page = memo(move || match router.route().screen {
        Screen::Decode => Page::Decode,
        Screen::Devices => Page::Devices,
        Screen::Device(..) => Page::Device,
        Screen::Dop(_) => Page::Dop,
        Screen::Snapshots(_) => Page::Snapshots,
        Screen::Network(_) => Page::Network,
        Screen::Traffic(_) => Page::Traffic,
        Screen::Settings => Page::Settings,
    });
    view! {
        <a class="skip" href="#main" on:click=move |event| {
            event.prevent_default();
            crate::browser::focus("main");
        }>
            "To the content"
        </a>
        <Rail>
            <ConnState/>
        </Rail>
        <main id="main" tabindex="-1">
            {move || match page.get() {
                Page::Decode => view! { <DecodePage/> }.into_any(),
                Page::Devices => view! { <DevicesPage/> }.into_any(),
                Page::Device => view! { <DeviceRoute/> }.into_any(),
                Page::Dop => view! { <DopPage/> }.into_any(),
                Page::Snapshots => view! { <SnapshotsPage/> }.into_any(),
                Page::Network => view! { <NetworkPage/> }.into_any(),
                Page::Traffic => view! { <TrafficPage/> }.into_any(),
                Page::Settings => view! { <SettingsPage/> }.into_any(),
            }}
        </main>
        <HelpOverlay/>
    }
}
