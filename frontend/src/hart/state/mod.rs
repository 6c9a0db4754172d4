//! What the program knows, without signals or a browser.

pub mod condition;
pub mod map;
pub mod plan;
pub mod site;
pub mod steps;
pub mod summary;
pub mod trend;
pub mod unit;
