//! A device: overview, set-up, variables, status.

use std::sync::Arc;

use leptos::prelude::*;

use super::trend::Trend;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::Glyph;
use crate::hart::markup::{overview, setup, status, values};
use crate::hart::state::unit::Unit;
use crate::hart::store::Store;
use crate::markup::control::Button;
use crate::markup::{Markup, valve};

/// Draws a part from the device, what is opened, and the time.
type DrawUnit = fn(&mut Markup, &Unit, &[String], u64);

/// A part of a screen that follows the device; its values open on demand.
fn shown(store: Store, opened: RwSignal<Vec<String>>, make: DrawUnit) -> Draw {
    Arc::new(move |html: &mut Markup| {
        let (opened, now) = (opened.get(), store.now_us.get());
        store.unit.with(|unit| make(html, unit, &opened, now));
    })
}

/// Opens or closes the details of a value.
fn toggle(opened: RwSignal<Vec<String>>) -> Callback<Act> {
    Callback::new(move |act: Act| {
        let Some(key) = act.element.get_attribute("data-key") else {
            return;
        };
        opened.update(|all| match all.iter().position(|k| *k == key) {
            Some(at) => {
                all.remove(at);
            }
            None => all.push(key),
        });
    })
}

/// A button that reads again, and how far reading is.
pub(super) fn tools(store: Store) -> (Draw, Callback<Act>) {
    let draw: Draw = Arc::new(move |html: &mut Markup| {
        let (job, online) = (store.job.get(), store.online.get());
        Button {
            act: "read",
            testid: "hart-read",
            words: "Read again",
            glyph: Some(Glyph::Poll),
            disabled: job.is_running() || !online,
            ..Button::default()
        }
        .draw(html);
        html.open(
            "span",
            &[
                ("class", "quiet"),
                ("role", "status"),
                ("data-testid", "hart-job"),
            ],
        );
        if job.is_running() {
            html.text(&format!(
                "{} of {} commands {}",
                job.done, job.total, job.text
            ));
        } else {
            html.text(&job.text);
        }
        html.close("span");
        Button {
            act: "cancel",
            testid: "hart-cancel",
            words: "Cancel",
            hidden: !job.is_running(),
            ..Button::default()
        }
        .draw(html);
    });
    let on_act = Callback::new(move |act: Act| match act.name.as_str() {
        "cancel" => store.cancel(store.job),
        _ => store.read_again(),
    });
    (draw, on_act)
}

/// What the valve does, and whether it is healthy.
#[component]
pub(super) fn OverviewPage() -> impl IntoView {
    let store = Store::get();
    let opened = RwSignal::new(Vec::new());
    let picture = shown(store, opened, |html, unit, _, now| {
        valve::valve(html, &overview::picture(unit, now));
    });
    let figures = shown(store, opened, overview::figures);
    let health = shown(store, opened, |html, unit, _, _| {
        overview::health(html, unit);
    });
    let (tools, on_act) = tools(store);
    view! {
        <div class="hart-page" data-testid="hart-overview">
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <div class="overview">
                <Drawn class="overview-valve" draw=picture/>
                <Drawn class="overview-figures" draw=figures on_act=toggle(opened)/>
                <Drawn class="overview-conditions" draw=health/>
            </div>
            <Trend/>
        </div>
    }
}

/// HART set-up, loop configuration, review and versions, as read; and what can't be read.
#[component]
pub(super) fn SetupPage() -> impl IntoView {
    let store = Store::get();
    let opened = RwSignal::new(Vec::new());
    let draw = shown(store, opened, setup::setup);
    let (tools, on_act) = tools(store);
    view! {
        <div class="hart-page" data-testid="hart-setup">
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="hart-groups" draw=draw on_act=toggle(opened)/>
        </div>
    }
}

/// Dynamic and device variables with their status.
#[component]
pub(super) fn VariablesPage() -> impl IntoView {
    let store = Store::get();
    let opened = RwSignal::new(Vec::new());
    let draw = shown(store, opened, values::variables);
    let (tools, on_act) = tools(store);
    view! {
        <div class="hart-page" data-testid="hart-variables">
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="hart-groups" draw=draw on_act=toggle(opened)/>
        </div>
    }
}

/// All status bits with their names.
#[component]
pub(super) fn StatusPage() -> impl IntoView {
    let store = Store::get();
    let draw: Draw = Arc::new(move |html: &mut Markup| {
        let now = store.now_us.get();
        store.unit.with(|unit| status::status(html, unit, now));
    });
    let (tools, on_act) = tools(store);
    view! {
        <div class="hart-page" data-testid="hart-status">
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="" draw=draw/>
        </div>
    }
}
