//! The logs of a device.

use std::sync::Arc;

use leptos::prelude::*;

use super::registers::{fill_once, on_tool, toolbar};
use super::save;
use crate::actuator::markup::{logs, tools};
use crate::actuator::state::dossier::{Dossier, Subject};
use crate::actuator::state::logs::{Column, Filter, LOGS, Table, csv, json, logs_of, rows};
use crate::actuator::state::wanted::Wanted;
use crate::actuator::store::Store;
use crate::browser::Narrow;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::windowed::{DrawRow, Windowed};
use crate::erased::memo;
use crate::markup::Markup;

fn all(dossier: &Dossier) -> Wanted {
    Wanted {
        what: "logs".to_owned(),
        files: LOGS.to_vec(),
        ..Wanted::default()
    }
    .registers(dossier, &[dossier.clock()])
    .rows(&rows(dossier))
}

/// Alarms, warnings, connections, events, and file 5.
#[component]
pub(super) fn LogsPage() -> impl IntoView {
    let store = Store::get();
    let narrow = use_context::<Narrow>();
    let file = memo(move || {
        let log = store.query("log").and_then(|log| log.parse().ok());
        let there = |log: &u16| store.with(|d| logs_of(d).contains(log));
        log.filter(there).unwrap_or(LOGS[0])
    });
    fill_once(store, all);
    let filter = RwSignal::new(Filter::default());
    let table = memo(move || store.with(|d| Table::of(d, file.get())));
    let offset = memo(move || store.with(Dossier::clock_offset));
    let matching = memo(move || {
        // Another log has other codes and columns.
        let log = file.get();
        let mut wanted = filter.get();
        table.with(|table| {
            if table.codes().is_none_or(|(_, f)| f.set.is_none()) || log == 5 {
                wanted.code = None;
            }
            table.matching(&wanted)
        })
    });
    let count = Signal::derive(move || matching.with(Vec::len));
    let choose: Draw = Arc::new(move |html: &mut Markup| {
        let open = file.get();
        let logs = store.with(logs_of);
        logs::choose(html, logs, open, |query| store.address("logs", query));
    });
    let filters: Draw = Arc::new(move |html: &mut Markup| {
        filter.with(|f| table.with(|t| logs::filters(html, t, f)));
    });
    let status: Draw = Arc::new(move |html: &mut Markup| {
        let log = file.get();
        store.with(|d| {
            table.with(|t| logs::status(html, d, t, count.get()));
            tools::failures(html, d, |s| match s {
                // That it changed stands with its problems.
                Subject::File(file) => file == log && !d.changed(file),
                // The clock, and the logs in registers.
                Subject::Block(3, 15 | 3023 | 3090) | Subject::Block(4, 45) => true,
                _ => false,
            });
        });
    });
    let head: Draw = Arc::new(move |html: &mut Markup| {
        filter.with(|f| table.with(|t| logs::head(html, t, f)));
    });
    let empty: Draw = Arc::new(move |html: &mut Markup| {
        if count.get() > 0 {
            return;
        }
        let words = match (
            table.with(|t| (t.rows.is_empty(), t.stored)),
            store.is_live(),
        ) {
            ((true, Some(0)), _) => "The device has stored nothing here.",
            ((true, _), true) => "Nothing was read yet. Read the logs.",
            ((true, _), false) => "The snapshot holds nothing of this log.",
            _ => "Nothing matches. Change the text or the choice.",
        };
        html.node("p", "empty", words);
    });
    let on_act = Callback::new(move |act: Act| {
        if on_tool(store, &act, all) {
            return;
        }
        match act.name.as_str() {
            "text" => filter.update(|f| f.text = act.value),
            "raw" => filter.update(|f| f.raw = !act.value.is_empty()),
            "code" => filter.update(|f| f.code = act.value.parse().ok()),
            "sort" => {
                let column = match act.element.get_attribute("data-column").as_deref() {
                    Some("number") | None => Column::Number,
                    Some("time") => Column::Time,
                    Some(at) => at.parse().map_or(Column::Number, Column::Value),
                };
                filter.update(|f| f.sort(column));
            }
            form => {
                let offset = offset.get_untracked();
                let (tag, text) = store.with(|d| {
                    let text = table.with_untracked(|table| {
                        let rows = matching.get_untracked();
                        if form == "csv" {
                            csv(table, &rows, offset)
                        } else {
                            json(table, &rows, offset)
                        }
                    });
                    (d.tag.clone(), text)
                });
                let name = format!("{tag}-log-{}", file.get_untracked());
                save(&name, form, &text);
            }
        }
    });
    let draw: DrawRow = Arc::new(move |at, html: &mut Markup| {
        let now = store.now.get_untracked();
        let offset = offset.get();
        table.with(|table| {
            let place = matching.with(|m| m.get(at).copied());
            if let Some(row) = place.and_then(|at| table.rows.get(at)) {
                logs::row(html, table, row, filter.with(|f| f.raw), offset, now);
            }
        });
    });
    let row_height = Signal::derive(move || {
        let narrow = narrow.is_some_and(|n| n.0.get());
        match (narrow, file.get()) {
            (true, 4) => 96,
            (true, 5) | (false, _) => 36,
            (true, _) => 64,
        }
    });
    let cursor = RwSignal::new(None);
    view! {
        <div class="icon-page icon-logs" data-testid="page-logs">
            <Drawn class="toolbar" draw=toolbar(store, &[("read", "Read logs")]) on_act=on_act/>
            <Drawn class="toolbar" draw=choose/>
            <Drawn class="toolbar filters" draw=filters on_act=on_act/>
            <Drawn class="log-status" draw=status testid="log-status" role="status"/>
            <Drawn class="icon-log-head" draw=head on_act=on_act/>
            <Drawn class="log-empty" draw=empty/>
            <Windowed
                label="Entries"
                count=count
                row_height=row_height
                cursor=cursor
                draw=draw
                testid="log-list"
            />
        </div>
    }
}
