//! The program of the DDC-100 networks.

use leptos::prelude::*;

/// The program.
#[component]
pub fn Network() -> impl IntoView {
    view! { <p class="empty">"DDC-100"</p> }
}
