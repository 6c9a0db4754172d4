//! Screens that are drawn as they are read: configuration, communication, identity, health.

use std::sync::Arc;

use leptos::prelude::*;
use shared::icon3000::identity::PROBES;
use shared::proto::{Block, TableName};

use super::{charts, save};
use crate::actuator::markup::configuration::{self, Filter};
use crate::actuator::markup::rows::{Around, list};
use crate::actuator::markup::{
    communication, heading, health as markup_health, identity, tools, words,
};
use crate::actuator::state::dossier::{Dossier, Subject};
use crate::actuator::state::wanted::{COUNTERS, Wanted};
use crate::actuator::state::{health, logs, rates, saved};
use crate::actuator::store::Store;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::erased::{effect, memo};
use crate::markup::Markup;

/// The keys of lines that are open.
type Opened = RwSignal<Vec<&'static str>>;

fn around(store: Store, opened: Opened, settings: bool) -> Around {
    Around {
        opened: opened.get(),
        now: if store.is_live() {
            store.now_us.get()
        } else {
            0
        },
        settings,
        ..Around::default()
    }
}

/// Opens or closes a line of a device.
fn toggle(store: Store, opened: Opened, act: &Act) {
    let key = act.element.get_attribute("data-key").unwrap_or_default();
    let row = store.with(|d| {
        let map = d.device.map()?;
        map.rows
            .iter()
            .find(|row| row.key == key)
            .map(|row| row.key)
    });
    if let Some(key) = row {
        opened.update(|opened| match opened.iter().position(|k| *k == key) {
            Some(at) => {
                opened.remove(at);
            }
            None => opened.push(key),
        });
    }
}

/// Reads what a screen shows when it is seen for the first time.
pub(super) fn fill_once(store: Store, wanted: fn(&Dossier) -> Wanted) {
    let ready = memo(move || {
        let known = store
            .site
            .with(|s| s.dossier.device.is_icon() && s.shown_job().is_none());
        store.is_live() && store.online.get() && known
    });
    let asked = StoredValue::new(String::new());
    effect(move || {
        let tag = store.tag.get();
        if ready.get() && asked.with_value(|t| *t != tag) {
            asked.set_value(tag);
            let wanted = store.site.with_untracked(|s| wanted(&s.dossier));
            store.fill(wanted);
        }
    });
}

/// The line of buttons above a screen, or where its data are from.
pub(super) fn toolbar(store: Store, what: &'static [(&'static str, &'static str)]) -> Draw {
    Arc::new(move |html: &mut Markup| {
        if store.is_live() {
            let (online, now) = (store.online.get(), store.now_us.get());
            store
                .site
                .with(|site| tools::reads(html, site, online, now, what));
        } else {
            store.with(|d| tools::origin(html, d));
        }
    })
}

/// Cancels, goes on, or reads; true if it was one of them.
pub(super) fn on_tool(store: Store, act: &Act, wanted: fn(&Dossier) -> Wanted) -> bool {
    match act.name.as_str() {
        "cancel" => store.cancel(),
        "resume" => store.resume(),
        "whole" => {
            let wanted = store
                .site
                .with_untracked(|s| Wanted::everything(&s.dossier));
            store.read(wanted);
        }
        "save" => {
            let now = store.now.get_untracked();
            let saved = store.site.try_update(|site| {
                // What is not whole is saved at the second time of asking.
                site.saving = !site.saving && !saved::gaps(&site.dossier).is_empty();
                let saved = || saved::snapshot(&site.dossier, now);
                (!site.saving).then(saved).flatten()
            });
            if let Some(saved) = saved.flatten() {
                let name = format!("{}-snapshot", saved.tag);
                save(&name, "json", &saved.to_text());
            }
        }
        "read" => {
            let wanted = store.site.with_untracked(|s| wanted(&s.dossier));
            store.read(wanted);
        }
        _ => return false,
    }
    true
}

