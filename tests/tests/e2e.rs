//! End to end: the built binary, a browser, and what a person sees.

use std::time::Duration;

use serde_json::json;
use tests::browser::{Page, Scheme, leaves_loopback};
use tests::server::Server;

/// Poll of unit 3 for position and torque, and the answer: 24.0 %, -12 %. CRCs by pymodbus.
const EXCHANGE: &str = "03 03 0B BC 00 02 06 29\n03 03 04 00 F0 FF F4 99 B7";

/// Types into the paste box as a person would paste.
async fn paste(page: &Page, text: &str) {
    page.wait_for("[data-testid=paste]").await;
    page.eval(&format!(
        "const box = document.querySelector('[data-testid=paste]');
         box.value = {text:?};
         box.dispatchEvent(new Event('input', {{ bubbles: true }}));"
    ))
    .await;
}

/// Moves the mouse onto the first element with this selector.
async fn hover(page: &Page, css: &str) {
    let at = page
        .eval(&format!(
            "const r = document.querySelector({css:?}).getBoundingClientRect();
             return [r.x + r.width / 3, r.y + r.height / 2]"
        ))
        .await;
    let params = json!({ "type": "mouseMoved", "x": at[0], "y": at[1] });
    page.devtools("Input.dispatchMouseEvent", params).await;
}

async fn count(page: &Page, css: &str) -> u64 {
    let found = page
        .eval(&format!("return document.querySelectorAll({css:?}).length"))
        .await;
    found.as_u64().expect("a number")
}

/// Both sizes in both schemes, for people to look at.
async fn look(page: &Page, name: &str) {
    for (scheme, shade) in [(Scheme::Light, "light"), (Scheme::Dark, "dark")] {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.show(width, height, scheme).await;
            assert!(
                page.screenshot(&format!("{name}-{width}-{shade}"))
                    .await
                    .is_file()
            );
        }
    }
    page.show(1440, 900, Scheme::Light).await;
}

/// Paste, list, tree, bytes: the whole thread of the decode page. Nothing leaves loopback.
#[tokio::test]
async fn pasted_bytes_become_a_tree() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.show(1440, 900, Scheme::Light).await;
    paste(&page, EXCHANGE).await;
    page.wait_until("document.querySelectorAll('[data-testid=frame-row]').length === 2")
        .await;
    page.eval("document.querySelectorAll('[data-testid=frame-row]')[1].click()")
        .await;
    page.wait_for("[data-testid=field-row][data-path='holding.3004']")
        .await;
    let position = page
        .text("[data-testid=field-row][data-path='holding.3004']")
        .await;
    assert!(
        position.contains("24.0") && position.contains('%'),
        "{position}"
    );
    assert!(
        position.contains("00 F0") || position.contains("00F0"),
        "raw: {position}"
    );
    let torque = page
        .text("[data-testid=field-row][data-path='holding.3005']")
        .await;
    assert!(torque.contains("-12"), "{torque}");

    // A field lights its bytes (3 and 4 of the frame), and a byte its field.
    page.click("[data-testid=field-row][data-path='holding.3004']")
        .await;
    page.wait_until(
        "[...document.querySelectorAll('[data-testid=hex-byte].selected')]
            .map(b => b.dataset.offset).join() === '3,4'",
    )
    .await;
    page.click("[data-testid=hex-byte][data-offset='5']").await;
    page.wait_until(
        "document.querySelector(\"[data-testid=field-row][data-path='holding.3005']\")
            .classList.contains('selected')",
    )
    .await;
    // Hovering does the same for as long as it lasts.
    hover(&page, "[data-testid=field-row][data-path='holding.3004']").await;
    page.wait_until(
        "[...document.querySelectorAll('[data-testid=hex-byte].marked')]
            .map(b => b.dataset.offset).join() === '3,4'",
    )
    .await;
    look(&page, "decode").await;
    page.assert_clean().await;
}

/// Bad input says what is wrong, and the rest is still decoded.
#[tokio::test]
async fn bad_input_is_explained() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    paste(&page, &format!("{EXCHANGE} DE AD BE EF 03 03 00")).await;
    page.wait_for("[data-testid=problem]").await;
    page.wait_until("document.querySelectorAll('[data-testid=frame-row]').length >= 3")
        .await;
    let said = page
        .eval("return document.body.innerText")
        .await
        .to_string();
    assert!(
        said.contains("belong to no frame") || said.contains("belongs to no frame"),
        "{said}"
    );

    paste(&page, "no bytes in here").await;
    page.wait_until("document.body.innerText.includes('not hexadecimal')")
        .await;
    page.assert_clean().await;
}

/// The decode page needs no backend once it is loaded.
#[tokio::test]
async fn decoding_goes_on_without_a_backend() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.wait_for("[data-testid=paste]").await;
    drop(server);
    let before = page.requests().await.len();
    assert!(before > 0, "the page was loaded");
    paste(&page, EXCHANGE).await;
    page.wait_until("document.querySelectorAll('[data-testid=frame-row]').length === 2")
        .await;
    let asked = page.requests().await;
    assert!(
        asked.iter().all(|url| url.starts_with("ws:")),
        "only the socket is tried: {asked:?}"
    );
}

