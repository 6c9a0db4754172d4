//! The page itself: pasted bytes, registers, traffic, a connection that is lost.

use std::time::Duration;

use serde_json::json;
use tests::browser::{Page, Scheme, leaves_loopback};
use tests::registers::Registers;
use tests::server::Server;

/// Poll of unit 3 for position and torque, and the answer: 24.0 %, -12 %. CRCs by pymodbus.
const EXCHANGE: &str = "03 03 0B BC 00 02 06 29\n03 03 04 00 F0 FF F4 99 B7";

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

/// Paste, list, tree, bytes: the whole thread of the decode page. Nothing leaves loopback.
#[tokio::test]
async fn pasted_bytes_become_a_tree() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.paste(EXCHANGE).await;
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
    page.look("decode").await;
    page.assert_clean().await;
}

/// Bad input says what is wrong, and the rest is still decoded.
#[tokio::test]
async fn bad_input_is_explained() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.paste(&format!("{EXCHANGE} DE AD BE EF 03 03 00"))
        .await;
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

    page.paste("no bytes in here").await;
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
    page.paste(EXCHANGE).await;
    page.wait_until("document.querySelectorAll('[data-testid=frame-row]').length === 2")
        .await;
    let asked = page.requests().await;
    assert!(
        asked.iter().all(|url| url.starts_with("ws:")),
        "only the socket is tried: {asked:?}"
    );
}

/// True while a program of its own is shown.
const OPEN: &str = "document.querySelector('[data-testid=program]')?.dataset.state === 'open'
    && document.querySelector('[data-testid=program-host]').childElementCount > 0";

/// The addresses of a program of its own among those that the page asked for.
async fn diagnostics(page: &Page) -> Vec<String> {
    let asked = page.requests().await.into_iter();
    asked.filter(|url| url.contains("/diagnostics")).collect()
}

/// The diagnostic objects are a program of its own: it is not part of the first load, comes once,
/// and works on without a backend.
#[tokio::test]
async fn a_second_program_comes_when_it_is_wanted() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.wait_for("[data-testid=paste]").await;
    page.wait_until("document.querySelector('[data-testid=conn-state]').innerText === 'Connected'")
        .await;
    assert_eq!(diagnostics(&page).await, [""; 0], "not before it is wanted");
    page.look("welcome").await;
    page.click("[data-testid=dop-link]").await;
    page.wait_until(OPEN).await;
    let asked = diagnostics(&page).await;
    assert!(
        asked.iter().any(|url| url.ends_with("/diagnostics.js"))
            && asked
                .iter()
                .any(|url| url.ends_with("/diagnostics_bg.wasm"))
            && asked.len() == 2,
        "{asked:?}"
    );
    page.assert_clean().await;

    drop(server);
    page.eval("location.hash = '#/decode'").await;
    page.wait_for("[data-testid=page-decode]").await;
    page.eval("location.hash = '#/dop/anything?key=value'")
        .await;
    page.wait_until(OPEN).await;
    let hash = page.eval("return location.hash").await;
    assert_eq!(hash, "#/dop/anything?key=value", "unknown tabs are kept");
    assert_eq!(diagnostics(&page).await, [""; 0], "it is there already");
}

/// A program that can't be had is said to be so, and can be had later.
#[tokio::test]
async fn a_program_that_does_not_come_is_tried_again() {
    let server = Server::start(&[]);
    let listen = server.address().to_string();
    let page = Page::open(&server.url("/#/decode")).await;
    page.wait_for("[data-testid=paste]").await;
    drop(server);
    page.eval("location.hash = '#/dop'").await;
    page.wait_for("[data-testid=program-failed]").await;
    page.look("program-failed").await;
    let _server = Server::start_at(&listen, &[]);
    page.click("[data-testid=program-retry]").await;
    page.wait_until(OPEN).await;
}

/// The single file holds everything: no server is asked for anything.
#[tokio::test]
async fn the_single_file_is_whole() {
    let file = tests::target_dir().with_file_name("static/dist/valvescope.html");
    assert!(file.is_file(), "run `cargo xtask web` first");
    let page = Page::open(&format!("file://{}#/decode", file.display())).await;
    page.paste(EXCHANGE).await;
    page.wait_until("document.querySelectorAll('[data-testid=frame-row]').length === 2")
        .await;
    page.eval("location.hash = '#/dop'").await;
    page.wait_until(OPEN).await;
    let asked = page.requests().await;
    assert!(
        asked.iter().all(|url| url.starts_with("file:")),
        "{asked:?}"
    );
    page.assert_clean().await;
}

