//! ICON3000 in depth: what it offers beyond its registers, and what all of it says together.
//!
//! ```text
//!  FC 20 answers ──► Records ──► Log, Curve (typed values, each with its source)
//!                     records     read          curve, stroke
//!  Span ──► plan ──► requests                   health, words, identity, config
//! ```
//!
//! # Invariants
//!
//! - A file is a sparse table of words: what was not read is `None`, never 0.
//! - Layouts are data (`shared/data/icon3000/record_*.csv`); nothing here knows an offset.
//! - Any words decode to something, with problems at records.
//!
//! Source: VCIOM-16345-EN, section 8.11, with the readings of its manual.

pub mod collect;
pub mod config;
pub mod counters;
pub mod curve;
pub mod export;
pub mod health;
pub mod identity;
mod judge;
pub mod model;
pub mod plan;
pub mod read;
pub mod records;
pub mod say;
pub mod snapshot;
pub mod stroke;
pub(crate) mod tree;
pub mod words;

#[cfg(test)]
mod tests;

pub use collect::Collector;
pub use model::{FILES, Field, File, Layout};
pub use plan::{FileRead, Span};
pub use read::{Entry, Item, Log};
pub use records::{Files, Records};
pub use snapshot::Snapshot;
