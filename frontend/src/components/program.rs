//! A place for a program of its own that the page loads when it is wanted.

use std::sync::Arc;

use js_sys::{Function, Reflect};
use leptos::html::Div;
use leptos::prelude::*;
use leptos::task::spawn_local;
use shared::device::Device;
use wasm_bindgen::prelude::*;

use crate::browser::offset_minutes;
use crate::components::drawn::{Act, Draw, Drawn};
use crate::components::icon::Glyph;
use crate::decode_store::{DecodeStore, Input};
use crate::erased::{effect, memo};
use crate::live::Live;
use crate::markup::Markup;
use crate::markup::control::Button;
use crate::router::Router;
use crate::state::place::Place;
use crate::state::route::Screen;
use crate::task::{now_ms, promise};

/// The program of the diagnostic objects.
pub const DIAGNOSTICS: &str = "diagnostics";
/// The program of the HART devices.
pub const HART: &str = "hart";
/// The program of the DDC-100 networks.
pub const NETWORK: &str = "network";
/// The program of the ICON3000 in depth.
pub const ACTUATOR: &str = "actuator";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Loading,
    Open,
    Failed,
}

impl State {
    const fn key(self) -> &'static str {
        match self {
            Self::Loading => "loading",
            Self::Open => "open",
            Self::Failed => "failed",
        }
    }
}

/// A program that is open, as its `open` returned it. What it may call lives as long as it does.
struct Guest {
    handle: JsValue,
    _send: Closure<dyn Fn(String)>,
    _go: Closure<dyn Fn(String)>,
}

impl Guest {
    /// Calls a method of the program, if it has it.
    fn tell(&self, method: &str, text: &str) {
        if let Some(function) = function(&self.handle, method) {
            // A program that fails says so in the console.
            let _said = function.call1(&self.handle, &JsValue::from_str(text));
        }
    }

    /// Gives the program an input to decode.
    fn give(&self, name: &str, input: &JsValue) {
        if let Some(function) = function(&self.handle, "input") {
            let _said = function.call2(&self.handle, &JsValue::from_str(name), input);
        }
    }
}

impl Drop for Guest {
    fn drop(&mut self) {
        if let Some(function) = function(&self.handle, "close") {
            let _said = function.call0(&self.handle);
        }
    }
}

fn function(of: &JsValue, name: &str) -> Option<Function> {
    let found = Reflect::get(of, &JsValue::from_str(name)).ok()?;
    found.dyn_into().ok()
}

/// Loads a program; `None` if it can't be had now.
async fn load(name: &str) -> Option<JsValue> {
    let window = JsValue::from(web_sys::window()?);
    let load = function(&window, "valvescopeProgram")?;
    let loading = load.call1(&window, &JsValue::from_str(name)).ok()?;
    promise(loading.dyn_into().ok()?).await
}

/// Opens a program in an element.
fn open(
    program: &JsValue,
    host: &JsValue,
    place: &str,
    live: Live,
    router: Router,
) -> Option<Guest> {
    let open = function(program, "open")?;
    let send = Closure::<dyn Fn(String)>::new(move |text: String| live.send_text(&text));
    let go = Closure::<dyn Fn(String)>::new(move |hash: String| router.go_to(&hash));
    let place = JsValue::from_str(place);
    let arguments = js_sys::Array::of4(host, &place, send.as_ref(), go.as_ref());
    let handle = open.apply(program, &arguments).ok()?;
    Some(Guest {
        handle,
        _send: send,
        _go: go,
    })
}

