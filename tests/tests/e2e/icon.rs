//! The ICON3000 in depth end to end: a simulated actuator saved as a snapshot, opened, looked at and
//! compared, as a person sees it. What a page shows is compared with the words of the snapshot.

mod live;
mod older;

use serde_json::Value;
use shared::address::{Address, Table};
use shared::capture::Micros;
use shared::icon3000::collect::Answer;
use shared::icon3000::{Collector, Log, Snapshot};
use shared::map::row::Model;
use shared::sim::{Fault, Icon3000, Programme};
use tests::browser::{Page, Scheme};

/// A simulated actuator, read whole: nothing of the page or the bridge takes part.
fn device(model: Model) -> Snapshot {
    faulty(model, &[])
}

/// The same with faults in it.
fn faulty(model: Model, faults: &[Fault]) -> Snapshot {
    let mut device = Icon3000::new(model, "XV-101", Programme::Strokes);
    for fault in faults {
        device.set_fault(*fault, true);
    }
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

/// The field that opens a snapshot.
const FILE: &str = "[data-testid=snapshot-file]";

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
    opened_with(tab, device(Model::Icon3000v2)).await
}

/// A page with this snapshot open on one of its tabs.
async fn opened_with(tab: &str, snapshot: Snapshot) -> (Page, Snapshot) {
    let page = single_file().await;
    page.open_file(FILE, "xv-101.json", &snapshot.to_text())
        .await;
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
        page.assert_shows("torque", &format!("file-{file}"), &wanted)
            .await;
    }
    page.look("icon-curves").await;
    page.click("[data-testid=preset][data-key=both]").await;
    page.wait_for("path[data-series=file-2001]").await;
    assert_eq!(page.count("[data-chart=torque] path[data-series]").await, 2);
    page.click("[data-testid=preset][data-key=all]").await;
    page.until(
        "[data-testid=signatures]",
        "$.querySelectorAll('tbody tr').length > 4",
    )
    .await;
    let verdict = page.text("[data-testid=thresholds]").await;
    assert!(verdict.contains("10 points"), "{verdict}");
    page.keep_saved().await;
    page.click("[data-testid=chart-save-csv]").await;
    let csv = page.saved(1).await;
    assert_eq!(csv.lines().count(), 102, "a head and 101 positions");
    // Each curve is a column; each row is a percent of travel with what the files say of it.
    let files = page
        .eval(
            "return [...document.querySelectorAll('[data-chart=torque] path[data-series]')]
               .map(path => path.dataset.series)",
        )
        .await;
    let files: Vec<String> = serde_json::from_value(files).expect("texts");
    assert!(files.len() > 4, "{files:?}");
    for (position, line) in (0_u16..).zip(csv.lines().skip(1)) {
        let cells: Vec<_> = line.split(',').collect();
        assert_eq!(cells.len(), files.len() + 1, "{line}");
        assert_eq!(cells[0].trim_end_matches(" %"), position.to_string());
        for (file, cell) in files.iter().zip(&cells[1..]) {
            let Some(file) = file.strip_prefix("file-") else {
                continue;
            };
            let words = snapshot.files.get(file.parse().expect("a number"));
            let word = words.and_then(|w| w.get(position)).expect("a sample");
            assert_eq!(
                *cell,
                word.cast_signed().to_string(),
                "{file} at {position}"
            );
        }
    }
    page.look("icon-curves-all").await;
    // As a picture of its own, and nearer.
    page.click("[data-testid=chart-save-svg]").await;
    let svg = page.saved(2).await;
    assert!(
        svg.starts_with("<svg") && svg.contains("xmlns"),
        "{svg:.200}"
    );
    let whole = page.drawn("torque", "file-1000").await;
    page.click("[data-testid=chart-in]").await;
    page.wait_until(
        "(([low, high]) => high - low < 100)
         (document.querySelector('[data-chart=torque] [data-testid=chart-svg]').dataset.x
           .split(' ').map(Number))",
    )
    .await;
    assert!(page.drawn("torque", "file-1000").await.len() <= whole.len());
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
    // Table 39: tenths of a second to each percent from the start on, then those of the way back.
    let reached = u16::try_from(travel).expect("a place") + 1;
    let words = records.run(0, reached).expect("times");
    let times: Vec<f64> = words.iter().map(|t| f64::from(*t) / 10.0).collect();
    let points = page.drawn("pst", "out").await;
    for (percent, ((x, y), time)) in (0_u32..).zip(points.iter().zip(&times)) {
        assert!(
            (x - f64::from(percent)).abs() < 0.6 && (y - time).abs() < 0.2,
            "{percent} % after {time} s: {points:?}"
        );
    }
    assert!(points.len() >= times.len(), "{points:?}");
    let result = records.get(108).expect("a result");
    let words = ["", "Passed", "Failed", "Reset", "T-PST", "T-RET", "OV-TR"];
    let verdict = page.text("[data-testid=verdict]").await;
    let wanted = words[usize::from(result)];
    assert!(
        result > 0 && verdict.contains(wanted),
        "{result}: {verdict}"
    );
    page.look("icon-pst").await;
    page.click("details:has([data-testid=stroke-raw]) summary")
        .await;
    page.until(
        "[data-testid=stroke-raw]",
        "/[0-9A-F]{4}/.test($.innerText)",
    )
    .await;
    // An emergency stroke: tenths of a second to each percent of travel (table 40).
    go(&page, "curves?show=efs").await;
    page.wait_for("[data-chart=efs] [data-testid=chart-svg]")
        .await;
    let words = snapshot.files.get(3501).and_then(|r| r.run(0, 101));
    let words = words.expect("the times of a stroke");
    let times: Vec<f64> = words
        .iter()
        .map(|tenths| f64::from(*tenths) / 10.0)
        .collect();
    page.assert_shows("efs", "out", &times).await;
    let verdict = page.text("[data-testid=verdict]").await;
    let took = format!("{:.1} s", times[100]);
    assert!(
        verdict.contains("Emergency stroke") && verdict.contains(&took),
        "{verdict}, {took}"
    );
    page.look("icon-efs").await;
    go(&page, "curves?show=trends").await;
    page.wait_for("[data-testid=recorder]").await;
    let stored = snapshot
        .files
        .get(5100)
        .and_then(|r| r.get(0))
        .expect("a count");
    let series = "trend-5100-electronics_temperature";
    page.wait_for(&format!("[data-chart={series}] svg")).await;
    let points = page.drawn(series, "motor_temperature").await;
    assert_eq!(points.len(), usize::from(stored));
    page.look("icon-trends").await;
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
        page.until(
            "[data-testid=log-status]",
            &format!("$.innerText.startsWith('{stored} ')"),
        )
        .await;
        page.look(&format!("icon-log-{file}")).await;
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
    page.keep_saved().await;
    // Filtered by text and by code: only rows that have it are left.
    page.enter("[data-testid=log-filter]", "torque").await;
    page.wait_until(
        "(rows => rows.length > 0 && rows.every(r => /torque/i.test(r.innerText)))
         ([...document.querySelectorAll('[data-testid=log-row]')])",
    )
    .await;
    page.enter("[data-testid=log-filter]", "").await;
    let code = words_code(snapshot.files.get(2).expect("a log"));
    page.enter("[data-testid=log-code]", &code.to_string())
        .await;
    page.wait_until(&format!(
        "(rows => rows.length > 0 && rows.every(r => r.innerText.includes('({code})')))
         ([...document.querySelectorAll('[data-testid=log-row]')])"
    ))
    .await;
    page.enter("[data-testid=log-code]", "").await;
    // Raw words in place of names.
    page.click("[data-testid=log-raw]").await;
    page.until(
        "[data-testid=log-row]",
        &format!("/[0-9A-F]{{4}}/.test($.innerText) && !$.innerText.includes('({code})')"),
    )
    .await;
    page.click("[data-testid=log-raw]").await;
    page.click("[data-testid=log-csv]").await;
    let csv = page.saved(1).await;
    assert_table(&csv, snapshot.files.get(2).expect("a log"), true);
    page.click("[data-testid=log-json]").await;
    let json: Value = serde_json::from_str(&page.saved(2).await).expect("JSON");
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

