//! The program of the ICON3000 in depth.

use leptos::prelude::*;

/// The program.
#[component]
pub fn Actuator() -> impl IntoView {
    view! { <p class="empty">"ICON3000"</p> }
}
