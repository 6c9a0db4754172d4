//! The page.

pub mod app;
pub mod browser;
pub mod components;
pub mod decode_store;
pub mod format;
pub mod keys;
pub mod live;
pub mod markup;
pub mod pages;
pub mod router;
pub mod state;
pub mod task;
pub mod theme;

pub use app::App;
