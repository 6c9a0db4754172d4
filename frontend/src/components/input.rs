//! What is to be decoded: paste, type, drop, open, or try a sample.

use std::sync::Arc;

use leptos::ev;
use leptos::html::Input;
use leptos::prelude::*;
use shared::device::Device;
use wasm_bindgen::JsCast;

use crate::browser::value_of;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::{Glyph, Icon};
use crate::decode_store::DecodeStore;
use crate::markup::Markup;
use crate::markup::decode::{self, Choices};
use crate::state::samples::by_key;

/// Longest text that is put into the field; longer ones are decoded all the same.
const SHOWN: usize = 20_000;

/// The input: a text field, a file, samples; framing and device; what was found.
#[component]
pub fn DecodeInput() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let file = NodeRef::<Input>::new();
    let over = RwSignal::new(false);

    // Paste works anywhere on the page.
    let handle = window_event_listener(ev::paste, move |event| {
        let in_field = event
            .target()
            .and_then(|t| t.dyn_into::<web_sys::Element>().ok())
            .is_some_and(|t| t.tag_name() == "INPUT");
        let Some(data) = event.clipboard_data().filter(|_| !in_field) else {
            return;
        };
        let dropped = data.files().and_then(|f| f.get(0));
        if let Some(file) = dropped {
            event.prevent_default();
            store.open_file(file);
        } else if let Ok(text) = data.get_data("text/plain")
            && !text.is_empty()
        {
            event.prevent_default();
            paste(store, &text);
        }
    });
    on_cleanup(move || handle.remove());
    let handles = [
        window_event_listener(ev::dragover, move |event| {
            event.prevent_default();
            over.set(true);
        }),
        window_event_listener(ev::dragleave, move |event| {
            if event.related_target().is_none() {
                over.set(false);
            }
        }),
        window_event_listener(ev::drop, move |event| {
            event.prevent_default();
            over.set(false);
            let Some(data) = event.data_transfer() else {
                return;
            };
            if let Some(file) = data.files().and_then(|f| f.get(0)) {
                store.open_file(file);
            } else if let Ok(text) = data.get_data("text/plain") {
                paste(store, &text);
            }
        }),
    ];
    on_cleanup(move || handles.into_iter().for_each(WindowListenerHandle::remove));

    let on_input = move |event: web_sys::Event| {
        let text = value_of(&event);
        store.text.set(text.clone());
        if text.trim().is_empty() {
            store.clear();
        } else {
            store.open_text(&text);
        }
    };
    let on_file = move |_| {
        let chosen = file.get_untracked().and_then(|f| {
            let first = f.files().and_then(|list| list.get(0));
            // So that the same file can be opened again.
            f.set_value("");
            first
        });
        if let Some(chosen) = chosen {
            store.open_file(chosen);
        }
    };
    let tools: Draw = Arc::new(move |html: &mut Markup| draw_choices(store, html));
    let on_act = Callback::new(move |act: Act| match act.name.as_str() {
        "framing" => store.choose_framing(&act.value),
        "device" => store.choose_device(Device::from_key(&act.value)),
        "sample" => {
            if let Some(sample) = by_key(&act.value) {
                store.open_sample(sample);
            }
        }
        "cancel" => store.cancel(),
        _ => store.clear(),
    });
    view! {
        <section class="input" class:collapsed=store.collapsed class:over=over aria-label="Input">
            <div class="input-row">
                <textarea
                    data-testid="paste"
                    data-find
                    class="mono"
                    spellcheck="false"
                    autocomplete="off"
                    aria-label="Bytes in hexadecimal, in any usual writing"
                    placeholder="Paste bytes here: hex in any usual writing, a log, a C array, Modbus ASCII lines. Or drop a file."
                    prop:value=store.text
                    on:input=on_input
                ></textarea>
                <label class="button" data-testid="open-file">
                    <Icon glyph=Glyph::File/>
                    "Open file"
                    <input
                        type="file"
                        class="hidden-input"
                        data-testid="file"
                        node_ref=file
                        on:change=on_file
                    />
                </label>
            </div>
            <Drawn class="input-row choices" draw=tools on_act=on_act/>
        </section>
    }
}

fn paste(store: DecodeStore, text: &str) {
    store.text.set(if text.len() <= SHOWN {
        text.to_owned()
    } else {
        String::new()
    });
    store.collapsed.set(true);
    store.open_text(text);
}

/// Framing, device, what was found, samples.
fn draw_choices(store: DecodeStore, html: &mut Markup) {
    let (framing, device) = (store.framing.get(), store.device.get());
    store.work.with(|work| {
        let now = Choices {
            framing,
            device,
            sample: store.sample.get(),
            hosted: store.hosted.get(),
            work: work.as_ref(),
            progress: store.progress.get(),
        };
        decode::choices(html, &now);
    });
}
