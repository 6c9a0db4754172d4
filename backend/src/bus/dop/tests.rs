use super::*;
use axum::extract::ws::Utf8Bytes;
use shared::device::Device;
use tokio::sync::mpsc;

const TAG: &str = "MX-1";

fn unit() -> DopUnit {
    let device = DeviceConfig {
        tag: TAG.into(),
        device: Device::Dop,
        bus: 0,
        unit: 4,
        description: String::new(),
        faults: Vec::new(),
        profile: Some(crate::sim::dop_profile()),
        target: None,
    };
    DopUnit::of(&device, &Gate::of(std::slice::from_ref(&device))).unwrap()
}

fn page() -> (Outlet, mpsc::Receiver<Utf8Bytes>) {
    let (sender, news) = mpsc::channel(Outlet::SIZE);
    (Outlet::new(sender), news)
}

fn read(id: u32, requests: Vec<u16>) -> DopAsk {
    DopAsk::Read {
        id,
        device: TAG.into(),
        requests,
    }
}

fn heard(news: &mut mpsc::Receiver<Utf8Bytes>) -> Vec<DopNews> {
    std::iter::from_fn(|| news.try_recv().ok())
        .map(|text| DopNews::from_text(&text).unwrap())
        .collect()
}

const CLIENT: ClientId = ClientId(1);

fn at(micros: u64) -> Micros {
    Micros::new(micros)
}

/// A page that takes nothing is waited for; nothing that matters is lost.
#[test]
fn a_slow_page_makes_its_own_job_wait() {
    let mut unit = unit();
    let (out, mut news) = page();
    // Words that are refused at once: each makes a message.
    unit.ask(CLIENT, read(1, vec![0x0FFF; 128]), out);
    let due = unit.due(at(0)).expect("it waits for room");
    assert!(due > at(0));
    assert!(unit.take(at(0)).is_none());
    let mut failed = 0;
    let mut done = false;
    let mut now = at(0);
    while !done {
        for message in heard(&mut news) {
            match message {
                DopNews::Failed { .. } => failed += 1,
                DopNews::Done { failed: 128, .. } => done = true,
                other => panic!("{other:?}"),
            }
        }
        now = unit.due(now).unwrap_or(now);
    }
    assert_eq!((failed, unit.due(now)), (128, None));
}

#[test]
fn a_line_that_is_lost_ends_all_jobs_and_says_so() {
    let mut unit = unit();
    let (out, mut news) = page();
    unit.ask(CLIENT, read(1, vec![1006, 1004]), out.clone());
    unit.ask(
        CLIENT,
        DopAsk::Log {
            id: 2,
            device: TAG.into(),
            object: 1202,
            from: shared::proto::LogFrom::Newest,
            after: None,
            limit: 0,
        },
        out,
    );
    assert!(matches!(unit.take(at(0)), Some(Step::Read(_))));
    unit.down("unplugged");
    let news = heard(&mut news);
    let kinds: Vec<(u32, &str)> = news
        .iter()
        .filter_map(|n| match n {
            DopNews::Failed {
                id,
                outcome: Outcome::Down,
                text,
                ..
            } => {
                assert_eq!(text, "unplugged");
                Some((*id, "failed"))
            }
            DopNews::LogEnd { id, text, .. } => {
                assert_eq!(text, "unplugged");
                Some((*id, "end"))
            }
            DopNews::Done {
                id, failed, ok: 0, ..
            } => {
                assert_eq!(*failed, if *id == 1 { 2 } else { 1 });
                Some((*id, "done"))
            }
            _ => None,
        })
        .collect();
    assert_eq!(kinds, [(1, "failed"), (1, "done"), (2, "end"), (2, "done")]);
    assert_eq!(unit.due(at(9)), None);
    // What comes late meets nobody.
    unit.reply(&Report::down("late"), at(10));
}

#[test]
fn the_queue_has_an_end() {
    let mut unit = unit();
    let (out, mut news) = page();
    for id in 0..70 {
        unit.ask(CLIENT, read(id, vec![1006]), out.clone());
    }
    let refused: Vec<u32> = heard(&mut news)
        .iter()
        .filter_map(|n| match n {
            DopNews::Done { id, failed: 1, .. } => Some(*id),
            _ => None,
        })
        .collect();
    assert_eq!(refused, [64, 65, 66, 67, 68, 69]);
}

