use super::*;

/// A run over a log with the default commands: newest 0, oldest 1, older 2, newer 3 (reading M5).
fn run(id: u16, from: LogFrom, after: Option<u64>, limit: u32) -> LogRun {
    LogRun::new(id, from, after, limit, &Profile::default()).unwrap()
}

fn keys(records: &[(u64, i64)]) -> Vec<Key> {
    let key = |(id, time): &(u64, i64)| Key {
        id: *id,
        time: *time,
    };
    records.iter().map(key).collect()
}

/// A device with a log: records from the oldest to the newest, pages of two.
struct Device {
    records: Vec<(u64, i64)>,
    /// Index behind which the last page ended.
    mark: usize,
}

impl Device {
    fn answer(&mut self, option: u8) -> Vec<Key> {
        let len = self.records.len();
        let page: Vec<usize> = match option {
            0 => (0..len).rev().take(2).collect(),
            1 => (0..len).take(2).collect(),
            2 => (0..self.mark).rev().take(2).collect(),
            3 => (self.mark + 1..len).take(2).collect(),
            _ => panic!("{option}"),
        };
        if let Some(last) = page.last() {
            self.mark = *last;
        }
        keys(&page.iter().map(|at| self.records[*at]).collect::<Vec<_>>())
    }
}

/// Reads to the end; gives the ids that were new.
fn read(run: &mut LogRun, device: &mut Device) -> Vec<u64> {
    let mut ids = Vec::new();
    while let Some(request) = run.next() {
        let page = device.answer(request.option());
        let new = run.take(&page).new;
        ids.extend(new.iter().map(|at| page[*at].id));
    }
    ids
}

fn device(ids: core::ops::RangeInclusive<u64>) -> Device {
    Device {
        records: ids.map(|id| (id, 1000 + id as i64)).collect(),
        mark: 0,
    }
}

