//! How fast `shared` is in a browser. Run by `cargo xtask bench`.
#![cfg(target_arch = "wasm32")]

use shared::address::RegisterNumber;
use std::hint::black_box;
use wasm_bindgen_test::{console_log, wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_browser);

/// Runs `work` about half a second long, and prints the time that one run takes.
fn measure(name: &str, mut work: impl FnMut()) {
    let clock = web_sys::window()
        .and_then(|w| w.performance())
        .expect("a browser has a clock");
    let (start, mut runs) = (clock.now(), 0_u32);
    while clock.now() - start < 500.0 {
        (0..1000).for_each(|_| work());
        runs += 1000;
    }
    let nanoseconds = (clock.now() - start) * 1e6 / f64::from(runs);
    console_log!("{name}: {nanoseconds:.0} ns");
}

#[wasm_bindgen_test]
fn resolve_a_register_number() {
    measure("resolve a register number", || {
        black_box(black_box(RegisterNumber::new(403_005)).resolve());
    });
}
