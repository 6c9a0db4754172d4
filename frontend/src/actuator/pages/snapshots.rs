//! Saved devices: open, look at, compare.

use std::sync::Arc;

use leptos::ev;
use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::icon3000::snapshot::{Diff, diff};
use wasm_bindgen::JsCast;

use crate::actuator::markup::snapshots::{self, Entry, LIVE};
use crate::actuator::markup::tools;
use crate::actuator::state::dossier::Dossier;
use crate::actuator::state::saved;
use crate::actuator::state::wanted::Wanted;
use crate::actuator::store::Store;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::{Glyph, Icon};
use crate::erased::{effect, memo};
use crate::format::encode;
use crate::markup::Markup;

/// Files that are open, and two of them compared.
#[component]
pub(super) fn SnapshotsPage() -> impl IntoView {
    let store = Store::get();
    let trouble = RwSignal::new(String::new());
    let passing = RwSignal::new(false);
    // The last read of a device counts once it is over.
    let sites = RwSignal::new(store.sites());
    effect(move || {
        store.site.with(|site| {
            if site.job.is_none() && !site.dossier.tag.is_empty() {
                sites.update(|sites| {
                    sites.retain(|d| d.tag != site.dossier.tag);
                    sites.push(Arc::new(site.dossier.clone()));
                });
            }
        });
    });
    let entries = memo(move || sites.with(|sites| entries(store, sites)));
    let found = move |key: &str| -> Option<Arc<Dossier>> {
        match key.strip_prefix(LIVE) {
            Some(tag) => sites.with(|sites| sites.iter().find(|d| d.tag == tag).cloned()),
            None => {
                let at: usize = key.parse().ok()?;
                store
                    .saved
                    .with(|saved| saved.get(at).map(|s| Arc::clone(&s.dossier)))
            }
        }
    };
    let first = memo(move || store.query("from").unwrap_or_default());
    let second = memo(move || store.query("to").unwrap_or_default());
    let compared = memo(move || -> Option<Diff> {
        let (a, b) = (found(&first.get())?, found(&second.get())?);
        let now = store.now.get_untracked();
        Some(diff(&saved::snapshot(&a, now)?, &saved::snapshot(&b, now)?))
    });
    let open_file = move |file: web_sys::File| {
        spawn_local(async move {
            let name = file.name();
            let text = text_of(file).await.unwrap_or_default();
            match saved::open(&name, &text) {
                Ok((dossier, opened)) => {
                    trouble.set(String::new());
                    store.open(dossier, opened.problems);
                }
                Err(error) => trouble.set(error),
            }
        });
    };
    let handles = [
        window_event_listener(ev::dragover, |event| event.prevent_default()),
        window_event_listener(ev::drop, move |event| {
            event.prevent_default();
            let files = event.data_transfer().and_then(|data| data.files());
            if let Some(file) = files.and_then(|f| f.get(0)) {
                open_file(file);
            }
        }),
    ];
    on_cleanup(move || handles.into_iter().for_each(WindowListenerHandle::remove));
    let lead: Draw = Arc::new(move |html: &mut Markup| {
        trouble.with(|t| {
            if !t.is_empty() {
                html.open(
                    "p",
                    &[("class", "notice"), ("data-testid", "snapshot-trouble")],
                );
                html.text(t).close("p");
            }
        });
        if entries.with(Vec::is_empty) {
            snapshots::welcome(html);
        }
    });
    let list: Draw = Arc::new(move |html: &mut Markup| {
        let now = store.now.get_untracked();
        entries.with(|entries| snapshots::list(html, entries, now));
    });
    let choices: Draw = Arc::new(move |html: &mut Markup| {
        entries.with(|entries| {
            if !entries.is_empty() {
                let (first, second) = (first.get(), second.get());
                let (online, now) = (store.online.get(), store.now_us.get());
                store.site.with(|site| {
                    let idle = online && site.job.is_none();
                    let pair = (first.as_str(), second.as_str());
                    snapshots::choices(html, entries, pair, passing.get(), idle);
                    if !site.dossier.tag.is_empty() {
                        tools::progress(html, site, online, now);
                    }
                });
            }
        });
    });
    let changes: Draw = Arc::new(move |html: &mut Markup| {
        compared.with(|diff| {
            if let Some(diff) = diff {
                snapshots::changes(html, diff, passing.get());
            }
        });
    });
    let on_act = Callback::new(move |act: Act| {
        let (a, b) = (first.get_untracked(), second.get_untracked());
        match act.name.as_str() {
            "first" => compare(store, &act.value, &b),
            "second" => compare(store, &a, &act.value),
            "swap" => compare(store, &b, &a),
            "passing" => passing.set(!act.value.is_empty()),
            "cancel" => store.cancel(),
            "resume" => store.resume(),
            "fresh" => {
                let live = [b, a].into_iter();
                let tag = live
                    .filter_map(|key| key.strip_prefix(LIVE).map(str::to_owned))
                    .next();
                store.visit(&tag.unwrap_or_default());
                let wanted = store
                    .site
                    .with_untracked(|s| Wanted::everything(&s.dossier));
                store.read(wanted);
            }
            _ => {
                let key = act.element.get_attribute("data-key").unwrap_or_default();
                if let Ok(at) = key.parse() {
                    store.close(at);
                    store.go("#/snapshots");
                }
            }
        }
    });
    view! {
        <div class="icon-page" data-testid="page-snapshot-list">
            <header class="icon-title">
                <h1>"Snapshots"</h1>
                <label class="button">
                    <Icon glyph=Glyph::File/>
                    "Open file"
                    <input
                        type="file"
                        class="hidden-input"
                        accept=".json,application/json"
                        data-testid="snapshot-file"
                        on:change=move |event| {
                            if let Some(file) = chosen_file(&event) {
                                open_file(file);
                            }
                        }
                    />
                </label>
            </header>
            <Drawn class="icon-intro" draw=lead/>
            <Drawn class="icon-body" draw=list on_act=on_act/>
            <Drawn class="toolbar filters icon-compare" draw=choices on_act=on_act/>
            <Drawn class="icon-groups" draw=changes testid="changes" role="status"/>
        </div>
    }
}

fn compare(store: Store, first: &str, second: &str) {
    let hash = format!("#/snapshots?from={}&to={}", encode(first), encode(second));
    store.go(&hash);
}

fn entries(store: Store, sites: &[Arc<Dossier>]) -> Vec<Entry> {
    let saved = store.saved.with(|saved| {
        let saved = saved.iter().enumerate();
        saved
            .map(|(at, s)| {
                let href = format!("#/snapshots/health?of={at}");
                snapshots::entry(&s.dossier, &at.to_string(), href, &s.problems)
            })
            .collect::<Vec<_>>()
    });
    let live = sites.iter().filter(|d| !d.is_empty()).map(|d| {
        let href = format!("#/device/{}/health", encode(&d.tag));
        snapshots::entry(d, &format!("{LIVE}{}", d.tag), href, &[])
    });
    saved.into_iter().chain(live).collect()
}

/// The text of a file that was chosen or dropped.
async fn text_of(file: web_sys::File) -> Option<String> {
    crate::task::promise(file.text()).await?.as_string()
}

/// The file that was chosen in a field, which is emptied so that the same can be chosen again.
fn chosen_file(event: &web_sys::Event) -> Option<web_sys::File> {
    let input = event
        .target()?
        .dyn_into::<web_sys::HtmlInputElement>()
        .ok()?;
    let file = input.files().and_then(|list| list.get(0));
    input.set_value("");
    file
}
