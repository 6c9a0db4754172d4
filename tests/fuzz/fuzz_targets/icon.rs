//! Any records of any file of an ICON3000v2, and any file of a snapshot: nothing panics, what was
//! read can be written and read again, and a snapshot differs from itself in nothing.
#![no_main]

use libfuzzer_sys::fuzz_target;
use shared::icon3000::curve::{self, Curve};
use shared::icon3000::read::Log;
use shared::icon3000::snapshot::{diff, parse};
use shared::icon3000::stroke::Stroke;
use shared::icon3000::{FILES, FileRead, Files, Records, config, health, identity, words};

fuzz_target!(|data: &[u8]| {
    let [choice, high, low, rest @ ..] = data else {
        return;
    };
    if *choice & 1 == 0 {
        let (snapshot, problems) = parse(rest);
        let Some(snapshot) = snapshot else {
            assert!(!problems.is_empty());
            return;
        };
        let (again, problems) = parse(snapshot.to_text().as_bytes());
        assert!(problems.is_empty(), "{problems:?}");
        assert_eq!(again.as_ref(), Some(&snapshot));
        assert!(diff(&snapshot, &snapshot).is_empty());
        let (model, image) = (snapshot.model, &snapshot.image);
        let _ = (
            health::health(model, image),
            config::configuration(model, image),
            words::pst(model, image),
            words::fail_safe(model, image),
            words::relays(model, image),
            identity::facts(model, image, snapshot.report().as_ref(), &snapshot.files),
            snapshot.holes(),
        );
        for (number, records) in snapshot.files.iter() {
            ask(number, records);
        }
        return;
    }
    // A response to any request.
    let mut files = Files::default();
    let (request, response) = rest.split_at(rest.len() / 2);
    let _ = (FileRead::of_pdu(request), files.absorb(request, response));
    for (number, records) in files.iter() {
        ask(number, records);
    }
    let file = &FILES[usize::from(*high) % FILES.len()];
    let number = file.first + u16::from(*low) % (file.last - file.first + 1);
    ask(number, &Records::of_bytes(u16::from(*choice >> 1), rest));
});

fn ask(number: u16, records: &Records) {
    if let Some(log) = Log::read(number, records) {
        let entries = log.entries.iter().flat_map(|e| &e.items);
        for item in log.head.iter().chain(entries).flatten() {
            let _ = (item.label(), item.text_with_unit(), item.raw());
        }
        let _ = curve::trend(&log, "voltage");
    }
    if let Some(curve) = Curve::of_file(number, records) {
        let drift = curve::drift(&curve, &curve).expect("of one direction");
        assert!(curve::judge(&drift) <= curve::Verdict::Steady);
    }
    if let Some(stroke) = Stroke::of_file(number, records) {
        let _ = (stroke.in_words(), stroke.is_contradictory());
    }
    assert!(records.is_complete(number) <= records.missing(number).is_empty());
}
