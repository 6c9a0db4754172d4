//! The `valvescope` binary.
fn main() {}
