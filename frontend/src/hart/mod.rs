//! The program of the HART devices, loaded when somebody wants to see one, or HART frames.
//!
//! ```text
//!  guest (input, place) ──► decode_store ──► components/decode_panes
//!  guest (place, news) ───► store ──► pages/ ──► markup/, chart
//! ```
//!
//! The first program has none of the tables of HART: it tells by the look of an input that it is
//! HART ([`is_hart`](shared::frame::is_hart)), and hands it on.
//!
//! # Invariants
//!
//! - **Exchanges are kept, meanings are made.** What the backend sends are frames as they were on
//!   the line; every value shown is decoded from them by [`shared::hart`].
//! - **Not read is not zero.** What was not read, was refused or is not answered says so.
//!
//! # Hooks for tests
//!
//! | where | hooks |
//! |---|---|
//! | decode | `hart-view` (`data-view`: `frames`, `procedures`, `map`), `hart-procedures`, `hart-run`, `hart-step` (`data-key`), `hart-open-run`, and those of the decode page |
//! | tabs | `hart-tab` (`data-tab`) |
//! | a value | `hart-value` (`data-key`: command and field), `value-facts` |
//! | above the tabs | `hart-forced` |
//! | overview | `hart-overview`, `hart-position`, `hart-state`, `hart-answered`, `hart-ne107`, `hart-set` (`data-key`), `hart-trend` |
//! | other tabs | `hart-setup`, `hart-unavailable`, `hart-variables`, `hart-status`, `hart-ne107`, `hart-result`, `hart-byte`, `hart-bit` (`data-key`, `data-on`), `hart-read`, `hart-job`, `hart-cancel` |
//! | status map | `hart-map-page`, `hart-map-view`, `hart-map`, `hart-map-row` (`data-index`, `data-category`), `hart-map-source`, `hart-map-beside`, `hart-map-family`, `hart-map-status`, `hart-map-save`, `hart-map-file`, `hart-result` |
//! | a line | `hart-bus`, `hart-link`, `hart-scan`, `hart-tag`, `hart-find`, `hart-find-long`, `hart-search`, `hart-found`, and those of the traffic |

pub mod markup;
mod pages;
pub mod state;
pub mod store;

pub use pages::Hart;
