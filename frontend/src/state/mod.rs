//! What the page knows, as plain Rust: no signals, no browser, tested natively.

pub(crate) mod absorb;
pub mod findings;
pub mod health;
pub mod job;
pub mod json;
pub mod load;
pub mod order;
pub mod overview;
pub mod place;
pub mod plant;
pub mod route;
pub mod samples;
pub mod selection;
pub mod shortcuts;
pub mod sorted;
pub mod summary;
pub mod traffic;
pub mod tree;
pub mod values;
pub mod window;
pub mod wire;
pub mod work;
