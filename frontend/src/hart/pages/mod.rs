//! The program's screens.

mod decode;

use leptos::prelude::*;

use crate::keys::KeyBus;

/// The program.
#[component]
pub fn Hart() -> impl IntoView {
    KeyBus::provide();
    view! { <div class="hart"><decode::DecodePage/></div> }
}
