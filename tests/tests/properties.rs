//! Promises that hold for any bytes.

use proptest::collection::vec;
use proptest::prelude::*;
use shared::capture::Capture;
use shared::decode::{Context, decode_frame};
use shared::device::Device;
use shared::encode;
use shared::frame::{Frame, Framing, Marks, Role, detect, scan};
use shared::session::Session;
use shared::text::import;
use shared::tree::{Decoded, Field};
use shared::value::Value;

/// PDUs as a master or device may send them, with random content.
fn pdu() -> BoxedStrategy<Vec<u8>> {
    let head =
        |function: u8| any::<[u8; 4]>().prop_map(move |rest| [&[function][..], &rest].concat());
    prop_oneof![
        (1_u8..=6).prop_flat_map(head),
        (3_u8..=4, vec(any::<[u8; 2]>(), 1..125)).prop_map(|(function, words)| {
            let count = u8::try_from(words.len() * 2).unwrap();
            [&[function, count][..], &words.concat()].concat()
        }),
        (any::<[u8; 2]>(), vec(any::<[u8; 2]>(), 1..123)).prop_map(|(start, words)| {
            let count = u16::try_from(words.len()).unwrap().to_be_bytes();
            let bytes = u8::try_from(words.len() * 2).unwrap();
            [&[16][..], &start, &count, &[bytes], &words.concat()].concat()
        }),
        (1_u8..24, 1_u8..12).prop_map(|(function, code)| vec![function | 0x80, code]),
        Just(vec![7]),
        Just(vec![17]),
    ]
    .boxed()
}

/// A stream with sound frames, damaged ones and garbage.
fn stream(framing: Framing) -> impl Strategy<Value = Vec<u8>> {
    let sound = (any::<u16>(), 1_u8..250, pdu())
        .prop_map(move |(tid, unit, pdu)| encode::frame(framing, tid, unit, &pdu))
        .boxed();
    let damaged =
        (sound.clone(), any::<prop::sample::Index>(), 0_u8..8).prop_map(|(mut bytes, at, bit)| {
            let at = at.index(bytes.len());
            bytes[at] ^= 1 << bit;
            bytes
        });
    let cut = (sound.clone(), any::<prop::sample::Index>()).prop_map(|(mut bytes, at)| {
        bytes.truncate(at.index(bytes.len()));
        bytes
    });
    let piece = prop_oneof![4 => sound, 1 => damaged, 1 => cut, 1 => vec(any::<u8>(), 0..40)];
    vec(piece, 0..12).prop_map(|pieces| pieces.concat())
}

fn any_stream() -> impl Strategy<Value = (Framing, Vec<u8>)> {
    prop::sample::select(Framing::ALL.to_vec()).prop_flat_map(|framing| {
        let bytes = prop_oneof![stream(framing), vec(any::<u8>(), 0..3000)];
        (Just(framing), bytes)
    })
}

fn bytes_of<'a>(stream: &'a [u8], frame: &Frame) -> &'a [u8] {
    &stream[usize::try_from(frame.offset).unwrap()..usize::try_from(frame.end()).unwrap()]
}

/// True for bits and other parts of a byte, which share it with the field around them.
fn is_part(field: &Field) -> bool {
    let bit = matches!(field.value, Value::Bit { .. }) && field.parent.is_some();
    bit || field.name.shares_bytes()
}

/// Every byte belongs to exactly one leaf; bits share the byte of their word.
fn assert_tiles(tree: &Decoded) {
    let mut owners = vec![0; tree.bytes().len()];
    for (id, field) in tree.iter() {
        let group = tree
            .iter()
            .any(|(_, f)| f.parent == Some(id) && !is_part(f));
        if !group && !is_part(field) {
            owners[field.place.range()].iter_mut().for_each(|o| *o += 1);
        }
    }
    assert!(owners.iter().all(|o| *o == 1), "{owners:?} in {tree:#?}");
}

