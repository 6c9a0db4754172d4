//! Screens of programs without a device: pasted registers, saved devices.

use leptos::prelude::*;

use crate::components::program::{ACTUATOR, DIAGNOSTICS, Program};

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

/// Saved devices.
#[component]
pub fn SnapshotsPage() -> impl IntoView {
    view! {
        <div class="page" data-testid="page-snapshots">
            <Program name=ACTUATOR device=None/>
        </div>
    }
}
