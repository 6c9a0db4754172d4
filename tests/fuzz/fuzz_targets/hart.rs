//! Any bytes as a HART stream: nothing panics, nothing is lost, every tree tiles its frame.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::capture::Capture;
use shared::decode::Context;
use shared::device::{Device, Family};
use shared::frame::{Framing, scan};
use shared::session::Session;
use shared::tree::Decoded;

fuzz_target!(|data: &[u8]| {
    let [choice, step, stream @ ..] = data else { return };
    let device = Family::ALL.get(usize::from(*choice % 6)).copied().map_or(Device::None, Device::Rotork);
    let context = Context { framing: Framing::Hart, device };
    let frames = scan(stream, Framing::Hart);
    let mut session = Session::new(Framing::Hart);
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
        shared::json::write_frame(&mut json, index, frame, Framing::Hart, &tree).expect("a string");
        let mut owners = vec![0_u8; tree.bytes().len()];
        for (id, field) in tree.iter() {
            let group = tree.iter().any(|(_, f)| f.parent == Some(id) && !f.name.shares_bytes());
            if !group && !field.name.shares_bytes() {
                owners[field.place.range()].iter_mut().for_each(|o| *o += 1);
            }
        }
        assert!(owners.iter().all(|o| *o == 1), "the leaves tile the frame");
    }
});
