//! The tag list of a network: import and export.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::ddc100::tags::TagList;
use wasm_bindgen::JsCast;

use super::save;
use crate::browser::value_of;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::{Glyph, Icon};
use crate::markup::Markup;
use crate::network::markup::tags;
use crate::network::state::list::{export, laid_over};
use crate::network::state::tags::Tags;
use crate::network::store::Store;

/// The list.
#[component]
pub(super) fn TagsPage() -> impl IntoView {
    let store = Store::get();
    let read = RwSignal::new(None::<TagList>);
    let import = move |text: String| {
        if text.trim().is_empty() {
            read.set(None);
            return;
        }
        let list = TagList::read(&text);
        if !list.tags.is_empty() {
            store.set_tags(store.tags.with_untracked(|tags| laid_over(tags, &list)));
            store.set_list(&list);
        }
        read.set(Some(list));
    };
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        store
            .list
            .with(|list| store.tags.with(|tags| tags::tools(html, tags, list)));
    });
    let said: Draw = Arc::new(move |html: &mut Markup| {
        read.with(|read| {
            if let Some(list) = read {
                let units = (1..=250).filter(|u| list.of_unit(*u).is_some()).count();
                tags::said(html, list, units);
            }
        });
    });
    let units: Draw = Arc::new(move |html: &mut Markup| {
        store.net.with(|net| {
            store.list.with(|list| {
                store.tags.with(|tags| tags::units(html, net, tags, list));
            });
        });
    });
    let on_act = Callback::new(move |act: Act| {
        if act.name == "forget" {
            store.set_tags(Tags::default());
            store.set_list(&TagList::default());
            read.set(None);
            return;
        }
        let list = store.net.with_untracked(|net| {
            let tags = store.tags.get_untracked();
            store.list.with_untracked(|list| export(net, &tags, list))
        });
        save(
            &format!("tags-{}", store.bus.get_untracked()),
            "csv",
            &list.to_csv(),
        );
    });
    let on_file = move |event: web_sys::Event| {
        let input = event
            .target()
            .and_then(|t| t.dyn_into::<web_sys::HtmlInputElement>().ok());
        let Some(input) = input else { return };
        let file = input.files().and_then(|list| list.get(0));
        input.set_value("");
        if let Some(file) = file {
            spawn_local(async move {
                let text = crate::task::promise(file.text()).await;
                if let Some(text) = text.and_then(|t| t.as_string()) {
                    import(text);
                }
            });
        }
    };
    view! {
        <div class="net-page tags-page" data-testid="tags">
            <p class="quiet typed-about">
                "Tags in the style of table 6.1: a line for each unit or point, as CSV. What is imported is laid over the configuration and kept in this browser only."
            </p>
            <div class="toolbar">
                <label class="button">
                    <Icon glyph=Glyph::File/>
                    "Import CSV"
                    <input
                        type="file"
                        class="hidden-input"
                        accept=".csv,text/csv,text/plain"
                        data-testid="tags-file"
                        on:change=on_file
                    />
                </label>
                <Drawn class="toolbar-part" draw=tools on_act=on_act/>
            </div>
            <div class="typed-paste tags-paste">
                <textarea
                    class="mono"
                    data-testid="tags-paste"
                    spellcheck="false"
                    aria-label="A tag list"
                    placeholder="Or paste a list: Tag name,Description,Unit,Register,Command data,Scaling,Comments"
                    on:input=move |event| import(value_of(&event))
                ></textarea>
            </div>
            <Drawn class="import-said" draw=said/>
            <Drawn class="tags-units" draw=units/>
        </div>
    }
}