/// The code of the first alarm of file 2.
fn words_code(log: &shared::icon3000::Records) -> u16 {
    log.get(3).expect("an alarm")
}

/// Holds that a saved table of alarms says what the words of file 2 say: how many, then for each the
/// seconds since 2000 in two words and a code (table 31).
fn assert_table(csv: &str, log: &shared::icon3000::Records, oldest_first: bool) {
    let stored = log.get(0).expect("a count");
    let mut lines: Vec<_> = csv.lines().collect();
    let head = lines.remove(0);
    assert!(head.starts_with("number,device_time,utc,"), "{head}");
    assert_eq!(lines.len(), usize::from(stored), "{csv}");
    if oldest_first {
        lines.reverse();
    }
    for (at, line) in (0..stored).zip(lines) {
        let word = |n: u16| log.get(1 + 3 * at + n).expect("an entry");
        let [high, low, code] = [word(0), word(1), word(2)];
        let cells: Vec<_> = line.split(',').collect();
        assert_eq!(cells[0], (at + 1).to_string(), "{line}");
        let since_2000 = i64::from(high) << 16 | i64::from(low);
        assert_eq!(seconds(cells[1]), 946_684_800 + since_2000, "{line}");
        let raw = cells.last().expect("raw words").replace(' ', "");
        assert_eq!(raw, format!("{code:04X}"), "{line}");
    }
}

