//! Snapshots, their files and what changed.

mod changes;

use super::*;
use crate::icon3000::identity::Guess;
use crate::icon3000::plan::FileRead;

/// Registers from `start` as a read would bring them.
fn block(snapshot: &mut Snapshot, function: u8, start: u16, words: &[u16]) {
    let count = u16::try_from(words.len()).unwrap();
    let mut request = vec![function];
    request.extend(start.to_be_bytes());
    request.extend(count.to_be_bytes());
    let mut response = vec![function, u8::try_from(words.len() * 2).unwrap()];
    response.extend(words.iter().flat_map(|w| w.to_be_bytes()));
    assert!(snapshot.absorb(&request, &response));
}

fn file(snapshot: &mut Snapshot, number: u16, words: &[u16]) {
    let count = u16::try_from(words.len()).unwrap();
    let read = FileRead::new(vec![Span::new(number, 0, count)]).unwrap();
    let bytes = u8::try_from(words.len() * 2).unwrap();
    let mut response = vec![20, bytes + 2, bytes + 1, 6];
    response.extend(words.iter().flat_map(|w| w.to_be_bytes()));
    assert!(snapshot.absorb(&read.pdu(), &response));
}

/// A device in a few words: position 24.0 %, dead band 1.0 %, its legacy copy, a tag, two alarms.
fn small() -> Snapshot {
    let mut s = Snapshot::new(Model::Icon3000v2, 17, "XV-101 \"north\"");
    s.tool = "valvescope 0.1.0".to_owned();
    s.taken = "2026-11-26T23:50:00Z".to_owned();
    s.took_ms = Some(8120);
    block(&mut s, 3, 0, &[0, 0, 10, 2]);
    block(&mut s, 3, 3004, &[240, 0xFFF4]);
    block(&mut s, 3, 3017, &[10, 2]);
    block(&mut s, 4, 0, &[240, 0xFFF4]);
    s.absorb(&[1, 0, 0, 0, 6], &[1, 1, 0b000100]);
    s.absorb(&[8, 0, 11, 0, 0], &[8, 0, 11, 4, 0xB7]);
    let mut report = vec![17, 0x52, 0, 0];
    report.extend(b"Biffi ICON3000  ");
    report.extend(format!("{:28}{:28}9.02  4.01", "SIM004711", "XV-101").bytes());
    s.absorb(&[17], &report);
    file(&mut s, 2, &[2, 0x32, 9, 6, 0x31, 8, 11]);
    let part = Part::File(Span::new(1002, 0, 108));
    let why = "illegal data address".to_owned();
    s.failures.push(Failure { part, why });
    s
}

/// The documented format, part by part.
#[test]
fn the_file_is_as_documented() {
    let text = small().to_text();
    let begin = "{\n\"format\":\"valvescope-snapshot\",\n\"version\":1,\n\
                 \"tool\":\"valvescope 0.1.0\",\n\"device\":\"icon3000v2\",\n\"unit\":17,\n\
                 \"tag\":\"XV-101 \\\"north\\\"\",\n\"taken\":\"2026-11-26T23:50:00Z\",\n\
                 \"took_ms\":8120,\n\"parts\":[\n{\"table\":\"coil\",\"start\":0,\"bits\":\"001000\"},\n";
    assert!(text.starts_with(begin), "{text}");
    for line in [
        "{\"table\":\"input\",\"start\":0,\"words\":\"00F0FFF4\"},",
        "{\"table\":\"holding\",\"start\":0,\"words\":\"00000000000A0002\"},",
        "{\"table\":\"holding\",\"start\":3004,\"words\":\"00F0FFF4\"},",
        "{\"hole\":\"holding\",\"start\":4,\"count\":3,\"why\":\"reserved\"},",
        "{\"hole\":\"holding\",\"start\":46,\"count\":2954,\"why\":\"reserved\"},",
        "{\"hole\":\"holding\",\"start\":3000,\"count\":4,\"why\":\"not read\"},",
        "{\"hole\":\"file\",\"file\":3,\"start\":0,\"count\":1,\"why\":\"not read\"},",
        "{\"hole\":\"file\",\"file\":5300,\"start\":0,\"count\":32,\"why\":\"not read\"},",
        "{\"counter\":11,\"value\":1207},",
        "{\"file\":2,\"start\":0,\"words\":\"000200320009000600310008000B\"},",
        "{\"failed\":\"file\",\"file\":1002,\"start\":0,\"count\":108,\"why\":\"illegal data address\"}",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}\n{text}");
    }
    let (body, hash) = text.split_once("\"hash\":\"sha256:").unwrap();
    assert_eq!(hash.len(), 64 + "\"\n}\n".len());
    assert!(hash.ends_with("\"\n}\n") && body.ends_with("\n],\n"));
    assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok());
}

