//! A unit of a network.

use std::sync::Arc;
use std::time::Duration;

use leptos::prelude::*;
use shared::capture::Micros;
use shared::ddc100::Pair;
use shared::ddc100::checklist::{Moment, checklist};
use shared::ddc100::command::parts;
use shared::ddc100::scaling::Scaling;
use shared::frame::Framing;
use shared::proto::{Block, TableName};

use crate::components::drawn::{Act, Draw, Drawn};
use crate::erased::effect;
use crate::markup::Markup;
use crate::network::markup::cards::{Cards, differences};
use crate::network::markup::{check, counters, unit};
use crate::network::state::net::{Net, Unit};
use crate::network::state::unit::Judged;
use crate::network::state::wish;
use crate::network::store::Store;

/// How often registers are read that polls may leave out.
const WATCH: Duration = Duration::from_secs(5);

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
        let now = (now, store.online.get());
        store
            .tags
            .with(|tags| unit::head(html, &bus, net, (of, judged), tags, now));
    });
    let faults = draw(|html, store, net, of, judged| {
        unit::faults(html, net, judged, &cards_of(store, net, of));
    });
    let check: Draw = Arc::new(move |html: &mut Markup| {
        let (wanted, percent, now) = (wanted.get(), percent.get(), store.now_us.get());
        let online = store.online.get();
        with_unit(store, |net, of, _| {
            let choices = wish::choices(of.device);
            check::wishes(html, &choices, &wanted, percent);
            let known = choices.iter().any(|(key, _)| *key == wanted);
            let Some(wish) = wish::from_key(&wanted, percent).filter(|_| known) else {
                html.node("p", "quiet", "Choose what the unit should do.");
                return;
            };
            let faults = Pair {
                one: of.fault[0],
                two: of.fault[1],
            };
            let chosen = store.tags.with(|tags| tags.chosen(of.info.unit, 8));
            let scaling = of.said_scaling(chosen);
            let moment = Moment {
                now: Micros::new(now),
                most: net.values_last_us(),
                online,
            };
            let list = checklist(of.device, &of.image, faults, scaling, moment, wish);
            check::checklist(html, &list, now);
            let framing = Framing::from_key(&net.framing).unwrap_or(Framing::Rtu);
            check::frame(html, &parts(of.device, framing, of.info.unit, wish));
        });
    });
    let cards = draw(|html, store, net, of, judged| {
        let view = &judged.view;
        let cards = cards_of(store, net, of);
        store.tags.with(|tags| cards.analog(html, view, tags));
        for (title, testid, numbers, bits) in [
            ("Status", "status", &[9, 16][..], &view.status),
            ("Digital inputs", "inputs", &[12, 13], &view.inputs),
            ("Digital outputs", "outputs", &[11], &view.outputs),
            ("Timers and analog channels", "timers", &[14], &view.timers),
            ("User faults", "user-faults", &[15], &view.user_faults),
        ] {
            cards.bits(html, (title, testid), numbers, bits);
        }
        differences(html, of.device, view);
        counters::counters(html, of, store.online.get(), store.now_us.get());
    });
    let reading = draw(|html, store, net, of, _| {
        unit::reading(html, of.info.unit, net, store.online.get());
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
    // At once for each unit, and every few seconds while it is shown.
    let look = move || {
        if let Some(unit) = address(store) {
            store.watch(unit);
        }
    };
    effect(move || {
        if store.tag.with(|tag| !tag.is_empty()) && store.online.get() {
            look();
        }
    });
    let timer = set_interval_with_handle(look, WATCH);
    on_cleanup(move || {
        if let Ok(timer) = timer {
            timer.clear();
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

/// What the cards of a unit have in common now.
fn cards_of<'a>(store: Store, net: &Net, of: &'a Unit) -> Cards<'a> {
    let stale = unit::is_stale(net, of, store.online.get());
    Cards::of(net, of, store.now_us.get(), stale)
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
