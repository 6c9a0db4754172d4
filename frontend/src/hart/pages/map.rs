//! The condensed status map: of a device, of the manual's examples, of a file.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::device::{Device, Family};
use shared::hart::PRESETS;
use shared::hart::ne107::Map;
use wasm_bindgen::JsCast;

use super::device::tools;
use crate::browser::save;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::{Glyph, Icon};
use crate::decode_store::DecodeStore;
use crate::hart::markup::map::{matrix, result};
use crate::hart::state::condition::alarm_bytes;
use crate::hart::state::map::{
    Known, from_csv, of_device, preset, refused, status_in, table, to_csv, typed,
};
use crate::hart::state::unit::Unit;
use crate::hart::store::Store;
use crate::markup::Markup;
use crate::markup::control::{Button, Choice};
use crate::task::promise;

/// A map with where it is from.
type Named = (String, Known);

/// The map of the device on the line.
#[component]
pub(super) fn DeviceMapPage() -> impl IntoView {
    let store = Store::get();
    let (draw, on_act) = tools(store);
    view! {
        <div class="hart-page" data-testid="hart-map-page">
            <Drawn class="toolbar" draw=draw on_act=on_act/>
            <MapView unit=Some(store.unit)/>
        </div>
    }
}

/// The matrix with its sources, without a device or with one.
#[component]
pub(super) fn MapView(
    /// The device.
    unit: Option<RwSignal<Unit>>,
) -> impl IntoView {
    let chosen = RwSignal::new(String::new());
    let beside = RwSignal::new(String::new());
    let picked = RwSignal::new(None::<Family>);
    let file = RwSignal::new(None::<Named>);
    let problem = RwSignal::new(String::new());
    let given = RwSignal::new(String::new());
    let input = use_context::<DecodeStore>();
    let captured = move || {
        let input = input?;
        input.epoch.track();
        let selected = input.cursor.get().and_then(|at| u32::try_from(at).ok());
        input
            .work
            .with(|work| status_in(&work.as_ref()?.session, selected))
    };
    let of = move |key: &str| -> Option<Named> {
        match key {
            "device" => unit?.with(of_device).map(|m| ("the device".to_owned(), m)),
            "file" => file.get(),
            "factory" => Some(("no effect for all".to_owned(), Known::all(&Map::default()))),
            key => preset(key).map(|p| (p.label.to_owned(), Known::all(&Map::of(p)))),
        }
    };
    // Unless somebody chose: what the device says, else the first example.
    let key = move || {
        let key = chosen.get();
        match (key.is_empty(), unit.is_some()) {
            (false, _) => key,
            (true, true) => "device".to_owned(),
            (true, false) => PRESETS.first().map_or("", |p| p.key).to_owned(),
        }
    };
    let family = move || {
        let own = unit.and_then(|u| u.with(|u| u.family));
        own.or(picked.get())
            .or_else(|| preset(&key()).map(|p| p.family))
    };
    let head: Draw = Arc::new(move |html: &mut Markup| {
        let presets: Vec<_> = PRESETS
            .iter()
            .map(|p| (p.key, format!("{}, {}", p.label, table(p))))
            .collect();
        let mut sources: Vec<(&str, String)> = Vec::new();
        if unit.is_some() {
            sources.push(("device", "As read from the device".to_owned()));
        }
        sources.extend(presets);
        sources.push(("factory", "As delivered: no effect for all".to_owned()));
        if let Some((name, _)) = file.get() {
            sources.push(("file", name));
        }
        let pairs = || sources.iter().map(|(k, w)| (*k, w.as_str()));
        let now = key();
        Choice {
            act: "map",
            testid: "hart-map-source",
            label: "Map",
            none: "Choose",
            value: &now,
            labelled: true,
            title: "",
        }
        .draw(html, pairs());
        let now = beside.get();
        Choice {
            act: "beside",
            testid: "hart-map-beside",
            label: "Compare with",
            none: "nothing",
            value: &now,
            labelled: true,
            title: "",
        }
        .draw(html, pairs());
        if unit.is_none() {
            let now = family().map_or("", Family::key);
            Choice {
                act: "family",
                testid: "hart-map-family",
                label: "Family",
                none: "Choose",
                value: now,
                labelled: true,
                title: "",
            }
            .draw(html, Family::ALL.iter().map(|f| (f.key(), f.label())));
        }
        Button {
            act: "save",
            testid: "hart-map-save",
            words: "Save as file",
            glyph: Some(Glyph::Save),
            disabled: of(&key()).and_then(|(_, m)| m.whole()).is_none(),
            ..Button::default()
        }
        .draw(html);
        if unit.is_none() {
            given.with(|text| status_field(html, text));
        }
        if problem.with(|p| !p.is_empty()) {
            problem.with(|p| html.node("p", "notice", p));
        }
    });
    let body: Draw = Arc::new(move |html: &mut Markup| {
        let (main, other) = (key(), beside.get());
        let why = unit.and_then(|u| u.with(|u| refused(u).map(str::to_owned)));
        if let Some(why) = why
            .as_ref()
            .filter(|_| main == "device" || other == "device")
        {
            html.node("p", "notice", why);
        }
        let Some((_, map)) = of(&main) else {
            if why.is_none() {
                html.node("p", "empty", "The map of the device was not read yet.");
            }
            return;
        };
        let beside = of(&other).map(|(_, m)| m);
        let family = family();
        let status = match unit {
            Some(unit) => unit.with(alarm_bytes).map(|s| (s, "the status as read")),
            None => given.with(|text| match (typed(text), text.trim().is_empty()) {
                (Some(status), _) => Some((status, "the status bytes as given")),
                (None, true) => captured().map(|s| (s, "command 48 of the input")),
                (None, false) => {
                    html.node(
                        "p",
                        "notice",
                        "Give at least four status bytes as hex digits.",
                    );
                    None
                }
            }),
        };
        if let (Some(family), Some((status, words))) = (family, status) {
            let words = format!("{words}, {},", shared::render::Spaced(&status));
            result(html, &words, map.report(family, &status));
        }
        let sources = [preset(&main), preset(&other)];
        let beside = beside.as_ref().map(|map| (map, sources[1]));
        matrix(html, family, (&map, sources[0]), beside);
        // How codes and indexes are read, that SI has no alarms, and what is open about an example.
        let mut notes = vec!["R18", "R21"];
        if family == Some(Family::Si) {
            notes.push("R10");
        }
        for bit in sources.into_iter().flatten().flat_map(|p| p.bits) {
            notes.extend(bit.reading.map(|r| r.id).filter(|id| !notes.contains(id)));
        }
        for reading in notes.into_iter().filter_map(shared::hart::reading) {
            html.open("p", &[("class", "quiet")]);
            html.node("code", "", reading.id)
                .text(" ")
                .text(reading.text)
                .close("p");
        }
    });
    let on_act = Callback::new(move |act: Act| match act.name.as_str() {
        "map" => chosen.set(act.value),
        "beside" => beside.set(act.value),
        "family" => picked.set(Device::from_key(&act.value).and_then(Device::family)),
        "status" => given.set(act.value),
        _ => {
            if let Some(map) = untrack(|| of(&key())).and_then(|(_, m)| m.whole()) {
                let family = untrack(family);
                save("valvescope-status-map.csv", &to_csv(family, &map));
            }
        }
    });
    let on_file = move |event: web_sys::Event| {
        let Some(chosen_file) = chosen_file(&event) else {
            return;
        };
        spawn_local(async move {
            let name = chosen_file.name();
            let text = promise(chosen_file.text())
                .await
                .and_then(|t| t.as_string());
            match text.as_deref().map(from_csv) {
                Some(Ok(map)) => {
                    file.set(Some((name, Known::all(&map))));
                    chosen.set("file".to_owned());
                    problem.set(String::new());
                }
                Some(Err(why)) => problem.set(why),
                None => problem.set("The file can't be read as text.".to_owned()),
            }
        });
    };
    view! {
        <div class="hart-map-view" data-testid="hart-map-view">
            <Drawn class="toolbar" draw=head on_act=on_act/>
            <label class="button hart-map-open">
                <Icon glyph=Glyph::File/>
                "Open a saved map"
                <input
                    type="file"
                    class="hidden-input"
                    data-testid="hart-map-file"
                    on:change=on_file
                />
            </label>
            <Drawn class="hart-map-body" draw=body/>
        </div>
    }
}

/// A field for the status bytes of a device that is not there.
fn status_field(html: &mut Markup, text: &str) {
    html.open("label", &[("class", "choice")]);
    html.node("span", "", "Status bytes").open(
        "input",
        &[
            ("type", "text"),
            ("data-act", "status"),
            ("data-testid", "hart-map-status"),
            ("data-value", text),
            ("value", text),
            ("placeholder", "as 02 00 02 00"),
            ("aria-label", "Status bytes 0 on of command 48, hexadecimal"),
        ],
    );
    html.close("label");
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
