//! Light, dark, or as the system has it.

use leptos::prelude::*;

use crate::browser::{remember, remembered};

/// What the user chose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// As the system has it.
    #[default]
    System,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

impl Theme {
    /// All choices.
    pub const ALL: [Self; 3] = [Self::System, Self::Light, Self::Dark];

    /// The word that is remembered.
    #[must_use]
    pub const fn key(self) -> &'static str {
        match self {
            Self::System => "system",
            Self::Light => "light",
            Self::Dark => "dark",
        }
    }

    /// The word on the switch.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::System => "As the system",
            Self::Light => "Light",
            Self::Dark => "Dark",
        }
    }
}

/// The theme of the page.
#[derive(Clone, Copy, Debug)]
pub struct ThemeChoice(pub RwSignal<Theme>);

/// Applies the remembered theme and every change of it.
pub fn provide_theme() {
    let stored = remembered("theme");
    let first = Theme::ALL
        .into_iter()
        .find(|t| stored.as_deref() == Some(t.key()))
        .unwrap_or_default();
    let theme = RwSignal::new(first);
    provide_context(ThemeChoice(theme));
    Effect::new(move |before: Option<Theme>| {
        let theme = theme.get();
        if let Some(root) = document().document_element() {
            // Fails only for names that are none.
            let _infallible = match theme {
                Theme::System => root.remove_attribute("data-theme"),
                _ => root.set_attribute("data-theme", theme.key()),
            };
        }
        if before.is_some_and(|b| b != theme) {
            remember("theme", theme.key());
        }
        theme
    });
}
