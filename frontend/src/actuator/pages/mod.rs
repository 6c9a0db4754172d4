//! The program's screens.

mod curves;
mod logs;
mod registers;
mod snapshots;

use std::sync::Arc;

use leptos::prelude::*;

use super::store::Store;
use crate::chart::view::ChartView;
use crate::chart::{Axis, Chart};
use crate::components::drawn::{Draw, Drawn};
use crate::erased::memo;
use crate::markup::Markup;

/// Tabs of a saved device.
const TABS: [(&str, &str); 6] = [
    ("curves", "Curves"),
    ("logs", "Logs"),
    ("health", "Health"),
    ("identity", "Identity"),
    ("communication", "Communication"),
    ("configuration", "Configuration"),
];

/// The program: a device on the line, or saved ones.
#[component]
pub fn Actuator() -> impl IntoView {
    let store = Store::provide();
    let open = memo(move || {
        let tab = store.tab.get();
        let known = TABS.iter().any(|(key, _)| *key == tab);
        if known { tab } else { String::new() }
    });
    let tabs: Draw = Arc::new(move |html: &mut Markup| {
        // Those of a device on the line are drawn by the page.
        if store.is_live() {
            return;
        }
        let open = open.get();
        tab(html, "#/snapshots", "", "Snapshots", open.is_empty());
        if store.saved.with(Vec::is_empty) {
            return;
        }
        for (key, label) in TABS {
            tab(html, &store.address(key, ""), key, label, key == open);
        }
    });
    let body = part(move || match open.get().as_str() {
        "communication" => view! { <registers::CommunicationPage/> }.into_any(),
        "configuration" => view! { <registers::ConfigurationPage/> }.into_any(),
        "curves" => view! { <curves::CurvesPage/> }.into_any(),
        "logs" => view! { <logs::LogsPage/> }.into_any(),
        "health" => view! { <registers::HealthPage/> }.into_any(),
        "identity" => view! { <registers::IdentityPage/> }.into_any(),
        _ => view! { <snapshots::SnapshotsPage/> }.into_any(),
    });
    view! {
        <div class="icon3000" data-testid="icon">
            <Drawn class="tabs icon-tabs" role="tablist" label="Saved device" draw=tabs/>
            {body}
        </div>
    }
}

fn tab(html: &mut Markup, href: &str, key: &str, label: &str, open: bool) {
    html.open(
        "a",
        &[
            ("class", "tab"),
            ("role", "tab"),
            ("href", href),
            ("data-testid", "icon-tab"),
            ("data-tab", key),
            ("aria-selected", if open { "true" } else { "false" }),
        ],
    );
    html.text(label).close("a");
}

/// A part of a view that changes, behind a box: Leptos would compile the machinery around each such
/// closure anew.
fn part(make: impl Fn() -> AnyView + Send + 'static) -> AnyView {
    let make: Box<dyn Fn() -> AnyView + Send> = Box::new(make);
    make.into_any()
}

/// Charts below each other.
fn charts(charts: Memo<Vec<Chart>>) -> AnyView {
    // As text, for which there are memos already.
    let count = memo(move || charts.with(Vec::len).to_string());
    part(move || {
        let all: Vec<AnyView> = (0..count.get().parse::<usize>().unwrap_or(0))
            .map(|at| {
                let chart = Signal::derive(move || {
                    charts.with(|all| all.get(at).cloned().unwrap_or_else(none))
                });
                view! { <ChartView chart=chart/> }.into_any()
            })
            .collect();
        all.into_any()
    })
}

/// What stands where a chart was, until the list is drawn anew.
fn none() -> Chart {
    Chart {
        key: String::new(),
        title: String::new(),
        x: Axis::number("", ""),
        y: Axis::number("", ""),
        series: Vec::new(),
        bands: Vec::new(),
        notes: Vec::new(),
    }
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
