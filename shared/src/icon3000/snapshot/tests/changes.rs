//! What changes in curves, logs, identity and between two models: each known change is found, and no
//! other.

use super::*;

/// Every change as `path: was → now`.
fn told(first: &Snapshot, second: &Snapshot) -> Vec<String> {
    let found = diff(first, second);
    let line = |c: &Change| format!("{}: {} → {}", c.path, c.was, c.now);
    found.changes.iter().map(line).collect()
}

fn empty() -> Snapshot {
    Snapshot::new(Model::Icon3000v2, 1, "XV-101")
}

/// A torque curve of so many percent all the way, stored so many days after 1 January 2000 (86400
/// seconds a day, high word first): 101 samples, time, three temperatures, voltage, stroke time.
fn torque(percent: u16, days: u32) -> Vec<u16> {
    let mut words = vec![percent; 101];
    let seconds = (days * 86_400).to_be_bytes();
    words.push(u16::from_be_bytes([seconds[0], seconds[1]]));
    words.push(u16::from_be_bytes([seconds[2], seconds[3]]));
    words.extend([31, 28, 46, 400, 24]);
    words
}

/// A snapshot with these files.
fn with(files: &[(u16, &[u16])]) -> Snapshot {
    let mut snapshot = empty();
    for (number, words) in files {
        file(&mut snapshot, *number, words);
    }
    snapshot
}

/// The same, with the number of opening curves that HR 3511 says are stored; of the others none.
fn stored(curves: u16, files: &[(u16, &[u16])]) -> Snapshot {
    let mut snapshot = with(files);
    block(&mut snapshot, 3, 3511, &[curves, 0, 0, 0]);
    snapshot
}

/// What only one of them has, as `path second` or `path first`.
fn apart(first: &Snapshot, second: &Snapshot) -> Vec<String> {
    let found = diff(first, second);
    let which = |second| if second { "second" } else { "first" };
    let only = found.only_one.iter();
    only.map(|o| format!("{} {}", o.path, which(o.in_second)))
        .collect()
}

/// Section 8.11.4: 1001 is the latest, so a new curve moves the others by one.
#[test]
fn curves_come_and_go() {
    let (a, b, c) = (torque(30, 1), torque(31, 2), torque(32, 3));
    let old = stored(2, &[(1000, &a), (1001, &b), (1002, &a)]);
    let new = stored(3, &[(1000, &a), (1001, &c), (1002, &b), (1003, &a)]);
    assert_eq!(told(&old, &old), [""; 0]);
    assert_eq!(
        told(&old, &new),
        [
            "holding.3511: 2 → 3",
            "file.1001:  → 2000-01-04 00:00:00, peak 32 %"
        ]
    );
    // The other way round it was dropped.
    assert_eq!(
        told(&new, &old),
        [
            "holding.3511: 3 → 2",
            "file.1001: 2000-01-04 00:00:00, peak 32 % → "
        ]
    );
    // The oldest that made room for a new one is not missed.
    let rolled = stored(2, &[(1000, &a), (1001, &c), (1002, &b)]);
    assert_eq!(
        told(&old, &rolled),
        ["file.1001:  → 2000-01-04 00:00:00, peak 32 %"]
    );
    let change = &diff(&old, &new).changes[0];
    assert_eq!(
        (change.sort, change.sort.is_passing()),
        (Sort::Curve, false)
    );
}

/// Of two actuators in the same state one was read in part: no curve came and none went, whatever is
/// missing: the number of them, all of them, one of them, or the end of one.
#[test]
fn curves_that_were_not_read_are_no_change() {
    let (a, b) = (torque(30, 1), torque(31, 2));
    let whole = stored(2, &[(1000, &a), (1001, &b), (1002, &a)]);
    let uncounted = with(&[(1000, &a), (1001, &b)]);
    let none = stored(2, &[(1000, &a)]);
    let one = stored(2, &[(1000, &a), (1002, &a)]);
    let cut = stored(2, &[(1000, &a), (1001, &b), (1002, &a[..107])]);
    for (part, only) in [
        (
            uncounted,
            &[
                "holding.3511",
                "holding.3512",
                "holding.3513",
                "holding.3514",
                "file.1002",
            ][..],
        ),
        (none, &["file.1001", "file.1002"]),
        (one, &["file.1001"]),
        (cut, &["file.1002"]),
    ] {
        assert_eq!(told(&whole, &part), [""; 0]);
        assert_eq!(told(&part, &whole), [""; 0]);
        let named = |which: &str| -> Vec<String> {
            only.iter().map(|path| format!("{path} {which}")).collect()
        };
        assert_eq!(apart(&whole, &part), named("first"));
        assert_eq!(apart(&part, &whole), named("second"));
    }
    // Nothing is stored, and nothing was read: that is whole.
    let emptied = stored(0, &[(1000, &a)]);
    let gone: Vec<_> = told(&whole, &emptied);
    assert_eq!(gone.iter().filter(|l| l.starts_with("file.")).count(), 2);
}

