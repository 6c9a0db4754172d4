//! The diagnostic objects end to end: pasted registers and a simulated unit, as a person sees them.
//! Numbers in a picture are worked out from its own ticks and compared with the registers.

use std::time::Duration;

use tests::browser::{Page, Scheme};
use tests::server::Server;

/// The registers of a sample, as the file has them.
fn sample(key: &str) -> Vec<u16> {
    let path = format!(
        "{}/../static/samples/dop-{key}.txt",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("the sample is there");
    let words = text.split_whitespace();
    words
        .map(|w| u16::from_str_radix(w, 16).expect("a register"))
        .collect()
}

/// Two registers, low word first, in two's complement.
fn s32(words: &[u16], at: usize) -> f64 {
    let raw = u32::from(words[at]) | u32::from(words[at + 1]) << 16;
    f64::from(raw.cast_signed())
}

/// Opens a sample by its address.
async fn open(server: &Server, key: &str) -> Page {
    let page = Page::open(&server.url(&format!("/#/dop?sample={key}"))).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=object-view]").await;
    page
}

/// Torque over a stroke: every point, the cursor by keys, zoom by drag, table and files.
#[tokio::test]
async fn a_torque_profile_is_drawn_as_it_was_read() {
    let server = Server::start(&[]);
    let page = open(&server, "torque").await;
    page.wait_for("[data-chart=dop-0191] [data-testid=chart-svg]")
        .await;
    let words = sample("torque");
    let part = |at: usize| -> Vec<f64> {
        words[at..at + 100]
            .iter()
            .map(|w| f64::from(*w) / 10.0)
            .collect()
    };
    for (series, at) in [
        ("max", 0),
        ("min", 100),
        ("average", 200),
        ("long-term", 300),
    ] {
        page.assert_shows("dop-0191", series, &part(at)).await;
    }
    let positions = page.drawn("dop-0191", "average").await;
    assert!((positions[0].0 - 0.5).abs() < 0.2 && (positions[99].0 - 99.5).abs() < 0.2);

    // The keyboard reads values where they stand.
    page.eval("document.querySelector('.chart-plot').focus()")
        .await;
    for key in ["Home", "ArrowRight", "ArrowRight"] {
        page.eval(&format!(
            "document.activeElement.dispatchEvent(new KeyboardEvent('keydown', {{ key: '{key}', bubbles: true }}))"
        ))
        .await;
    }
    let average = format!("{}.{}", words[202] / 10, words[202] % 10);
    page.until(
        "[data-testid=chart-readout]",
        &format!("$.innerText.includes('2 to 3 %') && $.innerText.includes('{average}')"),
    )
    .await;

    // A drag shows a part, a double click all of it.
    let drag = |from: f64, to: f64| {
        format!(
            "const plot = document.querySelector('.chart-plot');
             const svg = plot.querySelector('svg');
             const [left, , width] = svg.dataset.plot.split(' ').map(Number);
             const box = plot.getBoundingClientRect();
             const at = part => ({{ clientX: box.left + left + part * width, clientY: box.top + 60,
                                    button: 0, pointerId: 1, pointerType: 'mouse', bubbles: true }});
             plot.dispatchEvent(new PointerEvent('pointerdown', at({from})));
             plot.dispatchEvent(new PointerEvent('pointermove', at({to})));
             plot.dispatchEvent(new PointerEvent('pointerup', at({to})));"
        )
    };
    page.eval(&drag(0.25, 0.5)).await;
    page.until("[data-testid=chart-svg]", "Math.abs($.dataset.x.split(' ')[0] - 25) < 1 && Math.abs($.dataset.x.split(' ')[1] - 50) < 1").await;
    page.screenshot("dop-torque-part").await;
    page.eval("document.querySelector('.chart-plot').dispatchEvent(new MouseEvent('dblclick', { bubbles: true }))").await;
    page.until("[data-testid=chart-svg]", "$.dataset.x === '0 100'")
        .await;

    page.click("[data-testid=chart-data]").await;
    page.wait_for("[data-testid=chart-table]").await;
    assert_eq!(page.count("[data-testid=chart-table] tbody tr").await, 100);
    page.click("[data-testid=chart-data]").await;
    for form in ["svg", "png", "csv"] {
        page.click(&format!("[data-testid=chart-save-{form}]"))
            .await;
    }
    tokio::time::sleep(Duration::from_millis(500)).await;
    assert!(
        !page.text(".chart-head").await.contains("could not"),
        "the PNG was painted"
    );
    page.look("dop-torque").await;
    page.assert_clean().await;
}

