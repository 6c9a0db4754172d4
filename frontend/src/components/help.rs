//! The list of keys.

use std::sync::Arc;

use leptos::prelude::*;

use crate::browser::focus;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::erased::effect;
use crate::keys::on_action;
use crate::markup::{Markup, about};
use crate::state::shortcuts::Action;

/// The keys in a window of their own, opened by `?` and closed by Escape.
#[component]
pub fn HelpOverlay() -> impl IntoView {
    let open = RwSignal::new(false);
    on_action(move |action| match action {
        Action::Help => open.update(|o| *o = !*o),
        Action::Close => open.set(false),
        _ => {}
    });
    effect(move || {
        if open.get() {
            request_animation_frame(|| focus("[data-act=close-help]"));
        }
    });
    let draw: Draw = Arc::new(move |html: &mut Markup| {
        if open.get() {
            about::help(html);
        }
    });
    let close = Callback::new(move |_: Act| open.set(false));
    view! { <Drawn class="help" draw=draw on_act=close/> }
}
