//! The screens of a device on the line: the simulated plant behind the bridge. What a screen shows
//! is compared with the words in the saved file, with the list of registers, which the first program
//! reads and decodes by itself, and with a simulated actuator that no bridge has touched.

use std::time::{Duration, Instant};

use serde_json::Value;
use shared::address::{Address, Table};
use shared::icon3000::Snapshot;
use shared::icon3000::snapshot::parse;
use shared::map::row::Model;
use tests::browser::{Page, Scheme};
use tests::server::Server;

use super::{FILE, assert_health, assert_table, device};

/// How long a whole device may take.
const READ: Duration = Duration::from_secs(60);

/// Goes to a tab of the device.
async fn visit(page: &Page, tab: &str) {
    page.eval(&format!("location.hash = '#/device/XV-101/{tab}'"))
        .await;
    let name = tab.split('?').next().unwrap_or_default();
    page.wait_for(&format!("[data-testid=page-{name}]")).await;
}

/// Goes to a tab for the first time, and sees its read through: progress, and an end.
async fn read(page: &Page, tab: &str) {
    visit(page, tab).await;
    page.wait_until("window.progress.length > 0").await;
    done(page).await;
}

/// Waits until nothing is being read any more.
pub async fn done(page: &Page) {
    let end = Instant::now() + Duration::from_secs(40);
    loop {
        let text = page.text("[data-testid=icon-job]").await;
        if text.ends_with("done.") {
            break;
        }
        assert!(Instant::now() < end, "still `{text}`");
        tokio::time::sleep(Duration::from_millis(100)).await;
    }
}

/// Notes what the bar of progress says from now on.
async fn watch(page: &Page) {
    page.eval(
        "window.progress = [];
         new MutationObserver(() => {
           const bar = document.querySelector('[data-testid=icon-job] progress');
           if (bar) window.progress.push([bar.value, bar.max]);
         }).observe(document.body, { subtree: true, childList: true, attributes: true });",
    )
    .await;
}

/// What the bar said since the last look: it appeared, and it never went back.
async fn assert_progress(page: &Page, tab: &str) {
    let seen = page
        .eval("const seen = window.progress; window.progress = []; return seen")
        .await;
    let seen: Vec<(f64, f64)> = serde_json::from_value(seen).expect("pairs");
    assert!(!seen.is_empty(), "{tab}: no progress was shown");
    assert!(
        seen.is_sorted_by(|a, b| a.0 <= b.0) && seen.iter().all(|(done, all)| done <= all),
        "{tab}: {seen:?}"
    );
}

/// The raw word of a holding register as the list of registers has it.
async fn raw(page: &Page, address: u16) -> u16 {
    page.eval(&format!(
        "window.copied = null;
         navigator.clipboard.writeText = text => {{ window.copied = text; return Promise.resolve(); }};
         location.hash = '#/device/XV-101/values?q={address}&table=holding'"
    ))
    .await;
    let row = format!("[data-testid=register-row][data-address='{address}']");
    page.wait_for(&row).await;
    page.click("[data-testid=read-visible]").await;
    page.until(
        &format!("{row} [data-testid=register-value]"),
        "/\\w/.test($.innerText)",
    )
    .await;
    page.click(&row).await;
    page.click("[data-testid=copy-row]").await;
    page.wait_until("window.copied").await;
    let copied = page.eval("return window.copied").await;
    let copied = copied.as_str().expect("a text");
    let cell = copied.split('\t').nth(7).expect("a raw cell");
    u16::from_str_radix(cell, 16).unwrap_or_else(|_| panic!("no word: {copied}"))
}

/// What the page saves as a snapshot, and its text.
async fn save(page: &Page) -> (Snapshot, String) {
    page.keep_saved().await;
    page.click("[data-testid=icon-save]").await;
    let text = page.saved(1).await;
    let (snapshot, problems) = parse(text.as_bytes());
    assert!(problems.is_empty(), "{problems:?}");
    (snapshot.expect("a snapshot"), text)
}

