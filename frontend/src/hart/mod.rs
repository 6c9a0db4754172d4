//! The program of the HART devices.

use leptos::prelude::*;

/// The program.
#[component]
pub fn Hart() -> impl IntoView {
    view! { <p class="empty">"HART"</p> }
}
