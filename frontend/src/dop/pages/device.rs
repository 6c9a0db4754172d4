//! The settings that hold for a device.

use std::sync::Arc;

use leptos::prelude::*;

use super::save;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::Glyph;
use crate::dop::markup::profile;
use crate::dop::store::Store;
use crate::markup::Markup;
use crate::markup::control::Button;

/// The profile as the backend has it, what is assumed, and what was learned.
#[component]
pub(super) fn SettingsPage() -> impl IntoView {
    let store = Store::get();
    let head: Draw = Arc::new(move |html: &mut Markup| {
        store.site.with(|site| {
            let name = if site.profile.name.is_empty() { "without a name" } else { &site.profile.name };
            html.node("h2", "", &format!("Profile {name}"));
            html.node(
                "p",
                "quiet",
                "These settings are in the profile file that the configuration of the bridge names. \
                 Edit a copy here, save it, and put it in its place. What nobody set is assumed and \
                 marked so wherever it decides.",
            );
            if !site.known {
                html.node("p", "notice", "The bridge has not told the profile yet.");
            }
        });
        Button {
            act: "edit",
            testid: "edit-profile",
            words: "Edit a copy",
            glyph: Some(Glyph::Settings),
            ..Button::default()
        }
        .draw(html);
        html.text(" ");
        Button {
            act: "save",
            testid: "save-profile",
            words: "Save as file",
            glyph: Some(Glyph::Save),
            ..Button::default()
        }
        .draw(html);
    });
    let settings: Draw = Arc::new(move |html: &mut Markup| {
        store
            .site
            .with(|site| profile::settings(html, &site.profile, site.shift));
    });
    let on_act = Callback::new(move |act: Act| {
        let profile = store.site.with_untracked(|site| Arc::clone(&site.profile));
        if act.name == "edit" {
            store.set_own((*profile).clone());
            store.go("#/dop/profile");
        } else {
            save(
                &format!("profile-{}", profile.name),
                "json",
                &profile.to_json(),
            );
        }
    });
    view! {
        <div class="dop-page dop-settings">
            <Drawn class="settings-head" draw=head on_act=on_act/>
            <Drawn class="settings-list" draw=settings/>
        </div>
    }
}
