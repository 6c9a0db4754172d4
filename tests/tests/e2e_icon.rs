//! The ICON3000 in depth end to end: a simulated actuator saved as a snapshot, opened, looked at and
//! compared, as a person sees it. What a page shows is compared with the words of the snapshot.

#[path = "e2e_icon/live.rs"]
mod live;

use std::time::Duration;

use serde_json::Value;
use shared::capture::Micros;
use shared::icon3000::collect::Answer;
use shared::icon3000::{Collector, Log, Snapshot};
use shared::map::row::Model;
use shared::sim::{Icon3000, Programme};
use tests::browser::{Page, Scheme};

/// A simulated actuator, read whole: nothing of the page or the bridge takes part.
fn device(model: Model) -> Snapshot {
    let mut device = Icon3000::new(model, "XV-101", Programme::Strokes);
    // Long enough for a stroke.
    for second in 0..120_u64 {
        device.advance(Micros::new(second * 1_000_000), 1_795_651_200 + second);
    }
    let mut empty = Snapshot::new(model, 1, "XV-101");
    empty.tool = "test".into();
    empty.taken = "2025-12-06T05:48:40Z".into();
    let mut collector = Collector::new(empty);
    while let Some(step) = collector.step() {
        let pdu = step.pdu.clone();
        match device.answer(&pdu) {
            Some(answer) => collector.answer(Answer::Response(&answer)),
            None => collector.answer(Answer::Failed("no answer")),
        };
    }
    collector.finish()
}

/// Opens a snapshot as if its file had been chosen.
async fn open(page: &Page, name: &str, text: &str) {
    page.wait_for("[data-testid=snapshot-file]").await;
    let text = serde_json::to_string(text).expect("a text");
    page.eval(&format!(
        "const files = new DataTransfer();
         files.items.add(new File([{text}], {name:?}));
         const input = document.querySelector('[data-testid=snapshot-file]');
         input.files = files.files;
         input.dispatchEvent(new Event('change', {{ bubbles: true }}));"
    ))
    .await;
}

/// The page as a single file from a disk: no bridge takes part.
async fn single_file() -> Page {
    let file = tests::target_dir().with_file_name("static/dist/valvescope.html");
    assert!(file.is_file(), "run `cargo xtask web` first");
    let page = Page::open(&format!("file://{}#/snapshots", file.display())).await;
    page.show(1440, 900, Scheme::Light).await;
    page
}

/// A page with the snapshot of a simulated ICON3000v2 open on one of its tabs.
async fn opened(tab: &str) -> (Page, Snapshot) {
    let snapshot = device(Model::Icon3000v2);
    let page = single_file().await;
    open(&page, "xv-101.json", &snapshot.to_text()).await;
    page.wait_for("[data-testid=snapshot]").await;
    go(&page, tab).await;
    (page, snapshot)
}

/// Goes to a tab of the first saved device.
async fn go(page: &Page, tab: &str) {
    let (tab, query) = tab.split_once('?').unwrap_or((tab, ""));
    page.eval(&format!(
        "location.hash = '#/snapshots/{tab}?of=0{}{query}'",
        if query.is_empty() { "" } else { "&" }
    ))
    .await;
    page.wait_for(&format!("[data-testid=page-{tab}]")).await;
}

async fn count(page: &Page, css: &str) -> u64 {
    let script = format!("return document.querySelectorAll({css:?}).length");
    page.eval(&script).await.as_u64().expect("a number")
}

/// Waits until an expression with `$` for the first element of a selector is true.
async fn until(page: &Page, css: &str, test: &str) {
    let test = test.replace('$', "e");
    page.wait_until(&format!(
        "(e => e && ({test}))(document.querySelector({css:?}))"
    ))
    .await;
}

/// Both sizes in both schemes, for people to look at.
async fn look(page: &Page, name: &str) {
    for (scheme, shade) in [(Scheme::Light, "light"), (Scheme::Dark, "dark")] {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.show(width, height, scheme).await;
            tokio::time::sleep(Duration::from_millis(200)).await;
            page.screenshot(&format!("icon-{name}-{width}-{shade}"))
                .await;
        }
    }
    page.show(1440, 900, Scheme::Light).await;
}

