//! The program's screens.

mod device;
mod fields;
mod log;
mod object;
mod objects;
mod offline;
mod overview;
mod profile;

use std::sync::Arc;

use leptos::prelude::*;

use super::store::Store;
use crate::components::drawn::{Draw, Drawn};
use crate::erased::memo;
use crate::markup::Markup;

/// The program: what is pasted, or a device on the line.
#[component]
pub fn Diagnostics() -> impl IntoView {
    let store = Store::provide();
    let is_device = memo(move || store.tag.with(|tag| !tag.is_empty()));
    let open = memo(move || {
        let tab = store.tab.get();
        match (is_device.get(), tab.as_str()) {
            (true, "objects" | "logs" | "settings") | (false, "profile") => tab,
            _ => String::new(),
        }
    });
    let tabs: Draw = Arc::new(move |html: &mut Markup| {
        let tag = store.tag.get();
        let open = open.get();
        let base = if tag.is_empty() {
            "#/dop".to_owned()
        } else {
            format!("#/device/{}", crate::format::encode(&tag))
        };
        let all: &[(&str, &str)] = if tag.is_empty() {
            &[("", "Registers"), ("profile", "Profile")]
        } else {
            &[
                ("", "Overview"),
                ("objects", "Objects"),
                ("logs", "Logs"),
                ("settings", "Settings"),
            ]
        };
        for (key, label) in all {
            let href = match (*key, tag.is_empty()) {
                ("", true) => base.clone(),
                ("", false) => format!("{base}/overview"),
                (key, _) => format!("{base}/{key}"),
            };
            html.open(
                "a",
                &[
                    ("class", "tab"),
                    ("role", "tab"),
                    ("href", &href),
                    ("data-testid", "dop-tab"),
                    ("data-tab", if key.is_empty() { "overview" } else { key }),
                    ("aria-selected", if *key == open { "true" } else { "false" }),
                ],
            );
            html.text(label).close("a");
        }
    });
    let body = part(move || match (is_device.get(), open.get().as_str()) {
        (false, "profile") => view! { <profile::ProfilePage/> }.into_any(),
        (false, _) => view! { <offline::OfflinePage/> }.into_any(),
        (true, "objects") => view! { <objects::ObjectsPage/> }.into_any(),
        (true, "logs") => view! { <log::LogsPage/> }.into_any(),
        (true, "settings") => view! { <device::SettingsPage/> }.into_any(),
        (true, _) => view! { <overview::OverviewPage/> }.into_any(),
    });
    view! {
        <div class="dop">
            <Drawn class="tabs dop-tabs" role="tablist" label="Diagnostic objects" draw=tabs/>
            {body}
        </div>
    }
}

/// A part of a view that changes, behind a box: Leptos would compile the machinery around each such
/// closure anew.
fn part(make: impl Fn() -> AnyView + Send + 'static) -> AnyView {
    let make: Box<dyn Fn() -> AnyView + Send> = Box::new(make);
    make.into_any()
}

/// Sets or clears a class of an element that is drawn by now. Cheaper than a class that follows a
/// signal, whose machinery is compiled for each.
fn toggle(selector: &'static str, class: &'static str, on: bool) {
    request_animation_frame(move || {
        if let Ok(Some(element)) = document().query_selector(selector) {
            // Fails only for names that are none.
            let _infallible = element.class_list().toggle_with_force(class, on);
        }
    });
}

/// Saves text as a file named after what it is of.
fn save(what: &str, extension: &str, text: &str) {
    let safe = |c: char| {
        if c.is_ascii_alphanumeric() || c == '-' {
            c
        } else {
            '-'
        }
    };
    let what: String = what.chars().map(safe).collect();
    crate::browser::save(&format!("valvescope-{what}.{extension}"), text);
}

/// The text of a file that was chosen or dropped.
async fn text_of(file: web_sys::File) -> Option<String> {
    crate::task::promise(file.text()).await?.as_string()
}

/// The file that was chosen in a field, which is emptied so that the same can be chosen again.
fn chosen_file(event: &web_sys::Event) -> Option<web_sys::File> {
    use wasm_bindgen::JsCast;
    let input = event
        .target()?
        .dyn_into::<web_sys::HtmlInputElement>()
        .ok()?;
    let file = input.files().and_then(|list| list.get(0));
    input.set_value("");
    file
}