/// A trend runs from its start to its end; twelve months of which nine are there.
#[tokio::test]
async fn a_trend_runs_from_start_to_end() {
    let server = Server::start(&[]);
    let page = open(&server, "temperature").await;
    page.wait_for("[data-chart=dop-225c] [data-testid=chart-svg]")
        .await;
    let words = sample("temperature");
    let oldest_first = |at: usize| -> Vec<f64> {
        (0..9)
            .rev()
            .map(|i| s32(&words, at + 2 * i) / 10.0)
            .collect()
    };
    page.assert_shows("dop-225c", "max", &oldest_first(1)).await;
    page.assert_shows("dop-225c", "min", &oldest_first(25))
        .await;
    page.assert_shows("dop-225c", "average", &oldest_first(49))
        .await;
    let points = page.drawn("dop-225c", "average").await;
    // 2026-02-20 and 2026-11-20; a ninth of the time lies between points.
    let (start, end) = (1_771_545_600.0, 1_795_132_800.0);
    let step = (end - start) / 9.0;
    assert!(
        (points[0].0 - (start + step / 2.0)).abs() < step * 0.02,
        "{points:?}"
    );
    assert!((points[8].0 - (end - step / 2.0)).abs() < step * 0.02);
    let said = page.text("[data-testid=object-view]").await;
    assert!(said.contains("9 of at most 12 points are valid"), "{said}");
    assert!(page.text("[data-testid=assumptions]").await.contains("°C"));
    page.look("dop-trend").await;
    page.assert_clean().await;
}

/// Bins of two widths, and bars for three axes.
#[tokio::test]
async fn bars_are_as_high_as_their_bins() {
    let server = Server::start(&[]);
    let page = open(&server, "vibration").await;
    page.wait_for("[data-chart=dop-0002] rect[data-series]")
        .await;
    let words = sample("vibration");
    let seconds: Vec<f64> = (0..15).map(|i| s32(&words, 1 + 2 * i)).collect();
    page.assert_shows("dop-0002", "amount", &seconds).await;
    let bars = page.drawn("dop-0002", "amount").await;
    // The last narrow bin is 3.6 to 4.0 G, the last wide one 16.8 to 20 G.
    assert!(
        (bars[9].0 - 3.8).abs() < 0.05 && (bars[14].0 - 18.4).abs() < 0.1,
        "{bars:?}"
    );
    page.look("dop-histogram").await;

    page.eval("location.hash = '#/dop?sample=axes'").await;
    page.wait_for("[data-chart=dop-0005-level] rect[data-series]")
        .await;
    page.assert_shows("dop-0005-level", "rms", &[112.0, 87.0, 245.0])
        .await;
    page.assert_shows("dop-0005-level", "peak", &[318.0, 266.0, -722.0])
        .await;
    page.assert_shows("dop-0005-spectrum", "frequency", &[24.7, 50.2, 119.6])
        .await;
    page.look("dop-axes").await;
    page.assert_clean().await;
}

/// Single values with times in words and exactly, reasons in words, candidates to choose from.
#[tokio::test]
async fn registers_find_their_object() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/dop")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=dop-welcome]").await;
    page.look("dop-welcome").await;
    let text: String = sample("pst").iter().map(|w| format!("{w:04X} ")).collect();
    page.eval(&format!(
        "const box = document.querySelector('[data-testid=dop-paste]');
         box.value = {text:?};
         box.dispatchEvent(new Event('input', {{ bubbles: true }}));"
    ))
    .await;
    page.wait_for("[data-testid=dop-fit]").await;
    assert_eq!(page.count("[data-testid=dop-fit]").await, 2);
    let cards = page.text(".object-values").await;
    for words in ["41", "2026-11-03 06:00:12 UTC", "ago"] {
        assert!(cards.contains(words), "{words}: {cards}");
    }
    assert!(cards.to_lowercase().contains("valve jam"), "{cards}");
    page.look("dop-cards").await;
    // Another candidate, by a click.
    page.click("[data-testid=dop-fit][aria-pressed=false]")
        .await;
    page.until(
        "[data-testid=object-view]",
        "$.dataset.request === '0x00CF'",
    )
    .await;

    // A register lights its field.
    page.eval("location.hash = '#/dop?sample=pst'").await;
    page.until(
        "[data-testid=object-view]",
        "$.dataset.request === '0x00D1'",
    )
    .await;
    page.click("[data-testid=register][data-offset='24']").await;
    page.until(
        "[data-testid=field-row].selected",
        "$.dataset.path.includes('open_reason')",
    )
    .await;
    assert!(
        page.text("[data-testid=field-facts]")
            .await
            .contains("AIIOM000698-01")
    );

    page.eval("location.hash = '#/dop?sample=events'").await;
    page.wait_for("[data-testid=log-row][data-id='1205']").await;
    assert_eq!(page.count("[data-testid=log-row]").await, 6);
    let failure = page.text("[data-testid=log-row][data-id='1205']").await;
    assert!(
        failure.contains("Failure") && failure.contains("Open overtorque"),
        "{failure}"
    );
    page.look("dop-events").await;
    page.assert_clean().await;
}

