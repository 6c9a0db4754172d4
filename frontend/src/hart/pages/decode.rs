//! What do these bytes say? Input, framing and device are chosen in the page around the program.

use std::sync::Arc;

use leptos::prelude::*;
use shared::device::Device;
use shared::frame::Framing;
use shared::problem::Severity;
use wasm_bindgen::{JsCast, JsValue};

use super::map::MapView;
use crate::components::decode_panes::DecodePanes;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::decode_store::{DecodeStore, Input};
use crate::erased::{effect, memo};
use crate::guest::Guest;
use crate::hart::markup;
use crate::hart::state::steps::Steps;
use crate::markup::Markup;
use crate::markup::decode::{found as draw_found, progress_bar};
use crate::state::samples::by_key;

/// The frames of an input that the page handed on.
#[component]
pub(super) fn DecodePage() -> impl IntoView {
    let store = DecodeStore::provide();
    let guest = Guest::get();
    let chosen = |key: &'static str| {
        memo(move || {
            guest
                .place
                .with(|p| p.get(key).unwrap_or_default().to_owned())
        })
    };
    let (framing, device) = (chosen("framing"), chosen("device"));
    effect(move || {
        framing.with(|key| {
            if store.framing.get_untracked() != Framing::from_key(key) {
                store.choose_framing(key);
            }
        });
    });
    effect(move || {
        let device = device.with(|key| Device::from_key(key));
        if store.device.get_untracked() != device {
            store.choose_device(device);
        }
    });
    guest.on_input(move |name, input| open(store, name, input));

    let found: Draw = Arc::new(move |html: &mut Markup| {
        store.work.with(|work| {
            if let Some(work) = work {
                draw_found(html, work);
            }
        });
        if let Some(progress) = store.progress.get() {
            progress_bar(html, &progress);
        }
    });
    let on_act = Callback::new(move |_: Act| store.cancel());
    // What goes on over several frames.
    let followed = memo(move || {
        store.epoch.track();
        store.work.with(|work| {
            work.as_ref()
                .map_or_else(Steps::default, |w| Steps::of(&w.session))
        })
    });
    let steps: Draw = Arc::new(move |html: &mut Markup| {
        followed.with(|steps| markup::steps::steps(html, steps));
    });
    // The condensed status map needs no input.
    let view = RwSignal::new(
        guest
            .place
            .with_untracked(|p| p.get("view").unwrap_or_default().to_owned()),
    );
    let on_step = Callback::new(move |act: Act| {
        let frame = act.element.get_attribute("data-frame");
        if let Some(frame) = frame.and_then(|f| f.parse().ok()) {
            store.cursor.set(Some(frame));
            view.set(String::new());
        }
    });
    let tabs: Draw = Arc::new(move |html: &mut Markup| {
        let now = view.get();
        let (runs, warns) = followed.with(|steps| (steps.runs().len(), steps.warns()));
        let procedures = format!("Procedures ({runs})");
        for (act, words) in [
            ("frames", "Frames"),
            ("procedures", procedures.as_str()),
            ("map", "Condensed status map"),
        ] {
            let on = act == now || (now.is_empty() && act == "frames");
            html.open(
                "button",
                &[
                    ("class", "tab"),
                    ("role", "tab"),
                    ("data-act", act),
                    ("data-testid", "hart-view"),
                    ("data-view", act),
                    ("aria-selected", if on { "true" } else { "false" }),
                ],
            );
            if act == "procedures" && warns {
                html.severity(Severity::Warning);
            }
            html.text(words).close("button");
        }
    });
    let on_tab = Callback::new(move |act: Act| {
        let name = if act.name == "frames" {
            String::new()
        } else {
            act.name
        };
        view.set(name);
    });
    let body = super::part(move || match view.get().as_str() {
        "map" => view! { <div class="hart-page"><MapView unit=None/></div> }.into_any(),
        "procedures" => view! {
            <div class="hart-page" data-testid="hart-procedures">
                <Drawn class="hart-runs" draw=Arc::clone(&steps) on_act=on_step/>
            </div>
        }
        .into_any(),
        _ => view! {
            <Drawn class="hart-found" draw=Arc::clone(&found) on_act=on_act/>
            <DecodePanes/>
        }
        .into_any(),
    });
    view! {
        <Drawn class="tabs" role="tablist" label="HART" draw=tabs on_act=on_tab/>
        {body}
    }
}

/// Opens what the page hands on.
fn open(store: DecodeStore, name: &str, input: &JsValue) {
    if let Some(key) = input.as_string() {
        if let Some(sample) = by_key(&key) {
            store.open_sample(sample);
        }
        return;
    }
    let input = match input.clone().dyn_into::<web_sys::File>() {
        Ok(file) => Input::File(file),
        Err(bytes) => {
            let bytes = bytes.unchecked_into::<js_sys::Uint8Array>().to_vec();
            Input::Bytes(Arc::new(bytes))
        }
    };
    store.open(name.to_owned(), input);
}
