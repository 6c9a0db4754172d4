//! Screens that show registers: configuration, communication, identity.

use std::sync::Arc;

use leptos::prelude::*;
use shared::map::row::Row;

use crate::actuator::markup::configuration::{self, Filter};
use crate::actuator::markup::rows::{Around, list};
use crate::actuator::markup::{communication, identity, tools};
use crate::actuator::state::dossier::{Dossier, Subject};
use crate::actuator::state::wanted::{COUNTERS, Wanted};
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
            .with(|s| s.dossier.device.is_icon() && s.job.is_none());
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
    let mut wanted = Wanted {
        what: "settings".to_owned(),
        ..Wanted::default()
    }
    .rows(configuration::writable(dossier).into_iter());
    if let Some(map) = dossier.device.map() {
        let level = map.rows.iter().copied().filter(|r| r.address.get() == 3480);
        wanted = wanted.rows(level);
    }
    wanted
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
        store.with(|d| configuration::logged_in(html, d));
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
    .rows(communication::registers(dossier).into_iter())
}

/// The Modbus interface of the device.
#[component]
pub(super) fn CommunicationPage() -> impl IntoView {
    let store = Store::get();
    fill_once(store, channels);
    registers_page(
        store,
        "page-communication",
        &[("read", "Read counters")],
        channels,
        communication::registers,
        |s| !matches!(s, Subject::File(_) | Subject::Identity),
    )
}

fn who(dossier: &Dossier) -> Wanted {
    Wanted {
        what: "identity".to_owned(),
        identity: true,
        ..Wanted::default()
    }
    .rows(identity::registers(dossier).into_iter())
}

/// Who the device is.
#[component]
pub(super) fn IdentityPage() -> impl IntoView {
    let store = Store::get();
    fill_once(store, who);
    registers_page(
        store,
        "page-identity",
        &[("read", "Read identity")],
        who,
        identity::registers,
        |s| !matches!(s, Subject::Diagnostic(_)),
    )
}

/// A screen that is a list of registers.
fn registers_page(
    store: Store,
    testid: &'static str,
    what: &'static [(&'static str, &'static str)],
    wanted: fn(&Dossier) -> Wanted,
    rows: fn(&Dossier) -> Vec<&'static Row>,
    shows: fn(Subject) -> bool,
) -> AnyView {
    let opened: Opened = RwSignal::new(Vec::new());
    let lines: Draw = Arc::new(move |html: &mut Markup| {
        let around = around(store, opened, false);
        store.with(|d| list(html, d, &rows(d), &around));
    });
    let on_act = Callback::new(move |act: Act| {
        if !on_tool(store, &act, wanted) {
            toggle(store, opened, &act);
        }
    });
    view! {
        <div class="icon-page" data-testid=testid>
            <Drawn class="toolbar" draw=toolbar(store, what) on_act=on_act/>
            <Drawn class="icon-failed" draw=failures(store, shows)/>
            <Drawn class="icon-groups" draw=lines on_act=on_act/>
        </div>
    }
    .into_any()
}
