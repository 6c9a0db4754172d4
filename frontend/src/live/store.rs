//! The plant as signals: one connection, watches that follow the screen, a clock for ages.

use std::cell::Cell;
use std::rc::Rc;
use std::time::Duration;

use leptos::prelude::*;
use shared::proto::{Block, HART_PREFIX, PROGRAM_PREFIXES, ToBackend, ToPage};

use super::backoff::wait_ms;
use super::socket::{Event, Socket};
use crate::erased::{effect, memo};
use crate::router::Router;
use crate::state::overview;
use crate::state::plant::Plant;
use crate::state::route::Screen;
use crate::state::wire;
use crate::task::now_ms;

/// Period of watches, in milliseconds.
pub const PERIOD_MS: u32 = 1000;

/// A connection on which nothing came for so long is taken for dead.
const SILENCE_MS: f64 = 12_000.0;

/// State of the connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Conn {
    /// There is no backend to connect to, and why.
    Offline(&'static str),
    /// The first attempt.
    Connecting,
    /// Messages come.
    Connected,
    /// Lost, or never had; tried again. Milliseconds since 1970 when that began.
    Reconnecting(u64),
}

impl Conn {
    /// True while messages come.
    #[must_use]
    pub const fn is_up(&self) -> bool {
        matches!(self, Self::Connected)
    }
}

/// Blocks that a screen wants watched besides the overviews.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polled {
    /// Tag of the device.
    pub tag: String,
    /// What to read.
    pub blocks: Vec<Block>,
}

/// Hears the messages for a program that the page hosts.
type Ear = Rc<dyn Fn(&str)>;

#[derive(Default)]
struct Inner {
    socket: Option<Socket>,
    attempt: u32,
    heard: f64,
    /// The last `hello` as it came.
    hello: String,
    /// The program that the page hosts.
    ear: Option<Ear>,
}

/// The live side of the page.
#[derive(Clone, Copy, Debug)]
pub struct Live {
    /// What the backend has told.
    pub plant: RwSignal<Plant>,
    /// State of the connection.
    pub conn: RwSignal<Conn>,
    /// Microseconds since the start of the backend, twice a second.
    pub now: RwSignal<u64>,
    /// What the values tab polls.
    pub polled: RwSignal<Polled>,
    inner: StoredValue<Inner, LocalStorage>,
    dirty: StoredValue<Rc<Cell<bool>>, LocalStorage>,
}

impl Live {
    /// Connects, and makes the plant available.
    pub fn provide() -> Self {
        let live = Self {
            plant: RwSignal::new(Plant::default()),
            conn: RwSignal::new(Conn::Connecting),
            now: RwSignal::new(0),
            polled: RwSignal::new(Polled::default()),
            inner: StoredValue::new_local(Inner::default()),
            dirty: StoredValue::new_local(Rc::default()),
        };
        provide_context(live);
        match url() {
            Some(_) => live.connect(),
            None => live.conn.set(Conn::Offline(
                "This page was opened from a file, so there is no bridge. Decoding works.",
            )),
        }
        let clock = set_interval_with_handle(move || live.tick(), Duration::from_millis(500));
        on_cleanup(move || {
            if let Ok(clock) = clock {
                clock.clear();
            }
            let _gone = live.inner.try_update_value(|inner| inner.socket = None);
        });
        live.follow_screen();
        live
    }

    /// The live side of this page.
    #[must_use]
    pub fn get() -> Self {
        expect_context()
    }

    fn connect(self) {
        let Some(url) = url() else { return };
        let socket = Socket::open(&url, move |event| self.hear(event));
        let refused = socket.is_none();
        self.inner.update_value(|inner| {
            inner.heard = now_ms();
            inner.socket = socket;
        });
        if refused {
            self.retry();
        }
    }

