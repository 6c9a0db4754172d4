//! A unit as it is now: how old each value is, whether a command could be given, what was found
//! lately.

use super::{FINDING, Network, seconds};
use tests::browser::Scheme;

/// User fault 3 and timer 1 come with reads of their own and stay fresh; the frame that a command
/// would have stands beside the checklist; the cable leads from unit to unit; a bridge that is gone
/// makes everything old.
#[tokio::test]
async fn values_tell_how_old_they_are() {
    let network = Network::start("ddc-fresh", "loop", 4, &["user-fault-3-2", "analog-lost-2"]);
    let page = network.open("#/device/MOV-002").await;
    page.wait_within(
        "/User fault 3/i.test(document.querySelector('[data-testid=user-faults]')?.innerText)",
        seconds(20),
    )
    .await;
    let age = "Number((/([\\d.]+) s/.exec(document.querySelector(
        '[data-testid=user-faults] [data-testid=card-age]')?.innerText) ?? [])[1])";
    for _ in 0..8 {
        page.wait_within(&format!("{age} < 12"), seconds(5)).await;
        tokio::time::sleep(std::time::Duration::from_millis(500)).await;
    }
    // Table 3.7: open is 256 in register 1, function 06; CRC by the peers' tests of such frames.
    let frame = page.text("[data-testid=would-be]").await;
    let is_bytes = |line: &&str| line.chars().all(|c| c.is_ascii_hexdigit() || c == ' ');
    let bytes: String = frame.lines().filter(is_bytes).collect();
    assert!(
        frame.contains("256") && bytes.replace(' ', "").starts_with("020600000100"),
        "{frame}"
    );
    page.look("ddc-unit-fresh").await;
    // Section 3.2.7: a move goes by percent; with another scale it would go elsewhere.
    page.enter("[data-testid=wish]", "move").await;
    page.enter("[data-testid=wish-percent]", "99").await;
    page.wait_for("[data-testid=check-item][data-key=range][data-verdict=warn]")
        .await;
    page.enter("[data-testid=scaling]", "0-255").await;
    page.wait_for("[data-testid=check-item][data-key=scale][data-verdict=fail]")
        .await;
    page.enter("[data-testid=wish]", "start-esd").await;
    page.wait_for("[data-testid=check-item][data-key=network_esd]")
        .await;
    page.click("[data-testid=unit-after]").await;
    page.wait_until("location.hash === '#/device/MOV-003'")
        .await;
    page.click("[data-testid=unit-before]").await;
    page.wait_until("location.hash === '#/device/MOV-002'")
        .await;
    page.wait_for("[data-testid=overwritten]").await;
    page.wait_for("[data-testid=software]").await;
    page.assert_clean().await;

    drop(network);
    page.until(
        "[data-testid=unit-state]",
        "/no connection/.test($.innerText)",
    )
    .await;
    page.wait_until(
        "document.querySelector('[data-testid=verdict]').dataset.verdict === 'unknown'",
    )
    .await;
    page.look("ddc-unit-lost").await;
}

/// A break that heals leaves a trace; a network of several types has its own estimate beside table
/// 4.2; on a phone the table is sorted from a list.
#[tokio::test]
async fn what_was_found_is_kept() {
    let network = Network::start("ddc-log", "loop", 4, &["break-2 from 12 to 26 every 3600"]);
    let page = network.open("#/network/Loop%201").await;
    let broken = format!("document.querySelector('{FINDING}[data-key=break][data-certain=true]')");
    page.wait_within(&broken, seconds(40)).await;
    let good = format!("document.querySelector('{FINDING}[data-key=no_fault][data-certain=true]')");
    page.wait_within(&good, seconds(60)).await;
    page.wait_for("[data-testid=pass-table]").await;
    page.click("[data-testid=net-tab][data-tab=log]").await;
    page.wait_until(
        "(rows => rows.some(t => /between unit 2 .*and unit 3/.test(t) && !/No longer/.test(t))
           && rows.some(t => /No longer: .*between unit 2/.test(t)))
         ([...document.querySelectorAll('[data-testid=log-row]')].map(r => r.innerText))",
    )
    .await;
    page.keep_saved().await;
    page.click("[data-testid=save-log]").await;
    let csv = page.saved(1).await;
    assert!(csv.contains("No longer"), "{csv}");
    page.look("ddc-lately").await;
    page.click("[data-testid=net-tab][data-tab=scan]").await;
    page.until("[data-testid=scan-kind]", "$.value === 'here'")
        .await;
    page.look("ddc-scan-here").await;
    page.click("[data-testid=net-tab][data-tab=main]").await;
    page.show(390, 844, Scheme::Light).await;
    page.wait_for("[data-testid=unit-row][data-unit='4']").await;
    page.enter("[data-testid=order-units]", "unit").await;
    page.wait_until("document.querySelector('[data-testid=unit-row]')?.dataset.unit === '1'")
        .await;
    page.click("[data-testid=order-down]").await;
    page.wait_until("document.querySelector('[data-testid=unit-row]')?.dataset.unit === '4'")
        .await;
    page.assert_clean().await;
}
