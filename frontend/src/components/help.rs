//! The list of keys.

use std::sync::Arc;

use leptos::html::Button;
use leptos::prelude::*;

use crate::components::drawn::Drawn;
use crate::components::icon::{Glyph, Icon};
use crate::erased::effect;
use crate::keys::on_action;
use crate::markup::about;
use crate::state::shortcuts::Action;

/// The keys in a window of their own, opened by `?` and closed by Escape.
#[component]
pub fn HelpOverlay() -> impl IntoView {
    let (open, set_open) = signal(false);
    let close = NodeRef::<Button>::new();
    on_action(move |action| match action {
        Action::Help => set_open.update(|o| *o = !*o),
        Action::Close => set_open.set(false),
        _ => {}
    });
    effect(move || {
        if open.get()
            && let Some(button) = close.get()
        {
            // Fails only without a window.
            let _infallible = button.focus();
        }
    });
    view! {
        <Show when=move || open.get()>
            <div class="overlay" on:click=move |_| set_open.set(false)>
                <div
                    class="dialog"
                    role="dialog"
                    aria-modal="true"
                    aria-label="Keys"
                    data-testid="help"
                    on:click=|event| event.stop_propagation()
                >
                    <header>
                        <h2>"Keys"</h2>
                        <button
                            class="icon-button"
                            aria-label="Close"
                            node_ref=close
                            on:click=move |_| set_open.set(false)
                        >
                            <Icon glyph=Glyph::Close size=20/>
                        </button>
                    </header>
                    <Drawn class="" draw=Arc::new(about::keys)/>
                </div>
            </div>
        </Show>
    }
}