fn check(framing: Framing, stream: &[u8]) -> Vec<Frame> {
    let frames = scan(stream, framing);
    let mut at = 0;
    for (index, frame) in (0_u32..).zip(&frames) {
        assert_eq!(frame.offset, at, "entries tile the stream");
        assert!(frame.len > 0);
        at = frame.end();
        if let Some(pair) = frame.pair() {
            let other = &frames[usize::try_from(pair).unwrap()];
            assert_eq!(other.pair(), Some(index), "pairs are mutual");
            assert_eq!(
                (other.unit, other.function & 0x7F),
                (frame.unit, frame.function & 0x7F)
            );
        }
        let request = frame
            .pair()
            .filter(|p| *p < index)
            .map(|p| bytes_of(stream, &frames[usize::try_from(p).unwrap()]));
        for device in Device::ALL {
            let context = Context { framing, device };
            let tree = decode_frame(frame, bytes_of(stream, frame), request, &context);
            assert_tiles(&tree);
            for (id, field) in tree.iter() {
                let _ = (
                    tree.path(id),
                    tree.text(field),
                    tree.raw(field),
                    tree.owner(field.place.start),
                );
            }
            for problem in tree.problems() {
                assert!(!problem.to_string().is_empty());
                assert!(usize::from(problem.place.end()) <= tree.bytes().len() || frame.is_noise());
            }
        }
    }
    assert_eq!(at, stream.len() as u64, "no byte is lost");
    frames
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 600, ..ProptestConfig::default() })]

    /// Any bytes decode to something, and nothing of them is lost.
    #[test]
    fn decoding_is_total((framing, stream) in any_stream()) {
        check(framing, &stream);
    }

    /// However a stream is cut into pieces, the same frames are found.
    #[test]
    fn pieces_do_not_matter(
        (framing, stream) in any_stream(),
        cuts in vec(any::<prop::sample::Index>(), 0..20),
    ) {
        let whole = scan(&stream, framing);
        let mut cuts: Vec<_> = cuts.iter().map(|c| c.index(stream.len() + 1)).collect();
        cuts.extend([0, stream.len()]);
        cuts.sort_unstable();
        let mut session = Session::new(framing);
        for pair in cuts.windows(2) {
            session.push(&Capture::of(&stream[pair[0]..pair[1]]));
        }
        session.finish();
        let found: Vec<_> = (0..session.len()).map(|i| *session.frame(i).unwrap()).collect();
        prop_assert_eq!(found, whole);
        for index in 0..session.len() {
            let frame = session.frame(index).unwrap();
            prop_assert_eq!(session.bytes(index).unwrap(), bytes_of(&stream, frame));
        }
    }

    /// What was encoded is found again as one sound frame, with its unit and function.
    #[test]
    fn encode_then_decode(
        framing in prop::sample::select(Framing::MODBUS.to_vec()),
        tid in any::<u16>(),
        unit in 1_u8..250,
        pdu in pdu(),
    ) {
        let bytes = encode::frame(framing, tid, unit, &pdu);
        let frames = scan(&bytes, framing);
        prop_assert_eq!(frames.len(), 1, "{:?}", frames);
        prop_assert_eq!((frames[0].unit, frames[0].function), (unit, pdu[0]));
        prop_assert!(!frames[0].marks.is_damaged());
        prop_assert_eq!(shared::decode::pdu_of(&bytes, framing), Some(pdu));
    }

    /// A framing is detected for a sound frame of any kind; RTU and ASCII can't be mistaken.
    #[test]
    fn framing_is_detected(
        framing in prop::sample::select(vec![Framing::Rtu, Framing::Ascii]),
        unit in 1_u8..248,
        pdu in pdu(),
    ) {
        prop_assert_eq!(detect(&encode::frame(framing, 1, unit, &pdu)), framing);
    }

    /// Any text imports without loss of control; hexadecimal comes back.
    #[test]
    fn text_import_is_total(text in any::<Vec<u8>>(), bytes in vec(any::<u8>(), 4..200)) {
        let _ = import(&text, None);
        let spaced = shared::render::Spaced(&bytes).to_string();
        prop_assert_eq!(&import(spaced.as_bytes(), None).bytes, &bytes);
        prop_assert_eq!(&import(shared::render::hex(&bytes).as_bytes(), Some(Framing::Rtu)).bytes, &bytes);
    }

    /// Sound requests and answers one after the other are all found and paired.
    #[test]
    fn exchanges_are_paired(
        framing in prop::sample::select(Framing::MODBUS.to_vec()),
        reads in vec((1_u8..248, 3_u8..=4, 0_u16..5000, 1_u16..125, any::<u64>()), 1..12),
    ) {
        let mut stream = Vec::new();
        for (tid, (unit, function, start, count, seed)) in (0_u16..).zip(&reads) {
            let request = [&[*function][..], &start.to_be_bytes(), &count.to_be_bytes()].concat();
            let words = (0..*count).map(|i| (seed.wrapping_mul(u64::from(i) + 7) >> 20) as u16);
            let data: Vec<u8> = words.flat_map(u16::to_be_bytes).collect();
            let response = [&[*function, data.len() as u8][..], &data].concat();
            stream.extend(encode::frame(framing, tid, *unit, &request));
            stream.extend(encode::frame(framing, tid, *unit, &response));
        }
        let frames = scan(&stream, framing);
        prop_assert_eq!(frames.len(), reads.len() * 2);
        for pair in frames.chunks(2) {
            prop_assert_eq!((pair[0].role, pair[1].role), (Role::Request, Role::Response));
            prop_assert!(pair[0].pair().is_some() && pair[1].pair().is_some());
        }
    }
}

