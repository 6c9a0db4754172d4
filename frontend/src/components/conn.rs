//! The state of the connection, always in view.

use std::sync::Arc;

use leptos::prelude::*;

use crate::browser::offset_minutes;
use crate::components::drawn::{Draw, Drawn};
use crate::components::icon::Glyph;
use crate::format::clock_seconds;
use crate::live::Live;
use crate::live::store::Conn;
use crate::markup::Markup;

fn since(wall_ms: u64) -> String {
    clock_seconds(wall_ms, offset_minutes(wall_ms))
}

/// Connected or not and since when, and whether anything can be written.
#[component]
pub fn ConnState() -> impl IntoView {
    let live = Live::get();
    let draw: Draw = Arc::new(move |html: &mut Markup| {
        let conn = live.conn.get();
        let (app, read_only) = live.plant.with(|p| (p.app.clone(), p.read_only));
        let (words, title) = match conn {
            Conn::Offline(why) => ("Offline".to_owned(), why),
            Conn::Connecting => ("Connecting".to_owned(), ""),
            Conn::Connected => ("Connected".to_owned(), app.as_str()),
            Conn::Reconnecting(at) => (
                format!("Reconnecting since {}", since(at)),
                "Values may be stale until the connection is back.",
            ),
        };
        let class = if conn.is_up() { "conn" } else { "conn down" };
        html.open("div", &[("class", class), ("title", title)]);
        html.open("span", &[("role", "status"), ("data-testid", "conn-state")]);
        html.text(&words).close("span");
        if conn.is_up() && read_only {
            html.open(
                "span",
                &[("class", "read-only"), ("data-testid", "read-only")],
            );
            html.icon(Glyph::Lock).text("Read-only").close("span");
        }
        html.close("div");
    });
    view! { <Drawn class="" draw=draw/> }
}

/// What keeps the live screens from showing anything, and what to do; nothing while all is well.
#[component]
pub fn ConnNotice() -> impl IntoView {
    let live = Live::get();
    let draw: Draw = Arc::new(move |html: &mut Markup| {
        let said = live
            .plant
            .with(|p| p.mismatch.clone().or_else(|| p.refused.clone()));
        let words = match (said, live.conn.get()) {
            (Some(said), _) => said,
            (None, Conn::Offline(why)) => why.to_owned(),
            (None, Conn::Reconnecting(at)) => format!(
                "No connection to the bridge since {}. Values are stale. It is tried again every few seconds; check that valvescope is running.",
                since(at)
            ),
            _ => return,
        };
        html.open("p", &[("class", "notice"), ("data-testid", "conn-notice")]);
        html.text(&words).close("p");
    });
    view! { <Drawn class="notices" role="alert" draw=draw/> }
}
