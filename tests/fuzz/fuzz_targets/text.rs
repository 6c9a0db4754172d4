//! Any text, in any pieces, imports to the same bytes and problems.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::text::{HexReader, import, read_hex};

fuzz_target!(|data: &[u8]| {
    let [step, text @ ..] = data else { return };
    let _ = import(text, None);
    let whole = read_hex(text);
    let (mut out, mut problems) = (Vec::new(), Vec::new());
    let mut reader = HexReader::new();
    for piece in text.chunks(usize::from(*step).max(1)) {
        reader.push(piece, &mut out, &mut problems);
    }
    reader.finish(&mut out, &mut problems);
    assert_eq!((out, problems), whole);
});
