//! What the page knows, as plain Rust: no signals, no browser, tested natively.

pub mod detect;
pub mod findings;
pub mod load;
pub mod route;
pub mod samples;
pub mod selection;
pub mod shortcuts;
pub mod summary;
pub mod tree;
pub mod window;
pub mod work;