/// What is under way ends; what was to come does not begin, and the end is said.
#[test]
fn cancel_and_leave_end_what_was_not_begun() {
    let mut unit = unit();
    let ((out, mut news), (other, mut others)) = (page(), page());
    unit.ask(CLIENT, read(1, vec![1006, 1004]), out.clone());
    unit.ask(ClientId(2), read(1, vec![1005]), other);
    assert!(matches!(unit.take(at(0)), Some(Step::Read(_))));
    unit.ask(CLIENT, DopAsk::Cancel { id: 1 }, out);
    unit.reply(&Report::failed(Outcome::Silence, "no answer".into()), at(5));
    assert!(unit.due(at(6)).is_some());
    let ended = heard(&mut news).iter().any(|n| {
        matches!(
            n,
            DopNews::Done {
                id: 1,
                ok: 0,
                failed: 1,
                ..
            }
        )
    });
    assert!(ended, "one failed, the other was not begun");
    // The id of the one page means nothing to the other.
    assert!(
        !heard(&mut others)
            .iter()
            .any(|n| matches!(n, DopNews::Done { .. }))
    );
    // A write without an answer is looked for in the status; that is silent as well.
    unit.leave(ClientId(2));
    for now in [9, 10] {
        unit.reply(
            &Report::failed(Outcome::Silence, "no answer".into()),
            at(now),
        );
    }
    assert_eq!(unit.due(at(11)), None);
}

/// A handshake by hand, register by register, up to the object.
#[test]
fn an_object_is_handed_over_with_its_course() {
    let mut unit = unit();
    let (out, mut news) = page();
    unit.ask(CLIENT, read(3, vec![405]), out);
    let words = |words: &[u16]| {
        let mut pdu = vec![3, 2 * words.len() as u8];
        pdu.extend(words.iter().flat_map(|w| w.to_be_bytes()));
        Report {
            outcome: Outcome::Ok,
            text: String::new(),
            pdu: Some(pdu),
            code: None,
        }
    };
    let data = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10];
    let mut now = 0;
    for answer in [
        words(&[0]),
        words(&[]),
        words(&[405 | 1 << 12]),
        words(&[405 | 2 << 12]),
        words(&[10]),
        words(&data),
        words(&[405 | 2 << 12]),
    ] {
        now = unit.due(at(now)).unwrap().get();
        let step = unit.take(at(now)).expect("a step");
        let answer = match &step {
            Step::Write(permit) => {
                assert_eq!(permit.pdu(), [6, 0x0F, 0xA0, 0x01, 0x95]);
                Report {
                    pdu: Some(permit.pdu().to_vec()),
                    ..words(&[])
                }
            }
            _ => answer,
        };
        now += 10_000;
        unit.reply(&answer, at(now));
    }
    assert_eq!(unit.due(at(now)), None);
    let object = heard(&mut news)
        .into_iter()
        .find(|n| matches!(n, DopNews::Object { .. }));
    // Looks at 10 and 30 ms, a pause of an eighth of 250 ms, ready at 71.25, the end at 101.25.
    let want = DopNews::Object {
        id: 3,
        device: TAG.into(),
        request: 405,
        hex: "000100020003000400050006000700080009000A".into(),
        at_us: 101_250,
        took_us: 101_250,
        busy_us: 71_250,
        polls: 3,
        retries: 0,
        foreign: 0,
        text: "10 registers in 1 block, 101 ms".into(),
    };
    assert_eq!(object, Some(want));
}

/// A device that is not there is asked twice, not for each of a hundred objects.
#[test]
fn a_silent_device_is_given_up() {
    let mut unit = unit();
    let (out, mut news) = page();
    let requests: Vec<u16> = [1006, 1004, 1005, 1003].repeat(8);
    unit.ask(CLIENT, read(1, requests), out);
    let (mut asked, mut now) = (0, 0);
    while let Some(due) = unit.due(at(now)) {
        now = due.get();
        if unit.take(at(now)).is_some() {
            asked += 1;
            now += 500_000;
            unit.reply(
                &Report::failed(Outcome::Silence, "no answer".into()),
                at(now),
            );
        }
    }
    // A look at the status each time: nothing is written before that was read once.
    assert_eq!(asked, 2);
    let failed: Vec<String> = heard(&mut news)
        .into_iter()
        .filter_map(|n| match n {
            DopNews::Failed {
                text,
                outcome: Outcome::Silence,
                ..
            } => Some(text),
            _ => None,
        })
        .collect();
    assert_eq!(failed.len(), 32);
    assert!(failed[..2].iter().all(|t| t.contains("no answer")));
    assert!(failed[2..].iter().all(|t| t.contains("not asked for")));
}
