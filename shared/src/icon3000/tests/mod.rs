//! Layouts, records and plans, by hand from section 8.11 of VCIOM-16345-EN.

#[cfg(feature = "sim")]
mod collect;
#[cfg(feature = "sim")]
mod device;
mod views;
mod words;

use super::model::{FILES, File, Numbering};
use super::plan::{FileRead, MOST_RECORDS, Probe, Span, plan};
use super::read::Log;
use super::records::{Files, Records};

/// Lengths by the formulas of section 8.11, in bytes: 6 N + 2, 64 N + 2, 10 N + 8, 12 N + 10; and
/// the fixed numbers of records (reading E76: two bytes a record).
#[test]
fn lengths_follow_the_formulas() {
    let bytes = |number: u16, entries: u16| {
        let layout = File::of(number).and_then(|f| f.layout).unwrap();
        layout.records(entries) * 2
    };
    for n in [0_u16, 1, 7, 100, 1666] {
        let wide = u32::from(n);
        assert_eq!(bytes(2, n), 6 * wide + 2);
        assert_eq!(bytes(3, n), 6 * wide + 2);
        assert_eq!(bytes(4, n), 64 * wide + 2);
        assert_eq!(bytes(5000, n), 10 * wide + 8);
        assert_eq!(bytes(5100, n), 12 * wide + 10);
        assert_eq!(bytes(5200, n), 12 * wide + 10);
    }
    for (first, last, records) in [
        (1000, 1100, 108),
        (2000, 2100, 108),
        (3000, 3016, 118),
        (3500, 3516, 110),
        (5300, 5304, 32),
    ] {
        for number in [first, last] {
            assert_eq!(bytes(number, 0), records * 2, "{number}");
            assert_eq!(bytes(number, 9), records * 2, "{number}: no entries");
        }
        assert!(
            File::of(last + 1).is_none_or(|f| f.first == last + 1),
            "{last} is the last"
        );
    }
}

/// Table 30 and reading E67: decimal numbers, 1 + 100 and 1 + 16 curves.
#[test]
fn files_are_those_of_table_30() {
    let numbers: Vec<_> = FILES.iter().map(|f| (f.first, f.last)).collect();
    assert_eq!(
        numbers,
        [
            (2, 2),
            (3, 3),
            (4, 4),
            (5, 5),
            (1000, 1100),
            (2000, 2100),
            (3000, 3016),
            (3500, 3516),
            (5000, 5000),
            (5100, 5100),
            (5200, 5200),
            (5300, 5304),
        ]
    );
    assert!(File::of(5).unwrap().layout.is_none(), "reading E69");
    assert_eq!(File::of(0), None);
    assert_eq!(File::of(1101), None);
    let name = |number: u16| File::of(number).unwrap().name(number).into_owned();
    assert_eq!(name(1000), "FST Open Torque Curve, reference");
    assert_eq!(name(1001), "FST Open Torque Curve 1 (latest)");
    assert_eq!(name(2100), "FST Close Torque Curve 100");
    assert_eq!(name(5302), "Card Report: Terminal Board");
    assert_eq!(name(5100), "Recorders Log");
    assert!(matches!(
        File::by_key("card_reports").unwrap().numbering,
        Numbering::Named(_)
    ));
}

/// Every record of a layout belongs to one value, and the last one of a log to an entry.
#[test]
fn layouts_have_no_holes() {
    for file in &FILES {
        let Some(layout) = file.layout else { continue };
        for record in 0..400 {
            let slot = layout.slot(record);
            let inside = layout.is_log() || record < layout.head_records;
            assert_eq!(slot.is_some(), inside, "{} {record}", file.key);
            if let Some(slot) = slot {
                assert!(slot.word < slot.field.words);
                assert!(slot.index < slot.field.count);
                assert_eq!(slot.entry.is_none(), record < layout.head_records);
            }
        }
    }
}

