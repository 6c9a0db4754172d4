//! Each component shows one thing.

pub mod conn;
pub mod decode_panes;
pub mod drawn;
pub mod frame_detail;
mod frame_parts;
pub mod help;
pub mod icon;
pub mod input;
pub mod ne107;
pub mod problems;
pub mod program;
pub mod rail;
pub mod traffic;
pub mod traffic_panes;
pub mod values;
pub mod windowed;
