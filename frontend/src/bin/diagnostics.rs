//! The second program of the page, loaded when somebody wants to see diagnostic objects.
//!
//! The page calls `open` and speaks to what it returns; [`frontend::guest`] says how.

use frontend::browser::provide_narrow;
use frontend::dop::Diagnostics;
use frontend::guest::{Guest, Host};
use leptos::mount::{UnmountHandle, mount_to};
use leptos::prelude::*;
use wasm_bindgen::prelude::*;
use web_sys::HtmlElement;

/// Nothing runs before the page asks for it.
fn main() {
    console_error_panic_hook::set_once();
}

/// Puts the program into an element of the page.
///
/// `place` is a [`Place`](frontend::state::place::Place) as JSON, `send` takes a message to the
/// backend, `go` an address from `#` on.
#[wasm_bindgen]
#[must_use]
pub fn open(
    host: HtmlElement,
    place: &str,
    send: js_sys::Function,
    go: js_sys::Function,
) -> Handle {
    let owner = Owner::new();
    let guest = owner.with(|| Guest::provide(place, Host::new(send, go)));
    let mounted = mount_to(host, move || {
        provide_context(guest);
        provide_narrow();
        view! { <Diagnostics/> }.into_any()
    });
    Handle {
        guest,
        _mounted: mounted,
        _owner: owner,
    }
}

/// What the page holds while the program is shown.
#[wasm_bindgen]
pub struct Handle {
    guest: Guest,
    _mounted: UnmountHandle<<AnyView as Render>::State>,
    _owner: Owner,
}

impl core::fmt::Debug for Handle {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str("Handle")
    }
}

#[wasm_bindgen]
impl Handle {
    /// A message of the backend: `hello`, or one that begins with `{"dop":`.
    pub fn hear(&self, text: &str) {
        self.guest.hear(text);
    }

    /// The address or the connection changed.
    pub fn place(&self, json: &str) {
        self.guest.move_to(json);
    }

    /// Takes the program out of the page.
    pub fn close(self) {
        drop(self);
    }
}
