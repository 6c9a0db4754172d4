//! The register browser.

use core::ops::Range;
use std::sync::Arc;

use leptos::prelude::*;
use shared::map::row::{DeviceMap, Row};
use shared::map::search::groups;

use crate::browser::{Narrow, focus, value_of};
use crate::components::windowed::{DrawRow, Windowed};
use crate::format::count;
use crate::keys::on_action;
use crate::live::Live;
use crate::live::store::{PERIOD_MS, Polled};
use crate::markup::Markup;
use crate::markup::values::{Around, detail, row as draw_row};
use crate::router::Router;
use crate::state::health::outcome;
use crate::state::job::blocks;
use crate::state::overview::watched;
use crate::state::shortcuts::Action;
use crate::state::tree::Facts;
use crate::state::values::{
    Item, LEVELS, Opened, RawForm, as_answer, cell, filter, has_bits, items, place,
};
use crate::state::window::moved;
use shared::address::Table;
use shared::proto::Block;

/// Most blocks that are polled at once; more would not be over within a period.
const MOST: usize = 8;

/// All values of a device: search and filters, reading and polling, and everything about one row.
#[component]
pub fn ValuesView(
    /// Tag of the device.
    tag: String,
    /// Its map.
    map: &'static DeviceMap,
) -> impl IntoView {
    let live = Live::get();
    let router = Router::get();
    let Narrow(narrow) = expect_context();
    let tag = StoredValue::new(tag);
    let opened = RwSignal::new(Opened::new());
    let cursor = RwSignal::new(None::<usize>);
    let in_view = RwSignal::new(0..0);
    let polling = RwSignal::new(false);

    let route = Signal::derive(move || router.route());
    let items = Memo::new(move |_| {
        let filter = route.with(|r| filter(|key| r.get(key).map(str::to_owned)));
        opened.with(|opened| Arc::new(items(map, &filter, opened)))
    });
    let raw = Memo::new(move |_| {
        let key = route.with(|r| r.get("raw").unwrap_or_default().to_owned());
        let forms = RawForm::ALL.into_iter();
        forms.clone().find(|f| f.key() == key).unwrap_or_default()
    });
    let count_of = Signal::derive(move || items.with(|i| i.len()));

    // Polled are the rows in view, in as many blocks as fit a period.
    Effect::new(move |_| {
        let blocks = if polling.get() {
            let rows = rows_of(&items.get(), in_view.get());
            let mut blocks = blocks(&rows);
            blocks.truncate(MOST);
            blocks
        } else {
            Vec::new()
        };
        let next = Polled {
            tag: tag.get_value(),
            blocks,
        };
        if live.polled.with_untracked(|p| *p != next) {
            live.polled.set(next);
        }
    });
    on_cleanup(move || {
        let _gone = live.polled.try_set(Polled::default());
    });

    let around = move |row: &Row| {
        let (reachable, device) = live.plant.with(|p| {
            tag.with_value(|t| p.device(t)).map_or((false, None), |d| {
                let lost = d.outcome.is_some_and(|o| o != shared::proto::Outcome::Ok);
                (!lost, Some(d.device))
            })
        });
        let watched = device.map(watched).unwrap_or_default();
        let is_watched = watched.iter().any(|b| holds(b, row))
            || live.polled.with(|p| p.blocks.iter().any(|b| holds(b, row)));
        Around {
            now: live
                .now
                .get()
                .max(live.plant.with(|p| p.now(crate::task::now_ms()))),
            period: is_watched.then_some(u64::from(PERIOD_MS) * 1000),
            reachable: reachable && live.conn.get().is_up(),
            raw: raw.get(),
            open: opened.with(|o| o.contains(&place(row))),
        }
    };
    let cell_of = move |item: Item| {
        live.plant.with(|p| {
            tag.with_value(|t| p.device(t))
                .and_then(|d| cell(item, &d.image))
        })
    };
    let draw: DrawRow = Arc::new(move |at: usize, html: &mut Markup| {
        if let Some(item) = items.with(|i| i.get(at).copied()) {
            draw_row(html, item, cell_of(item).as_ref(), &around(item.row()));
        }
    });
    let on_open = Callback::new(move |(at, target): (usize, Option<web_sys::Element>)| {
        let row = items.with_untracked(|i| i.get(at).map(|i| i.row()));
        let toggles = target.is_none_or(|t| t.closest("[data-toggle]").ok().flatten().is_some());
        if let Some(row) = row.filter(|row| toggles && has_bits(row)) {
            opened.update(|o| {
                if !o.remove(&place(row)) {
                    o.insert(place(row));
                }
            });
        }
    });
    let selected = move || {
        cursor
            .get()
            .and_then(|at| items.with(|i| i.get(at).copied()))
    };
    let facts = move || {
        selected().map_or_else(String::new, |item| {
            let parts = live.plant.with(|p| {
                let device = tag.with_value(|t| p.device(t))?;
                parts(
                    item,
                    device
                        .image
                        .row(item.row())
                        .is_some()
                        .then_some(&device.image)?,
                )
            });
            detail(
                map,
                item,
                cell_of(item).as_ref(),
                &parts.unwrap_or_default(),
            )
        })
    };
    on_action(move |action| match action {
        Action::Find => focus("[data-find]"),
        Action::Next | Action::Previous => {
            let key = if action == Action::Next { "j" } else { "k" };
            let count = count_of.get_untracked();
            cursor.update(|at| *at = moved(key, *at, count, 1).or(*at));
        }
        Action::Close => cursor.set(None),
        _ => {}
    });
    let read = move |rows: Vec<&'static Row>| live.read(&tag.get_value(), blocks(&rows));
    view! {
        <div class="values" class:with-detail=move || cursor.get().is_some()>
            <Filters map=map/>
            <div class="toolbar">
                <button
                    class="button"
                    data-testid="read-visible"
                    on:click=move |_| {
                        read(rows_of(&items.get_untracked(), in_view.get_untracked()));
                    }
                >
                    "Read visible"
                </button>
                <button
                    class="button"
                    data-testid="read-all"
                    on:click=move |_| {
                        let all = items.get_untracked();
                        read(rows_of(&all, 0..all.len()));
                    }
                >
                    {move || {
                        let rows = items.with(|i| rows_of(i, 0..i.len()).len());
                        format!("Read all {rows}")
                    }}
                </button>
                <button
                    class="button"
                    data-testid="read-selected"
                    prop:disabled=move || cursor.get().is_none()
                    on:click=move |_| {
                        if let Some(item) = untrack(selected) {
                            read(vec![item.row()]);
                        }
                    }
                >
                    "Read selected"
                </button>
                <button
                    class="button"
                    data-testid="poll-visible"
                    aria-pressed=move || polling.get().to_string()
                    on:click=move |_| polling.update(|p| *p = !*p)
                >
                    {move || if polling.get() { "Polling visible, 1 s" } else { "Poll visible" }}
                </button>
                <JobState tag=tag/>
            </div>
            <div class="value-row value-head" aria-hidden="true">
                <span></span>
                <span class="num">"Address"</span>
                <span class="num">"Number"</span>
                <span>"Name"</span>
                <span class="right">"Value"</span>
                <span>"Unit"</span>
                <span>"Age, quality"</span>
                <RawChoice raw=raw/>
            </div>
            <Windowed
                label="Registers"
                count=count_of
                row_height=Signal::derive(move || if narrow.get() { 60 } else { 30 })
                cursor=cursor
                draw=draw
                in_view=in_view
                on_open=on_open
                testid="register-list"
            />
            <p class="empty" hidden=move || { count_of.get() > 0 }>
                "No register matches. Search by name, address (3004), number (403005) or hexadecimal (0x0BBC)."
            </p>
            <aside
                class="row-detail"
                aria-label="Register"
                data-testid="register-detail"
                hidden=move || cursor.get().is_none()
            >
                <button class="button" on:click=move |_| cursor.set(None)>
                    "Close"
                </button>
                <div inner_html=facts></div>
            </aside>
        </div>
    }
}

