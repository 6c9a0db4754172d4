use super::*;
use shared::proto::DopStep;

fn hear(site: &mut Site, json: &str) {
    site.hear(&DopNews::from_text(json).expect(json), 1_000_000);
}

/// Object 405 with an open torque of 42.5 %.
const TORQUE: &str = r#"{"dop":{"object":{"id":7,"device":"M","request":405,"hex":"9ECB60260000000001A900000000000000000136","at_us":2000,"took_us":310000,"busy_us":250000,"polls":2,"retries":1,"foreign":0,"text":""}}}"#;

#[test]
fn a_read_goes_from_asked_to_done() {
    let mut site = Site::default();
    site.asked(7, &[Request::from_word(405), Request::from_word(1005)]);
    assert_eq!(site.reading().map(|j| (j.done, j.total)), Some((0, 2)));
    site.hear(
        &DopNews::Progress {
            id: 7,
            device: "M".into(),
            request: 405,
            step: DopStep::Busy,
            done: 0,
            total: 2,
            text: "busy".into(),
        },
        0,
    );
    assert_eq!(site.reading().unwrap().text, "busy");
    hear(&mut site, TORQUE);
    assert_eq!(site.reading().unwrap().done, 1);
    let kept = &site.kept[&405];
    assert_eq!((kept.words.len(), kept.words[4]), (10, 425));
    assert_eq!(kept.wall_ms, Some(1_000_002));
    assert_eq!(kept.course.unwrap().busy_us, 250_000);
    hear(
        &mut site,
        r#"{"dop":{"failed":{"id":7,"device":"M","request":1005,"code":10,"outcome":"ok","text":"link busy"}}}"#,
    );
    assert_eq!(site.failed[&1005].code, Some(10));
    hear(
        &mut site,
        r#"{"dop":{"done":{"id":7,"device":"M","ok":1,"failed":1}}}"#,
    );
    assert!(site.jobs.is_empty());
    assert_eq!(site.last, "1 object read, 1 could not be.");
    // Asking again forgets the failure.
    site.asked(8, &[Request::from_word(1005)]);
    assert!(site.failed.is_empty());
    site.lost();
    assert!(site.jobs.is_empty() && site.last.contains("lost"));
}

#[test]
fn a_log_grows_and_is_resumed() {
    let mut site = Site::default();
    site.asked_log(3, EVENTS, false, false);
    // One record: number 5, 2021-02-12 15:29:15, failure, no text.
    let page = format!(
        r#"{{"dop":{{"object":{{"id":3,"device":"M","request":1202,"hex":"0001000500009ECB6026000000000003{}","at_us":0,"took_us":1,"busy_us":1,"polls":1,"retries":0,"foreign":0,"text":""}}}}}}"#,
        "0000".repeat(20)
    );
    hear(&mut site, &page);
    hear(
        &mut site,
        r#"{"dop":{"log_end":{"id":3,"device":"M","object":1202,"pages":1,"text":"no more"}}}"#,
    );
    hear(
        &mut site,
        r#"{"dop":{"done":{"id":3,"device":"M","ok":1,"failed":0}}}"#,
    );
    assert_eq!(site.events.records.len(), 1);
    assert_eq!(site.events.end.as_deref(), Some("no more"));
    assert_eq!(site.events.records[0].category, Some(3));
    site.asked_log(4, EVENTS, false, true);
    assert_eq!((site.events.records.len(), &site.events.end), (1, &None));
    assert!(site.job_of_log(EVENTS).is_some() && site.reading().is_none());
    site.cancelled(4);
    assert!(site.jobs[0].cancelled);
    site.asked_log(5, EVENTS, true, false);
    assert!(site.events.records.is_empty() && site.events.from_oldest);
}

#[test]
fn indicators_are_put_together_low_word_first() {
    let mut site = Site::default();
    hear(
        &mut site,
        r#"{"dop":{"indicators":{"device":"M","hex":"0001000000008000","at_us":9}}}"#,
    );
    assert_eq!(site.indicators, Some(((1 << 63) | 1, 9)));
}

#[test]
fn the_profile_is_that_of_the_backend() {
    let mut site = Site::default();
    hear(
        &mut site,
        r#"{"dop":{"profile":{"device":"M","profile":{"format":"valvescope-dop-profile","version":1,"name":"Site A"},"shift":12}}}"#,
    );
    assert!(site.known);
    assert_eq!(
        (site.profile.name.as_str(), site.shift),
        ("Site A", Some(12))
    );
}

#[test]
fn every_object_with_every_option_is_asked_for_once() {
    let all = all_requests(&Profile::default());
    // Thirty objects without the logs. Options: 1, 203, 204, 401, 601 and 604 have four, 3, 4 and 7
    // three, 202 two, the other twenty one.
    assert_eq!(all.len(), 6 * 4 + 3 * 3 + 2 + 20);
    let mut words: Vec<_> = all.iter().map(|r| r.word()).collect();
    words.sort_unstable();
    words.dedup();
    assert_eq!(words.len(), all.len());
}
