//! How the page looks, where its facts come from, and what keys there are.

use std::sync::Arc;

use leptos::prelude::*;

use crate::browser::is_file;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::markup::{Markup, about};
use crate::theme::{Theme, ThemeChoice};

/// Settings and facts about the program.
#[component]
pub fn SettingsPage() -> impl IntoView {
    let ThemeChoice(theme) = expect_context();
    let draw: Draw =
        Arc::new(move |html: &mut Markup| about::settings(html, theme.get(), is_file()));
    let on_act = Callback::new(move |act: Act| {
        let chosen = Theme::ALL.into_iter().find(|t| t.key() == act.value);
        theme.set(chosen.unwrap_or_default());
    });
    view! { <Drawn class="page settings" draw=draw on_act=on_act testid="page-settings"/> }
}
