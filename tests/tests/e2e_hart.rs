//! HART end to end: pasted frames, and the simulated loop, as a person sees them.

use std::time::Duration;

use serde_json::{Value, json};
use tests::browser::{Page, Scheme};
use tests::server::Server;

/// Poll of a Rotork actuator and its answer: the worked frames R5 and R6, five preamble bytes each.
const POLL: &str = "FF FF FF FF FF 82 AE DD 01 23 45 03 00 95\n\
    FF FF FF FF FF 86 AE DD 01 23 45 03 1A 00 00 41 40 00 00 39 42 48 00 00 39 42 46 00 00 39 41 48 \
    00 00 39 7F A0 00 00 52";

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

/// Chooses from a list as a person would.
async fn choose(page: &Page, testid: &str, value: &str) {
    page.eval(&format!(
        "const list = document.querySelector('[data-testid={testid}]');
         list.value = {value:?};
         list.dispatchEvent(new Event('change', {{ bubbles: true }}));"
    ))
    .await;
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

/// The text of a field of the frame that is shown.
async fn field(page: &Page, path: &str) -> String {
    page.text(&format!("[data-path='{path}'] .tree-value"))
        .await
        .replace('\n', " ")
}

/// Presses a key where the focus is.
async fn press(page: &Page, key: &str) {
    for kind in ["keyDown", "keyUp"] {
        let params = json!({ "type": kind, "key": key, "code": key });
        page.devtools("Input.dispatchKeyEvent", params).await;
    }
}

/// Both sizes in both schemes, for people to look at.
async fn look(page: &Page, name: &str) {
    for (scheme, shade) in [(Scheme::Light, "light"), (Scheme::Dark, "dark")] {
        for (width, height) in [(1440, 900), (390, 844)] {
            page.show(width, height, scheme).await;
            tokio::time::sleep(Duration::from_millis(250)).await;
            page.screenshot(&format!("hart-{name}-{width}-{shade}"))
                .await;
        }
    }
    page.show(1440, 900, Scheme::Light).await;
}

/// Pasted HART is noticed, decoded by its own program, and shown as Modbus is: rows, tree, bytes,
/// pairs. Modbus pasted over it is decoded by the page again.
#[tokio::test]
async fn pasted_frames_are_decoded() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.show(1440, 900, Scheme::Light).await;
    paste(&page, POLL).await;
    page.wait_for("[data-testid=program][data-state=open]")
        .await;
    until(
        &page,
        "[data-testid=found]",
        "/2 frames/.test($.textContent)",
    )
    .await;
    let row = page.text("[data-testid=frame-row][data-index='1']").await;
    for words in [
        "2EDD 012345",
        "Read dynamic variables",
        "Success",
        "Loop current 12 mA",
    ] {
        assert!(row.contains(words), "{words} in {row}");
    }
    // The answer: values with unit, no fourth variable, and the way to the request.
    page.click("[data-testid=frame-row][data-index='1']").await;
    page.wait_for("[data-path='command.3.pv']").await;
    assert_eq!(field(&page, "command.3.pv").await, "50 %");
    assert_eq!(field(&page, "command.3.sv").await, "49.5 %");
    assert_eq!(field(&page, "command.3.loop_current").await, "12 mA");
    let none = field(&page, "command.3.qv").await;
    assert!(none.contains("not a number"), "{none}");
    // Bytes and fields are one picture: byte 20 is the first of the primary variable.
    page.click("[data-testid=hex-byte][data-offset='20']").await;
    until(
        &page,
        "[data-path='command.3.pv']",
        "$.classList.contains('selected')",
    )
    .await;
    let facts = page.text("[data-testid=field-facts]").await;
    assert!(facts.contains("command.3.pv"), "{facts}");
    page.click("[data-testid=frame-pair]").await;
    until(
        &page,
        "[data-testid=frame-detail] h2",
        "/request/.test($.textContent)",
    )
    .await;
    // By keyboard: down to the answer again.
    page.eval("document.querySelector('[data-testid=frame-list]').focus()")
        .await;
    press(&page, "ArrowDown").await;
    until(
        &page,
        "[data-testid=frame-detail] h2",
        "/response/.test($.textContent)",
    )
    .await;
    look(&page, "paste").await;

    paste(&page, "03 03 0B BC 00 02 06 29").await;
    until(
        &page,
        "[data-testid=found]",
        "/, 1 frame/.test($.textContent)",
    )
    .await;
    assert_eq!(count(&page, "[data-testid=program]").await, 0);
    page.assert_clean().await;
}

