//! Any bytes in any pieces: the stream decoder never panics, loses nothing, and finds the same
//! frames as in one piece.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::capture::{Capture, Direction};
use shared::decode::{Context, decode_frame};
use shared::device::Device;
use shared::frame::{Framing, scan};
use shared::session::Session;
use shared::tree::Decoded;

fuzz_target!(|data: &[u8]| {
    let [choice, step, stream @ ..] = data else { return };
    let framing = Framing::ALL[usize::from(*choice) % Framing::ALL.len()];
    let device = Device::ALL[usize::from(*choice >> 2) % Device::ALL.len()];
    let context = Context { framing, device };

    let frames = scan(stream, framing);
    let total: u64 = frames.iter().map(|f| u64::from(f.len)).sum();
    assert_eq!(total, stream.len() as u64, "frames and noise tile the stream");

    let mut session = Session::new(framing);
    for piece in stream.chunks(usize::from(*step).max(1)) {
        session.push(&Capture::of(piece));
    }
    session.finish();
    assert_eq!(session.len() as usize, frames.len(), "pieces do not matter");

    let mut tree = Decoded::default();
    let mut json = String::new();
    for (index, frame) in (0..).zip(&frames) {
        assert_eq!(session.frame(index), Some(frame));
        assert!(session.decode(index, &context, &mut tree));
        json.clear();
        shared::json::write_frame(&mut json, index, frame, framing, &tree).expect("a string");
        for (_, field) in tree.iter() {
            assert!(field.place.range().end <= tree.bytes().len());
        }
    }

    // With directions and silences as a tap knows them: other frames, but nothing lost either.
    let mut session = Session::new(framing);
    for (at, piece) in stream.chunks(usize::from(*step).max(1)).enumerate() {
        let direction = if at % 2 == 0 { Direction::ToDevice } else { Direction::FromDevice };
        session.push(&Capture { bytes: piece, at: None, direction, ends: at % 3 == 0 });
        let first = session.len().saturating_sub(8);
        session.forget_before(first);
    }
    session.finish();
    for index in session.first()..session.len() {
        let (frame, bytes) = (session.frame(index).expect("kept"), session.bytes(index).expect("kept"));
        let _ = decode_frame(frame, bytes, None, &context);
    }
});
