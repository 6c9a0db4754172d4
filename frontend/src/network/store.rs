//! What the program knows, as signals: the network that is shown, its tags, the clock.

use std::cell::Cell;
use std::rc::Rc;
use std::time::Duration;

use leptos::prelude::*;
use shared::ddc100::counters;
use shared::ddc100::tags::TagList;
use shared::proto::{Block, DdcAsk, DdcNews, DeviceInfo, TableName, ToPage};

use super::markup::unit::WATCHED;
use super::state::net::{Net, Unit};
use super::state::tags::Tags;
use super::state::unit::Judged;
use crate::browser::{remember, remembered};
use crate::erased::{effect, memo};
use crate::format::{decode, encode};
use crate::guest::Guest;
use crate::state::wire;

/// How long news are gathered before the screen is drawn anew.
const GATHER: Duration = Duration::from_millis(200);

/// The store.
#[derive(Clone, Copy, Debug)]
pub struct Store {
    guest: Guest,
    /// Tag of the unit whose page is shown; empty on the screens of a network.
    pub tag: Memo<String>,
    /// The network that is shown; empty offline.
    pub bus: Memo<String>,
    /// The open tab.
    pub tab: Memo<String>,
    /// True while there is a connection.
    pub online: Memo<bool>,
    /// The networks of the bridge, and the units on them.
    pub devices: RwSignal<Vec<DeviceInfo>>,
    /// The network.
    pub net: RwSignal<Net>,
    /// What the browser knows of its units.
    pub tags: RwSignal<Tags>,
    /// The tag list that was imported last.
    pub list: RwSignal<TagList>,
    /// All its units with what they say, and how they are.
    pub judged: Memo<Vec<Judged>>,
    /// The unit that is being polled, and on which port.
    pub poll: RwSignal<Option<(u8, u8)>>,
    /// The unit that is chosen in the drawing, by its place.
    pub chosen: RwSignal<Option<usize>>,
    /// Microseconds of the backend's clock, once a second.
    pub now_us: RwSignal<u64>,
    next: StoredValue<u32>,
    dirty: StoredValue<Rc<Cell<bool>>, LocalStorage>,
}

impl Store {
    /// Listens to the page and makes the store available.
    pub fn provide() -> Self {
        let guest = Guest::get();
        let place = guest.place;
        let devices = RwSignal::new(Vec::<DeviceInfo>::new());
        let tag = memo(move || place.with(|p| p.device.clone().unwrap_or_default()));
        let path = memo(move || place.with(|p| p.tab.clone()));
        let bus = memo(move || {
            let tag = tag.get();
            if tag.is_empty() {
                return path.with(|path| bus_of(path));
            }
            devices.with(|all| {
                let found = all.iter().find(|d| d.tag == tag);
                found.map_or_else(String::new, |d| d.bus.clone())
            })
        });
        let (net, tags) = (
            RwSignal::new(Net::default()),
            RwSignal::new(Tags::default()),
        );
        let store = Self {
            guest,
            tag,
            bus,
            tab: memo(move || path.with(|path| tab_of(path))),
            online: memo(move || place.with(|p| p.online)),
            devices,
            net,
            tags,
            list: RwSignal::new(TagList::default()),
            judged: memo(move || net.with(|net| tags.with(|tags| Judged::all(net, tags)))),
            poll: RwSignal::new(None),
            chosen: RwSignal::new(None),
            now_us: RwSignal::new(guest.now_us()),
            next: StoredValue::new(first_id()),
            dirty: StoredValue::new_local(Rc::default()),
        };
        provide_context(store);
        let clock = set_interval_with_handle(
            move || store.now_us.set(guest.now_us()),
            Duration::from_secs(1),
        );
        guest.listen(move |text| store.hear(text));
        store.follow();
        on_cleanup(move || {
            if let Ok(clock) = clock {
                clock.clear();
            }
            if let Some(bus) = store.bus.try_get_untracked().filter(|bus| !bus.is_empty()) {
                store.send(&DdcAsk::Leave { bus });
            }
        });
        store
    }

