//! The register browser.

use core::ops::Range;
use std::sync::Arc;

use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::address::Table;
use shared::image::Image;
use shared::map::row::{DeviceMap, Kind, Row};
use shared::map::search::groups;
use shared::proto::{Block, Outcome};
use shared::tree::Name;

use crate::browser::{Narrow, copy, focus};
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::windowed::{DrawRow, Windowed};
use crate::erased::{effect, memo};
use crate::keys::on_action;
use crate::live::Live;
use crate::live::store::{PERIOD_MS, Polled};
use crate::markup::Markup;
use crate::markup::toolbar;
use crate::markup::values::{Around, detail, head, nothing, row as draw_row};
use crate::router::Router;
use crate::state::job::blocks;
use crate::state::order::Order;
use crate::state::overview::watched;
use crate::state::plant::DeviceState;
use crate::state::shortcuts::Action;
use crate::state::tree::Facts;
use crate::state::values::{
    Item, Opened, RawForm, as_answer, as_text, cell, filter, has_bits, items, place, toggle,
};
use crate::state::window::moved;
use crate::task::sleep;

/// Most blocks that are polled at once; more would not be over within a period.
const MOST: usize = 8;

/// Which line something is about, see [`Item::place`].
type Place = (Table, u16, Option<u16>);

/// Everything that the parts of the register browser share.
#[derive(Clone, Copy)]
struct Browser {
    live: Live,
    router: Router,
    map: &'static DeviceMap,
    tag: StoredValue<String>,
    opened: RwSignal<Opened>,
    cursor: RwSignal<Option<usize>>,
    in_view: RwSignal<Range<usize>>,
    polling: RwSignal<bool>,
    /// Whether a row was just copied, in words.
    copied: RwSignal<&'static str>,
    items: Memo<Arc<Vec<Item>>>,
}

impl Browser {
    /// The device, if it is there; follows the plant.
    fn with<T>(self, read: impl FnOnce(Option<&DeviceState>) -> T) -> T {
        self.live
            .plant
            .with(|p| read(self.tag.with_value(|t| p.device(t))))
    }

    fn raw(self) -> RawForm {
        let route = self.router.route();
        let key = route.get("raw").unwrap_or_default();
        let mut forms = RawForm::ALL.into_iter();
        forms.find(|f| f.key() == key).unwrap_or_default()
    }

    fn around(self, row: &Row) -> Around {
        let (reachable, is_watched) = self.with(|device| {
            device.map_or((false, false), |d| {
                let lost = d
                    .outcome
                    .is_some_and(|o| !matches!(o, Outcome::Ok | Outcome::Exception));
                (!lost, watched(d.device).iter().any(|b| holds(b, row)))
            })
        });
        let is_polled = || {
            self.live
                .polled
                .with(|p| p.blocks.iter().any(|b| holds(b, row)))
        };
        self.live.now.track();
        Around {
            now: self.live.plant.with(|p| p.now(crate::task::now_ms())),
            period: (is_watched || is_polled()).then_some(u64::from(PERIOD_MS) * 1000),
            reachable: reachable && self.live.conn.get().is_up(),
            raw: self.raw(),
            open: self.opened.with(|o| o.contains(&place(row))),
        }
    }

    fn selected(self) -> Option<Item> {
        let at = self.cursor.get()?;
        self.items.with(|i| i.get(at).copied())
    }

    fn draw_row(self, at: usize, html: &mut Markup) {
        if let Some(item) = self.items.with(|i| i.get(at).copied()) {
            let cell = self.with(|d| cell(item, &d?.image));
            draw_row(html, item, cell.as_ref(), &self.around(item.row()));
        }
    }

    fn draw_detail(self, html: &mut Markup) {
        if let Some(item) = self.selected() {
            let (cell, parts) = self.with(|d| {
                let image = d.map(|d| &d.image);
                (
                    image.and_then(|image| cell(item, image)),
                    image
                        .and_then(|image| parts(item, image))
                        .unwrap_or_default(),
                )
            });
            let copied = self.copied.get();
            detail(html, self.map, item, cell.as_ref(), &parts, copied);
        }
    }

    fn order(self) -> Order {
        Order::parse(self.router.route().get("sort").unwrap_or_default())
    }

