//! What the program knows, without signals and without the browser. Tested natively.

pub mod curves;
pub mod dossier;
pub mod job;
pub mod logs;
pub mod strokes;
pub mod trends;
pub mod wanted;