/// The family decides about the bits of command 48, and the list of devices offers the families.
#[tokio::test]
async fn the_family_names_the_status_bits() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.show(1440, 900, Scheme::Light).await;
    // The worked frames R9 and R10.
    paste(
        &page,
        "FF FF FF FF FF 82 AE DD 01 23 45 30 00 A6\n\
         FF FF FF FF FF 86 AE DD 01 23 45 30 0B 00 90 02 00 02 00 A4 40 08 00 00 D5",
    )
    .await;
    page.click("[data-testid=frame-row][data-index='1']").await;
    page.wait_for("[data-path='command.48.byte_0']").await;
    let families = page
        .eval(
            "return [...document.querySelectorAll('[data-testid=decode-device] option')]
               .map(o => o.value)",
        )
        .await;
    let wanted = [
        "",
        "rotork-cva",
        "rotork-iq",
        "rotork-cma",
        "rotork-ck",
        "rotork-si",
    ];
    assert_eq!(families, json!(wanted));
    choose(&page, "decode-device", "rotork-iq").await;
    until(
        &page,
        "[data-path='command.48.byte_0'] .tree-value",
        "/Local control fault/i.test($.textContent)",
    )
    .await;
    choose(&page, "decode-device", "rotork-cva").await;
    until(
        &page,
        "[data-path='command.48.byte_0'] .tree-value",
        "!/Local control fault/i.test($.textContent)",
    )
    .await;
    page.assert_clean().await;
}

/// The condensed status map without a device: the example of table 20, beside that of table 23.
#[tokio::test]
async fn the_status_map_needs_no_device() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode?view=map")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=hart-map]").await;
    // Table 20: valve obstructed (byte 1 bit 0, index 16) is out of specification (4).
    let category = "return document.querySelector('[data-testid=hart-map-row][data-index=\"16\"]')
        .dataset.category";
    assert_eq!(page.eval(category).await, "4");
    look(&page, "map").await;
    choose(&page, "hart-map-beside", "ck_example").await;
    page.wait_for("[data-testid=hart-map-row].differs").await;
    // Table 23: the same bit is a function check (5).
    choose(&page, "hart-map-source", "ck_example").await;
    until(
        &page,
        "[data-testid=hart-map-row][data-index='16']",
        "$.dataset.category === '5'",
    )
    .await;
    page.assert_clean().await;
}

