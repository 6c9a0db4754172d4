//! The page: bytes to meaning, offline and live.
//!
//! ```text
//!  address bar ──► router ──► pages/ ──► components/ ──► markup/
//!  paste, file ──► decode_store ─┐           ▲
//!  WebSocket ────► live ─────────┴─► state/ ─┘   plain Rust, tested natively
//! ```
//!
//! # Invariants
//!
//! - **State flows one way.** `state/` knows neither signals nor the browser; stores hold it in
//!   signals; components read it. Signals are reached through context newtypes only.
//! - **Bytes and fields are linked by one selection** ([`state::selection`]); who selected does not
//!   scroll.
//! - **Only what is in view is drawn.** Every list that can be long is a
//!   [`Windowed`](components::windowed::Windowed); its rows are [`markup`], all text escaped.
//! - **Everything shown live comes from captures** that the backend ships as bytes; the page decodes
//!   them by the same [`Session`](shared::session::Session) as everybody else.
//! - **Nothing here writes to a device**, and nothing decoded offline leaves the page.
//!
//! # Hooks for tests
//!
//! `data-testid` values are stable:
//!
//! | where | hooks |
//! |---|---|
//! | everywhere | `nav-decode`, `nav-devices`, `nav-network` (only with such a network), `nav-traffic`, `nav-settings`, `conn-state` (text), `read-only`, `conn-notice`, `help`, `page-decode`, `page-devices`, `page-device`, `page-traffic`, `page-settings` |
//! | a program of its own | `program` (`data-state` is `loading`, `open` or `failed`), `program-host`, `program-failed`, `program-retry`, `page-dop`, `dop-link`, `page-network`, `network-link` |
//! | decode | `paste`, `file`, `open-file`, `clear`, `decode-framing`, `decode-device`, `sample`, `sample-button` (`data-sample`), `found`, `cancel`, `frame-list`, `frame-row` (`data-index`, `data-role`), `problem-count`, `with-notes`, `problem` (`data-code`) |
//! | a frame | `frame-detail`, `frame-pair`, `frame-problem` (`data-code`), `hex-byte` (`data-offset`; class `marked` while hovered, `selected`), `field-row` (`data-path`; the same classes), `expand-all` (bits begin closed), `field-facts`, `copy-hex`, `copy-text`, `copy-json` |
//! | devices | `network-of-devices`, `device-list`, `device-row` (`data-tag`) |
//! | a device | `device-header`, `device-silent`, `tab-overview`, `tab-values`, `tab-traffic`, `overview`, `position`, `condition` (`data-key`) |
//! | values | `register-search`, `filter-table`, `filter-group`, `filter-access`, `filter-level`, `show-reserved`, `raw-form`, `sort-address`, `sort-name`, `sort-value`, `sort-age`, `nothing`, `widen`, `copy-row`, `register-list`, `register-row` (`data-address`, `data-table`, `data-key`), `register-value`, `register-age`, `register-detail`, `read-visible`, `read-all`, `read-selected`, `poll-visible`, `job`, `cancel-read` |
//! | traffic | `traffic-bus`, `traffic-list`, `frame-row`, `pause`, `clear-traffic`, `filter-unit`, `filter-function`, `filter-problems`, `export`, `traffic-count`, `missed` |
//! | settings | `theme-system`, `theme-light`, `theme-dark`, `download` |

#[cfg(feature = "icon")]
pub mod actuator;
pub mod app;
pub mod browser;
pub mod chart;
pub mod components;
pub mod decode_store;
pub mod dop;
pub mod erased;
pub mod format;
pub mod guest;
#[cfg(feature = "hart")]
pub mod hart;
pub mod keys;
pub mod live;
pub mod markup;
pub mod network;
pub mod pages;
pub mod program;
pub mod router;
pub mod state;
pub mod task;
pub mod theme;

pub use app::App;
