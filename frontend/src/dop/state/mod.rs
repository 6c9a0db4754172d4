//! What is known of diagnostic objects: reads, logs, jobs, settings. Plain Rust, tested natively.

pub mod compare;
pub mod draft;
pub mod explain;
pub mod kept;
pub mod logs;
pub mod offline;
pub mod saved;
pub mod site;
