//! The program of the diagnostic objects, loaded when somebody wants to see them.
//!
//! ```text
//!  guest (place, news) ──► store ──► pages/ ──► markup/, chart
//!  pasted registers ───────► state/ ─┘   │
//!                             picture, cards: what suits an object
//! ```
//!
//! # Invariants
//!
//! - **Registers are kept, meanings are made.** What is stored or saved are registers; a changed
//!   setting changes every picture at once.
//! - **What nobody set is marked.** A default of the profile shows as assumed wherever it decides.
//! - **Not read is not zero.** Objects that were not read, failed or are not there say so.
//!
//! # Hooks for tests
//!
//! | where | hooks |
//! |---|---|
//! | tabs | `dop-tab` (`data-tab`) |
//! | offline | `dop-paste`, `dop-file`, `dop-request`, `dop-word`, `dop-sample`, `dop-sample-button` (`data-sample`), `dop-found`, `dop-fits`, `dop-fit` (`data-word`, `aria-pressed`), `no-fit`, `dop-problem`, `found-read` (`data-index`), `dop-clear`, `dop-welcome` |
//! | an object | `object-view` (`data-request`), `object-how`, `object-why`, `object-error`, `object-problem` (`data-code`), `object-remark`, `assumptions`, `card`, `card-line` (`data-path`), `bit`, `register` (`data-offset`), `field-row` (`data-path`), `field-facts`, `quantity` (`data-key`), `read-object`, `save-read`, `copy-registers`, `differences`, `difference` (`data-path`); charts as [`chart`](crate::chart) says |
//! | objects of a device | `object-row` (`data-object`), `object-option` (`data-request`), `read-all-objects`, `cancel-objects`, `save-objects`, `keep-objects`, `open-earlier`, `earlier-file`, `forget-earlier`, `earlier-note`, `dop-job` |
//! | overview | `indicators`, `alarms`, `warnings`, `active-bit` (`data-bit`), `explained`, `panel` (`data-object`), `clock-deviation`, `read-overview` |
//! | logs | `log-1202`, `log-1203`, `log-newest`, `log-oldest`, `log-resume`, `log-cancel`, `log-csv`, `log-json`, `log-filter`, `log-category`, `log-status`, `log-list`, `log-row` (`data-id`) |
//! | settings | `setting` (`data-key`), `edit-profile`, `profile-<key>`, `profile-problem`, `text-problem`, `profile-text`, `profile-save`, `profile-file`, `profile-new`, `add-indicators`, `add-alarms`, `add-warnings`, `bit-row` |

pub mod cards;
pub mod markup;
pub mod pages;
pub mod picture;
#[cfg(test)]
pub(crate) mod registers;
pub mod state;
pub mod store;
pub mod when;

pub use pages::Diagnostics;
