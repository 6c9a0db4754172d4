//! The screens, put together from components.

pub mod decode;
pub mod settings;