/// Keeps what the page saves, so that a test can read it.
async fn keep_saved(page: &Page) {
    page.eval(
        "window.saved = [];
         const make = URL.createObjectURL.bind(URL);
         URL.createObjectURL = blob => { blob.text().then(t => window.saved.push(t)); return make(blob); };",
    )
    .await;
}

/// The last text that was saved.
async fn saved(page: &Page, number: usize) -> String {
    page.wait_until(&format!("window.saved.length >= {number}"))
        .await;
    let text = page
        .eval("return window.saved[window.saved.length - 1]")
        .await;
    text.as_str().expect("a text").to_owned()
}

/// Reads what a series shows: pairs of x and y in the units of the axes, told by the ticks.
async fn drawn(page: &Page, chart: &str, series: &str) -> Vec<(f64, f64)> {
    let script = format!(
        "const svg = document.querySelector('[data-chart={chart:?}] [data-testid=chart-svg]');
         const ticks = [...svg.querySelectorAll('text[data-tick=y]')].map(t =>
           [Number(t.getAttribute('y')) - 4,
            Number(t.textContent.replaceAll('\\u2009', '').replace('\\u2212', '-'))]);
         const [a, b] = [ticks[0], ticks[ticks.length - 1]];
         const y = p => a[1] + (p - a[0]) / (b[0] - a[0]) * (b[1] - a[1]);
         const [left, , width] = svg.dataset.plot.split(' ').map(Number);
         const [low, high] = svg.dataset.x.split(' ').map(Number);
         const x = p => low + (p - left) / width * (high - low);
         const d = svg.querySelector('path[data-series={series:?}]').getAttribute('d');
         return [...d.matchAll(/[ML](-?[\\d.]+) (-?[\\d.]+)/g)].map(m => [x(Number(m[1])), y(Number(m[2]))]);"
    );
    let found = page.eval(&script).await;
    let pair = |p: &Value| Some((p.get(0)?.as_f64()?, p.get(1)?.as_f64()?));
    let points = found.as_array().expect("points").iter();
    points.map(|p| pair(p).expect("two numbers")).collect()
}

/// Holds that a series shows these values, within what a pixel can say.
async fn shows(page: &Page, chart: &str, series: &str, wanted: &[f64]) {
    let points = drawn(page, chart, series).await;
    let span = wanted.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
    assert_eq!(points.len(), wanted.len(), "{chart} {series}: {points:?}");
    for ((_, y), wanted) in points.iter().zip(wanted) {
        assert!(
            (y - wanted).abs() < span * 0.006 + 0.05,
            "{chart} {series}: {y} instead of {wanted}"
        );
    }
}

/// Torque over position: the latest stroke against its reference, as the files say.
#[tokio::test]
async fn torque_signatures_are_drawn_as_they_were_read() {
    let (page, snapshot) = opened("curves").await;
    page.wait_for("[data-chart=torque] [data-testid=chart-svg]")
        .await;
    for file in [1000, 1001] {
        let records = snapshot.files.get(file).expect("a curve");
        let words = records.run(0, 101).expect("all samples");
        let wanted: Vec<f64> = words.iter().map(|w| f64::from(w.cast_signed())).collect();
        shows(&page, "torque", &format!("file-{file}"), &wanted).await;
    }
    look(&page, "curves").await;
    page.click("[data-testid=preset][data-key=both]").await;
    page.wait_for("path[data-series=file-2001]").await;
    assert_eq!(
        count(&page, "[data-chart=torque] path[data-series]").await,
        2
    );
    page.click("[data-testid=preset][data-key=all]").await;
    until(
        &page,
        "[data-testid=signatures]",
        "$.querySelectorAll('tbody tr').length > 4",
    )
    .await;
    let verdict = page.text("[data-testid=thresholds]").await;
    assert!(verdict.contains("10 points"), "{verdict}");
    keep_saved(&page).await;
    page.click("[data-testid=chart-save-csv]").await;
    let csv = saved(&page, 1).await;
    assert_eq!(csv.lines().count(), 102, "a head and 101 positions");
    look(&page, "curves-all").await;
    page.assert_clean().await;
}

