//! Demand and position over time, as they come.

use std::sync::Arc;

use leptos::prelude::*;

use super::part;
use crate::chart::Chart;
use crate::chart::view::ChartView;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::erased::memo;
use crate::hart::state::trend::chart;
use crate::hart::store::Store;
use crate::markup::Markup;
use crate::markup::control::Button;

/// Demand and position, and torque below them.
#[component]
pub(super) fn Trend() -> impl IntoView {
    let store = Store::get();
    let (start, _) = store.times();
    let has = memo(move || store.unit.with(|u| u.trend.len() > 1));
    let picture = memo(move || {
        store
            .unit
            .with(|u| chart(u.trend.iter(), u.family, start / 1000))
    });
    // A picture that stands still can be zoomed and read.
    let held = RwSignal::new(None::<Chart>);
    let shown = memo(move || held.get().unwrap_or_else(|| picture.get()));
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let is_held = held.with(Option::is_some);
        Button {
            act: "hold",
            testid: "hart-hold",
            words: if is_held { "Go on" } else { "Hold the chart" },
            pressed: Some(is_held),
            ..Button::default()
        }
        .draw(html);
    });
    let on_act = Callback::new(move |_: Act| {
        let next = held
            .with_untracked(Option::is_none)
            .then(|| picture.get_untracked());
        held.set(next);
    });
    part(move || {
        if has.get() {
            view! {
                <section class="hart-trend" data-testid="hart-trend">
                    <Drawn class="" draw=Arc::clone(&tools) on_act=on_act/>
                    <ChartView chart=shown/>
                </section>
            }
            .into_any()
        } else {
            view! { <p class="empty">"The chart begins with the second answer to command 3."</p> }
                .into_any()
        }
    })
}
