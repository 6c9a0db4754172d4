//! The program of the DDC-100 networks, loaded when somebody wants to see one.
//!
//! ```text
//!  guest (place, news) ──► store ──► pages/ ──► markup/
//!                             │                    ▲
//!                             └──► state/ ─────────┘   net, cable, picture, table, unit
//! ```

pub mod markup;
pub mod pages;
pub mod state;
pub mod store;

pub use pages::Network;
