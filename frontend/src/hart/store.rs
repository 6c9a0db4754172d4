//! What the program knows, as signals: the device, its bus, the clock; and who asks for what.

use std::time::Duration;

use leptos::prelude::*;
use shared::capture::{Capture, Direction, Micros};
use shared::proto::{HartAsk, HartNews, ToBackend, ToPage, Way};
use shared::session::Session;

use super::state::plan;
use super::state::site::{Found, Job, Link, Plant};
use super::state::unit::{Key, Unit, to_wire};
use crate::erased::{effect, memo};
use crate::guest::Guest;
use crate::state::absorb::bytes_of;
use crate::state::wire;

/// Frames kept of a bus, and forgotten at once.
const KEPT: u32 = 5000;
const BATCH: u32 = 500;

/// The frames of a bus.
#[derive(Clone, Debug)]
pub struct Traffic {
    /// Its name.
    pub bus: String,
    /// Its frames.
    pub session: Session,
    /// Sequence number of the last capture.
    pub last_seq: Option<u64>,
    /// Captures that were lost on the way.
    pub missed: u64,
}

/// The store.
#[derive(Clone, Copy, Debug)]
pub struct Store {
    guest: Guest,
    /// Tag of the device, empty elsewhere.
    pub tag: Memo<String>,
    /// The open tab, as the address has it.
    pub tab: Memo<String>,
    /// True while there is a connection.
    pub online: Memo<bool>,
    /// The bus that is shown: that of the device, or the one of the address.
    pub bus: Memo<String>,
    /// Buses and devices.
    pub plant: RwSignal<Plant>,
    /// The device.
    pub unit: RwSignal<Unit>,
    /// The read under way.
    pub job: RwSignal<Job>,
    /// The scan or search under way.
    pub search: RwSignal<Job>,
    /// What it found.
    pub found: RwSignal<Vec<Found>>,
    /// The state of the line.
    pub link: RwSignal<Option<Link>>,
    /// The frames of the bus, while they are shown.
    pub traffic: RwSignal<Option<Traffic>>,
    /// Microseconds of the backend's clock, once a second.
    pub now_us: RwSignal<u64>,
    visible: RwSignal<bool>,
    next: StoredValue<u32>,
}

impl Store {
    /// Listens to the page and makes the store available.
    pub fn provide() -> Self {
        let guest = Guest::get();
        let place = guest.place;
        let plant = RwSignal::new(Plant::default());
        let tag = memo(move || place.with(|p| p.device.clone().unwrap_or_default()));
        let store = Self {
            guest,
            tag,
            tab: memo(move || place.with(|p| p.tab.clone())),
            online: memo(move || place.with(|p| p.online)),
            bus: memo(move || {
                let of_device = plant.with(|p| tag.with(|t| p.device(t).map(|d| d.bus.clone())));
                of_device
                    .unwrap_or_else(|| place.with(|p| p.get("bus").unwrap_or_default().to_owned()))
            }),
            plant,
            unit: RwSignal::new(Unit::new(String::new(), None, String::new())),
            job: RwSignal::new(Job::default()),
            search: RwSignal::new(Job::default()),
            found: RwSignal::new(Vec::new()),
            link: RwSignal::new(None),
            traffic: RwSignal::new(None),
            now_us: RwSignal::new(guest.now_us()),
            visible: RwSignal::new(!document().hidden()),
            next: StoredValue::new(first_id()),
        };
        provide_context(store);
        let clock = set_interval_with_handle(
            move || {
                store.now_us.set(guest.now_us());
                store.visible.set(!document().hidden());
                store.read_due();
            },
            Duration::from_secs(1),
        );
        on_cleanup(move || {
            if let Ok(clock) = clock {
                clock.clear();
            }
        });
        guest.listen(move |text| store.hear(text));
        store.follow();
        store
    }

    /// The store of this program.
    #[must_use]
    pub fn get() -> Self {
        expect_context()
    }

    /// A setting of the address.
    #[must_use]
    pub fn query(self, key: &str) -> Option<String> {
        self.guest.place.with(|p| p.get(key).map(str::to_owned))
    }

    /// Where the page is, for times of day: start of the backend and offset of local time.
    #[must_use]
    pub fn times(self) -> (u64, i32) {
        self.guest
            .place
            .with_untracked(|p| (p.start_wall_ms, p.offset_minutes))
    }

    /// Goes to an address of the page.
    pub fn go(self, hash: &str) {
        self.guest.go(hash);
    }