/// Table 35 and reading E71: entry k starts at 1 + 32 (k - 1).
#[test]
fn connections_take_32_records() {
    let layout = File::of(4).unwrap().layout.unwrap();
    for k in 1..=5_u16 {
        let n = 1 + 32 * (k - 1);
        for (offset, key) in [
            (0, "level"),
            (1, "device_id"),
            (12, "device_id"),
            (13, "operator_id"),
            (24, "operator_id"),
            (25, "spare"),
            (28, "spare"),
            (29, "device"),
            (30, "time"),
            (31, "time"),
        ] {
            let slot = layout.slot(n + offset).unwrap();
            assert_eq!((slot.entry, slot.field.key), (Some(k), key), "{k} {offset}");
        }
    }
}

/// Reading E80: data length 245 at most, so 121 records in one group; a PDU never beyond 253.
#[test]
fn requests_are_as_full_as_they_may_be() {
    assert_eq!(MOST_RECORDS, 121);
    assert!(FileRead::new(vec![Span::new(1000, 0, 121)]).is_some());
    assert!(FileRead::new(vec![Span::new(1000, 0, 122)]).is_none());
    assert!(FileRead::new(vec![Span::new(2, 9999, 1)]).is_some());
    assert!(FileRead::new(vec![Span::new(2, 9999, 2)]).is_none());
    assert!(FileRead::new(vec![Span::new(2, 0, 0)]).is_none());
    assert!(FileRead::new(vec![]).is_none());
    // 35 groups of 7 bytes are 245; 35 answers of 1 record are 140.
    let heads = |n: u16| (0..n).map(|f| Span::new(1000 + f, 0, 1)).collect();
    assert!(FileRead::new(heads(35)).is_some());
    assert!(FileRead::new(heads(36)).is_none());

    let curves = (1000..1003).map(|f| Span::new(f, 0, 108));
    let reads = plan(curves);
    assert_eq!(reads.len(), 3, "a curve comes from one answer");
    let reports = plan((5300..5305).map(|f| Span::new(f, 0, 32)));
    // 66 bytes each: three fit.
    let groups: Vec<_> = reports.iter().map(|r| r.spans().len()).collect();
    assert_eq!(groups, [3, 2]);
    for read in reads.iter().chain(&reports) {
        assert!(read.response_len() <= 247 && read.pdu().len() <= 247);
        assert_eq!(FileRead::of_pdu(&read.pdu()).as_ref(), Some(read));
    }
    // Modbus V1.1b3, section 6.14: two groups of two records.
    let read = FileRead::new(vec![Span::new(4, 1, 2), Span::new(3, 9, 2)]).unwrap();
    assert_eq!(
        read.pdu(),
        [0x14, 0x0E, 6, 0, 4, 0, 1, 0, 2, 6, 0, 3, 0, 9, 0, 2]
    );
    assert_eq!(read.response_len(), 14);
    assert_eq!(read.split().len(), 2);
}

/// A long log is cut where an entry ends, so that none is put together from two answers.
#[test]
fn logs_are_cut_between_entries() {
    let layout = File::of(5000).unwrap().layout.unwrap();
    let whole = u16::try_from(layout.records(200)).unwrap();
    let reads = plan([Span::new(5000, 0, whole)]);
    let mut next = 0;
    for read in &reads {
        for span in read.spans() {
            assert_eq!(span.start, next);
            next += span.count;
            let end = next - layout.head_records;
            assert!(end.is_multiple_of(layout.entry_records) || next == whole);
            assert!(span.count <= 121);
        }
    }
    assert_eq!(next, whole);
    assert_eq!(reads.len(), usize::from(whole.div_ceil(120)));
}

/// First the head, then what it announces; what was read is not asked for again.
#[test]
fn a_read_goes_on_where_it_stopped() {
    let mut files = Files::default();
    let records = files.entry(2);
    assert_eq!(records.missing(2), [Span::new(2, 0, 1)]);
    assert!(!records.is_complete(2));
    records.put(0, [3]);
    assert_eq!(records.missing(2), [Span::new(2, 1, 9)]);
    let request = FileRead::new(vec![Span::new(2, 1, 4)]).unwrap().pdu();
    let response = [20, 10, 9, 6, 0, 1, 0, 2, 0, 3, 0, 4];
    assert_eq!(
        files.absorb(&request, &response),
        Some(vec![Span::new(2, 1, 4)])
    );
    let records = files.get(2).unwrap();
    assert_eq!(records.missing(2), [Span::new(2, 5, 5)]);
    let log = Log::read(2, records).unwrap();
    assert_eq!((log.stored, log.entries.len()), (Some(3), 2));
    assert!(!log.complete);
    assert_eq!(log.entries[0].get("code").unwrap().words, [3]);
    assert!(log.entries[1].get("time").is_none(), "only half of it");
    assert!(log.entries[1].get("code").is_none());
    // A file without a layout: nobody knows how long it is.
    assert_eq!(files.entry(5).missing(5), []);
}

