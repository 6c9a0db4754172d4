//! How fast `shared` is in a browser. Run by `cargo xtask bench`.
#![cfg(target_arch = "wasm32")]

use shared::address::{Address, Table};
use shared::decode::{Context, decode_into};
use shared::device::Device;
use shared::frame::{Framing, Role, scan_into};
use shared::map::decode::each_value;
use shared::map::row::Model;
use shared::tree::Decoded;
use std::hint::black_box;
use tests::load::{polls, requests, response};
use wasm_bindgen_test::{console_log, wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_browser);

/// Runs `work` about a second long, and prints how many items it did in one.
fn measure(name: &str, items: u64, mut work: impl FnMut()) {
    let clock = web_sys::window()
        .and_then(|w| w.performance())
        .expect("a browser has a clock");
    work();
    let (start, mut done) = (clock.now(), 0_u64);
    while clock.now() - start < 1000.0 {
        work();
        done += items;
    }
    let millions = done as f64 / (clock.now() - start) / 1000.0;
    console_log!("{name}: {millions:.2} million/s");
}

#[wasm_bindgen_test]
fn scan_requests() {
    let (load, mut index) = (requests(100_000), Vec::new());
    measure("scan/requests", load.messages, || {
        scan_into(black_box(&load.bytes), Framing::Rtu, &mut index);
    });
    assert_eq!(index.len(), 100_000);
}

#[wasm_bindgen_test]
fn scan_polls() {
    let (load, mut index) = (polls(100_000), Vec::new());
    measure("scan/polls", load.messages, || {
        scan_into(black_box(&load.bytes), Framing::Rtu, &mut index);
    });
    assert_eq!(index.len(), 100_000);
}

#[wasm_bindgen_test]
fn values_of_the_map() {
    let (load, mut index) = (polls(100_000), Vec::new());
    let map = Model::Icon3000v2.map();
    let mut count = 0_u64;
    measure("decode/stream to values of the map", load.messages, || {
        scan_into(&load.bytes, Framing::Rtu, &mut index);
        for frame in index.iter().filter(|f| f.role == Role::Response) {
            let bytes = |f: &shared::frame::Frame| &load.bytes[f.offset as usize..f.end() as usize];
            let request = bytes(&index[frame.pair().expect("paired") as usize]);
            let start = Address::new(u16::from_be_bytes([request[2], request[3]]));
            let data = bytes(frame);
            let words = &data[3..data.len() - 2];
            each_value(map, Table::Holding, start, words, |row, judged| {
                black_box((row, &judged));
                count += 1;
            });
        }
    });
    assert!(count > 0);
}

#[wasm_bindgen_test]
fn tree_of_ten_registers() {
    let request = shared::encode::frame(Framing::Rtu, 0, 1, &[3, 0x0B, 0xB8, 0, 10]);
    let answer = shared::encode::frame(Framing::Rtu, 0, 1, &response(3000, 10, 5));
    let mut index = Vec::new();
    scan_into(
        &[request.clone(), answer.clone()].concat(),
        Framing::Rtu,
        &mut index,
    );
    let context = Context {
        framing: Framing::Rtu,
        device: Device::Icon3000v2,
    };
    let mut tree = Decoded::default();
    measure("decode/field tree of 10 registers", 1000, || {
        for _ in 0..1000 {
            decode_into(
                black_box(&index[1]),
                &answer,
                Some(&request),
                &context,
                &mut tree,
            );
        }
    });
    assert!(tree.fields().len() > 10);
}
