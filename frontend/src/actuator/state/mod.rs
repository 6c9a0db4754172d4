//! What the program knows, without signals and without the browser. Tested natively.

pub mod dossier;
pub mod job;
pub mod logs;
pub mod wanted;
