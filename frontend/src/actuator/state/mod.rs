//! What the program knows, without signals and without the browser. Tested natively.

pub mod curves;
pub mod dossier;
pub mod health;
pub mod job;
pub mod logs;
pub mod rates;
pub mod saved;
pub mod strokes;
pub mod trends;
pub mod wanted;
