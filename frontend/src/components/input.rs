//! What is to be decoded: paste, type, drop, open, or try a sample.

use leptos::ev;
use leptos::html::Input;
use leptos::prelude::*;
use shared::device::Device;
use shared::frame::Framing;
use wasm_bindgen::JsCast;

use crate::browser::value_of;
use crate::components::icon::{Glyph, Icon};
use crate::decode_store::DecodeStore;
use crate::format::{count, size, thousands};
use crate::state::samples::SAMPLES;
use crate::state::work::form_label;

/// Longest text that is put into the field; longer ones are decoded all the same.
const SHOWN: usize = 20_000;

/// The input: a text field, a file, samples; framing and device; what was found.
#[component]
pub fn DecodeInput() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let file = NodeRef::<Input>::new();
    let (over, set_over) = signal(false);

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
            set_over.set(true);
        }),
        window_event_listener(ev::dragleave, move |event| {
            if event.related_target().is_none() {
                set_over.set(false);
            }
        }),
        window_event_listener(ev::drop, move |event| {
            event.prevent_default();
            set_over.set(false);
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
    let is_open = move || store.work.with(Option::is_some);
    view! {
        <section
            class="input"
            class:collapsed=store.collapsed
            class:over=over
            aria-label="Input"
        >
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
                <div class="actions">
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
                    <Show when=is_open>
                        <button
                            class="button"
                            data-testid="clear"
                            on:click=move |_| store.clear()
                        >
                            <Icon glyph=Glyph::Clear/>
                            "Clear"
                        </button>
                    </Show>
                </div>
            </div>
            <div class="input-row choices">
                <FramingChoice/>
                <DeviceChoice/>
                <Found/>
                <SampleChoice/>
            </div>
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

#[component]
fn FramingChoice() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let found = move || {
        store
            .work
            .with(|w| w.as_ref().map_or("", |w| w.session.framing().label()))
    };
    let auto = move || match (store.framing.get(), found()) {
        (None, found) if !found.is_empty() => format!("Automatic: {found}"),
        _ => "Automatic".to_owned(),
    };
    let on_change = move |event: web_sys::Event| {
        store.choose_framing(Framing::from_key(&value_of(&event)));
    };
    view! {
        <label class="choice">
            <span>"Framing"</span>
            <select
                data-testid="decode-framing"
                prop:value=move || store.framing.get().map_or("", Framing::key)
                on:change=on_change
            >
                <option value="">{auto}</option>
                {Framing::ALL
                    .map(|f| {
                        view! {
                            <option
                                value=f.key()
                                selected=move || store.framing.get() == Some(f)
                            >
                                {f.label()}
                            </option>
                        }
                    })}
            </select>
        </label>
    }
}

#[component]
fn DeviceChoice() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let guess = Memo::new(move |_| store.work.with(|w| w.as_ref().map(|w| w.guess.clone())));
    let auto = move || match (store.device.get(), guess.get()) {
        (None, Some(guess)) => format!("Automatic: {}", guess.device.label()),
        _ => "Automatic".to_owned(),
    };
    let reason = move || match (store.device.get(), guess.get()) {
        (None, Some(guess)) => guess.reason,
        _ => String::new(),
    };
    let on_change = move |event: web_sys::Event| {
        store.choose_device(Device::from_key(&value_of(&event)));
    };
    view! {
        <label class="choice" title=reason>
            <span>"Device"</span>
            <select
                data-testid="decode-device"
                prop:value=move || store.device.get().map_or("", Device::key)
                on:change=on_change
            >
                <option value="">{auto}</option>
                {Device::ALL
                    .map(|d| {
                        view! {
                            <option value=d.key() selected=move || store.device.get() == Some(d)>
                                {d.label()}
                            </option>
                        }
                    })}
            </select>
        </label>
    }
}

/// What was found, or how far reading is.
#[component]
fn Found() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let words = move || {
        store.work.with(|w| {
            w.as_ref().map(|w| {
                let stopped = if w.partial {
                    ", reading was stopped"
                } else {
                    ""
                };
                format!(
                    "{}: {}, {}, {}{stopped}",
                    w.name,
                    form_label(w.form),
                    size(w.session.end()),
                    count(u64::from(w.session.len()), "frame")
                )
            })
        })
    };
    let progress = move || {
        store.progress.get().map(|p| {
            let percent = format!("{:.0} %", p.done * 100.0);
            let frames =
                (p.frames > 0).then(|| format!(", {} frames", thousands(u64::from(p.frames))));
            view! {
                <span class="progress" role="status">
                    <progress max="1" prop:value=p.done></progress>
                    {p.what} " " {percent} {frames}
                    <button
                        class="button"
                        data-testid="cancel"
                        on:click=move |_| store.cancel()
                    >
                        "Cancel"
                    </button>
                </span>
            }
        })
    };
    view! {
        <span class="found" data-testid="found" aria-live="polite">
            {words}
        </span>
        {progress}
    }
}

#[component]
fn SampleChoice() -> impl IntoView {
    let store: DecodeStore = expect_context();
    let on_change = move |event: web_sys::Event| {
        if let Some(sample) = crate::state::samples::by_key(&value_of(&event)) {
            store.open_sample(sample);
        }
    };
    view! {
        <label class="choice samples">
            <span>"Sample"</span>
            <select
                data-testid="sample"
                prop:value=move || store.sample.get().unwrap_or_default()
                on:change=on_change
            >
                <option value="">"Choose"</option>
                {SAMPLES
                    .iter()
                    .map(|s| {
                        view! {
                            <option value=s.key selected=move || store.sample.get() == Some(s.key)>
                                {s.title}
                            </option>
                        }
                    })
                    .collect::<Vec<_>>()}
            </select>
        </label>
    }
}