    fn draw_nothing(self, html: &mut Markup) {
        if self.items.with(|items| items.is_empty()) {
            let route = self.router.route();
            let query = route.get("q").unwrap_or_default();
            nothing(html, query, route.get("reserved").is_none());
        }
    }

    /// Copies the selected line, and says for a while whether it worked.
    fn copy(self) {
        let text = untrack(|| {
            let item = self.selected()?;
            let cell = self.with(|d| cell(item, &d?.image));
            Some(as_text(item, cell.as_ref()))
        });
        let Some(text) = text else { return };
        spawn_local(async move {
            let words = if copy(text).await {
                "Copied"
            } else {
                "No clipboard"
            };
            // The screen may be gone by now.
            let _gone = self.copied.try_set(words);
            sleep(1500).await;
            let _gone = self.copied.try_set("");
        });
    }

    /// The cursor stays on its line when lines come, go or change places.
    fn keep_cursor(self) {
        let line: StoredValue<Option<Place>> = StoredValue::new(None);
        effect(move || {
            let at = self.items.with(|items| {
                let line = line.get_value()?;
                items.iter().position(|item| item.place() == line)
            });
            if self.cursor.get_untracked() != at && line.with_value(Option::is_some) {
                self.cursor.set(at);
            }
        });
        effect(move || {
            let at = self.cursor.get();
            let item = at.and_then(|at| self.items.with_untracked(|i| i.get(at).copied()));
            line.set_value(item.map(Item::place));
        });
    }

    /// Polled are the rows in view, in as many blocks as fit a period.
    fn poll(self) {
        let mut next = Polled {
            tag: self.tag.get_value(),
            blocks: Vec::new(),
        };
        if self.polling.get() {
            next.blocks = blocks(&rows_of(&self.items.get(), self.in_view.get()));
            next.blocks.truncate(MOST);
        }
        if self.live.polled.with_untracked(|p| *p != next) {
            self.live.polled.set(next);
        }
    }

    fn act(self, act: &Act) {
        let items = self.items.get_untracked();
        let read = |rows: Vec<&'static Row>| self.live.read(&self.tag.get_value(), blocks(&rows));
        match act.name.as_str() {
            "read-visible" => read(rows_of(&items, self.in_view.get_untracked())),
            "read-all" => read(rows_of(&items, 0..items.len())),
            "read-selected" => {
                let item = untrack(|| self.selected());
                read(item.into_iter().map(Item::row).collect());
            }
            "poll" => self.polling.update(|p| *p = !*p),
            "cancel" => self.live.cancel(&self.tag.get_value()),
            "close" => self.cursor.set(None),
            "raw" => {
                let next = untrack(|| self.raw()).next();
                self.router.set("raw", next.key());
            }
            "copy-row" => self.copy(),
            "sort" => {
                let column = act.element.get_attribute("data-column").unwrap_or_default();
                let next = untrack(|| self.order()).after(&column);
                self.router.set("sort", &next);
            }
            "widen" => {
                for setting in ["q", "table", "group", "access", "level"] {
                    self.router.set(setting, "");
                }
            }
            // What narrows the list stands in the address.
            setting => self.router.set(setting, &act.value),
        }
    }
}