/// Section 8.11.1: record 0 counts the alarms, three records each follow. With the head alone, and
/// with one alarm of two, nothing is known of the others.
#[test]
fn entries_that_were_not_read_are_no_change() {
    let whole = with(&[(2, &[2, 0x32, 9, 6, 0x31, 8, 11])]);
    for (part, only) in [
        (
            with(&[(2, &[2])]),
            &["file.2.entry[1]", "file.2.entry[2]"][..],
        ),
        (with(&[(2, &[2, 0x32, 9, 6])]), &["file.2.entry[2]"]),
        (
            with(&[(2, &[2, 0x32, 9, 6, 0x31, 8])]),
            &["file.2.entry[2]"],
        ),
    ] {
        assert_eq!(told(&whole, &part), [""; 0]);
        assert_eq!(told(&part, &whole), [""; 0]);
        let named = |which: &str| -> Vec<String> {
            only.iter().map(|path| format!("{path} {which}")).collect()
        };
        assert_eq!(apart(&whole, &part), named("first"));
        assert_eq!(apart(&part, &whole), named("second"));
        assert!(
            diff(&part, &whole).only_one[0]
                .label
                .starts_with("Alarms Log: alarm, 2000-")
        );
    }
    // The head alone tells that there is one more.
    let more = with(&[(2, &[3])]);
    assert_eq!(told(&whole, &more), ["file.2.count: 2 → 3"]);
}

/// HR 3090 and on: code, date (0xDDMM, 0xYYYY) and time (0x00HH, 0xMMSS), five times. Two alarms are
/// in it: main voltage (11), and before it the thermostat (2).
#[test]
fn registers_of_the_log_that_were_not_read_are_no_change() {
    let mut words = vec![
        11, 0x2611, 0x2026, 0x0009, 0x3000, 2, 0x2511, 0x2026, 0x0008, 0x1530,
    ];
    words.resize(25, 0);
    let read = |count: usize| {
        let mut snapshot = Snapshot::new(Model::Icon3000, 1, "XV-101");
        block(&mut snapshot, 3, 3090, &words[..count]);
        snapshot
    };
    let whole = read(25);
    let nothing = Snapshot::new(Model::Icon3000, 1, "XV-101");
    for (part, only) in [
        (nothing, &["holding.3090", "holding.3095"][..]),
        (read(6), &["holding.3095"]),
        // The last of the 15 values is missing, and it is of no entry.
        (read(24), &[]),
    ] {
        assert_eq!(told(&whole, &part), [""; 0]);
        assert_eq!(told(&part, &whole), [""; 0]);
        let named = |which: &str| -> Vec<String> {
            only.iter().map(|path| format!("{path} {which}")).collect()
        };
        assert_eq!(apart(&whole, &part), named("first"));
        assert_eq!(apart(&part, &whole), named("second"));
    }
    // Both whole: one that came is told, and one that went.
    let mut older = Snapshot::new(Model::Icon3000, 1, "XV-101");
    let mut before = words[5..].to_vec();
    before.resize(25, 0);
    block(&mut older, 3, 3090, &before);
    let came = told(&older, &whole);
    assert_eq!(came.len(), 1, "{came:?}");
    assert!(came[0].starts_with("holding.3090:  → ") && came[0].contains("Main Voltage (11)"));
    let went = told(&whole, &older);
    assert!(
        went[0].ends_with("→ ") && went[0].contains("Main Voltage (11)"),
        "{went:?}"
    );
}

/// Table 4: an ICON2000v4 has its log in IR 45 and on; compared with an ICON3000 too.
#[test]
fn an_icon2000v4_has_its_log_in_input_registers() {
    let read = |model: Model, latest: u16| {
        let mut snapshot = Snapshot::new(model, 1, "XV-101");
        let mut words = vec![latest, 0x2611, 0x2026, 0x0009, 0x3000];
        words.resize(25, 0);
        block(&mut snapshot, 4, 45, &words);
        snapshot
    };
    let was = read(Model::Icon2000v4, 0);
    for now in [read(Model::Icon2000v4, 11), read(Model::Icon3000, 11)] {
        let found = told(&was, &now);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(found[0].starts_with("input.45:  → ") && found[0].contains("Main Voltage (11)"));
    }
}