#[test]
fn the_requests_are_those_of_the_profile() {
    let first = run(1202, LogFrom::Newest, None, 0);
    assert_eq!(first.next().unwrap().word(), 0x04B2);
    let first = run(1203, LogFrom::Oldest, None, 0);
    assert_eq!(first.next().unwrap().word(), 0x14B3);
    let profile = Profile::from_json(r#"{"log":{"newest":4,"older":7,"present":0}}"#).unwrap();
    let mut other = LogRun::new(1202, LogFrom::Newest, None, 0, &profile).unwrap();
    assert_eq!(other.next().unwrap().word(), 0x44B2);
    other.take(&keys(&[(9, 9)]));
    assert_eq!(other.next().unwrap().word(), 0x74B2);
    assert!(LogRun::new(1006, LogFrom::Newest, None, 0, &profile).is_none());
    assert!(LogRun::new(2000, LogFrom::Newest, None, 0, &profile).is_none());
}

#[test]
fn a_log_is_read_in_either_direction_until_a_page_is_empty() {
    let mut newest = run(1202, LogFrom::Newest, None, 0);
    assert_eq!(read(&mut newest, &mut device(1..=5)), [5, 4, 3, 2, 1]);
    assert_eq!((newest.stop(), newest.pages()), (Some(&Stop::Complete), 4));
    let mut oldest = run(1202, LogFrom::Oldest, None, 0);
    assert_eq!(read(&mut oldest, &mut device(1..=5)), [1, 2, 3, 4, 5]);
    assert_eq!((oldest.stop(), oldest.pages()), (Some(&Stop::Complete), 4));
    let mut none = run(1203, LogFrom::Newest, None, 0);
    let mut empty = Device {
        records: Vec::new(),
        mark: 0,
    };
    assert_eq!(read(&mut none, &mut empty), [0_u64; 0]);
    assert_eq!((none.stop(), none.pages()), (Some(&Stop::Complete), 1));
}

/// Reading B14: the ids of object 1203 come round at 65535, in either direction.
#[test]
fn ids_may_come_round() {
    let records = [65_533, 65_534, 65_535, 0, 1, 2];
    let records: Vec<(u64, i64)> = records.iter().zip(100..).map(|(i, t)| (*i, t)).collect();
    for (from, want) in [
        (LogFrom::Newest, [2, 1, 0, 65_535, 65_534, 65_533]),
        (LogFrom::Oldest, [65_533, 65_534, 65_535, 0, 1, 2]),
    ] {
        let mut log = run(1203, from, None, 0);
        let mut device = Device {
            records: records.clone(),
            mark: 0,
        };
        assert_eq!(read(&mut log, &mut device), want);
        assert_eq!(log.stop(), Some(&Stop::Complete));
        // All in the same second: only the ids tell the direction.
        let mut log = run(1203, from, None, 0);
        let same: Vec<(u64, i64)> = records.iter().map(|(id, _)| (*id, 100)).collect();
        let mut device = Device {
            records: same,
            mark: 0,
        };
        assert_eq!(read(&mut log, &mut device), want);
        assert_eq!(log.stop(), Some(&Stop::Complete));
    }
}

#[test]
fn a_page_that_repeats_ends_the_log() {
    let mut log = run(1202, LogFrom::Newest, None, 0);
    assert_eq!(log.take(&keys(&[(9, 90), (8, 80)])).new, [0, 1]);
    // One record twice is left out, the other is taken.
    let page = log.take(&keys(&[(8, 80), (7, 70)]));
    assert_eq!((page.new, page.repeated), (vec![1], 1));
    assert_eq!(log.stop(), None);
    let page = log.take(&keys(&[(8, 80), (7, 70)]));
    assert_eq!((page.new.len(), page.repeated), (0, 2));
    assert_eq!(log.stop(), Some(&Stop::Repeated(8)));
    assert_eq!((log.next(), log.records()), (None, 3));
}

#[test]
fn time_that_goes_the_wrong_way_ends_the_log_and_loses_nothing() {
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.take(&keys(&[(9, 90), (8, 80)]));
    let page = log.take(&keys(&[(10, 100), (11, 110)]));
    assert_eq!(page.new, [0, 1], "what came is kept");
    assert_eq!(log.stop(), Some(&Stop::WrongWay(11)));
    let mut log = run(1202, LogFrom::Oldest, None, 0);
    log.take(&keys(&[(1, 10), (2, 20)]));
    log.take(&keys(&[(0, 5)]));
    assert_eq!(log.stop(), Some(&Stop::WrongWay(0)));
    assert!(log.stop().unwrap().to_string().contains("log commands"));
}

#[test]
fn error_3_is_an_end_behind_the_first_page_only() {
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.take(&keys(&[(9, 90)]));
    log.failed(Some(3), "x");
    assert_eq!(log.stop(), Some(&Stop::Option));
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.failed(Some(3), "x");
    assert_eq!(log.stop(), Some(&Stop::Failed("x".into())));
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.take(&keys(&[(9, 90)]));
    log.failed(Some(8), "y");
    assert_eq!(log.stop(), Some(&Stop::Failed("y".into())));
}

#[test]
fn limits_hold() {
    let mut log = run(1202, LogFrom::Newest, None, 3);
    assert_eq!(read(&mut log, &mut device(1..=50)), [50, 49, 48]);
    assert_eq!(log.stop(), Some(&Stop::Limit(3)));
    // A profile that allows four pages.
    let profile = Profile::from_json(r#"{"reading":{"log_limit":4}}"#).unwrap();
    let mut log = LogRun::new(1202, LogFrom::Newest, None, 0, &profile).unwrap();
    assert_eq!(read(&mut log, &mut device(1..=50)).len(), 4);
    assert_eq!(log.stop(), Some(&Stop::Limit(4)));
}

/// To go on where it stopped: what was read before is passed over.
#[test]
fn a_run_resumes_behind_a_record() {
    let mut log = run(1202, LogFrom::Newest, Some(4), 0);
    assert_eq!(read(&mut log, &mut device(1..=6)), [3, 2, 1]);
    assert_eq!(log.stop(), Some(&Stop::Complete));
    let mut log = run(1202, LogFrom::Oldest, Some(3), 0);
    assert_eq!(read(&mut log, &mut device(1..=6)), [4, 5, 6]);
}

#[test]
fn cancel_ends_it() {
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.take(&keys(&[(9, 90)]));
    log.cancel();
    assert_eq!((log.next(), log.stop()), (None, Some(&Stop::Cancelled)));
    // A page that comes all the same changes nothing.
    assert!(log.take(&keys(&[(8, 80)])).new.is_empty());
}

/// The mark in the device moved on with a page that was lost: going back finds its records.
#[test]
fn a_lost_page_is_fetched_by_going_back() {
    let mut device = device(1..=9);
    let mut log = run(1202, LogFrom::Newest, None, 0);
    let mut ids = Vec::new();
    let mut lost = false;
    while let Some(request) = log.next() {
        let page = device.answer(request.option());
        if log.pages() == 2 && !lost {
            lost = true;
            assert!(!log.is_at_start());
            assert!(log.disturbed() && log.is_at_start());
            continue;
        }
        let new = log.take(&page).new;
        ids.extend(new.iter().map(|at| page[*at].id));
    }
    assert_eq!(ids, [9, 8, 7, 6, 5, 4, 3, 2, 1]);
    assert_eq!(log.stop(), Some(&Stop::Complete));
    assert_eq!(log.rewinds(), 1);
    // Not for ever.
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.take(&keys(&[(9, 90)]));
    assert!((0..3).all(|_| log.disturbed()));
    assert!(!log.disturbed());
}

/// A device that gives known pages only, over and over, does not hold a run that went back.
#[test]
fn going_back_ends_too() {
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.take(&keys(&[(9, 90)]));
    log.disturbed();
    for _ in 0..10 {
        log.take(&keys(&[(9, 90)]));
    }
    assert_eq!(log.stop(), Some(&Stop::Repeated(9)));
    assert!(log.pages() <= 11);
}

/// Registers as the device sends them: one event record by hand (AIIOM000698-01, section 8.1).
#[test]
fn pages_are_read_from_registers() {
    let mut words = vec![1, 0x1234, 0x0001, 0x9ECB, 0x6026, 0, 0, 3];
    words.extend([u16::from_le_bytes(*b"Ph"), u16::from_le_bytes(*b"as")]);
    words.resize(1 + 27, 0);
    let profile = Profile::default();
    let read = ObjectRead::read(Request::from_word(0x04B2), &words, &profile);
    let mut log = run(1202, LogFrom::Newest, None, 0);
    assert_eq!(log.page(&read).new, [0]);
    let want = Key {
        time: 0x6026_9ECB,
        id: 0x0001_1234,
    };
    assert_eq!(log.seen.iter().next(), Some(&want));
    let empty = ObjectRead::read(Request::from_word(0x24B2), &[0], &profile);
    assert!(log.page(&empty).new.is_empty());
    assert_eq!(log.stop(), Some(&Stop::Complete));
    // Eighteen records are announced and none is there.
    let short = ObjectRead::read(Request::from_word(0x04B2), &[18], &profile);
    let mut log = run(1202, LogFrom::Newest, None, 0);
    log.page(&short);
    assert_eq!(log.stop(), Some(&Stop::Short));
}

proptest::proptest! {
    /// Any pages whatever end a run, and no record is handed over twice.
    #[test]
    fn any_pages_end(
        pages in proptest::collection::vec(
            proptest::collection::vec((0_u64..40, 0_i64..40), 0..5), 1..30),
        oldest in proptest::prelude::any::<bool>(),
        disturbed in 0_usize..30,
    ) {
        let from = if oldest { LogFrom::Oldest } else { LogFrom::Newest };
        let mut log = run(1203, from, None, 200);
        let mut seen = BTreeSet::new();
        let mut steps = 0;
        for page in pages.iter().cycle() {
            if log.next().is_none() {
                break;
            }
            steps += 1;
            assert!(steps < 3_000, "goes on for ever");
            if steps == disturbed {
                log.disturbed();
            }
            let page = keys(page);
            for at in log.take(&page).new {
                assert!(seen.insert(page[at]), "twice");
            }
        }
        assert!(log.stop().is_some());
    }
}