/// All values of a device: search and filters, reading and polling, and everything about one row.
#[component]
pub fn ValuesView(
    /// Tag of the device.
    tag: String,
    /// Its map.
    map: &'static DeviceMap,
) -> impl IntoView {
    let (live, router) = (Live::get(), Router::get());
    let Narrow(narrow) = expect_context();
    let opened = RwSignal::new(Opened::new());
    let tag = StoredValue::new(tag);
    let all = Browser {
        live,
        router,
        map,
        tag,
        opened,
        cursor: RwSignal::new(None),
        in_view: RwSignal::new(0..0),
        polling: RwSignal::new(false),
        copied: RwSignal::new(""),
        items: memo(move || {
            let route = router.route();
            let filter = filter(|key| route.get(key).map(str::to_owned));
            let order = Order::parse(route.get("sort").unwrap_or_default());
            if order.is_live() {
                // Twice a second; not with each value, which nobody could follow.
                live.now.track();
            }
            let none = Image::new();
            live.plant.with_untracked(|plant| {
                let device = tag.with_value(|t| plant.device(t));
                let image = device.map_or(&none, |d| &d.image);
                opened.with(|opened| Arc::new(items(map, &filter, opened, order, image)))
            })
        }),
    };
    all.keep_cursor();
    effect(move || all.poll());
    on_cleanup(move || {
        let _gone = all.live.polled.try_set(Polled::default());
    });
    on_action(move |action| match action {
        Action::Find => focus("[data-find]"),
        Action::Next | Action::Previous => {
            let key = if action == Action::Next { "j" } else { "k" };
            let count = all.items.with_untracked(|i| i.len());
            all.cursor
                .update(|at| *at = moved(key, *at, count, 1).or(*at));
        }
        Action::Close => all.cursor.set(None),
        _ => {}
    });

    let draw: DrawRow = Arc::new(move |at, html: &mut Markup| all.draw_row(at, html));
    let on_open = Callback::new(move |(at, target): (usize, Option<web_sys::Element>)| {
        let row = all.items.with_untracked(|i| i.get(at).map(|i| i.row()));
        let toggles = target.is_none_or(|t| t.closest("[data-toggle]").ok().flatten().is_some());
        if let Some(row) = row.filter(|row| toggles && has_bits(row)) {
            opened.update(|o| toggle(o, place(row)));
        }
    });
    let names = groups(map);
    let filters: Draw = Arc::new(move |html: &mut Markup| {
        let route = router.route();
        toolbar::filters(html, &names, |key| route.get(key).unwrap_or_default());
    });
    let buttons: Draw = Arc::new(move |html: &mut Markup| {
        let found = all.items.with(|i| rows_of(i, 0..i.len()).len());
        let (polling, selected) = (all.polling.get(), all.cursor.get().is_some());
        all.with(|d| {
            let job = d.and_then(|d| d.job.as_ref());
            toolbar::reading(html, found, selected, polling, job);
        });
    });
    let heads: Draw = Arc::new(move |html: &mut Markup| head(html, all.raw(), all.order()));
    let empty: Draw = Arc::new(move |html: &mut Markup| all.draw_nothing(html));
    let facts: Draw = Arc::new(move |html: &mut Markup| all.draw_detail(html));
    let on_act = Callback::new(move |act: Act| all.act(&act));
    view! {
        <div class="values" class:with-detail=move || all.cursor.get().is_some()>
            <Drawn class="toolbar filters" role="search" draw=filters on_act=on_act/>
            <Drawn class="toolbar" draw=buttons on_act=on_act/>
            <div role="table" aria-label="Columns">
                <Drawn class="value-row value-head" role="row" draw=heads on_act=on_act/>
            </div>
            <Drawn class="nothing" role="status" draw=empty on_act=on_act/>
            <Windowed
                label="Registers"
                count=Signal::derive(move || all.items.with(|i| i.len()))
                row_height=Signal::derive(move || if narrow.get() { 60 } else { 30 })
                cursor=all.cursor
                draw=draw
                in_view=all.in_view
                on_open=on_open
                testid="register-list"
            />
            <Drawn
                class="row-detail"
                role="complementary"
                label="Register"
                draw=facts
                on_act=on_act
                testid="register-detail"
            />
        </div>
    }
}

/// The rows of some lines, each once.
fn rows_of(items: &[Item], range: Range<usize>) -> Vec<&'static Row> {
    let mut rows: Vec<&'static Row> = Vec::new();
    let items = items.get(range.start..range.end.min(items.len()));
    for row in items.unwrap_or_default().iter().map(|item| item.row()) {
        if rows.last().is_none_or(|last| !core::ptr::eq(*last, row)) {
            rows.push(row);
        }
    }
    rows
}

fn holds(block: &Block, row: &Row) -> bool {
    Table::from(block.table) == row.table
        && row.address.get() >= block.start
        && row.end() <= u32::from(block.start) + u32::from(block.count)
}

/// The parts of a value that has parts.
fn parts(item: Item, image: &Image) -> Option<Vec<Facts>> {
    if item.row().kind != Kind::Curve {
        return None;
    }
    let decoded = as_answer(item.row(), image)?;
    let parts = decoded
        .iter()
        .filter(|(_, f)| matches!(f.name, Name::Within(..)));
    Some(
        parts
            .filter_map(|(id, _)| Facts::of(&decoded, id))
            .collect(),
    )
}
