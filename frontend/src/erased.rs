//! Effects and memos whose closures are boxed.
//!
//! Leptos compiles the machinery around each effect and memo anew for each closure, over a
//! kilobyte a piece. Behind a box there is one machinery for all; nothing here runs often enough
//! for the call through the box to matter.

use leptos::prelude::{Effect, Memo};

/// Runs `work` now and whenever something that it read changes.
pub fn effect(work: impl Fn() + 'static) {
    let work: Box<dyn Fn()> = Box::new(work);
    Effect::new(move |_| work());
}

/// A value that is computed anew when something that it read changes.
pub fn memo<T>(work: impl Fn() -> T + Send + Sync + 'static) -> Memo<T>
where
    T: PartialEq + Send + Sync + 'static,
{
    let work: Box<dyn Fn() -> T + Send + Sync> = Box::new(work);
    Memo::new(move |_| work())
}