/// The samples: a handheld's session, a damaged stream whose causes are named, a gateway.
#[tokio::test]
async fn samples_show_what_they_promise() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode?sample=hart-handheld")).await;
    page.show(1440, 900, Scheme::Light).await;
    until(
        &page,
        "[data-testid=found]",
        "/28 frames/.test($.textContent)",
    )
    .await;
    look(&page, "handheld").await;
    // The session begins with an identification; a step leads to its frame.
    page.click("[data-testid=hart-view][data-view=procedures]")
        .await;
    page.wait_for("[data-testid=hart-run]").await;
    let run = page.text("[data-testid=hart-run]").await;
    assert!(run.contains("Identification"), "{run}");
    look(&page, "procedures").await;
    page.click("[data-testid=hart-step] .link").await;
    page.wait_for("[data-testid=frame-list]").await;

    choose(&page, "sample", "hart-damaged").await;
    until(
        &page,
        "[data-testid=found]",
        "/17 frames/.test($.textContent)",
    )
    .await;
    let codes = "return [...new Set([...document.querySelectorAll('[data-testid=problem]')]
        .map(p => p.dataset.code))]";
    until(
        &page,
        "[data-testid=problem-count]",
        "/6 errors/.test($.textContent)",
    )
    .await;
    let seen = page.eval(codes).await;
    assert!(
        seen.as_array()
            .is_some_and(|c| c.contains(&Value::from("start-missing"))),
        "{seen}"
    );
    look(&page, "damaged").await;

    choose(&page, "sample", "hart-ip").await;
    until(
        &page,
        "[data-testid=found]",
        "/12 frames/.test($.textContent)",
    )
    .await;
    let framing = page.text("[data-testid=frame-row][data-index='0']").await;
    assert!(framing.contains("Session initiate"), "{framing}");
    look(&page, "ip").await;

    // A framing can be forced, and taken back.
    choose(&page, "decode-framing", "hart").await;
    until(
        &page,
        "[data-testid=found]",
        "!/12 frames/.test($.textContent)",
    )
    .await;
    choose(&page, "decode-framing", "").await;
    until(
        &page,
        "[data-testid=found]",
        "/12 frames/.test($.textContent)",
    )
    .await;
    page.click("[data-testid=clear]").await;
    page.wait_for("[data-testid=sample-button]").await;
    assert_eq!(count(&page, "[data-testid=program]").await, 0);
    page.assert_clean().await;
}

/// The line of the built-in plant, and its devices: an IQ at polling address 0, a CVA at 1.
const LOOP: &str = "Simulated%20HART%20loop";

/// Opens a tab of a device of the simulated loop.
async fn open_device(server: &Server, tag: &str, tab: &str) -> Page {
    let page = Page::open(&server.url(&format!("/#/device/{tag}/{tab}"))).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=program][data-state=open]")
        .await;
    page
}

/// Waits until a value of a device is there, and gives it as it stands.
async fn value(page: &Page, key: &str) -> String {
    let css = format!("[data-testid=hart-value][data-key='{key}'] .value-said b");
    page.text(&css).await
}

/// A float as the frame that is shown under a value has it, so many bytes behind the status bytes.
async fn float_of(page: &Page, key: &str, at: usize) -> f32 {
    page.click(&format!(
        "[data-testid=hart-value][data-key='{key}'] .value-name"
    ))
    .await;
    let facts = page
        .text(&format!(
            "[data-testid=hart-value][data-key='{key}'] [data-testid=value-facts] p.mono"
        ))
        .await;
    let hex = facts.rsplit(": ").next().unwrap_or_default();
    let bytes: Vec<u8> = hex
        .split_whitespace()
        .map(|b| u8::from_str_radix(b, 16).expect("a byte"))
        .collect();
    // Delimiter, five bytes of address, command, count, two of status.
    let from = 10 + at;
    let word = bytes[from..from + 4].try_into().expect("four bytes");
    f32::from_be_bytes(word)
}

/// The overview of a simulated IQ: what it shows is what its frames say.
#[tokio::test]
async fn a_device_is_shown_live() {
    let server = Server::start(&[]);
    let page = open_device(&server, "FV-401", "overview").await;
    page.wait_for("[data-testid=hart-position] .unit").await;
    // Zero is 4 mA and 100 % is 20 mA: the frame's own current, read by hand, is the shown one.
    let current = value(&page, "3.loop_current").await;
    let shown: f32 = current.parse().expect("a number");
    assert!((3.5..=20.5).contains(&shown), "{current}");
    page.click("[data-testid=hart-read]").await;
    page.wait_for("[data-testid=hart-value][data-key='133.mode'] .value-said b")
        .await;
    let mode = value(&page, "133.mode").await;
    assert!(mode.contains("Analogue input"), "{mode}");
    // Demand, position: unit byte 4, float from 5 on; unit 9, float from 10 on.
    let demand = float_of(&page, "3.pv", 5).await;
    assert!((0.0..=100.0).contains(&demand), "{demand}");
    page.wait_for("[data-testid=hart-trend] [data-testid=chart-svg]")
        .await;
    until(
        &page,
        "[data-testid=hart-ne107]",
        "!/not read/.test($.textContent)",
    )
    .await;
    look(&page, "overview").await;
    page.assert_clean().await;
}