/// The overview of a simulated actuator moves.
#[tokio::test]
async fn the_live_overview_moves() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/devices")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_until("document.querySelector('[data-testid=device-row]')?.innerText.includes('%')")
        .await;
    page.look("devices").await;
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
    page.look("overview").await;
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
    page.look("values").await;
    page.assert_clean().await;
}

/// What the rows in view say in one column, from the top.
async fn column(page: &Page, css: &str) -> Vec<String> {
    let found = page
        .eval(&format!(
            "const rows = [...document.querySelectorAll('[data-testid=register-row]')];
             const top = r => r.getBoundingClientRect().top;
             rows.sort((a, b) => top(a) - top(b));
             return rows.map(r => r.querySelector({css:?}).innerText)"
        ))
        .await;
    let cells = found.as_array().expect("a list").iter();
    cells
        .map(|c| c.as_str().expect("a text").to_owned())
        .collect()
}

/// The list is sorted by its columns, by mouse and by keyboard, and keeps the chosen line.
#[tokio::test]
async fn registers_are_sorted() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/XV-101/values?q=torque&table=holding")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=register-row]").await;
    let sorted = |column: &'static str, how: &'static str| {
        format!(
            "document.querySelector('[data-testid=sort-{column}]').closest('[aria-sort]')
                .getAttribute('aria-sort') === '{how}'"
        )
    };
    page.wait_until(&sorted("address", "ascending")).await;
    let addresses = column(&page, ".mono").await;
    let number = |text: &String| text.parse::<u32>().expect("an address");
    assert!(addresses.iter().map(number).is_sorted(), "{addresses:?}");

    let first = "[data-testid=register-row][data-address='3005']";
    page.click(first).await;
    page.click("[data-testid=sort-name]").await;
    page.wait_until(&sorted("name", "ascending")).await;
    page.wait_until(&sorted("address", "none")).await;
    let names = column(&page, ".value-label").await;
    let lower = |name: &String| name.to_ascii_lowercase();
    assert!(
        names.len() > 5 && names.iter().map(lower).is_sorted(),
        "{names:?}"
    );
    page.wait_until(
        "document.querySelector('.windowed-row.selected [data-address]').dataset.address === '3005'",
    )
    .await;

    // By the keyboard: the focus stays on the button, which turns the order round.
    page.eval("document.querySelector('[data-testid=sort-name]').focus()")
        .await;
    let key = |kind: &str| json!({ "type": kind, "key": "Enter", "code": "Enter", "text": "\r", "windowsVirtualKeyCode": 13 });
    page.devtools("Input.dispatchKeyEvent", key("keyDown"))
        .await;
    page.devtools("Input.dispatchKeyEvent", key("keyUp")).await;
    page.wait_until(&sorted("name", "descending")).await;
    page.wait_until("document.activeElement.dataset.testid === 'sort-name'")
        .await;
    let names = column(&page, ".value-label").await;
    assert!(names.iter().map(lower).rev().is_sorted(), "{names:?}");
    let hash = page.eval("return location.hash").await;
    assert!(
        hash.as_str().is_some_and(|h| h.contains("sort=-name")),
        "{hash}"
    );

    // Values: what was read comes first.
    page.click("[data-testid=read-all]").await;
    page.click("[data-testid=sort-value]").await;
    page.wait_until("/\\d/.test(document.querySelector('[data-testid=register-value]').innerText)")
        .await;
    page.look("sorted").await;
    page.assert_clean().await;
}