/// Search and filters; what is set stands in the address.
#[component]
fn Filters(
    /// The map that is searched.
    map: &'static DeviceMap,
) -> impl IntoView {
    let router = Router::get();
    let tables = Table::ALL.map(|t| (t.key(), t.label()));
    let names = groups(map).into_iter().map(|g| (g, g)).collect();
    let levels = LEVELS.map(|l| (l.key(), l.key()));
    let access = [
        ("r", "Read-only"),
        ("rw", "Writable"),
        ("rw!", "Moves or reconfigures"),
    ];
    let reserved = router.setting("reserved");
    let query = router.setting("q");
    view! {
        <div class="toolbar filters" role="search">
            <input
                type="search"
                data-testid="register-search"
                data-find
                placeholder="Name, address or number"
                aria-label="Search by name, address, number or hexadecimal"
                prop:value=query
                on:input=move |e| router.set("q", &value_of(&e))
            />
            <SettingChoice key="table" label="Table" choices=tables.to_vec()/>
            <SettingChoice key="group" label="Group" choices=names/>
            <SettingChoice key="access" label="Access" choices=access.to_vec()/>
            <SettingChoice key="level" label="Level" choices=levels.to_vec()/>
            <label class="check">
                <input
                    type="checkbox"
                    data-testid="show-reserved"
                    prop:checked=move || !reserved.get().is_empty()
                    on:change=move |e| {
                        router.set("reserved", if event_target_checked(&e) { "show" } else { "" });
                    }
                />
                "Reserved"
            </label>
        </div>
    }
}