/// SHA-256 by FIPS 180-4, example of one block: "abc".
#[test]
fn the_hash_is_the_standard_one() {
    use sha2::{Digest, Sha256};
    let sum = Sha256::digest(b"abc");
    assert_eq!(
        crate::render::hex(&sum),
        "BA7816BF8F01CFEA414140DE5DAE2223B00361A396177A9CB410FF61F20015AD"
    );
}

#[test]
fn a_file_comes_back_as_it_was() {
    let s = small();
    let (back, problems) = parse(s.to_text().as_bytes());
    assert_eq!(problems, []);
    assert_eq!(back.as_ref(), Some(&s));
    // White space and the order of keys are nobody's business.
    let value: serde_json::Value = serde_json::from_str(&s.to_text()).unwrap();
    let (back, problems) = parse(serde_json::to_string_pretty(&value).unwrap().as_bytes());
    assert_eq!(problems, []);
    assert_eq!(back.as_ref(), Some(&s));
    assert!(diff(&s, &back.unwrap()).is_empty());
}

/// HR 3511 says that two opening curves are stored (section 8.11.4: 216 bytes, 108 records); the
/// latest was read, the one before not, and of three warnings only the first (section 8.11.2).
#[test]
fn files_that_were_not_read_are_holes() {
    let mut s = Snapshot::new(Model::Icon3000v2, 1, "XV");
    block(&mut s, 3, 3511, &[2, 0, 0, 0]);
    file(&mut s, 1001, &[9; 108]);
    file(&mut s, 3, &[3, 0, 50, 6]);
    let holes = s.file_holes();
    assert!(holes.contains(&Span::new(1002, 0, 108)) && holes.contains(&Span::new(3, 4, 6)));
    let curve = |n: &Span| (1000..=1100).contains(&n.file) || n.file == 2001;
    assert_eq!(holes.iter().filter(|n| curve(n)).count(), 1, "{holes:?}");
    let why = "no answer".to_owned();
    let part = Part::File(Span::new(1002, 0, 108));
    s.failures.push(Failure { part, why });
    assert!(!s.file_holes().iter().any(curve), "it failed, and says so");
    let old = Snapshot::new(Model::Icon3000, 1, "XV");
    assert_eq!(old.file_holes(), [], "there are no files before the v2");
}

#[test]
fn the_time_of_the_clock_comes_back() {
    let mut s = small();
    s.clock_read = "2026-11-26T23:51:00Z".to_owned();
    let text = s.to_text();
    assert!(text.contains("\"took_ms\":8120,\n\"clock_read\":\"2026-11-26T23:51:00Z\",\n"));
    assert_eq!(parse(text.as_bytes()), (Some(s), Vec::new()));
}

/// What the device says of its model is context as the times are: it comes back, and it is no change.
#[test]
fn why_it_is_that_model_comes_back() {
    let mut s = small();
    for (model, line) in [
        (Some(Model::Icon3000v2), "\"guess\":\"icon3000v2\""),
        (None, "\"guess\":null"),
    ] {
        let why = "HR 3480 answers.".to_owned();
        s.guess = Some(Guess { model, why });
        let text = s.to_text();
        let lines = format!("8120,\n{line},\n\"guess_why\":\"HR 3480 answers.\",\n\"parts\":[");
        assert!(text.contains(&lines), "{text}");
        assert_eq!(parse(text.as_bytes()), (Some(s.clone()), Vec::new()));
        let (found, problems) = parse(text.replace("3480", "3481").as_bytes());
        assert!(found.is_some() && problems.len() == 1, "the hash covers it");
        assert!(diff(&small(), &s).is_empty());
    }
    // Files from before it are as they were.
    assert!(!small().to_text().contains("guess"));
}