/// A capture of a session is recognised, its addresses inferred and said to be so.
#[tokio::test]
async fn a_capture_becomes_reads() {
    let server = Server::start(&[]);
    let page = open(&server, "session").await;
    page.wait_until("document.querySelectorAll('[data-testid=found-read]').length === 2")
        .await;
    let found = page.text("[data-testid=dop-found]").await;
    assert!(
        found.contains("inferred") && found.contains("request 500"),
        "{found}"
    );
    // The lines of the sample are 60 ms apart: ready in the sixth, all registers in the tenth.
    let first = page.text("[data-testid=found-read][data-index='0']").await;
    assert!(first.contains("540.0 ms, busy 300.0 ms"), "{first}");
    page.click("[data-testid=found-read][data-index='1']").await;
    page.wait_for("[data-chart=dop-025c] [data-testid=chart-svg]")
        .await;
    page.look("dop-session").await;
    page.assert_clean().await;
}

/// The profile as a form and as text, mistakes beside their field, kept for the next visit.
#[tokio::test]
async fn a_profile_is_edited() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/dop/profile")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=profile-text]").await;
    let set = |testid: &str, value: &str, event: &str| {
        format!(
            "const field = document.querySelector('[data-testid=\"{testid}\"]');
             field.value = '{value}';
             field.dispatchEvent(new Event('{event}', {{ bubbles: true }}));"
        )
    };
    page.eval(&set("profile-registers.request", "70000", "input"))
        .await;
    page.wait_for("[data-testid=profile-problem]").await;
    let problem = page.text("[data-testid=text-problem]").await;
    assert!(
        problem.contains("registers.request") && problem.contains("65535"),
        "{problem}"
    );
    page.screenshot("dop-profile-mistake").await;
    page.eval(&set("profile-registers.request", "500", "input"))
        .await;
    page.eval(&set("profile-temperature", "degF", "change"))
        .await;
    page.until(
        "[data-testid=profile-text]",
        "$.value.includes('\"request\": 500') && $.value.includes('degF')",
    )
    .await;
    assert_eq!(page.count("[data-testid=profile-problem]").await, 0);
    page.click("[data-testid=add-indicators]").await;
    page.wait_for("[data-testid=bit-row]").await;
    page.look("dop-profile").await;
    // The setting holds at once, and is no longer assumed.
    page.eval("location.hash = '#/dop?sample=temperature'")
        .await;
    page.wait_for("[data-chart=dop-225c]").await;
    page.until("[data-chart=dop-225c]", "$.textContent.includes('°F')")
        .await;
    assert!(!page.text("[data-testid=assumptions]").await.contains("°C"));
    page.assert_clean().await;
}

/// The registers that the page shows.
async fn registers(page: &Page) -> Vec<u16> {
    let found = page
        .eval("return [...document.querySelectorAll('[data-testid=register]')].map(r => r.textContent)")
        .await;
    let cells = found.as_array().expect("registers").iter();
    cells
        .map(|c| u16::from_str_radix(c.as_str().expect("text"), 16).expect("a register"))
        .collect()
}

/// The simulated unit at a glance: what is active with sign and explanation, who it is, its clock.
#[tokio::test]
async fn the_overview_of_a_unit() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/MX-301/overview")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-testid=indicators] [data-testid=active-bit] .sign")
        .await;
    page.until(
        "[data-testid=panel][data-object='1006']",
        "$.innerText.includes('MX-301')",
    )
    .await;
    page.wait_for("[data-testid=clock-deviation]").await;
    page.wait_for("[data-testid=panel][data-object='209'] [data-testid=card-line]")
        .await;
    page.wait_for("[data-testid=warnings] [data-testid=active-bit]")
        .await;
    page.look("dop-overview").await;
    // An indicator leads to the object that says more, which is read when it is opened.
    page.click("[data-testid=explained]").await;
    page.wait_for("[data-testid=object-view] [data-testid=card-line]")
        .await;
    let how = page.text("[data-testid=object-how]").await;
    assert!(
        how.contains("read from the device") && how.contains("busy"),
        "{how}"
    );
    page.assert_clean().await;
}