    fn retry(self) {
        let since = match self.conn.try_get_untracked() {
            // The page is gone.
            None => return,
            Some(Conn::Reconnecting(since)) => since,
            Some(_) => wall_now(),
        };
        self.plant.update(Plant::lost);
        self.conn.set(Conn::Reconnecting(since));
        let attempt = self
            .inner
            .try_update_value(|inner| {
                inner.socket = None;
                inner.attempt = inner.attempt.saturating_add(1);
                inner.attempt - 1
            })
            .unwrap_or(0);
        let wait = wait_ms(attempt, js_sys::Math::random());
        set_timeout(
            move || {
                if self.inner.try_with_value(|i| i.socket.is_none()) == Some(true) {
                    self.connect();
                }
            },
            Duration::from_millis(u64::from(wait)),
        );
    }

    fn hear(self, event: Event) {
        if self.plant.try_with_untracked(|_| ()).is_none() {
            return;
        }
        let _gone = self.inner.try_update_value(|inner| inner.heard = now_ms());
        match event {
            Event::Open => self.send(&[Plant::hello()]),
            Event::Text(text) if is_for_program(&text) => {
                let mut changed = false;
                if text.starts_with(HART_PREFIX) {
                    self.plant
                        .update_untracked(|plant| changed = plant.hart(&text));
                }
                if changed {
                    self.notify_soon();
                }
                self.pass_on(&text);
            }
            Event::Text(text) => match wire::read(&text) {
                Ok(message) => self.take(message, text),
                Err(error) => {
                    let words = format!("A message of the backend was not understood: {error}");
                    self.plant.update(|plant| plant.refused = Some(words));
                }
            },
            // Called from the socket's own handler, which must not be dropped under it.
            Event::Closed => set_timeout(move || self.retry(), Duration::ZERO),
        }
    }

    fn take(self, message: ToPage, text: String) {
        let is_hello = matches!(message, ToPage::Hello { .. });
        if let ToPage::Capture { bus, .. } | ToPage::Lagged { bus, .. } = &message
            && self
                .plant
                .with_untracked(|plant| plant.bus(bus).is_some_and(|bus| !bus.is_known()))
        {
            self.pass_on(&text);
            return;
        }
        let mut answer = Vec::new();
        self.plant
            .update_untracked(|plant| answer = plant.take(message, now_ms()));
        self.send(&answer);
        if !is_hello {
            self.notify_soon();
            return;
        }
        let _gone = self.inner.try_update_value(|inner| {
            inner.attempt = 0;
            inner.hello.clone_from(&text);
        });
        self.conn.set(Conn::Connected);
        self.plant.notify();
        self.tick();
        self.pass_on(&text);
    }

    /// Tells the program that the page hosts.
    fn pass_on(self, text: &str) {
        let ear = self.inner.try_with_value(|inner| inner.ear.clone());
        if let Some(Some(ear)) = ear {
            ear(text);
        }
    }

    /// Calls `ear` with the last `hello`, and from now on with each message that is for the program
    /// that the page hosts.
    pub fn listen(self, ear: impl Fn(&str) + 'static) {
        let hello = self.inner.try_update_value(|inner| {
            inner.ear = Some(Rc::new(ear));
            inner.hello.clone()
        });
        if let Some(hello) = hello.filter(|hello| !hello.is_empty()) {
            self.pass_on(&hello);
        }
    }

    /// Ends [`listen`](Self::listen).
    pub fn deafen(self) {
        let _gone = self.inner.try_update_value(|inner| inner.ear = None);
    }

    /// Redraws once for all messages that come before the next frame of the screen.
    fn notify_soon(self) {
        let dirty = self.dirty.get_value();
        if !dirty.replace(true) {
            request_animation_frame(move || {
                dirty.set(false);
                // The page may be gone by now.
                if self.plant.try_with_untracked(|_| ()).is_some() {
                    self.plant.notify();
                }
            });
        }
    }

