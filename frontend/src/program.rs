//! What every program that the page hosts exports.

/// Exports a component as a program of its own: what a binary in `src/bin` consists of.
///
/// The page calls `open` and speaks to what it returns; [`guest`](crate::guest) says how.
#[macro_export]
macro_rules! program {
    ($view:path) => {
        use ::leptos::mount::{UnmountHandle, mount_to};
        use ::leptos::prelude::*;
        use ::wasm_bindgen::prelude::*;
        use $crate::guest::{Guest, Host};

        /// Nothing runs before the page asks for it.
        fn main() {
            ::console_error_panic_hook::set_once();
        }

        /// Puts the program into an element of the page.
        ///
        /// `place` is a [`Place`]($crate::state::place::Place) as JSON, `send` takes a message to
        /// the backend, `go` an address from `#` on.
        #[wasm_bindgen]
        #[must_use]
        pub fn open(
            host: ::web_sys::HtmlElement,
            place: &str,
            send: ::js_sys::Function,
            go: ::js_sys::Function,
        ) -> Handle {
            let owner = Owner::new();
            let guest = owner.with(|| Guest::provide(place, Host::new(send, go)));
            let mounted = mount_to(host, move || {
                provide_context(guest);
                $crate::browser::provide_narrow();
                $view().into_any()
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

        impl ::core::fmt::Debug for Handle {
            fn fmt(&self, f: &mut ::core::fmt::Formatter<'_>) -> ::core::fmt::Result {
                f.write_str("Handle")
            }
        }

        #[wasm_bindgen]
        impl Handle {
            /// A message of the backend that is for programs.
            pub fn hear(&self, text: &str) {
                self.guest.hear(text);
            }

            /// The address or the connection changed.
            pub fn place(&self, json: &str) {
                self.guest.move_to(json);
            }

            /// An input to decode: its name, and a text, bytes, a file, or the key of a sample.
            pub fn input(&self, name: &str, input: &JsValue) {
                self.guest.open(name, input);
            }

            /// Takes the program out of the page.
            pub fn close(self) {
                drop(self);
            }
        }
    };
}