fn failures(store: Store, shows: fn(Subject) -> bool) -> Draw {
    Arc::new(move |html: &mut Markup| store.with(|d| tools::failures(html, d, shows)))
}

fn all_settings(dossier: &Dossier) -> Wanted {
    Wanted {
        what: "settings".to_owned(),
        ..Wanted::default()
    }
    .rows(&configuration::writable(dossier))
    .registers(dossier, &words::REGISTERS)
    .rows(&health::inputs(dossier))
}

/// All that can be set.
#[component]
pub(super) fn ConfigurationPage() -> impl IntoView {
    let store = Store::get();
    let filter = RwSignal::new(Filter::default());
    let opened: Opened = RwSignal::new(Vec::new());
    fill_once(store, all_settings);
    let filters: Draw = Arc::new(move |html: &mut Markup| {
        filter.with(|f| store.with(|d| configuration::filters(html, d, f)));
    });
    let level: Draw = Arc::new(move |html: &mut Markup| {
        store.with(|d| {
            configuration::logged_in(html, d);
            heading(html, "In words", "");
            words::words(html, d, store.now.get());
            heading(html, "Settings", "as the groups of the manual");
        });
    });
    let settings: Draw = Arc::new(move |html: &mut Markup| {
        let around = around(store, opened, true);
        filter.with(|f| store.with(|d| configuration::settings(html, d, f, &around)));
    });
    let on_act = Callback::new(move |act: Act| {
        if on_tool(store, &act, all_settings) {
            return;
        }
        match act.name.as_str() {
            "text" => filter.update(|f| f.text = act.value),
            "group" => filter.update(|f| f.group = act.value),
            "marked" => filter.update(|f| f.marked = !act.value.is_empty()),
            _ => toggle(store, opened, &act),
        }
    });
    view! {
        <div class="icon-page" data-testid="page-configuration">
            <Drawn class="toolbar" draw=toolbar(store, &[("read", "Read settings")]) on_act=on_act/>
            <Drawn class="icon-failed" draw=failures(store, |s| matches!(s, Subject::Block(..)))/>
            <Drawn class="icon-intro" draw=level/>
            <Drawn class="toolbar filters" draw=filters on_act=on_act/>
            <Drawn class="icon-groups" draw=settings on_act=on_act/>
        </div>
    }
}

fn channels(dossier: &Dossier) -> Wanted {
    Wanted {
        what: "channels".to_owned(),
        counters: COUNTERS.to_vec(),
        ..Wanted::default()
    }
    .rows(&communication::all_registers(dossier))
}

/// How often health, and the counters while that is on, are read anew, in seconds.
const PERIOD: i64 = 5;

/// The Modbus interface of the device.
#[component]
pub(super) fn CommunicationPage() -> impl IntoView {
    let store = Store::get();
    let opened: Opened = RwSignal::new(Vec::new());
    let watched = RwSignal::new(false);
    fill_once(store, channels);
    effect(move || {
        let due = store.now.get() % PERIOD == 0;
        if due && watched.get_untracked() {
            store.read(Wanted {
                counters: COUNTERS.to_vec(),
                quiet: true,
                ..Wanted::default()
            });
        }
    });
    let counters: Draw = Arc::new(move |html: &mut Markup| {
        let now = store.now.get();
        store.with(|d| communication::counters(html, d, now));
    });
    let watch: Draw = Arc::new(move |html: &mut Markup| {
        if store.is_live() {
            let rounds = store.with(|d| d.counters.get(&COUNTERS[0]).map_or(0, Vec::len));
            communication::watch(html, watched.get(), rounds);
        }
    });
    let pictures = memo(move || store.with(|d| rates::chart(d).into_iter().collect::<Vec<_>>()));
    let lines: Draw = Arc::new(move |html: &mut Markup| {
        let around = around(store, opened, false);
        heading(html, "Channels", "");
        store.with(|d| list(html, d, &communication::registers(d), &around));
    });
    let on_act = Callback::new(move |act: Act| {
        if on_tool(store, &act, channels) {
            return;
        }
        match act.name.as_str() {
            "watch" => watched.set(!act.value.is_empty()),
            _ => toggle(store, opened, &act),
        }
    });
    view! {
        <div class="icon-page" data-testid="page-communication">
            <Drawn class="toolbar" draw=toolbar(store, &[("read", "Read counters")]) on_act=on_act/>
            <Drawn
                class="icon-failed"
                draw=failures(store, |s| matches!(s, Subject::Block(..) | Subject::Diagnostic(_)))
            />
            <Drawn class="icon-body" draw=counters/>
            <Drawn class="icon-body" draw=watch on_act=on_act/>
            <div class="icon-body">{charts(pictures)}</div>
            <Drawn class="icon-groups" draw=lines on_act=on_act/>
        </div>
    }
}

