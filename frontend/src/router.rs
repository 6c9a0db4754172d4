//! The address bar and the page, kept in step.

use leptos::ev;
use leptos::prelude::*;

use crate::erased::memo;
use crate::state::route::{Route, Screen};

/// Where the page is.
#[derive(Clone, Copy, Debug)]
pub struct Router(RwSignal<Route>);

impl Router {
    /// Follows the address bar and makes the router available.
    pub fn provide() -> Self {
        let hash = || location().hash().unwrap_or_default();
        let route = RwSignal::new(Route::parse(&hash()));
        let listener = window_event_listener(ev::hashchange, move |_| {
            let next = Route::parse(&hash());
            if route.with_untracked(|r| *r != next) {
                route.set(next);
            }
        });
        on_cleanup(move || listener.remove());
        let router = Self(route);
        provide_context(router);
        router
    }

    /// The router of this page.
    #[must_use]
    pub fn get() -> Self {
        expect_context()
    }

    /// Follows the route.
    #[must_use]
    pub fn route(self) -> Route {
        self.0.get()
    }

    /// Looks at the route without following it.
    #[must_use]
    pub fn peek(self) -> Route {
        self.0.get_untracked()
    }

    /// Follows the screen only.
    #[must_use]
    pub fn screen(self) -> Memo<Screen> {
        memo(move || self.0.with(|r| r.screen.clone()))
    }

    /// Follows one setting.
    #[must_use]
    pub fn setting(self, key: &'static str) -> Memo<String> {
        memo(move || self.0.with(|r| r.get(key).unwrap_or_default().to_owned()))
    }

    /// Goes somewhere; the browser's "back" leads here again.
    pub fn go(self, route: &Route) {
        // Fails only for addresses that are none.
        let _infallible = location().set_hash(&route.to_string());
    }

    /// The same for an address as text, from `#` on.
    pub fn go_to(self, hash: &str) {
        let _infallible = location().set_hash(hash);
    }

    /// Changes a setting of this screen in the address, without a new entry in the history.
    pub fn set(self, key: &str, value: &str) {
        let next = self.peek().with(key, value);
        if next == self.peek() {
            return;
        }
        let text = next.to_string();
        self.0.set(next);
        // Replacing the fragment does not load anything.
        let _infallible = location().replace(&text);
    }
}
