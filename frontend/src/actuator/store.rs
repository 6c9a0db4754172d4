//! What the program knows, as signals: the device on the line, saved devices, the clock.

mod site;

use std::cell::RefCell;
use std::sync::Arc;
use std::time::Duration;

use leptos::prelude::*;
use shared::device::Device;
use shared::proto::{IconAsk, ToPage};

use super::state::dossier::Dossier;
use super::state::job::Job;
use super::state::wanted::Wanted;
use crate::erased::{effect, memo};
use crate::guest::Guest;
use crate::state::wire;

pub use site::Site;
use site::device_of;

thread_local! {
    /// What stays while the program is not shown: the page closes it with every change of screen,
    /// and reading a device anew takes minutes on a slow line.
    static KEPT: RefCell<Kept> = const { RefCell::new(Kept { sites: Vec::new(), saved: Vec::new() }) };
}

#[derive(Default)]
struct Kept {
    sites: Vec<Site>,
    saved: Vec<Saved>,
}

/// A saved device that is open.
#[derive(Clone, Debug)]
pub struct Saved {
    /// What it says.
    pub dossier: Arc<Dossier>,
    /// What is wrong with its file.
    pub problems: Vec<String>,
}

/// The store.
#[derive(Clone, Copy, Debug)]
pub struct Store {
    guest: Guest,
    /// Tag of the device on the line, empty for saved ones.
    pub tag: Memo<String>,
    /// The open tab.
    pub tab: Memo<String>,
    /// True while there is a connection.
    pub online: Memo<bool>,
    /// The device on the line.
    pub site: RwSignal<Site>,
    /// Saved devices that are open.
    pub saved: RwSignal<Vec<Saved>>,
    /// Seconds since 1970, once a second.
    pub now: RwSignal<i64>,
    /// Microseconds of the backend's clock, once a second.
    pub now_us: RwSignal<u64>,
    next: StoredValue<u32>,
    /// The last `hello`: what it says of a device is needed again when another is shown.
    greeting: StoredValue<Option<ToPage>>,
}

