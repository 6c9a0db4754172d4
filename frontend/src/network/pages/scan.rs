//! How long does a scan take?

use std::sync::Arc;

use leptos::prelude::*;
use shared::device::Device;

use crate::components::drawn::{Act, Draw, Drawn};
use crate::markup::Markup;
use crate::network::markup::{head, scan};
use crate::network::state::scan::{Scan, table_4_2, types};
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
        let here = store.net.with(types);
        scan::controls(html, &entered.get(), &here);
    });
    let result: Draw = Arc::new(move |html: &mut Markup| {
        let entered = entered.get();
        store.net.with(|net| {
            let whole = entered.mixed(net).filter(|_| entered.kind.is_none());
            match (entered.estimate(), whole) {
                (Some(estimate), _) => scan::result(html, &entered, &estimate),
                (None, Some(mixed)) => {
                    scan::mixed(html, &entered, (&types(net), mixed), &table_4_2(net));
                }
                (None, None) => {
                    html.node("p", "notice", "So many registers can't be read at once.");
                }
            }
            if net.shape.is_some() {
                html.node("h3", "", "Measured on this network");
                head::passes(html, net);
            }
        });
    });
    let tables: Draw = Arc::new(
        move |html: &mut Markup| match entered.with(|scan| scan.kind) {
            Some(kind) => scan::tables(html, kind),
            None => {
                scan::tables(html, Device::Ddc100Mx);
                scan::tables(html, Device::Ddc100Uec);
            }
        },
    );
    let on_act = Callback::new(move |act: Act| {
        entered.update(|scan| match (act.name.as_str(), act.value.as_str()) {
            ("kind", "here") => {
                scan.kind = None;
                scan.units = store.net.with_untracked(|net| Scan::of(net).units);
            }
            (name, value) => scan.set(name, value),
        });
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
