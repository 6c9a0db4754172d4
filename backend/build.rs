//! Builds the bridge again when the bundle of the page has other files than before.

fn main() {
    println!("cargo:rerun-if-changed=../static/dist");
}
