//! Promises that hold for any records, any registers and any file of a snapshot. `PROPTEST_CASES`
//! says how many of each are tried.

use proptest::collection::vec;
use proptest::prelude::*;
use shared::address::{Address, Table};
use shared::capture::Micros;
use shared::decode::{Context, decode_frame};
use shared::device::Device;
use shared::encode;
use shared::frame::{Framing, scan};
use shared::icon3000::curve::{self, Curve};
use shared::icon3000::read::Log;
use shared::icon3000::snapshot::{Snapshot, diff, parse};
use shared::icon3000::stroke::Stroke;
use shared::icon3000::{
    FILES, File, FileRead, Records, Span, config, health, identity, plan, words,
};
use shared::map::row::Model;
use shared::value::Value;

/// Files that exist, their neighbours, or any number.
fn number() -> impl Strategy<Value = u16> {
    let known: Vec<u16> = FILES
        .iter()
        .flat_map(|f| [f.first, f.last, f.last.saturating_add(1)])
        .collect();
    prop_oneof![4 => prop::sample::select(known), 1 => any::<u16>()]
}

/// A word as devices send them, or any.
fn word() -> impl Strategy<Value = u16> {
    prop_oneof![Just(0), Just(0xFFFF), 0..40_u16, any::<u16>()]
}

/// Everything that can be asked of the records of a file, so that nothing of it panics.
fn ask(number: u16, records: &Records) {
    if let Some(log) = Log::read(number, records) {
        for item in log.head.iter().flatten() {
            let _ = (item.label(), item.text_with_unit(), item.raw());
        }
        for entry in &log.entries {
            assert!(entry.number > 0 && entry.time().is_some() <= !entry.is_unread());
        }
        for key in ["torque", "voltage"] {
            let _ = curve::trend(&log, key);
        }
        assert!(log.name().len() > 3);
    }
    if let Some(curve) = Curve::of_file(number, records) {
        assert_eq!(curve.samples.len(), curve::SAMPLES);
        let drift = curve::drift(&curve, &curve).expect("of one direction");
        let still = [drift.break_away, drift.running_tenths, drift.seating];
        assert!(still.iter().flatten().all(|by| *by == 0));
        let verdict = curve::judge(&drift);
        assert!(verdict <= curve::Verdict::Steady, "no drift from itself");
    }
    if let Some(stroke) = Stroke::of_file(number, records) {
        assert!(!stroke.in_words().is_empty());
        assert!(
            stroke
                .out
                .iter()
                .chain(&stroke.back)
                .all(|p| p.position <= 100)
        );
        let _ = stroke.is_contradictory();
    }
    let missing: u32 = records
        .missing(number)
        .iter()
        .map(|s| u32::from(s.count))
        .sum();
    assert!(missing <= 10_000);
    if records.is_complete(number) {
        assert_eq!(missing, 0);
    }
}

