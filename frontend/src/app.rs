//! The shell: what every screen shares.

use leptos::prelude::*;

use crate::browser::provide_narrow;
use crate::components::help::HelpOverlay;
use crate::components::rail::Rail;
use crate::decode_store::DecodeStore;
use crate::keys::{KeyBus, on_action};
use crate::pages::decode::DecodePage;
use crate::pages::settings::SettingsPage;
use crate::router::Router;
use crate::state::route::{Route, Screen};
use crate::state::shortcuts::Action;
use crate::theme::provide_theme;

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
            Action::Devices => Screen::Devices,
            Action::Traffic => Screen::Traffic(None),
            Action::Settings => Screen::Settings,
            _ => return,
        };
        router.go(&Route::to(screen));
    });
    let screen = router.screen();
    view! {
        <a class="skip" href="#main" on:click=move |event| {
            event.prevent_default();
            crate::browser::focus("main");
        }>
            "To the content"
        </a>
        <Rail>"offline"</Rail>
        <main id="main" tabindex="-1">
            {move || match screen.get() {
                Screen::Settings => view! { <SettingsPage/> }.into_any(),
                _ => view! { <DecodePage/> }.into_any(),
            }}
        </main>
        <HelpOverlay/>
    }
}
