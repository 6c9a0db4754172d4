//! The inside of a program that the page hosts: what it is told, and whom it can ask.
//!
//! ```text
//!  page (components::program)              program (src/bin)
//!   window.valvescopeProgram(name) ──────► loaded once
//!   open(host, place, send, go) ─────────► Guest, a view in `host`
//!   handle.place(json), hear(text) ──────► Guest::place, Guest::listen
//!   handle.input(name, bytes) ───────────► Guest::on_input
//!   socket, address bar ◄──────────────── Guest::send, Guest::go
//! ```

use std::rc::Rc;

use leptos::prelude::*;
use wasm_bindgen::JsValue;

use crate::state::place::Place;
use crate::task::now_ms;

type Ear = Rc<dyn Fn(&str)>;
type Opener = Rc<dyn Fn(&str, &JsValue)>;

/// What the page lets a program do.
#[derive(Debug)]
pub struct Host {
    send: js_sys::Function,
    go: js_sys::Function,
}

impl Host {
    /// From the two functions that the page hands over.
    #[must_use]
    pub const fn new(send: js_sys::Function, go: js_sys::Function) -> Self {
        Self { send, go }
    }
}

#[derive(Default)]
struct Heard {
    ear: Option<Ear>,
    /// What came before anybody listened.
    early: Vec<String>,
    opener: Option<Opener>,
    /// The last input that came before anybody wanted one.
    input: Option<(String, JsValue)>,
}

/// A program's side of the page. Belongs to the owner under which it was made.
#[derive(Clone, Copy)]
pub struct Guest {
    /// Where the page is.
    pub place: RwSignal<Place>,
    host: StoredValue<Host, LocalStorage>,
    heard: StoredValue<Heard, LocalStorage>,
}

impl core::fmt::Debug for Guest {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Guest")
    }
}

impl Guest {
    /// Begins at a place, given as JSON, and makes itself available as a context.
    #[must_use]
    pub fn provide(place: &str, host: Host) -> Self {
        let guest = Self {
            place: RwSignal::new(Place::from_json(place).unwrap_or_default()),
            host: StoredValue::new_local(host),
            heard: StoredValue::new_local(Heard::default()),
        };
        provide_context(guest);
        guest
    }

    /// The program's side of the page.
    #[must_use]
    pub fn get() -> Self {
        expect_context()
    }

    /// The address or the connection changed.
    pub fn move_to(self, place: &str) {
        if let Some(place) = Place::from_json(place) {
            // The program may be closed already.
            let _gone = self.place.try_set(place);
        }
    }

    /// A message of the backend came.
    pub fn hear(self, text: &str) {
        let ear = self.heard.try_update_value(|heard| {
            if heard.ear.is_none() {
                heard.early.push(text.to_owned());
            }
            heard.ear.clone()
        });
        if let Some(Some(ear)) = ear {
            ear(text);
        }
    }

    /// Calls `ear` with each message of the backend, those that came before it included: the
    /// `hello`, what begins as [`PROGRAM_PREFIXES`](shared::proto::PROGRAM_PREFIXES) say, and the
    /// captures of buses whose framing the page does not know.
    pub fn listen(self, ear: impl Fn(&str) + 'static) {
        let ear: Ear = Rc::new(ear);
        let early = self.heard.try_update_value(|heard| {
            heard.ear = Some(Rc::clone(&ear));
            core::mem::take(&mut heard.early)
        });
        early.iter().flatten().for_each(|text| ear(text));
    }

    /// An input to decode came: bytes, a file, or as a text the key of a sample.
    pub fn open(self, name: &str, input: &JsValue) {
        let opener = self.heard.try_update_value(|heard| {
            if heard.opener.is_none() {
                heard.input = Some((name.to_owned(), input.clone()));
            }
            heard.opener.clone()
        });
        if let Some(Some(opener)) = opener {
            opener(name, input);
        }
    }

    /// Calls `open` with each input to decode, one that came before included.
    pub fn on_input(self, open: impl Fn(&str, &JsValue) + 'static) {
        let open: Opener = Rc::new(open);
        let early = self.heard.try_update_value(|heard| {
            heard.opener = Some(Rc::clone(&open));
            heard.input.take()
        });
        if let Some(Some((name, input))) = early {
            open(&name, &input);
        }
    }

    /// Sends a message to the backend, as JSON. It is lost while there is no connection.
    pub fn send(self, text: &str) {
        // The program may be closing.
        let _gone = self.host.try_with_value(|host| call(&host.send, text));
    }

    /// Goes to an address of the page, from `#` on.
    pub fn go(self, hash: &str) {
        self.host.with_value(|host| call(&host.go, hash));
    }

    /// Microseconds of the backend's clock now; 0 if it never told. Does not follow anything.
    #[must_use]
    pub fn now_us(self) -> u64 {
        self.place.with_untracked(|place| {
            if place.now_us == 0 {
                return 0;
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a positive number of milliseconds, far below 2^52"
            )]
            let now = now_ms().max(0.0) as u64;
            let passed = now.saturating_sub(place.at_ms).saturating_mul(1000);
            place.now_us.saturating_add(passed)
        })
    }
}

fn call(function: &js_sys::Function, text: &str) {
    // The page's functions do not throw.
    let _infallible = function.call1(&JsValue::NULL, &JsValue::from_str(text));
}