impl Store {
    /// Listens to the page and makes the store available.
    pub fn provide() -> Self {
        let guest = Guest::get();
        let place = guest.place;
        let saved = KEPT.with_borrow(|kept| kept.saved.clone());
        let store = Self {
            guest,
            tag: memo(move || place.with(|p| p.device.clone().unwrap_or_default())),
            tab: memo(move || place.with(|p| p.tab.clone())),
            online: memo(move || place.with(|p| p.online)),
            site: RwSignal::new(kept(
                &place.with_untracked(|p| p.device.clone().unwrap_or_default()),
            )),
            saved: RwSignal::new(saved),
            now: RwSignal::new(wall_now()),
            now_us: RwSignal::new(guest.now_us()),
            next: StoredValue::new(first_id()),
            greeting: StoredValue::new(None),
        };
        provide_context(store);
        let clock = set_interval_with_handle(
            move || {
                store.now.set(wall_now());
                store.now_us.set(guest.now_us());
                store.give_up();
            },
            Duration::from_secs(1),
        );
        on_cleanup(move || {
            if let Ok(clock) = clock {
                clock.clear();
            }
            store.keep();
        });
        // Effects run after the first messages were heard, so this must not undo what they said.
        effect(move || {
            let tag = store.tag.get();
            if store.site.with_untracked(|s| s.dossier.tag != tag) {
                store.visit(&tag);
            }
        });
        guest.listen(move |text| store.hear(text));
        effect(move || {
            if !store.online.get() {
                store.site.update(Site::lost);
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
    pub fn query(self, key: &str) -> Option<String> {
        self.guest.place.with(|p| p.get(key).map(str::to_owned))
    }

    /// Goes to an address of the page.
    pub fn go(self, hash: &str) {
        self.guest.go(hash);
    }

    /// True if the device on the line is shown, not a saved one.
    #[must_use]
    pub fn is_live(self) -> bool {
        self.tag.with(|tag| !tag.is_empty())
    }

    /// The address of a tab of what is shown.
    #[must_use]
    pub fn address(self, tab: &str, query: &str) -> String {
        let tag = self.tag.get();
        let mut address = if tag.is_empty() {
            format!("#/snapshots/{tab}?of={}", self.index().unwrap_or(0))
        } else {
            format!("#/device/{}/{tab}", crate::format::encode(&tag))
        };
        if !query.is_empty() {
            address.push(if tag.is_empty() { '&' } else { '?' });
            address.push_str(query);
        }
        address
    }

    /// Which saved device the address names.
    #[must_use]
    pub fn index(self) -> Option<usize> {
        self.query("of")?.parse().ok()
    }

    /// Looks at the device that is shown, and follows it.
    pub fn with<T>(self, look: impl FnOnce(&Dossier) -> T) -> T {
        if self.is_live() {
            return self.site.with(|site| look(&site.dossier));
        }
        let at = self.index().unwrap_or(0);
        self.saved.with(|saved| match saved.get(at) {
            Some(saved) => look(&saved.dossier),
            None => look(&Dossier::default()),
        })
    }

    /// Turns to a device on the line, whatever the address says, and keeps what is known of the one
    /// before.
    pub fn visit(self, tag: &str) {
        if self.site.with_untracked(|s| s.dossier.tag != tag) {
            self.keep();
            self.site.set(kept(tag));
            self.greet();
        }
    }

    fn hear(self, text: &str) {
        if let Some(news) = wire::icon::read(text) {
            let now = self.guest.now_us();
            // The program may be closed by now.
            let next = self.site.try_update(|site| {
                let ours = *device_of(&news) == site.dossier.tag;
                ours.then(|| site.hear(&news, self.next, now)).flatten()
            });
            if let Some(ask) = next.flatten() {
                self.send(&ask);
            }
        } else if let Ok(hello @ ToPage::Hello { .. }) = wire::read(text) {
            self.greeting.set_value(Some(hello));
            self.greet();
        }
    }

    /// Tells the device that is shown what the last `hello` says of it.
    fn greet(self) {
        self.greeting.with_value(|greeting| {
            if let Some(ToPage::Hello {
                now_us,
                wall_ms,
                devices,
                ..
            }) = greeting
            {
                let start = wall_ms.saturating_sub(now_us / 1000);
                self.site.update(|site| {
                    let found = devices.iter().find(|d| d.tag == site.dossier.tag);
                    let device = found.and_then(|d| Some((Device::from_key(&d.kind)?, d.unit)));
                    site.greeted(device, start);
                });
            }
        });
    }

    /// Ends a read of which nothing is heard any more.
    fn give_up(self) {
        let now = self.guest.now_us();
        let stuck = |site: &Site| site.job.as_ref().is_some_and(|job| job.is_stuck(now));
        if self.site.with_untracked(stuck) {
            self.cancel();
            self.site.update(|site| {
                site.stop("The bridge did not answer for a minute, so the read was ended.");
            });
        }
    }

    fn send(self, ask: &IconAsk) {
        self.guest.send(&wire::icon::write(ask));
    }

    fn next_id(self) -> u32 {
        let id = self.next.get_value();
        self.next.set_value(id.wrapping_add(1));
        id
    }

    /// Reads all of these anew.
    pub fn read(self, wanted: Wanted) {
        if !wanted.quiet {
            self.site.update(|site| site.broken = None);
        }
        self.begin(wanted, self.guest.now_us());
    }

    /// Reads what of these was never read.
    pub fn fill(self, wanted: Wanted) {
        self.begin(wanted, 0);
    }

    /// Goes on with a read that was ended.
    pub fn resume(self) {
        let broken = self.site.try_update(|site| site.broken.take()).flatten();
        if let Some((wanted, since)) = broken {
            // What failed then is tried again, and is on the list until it is answered.
            self.site.update(|site| {
                let failed = site.dossier.failed.values_mut();
                failed.for_each(|failure| failure.again = true);
            });
            self.begin(wanted, since);
        }
    }

    fn begin(self, wanted: Wanted, since: u64) {
        if !self.online.get_untracked() {
            return;
        }
        let under_way = |s: &Site| s.job.as_ref().map(|job| (job.id, job.wanted.quiet));
        match self.site.with_untracked(under_way) {
            Some((id, true)) if !wanted.quiet => self.send(&IconAsk::Cancel { id }),
            Some(_) => return,
            None => {}
        }
        let (id, now) = (self.next_id(), self.guest.now_us());
        let ask = self.site.try_update(|site| {
            site.saving &= wanted.quiet;
            site.job = Job::new(id, wanted, &site.dossier, since, now);
            let job = site.job.as_ref()?;
            Some(IconAsk::Read {
                id,
                device: site.dossier.tag.clone(),
                steps: job.steps().to_vec(),
            })
        });
        if let Some(ask) = ask.flatten() {
            self.send(&ask);
        }
    }

    /// Ends the read under way.
    pub fn cancel(self) {
        let mut id = None;
        self.site.update(|site| {
            if let Some(job) = &mut site.job {
                job.cancelled = true;
                id = Some(job.id);
            }
        });
        if let Some(id) = id {
            self.send(&IconAsk::Cancel { id });
        }
    }

    /// Opens a saved device.
    pub fn open(self, dossier: Dossier, problems: Vec<String>) {
        let dossier = Arc::new(dossier);
        self.saved
            .update(|saved| saved.push(Saved { dossier, problems }));
    }

    /// Closes a saved device.
    pub fn close(self, at: usize) {
        self.saved.update(|saved| {
            if at < saved.len() {
                saved.remove(at);
            }
        });
    }

    /// Devices on the line that were read since the page was opened.
    #[must_use]
    pub fn sites(self) -> Vec<Arc<Dossier>> {
        KEPT.with_borrow(|kept| {
            let sites = kept.sites.iter();
            sites.map(|s| Arc::new(s.dossier.clone())).collect()
        })
    }

    /// Keeps what is known for the next time the program is shown. A read under way is ended: what
    /// comes of it would be heard by nobody.
    fn keep(self) {
        let site = self.site.try_update_untracked(core::mem::take);
        let saved = self.saved.try_get_untracked().unwrap_or_default();
        let mut site = site.unwrap_or_default();
        if let Some(job) = &site.job {
            self.send(&IconAsk::Cancel { id: job.id });
        }
        site.stop("");
        KEPT.with_borrow_mut(|kept| {
            kept.saved = saved;
            if !site.dossier.tag.is_empty() {
                kept.sites.retain(|s| s.dossier.tag != site.dossier.tag);
                kept.sites.push(site);
            }
        });
    }
}

/// What is known of a device from an earlier visit, or a device of which nothing is known.
fn kept(tag: &str) -> Site {
    let kept = KEPT.with_borrow(|kept| kept.sites.iter().find(|s| s.dossier.tag == tag).cloned());
    kept.unwrap_or_else(|| Site {
        dossier: Dossier::new(tag, Device::None),
        ..Site::default()
    })
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
