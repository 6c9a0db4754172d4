//! The web application: the page, and the WebSocket that feeds it.

use crate::plant::Plant;
use crate::ws;
use axum::Router;
use axum::http::StatusCode;
use axum::routing::get;
use std::sync::Arc;
use tokio::sync::Semaphore;

/// Pages that may be connected at once.
const MAX_CLIENTS: usize = 64;

/// What the handlers share. Cheap to clone.
#[derive(Clone, Debug)]
pub struct App {
    pub(crate) plant: Arc<Plant>,
    pub(crate) hosts: Arc<ws::Hosts>,
    pub(crate) seats: Arc<Semaphore>,
}

impl App {
    /// An application for a plant that runs; `hosts` says under which names it may be opened.
    #[must_use]
    pub fn new(plant: Arc<Plant>, hosts: ws::Hosts) -> Self {
        Self {
            plant,
            hosts: Arc::new(hosts),
            seats: Arc::new(Semaphore::new(MAX_CLIENTS)),
        }
    }
}

/// All routes.
pub fn app(state: App) -> Router {
    Router::new()
        .route("/ws", get(ws::upgrade))
        .fallback(get(crate::http::file))
        .method_not_allowed_fallback(|| async {
            crate::http::plain(
                StatusCode::METHOD_NOT_ALLOWED,
                "Only GET is answered here.\n",
            )
        })
        .with_state(state)
}