#[test]
fn damaged_files_say_where() {
    let text = small().to_text();
    let said = |text: &str| {
        let (snapshot, problems) = parse(text.as_bytes());
        let problems: Vec<_> = problems.iter().map(ToString::to_string).collect();
        (snapshot, problems.join("\n"))
    };
    let (snapshot, problems) = said(&text.replace("00F0FFF4", "00F1FFF4"));
    assert!(
        snapshot.is_some() && problems.contains("the hash does not fit"),
        "{problems}"
    );
    // Line 13 is the first input register block.
    let at = 1 + text.lines().position(|l| l.contains("\"input\"")).unwrap();
    let (snapshot, problems) = said(&text.replace(
        "\"00F0FFF4\"},\n{\"table\":\"holding\",\"start\":0",
        "\"00F0FFXX\"},\n{\"table\":\"holding\",\"start\":0",
    ));
    assert!(
        problems.contains(&format!("line {at}: there are other characters")),
        "{problems}"
    );
    assert!(
        snapshot
            .unwrap()
            .image
            .cell(Table::Holding, Address::new(3004))
            .is_some()
    );
    // Cut in the middle: what came before is there.
    let cut = text.find("\"counter\"").unwrap();
    let (snapshot, problems) = said(&text[..cut]);
    let snapshot = snapshot.unwrap();
    assert!(snapshot.counters.is_empty() && snapshot.identity.is_some());
    assert!(
        problems.contains("the JSON is damaged") && problems.contains("hash is missing"),
        "{problems}"
    );
    for (text, part) in [
        ("", "this is no JSON"),
        ("{}", "this is no snapshot"),
        ("[1]", "not a snapshot"),
        (
            "{\"format\":\"valvescope-snapshot\",\"version\":1,\"device\":\"ddc100-mx\"}",
            "icon3000v2 was expected",
        ),
    ] {
        let (snapshot, problems) = said(text);
        assert!(
            snapshot.is_none() && problems.contains(part),
            "{text}: {problems}"
        );
    }
    assert!(parse(&[0xFF; 64]).0.is_none());
}

/// One change that stands at three places (HR 2, HR 3017, and nothing else) is one change; a
/// measurement with its copy in the input registers another; each as it is named and scaled.
#[test]
fn changes_are_told_once_and_by_meaning() {
    let first = small();
    assert!(diff(&first, &first).is_empty());
    let mut second = small();
    block(&mut second, 3, 2, &[15]);
    block(&mut second, 3, 3017, &[15]);
    block(&mut second, 3, 3004, &[250]);
    block(&mut second, 4, 0, &[250]);
    second.absorb(&[8, 0, 11, 0, 0], &[8, 0, 11, 4, 0xB8]);
    // A third alarm: everything moves on by three records.
    file(&mut second, 2, &[3, 0x33, 1, 2, 0x32, 9, 6, 0x31, 8, 11]);
    let found = diff(&first, &second);
    let told: Vec<_> = found
        .changes
        .iter()
        .map(|c| {
            format!(
                "{} {}: {} → {} {:?}",
                c.sort.key(),
                c.path,
                c.was,
                c.now,
                c.also
            )
        })
        .collect();
    assert_eq!(
        told,
        [
            "configuration holding.3017: 1.0 % → 1.5 % [\"holding.2\"]",
            "log file.2.entry[1]:  → 2000-02-08 16:25:37, Motor Thermostat (2) []",
            "state holding.3004: 24.0 % → 25.0 % [\"input.0\"]",
            "counter counter.11: 1207 → 1208 []",
        ]
    );
    assert_eq!(found.lasting().count(), 2);
    assert!(found.only_one.is_empty() && found.remarks.is_empty());
    let back = diff(&second, &first);
    assert_eq!(back.changes.len(), 4, "{:?}", back.changes);
}

/// A mirror that says something else than its home is told apart.
#[test]
fn mirrors_that_differ_are_told_apart() {
    let first = small();
    let mut second = small();
    block(&mut second, 3, 2, &[20]);
    block(&mut second, 3, 3017, &[15]);
    let found = diff(&first, &second);
    let paths: Vec<_> = found.changes.iter().map(|c| c.path.as_str()).collect();
    assert_eq!(paths, ["holding.2", "holding.3017"]);
}

#[test]
fn what_was_read_once_is_no_change() {
    let first = small();
    let mut second = small();
    block(&mut second, 3, 3019, &[1]);
    second.counters.clear();
    let found = diff(&first, &second);
    assert!(found.is_empty());
    let only: Vec<_> = found
        .only_one
        .iter()
        .map(|o| (o.path.as_str(), o.in_second))
        .collect();
    assert_eq!(only, [("holding.3019", true), ("counter.11", false)]);
}