/// A reference that was taken anew at the same time and with the same peak still says what changed.
#[test]
fn a_reference_says_where_it_differs() {
    let was = torque(30, 1);
    let mut now = was.clone();
    // 5 % less at 40 %, 12 % less at 57 %: the larger one is told, the smaller one is in it.
    (now[40], now[57]) = (25, 18);
    assert_eq!(
        told(&with(&[(1000, &was)]), &with(&[(1000, &now)])),
        [
            "file.1000: 2000-01-02 00:00:00, peak 30 % → 2000-01-02 00:00:00, peak 30 %; most at \
          Torque at 57 %: 30 % → 18 %"
        ]
    );
    // Nothing but the voltage (record 106).
    let mut now = was.clone();
    now[106] = 380;
    assert_eq!(
        told(&with(&[(2000, &was)]), &with(&[(2000, &now)])),
        [
            "file.2000: 2000-01-02 00:00:00, peak 30 % → 2000-01-02 00:00:00, peak 30 %; Voltage: \
          400 V → 380 V"
        ]
    );
    // Table 39: time to 3 % is record 3, in tenths of a second; result 108, table 40: 110 records.
    let mut was = vec![0; 118];
    (was[3], was[108]) = (12, 1);
    let mut now = was.clone();
    now[3] = 19;
    let found = told(&with(&[(3000, &was)]), &with(&[(3000, &now)]));
    assert_eq!(found.len(), 1);
    assert!(
        found[0].ends_with("3 % of travel: 1.2 s → 1.9 s"),
        "{found:?}"
    );
    let (was, mut now) = (vec![0; 110], vec![0; 110]);
    now[100] = 255;
    let found = told(&with(&[(3500, &was)]), &with(&[(3500, &now)]));
    assert_eq!(found.len(), 1);
    assert!(
        found[0].ends_with("100 % of travel: 0.0 s → 25.5 s"),
        "{found:?}"
    );
    // One that only one of them has cannot be compared.
    let found = diff(&with(&[(1000, &torque(30, 1))]), &empty());
    assert!(found.is_empty());
    assert_eq!(
        (found.only_one.len(), found.only_one[0].in_second),
        (1, false)
    );
}

/// Section 8.11.3: 32 records an entry. File 5 has no layout: each record by itself.
#[test]
fn connections_and_unknown_records() {
    let entry = |level: u16, second: u16| {
        let mut words = vec![level];
        words.extend([0x4141; 24]);
        words.extend([0; 4]);
        words.extend([1, 0, second]);
        assert_eq!(words.len(), 32);
        words
    };
    let log = |entries: &[Vec<u16>]| {
        let count = u16::try_from(entries.len()).unwrap();
        [vec![count], entries.concat()].concat()
    };
    let (a, b) = (entry(1, 10), entry(2, 20));
    let old = with(&[(4, &log(std::slice::from_ref(&a)))]);
    let new = with(&[(4, &log(&[b, a]))]);
    let found = told(&old, &new);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("file.4.entry[1]:  → Service (2), "));
    assert!(
        found[0].ends_with("RS232 (1), 2000-01-01 00:00:20"),
        "{found:?}"
    );
    let old = with(&[(5, &[1, 2, 3, 4])]);
    let new = with(&[(5, &[1, 2, 0xABCD, 4])]);
    assert_eq!(told(&old, &new), ["file.5.record[2]: 0x0003 → 0xABCD"]);
}

/// Section 8.10: of a report that differs in one text, that one is told; another serial number is
/// said to be perhaps another actuator.
#[test]
fn identity_is_compared_text_by_text() {
    let report = |serial: &str, tag: &str| {
        let mut snapshot = empty();
        let mut pdu = vec![17, 0x52, 0, 0];
        pdu.extend(b"Biffi ICON3000  ");
        pdu.extend(format!("{serial:28}{tag:28}9.02  4.01").bytes());
        assert!(snapshot.absorb(&[17], &pdu));
        snapshot
    };
    let was = report("SIM004711", "XV-101");
    assert_eq!(
        told(&was, &report("SIM004711", "XV-102")),
        ["identity.valve_tag: XV-101 → XV-102"]
    );
    let other = report("SIM000001", "XV-101");
    assert_eq!(
        told(&was, &other),
        ["identity.serial_number: SIM004711 → SIM000001"]
    );
    let found = diff(&was, &other);
    assert_eq!((found.remarks.len(), found.lasting().count()), (1, 1));
    // A card report is identity too (table 49: card code in records 0 to 4).
    let card = |code: u16| {
        let mut words = vec![0x3030; 32];
        words[0] = code;
        with(&[(5301, &words)])
    };
    let found = diff(&card(0x3934), &card(0x3935));
    assert_eq!(found.changes.len(), 1);
    assert_eq!(found.changes[0].sort, Sort::Identity);
    assert_eq!(found.changes[0].path, "file.5301.card_code");
    assert_eq!(found.changes[0].was, "9400000000");
}

/// What only the newer model has is not compared, and that is said.
#[test]
fn two_models_are_compared_by_what_both_have() {
    let mut old = Snapshot::new(Model::Icon3000, 1, "XV-101");
    block(&mut old, 3, 3017, &[10]);
    let mut new = empty();
    block(&mut new, 3, 3017, &[12]);
    block(&mut new, 3, 3480, &[1]);
    file(&mut new, 1000, &torque(30, 1));
    let found = diff(&old, &new);
    assert_eq!(told(&old, &new), ["holding.3017: 1.0 % → 1.2 %"]);
    assert_eq!(found.remarks.len(), 1);
    assert!(found.remarks[0].contains("ICON3000, the second of an ICON3000v2"));
    let only: Vec<_> = found
        .only_one
        .iter()
        .map(|o| (o.path.as_str(), o.in_second))
        .collect();
    assert_eq!(only, [("holding.3480", true), ("file.1000", true)]);
}
