//! What the program knows, without signals and without a browser.

pub mod cable;
pub mod findings;
pub mod geometry;
pub mod list;
pub mod log;
pub mod names;
pub mod net;
pub mod picture;
pub mod scan;
pub mod table;
pub mod tags;
pub mod typed;
pub mod unit;
pub mod wish;
