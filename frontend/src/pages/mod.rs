//! The screens, put together from components.

pub mod decode;
pub mod device;
pub mod devices;
pub mod dop;
pub mod network;
pub mod settings;
pub mod traffic;
