//! Long work in slices, so that the page answers in between.

use std::cell::Cell;
use std::rc::Rc;

use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::JsFuture;

/// How long one slice of work may take, in milliseconds.
pub const SLICE_MS: f64 = 12.0;

/// Milliseconds on a clock that never goes back.
#[must_use]
pub fn now_ms() -> f64 {
    web_sys::window()
        .and_then(|w| w.performance())
        .map_or(0.0, |p| p.now())
}

/// Lets the browser draw and answer, then goes on.
pub async fn pause() {
    sleep(0).await;
}

/// Waits.
pub async fn sleep(millis: i32) {
    let promise = js_sys::Promise::new(&mut |resolve, _| {
        if let Some(window) = web_sys::window() {
            // Only fails if the function is none.
            let _infallible =
                window.set_timeout_with_callback_and_timeout_and_arguments_0(&resolve, millis);
        }
    });
    let _never_rejected = JsFuture::from(promise).await;
}

/// Waits for a promise; `None` if it was rejected.
pub async fn promise(promise: js_sys::Promise) -> Option<JsValue> {
    JsFuture::from(promise).await.ok()
}

/// Tells whether a piece of work is still wanted: starting another one ends it.
#[derive(Clone, Debug, Default)]
pub struct Turn(Rc<Cell<u32>>);

impl Turn {
    /// Ends the work under way and returns the sign of the next one.
    #[must_use]
    pub fn next(&self) -> Ticket {
        self.0.set(self.0.get().wrapping_add(1));
        Ticket {
            turn: Rc::clone(&self.0),
            number: self.0.get(),
        }
    }
}

/// The sign of one piece of work.
#[derive(Clone, Debug)]
pub struct Ticket {
    turn: Rc<Cell<u32>>,
    number: u32,
}

impl Ticket {
    /// True until other work begins or this is stopped.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.turn.get() == self.number
    }
}