    /// The store of this program.
    #[must_use]
    pub fn get() -> Self {
        expect_context()
    }

    /// A setting of the address.
    #[must_use]
    pub fn query(self, key: &str) -> String {
        self.guest
            .place
            .with(|p| p.get(key).unwrap_or_default().to_owned())
    }

    /// Goes to an address of the page.
    pub fn go(self, hash: &str) {
        self.guest.go(hash);
    }

    /// Changes a setting of the screen; an empty one is left out.
    pub fn set_query(self, key: &str, value: &str) {
        let hash = self.guest.place.with_untracked(|place| {
            let mut all: Vec<_> = place
                .query
                .iter()
                .filter(|(k, _)| k != key)
                .map(|(k, v)| (k.as_str(), v.as_str()))
                .collect();
            if !value.is_empty() {
                all.push((key, value));
            }
            let mut hash = format!("#/network/{}", place.tab);
            for (at, (key, value)) in all.iter().enumerate() {
                hash.push(if at == 0 { '?' } else { '&' });
                hash.push_str(&format!("{}={}", encode(key), encode(value)));
            }
            hash
        });
        self.go(&hash);
    }

    /// Follows the network that the address names.
    fn follow(self) {
        let store = self;
        let wanted = memo(move || (store.bus.get(), store.online.get()));
        let followed = StoredValue::new(String::new());
        effect(move || {
            let (bus, online) = wanted.get();
            let before = followed.get_value();
            if before != bus {
                if online && !before.is_empty() {
                    store.send(&DdcAsk::Leave { bus: before });
                }
                store.net.set(Net::default());
                store.chosen.set(None);
                let kept = remembered(&kept_key(&bus)).unwrap_or_default();
                store.tags.set(Tags::from_text(&kept));
                let list = remembered(&list_key(&bus)).filter(|text| !text.is_empty());
                store
                    .list
                    .set(list.map(|csv| TagList::read(&csv)).unwrap_or_default());
            }
            store.poll.set(None);
            if online && !bus.is_empty() {
                store.send(&DdcAsk::Follow { bus: bus.clone() });
            } else {
                let now_ms = wall_ms();
                store.net.update(|net| {
                    net.log.now_ms = now_ms;
                    net.lost();
                });
            }
            followed.set_value(bus);
        });
    }

    fn hear(self, text: &str) {
        let Some(bus) = self.bus.try_get_untracked() else {
            // The program is closed.
            return;
        };
        let Some(news) = wire::ddc::read(text) else {
            if let Ok(ToPage::Hello { mut devices, .. }) = wire::read(text) {
                devices.retain(|d| d.kind.starts_with("ddc100"));
                self.devices.set(devices);
            }
            return;
        };
        if *bus_named(&news) != bus {
            return;
        }
        if let DdcNews::Poll { unit, port, .. } = news {
            self.poll.set(Some((unit, port)));
            return;
        }
        let now_ms = wall_ms();
        self.net.update_untracked(|net| {
            net.log.now_ms = now_ms;
            net.hear(news);
        });
        self.draw_soon();
    }

    /// Draws once for all news of a moment.
    fn draw_soon(self) {
        let Some(dirty) = self.dirty.try_get_value() else {
            return;
        };
        if !dirty.replace(true) {
            set_timeout(
                move || {
                    dirty.set(false);
                    // The program may be closed by now.
                    if self.net.try_with_untracked(|_| ()).is_some() {
                        self.net.notify();
                    }
                },
                GATHER,
            );
        }
    }

    fn send(self, ask: &DdcAsk) {
        self.guest.send(&wire::ddc::write(ask));
    }

    /// Reads registers of a unit once.
    pub fn read(self, unit: u8, block: Block) {
        let id = self.next.get_value();
        self.next.set_value(id.wrapping_add(1));
        let bus = self.bus.get_untracked();
        self.net.update(|net| net.ask(id, unit));
        self.send(&DdcAsk::Read {
            id,
            bus,
            unit,
            block,
        });
    }