/// Where the page is, for a program that shows a device; `None` while it is leaving for a place that
/// is not the program's.
fn place(live: Live, router: Router, device: Option<&String>) -> Option<Place> {
    let mut route = router.route();
    let tab = match (route.screen, device) {
        (Screen::Device(tag, tab), Some(device)) if tag == *device => tab,
        (Screen::Dop(tab) | Screen::Snapshots(tab) | Screen::Network(tab), None) => tab,
        (Screen::Traffic(bus), None) => {
            let first = || {
                live.plant
                    .with(|p| p.buses.first().map(|b| b.info.name.clone()))
            };
            let bus = bus.or_else(first).unwrap_or_default();
            route.query.push(("bus".to_owned(), bus));
            "bus".to_owned()
        }
        (Screen::Decode, None) => {
            let store: DecodeStore = expect_context();
            let device = store.device.get().map_or("", Device::key);
            for (key, value) in [
                ("framing", store.hosted.get().unwrap_or_default()),
                ("device", device),
            ] {
                route.query.push((key.to_owned(), value.to_owned()));
            }
            "decode".to_owned()
        }
        _ => return None,
    };
    let online = live.conn.get().is_up();
    let at = now_ms();
    let (now_us, start_wall_ms) = live
        .plant
        .with_untracked(|plant| (plant.now(at), plant.start_wall_ms));
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a positive number of milliseconds, far below 2^52"
    )]
    let at_ms = at.max(0.0) as u64;
    Some(Place {
        device: device.cloned(),
        tab,
        query: route.query,
        online,
        now_us,
        start_wall_ms,
        at_ms,
        offset_minutes: offset_minutes(start_wall_ms),
    })
}

/// Shows a program of its own: loads it, tells it where the page is and what the backend says.
#[component]
pub fn Program(
    /// Its name.
    name: &'static str,
    /// Tag of the device that it shows.
    device: Option<String>,
) -> impl IntoView {
    let (live, router) = (Live::get(), Router::get());
    let state = RwSignal::new(State::Loading);
    let host = NodeRef::<Div>::new();
    let guest: StoredValue<Option<Guest>, LocalStorage> = StoredValue::new_local(None);
    let place = memo(move || place(live, router, device.as_ref()));

    let begin = move || {
        let Some(host) = host.get_untracked() else {
            return;
        };
        state.set(State::Loading);
        spawn_local(async move {
            let program = load(name).await;
            // Another screen may be shown by now.
            let place = place.try_get_untracked().flatten();
            let Some(json) = place.as_ref().map(Place::to_json) else {
                return;
            };
            let opened = program.and_then(|program| open(&program, &host, &json, live, router));
            let Some(opened) = opened else {
                state.set(State::Failed);
                return;
            };
            guest.set_value(Some(opened));
            state.set(State::Open);
            live.listen(move |text| {
                let _gone = guest.try_with_value(|guest| {
                    if let Some(guest) = guest {
                        guest.tell("hear", text);
                    }
                });
            });
        });
    };
    effect(move || {
        if host.get().is_some() {
            begin();
        }
    });
    effect(move || {
        let json = place.with(|place| place.as_ref().map(Place::to_json));
        guest.with_value(|guest| {
            if let (Some(guest), Some(json)) = (guest, json) {
                guest.tell("place", &json);
            }
        });
    });
    // What the decode page leaves to the program.
    let decode: DecodeStore = expect_context();
    effect(move || {
        decode.hosted.track();
        if name != HART || state.get() != State::Open {
            return;
        }
        let Some((name, input)) = decode.input() else {
            return;
        };
        let input = match input {
            Input::Bytes(bytes) => js_sys::Uint8Array::from(bytes.as_slice()).into(),
            Input::File(file) => file.into(),
            Input::Sample(key) => JsValue::from_str(key),
        };
        guest.with_value(|guest| {
            if let Some(guest) = guest {
                guest.give(&name, &input);
            }
        });
    });
    on_cleanup(move || {
        live.deafen();
        // Taken out first: closing runs the program's own clean-up.
        let closed = guest.try_update_value(Option::take);
        drop(closed);
    });

    let draw: Draw = Arc::new(move |html: &mut Markup| match state.get() {
        State::Open => {}
        State::Loading => {
            html.node("p", "quiet", "Loading\u{2026}");
        }
        State::Failed => {
            html.open(
                "p",
                &[("class", "notice"), ("data-testid", "program-failed")],
            );
            html.text("This part of the page could not be loaded. It comes from the bridge that the page came from: check that valvescope is running there.");
            html.text(" ");
            Button {
                act: "retry",
                testid: "program-retry",
                words: "Try again",
                glyph: Some(Glyph::Poll),
                ..Button::default()
            }
            .draw(html);
            html.close("p");
        }
    });
    let on_act = Callback::new(move |_: Act| begin());
    view! {
        <div class="program" data-testid="program" data-state=move || state.get().key()>
            <Drawn class="" role="status" draw=draw on_act=on_act/>
            <div data-testid="program-host" node_ref=host></div>
        </div>
    }
}
