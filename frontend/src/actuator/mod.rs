//! The program of the ICON3000 in depth, loaded when somebody wants to see more than its registers.
//!
//! ```text
//!  guest (place, news) ──► store ──► pages/ ──► markup/, chart
//!  saved device ─────────► state::dossier ─┘
//! ```
//!
//! # Invariants
//!
//! - **Words are kept, meanings are made.** A device on the line and one from a file are the same
//!   [`Dossier`](state::dossier::Dossier), shown by the same screens.
//! - **Not read is not zero.** What was not read, failed or is not there says so.
//! - **Nothing here writes to a device.**
//!
//! # Hooks for tests
//!
//! | where | hooks |
//! |---|---|
//! | everywhere | `icon-read`, `icon-cancel`, `icon-resume`, `icon-job` (text), `icon-failed` (`data-subject`), `icon-nothing` |
//! | toolbar | `icon-save`, `icon-gaps` (what is missing), `icon-save-gaps`, `icon-whole` |
//! | health, words, identity, counters | `read-at` |
//! | logs | `log-raw` |
//! | strokes | `stroke-raw` |
//! | snapshots | `compare-fresh` |
//! | rows | `icon-row` (`data-address`, `data-key`, `data-quality`), in it `icon-value` |

pub mod markup;
pub mod pages;
pub mod state;
pub mod store;

pub use pages::Actuator;