    /// Reads what the polls of a unit may leave out, unless that is under way, or nobody looks.
    pub fn watch(self, unit: u8) {
        let (first, last) = WATCHED;
        let polled = self.net.with_untracked(|net| {
            let end = u32::from(net.start) + u32::from(net.count);
            net.start < first && end >= u32::from(last)
        });
        if polled || !self.online.get_untracked() || document().hidden() {
            return;
        }
        let id = self.next.get_value();
        let mut asks = false;
        self.net.update_untracked(|net| asks = net.watch(id, unit));
        if asks {
            self.next.set_value(id.wrapping_add(1));
            self.send(&DdcAsk::Read {
                id,
                bus: self.bus.get_untracked(),
                unit,
                block: Block {
                    table: TableName::Holding,
                    start: first - 1,
                    count: last - first + 1,
                },
            });
        }
    }

    /// The tags of the units, by their addresses; empty for one that has none. Follows them.
    #[must_use]
    pub fn names(self) -> Box<dyn Fn(u8) -> String> {
        let all: Vec<(u8, String)> = self.net.with(|net| {
            let tag = |tags: &Tags, unit: &Unit| (unit.info.unit, tags.tag(unit).to_owned());
            self.tags
                .with(|tags| net.units.iter().map(|unit| tag(tags, unit)).collect())
        });
        Box::new(move |unit| {
            let found = all.iter().find(|(of, _)| *of == unit);
            found.map_or_else(String::new, |(_, tag)| tag.clone())
        })
    }

    /// Reads the counters of a unit once.
    pub fn read_counters(self, unit: u8) {
        let bus = self.bus.get_untracked();
        self.net.update(|net| net.ask_counters(unit));
        for sub_function in counters::READS {
            let id = self.next.get_value();
            self.next.set_value(id.wrapping_add(1));
            self.send(&DdcAsk::Counter {
                id,
                bus: bus.clone(),
                unit,
                sub_function,
            });
        }
    }

    /// Changes what the browser knows of the units, and keeps it.
    pub fn set_tags(self, tags: Tags) {
        let bus = self.bus.get_untracked();
        remember(&kept_key(&bus), &tags.to_text());
        self.tags.set(tags);
    }

    /// Keeps the tag list that was imported.
    pub fn set_list(self, list: &TagList) {
        let bus = self.bus.get_untracked();
        let text = if list.tags.is_empty() {
            String::new()
        } else {
            list.to_csv()
        };
        remember(&list_key(&bus), &text);
        self.list.set(list.clone());
    }
}

/// Now, in milliseconds since 1970.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a positive number of milliseconds, far below 2^52"
)]
fn wall_ms() -> u64 {
    js_sys::Date::now().max(0.0) as u64
}

fn list_key(bus: &str) -> String {
    format!("ddc.list.{bus}")
}

/// The bus that an address names: `Loop%201/tags`.
fn bus_of(path: &str) -> String {
    decode(path.split('/').next().unwrap_or_default())
}

/// The tab that it names.
fn tab_of(path: &str) -> String {
    path.split('/').nth(1).map(decode).unwrap_or_default()
}

fn kept_key(bus: &str) -> String {
    format!("ddc.tags.{bus}")
}

const fn bus_named(news: &DdcNews) -> &String {
    match news {
        DdcNews::Network { bus, .. }
        | DdcNews::Unit { bus, .. }
        | DdcNews::Poll { bus, .. }
        | DdcNews::Pass { bus, .. }
        | DdcNews::Port { bus, .. }
        | DdcNews::Read { bus, .. } => bus,
    }
}

/// Numbers of reads begin somewhere, so that news about those of an earlier visit find none.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "some number below two thousand million"
)]
fn first_id() -> u32 {
    (js_sys::Math::random() * 2.0e9) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_names_bus_and_tab() {
        assert_eq!(bus_of("Loop%201/tags"), "Loop 1");
        assert_eq!(tab_of("Loop%201/tags"), "tags");
        assert_eq!((bus_of(""), tab_of("")), (String::new(), String::new()));
        // A bus that has a slash in its name.
        assert_eq!(bus_of("a%2Fb"), "a/b");
        assert_eq!(tab_of("/scan"), "scan");
    }
}
