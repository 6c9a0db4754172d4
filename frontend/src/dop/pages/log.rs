//! The logs of a device.

use std::sync::Arc;

use leptos::prelude::*;

use super::save;
use crate::browser::Narrow;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::windowed::{DrawRow, Windowed};
use crate::dop::markup::logs;
use crate::dop::state::logs::{EVENTS, Filter, MOVEMENTS, csv, json};
use crate::dop::store::Store;
use crate::erased::memo;
use crate::markup::Markup;

/// The event log or the movement log.
#[component]
pub(super) fn LogsPage() -> impl IntoView {
    let store = Store::get();
    let narrow = use_context::<Narrow>();
    let moves = memo(move || {
        store
            .query("log")
            .is_some_and(|log| log == MOVEMENTS.to_string())
    });
    let object = move || if moves.get() { MOVEMENTS } else { EVENTS };
    let object_now = move || {
        if moves.get_untracked() {
            MOVEMENTS
        } else {
            EVENTS
        }
    };
    let filter = RwSignal::new(Filter::default());
    let matching = memo(move || {
        let object = object();
        let mut wanted = filter.get();
        if object == MOVEMENTS {
            // Movements have none.
            wanted.category = None;
        }
        store.site.with(|site| site.log(object).matching(&wanted))
    });
    let cursor = RwSignal::new(None);
    let count = Signal::derive(move || matching.with(Vec::len));
    let choose: Draw = Arc::new(move |html: &mut Markup| {
        let open = object();
        store.tag.with(|tag| logs::choose(html, tag, open));
    });
    let tools: Draw = Arc::new(move |html: &mut Markup| {
        let (object, online) = (object(), store.online.get());
        store.site.with(|site| {
            let (log, job) = (site.log(object), site.job_of_log(object));
            logs::tools(html, log, job, online);
        });
    });
    let filters: Draw = Arc::new(move |html: &mut Markup| {
        filter.with(|f| logs::filter(html, object(), f));
    });
    let status: Draw = Arc::new(move |html: &mut Markup| {
        let object = object();
        store.site.with(|site| {
            logs::status(html, site.log(object), site.job_of_log(object), count.get());
        });
    });
    let empty: Draw = Arc::new(move |html: &mut Markup| {
        if count.get() > 0 {
            return;
        }
        let object = object();
        let words = if store.site.with(|s| s.log(object).records.is_empty()) {
            "Nothing was read yet. Choose which end comes first."
        } else {
            "Nothing matches. Change the text or the category."
        };
        html.node("p", "empty", words);
    });
    let on_act = Callback::new(move |act: Act| {
        let log = object_now();
        match act.name.as_str() {
            "newest" | "oldest" => store.read_log(log, act.name == "oldest", false),
            "resume" => store.read_log(log, false, true),
            "cancel" => {
                let job = store
                    .site
                    .with_untracked(|s| s.job_of_log(log).map(|j| j.id));
                if let Some(id) = job {
                    store.cancel(id);
                }
            }
            "text" => filter.update(|f| f.text = act.value),
            "category" => filter.update(|f| f.category = act.value.parse().ok()),
            form => {
                let text = store.site.with_untracked(|site| {
                    let records = &site.log(log).records;
                    let shown: Vec<_> = matching
                        .with_untracked(|m| m.iter().filter_map(|at| records.get(*at)).collect());
                    if form == "csv" {
                        csv(&shown)
                    } else {
                        json(&shown)
                    }
                });
                let name = format!("dop-{}-{log}", store.tag.get_untracked());
                save(&name, form, &text);
            }
        }
    });
    let draw: DrawRow = Arc::new(move |at, html: &mut Markup| {
        let (object, now) = (object(), store.now.get_untracked());
        store.site.with(|site| {
            let record = matching.with(|m| m.get(at).copied());
            if let Some(record) = record.and_then(|at| site.log(object).records.get(at)) {
                logs::row(html, record, now);
            }
        });
    });
    let row_height = Signal::derive(move || {
        let narrow = narrow.is_some_and(|n| n.0.get());
        match (narrow, object() == MOVEMENTS) {
            (true, true) => 104,
            (true, false) => 64,
            _ => 38,
        }
    });
    view! {
        <div class="dop-page dop-logs">
            <Drawn class="toolbar" draw=choose/>
            <Drawn class="toolbar" draw=tools on_act=on_act/>
            <Drawn class="toolbar filters" draw=filters on_act=on_act/>
            <Drawn class="log-status" draw=status testid="log-status" role="status"/>
            <Drawn class="log-empty" draw=empty/>
            <Windowed
                label="Records"
                count=count
                row_height=row_height
                cursor=cursor
                draw=draw
                testid="log-list"
            />
        </div>
    }
}