/// Answers that are not what was asked for change nothing.
#[test]
fn wrong_answers_are_not_taken() {
    let request = FileRead::new(vec![Span::new(2, 0, 1), Span::new(3, 0, 1)])
        .unwrap()
        .pdu();
    let mut files = Files::default();
    for response in [
        &[0x94, 2][..],
        &[20, 4, 3, 6, 0, 1],
        &[20, 8, 3, 6, 0, 1, 3, 7, 0, 2],
        &[20, 8, 3, 6, 0, 1, 5, 6, 0, 2],
        &[20, 9, 3, 6, 0, 1, 3, 6, 0, 2],
        &[20, 10, 3, 6, 0, 1, 5, 6, 0, 2, 0, 3],
        &[21, 8, 3, 6, 0, 1, 3, 6, 0, 2],
        &[],
    ] {
        assert_eq!(files.absorb(&request, response), None, "{response:?}");
    }
    assert!(files.is_empty());
    let good = [20, 8, 3, 6, 0, 1, 3, 6, 0, 2];
    assert!(files.absorb(&request, &good).is_some());
    assert_eq!(files.get(3).unwrap().get(0), Some(2));
}

/// A count that no file can hold, an unknown code, and times out of order are said at their record.
#[test]
fn odd_logs_keep_their_values_and_say_so() {
    let mut records = Records::of(0, [5000, 0, 10, 33, 0, 20, 2]);
    let log = Log::read(2, &records).unwrap();
    assert_eq!(log.stored, Some(5000));
    let said: Vec<_> = log.problems.iter().map(|p| p.record).collect();
    assert_eq!(said, [0, 3, 4], "{:?}", log.problems);
    assert_eq!(
        log.entries[0].get("code").unwrap().text(),
        "unknown code (33)"
    );
    assert!(records.expected(log.file.layout.unwrap()).unwrap() <= 10_000);
    records.put(0, [1]);
    let log = Log::read(2, &records).unwrap();
    assert!(log.problems[0].text.contains("announces 1 only"));
}

/// A file of so many records, probed: what was asked for, as first record and count, and how many
/// records were found.
fn probed(records: u32) -> (Vec<(u16, u16)>, u16) {
    let mut probe = Probe::new(5, 0);
    let mut asked = Vec::new();
    while let Some(span) = probe.next() {
        asked.push((span.start, span.count));
        if span.end() <= records {
            probe.answered();
        } else {
            probe.refused();
        }
    }
    (asked, probe.found())
}

/// A file of 64 records, by hand: 121 and 60 halve to 60, 30, 15, 7, 3, 1 (readings E69, E80).
#[test]
fn a_file_of_unknown_length_is_probed_to_its_end() {
    let (asked, found) = probed(64);
    let by_hand = [
        (0, 121),
        (0, 60),
        (60, 60),
        (60, 30),
        (60, 15),
        (60, 7),
        (60, 3),
        (63, 3),
        (63, 1),
        (64, 1),
    ];
    assert_eq!((asked.as_slice(), found), (&by_hand[..], 64));
    // Nothing there: seven requests say so.
    let (asked, found) = probed(0);
    let counts: Vec<_> = asked.iter().map(|(_, count)| *count).collect();
    assert_eq!((counts, found), (vec![121, 60, 30, 15, 7, 3, 1], 0));
    for records in [1_u16, 2, 59, 60, 61, 120, 121, 122, 242, 9999, 10_000] {
        assert_eq!(probed(records.into()).1, records);
    }
    // 10000 = 82 x 121 + 78, and no record beyond 9999 is asked for.
    let (asked, _) = probed(10_000);
    assert_eq!((asked.len(), asked.last()), (83, Some(&(9922, 78))));
    assert_eq!(Probe::new(5, 40).next(), Some(Span::new(5, 40, 121)));
}
