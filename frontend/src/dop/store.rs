//! What the program knows, as signals: the device on the line, the settings made here, the clock.

use std::sync::Arc;
use std::time::Duration;

use leptos::prelude::*;
use shared::dop::{ObjectRead, Profile, Request};
use shared::proto::{DopAsk, DopNews, LogFrom};

use super::markup::overview;
use super::picture::overlay;
use super::state::kept::Kept;
use super::state::saved::Saved;
use super::state::site::{Site, all_requests};
use crate::browser::{remember, remembered};
use crate::chart::Chart;
use crate::erased::{effect, memo};
use crate::guest::Guest;
use crate::state::wire;

/// Where the profile of the offline side is remembered.
const PROFILE: &str = "dop.profile";

/// How often the user indicators are read while they are shown.
const WATCH_MS: u32 = 2000;

/// The store.
#[derive(Clone, Copy, Debug)]
pub struct Store {
    guest: Guest,
    /// Tag of the device, empty offline.
    pub tag: Memo<String>,
    /// The open tab.
    pub tab: Memo<String>,
    /// True while there is a connection.
    pub online: Memo<bool>,
    /// The device.
    pub site: RwSignal<Site>,
    /// The settings made here, for what is decoded offline.
    pub own: RwSignal<Arc<Profile>>,
    /// Earlier reads to compare with.
    pub earlier: RwSignal<Option<Arc<Saved>>>,
    /// What of strokes is laid over each other.
    pub quantity: RwSignal<String>,
    /// Seconds since 1970, once a second.
    pub now: RwSignal<i64>,
    /// Microseconds of the backend's clock, once a second.
    pub now_us: RwSignal<i64>,
    next: StoredValue<u32>,
}