/// A stroke is read and drawn as its registers say; all objects with progress; what changed.
#[tokio::test]
async fn objects_are_read_and_compared() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/MX-301/objects?object=401&option=0")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.wait_for("[data-chart=dop-0191] [data-testid=chart-svg]")
        .await;
    let words = registers(&page).await;
    assert_eq!(words.len(), 410);
    for (series, at) in [
        ("max", 0),
        ("min", 100),
        ("average", 200),
        ("long-term", 300),
    ] {
        let wanted: Vec<f64> = words[at..at + 100]
            .iter()
            .map(|w| f64::from(*w) / 10.0)
            .collect();
        page.assert_shows("dop-0191", series, &wanted).await;
    }
    // Its reference lies over it, dashed.
    page.eval(
        "document.querySelector(\"[data-testid=object-option][data-request='0x1191']\").click()",
    )
    .await;
    page.until(
        "[data-testid=object-view]",
        "$.dataset.request === '0x1191'",
    )
    .await;
    page.wait_for("[data-chart=dop-strokes-avg] path[data-series=option-1].dashed")
        .await;
    let reference = registers(&page).await;
    let average: Vec<f64> = reference[200..300]
        .iter()
        .map(|w| f64::from(*w) / 10.0)
        .collect();
    page.assert_shows("dop-strokes-avg", "option-1", &average)
        .await;

    // All of them, cancelled and begun anew.
    page.click("[data-testid=read-all-objects]").await;
    page.until("[data-testid=dop-job]", "/\\d+ of 55/.test($.innerText)")
        .await;
    page.screenshot("dop-reading").await;
    page.click("[data-testid=cancel-objects]").await;
    page.until("[data-testid=dop-job]", "$.innerText.includes('Cancelled')")
        .await;

    // A trend of a live unit, from its start to its end.
    page.eval("location.hash = '#/device/MX-301/objects?object=1&option=1'")
        .await;
    page.wait_for("[data-chart=dop-1001] [data-testid=chart-svg]")
        .await;
    let words = registers(&page).await;
    let points = usize::from(words[0].min(30));
    let oldest_first: Vec<f64> = (0..points).rev().map(|i| s32(&words, 61 + 2 * i)).collect();
    page.assert_shows("dop-1001", "average", &oldest_first)
        .await;

    // Kept, read again, compared.
    page.eval("location.hash = '#/device/MX-301/objects?object=1007&option=0'")
        .await;
    page.wait_for("[data-testid=object-view][data-request='0x03EF']")
        .await;
    page.click("[data-testid=keep-objects]").await;
    page.wait_for("[data-testid=earlier-note]").await;
    tokio::time::sleep(Duration::from_millis(1200)).await;
    page.click("[data-testid=read-object]").await;
    page.wait_for("[data-testid=difference]").await;
    let change = page.text("[data-testid=differences]").await;
    assert!(change.contains("Date and time"), "{change}");
    page.look("dop-compared").await;
    page.eval("location.hash = '#/device/MX-301/objects?object=401&option=0'")
        .await;
    page.wait_for("[data-chart=dop-0191-compared] path[data-series=earlier-average].dashed")
        .await;
    page.look("dop-objects").await;
    page.eval("location.hash = '#/device/MX-301/settings'")
        .await;
    page.wait_for("[data-testid=setting][data-key='registers.request']")
        .await;
    page.look("dop-settings").await;
    page.assert_clean().await;
}

/// The logs page by page, once each, filtered, with sign and words.
#[tokio::test]
async fn logs_are_read_to_their_end() {
    let server = Server::start(&[]);
    let page = Page::open(&server.url("/#/device/MX-301/logs")).await;
    page.show(1440, 900, Scheme::Light).await;
    page.until("[data-testid=log-newest]", "!$.disabled").await;
    page.click("[data-testid=log-newest]").await;
    page.wait_for("[data-testid=log-row]").await;
    page.click("[data-testid=log-cancel]").await;
    page.until("[data-testid=log-resume]", "!$.disabled").await;
    let before = page.text("[data-testid=log-status] b").await;
    page.click("[data-testid=log-resume]").await;
    // Two dozen pages, half a second each.
    tokio::time::sleep(Duration::from_secs(10)).await;
    page.until(
        "[data-testid=log-status]",
        "$.innerText.includes('end of the log')",
    )
    .await;
    let after = page.text("[data-testid=log-status] b").await;
    assert_ne!(before, after, "more came after going on");
    let rows = page.count("[data-testid=log-row]").await;
    assert!((8..80).contains(&rows), "{rows} rows in the page");
    page.eval(
        "const list = document.querySelector('[data-testid=log-category]');
         list.value = '3';
         list.dispatchEvent(new Event('change', { bubbles: true }));",
    )
    .await;
    page.until("[data-testid=log-status]", "$.innerText.includes('shown')")
        .await;
    page.until("[data-testid=log-list]", "[...$.querySelectorAll('[data-testid=log-row]')].every(r => r.innerText.includes('Failure') && r.querySelector('.sign-f'))").await;
    page.look("dop-logs").await;
    page.click("[data-testid=log-1203]").await;
    page.until("[data-testid=log-oldest]", "!$.disabled").await;
    page.click("[data-testid=log-oldest]").await;
    page.wait_for("[data-testid=log-row] .log-number").await;
    page.look("dop-movements").await;
    page.assert_clean().await;
}
