//! The state of the connection, always in view.

use leptos::prelude::*;

use crate::browser::offset_minutes;
use crate::components::icon::{Glyph, Icon};
use crate::format::clock_seconds;
use crate::live::Live;
use crate::live::store::Conn;

/// Connected or not and since when, and whether anything can be written.
#[component]
pub fn ConnState() -> impl IntoView {
    let live = Live::get();
    let words = move || match live.conn.get() {
        Conn::Offline(_) => "Offline".to_owned(),
        Conn::Connecting => "Connecting".to_owned(),
        Conn::Connected => "Connected".to_owned(),
        Conn::Reconnecting(since) => format!(
            "Reconnecting since {}",
            clock_seconds(since, offset_minutes(since))
        ),
    };
    let title = move || match live.conn.get() {
        Conn::Offline(why) => why.to_owned(),
        Conn::Connected => live.plant.with(|p| p.app.clone()),
        _ => "Values may be stale until the connection is back.".to_owned(),
    };
    let read_only = move || live.conn.get().is_up() && live.plant.with(|p| p.read_only);
    view! {
        <div class="conn" class:down=move || !live.conn.get().is_up() title=title>
            <span role="status" data-testid="conn-state">
                {words}
            </span>
            <span class="read-only" data-testid="read-only" hidden=move || !read_only()>
                <Icon glyph=Glyph::Lock/>
                "Read-only"
            </span>
        </div>
    }
}

/// What keeps the live screens from showing anything, and what to do; nothing while all is well.
#[component]
pub fn ConnNotice() -> impl IntoView {
    let live = Live::get();
    let words = move || {
        let said = live
            .plant
            .with(|p| p.mismatch.clone().or_else(|| p.refused.clone()));
        match (live.conn.get(), said) {
            (_, Some(said)) => said,
            (Conn::Offline(why), _) => why.to_owned(),
            (Conn::Reconnecting(since), _) => format!(
                "No connection to the bridge since {}. Values are stale. It is tried again every few seconds; check that valvescope is running.",
                clock_seconds(since, offset_minutes(since))
            ),
            _ => String::new(),
        }
    };
    view! {
        <p
            class="notice"
            role="alert"
            data-testid="conn-notice"
            hidden=move || words().is_empty()
        >
            {words}
        </p>
    }
}