    fn tick(self) {
        let now = now_ms();
        let Some(backend) = self.plant.try_with_untracked(|plant| plant.now(now)) else {
            return;
        };
        self.now.set(backend);
        let dead = self
            .inner
            .try_with_value(|i| i.socket.is_some() && now - i.heard > SILENCE_MS);
        if dead == Some(true) {
            self.retry();
        }
    }

    /// Sends messages, if there is a connection.
    pub fn send(self, messages: &[ToBackend]) {
        let _gone = self.inner.try_with_value(|inner| {
            if let Some(socket) = &inner.socket {
                messages.iter().for_each(|m| socket.send(m));
            }
        });
    }

    /// Sends the message of a program that the page hosts, if there is a connection.
    pub fn send_text(self, text: &str) {
        let _gone = self.inner.try_with_value(|inner| {
            if let Some(socket) = &inner.socket {
                socket.send_text(text);
            }
        });
    }

    /// Reads blocks of a device once.
    pub fn read(self, tag: &str, blocks: Vec<Block>) {
        let mut sent = Vec::new();
        self.plant.update(|plant| sent = plant.read(tag, blocks));
        self.send(&sent);
    }

    /// Stops reading; what was asked already still comes.
    pub fn cancel(self, tag: &str) {
        self.plant.update(|plant| {
            if let Some(job) = plant.device_mut(tag).and_then(|d| d.job.as_mut()) {
                job.cancel();
            }
        });
    }

    /// Watches what the screen shows, and nothing while it shows nothing live.
    fn follow_screen(self) {
        let router = Router::get();
        let devices = memo(move || {
            self.plant.with(|plant| {
                let devices = plant.devices.iter();
                devices
                    .map(|d| (d.info.tag.clone(), d.device))
                    .collect::<Vec<_>>()
            })
        });
        let screen = memo(move || {
            let route = router.route();
            (route.is_live(), route.screen)
        });
        // On its own page a HART device is watched by its program.
        effect(move || {
            let up = self.conn.get().is_up();
            let (_, screen) = screen.get();
            let hart = devices.with(|devices| {
                let hart = devices.iter().filter(|(_, d)| d.family().is_some());
                hart.map(|(tag, _)| tag.clone()).collect::<Vec<_>>()
            });
            for tag in hart.iter().filter(|_| up) {
                if !matches!(&screen, Screen::Device(here, _) if here == tag) {
                    self.send_text(&wire::hart::watch_in_list(tag, screen == Screen::Devices));
                }
            }
        });
        effect(move || {
            let up = self.conn.get().is_up();
            let (is_live, screen) = screen.get();
            let polled = self.polled.get();
            let wanted = devices.with(|devices| {
                let devices = devices.iter().filter(|_| is_live && up);
                devices
                    .map(|(tag, device)| {
                        let mut blocks = overview::watched(*device);
                        let here = matches!(&screen, Screen::Device(here, _) if here == tag);
                        if here && polled.tag == *tag {
                            blocks.extend(&polled.blocks);
                        }
                        (tag.clone(), blocks, PERIOD_MS)
                    })
                    .filter(|(_, blocks, _)| !blocks.is_empty())
                    .collect()
            });
            if up {
                let mut sent = Vec::new();
                self.plant
                    .update_untracked(|plant| sent = plant.watch(wanted));
                self.send(&sent);
            }
        });
    }
}

/// True for a message that the page passes on unread.
fn is_for_program(text: &str) -> bool {
    PROGRAM_PREFIXES.iter().any(|p| text.starts_with(p))
}

/// Where the backend is; `None` for a page from a disk.
fn url() -> Option<String> {
    let location = location();
    let scheme = match location.protocol().ok()?.as_str() {
        "http:" => "ws",
        "https:" => "wss",
        _ => return None,
    };
    let host = location.host().ok().filter(|h| !h.is_empty())?;
    Some(format!("{scheme}://{host}/ws"))
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "milliseconds since 1970"
)]
fn wall_now() -> u64 {
    js_sys::Date::now() as u64
}