    fn follow(self) {
        let store = self;
        // Another device: nothing is known of it.
        let known = memo(move || {
            store
                .plant
                .with(|p| store.tag.with(|t| p.device(t).cloned()))
        });
        effect(move || {
            let tag = store.tag.get();
            let (family, bus) = known
                .get()
                .map_or((None, String::new()), |d| (d.family, d.bus));
            let same = store
                .unit
                .with_untracked(|u| u.tag == tag && u.family == family && u.bus == bus);
            if !same {
                store.unit.set(Unit::new(tag, family, bus));
                store.job.set(Job::default());
            }
        });
        effect(move || {
            if !store.online.get() {
                store.unit.update(Unit::lost);
                store.job.set(Job::default());
                store.search.set(Job::default());
            }
        });
        // Only what is shown is polled, and nothing while nobody looks.
        let wanted = memo(move || {
            let tag = store.tag.get();
            let family = known.get().and_then(|d| d.family);
            let up = store.online.get() && store.visible.get();
            let shown = store.tab.with(|tab| plan::tab(tab));
            let (keys, period) = plan::watched(shown, family);
            let keys = if up { keys } else { Vec::new() };
            (tag, keys, period, store.online.get(), known.get().is_some())
        });
        effect(move || {
            let (device, keys, period_ms, online, known) = wanted.get();
            if online && known {
                store.send(&HartAsk::Watch {
                    device,
                    commands: keys.iter().map(to_wire).collect(),
                    period_ms,
                });
            }
        });
        effect(move || {
            store.tab.track();
            if known.get().is_some() && store.online.get() {
                store.read_due();
            }
        });
        // The state of the line, where it is shown.
        effect(move || {
            let bus = store.bus.get();
            store.link.set(None);
            if store.online.get() && !bus.is_empty() && store.is_on_bus_page() {
                store.send(&HartAsk::Link { bus });
            }
        });
        let listened = memo(move || {
            let shown = store.tab.with(|t| t == "traffic" || t == "bus");
            (store.online.get() && shown).then(|| store.bus.get())
        });
        effect(move || store.subscribe(listened.get().filter(|bus| !bus.is_empty())));
        on_cleanup(move || {
            let bus = store.traffic.try_update(Option::take).flatten();
            if let Some(bus) = bus {
                store.say(&ToBackend::Unsubscribe { bus: bus.bus });
            }
        });
    }

    fn is_on_bus_page(self) -> bool {
        self.tab.with(|tab| tab == "bus")
    }

    fn subscribe(self, bus: Option<String>) {
        let before = self
            .traffic
            .with_untracked(|t| t.as_ref().map(|t| (t.bus.clone(), t.last_seq)));
        let Some(bus) = bus else {
            // What was heard stays, in case the connection comes back.
            if let Some((bus, _)) = before {
                self.say(&ToBackend::Unsubscribe { bus });
            }
            return;
        };
        let after = match before {
            Some((old, last)) if old == bus => last,
            _ => {
                let framing = self.plant.with_untracked(|p| p.framing(&bus));
                self.traffic.set(Some(Traffic {
                    bus: bus.clone(),
                    session: Session::new(framing),
                    last_seq: None,
                    missed: 0,
                }));
                None
            }
        };
        self.say(&ToBackend::Subscribe { bus, after });
    }

    fn hear(self, text: &str) {
        // The program may be closed by now.
        let Some(tag) = self.tag.try_get_untracked() else {
            return;
        };
        let Some(news) = wire::hart::read(text) else {
            self.hear_other(text);
            return;
        };
        match &news {
            HartNews::Exchange {
                device,
                command,
                request,
                response,
                outcome,
                text,
                at_us,
                took_us,
                tries,
                ..
            } => {
                if *device == tag {
                    self.unit.update(|unit| {
                        unit.take(
                            &bytes_of(request),
                            &bytes_of(response),
                            *command,
                            (*outcome, text),
                            (*at_us, *took_us, *tries),
                        );
                    });
                }
            }
            HartNews::Found {
                id,
                polling,
                response,
                at_us,
                ..
            } => {
                let mine = self.search.with_untracked(|s| s.id == *id);
                if let Some(found) = Found::new(*polling, response, *at_us).filter(|_| mine) {
                    self.found.update(|all| all.push(found));
                }
            }
            HartNews::Link { bus, .. } => {
                if self.bus.with_untracked(|b| b == bus) {
                    self.link.set(Link::of(&news));
                }
            }
            HartNews::Progress { id, .. } | HartNews::Done { id, .. } => {
                for job in [self.job, self.search] {
                    if job.with_untracked(|j| j.id == *id) {
                        job.update(|j| j.hear(&news));
                    }
                }
            }
        }
    }