/// The overview of a simulated actuator moves.
#[tokio::test]
async fn the_live_overview_moves() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/devices")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_until("document.querySelector('[data-testid=device-row]')?.innerText.includes('%')")
        .await;
    look(&page, "devices").await;
    page.click("[data-testid=device-row] a, [data-testid=device-row]")
        .await;
    page.wait_until(
        "/\\d/.test(document.querySelector('[data-testid=position]')?.innerText ?? '')",
    )
    .await;
    let first = page.text("[data-testid=position]").await;
    // The programme of the simulated valve rests between its strokes.
    let mut now = first.clone();
    for _ in 0..120 {
        now = page.text("[data-testid=position]").await;
        if now != first {
            break;
        }
        tokio::time::sleep(Duration::from_secs(1)).await;
    }
    assert_ne!(now, first, "the position has not moved for two minutes");
    look(&page, "overview").await;
    page.assert_clean().await;
}

/// Registers are found by name, by address and by number; their values arrive.
#[tokio::test]
async fn registers_are_searched_and_read() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/XV-101/values")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=register-row]").await;
    for query in ["actuator position", "3004", "403005", "0x0BBC"] {
        page.eval(&format!(
            "const box = document.querySelector('[data-testid=register-search]');
             box.value = {query:?};
             box.dispatchEvent(new Event('input', {{ bubbles: true }}));"
        ))
        .await;
        page.wait_until(
            "document.querySelector(\"[data-testid=register-row][data-table='holding'][data-address='3004']\")
                && document.querySelectorAll('[data-testid=register-row]').length < 12",
        )
        .await;
    }
    let row = "[data-testid=register-row][data-table='holding'][data-address='3004']";
    let text = page.text(row).await;
    assert!(
        text.contains("3004") && text.contains("403005"),
        "both numbers: {text}"
    );
    page.click("[data-testid=read-visible]").await;
    page.wait_until(&format!(
        "/\\d+\\.\\d/.test(document.querySelector(\"{row}\").innerText)"
    ))
    .await;
    look(&page, "values").await;
    page.assert_clean().await;
}

/// Only the rows in view are in the page.
#[tokio::test]
async fn long_lists_are_windowed() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/XV-101/values")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=register-row]").await;
    let rows = count(&page, "[data-testid=register-row]").await;
    assert!((5..120).contains(&rows), "{rows} rows in the page");
}

/// A backend that is killed and comes back: the page says so and heals by itself.
#[tokio::test]
async fn the_page_heals() {
    let server = Server::start(&[]);
    let listen = server.address().to_string();
    let page = Page::open(&server.url("/#/devices")).await;
    page.wait_until("document.querySelector('[data-testid=device-row]')?.innerText.includes('%')")
        .await;
    let up = page.text("[data-testid=conn-state]").await;
    drop(server);
    page.wait_until(&format!(
        "document.querySelector('[data-testid=conn-state]').innerText !== {up:?}"
    ))
    .await;
    page.screenshot("lost").await;
    tokio::time::sleep(Duration::from_millis(500)).await;
    let _server = Server::start_at(&listen, &[]);
    page.wait_until(&format!(
        "document.querySelector('[data-testid=conn-state]').innerText === {up:?}"
    ))
    .await;
    // Values come again: the age of the first device is young.
    page.wait_until("document.querySelector('[data-testid=device-row]')?.innerText.includes('%')")
        .await;
    let requests = page.requests().await;
    assert!(
        !requests.iter().any(|url| leaves_loopback(url)),
        "{requests:?}"
    );
}

/// Frames on the bus are shown as they pass, decoded.
#[tokio::test]
async fn traffic_is_shown() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/devices")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_until("document.querySelector('[data-testid=device-row]')?.innerText.includes('%')")
        .await;
    page.click("[data-testid=nav-traffic]").await;
    page.wait_until("document.querySelectorAll('[data-testid=frame-row]').length > 2")
        .await;
    page.eval("document.querySelectorAll('[data-testid=frame-row]')[1].click()")
        .await;
    page.wait_for("[data-testid=field-row]").await;
    look(&page, "traffic").await;
    page.assert_clean().await;
}

/// The guard of the other tests: an error in the console and a stray request are seen.
#[tokio::test]
async fn strays_and_errors_are_noticed() {
    let page = Page::open(
        "data:text/html,<img src='http://192.0.2.1/a'><script>console.error('b')</script>",
    )
    .await;
    page.wait_until("document.images[0].complete").await;
    let requests = page.requests().await;
    assert!(
        requests.iter().any(|url| leaves_loopback(url)),
        "{requests:?}"
    );
    let console = page.console().await;
    let error = |text: &str| {
        console
            .iter()
            .any(|l| l.is_error() && l.message.contains(text))
    };
    assert!(error("\"b\""), "{console:?}");
    assert!(
        console
            .iter()
            .any(|l| l.message.contains("ERR_NAME_NOT_RESOLVED")),
        "{console:?}"
    );
}