/// A partial stroke: times, limits and the result in words; an emergency stroke; recorders.
#[tokio::test]
async fn strokes_and_trends_are_drawn_as_they_were_read() {
    let (page, snapshot) = opened("curves?show=pst").await;
    page.wait_for("[data-chart=pst] [data-testid=chart-svg]")
        .await;
    let records = snapshot.files.get(3001).expect("a stroke");
    let log = Log::read(3001, records).expect("a layout");
    let travel = log
        .get("travel_limit")
        .and_then(shared::icon3000::Item::number)
        .expect("a travel");
    let points = drawn(&page, "pst", "out").await;
    let at = usize::try_from(travel).expect("a place");
    let tenths = records.run(0, 51).expect("times")[at];
    let (x, y) = points[at];
    assert!(
        (x - 20.0).abs() < 100.0 && (y - f64::from(tenths) / 10.0).abs() < 0.2,
        "{points:?}"
    );
    let verdict = page.text("[data-testid=verdict]").await;
    assert!(!verdict.is_empty());
    look(&page, "pst").await;
    go(&page, "curves?show=efs").await;
    look(&page, "efs").await;
    go(&page, "curves?show=trends").await;
    page.wait_for("[data-testid=recorder]").await;
    let stored = snapshot
        .files
        .get(5100)
        .and_then(|r| r.get(0))
        .expect("a count");
    let series = "trend-5100-electronics_temperature";
    page.wait_for(&format!("[data-chart={series}] svg")).await;
    let points = drawn(&page, series, "motor_temperature").await;
    assert_eq!(points.len(), usize::from(stored));
    look(&page, "trends").await;
    page.assert_clean().await;
}

/// Every log: as many rows as the file says, sorted, filtered, exported.
#[tokio::test]
async fn logs_are_tables() {
    let (page, snapshot) = opened("logs").await;
    for file in [2, 3, 4, 5000] {
        page.click(&format!("[data-testid=icon-log-{file}]")).await;
        let stored = snapshot
            .files
            .get(file)
            .and_then(|r| r.get(0))
            .expect("a count");
        until(
            &page,
            "[data-testid=log-status]",
            &format!("$.innerText.startsWith('{stored} ')"),
        )
        .await;
        look(&page, &format!("log-{file}")).await;
    }
    page.click("[data-testid=icon-log-2]").await;
    page.wait_for("[data-testid=log-row]").await;
    let first = "document.querySelector('[data-testid=log-row]').dataset.number";
    page.wait_until(&format!("{first} == '1'")).await;
    page.click("[data-testid=log-sort][data-column=number]")
        .await;
    let stored = snapshot
        .files
        .get(2)
        .and_then(|r| r.get(0))
        .expect("a count");
    page.wait_until(&format!("{first} == '{stored}'")).await;
    keep_saved(&page).await;
    page.click("[data-testid=log-csv]").await;
    let csv = saved(&page, 1).await;
    assert_eq!(csv.lines().count(), usize::from(stored) + 1, "{csv}");
    assert!(csv.starts_with("number,device_time,utc,"), "{csv}");
    page.click("[data-testid=log-json]").await;
    let json: Value = serde_json::from_str(&saved(&page, 2).await).expect("JSON");
    assert_eq!(json.as_array().map(Vec::len), Some(usize::from(stored)));
    let codes: Vec<u64> = json
        .as_array()
        .expect("a list")
        .iter()
        .rev()
        .map(|e| e["code_raw"].as_u64().expect("a code"))
        .collect();
    let words = snapshot.files.get(2).expect("a log");
    let wanted: Vec<u64> = (0..stored)
        .map(|n| u64::from(words.get(3 + 3 * n).expect("a code")))
        .collect();
    assert_eq!(codes, wanted, "the oldest first on the screen");
    page.assert_clean().await;
}