fn word(snapshot: &Snapshot, address: u16) -> u16 {
    let cell = snapshot.image.cell(Table::Holding, Address::new(address));
    cell.expect("it was read").word
}

/// Every tab is read from the line and shows what the device holds; the whole is saved.
#[tokio::test]
async fn every_tab_is_read_from_the_line() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/XV-101/overview")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_until("/\\d/.test(document.querySelector('[data-testid=position]')?.innerText)")
        .await;
    watch(&page).await;
    for tab in [
        "curves",
        "curves?show=pst",
        "curves?show=trends",
        "logs",
        "health",
        "identity",
        "communication",
        "configuration",
    ] {
        read(&page, tab).await;
        assert_progress(&page, tab).await;
        assert_eq!(page.count("[data-testid=icon-failed]").await, 0, "{tab}");
        page.look(&format!("icon-live-{}", tab.replace("?show=", "-")))
            .await;
    }

    // Emergency strokes came with the partial ones.
    visit(&page, "curves?show=efs").await;
    page.wait_for("[data-chart=efs] [data-testid=chart-svg]")
        .await;
    page.look("icon-live-curves-efs").await;

    // Settings: the list of registers asks the device for the same words.
    let shown = [3615, 3580, 3017];
    let mut words = Vec::new();
    for address in shown {
        words.push(raw(&page, address).await);
    }
    visit(&page, "configuration").await;
    for (address, word) in shown.into_iter().zip(words) {
        let row = format!("[data-testid=icon-row][data-address='{address}']");
        page.click(&format!("{row} button")).await;
        page.until(
            &row,
            &format!("$.innerText.includes('{word:04X}') && $.innerText.includes('{word}')"),
        )
        .await;
    }

    // Alarms and warnings: the same words as the list of registers reads, bit by bit.
    for register in [3009, 3010, 3011] {
        let word = raw(&page, register).await;
        visit(&page, "health").await;
        page.wait_for("[data-testid=health-sum]").await;
        assert_health(&page, register, word).await;
    }

    // The reference is no result of this run: an actuator of the same kind without a bridge has it.
    let alike = device(Model::Icon3000v2);
    visit(&page, "curves").await;
    let reference = alike.files.get(1000).expect("a reference");
    let wanted: Vec<f64> = reference
        .run(0, 101)
        .expect("all samples")
        .iter()
        .map(|w| f64::from(w.cast_signed()))
        .collect();
    page.assert_shows("torque", "file-1000", &wanted).await;
    visit(&page, "identity").await;
    let report = alike.report().expect("a report");
    page.until(
        "[data-testid=identity][data-key=serial_number]",
        &format!("$.innerText.includes({:?})", report.serial_number),
    )
    .await;
    page.assert_clean().await;
}

