//! The connection to the backend, and what came through it.

pub mod backoff;
pub mod socket;
pub mod store;

pub use store::Live;
