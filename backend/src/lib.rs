//! The bridge: all I/O, all time, as little meaning as possible.
//!
//! ```text
//!  page ◄── WebSocket ── ws/ ── plant ── bus/ (one actor per line) ── gate ── tap ── line
//! ```
//!
//! # Invariants
//!
//! - **One actor owns one line.** Nobody else opens the port.
//! - **Nothing that writes leaves.** [`bus::gate`] stands at the bottom of every line and lets only
//!   reads through; above it there are no types that say anything else.
//! - **The tap sees every byte**, noise and echoes included, in both directions.
//! - **Bytes travel, meaning stays with `shared`.** The page decodes what the tap recorded.
//! - **No queue grows without a bound**, whatever a client or a line does.

pub mod app;
pub mod bus;
pub mod cli;
pub mod clock;
pub mod config;
pub mod http;
pub mod listen;
pub mod plant;
pub mod serial;
pub mod sim;
pub mod snapshot;
pub mod ws;
