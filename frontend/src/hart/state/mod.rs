//! What the program knows, without signals or a browser.
pub mod summary;