/// A whole read is ended half way and gone on with; what it brought is saved, opened and compared.
#[tokio::test]
async fn a_whole_device_is_read_saved_and_compared() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/XV-101/logs")).await;
    page.show(1440, 900, Scheme::Light).await;
    done(&page).await;
    page.click("[data-testid=icon-whole]").await;
    page.until(
        "[data-testid=icon-job] progress",
        "$.value > 3 && $.value < $.max",
    )
    .await;
    page.click("[data-testid=icon-cancel]").await;
    page.until(
        "[data-testid=icon-job]",
        "$.innerText.startsWith('Cancelled after ')",
    )
    .await;
    page.look("icon-live-cancelled").await;
    page.click("[data-testid=icon-resume]").await;
    done(&page).await;
    page.until("[data-testid=icon-resume]", "$.hidden").await;
    let (snapshot, text) = save(&page).await;
    assert_eq!(snapshot.tag, "XV-101");
    assert!(snapshot.failures.is_empty(), "{:?}", snapshot.failures);
    let holes = snapshot.holes();
    assert!(holes.iter().all(|h| h.why == "reserved"), "{holes:?}");

    // The log of alarms as a table file: word by word what the file 2 of the device says.
    let log = snapshot.files.get(2).expect("a log");
    let stored = log.get(0).expect("a count");
    page.click("[data-testid=icon-log-2]").await;
    page.click("[data-testid=log-csv]").await;
    assert_table(&page.saved(2).await, log, false);
    page.click("[data-testid=log-json]").await;
    let json: Value = serde_json::from_str(&page.saved(3).await).expect("JSON");
    let codes: Vec<u64> = json
        .as_array()
        .expect("a list")
        .iter()
        .map(|e| e["code_raw"].as_u64().expect("a code"))
        .collect();
    let wanted: Vec<u64> = (0..stored)
        .map(|n| u64::from(log.get(3 + 3 * n).expect("a code")))
        .collect();
    assert_eq!(codes, wanted);

    // Counters and health as the saved words say.
    page.eval("location.hash = '#/device/XV-101/communication'")
        .await;
    let messages = snapshot.counters.get(&14).expect("a counter");
    assert!(*messages > 0, "nothing was counted");
    page.until(
        "[data-testid=counter][data-sub='14']",
        &format!("$.innerText.replaceAll('\\u2009', '').includes('{messages}')"),
    )
    .await;
    let settings = word(&snapshot, 3615);
    page.eval("location.hash = '#/device/XV-101/configuration'")
        .await;
    page.until(
        "[data-testid=icon-row][data-address='3615']",
        &format!("$.innerText.includes('{settings}')"),
    )
    .await;

    // The file on the screen of snapshots, beside the device that it is of.
    let mut after = snapshot.clone();
    for (address, word) in [
        (3615, settings + 1),
        (3580, word(&snapshot, 3580) ^ 1),
        (3017, word(&snapshot, 3017) + 1),
    ] {
        let [high, low] = u16::to_be_bytes(address);
        let [a, b] = u16::to_be_bytes(word);
        assert!(after.absorb(&[3, high, low, 0, 1], &[3, 2, a, b]));
    }
    page.eval("location.hash = '#/snapshots'").await;
    page.open_file(FILE, "xv-101.json", &text).await;
    page.wait_for("[data-testid=snapshot][data-key='0']").await;
    page.wait_for("[data-testid=snapshot][data-key='live:XV-101']")
        .await;
    page.open_file(FILE, "after.json", &after.to_text()).await;
    page.wait_for("[data-testid=snapshot][data-key='1']").await;
    page.eval("location.hash = '#/snapshots?from=0&to=0'").await;
    let sum = "[data-testid=compare-sum]";
    page.until(sum, "$.innerText === 'No change.'").await;
    page.eval("location.hash = '#/snapshots?from=0&to=1'").await;
    page.until(sum, "$.innerText.startsWith('3 changes')").await;
    let paths = page
        .eval(
            "return [...document.querySelectorAll('[data-testid=change]')]
               .map(c => c.dataset.path).sort()",
        )
        .await;
    let wanted = ["holding.3017", "holding.3580", "holding.3615"];
    assert_eq!(paths, serde_json::json!(wanted));
    page.look("icon-live-compare").await;
    // The device read anew: nothing lasting changed in it; counters and measurements did.
    page.eval("location.hash = '#/snapshots?from=0&to=live%3AXV-101'")
        .await;
    let copy = page
        .text("[data-testid=snapshot][data-key='live:XV-101']")
        .await;
    page.click("[data-testid=compare-fresh]").await;
    page.until("[data-testid=compare-fresh]", "$.disabled")
        .await;
    page.until_within("[data-testid=compare-fresh]", "!$.disabled", READ)
        .await;
    let fresh = page
        .text("[data-testid=snapshot][data-key='live:XV-101']")
        .await;
    assert_ne!(fresh, copy, "it was read a minute ago");
    page.until(sum, "$.innerText.startsWith('No change')").await;
    page.look("icon-live-fresh").await;
    page.assert_clean().await;
}
