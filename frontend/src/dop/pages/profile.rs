//! The profile editor: a form and its text, each following the other.

use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::dop::Profile;
use shared::dop::profile::ProfileProblem;

use super::{chosen_file, save, text_of};
use crate::browser::value_of;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::{Glyph, Icon};
use crate::dop::markup::profile;
use crate::dop::state::draft::{BitRow, Draft};
use crate::dop::store::Store;
use crate::markup::Markup;
use crate::markup::control::Button;

/// The settings made here.
#[component]
pub(super) fn ProfilePage() -> impl IntoView {
    let store = Store::get();
    let own = store.own.get_untracked();
    let draft = RwSignal::new(Draft::of(&own));
    let text = RwSignal::new(own.to_json());
    let in_form = RwSignal::new(Vec::<ProfileProblem>::new());
    let in_text = RwSignal::new(Vec::<ProfileProblem>::new());
    // The form changed: the text follows, right or wrong.
    let from_form = move || {
        let json = draft.with_untracked(Draft::to_json);
        match Profile::from_json(&json) {
            Ok(profile) => {
                text.set(profile.to_json());
                in_form.set(Vec::new());
                in_text.set(Vec::new());
                store.set_own(profile);
            }
            Err(problems) => {
                text.set(json);
                in_form.set(problems.clone());
                in_text.set(problems);
            }
        }
    };
    // The text changed: the form follows once it is right.
    let from_text = move |json: String| {
        match Profile::from_json(&json) {
            Ok(profile) => {
                draft.set(Draft::of(&profile));
                in_form.set(Vec::new());
                in_text.set(Vec::new());
                store.set_own(profile);
            }
            Err(problems) => in_text.set(problems),
        }
        text.set(json);
    };
    let on_form = Callback::new(move |act: Act| {
        draft.update(|draft| change(draft, &act));
        from_form();
    });
    let form: Draw = Arc::new(move |html: &mut Markup| {
        draft.with(|draft| in_form.with(|problems| profile::form(html, draft, problems)));
    });
    let problems: Draw = Arc::new(move |html: &mut Markup| {
        in_text.with(|all| profile::problems(html, all));
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let bad = in_text.with(|all| !all.is_empty());
        Button {
            act: "save",
            testid: "profile-save",
            words: "Save as file",
            glyph: Some(Glyph::Save),
            disabled: bad,
            ..Button::default()
        }
        .draw(html);
        Button {
            act: "new",
            testid: "profile-new",
            words: "Begin anew",
            glyph: Some(Glyph::Clear),
            ..Button::default()
        }
        .draw(html);
    });
    let on_tool = Callback::new(move |act: Act| {
        if act.name == "new" {
            from_text(Profile::default().to_json());
        } else {
            let name = store.own.with_untracked(|p| p.name.clone());
            save(&format!("profile-{name}"), "json", &text.get_untracked());
        }
    });
    let on_file = move |event: web_sys::Event| {
        let Some(file) = chosen_file(&event) else {
            return;
        };
        spawn_local(async move {
            if let Some(json) = text_of(file).await {
                from_text(json);
            }
        });
    };
    view! {
        <div class="dop-page dop-profile">
            <div class="toolbar">
                <label class="button" data-testid="profile-open">
                    <Icon glyph=Glyph::File/>
                    "Open file"
                    <input
                        type="file"
                        class="hidden-input"
                        accept=".json,application/json"
                        data-testid="profile-file"
                        on:change=on_file
                    />
                </label>
                <Drawn class="actions" draw=tools on_act=on_tool/>
                <p class="quiet">
                    "What the manual leaves open, for one site. It holds for what is decoded here, is "
                    "kept in this browser, and is the file that the bridge reads."
                </p>
            </div>
            <div class="profile-panes">
                <Drawn class="profile-form" draw=form on_act=on_form/>
                <section class="profile-text" aria-label="Profile as text">
                    <h3>"The file"</h3>
                    <textarea
                        class="mono"
                        data-testid="profile-text"
                        spellcheck="false"
                        autocomplete="off"
                        aria-label="Profile as JSON"
                        prop:value=text
                        on:input=move |event| from_text(value_of(&event))
                    ></textarea>
                    <Drawn class="text-problems" draw=problems role="status"/>
                </section>
            </div>
        </div>
    }
}

/// Makes of a draft what a control says.
fn change(draft: &mut Draft, act: &Act) {
    let mut parts = act.name.splitn(2, '.');
    let (what, rest) = (parts.next().unwrap_or(""), parts.next().unwrap_or(""));
    match what {
        "set" => draft.set(rest, act.value.clone()),
        "add" => {
            if let Some(rows) = rest
                .parse::<usize>()
                .ok()
                .and_then(|l| draft.bits.get_mut(l))
            {
                let next = rows.iter().filter_map(|r| r.bit.parse::<u8>().ok()).max();
                rows.push(BitRow {
                    bit: next.map_or(0, |bit| bit.saturating_add(1)).to_string(),
                    name: "New name".to_owned(),
                    ne107: String::new(),
                });
            }
        }
        "drop" | "bits" => {
            let mut parts = rest.split('.');
            let mut number = || parts.next().and_then(|p| p.parse::<usize>().ok());
            let (Some(list), Some(at)) = (number(), number()) else {
                return;
            };
            let Some(rows) = draft.bits.get_mut(list).filter(|rows| at < rows.len()) else {
                return;
            };
            if what == "drop" {
                rows.remove(at);
                return;
            }
            let (row, value) = (&mut rows[at], act.value.clone());
            match parts.next() {
                Some("bit") => row.bit = value,
                Some("name") => row.name = value,
                _ => row.ne107 = value,
            }
        }
        _ => {}
    }
}
