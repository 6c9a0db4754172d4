//! A unit of a network.

use std::sync::Arc;

use leptos::prelude::*;
use shared::ddc100::Pair;
use shared::ddc100::checklist::checklist;
use shared::ddc100::scaling::Scaling;
use shared::proto::{Block, TableName};

use crate::components::drawn::{Act, Draw, Drawn};
use crate::markup::Markup;
use crate::network::markup::{counters, unit};
use crate::network::state::net::{Net, Unit};
use crate::network::state::unit::Judged;
use crate::network::state::wish;
use crate::network::store::Store;

/// Draws a part from the network, the unit and what it says.
type DrawUnit = fn(&mut Markup, Store, &Net, &Unit, &Judged);

/// The unit whose tag the address names.
#[component]
pub(super) fn UnitPage() -> impl IntoView {
    let store = Store::get();
    let wanted = RwSignal::new("open".to_owned());
    let percent = RwSignal::new(50_u8);
    let draw = move |make: DrawUnit| -> Draw {
        Arc::new(move |html: &mut Markup| with_unit(store, |n, u, j| make(html, store, n, u, j)))
    };
    let head = draw(|html, store, net, of, judged| {
        let now = store.now_us.get();
        let bus = store.bus.get();
        store
            .tags
            .with(|tags| unit::head(html, &bus, net, (of, judged), tags, now));
    });
    let faults = draw(|html, _, _, of, judged| unit::faults(html, of, judged));
    let check: Draw = Arc::new(move |html: &mut Markup| {
        let (wanted, percent, now) = (wanted.get(), percent.get(), store.now_us.get());
        with_unit(store, |_, of, _| {
            let choices = wish::choices(of.device);
            unit::wishes(html, &choices, &wanted, percent);
            let known = choices.iter().any(|(key, _)| *key == wanted);
            let Some(wish) = wish::from_key(&wanted, percent).filter(|_| known) else {
                html.node("p", "quiet", "Choose what the unit should do.");
                return;
            };
            let faults = Pair {
                one: of.fault[0],
                two: of.fault[1],
            };
            let scaling = store.tags.with(|tags| tags.scaling(of.info.unit));
            let list = checklist(of.device, &of.image, faults, scaling, wish);
            unit::checklist(html, &list, now);
        });
    });
    let cards = draw(|html, store, _, of, judged| {
        let scaling = store.tags.with(|tags| tags.scaling(of.info.unit));
        let view = &judged.view;
        unit::analog(html, view, scaling);
        unit::bits(html, "Status", "status", &view.status);
        unit::bits(html, "Digital inputs", "inputs", &view.inputs);
        unit::bits(html, "Digital outputs", "outputs", &view.outputs);
        unit::bits(html, "Timers and analog channels", "timers", &view.timers);
        unit::bits(html, "User faults", "user-faults", &view.user_faults);
        unit::differences(html, of.device);
        counters::counters(html, of, store.online.get(), store.now_us.get());
    });
    let reading = draw(|html, store, net, of, _| {
        unit::reading(html, of.info.unit, net.asked.as_ref(), store.online.get());
    });
    let registers = draw(|html, store, _, of, _| {
        unit::registers(html, of, store.now_us.get());
    });
    let on_act = Callback::new(move |act: Act| match act.name.as_str() {
        "wish" => wanted.set(act.value),
        "percent" => {
            if let Ok(to) = act.value.parse() {
                percent.set(to);
            }
        }
        "scaling" => {
            let (Some(scaling), Some(unit)) = (Scaling::from_key(&act.value), address(store))
            else {
                return;
            };
            let mut tags = store.tags.get_untracked();
            tags.set_scaling(unit, scaling);
            store.set_tags(tags);
        }
        "counters" => {
            if let Some(unit) = address(store) {
                store.read_counters(unit);
            }
        }
        _ => {
            if let Some(unit) = address(store) {
                let block = Block {
                    table: TableName::Holding,
                    start: 0,
                    count: unit::REGISTERS,
                };
                store.read(unit, block);
            }
        }
    });
    view! {
        <div class="net-page unit-page" data-testid="unit">
            <Drawn class="unit-top" draw=head/>
            <div class="unit-columns">
                <Drawn class="unit-card" draw=faults/>
                <Drawn class="unit-card" draw=check on_act=on_act testid="checklist"/>
            </div>
            <Drawn class="unit-cards" draw=cards on_act=on_act/>
            <Drawn class="toolbar unit-reading" draw=reading on_act=on_act/>
            <Drawn class="unit-register-list" draw=registers/>
        </div>
    }
}

/// Calls `with` with the unit that is shown, if the network has it.
fn with_unit(store: Store, with: impl FnOnce(&Net, &Unit, &Judged)) {
    let tag = store.tag.get();
    store.net.with(|net| {
        store.judged.with(|judged| {
            let all = net.units.iter().zip(judged);
            if let Some((unit, judged)) = all.into_iter().find(|(u, _)| u.info.tag == tag) {
                with(net, unit, judged);
            }
        });
    });
}

/// Its address.
fn address(store: Store) -> Option<u8> {
    let tag = store.tag.get_untracked();
    let found = |net: &Net| {
        net.units
            .iter()
            .find(|u| u.info.tag == tag)
            .map(|u| u.info.unit)
    };
    store.net.with_untracked(found)
}
