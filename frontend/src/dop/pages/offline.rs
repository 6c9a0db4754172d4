//! Registers without a device: pasted, dropped, from a file, or a sample.

use std::sync::Arc;

use leptos::ev;
use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::dop::Request;
use wasm_bindgen::JsCast;

use super::object::ObjectView;
use super::{chosen_file, part, text_of, toggle};
use crate::browser::value_of;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::{Glyph, Icon};
use crate::dop::markup::offline;
use crate::dop::state::offline::Offline;
use crate::dop::store::Store;
use crate::erased::{effect, memo};
use crate::markup::Markup;

/// The torque of a stroke, whose options lie over each other.
const STROKES: u16 = 401;

/// The offline side.
#[component]
pub(super) fn OfflinePage() -> impl IntoView {
    let store = Store::get();
    let text = RwSignal::new(String::new());
    let request = RwSignal::new(None::<Request>);
    let item = RwSignal::new(None::<usize>);
    let offline = memo(move || {
        let (request, profile) = (request.get(), store.own.get());
        text.with(|text| Offline::open(text, request, &profile))
    });
    let open = move |content: String| {
        item.set(None);
        text.set(content);
    };
    // A sample is part of the address, so that a link opens it again.
    let wanted = memo(move || store.query("sample").unwrap_or_default());
    effect(move || {
        if let Some(sample) = offline::sample(&wanted.get()) {
            request.set((sample.request != 0).then(|| Request::from_word(sample.request)));
            open(sample.content.to_owned());
        }
    });
    let open_file = move |file: web_sys::File| {
        spawn_local(async move {
            if let Some(content) = text_of(file).await {
                open(content);
            }
        });
    };
    let handles = [
        window_event_listener(ev::dragover, move |event| {
            event.prevent_default();
            toggle(".dop .input", "over", true);
        }),
        window_event_listener(ev::dragleave, move |event| {
            if event.related_target().is_none() {
                toggle(".dop .input", "over", false);
            }
        }),
        window_event_listener(ev::drop, move |event| {
            event.prevent_default();
            toggle(".dop .input", "over", false);
            let Some(data) = event.data_transfer() else {
                return;
            };
            if let Some(file) = data.files().and_then(|f| f.get(0)) {
                open_file(file);
            } else if let Ok(content) = data.get_data("text/plain") {
                open(content);
            }
        }),
    ];
    let pasted = window_event_listener(ev::paste, move |event| {
        let in_field = event
            .target()
            .and_then(|t| t.dyn_into::<web_sys::Element>().ok())
            .is_some_and(|t| matches!(t.tag_name().as_str(), "INPUT" | "TEXTAREA"));
        let Some(data) = event.clipboard_data().filter(|_| !in_field) else {
            return;
        };
        if let Ok(content) = data.get_data("text/plain")
            && !content.is_empty()
        {
            event.prevent_default();
            open(content);
        }
    });
    on_cleanup(move || {
        handles.into_iter().for_each(WindowListenerHandle::remove);
        pasted.remove();
    });

    let decoded = memo(move || {
        let at = item.get().unwrap_or(0);
        offline.with(|o| {
            o.items
                .get(at)
                .or_else(|| o.items.first())
                .map(|i| i.decoded.clone())
        })
    });
    let strokes = memo(move || {
        offline.with(|o| {
            let all = o.items.iter().map(|i| &i.decoded);
            let strokes = all.filter(|d| d.kept.request.object() == STROKES);
            store.strokes(&strokes.map(|d| &*d.read).collect::<Vec<_>>())
        })
    });
    effect(move || {
        let reads = offline.with(|o| o.items.len());
        toggle(".dop-offline", "several", reads > 1);
        toggle(".dop .input", "collapsed", reads > 0);
    });
    let earlier = memo(|| None);
    let choices: Draw = Arc::new(move |html: &mut Markup| {
        let (request, profile) = (request.get(), store.own.get());
        offline.with(|o| offline::choices(html, request, &profile, o));
    });
    let doubts: Draw = Arc::new(move |html: &mut Markup| {
        let chosen = decoded.with(|d| d.as_ref().map(|d| d.kept.request));
        offline.with(|o| {
            offline::doubts(html, o, chosen);
            if o.items.is_empty() && o.problems.is_empty() {
                offline::welcome(html);
            }
        });
    });
    let items: Draw = Arc::new(move |html: &mut Markup| {
        offline.with(|o| {
            if o.items.len() > 1 {
                offline::items(html, o, item.get().unwrap_or(0));
            }
        });
    });
    let on_act = Callback::new(move |act: Act| {
        let attribute = |name| act.element.get_attribute(name).unwrap_or_default();
        match act.name.as_str() {
            "request" | "word" => request.set(word(&act.value)),
            "fit" => request.set(word(&attribute("data-word"))),
            "sample" => {
                let key = if act.value.is_empty() {
                    attribute("data-sample")
                } else {
                    act.value
                };
                store.go(&format!("#/dop?sample={key}"));
            }
            "item" => item.set(attribute("data-index").parse().ok()),
            _ => {
                request.set(None);
                open(String::new());
                store.go("#/dop");
            }
        }
    });
    let has = memo(move || decoded.with(Option::is_some));
    let shown = part(move || {
        let object = move || {
            view! { <ObjectView decoded=decoded strokes=strokes earlier=earlier/> }
        };
        has.get().then(object).into_any()
    });
    view! {
        <div class="dop-page dop-offline">
            <section class="input" aria-label="Input">
                <div class="input-row">
                    <textarea
                        class="mono"
                        data-testid="dop-paste"
                        data-find
                        spellcheck="false"
                        autocomplete="off"
                        aria-label="Response registers, a capture, or saved reads"
                        placeholder="Paste response registers here: hex, decimal or a table. Or a Modbus capture of the whole exchange."
                        prop:value=text
                        on:input=move |event| open(value_of(&event))
                    ></textarea>
                    <label class="button">
                        <Icon glyph=Glyph::File/>
                        "Open file"
                        <input
                            type="file"
                            class="hidden-input"
                            data-testid="dop-file"
                            on:change=move |event| {
                                if let Some(file) = chosen_file(&event) {
                                    open_file(file);
                                }
                            }
                        />
                    </label>
                </div>
                <Drawn class="input-row choices" draw=choices on_act=on_act/>
            </section>
            <Drawn class="doubts" draw=doubts on_act=on_act/>
            <div class="offline-body">
                <Drawn class="offline-items" draw=items on_act=on_act/>
                {shown}
            </div>
        </div>
    }
}

/// A request word as people write it.
fn word(text: &str) -> Option<Request> {
    let digits = text.trim();
    let digits = digits
        .strip_prefix("0x")
        .or_else(|| digits.strip_prefix("0X"))
        .unwrap_or(digits);
    u16::from_str_radix(digits, 16).ok().map(Request::from_word)
}