/// Health, identity, counters, settings: read back from the words of the snapshot.
#[tokio::test]
async fn everything_else_is_shown_as_it_was_read() {
    let (page, snapshot) = opened("health").await;
    let sum = page.text("[data-testid=health-sum]").await;
    assert!(!sum.is_empty());
    look(&page, "health").await;

    go(&page, "identity").await;
    let report = snapshot.report().expect("a report");
    until(
        &page,
        "[data-testid=identity][data-key=serial_number]",
        &format!("$.innerText.includes({:?})", report.serial_number),
    )
    .await;
    assert_eq!(count(&page, "[data-testid=card]").await, 5);
    look(&page, "identity").await;

    go(&page, "communication").await;
    let messages = snapshot.counters.get(&14).expect("a counter").to_string();
    until(
        &page,
        "[data-testid=counter][data-sub='14']",
        &format!("$.innerText.replaceAll('\\u2009', '').includes('{messages}')"),
    )
    .await;
    look(&page, "communication").await;

    go(&page, "configuration").await;
    until(&page, "[data-testid=words-pst]", "$.innerText.length > 60").await;
    page.click("[data-testid=icon-row][data-address='3615'] button")
        .await;
    until(
        &page,
        "[data-testid=icon-row][data-address='3615']",
        "$.innerText.includes('E03') && $.innerText.includes('VCIOM-16345-EN')",
    )
    .await;
    look(&page, "configuration").await;
    page.assert_clean().await;
}

/// A device with itself has no change; with three settings changed by hand exactly three.
#[tokio::test]
async fn snapshots_are_compared_by_meaning() {
    let before = device(Model::Icon3000v2);
    let mut after = before.clone();
    for (address, word) in [(3615, 25), (3580, 9), (3017, 33)] {
        let [high, low] = u16::to_be_bytes(address);
        let [a, b] = u16::to_be_bytes(word);
        assert!(after.absorb(&[3, high, low, 0, 1], &[3, 2, a, b]));
    }
    let page = single_file().await;
    page.wait_for("[data-testid=snapshot-file]").await;
    look(&page, "snapshots-none").await;
    open(&page, "no.json", "{}").await;
    let trouble = page.text("[data-testid=snapshot-trouble]").await;
    assert!(trouble.contains("no.json is no snapshot"), "{trouble}");
    open(&page, "before.json", &before.to_text()).await;
    page.wait_for("[data-testid=snapshot][data-key='0']").await;
    open(&page, "after.json", &after.to_text()).await;
    page.wait_for("[data-testid=snapshot][data-key='1']").await;
    page.eval("location.hash = '#/snapshots?from=0&to=0'").await;
    until(
        &page,
        "[data-testid=compare-sum]",
        "$.innerText === 'No change.'",
    )
    .await;
    page.eval("location.hash = '#/snapshots?from=0&to=1'").await;
    until(
        &page,
        "[data-testid=compare-sum]",
        "$.innerText.startsWith('3 changes')",
    )
    .await;
    assert_eq!(count(&page, "[data-testid=change]").await, 3);
    until(
        &page,
        "[data-path='holding.3615']",
        "$.innerText.includes('25 %')",
    )
    .await;
    look(&page, "compare").await;
    page.assert_clean().await;
}

/// An older model has no files, and the page says so; nothing is asked of anybody.
#[tokio::test]
async fn an_older_model_shows_what_it_has() {
    let page = single_file().await;
    let snapshot = device(Model::Icon3000);
    open(&page, "old.json", &snapshot.to_text()).await;
    page.wait_for("[data-testid=snapshot]").await;
    go(&page, "curves").await;
    page.wait_for("[data-chart=torque] [data-testid=chart-svg]")
        .await;
    go(&page, "curves?show=pst").await;
    until(
        &page,
        "[data-testid=icon-nothing]",
        "$.innerText.includes('no files')",
    )
    .await;
    go(&page, "configuration").await;
    until(
        &page,
        "[data-testid=level]",
        "$.innerText.includes('no user levels')",
    )
    .await;
    let asked = page.requests().await;
    assert!(
        asked
            .iter()
            .all(|url| url.starts_with("file:") || url.starts_with("data:")),
        "{asked:#?}"
    );
}
