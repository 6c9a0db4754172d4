//! What was found on a network lately.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;

use super::save;
use crate::browser::{copy, offset_minutes};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::format::clock_seconds;
use crate::markup::Markup;
use crate::network::markup::log;
use crate::network::state::names::named;
use crate::network::store::Store;

/// The list.
#[component]
pub(super) fn LogPage() -> impl IntoView {
    let store = Store::get();
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        store.net.with(|net| log::tools(html, &net.log));
    });
    let events: Draw = Arc::new(move |html: &mut Markup| {
        let name = store.names();
        let time = |ms| clock_seconds(ms, offset_minutes(ms));
        store
            .net
            .with(|net| log::events(html, &net.log, &time, &*name));
    });
    let on_act = Callback::new(move |act: Act| {
        let comma = if act.name == "copy" { '\t' } else { ',' };
        let name = store.names();
        let text = store.net.with_untracked(|net| {
            let named = |text: &str| named(text, &*name);
            net.log.as_text(&iso, &named, comma)
        });
        if act.name == "copy" {
            spawn_local(async move {
                // Without a clipboard the file is left.
                let _copied = copy(text).await;
            });
        } else {
            save(
                &format!("lately-{}", store.bus.get_untracked()),
                "csv",
                &text,
            );
        }
    });
    view! {
        <div class="net-page" data-testid="lately">
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="net-log-list" draw=events/>
        </div>
    }
}

/// A moment with its date, UTC.
fn iso(ms: u64) -> String {
    #[expect(
        clippy::cast_precision_loss,
        reason = "milliseconds since 1970 are far below 2^52"
    )]
    let date = js_sys::Date::new(&wasm_bindgen::JsValue::from_f64(ms as f64));
    date.to_iso_string().into()
}
