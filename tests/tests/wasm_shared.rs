//! `shared` as the browser runs it.
#![cfg(target_arch = "wasm32")]

use shared::address::{RegisterNumber, Table};
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_browser);

/// Numbers resolve in wasm, where `usize` has 32 bits, as they do natively.
#[wasm_bindgen_test]
fn numbers_resolve() {
    let (table, address) = RegisterNumber::new(403_005)
        .resolve()
        .expect("a holding register");
    assert_eq!((table, address.get()), (Table::Holding, 3004));
    assert_eq!(RegisterNumber::of(table, address).get(), 403_005);
}
