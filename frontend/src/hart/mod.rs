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

mod pages;
pub mod state;

pub use pages::Hart;
