//! Diagnostic objects without a device: pasted registers.

use leptos::prelude::*;

use crate::components::program::{DIAGNOSTICS, Program};

/// The offline side of the diagnostic objects.
#[component]
pub fn DopPage() -> impl IntoView {
    view! {
        <div class="page" data-testid="page-dop">
            <header>
                <h1>"Diagnostic objects"</h1>
                <span class="quiet">"Limitorque MX and QX"</span>
            </header>
            <Program name=DIAGNOSTICS device=None/>
        </div>
    }
}