/// A search that finds nothing says so, and leads out again; a row can be copied.
#[tokio::test]
async fn an_empty_list_and_a_copied_row() {
    let server = Server::start(&[]);
    let page =
        Page::open(&server.url("/#/device/XV-101/values?q=nothing+like+it&table=coil")).await;
    page.show(1440, 900, Scheme::Light).await;
    let said = page.text("[data-testid=nothing]").await;
    assert!(
        said.contains("nothing like it") || said.contains("nothing+like+it"),
        "{said}"
    );
    page.look("nothing-matches").await;
    page.click("[data-testid=widen]").await;
    page.wait_for("[data-testid=register-row]").await;
    page.wait_until("!document.querySelector('[data-testid=nothing]')")
        .await;

    // The clipboard of the machine is not this test's business.
    page.eval(
        "window.copied = null;
         navigator.clipboard.writeText = text => { window.copied = text; return Promise.resolve(); };",
    )
    .await;
    page.eval("location.hash = '#/device/XV-101/values?q=3004&table=holding'")
        .await;
    page.wait_until(
        "document.querySelector('[data-testid=register-row]')?.dataset.address === '3004'",
    )
    .await;
    page.wait_until("/%/.test(document.querySelector('[data-testid=register-row]').innerText)")
        .await;
    page.click("[data-testid=register-row]").await;
    page.click("[data-testid=copy-row]").await;
    page.wait_until("window.copied").await;
    let copied = page.eval("return window.copied").await;
    let cells: Vec<&str> = copied.as_str().expect("a text").split('\t').collect();
    assert_eq!(
        cells[..4],
        ["holding", "3004", "403005", "Actuator Position"]
    );
    assert_eq!((cells[5], cells[6]), ("%", "good"));
    let raw = u16::from_str_radix(cells[7], 16).expect("one word");
    let tenths = cells[4]
        .replace('.', "")
        .parse::<u16>()
        .expect("a position");
    assert_eq!(raw, tenths, "{cells:?}");
    assert!(cells[8].contains("p. 23"), "{cells:?}");
    page.wait_until("document.querySelector('[data-testid=copy-row]').innerText === 'Copied'")
        .await;
    page.assert_clean().await;
}

/// A device that raises an alarm while somebody looks: letter and shape beside the colour, the
/// device at the top of the list, the alarm in words; and all is quiet again when it clears.
#[tokio::test]
async fn an_alarm_is_seen() {
    let quiet = Registers::start();
    let device = Registers::start();
    // Remote, closed; no alarm.
    for registers in [&quiet, &device] {
        registers.set(3001, 0x0021);
    }
    let folder = std::env::temp_dir().join(format!("valvescope-alarm-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder for the configuration");
    let file = folder.join("valvescope.toml");
    let bus = |name: &str, registers: &Registers| {
        let address = registers.address();
        format!(
            "[[bus]]\nname = \"{name}\"\nkind = \"tcp\"\nhost = \"{address}\"\n
             [[device]]\ntag = \"XV-{name}\"\nkind = \"icon3000v2\"\nbus = \"{name}\"\nunit = 1\n"
        )
    };
    let text = bus("1", &quiet) + &bus("2", &device);
    std::fs::write(&file, text).expect("a folder that can be written to");
    let server = Server::start(&["--config", file.to_str().expect("a plain path")]);
    let page = Page::open(&server.url("/#/devices")).await;
    page.show(1440, 900, Scheme::Light).await;
    let row = "[data-testid=device-row][data-tag=XV-2]";
    page.wait_until(&format!(
        "document.querySelector('{row}')?.innerText.includes('Closed')"
    ))
    .await;
    assert_eq!(page.count(".sign").await, 0, "nothing is wrong yet");
    let first = "document.querySelector('[data-testid=device-row]').dataset.tag";
    page.wait_until(&format!("{first} === 'XV-1'")).await;

    // Alarms 1 bit 5 is Hi-Hi Temperature, warnings bit 2 Hi Temperature (tables of p. 24).
    device.set(3010, 1 << 5);
    device.set(3009, 1 << 2);
    page.wait_for(&format!("{row} .sign-f[aria-label=Failure] svg path"))
        .await;
    let letter = page.text(&format!("{row} .sign-f b")).await;
    assert_eq!(letter, "F");
    let words = page.text(row).await;
    assert!(words.contains("Hi-Hi Temperature"), "{words}");
    page.wait_until(&format!("{first} === 'XV-2'")).await;
    page.look("alarm-list").await;
    page.click(row).await;
    page.wait_for("[data-testid=condition][data-key=hi_hi_temperature] .sign-f svg")
        .await;
    page.wait_for("[data-testid=condition][data-key=hi_temperature] .sign svg")
        .await;
    page.look("alarm-device").await;

    device.set(3010, 0);
    device.set(3009, 0);
    page.wait_until(
        "!document.querySelector('[data-testid=condition][data-key=hi_hi_temperature]')",
    )
    .await;
    page.assert_clean().await;
    drop(server);
    std::fs::remove_dir_all(&folder).expect("the folder of this test");
}

/// Only the rows in view are in the page.
#[tokio::test]
async fn long_lists_are_windowed() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/XV-101/values")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=register-row]").await;
    let rows = page.count("[data-testid=register-row]").await;
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
    page.look("traffic").await;
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
