//! HART end to end: pasted frames, and the simulated loop, as a person sees them.

mod gateway;
mod live;

use serde_json::{Value, json};
use tests::browser::{Page, Scheme};
use tests::server::Server;

/// Poll of a Rotork actuator and its answer: the worked frames R5 and R6, five preamble bytes each.
const POLL: &str = "FF FF FF FF FF 82 AE DD 01 23 45 03 00 95\n\
    FF FF FF FF FF 86 AE DD 01 23 45 03 1A 00 00 41 40 00 00 39 42 48 00 00 39 42 46 00 00 39 41 48 \
    00 00 39 7F A0 00 00 52";

/// The text of a field of the frame that is shown.
async fn field(page: &Page, path: &str) -> String {
    page.text(&format!("[data-path='{path}'] .tree-value"))
        .await
        .replace('\n', " ")
}

/// Pasted HART is noticed, decoded by its own program, and shown as Modbus is: rows, tree, bytes,
/// pairs. Modbus pasted over it is decoded by the page again.
#[tokio::test]
async fn pasted_frames_are_decoded() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.paste(POLL).await;
    page.wait_for("[data-testid=program][data-state=open]")
        .await;
    page.until("[data-testid=found]", "/2 frames/.test($.textContent)")
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
    page.until(
        "[data-path='command.3.pv']",
        "$.classList.contains('selected')",
    )
    .await;
    let facts = page.text("[data-testid=field-facts]").await;
    assert!(facts.contains("command.3.pv"), "{facts}");
    page.click("[data-testid=frame-pair]").await;
    page.until(
        "[data-testid=frame-detail] h2",
        "/request/.test($.textContent)",
    )
    .await;
    // By keyboard: down to the answer again.
    page.eval("document.querySelector('[data-testid=frame-list]').focus()")
        .await;
    page.press("ArrowDown").await;
    page.until(
        "[data-testid=frame-detail] h2",
        "/response/.test($.textContent)",
    )
    .await;
    page.look("hart-paste").await;

    page.paste("03 03 0B BC 00 02 06 29").await;
    page.until("[data-testid=found]", "/, 1 frame/.test($.textContent)")
        .await;
    assert_eq!(page.count("[data-testid=program]").await, 0);
    page.assert_clean().await;
}

/// The family decides about the bits of command 48, and the list of devices offers the families.
#[tokio::test]
async fn the_family_names_the_status_bits() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/decode")).await;
    page.show(1440, 900, Scheme::Light).await;
    // The worked frames R9 and R10.
    page.paste(
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
    page.enter("[data-testid=decode-device]", "rotork-iq").await;
    page.until(
        "[data-path='command.48.byte_0'] .tree-value",
        "/Local control fault/i.test($.textContent)",
    )
    .await;
    page.enter("[data-testid=decode-device]", "rotork-cva")
        .await;
    page.until(
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
    page.look("hart-map").await;
    page.enter("[data-testid=hart-map-beside]", "ck_example")
        .await;
    page.wait_for("[data-testid=hart-map-row].differs").await;
    // Saved, changed by hand and opened again: only what was changed is another category. Index 17
    // is byte 1 bit 1.
    page.keep_saved().await;
    page.click("[data-testid=hart-map-save]").await;
    let saved = page.saved(1).await;
    let line = saved
        .lines()
        .find(|l| l.starts_with("16,"))
        .expect("an entry");
    assert!(line.ends_with(",4"), "{line}");
    let changed = saved.replace(line, &format!("{}3", &line[..line.len() - 1]));
    let file = "[data-testid=hart-map-file]";
    page.open_file(file, "broken.csv", "index\n").await;
    page.until(
        "[data-testid=hart-map-view] .notice",
        "/no map/.test($.innerText)",
    )
    .await;
    page.open_file(file, "map.csv", &changed).await;
    page.until(
        "[data-testid=hart-map-row][data-index='16']",
        "$.dataset.category === '3'",
    )
    .await;
    assert_eq!(page.count("[data-testid=hart-map-view] .notice").await, 0);
    page.click("[data-testid=hart-map-save]").await;
    let categories = |text: &str| -> Vec<(String, String)> {
        let entry = |line: &str| {
            Some((
                line.split_once(',')?.0.into(),
                line.rsplit_once(',')?.1.into(),
            ))
        };
        text.lines().filter_map(entry).collect()
    };
    assert_eq!(categories(&page.saved(2).await), categories(&changed));
    // Table 23: the same bit is a function check (5).
    page.enter("[data-testid=hart-map-source]", "ck_example")
        .await;
    page.until(
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
    page.until("[data-testid=found]", "/28 frames/.test($.textContent)")
        .await;
    page.look("hart-handheld").await;
    // The session begins with an identification; a step leads to its frame.
    page.click("[data-testid=hart-view][data-view=procedures]")
        .await;
    page.wait_for("[data-testid=hart-run]").await;
    let run = page.text("[data-testid=hart-run]").await;
    assert!(run.contains("Identification"), "{run}");
    page.look("hart-procedures").await;
    page.click("[data-testid=hart-step] .link").await;
    page.wait_for("[data-testid=frame-list]").await;

    page.enter("[data-testid=sample]", "hart-damaged").await;
    page.until("[data-testid=found]", "/17 frames/.test($.textContent)")
        .await;
    let codes = "return [...new Set([...document.querySelectorAll('[data-testid=problem]')]
        .map(p => p.dataset.code))]";
    page.until(
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
    page.look("hart-damaged").await;

    page.enter("[data-testid=sample]", "hart-ip").await;
    page.until("[data-testid=found]", "/12 frames/.test($.textContent)")
        .await;
    let framing = page.text("[data-testid=frame-row][data-index='0']").await;
    assert!(framing.contains("Session initiate"), "{framing}");
    page.look("hart-ip").await;

    // A framing can be forced, and taken back.
    page.enter("[data-testid=decode-framing]", "hart").await;
    page.until("[data-testid=found]", "!/12 frames/.test($.textContent)")
        .await;
    page.enter("[data-testid=decode-framing]", "").await;
    page.until("[data-testid=found]", "/12 frames/.test($.textContent)")
        .await;
    page.click("[data-testid=clear]").await;
    page.wait_for("[data-testid=sample-button]").await;
    assert_eq!(page.count("[data-testid=program]").await, 0);
    page.assert_clean().await;
}
