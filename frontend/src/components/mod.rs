//! Each component shows one thing.

pub mod facts;
pub mod frame_detail;
pub mod frame_list;
pub mod help;
pub mod hex;
pub mod icon;
pub mod input;
pub mod ne107;
pub mod problems;
pub mod rail;
pub mod tree;
pub mod windowed;