proptest! {
    /// The leaves of any response tile its frame, whatever the request asked for.
    #[test]
    fn any_response_decodes(
        asked in vec((number(), prop_oneof![0..300_u16, any::<u16>()], 0..130_u16), 1..4),
        answered in vec(vec(word(), 0..60), 0..4),
        cut in 0..9_usize,
    ) {
        let mut request = vec![20, u8::try_from(asked.len() * 7).unwrap()];
        for (file, start, count) in &asked {
            request.push(6);
            for word in [file, start, count] {
                request.extend(word.to_be_bytes());
            }
        }
        let mut data: Vec<u8> = Vec::new();
        for words in &answered {
            data.push(u8::try_from(words.len() * 2 + 1).unwrap());
            data.push(6);
            data.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        }
        data.truncate(240);
        data.truncate(data.len().saturating_sub(cut));
        let mut response = vec![20, u8::try_from(data.len()).unwrap()];
        response.extend(&data);
        let frame = |pdu: &[u8]| encode::frame(Framing::Rtu, 0, 1, pdu);
        let (request, response) = (frame(&request), frame(&response));
        let context = Context { framing: Framing::Rtu, device: Device::Icon3000v2 };
        for found in scan(&response, Framing::Rtu) {
            let range = found.offset as usize..found.end() as usize;
            let tree = decode_frame(&found, &response[range], Some(&request), &context);
            let mut owners = vec![0_u32; tree.bytes().len()];
            for (id, field) in tree.iter() {
                let _ = (tree.path(id), tree.text(field), field.name.label());
                let shares = |f: &shared::tree::Field| f.name.shares_bytes();
                let parts = tree.iter().any(|(_, f)| f.parent == Some(id) && !shares(f));
                if parts || shares(field) || matches!(field.value, Value::Bit { .. }) {
                    continue;
                }
                for owner in &mut owners[field.place.range()] {
                    *owner += 1;
                }
            }
            prop_assert!(owners.iter().all(|o| *o == 1), "{owners:?}");
        }
    }

    /// Any records of any file, whole or in part.
    #[test]
    fn any_records_are_read(
        number in number(),
        parts in vec((0..200_u16, vec(word(), 0..130)), 0..4),
    ) {
        let mut records = Records::default();
        for (start, words) in parts {
            records.put(start, words);
        }
        ask(number, &records);
    }

    /// A plan asks for every record once and in order, and for nothing that a request or response
    /// cannot hold.
    #[test]
    fn plans_cover_what_is_wanted(
        wanted in vec((number(), 0..10_000_u16, 1..600_u16), 0..6),
    ) {
        let spans: Vec<Span> = wanted.iter().map(|(f, s, c)| Span::new(*f, *s, *c)).collect();
        let reads = plan::plan(spans.clone());
        let each = |span: &Span| {
            let file = span.file;
            let last = span.end().min(10_000);
            (u32::from(span.start)..last).map(move |r| (file, r)).collect::<Vec<_>>()
        };
        let all: Vec<_> = spans.iter().flat_map(each).collect();
        let asked: Vec<_> = reads.iter().flat_map(FileRead::spans).flat_map(each).collect();
        prop_assert_eq!(asked, all);
        for read in &reads {
            prop_assert!(read.pdu().len() <= 247 && read.response_len() <= 247);
            let back = FileRead::of_pdu(&read.pdu());
            prop_assert_eq!(back.as_ref(), Some(read));
        }
    }

    /// Any snapshot comes back from its file as it was, and differs from itself in nothing.
    #[test]
    fn snapshots_come_back(
        model in prop::sample::select(vec![Model::Icon2000v4, Model::Icon3000, Model::Icon3000v2]),
        tag in "\\PC{0,12}",
        cells in prop::collection::btree_map((0..4_usize, 0..4_200_u16), word(), 0..60),
        files in vec((number(), 0..9_999_u16, vec(word(), 1..20)), 0..5),
        counters in vec((any::<u16>(), any::<u16>()), 0..4),
    ) {
        let mut snapshot = Snapshot::new(model, 7, &tag);
        for ((table, address), word) in cells {
            let table = Table::ALL[table];
            let word = if table.is_bits() { word & 1 } else { word };
            snapshot.image.set(table, Address::new(address), word, Micros::default());
        }
        for (number, start, words) in files {
            snapshot.files.entry(number).put(start, words);
        }
        snapshot.counters.extend(counters);
        let text = snapshot.to_text();
        let (back, problems) = parse(text.as_bytes());
        prop_assert_eq!(&problems, &[]);
        prop_assert_eq!(back.as_ref(), Some(&snapshot));
        prop_assert!(diff(&snapshot, &snapshot).is_empty());
        let image = &snapshot.image;
        let _ = (health::health(model, image), config::configuration(model, image));
        let _ = (words::pst(model, image), words::fail_safe(model, image), words::relays(model, image));
        let _ = (words::inputs(model, image), words::positioner(model, image), words::modes(model, image));
        let _ = words::interlocks(model, image);
        let _ = identity::facts(model, image, None, &snapshot.files);
        let _ = identity::detect(image, None, None, None);
    }

    /// Any bytes are a snapshot or say why they are none; what was read can be written.
    #[test]
    fn any_bytes_are_parsed(bytes in vec(any::<u8>(), 0..300)) {
        let (snapshot, problems) = parse(&bytes);
        prop_assert!(snapshot.is_some() || !problems.is_empty());
    }

    /// A file with one byte changed still gives what it can, and never passes for the whole.
    #[test]
    fn damaged_files_are_noticed(at in any::<prop::sample::Index>(), byte in 0x20..0x7F_u8) {
        let mut snapshot = Snapshot::new(Model::Icon3000v2, 1, "XV-101");
        for address in 3000..3040 {
            snapshot.image.set(Table::Holding, Address::new(address), address, Micros::default());
        }
        snapshot.files.entry(2).put(0, [1, 2, 3, 4]);
        let text = snapshot.to_text();
        let mut bytes = text.clone().into_bytes();
        let at = at.index(bytes.len());
        bytes[at] = byte;
        let (back, problems) = parse(&bytes);
        let same = back.as_ref() == Some(&snapshot);
        prop_assert!(same || !problems.is_empty(), "byte {at} of {text}");
    }
}

#[test]
fn files_have_names() {
    for file in &FILES {
        for number in [file.first, file.last] {
            assert_eq!(File::of(number), Some(file));
        }
    }
}
