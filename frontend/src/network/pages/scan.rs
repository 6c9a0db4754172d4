//! How long does a scan take?

use std::sync::Arc;

use leptos::prelude::*;

use crate::components::drawn::{Act, Draw, Drawn};
use crate::markup::Markup;
use crate::network::markup::{head, scan};
use crate::network::state::scan::Scan;
use crate::network::store::Store;

/// The estimate, beside tables 4.1 and 4.2 and beside what is measured.
#[component]
pub(super) fn ScanPage() -> impl IntoView {
    let store = Store::get();
    let entered = RwSignal::new(store.net.with_untracked(|net| match net.shape {
        Some(_) => Scan::of(net),
        None => Scan::default(),
    }));
    let controls: Draw = Arc::new(move |html: &mut Markup| {
        scan::controls(html, &entered.get());
    });
    let result: Draw = Arc::new(move |html: &mut Markup| {
        let entered = entered.get();
        match entered.estimate() {
            Some(estimate) => scan::result(html, &entered, &estimate),
            None => {
                html.node("p", "notice", "So many registers can't be read at once.");
            }
        }
        store.net.with(|net| {
            if net.shape.is_some() {
                html.node("h3", "", "Measured on this network");
                head::passes(html, net);
            }
        });
    });
    let tables: Draw = Arc::new(move |html: &mut Markup| {
        let kind = entered.with(|scan| scan.kind);
        scan::tables(html, kind);
    });
    let on_act = Callback::new(move |act: Act| {
        entered.update(|scan| scan.set(&act.name, &act.value));
    });
    view! {
        <div class="net-page" data-testid="scan">
            <Drawn class="toolbar" draw=controls on_act=on_act/>
            <div class="scan-columns">
                <Drawn class="scan-result" draw=result/>
                <Drawn class="scan-tables" draw=tables/>
            </div>
        </div>
    }
}
