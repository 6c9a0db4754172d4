//! Any bytes as a HART stream: nothing panics, nothing is lost, every tree tiles its frame, every
//! procedure is followed; and the same bytes as what is written to a line with simulated devices,
//! which answer in sound frames or not at all.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::capture::{Capture, Micros};
use shared::decode::Context;
use shared::device::{Device, Family};
use shared::frame::{Framing, scan};
use shared::hart::procedure::Procedures;
use shared::session::Session;
use shared::sim::hart::{HartBurst, HartDevice, HartLine, HartSetup};
use shared::tree::Decoded;

/// A line in fast motion, with a device of the family, to which the bytes are written in pieces.
fn simulate(choice: u8, step: u8, stream: &[u8]) {
    let family = Family::ALL[usize::from(choice) % Family::ALL.len()];
    let setup = HartSetup { baud: 115_200, delayed_ms: u32::from(choice & 0x40) * 10, ..HartSetup::of(family) };
    let mut line = HartLine::new(setup.baud, vec![HartDevice::new("FV-401", setup)]);
    if choice & 0x80 != 0 {
        line.add_burst(HartBurst::new(setup.baud, 7, 100));
    }
    let (mut at, mut heard) = (1_000_000, Vec::new());
    for piece in stream.chunks(usize::from(step).max(1)) {
        line.push(piece, Micros::new(at));
        // Long enough for most pieces and an answer; sometimes not, so that both send at once.
        at += 3_000 + u64::from(step) * 100;
        heard.extend(line.advance(Micros::new(at)));
    }
    // A request that is sound, whatever came before: it is answered.
    line.set_echo(false);
    at += 3_000_000;
    heard.extend(line.advance(Micros::new(at)));
    if choice & 0x80 == 0 {
        line.devices_mut()[0].power_cycle();
        at += 3_000_000;
        let _ = line.advance(Micros::new(at));
        let mut ask = vec![0xFF; 5];
        ask.extend([0x82, 0xAE, 0xDD, 0x01, 0x23, 0x45, 0x07, 0x00, 0x91]);
        line.push(&ask, Micros::new(at));
        at += 1_000_000;
        let answer = line.advance(Micros::new(at));
        assert_eq!(answer.len(), 5 + 9 + 4, "{answer:02X?}");
    }
    let frames = scan(&heard, Framing::Hart);
    if line.collisions().is_empty() {
        assert!(frames.iter().all(|f| !f.marks.is_damaged() && !f.is_noise()), "{heard:02X?}");
    }
}

fuzz_target!(|data: &[u8]| {
    let [choice, step, stream @ ..] = data else { return };
    let device = Family::ALL.get(usize::from(*choice % 6)).copied().map_or(Device::None, Device::Rotork);
    let context = Context { framing: Framing::Hart, device };
    let frames = scan(stream, Framing::Hart);
    simulate(*choice, *step, stream);
    let mut procedures = Procedures::new();
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
        // Of damaged frames, too: whoever passes them in learns nothing wrong from a panic.
        let step = procedures.frame(Framing::Hart, tree.bytes(), index);
        let step = step.as_ref();
        shared::json::write_hart_frame(&mut json, index, frame, Framing::Hart, &tree, step).expect("a string");
        let mut owners = vec![0_u8; tree.bytes().len()];
        for (id, field) in tree.iter() {
            let group = tree.iter().any(|(_, f)| f.parent == Some(id) && !f.name.shares_bytes());
            if !group && !field.name.shares_bytes() {
                owners[field.place.range()].iter_mut().for_each(|o| *o += 1);
            }
        }
        assert!(owners.iter().all(|o| *o == 1), "the leaves tile the frame");
    }
    for open in procedures.open() {
        json.clear();
        open.write_json(&mut json).expect("a string");
    }
});