/// Seconds since 1970 of `2025-12-06T05:48:40`, day by day.
fn seconds(text: &str) -> i64 {
    let numbers: Vec<i64> = text
        .split(['-', 'T', ':'])
        .map(|n| n.parse().expect("a number"))
        .collect();
    let [year, month, day, hour, minute, second] = numbers[..] else {
        panic!("{text} is no time");
    };
    let leap = |y: i64| y % 4 == 0 && (y % 100 != 0 || y % 400 == 0);
    let years: i64 = (1970..year).map(|y| 365 + i64::from(leap(y))).sum();
    let lengths = [31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let months: i64 = (1..month)
        .zip(lengths)
        .map(|(m, days)| days + i64::from(m == 2 && leap(year)))
        .sum();
    ((years + months + day - 1) * 24 + hour) * 3600 + minute * 60 + second
}

/// Health names each condition where it stands: a hot motor and a low battery in HR 3010, a stroke
/// test that came back too late in HR 3009 (table 5); the worst first, each with its reason.
#[tokio::test]
async fn health_names_what_the_bits_say() {
    let faults = [Fault::Thermostat, Fault::LowBattery, Fault::PstReturn];
    let snapshot = faulty(Model::Icon3000v2, &faults);
    let (page, snapshot) = opened_with("health", snapshot).await;
    page.wait_for("[data-testid=health]").await;
    for register in [3009, 3010] {
        let cell = snapshot.image.cell(Table::Holding, Address::new(register));
        let word = cell.expect("it was read").word;
        assert_health(&page, register, word).await;
    }
    let listed = page
        .eval(
            "return [...document.querySelectorAll('[data-testid=health]')]
               .map(e => `${e.dataset.key} ${e.dataset.status}`)",
        )
        .await;
    let listed: Vec<String> = serde_json::from_value(listed).expect("texts");
    assert_eq!(listed[0], "motor_thermostat F", "{listed:?}");
    assert!(listed.contains(&"low_battery M".to_owned()), "{listed:?}");
    let rank = |entry: &String| "FCSM".find(&entry[entry.len() - 1..]);
    assert!(listed.is_sorted_by_key(rank), "{listed:?}");
    let sum = page.text("[data-testid=health-sum]").await;
    assert!(
        sum.contains("Failure") && sum.contains(&format!("{} conditions", listed.len())),
        "{sum}"
    );
    page.look("icon-health-faults").await;
    page.assert_clean().await;
}

/// Holds that the conditions of a register on the screen are the bits of its word, no more and no
/// less, each with what to check (VCIOM-16345-EN, table 5).
async fn assert_health(page: &Page, register: u16, word: u16) {
    // Bit 15 of the warnings says that there is one; with a bit of its own it is not said twice.
    let repeats = register == 3009 && word & 0x0FFF != 0;
    let bits: Vec<u16> = (0..16)
        .filter(|bit| word >> bit & 1 == 1 && !(repeats && *bit == 15))
        .collect();
    let script = format!(
        "return [...document.querySelectorAll('[data-testid=health]')]
           .filter(e => e.innerText.includes('Check: '))
           .map(e => e.innerText.match(/HR {register}, bit (\\d+)/)?.[1])
           .filter(Boolean).map(Number).sort((a, b) => a - b)"
    );
    assert_eq!(
        page.eval(&script).await,
        serde_json::json!(bits),
        "HR {register}"
    );
}

/// Health, identity, counters, settings: read back from the words of the snapshot.
#[tokio::test]
async fn everything_else_is_shown_as_it_was_read() {
    let (page, snapshot) = opened("health").await;
    page.wait_for("[data-testid=health-sum]").await;
    for register in [3009, 3010, 3011] {
        let cell = snapshot.image.cell(Table::Holding, Address::new(register));
        assert_health(&page, register, cell.expect("it was read").word).await;
    }
    page.look("icon-health").await;

    go(&page, "identity").await;
    let report = snapshot.report().expect("a report");
    page.until(
        "[data-testid=identity][data-key=serial_number]",
        &format!("$.innerText.includes({:?})", report.serial_number),
    )
    .await;
    assert_eq!(page.count("[data-testid=card]").await, 5);
    page.look("icon-identity").await;

    go(&page, "communication").await;
    let messages = snapshot.counters.get(&14).expect("a counter").to_string();
    page.until(
        "[data-testid=counter][data-sub='14']",
        &format!("$.innerText.replaceAll('\\u2009', '').includes('{messages}')"),
    )
    .await;
    page.look("icon-communication").await;

    go(&page, "configuration").await;
    page.until("[data-testid=words-pst]", "$.innerText.length > 60")
        .await;
    page.click("[data-testid=icon-row][data-address='3615'] button")
        .await;
    page.until(
        "[data-testid=icon-row][data-address='3615']",
        "$.innerText.includes('E03') && $.innerText.includes('VCIOM-16345-EN')",
    )
    .await;
    page.look("icon-configuration").await;
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
    page.look("icon-snapshots-none").await;
    page.open_file(FILE, "no.json", "{}").await;
    let trouble = page.text("[data-testid=snapshot-trouble]").await;
    assert!(trouble.contains("no.json is no snapshot"), "{trouble}");
    page.open_file(FILE, "before.json", &before.to_text()).await;
    page.wait_for("[data-testid=snapshot][data-key='0']").await;
    page.open_file(FILE, "after.json", &after.to_text()).await;
    page.wait_for("[data-testid=snapshot][data-key='1']").await;
    page.eval("location.hash = '#/snapshots?from=0&to=0'").await;
    page.until("[data-testid=compare-sum]", "$.innerText === 'No change.'")
        .await;
    page.eval("location.hash = '#/snapshots?from=0&to=1'").await;
    page.until(
        "[data-testid=compare-sum]",
        "$.innerText.startsWith('3 changes')",
    )
    .await;
    assert_eq!(page.count("[data-testid=change]").await, 3);
    page.until("[data-path='holding.3615']", "$.innerText.includes('25 %')")
        .await;
    page.look("icon-compare").await;
    page.assert_clean().await;
}

/// An older model has no files, and the page says so; nothing is asked of anybody.
#[tokio::test]
async fn an_older_model_shows_what_it_has() {
    let page = single_file().await;
    let snapshot = device(Model::Icon3000);
    page.open_file(FILE, "old.json", &snapshot.to_text()).await;
    page.wait_for("[data-testid=snapshot]").await;
    go(&page, "curves").await;
    page.wait_for("[data-chart=torque] [data-testid=chart-svg]")
        .await;
    go(&page, "curves?show=pst").await;
    page.until(
        "[data-testid=icon-nothing]",
        "$.innerText.includes('no files')",
    )
    .await;
    go(&page, "configuration").await;
    page.until(
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
