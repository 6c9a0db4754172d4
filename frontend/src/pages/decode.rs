//! What do these bytes say?

use leptos::prelude::*;

use crate::components::decode_panes::DecodePanes;
use crate::components::input::DecodeInput;
use crate::components::program::{HART, Program};
use crate::decode_store::DecodeStore;
use crate::erased::{effect, memo};
use crate::router::Router;
use crate::state::samples::by_key;

/// Bytes to meaning, without a network.
#[component]
pub fn DecodePage() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let router = Router::get();

    // A link may name a sample, and the address names the open one.
    let wanted = router.peek().get("sample").and_then(by_key);
    if let Some(sample) = wanted
        && store.sample.get_untracked() != Some(sample.key)
    {
        store.open_sample(sample);
    }
    // What the program of HART shows without an input.
    if router.peek().get("view").is_some() && store.hosted.with_untracked(Option::is_none) {
        store.choose_framing("hart");
    }
    effect(move || router.set("sample", store.sample.get().unwrap_or_default()));

    let hosted = memo(move || store.hosted.with(Option::is_some));
    let body = move || {
        if hosted.get() {
            view! { <Program name=HART device=None/> }.into_any()
        } else {
            view! { <DecodePanes/> }.into_any()
        }
    };
    view! {
        <div class="page decode" data-testid="page-decode">
            <h1 class="hidden-title">"Decode"</h1>
            <DecodeInput/>
            {body}
        </div>
    }
}