impl Store {
    /// Listens to the page and makes the store available.
    pub fn provide() -> Self {
        let guest = Guest::get();
        let place = guest.place;
        let own = remembered(PROFILE).and_then(|text| Profile::from_json(&text).ok());
        let store = Self {
            guest,
            tag: memo(move || place.with(|p| p.device.clone().unwrap_or_default())),
            tab: memo(move || place.with(|p| p.tab.clone())),
            online: memo(move || place.with(|p| p.online)),
            site: RwSignal::new(Site::default()),
            own: RwSignal::new(Arc::new(own.unwrap_or_default())),
            earlier: RwSignal::new(None),
            quantity: RwSignal::new("avg".to_owned()),
            now: RwSignal::new(wall_now()),
            now_us: RwSignal::new(guest.now_us().cast_signed()),
            next: StoredValue::new(first_id()),
        };
        provide_context(store);
        let clock = set_interval_with_handle(
            move || {
                store.now.set(wall_now());
                store.now_us.set(guest.now_us().cast_signed());
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

    /// Goes to an address of the page.
    pub fn go(self, hash: &str) {
        self.guest.go(hash);
    }

    /// Asks for what a device needs to be known, and watches its indicators while they are shown.
    fn follow(self) {
        let store = self;
        effect(move || {
            let tag = store.tag.get();
            store.site.set(Site::default());
            store.earlier.set(kept(&tag));
        });
        effect(move || {
            let (tag, online) = (store.tag.get(), store.online.get());
            if tag.is_empty() {
                return;
            }
            if online {
                store.send(DopAsk::Profile { device: tag });
            } else {
                store.site.update(Site::lost);
            }
        });
        let watched = memo(move || {
            let overview = store.tab.with(|tab| tab.is_empty() || tab == "overview");
            let has = store
                .site
                .with(|s| s.profile.registers.indicators.is_some());
            store.online.get() && overview && has
        });
        effect(move || {
            let tag = store.tag.get_untracked();
            if !tag.is_empty() && store.online.get_untracked() {
                let period_ms = if watched.get() { WATCH_MS } else { 0 };
                store.send(DopAsk::Watch {
                    device: tag,
                    period_ms,
                });
            } else {
                watched.track();
            }
        });
        // The overview is read once, when it is seen for the first time.
        let ready = memo(move || store.is_ready_for_overview());
        let asked = StoredValue::new(String::new());
        effect(move || {
            let tag = store.tag.get();
            if ready.get() && asked.with_value(|t| *t != tag) {
                asked.set_value(tag);
                let missing = store.site.with_untracked(|site| {
                    let mut all = overview::requests(&site.profile);
                    all.retain(|r| {
                        !site.kept.contains_key(&r.word()) && !site.failed.contains_key(&r.word())
                    });
                    if site.reading().is_some() {
                        Vec::new()
                    } else {
                        all
                    }
                });
                if !missing.is_empty() {
                    store.read(missing);
                }
            }
        });
    }

    fn is_ready_for_overview(self) -> bool {
        let shown = self.tab.with(|tab| tab.is_empty() || tab == "overview");
        let configured = self
            .site
            .with(|s| s.known && s.profile.registers.request.is_some());
        !self.tag.with(String::is_empty) && shown && configured && self.online.get()
    }

    fn hear(self, text: &str) {
        let Some(news) = wire::dop::read(text) else {
            return;
        };
        let about = device_of(&news);
        // The program may be closed by now.
        let Some(true) = self.tag.try_with_untracked(|tag| tag == about) else {
            return;
        };
        let start = self.guest.place.with_untracked(|p| p.start_wall_ms);
        self.site.update(|site| site.hear(&news, start));
    }

    fn send(self, ask: DopAsk) {
        self.guest.send(&wire::dop::write(&ask));
    }

    fn next_id(self) -> u32 {
        let id = self.next.get_value();
        self.next.set_value(id.wrapping_add(1));
        id
    }

    /// Reads objects of the device.
    pub fn read(self, requests: Vec<Request>) {
        let (id, device) = (self.next_id(), self.tag.get_untracked());
        self.site.update(|site| site.asked(id, &requests));
        self.send(DopAsk::Read {
            id,
            device,
            requests: requests.iter().map(|r| r.word()).collect(),
        });
    }

    /// Reads every object with every option.
    pub fn read_all(self) {
        let all = self.site.with_untracked(|site| all_requests(&site.profile));
        self.read(all);
    }

    /// Reads a log, or goes on where it stopped.
    pub fn read_log(self, object: u16, from_oldest: bool, resume: bool) {
        let (id, device) = (self.next_id(), self.tag.get_untracked());
        let mut after = None;
        let mut oldest = from_oldest;
        self.site.update(|site| {
            if resume {
                after = site.log(object).last_id();
                oldest = site.log(object).from_oldest;
            }
            site.asked_log(id, object, oldest, resume);
        });
        self.send(DopAsk::Log {
            id,
            device,
            object,
            from: if oldest {
                LogFrom::Oldest
            } else {
                LogFrom::Newest
            },
            after,
            limit: 0,
        });
    }

    /// Ends the job with this number.
    pub fn cancel(self, id: u32) {
        self.site.update(|site| site.cancelled(id));
        self.send(DopAsk::Cancel { id });
    }

    /// Changes the settings made here and remembers them.
    pub fn set_own(self, profile: Profile) {
        remember(PROFILE, &profile.to_json());
        self.own.set(Arc::new(profile));
    }

    /// The reads of the device, to be saved.
    #[must_use]
    pub fn saved(self) -> Saved {
        self.site.with_untracked(|site| Saved {
            device: self.tag.get_untracked(),
            reads: site.kept.values().cloned().collect(),
        })
    }

    /// Keeps the reads in the browser, to be compared with later ones.
    pub fn keep(self) {
        let saved = self.saved();
        remember(&kept_key(&saved.device), &saved.to_json());
        self.earlier.set(Some(Arc::new(saved)));
    }

    /// The chart of strokes over each other, if there are several.
    #[must_use]
    pub fn strokes(self, reads: &[&ObjectRead]) -> Vec<Chart> {
        let chart = self.quantity.with(|quantity| overlay(reads, quantity));
        chart.into_iter().collect()
    }

    /// An earlier read of a request.
    #[must_use]
    pub fn earlier_of(self, request: Request) -> Option<Kept> {
        self.earlier
            .with(|saved| saved.as_ref().and_then(|s| s.get(request).cloned()))
    }
}

/// Reads of a device that the browser has kept.
fn kept(tag: &str) -> Option<Arc<Saved>> {
    let text = remembered(&kept_key(tag)).filter(|_| !tag.is_empty())?;
    Saved::from_json(&text).ok().map(Arc::new)
}

fn kept_key(tag: &str) -> String {
    format!("dop.kept.{tag}")
}

const fn device_of(news: &DopNews) -> &String {
    match news {
        DopNews::Profile { device, .. }
        | DopNews::Progress { device, .. }
        | DopNews::Object { device, .. }
        | DopNews::Failed { device, .. }
        | DopNews::LogEnd { device, .. }
        | DopNews::Done { device, .. }
        | DopNews::Indicators { device, .. } => device,
    }
}

#[expect(clippy::cast_possible_truncation, reason = "seconds since 1970")]
fn wall_now() -> i64 {
    (js_sys::Date::now() / 1000.0) as i64
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