    /// The greeting, and the captures of the bus.
    fn hear_other(self, text: &str) {
        let Ok(message) = wire::read(text) else {
            return;
        };
        match message {
            ToPage::Capture {
                bus,
                seq,
                at_us,
                way,
                ends,
                hex,
            } => self.traffic.update(|traffic| {
                if let Some(traffic) = traffic.as_mut().filter(|t| t.bus == bus) {
                    traffic.push(seq, at_us, way, ends, &bytes_of(&hex));
                }
            }),
            ToPage::Lagged { bus, missed } => self.traffic.update(|traffic| {
                if let Some(traffic) = traffic.as_mut().filter(|t| t.bus == bus) {
                    traffic.missed = traffic.missed.saturating_add(missed);
                    traffic.session.silence();
                    traffic.last_seq = None;
                }
            }),
            message => {
                if let Some(plant) = Plant::of(&message) {
                    self.plant.set(plant);
                }
            }
        }
    }

    fn send(self, ask: &HartAsk) {
        self.guest.send(&wire::hart::write(ask));
    }

    fn say(self, message: &ToBackend) {
        if let Some(text) = wire::write(message) {
            self.guest.send(&text);
        }
    }

    fn next_id(self) -> u32 {
        let id = self.next.get_value();
        self.next.set_value(id.wrapping_add(1));
        id
    }

    /// Reads what the open tab needs now.
    fn read_due(self) {
        let busy = self.job.with_untracked(Job::is_running);
        let up = self.online.get_untracked() && self.visible.get_untracked();
        let known = self
            .plant
            .with_untracked(|p| self.tag.with_untracked(|t| p.device(t).is_some()));
        if busy || !up || !known {
            return;
        }
        let now = self.guest.now_us();
        let tab = self.tab.with_untracked(|tab| plan::tab(tab));
        let keys = self.unit.with_untracked(|unit| {
            // The effect that begins with a device may come later.
            if self.tag.with_untracked(|t| unit.tag == *t) {
                plan::due(tab, unit, now)
            } else {
                Vec::new()
            }
        });
        self.read(&keys);
    }

    /// Reads commands of the device once.
    pub fn read(self, keys: &[Key]) {
        if keys.is_empty() {
            return;
        }
        let id = self.next_id();
        let total = u32::try_from(keys.len()).unwrap_or(u32::MAX);
        self.job.set(Job::new(id, total));
        self.unit.update(|unit| unit.ask(keys));
        self.send(&HartAsk::Read {
            id,
            device: self.tag.get_untracked(),
            commands: keys.iter().map(to_wire).collect(),
        });
    }

    /// Reads again all that the open tab shows.
    pub fn read_again(self) {
        let tab = self.tab.with_untracked(|tab| plan::tab(tab));
        let family = self.unit.with_untracked(|u| u.family);
        let mut keys = plan::once(tab);
        for key in plan::watched(tab, family).0 {
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
        self.read(&keys);
    }

    /// Looks at polling addresses of the bus.
    pub fn scan(self) {
        let id = self.begin_search(64);
        let bus = self.bus.get_untracked();
        self.send(&HartAsk::Scan {
            id,
            bus,
            first: 0,
            last: 63,
        });
    }

    /// Asks which device has a tag.
    pub fn find(self, tag: String, long: bool) {
        let id = self.begin_search(1);
        let bus = self.bus.get_untracked();
        self.send(&HartAsk::Find { id, bus, tag, long });
    }

    fn begin_search(self, total: u32) -> u32 {
        let id = self.next_id();
        self.found.set(Vec::new());
        self.search.set(Job::new(id, total));
        id
    }

    /// Ends a read, scan or search.
    pub fn cancel(self, job: RwSignal<Job>) {
        let id = job.with_untracked(|j| j.id);
        self.send(&HartAsk::Cancel { id });
    }
}

impl Traffic {
    fn push(&mut self, seq: u64, at_us: u64, way: Way, ends: bool, bytes: &[u8]) {
        if let Some(last) = self.last_seq {
            if seq <= last {
                return;
            }
            let missed = seq - last - 1;
            if missed > 0 {
                self.missed = self.missed.saturating_add(missed);
                self.session.silence();
            }
        }
        self.last_seq = Some(seq);
        self.session.push(&Capture {
            bytes,
            at: Some(Micros::new(at_us)),
            direction: match way {
                Way::Tx => Direction::ToDevice,
                Way::Rx => Direction::FromDevice,
            },
            ends,
        });
        let kept = self.session.len().saturating_sub(self.session.first());
        if kept > KEPT + BATCH {
            self.session
                .forget_before(self.session.len().saturating_sub(KEPT));
        }
    }
}

/// Numbers of jobs begin somewhere, so that news about jobs of an earlier visit finds none.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "some number below two thousand million"
)]
fn first_id() -> u32 {
    (js_sys::Math::random() * 2.0e9) as u32
}
