//! All objects of a device: the list, and the one that is open.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::dop::Request;

use super::object::ObjectView;
use super::{chosen_file, part, save, text_of, toggle};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::Glyph;
use crate::dop::markup::list;
use crate::dop::state::kept::Decoded;
use crate::dop::state::saved::Saved;
use crate::dop::store::Store;
use crate::erased::{effect, memo};
use crate::markup::Markup;
use crate::markup::control::Button;

/// The torque of a stroke, whose options lie over each other.
const STROKES: u16 = 401;

/// The list of objects, and the one that the address names.
#[component]
pub(super) fn ObjectsPage() -> impl IntoView {
    let store = Store::get();
    let trouble = RwSignal::new(String::new());
    let chosen = memo(move || {
        let number = |key| store.query(key).and_then(|text| text.parse::<u16>().ok());
        let option = number("option")
            .and_then(|o| u8::try_from(o).ok())
            .unwrap_or(0);
        number("object").and_then(|object| Request::new(object, option))
    });
    let decoded = memo(move || {
        let request = chosen.get()?;
        let (kept, profile) = store
            .site
            .with(|s| (s.kept.get(&request.word()).cloned(), Arc::clone(&s.profile)));
        kept.map(|kept| Decoded::new(kept, &profile))
    });
    let earlier = memo(move || {
        let kept = store.earlier_of(chosen.get()?)?;
        let profile = store.site.with(|s| Arc::clone(&s.profile));
        Some(Decoded::new(kept, &profile))
    });
    let strokes = memo(move || {
        if chosen.get().is_none_or(|r| r.object() != STROKES) {
            return Vec::new();
        }
        store.site.with(|s| {
            let strokes = s.kept.values().filter(|k| k.request.object() == STROKES);
            let reads: Vec<_> = strokes.map(|k| k.read(&s.profile)).collect();
            store.strokes(&reads.iter().collect::<Vec<_>>())
        })
    });
    // An object that is opened for the first time is read.
    effect(move || {
        let Some(request) = chosen.get() else { return };
        let wanted = store.online.get()
            && store.site.with_untracked(|s| {
                let word = request.word();
                !s.kept.contains_key(&word)
                    && !s.failed.contains_key(&word)
                    && s.reading().is_none()
            });
        if wanted && request.is_known(&store.site.with_untracked(|s| Arc::clone(&s.profile))) {
            store.read(vec![request]);
        }
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let online = store.online.get();
        let kept = store.earlier.with(Option::is_some);
        store
            .site
            .with(|site| list::tools(html, site, online, kept));
    });
    let notes: Draw = Arc::new(move |html: &mut Markup| {
        trouble.with(|t| {
            if !t.is_empty() {
                html.node("p", "notice", t);
            }
        });
        store.earlier.with(|saved| {
            if let Some(saved) = saved {
                draw_earlier(html, saved);
            }
        });
    });
    let objects: Draw = Arc::new(move |html: &mut Markup| {
        let (now, tag) = (store.now.get(), store.tag.get());
        let chosen = chosen.get().unwrap_or_default();
        store
            .site
            .with(|site| list::objects(html, site, &tag, chosen, now));
    });
    let on_act = Callback::new(move |act: Act| match act.name.as_str() {
        "read-all" => store.read_all(),
        "cancel" => {
            if let Some(id) = store.site.with_untracked(|s| s.reading().map(|j| j.id)) {
                store.cancel(id);
            }
        }
        "keep" => store.keep(),
        _ => {
            let saved = store.saved();
            save(&format!("dop-{}", saved.device), "json", &saved.to_json());
        }
    });
    let on_file = move |event: web_sys::Event| {
        let Some(file) = chosen_file(&event) else {
            return;
        };
        spawn_local(async move {
            let text = text_of(file).await.unwrap_or_default();
            match Saved::from_json(&text) {
                Ok(saved) => {
                    trouble.set(String::new());
                    store.earlier.set(Some(Arc::new(saved)));
                }
                Err(words) => trouble.set(words),
            }
        });
    };
    // Why there is nothing to see yet.
    let missing: Draw = Arc::new(move |html: &mut Markup| {
        if decoded.with(Option::is_none) {
            store
                .site
                .with(|site| draw_missing(html, site, chosen.get()));
        }
    });
    let on_missing = Callback::new(move |_: Act| {
        if let Some(request) = chosen.get_untracked() {
            store.read(vec![request]);
        }
    });
    let back: Draw = Arc::new(move |html: &mut Markup| {
        let href = store.tag.with(|tag| list::link(tag, "objects", ""));
        html.open("a", &[("class", "button dop-back"), ("href", &href)]);
        html.text("All objects").close("a");
    });
    effect(move || toggle(".dop-objects", "show-detail", chosen.get().is_some()));
    let has = memo(move || decoded.with(Option::is_some));
    let shown = part(move || {
        let object = move || {
            view! { <ObjectView decoded=decoded strokes=strokes earlier=earlier/> }
        };
        has.get().then(object).into_any()
    });
    view! {
        <div class="dop-page dop-objects">
            <div class="objects-list" on:change=on_file>
                <Drawn class="toolbar" draw=tools on_act=on_act/>
                <Drawn
                    class="objects-notes"
                    draw=notes
                    on_act=Callback::new(move |_: Act| store.earlier.set(None))
                />
                <Drawn class="objects-rows" draw=objects/>
            </div>
            <div class="objects-detail">
                <Drawn class="back-row" draw=back/>
                <Drawn class="object-missing" draw=missing on_act=on_missing/>
                {shown}
            </div>
        </div>
    }
}

fn draw_earlier(html: &mut Markup, saved: &Saved) {
    html.open(
        "p",
        &[("class", "earlier-note"), ("data-testid", "earlier-note")],
    );
    let reads = crate::format::count(
        u64::try_from(saved.reads.len()).unwrap_or(0),
        "earlier read",
    );
    html.text(&format!("Compared with {reads} of {} ", saved.device));
    let last = saved.reads.iter().filter_map(|k| k.wall_ms).max();
    if let Some(last) = last.and_then(|ms| i64::try_from(ms / 1000).ok()) {
        html.text(&format!("until {} UTC ", crate::chart::time::stamp(last)));
    }
    html.open(
        "button",
        &[
            ("class", "quiet-button"),
            ("data-act", "forget"),
            ("data-testid", "forget-earlier"),
        ],
    );
    html.text("Do not compare").close("button").close("p");
}

fn draw_missing(html: &mut Markup, site: &crate::dop::state::site::Site, chosen: Option<Request>) {
    let Some(request) = chosen else {
        html.node("p", "empty", "Choose an object and an option to see it.");
        return;
    };
    let label = shared::dop::object(request.object()).map_or("Unknown object", |o| o.label);
    html.node("h2", "", label);
    html.open("p", &[("class", "quiet")]);
    html.node("code", "", &request.to_string()).close("p");
    let job = site.reading();
    if let Some(failure) = site.failed.get(&request.word()) {
        html.open(
            "p",
            &[("class", "object-error"), ("data-testid", "object-failed")],
        );
        html.severity(shared::problem::Severity::Error);
        html.text(" ").text(&failure.text).close("p");
    } else if let Some(job) = job {
        html.open("p", &[("role", "status")]);
        html.text(&format!("Reading: {}", job.text)).close("p");
    } else {
        html.node("p", "quiet", "Not read yet.");
    }
    Button {
        act: "read",
        testid: "read-object",
        words: "Read",
        glyph: Some(Glyph::Poll),
        disabled: job.is_some(),
        ..Button::default()
    }
    .draw(html);
}
