//! JSON as the page reads and writes it.

pub use shared::json::value::{Json, quoted};