/// A list of choices that stands in the address.
#[component]
fn SettingChoice(
    /// Name in the address.
    key: &'static str,
    /// Its word.
    label: &'static str,
    /// Value and word of each choice.
    choices: Vec<(&'static str, &'static str)>,
) -> impl IntoView {
    let router = Router::get();
    let setting = router.setting(key);
    let options = choices
        .into_iter()
        .map(|(value, words)| {
            view! {
                <option value=value selected=move || setting.get() == value>
                    {words}
                </option>
            }
            .into_any()
        })
        .collect::<Vec<_>>();
    view! {
        <select
            data-testid=format!("filter-{key}")
            aria-label=label
            prop:value=setting
            on:change=move |e| router.set(key, &value_of(&e))
        >
            <option value="">{label}</option>
            {options}
        </select>
    }
}

/// How raw words are written; a click goes to the next form.
#[component]
fn RawChoice(
    /// The present form.
    raw: Memo<RawForm>,
) -> impl IntoView {
    let router = Router::get();
    let next = move |_| {
        let next = match raw.get_untracked() {
            RawForm::Hex => RawForm::Decimal,
            RawForm::Decimal => RawForm::Binary,
            RawForm::Binary => RawForm::Hex,
        };
        router.set("raw", next.key());
    };
    view! {
        <button class="quiet-button" data-testid="raw-form" on:click=next>
            {move || format!("Raw, {}", raw.get().key())}
        </button>
    }
}

/// How far reading is, and what failed.
#[component]
fn JobState(
    /// Tag of the device.
    tag: StoredValue<String>,
) -> impl IntoView {
    let live = Live::get();
    let job = Memo::new(move |_| {
        live.plant.with(|p| {
            let job = tag.with_value(|t| p.device(t))?.job.as_ref()?;
            let failed = job.failed.first().map(|f| {
                let last = f
                    .block
                    .start
                    .saturating_add(f.block.count.saturating_sub(1));
                let what = format!("{} to {last}", f.block.start);
                let why = if f.text.is_empty() {
                    outcome(f.outcome)
                } else {
                    &f.text
                };
                let all = count(u64::try_from(job.failed.len()).unwrap_or(0), "block");
                format!("{all} failed; {what}: {why}")
            });
            Some((job.done, job.total, job.is_over(), failed))
        })
    });
    let words = move || {
        job.get()
            .map_or_else(String::new, |(done, total, over, failed)| {
                let progress = format!(
                    "{done} of {}",
                    count(u64::try_from(total).unwrap_or(0), "block")
                );
                match (over, failed) {
                    (false, None) => progress,
                    (false, Some(failed)) => format!("{progress} {failed}"),
                    (true, None) => format!("{progress} read"),
                    (true, Some(failed)) => failed,
                }
            })
    };
    let running = move || job.with(|j| j.as_ref().is_some_and(|(.., over, _)| !over));
    view! {
        <span class="quiet job" role="status" data-testid="job">
            {words}
        </span>
        <button
            class="button"
            data-testid="cancel-read"
            hidden=move || !running()
            on:click=move |_| live.cancel(&tag.get_value())
        >
            "Cancel"
        </button>
    }
}

/// The rows of some lines, each once, without those that can't be read.
fn rows_of(items: &[Item], range: Range<usize>) -> Vec<&'static Row> {
    let mut rows: Vec<&'static Row> = Vec::new();
    for item in items
        .get(range.start..range.end.min(items.len()))
        .unwrap_or_default()
    {
        let row = item.row();
        if rows.last().is_none_or(|last| !core::ptr::eq(*last, row)) {
            rows.push(row);
        }
    }
    rows
}

fn holds(block: &Block, row: &Row) -> bool {
    let start = row.address.get();
    Table::from(block.table) == row.table
        && start >= block.start
        && row.end() <= u32::from(block.start) + u32::from(block.count)
}

/// The parts of a value that has parts.
fn parts(item: Item, image: &shared::image::Image) -> Option<Vec<Facts>> {
    if item.row().kind != shared::map::row::Kind::Curve {
        return None;
    }
    let decoded = as_answer(item.row(), image)?;
    let ids = decoded
        .iter()
        .filter(|(_, f)| matches!(f.name, shared::tree::Name::Within(..)));
    Some(ids.filter_map(|(id, _)| Facts::of(&decoded, id)).collect())
}
