//! DDC-100 networks, and what can be worked out about one without a bridge.

use leptos::prelude::*;

use crate::components::program::{NETWORK, Program};

/// The networks.
#[component]
pub fn NetworkPage() -> impl IntoView {
    view! {
        <div class="page" data-testid="page-network">
            <Program name=NETWORK device=None/>
        </div>
    }
}
