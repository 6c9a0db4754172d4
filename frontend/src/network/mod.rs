//! The program of the DDC-100 networks, loaded when somebody wants to see one.
//!
//! ```text
//!  guest (place, news) ──► store ──► pages/ ──► markup/
//!                             │                    ▲
//!                             └──► state/ ─────────┘   net, picture, cable, table, tags, typed …
//! ```
//!
//! # Invariants
//!
//! - **What the host found and what a unit reports are kept apart.** The faults of the poller stand
//!   beside bits 10 and 11 of register 9 and never replace them.
//! - **Grey is normal.** The drawing has colour, sign and letter only where something is wrong; how
//!   far the signal of a port gets is told by the kind of line.
//! - **Nothing here commands a unit.** The checklist says whether one could; there is no message that
//!   would.
//!
//! # Hooks for tests
//!
//! | where | hooks |
//! |---|---|
//! | tabs | `net-tab` (`data-tab`), `other-network`, `no-network` |
//! | diagnosis | `finding` (`data-key`, `data-certain`), `caution` |
//! | the drawing | `ring` (a list for those who do not see it), `node` (`data-unit`, `data-at`), `break` (`data-from`, `data-to`: stretches of the cable from 0; `data-kind` is `certain` or `possible`), `poll` (`data-port`), narrow: `cable-list`, `line-unit` |
//! | ports and polling | `port` (`data-port`, `data-state`), `poll-now`, `passes`, `pass-table`, `chosen-unit` (`data-unit`), `open-unit` |
//! | lately | `lately`, `log`, `log-row`, `copy-log`, `save-log` |
//! | all units | `order-units`, `order-down`, `unit-search`, `only-faults`, `unit-count`, `copy-units`, `save-units`, `sort-<column>`, `unit-list`, `unit-row` (`data-unit`; in it `data-bit` is `host-a`, `host-b`, `own-a`, `own-b`) |
//! | a unit | `unit`, `unit-position`, `unit-state`, `unit-reach`, `to-network`, `unit-before`, `unit-after`, `card-age`, `overwritten`, `unit-fault` and `old-fault` (`data-key`), `would-be`, `software`, `watched`, `checklist`, `wish`, `wish-percent`, `verdict` (`data-verdict`), `check-item` (`data-key`, `data-verdict`), `analog`, `scaling`, `analog-row`, `status`, `inputs`, `outputs`, `timers`, `user-faults`, `differences`, `counters`, `read-counters`, `counter` (`data-sub`), `read-registers`, `read-state`, `registers` |
//! | tag list | `tags`, `tags-file`, `tags-paste`, `export-tags`, `forget-tags`, `import-said`, `tag-problem` (`data-line`, `data-column`), `tag-table`, `tag-row` (`data-unit`), `tag-strangers`, `tag-type` |
//! | fault table | `fault-table`, `typed-shape`, `typed-units`, `typed-example`, `typed-take`, `typed-clear`, `typed-grid`, `typed-bit` (`data-at`, `data-port`), `typed-paste`, `typed-problem` |
//! | scan time | `scan`, `scan-kind`, `scan-units`, `scan-registers`, `scan-baud`, `scan-framing`, `scan-turn`, `scan-time`, `scan-table` |

pub mod markup;
pub mod pages;
pub mod state;
pub mod store;

pub use pages::Network;