/// Everything of the set-up is read or said to be refused; nothing stays "not read".
#[tokio::test]
async fn the_set_up_is_read() {
    let server = Server::start(&[]);
    let page = open_device(&server, "FV-401", "setup").await;
    page.wait_for("[data-testid=hart-unavailable]").await;
    patient(
        &page,
        "[data-testid=hart-setup]",
        "!/not read/.test($.textContent)",
    )
    .await;
    let zero = value(&page, "131.zero").await;
    assert!(
        (float_of(&page, "131.zero", 0).await - zero.parse::<f32>().expect("mA")).abs() < 0.001
    );
    let maker = value(&page, "0.manufacturer").await;
    assert!(maker.contains("Rotork"), "{maker}");
    look(&page, "setup").await;
    page.click("[data-testid=hart-tab][data-tab=variables]")
        .await;
    page.wait_for("[data-testid=hart-variables] [data-key='3.pv'] b")
        .await;
    patient(
        &page,
        "[data-testid=hart-variables] [data-key='9.slot[2].status']",
        "!/not read/.test($.textContent)",
    )
    .await;
    look(&page, "variables").await;
    page.assert_clean().await;
}

/// Status by bit, for an IQ and a CVA; the map of the device.
#[tokio::test]
async fn status_and_map_are_those_of_the_family() {
    let server = Server::start(&[]);
    let page = open_device(&server, "FV-401", "status").await;
    page.wait_for("[data-testid=hart-bit]").await;
    // Appendix 1: 39 bits of the IQ; 8 of the device status, 6 extended.
    assert!(count(&page, "[data-testid=hart-bit]").await >= 39 + 8 + 6);
    look(&page, "status").await;
    page.click("[data-testid=hart-tab][data-tab=map]").await;
    page.wait_for("[data-testid=hart-map]").await;
    page.wait_for("[data-testid=hart-result]").await;
    look(&page, "device-map").await;
    let page = open_device(&server, "FV-402", "status").await;
    // Table 15: the status word of the CVA, command 129.
    patient(
        &page,
        "[data-testid=hart-status]",
        "/command 129/.test($.textContent) && /Relay/.test($.textContent)",
    )
    .await;
    page.assert_clean().await;
}

/// A HART line: its frames are shown by the program, the line says who is on it, and a scan finds
/// the devices. The list of devices tells their state.
#[tokio::test]
async fn a_line_shows_its_frames_and_is_searched() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/devices")).await;
    page.show(1440, 900, Scheme::Light).await;
    patient(
        &page,
        "[data-testid=device-row][data-tag=FV-401]",
        "/poll 0/.test($.textContent) && !/never/.test($.textContent)",
    )
    .await;
    look(&page, "devices").await;
    let page = Page::open(&server.url(&format!("/#/traffic/{LOOP}"))).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=hart-link]").await;
    page.click("[data-testid=hart-scan]").await;
    page.wait_for("[data-testid=hart-found]").await;
    patient(
        &page,
        "[data-testid=frame-row]",
        "/Read unique identifier/.test($.textContent)",
    )
    .await;
    look(&page, "line").await;
    page.click("[data-testid=hart-bus] [data-testid=hart-cancel]")
        .await;
    page.assert_clean().await;
}

/// As [`until`], for what takes a slow line some time.
async fn patient(page: &Page, css: &str, test: &str) {
    let script = format!(
        "return Boolean((e => e && ({}))(document.querySelector({css:?})))",
        test.replace('$', "e")
    );
    for _ in 0..120 {
        if page.eval(&script).await == Value::Bool(true) {
            return;
        }
        tokio::time::sleep(Duration::from_millis(250)).await;
    }
    panic!("never true of {css}: {test}");
}
