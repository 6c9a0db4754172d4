//! Demand and position over time, as they come.

use leptos::prelude::*;

use super::part;
use crate::chart::view::ChartView;
use crate::erased::memo;
use crate::hart::state::trend::chart;
use crate::hart::store::Store;

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
    part(move || {
        if has.get() {
            view! {
                <section class="hart-trend" data-testid="hart-trend">
                    <ChartView chart=picture/>
                </section>
            }
            .into_any()
        } else {
            view! { <p class="empty">"The chart begins with the second answer to command 3."</p> }
                .into_any()
        }
    })
}