fn who(dossier: &Dossier) -> Wanted {
    let mut wanted = Wanted {
        what: "identity".to_owned(),
        identity: true,
        files: (5300..=5304).collect(),
        ..Wanted::default()
    }
    .rows(&dossier.rows(&identity::is_told));
    // Each by itself, whatever the map says: whether they answer tells the model.
    wanted.blocks.extend(PROBES.map(|start| Block {
        table: TableName::Holding,
        start,
        count: 1,
    }));
    wanted
}

/// Who the device is.
#[component]
pub(super) fn IdentityPage() -> impl IntoView {
    drawn_page(
        "page-identity",
        &[("read", "Read identity")],
        who,
        |s| match s {
            Subject::File(file) => (5300..=5304).contains(&file),
            Subject::Identity | Subject::Block(..) => true,
            Subject::Diagnostic(_) => false,
        },
        |html, store, dossier| identity::identity(html, dossier, store.now.get()),
    )
}

fn what_is_wrong(dossier: &Dossier) -> Wanted {
    Wanted {
        what: "health".to_owned(),
        files: vec![2, 3],
        ..Wanted::default()
    }
    .rows(&health::rows(dossier))
    .rows(&logs::rows(dossier))
}

/// What is wrong with the device.
#[component]
pub(super) fn HealthPage() -> impl IntoView {
    let store = Store::get();
    // As the page around does, so that both say the same.
    effect(move || {
        let due = store.now.get() % PERIOD == 0;
        if due && store.is_live() && !document().hidden() {
            let rows = store.site.with_untracked(|s| health::rows(&s.dossier));
            let quiet = Wanted {
                quiet: true,
                ..Wanted::default()
            };
            store.read(quiet.rows(&rows));
        }
    });
    drawn_page(
        "page-health",
        &[("read", "Read health")],
        what_is_wrong,
        |s| matches!(s, Subject::File(2 | 3) | Subject::Block(..)),
        |html, store, dossier| {
            let now = store.now.get();
            markup_health::health(html, dossier, &store.address("logs", ""), now);
        },
    )
}

/// A screen that is drawn from the device alone.
fn drawn_page(
    testid: &'static str,
    what: &'static [(&'static str, &'static str)],
    wanted: fn(&Dossier) -> Wanted,
    shows: fn(Subject) -> bool,
    draw: fn(&mut Markup, Store, &Dossier),
) -> AnyView {
    let store = Store::get();
    fill_once(store, wanted);
    let body: Draw = Arc::new(move |html: &mut Markup| store.with(|d| draw(html, store, d)));
    let on_act = Callback::new(move |act: Act| {
        on_tool(store, &act, wanted);
    });
    view! {
        <div class="icon-page" data-testid=testid>
            <Drawn class="toolbar" draw=toolbar(store, what) on_act=on_act/>
            <Drawn class="icon-failed" draw=failures(store, shows)/>
            <Drawn class="icon-groups" draw=body/>
        </div>
    }
    .into_any()
}