/// All changes of one and of two bits of sound RTU frames are noticed: no damaged frame is taken
/// for a sound one of the same length.
#[test]
fn flipped_bits_are_noticed() {
    let frames = [
        "7D0300070003BFF6",
        "03010118503A",
        "010F000000010101EF57",
        "7D0306003D084400003E07",
    ];
    for hex in frames {
        let sound = import(hex.as_bytes(), None).bytes;
        let bits = sound.len() * 8;
        for first in 0..bits {
            for second in first..bits {
                let mut bytes = sound.clone();
                bytes[first / 8] ^= 1 << (first % 8);
                if second != first {
                    bytes[second / 8] ^= 1 << (second % 8);
                }
                let found = scan(&bytes, Framing::Rtu);
                let accepted = found.iter().any(|f| {
                    f.len as usize == bytes.len() && f.role != Role::Noise && !f.marks.is_damaged()
                });
                assert!(!accepted, "{hex} with bits {first} and {second} flipped");
                assert_eq!(
                    found.iter().map(|f| f.len as usize).sum::<usize>(),
                    bytes.len()
                );
            }
        }
    }
}

/// Pure garbage takes time in proportion to its length, in every framing.
#[test]
fn garbage_does_not_hang() {
    let mut state = 0x1234_5678_u32;
    let random: Vec<u8> = (0..2_000_000)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    let shapes: [Vec<u8>; 4] = [
        random,
        vec![0; 2_000_000],
        [0x01, 0x07, 0x55, 0xAA].repeat(500_000),
        b":0".repeat(1_000_000),
    ];
    for bytes in &shapes {
        for framing in Framing::ALL {
            let frames = scan(bytes, framing);
            assert_eq!(
                frames.iter().map(|f| u64::from(f.len)).sum::<u64>(),
                bytes.len() as u64
            );
            let good = frames
                .iter()
                .filter(|f| f.role != Role::Noise && !f.marks.is_damaged());
            // 2^-16 of two million positions with a function code of the table, at most.
            let accepted = good.filter(|f| !f.marks.has(Marks::GUESS)).count();
            assert!(accepted < 60, "{framing:?}: {accepted} frames in garbage");
        }
    }
}
