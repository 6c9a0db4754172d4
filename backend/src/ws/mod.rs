//! The WebSocket: who may open it, and what is said over it.

mod hosts;
mod session;

pub use hosts::Hosts;

use crate::app::App;
use crate::http::plain;
use axum::body::Body;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::http::{HeaderMap, Response, StatusCode};
use shared::proto::MAX_MESSAGE;
use std::sync::Arc;

/// Refuses pages of other origins before the upgrade: any page in the same browser can reach a
/// port of this computer.
pub(crate) async fn upgrade(
    State(app): State<App>,
    headers: HeaderMap,
    socket: WebSocketUpgrade,
) -> Response<Body> {
    if let Err(why) = app.hosts.admit(&headers) {
        tracing::warn!("refused a connection: {why}");
        return plain(StatusCode::FORBIDDEN, why);
    }
    let Ok(seat) = Arc::clone(&app.seats).try_acquire_owned() else {
        return plain(
            StatusCode::SERVICE_UNAVAILABLE,
            "Too many pages are connected; close one.\n",
        );
    };
    socket
        .max_message_size(MAX_MESSAGE)
        .max_frame_size(MAX_MESSAGE)
        .read_buffer_size(4096)
        .write_buffer_size(0)
        .on_upgrade(async move |socket| {
            session::run(socket, &app.plant).await;
            drop(seat);
        })
}
