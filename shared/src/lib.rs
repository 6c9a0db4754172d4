//! Pure decoding of valve actuator protocols: bytes to frames, transactions and values.
//!
//! ```text
//!  wire bytes ──► frames ──► transactions ──► device map ──► values ──► page, command line
//!   text/          frame/     transaction      map/           tree, render
//!   capture        └───────── session ─────────┘
//! ```
//!
//! # Invariants
//!
//! - **No I/O, no clock, no randomness, no global state.** Time comes in with a
//!   [`Capture`](capture::Capture).
//! - **Decoding never fails as a whole.** Any bytes give frames, noise and
//!   [`Problem`](problem::Problem)s pinned to bytes.
//! - **Nothing is lost.** Frames and noise tile a stream; the leaves of a tree tile a frame.
//! - **Every field and every row of a map names its source.**
//! - **Only [`proto`] is serialized.** The tree stays where it was made; bytes travel.
//!
//! Start reading at [`frame::scan`], [`decode::decode_frame`] and [`session::Session`].
#![cfg_attr(
    not(test),
    deny(
        clippy::unwrap_used,
        clippy::expect_used,
        clippy::panic,
        clippy::indexing_slicing,
        clippy::arithmetic_side_effects,
        clippy::as_conversions
    )
)]

pub mod address;
pub mod capture;
pub mod ddc100;
pub mod decode;
pub mod device;
pub mod dop;
pub mod encode;
pub mod few;
pub mod frame;
pub mod guess;
#[cfg(feature = "hart")]
pub mod hart;
#[cfg(feature = "icon")]
pub mod icon3000;
pub mod image;
pub mod json;
pub mod map;
pub mod pdu;
pub mod place;
pub mod problem;
pub mod proto;
pub mod reader;
pub mod render;
pub mod scale;
pub mod session;
#[cfg(feature = "sim")]
pub mod sim;
pub mod text;
pub mod transaction;
pub mod tree;
pub mod value;
